#pragma once

#include <optional>
#include <vector>

#include "model/mechanism.hpp"
#include "model/parameters.hpp"
#include "model/scene.hpp"
#include "statics/model/scaling.hpp"

namespace poise {

/// A scene compiled in units of its own size and load, so that all solvers work with numbers of order one. x are the
/// coordinates in those units, q in SI (rad, m); time stays in seconds.
class ScaledModel {
 public:
  /// Throws InputError if the scene contradicts itself.
  ScaledModel(Scene scene, Purpose purpose);
  /// Compiles the scene in given units, which models that differ in loads or masses can share; `varying` is that of
  /// lay_out().
  ScaledModel(Scene scene, Purpose purpose, const Scales& scales, const VaryingNumbers& varying = {});
  ScaledModel(const ScaledModel&) = delete;
  ScaledModel& operator=(const ScaledModel&) = delete;

  const Scene& scene() const { return scene_; }  ///< SI
  const Scales& scales() const { return scales_; }
  const Mechanism<double>& mechanism() const { return mechanism_; }  ///< measured in scales()
  const Layout& layout() const { return mechanism_.layout(); }

  std::vector<double> start() const { return mechanism_.start(); }  ///< x
  std::vector<double> to_si(std::vector<double> x) const;
  std::vector<double> from_si(std::vector<double> q) const;
  /// Poses of all bodies and then of all bars, SI.
  std::vector<BodyPose<double>> poses(const std::vector<double>& x) const;
  /// The same with origins measured from Layout::anchor, so that rounding does not depend on where the world's origin
  /// is.
  std::vector<BodyPose<double>> poses_from_anchor(const std::vector<double>& x) const;

 private:
  std::vector<BodyPose<double>> in_si(std::vector<BodyPose<double>> poses) const;
  Mechanism<double> compiled(Purpose purpose, const std::optional<Scales>& scales, const VaryingNumbers& varying);

  Scene scene_;
  Scales scales_;
  Mechanism<double> mechanism_;
};

}  // namespace poise
