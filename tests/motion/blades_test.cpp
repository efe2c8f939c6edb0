// Motions of bodies on blades, against closed forms and published values.

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <map>
#include <string>
#include <vector>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/parameters.hpp"
#include "motion/body_motion.hpp"
#include "motion/forces_in_time.hpp"
#include "motion/simulate.hpp"
#include "statics/model/mobility.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/motions.hpp"

namespace poise::blades_test {
namespace {

Scene sleigh() { return read_scene(test::dataset("machines/chaplygin_sleigh.toml")); }
Scene castor() { return read_scene(test::dataset("machines/castor.toml")); }

/// A body on a knife edge under its centre of mass, on a plane that falls by `slope` m/s^2 along x.
Scene knife(double slope, const std::string& more = "") {
  return parse_scene(fmt::format(R"(
gravity = [{}, 0]
[body.plate]
points = {{ P = [0, 0], nose = [0.4, 0] }}
mass = 2
inertia = 0.3
{}
[[blade]]
name = "edge"
at = "plate.P"
{}
)",
                                 slope, more.starts_with("[") ? more : "", more.starts_with("[") ? "" : more),
                     "knife.toml");
}

/// Places and rates by the names of coordinates: "sleigh", "sleigh.x".
MotionState released(const MotionModel& model, const std::map<std::string, double>& places,
                     const std::map<std::string, double>& rates) {
  std::vector<StartValue> wanted;
  for (const auto& [values, is_rate] : {std::pair(&places, false), std::pair(&rates, true)}) {
    for (const auto& [name, value] : *values) {
      for (int i = 0; i < model.layout().kept; ++i) {
        if (model.layout().coordinates[static_cast<std::size_t>(i)].name == name) {
          wanted.push_back({i, is_rate, value});
        }
      }
    }
  }
  EXPECT_EQ(wanted.size(), places.size() + rates.size());
  return start_motion(model, wanted);
}

/// The rate of a blade's point across its edge, by vector mechanics alone.
double across(const Scene& scene, const Blade& blade, const std::vector<BodyMotion>& motions) {
  const BodyMotion& body = motions[static_cast<std::size_t>(blade.at.body)];
  const Vec2 place = body.pose.world(scene.local(blade.at));
  const Vec2 apart = body.velocity_at(place) - motions[static_cast<std::size_t>(blade.on)].velocity_at(place);
  return cross(unit(body.pose.angle + blade.angle), apart);
}

/// The largest of it at the nodes of a motion.
double largest_across(const MotionModel& model, const Motion& motion) {
  double largest = 0.0;
  for (std::size_t k = 0; k < motion.trajectory.nodes(); ++k) {
    const std::vector<double> x = model.from_si(test::q_at(motion, k)), v = model.from_si(test::v_at(motion, k));
    const std::vector<BodyMotion> motions = body_motions(model, x, v, std::vector<double>(x.size(), 0.0));
    for (const Blade& blade : model.scene().blades) {
      largest = std::max(largest, std::abs(across(model.scene(), blade, motions)));
    }
  }
  return largest;
}

// v = V tanh(L (t - t0)), w = V sqrt(m/I) / cosh(L (t - t0)): the values of benchmarks 3.1.
TEST(Blades, ChaplyginSleighTurnsIntoItsRun) {
  const MotionModel model(sleigh());
  const MotionState start = released(model, {}, {{"sleigh", 2.0}, {"sleigh.x", 0.5}});
  struct Row {
    double t, v, w, heading, x, y;
  };
  constexpr std::array rows{Row{0.5, 0.875878312566, 1.13052661594, 0.781087348, 0.315733467, 0.157202161},
                            Row{1.0, 0.977152915032, 0.538869091833, 1.18294215, 0.563594992, 0.552033165},
                            Row{2.0, 1.00380699595, 0.111721337464, 1.45526921, 0.777309439, 1.52235934}};
  const Motion motion = test::moved(model, start, 2.0, 1e-10);
  const int heading = test::coordinate_of(model, "sleigh");
  const std::vector<test::Reading> read = test::read_at(motion, {0.5, 1.0, 2.0});
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Row& row = rows[k];
    const std::vector<double> x = model.from_si(read[k].q), v = model.from_si(read[k].v);
    const BodyMotion body = body_motions(model, x, v, std::vector<double>(x.size(), 0.0))[1];
    const double theta = read[k].q[static_cast<std::size_t>(heading)];
    EXPECT_NEAR(dot(body.velocity, unit(theta)), row.v, 1e-11) << row.t;
    EXPECT_NEAR(body.rate, row.w, 1e-11) << row.t;
    EXPECT_NEAR(theta, row.heading, 5e-9) << row.t;
    const Vec2 place = model.poses(x)[1].origin;
    EXPECT_NEAR(place.x, row.x, 5e-10) << row.t;
    EXPECT_NEAR(place.y, row.y, 5e-9) << row.t;
  }
  for (const double energy : motion.kinetic) EXPECT_NEAR(energy, motion.kinetic.front(), 1e-10);
  EXPECT_LT(largest_across(model, motion), 1e-14);
  // In the end it has turned by sqrt(I/m)/a (pi/2 - gd(-L t0)).
  const Motion on = test::moved(model, start, 20.0, 1e-10);
  EXPECT_NEAR(test::q_at(on, on.trajectory.nodes() - 1)[static_cast<std::size_t>(heading)], 1.52570248909, 1e-10);
  EXPECT_LT(largest_across(model, on), 1e-14);
}

// With its mass above the edge it turns steadily at w, and slides down and up again on a cycloid:
//   v = (s/w) sin(w t),  x = s/(2 w^2) sin^2(w t),  y = s/(2 w^2) (w t - sin(2 w t)/2),  force 2 m s sin(w t).
TEST(Blades, KnifeOnASlopeDrawsACycloid) {
  const double s = 3.0, w = 1.7, m = 2.0;
  const MotionModel model(knife(s));
  const Motion motion = test::moved(model, released(model, {}, {{"plate", w}}), 5.0, 1e-10);
  std::vector<double> times;
  for (int k = 0; k <= 50; ++k) times.push_back(0.1 * k);
  const std::vector<test::Reading> read = test::read_at(motion, times);
  for (std::size_t k = 0; k < times.size(); ++k) {
    const double t = times[k], size = s / (2 * w * w);
    const Vec2 place = model.poses(model.from_si(read[k].q))[1].origin;
    EXPECT_NEAR(place.x, size * std::pow(std::sin(w * t), 2), 1e-10) << t;
    EXPECT_NEAR(place.y, size * (w * t - std::sin(2 * w * t) / 2), 1e-10) << t;
  }
  EXPECT_LT(motion.energy_error, 1e-11);
  EXPECT_LT(largest_across(model, motion), 1e-13);
  // The free bodies find the force of the blade without its multiplier.
  MotionRecord record;
  record.time = times;
  record.kinetic.assign(times.size(), 0.0);
  const ForceHistory forces = forces_in_time(model.scene(), model, motion, record, {});
  EXPECT_TRUE(forces.balanced());
  EXPECT_LT(forces.power_error, 1e-9);
  for (std::size_t k = 0; k < times.size(); ++k) {
    const std::vector<Reaction>& reactions = forces.found.poses[k].reactions;
    ASSERT_EQ(reactions.size(), 1U);
    EXPECT_EQ(reactions[0].name, "edge");
    EXPECT_EQ(reactions[0].kind, "blade");
    const double force = 2 * m * s * std::sin(w * times[k]);
    const Vec2 left = quarter_turn(unit(w * times[k]));
    EXPECT_NEAR(reactions[0].force.x, force * left.x, 1e-8) << times[k];
    EXPECT_NEAR(reactions[0].force.y, force * left.y, 1e-8) << times[k];
  }
}

// The equations of motion about steady towing: four roots, of which one is zero because the rate across the blade stays
// what it is. The others solve  [m (e-a)^2 + J] s^3 + [m (e-a) V + c] s^2 + k e^2 s + k e V = 0.
std::vector<std::complex<double>> roots_of_castor(double speed) {
  Scene scene = castor();
  scene.drives[0].rate = speed;
  const MotionModel model(scene);
  const std::vector<double> x = close_loops(model);
  ReducedMotion<double> motion(model.scaled_scene(), model.mechanism(), model.inertia());
  EXPECT_EQ(motion.begin(0.0, x.data()), ReducedMotion<double>::Status::ok);
  std::vector<double> z;
  for (const int i : motion.independent()) z.push_back(x[static_cast<std::size_t>(i)]);
  const std::vector<double> w(z.size(), 0.0);
  EXPECT_EQ(motion.evaluate(0.0, z.data(), w.data()), ReducedMotion<double>::Status::ok);
  motion.linearize();
  const Eigen::Index f = motion.freedoms();
  EXPECT_EQ(f, 2);
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(2 * f, 2 * f);
  system.topRightCorner(f, f).setIdentity();
  for (Eigen::Index k = 0; k < f; ++k) {
    for (Eigen::Index j = 0; j < f; ++j) {
      system(f + j, k) = motion.alpha_z(static_cast<int>(k))[j];
      system(f + j, f + k) = motion.alpha_w(static_cast<int>(k))[j];
    }
  }
  const Eigen::VectorXcd found = system.eigenvalues();
  std::vector<std::complex<double>> out(found.begin(), found.end());
  std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return std::abs(a) < std::abs(b); });
  return out;
}

TEST(Blades, CastorShimmiesBeyondItsCriticalSpeed) {
  const double critical = 0.3 * 0.1 / (0.05 - 2 * 0.02 * 0.08);
  EXPECT_NEAR(critical, 0.641025641026, 5e-13);
  const auto at = roots_of_castor(critical);
  EXPECT_NEAR(std::abs(at[0]), 0.0, 1e-8);
  EXPECT_NEAR(at[1].real(), -6.41025641026, 1e-9);
  EXPECT_NEAR(at[1].imag(), 0.0, 1e-9);
  EXPECT_NEAR(at[2].real(), 0.0, 1e-9);
  EXPECT_NEAR(std::abs(at[2].imag()), 56.4332647980, 1e-9);
  EXPECT_NEAR(roots_of_castor(0.9 * critical)[2].real(), -0.236378824, 1e-9);
  EXPECT_NEAR(roots_of_castor(1.1 * critical)[2].real(), 0.235189295, 1e-9);
}

// In the motion itself a small oscillation grows or dies out at these rates.
TEST(Blades, CastorMovesAsItsRootsSay) {
  for (const auto& [part, growth] : {std::pair(0.9, -0.236378824), std::pair(1.1, 0.235189295)}) {
    Scene scene = castor();
    scene.drives[0].rate = part * 0.3 * 0.1 / (0.05 - 2 * 0.02 * 0.08);
    const MotionModel model(scene);
    const Motion motion = test::moved(model, released(model, {{"castor", 1e-4}}, {}), 5.0, 1e-11);
    EXPECT_LT(motion.energy_error, 1e-9);
    const int swing = test::coordinate_of(model, "castor");
    // Largest angles near 3 s and 5 s, when the fast decay is over: exp(-6.4 * 3) = 5e-9.
    const auto largest_in = [&](double from, double to) {
      std::vector<double> times;
      for (int k = 0; k <= 4000; ++k) times.push_back(from + (to - from) * k / 4000);
      double most = 0.0, when = 0.0;
      const std::vector<test::Reading> read = test::read_at(motion, times);
      for (std::size_t k = 0; k < times.size(); ++k) {
        const double here = std::abs(read[k].q[static_cast<std::size_t>(swing)]);
        if (here > most) most = here, when = times[k];
      }
      return std::pair(most, when);
    };
    const auto [first, at_first] = largest_in(3.0, 3.1);
    const auto [last, at_last] = largest_in(4.85, 4.95);
    EXPECT_NEAR(std::log(last / first) / (at_last - at_first), growth, 1e-5) << part;
    EXPECT_LT(largest_across(model, motion), 1e-13);
  }
}

/// A knife on a table, which moves along x, or turns about the origin.
Scene on_table(const std::string& joint, double rate) {
  return parse_scene(fmt::format(R"(
[ground.points]
O = [0, 0]
[body.table]
points = {{ O = [0, 0] }}
mass = 5
inertia = 5
[body.plate]
points = {{ P = [0, 0] }}
mass = 2
inertia = 0.3
[[{}]]
name = "J"
points = ["ground.O", "table.O"]
{}
[[drive]]
name = "D"
{}
rate = {}
[[blade]]
name = "edge"
at = "plate.P"
on = "table"
)",
                                 joint, joint == "slide" ? "axis = [1, 0]" : "",
                                 joint == "slide" ? "slide = \"J\"" : "bodies = [\"ground\", \"table\"]", rate),
                     "table.toml");
}

// On a table that moves steadily without turning it moves as on the ground.
TEST(Blades, MoveOnATableAsOnTheGround) {
  const double u = 0.8, w = 1.3;
  const MotionModel model(on_table("slide", u));
  const Motion motion = test::moved(model, released(model, {}, {{"plate", w}, {"plate.x", u + 0.5}}), 2.0, 1e-10);
  for (const test::Reading& read : test::read_at(motion, {0.7, 2.0})) {
    const std::vector<BodyPose<double>> poses = model.poses(model.from_si(read.q));
    const double t = poses[2].angle / w;
    const Vec2 place = poses[2].origin - poses[1].origin;
    EXPECT_NEAR(place.x, 0.5 / w * std::sin(w * t), 1e-10);
    EXPECT_NEAR(place.y, 0.5 / w * (1 - std::cos(w * t)), 1e-10);
  }
  EXPECT_LT(largest_across(model, motion), 1e-13);
}

// On one that turns at W, and turning with it, it is driven out along its edge: x'' = W^2 x, x = (v0/W) sinh(W t).
TEST(Blades, AreDrivenOutOnATurntable) {
  const double W = 1.4, v0 = 0.3;
  const MotionModel model(on_table("pin", W));
  const Motion motion = test::moved(model, released(model, {}, {{"plate", W}, {"plate.x", v0}}), 1.5, 1e-10);
  for (const double t : {0.5, 1.5}) {
    const std::vector<BodyPose<double>> poses = model.poses(model.from_si(test::read_at(motion, {t})[0].q));
    EXPECT_NEAR(poses[2].angle, W * t, 1e-10);
    const Vec2 place = v0 / W * std::sinh(W * t) * unit(W * t);
    EXPECT_NEAR(norm(poses[2].origin - place), 0.0, 1e-10) << t;
  }
  EXPECT_LT(motion.energy_error, 1e-10);
  EXPECT_LT(largest_across(model, motion), 1e-13);
}

// The nose, d ahead of the edge, hits a wall x = b:  m dv = -P cos, I dw = P d sin,  P = (1 + e) x'/(cos^2/m + d^2
// sin^2/I).
TEST(Blades, TakeTheirPartOfAnImpact) {
  const double d = 0.5, m = 1.0, I = 0.1 + 0.3 * 0.3, e = 0.6, v0 = 2.0, heading = 0.7;
  const std::string text = R"(
[body.sleigh]
points = { P = [0, 0], nose = [0.5, 0] }
mass = 1
center = [0.3, 0]
inertia = 0.1
[[blade]]
name = "edge"
at = "sleigh.P"
[[stop]]
name = "wall"
x = "sleigh.nose"
max = 0.6
restitution = 0.6
[start]
sleigh = 0.7
)";
  const MotionModel model(parse_scene(text, "wall.toml"));
  const MotionState start =
      released(model, {{"sleigh", heading}},
               {{"sleigh.x", v0 * std::cos(heading)}, {"sleigh.y", v0 * std::sin(heading)}, {"sleigh", 0.0}});
  const double when = (0.6 - d * std::cos(heading)) / (v0 * std::cos(heading));
  const Motion motion = test::moved(model, start, 1.2 * when, 1e-10);
  ASSERT_EQ(motion.events.size(), 1U);
  EXPECT_NEAR(motion.events[0].t, when, 1e-10);
  const double c = std::cos(heading), s = std::sin(heading);
  const double impulse = (1 + e) * v0 * c / (c * c / m + d * d * s * s / I);
  EXPECT_NEAR(motion.events[0].impulse, impulse, 1e-9);
  EXPECT_NEAR(motion.events[0].rate_after, e * v0 * c, 1e-9);
  std::size_t node = 0;
  while (motion.trajectory.t[node] < when - 1e-9) ++node;
  while (motion.trajectory.t[node + 1] <= motion.trajectory.t[node] + 1e-15) ++node;
  const std::vector<double> x = model.from_si(test::q_at(motion, node)), v = model.from_si(test::v_at(motion, node));
  const BodyMotion body = body_motions(model, x, v, std::vector<double>(x.size(), 0.0))[1];
  EXPECT_NEAR(dot(body.velocity, unit(body.pose.angle)), v0 - impulse * c / m, 1e-8);
  EXPECT_NEAR(body.rate, impulse * d * s / I, 1e-8);
  EXPECT_LT(largest_across(model, motion), 1e-13);
}

// Derivatives of the accelerations by coordinates and rates, against differences.
TEST(Blades, LinearizedAsDifferencesSay) {
  std::vector<Scene> scenes{sleigh(), castor(), knife(2.0), on_table("pin", 1.1)};
  scenes.push_back(knife(1.0, "angle = 0.4"));
  for (const Scene& scene : scenes) {
    const MotionModel model(scene);
    const std::vector<double> x = close_loops(model);
    ReducedMotion<double> motion(model.scaled_scene(), model.mechanism(), model.inertia());
    ASSERT_EQ(motion.begin(0.0, x.data()), ReducedMotion<double>::Status::ok);
    const auto f = static_cast<std::size_t>(motion.freedoms());
    std::vector<double> y;
    for (const int i : motion.independent()) y.push_back(x[static_cast<std::size_t>(i)]);
    for (std::size_t k = 0; k < f; ++k) y[k] += 0.1 + 0.07 * static_cast<double>(k);
    for (std::size_t k = 0; k < f; ++k) y.push_back(0.9 - 0.6 * static_cast<double>(k));
    const auto alpha = [&](const std::vector<double>& state) {
      motion.expect(x.data());
      EXPECT_EQ(motion.evaluate(0.0, state.data(), state.data() + f), ReducedMotion<double>::Status::ok);
      return std::vector<double>(motion.alpha(), motion.alpha() + f);
    };
    std::vector<std::vector<double>> by;
    alpha(y);
    motion.linearize();
    for (std::size_t k = 0; k < 2 * f; ++k) {
      const double* const from = k < f ? motion.alpha_z(static_cast<int>(k)) : motion.alpha_w(static_cast<int>(k - f));
      by.emplace_back(from, from + f);
    }
    for (std::size_t k = 0; k < 2 * f; ++k) {
      const double h = 1e-3;
      const auto at = [&](double steps) {
        std::vector<double> state = y;
        state[k] += steps * h;
        return alpha(state);
      };
      const std::vector<double> up = at(1), down = at(-1), far = at(2), far_down = at(-2);
      for (std::size_t j = 0; j < f; ++j) {
        const double difference = (8 * (up[j] - down[j]) - (far[j] - far_down[j])) / (12 * h);
        EXPECT_NEAR(by[k][j], difference, 1e-8 * (1 + std::abs(difference))) << scene.file << " " << k << " " << j;
      }
    }
  }
}

// A linear condition with constant factors between rates, x1' - 2 x2' = u, is a drive of the sum: with a force F on the
// first mass  x2'' = F/(2 m1 + m2/2),  x1'' = 2 x2''. Statics leaves it free.
TEST(Blades, ConditionsWithConstantFactorsAreDrivesOfSums) {
  const Scene scene = parse_scene(R"(
[ground.points]
O = [0, 0]
[body.one]
points = { C = [0, 0] }
mass = 1
[body.two]
points = { C = [0, 0] }
mass = 2
[[slide]]
name = "first"
points = ["ground.O", "one.C"]
axis = [1, 0]
[[slide]]
name = "second"
points = ["ground.O", "two.C"]
axis = [1, 0]
[[force]]
name = "F"
at = "one.C"
vector = [3, 0]
[[drive]]
name = "condition"
sum = [{ factor = 1, slide = "first" }, { factor = -2, slide = "second" }]
rate = 0.5
)",
                                  "sum.toml");
  const MotionModel model(scene);
  const Motion motion = test::moved(model, released(model, {}, {{"second", 0.4}}), 1.0);
  const std::vector<double> q = test::q_at(motion, motion.trajectory.nodes() - 1);
  EXPECT_NEAR(q[static_cast<std::size_t>(test::coordinate_of(model, "first"))], 0.5 + 0.8 + 1.0, 1e-10);
  EXPECT_NEAR(q[static_cast<std::size_t>(test::coordinate_of(model, "second"))], 0.4 + 0.5, 1e-10);
  EXPECT_LT(motion.energy_error, 1e-10);
}

std::string why_refused(const Scene& scene, const std::map<std::string, double>& rates = {}) {
  return test::message_of([&] {
    const MotionModel model(scene);
    simulate(model, released(model, {}, rates), {.duration = 0.1});
  });
}

TEST(Blades, ThatHoldNothingAreRefusedByName) {
  const std::string fixed = R"(
[ground.points]
O = [0, 0]
[body.arm]
points = { O = [0, 0], A = [1, 0] }
mass = 1
[[pin]]
points = ["ground.O", "arm.O"]
[[blade]]
name = "idle"
at = "arm.O"
)";
  const std::string message = why_refused(parse_scene(fixed, "fixed.toml"));
  EXPECT_NE(message.find("fixed.toml:9: blade \"idle\".at: expected a point that can move"), std::string::npos)
      << message;
  const std::string twice = why_refused(knife(1.0,
                                              "[[blade]]\nname = \"twin\"\nat = \"plate.nose\"\n[[blade]]\nname = "
                                              "\"third\"\nat = \"plate.P\"\nangle = 3.141592653589793\n"));
  EXPECT_NE(twice.find("repeats those of the blades before it"), std::string::npos) << twice;
  const std::string start = why_refused(knife(1.0), {{"plate.y", 1.0}, {"plate", 0.5}});
  EXPECT_NE(start.find("blade \"edge\": the rates of the start would take plate.P across its edge"), std::string::npos)
      << start;
  const std::string rubs = why_refused(
      knife(1.0, "[[friction]]\nname = \"rub\"\nbodies = [\"ground\", \"plate\"]\ntorque = 1\nwidth = 0\n"));
  EXPECT_NE(rubs.find("friction that sticks is not treated beside blades"), std::string::npos) << rubs;
  const std::string ground = test::message_of([] {
    parse_scene("[ground.points]\nO = [0, 0]\n[body.a]\nmass = 1\n[[blade]]\nat = \"ground.O\"\n", "ground.toml");
  });
  EXPECT_NE(ground.find("ground.toml:6: blade 1.at: expected a point of a body that can move"), std::string::npos)
      << ground;
}

}  // namespace
}  // namespace poise::blades_test
