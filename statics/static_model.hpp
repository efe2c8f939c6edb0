#pragma once

#include "statics/equilibrium_problem.hpp"
#include "statics/scaled_model.hpp"

namespace poise {

/// A scene compiled for statics.
class StaticModel : public ScaledModel {
 public:
  /// Throws InputError if the scene contradicts itself.
  explicit StaticModel(Scene scene);
  /// The same in given units.
  StaticModel(Scene scene, const Scales& scales);

  /// The scene measured in scales(), made anew by every call.
  Scene scaled_scene() const { return scaled(scene(), scales()); }
  const EquilibriumProblem& problem() const { return problem_; }

 private:
  EquilibriumProblem problem_;
};

}  // namespace poise
