#include "statics/equilibrium/settle.hpp"

#include <array>
#include <atomic>
#include <cmath>
#include <random>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "statics/equilibrium/equilibrium.hpp"
#include "statics/model/mobility.hpp"
#include "tests/judge/settling_judge.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/seed.hpp"

namespace poise::settle_test {
namespace {

using End = Settling::End;

// --- the knee-joint press
// ------------------------------------------------------------------------------------------------

constexpr double link = 300.0, met = 598.0, stiffness = 40.0;  // mm, kN/mm

// Load that holds the press at the angle a from dead centre, kN, and its slope.
double load_at(double a) { return 2.0 * stiffness * (2.0 * link * std::cos(a) - met) * std::tan(a); }
double load_slope(double a) {
  const double c = std::cos(a);
  return 2.0 * stiffness * (2.0 * link * c - met / (c * c));
}
double steepest() { return std::acos(std::cbrt(met / (2.0 * link))); }

// The angle at which the press stops under a load below the largest: between that of the largest load and that at
// which the workpiece is met.
double angle_under(double load) {
  double low = steepest(), high = std::acos(met / (2.0 * link));
  for (int k = 0; k < 200; ++k) {
    const double middle = 0.5 * (low + high);
    (load_at(middle) > load ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

struct Press {
  explicit Press(double load) : model(loaded(load)), settling(settle(model, close_loops(model))) {}

  static Scene loaded(double load) {
    Scene scene = read_scene(test::dataset("knee_press.toml"));
    set_value(scene, "load.P", load);
    return scene;
  }
  double angle() const { return test::angle_of(model, settling.x, "upper"); }

  StaticModel model;
  Settling settling;
};

TEST(SettlePress, StopsBeforeDeadCentreAtAllLoadsThatTheWorkpieceBears) {
  const double most = load_at(steepest());
  for (int k = 1; k <= 200; ++k) {
    const double load = most * k / 200.0 * (1.0 - 1e-9);
    const Press press(load);
    ASSERT_EQ(press.settling.end, End::settled) << load;
    EXPECT_FALSE(press.settling.in_doubt) << load;
    EXPECT_TRUE(press.settling.active_stops.empty()) << load;
    // To 1e-12 of the load; next to a fold that is a distance of 1e-12 over the slope of the load.
    EXPECT_NEAR(press.angle(), angle_under(load), 1e-12 * (1.0 + load / std::abs(load_slope(press.angle())))) << load;
  }
}

TEST(SettlePress, LoadsNextToTheLargestAreToldApart) {
  const double most = load_at(steepest());
  for (const double below : {1e-3, 1e-6, 1e-8, 1e-9}) {
    const Press stays(most * (1.0 - below));
    EXPECT_GT(stays.angle(), steepest()) << below;
    EXPECT_NEAR(load_at(stays.angle()) / most, 1.0 - below, 1e-12) << below;
    const Press snaps(most * (1.0 + below));
    EXPECT_EQ(snaps.settling.active_stops, std::vector<int>{0}) << below;
    EXPECT_NEAR(snaps.angle(), -10.0 * M_PI / 180.0, 1e-12) << below;
  }
}

TEST(SettlePress, AtTheLargestLoadRoundingDecidesAndItSaysSo) {
  const Press press(load_at(steepest()));
  EXPECT_EQ(press.settling.end, End::settled);
  EXPECT_TRUE(press.settling.in_doubt);
}

TEST(SettlePress, NoMethodLeavesTheSettledPose) {
  const Press press(2.5);
  for (const Method method : {Method::virtual_work, Method::energy, Method::dynamic_relaxation}) {
    const Equilibrium found = solve(press.model, test::by(method, Seek::settle));
    ASSERT_TRUE(found.found()) << to_string(method) << ": " << found.why;
    EXPECT_NEAR(test::angle_of(press.model, found.x, "upper"), angle_under(2.5), 1e-12) << to_string(method);
    EXPECT_EQ(found.certificate.stability, Stability::stable);
  }
}

// --- a rocker switch
// -----------------------------------------------------------------------------------------------------

// A lever whose tip a spring pulls towards a point on the other side of its pivot: 0 is unstable, and stops at +-20
// degrees hold it on either side.
std::string rocker_switch(double start) {
  return fmt::format(R"(
units = {{ angle = "deg", length = "mm" }}
ground.points = {{ O = [0, 0], H = [-10, 0] }}
body.lever.points = {{ O = [0, 0], B = [20, 0] }}
pin = [{{ name = "O", points = ["ground.O", "lever.O"] }}]
spring = [{{ name = "s", points = ["ground.H", "lever.B"], stiffness = 2, free_length = 25 }}]
stop = [{{ name = "travel", bodies = ["ground", "lever"], min = -20, max = 20 }}]
start.lever = {}
)",
                     start);
}

TEST(SettleSwitch, StaysWithItsStopAndReportsTheWatershed) {
  for (const double start : {17.0, 3.0, 1e-6, -1e-6, -17.0}) {
    const StaticModel model = test::model_of(rocker_switch(start));
    const Settling found = settle(model, model.start());
    ASSERT_EQ(found.end, End::settled) << start;
    EXPECT_NEAR(test::angle_of(model, found.x, "lever"), std::copysign(20.0, start) * M_PI / 180.0, 1e-11) << start;
    EXPECT_EQ(found.active_stops, std::vector<int>{0});
    if (std::abs(start) > 3.0) continue;
    EXPECT_NEAR(found.margin / (std::abs(start) * M_PI / 180.0), 1.0, 0.02);
  }
}

TEST(SettleSwitch, OfAnUnstableStartBothSidesAreFound) {
  const StaticModel model = test::model_of(rocker_switch(0.0));
  const Settling found = settle(model, model.start());
  ASSERT_EQ(found.end, End::start_unstable);
  EXPECT_EQ(found.x, model.start());
  ASSERT_EQ(found.sides.size(), 2U);
  for (const Settling::Side& side : found.sides) {
    EXPECT_EQ(side.end, End::settled);
    EXPECT_NEAR(test::angle_of(model, side.x, "lever"), std::copysign(20.0, side.direction[0]) * M_PI / 180.0, 1e-11);
  }
  EXPECT_LT(found.sides[0].direction[0] * found.sides[1].direction[0], 0.0);
  // The answer of a method that keeps to it is found, a minimiser that leaves it went elsewhere.
  EXPECT_TRUE(solve(model, test::by(Method::virtual_work, Seek::settle)).found());
  const Equilibrium left = solve(model, test::by(Method::dynamic_relaxation, Seek::settle));
  EXPECT_TRUE(left.status == Status::elsewhere || left.found()) << left.why;
}

// --- how a motion ends
// -------------------------------------------------------------------------------------------------

TEST(Settle, RunsAwayWhereNothingHoldsIt) {
  const StaticModel model = test::model_of(R"(
gravity = [0, -9.81]
ground.points = { O = [0, 0] }
body.block = { mass = 1, points = { B = [0, 0] } }
slide = [{ name = "guide", points = ["ground.O", "block.B"], axis = [0, 1] }]
)");
  const Settling found = settle(model, model.start());
  EXPECT_EQ(found.end, End::runs_away);
  const Equilibrium answer = solve(model, test::by(Method::virtual_work, Seek::settle));
  EXPECT_EQ(answer.status, Status::not_found);
  EXPECT_TRUE(answer.why.starts_with(found.why)) << answer.why;
}

TEST(Settle, FollowersThatDriveItRoundReachTheStepLimit) {
  // A follower load turns the crank for ever.
  const StaticModel model = test::model_of(R"(
ground.points = { O = [0, 0] }
body.crank.points = { O = [0, 0], B = [1, 0] }
pin = [{ name = "O", points = ["ground.O", "crank.O"] }]
force = [{ name = "F", at = "crank.B", vector = [0, 1], follows = "crank" }]
)");
  EXPECT_EQ(settle(model, model.start()).end, End::runs_away);
  EXPECT_EQ(settle(model, model.start(), {.steps = 20}).end, End::step_limit);
}

TEST(Settle, AChangePointOnTheWayIsSingular) {
  // A parallelogram that its load turns into its flat pose, from which it could go on as a parallelogram or crossed.
  const StaticModel model = test::model_of(R"(
ground.points = { A = [0, 0], D = [2, 0] }
body.left.points = { A = [0, 0], B = [1, 0] }
body.top.points = { B = [0, 0], C = [2, 0] }
body.right.points = { D = [0, 0], C = [1, 0] }
pin = [{ name = "A", points = ["ground.A", "left.A"] }, { name = "B", points = ["left.B", "top.B"] },
       { name = "C", points = ["top.C", "right.C"] }, { name = "D", points = ["ground.D", "right.D"] }]
torque = [{ name = "T", on = "left", value = -1 }]
start = { left = 1, top = 0, right = 1 }
)");
  const Settling found = settle(model, model.start());
  EXPECT_EQ(found.end, End::singular);
  EXPECT_NEAR(test::angle_of(model, found.x, "left"), 0.0, 1e-6);
}

TEST(Settle, LoopsThatCannotCloseAndInterruptsAreSaid) {
  const StaticModel model = test::model_of(rocker_switch(17.0));
  const std::atomic<bool> stop = true;
  EXPECT_EQ(settle(model, model.start(), {.interrupt = &stop}).end, End::interrupted);
  const StaticModel open = test::model_of(R"(
ground.points = { A = [0, 0], D = [9, 0] }
body.left.points = { A = [0, 0], B = [1, 0] }
body.right.points = { D = [0, 0], B = [1, 0] }
pin = [{ name = "A", points = ["ground.A", "left.A"] }, { name = "B", points = ["left.B", "right.B"] },
       { name = "D", points = ["ground.D", "right.D"] }]
force = [{ name = "F", at = "left.B", vector = [0, 1] }]
)");
  EXPECT_EQ(settle(open, open.start()).end, End::not_closed);
}

TEST(Settle, WhereEveryPoseBalancesItStays) {
  const StaticModel model = test::model_of(R"(
gravity = [0, -9.81]
ground.points = { O = [0, 0] }
body.arm = { mass = 2, center = [0, 0], points = { O = [0, 0], B = [1, 0], C = [-1, 0] } }
pin = [{ name = "O", points = ["ground.O", "arm.O"] }]
force = [{ name = "F", at = "arm.B", vector = [0, -1] }, { name = "G", at = "arm.C", vector = [0, -1] }]
start.arm = 0.3
)");
  const Settling found = settle(model, model.start());
  EXPECT_EQ(found.end, End::settled);
  EXPECT_EQ(found.x, model.start());
}

// --- several freedoms
// ----------------------------------------------------------------------------------------------------

// Two slides in series on springs.
std::string two_sliders(const std::string& dampers) {
  return R"(
ground.points = { O = [0, 0] }
body.first.points = { O = [0, 0], P = [0, 0] }
body.second.points = { P = [0, 0] }
slide = [{ name = "x", points = ["ground.O", "first.O"], axis = [1, 0] },
         { name = "y", points = ["first.P", "second.P"], axis = [0, 1] }]
spring = [{ name = "sx", slide = "x", stiffness = 1, free_length = 0 },
          { name = "sy", slide = "y", stiffness = 1, free_length = 0 }]
)" + dampers +
         "start = { x = 1, y = 1 }\n";
}

TEST(SettleSeveral, TheResistanceIsThatOfTheDampersWhereTheyResistEveryFreedom) {
  const std::string both =
      "damper = [{ name = \"dx\", slide = \"x\", coefficient = 1 }, { name = \"dy\", slide = \"y\", coefficient = 4 "
      "}]\n";
  const std::string one = "damper = [{ name = \"dx\", slide = \"x\", coefficient = 1 }]\n";
  const StaticModel damped = test::model_of(two_sliders(both));
  EXPECT_TRUE(settle(damped, damped.start()).by_dampers);
  const StaticModel partly = test::model_of(two_sliders(one));
  EXPECT_FALSE(settle(partly, partly.start()).by_dampers);
  const StaticModel free = test::model_of(two_sliders(""));
  EXPECT_FALSE(settle(free, free.start()).by_dampers);
}

// A block on two slides, pushed up into the corner of two circles: nothing is left that could move, and the second of
// them is met within a tolerance only.
TEST(SettleSeveral, WhereStopsLeaveNothingFreeItRestsOnAllOfThem) {
  for (const double reach : {2.1, 2.2, 2.3}) {
    const StaticModel model = test::model_of(fmt::format(
        R"(ground.points = {{ O = [0, 0], S = [-0.1, 0.1], T = [0.8, -0.1] }}
           body.cart.points = {{ O = [0, 0] }}
           body.block.points = {{ O = [0, 0] }}
           slide = [{{ name = "x", points = ["ground.O", "cart.O"], axis = [1, 0] }},
                    {{ name = "y", points = ["cart.O", "block.O"], axis = [0, 1] }}]
           force = [{{ at = "block.O", vector = [0, 0.2] }}]
           stop = [{{ points = ["ground.S", "block.O"], max = 2 }}, {{ points = ["ground.T", "block.O"], max = {} }}]
        )",
        reach));
    const Equilibrium found = solve(model, test::by(Method::virtual_work, Seek::settle));
    ASSERT_TRUE(found.settling);
    EXPECT_EQ(found.status, Status::confirmed) << found.why;
    // The upper of the points where the circles meet.
    const double apart = std::hypot(0.9, 0.2), along = (4.0 - reach * reach + apart * apart) / (2.0 * apart);
    const double across = std::sqrt(4.0 - along * along);
    EXPECT_NEAR(test::travel_of(model, found.settling->x, "x"), -0.1 + (0.9 * along + 0.2 * across) / apart, 1e-14);
    EXPECT_NEAR(test::travel_of(model, found.settling->x, "y"), 0.1 + (-0.2 * along + 0.9 * across) / apart, 1e-14);
  }
}

TEST(SettleSeveral, AnUpsideDownChainFallsFromEachDirectionToBothSides) {
  Scene scene = test::chain(2, 1.0, 1.0);
  scene.gravity = {9.81, 0.0};
  scene.start.angle[1] = scene.start.angle[2] = M_PI;
  const StaticModel model(scene);
  const Settling found = settle(model, model.start());
  ASSERT_EQ(found.end, End::start_unstable);
  ASSERT_EQ(found.sides.size(), 4U);
  for (const Settling::Side& side : found.sides) {
    ASSERT_EQ(side.end, End::settled);
    for (const char* body : {"1", "2"}) {
      EXPECT_NEAR(std::cos(test::angle_of(model, side.x, body)), 1.0, 1e-12);
    }
  }
}

TEST(SettleSeveral, LongChainsSettleToo) {
  for (const int links : {30, 100}) {
    const StaticModel model(test::hanging_chain(links, 1.5, 10.0, 1.0));
    const std::vector<double> start = close_loops(model);
    const Settling found = settle(model, start);
    ASSERT_EQ(found.end, End::settled) << links << ": " << found.why;
    const Equilibrium stable = solve(model, start, test::by(Method::virtual_work, Seek::stable));
    ASSERT_TRUE(stable.found());
    for (std::size_t i = 0; i < start.size(); ++i) EXPECT_NEAR(found.x[i], stable.x[i], 1e-9);
  }
}

// --- distances that pass near zero -----------------------------------------------------------------------------------

// A slide along x, pulled by 30 N against a spring of 0.1 N/mm past a point at its side at (150, y), to rest at 300 mm.
std::string runner(double y, const std::string& beside, double start) {
  return fmt::format(R"(
units = {{ length = "mm" }}
ground.points = {{ O = [0, 0], D = [150, {}] }}
body.drawer.points = {{ P = [0, 0] }}
slide = [{{ name = "run", points = ["ground.O", "drawer.P"], axis = [1, 0] }}]
spring = [{{ name = "return", slide = "run", stiffness = 0.1, free_length = 0 }}, {}]
force = [{{ name = "pull", at = "drawer.P", vector = [30, 0] }}]
start.run = {}
)",
                     y, beside, start);
}
std::string bump(double rate, double free_length) {
  return fmt::format(
      R"({{ name = "bump", points = ["ground.D", "drawer.P"], stiffness = {}, free_length = {}, acts = "compression" }})",
      rate, free_length);
}
std::string post(const std::string& point, double radius) {
  return fmt::format("stop = [{{ name = \"post\", points = [\"ground.D\", \"{}\"], min = {} }}]\n", point, radius);
}

// Where the runner rests before a bump of (mm, N/mm) whose force exceeds the pull: the first zero of the force, between
// where the bump is met and its steepest place.
double rest_before_bump(double y, double rate, double free_length) {
  const auto force = [&](double x) {
    const double g = std::hypot(x - 150.0, y);
    return 30.0 - 0.1 * x - rate * (free_length - g) * (150.0 - x) / g;
  };
  double low = 150.0 - std::sqrt(free_length * free_length - y * y);
  double high = low;
  while (force(high) > 0.0) high += 1e-4 * (150.0 - low);
  for (int k = 0; k < 200; ++k) (force(0.5 * (low + high)) > 0.0 ? low : high) = 0.5 * (low + high);
  return 0.5 * (low + high);
}

TEST(SettleNarrow, ASlideRestsBeforeABump) {
  for (const auto& [y, rate, length] : {std::array{4.5, 1e3, 5.0}, {0.999, 1e7, 1.0}, {0.1, 1e5, 1.0}}) {
    for (const double start : {0.0, 5.0, 10.0, 37.0, 60.0, 100.0, 140.0}) {
      const StaticModel model = test::model_of(runner(y, bump(rate, length), start));
      const Settling found = settle(model, model.start());
      ASSERT_EQ(found.end, End::settled);
      EXPECT_NEAR(1e3 * test::travel_of(model, found.x, "run"), rest_before_bump(y, rate, length), 1e-7)
          << y << ' ' << length << ' ' << start;
    }
  }
}

TEST(SettleNarrow, ASlideRestsAtAPost) {
  for (const auto& [y, radius] : {std::array{0.0, 1.0}, {0.999, 1.0}, {0.0, 3.0}, {0.999, 3.0}, {0.0, 0.01}}) {
    for (const double start : {0.0, 10.0, 37.0, 100.0, 140.0}) {
      const StaticModel model = test::model_of(runner(y, "", start) + post("drawer.P", radius));
      const Settling found = settle(model, model.start());
      ASSERT_EQ(found.end, End::settled);
      EXPECT_EQ(found.active_stops, std::vector<int>{0});
      EXPECT_NEAR(1e3 * test::travel_of(model, found.x, "run"), 150.0 - std::sqrt(radius * radius - y * y), 1e-6)
          << y << ' ' << radius << ' ' << start;
    }
  }
}

// An arm of 1 m falls from `start`, about the origin, onto a post at D; its tip may carry a rod that hangs down.
std::string falling_arm(double start, Vec2 at, double radius, bool carries_rod) {
  return fmt::format(R"(
gravity = [0, -9.81]
ground.points = {{ O = [0, 0], D = [{}, {}] }}
body.arm = {{ points = {{ O = [0, 0], T = [1, 0] }}, mass = 1, center = [0.5, 0] }}
{}
pin = [{{ points = ["ground.O", "arm.O"] }}{}]
start = {{ arm = {}{} }}
)",
                     at.x, at.y,
                     carries_rod ? "body.b = { points = { A = [0, 0] }, mass = 1, center = [0.25, 0] }" : "",
                     carries_rod ? R"(, { points = ["arm.T", "b.A"] })" : "", start, carries_rod ? ", b = -1.5" : "") +
         post("arm.T", radius);
}

// The angle at which the tip, falling clockwise, meets a circle around a point at the distance r and angle a from O.
double first_contact(double r, double a, double radius) {
  return a + std::acos((1.0 + r * r - radius * radius) / (2.0 * r));
}

TEST(SettleNarrow, AnArmRestsOnAPost) {
  for (const bool carries_rod : {false, true}) {
    for (const double radius : {0.1, 0.05, 0.02, 0.01, 1e-3, 1e-4}) {
      for (const double start : {0.2, 0.5, 0.8, 1.0, 1.2, 1.5}) {
        const StaticModel model = test::model_of(falling_arm(start, {0.8, -0.6}, radius, carries_rod));
        const Settling found = settle(model, model.start());
        ASSERT_EQ(found.end, End::settled) << found.why;
        EXPECT_EQ(found.active_stops, std::vector<int>{0});
        EXPECT_NEAR(test::angle_of(model, found.x, "arm"), first_contact(1.0, std::atan2(-0.6, 0.8), radius), 1e-7)
            << carries_rod << ' ' << radius << ' ' << start;
      }
    }
  }
}

TEST(SettleNarrow, RandomPostsAndBumpsAreMet) {
  std::mt19937_64 random(test::seed(7));
  const auto between = [&](double low, double high) {
    return low + (high - low) * std::generate_canonical<double, 53>(random);
  };
  for (int k = 0; k < 300; ++k) {
    const double radius = std::pow(10.0, between(-3.0, -1.0));
    const double aside = between(-0.99, 0.99) * radius;  // of the way
    if (k % 3 == 0) {
      // In mm; the bump is so stiff that it holds.
      const double y = 1e3 * std::abs(aside), length = 1e3 * radius;
      const bool is_post = k % 2 == 0;
      const std::string text = is_post ? runner(y, "", between(0.0, 40.0)) + post("drawer.P", length)
                                       : runner(y, bump(1e9, length), between(0.0, 40.0));
      const StaticModel model = test::model_of(text);
      const Settling found = settle(model, model.start());
      ASSERT_EQ(found.end, End::settled) << k;
      EXPECT_EQ(found.active_stops.size(), is_post ? 1U : 0U) << k;
      const double expected = is_post ? 150.0 - std::sqrt(length * length - y * y) : rest_before_bump(y, 1e9, length);
      EXPECT_NEAR(1e3 * test::travel_of(model, found.x, "run"), expected, 1e-6) << k;
      continue;
    }
    const double r = 1.0 + aside, a = between(-1.3, 0.8);
    const double contact = first_contact(r, a, radius);
    const double start = between(contact + 0.01, 1.5);
    const StaticModel model =
        test::model_of(falling_arm(start, {r * std::cos(a), r * std::sin(a)}, radius, k % 3 == 2));
    const Settling found = settle(model, model.start());
    ASSERT_EQ(found.end, End::settled) << k << ": " << found.why;
    EXPECT_EQ(found.active_stops, std::vector<int>{0}) << k;
    EXPECT_NEAR(test::angle_of(model, found.x, "arm"), contact, 1e-6) << k;
  }
}

// --- against slow motion ---------------------------------------------------------------------------------------------

TEST(SettleRandom, OneFreedomRestsWhereSlowMotionDoes) {
  for (std::uint64_t k = 1; k <= 200; ++k) {
    const std::uint64_t seed = test::seed(k);
    const judge::JudgedSettling judged = judge::judge_settling_of_one_freedom(seed);
    EXPECT_TRUE(judged.agrees) << seed << ": " << judged.words;
  }
}

TEST(SettleRandom, SeveralFreedomsRestWhereSlowMotionDoesOrAreInDoubt) {
  for (std::uint64_t k = 1; k <= 60; ++k) {
    const std::uint64_t seed = test::seed(k);
    const judge::JudgedSettling judged = judge::judge_settling_of_several_freedoms(seed);
    EXPECT_TRUE(judged.agrees || judged.in_doubt) << seed << ": " << judged.words;
  }
}

}  // namespace
}  // namespace poise::settle_test
