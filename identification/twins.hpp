#pragma once

// Other values of dimensions with which a mechanism moves alike. Private to this folder.

#include <vector>

#include "identification/fit.hpp"

namespace poise {

/// Parameters, far from those of a fit, with which its mechanism may move as it does with these: a spring's anchor on
/// the other side of the line along which its other end runs, say. Such minima need not be near any path that a search
/// has taken.
///
/// No motion is computed for them. At states of the fit's own motions the accelerations alpha and readings y with
/// parameters p differ from those with the fitted ones by
///   e(p) = (y(p) - y) / noise,  (alpha(p) - alpha) / (|alpha| noise / |y|)
/// (sizes: root mean squares, y about its mean), which is zero where the motions are the same. Each dimension that has
/// an estimate is moved by steps that grow from some standard errors to the mechanism's size; from where |e| has a
/// local minimum, Levenberg and Marquardt's method varies all parameters. What ends with a root mean square of e below
/// 10 is returned, that nearest to zero first.
std::vector<std::vector<double>> twins(const FitProblem& problem, const Fit& fitted);

}  // namespace poise
