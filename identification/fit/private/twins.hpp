#pragma once

// Other values of dimensions with which a mechanism moves alike.

#include <vector>

#include "identification/fit/fit.hpp"
#include "identification/identifiability/frequencies.hpp"

namespace poise {

/// Fits, far from this one, whose mechanism may move as its own does, or whose readings may be the same: a spring's
/// anchor on the other side of the line along which its other end runs, say, or a pivot on the other side of a distance
/// sensor, with a pendulum that swings the other way. Such minima need not be near any path that a search has taken.
///
/// No motion is computed for them. At states (z, w) of the fit's own motions, and with parameters p, the mechanism
/// takes the states (a + s z, s w) of its independent coordinates, element by element: s = 1 and a = 0, and where all
/// runs have unknown starts and a coordinate is not read as it is, also s_k = -1 for each selection of up to three
/// degrees of freedom (for all, if there are more), the offsets a unknown, from twice the mean of z_k there on. The
/// accelerations alpha and readings y there differ from those of the fit by
///   e(p, a) = (y - y(fit)) / noise,  (s alpha - alpha(fit)) / (|alpha(fit)| noise / |y(fit)|)
/// (sizes: root mean squares, y about its mean), which is zero where the readings are the same. Each dimension that has
/// an estimate is moved by steps that grow from some standard errors to some sizes of the mechanism; from where |e| has
/// a local minimum, and with s = -1 also from where none has moved, Levenberg and Marquardt's method varies p and a.
/// What ends with a root mean square of e below 10 is returned, that nearest to zero first.
std::vector<FitPoint> twins(const FitProblem& problem, const Fit& fitted);

}  // namespace poise
