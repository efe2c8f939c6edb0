#pragma once

#include "model/inertia.hpp"
#include "statics/scaled_model.hpp"

namespace poise {

/// A scene compiled for motion: everything that has inertia, is damped or is driven enters the compiled model.
class MotionModel : public ScaledModel {
 public:
  /// Throws InputError if the scene contradicts itself.
  explicit MotionModel(Scene scene);
  /// The same in given units, which models that differ in masses or stiffnesses can share; `also` as for lay_out().
  MotionModel(Scene scene, const Scales& scales, const Scene* also = nullptr);

  const Scene& scaled_scene() const { return scaled_; }        ///< measured in scales()
  const Inertia<double>& inertia() const { return inertia_; }  ///< of the scaled scene

 private:
  Scene scaled_;
  Inertia<double> inertia_;
};

}  // namespace poise
