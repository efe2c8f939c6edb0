#pragma once

#include <functional>
#include <string>
#include <vector>

#include "statics/model/static_model.hpp"
#include "statics/quantities/quantity.hpp"

namespace poise {

/// A quantity in a position, SI: not a number where it is undefined, and why, in one sentence.
struct QuantityValue {
  double value = 0.0;
  std::string why;
};

/// A force at a point of the world and a moment on a body.
struct ForceBeside {
  int body = 0;
  Vec2 at{}, force{};
  double moment = 0.0;
};

/// Finds stresses and modes where a model rests at scaled coordinates while stops hold.
using OtherQuantities = std::function<QuantityValue(const SoughtQuantity& of, const StaticModel& model,
                                                    const std::vector<double>& x, const std::vector<int>& active)>;

/// Bodies at rest and what holds them, for quantities: in a scene measured in `scales`.
struct RestingPlace {
  Scene scene;
  Scales scales;
  std::vector<double> poses;  ///< scaled: poses_of() of a model at rest
  std::vector<int> active;    ///< stops that hold, indices of Scene::stops; those that are drives last
  int driven = -1;            ///< the first of these that is a drive, in whose stead a push holds the pose; -1 of none
  /// What acts on bodies beside loads, elements, joints and stops: inertia forces, dampers; scaled.
  std::vector<ForceBeside> beside{};
  /// Finds stresses and modes; without it they are not known.
  std::function<QuantityValue(const SoughtQuantity&)> other{};
};

/// Where a model rests at the scaled coordinates x. Refers to the model where there are `others`.
RestingPlace resting_place(const StaticModel& model, const std::vector<double>& x, const std::vector<int>& active,
                           int driven = -1, const OtherQuantities& others = {});

/// Whether others than statics find a part of the quantity: a stress or a mode.
bool is_found_by_others(const SoughtQuantity& of);

/// Values of quantities in a place, all from the same efforts of joints and stops: those that balance the bodies,
/// found once where any of the quantities depends on them. An effort that joints which repeat each other leave open is
/// undefined, and so is what depends on it.
std::vector<QuantityValue> quantity_values(const RestingPlace& place, const std::vector<SoughtQuantity>& of);

/// The values alone, not a number where one is undefined: where a model rests at the scaled coordinates x while the
/// stops `active` hold. `driven` as of RestingPlace.
std::vector<double> quantities_at(const StaticModel& model, const std::vector<double>& x,
                                  const std::vector<int>& active, const std::vector<SoughtQuantity>& of,
                                  int driven = -1);

}  // namespace poise
