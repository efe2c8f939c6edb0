#include "statics/quantities/quantities_at.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "statics/bodies/body_measures.hpp"
#include "statics/quantities/linear_response.hpp"
#include "statics/quantities/quantity_value.hpp"

namespace poise {
namespace {

using Kind = SoughtQuantity::Kind;

constexpr const char* not_determined = "it is not determined: joints that repeat each other share the load";

bool depends_on_efforts(const SoughtQuantity& of) {
  return std::any_of(of.of.begin(), of.of.end(), depends_on_efforts) || of.kind == Kind::reaction ||
         of.kind == Kind::stop_reaction || of.kind == Kind::drive_force || of.kind == Kind::shaking;
}

/// The place in acting() of a stop, -1 where it is none of these.
int place_of(const NumberedEquations& equations, int stop) {
  for (std::size_t h = 0; h < equations.acting().size(); ++h) {
    if (equations.acting()[h].stop == stop) return static_cast<int>(h);
  }
  return -1;
}

/// Places of bodies with the efforts that hold them.
struct Held {
  std::vector<double> z;
  Eigen::MatrixXd open;  // columns: changes of efforts that balance by themselves
};

/// Of the equations of balance, linear in the efforts: columns are what a unit of each does to the bodies; `beside` is
/// what acts on these besides loads and elements.
Held held_at(const NumberedEquations& equations, std::vector<double> z, const std::vector<double>& beside) {
  const Eigen::Index places = equations.poses(), efforts = equations.unknowns() - equations.poses();
  z.resize(static_cast<std::size_t>(equations.unknowns()), 0.0);
  if (efforts == 0) return {std::move(z), {}};
  std::vector<NumberedEquations::Placed<double>> placed;
  equations.place(z.data(), placed);
  const NumberedEquations::Bodies<double> bodies = equations.bodies(equations.numbers().data(), placed);
  Eigen::MatrixXd columns(places, efforts);
  for (Eigen::Index k = 0; k < efforts; ++k) {
    const std::vector<double> column = equations.row_gradient(static_cast<int>(places + k), bodies, placed);
    columns.col(k) = Eigen::Map<const Eigen::VectorXd>(column.data(), places);
  }
  std::vector<double> applied = beside;
  equations.push_applied(bodies, placed, applied.data());
  const Eigen::VectorXd rest = -Eigen::Map<const Eigen::VectorXd>(applied.data(), places);
  const solvers::LeastSquares<double> factors(columns, solvers::known_to::solution);
  Eigen::VectorXd found = factors.solve(rest);
  // The contact forces of gears, racks and cams act elsewhere than their measures, by forces along rows of joints.
  const bool has_contacts = std::any_of(equations.acting().begin(), equations.acting().end(), [&](const auto& one) {
    return loads_bearings(equations.scene().stops[static_cast<std::size_t>(one.stop)]);
  });
  if (has_contacts) {
    std::copy(found.data(), found.data() + efforts, z.begin() + places);
    std::vector<double> residual(z.size());
    equations.residual(equations.numbers().data(), z.data(), residual.data(), placed);
    found -= factors.solve(Eigen::Map<const Eigen::VectorXd>(residual.data(), places) +
                           Eigen::Map<const Eigen::VectorXd>(beside.data(), places));
  }
  std::copy(found.data(), found.data() + efforts, z.begin() + places);
  Held out{std::move(z), {}};
  if (factors.rank() < efforts) out.open = factors.null_space();
  return out;
}

/// Generalized forces on the places of the bodies, and their resultant on the ground about the origin of the world.
struct Beside {
  std::vector<double> on_places;
  GroundForce<double> on_ground;
};

Beside beside_of(const RestingPlace& place) {
  Beside out{std::vector<double>(place.poses.size(), 0.0), {}};
  for (const ForceBeside& one : place.beside) {
    if (one.body == 0) {
      out.on_ground.add(one.at, one.force, one.moment);
      continue;
    }
    const auto first = static_cast<std::size_t>(3 * (one.body - 1));
    const Vec2 origin{place.poses[first], place.poses[first + 1]};
    out.on_places[first] += one.force.x;
    out.on_places[first + 1] += one.force.y;
    out.on_places[first + 2] += cross(one.at - origin, one.force) + one.moment;
  }
  return out;
}

/// Whether a quantity changes with efforts that balance by themselves.
bool is_open(const SoughtQuantity& of, const NumberedEquations& equations, const Held& held, int driven) {
  if (held.open.cols() == 0) return false;
  constexpr double nothing = 1e-9;
  const Eigen::VectorXd by_efforts = gradient_by_efforts(of, equations, held.z, driven);
  return !by_efforts.isZero() &&
         !((held.open.transpose() * by_efforts).cwiseAbs().maxCoeff() <= nothing * by_efforts.norm());
}

/// Without the numbers as variables, which measures alone do not need.
std::vector<QuantityValue> measures_in(const RestingPlace& place, const std::vector<SoughtQuantity>& of) {
  std::vector<BodyPose<double>> poses(1);
  for (std::size_t i = 0; i + 2 < place.poses.size(); i += 3) {
    poses.push_back({{place.poses[i], place.poses[i + 1]}, place.poses[i + 2]});
  }
  std::vector<QuantityValue> out;
  for (const SoughtQuantity& one : of) {
    out.push_back({value_of(place.scene, one.on, poses) / one.dimension.per_scale(place.scales), ""});
  }
  return out;
}

/// A quantity with a number in place of each part that others find. Why one has none is left in `why`.
SoughtQuantity with_others(SoughtQuantity of, const RestingPlace& place, std::string& why) {
  if (of.is_in_link() || of.kind == Kind::frequency || of.kind == Kind::damping) {
    const QuantityValue found = place.other(of);
    if (why.empty()) why = found.why;
    of.kind = Kind::number;
    of.constant = found.value * of.dimension.per_scale(place.scales);
  }
  for (SoughtQuantity& part : of.of) part = with_others(std::move(part), place, why);
  return of;
}

}  // namespace

bool is_found_by_others(const SoughtQuantity& of) {
  return of.has(Kind::stress) || of.has(Kind::link_load) || of.has(Kind::frequency) || of.has(Kind::damping);
}

RestingPlace resting_place(const StaticModel& model, const std::vector<double>& x, const std::vector<int>& active,
                           int driven, const OtherQuantities& others) {
  RestingPlace out{model.scaled_scene(), model.scales(), poses_of(model, x), active, driven, {}, {}};
  if (others) {
    out.other = [&model, others, x, active](const SoughtQuantity& of) { return others(of, model, x, active); };
  }
  return out;
}

std::vector<QuantityValue> quantity_values(const RestingPlace& place, const std::vector<SoughtQuantity>& of) {
  if (std::all_of(of.begin(), of.end(), [](const SoughtQuantity& one) { return one.kind == Kind::measure; })) {
    return measures_in(place, of);
  }
  const NumberedEquations equations(place.scene, acting_at(place.scene, place.poses, place.active));
  const int driven = place_of(equations, place.driven);
  const Beside beside = beside_of(place);
  Held held{place.poses, {}};
  if (std::any_of(of.begin(), of.end(), depends_on_efforts)) {
    held = held_at(equations, place.poses, beside.on_places);
  }
  held.z.resize(static_cast<std::size_t>(equations.unknowns()), 0.0);
  QuantityPlace<double> at(equations, equations.numbers().data(), held.z.data(), driven);
  at.add_beside(beside.on_places, beside.on_ground);
  std::vector<QuantityValue> out;
  for (const SoughtQuantity& given : of) {
    QuantityValue& found = out.emplace_back();
    const SoughtQuantity one = place.other && is_found_by_others(given) ? with_others(given, place, found.why) : given;
    found.value = at.value(one) / one.dimension.per_scale(place.scales);
    if (found.why.empty()) found.why = at.why();
    if (found.why.empty() && depends_on_efforts(one) && is_open(one, equations, held, driven)) {
      found = {std::numeric_limits<double>::quiet_NaN(), not_determined};
    }
  }
  return out;
}

std::vector<double> quantities_at(const StaticModel& model, const std::vector<double>& x,
                                  const std::vector<int>& active, const std::vector<SoughtQuantity>& of, int driven) {
  std::vector<double> out;
  for (const QuantityValue& one : quantity_values(resting_place(model, x, active, driven), of)) {
    out.push_back(one.value);
  }
  return out;
}

}  // namespace poise
