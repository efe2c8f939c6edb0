#include "statics/equilibrium/link_loads.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "model/flexible_link.hpp"
#include "solvers/root.hpp"
#include "statics/bodies/body_measures.hpp"
#include "statics/bodies/contact_loads.hpp"
#include "statics/model/mobility.hpp"

namespace poise {
namespace {

/// Part of a length below which places are one, and part of a force below which it is rounding.
constexpr double same_within = 1e-9;
constexpr double part_rounding = 1e-9;

/// A reason why nothing can be said of a link.
struct Refusal {
  std::string why;
};

/// The roots of a + b x + c x^2 within (0, end).
std::vector<double> roots_within(double a, double b, double c, double end) {
  std::vector<double> out;
  const auto add = [&](double x) {
    if (x > 0.0 && x < end) out.push_back(x);
  };
  const double square = b * b - 4 * a * c;
  if (square < 0.0) return out;
  // The larger root first: the other is their product over it.
  const double q = -0.5 * (b + std::copysign(std::sqrt(square), b));
  if (c != 0.0) add(q / c);
  if (q != 0.0) add(a / q);
  std::sort(out.begin(), out.end());
  return out;
}

/// The polyline of a section, in the frame of its body.
class Line {
 public:
  explicit Line(const Body& body) {
    for (const int point : body.section->line) {
      const Vec2 at = body.points[static_cast<std::size_t>(point)].at;
      if (!corners_.empty()) {
        const double step = norm(at - corners_.back());
        if (step == 0.0) throw Refusal{"two points of its line are at the same place"};
        s_.push_back(s_.back() + step);
      } else {
        s_.push_back(0.0);
      }
      corners_.push_back(at);
    }
  }

  double length() const { return s_.back(); }
  const std::vector<double>& stations() const { return s_; }
  Vec2 first() const { return corners_.front(); }
  Vec2 last() const { return corners_.back(); }
  std::size_t stretches() const { return s_.size() - 1; }
  Vec2 along(std::size_t stretch) const {
    return (1 / (s_[stretch + 1] - s_[stretch])) * (corners_[stretch + 1] - corners_[stretch]);
  }
  /// The stretch that begins at s or has it inside; the last one at the end.
  std::size_t stretch_at(double s) const {
    const auto next = std::upper_bound(s_.begin(), s_.end(), s);
    return std::min(static_cast<std::size_t>(next - s_.begin()), stretches()) - 1;
  }
  Vec2 at(double s) const {
    const std::size_t k = stretch_at(s);
    return corners_[k] + (s - s_[k]) * along(k);
  }
  /// s of the nearest point, of several the first.
  double nearest(Vec2 p) const {
    double best = 0.0, least = norm(p - corners_.front());
    for (std::size_t k = 0; k < stretches(); ++k) {
      const double x = std::clamp(dot(along(k), p - corners_[k]), 0.0, s_[k + 1] - s_[k]);
      const double distance = norm(p - corners_[k] - x * along(k));
      if (distance < least - same_within * length()) {
        best = s_[k] + x;
        least = distance;
      }
    }
    return best;
  }
  /// Square of the radius of gyration about the centroid.
  double gyration() const {
    const Vec2 middle = centroid();
    double sum = 0.0;
    for (std::size_t k = 0; k < stretches(); ++k) {
      const double step = s_[k + 1] - s_[k];
      const Vec2 from_middle = 0.5 * (corners_[k] + corners_[k + 1]) - middle;
      sum += step / length() * (dot(from_middle, from_middle) + step * step / 12);
    }
    return sum;
  }
  Vec2 centroid() const {
    Vec2 sum{};
    for (std::size_t k = 0; k < stretches(); ++k) {
      sum += ((s_[k + 1] - s_[k]) / length()) * (0.5 * (corners_[k] + corners_[k + 1]));
    }
    return sum;
  }

 private:
  std::vector<Vec2> corners_;
  std::vector<double> s_;
};

/// Collects all that acts on a link, in the frame of its body.
class Actions {
 public:
  Actions(const Scene& scene, const std::vector<BodyPose<double>>& poses, const Line& line, LinkLoads& out)
      : scene_(scene), poses_(poses), pose_(poses[static_cast<std::size_t>(out.frame)]), line_(line), out_(out) {}

  /// The weight, and what the motion adds to it.
  void add_mass(const BodyAcceleration* motion) {
    if (motion == nullptr) return add_weight();
    const Body& body = scene_.bodies[static_cast<std::size_t>(out_.frame)];
    const Vec2 fall = turned_back(scene_.gravity - motion->of_origin);
    // Weight less inertia force, per mass, at a place of the body's frame.
    const auto per_mass = [&](Vec2 at) {
      return fall - motion->turning * quarter_turn(at) + (motion->rate * motion->rate) * at;
    };
    const double gyration = line_.gyration();
    if (is_near(line_.centroid(), body.center)) out_.spread = std::min(body.mass, body.inertia / gyration);
    // What is left by rounding is none.
    const double left = body.mass - out_.spread;
    const double lumped = left > same_within * body.mass ? left : 0.0;
    const double turning = body.inertia - out_.spread * gyration;
    const double couple = turning > same_within * body.inertia ? -turning * motion->turning : 0.0;
    const double density = out_.spread / line_.length();
    for (std::size_t k = 0; density > 0.0 && k < line_.stretches(); ++k) {
      const double from = line_.stations()[k], to = line_.stations()[k + 1];
      const Vec2 first = per_mass(line_.at(from)), second = per_mass(line_.at(from) + (to - from) * line_.along(k));
      out_.line_actions.push_back(
          {"weight and inertia", from, to, density * first, (density / (to - from)) * (second - first)});
    }
    act("weight and inertia", body.center, lumped * per_mass(body.center), couple);
  }

  void add_loads() {
    for (const Force& force : scene_.forces) {
      if (force.at.body == out_.frame && !(force.vector == Vec2{})) add_force(force);
    }
    for (const Torque& torque : scene_.torques) {
      if (torque.body != out_.frame || torque.value == 0.0) continue;
      const std::string name = "torque " + torque.name;
      if (torque.point >= 0) {
        const Vec2 at = scene_.local({torque.body, torque.point});
        act(name, at, {}, torque.value);
      } else {
        couple(name, 0, torque.value, "; give it at = \"BODY.POINT\" in place of on");
      }
    }
  }

  void add_elements(const std::vector<double>& forces) {
    for (std::size_t e = 0; e < scene_.elements.size(); ++e) {
      const Element& element = scene_.elements[e];
      add_efforts(element.family() + " " + element.name, element.on, -forces[e]);
    }
  }

  void add_drives(const std::vector<MeasureEffort>& efforts) {
    for (const MeasureEffort& effort : efforts) add_efforts("drive " + effort.name, effort.on, effort.value);
  }

  void add_reaction(const Reaction& reaction) {
    const std::string name = reaction.kind + " " + reaction.name;
    if (reaction.of_stop()) {
      return add_stop(name, scene_.stops[static_cast<std::size_t>(reaction.stop)], reaction);
    }
    const Joint& joint = scene_.joints[static_cast<std::size_t>(reaction.joint)];
    const bool on_b = joint.b.body == out_.frame;
    if (!on_b && joint.a.body != out_.frame) return;
    expect_determined(name, reaction);
    const double sign = on_b ? 1.0 : -1.0;
    // The force of a bar acts at each of its ends, all others where the point of the second body is.
    const Vec2 at = joint.keeps_length() ? scene_.local(on_b ? joint.b : joint.a) : local(reaction.at);
    joints_.emplace_back(name, at);
    act(name, at, sign * turned_back(reaction.force), sign * reaction.moment);
  }

  /// A link with three joints or more is a beam only if its line visits them.
  void expect_joints_on_line() const {
    std::vector<Vec2> places;
    for (const auto& [name, at] : joints_) {
      const bool is_new = std::none_of(places.begin(), places.end(), [&, at = at](Vec2 p) { return is_near(p, at); });
      if (is_new) places.push_back(at);
    }
    if (places.size() < 3) return;
    for (const auto& [name, at] : joints_) {
      if (is_near(line_.at(line_.nearest(at)), at)) continue;
      throw Refusal{fmt::format("it has joints at {} places and {} is not on its line: it is no beam along that line",
                                places.size(), name)};
    }
  }

 private:
  bool is_near(Vec2 a, Vec2 b) const { return norm(a - b) <= same_within * line_.length(); }
  Vec2 local(Vec2 world) const { return turned_back(world - pose_.origin); }
  Vec2 turned_back(Vec2 world) const { return world * conj(pose_.direction()); }

  static void expect_determined(const std::string& name, const Reaction& reaction) {
    if (!reaction.determined) {
      throw Refusal{fmt::format("statics does not determine the force of {}: a joint more than needed", name)};
    }
  }

  /// Places within rounding of each other are one.
  double station(double s) {
    for (const double known : line_.stations()) {
      if (std::abs(known - s) <= same_within * line_.length()) return known;
    }
    for (const LinkAction& action : out_.actions) {
      if (std::abs(action.s - s) <= same_within * line_.length()) return action.s;
    }
    return s;
  }

  void act(const std::string& name, Vec2 at, Vec2 force, double moment) {
    if (force == Vec2{} && moment == 0.0) return;
    const double s = station(line_.nearest(at));
    const Vec2 arm = at - line_.at(s);
    const bool is_on_line = norm(arm) <= same_within * line_.length();
    out_.actions.push_back({name, s, force, moment + cross(arm, force), is_on_line ? 0.0 : norm(arm)});
  }

  void add_weight() {
    const Body& body = scene_.bodies[static_cast<std::size_t>(out_.frame)];
    if (body.mass == 0.0 || scene_.gravity == Vec2{}) return;
    const Vec2 weight = turned_back(body.mass * scene_.gravity);
    if (is_near(line_.centroid(), body.center))
      add_along("weight", 0.0, line_.length(), (1 / line_.length()) * weight);
    else
      act("weight", body.center, weight, 0.0);
  }

  void add_along(const std::string& name, double from, double to, Vec2 per_length) {
    out_.line_actions.push_back({name, from, to, per_length, {}});
  }

  void add_force(const Force& force) {
    Vec2 vector = turned_back(force.vector);
    if (force.follows >= 0) vector = vector * poses_[static_cast<std::size_t>(force.follows)].direction();
    if (!force.to) return act("force " + force.name, scene_.local(force.at), vector, 0.0);
    const std::string name = "distributed load " + force.name;
    const Vec2 a = scene_.local(force.at), b = scene_.local(*force.to);
    const double s_a = station(line_.nearest(a)), s_b = station(line_.nearest(b));
    const bool is_on_line = is_near(line_.at(s_a), a) && is_near(line_.at(s_b), b) &&
                            std::abs(std::abs(s_b - s_a) - norm(b - a)) <= same_within * line_.length();
    if (!is_on_line) throw Refusal{fmt::format("the line of {} is not part of its own", name)};
    add_along(name, std::min(s_a, s_b), std::max(s_a, s_b), vector);
  }

  /// A moment between the link and another body enters at the one joint that they share.
  void couple(const std::string& name, int other, double moment, const std::string& advice) {
    std::vector<Vec2> places;
    for (const Joint& joint : scene_.joints) {
      const bool on_b = joint.b.body == out_.frame;
      if ((on_b ? joint.a.body : joint.b.body) != other || (!on_b && joint.a.body != out_.frame)) continue;
      places.push_back(scene_.local(on_b ? joint.b : joint.a));
    }
    if (places.size() != 1) {
      throw Refusal{fmt::format("where the moment of {} enters it is not known: it shares {} with \"{}\"{}", name,
                                places.empty() ? "no joint" : "several joints",
                                scene_.bodies[static_cast<std::size_t>(other)].name, advice)};
    }
    act(name, places.front(), {}, moment);
  }

  /// An effort on a measure, positive where it tends to increase it.
  void add_efforts(const std::string& name, const Measure& on, double effort) {
    if (effort == 0.0) return;
    for (const UnitEffort& unit : unit_efforts(scene_, on, poses_)) {
      for (const bool on_b : {false, true}) {
        if ((on_b ? unit.body_b : unit.body_a) != out_.frame) continue;
        const double size = on_b ? effort : -effort;
        if (unit.moment != 0.0)
          couple(name, on_b ? unit.body_a : unit.body_b, size * unit.moment, "");
        else
          act(name, local(on_b ? unit.b : unit.a), size * turned_back(unit.force), 0.0);
      }
    }
  }

  /// The force of teeth or of a cam, where it acts.
  void add_contact(const std::string& name, const ContactLoad<double>& contact, const Stop& stop,
                   const Reaction& reaction) {
    if (out_.frame != contact.body_a && out_.frame != contact.body_b) return;
    expect_determined(name, reaction);
    const double effort = effort_of(stop, reaction);
    const Vec2 force = effort * contact.force + std::abs(effort) * contact.separating;
    act(name, local(contact.at), (out_.frame == contact.body_b ? 1.0 : -1.0) * turned_back(force), 0.0);
  }

  void add_stop(const std::string& name, const Stop& stop, const Reaction& reaction) {
    if (const auto contact = contact_load(BodyForces(scene_, poses_), reaction.stop)) {
      return add_contact(name, *contact, stop, reaction);
    }
    const std::vector<UnitEffort> units = unit_efforts(scene_, stop.on, poses_);
    const bool touches = std::any_of(units.begin(), units.end(), [&](const UnitEffort& unit) {
      return unit.body_a == out_.frame || unit.body_b == out_.frame;
    });
    if (!touches) return;
    expect_determined(name, reaction);
    const bool is_pin = stop.on.kind == Measure::Kind::distance && stop.max <= 0.0;
    if (is_pin) {
      const double sign = stop.on.b.body == out_.frame ? 1.0 : -1.0;
      return act(name, local(reaction.at), sign * turned_back(reaction.force), 0.0);
    }
    if (!stop.on.is_angle()) return add_efforts(name, stop.on, -reaction.axial);
    // The reaction is that on the first term.
    add_efforts(name, stop.on, reaction.moment / units.front().moment);
  }

  const Scene& scene_;
  const std::vector<BodyPose<double>>& poses_;
  const BodyPose<double>& pose_;
  const Line& line_;
  LinkLoads& out_;
  std::vector<std::pair<std::string, Vec2>> joints_;
};

/// The places at which a diagram may have a kink or a jump.
std::vector<double> breaks_of(const Line& line, const LinkLoads& loads) {
  std::vector<double> out = line.stations();
  for (const LinkAction& action : loads.actions) out.push_back(action.s);
  for (const LineAction& action : loads.line_actions) out.insert(out.end(), {action.from, action.to});
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

double largest_force(const LinkLoads& loads) {
  double largest = 0.0;
  for (const LinkAction& action : loads.actions) {
    largest = std::max({largest, norm(action.force), std::abs(action.moment) / loads.length});
  }
  for (const LineAction& action : loads.line_actions) {
    const Vec2 last = action.per_length + (action.to - action.from) * action.slope;
    largest = std::max(largest, std::max(norm(action.per_length), norm(last)) * (action.to - action.from));
  }
  return largest;
}

double shear_over(const LinkPiece& piece, double x) {
  return piece.shear + x * (piece.shear_slope + 0.5 * x * piece.shear_bend);
}

/// Integral of shear_over.
double moment_over(const LinkPiece& piece, double x) {
  return piece.moment + x * (piece.shear + x * (piece.shear_slope / 2 + x * piece.shear_bend / 6));
}

/// Sums what acts along the line.
void find_pieces(const Line& line, LinkLoads& loads) {
  const std::vector<double> breaks = breaks_of(line, loads);
  Vec2 before{};        // the sum of all forces so far
  double moment = 0.0;  // and their moment about the present place
  for (std::size_t k = 0; k < breaks.size(); ++k) {
    const double s = breaks[k];
    for (const LinkAction& action : loads.actions) {
      if (action.s != s) continue;
      before += action.force;
      moment += action.moment;
    }
    if (k + 1 == breaks.size()) break;
    const double step = breaks[k + 1] - s;
    const Vec2 along = line.along(line.stretch_at(s)), left = quarter_turn(along);
    Vec2 even{}, slope{};
    for (const LineAction& action : loads.line_actions) {
      if (!(action.from <= s && s < action.to)) continue;
      even += action.per_length + (s - action.from) * action.slope;
      slope += action.slope;
    }
    LinkPiece piece{.from = s, .to = breaks[k + 1], .at = line.at(s), .along = along};
    piece.normal = -dot(before, along);
    piece.shear = dot(before, left);
    piece.moment = -moment;
    piece.normal_slope = -dot(even, along);
    piece.shear_slope = dot(even, left);
    piece.normal_bend = -dot(slope, along);
    piece.shear_bend = dot(slope, left);
    loads.pieces.push_back(piece);
    moment -= moment_over(piece, step) - piece.moment;
    before += step * (even + (0.5 * step) * slope);
  }
  const double largest = largest_force(loads);
  loads.imbalance = largest > 0.0 ? std::max(norm(before), std::abs(moment) / loads.length) / largest : 0.0;
}

double turn_over(const LinkPiece& piece, double stiffness, double x) {
  return x * (piece.moment + x * (piece.shear / 2 + x * (piece.shear_slope / 6 + x * piece.shear_bend / 24))) /
         stiffness;
}

/// Integral of turn_over.
double rise_over(const LinkPiece& piece, double stiffness, double x) {
  return x * x *
         (piece.moment / 2 + x * (piece.shear / 6 + x * (piece.shear_slope / 24 + x * piece.shear_bend / 120))) /
         stiffness;
}

/// Integrates the curvature, first with the first end clamped, and then turns the line so that its ends stay on the
/// line through both.
void find_deflection(const Line& line, double stiffness, LinkLoads& loads) {
  double turn = 0.0;
  Vec2 moved{};
  for (LinkPiece& piece : loads.pieces) {
    piece.turn = turn;
    piece.deflection = moved;
    const double step = piece.to - piece.from;
    moved += (turn * step + rise_over(piece, stiffness, step)) * quarter_turn(piece.along);
    turn += turn_over(piece, stiffness, step);
  }
  const Vec2 chord = line.last() - line.first();
  const double span = norm(chord);
  const double back = span > same_within * loads.length ? -dot(moved, quarter_turn((1 / span) * chord)) / span : 0.0;
  for (LinkPiece& piece : loads.pieces) {
    piece.turn += back;
    piece.deflection += back * quarter_turn(piece.at - line.first());
  }
  loads.turn_first = back;
  loads.turn_last = turn + back;
}

double stiffness_of(const CrossSection& section) { return section.modulus * section.second_moment; }

void set_stresses(const CrossSection& section, LinkState& state) {
  state.stress_left = state.normal / section.area - state.moment * section.to_left() / section.second_moment;
  state.stress_right = state.normal / section.area + state.moment * section.to_right() / section.second_moment;
}

void enlarge(LargestOnLink& largest, double value, double s) {
  if (std::abs(value) > std::abs(largest.value)) largest = {value, s};
}

/// Where f, monotonic between ascending bounds, changes its sign.
template <class F>
std::vector<double> crossings(const std::vector<double>& bounds, F f) {
  std::vector<double> out;
  for (std::size_t k = 0; k + 1 < bounds.size(); ++k) {
    solvers::Bracket bracket{bounds[k], bounds[k + 1]};
    const bool falls = f(bracket.from) > 0.0;
    if (falls == (f(bracket.to) > 0.0)) continue;
    solvers::bisect(bracket, [&](double x) { return (f(x) > 0.0) == falls; });
    out.push_back(bracket.from);
  }
  return out;
}

/// Where the line of a piece does not turn: its displacement may be largest there. Its slope is the curvature, whose
/// own slope is the shear force, quadratic: each is monotonic between the places where the next one vanishes.
std::vector<double> level_places(const LinkPiece& piece, double stiffness) {
  const double end = piece.to - piece.from;
  const auto with_ends = [&](std::vector<double> inside) {
    inside.insert(inside.begin(), 0.0);
    inside.push_back(end);
    return inside;
  };
  const std::vector<double> level_moment =
      with_ends(roots_within(piece.shear, piece.shear_slope, piece.shear_bend / 2, end));
  const std::vector<double> straight =
      with_ends(crossings(level_moment, [&](double x) { return moment_over(piece, x); }));
  return crossings(straight, [&](double x) { return piece.turn + turn_over(piece, stiffness, x); });
}

void take_largest(LinkLoads& loads, const LinkState& state, double s) {
  enlarge(loads.normal, state.normal, s);
  enlarge(loads.shear, state.shear, s);
  enlarge(loads.moment, state.moment, s);
  for (const double stress : {state.stress_left, state.stress_right}) {
    if (stress > loads.tension.value) loads.tension = {stress, s};
    if (stress < loads.compression.value) loads.compression = {stress, s};
  }
  enlarge(loads.deflection, norm(state.deflection), s);
}

void find_largest(LinkLoads& loads) {
  const CrossSection& section = loads.section;
  const auto look_at = [&](const LinkPiece& piece, double x) {
    take_largest(loads, loads.at(piece, piece.from + x), piece.from + x);
  };
  for (const LinkPiece& piece : loads.pieces) {
    const double end = piece.to - piece.from;
    look_at(piece, 0.0);
    look_at(piece, end);
    for (const double x : roots_within(piece.shear, piece.shear_slope, piece.shear_bend / 2, end)) look_at(piece, x);
    for (const double x : roots_within(piece.shear_slope, piece.shear_bend, 0.0, end)) look_at(piece, x);
    for (const double x : roots_within(piece.normal_slope, piece.normal_bend, 0.0, end)) look_at(piece, x);
    for (const double fibre : {-section.to_left(), section.to_right()}) {
      const double by_shear = fibre / section.second_moment;
      const double slope = piece.normal_slope / section.area + piece.shear * by_shear;
      const double bend = piece.normal_bend / section.area + piece.shear_slope * by_shear;
      for (const double x : roots_within(slope, bend, piece.shear_bend / 2 * by_shear, end)) look_at(piece, x);
    }
    for (const double x : level_places(piece, stiffness_of(section))) look_at(piece, x);
  }
}

/// Euler's load of the part between the two forces, over the compression.
std::optional<double> buckling_factor(const Scene& scene, const LinkLoads& loads) {
  for (const Joint& joint : scene.joints) {
    const bool is_on_link = joint.a.body == loads.frame || joint.b.body == loads.frame;
    if (is_on_link && joint.keeps_angle()) return std::nullopt;
  }
  const double force = loads.normal.value;
  const double none = part_rounding * std::abs(force);
  if (force >= 0.0 || !loads.line_actions.empty()) return std::nullopt;
  if (std::abs(loads.shear.value) > none || std::abs(loads.moment.value) > none * loads.length) return std::nullopt;
  double first = loads.length, last = 0.0, pressed = 0.0;
  for (const LinkPiece& piece : loads.pieces) {
    if (std::abs(piece.normal) <= none) continue;
    if (std::abs(piece.normal - force) > none) return std::nullopt;
    first = std::min(first, piece.from);
    last = std::max(last, piece.to);
    pressed += piece.to - piece.from;
  }
  if (std::abs(last - first - pressed) > same_within * loads.length) return std::nullopt;
  return std::numbers::pi * std::numbers::pi * stiffness_of(loads.section) / (pressed * pressed) / -force;
}

LinkLoads rigid_link(const Scene& scene, const std::vector<BodyPose<double>>& poses, const ForcesInMotion& forces,
                     int body) {
  const Body& link = scene.bodies[static_cast<std::size_t>(body)];
  LinkLoads out;
  out.name = link.name;
  out.frame = body;
  out.section = link.section.value();
  const Line line(link);
  out.length = line.length();
  Actions actions(scene, poses, line, out);
  actions.add_mass(forces.accelerations.empty() ? nullptr : &forces.accelerations[static_cast<std::size_t>(body)]);
  actions.add_loads();
  actions.add_elements(forces.element_forces);
  actions.add_drives(forces.efforts);
  for (const Reaction& reaction : forces.reactions) actions.add_reaction(reaction);
  actions.expect_joints_on_line();
  find_pieces(line, out);
  if (forces.balanced && !(out.imbalance <= part_rounding)) {
    throw Refusal{
        fmt::format("what acts on it does not balance along its line, by {:.1g} of the largest force", out.imbalance)};
  }
  find_deflection(line, stiffness_of(out.section), out);
  find_largest(out);
  out.buckling_factor = buckling_factor(scene, out);
  return out;
}

/// Integrates by the three points of Gauss.
template <class F>
auto integral(double from, double to, F f) {
  decltype(f(from)) sum{};
  for (std::size_t g = 0; g < beam_element::gauss_place.size(); ++g) {
    const double x = from + (to - from) * beam_element::gauss_place[g];
    sum += ((to - from) * beam_element::gauss_weight[g]) * f(x);
  }
  return sum;
}

/// One element of a flexible link, of length h and mass m, with the turn of its nodes and what its first pin carries.
/// The force across the line at a place x of 0 .. 1, on what is behind it, is
///   F(x) = F(0) + m (x g - J(x)),  J(x) = int_0^x a = x a(0) + h int_0^x (x - y) t(y) (i phi'' - phi'^2) dy,
/// with the accelerations a of the line, r(x) = r(0) + h int_0^x t, and its direction t = d exp(i phi).
class BentElement {
 public:
  BentElement(const Scene& scene, const std::vector<BodyPose<double>>& poses,
              const std::vector<BodyAcceleration>& accelerations, const FlexibleLink& link, std::size_t element) {
    // What rests has none.
    const auto acceleration = [&](std::size_t body) {
      return accelerations.empty() ? BodyAcceleration{} : accelerations[body];
    };
    for (std::size_t k = 0; k < turn_.size(); ++k) {
      const auto body = static_cast<std::size_t>(link.bodies[3 * element + k]);
      turn_[k] = poses[body].angle;
      rate_[k] = acceleration(body).rate;
      turning_[k] = acceleration(body).turning;
    }
    // The second body of the element belongs to it alone: its points are where it begins and where it ends.
    const auto second = static_cast<std::size_t>(link.bodies[3 * element + 1]);
    const Body& body = scene.bodies[second];
    const Vec2 along = body.points.back().at - body.points.front().at;
    length_ = norm(along) / beam_element::weight[1];
    direction_ = (1 / norm(along)) * along;
    mass_ = body.mass / beam_element::weight[1];
    gravity_ = scene.gravity;
    const Vec2 first_node = (length_ * beam_element::weight[0]) * (direction_ * unit(turn_[0]));
    begins_ = poses[second].world(body.points.front().at) - first_node;
    const BodyAcceleration of_second = acceleration(second);
    of_first_node_ = of_second.of_origin +
                     swung(of_second.turning, of_second.rate) * (body.points.front().at * unit(poses[second].angle));
    of_begin_ = of_first_node_ - swung(turning_[0], rate_[0]) * first_node;
  }

  double length() const { return length_; }
  /// What the first pin carries has the weight and the inertia of the first node in it, whose centre of mass is there.
  void set_force(Vec2 of_first_pin) {
    before_ = of_first_pin - (mass_ * beam_element::weight[0]) * (gravity_ - of_first_node_);
  }

  LinkSample at(double x) const {
    LinkSample out;
    out.state.turn = by_nodes(turn_, x);
    out.along = tangent(x);
    out.state.normal = -dot(force(x), out.along);
    out.state.shear = shear(x);
    out.state.at = begins_ + length_ * integral(0.0, x, [&](double y) { return tangent(y); });
    return out;
  }
  /// Gives the growth of the moment from one place to another: dM/ds = V.
  double growth(double from, double to) const {
    return length_ * integral(from, to, [&](double y) { return shear(y); });
  }

 private:
  using AtNodes = std::array<double, beam_element::nodes>;

  static double by_nodes(const AtNodes& values, double x) {
    double sum = 0.0;
    for (int k = 0; k < beam_element::nodes; ++k) {
      sum += beam_element::lagrange(k, x) * values[static_cast<std::size_t>(k)];
    }
    return sum;
  }
  /// The factor of a vector that turns, of which its second derivative by time is the product.
  static Vec2 swung(double turning, double rate) { return {-rate * rate, turning}; }

  Vec2 tangent(double x) const { return direction_ * unit(by_nodes(turn_, x)); }
  Vec2 force(double x) const {
    const Vec2 within = integral(
        0.0, x, [&](double y) { return (x - y) * (tangent(y) * swung(by_nodes(turning_, y), by_nodes(rate_, y))); });
    return before_ + mass_ * (x * (gravity_ - of_begin_) - length_ * within);
  }
  double shear(double x) const { return dot(force(x), quarter_turn(tangent(x))); }

  AtNodes turn_{}, rate_{}, turning_{};
  double length_ = 0.0, mass_ = 0.0;
  Vec2 direction_{}, gravity_{}, begins_{}, before_{};
  Vec2 of_begin_{}, of_first_node_{};  // accelerations
};

/// What the pin between two neighbours of a chain carries, on the second.
Vec2 force_between(const Scene& scene, const std::vector<Reaction>& reactions, int a, int b) {
  const auto joint = std::find_if(scene.joints.begin(), scene.joints.end(),
                                  [&](const Joint& one) { return one.a.body == a && one.b.body == b; });
  const auto index = static_cast<int>(joint - scene.joints.begin());
  const auto found =
      std::find_if(reactions.begin(), reactions.end(), [&](const Reaction& one) { return one.joint == index; });
  if (!found->determined) throw Refusal{"statics does not determine the forces in it: a joint more than needed"};
  return found->force;
}

LinkLoads flexible_link(const Scene& scene, const std::vector<BodyPose<double>>& poses, const ForcesInMotion& forces,
                        const FlexibleLink& link) {
  LinkLoads out;
  out.name = link.name;
  out.flexible = true;
  out.section = link.section;
  const auto& gauss = beam_element::gauss_place;
  for (std::size_t e = 0; 3 * e < link.springs.size(); ++e) {
    BentElement element(scene, poses, forces.accelerations, link, e);
    element.set_force(force_between(scene, forces.reactions, link.bodies[3 * e], link.bodies[3 * e + 1]));
    std::array<double, gauss.size()> moment{};
    for (std::size_t g = 0; g < gauss.size(); ++g) {
      const auto spring = static_cast<std::size_t>(link.springs[3 * e + g]);
      moment[g] = forces.element_forces[spring] / beam_element::gauss_weight[g];
    }
    const auto add = [&](double x, double bending) {
      LinkSample sample = element.at(x);
      sample.s = out.length + x * element.length();
      sample.state.moment = bending;
      set_stresses(out.section, sample.state);
      take_largest(out, sample.state, sample.s);
      out.samples.push_back(sample);
    };
    add(0.0, moment.front() - element.growth(0.0, gauss.front()));
    for (std::size_t g = 0; g < gauss.size(); ++g) add(gauss[g], moment[g]);
    add(1.0, moment.back() + element.growth(gauss.back(), 1.0));
    out.length += element.length();
  }
  return out;
}

template <class Find>
void add_or_refuse(std::vector<LinkLoads>& out, const std::string& name, Find find) {
  try {
    out.push_back(find());
  } catch (const Refusal& refusal) {
    LinkLoads& refused = out.emplace_back();
    refused.name = name;
    refused.why = refusal.why;
  }
}

}  // namespace

LinkState LinkLoads::at(const LinkPiece& piece, double s) const {
  const double x = s - piece.from, stiffness = stiffness_of(section);
  LinkState out;
  out.normal = piece.normal + x * (piece.normal_slope + 0.5 * x * piece.normal_bend);
  out.shear = shear_over(piece, x);
  out.moment = moment_over(piece, x);
  set_stresses(section, out);
  out.at = piece.at + x * piece.along;
  out.turn = piece.turn + turn_over(piece, stiffness, x);
  out.deflection = piece.deflection + (piece.turn * x + rise_over(piece, stiffness, x)) * quarter_turn(piece.along);
  return out;
}

std::optional<LinkState> LinkLoads::at_nearest(Vec2 point) const {
  constexpr double nearer = 1e-9;  // of the length: places of two pieces that meet are the end of the first
  std::optional<LinkState> out;
  double least = 0.0;
  for (const LinkPiece& piece : pieces) {
    const double x = std::clamp(dot(point - piece.at, piece.along), 0.0, piece.to - piece.from);
    const double distance = norm(point - (piece.at + x * piece.along));
    if (out && distance > least - nearer * length) continue;
    least = distance;
    out = at(piece, piece.from + x);
  }
  return out;
}

std::vector<LinkSample> LinkLoads::sampled(int parts) const {
  std::vector<LinkSample> out = samples;
  for (const LinkPiece& piece : pieces) {
    for (int k = 0; k <= parts; ++k) {
      const double s = k == parts ? piece.to : piece.from + k * (piece.to - piece.from) / parts;
      out.push_back({s, piece.along, at(piece, s)});
    }
  }
  return out;
}

bool has_links(const Scene& scene) {
  return !scene.flexible_links.empty() || std::any_of(scene.bodies.begin(), scene.bodies.end(),
                                                      [](const Body& body) { return body.section.has_value(); });
}

std::vector<LinkLoads> link_loads(const Scene& scene, const std::vector<BodyPose<double>>& poses, const Check& check) {
  ForcesInMotion at_rest{.element_forces = {}, .reactions = check.reactions, .efforts = {}, .accelerations = {}};
  for (const ElementForce& force : check.element_forces) at_rest.element_forces.push_back(force.value);
  return link_loads(scene, poses, at_rest);
}

std::vector<LinkLoads> link_loads(const Scene& scene, const std::vector<BodyPose<double>>& poses,
                                  const ForcesInMotion& forces) {
  std::vector<LinkLoads> out;
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    if (!scene.bodies[i].section) continue;
    add_or_refuse(out, scene.bodies[i].name, [&] { return rigid_link(scene, poses, forces, static_cast<int>(i)); });
  }
  for (const FlexibleLink& link : scene.flexible_links) {
    add_or_refuse(out, link.name, [&] { return flexible_link(scene, poses, forces, link); });
  }
  return out;
}

Equilibrium solve_or_hold(const StaticModel& model, const SolveOptions& options) {
  Equilibrium structure;
  if (model.mechanism().coordinates() > 0) {
    const Mobility mobility = analyse_mobility(model);
    expect_closed(model, mobility);
    if (mobility.freedoms > 0) return solve(model, mobility.x, options);
    structure.x = mobility.x;
  }
  structure.reached = structure.x;
  structure.check = check(model, structure.x, options.check);
  structure.status = structure.check.is_equilibrium() ? Status::checked : Status::not_found;
  structure.why = structure.check.is_equilibrium() ? "nothing can move: a structure" : structure.check.objection;
  return structure;
}

}  // namespace poise
