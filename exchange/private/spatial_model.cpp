#include "exchange/private/spatial_model.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <numbers>
#include <unordered_set>

#include <fmt/format.h>

#include "exchange/private/reading.hpp"
#include "model/named_number.hpp"
#include "model/one_line.hpp"
#include "model/scene_builder.hpp"

namespace poise {
namespace {

using Eigen::Vector3d;

// Sine of the angle by which axes may be off: files round quarter turns to 1.57.
constexpr double most_off = 1e-3;
constexpr double noticed_off = 1e-9;
constexpr double no_limit = 1e6;
constexpr double degrees = 180.0 / std::numbers::pi;

struct Plane {
  Vector3d x, y, normal;

  Vec2 seen(const Vector3d& v) const { return {x.dot(v), y.dot(v)}; }
};

const SpatialJoint* first_joint(const SpatialModel& model, bool slides) {
  const auto found = std::find_if(model.joints.begin(), model.joints.end(),
                                  [&](const SpatialJoint& joint) { return joint.slides == slides; });
  return found == model.joints.end() ? nullptr : &*found;
}

// Of either sense.
Vector3d normal_of(const SpatialModel& model) {
  if (const SpatialJoint* hinge = first_joint(model, false)) return hinge->axis;
  const SpatialJoint* slide = first_joint(model, true);
  if (slide == nullptr) {
    fail_at(model.file, 0, "mechanism", "expected a joint that turns or slides, found none; then nothing moves");
  }
  for (const SpatialJoint& other : model.joints) {
    const Vector3d across = slide->axis.cross(other.axis);
    if (across.norm() > most_off) return across.normalized();
  }
  const Vector3d across = slide->axis.cross(model.gravity);
  if (across.norm() > most_off * model.gravity.norm()) return across.normalized();
  const Vector3d beside = std::abs(slide->axis.x()) < 0.9 ? Vector3d::UnitX() : Vector3d::UnitZ();
  return slide->axis.cross(beside).normalized();
}

void expect_planar(const SpatialModel& model, const Vector3d& normal, std::vector<std::string>& notes) {
  const SpatialJoint* const hinge = first_joint(model, false);
  double most = 0.0;
  for (const SpatialJoint& joint : model.joints) {
    const double sine = joint.slides ? std::abs(joint.axis.dot(normal)) : joint.axis.cross(normal).norm();
    const double angle = std::asin(std::min(1.0, sine)) * degrees;
    if (sine > most_off && joint.slides) {
      fail_at(model.file, joint.line, fmt::format("joint \"{}\"", joint.name),
              fmt::format("expected a slide in the plane across the axis of {}, found one at {:.3g} degrees to that "
                          "plane; Poise models planar mechanisms",
                          hinge != nullptr ? fmt::format("joint \"{}\"", hinge->name) : "the mechanism", angle));
    }
    if (sine > most_off) {
      fail_at(model.file, joint.line, fmt::format("joint \"{}\"", joint.name),
              fmt::format("expected an axis parallel to that of joint \"{}\", found one at {:.3g} degrees to it; Poise "
                          "models planar mechanisms",
                          hinge->name, angle));
    }
    most = std::max(most, angle);
  }
  if (most > noticed_off * degrees) {
    notes.push_back(fmt::format("Axes that are up to {:.2g} degrees off the plane count as in it.", most));
  }
}

Plane plane_of(const SpatialModel& model, std::vector<std::string>& notes) {
  Plane plane;
  plane.normal = normal_of(model);
  expect_planar(model, plane.normal, notes);
  const auto within = [&](const Vector3d& v) { return Vector3d(v - v.dot(plane.normal) * plane.normal); };
  const double across = std::abs(model.gravity.dot(plane.normal));
  const Vector3d down = within(model.gravity);
  if (down.norm() > noticed_off * model.gravity.norm()) {
    plane.y = -down.normalized();
  } else {
    const bool is_level = std::abs(plane.normal.z()) > 1.0 - most_off;
    plane.y = within(is_level ? Vector3d::UnitY() : Vector3d::UnitZ()).normalized();
  }
  // It is seen from +x, -y or +z, as drawings of what stands in a room or lies on a floor are.
  Eigen::Index largest = 0;
  plane.normal.cwiseAbs().maxCoeff(&largest);
  if ((plane.normal[largest] < 0.0) != (largest == 1)) plane.normal = -plane.normal;
  plane.x = plane.y.cross(plane.normal);
  const auto shown = [](const Vector3d& v) {
    return fmt::format("({:.4g}, {:.4g}, {:.4g})", v.x() + 0.0, v.y() + 0.0, v.z() + 0.0);
  };
  notes.push_back(fmt::format("x is {} of the file, y is {}.", shown(plane.x), shown(plane.y)));
  if (across > noticed_off * model.gravity.norm() && across > 0.0) {
    notes.push_back(
        fmt::format("Gravity of {:.4g} m/s^2 across the plane is left out: it loads bearings only.", across));
  }
  return plane;
}

// The number of few digits that is the same but for rounding of numbers of that scale.
double tidy(double value, double scale) {
  const double rounded = read_number(fmt::format("{:.10g}", value)).value_or(value);
  return std::abs(rounded - value) <= 1e-15 * std::max(scale, std::abs(value)) ? rounded + 0.0 : value;
}

// A body of the scene. One with several joints is the last of a row of them, of which the others have no mass.
struct Station {
  std::string name;
  double angle = 0.0;
  Vec2 origin{};
  SceneBuilder::BodyData data{};
  std::unordered_set<std::string> taken{};
};

// A joint between two stations, or one half of a pin in a slot.
struct JointPlace {
  int parent = 0, child = 0;
  std::string name;
  double sense = 1.0;  // of a hinge: 1 where its value grows with the angle of the child
};

class PlanarScene {
 public:
  explicit PlanarScene(SpatialModel model)
      : model_(std::move(model)), plane_(plane_of(model_, model_.notes)), builder_(title_of(model_)) {}

  Imported scene() {
    for (const SpatialBody& body : model_.bodies) {
      size_ = std::max({size_, body.at.cwiseAbs().maxCoeff(), body.center.cwiseAbs().maxCoeff()});
    }
    for (const SpatialJoint& joint : model_.joints) size_ = std::max(size_, joint.at.cwiseAbs().maxCoeff());
    builder_.source("imported from " + one_line(std::filesystem::path(model_.file).filename().string()));
    const Vec2 gravity = plane_.seen(model_.gravity);
    const double strength = norm(gravity);
    if (strength > 0.0) builder_.gravity({tidy(gravity.x, strength), tidy(gravity.y, strength)});
    joints_.resize(model_.joints.size());
    is_used_.resize(model_.joints.size(), false);
    for (const SpatialTendon& tendon : model_.tendons) {
      for (const auto& [joint, factor] : tendon.terms) is_used_[static_cast<std::size_t>(joint)] = true;
    }
    // Before the joints, which get others where they are called like a body.
    for (const SpatialBody& body : model_.bodies) body_names_.push_back(name_of(body.name, "body"));
    for (std::size_t body = 0; body < model_.bodies.size(); ++body) add_body(body);
    for (const SpatialClosure& closure : model_.closures) add_closure(closure);
    for (std::size_t joint = 0; joint < joints_.size(); ++joint) add_effects(joint);
    for (const SpatialTendon& tendon : model_.tendons) add_tendon(tendon);
    note_what_is_dropped();
    for (const auto& [name, at] : stations_.front().data.points) builder_.ground_point(name, at);
    for (std::size_t k = 1; k < stations_.size(); ++k) builder_.body(stations_[k].name, stations_[k].data);
    for (const auto* group : {&add_joints_, &add_elements_, &add_starts_}) {
      for (const auto& add : *group) add();
    }
    Imported out{builder_.text(), std::move(model_.notes)};
    try {
      parse_scene(out.text, model_.file);
    } catch (const InputError& error) {
      // Its line is that of a text which the user has not seen.
      std::string message = error.what();
      const std::size_t place = message.find(": ");
      fail_at(model_.file, 0, "mechanism", place == std::string::npos ? message : message.substr(place + 2));
    }
    return out;
  }

 private:
  using Terms = std::vector<MeasureByName::Term>;

  static std::string title_of(const SpatialModel& model) {
    return one_line(model.title.empty() ? std::filesystem::path(model.file).stem().string() : model.title);
  }

  // Bodies, joints and couplings have names of their own.
  std::string name_of(const std::string& name, const std::string& otherwise) {
    return own_name(name.empty() ? otherwise : name, names_);
  }

  Vec2 tidied(Vec2 v) const { return {tidy(v.x, size_), tidy(v.y, size_)}; }

  int add_station(const std::string& name, const Vector3d& at, double angle) {
    Station station;
    station.name = name;
    station.angle = angle;
    station.origin = plane_.seen(at);
    stations_.push_back(std::move(station));
    return static_cast<int>(stations_.size()) - 1;
  }

  // "BODY.POINT" of a point there, which has the name unless it was there before.
  std::string point(int body, const std::string& name, const Vector3d& at) {
    Station& station = stations_[static_cast<std::size_t>(body)];
    const Vec2 local = tidied((plane_.seen(at) - station.origin) * unit(-station.angle));
    for (const auto& [other, place] : station.data.points) {
      if (norm(place - local) <= 1e-14 * size_) return station.name + "." + other;
    }
    station.data.points.emplace_back(name_beside(name, station.taken), local);
    return station.name + "." + station.data.points.back().first;
  }

  Vec2 axis_in(int body, const SpatialJoint& joint) const {
    const Vec2 axis = plane_.seen(joint.axis) * unit(-stations_[static_cast<std::size_t>(body)].angle);
    return {tidy(axis.x, 1.0), tidy(axis.y, 1.0)};
  }

  double sense_of(const SpatialJoint& joint) const { return joint.axis.dot(plane_.normal) > 0.0 ? 1.0 : -1.0; }

  void add_body(std::size_t index) {
    const SpatialBody& body = model_.bodies[index];
    if (index == 0) {
      last_.push_back(add_station("ground", body.at, 0.0));
    } else {
      int at = last_[static_cast<std::size_t>(body.parent)];
      if (body.is_free || is_floating(body)) {
        at = add_free(body, body_names_[index]);
      } else if (body.joints.empty()) {
        at = add_fixed(body, body_names_[index], at);
      } else {
        for (std::size_t k = 0; k < body.joints.size();) at = add_joint(body, body_names_[index], k, at);
      }
      last_.push_back(at);
      set_mass(body, stations_[static_cast<std::size_t>(at)]);
    }
    // Points at which joints are keep the names of the file.
    for (const auto& [name, place] : body.points) point(last_.back(), name, place);
  }

  // Two slides and a hinge on which nothing acts leave it all freedoms in the plane.
  bool is_floating(const SpatialBody& body) const {
    if (body.parent != 0 || body.joints.size() != 3) return false;
    const auto joint = [&](std::size_t k) { return model_.joints[static_cast<std::size_t>(body.joints[k])]; };
    if (!joint(0).slides || !joint(1).slides || joint(2).slides) return false;
    if (joint(0).axis.cross(joint(1).axis).norm() < most_off) return false;
    return std::all_of(body.joints.begin(), body.joints.end(), [&](int k) {
      return model_.joints[static_cast<std::size_t>(k)].is_bare() && !is_used_[static_cast<std::size_t>(k)];
    });
  }

  // Its frame has the angle of the last of its joints, as if it hung on it.
  int add_free(const SpatialBody& body, const std::string& name) {
    double angle = 0.0;
    if (!body.joints.empty()) {
      const SpatialJoint& hinge = model_.joints[static_cast<std::size_t>(body.joints.back())];
      angle = sense_of(hinge) * hinge.reference;
    }
    const int child = add_station(name, body.at, angle);
    if (angle != 0.0) start(name, angle);
    add_starts_.emplace_back([this, name, at = tidied(stations_.back().origin)] { builder_.start_position(name, at); });
    return child;
  }

  void set_mass(const SpatialBody& body, Station& station) {
    station.data.mass = body.mass;
    if (body.mass > 0.0)
      station.data.center = tidied((plane_.seen(body.center) - station.origin) * unit(-station.angle));
    const double inertia = plane_.normal.dot(body.inertia * plane_.normal);
    const double largest = body.inertia.cwiseAbs().maxCoeff();
    if (inertia < -1e-12 * largest) {
      fail_at(model_.file, body.line, fmt::format("body \"{}\"", body.name),
              fmt::format("expected an inertia >= 0 about the normal of the plane, found {:.6g}", inertia));
    }
    station.data.inertia = std::max(0.0, tidy(inertia, largest));
  }

  // Adds body.joints[k], and with it the hinge behind a slide, which are a pin in a slot together. Returns the station
  // behind it, and moves k on.
  int add_joint(const SpatialBody& body, const std::string& name, std::size_t& k, int parent) {
    const auto index = static_cast<std::size_t>(body.joints[k]);
    const SpatialJoint& first = model_.joints[index];
    const bool is_slot = first.slides && k + 1 < body.joints.size() &&
                         !model_.joints[static_cast<std::size_t>(body.joints[k + 1])].slides;
    const SpatialJoint& last = is_slot ? model_.joints[static_cast<std::size_t>(body.joints[k + 1])] : first;
    k += is_slot ? 2 : 1;
    const bool is_last = k == body.joints.size();
    const double turned = last.slides ? 0.0 : sense_of(last) * last.reference;
    const double angle = stations_[static_cast<std::size_t>(parent)].angle + turned;
    const int child = add_station(is_last ? name : name_of(name + " carrier", ""), body.at, angle);
    JointPlace place{parent, child, name_of(first.name, name + (first.slides ? " slide" : " pin")),
                     last.slides ? 1.0 : sense_of(last)};
    joints_[index] = place;
    if (is_slot) joints_[static_cast<std::size_t>(body.joints[k - 1])] = place;
    if (angle != 0.0) start(stations_[static_cast<std::size_t>(child)].name, angle);
    if (!first.slides) {
      const std::string a = point(parent, place.name, first.at), b = point(child, place.name, first.at);
      add_joints_.emplace_back([=, this, friction = first.friction] {
        builder_.pin(a, b, place.name);
        if (friction > 0.0) builder_.friction({{"torque", friction}});
      });
      return child;
    }
    const Vec2 axis = axis_in(parent, first);
    const std::string a = point(parent, place.name, last.at - first.reference * first.axis);
    const std::string b = point(child, place.name, last.at);
    add_joints_.emplace_back([=, this, friction = first.friction] {
      if (is_slot)
        builder_.pin_in_slot(a, b, axis, place.name);
      else
        builder_.slide(a, b, axis, place.name);
      if (friction > 0.0) builder_.friction({{"force", friction}});
    });
    if (is_slot && last.friction > 0.0) {
      add_elements_.emplace_back([this, place, friction = last.friction] {
        builder_.element("friction", place.name, turn_of(place), {{"torque", friction}, {"width", 0.0}});
      });
    }
    if (first.reference != 0.0) start(place.name, first.reference);
    return child;
  }

  int add_fixed(const SpatialBody& body, const std::string& name, int parent) {
    const double angle = stations_[static_cast<std::size_t>(parent)].angle;
    const int child = add_station(name, body.at, angle);
    if (angle != 0.0) start(name, angle);
    const std::string joint = name_of(name + " weld", "weld");
    const std::string a = point(parent, name, body.at), b = point(child, name, body.at);
    add_joints_.emplace_back([=, this] { builder_.weld(a, b, 0.0, joint); });
    return child;
  }

  void start(const std::string& name, double value) {
    add_starts_.emplace_back([this, name, value] { builder_.start(name, value); });
  }

  void add_closure(const SpatialClosure& closure) {
    const int a = last_[static_cast<std::size_t>(closure.a)], b = last_[static_cast<std::size_t>(closure.b)];
    const std::string name = name_of(closure.name, closure.is_fixed ? "weld" : "pin");
    const std::string at_a = point(a, name, closure.at_a), at_b = point(b, name, closure.at_b);
    if (!closure.is_fixed) {
      add_joints_.emplace_back([=, this] { builder_.pin(at_a, at_b, name); });
      return;
    }
    const Vector3d normal = closure.turn * plane_.normal;
    if (normal.cross(plane_.normal).norm() > most_off || normal.dot(plane_.normal) < 0.0) {
      fail_at(model_.file, closure.line, fmt::format("weld \"{}\"", name),
              "expected a relative pose that is a turn in the plane, found one that tilts the body out of it");
    }
    const Vec2 turned = plane_.seen(closure.turn * plane_.x);
    const double angle = stations_[static_cast<std::size_t>(b)].angle - stations_[static_cast<std::size_t>(a)].angle +
                         tidy(std::atan2(turned.y, turned.x), 1.0);
    add_joints_.emplace_back([=, this] { builder_.weld(at_a, at_b, angle, name); });
  }

  MeasureByName turn_of(const JointPlace& place) const {
    const std::string& parent = stations_[static_cast<std::size_t>(place.parent)].name;
    const std::string& child = stations_[static_cast<std::size_t>(place.child)].name;
    return place.sense > 0.0 ? measures::angle(parent, child) : measures::angle(child, parent);
  }

  MeasureByName value_of(std::size_t joint) const {
    const JointPlace& place = joints_[joint];
    return model_.joints[joint].slides ? measures::travel(place.name) : turn_of(place);
  }

  void add_spring(const std::string& name, const MeasureByName& on, bool is_angle, double stiffness, double from,
                  double to) {
    const std::string free = is_angle ? "free_angle" : "free_length";
    if (stiffness == 0.0) return;
    add_elements_.emplace_back([=, this] {
      if (from == to) {
        builder_.element("spring", name, on, {{"stiffness", stiffness}, {free, from}});
        return;
      }
      const bool pulls = to<no_limit, pushes = from>(on.key == "points" ? 0.0 : -no_limit);
      if (pulls) builder_.element("spring", name, on, {{"stiffness", stiffness}, {free, to}, {"acts", "tension"}});
      if (pushes) {
        builder_.element("spring", pulls ? name + " pushing" : name, on,
                         {{"stiffness", stiffness}, {free, from}, {"acts", "compression"}});
      }
    });
  }

  void add_damper(const std::string& name, const MeasureByName& on, double coefficient) {
    if (coefficient == 0.0) return;
    add_elements_.emplace_back([=, this] { builder_.element("damper", name, on, {{"coefficient", coefficient}}); });
  }

  void add_stop(const std::string& name, const MeasureByName& on, double lower, double upper) {
    std::vector<SceneBuilder::Key> keys;
    if (lower > -no_limit) keys.emplace_back("min", lower);
    if (upper < no_limit) keys.emplace_back("max", upper);
    if (keys.empty()) return;
    add_elements_.emplace_back([=, this] { builder_.stop(name, on, keys); });
  }

  void add_effects(std::size_t index) {
    const SpatialJoint& joint = model_.joints[index];
    const JointPlace& place = joints_[index];
    if (place.child == 0) return;  // of a body that floats
    const MeasureByName on = value_of(index);
    // Both halves of a pin in a slot have its name.
    const bool is_second = !joint.slides && index > 0 && joints_[index - 1].name == place.name;
    const std::string name = is_second ? name_of(joint.name, place.name + " turn") : place.name;
    add_spring(name, on, !joint.slides, joint.stiffness, joint.spring_reference, joint.spring_reference);
    add_damper(name, on, joint.damping);
    add_stop(name, on, joint.lower, joint.upper);
    if (joint.armature > 0.0) add_rotor(name, on, joint);
  }

  // Its kinetic energy is that of the armature: the square of the joint's rate alone counts.
  void add_rotor(const std::string& joint_name, const MeasureByName& on, const SpatialJoint& joint) {
    const std::string name = name_of(joint_name + " rotor", "");
    const int rotor = add_station(name, joint.at, joint.reference);
    stations_.back().data.inertia = joint.armature;
    const std::string shaft = name_of(name + " shaft", "shaft");
    const std::string coupling = name_of(name + " coupling", "coupling");
    const std::string a = point(0, shaft, joint.at), b = point(rotor, shaft, joint.at);
    if (joint.reference != 0.0) start(name, joint.reference);
    add_joints_.emplace_back([=, this] { builder_.pin(a, b, shaft); });
    add_elements_.emplace_back([=, this] {
      builder_.coupling(measures::sum({{1.0, measures::angle("ground", name)}, {-1.0, on}}), {{"value", 0.0}},
                        coupling);
    });
    model_.notes.push_back(
        fmt::format("The armature of joint \"{}\" is the body \"{}\", which turns with the joint.", joint_name, name));
  }

  void add_tendon(const SpatialTendon& tendon) {
    const std::string name = name_of(tendon.name, "tendon");
    MeasureByName on;
    bool is_angle = false;
    if (!tendon.points.empty()) {
      std::vector<std::string> points;
      for (const auto& [body, at] : tendon.points) {
        points.push_back(point(last_[static_cast<std::size_t>(body)], name, at));
      }
      expect_one_plane(tendon);
      if (points.size() != 2) return add_rope(tendon, name, points);
      on = measures::distance(points.front(), points.back());
      if (tendon.lower == tendon.upper) {
        add_joints_.emplace_back(
            [=, this, length = tendon.lower] { builder_.bar(on.names.front(), on.names.back(), length, name); });
      }
    } else {
      Terms terms;
      is_angle = true;
      bool is_length = true;
      for (const auto& [joint, factor] : tendon.terms) {
        const bool slides = model_.joints[static_cast<std::size_t>(joint)].slides;
        is_angle = is_angle && !slides;
        is_length = is_length && slides;
        terms.push_back({factor, value_of(static_cast<std::size_t>(joint))});
      }
      if (!is_angle && !is_length && tendon.lower != tendon.upper) {
        fail_at(model_.file, tendon.line, fmt::format("tendon \"{}\"", tendon.name),
                "expected joints that all turn or all slide, found both; Poise adds them only where an equality holds "
                "the sum");
      }
      on = terms.size() == 1 && terms.front().factor == 1.0 ? terms.front().measure : measures::sum(std::move(terms));
      if (tendon.lower == tendon.upper) {
        const MeasureByName sum = on.key == "sum" ? on : measures::sum({{1.0, on}});
        add_elements_.emplace_back([=, this, value = tendon.lower] {
          builder_.coupling(sum, {{"value", value}}, name);
        });
      }
    }
    add_spring(name, on, is_angle, tendon.stiffness, tendon.slack_from, tendon.slack_to);
    add_damper(name, on, tendon.damping);
    if (tendon.friction > 0.0) {
      add_elements_.emplace_back([=, this, friction = tendon.friction] {
        builder_.element("friction", name, on, {{is_angle ? "torque" : "force", friction}, {"width", 0.0}});
      });
    }
    if (tendon.lower != tendon.upper) add_stop(name, on, std::max(tendon.lower, lowest(tendon)), tendon.upper);
  }

  // A length is not negative.
  static double lowest(const SpatialTendon& tendon) {
    return tendon.points.empty() || tendon.lower > 0.0 ? tendon.lower : -std::numeric_limits<double>::infinity();
  }

  void expect_one_plane(const SpatialTendon& tendon) const {
    const double height = tendon.points.front().second.dot(plane_.normal);
    for (const auto& [body, at] : tendon.points) {
      if (std::abs(at.dot(plane_.normal) - height) > most_off * size_) {
        fail_at(model_.file, tendon.line, fmt::format("tendon \"{}\"", tendon.name),
                "expected sites in one plane, found some apart along its normal; Poise models planar mechanisms");
      }
    }
  }

  // A way over points can pull only.
  void add_rope(const SpatialTendon& tendon, const std::string& name, const std::vector<std::string>& points) {
    const bool pulls_only = tendon.stiffness == 0.0 || (tendon.slack_from <= 0.0 && tendon.slack_to > 0.0);
    if (tendon.lower > 0.0 || tendon.damping > 0.0 || tendon.friction > 0.0 || !pulls_only) {
      fail_at(model_.file, tendon.line, fmt::format("tendon \"{}\"", tendon.name),
              fmt::format("expected a way over {} sites that pulls only, found one with another spring, a damping, "
                          "friction or a lower limit; take two sites",
                          points.size()));
    }
    const std::vector<SceneBuilder::RopePoint> over(points.begin(), points.end());
    add_elements_.emplace_back([=, this, stiffness = tendon.stiffness, free = tendon.slack_to, longest = tendon.upper] {
      if (longest < no_limit) builder_.rope(over, {{"length", longest}}, name);
      if (stiffness > 0.0) {
        builder_.rope(over, {{"stiffness", stiffness}, {"free_length", free}},
                      longest < no_limit ? name + " stretching" : name);
      }
    });
  }

  void note_what_is_dropped() {
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (const SpatialJoint& joint : model_.joints) {
      const double height = joint.slides ? least : joint.at.dot(plane_.normal);
      if (joint.slides) continue;
      least = std::min(least, height);
      most = std::max(most, height);
    }
    std::vector<std::string> tilted;
    for (const SpatialBody& body : model_.bodies) {
      if (body.mass > 0.0) {
        least = std::min(least, body.center.dot(plane_.normal));
        most = std::max(most, body.center.dot(plane_.normal));
      }
      const Vector3d product = body.inertia * plane_.normal;
      const double across = (product - product.dot(plane_.normal) * plane_.normal).norm();
      if (across > 1e-6 * body.inertia.cwiseAbs().maxCoeff()) tilted.push_back('"' + body.name + '"');
    }
    if (most - least > 1e-9 * size_) {
      model_.notes.push_back(fmt::format(
          "Offsets along the normal of the plane, of up to {:.4g} m, are left out: they load bearings only.",
          most - least));
    }
    if (!tilted.empty()) {
      model_.notes.push_back(fmt::format(
          "Products of inertia with the normal of the plane are left out: they load bearings only. Bodies: {}.",
          fmt::join(tilted, ", ")));
    }
  }

  SpatialModel model_;
  Plane plane_;
  SceneBuilder builder_;
  double size_ = 0.0;
  std::vector<Station> stations_;
  std::vector<int> last_;           // station of each body
  std::vector<JointPlace> joints_;  // of each joint of the model
  std::vector<bool> is_used_;       // by tendons
  std::vector<std::string> body_names_;
  std::unordered_set<std::string> names_;
  // What is added once all points are known, in the order of a scene file.
  std::vector<std::function<void()>> add_joints_, add_elements_, add_starts_;
};

}  // namespace

bool SpatialJoint::is_bare() const {
  return stiffness == 0.0 && damping == 0.0 && friction == 0.0 && armature == 0.0 && std::isinf(lower) &&
         std::isinf(upper);
}

double SpatialModel::lower_limit(double value) {
  return value > -no_limit ? value : -std::numeric_limits<double>::infinity();
}

double SpatialModel::upper_limit(double value) {
  return value < no_limit ? value : std::numeric_limits<double>::infinity();
}

void expect_si(const std::string& format, const ImportOptions& options) {
  if (options.length) throw InputError(fmt::format("--units: expected no unit of {}, which is in metres", format));
  if (options.tolerance)
    throw InputError(fmt::format("--tolerance: expected none of {}, which names its joints", format));
}

Imported planar_scene(SpatialModel model) { return PlanarScene(std::move(model)).scene(); }

}  // namespace poise
