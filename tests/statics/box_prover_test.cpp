#include "statics/all_equilibria/private/box_prover.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "model/scene.hpp"
#include "solvers/newton.hpp"
#include "statics/all_equilibria/private/enclosed_set.hpp"
#include "statics/all_equilibria/turns.hpp"
#include "statics/model/held_rows.hpp"
#include "statics/model/mobility.hpp"
#include "statics/proof/certificate.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/busy_machine.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/seed.hpp"

namespace poise::box_prover_test {
namespace {

EnclosedSet enclosed(const StaticModel& model, const AllEquilibriaOptions& options = {}) {
  const Turns turns(model);
  LoopTurns loops(model, turns, analyse_mobility(model).x);
  return enclose_equilibria(model, loops, options);
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

struct Known {
  const char* scene;
  std::size_t equilibria;
};

// What references and closed forms count.
class KnownSets : public testing::TestWithParam<Known> {};

TEST_P(KnownSets, AreProvedComplete) {
  const StaticModel model(read_scene(test::dataset(GetParam().scene)));
  const EquilibriumSet set = all_equilibria(model, {.settling = false});
  EXPECT_EQ(set.claim, Claim::complete) << set.statement;
  EXPECT_TRUE(set.undecided.empty());
  EXPECT_EQ(set.equilibria.size(), GetParam().equilibria);
  EXPECT_NEAR(set.decided, 1.0, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Datasets, KnownSets,
                         testing::Values(Known{"four_bar_gravity.toml", 4}, Known{"four_bar_torsion.toml", 4},
                                         Known{"heaton_timme.toml", 4}, Known{"zeeman.toml", 2},
                                         Known{"tip_force_chain.toml", 32}, Known{"pendulum_chain.toml", 8},
                                         Known{"pendulum_a01.toml", 2}, Known{"hencky_cantilever.toml", 19},
                                         Known{"von_mises_toggle.toml", 3}, Known{"toggle.toml", 4},
                                         Known{"inverted_pendulum_torsion.toml", 11},
                                         Known{"hard/follower_four_bar.toml", 4}, Known{"hard/follower_arm.toml", 2}),
                         [](const auto& known) {
                           std::string name = known.param.scene;
                           name.resize(name.find('.'));
                           std::replace(name.begin(), name.end(), '/', '_');
                           return name;
                         });

// n links of 1 m with torsion springs of 1 N m/rad, pushed back along themselves by kappa N at the tip. Balance of link
// i gives  phi_{i+1} = 2 phi_i - phi_{i-1} - kappa sin phi_i,  phi_0 = 0; equilibria are the phi_1 for which
// phi_{n+1} = phi_n, with |phi_1| <= n kappa.
TEST(BoxProver, ProvesAllBuckledShapesThatShootingMeets) {
  struct Case {
    int links;
    double kappa;
  };
  for (const Case& c : {Case{3, 4.0}, Case{4, 4.0}, Case{4, 8.0}, Case{6, 2.0}, Case{6, 4.0}}) {
    SCOPED_TRACE(testing::Message() << c.links << " links, kappa " << c.kappa);
    const auto end = [&](double phi) {
      double before = 0.0;
      for (int i = 0; i < c.links; ++i) {
        const double next = 2 * phi - before - c.kappa * std::sin(phi);
        before = std::exchange(phi, next);
      }
      return phi - before;
    };
    constexpr int steps = 4'000'000;
    const double reach = c.links * c.kappa + 1.0;
    std::size_t shapes = 0;
    double last = end(-reach);
    for (int k = 1; k < steps; k += 2) {
      const double now = end(reach * (2.0 * k / steps - 1.0));
      if ((now > 0) != (last > 0)) ++shapes;
      last = now;
    }
    Scene scene = test::chain(c.links, 1.0, 0.0);
    for (int i = 1; i <= c.links; ++i) test::add_torsion_spring(scene, i - 1, i, 1.0);
    test::add_force(scene, std::to_string(c.links) + ".b", {-c.kappa, 0.0}, "P");
    const StaticModel model(scene);
    const EnclosedSet set = enclosed(model);
    EXPECT_TRUE(set.applies) << set.why_not;
    EXPECT_TRUE(set.undecided.empty());
    EXPECT_EQ(set.found.size(), shapes);
    // Energy grows without bound, so that its stationary points sum up to one (Morse).
    int sum = 0;
    for (const std::vector<double>& x : set.found) sum += certify(model, x).unstable_directions % 2 == 0 ? 1 : -1;
    EXPECT_EQ(sum, 1);
  }
}

// Scenes of all kinds of terms: loops, chains, both together, lengths, springs between bodies, following loads.
std::vector<Scene> scenes_without_stops() {
  std::vector<Scene> out;
  for (const char* scene :
       {"four_bar_gravity.toml", "four_bar_torsion.toml", "heaton_timme.toml", "six_bar.toml",
        "vertical_slider_crank.toml", "andrews.toml", "tip_force_chain.toml", "zeeman.toml", "hencky_cantilever.toml",
        "hard/ziegler.toml", "hard/follower_four_bar.toml", "toggle.toml", "hard/rhombus.toml"}) {
    out.push_back(read_scene(test::dataset(scene)));
  }
  Scene& hung = out.emplace_back(out.front());
  hung.title = "Four-bar with a pendulum on its coupler, and a spring between them";
  const int link = test::add_link(hung, "hung", 1.0, 1.0);
  test::add_pin(hung, "coupler.C", "hung.a");
  test::add_torsion_spring(hung, 2, link, 1.0);
  hung.start.angle.back() = -1.0;
  return out;
}

// From random starts: nothing is proved here.
std::vector<std::vector<double>> some_equilibria(const StaticModel& model) {
  std::vector<std::vector<double>> out;
  for (const Equilibrium& one : all_equilibria(model, {.seconds = 0.0, .starts = 200, .settling = false}).equilibria) {
    out.push_back(one.x);
  }
  return out;
}

// Boxes of all sizes that hold a known equilibrium, often close to their faces, are not called empty and keep it.
TEST(BoxProver, NeverLosesAnEquilibrium) {
  std::mt19937_64 random(test::seed(11));
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (const Scene& scene : scenes_without_stops()) {
    SCOPED_TRACE(scene.title);
    const StaticModel model(scene);
    const std::vector<std::vector<double>> known = some_equilibria(model);
    ASSERT_FALSE(known.empty());
    BoxProver prover(model, std::vector<StopState>(model.mechanism().stops(), StopState::inactive), 0);
    for (int k = 0; k < 2000; ++k) {
      const std::vector<double>& x = known[static_cast<std::size_t>(k) % known.size()];
      CoordinateBox box(x.size());
      const double size = std::pow(10.0, -7.0 * share(random) + 0.3);
      for (std::size_t i = 0; i < x.size(); ++i) {
        const double width = size * std::pow(10.0, -share(random));
        const double below = k % 3 == 0 ? 1e-11 : share(random) * width;
        box[i] = Interval(x[i] - below, x[i] + (k % 3 == 1 ? 1e-11 : width));
      }
      const solvers::RoundingUp up;
      const BoxProver::Decision decision = prover.examine(box).decision;
      ASSERT_NE(decision, BoxProver::Decision::empty) << k;
      ASSERT_NE(decision, BoxProver::Decision::locked) << k;
      for (std::size_t i = 0; i < x.size(); ++i) {
        ASSERT_LE(box[i].lower(), x[i] + 1e-12) << k;
        ASSERT_GE(box[i].upper(), x[i] - 1e-12) << k;
      }
    }
  }
}

// Closed poses that are no equilibria stay in their boxes while only closures narrow them.
TEST(BoxProver, ClosuresKeepEveryClosedPose) {
  std::mt19937_64 random(test::seed(5));
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (const char* scene : {"four_bar_gravity.toml", "six_bar.toml", "vertical_slider_crank.toml", "andrews.toml",
                            "lift.toml", "scissor_lift.toml"}) {
    SCOPED_TRACE(scene);
    const StaticModel model(read_scene(test::dataset(scene)));
    BoxProver prover(model, std::vector<StopState>(model.mechanism().stops(), StopState::inactive), 0);
    int closed = 0;
    for (int k = 0; k < 2000; ++k) {
      std::vector<double> x = model.start();
      for (double& value : x) value += 6.0 * (share(random) - 0.5);
      solvers::Newton newton(model.problem());
      const solvers::NewtonResult& pose = newton.close(x);
      if (pose.end != solvers::NewtonEnd::converged) continue;
      ++closed;
      CoordinateBox box(x.size());
      for (std::size_t i = 0; i < x.size(); ++i) {
        const double width = std::pow(10.0, -3.0 * share(random) + 0.5);
        box[i] = Interval(pose.x[i] - (k % 2 == 0 ? 1e-9 : share(random) * width), pose.x[i] + width);
      }
      const solvers::RoundingUp up;
      ASSERT_TRUE(prover.contract(box)) << k;
      for (std::size_t i = 0; i < x.size(); ++i) {
        ASSERT_LE(box[i].lower(), pose.x[i] + 1e-10) << k;
        ASSERT_GE(box[i].upper(), pose.x[i] - 1e-10) << k;
      }
    }
    EXPECT_GT(closed, 100);
  }
}

// A crank of 1 m drives a table that slides along y on a block that slides along x: with the crank's angle given both
// travels follow, and with one of them given the angle, on either side.
StaticModel cross_slide(const std::string& stops = "") {
  return test::model_of(R"(
[ground]
points = { O = [0, 0], S = [0, 0], A = [2, 1] }
[body.crank]
points = { O = [0, 0], B = [1, 0] }
mass = 1
center = [1, 0]
[body.block]
points = { C = [0, 0] }
[body.table]
points = { B = [0, 0] }
[[pin]]
points = ["ground.O", "crank.O"]
[[slide]]
name = "x"
points = ["ground.S", "block.C"]
axis = [1, 0]
[[slide]]
name = "y"
points = ["block.C", "table.B"]
axis = [0.6, 0.8]
[[pin]]
points = ["crank.B", "table.B"]
)" + stops + R"(
[start]
crank = 0.5
)");
}

// Poses between the limits of stops, often at one of them, stay in their boxes.
TEST(BoxProver, StopsKeepEveryPoseBetween) {
  const StaticModel model = cross_slide(R"(
[[stop]]
name = "x"
slide = "x"
min = -0.3
max = 0.9
[[stop]]
name = "distance"
points = ["ground.A", "crank.B"]
min = 1.3
max = 2.6
)");
  const double size = model.scales().length;
  BoxProver prover(model, std::vector<StopState>(2, StopState::inactive), 0);
  std::mt19937_64 random(test::seed(31));
  std::uniform_real_distribution<double> share(0.0, 1.0);
  const auto travels = [](double t) { return Vec2{std::cos(t) - 0.75 * std::sin(t), 1.25 * std::sin(t)}; };
  const auto is_between = [&](double t) {
    const double x = travels(t).x;
    const double distance = std::hypot(2 - std::cos(t), 1 - std::sin(t));
    return x >= -0.3 && x <= 0.9 && distance >= 1.3 && distance <= 2.6;
  };
  int between = 0;
  int at_a_limit = 0;
  for (int k = 0; k < 4000; ++k) {
    double t = M_PI * (2.0 * share(random) - 1.0);
    if (!is_between(t)) continue;
    ++between;
    if (const double beyond = t + 0.5; k % 3 == 0 && !is_between(beyond)) {
      double above = beyond;
      for (int halving = 0; halving < 60; ++halving) {
        const double middle = 0.5 * (t + above);
        (is_between(middle) ? t : above) = middle;
      }
      ++at_a_limit;
    }
    const double pose[] = {t, travels(t).x / size, travels(t).y / size};
    CoordinateBox box(3);
    for (std::size_t i = 0; i < 3; ++i) {
      const double width = std::pow(10.0, -4.0 * share(random) + 0.5);
      box[i] = Interval(pose[i] - (k % 2 == 0 ? 1e-9 : share(random) * width), pose[i] + width);
    }
    const solvers::RoundingUp up;
    ASSERT_TRUE(prover.contract(box)) << k;
    for (std::size_t i = 0; i < 3; ++i) {
      ASSERT_LE(box[i].lower(), pose[i] + 1e-12) << k;
      ASSERT_GE(box[i].upper(), pose[i] - 1e-12) << k;
    }
  }
  EXPECT_GT(between, 200);
  EXPECT_GT(at_a_limit, 50);
}

// All coordinates but two or three are known to 1e-13: then closures tell the others nearly as well, and a sliver too
// much off any bound loses the pose. Of those that are left open the pose is often at a face.
TEST(BoxProver, ClosuresKeepAPoseThatIsNearlyKnown) {
  std::mt19937_64 random(test::seed(23));
  std::uniform_real_distribution<double> share(0.0, 1.0);
  std::vector<Scene> scenes{cross_slide().scene()};
  for (const char* scene : {"four_bar_gravity.toml", "six_bar.toml", "vertical_slider_crank.toml", "andrews.toml"}) {
    scenes.push_back(read_scene(test::dataset(scene)));
  }
  for (const Scene& scene : scenes) {
    SCOPED_TRACE(scene.title);
    const StaticModel model(scene);
    BoxProver prover(model, std::vector<StopState>(model.mechanism().stops(), StopState::inactive), 0);
    int closed = 0;
    int narrowed = 0;
    for (int k = 0; k < 1000; ++k) {
      std::vector<double> x = model.start();
      for (double& value : x) value += 6.0 * (share(random) - 0.5);
      solvers::Newton newton(model.problem());
      const solvers::NewtonResult& pose = newton.close(x);
      if (pose.end != solvers::NewtonEnd::converged) continue;
      ++closed;
      const std::size_t n = x.size();
      CoordinateBox box(n);
      for (std::size_t i = 0; i < n; ++i) box[i] = Interval(pose.x[i] - 1e-13, pose.x[i] + 1e-13);
      std::vector<std::size_t> open;
      for (int o = 0; o < 2 + k % 2; ++o) open.push_back(random() % n);
      for (const std::size_t i : open) {
        const double width = 6.0 * std::pow(share(random), 3.0) + 1e-3;
        const double below = k % 3 == 0 ? 1e-13 : (k % 3 == 1 ? width : share(random) * width);
        box[i] = Interval(pose.x[i] - below, pose.x[i] - below + width + 1e-13);
      }
      const solvers::RoundingUp up;
      ASSERT_TRUE(prover.contract(box, false)) << k;
      for (std::size_t i = 0; i < n; ++i) {
        ASSERT_LE(box[i].lower(), pose.x[i] + 1e-12) << k;
        ASSERT_GE(box[i].upper(), pose.x[i] - 1e-12) << k;
      }
      narrowed += widest(box) < 1e-6 ? 1 : 0;
    }
    EXPECT_GT(closed, 100);
    EXPECT_GT(narrowed, 50);
  }
}

// What is called unique is an equilibrium, within the box or a little beside it.
TEST(BoxProver, CallsNothingElseAnEquilibrium) {
  std::mt19937_64 random(test::seed(31));
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (const Scene& scene : scenes_without_stops()) {
    SCOPED_TRACE(scene.title);
    const StaticModel model(scene);
    const std::vector<std::vector<double>> known = some_equilibria(model);
    ASSERT_FALSE(known.empty());
    BoxProver prover(model, std::vector<StopState>(model.mechanism().stops(), StopState::inactive), 0);
    int unique = 0;
    for (int k = 0; k < 2000; ++k) {
      const std::vector<double>& x = known[static_cast<std::size_t>(k) % known.size()];
      CoordinateBox box(x.size());
      const double size = std::pow(10.0, -4.0 * share(random));
      for (std::size_t i = 0; i < x.size(); ++i) {
        const double middle = x[i] + 1.5 * size * (share(random) - 0.5);
        box[i] = Interval(middle - 0.5 * size, middle + 0.5 * size);
      }
      BoxProver::Verdict verdict;
      {
        const solvers::RoundingUp up;
        verdict = prover.examine(box);
      }
      if (verdict.decision != BoxProver::Decision::unique) continue;
      ++unique;
      double nearest = 1.0;
      for (const std::vector<double>& y : known) nearest = std::min(nearest, distance(y, verdict.at));
      if (nearest < 1e-9) continue;
      // Random starts can miss some.
      const Equilibrium another = solve(model, verdict.at, {.seek = Seek::any});
      ASSERT_TRUE(another.certificate.confirmed()) << k;
      ASSERT_LT(distance(another.x, verdict.at), 1e-9) << k;
    }
    EXPECT_GT(unique, 10);
  }
}

// The weight of a block on a vertical rail has one sign everywhere; it rests on the stop.
TEST(EnclosedSet, FindsWhatOnlyAStopHolds) {
  Scene scene = read_scene(test::dataset("von_mises_toggle.toml"));
  scene.elements.clear();
  ASSERT_EQ(scene.stops.size(), 0U);
  test::add_stop(scene, "floor", Measure::travel_of(0), -0.25, 0.75);
  const EquilibriumSet set = all_equilibria(StaticModel(scene), {.settling = false});
  EXPECT_EQ(set.claim, Claim::complete) << set.statement;
  ASSERT_EQ(set.equilibria.size(), 1U);
  EXPECT_EQ(set.equilibria[0].certificate.active_stops, std::vector<int>{0});
}

// The toggle's stable equilibria lie beyond both limits, the unstable one between them; it rests on either.
TEST(EnclosedSet, FindsWhatStandsBetweenStopsAndOnThem) {
  Scene scene = read_scene(test::dataset("von_mises_toggle.toml"));
  test::add_stop(scene, "stop", Measure::travel_of(0), 0.0, 0.3);
  scene.start.travel[0] = 0.1;
  const EquilibriumSet set = all_equilibria(StaticModel(scene), {.settling = false});
  EXPECT_EQ(set.claim, Claim::complete) << set.statement;
  EXPECT_EQ(set.equilibria.size(), 3U);
}

// A stop presses however far its spring has wound up: the spring's stiffness bounds no angle then.
TEST(EnclosedSet, FindsASpringThatIsPreloadedAgainstAStop) {
  Scene scene = read_scene(test::dataset("inverted_pendulum_torsion.toml"));
  test::add_stop(scene, "stop", Measure::angle_between(0, 1), 40.0, 41.0);
  scene.start.angle[1] = 40.5;
  const EquilibriumSet set = all_equilibria(StaticModel(scene), {.settling = false});
  EXPECT_EQ(set.claim, Claim::complete) << set.statement;
  ASSERT_EQ(set.equilibria.size(), 1U);
  EXPECT_EQ(set.equilibria[0].certificate.active_stops, std::vector<int>{0});
}

// The same block under a ceiling, with gravity turned round.
TEST(EnclosedSet, FindsWhatOnlyAnUpperLimitHolds) {
  Scene scene = read_scene(test::dataset("von_mises_toggle.toml"));
  scene.elements.clear();
  scene.gravity = -1.0 * scene.gravity;
  for (Force& force : scene.forces) force.vector = -1.0 * force.vector;
  test::add_stop(scene, "ceiling", Measure::travel_of(0), -0.25, 0.75);
  const EquilibriumSet set = all_equilibria(StaticModel(scene), {.settling = false});
  EXPECT_EQ(set.claim, Claim::complete) << set.statement;
  ASSERT_EQ(set.equilibria.size(), 1U);
  EXPECT_EQ(set.equilibria[0].certificate.active_stops, std::vector<int>{0});
}

// A pendulum that starts at any angle hangs at the same one: at the face where the first box is halved, opposite to the
// start, or elsewhere.
TEST(EnclosedSet, HasNoGapsBetweenItsBoxes) {
  Scene scene = read_scene(test::dataset("pendulum_a01.toml"));
  const double full = 2.0 * 3.1416;
  for (const double share : {0.0, 0.4871, 0.4871 * 0.4871, 0.4871 * 1.5129, 0.5, 1.0}) {
    for (const double by : {-5e-7, 0.0, 5e-7}) {
      // Share of the first box below the place where it hangs.
      scene.start.angle[1] = -0.5 * M_PI + 0.5 * full - share * full + by;
      const EnclosedSet set = enclosed(StaticModel(scene));
      ASSERT_TRUE(set.applies) << set.why_not;
      const auto hangs = [](const std::vector<double>& x) { return std::sin(x[0]) < -1.0 + 1e-12; };
      const bool inside = full * std::min(share, 1.0 - share) > 1e-5;
      if (inside) {
        EXPECT_TRUE(std::any_of(set.found.begin(), set.found.end(), hangs)) << share << ' ' << by;
      }
      const EquilibriumSet all = all_equilibria(StaticModel(scene), {.settling = false});
      EXPECT_EQ(all.claim, Claim::complete) << all.statement;
      EXPECT_EQ(all.equilibria.size(), 2U) << share << ' ' << by;
    }
  }
}

// The same eleven equilibria, ten turns further.
TEST(EnclosedSet, BoundsAnglesAroundWhereTheirSpringsAreFree) {
  Scene scene = read_scene(test::dataset("inverted_pendulum_torsion.toml"));
  std::get<LinearSpring>(scene.elements.at(0).law).free_length += 20.0 * M_PI;
  const EquilibriumSet set = all_equilibria(StaticModel(scene), {.settling = false});
  EXPECT_EQ(set.claim, Claim::complete) << set.statement;
  EXPECT_EQ(set.equilibria.size(), 11U);
}

// Of the eleven, eight are below the stop, and on it the weight presses: theta < 20 sin theta at 7.5 rad.
TEST(EnclosedSet, BoundsAnglesOnWhichSpringsAndAStopAct) {
  Scene scene = read_scene(test::dataset("inverted_pendulum_torsion.toml"));
  scene.start.angle = {std::nullopt, 2.99 + 0.5 * M_PI};
  test::add_stop(scene, "stop", 0, 1, -std::numeric_limits<double>::infinity(), 7.5 + 0.5 * M_PI);
  const EquilibriumSet set = all_equilibria(StaticModel(scene), {.settling = false});
  EXPECT_EQ(set.claim, Claim::complete) << set.statement;
  EXPECT_FALSE(set.angles_within.has_value());
  EXPECT_EQ(set.equilibria.size(), 9U);
}

// Two rods on soft torsion springs, with a stop between them: whatever random starts meet is in the set.
TEST(EnclosedSet, BoundsAnglesBetweenWhichAStopActs) {
  Scene scene = read_scene(test::dataset("inverted_pendulum_torsion.toml"));
  const int second = test::add_link(scene, "second", 1.0, 1.0);
  test::add_pin(scene, "rod.tip", "second.a");
  test::add_torsion_spring(scene, 1, second, 1.5, 0.5);
  scene.start.angle = {std::nullopt, 1.0, 1.5};
  test::add_stop(scene, "stop", 1, second, -1.0, std::numeric_limits<double>::infinity());
  const StaticModel model(scene);
  const EquilibriumSet set = all_equilibria(model, {.settling = false});
  EXPECT_EQ(set.claim, Claim::complete) << set.statement;
  EXPECT_FALSE(set.angles_within.has_value());
  int on_stop = 0;
  for (const std::vector<double>& x : some_equilibria(model)) {
    double nearest = 1.0;
    for (const Equilibrium& one : set.equilibria) nearest = std::min(nearest, distance(one.x, x));
    EXPECT_LT(nearest, 1e-9);
    on_stop += std::abs(x[1] - x[0] + 1.0) < 1e-9 ? 1 : 0;
  }
  EXPECT_GT(on_stop, 0);
  EXPECT_GT(set.equilibria.size(), 30U);
}

// At every turn the spring winds the tip of the rod down onto the floor, on one side of it.
TEST(EnclosedSet, BoundsNoAnglesOnWhichOtherStopsPress) {
  Scene scene = read_scene(test::dataset("inverted_pendulum_torsion.toml"));
  test::add_stop(scene, "floor", Measure::y_of(test::point(scene, "rod.tip")), 0.5);
  const EquilibriumSet set = all_equilibria(StaticModel(scene), {.settling = false});
  EXPECT_EQ(set.claim, Claim::complete) << set.statement;
  EXPECT_TRUE(set.angles_within.has_value());
}

// A rod hangs on the stop of a body that is welded to it at an angle: its own angle is between -1.2 and -0.2 rad.
TEST(EnclosedSet, BoundsAnglesByStopsOfWhatIsWeldedToThem) {
  const StaticModel model = test::model_of(R"(
gravity = [0, -9.81]
[ground]
points = { O = [0, 0] }
[body.rod]
points = { O = [0, 0], E = [1, 0] }
mass = 1
center = [1, 0]
[body.cam]
points = { E = [0, 0] }
[[pin]]
points = ["ground.O", "rod.O"]
[[weld]]
points = ["rod.E", "cam.E"]
angle = 0.7
[[stop]]
name = "stop"
bodies = ["ground", "cam"]
min = -0.5
max = 0.5
[start]
rod = -0.8
)");
  const EnclosedSet set = enclosed(model);
  ASSERT_TRUE(set.applies) << set.why_not;
  EXPECT_TRUE(set.undecided.empty());
  ASSERT_EQ(set.found.size(), 1U);
  EXPECT_NEAR(set.found[0][0], -1.2, 1e-12);
}

// A crank-rocker whose springs wind up with every round of the crank, against the places where the force along its
// curves of poses changes its sign.
TEST(EnclosedSet, CountsTheEquilibriaOfEveryRound) {
  for (const auto& [crank, far_stop] : {std::pair(1, false), std::pair(1, true), std::pair(3, false)}) {
    SCOPED_TRACE(far_stop);
    Scene scene = read_scene(test::dataset("four_bar_gravity.toml"));
    if (crank == 3) std::swap(scene.bodies[1].points[1].at, scene.bodies[3].points[1].at);
    test::add_torsion_spring(scene, 0, crank, 0.6, 1.0);
    test::add_torsion_spring(scene, std::min(crank, 2), std::max(crank, 2), 0.25);
    // With a stop that nothing reaches rounds are examined one by one, without it together.
    if (far_stop) test::add_stop(scene, "far", 0, 4 - crank, -40.0, 40.0);
    const StaticModel model(scene);
    const Turns turns(model);
    LoopTurns loops(model, turns, analyse_mobility(model).x);
    ASSERT_TRUE(loops.known());
    ASSERT_TRUE(loops.winds());
    const EnclosedSet set = enclose_equilibria(model, loops, {});
    ASSERT_TRUE(set.applies) << set.why_not;
    EXPECT_TRUE(set.undecided.empty());
    const std::vector<std::vector<double>> expected = loops.changes_of_force();
    ASSERT_GT(expected.size(), 10U);
    for (const std::vector<double>& x : expected) {
      const bool is_there = std::any_of(set.found.begin(), set.found.end(),
                                        [&](const std::vector<double>& y) { return turns.distance(x, y) < 0.1; });
      EXPECT_TRUE(is_there) << x[0] << ' ' << x[1] << ' ' << x[2];
    }
  }
}

TEST(EnclosedSet, IsTheSameOnSeveralThreads) {
  const StaticModel model(read_scene(test::dataset("six_bar.toml")));
  EXPECT_EQ(enclosed(model, {.jobs = 1}).found.size(), enclosed(model, {.jobs = 4}).found.size());
}

TEST(EnclosedSet, CallsACurveOfEquilibriaNeutral) {
  const StaticModel model(read_scene(test::dataset("hard/balanced_arm.toml")));
  const EnclosedSet set = enclosed(model);
  ASSERT_TRUE(set.applies) << set.why_not;
  ASSERT_FALSE(set.undecided.empty());
  EXPECT_TRUE(set.undecided.front().neutral) << set.undecided.front().why;
}

// A rhombus has three poses in which all bars lie in one line, where no finite joint forces bear its weight.
TEST(EnclosedSet, SetsSingularPosesOfARhombusApart) {
  const StaticModel model(read_scene(test::dataset("hard/rhombus.toml")));
  const EnclosedSet set = enclosed(model);
  ASSERT_TRUE(set.applies) << set.why_not;
  EXPECT_TRUE(set.undecided.empty());
  EXPECT_EQ(set.found.size(), 6U);
  ASSERT_EQ(set.singular.size(), 3U);
  for (const UndecidedBox& box : set.singular) {
    for (std::size_t i = 0; i < box.lower.size(); ++i) {
      const double half_turns = std::round(box.lower[i] / M_PI);
      EXPECT_LT(box.lower[i], half_turns * M_PI);
      EXPECT_GT(box.upper[i], half_turns * M_PI);
      EXPECT_LT(box.upper[i] - box.lower[i], 1e-5);
    }
  }
  const EquilibriumSet all = all_equilibria(model, {.settling = false});
  EXPECT_EQ(all.claim, Claim::complete) << all.statement;
  EXPECT_NE(all.statement.find("any in 3 singular positions would need"), std::string::npos) << all.statement;
}

// A third crank repeats what two of them do. Of a parallelogram under a vertical load W and a torque T on one crank,
// cos(theta) = T / (W times length of the crank); its antiparallelograms do not fit the third crank.
TEST(EnclosedSet, JointsThatRepeatOthersAreLeftOutOfBalance) {
  Scene scene = read_scene(test::dataset("redundant_parallelogram.toml"));
  scene.elements.clear();
  const EquilibriumSet set = all_equilibria(StaticModel(scene), {.settling = false});
  EXPECT_EQ(set.claim, Claim::complete) << set.statement;
  EXPECT_NE(set.statement.find("repeat others (B2, B3), checked every 0.01 rad"), std::string::npos) << set.statement;
  EXPECT_EQ(set.singular.size(), 2U);
  ASSERT_EQ(set.equilibria.size(), 2U);
  for (const Equilibrium& equilibrium : set.equilibria) {
    for (int crank = 0; crank < 3; ++crank) EXPECT_NEAR(std::abs(equilibrium.x[crank]), 1.0, 1e-9);
  }
}

constexpr const char* plate_on_three_cranks = R"(
gravity = [0, -10]
[ground]
points = { A = [0, 0], B = [1, 0], C = [0.4, 0.7] }
[body.plate]
points = { A = [0, 0], B = [1, 0], C = [0.4, 0.7] }
mass = 1
center = [0.3, 0.2]
[body.a]
points = { O = [0, 0], E = [0.5, 0] }
[body.b]
points = { O = [0, 0], E = [0.5, 0] }
[body.c]
points = { O = [0, 0], E = [0.5, 0] }
[[pin]]
points = ["ground.A", "a.O"]
[[pin]]
points = ["ground.B", "b.O"]
[[pin]]
points = ["ground.C", "c.O"]
[[pin]]
points = ["plate.A", "a.E"]
[[pin]]
points = ["plate.B", "b.E"]
[[pin]]
points = ["plate.C", "c.E"]
[start]
a = 0.3
b = 0.3
c = 0.3
)";

// The third crank repeats what two do while all are parallel: V = m g (y_center + l sin(theta)), -3 and 7 J at theta =
// -+ pi / 2. In the two poses where the cranks cross it does not, and the plate rests there under any load.
TEST(EnclosedSet, FindsRigidPosesWhereJointsRepeatOthersElsewhere) {
  Scene scene = parse_scene(plate_on_three_cranks, "plate");
  EquilibriumSet set = all_equilibria(StaticModel(scene), {.settling = false});
  EXPECT_EQ(set.claim, Claim::complete) << set.statement;
  ASSERT_EQ(set.equilibria.size(), 4U);
  EXPECT_NEAR(set.equilibria.front().energy.value(), -3.0, 1e-9);
  EXPECT_NEAR(set.equilibria.back().energy.value(), 7.0, 1e-9);
  for (const std::size_t k : {std::size_t{1}, std::size_t{2}}) {
    EXPECT_EQ(freedoms_of(StaticModel(scene), set.equilibria[k].x), 0);
  }

  // A stop that is passed in one of them.
  test::add_stop(scene, "stop", 0, 1, -0.5, 1.5);
  set = all_equilibria(StaticModel(scene), {.settling = false});
  EXPECT_EQ(set.claim, Claim::complete) << set.statement;
  EXPECT_EQ(set.equilibria.size(), 3U);
}

// With a spring on a crank its turns count, also in rigid poses: there those next to the start do. Near one of them the
// balance along two cranks alone has a solution, in which the third does not close.
TEST(EnclosedSet, CountsRigidPosesAtOneTurn) {
  Scene scene = parse_scene(plate_on_three_cranks, "plate");
  scene.bodies[1].center = {-0.8, -0.6};
  test::add_torsion_spring(scene, 0, 2, 5.0);
  const EquilibriumSet set = all_equilibria(StaticModel(scene), {.settling = false});
  EXPECT_EQ(set.claim, Claim::complete) << set.statement;
  int rigid = 0;
  for (const Equilibrium& equilibrium : set.equilibria) {
    rigid += freedoms_of(StaticModel(scene), equilibrium.x) == 0 ? 1 : 0;
  }
  EXPECT_EQ(rigid, 2) << set.statement;
  EXPECT_EQ(set.equilibria.size(), 3U);
}

// Another freedom besides: nothing is proved where joints do not repeat others in all poses.
TEST(EnclosedSet, SaysThatJointsDoNotRepeatOthersInAllPoses) {
  Scene scene = parse_scene(plate_on_three_cranks, "plate");
  const int arm = scene.add_body("arm");
  scene.bodies[arm].mass = 1.0;
  scene.bodies[arm].center = {0.2, 0.0};
  scene.add_point(arm, "O", {0.0, 0.0});
  test::add_pin(scene, "plate.C", "arm.O");
  const EquilibriumSet set = all_equilibria(StaticModel(scene), {.settling = false});
  EXPECT_EQ(set.claim, Claim::sampled);
  EXPECT_NE(set.statement.find("do not repeat them in all positions"), std::string::npos) << set.statement;
}

// The poses of a parallelogram and of its antiparallelogram cross where it lies flat, so that it is not known which
// turns of its torsion spring motion leads to: all within a turn are looked for.
TEST(EnclosedSet, LooksForTurnsThatMayBeReached) {
  const EquilibriumSet set = all_equilibria(
      StaticModel(read_scene(test::dataset("hard/flat_sprung_parallelogram.toml"))), {.settling = false});
  EXPECT_EQ(set.claim, Claim::complete) << set.statement;
  EXPECT_EQ(set.equilibria.size(), 3U);
  EXPECT_NE(set.statement.find("within a full turn of the start"), std::string::npos) << set.statement;
}

// Rows that are dependent in one pose alone repeat nothing: a chain pulled taut cannot move, and bears no load across.
TEST(EnclosedSet, ATautChainIsASingularPose) {
  const EquilibriumSet set =
      all_equilibria(StaticModel(read_scene(test::dataset("hard/taut.toml"))), {.settling = false});
  EXPECT_EQ(set.claim, Claim::complete) << set.statement;
  EXPECT_TRUE(set.equilibria.empty());
  EXPECT_EQ(set.singular.size(), 1U);
  EXPECT_EQ(set.statement.find("repeat"), std::string::npos) << set.statement;
}

// Two cranks of a parallelogram that lies flat turn down each on its own, so that both stops press, though elsewhere it
// has one freedom.
TEST(EnclosedSet, MoreStopsPressInASingularPoseThanElsewhere) {
  Scene scene = test::parallelogram(2, 0.5, 1.0);
  scene.torques.clear();
  scene.forces.clear();
  scene.add_point(3, "C", {0.4, 0.0});
  test::add_force(scene, "coupler.C", {0.0, -1.0}, "W");
  for (const char* end : {"0.b", "1.b"}) {
    test::add_stop(scene, end, Measure::y_of(test::point(scene, end)), 0.0);
  }
  const EquilibriumSet set = all_equilibria(StaticModel(scene), {.settling = false});
  const std::vector<double> flat{0.0, 0.0, 0.0};
  const auto holds_it = [&](const UndecidedBox& box) {
    for (std::size_t i = 0; i < flat.size(); ++i) {
      if (box.lower[i] > flat[i] || box.upper[i] < flat[i]) return false;
    }
    return true;
  };
  EXPECT_EQ(set.claim, Claim::incomplete) << set.statement;
  EXPECT_TRUE(std::any_of(set.undecided.begin(), set.undecided.end(), holds_it)) << set.statement;
}

// No box is small enough to tell what a spring does that is exactly at its limit; the certificate is.
TEST(EnclosedSet, SpringsAtTheirLimitsAreOnePlace) {
  for (const auto& [scene, equilibria] : {std::pair("hard/one_band.toml", 3U), std::pair("hard/just_taut.toml", 2U),
                                          std::pair("hard/two_rods_at_kinks.toml", 4U)}) {
    SCOPED_TRACE(scene);
    const EquilibriumSet set = all_equilibria(StaticModel(read_scene(test::dataset(scene))), {.settling = false});
    EXPECT_EQ(set.claim, Claim::complete) << set.statement;
    EXPECT_EQ(set.equilibria.size(), equilibria);
    EXPECT_NE(set.statement.find("one is given"), std::string::npos) << set.statement;
  }
}

TEST(EnclosedSet, SaysWhatIsUndecidedWhenItsWorkIsDone) {
  const StaticModel model(read_scene(test::dataset("hanging_chain_10.toml")));
  const double work = 1e4 * work_of_a_box(model.mechanism().coordinates());
  const EnclosedSet set = enclosed(model, {.work = work});
  EXPECT_FALSE(set.applies);
  EXPECT_TRUE(set.why_not.starts_with("the proof was not finished after ")) << set.why_not;
  // A round may examine a box more for each of its chunks.
  EXPECT_GE(set.boxes, 10000);
  EXPECT_LE(set.boxes, 10064);
  EXPECT_LT(set.decided, 1.0);
  ASSERT_FALSE(set.undecided.empty());
  EXPECT_EQ(set.undecided.front().why, "the boxes allowed were used up");
  // The same with more threads, on a machine that has more to do than it can.
  const test::BusyMachine busy;
  const EnclosedSet again = enclosed(model, {.work = work, .jobs = 3});
  EXPECT_EQ(again.why_not, set.why_not);
  EXPECT_EQ(again.boxes, set.boxes);
  EXPECT_EQ(again.decided, set.decided);
  EXPECT_EQ(again.found, set.found);
  ASSERT_EQ(again.undecided.size(), set.undecided.size());
  for (std::size_t k = 0; k < set.undecided.size(); ++k) {
    EXPECT_EQ(again.undecided[k].lower, set.undecided[k].lower);
    EXPECT_EQ(again.undecided[k].upper, set.undecided[k].upper);
  }
}

TEST(EnclosedSet, SaysThatATimeWasAskedFor) {
  const StaticModel model(read_scene(test::dataset("hanging_chain_10.toml")));
  const EnclosedSet set = enclosed(model, {.seconds = 0.05});
  EXPECT_FALSE(set.applies);
  EXPECT_TRUE(set.why_not.starts_with("the proof was not finished in 0.05 s, after ")) << set.why_not;
  ASSERT_FALSE(set.undecided.empty());
  EXPECT_EQ(set.undecided.front().why, "the time allowed was over");
}

}  // namespace
}  // namespace poise::box_prover_test
