#pragma once

#include <memory>
#include <mutex>

#include "statics/model/equilibrium_problem.hpp"
#include "statics/model/scaled_model.hpp"

namespace poise {

struct BallMechanism;

/// A scene compiled for statics: loads that follow functions of time have their value at t = 0, at_time().
class StaticModel : public ScaledModel {
 public:
  /// Throws InputError if the scene contradicts itself.
  explicit StaticModel(Scene scene);
  StaticModel(const StaticModel&) = delete;
  StaticModel& operator=(const StaticModel&) = delete;
  ~StaticModel();
  /// Compiles the scene in given units; `varying` is that of lay_out().
  StaticModel(Scene scene, const Scales& scales, const VaryingNumbers& varying = {});

  /// The scene measured in scales(), made anew by every call.
  Scene scaled_scene() const { return scaled(scene(), scales()); }
  const EquilibriumProblem& problem() const { return problem_; }
  /// The scene in ball arithmetic, compiled at the first call.
  const BallMechanism& balls() const;

 private:
  EquilibriumProblem problem_;
  mutable std::once_flag balls_made_;
  mutable std::unique_ptr<const BallMechanism> balls_;
};

}  // namespace poise
