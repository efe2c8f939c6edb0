#pragma once

#include <vector>

#include <Eigen/Core>

#include "identification/identifiability/identifiability.hpp"

namespace poise {

/// Fills the words and the remedy of a direction of the parameters (values in the scene, SI), whose parts are relative
/// to `scale`, and finds out whether a weak one is mainly the common scale. Words leave out small parts where there are
/// many.
void explain(const FitProblem& problem, const std::vector<double>& parameters, const Eigen::VectorXd& scale,
             Identifiability::Direction& direction);

/// "k / m", "J + 0.25 m - 1.2 c".
std::string in_words(const FitProblem& problem, const Identifiability::Combination& combination);

}  // namespace poise
