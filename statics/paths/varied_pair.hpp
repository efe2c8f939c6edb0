#pragma once

#include <memory>
#include <string>

#include "statics/model/varied_scene.hpp"

namespace poise {

/// A number that varies, and its range in the scene's own units: names as for VariedScene.
struct VariedNumber {
  std::string name;
  double from = 0.0, to = 0.0;
};

/// A scene of which two numbers vary.
class VariedPair {
 public:
  /// A driven measure can be the first number only. Throws InputError for bad names and ranges as VariedScene does, for
  /// two numbers that are one, and for "loads" together with a load, which it multiplies.
  VariedPair(const Scene& scene, const VariedNumber& first, const VariedNumber& second);

  /// Each with the other held at a value within its range; for names, ranges and units.
  const VariedScene& first() const { return first_; }
  const VariedScene& second() const { return second_; }
  /// One varies, the other is held, SI. Coordinates and scales are the same for all values.
  VariedScene first_at(double second) const { return first_.in(second_.scene_at(second), first_); }
  VariedScene second_at(double first) const { return second_.in(first_.scene_at(first), first_); }
  /// Compiled for statics at values of both, SI.
  std::unique_ptr<StaticModel> model_at(double first, double second) const { return first_at(second).model_at(first); }

 private:
  VariedScene second_, first_;  // in this order: the first in a scene in which the second has a generic value
};

}  // namespace poise
