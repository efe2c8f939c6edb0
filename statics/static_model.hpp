#pragma once

#include "statics/equilibrium_problem.hpp"
#include "statics/scaled_model.hpp"

namespace poise {

/// A scene ready for statics.
class StaticModel : public ScaledModel {
 public:
  /// Throws InputError where the scene contradicts itself.
  explicit StaticModel(Scene scene);

  const EquilibriumProblem& problem() const { return problem_; }

 private:
  EquilibriumProblem problem_;
};

}  // namespace poise
