#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "statics/model/readings.hpp"
#include "statics/paths/path.hpp"
#include "statics/quantities/quantities_at.hpp"

namespace poise {

/// Reads the points of a path by the names of the scene.
class PathReader {
 public:
  explicit PathReader(const VariedScene& varied, OtherQuantities others = {})
      : varied_(varied), others_(std::move(others)) {}

  /// The mechanism with the dimensions that it has at the point; loads and stiffnesses may be those of another. Valid
  /// until the next call.
  const StaticModel& model(const PathPoint& point);
  /// Where bodies, slides and springs are at the point, SI. Forces of springs may be those of another point.
  Readings read(const PathPoint& point) { return read_off(model(point), point.x); }
  /// Of a driven measure, with what drives it.
  std::vector<QuantityValue> values(const std::vector<SoughtQuantity>& of, const PathPoint& point);
  /// SI; not a number where the quantity is undefined.
  double value(const SoughtQuantity& quantity, const PathPoint& point) { return values({quantity}, point)[0].value; }

 private:
  const VariedScene& varied_;
  OtherQuantities others_;
  std::unique_ptr<StaticModel> model_;
  double at_ = 0.0;  // parameter of model_
};

/// The scene by whose names quantities of a path are found: the driven measure is a drive of it, and no stop.
Scene named_scene(const VariedScene& varied);

/// The angle or travel that changes most along the path, in rad or mechanism sizes; of mechanisms that have neither a
/// coordinate of a point. Where none changes by a millionth, as on a stop, the force of an element or joint that
/// changes most, if one does. The first where several do. There is one point at least.
SoughtQuantity most_changing(const VariedScene& varied, const Path& path);

}  // namespace poise
