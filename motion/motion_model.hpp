#pragma once

#include "model/inertia.hpp"
#include "statics/model/scaled_model.hpp"

namespace poise {

/// A scene compiled for motion: everything that has inertia, is damped or is driven enters the compiled model.
class MotionModel : public ScaledModel {
 public:
  /// Throws InputError if the scene contradicts itself.
  explicit MotionModel(Scene scene);
  /// Compiles the scene in given units, which models that differ in masses or stiffnesses can share; `varying` is that
  /// of lay_out().
  MotionModel(Scene scene, const Scales& scales, const VaryingNumbers& varying = {});

  const Scene& scaled_scene() const { return scaled_; }        ///< measured in scales()
  const Inertia<double>& inertia() const { return inertia_; }  ///< of the scaled scene

 private:
  Scene scaled_;
  Inertia<double> inertia_;
};

/// The loads of a scene that follow functions of time, but for such as are always zero, numbers of springs and gravity:
/// models of the scene at its times that are made for these have the same coordinates.
VaryingNumbers loads_in_time(const Scene& scene);

}  // namespace poise
