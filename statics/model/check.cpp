#include "statics/model/check.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "model/couplings.hpp"
#include "model/rolling_profile.hpp"
#include "statics/bodies/body_measures.hpp"
#include "statics/bodies/free_bodies.hpp"
#include "statics/model/crossing_outlines.hpp"

namespace poise {
namespace {

constexpr double no_length = 1e-12;  // of the mechanism's size
// Share of the largest force that rounding of stiff springs may leave unbalanced.
constexpr double rounding_forgiven = 1e-6;
// Of the mechanism's size: how deep a profile may cut into its line, to rounding.
constexpr double deepest_cut = 1e-8;
// Of the largest force: a wheel that is pulled less than that touches its line to rounding.
constexpr double negligible_pull = 1e-10;

// Gap of a joint between the poses of its two bodies, m.
double gap(const Scene& scene, const Joint& joint, const std::vector<BodyPose<double>>& poses, double size) {
  const BodyPose<double>& a = poses[joint.a.body];
  const BodyPose<double>& b = poses[joint.b.body];
  const Vec2 d = b.world(scene.local(joint.b)) - a.world(scene.local(joint.a));
  double wide = norm(d);
  if (joint.keeps_length()) wide = std::abs(wide - joint.length);
  if (joint.has_travel()) wide = std::abs(cross(joint.direction() * unit(a.angle), d));
  if (joint.keeps_angle()) {
    wide = std::max(wide, size * std::abs(std::remainder(b.angle - a.angle - joint.angle, 2 * M_PI)));
  }
  return wide;
}

bool is_finite(const std::vector<double>& x) {
  return std::all_of(x.begin(), x.end(), [](double v) { return std::isfinite(v); });
}

class EquilibriumCheck {
 public:
  EquilibriumCheck(const StaticModel& model, const std::vector<double>& x, const CheckTolerances& tolerances,
                   const std::vector<int>* active, const std::vector<int>& sharing)
      : model_(model),
        scene_(model.scene()),
        x_(x),
        tolerances_(tolerances),
        active_(active),
        sharing_(sharing),
        poses_(model.poses_from_anchor(x)),
        size_(model.scales().length) {}

  Check run() {
    if (!is_finite(x_)) {
      out_.objection = "a coordinate is not a finite number";
      return out_;
    }
    measure_closure();
    measure_stops();
    balance_bodies();
    return out_;
  }

 private:
  void object(const std::string& reason) {
    if (out_.objection.empty()) out_.objection = reason;
  }

  void measure_closure() {
    for (std::size_t j = 0; j < scene_.joints.size(); ++j) {
      const Joint& joint = scene_.joints[j];
      double wide = gap(scene_, joint, poses_, size_);
      // A travel that only closes a loop moves no body: it has to agree with the poses of the bodies.
      const int t = model_.layout().travel[j];
      if (t >= 0 && t < model_.layout().kept) {
        wide =
            std::max(wide, std::abs(value_of(scene_, Measure::travel_of(static_cast<int>(j)), poses_) - size_ * x_[t]));
      }
      if (wide > out_.closure_error || out_.worst_joint.empty()) {
        out_.closure_error = wide;
        out_.worst_joint = joint.name;
      }
    }
    out_.closed = out_.closure_error <= tolerances_.closure * size_;
    if (!out_.closed) {
      object(fmt::format("joint \"{}\" is open by {:.3g} {}", out_.worst_joint,
                         out_.closure_error / scene_.units.length, scene_.units.length_name));
    }
  }

  void measure_stops() {
    out_.stops_kept = true;
    for (std::size_t s = 0; s < scene_.stops.size(); ++s) {
      const Stop& stop = scene_.stops[s];
      const double unit_size = stop.on.is_angle() ? 1.0 : size_;
      const double g = value_of(scene_, stop.on, poses_);
      const double beyond = std::max({0.0, g - stop.max, stop.min - g}) / unit_size;
      const double near = tolerances_.stop * unit_size;
      const bool at_max = g >= stop.max - near;
      const bool at_min = g <= stop.min + near;
      touching_.push_back(at_max && at_min ? 2 : at_max ? 1 : at_min ? -1 : 0);
      if (active_ != nullptr) {
        const auto is_in = [&](const std::vector<int>& stops) {
          return std::find(stops.begin(), stops.end(), static_cast<int>(s)) != stops.end();
        };
        if (!is_in(*active_) && !is_in(sharing_))
          touching_.back() = 0;
        else if (touching_.back() == 0)
          touching_.back() = 2;
      }
      if (beyond <= out_.stop_violation) continue;
      out_.stop_violation = beyond;
      out_.worst_stop = stop.name;
      worst_family_ = stop.family();
    }
    if (out_.stop_violation > tolerances_.stop) {
      out_.stops_kept = false;
      object(fmt::format("{} \"{}\" is overrun by {:.3g} of the mechanism's size", worst_family_, out_.worst_stop,
                         out_.stop_violation));
    }
  }

  void balance_bodies() {
    FreeBodies bodies = balance(scene_, poses_, touching_, size_);
    out_.imbalance = bodies.imbalance;
    out_.worst_body = scene_.bodies.size() > 1 ? scene_.bodies[bodies.worst_body].name : "";
    out_.largest_force = bodies.largest_force;
    out_.reactions = std::move(bodies.reactions);
    out_.redundancy = bodies.redundancy;
    if (active_ != nullptr) add_idle_stops();
    for (const Element& e : scene_.elements) {
      out_.element_forces.push_back({.value = force_at_rest(e.law, value_of(scene_, e.on, poses_)).value});
    }
    look_at_pulleys();
    look_at_wheels();
    look_at_outlines();
    if (const Element* cone = pushing_at_zero_length()) {
      object(fmt::format(
          "{} \"{}\" is compressed to length zero, where its force has no direction: no equilibrium is possible there",
          cone->family(), cone->name));
      return;
    }
    // The balance cannot be better than the change of force of the stiffest spring for a few rounding errors of
    // position.
    double stiffest = 0.0;
    for (const Element& e : scene_.elements) stiffest = std::max(stiffest, rounding_size(e));
    const double rounding = 1e-14 * stiffest;
    if (!std::isfinite(out_.imbalance) || !std::isfinite(out_.largest_force)) {
      const std::string rope = rope_without_length(scene_, poses_);
      object(rope.empty() ? "forces overflow double precision, so balance cannot be checked" : rope);
      return;
    }
    out_.balanced = is_balanced(bodies, rounding);
    if (!bodies.pulling.empty()) object(pulling_in_words(bodies.pulling));
    out_.pulling = std::move(bodies.pulling);
    if (!out_.balanced) object(unbalanced_in_words(bodies));
  }

  // Gives stops that act and carry nothing in the set of reactions their places, among the others in the order of the
  // scene.
  void add_idle_stops() {
    std::vector<Reaction> stops;
    const auto first =
        std::find_if(out_.reactions.begin(), out_.reactions.end(), [](const Reaction& r) { return r.of_stop(); });
    auto next = first;
    for (std::size_t s = 0; s < scene_.stops.size(); ++s) {
      if (touching_[s] == 0) continue;
      const bool carries = next != out_.reactions.end() && next->stop == static_cast<int>(s);
      stops.push_back(carries ? std::move(*next++) : idle_reaction(scene_, poses_, static_cast<int>(s)));
    }
    out_.reactions.erase(first, out_.reactions.end());
    out_.reactions.insert(out_.reactions.end(), std::make_move_iterator(stops.begin()),
                          std::make_move_iterator(stops.end()));
  }

  // A small imbalance that rounding of the positions causes is no objection; nor is any where all forces are no more
  // than that.
  bool is_balanced(const FreeBodies& bodies, double rounding) const {
    return bodies.largest_force <= rounding ||
           bodies.imbalance <= tolerances_.imbalance * bodies.largest_force +
                                   std::min(rounding, rounding_forgiven * bodies.largest_force);
  }

  // Force that an element would exert over the whole size of the quantities its measure is computed from.
  double rounding_size(const Element& e) const {
    const double k = std::abs(force_at_rest(e.law, value_of(scene_, e.on, poses_)).by_measure);
    if (!e.on.is_angle()) return k * size_;
    double turns = std::abs(value_of(scene_, e.on, poses_));
    if (e.on.kind == Measure::Kind::angle) {
      turns = std::abs(poses_[e.on.body_a].angle) + std::abs(poses_[e.on.body_b].angle);
    }
    if (const auto* spring = std::get_if<LinearSpring>(&e.law)) turns += std::abs(spring->free_length);
    return k * turns / size_;
  }

  // Of ropes that carry a force: off a pulley its length is not the one of the equations.
  void look_at_pulleys() {
    out_.keeps_contacts = true;
    const auto look_at = [&](const auto& item) {
      const RopeContact* const pulley = untouched_pulley(scene_, item.on, poses_);
      if (pulley == nullptr) return;
      out_.keeps_contacts = false;
      object(
          fmt::format("{} \"{}\" does not touch its pulley \"{}\", round which it would have to pass on the other side",
                      item.family(), item.name, scene_.name_of(pulley->at)));
    };
    for (std::size_t e = 0; e < scene_.elements.size(); ++e) {
      if (out_.element_forces[e].value != 0.0) look_at(scene_.elements[e]);
    }
    for (std::size_t s = 0; s < scene_.stops.size(); ++s) {
      if (touching_[s] != 0) look_at(scene_.stops[s]);
    }
  }

  // A wheel or a profile that would have to be pulled to its line or circle lifts off.
  void look_at_wheels() {
    const double least = -negligible_pull * out_.largest_force;
    for (const Reaction& reaction : out_.reactions) {
      if (!reaction.of_stop() || !reaction.kind.starts_with("rolling")) continue;
      const Stop* const row = &scene_.stops[static_cast<std::size_t>(reaction.stop)];
      if (coupling_kind(*row)->row > 0) continue;
      if (row->table.starts_with("rolling_profile")) look_at_profile(row);
      const bool is_too_large = row->table == "rolling_on_circle" && row->max <= 0.0;
      if (!is_too_large && -row->sense * reaction.axial >= least) continue;
      out_.keeps_contacts = false;
      object(fmt::format("{} \"{}\" {}", row->family(), row->name,
                         is_too_large ? "has a wheel as large as the circle in which it rolls"
                         : row->table.starts_with("rolling_profile") ? "lifts off, its profile would have to be pulled"
                                                                     : "lifts off, its wheel would have to be pulled"));
    }
  }

  void look_at_outlines() {
    const Stop* const crossed = crossing_outlines(scene_, poses_, deepest_cut * size_);
    if (crossed == nullptr) return;
    out_.keeps_contacts = false;
    object(fmt::format("{} \"{}\" has outlines that cross each other", crossed->family(), crossed->name));
  }

  // A profile touches between its ends, and nowhere else: it cuts into nothing.
  void look_at_profile(const Stop* rows) {
    // From the line, or along the radius of a circle, to the curve's origin.
    const Measure& across = rows->on.terms[0].measure;
    const auto first = static_cast<std::size_t>(rows - scene_.stops.data());
    const auto [from, to] = range_of_profile(scene_, first);
    const double u = value_of(scene_, rows->on.terms[1].measure, poses_) / rows->on.terms[1].span;
    const auto refuse = [&](std::string_view why) {
      out_.keeps_contacts = false;
      object(fmt::format("{} \"{}\" {}", rows->family(), rows->name, why));
    };
    const double near = tolerances_.stop * size_ / rows->on.terms[1].span;
    const bool is_closed = rows->on.terms[1].profile->periodic();
    if (!is_closed && (u <= from + near || u >= to - near)) {
      refuse("touches at an end of its curve, where it ceases to roll");
    }
    const auto pose = [&](PointRef point) { return poses_[static_cast<std::size_t>(point.body)]; };
    const Vec2 origin = pose(across.a).world(scene_.local(across.a));
    const Vec2 outward = direction<double>(across.axis) * unit(pose(across.a).angle);
    constexpr int samples = 2000;
    double deepest = 0.0;
    for (int k = 0; k <= samples; ++k) {
      const Vec2 of_curve = point_of_profile(rows, from + (to - from) * k / samples);
      const Vec2 at = pose(across.b).world(scene_.local(across.b) + of_curve) - origin;
      const bool is_on_circle = rows->table == "rolling_profile_on_circle";
      deepest = std::max(deepest, is_on_circle ? rows->sense * (rows->max - norm(at)) : -dot(at, outward));
    }
    if (deepest > deepest_cut * size_) refuse("cuts with its profile into what it rolls on");
  }

  // Its energy has the tip of a cone there, where no derivative exists.
  const Element* pushing_at_zero_length() const {
    for (const Element& e : scene_.elements) {
      if (e.on.kind != Measure::Kind::distance) continue;
      if (value_of(scene_, e.on, poses_) <= no_length * size_ && force_at_rest(e.law, 0.0).value < 0.0) return &e;
    }
    return nullptr;
  }

  // "rope "a" and rope "b" would have to push, stop "c" would have to pull".
  std::string pulling_in_words(const std::vector<int>& stops) const {
    std::vector<std::string> pushing, pulling;
    for (const int s : stops) {
      const Stop& stop = scene_.stops[static_cast<std::size_t>(s)];
      const bool is_length = stop.on.kind == Measure::Kind::distance || stop.on.kind == Measure::Kind::rope;
      const bool holds_together = is_length && touching_[static_cast<std::size_t>(s)] > 0;
      (holds_together ? pushing : pulling).push_back(stop.title());
    }
    std::vector<std::string> parts;
    if (!pushing.empty()) parts.push_back(fmt::format("{} would have to push", fmt::join(pushing, " and ")));
    if (!pulling.empty()) parts.push_back(fmt::format("{} would have to pull", fmt::join(pulling, " and ")));
    return fmt::format("{}", fmt::join(parts, ", "));
  }

  std::string unbalanced_in_words(const FreeBodies& bodies) const {
    const Units& units = scene_.units;
    const std::string amount =
        bodies.is_moment ? fmt::format("{:.3g} {} {}", bodies.imbalance * size_ / (units.force * units.length),
                                       units.force_name, units.length_name)
                         : fmt::format("{:.3g} {}", bodies.imbalance / units.force, units.force_name);
    return fmt::format("body \"{}\" is out of balance by {} ({:.1g} of the largest force{})", out_.worst_body, amount,
                       bodies.imbalance / bodies.largest_force, bodies.is_moment ? " times the mechanism's size" : "");
  }

  const StaticModel& model_;
  const Scene& scene_;
  const std::vector<double>& x_;
  const CheckTolerances& tolerances_;
  const std::vector<int>* active_;
  const std::vector<int>& sharing_;
  std::vector<BodyPose<double>> poses_;
  double size_;
  std::vector<int> touching_;
  std::string worst_family_;
  Check out_;
};

}  // namespace

Check check(const StaticModel& model, const std::vector<double>& x, const CheckTolerances& tolerances,
            const std::vector<int>* active, const std::vector<int>& sharing) {
  return EquilibriumCheck(model, x, tolerances, active, sharing).run();
}

}  // namespace poise
