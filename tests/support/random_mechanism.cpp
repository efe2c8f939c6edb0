#include "tests/support/random_mechanism.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "model/mechanism.hpp"
#include "model/parameters.hpp"
#include "solvers/linear_algebra.hpp"
#include "statics/model/curvature.hpp"
#include "tests/support/closure_rows.hpp"
#include "tests/support/elements.hpp"
#include "tests/support/vector_mechanics.hpp"

namespace poise::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Everything is drawn in units in which bodies and loads are of order one.
constexpr double least_singular_value = 0.1;   // of the closure Jacobian, redundant rows aside
constexpr double least_curvature = 0.1;        // of the reduced Hessian
constexpr double largest_sensitivity = 20.0;   // see PlantedMechanism
constexpr double largest_planted_load = 10.0;  // a planted one
constexpr double least_arm = 0.3;              // of two points that a joint or spring should tell apart
constexpr int tries = 200;
constexpr double infinity = std::numeric_limits<double>::infinity();

Vec2 random_vector(Random& random, double least, double most) {
  const Vec2 direction = unit(random.uniform(-M_PI, M_PI));
  return random.uniform(least, most) * direction;
}

// A scene and the pose in which its loops close.
struct Draft {
  Scene scene;
  int mobility = 0;  // of all bodies, the ones that the compiled model drops included
  int loops = 0;
  int redundant = 0;
};

// World place of a point, all bodies where the scene's start puts them (a draft gives both angle and origin of each).
Vec2 place(const Scene& scene, PointRef p) {
  return scene.start.position[p.body].value_or(Vec2{}) + scene.local(p) * unit(scene.start.angle[p.body].value_or(0.0));
}

// Coordinates of the start. A scene has no guess for a bar: the model takes it from the places of what the bar joins,
// which it does not know where a body hangs on bars alone.
std::vector<double> start_of(const Mechanism<double>& mechanism, const Scene& scene) {
  std::vector<double> q = mechanism.start();
  for (const Link& link : mechanism.layout().links) {
    if (link.body >= 0 || link.frame < 0 || link.frame >= mechanism.coordinates()) continue;
    const Joint& bar = scene.joints[link.joint];
    const Vec2 along = place(scene, bar.b) - place(scene, bar.a);
    q[link.frame] = std::atan2(along.y, along.x);
  }
  return q;
}

// Values of a mechanism in the pose of its draft as matrices, for the given constraint rows.
struct Pose {
  Pose(const Mechanism<double>& mechanism, const Scene& scene, const std::vector<int>& rows)
      : q(start_of(mechanism, scene)), point(mechanism, q, rows) {}

  std::vector<double> q;
  DensePoint<double> point;
};

// Orthonormal basis of the directions that the joints (the given rows) allow, and the singular values of the rows.
struct Motion {
  explicit Motion(const MatrixXd& jacobian, int redundant) {
    const Eigen::Index n = jacobian.cols();
    basis = MatrixXd::Identity(n, n);
    if (jacobian.rows() == 0) return;
    const Eigen::Index rank = jacobian.rows() - redundant;
    if (rank > n || n == 0) {
      least = 0.0;
      return;
    }
    const solvers::SingularValues svd = solvers::singular_value_decomposition(jacobian);
    basis = svd.right.rightCols(n - rank);
    if (rank > 0) least = svd.values[rank - 1];
    if (redundant > 0 && rank < svd.values.size()) most_redundant = svd.values[rank];
  }

  bool is_regular() const { return least > least_singular_value && most_redundant < 1e-12; }

  MatrixXd basis;
  double least = infinity;      // smallest singular value of independent rows
  double most_redundant = 0.0;  // largest one of redundant rows
};

// Grows the tree and closes its loops.
class Geometry {
 public:
  Geometry(Random& random, int loops, int mobility) : random_(random), loops_(loops), mobility_(mobility) {}

  std::optional<Draft> draw() {
    std::vector<Closing> closings = choose_closings();
    int open = mobility_;
    for (const Closing& c : closings) open -= c.mobility;
    if (open < 1 || open > 7) return std::nullopt;
    while (draft_.mobility < open) grow(open - draft_.mobility);
    for (const Closing& c : closings) {
      if (!close(c)) return std::nullopt;
    }
    return draft_;
  }

 private:
  struct Closing {
    void (Geometry::*add)();
    int loops;
    int mobility;  // what it adds
    int redundant = 0;
  };

  std::vector<Closing> choose_closings() {
    static const std::vector<Closing> zoo = {{&Geometry::add_dyad, 1, 0},
                                             {&Geometry::add_dyad, 1, 0},
                                             {&Geometry::add_sliding_dyad, 1, 0},
                                             {&Geometry::add_slotted_dyad, 1, 0},
                                             {&Geometry::add_slotted_dyad, 1, 0},
                                             {&Geometry::add_barred_dyad, 1, 0},
                                             {&Geometry::add_hung_body, 2, 0},
                                             {&Geometry::add_bar, 1, -1},
                                             {&Geometry::add_slot, 1, -1},
                                             {&Geometry::add_pin, 1, -2},
                                             {&Geometry::add_slide, 1, -2},
                                             {&Geometry::add_second_slide, 1, 0, 1},
                                             {&Geometry::add_parallel_cranks, 2, 1, 1}};
    std::vector<Closing> chosen;
    int left = loops_;
    while (left > 0) {
      const Closing& c = zoo[random_.index(zoo.size())];
      if (c.loops > left) continue;
      chosen.push_back(c);
      left -= c.loops;
    }
    return chosen;
  }

  // Adds a closing where it leaves the pose regular.
  bool close(const Closing& closing) {
    const Draft before = draft_;
    for (int k = 0; k < 20; ++k) {
      (this->*closing.add)();
      draft_.loops += closing.loops;
      draft_.redundant += closing.redundant;
      draft_.mobility += closing.mobility;
      if (is_regular()) return true;
      draft_ = before;
    }
    return false;
  }

  bool is_regular() const {
    const Mechanism<double> mechanism(draft_.scene);
    if (mechanism.closures() != draft_.loops) return false;
    const Pose at(mechanism, draft_.scene, closure_rows(mechanism));
    return Motion(at.point.jacobian, draft_.redundant).is_regular();
  }

  // --- bodies and points --------------------------------------------------------------------------------------------

  Scene& scene() { return draft_.scene; }
  Vec2 somewhere() { return {random_.uniform(-1.0, 1.0), random_.uniform(-1.0, 1.0)}; }
  Vec2 direction() { return unit(random_.uniform(-M_PI, M_PI)); }
  // A place at a good distance.
  Vec2 away_from(Vec2 p) { return p + random_vector(random_, least_arm, 1.2); }

  double angle(int body) const { return draft_.scene.start.angle[body].value_or(0.0); }
  Vec2 origin(int body) const { return draft_.scene.start.position[body].value_or(Vec2{}); }

  int any_body() { return random_.index(scene().bodies.size()); }
  int moving_body() { return 1 + random_.index(scene().bodies.size() - 1); }

  std::pair<int, int> two_bodies() {
    const int a = any_body();
    int b = any_body();
    while (b == a) b = any_body();
    return {a, b};
  }

  // A body near a place: sometimes with its origin there, sometimes wound up by a turn.
  int new_body(Vec2 near) {
    const int body = scene().add_body(fmt::format("b{}", scene().bodies.size()));
    scene().start.position[body] = random_.chance(0.5) ? near : near + 0.3 * somewhere();
    const double turns = random_.chance(0.1) ? 2 * M_PI * (1 - 2 * random_.index(2)) : 0.0;
    scene().start.angle[body] = random_.uniform(-3.0, 3.0) + turns;
    return body;
  }

  PointRef point(int body, Vec2 place) {
    const Vec2 local = (place - origin(body)) * conj(unit(angle(body)));
    return scene().add_point(body, fmt::format("p{}", scene().bodies[body].points.size()), local);
  }

  // Joins place_a of a to place_b of b, as they stand. The line of a slide or slot runs through both places, or along
  // `line` where they coincide.
  void join(Joint::Kind kind, int a, Vec2 place_a, int b, Vec2 place_b, Vec2 line = {1.0, 0.0}) {
    if (random_.chance(0.5)) {
      std::swap(a, b);
      std::swap(place_a, place_b);
    }
    Joint joint;
    joint.kind = kind;
    joint.name = fmt::format("j{}", scene().joints.size());
    joint.a = point(a, place_a);
    joint.b = point(b, place_b);
    joint.axis = line * conj(unit(angle(a)));
    joint.angle = angle(b) - angle(a);
    joint.length = norm(place_b - place_a);
    const int index = scene().add_joint(joint);
    if (joint.has_travel()) scene().start.travel[index] = dot(line, place_b - place_a);
  }

  void pin(int a, int b, Vec2 place) { join(Joint::Kind::pin, a, place, b, place); }
  void weld(int a, int b, Vec2 place) { join(Joint::Kind::weld, a, place, b, place); }
  void bar(int a, Vec2 place_a, int b, Vec2 place_b) { join(Joint::Kind::bar, a, place_a, b, place_b); }
  // A slide or slot: from `place` in a to some place on a line through it, in b.
  void run(Joint::Kind kind, int a, Vec2 place, int b) {
    const Vec2 line = direction();
    join(kind, a, place, b, place + random_.uniform(-0.8, 0.8) * line, line);
  }

  // --- the tree -----------------------------------------------------------------------------------------------------

  // One body more, with at most `left` freedoms.
  void grow(int left) {
    const int parent = any_body();
    const Vec2 place = somewhere();
    const double kind = random_.uniform(0.0, 1.0);
    const int body = new_body(place);
    if (kind < 0.1) {
      weld(parent, body, place);
    } else if (kind < 0.35) {
      run(Joint::Kind::slide, parent, place, body);
      draft_.mobility += 1;
    } else if (kind < 0.45 && left >= 2) {
      run(Joint::Kind::pin_in_slot, parent, place, body);
      draft_.mobility += 2;
    } else if (kind < 0.55 && left >= 2) {
      bar(parent, away_from(place), body, place);
      draft_.mobility += 2;
    } else if (kind < 0.6 && left >= 3) {
      draft_.mobility += 3;  // held by springs and loads alone
    } else {
      pin(parent, body, place);
      draft_.mobility += 1;
    }
  }

  // --- closings -----------------------------------------------------------------------------------------------------

  void add_dyad() {
    const auto [a, b] = two_bodies();
    const Vec2 knee = somewhere();
    const Vec2 place_a = away_from(knee);
    const Vec2 place_b = away_from(knee);
    const int u = new_body(knee);
    const int v = new_body(place_b);
    pin(a, u, place_a);
    pin(u, v, knee);
    pin(v, b, place_b);
  }

  void add_sliding_dyad() {
    const auto [a, b] = two_bodies();
    const Vec2 place_a = somewhere();
    const Vec2 place_b = away_from(place_a);
    const int u = new_body(place_a);
    const int v = new_body(place_b);
    pin(a, u, place_a);
    pin(b, v, place_b);
    run(Joint::Kind::slide, u, somewhere(), v);
  }

  void add_slotted_dyad() {
    const auto [a, b] = two_bodies();
    const Vec2 place_a = somewhere();
    const int u = new_body(place_a);
    pin(a, u, place_a);
    run(Joint::Kind::pin_in_slot, u, away_from(place_a), b);
  }

  void add_barred_dyad() {
    const auto [a, b] = two_bodies();
    const Vec2 place_a = somewhere();
    const Vec2 end = away_from(place_a);
    const int u = new_body(place_a);
    pin(a, u, place_a);
    bar(u, end, b, away_from(end));
  }

  // A body held by three bars and nothing else.
  void add_hung_body() {
    const Vec2 place = somewhere();
    const int holder[] = {any_body(), any_body(), any_body()};
    const int u = new_body(place);
    for (const int h : holder) {
      const Vec2 end = place + 0.7 * somewhere();
      bar(u, end, h, away_from(end));
    }
  }

  void add_bar() {
    const auto [a, b] = two_bodies();
    const Vec2 place = somewhere();
    bar(a, place, b, away_from(place));
  }

  void add_slot() {
    const auto [a, b] = two_bodies();
    run(Joint::Kind::pin_in_slot, a, somewhere(), b);
  }

  void add_pin() {
    const auto [a, b] = two_bodies();
    pin(a, b, somewhere());
  }

  void add_slide() {
    const auto [a, b] = two_bodies();
    run(Joint::Kind::slide, a, somewhere(), b);
  }

  // A second slide beside one that is there, on a parallel line.
  void add_second_slide() {
    std::vector<Joint> slides;
    for (const Joint& joint : scene().joints) {
      if (joint.kind == Joint::Kind::slide) slides.push_back(joint);
    }
    if (slides.empty()) return;
    const Joint& first = slides[random_.index(slides.size())];
    const Vec2 place = somewhere();
    const Vec2 line = first.direction() * unit(angle(first.a.body));
    join(Joint::Kind::slide, first.a.body, place, first.b.body, place + random_.uniform(-0.8, 0.8) * line, line);
  }

  // A body on three parallel cranks of equal length.
  void add_parallel_cranks() {
    const int a = any_body();
    const Vec2 crank = random_vector(random_, 2 * least_arm, 1.2);
    const int coupler = new_body(somewhere());
    for (int k = 0; k < 3; ++k) {
      const Vec2 place = somewhere();
      const int u = new_body(place);
      pin(a, u, place);
      pin(u, coupler, place + crank);
    }
  }

  Random& random_;
  int loops_, mobility_;
  Draft draft_;
};

// Hangs springs, loads and stops on a drawn geometry and plants the equilibrium.
class Planting {
 public:
  Planting(Random& random, const Wish& wish, Draft draft) : random_(random), wish_(wish), draft_(std::move(draft)) {}

  std::optional<PlantedMechanism> plant() {
    add_masses();
    add_springs();
    add_dead_loads();
    if (wish_.followers) add_followers();
    if (wish_.stops) add_stops();
    if (wish_.couplings) {
      add_couplings();
      add_springs_upon_their_measures();
    }
    if (!choose_stops_that_press() || !balance() || !measure()) return std::nullopt;
    out_.loops = draft_.loops;
    out_.redundant = draft_.redundant;
    finish();
    return out_;
  }

 private:
  Scene& scene() { return draft_.scene; }
  int moving_body() { return 1 + random_.index(scene().bodies.size() - 1); }
  PointRef point(int body) {
    return scene().add_point(body, fmt::format("p{}", scene().bodies[body].points.size()),
                             {random_.uniform(-0.7, 0.7), random_.uniform(-0.7, 0.7)});
  }
  // Points of two bodies at a good distance.
  std::pair<PointRef, PointRef> two_points() {
    for (;;) {
      const int a = random_.index(scene().bodies.size());
      const int b = random_.index(scene().bodies.size());
      if (a == b) continue;
      const PointRef p = point(a);
      const PointRef q = point(b);
      if (norm(place(scene(), p) - place(scene(), q)) > least_arm) return {p, q};
    }
  }

  void add_masses() {
    if (random_.chance(0.7)) scene().gravity = unit(random_.chance(0.7) ? -M_PI / 2 : random_.uniform(-M_PI, M_PI));
    for (std::size_t i = 1; i < scene().bodies.size(); ++i) {
      if (random_.chance(0.4)) continue;
      Body& body = scene().bodies[i];
      body.mass = random_.uniform(0.1, 1.0);
      body.center = {random_.uniform(-0.5, 0.5), random_.uniform(-0.5, 0.5)};
      body.inertia = random_.chance(0.5) ? random_.uniform(0.01, 0.1) : 0.0;
    }
  }

  void add_springs() {
    const int line_springs = 1 + random_.index(3);
    for (int k = 0; k < line_springs; ++k) {
      const std::pair<PointRef, PointRef> ends = two_points();
      const double stiffness = random_.uniform(0.5, 5.0);
      // Far enough from its present length that a disturbed start does not change who is slack.
      const double stretch = random_.chance(0.5) ? random_.uniform(0.4, 0.7) : random_.uniform(1.3, 1.6);
      const double free_length = stretch * norm(place(scene(), ends.second) - place(scene(), ends.first));
      const auto acts = static_cast<LinearSpring::Acts>(random_.index(3));
      scene().elements.push_back(
          line_spring(fmt::format("s{}", k), ends.first, ends.second, stiffness, free_length, acts));
      if (wish_.other_laws) scene().elements.back().law = other_law(stiffness, free_length / stretch, free_length);
    }
    const int torsion_springs = random_.index(3);
    for (int k = 0; k < torsion_springs; ++k) {
      const int b = moving_body();
      const int a = random_.index(b);
      const double stiffness = random_.uniform(0.2, 2.0);
      const double free_angle = angle_between(a, b) + random_.uniform(-1.5, 1.5);
      scene().elements.push_back(torsion_spring(fmt::format("t{}", k), a, b, stiffness, free_angle));
      if (wish_.other_laws) scene().elements.back().law = other_law(stiffness, angle_between(a, b), free_angle);
    }
  }

  // A law of a spring whose measure is `now` and whose force is about stiffness (now - free): no disturbed start
  // changes the piece of a curve, nor the side of a stop. A strut has no stop here.
  Law other_law(double stiffness, double now, double free) {
    const double size = std::abs(now - free);
    switch (random_.index(4)) {
      case 0: {
        std::vector<double> x{now - random_.uniform(1.2, 1.5) * size}, force{random_.uniform(-1.0, 0.0) * stiffness};
        for (int k = 0; k < 4; ++k) {
          x.push_back(x.back() + random_.uniform(0.5, 1.0) * size);
          force.push_back(force.back() + random_.uniform(-0.2, 1.0) * stiffness * size);
        }
        // A point may be at the present value, which belongs to two pieces then.
        const bool at_point = random_.chance(0.3);
        if (at_point) x[2] = std::clamp(now, x[1] + 0.1 * size, x[3] - 0.1 * size);
        CurveSpring curve(std::move(x), std::move(force), true);
        curve.scale = random_.uniform(0.5, 1.5);
        curve.shift = at_point ? 0.0 : random_.uniform(-0.1, 0.1) * size;
        return curve;
      }
      case 1: {
        const double stroke = random_.uniform(1.0, 2.0) * size;
        return GasStrut{.preload = stiffness * size,
                        .length = now + random_.uniform(0.1, 0.9) * stroke,
                        .stroke = stroke,
                        .ratio = random_.uniform(1.2, 2.0),
                        .exponent = random_.chance(0.3) ? 1.0 : random_.uniform(0.9, 1.5)};
      }
      case 2:
        return PreloadedSpring{stiffness, stiffness * random_.uniform(-1.0, 1.0) * size, free};
      default:
        return BumpStop{stiffness * size, free, size, random_.uniform(1.5, 3.0),
                        random_.chance(0.3)   ? BumpStop::Acts::both
                        : random_.chance(0.5) ? BumpStop::Acts::tension
                                              : BumpStop::Acts::compression};
    }
  }

  double angle_between(int a, int b) {
    return scene().start.angle[b].value_or(0.0) - scene().start.angle[a].value_or(0.0);
  }

  void add_dead_loads() {
    const int forces = random_.index(3);
    for (int k = 0; k < forces; ++k) {
      Force force;
      force.name = fmt::format("f{}", k);
      force.at = point(moving_body());
      force.vector = random_vector(random_, 0.2, 1.0);
      scene().forces.push_back(force);
    }
    if (random_.chance(0.3)) scene().torques.push_back({"m0", moving_body(), random_.uniform(-1.0, 1.0)});
  }

  void add_followers() {
    const int followers = 1 + random_.index(2);
    for (int k = 0; k < followers; ++k) {
      Force force;
      force.name = fmt::format("follower{}", k);
      force.at = point(moving_body());
      force.vector = random_vector(random_, 0.2, 1.0);
      force.follows = random_.chance(0.7) ? force.at.body : moving_body();
      scene().forces.push_back(force);
    }
  }

  void add_stops() {
    std::vector<int> runs;
    for (std::size_t j = 0; j < scene().joints.size(); ++j) {
      if (scene().joints[j].has_travel()) runs.push_back(static_cast<int>(j));
    }
    const int stops = 1 + random_.index(3);
    for (int k = 0; k < stops; ++k) {
      Stop stop;
      stop.name = fmt::format("stop{}", k);
      auto kind = static_cast<Measure::Kind>(random_.index(3));
      if (kind == Measure::Kind::travel && runs.empty()) kind = Measure::Kind::distance;
      if (kind == Measure::Kind::angle) {
        const int b = moving_body();
        stop.on = Measure::angle_between(random_.index(b), b);
      } else if (kind == Measure::Kind::distance) {
        const auto [a, b] = two_points();
        stop.on = Measure::distance_between(a, b);
      } else {
        stop.on = Measure::travel_of(runs[random_.index(runs.size())]);
      }
      scene().stops.push_back(with_limits(stop, -1.0, 1.0));
    }
  }

  // Until they are chosen limits only say which of them there are: two that differ, one, or one value.
  static Stop with_limits(Stop stop, double min, double max) {
    stop.min = min;
    stop.max = max;
    return stop;
  }

  Measure angle_of_some_body() {
    const int b = moving_body();
    return Measure::angle_between(random_.index(b), b);
  }

  // A measure that a coupling may have in its sum, or a cam as its follower.
  Measure some_measure() {
    switch (random_.index(4)) {
      case 0:
        return angle_of_some_body();
      case 1: {
        const auto [a, b] = two_points();
        return Measure::component_along(a, b, unit(random_.uniform(-M_PI, M_PI)));
      }
      case 2: {
        const auto [a, b] = two_points();
        return Measure::distance_between(a, b);
      }
      default:
        return random_.chance(0.5) ? Measure::x_of(point(moving_body())) : Measure::y_of(point(moving_body()));
    }
  }

  // Over three or four points, of which those between the ends may be pulleys: the rope bends round each so much that
  // it stays on it.
  std::optional<Measure> some_rope() {
    for (int k = 0; k < 20; ++k) {
      std::vector<RopeContact> over;
      const int points = 3 + random_.index(2);
      for (int c = 0; c < points; ++c) over.push_back({point(random_.index(scene().bodies.size()))});
      bool fits = true;
      const auto leg = [&](int c) { return place(scene(), over[c + 1].at) - place(scene(), over[c].at); };
      for (int c = 0; c + 1 < points; ++c) fits = fits && norm(leg(c)) > 1.5 * least_arm;
      for (int c = 1; c + 1 < points && fits; ++c) {
        const double bend = std::atan2(cross(leg(c - 1), leg(c)), dot(leg(c - 1), leg(c)));
        fits = std::abs(bend) > 0.5 && std::abs(bend) < 2.5;
        if (!wish_.pulleys || random_.chance(0.5)) continue;
        over[c].radius = random_.uniform(0.02, 0.1);
        over[c].turn = bend > 0 ? 1 : -1;
      }
      if (fits) return Measure::rope_over(over);
    }
    return std::nullopt;
  }

  std::shared_ptr<const Profile> some_profile() {
    if (random_.chance(0.5)) {
      const double top = random_.uniform(-1.0, 1.0), low = random_.uniform(-0.5, 0.5);
      return std::make_shared<const Profile>(
          Profile::spline({0.0, 0.2, 0.45, 0.7, 1.0}, {low, random_.uniform(-0.5, 0.5), top, 0.3, low}, true));
    }
    const std::string_view law = Profile::laws[1 + random_.index(Profile::laws.size() - 1)];
    const double rise = random_.uniform(0.3, 0.5);
    return std::make_shared<const Profile>(std::vector<Profile::Piece>{Profile::standard(law, 0.0, rise, 0.0, 1.0),
                                                                       Profile::standard(law, rise, 1.0, 1.0, 0.0)},
                                           true);
  }

  void add_couplings() {
    const int couplings = 1 + random_.index(2);
    for (int k = 0; k < couplings; ++k) {
      if (std::optional<Stop> coupling = some_coupling()) {
        coupling->name = fmt::format("{}{}", coupling->table, k);
        scene().stops.push_back(*std::move(coupling));
      }
    }
  }

  std::optional<Stop> some_coupling() {
    constexpr double held = 0.0;
    const double factor = random_.uniform(0.3, 1.5) * (1 - 2 * random_.index(2));
    Stop stop;
    switch (random_.index(5)) {
      case 0:
        stop.table = random_.chance(0.5) ? "gear" : "belt";
        stop.sense = factor > 0 ? 1.0 : -1.0;
        stop.on = Measure::sum_of({{1.0, angle_of_some_body()}, {factor, angle_of_some_body()}});
        return with_limits(stop, held, held);
      case 1: {
        std::vector<int> runs;
        for (std::size_t j = 0; j < scene().joints.size(); ++j) {
          if (scene().joints[j].has_travel()) runs.push_back(static_cast<int>(j));
        }
        if (runs.empty()) return std::nullopt;
        stop.table = "rack";
        stop.sense = -1.0;
        stop.on = Measure::sum_of(
            {{1.0, Measure::travel_of(runs[random_.index(runs.size())])}, {factor, angle_of_some_body()}});
        return with_limits(stop, held, held);
      }
      case 2:
        stop.table = "coupling";
        stop.on = Measure::sum_of({{1.0, some_measure()}, {factor, some_measure()}});
        if (random_.chance(0.5)) stop.on.terms.push_back({random_.uniform(-1.0, 1.0), some_measure()});
        return with_limits(stop, held, held);
      case 3:
        stop.table = "cam";
        stop.sense = -1.0;
        stop.on = Measure::sum_of(
            {{1.0, some_measure()}, {factor, angle_of_some_body(), some_profile(), random_.uniform(-3.0, 3.0)}});
        return random_.chance(0.5) ? with_limits(stop, held, held) : with_limits(stop, held, infinity);
      default: {
        const std::optional<Measure> rope = some_rope();
        if (!rope) return std::nullopt;
        stop.table = "rope";
        stop.on = *rope;
        return with_limits(stop, -infinity, held);
      }
    }
  }

  // A stretching rope, or a spring upon a component or a sum.
  void add_springs_upon_their_measures() {
    Element spring;
    spring.name = "upon";
    if (const std::optional<Measure> rope = random_.chance(0.5) ? some_rope() : std::nullopt) {
      spring.table = "rope";
      spring.on = *rope;
    } else {
      spring.table = "spring";
      const auto [a, b] = two_points();
      spring.on = Measure::component_along(a, b, unit(random_.uniform(-M_PI, M_PI)));
    }
    LinearSpring law{.stiffness = random_.uniform(0.5, 3.0)};
    if (spring.table == "rope") law.acts = LinearSpring::Acts::tension;
    spring.law = law;
    scene().elements.push_back(spring);
    // So far from its free length that a disturbed start does not make it slack.
    const Mechanism<double> mechanism(scene());
    const double now = measured(scene(), spring.on, mechanism.poses(start_of(mechanism, scene()).data()));
    law.free_length = now - random_.uniform(0.3, 0.6);
    scene().elements.back().law = law;
  }

  // Sets the limits of the stops: some are active in the present pose, with a random force for each, the others are
  // wide.
  // Couplings that hold are active; false where one cannot be, as it repeats what joints and others hold.
  bool choose_stops_that_press() {
    const Mechanism<double> mechanism(scene());
    std::vector<int> rows = closure_rows(mechanism);
    for (int s = 0; s < mechanism.stops(); ++s) {
      const int row = mechanism.stop_row(s);
      const double g = Pose(mechanism, scene(), {row}).point.constraint[row];
      Stop& stop = scene().stops[s];
      rows.push_back(row);
      const Pose held(mechanism, scene(), rows);
      const bool may_press = Motion(held.point.jacobian, draft_.redundant).is_regular();
      const bool has_lower = stop.min != -infinity, has_upper = stop.max != infinity;
      const bool holds = stop.holds();
      if (holds && !may_press) return false;
      const bool presses = holds || (random_.chance(0.5) && may_press);
      const auto side = [&] { return has_lower && has_upper ? 1 - 2 * random_.index(2) : has_upper ? 1 : -1; };
      const double push = presses ? random_.uniform(0.3, 1.0) * side() : 0.0;
      if (presses) {
        stop.max = push > 0 || holds ? g : infinity;
        stop.min = push < 0 || holds ? g : -infinity;
        out_.pressing.push_back(s);
        push_.push_back(push);
      } else {
        const double room = random_.uniform(0.2, 0.6);
        if (has_upper) stop.max = g + room;
        if (has_lower) stop.min = stop.on.kind == Measure::Kind::distance ? std::max(0.0, g - room) : g - room;
        rows.pop_back();
      }
    }
    return true;
  }

  // -Q of all loads and of the active stops.
  VectorXd negative_force(const Mechanism<double>& mechanism) {
    std::vector<int> rows;
    for (const int s : out_.pressing) rows.push_back(mechanism.stop_row(s));
    const Pose at(mechanism, scene(), rows);
    return at.point.force + at.point.jacobian.transpose() * Eigen::Map<const VectorXd>(push_.data(), push_.size());
  }

  // One load per freedom, so that N^T Q = 0.
  bool balance() {
    const Mechanism<double> mechanism(scene());
    const Motion motion(Pose(mechanism, scene(), closure_rows(mechanism)).point.jacobian, draft_.redundant);
    const int freedoms = static_cast<int>(motion.basis.cols());
    if (freedoms < 1 || freedoms > 3) return false;
    const std::vector<Stop>& stops = scene().stops;
    const auto held = std::count_if(stops.begin(), stops.end(), [](const Stop& stop) { return stop.couples(); });
    if (held >= freedoms) return false;
    out_.freedoms = freedoms;

    // Candidates, as what a unit of each adds to N^T Q.
    const VectorXd before = negative_force(mechanism);
    std::vector<std::function<void(double)>> candidates;
    MatrixXd work(freedoms, 0);
    for (int k = 0; k < 6 * freedoms; ++k) {
      const Scene kept = scene();
      const std::function<void(double)> load = random_.chance(0.6) ? planted_torque() : planted_force();
      load(1.0);
      const Mechanism<double> loaded(scene());
      const bool same_model = loaded.coordinates() == mechanism.coordinates();
      const VectorXd added = same_model ? VectorXd(before - negative_force(loaded)) : VectorXd();
      scene() = kept;
      if (!same_model) continue;
      candidates.push_back(load);
      work.conservativeResize(Eigen::NoChange, work.cols() + 1);
      work.rightCols(1) = motion.basis.transpose() * added;
    }
    if (work.cols() < freedoms) return false;
    const std::vector<int> order = solvers::pivot_order(work, solvers::known_to::rounding).columns;
    MatrixXd chosen(freedoms, freedoms);
    for (int k = 0; k < freedoms; ++k) chosen.col(k) = work.col(order[k]);
    const solvers::FullyPivotedLu factors(chosen);
    if (factors.reciprocal_condition() == 0.0) return false;

    // Once, and once more for what rounding left.
    const Scene unloaded = scene();
    VectorXd size = VectorXd::Zero(freedoms);
    for (int pass = 0; pass < 2; ++pass) {
      const VectorXd left = negative_force(Mechanism<double>(scene()));
      size += factors.solve(VectorXd(motion.basis.transpose() * left));
      scene() = unloaded;
      for (int k = 0; k < freedoms; ++k) candidates[order[k]](size[k]);
    }
    return size.cwiseAbs().maxCoeff() < largest_planted_load;
  }

  std::function<void(double)> planted_torque() {
    const int body = moving_body();
    return [this, body](double size) {
      scene().torques.push_back({fmt::format("planted{}", scene().torques.size()), body, size});
    };
  }

  std::function<void(double)> planted_force() {
    const int body = moving_body();
    const Vec2 at = {random_.uniform(-0.7, 0.7), random_.uniform(-0.7, 0.7)};
    const Vec2 direction = unit(random_.uniform(-M_PI, M_PI));
    return [this, body, at, direction](double size) {
      Force force;
      force.name = fmt::format("planted_force{}", scene().forces.size());
      force.at = scene().add_point(body, fmt::format("p{}", scene().bodies[body].points.size()), at);
      force.vector = size * direction;
      scene().forces.push_back(force);
    };
  }

  // Curvatures and sensitivity of the planted equilibrium; false where it is nearly singular.
  bool measure() {
    const Mechanism<double> mechanism(scene());
    std::vector<int> rows = closure_rows(mechanism);
    for (const int s : out_.pressing) rows.push_back(mechanism.stop_row(s));
    Pose at(mechanism, scene(), rows);
    const Motion motion(at.point.jacobian, draft_.redundant);
    if (!motion.is_regular()) return false;
    const MatrixXd reduced = wish_.followers ? by_forces(mechanism, at, motion) : by_energy(mechanism, at, motion);
    if (reduced.size() > 0) {
      const Eigen::VectorXcd values = solvers::eigenpairs(reduced).values;
      out_.curvature.assign(values.begin(), values.end());
    }
    for (const auto& e : out_.curvature) {
      if (std::abs(e.real()) < least_curvature) return false;
    }
    const Eigen::Index n = mechanism.coordinates();
    const Eigen::Index m = at.point.jacobian.rows();
    MatrixXd system = MatrixXd::Zero(n + m, n + m);
    system << at.point.tangent(at.point.multipliers()), at.point.jacobian.transpose(), at.point.jacobian,
        MatrixXd::Zero(m, m);
    const VectorXd singular = solvers::singular_value_decomposition(system).values;
    out_.sensitivity = 1.0 / singular[singular.size() - 1 - draft_.redundant];
    return out_.sensitivity < largest_sensitivity;
  }

  // Moves from the pose by s along the basis and closes the rows again by shortest steps.
  static std::vector<double> moved(const Mechanism<double>& mechanism, const Pose& at, const Motion& motion,
                                   const VectorXd& s) {
    std::vector<double> q = at.q;
    Eigen::Map<VectorXd> x(q.data(), q.size());
    x += motion.basis * s;
    for (int k = 0; k < 10; ++k) {
      const DensePoint<double> now(mechanism, q, at.point.kept);
      VectorXd gap(at.point.kept.size());
      for (std::size_t r = 0; r < at.point.kept.size(); ++r) {
        const int row = at.point.kept[r];
        gap[r] = now.constraint[row] - (row < mechanism.equalities() ? 0.0 : at.point.constraint[row]);
      }
      if (gap.size() == 0 || gap.cwiseAbs().maxCoeff() < 1e-14) break;
      // Redundant rows have pivots of the order of the displacement here.
      x -= solvers::minimum_norm_solution(now.jacobian, gap, 1e-2);
    }
    return q;
  }

  MatrixXd by_energy(const Mechanism<double>& mechanism, const Pose& at, const Motion& motion) {
    constexpr double h = 1e-3;
    const Eigen::Index f = motion.basis.cols();
    const auto energy = [&](Eigen::Index i, double step_i, Eigen::Index j, double step_j) {
      VectorXd s = VectorXd::Zero(f);
      s[i] += step_i;
      s[j] += step_j;
      return potential_energy(scene(), mechanism.poses(moved(mechanism, at, motion, s).data()));
    };
    MatrixXd out(f, f);
    for (Eigen::Index i = 0; i < f; ++i) {
      for (Eigen::Index j = 0; j < f; ++j) {
        out(i, j) =
            (energy(i, h, j, h) - energy(i, h, j, -h) - energy(i, -h, j, h) + energy(i, -h, j, -h)) / (4 * h * h);
      }
    }
    return out;
  }

  // d/ds of  Z^T (F + J^T y)  with y held: where this residual vanishes it does not matter that Z is held too.
  MatrixXd by_forces(const Mechanism<double>& mechanism, const Pose& at, const Motion& motion) {
    constexpr double h = 1e-4;
    const Eigen::Index f = motion.basis.cols();
    const VectorXd y = at.point.multipliers();
    const auto residual = [&](Eigen::Index i, double step) -> VectorXd {
      VectorXd s = VectorXd::Zero(f);
      s[i] = step;
      const DensePoint<double> now(mechanism, moved(mechanism, at, motion, s), at.point.kept);
      return motion.basis.transpose() * (now.force + now.jacobian.transpose() * y);
    };
    MatrixXd out(f, f);
    for (Eigen::Index i = 0; i < f; ++i) out.col(i) = (residual(i, h) - residual(i, -h)) / (2 * h);
    return out;
  }

  // Takes the scene to some size and load in SI, both powers of two so that nothing is rounded, and disturbs its start.
  void finish() {
    const Scales to_si = {std::exp2(random_.index(9) - 5), std::exp2(random_.index(11) - 8)};
    scene().file = "random mechanism";
    out_.in_equilibrium = scaled(scene(), to_si);
    disturb(scene().start);
    out_.scene = scaled(scene(), to_si);
    const Mechanism<double> in_equilibrium(out_.in_equilibrium);
    out_.equilibrium = start_of(in_equilibrium, out_.in_equilibrium);
    out_.start = start_of(Mechanism<double>(out_.scene), out_.scene);
    const std::vector<double> guess = in_equilibrium.start();
    for (std::size_t i = 0; i < guess.size(); ++i) {
      out_.hangs_on_bars =
          out_.hangs_on_bars || std::abs(std::remainder(guess[i] - out_.equilibrium[i], 2 * M_PI)) > 1e-9;
    }
  }

  void disturb(Start& start) {
    const auto off = [&] { return random_.uniform(-wish_.disturbance, wish_.disturbance); };
    for (auto& angle : start.angle) {
      if (angle) *angle += off();
    }
    for (auto& travel : start.travel) {
      if (travel) *travel += off();
    }
    for (auto& position : start.position) {
      if (position) *position += {off(), off()};
    }
  }

  Random& random_;
  const Wish& wish_;
  Draft draft_;
  std::vector<double> push_;  // multipliers of the active stops
  PlantedMechanism out_;
};

}  // namespace

int PlantedMechanism::falling() const {
  return static_cast<int>(
      std::count_if(curvature.begin(), curvature.end(), [](const auto& e) { return e.real() < 0; }));
}

PlantedMechanism plant_mechanism(std::uint64_t seed, const Wish& wish) {
  Random random(seed);
  for (int k = 0; k < tries; ++k) {
    const int mobility = 1 + random.index(3);
    const std::optional<Draft> draft = Geometry(random, wish.loops, mobility).draw();
    if (!draft) continue;
    for (int load = 0; load < 5; ++load) {
      if (const auto planted = Planting(random, wish, *draft).plant()) return *planted;
    }
  }
  throw std::logic_error(fmt::format("no mechanism of {} loops was drawn from seed {}", wish.loops, seed));
}

}  // namespace poise::test
