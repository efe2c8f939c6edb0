// Load paths against closed forms and the reference answers.

#include "statics/paths/path.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/input_error.hpp"
#include "model/scene.hpp"
#include "statics/model/readings.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/known_answers.hpp"

namespace poise::path_test {
namespace {

using Kind = PathEvent::Kind;

std::vector<const PathEvent*> events(const Path& path, Kind kind) {
  std::vector<const PathEvent*> out;
  for (const PathEvent& event : path.events) {
    if (event.kind == kind) out.push_back(&event);
  }
  return out;
}

void expect_traced(const Path& path) {
  EXPECT_EQ(path.status, Path::Status::traced) << path.why;
  EXPECT_EQ(path.unproved(), 0);
}

void expect_relative(double value, double exact, double tolerance) {
  EXPECT_LE(std::abs(value - exact), tolerance * std::abs(exact)) << fmt::format("{:.17g} for {:.17g}", value, exact);
}

Scene von_mises(double b, double h, double stiffness) {
  return parse_scene(fmt::format(R"(
    [ground]
    points = {{ L = [{0}, 0], R = [{1}, 0], O = [0, 0] }}
    [body.apex]
    points = {{ C = [0, 0] }}
    [[slide]]
    name = "guide"
    points = ["ground.O", "apex.C"]
    axis = [0, 1]
    [[spring]]
    name = "left"
    points = ["ground.L", "apex.C"]
    stiffness = {2}
    free_length = {3:.17g}
    [[spring]]
    name = "right"
    points = ["ground.R", "apex.C"]
    stiffness = {2}
    free_length = {3:.17g}
    [[force]]
    name = "P"
    at = "apex.C"
    vector = [0, -1]
    [start]
    guide = {4}
  )",
                                 -b, b, stiffness, std::hypot(b, h), h),
                     "von_mises.toml");
}

// With springs of free length l between pivots b apart on each side, P = 2 k (l / L - 1) y is largest where the length
// L = (l b^2)^(1/3).
struct VonMisesFold {
  double height, load;
};
VonMisesFold von_mises_fold(double b, double h, double stiffness) {
  const double l = std::hypot(b, h), length = std::cbrt(l * b * b);
  const double y = std::sqrt(length * length - b * b);
  return {y, 2 * stiffness * (l / length - 1) * y};
}

TEST(Path, FindsTheSnapThroughOfVonMisesTruss) {
  const VariedScene varied(von_mises(1.0, 0.5, 1000.0), "load.P", 0.0, 60.0);
  const Path path = poise::path(varied);
  expect_traced(path);
  const auto folds = events(path, Kind::fold);
  ASSERT_FALSE(folds.empty());
  // static.vonmises.k1000_b1_h05.
  expect_relative(folds[0]->at.parameter, 42.9143257312246876869530451065, 1e-12);
  EXPECT_GE(folds[0]->digits(), 12);
  const auto snaps = events(path, Kind::snap);
  ASSERT_FALSE(snaps.empty());
  ASSERT_TRUE(snaps[0]->landing);
  EXPECT_EQ(snaps[0]->landing->stability, Stability::stable);
  EXPECT_EQ(snaps[0]->landing->proof, PointProof::proved);
  // It snaps to the other side: static.vonmises eqs.1 at P_limit to 10 digits.
  EXPECT_NEAR(snaps[0]->landing->x[0] * varied.scales().length, -0.588543535, 1e-8);
  EXPECT_LT(*snaps[0]->landing->energy, *snaps[0]->at.energy);
}

// A published check: half span 5 m, height 1 m, EA = 1280 MN; largest load 3790 kN at a deflection of 426.4 mm.
TEST(Path, MeetsAPublishedShallowTruss) {
  const double l = std::hypot(5.0, 1.0);
  const Path path = poise::path(VariedScene(von_mises(5.0, 1.0, 1280e6 / l), "load.P", 0.0, 5e6));
  const auto folds = events(path, Kind::fold);
  ASSERT_FALSE(folds.empty());
  const VonMisesFold exact = von_mises_fold(5.0, 1.0, 1280e6 / l);
  expect_relative(folds[0]->at.parameter, exact.load, 1e-12);
  EXPECT_NEAR(folds[0]->at.parameter / 1e3, 3790.0, 5.0);
  EXPECT_NEAR((1.0 - exact.height) * 1e3, 426.4, 0.1);
}

TEST(Path, FindsTheLargestLoadOfTheToggle) {
  Scene scene = read_scene(test::dataset("toggle.toml"));
  set_value(scene, "start.left", 0.2);
  set_value(scene, "start.right", -0.2);
  const Path path = poise::path(VariedScene(scene, "load.P", 0.0, 25.0));
  expect_traced(path);
  const auto folds = events(path, Kind::fold);
  ASSERT_FALSE(folds.empty());
  expect_relative(folds[0]->at.parameter, 18.4755402267485084790530026904, 1e-12);  // static.toggle
  EXPECT_NEAR(folds[0]->at.x[0], 0.115728901397237407646063382348, 1e-9);
}

std::string column(int links) {
  std::string text = "[ground]\npoints = { O = [0, 0] }\n";
  for (int i = 1; i <= links; ++i) {
    const std::string before = i == 1 ? "ground" : fmt::format("link{}", i - 1);
    text += fmt::format("[body.link{}]\npoints = {{ a = [0, 0], b = [1, 0] }}\n", i);
    text += fmt::format("[[pin]]\npoints = [\"{}.{}\", \"link{}.a\"]\n", before, i == 1 ? "O" : "b", i);
    text +=
        fmt::format("[[torsion_spring]]\nbodies = [\"{}\", \"link{}\"]\nstiffness = 1\nfree_angle = 0\n", before, i);
  }
  return text + fmt::format("[[force]]\nname = \"P\"\nat = \"link{}.b\"\nvector = [-1, 0]\n", links);
}

// Hencky's column: K = T - P I on the angles, T = tridiag(-1, 2, -1) with a last entry of 1, whose eigenvalues are
// 2 - 2 cos((2 j - 1) pi / (2 n + 1)).
TEST(Path, FindsTheCriticalLoadsOfColumnsWithTheirBranches) {
  for (int n = 2; n <= 10; ++n) {
    const VariedScene varied(parse_scene(column(n), "column.toml"), "load.P", 0.01, 4.0);
    const Path straight = poise::path(varied, {.spacing = 0.1});
    expect_traced(straight);
    const auto branches = events(straight, Kind::branch);
    ASSERT_EQ(branches.size(), static_cast<std::size_t>(n)) << n << " links";
    for (int j = 0; j < n; ++j) {
      expect_relative(branches[j]->at.parameter, 2 - 2 * std::cos((2 * j + 1) * M_PI / (2 * n + 1)), 1e-10);
    }
    if (n > 4) continue;
    // Two curves leave each of them, mirror images, with the buckled shape of its eigenvector.
    const Path all = poise::path(varied, {.branches = true, .spacing = 0.1});
    EXPECT_EQ(all.status, Path::Status::traced) << all.why;
    for (int j = 0; j < n; ++j) {
      std::vector<const PathBranch*> leaving;
      for (const PathBranch& branch : all.branches) {
        if (branch.from >= 0 && all.events[branch.from].kind == Kind::branch &&
            std::abs(all.events[branch.from].at.parameter - branches[j]->at.parameter) < 1e-9) {
          leaving.push_back(&branch);
        }
      }
      ASSERT_EQ(leaving.size(), 2U) << n << " links, load " << j;
      const std::vector<double>& first = leaving[0]->points[1].x;
      for (int i = 1; i < n; ++i) {
        const auto shape = [&](int k) { return std::sin((2 * j + 1) * M_PI * (k + 1) / (2 * n + 1)); };
        EXPECT_NEAR(first[i] / first[0], shape(i) / shape(0), 1e-3);
        EXPECT_NEAR(leaving[1]->points[1].x[i], -first[i], 1e-6);
      }
    }
  }
}

// Two equal pendulums, each upright with k = 1: both buckle at the load 1, and eight curves leave the point, those of
// either pendulum alone and of both.
TEST(Path, FollowsAllCurvesThroughAMultipleBranchPoint) {
  const std::string pendulum = R"(
    [body.{0}]
    points = {{ o = [0, 0], t = [0, 1] }}
    [[pin]]
    points = ["ground.{0}", "{0}.o"]
    [[torsion_spring]]
    bodies = ["ground", "{0}"]
    stiffness = 1
    free_angle = 0
    [[force]]
    name = "P{0}"
    at = "{0}.t"
    vector = [0, -1]
  )";
  const std::string text = "[ground]\npoints = { a = [0, 0], b = [3, 0] }\n" +
                           fmt::format(fmt::runtime(pendulum), "a") + fmt::format(fmt::runtime(pendulum), "b");
  const Path path =
      poise::path(VariedScene(parse_scene(text, "two.toml"), "loads", 0.2, 1.5), {.branches = true, .spacing = 0.1});
  EXPECT_EQ(path.status, Path::Status::traced) << path.why;
  const auto points = events(path, Kind::branch);
  ASSERT_EQ(points.size(), 1U);
  EXPECT_NEAR(points[0]->at.parameter, 1.0, 1e-10);
  ASSERT_EQ(path.branches.size(), 9U);
  std::vector<std::pair<int, int>> sides;
  for (std::size_t b = 1; b < path.branches.size(); ++b) {
    const PathPoint& last = path.branches[b].points.back();
    EXPECT_NEAR(last.parameter, 1.5, 1e-15);
    const auto sign = [](double v) { return v > 1e-6 ? 1 : v < -1e-6 ? -1 : 0; };
    sides.emplace_back(sign(last.x[0]), sign(last.x[1]));
    // t = 1.5 sin t on each pendulum that has buckled.
    for (const double t : last.x) EXPECT_NEAR(t, 1.5 * std::sin(t), 1e-14);
  }
  std::sort(sides.begin(), sides.end());
  EXPECT_EQ(std::unique(sides.begin(), sides.end()), sides.end());
}

// A bistable compliant four-bar as a rigid-link model: one torsion spring, at the ground pivot of the rocker of a
// crank-rocker (B. D. Jensen, L. L. Howell, "Identification of compliant pseudo-rigid-body four-link mechanism
// configurations resulting in bistable behavior", 2003, say where springs make such mechanisms bistable; the numbers
// are ours). V = k/2 (u - u0)^2 of the rocker's angle u, so that the moment on the crank is k (u - u0) du/dt with
// du/dt = r2 sin(w - t) / (r4 sin(w - u)), w the coupler's angle.
TEST(Path, GivesTheMomentOfABistableFourBar) {
  Scene scene = parse_scene(R"(
    units = { length = "mm", angle = "deg" }
    [ground]
    points = { A = [0, 0], D = [90, 0] }
    [body.crank]
    points = { A = [0, 0], B = [30, 0] }
    [body.coupler]
    points = { B = [0, 0], C = [80, 0] }
    [body.rocker]
    points = { D = [0, 0], C = [60, 0] }
    [[pin]]
    points = ["ground.A", "crank.A"]
    [[pin]]
    points = ["crank.B", "coupler.B"]
    [[pin]]
    points = ["coupler.C", "rocker.C"]
    [[pin]]
    points = ["ground.D", "rocker.D"]
    [[torsion_spring]]
    name = "flexure"
    bodies = ["ground", "rocker"]
    stiffness = 10
    free_angle = 110
    [start]
    crank = 60
    coupler = 30
    rocker = 110
  )",
                            "bistable.toml");
  const VariedScene varied(scene, "angle.crank", 30.0, 390.0);
  const Path path = poise::path(varied);
  expect_traced(path);
  ASSERT_EQ(path.branches.size(), 1U);
  const double k = scene.elements[0].law.index() == 0 ? std::get<LinearSpring>(scene.elements[0].law).stiffness : 0.0;
  int rests = 0;
  double before = 0.0;
  for (const PathPoint& point : path.branches[0].points) {
    const double t = point.x[0], w = point.x[1], u = point.x[2];
    EXPECT_NEAR(std::hypot(30 * std::cos(t) + 80 * std::cos(w) - 60 * std::cos(u) - 90,
                           30 * std::sin(t) + 80 * std::sin(w) - 60 * std::sin(u)),
                0.0, 1e-12);
    const double ratio = 30 * std::sin(w - t) / (60 * std::sin(w - u));
    EXPECT_NEAR(point.effort, k * (u - 110 * M_PI / 180) * ratio, 1e-10 * k);
    if (before < 0.0 && point.effort >= 0.0) ++rests;  // it resists being moved away on both sides
    before = point.effort;
  }
  EXPECT_EQ(rests, 2);
}

// static.hencky_cantilever n3_kappa4: nineteen equilibria, of which the curves through the straight column pass seven.
TEST(Path, FindsCurvesThatAreNotConnectedWithTheStart) {
  const VariedScene varied(parse_scene(column(3), "column.toml"), "load.P", 0.01, 4.0);
  const auto count_at_end = [&](int search) {
    const Path path = poise::path(varied, {.search = search, .branches = true, .at = {4.0}, .spacing = 0.1});
    EXPECT_EQ(path.status, Path::Status::traced) << path.why;
    EXPECT_EQ(path.unproved(), 0);
    std::vector<std::vector<double>> places;
    for (const PathPoint& point : path.wanted.at(0)) {
      const bool is_new = std::none_of(places.begin(), places.end(), [&](const std::vector<double>& x) {
        return std::abs(x[0] - point.x[0]) + std::abs(x[1] - point.x[1]) + std::abs(x[2] - point.x[2]) < 1e-6;
      });
      if (is_new) places.push_back(point.x);
    }
    return places.size();
  };
  EXPECT_EQ(count_at_end(0), 7U);
  EXPECT_EQ(count_at_end(300), 19U);
}

// A range that begins just below a fold, by less than any first step: the curve leads into it, and out again behind
// the fold.
TEST(Path, FindsAFoldNextToItsStart) {
  const double load = von_mises_fold(1.0, 0.5, 1000.0).load;
  for (const double below : {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9}) {
    SCOPED_TRACE(below);
    const Path path = poise::path(VariedScene(von_mises(1.0, 0.5, 1000.0), "load.P", (1.0 - below) * load, 2.0 * load));
    expect_traced(path);
    const auto folds = events(path, Kind::fold);
    ASSERT_EQ(folds.size(), 1U);
    expect_relative(folds[0]->at.parameter, load, 1e-12);
    EXPECT_EQ(events(path, Kind::snap).size(), 1U);
  }
}

// theta - e = lambda sin theta: static.inverted_pendulum_imperfect, on the side that the offset does not favour.
TEST(Path, FindsTheFoldsOfImperfectPendulums) {
  const auto fold = [](double e) {
    const Scene scene = parse_scene(fmt::format(R"(
      [ground]
      points = {{ O = [0, 0] }}
      [body.rod]
      points = {{ O = [0, 0], tip = [0, 1] }}
      [[pin]]
      points = ["ground.O", "rod.O"]
      [[torsion_spring]]
      bodies = ["ground", "rod"]
      stiffness = 1
      free_angle = {:.17g}
      [[force]]
      name = "P"
      at = "rod.tip"
      vector = [0, -1]
      [start]
      rod = {}
    )",
                                                e, e > 0 ? -1.0 : 1.0),
                                    "imperfect.toml");
    const Path path = poise::path(VariedScene(scene, "load.P", 3.0, 0.5));
    for (const PathEvent& event : path.events) {
      if (event.kind == Kind::fold) return event.at;
    }
    return PathPoint{};
  };
  struct Reference {
    double offset, load, angle;
  };
  for (const Reference& known : {Reference{1e-2, 1.04897323447748318843, -0.306772547185126073907},
                                 Reference{1e-4, 1.00224220856508189133, -0.0669033180477885681410},
                                 Reference{1e-6, 1.00010400743621091322, -0.0144220957137714929396}}) {
    for (const double side : {1.0, -1.0}) {
      const PathPoint found = fold(side * known.offset);
      ASSERT_FALSE(found.x.empty()) << side * known.offset;
      expect_relative(found.parameter, known.load, 1e-12);
      EXPECT_NEAR(found.x[0], side * known.angle, 1e-6);
    }
  }
}

// P = 2 k (2 l cos a - l0) tan a of a knee joint press, a from dead centre, the workpiece met at 2 l cos a = l0.
TEST(Path, FollowsThePressFromTheOpenStartToItsSnap) {
  const Scene scene = parse_scene(R"(
    units = { length = "mm", force = "kN", angle = "deg" }
    [ground]
    points = { O = [0, 0] }
    [body.lower]
    points = { a = [0, 0], b = [300, 0] }
    [body.upper]
    points = { a = [0, 0], b = [300, 0] }
    [body.ram]
    points = { c = [0, 0] }
    [[pin]]
    points = ["ground.O", "lower.a"]
    [[pin]]
    points = ["lower.b", "upper.a"]
    [[pin]]
    points = ["upper.b", "ram.c"]
    [[slide]]
    name = "guide"
    points = ["ground.O", "ram.c"]
    axis = [0, 1]
    [[spring]]
    name = "workpiece"
    points = ["ground.O", "ram.c"]
    stiffness = 40
    free_length = 598
    acts = "tension"
    [[stop]]
    name = "over"
    bodies = ["ground", "lower"]
    min = 85
    max = 170
    [[force]]
    name = "P"
    at = "lower.b"
    vector = [1, 0]
    [start]
    lower = 160
    upper = 20
    guide = 205
  )",
                                  "press.toml");
  const VariedScene varied(scene, "load.P", 0.001, 6.0);
  const Path path = poise::path(varied);
  expect_traced(path);
  for (const PathPoint& point : path.branches[0].points) {
    const double a = point.x[0] - M_PI / 2;
    expect_relative(point.parameter, 2 * 40e6 * (0.6 * std::cos(a) - 0.598) * std::tan(a), 1e-9);
  }
  const auto folds = events(path, Kind::fold);
  ASSERT_FALSE(folds.empty());
  // dP/da = 0:  2 l cos^3 a = l0.
  const double a = std::acos(std::cbrt(0.598 / 0.6));
  expect_relative(folds[0]->at.parameter, 2 * 40e6 * (0.6 * std::cos(a) - 0.598) * std::tan(a), 1e-12);
  const auto snaps = events(path, Kind::snap);
  ASSERT_FALSE(snaps.empty());
  ASSERT_TRUE(snaps[0]->landing);
  EXPECT_EQ(snaps[0]->landing->active_stops, std::vector<int>{0});

  // Pulled open first: the stop at 170 degrees lets go where the load vanishes, the workpiece is met beyond.
  const Path pulled = poise::path(VariedScene(scene, "load.P", -1.0, 6.0), {.certify = false});
  EXPECT_EQ(pulled.status, Path::Status::traced) << pulled.why;
  const auto stops = events(pulled, Kind::stop);
  const auto slack = events(pulled, Kind::slack);
  ASSERT_FALSE(stops.empty());
  ASSERT_FALSE(slack.empty());
  EXPECT_FALSE(stops[0]->on);
  EXPECT_EQ(stops[0]->at.parameter, 0.0);
  EXPECT_NEAR(stops[0]->at.x[0], 170 * M_PI / 180, 1e-12);
  EXPECT_TRUE(slack[0]->on);
  EXPECT_NEAR(std::cos(slack[0]->at.x[0] - M_PI / 2), 0.598 / 0.6, 1e-14);
}

// A driven measure: the force that holds the apex of von Mises' truss at y, through both folds.
TEST(Path, GivesTheForceOverTravel) {
  Scene scene = von_mises(1.0, 0.5, 1000.0);
  set_value(scene, "load.P", 0.0);
  const VariedScene varied(scene, "travel.guide", 0.5, -0.5);
  EXPECT_TRUE(varied.is_driven());
  EXPECT_EQ(varied.effort_dimension().unit_name({}), dimension::force.unit_name({}));
  const Path path = poise::path(varied);
  expect_traced(path);
  ASSERT_EQ(path.branches.size(), 1U);
  const double l = std::hypot(1.0, 0.5);
  for (const PathPoint& point : path.branches[0].points) {
    const double y = point.parameter;
    EXPECT_NEAR(point.effort, -2 * 1000.0 * (l / std::hypot(1.0, y) - 1) * y, 1e-9);
  }
  EXPECT_TRUE(events(path, Kind::fold).empty());
}

TEST(Path, LoadsAndUnloadsWithHysteresis) {
  const VariedScene varied(von_mises(1.0, 0.5, 1000.0), "load.P", -60.0, 60.0);
  const Path path = poise::path(varied, {.follow = PathOptions::Follow::jump});
  expect_traced(path);
  const auto snaps = events(path, Kind::snap);
  ASSERT_EQ(snaps.size(), 2U);
  const double load = von_mises_fold(1.0, 0.5, 1000.0).load;
  expect_relative(snaps[0]->at.parameter, load, 1e-12);
  expect_relative(snaps[1]->at.parameter, -load, 1e-12);
  const auto ends = events(path, Kind::hysteresis_end);
  ASSERT_EQ(ends.size(), 1U);
  expect_relative(ends[0]->at.parameter, -load, 1e-12);
  for (const PathBranch& branch : path.branches) {
    for (const PathPoint& point : branch.points) EXPECT_NE(point.stability, Stability::unstable);
  }
}

// The clamp holds with its over-centre stop until the pull balances the rubber: there the stop lets go, the load turns.
TEST(Path, TellsAStopThatLetsGoFromAFold) {
  const Scene scene = read_scene(test::dataset("toggle_clamp.toml"));
  const Path path = poise::path(VariedScene(scene, "load.P", 0.0, 200.0));
  expect_traced(path);
  const auto stops = events(path, Kind::stop);
  ASSERT_FALSE(stops.empty());
  EXPECT_FALSE(stops[0]->on);
  EXPECT_EQ(scene.stops[stops[0]->item].name, "over_centre");
  const auto folds = events(path, Kind::fold);
  ASSERT_FALSE(folds.empty());
  EXPECT_EQ(folds[0]->at.parameter, stops[0]->at.parameter);
  EXPECT_GE(stops[0]->digits(), 10);
}

// An arm with a dead weight and a counter-torque T: m g l cos t = T; with every turn the curve repeats itself.
TEST(Path, EndsAClosedCurveAfterAWholeTurn) {
  const Scene scene = parse_scene(R"(
    gravity = [0, -10]
    [ground]
    points = { O = [0, 0] }
    [body.arm]
    points = { O = [0, 0] }
    mass = 1
    center = [1, 0]
    [[pin]]
    points = ["ground.O", "arm.O"]
    [[torque]]
    name = "T"
    on = "arm"
    value = 1
    [start]
    arm = -1.5
  )",
                                  "arm.toml");
  const VariedScene varied(scene, "load.T", 0.0, 20.0);
  const Path path = poise::path(varied, {.certify = false});
  const auto folds = events(path, Kind::fold);
  ASSERT_FALSE(folds.empty());
  expect_relative(folds[0]->at.parameter, 10.0, 1e-14);
  const Path whole = poise::path(VariedScene(scene, "load.T", -15.0, 20.0), {.certify = false});
  EXPECT_EQ(whole.status, Path::Status::no_start);  // nothing balances more than 10 N m
  const Path around = poise::path(VariedScene(scene, "load.T", 5.0, -20.0), {.certify = false});
  EXPECT_EQ(around.branches.at(0).end, PathBranch::End::range);
}

TEST(Path, GivesTheEquilibriaAtWantedValues) {
  const VariedScene varied(von_mises(1.0, 0.5, 1000.0), "load.P", -60.0, 60.0);
  const double half = 0.5 * 42.9143257312246876869530451065;
  const Path path = poise::path(varied, {.at = {half, 50.0}});
  ASSERT_EQ(path.wanted.size(), 2U);
  // static.vonmises eqs.0.5: two stable equilibria and an unstable one.
  std::vector<double> heights;
  for (const PathPoint& point : path.wanted[0]) {
    EXPECT_EQ(point.parameter, half);
    EXPECT_EQ(point.proof, PointProof::proved);
    heights.push_back(point.x[0] * varied.scales().length);
  }
  std::sort(heights.begin(), heights.end());
  ASSERT_EQ(heights.size(), 3U);
  EXPECT_NEAR(heights[0], -0.548097444662501968920148281022, 1e-14);
  EXPECT_NEAR(heights[1], 0.0949167614870496588236605496983, 1e-14);
  EXPECT_NEAR(heights[2], 0.436788903652506562874370276452, 1e-14);
  EXPECT_EQ(path.wanted[1].size(), 1U);
}

// What stops a path, each with its reason.
TEST(Path, SaysWhyItEnds) {
  Scene scene = von_mises(1.0, 0.5, 1000.0);
  const Path many = poise::path(VariedScene(scene, "load.P", 0.0, 60.0), {.certify = false, .most_points = 5});
  EXPECT_EQ(many.status, Path::Status::incomplete);
  EXPECT_EQ(many.branches[0].end, PathBranch::End::limit);

  const std::atomic<bool> raised{true};
  const Path stopped = poise::path(VariedScene(scene, "load.P", 0.0, 60.0), {.certify = false, .interrupt = &raised});
  EXPECT_EQ(stopped.status, Path::Status::interrupted);

  // A third crank that repeats the two others, until its length changes.
  Scene cranks = test::parallelogram(3, 0.5, 100.0);
  const std::string length = "point." + cranks.bodies[1].name + "." + cranks.bodies[1].points.back().name + ".x";
  const Path apart = poise::path(VariedScene(cranks, length, 1.0, 1.2), {.certify = false});
  EXPECT_EQ(apart.status, Path::Status::incomplete);
  EXPECT_EQ(apart.branches[0].end, PathBranch::End::stuck);
  EXPECT_NE(apart.why.find("no longer fit together"), std::string::npos) << apart.why;
}

// A slide that is driven past a spring at its side, which acts over 0.09 mm of 300 mm of travel only: a distance bends
// sharply where it is least. Two events, and the force that the spring adds between them.
TEST(Path, MeetsASpringThatActsOverALittleOfTheWay) {
  const Scene scene = parse_scene(R"(
    units = { length = "mm" }
    [ground]
    points = { O = [0, 0], D = [150, 0.999] }
    [body.drawer]
    points = { P = [0, 0] }
    [[slide]]
    name = "run"
    points = ["ground.O", "drawer.P"]
    axis = [1, 0]
    [[spring]]
    name = "bump"
    points = ["ground.D", "drawer.P"]
    stiffness = 1e7
    free_length = 1
    acts = "compression"
    [[spring]]
    name = "return"
    slide = "run"
    stiffness = 0.1
    free_length = 0
  )",
                                  "bump.toml");
  const double at = 149.97e-3;
  const Path path = poise::path(VariedScene(scene, "travel.run", 0.0, 300.0), {.at = {at}});
  expect_traced(path);
  const auto slack = events(path, Kind::slack);
  ASSERT_EQ(slack.size(), 2U);
  const double half = std::sqrt(1.0 - 0.999 * 0.999) * 1e-3;
  EXPECT_NEAR(slack[0]->at.parameter, 0.15 - half, 1e-12);
  EXPECT_NEAR(slack[1]->at.parameter, 0.15 + half, 1e-12);
  ASSERT_EQ(path.wanted[0].size(), 1U);
  const double length = std::hypot(at - 0.15, 0.999e-3);
  const double force = 100.0 * at - 1e10 * (1e-3 - length) * (at - 0.15) / length;
  EXPECT_NEAR(path.wanted[0][0].effort, force, 1e-6 * std::abs(force));
}

// t = lambda sin t, lambda = P / 10: a column straight up to 10 N. Loaded it bends aside without a jump, unloaded it
// comes back and stays straight.
TEST(Path, LoadsAColumnPastBucklingAndBack) {
  const Scene scene = parse_scene(R"(
    [ground]
    points = { O = [0, 0] }
    [body.rod]
    points = { O = [0, 0], tip = [0, 1] }
    [[pin]]
    points = ["ground.O", "rod.O"]
    [[torsion_spring]]
    bodies = ["ground", "rod"]
    stiffness = 10
    free_angle = 0
    [[force]]
    name = "P"
    at = "rod.tip"
    vector = [0, -1]
    [start]
    rod = 1
  )",
                                  "rod.toml");
  const PathOptions jump{.follow = PathOptions::Follow::jump};
  for (const auto& [from, to] : {std::pair(20.0, 0.0), std::pair(0.0, 20.0)}) {
    const Path path = poise::path(VariedScene(scene, "load.P", from, to), jump);
    EXPECT_EQ(path.status, Path::Status::traced) << path.why;
    EXPECT_TRUE(events(path, Kind::snap).empty());
    double least = 20.0, most = 0.0;
    for (const PathBranch& branch : path.branches) {
      for (const PathPoint& point : branch.points) {
        least = std::min(least, point.parameter);
        most = std::max(most, point.parameter);
        EXPECT_NEAR(10 * point.x[0], point.parameter * std::sin(point.x[0]), 1e-9);
        EXPECT_NE(point.stability, Stability::unstable) << point.parameter;
      }
    }
    EXPECT_EQ(least, 0.0);
    EXPECT_EQ(most, 20.0);
  }
  // Upright under 20 N it would not rest: loading begins beside.
  Scene upright = scene;
  set_value(upright, "start.rod", 0.0);
  const Path beside = poise::path(VariedScene(upright, "load.P", 20.0, 12.0), jump);
  EXPECT_EQ(beside.status, Path::Status::traced) << beside.why;
  ASSERT_FALSE(beside.notes.empty());
  EXPECT_GT(std::abs(beside.branches.at(0).points.at(0).x[0]), 0.5);
}

TEST(Path, RefusesANumberOnWhichNothingDepends) {
  Scene scene = von_mises(1.0, 0.5, 1000.0);
  EXPECT_THROW(poise::path(VariedScene(scene, "body.apex.mass", 0.0, 5.0)), InputError);  // without gravity
}

// What holds a driven measure ends at a stop, or where the force grows beyond all bounds; on the way to the first value
// the loops stay closed.
TEST(Path, EndsADriveAtStopsAndDeadCentres) {
  const Scene clamp = read_scene(test::dataset("toggle_clamp.toml"));
  const Path stopped = poise::path(VariedScene(clamp, "angle.handle", 93.0, 20.0));
  expect_traced(stopped);
  EXPECT_EQ(stopped.branches.at(0).end, PathBranch::End::blocked);
  EXPECT_NE(stopped.branches[0].why.find("stop \"open\" leaves no motion"), std::string::npos);
  // Two stops leave none as the frame becomes lower, at 56.797 mm: both angles of the loop are at their limits there.
  const Path jammed = poise::path(VariedScene(clamp, "point.ground.A.y", 60.0, 56.0));
  EXPECT_NE(jammed.branches.at(0).why.find("stop \"over_centre\" and stop \"open\" leave no motion"), std::string::npos)
      << jammed.branches[0].why;
  // Past the stop that holds the handle no pose is closed.
  EXPECT_THROW(poise::path(VariedScene(clamp, "angle.handle", 94.0, 20.0)), InputError);

  const Scene press = read_scene(test::dataset("toggle_press.toml"));
  const Path dead = poise::path(VariedScene(press, "travel.gib", 230.0, 150.0), {.certify = false});
  EXPECT_EQ(dead.status, Path::Status::incomplete);
  EXPECT_EQ(dead.branches.at(0).end, PathBranch::End::singular);
  EXPECT_NE(dead.why.find("joint forces grow without bound"), std::string::npos) << dead.why;

  // More than 100 rad of a driven angle are no running away.
  const Path turns =
      poise::path(VariedScene(read_scene(test::dataset("zeeman.toml")), "angle.disc", 0.0, 120.0), {.certify = false});
  EXPECT_EQ(turns.status, Path::Status::traced) << turns.why;
}

// Beyond the dense limit, against the small column: n links of length 1/n and springs of stiffness n tend to Euler's.
TEST(Path, FollowsColumnsOfHundredsOfLinks) {
  std::string text = column(500);
  text += "[[force]]\nname = \"Q\"\nat = \"link500.b\"\nvector = [0, 1e-8]\n";
  const double critical = 2 - 2 * std::cos(M_PI / 1001);
  const VariedScene varied(parse_scene(text, "column.toml"), "load.P", 0.5 * critical, 1.5 * critical);
  const Path path = poise::path(varied, {.certify = false});
  EXPECT_EQ(path.status, Path::Status::traced) << path.why;
  const std::vector<double>& last = path.branches.at(0).points.back().x;
  // Past the critical load the shape of an elastica: the tip's angle from P / P_cr = (2 K(k) / pi)^2, k = sin(tip / 2),
  // for the column of the same length; 500 links are within 1 % of it.
  const double k = std::sin(0.5 * last.back());
  EXPECT_NEAR(std::pow(2 * std::comp_ellint_1(k) / M_PI, 2), 1.5, 0.015);
}

}  // namespace
}  // namespace poise::path_test
