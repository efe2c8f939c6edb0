#pragma once

#include "model/inertia.hpp"
#include "statics/scaled_model.hpp"

namespace poise {

/// A scene ready for motion: everything that has inertia, is damped or is driven enters the compiled model.
class MotionModel : public ScaledModel {
 public:
  /// Throws InputError where the scene contradicts itself.
  explicit MotionModel(Scene scene);
  /// The same in given units: models that differ in masses or stiffnesses can share theirs.
  MotionModel(Scene scene, const Scales& scales);

  const Inertia<double>& inertia() const { return inertia_; }  ///< of the scaled scene

 private:
  Inertia<double> inertia_;
};

}  // namespace poise
