// Friction between a cam and the edge of its follower, against equations of motion written out with the tangent and
// normal of the profile, and against closed forms.

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/joint_friction.hpp"
#include "model/parameters.hpp"
#include "model/read_scene.hpp"
#include "model/set_parameter.hpp"
#include "motion/contacts.hpp"
#include "motion/simulate.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/motions.hpp"

namespace poise::rubbing_cam_test {
namespace {

using Kind = ContactEvent::Kind;

constexpr double g = 9.81;
constexpr double base = 0.05, lift = 0.02, rise = 2.0;

// The lift: cycloidal in 2 rad, then a dwell, and back.
std::string lobe(double friction, const std::string& follower, double at_base, double by) {
  return fmt::format(R"([[cam]]
name = "lobe"
bodies = ["ground", "cam"]
follower = {{ {} }}
roller = "follower.T"
base = {}
lift = {}
friction = {}
law = [
  {{ to = 2, lift = 1, law = "cycloidal" }},
  {{ to = 4, law = "dwell" }},
  {{ to = 6, lift = 0, law = "cycloidal" }},
  {{ to = {:.17g}, law = "dwell" }},
]
)",
                     follower, at_base, by, friction, 2 * M_PI);
}

// A follower of 0.5 kg on a guide beside the cam's axis, pressed by a spring of 400 N/m.
std::string started(double cam, const std::string& follower, double place) {
  return fmt::format("[start]\ncam = {:.17g}\n{} = {:.17g}\n", cam, follower, place);
}

std::string sliding(double friction) {
  return R"(gravity = [0, -9.81]
[ground]
points = { O = [0, 0], F = [0.012, 0] }
[body.cam]
points = { O = [0, 0] }
inertia = 0.004
[body.follower]
points = { T = [0, 0] }
mass = 0.5
[[pin]]
name = "shaft"
points = ["ground.O", "cam.O"]
[[slide]]
name = "guide"
points = ["ground.F", "follower.T"]
axis = [0, 1]
[[spring]]
slide = "guide"
stiffness = 400
free_length = 0.01
)" + lobe(friction, "slide = \"guide\"", base, lift);
}

// A lever of 0.001 kg m2 without weight about a pin beside the cam, pressed by a torsion spring; its edge is 0.1 m from
// the pin, which is 0.11 m beside the axis and 0.02 m above it.
constexpr double arm_length = 0.1, arm_angle = 2.6, arm_base = 0.05, arm_lift = -0.2;
constexpr Vec2 pivot{0.11, 0.02};

std::string turning(double friction) {
  const Vec2 edge = arm_length * unit(arm_angle);
  return fmt::format(R"(
[ground]
points = {{ O = [0, 0], P = [0.11, 0.02] }}
[body.cam]
points = {{ O = [0, 0] }}
inertia = 0.004
[body.follower]
points = {{ O = [0, 0], T = [{:.17g}, {:.17g}] }}
inertia = 0.001
[[pin]]
name = "shaft"
points = ["ground.O", "cam.O"]
[[pin]]
name = "pivot"
points = ["ground.P", "follower.O"]
[[torsion_spring]]
bodies = ["follower", "ground"]
stiffness = 8
free_angle = -0.4
)",
                     edge.x, edge.y) +
         lobe(friction, "bodies = [\"follower\", \"ground\"]", -arm_base, -arm_lift);
}

// s(h) of the rise, with derivatives.
std::array<double, 3> lifted(double from, double by, double h) {
  const double u = h / rise, turn = 2 * M_PI * u;
  return {from + by * (u - std::sin(turn) / (2 * M_PI)), by / rise * (1 - std::cos(turn)),
          by / (rise * rise) * 2 * M_PI * std::sin(turn)};
}

// The angle and rate of the cam while its follower touches: both bodies cut free, with the normal force N and friction
// mu N along the slip, on the edge of the follower at p from the axis, which moves by p_s per unit of its coordinate s.
struct Touched {
  double h, w;
};
template <class Follower>
std::array<double, 2> rates(const Follower& follower, double mu, const Touched& at) {
  const auto [s, s1, s2] = follower.lift(at.h);
  const double ds = s1 * at.w;
  const Vec2 p = follower.place(s), p_s = follower.slope(s);
  const Vec2 slip = ds * p_s - at.w * quarter_turn(p);
  const Vec2 along = 1 / norm(slip) * slip;
  const Vec2 normal = dot(quarter_turn(along), p) > 0 ? quarter_turn(along) : -quarter_turn(along);
  const Vec2 on_follower = normal - mu * along;  // per N
  // m s'' = N on_follower.p_s + q,  J h'' = -N p x on_follower,  s'' = s1 h'' + s2 w^2.
  const double push = dot(on_follower, p_s), turn = -cross(p, on_follower) / 0.004;
  const double N = (follower.inertia * s2 * at.w * at.w - follower.force(s)) / (push - follower.inertia * s1 * turn);
  EXPECT_GT(N, 0.0);
  return {at.w, N * turn};
}

template <class Follower>
Touched stepped(const Follower& follower, double mu, Touched at, double duration, int steps) {
  const double d = duration / steps;
  const auto next = [&](const Touched& from, const std::array<double, 2>& rate, double by) {
    return Touched{from.h + by * rate[0], from.w + by * rate[1]};
  };
  for (int k = 0; k < steps; ++k) {
    const auto a = rates(follower, mu, at), b = rates(follower, mu, next(at, a, d / 2)),
               c = rates(follower, mu, next(at, b, d / 2)), e = rates(follower, mu, next(at, c, d));
    at.h += d / 6 * (a[0] + 2 * b[0] + 2 * c[0] + e[0]);
    at.w += d / 6 * (a[1] + 2 * b[1] + 2 * c[1] + e[1]);
  }
  return at;
}

struct OnGuide {
  double inertia = 0.5;
  std::array<double, 3> lift(double h) const { return lifted(base, rubbing_cam_test::lift, h); }
  Vec2 place(double s) const { return {0.012, s}; }
  Vec2 slope(double) const { return {0.0, 1.0}; }
  double force(double s) const { return -0.5 * g - 400 * (s - 0.01); }
};
struct OnPivot {
  double inertia = 0.001;
  std::array<double, 3> lift(double h) const { return lifted(arm_base, arm_lift, h); }
  Vec2 place(double s) const { return pivot + arm_length * unit(arm_angle + s); }
  Vec2 slope(double s) const { return arm_length * quarter_turn(unit(arm_angle + s)); }
  double force(double s) const { return -8 * (s - 0.4); }
};

template <class Follower>
void compare(const std::string& text, const std::string& coordinate, const Follower& follower, double mu, double from,
             double speed, double duration) {
  const auto [s, s1, s2] = follower.lift(from);
  const MotionModel model(resisted_by_joints(parse_scene(text + started(from, coordinate, s), "scene.toml")));
  const MotionState start =
      test::released(model, {{{"cam", from}, {coordinate, s}}, {{"cam", speed}, {coordinate, s1 * speed}}});
  const Motion motion = test::moved(model, start, duration, 1e-12);
  ASSERT_EQ(motion.status, MotionStatus::completed) << motion.why;
  const auto cam = static_cast<std::size_t>(test::coordinate_of(model, "cam"));
  const Touched wanted = stepped(follower, mu, {from, speed}, duration, 20'000);
  const std::size_t last = motion.trajectory.t.size() - 1;
  EXPECT_NEAR(test::q_at(motion, last)[cam], wanted.h, 1e-9);
  EXPECT_NEAR(test::v_at(motion, last)[cam], wanted.w, 1e-8);
  EXPECT_LT(motion.energy_error, 1e-9);
}

TEST(RubbingCam, SlowsAsItsEquationsSay) {
  compare(sliding(0.3), "guide", OnGuide{}, 0.3, 0.3, 20.0, 0.05);
  compare(sliding(0.3), "guide", OnGuide{}, 0.3, 1.6, -20.0, 0.05);
  compare(turning(0.25), "follower", OnPivot{}, 0.25, 0.3, 20.0, 0.04);
  compare(turning(0.25), "follower", OnPivot{}, 0.25, 1.6, -20.0, 0.04);
}

// On the dwell, at R = 0.07 m from an axis in its guide's line, the spring and the weight press with F:
// J w' = -mu F R until it stands still, and then it is held.
TEST(RubbingCam, ADwellBrakesItsCam) {
  std::string text = sliding(0.3);
  text.replace(text.find("0.012"), 5, "0.000");
  const MotionModel model(resisted_by_joints(parse_scene(text + started(2.2, "guide", 0.07), "scene.toml")));
  const double F = 0.5 * g + 400 * 0.06, slowing = 0.3 * F * 0.07 / 0.004, from = 2.2, speed = 12.0;
  const MotionState start = test::released(model, {{{"cam", from}, {"guide", 0.07}}, {{"cam", speed}, {"guide", 0.0}}});
  const Motion motion = test::moved(model, start, 0.3, 1e-12);
  ASSERT_EQ(motion.status, MotionStatus::completed) << motion.why;
  ASSERT_EQ(motion.events.size(), 1U);
  EXPECT_EQ(motion.events[0].kind, Kind::stick);
  EXPECT_NEAR(motion.events[0].t, speed / slowing, 1e-12);
  const auto cam = static_cast<std::size_t>(test::coordinate_of(model, "cam"));
  const std::size_t last = motion.trajectory.t.size() - 1;
  EXPECT_NEAR(test::q_at(motion, last)[cam], from + speed * speed / (2 * slowing), 1e-12);
  EXPECT_EQ(test::v_at(motion, last)[cam], 0.0);
  EXPECT_LT(motion.energy_error, 1e-10);
}

// The cam is held on a rise as long as a force within the angle of friction from the normal goes through its axis, and
// turned by the spring with less.
TEST(RubbingCam, HoldsWhereItsAngleOfFrictionAllows) {
  const auto [s, s1, s2] = lifted(base, lift, 1.0);
  const double needed = std::tan(std::atan((s1 - 0.012) / s) + std::atan(0.012 / s));
  for (const double share : {0.98, 1.02}) {
    const MotionModel model(
        resisted_by_joints(parse_scene(sliding(share * needed) + started(1.0, "guide", s), "scene.toml")));
    const MotionState start = test::released(model, {{{"cam", 1.0}, {"guide", s}}, {}});
    const Motion motion = test::moved(model, start, 0.05, 1e-12);
    ASSERT_EQ(motion.status, MotionStatus::completed) << motion.why;
    const auto cam = static_cast<std::size_t>(test::coordinate_of(model, "cam"));
    const double moved = test::q_at(motion, motion.trajectory.t.size() - 1)[cam] - 1.0;
    if (share > 1.0)
      EXPECT_NEAR(moved, 0.0, 1e-12);
    else
      EXPECT_LT(moved, -1e-5);
  }
}

// A rod of 1 kg and half length 0.5 that leans at 1.0 rad and slides with its lower end on a rough floor.
constexpr const char* rod = R"(gravity = [0, -9.81]
[ground]
points = { O = [0, 0] }
[body.rod]
points = { A = [-0.5, 0.02], B = [0.5, 0] }
mass = 1
inertia = 0.08
[[stop]]
name = "floor"
y = "rod.A"
min = 0
friction = 0.4
[start]
rod = 1
position = { rod = [0, 0.42] }
)";

// Accelerations while the first stop is touched at its min and something slides across it in the negative sense, and
// their derivatives by the state and by dimensions, friction and the shape of the cam, against differences of scenes
// compiled anew.
void check_derivatives(const std::string& text, const std::vector<std::string>& independent,
                       const std::vector<double>& places, const std::vector<double>& rates) {
  const Scene scene = resisted_by_joints(parse_scene(text, "scene.toml"));
  std::vector<ParameterRow> rows;
  std::vector<ParameterPlace> of_rows;
  for (const ParameterRow& row : parameter_table(scene)) {
    const std::string path = row.path.text();
    const bool is_asked = path.starts_with("cam.") || path.starts_with("point.") || path.ends_with("friction");
    if (!is_asked || path.ends_with("restitution")) continue;
    rows.push_back(row);
    of_rows.push_back(row.place);
  }
  ASSERT_GE(rows.size(), 3U);
  const VaryingNumbers varying(scene, of_rows);
  const Scales scales = MotionModel(scene).scales();
  const auto model = std::make_shared<const MotionModel>(scene, scales, varying);
  std::vector<int> chosen;
  for (const std::string& name : independent) {
    const std::vector<Coordinate>& all = model->layout().coordinates;
    const auto found = std::find_if(all.begin(), all.end(), [&](const Coordinate& one) { return one.name == name; });
    ASSERT_NE(found, all.end()) << name;
    chosen.push_back(static_cast<int>(found - all.begin()));
  }
  const auto scaled = [&](std::size_t k, double value) {
    return chosen[k] < model->layout().angles ? value : value / scales.length;
  };
  std::vector<double> q = test::released(*model, {}).q;
  for (std::size_t i = 0; i < q.size(); ++i) {
    if (static_cast<int>(i) >= model->layout().angles) q[i] /= scales.length;
  }
  std::vector<double> z, w;
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    z.push_back(scaled(k, places[k]));
    w.push_back(scaled(k, rates[k]));
    q[static_cast<std::size_t>(chosen[k])] = z.back();
  }
  std::vector<int> in_order = chosen;
  std::sort(in_order.begin(), in_order.end());
  ASSERT_EQ(in_order, chosen);
  using Moved = ReducedMotion<double>;
  const auto place_in = [&](Moved& motion, const MotionModel& of, const std::vector<double>& at,
                            const std::vector<double>& with) {
    motion.set_touching(of.scaled_scene(), {{0, false}});
    motion.set_sliding(of.scaled_scene(), std::vector<int>(of.scaled_scene().elements.size(), -1), q.data());
    motion.start_drives(q.data());
    motion.choose(0.0, q.data(), false, &chosen);
    motion.expect(q.data());
    ASSERT_EQ(motion.evaluate(0.0, at.data(), with.data()), Moved::Status::ok);
  };
  const std::size_t f = chosen.size();
  const auto alpha_of = [&](const MotionModel& of, const std::vector<double>& at, const std::vector<double>& with) {
    Moved other(of.scaled_scene(), of.mechanism(), of.inertia());
    place_in(other, of, at, with);
    return std::vector<double>(other.alpha(), other.alpha() + f);
  };
  Moved here(model->scaled_scene(), model->mechanism(), model->inertia());
  place_in(here, *model, z, w);
  std::vector<Variation> variations;
  for (const ParameterRow& row : rows) variations.emplace_back(model, row.place);
  here.set_variations(variations);
  here.linearize();
  const auto expect_near = [&](const double* derivative, double size, const auto& at, const std::string& by_what) {
    constexpr double d = 1e-4;
    const std::vector<double> up = at(d), down = at(-d), far = at(2 * d), far_down = at(-2 * d);
    for (std::size_t i = 0; i < f; ++i) {
      const double by = (8 * (up[i] - down[i]) - (far[i] - far_down[i])) / (12 * d * size);
      EXPECT_NEAR(derivative[i], by, 1e-6 * (std::abs(by) + std::abs(here.alpha()[i]) + 1.0)) << by_what << " " << i;
    }
  };
  for (std::size_t k = 0; k < f; ++k) {
    const auto moved_by = [&](std::vector<double> values, double by) {
      values[k] += by;
      return values;
    };
    expect_near(
        here.alpha_z(static_cast<int>(k)), 1.0, [&](double h) { return alpha_of(*model, moved_by(z, h), w); }, "z");
    expect_near(
        here.alpha_w(static_cast<int>(k)), 1.0, [&](double h) { return alpha_of(*model, z, moved_by(w, h)); }, "w");
  }
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const double value = value_at(scene, rows[k].place).value();
    const double size = std::max(std::abs(value), 0.05);
    std::vector<double> alpha(f);
    here.influence({.variation = static_cast<int>(k)}, alpha.data());
    const auto changed = [&](double h) {
      Scene other = scene;
      set_value_at(other, rows[k].place, value + h * size);
      return alpha_of(MotionModel(other, scales, varying), z, w);
    };
    expect_near(alpha.data(), size, changed, rows[k].path.text());
  }
}

TEST(RubbingCam, DerivativesAreThoseOfDifferences) {
  const auto slide = lifted(base, lift, 0.8), arm = lifted(arm_base, arm_lift, 0.8);
  check_derivatives(sliding(0.3) + started(0.8, "guide", slide[0]), {"cam"}, {0.8}, {5.0});
  check_derivatives(turning(0.25) + started(0.8, "follower", arm[0]), {"cam"}, {0.8}, {5.0});
}

// Friction across a stop acts along a line that is fixed, at a point that turns with its body.
TEST(FrictionAcrossStops, DerivativesAreThoseOfDifferences) {
  check_derivatives(rod, {"rod", "rod.x"}, {1.0, 0.0}, {0.7, -1.5});
}

TEST(RubbingCam, AsksForAnEdge) {
  std::string text = sliding(0.3);
  const auto message = [](const std::string& of) { return test::message_of([&] { parse_scene(of, "scene.toml"); }); };
  std::string without = text;
  const std::string key = "roller = \"follower.T\"\n";
  without.replace(without.find(key), key.size(), "");
  EXPECT_NE(message(without).find("expected the key roller beside it"), std::string::npos) << message(without);
  std::string grooved = text;
  grooved.replace(grooved.find(key), 0, "guided = true\n");
  EXPECT_NE(message(grooved).find("guided cam"), std::string::npos) << message(grooved);
  std::string negative = text;
  negative.replace(negative.find("friction = 0.3"), 14, "friction = -0.3");
  EXPECT_NE(message(negative).find("friction"), std::string::npos);
}

}  // namespace
}  // namespace poise::rubbing_cam_test
