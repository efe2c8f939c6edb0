#pragma once

#include <string>
#include <vector>

#include "app/results/identification/identify.hpp"

namespace poise::app {

/// A scene file with the numbers of a fit.
struct FittedScene {
  std::string text;               ///< empty where no estimate can be written
  std::vector<std::string> left;  ///< what is not written, and why: one line each
};

/// The text of the experiment's scene file with its estimates in place, behind a comment that says where they come from
/// and which are left. Changes by `set` of the experiment and by --set are written too. Not written are estimates that
/// are withheld, those of an unknown that has several values, and numbers that the equilibrium of a run sets.
FittedScene fitted_scene(const FitProblem& problem, const Identification& answer);

}  // namespace poise::app
