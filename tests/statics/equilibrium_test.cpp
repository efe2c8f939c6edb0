// Every outcome of a search, and that its result depends on the mechanism only.

#include "statics/equilibrium/equilibrium.hpp"

#include <atomic>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/scene.hpp"
#include "statics/model/mobility.hpp"
#include "statics/model/reference.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/elements.hpp"
#include "tests/support/known_answers.hpp"

namespace poise::equilibrium_test {
namespace {

using test::angle_of;
using test::by;
using test::dataset;

constexpr Method methods[] = {Method::virtual_work, Method::energy};

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

// A block on a vertical rail under gravity 10 m/s^2, from y = `start`; the test adds its support.
Scene block(double mass, double start, const std::string& more) {
  return parse_scene(fmt::format(R"(
    gravity = [0, -10]
    [ground]
    points = {{ R = [0, 0], top = [0, 5], bottom = [0, -5] }}
    [body.block]
    points = {{ P = [0, 0] }}
    mass = {}
    [[slide]]
    name = "rail"
    points = ["ground.R", "block.P"]
    axis = [0, 1]
    {}
    [start]
    rail = {}
  )",
                                 mass, more, start),
                     "block.toml");
}

Scene upright_chain(int links) {
  Scene scene = test::chain(links, 1.0, 1.0);
  scene.gravity = {0.0, -10.0};
  for (auto& angle : scene.start.angle) angle = M_PI_2;
  return scene;
}

void expect_message(const Scene& scene, std::vector<std::string> parts) {
  const StaticModel model(scene);
  for (const Closure& loop : model.layout().closures) {
    if (contains(parts.front(), "assembled")) parts.push_back("\"" + loop.name + "\"");
  }
  try {
    assemble(model);
    FAIL() << "assembled";
  } catch (const InputError& error) {
    for (const std::string& part : parts) EXPECT_TRUE(contains(error.what(), part)) << error.what();
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
  }
  EXPECT_THROW(solve(model, test::by(Method::virtual_work)), InputError);
}

// --- every status ----------------------------------------------------------------------------------------------------

TEST(Status, BeginsAsNotSolved) {
  const Equilibrium nothing;
  EXPECT_EQ(to_string(nothing.status), "not solved");
  EXPECT_FALSE(nothing.found());
  EXPECT_FALSE(nothing.check.is_equilibrium());
}

TEST(Status, Confirmed) {
  const StaticModel model(read_scene(dataset("thesis_four_bar.toml")));
  for (const Method method : methods) {
    const Equilibrium found = solve(model, by(method));
    EXPECT_EQ(to_string(found.status), "confirmed") << found.why;
    EXPECT_TRUE(found.found());
    EXPECT_EQ(found.method, method);
    EXPECT_GT(found.iterations, 0);
    EXPECT_GT(found.evaluations, 0);
    EXPECT_GT(found.microseconds, 0.0);
    EXPECT_TRUE(found.energy && std::isfinite(*found.energy));
    EXPECT_NE(found.why, "");
  }
}

TEST(Status, CheckedWhereAProofTakesTooLong) {
  const StaticModel model(read_scene(dataset("thesis_four_bar.toml")));
  for (const Method method : methods) {
    SolveOptions options = by(method);
    options.certificate.seconds = 0.0;
    const Equilibrium found = solve(model, options);
    EXPECT_EQ(to_string(found.status), "checked, not proved") << found.why;
    EXPECT_FALSE(found.found());
    EXPECT_TRUE(found.check.is_equilibrium());
    EXPECT_EQ(found.certificate.stability, Stability::unknown);
  }
}

TEST(Status, NotConfirmedIfTheCheckRejectsTheClaim) {
  const StaticModel model(read_scene(dataset("thesis_four_bar.toml")));
  for (const Method method : methods) {
    SolveOptions options = by(method);
    options.certificate.seconds = 0.0;
    options.check.imbalance = 1e-30;
    options.check.closure = 1e-30;
    const Equilibrium found = solve(model, options);
    EXPECT_EQ(to_string(found.status), "not confirmed") << found.why;
    EXPECT_FALSE(found.found());
    EXPECT_NE(found.check.objection, "");
    EXPECT_TRUE(contains(found.why, found.check.objection)) << found.why;
  }
}

TEST(Status, NotFoundWhereThereIsNoRest) {
  const StaticModel model(block(2.0, 0.0, ""));
  for (const Method method : methods) {
    for (const Seek seek : {Seek::any, Seek::stable}) {
      const Equilibrium found = solve(model, by(method, seek));
      EXPECT_EQ(to_string(found.status), "not found") << found.why;
      EXPECT_FALSE(found.check.is_equilibrium());
      EXPECT_TRUE(contains(found.why, "body \"block\" is out of balance by 20 N")) << found.why;
    }
  }
}

TEST(Status, NotFoundWhereItIsNotOfTheKindSought) {
  // Ipopt does not leave an exact maximum.
  const StaticModel model(upright_chain(1));
  const Equilibrium found = solve(model, model.start(), by(Method::energy, Seek::stable));
  if (found.found()) {
    EXPECT_EQ(found.certificate.stability, Stability::stable);
  } else {
    EXPECT_EQ(to_string(found.status), "not found");
    EXPECT_TRUE(found.check.is_equilibrium());
    EXPECT_TRUE(contains(found.why, "unstable equilibrium")) << found.why;
  }
}

TEST(Status, NotApplicableNamesTheForceWithoutPotential) {
  Scene scene = upright_chain(2);
  test::add_force(scene, "2.b", {-3.0, 0.0}, "thrust");
  scene.forces[0].follows = 2;
  scene.start.angle[1] = scene.start.angle[2] = -1.0;
  const StaticModel model(scene);
  const Equilibrium found = solve(model, by(Method::energy));
  EXPECT_EQ(to_string(found.status), "not applicable");
  EXPECT_TRUE(contains(found.why, "\"thrust\"")) << found.why;
  EXPECT_FALSE(found.found());
  const Equilibrium by_work = solve(model, test::by(Method::virtual_work));
  EXPECT_TRUE(by_work.found()) << by_work.why;
  EXPECT_FALSE(by_work.energy);
}

TEST(Status, Interrupted) {
  const StaticModel model(read_scene(dataset("thesis_chain.toml")));
  const std::atomic<bool> interrupt{true};
  for (const Method method : methods) {
    SolveOptions options = by(method);
    options.interrupt = &interrupt;
    const Equilibrium found = solve(model, options);
    EXPECT_EQ(to_string(found.status), "interrupted") << found.why;
    EXPECT_FALSE(found.found());
    EXPECT_EQ(found.x.size(), static_cast<std::size_t>(model.mechanism().coordinates()));
  }
}

TEST(Status, MethodsHaveTheNamesOfTheCommandLine) {
  EXPECT_EQ(to_string(Method::virtual_work), "virtual-work");
  EXPECT_EQ(to_string(Method::energy), "energy");
}

// --- what cannot be solved for -----------------------------------------------------------------------------------

// Each method speaks for itself: none runs another's program under its name.
TEST(Dispatch, EveryMethodRunsItsOwnProgram) {
  const std::map<Method, std::string> programs = {
      {Method::virtual_work, "Newton: "},
      {Method::energy, "Ipopt: "},
      {Method::augmented_lagrangian, "augmented Lagrangian: "},
      {Method::augmented_lagrangian_modified, "modified augmented Lagrangian: "},
      {Method::slsqp, "NLopt SLSQP: "},
      {Method::auglag_lbfgs, "NLopt AUGLAG with L-BFGS: "},
      {Method::cobyla, "NLopt COBYLA: "},
      {Method::dynamic_relaxation, "dynamic relaxation: "},
      {Method::least_squares, "Ceres: "}};
  const StaticModel model(read_scene(dataset("thesis_four_bar.toml")));
  for (const MethodTraits& method : all_methods()) {
    const Equilibrium found = solve(model, by(method.method));
    EXPECT_TRUE(found.why.starts_with(programs.at(method.method))) << method.name << ": " << found.why;
  }
}

// The weights change the way to the equilibrium, not where it is, nor the reactions there.
TEST(Dispatch, WeightsOfTheAugmentedLagrangianLeaveTheEquilibrium) {
  const StaticModel model(read_scene(dataset("six_bar.toml")));
  const Equilibrium reference = solve(model, by(Method::virtual_work));
  ASSERT_TRUE(reference.found()) << reference.why;
  std::set<int> ways;
  for (const double penalty : {0.0, 10.0, 1e3}) {
    for (const double scaling : {1e-3, 1.0, 1e3}) {
      SolveOptions options = by(Method::augmented_lagrangian);
      options.seek = Seek::any;
      options.lagrangian = {scaling, penalty};
      const Equilibrium found = solve(model, options);
      ASSERT_TRUE(found.found()) << penalty << " " << scaling << ": " << found.why;
      ASSERT_EQ(found.x.size(), reference.x.size());
      for (std::size_t i = 0; i < found.x.size(); ++i) EXPECT_NEAR(found.x[i], reference.x[i], 1e-9);
      ways.insert(found.iterations);
    }
  }
  EXPECT_GT(ways.size(), 1U) << "a penalty that changes nothing on the way";
}

TEST(Dispatch, AMethodThatIsNoneIsRefused) {
  const StaticModel model(read_scene(dataset("thesis_four_bar.toml")));
  EXPECT_THROW(solve(model, by(static_cast<Method>(all_methods().size()))), std::invalid_argument);
}

TEST(Assemble, NamesTheOpenLoopAndItsGap) {
  // Three links of a metre cannot span 5 m: two are missing.
  Scene scene = test::chain(3, 1.0, 1.0);
  scene.file = "span.toml";
  scene.gravity = {0.0, -10.0};
  scene.add_point(0, "E", {5.0, 0.0});
  test::add_pin(scene, "3.b", "ground.E");
  expect_message(scene, {"cannot be assembled", "span.toml: mechanism:", "open by 2 m"});
}

TEST(Assemble, NamesTheStopThatCannotBeKeptAndItsLine) {
  const Scene scene = parse_scene(
      "gravity = [0, -10]\n[ground]\npoints = { O = [0, 0] }\n[body.rod]\npoints = { O = [0, 0] }\nmass = 1\n"
      "center = [1, 0]\n[[pin]]\npoints = [\"ground.O\", \"rod.O\"]\n[[stop]]\nname = \"low\"\n"
      "bodies = [\"ground\", \"rod\"]\nmax = 0.5\n[[stop]]\nname = \"high\"\nbodies = [\"ground\", \"rod\"]\nmin = "
      "1.5\n",
      "stops.toml");
  expect_message(scene, {"stops.toml:1", ": mechanism:", "cannot be assembled", "stop \"", "remains overrun by 0.5"});
}

TEST(Solve, MovesARodWhosePinWasWrittenTwice) {
  // 0.3 and 0.1 + 0.2: closures with derivatives of rounding only hold nothing.
  Scene scene = parse_scene(
      "gravity = [0, -10]\n[ground]\npoints = { O = [0, 0] }\n[body.rod]\n"
      "points = { a = [0.3, 0], b = [0.30000000000000004, 0] }\nmass = 1\ncenter = [0.5, 0]\n"
      "[[pin]]\npoints = [\"ground.O\", \"rod.a\"]\n[[pin]]\npoints = [\"ground.O\", \"rod.b\"]\n[start]\nrod = -1\n",
      "rod.toml");
  const StaticModel model(scene);
  EXPECT_NEAR(solve(model, test::by(Method::virtual_work)).x.at(0), -M_PI_2, 1e-12);
  SolveOptions stable;
  stable.seek = Seek::stable;
  scene.start.angle[1] = 1.0;
  EXPECT_NEAR(std::sin(solve(StaticModel(scene), stable).x.at(0)), -1.0, 1e-12);
}

// Whether the failure is one of the search, or of a scene that no pose can satisfy.
bool may_be_assembled(const Scene& scene) {
  try {
    assemble(StaticModel(scene));
  } catch (const AssemblyError& error) {
    EXPECT_TRUE(contains(error.what(), "cannot be assembled from its start")) << error.what();
    return true;
  } catch (const InputError& error) {
    EXPECT_TRUE(contains(error.what(), "cannot be assembled in any position")) << error.what();
    return false;
  }
  ADD_FAILURE() << "assembled";
  return false;
}

TEST(Assemble, TellsAStartThatFailsFromAMechanismThatCannotClose) {
  Scene hood = read_scene(dataset("car_hood.toml"));
  set_value(hood, "start.rear", 132);
  set_value(hood, "start.front", -143);
  set_value(hood, "start.hood", -52);
  EXPECT_TRUE(may_be_assembled(hood));
  // Links of 3 m span neither 5 m nor, with one of them 7 m long, 2 m.
  for (const double longest : {1.0, 7.0}) {
    Scene chain = test::chain(3, 1.0, 1.0);
    chain.bodies[2].points[2].at.x = longest;
    chain.add_point(0, "E", {longest > 1.0 ? 2.0 : 5.0, 0.0});
    test::add_pin(chain, "3.b", "ground.E");
    EXPECT_FALSE(may_be_assembled(chain)) << longest;
  }
  // A stop that wants the tip farther from the ground than the links reach.
  Scene reach = test::chain(2, 1.0, 1.0);
  reach.gravity = {0.0, -10.0};
  Stop stop;
  stop.name = "far";
  stop.on = Measure::distance_between(test::point(reach, "ground.O"), test::point(reach, "2.b"));
  stop.min = 2.5;
  reach.stops.push_back(stop);
  EXPECT_FALSE(may_be_assembled(reach));
}

TEST(Assemble, StartsABodyOnBarsAtThePositionOfTheScene) {
  // A plank on two legs of one metre; its start position decides whether it stands on them or hangs from them.
  for (const double side : {1.0, -1.0}) {
    Scene scene = parse_scene(
        "gravity = [0, -10]\n[ground]\npoints = { A = [0, 0], B = [2, 0] }\n[body.plank]\n"
        "points = { a = [0, 0], b = [1.8, 0] }\nmass = 1\ncenter = [0.9, 0]\n"
        "[[bar]]\npoints = [\"ground.A\", \"plank.a\"]\nlength = 1\n"
        "[[bar]]\npoints = [\"ground.B\", \"plank.b\"]\nlength = 1\n"
        "[start]\nposition = { plank = [0.12, " +
            std::to_string(0.98 * side) + "] }\n",
        "plank");
    const StaticModel model(scene);
    const Equilibrium equilibrium = solve(model, test::by(Method::virtual_work));
    ASSERT_TRUE(equilibrium.found()) << equilibrium.why;
    EXPECT_EQ(equilibrium.certificate.stability, side > 0 ? Stability::unstable : Stability::stable);
    EXPECT_NEAR(model.poses(equilibrium.x)[1].origin.y, side * std::sqrt(1.0 - 0.01), 1e-12);
  }
}

TEST(Solve, ProvesWhatASpringTooStiffForDoubleHides) {
  const auto lever = [](const std::string& stiffness) {
    const StaticModel model(parse_scene(
        "gravity = [0, -9.81]\n[ground]\npoints = { O = [0, 0], S = [0.3, 0.4] }\n[body.lever]\n"
        "points = { O = [0, 0], S = [0.3, 0] }\nmass = 4\ncenter = [0.25, 0]\n[[pin]]\n"
        "points = [\"ground.O\", \"lever.O\"]\n[[spring]]\nname = \"S\"\npoints = [\"ground.S\", \"lever.S\"]\n"
        "free_length = 0.41\nstiffness = " +
            stiffness + "\n",
        "lever"));
    SolveOptions options;
    options.safeguards.restarts = false;  // another start may by chance round to a balance
    const Equilibrium found = solve(model, options);
    const Reference exact = refine(model, found.x);
    EXPECT_TRUE(exact.refined) << exact.why;
    EXPECT_LE(exact.error, found.certificate.radius);
    return found;
  };
  EXPECT_EQ(lever("1e6").status, Status::confirmed);
  EXPECT_EQ(lever("1e20").status, Status::confirmed);
}

TEST(Assemble, ReportsTheGapInTheUnitsOfTheScene) {
  Scene scene = test::chain(2, 1.0, 1.0);
  scene.units.length_name = "mm";
  scene.units.length = 1e-3;
  scene.add_point(0, "E", {0.0, -2.5});
  scene.start.angle[1] = scene.start.angle[2] = -1.5;
  test::add_pin(scene, "2.b", "ground.E");
  expect_message(scene, {"cannot be assembled", "open by 500 mm"});
}

TEST(Assemble, ReportsThatNoDegreeOfFreedomIsLeft) {
  Scene scene = test::chain(2, 1.0, 1.0);
  scene.gravity = {0.0, -10.0};
  scene.add_point(0, "E", {1.0, 0.0});
  scene.start.angle[1] = -1.0;
  scene.start.angle[2] = 1.0;
  test::add_pin(scene, "2.b", "ground.E");
  expect_message(scene, {"no degree of freedom left", "2 coordinates", "2 independent closure equations",
                         "of a structure, poise loads and poise forces", "poise equilibria --assemblies"});
}

TEST(Assemble, ReportsThatNothingCanMove) {
  expect_message(test::chain(2, 1.0, 1.0), {"nothing can move under load"});
  expect_message(Scene(), {"nothing can move under load", "of a structure, poise loads and poise forces"});
}

TEST(Assemble, ClosesLoopsFromAnOpenStart) {
  const StaticModel model(
      test::started_at(read_scene(dataset("thesis_four_bar.toml")), {{"link4", 1.5}, {"link6", 0.1}, {"link7", 5.0}}));
  const Check check = poise::check(model, assemble(model));
  EXPECT_TRUE(check.closed);
  EXPECT_FALSE(check.is_equilibrium());
}

// --- minima ------------------------------------------------------------------------------------------------------

TEST(SeekStable, LeavesAnExactMaximum) {
  for (const int links : {1, 2, 5, 60}) {
    const StaticModel model(upright_chain(links));
    const Equilibrium top = solve(model, test::by(Method::virtual_work));
    EXPECT_EQ(top.certificate.unstable_directions, links);
    const Equilibrium found = solve(model, by(Method::virtual_work, Seek::stable));
    ASSERT_TRUE(found.found()) << found.why;
    EXPECT_EQ(to_string(found.certificate.stability), "stable");
    for (int i = 1; i <= links; ++i) {
      const double angle = angle_of(model, found.x, std::to_string(i));
      EXPECT_LE(std::abs(std::remainder(angle + M_PI_2, 2 * M_PI)), 1e-12) << i;
    }
    EXPECT_LT(found.energy.value(), top.energy.value());
  }
}

TEST(SeekStable, LeavesAnExactSaddle) {
  Scene scene = upright_chain(3);
  scene.start.angle[2] = -M_PI_2;
  const StaticModel model(scene);
  EXPECT_EQ(solve(model, test::by(Method::virtual_work)).certificate.unstable_directions, 2);
  const Equilibrium found = solve(model, by(Method::virtual_work, Seek::stable));
  ASSERT_TRUE(found.found()) << found.why;
  EXPECT_EQ(to_string(found.certificate.stability), "stable");
}

// --- stops -------------------------------------------------------------------------------------------------------

TEST(StopsInSearch, BothMethodsFindEquilibriaAtThem) {
  const char* held[] = {"[[stop]]\nname = \"stop\"\nslide = \"rail\"\nmin = -2\nmax = 4\n",
                        "[[stop]]\nname = \"stop\"\npoints = [\"ground.top\", \"block.P\"]\nmax = 7\n",
                        "[[stop]]\nname = \"stop\"\npoints = [\"ground.bottom\", \"block.P\"]\nmin = 3\n"};
  for (const char* stop : held) {
    SCOPED_TRACE(stop);
    const StaticModel model(block(2.0, 1.0, stop));
    for (const Method method : methods) {
      for (const Seek seek : {Seek::any, Seek::stable}) {
        const Equilibrium found = solve(model, by(method, seek));
        ASSERT_TRUE(found.found()) << to_string(method) << ": " << found.why;
        EXPECT_NEAR(test::travel_of(model, found.x, "rail"), -2.0, method == Method::energy ? 4e-8 : 1e-12);
        EXPECT_NEAR(test::reaction_of(found.check, "stop").force.y, 20.0, 1e-9);
        EXPECT_EQ(to_string(found.certificate.stability), "stable");
      }
    }
  }
}

TEST(StopsInSearch, TheMethodsAgreeOnTheClamp) {
  const StaticModel model(read_scene(dataset("toggle_clamp.toml")));
  const Equilibrium work = solve(model, test::by(Method::virtual_work));
  const Equilibrium energy = solve(model, by(Method::energy));
  ASSERT_TRUE(work.found()) << work.why;
  ASSERT_TRUE(energy.found()) << energy.why;
  for (const char* body : {"handle", "link", "arm"}) {
    EXPECT_NEAR(angle_of(model, work.x, body), angle_of(model, energy.x, body), 1e-8) << body;
  }
  EXPECT_NEAR(test::reaction_of(work.check, "over_centre").moment,
              test::reaction_of(energy.check, "over_centre").moment, 1e-6);
  EXPECT_NEAR(work.energy.value(), energy.energy.value(), 1e-8);
}

TEST(StopsInSearch, TheClampOpensToItsOtherStop) {
  Scene scene = read_scene(dataset("toggle_clamp.toml"));
  set_value(scene, "load.P", 38.0);
  const StaticModel model(scene);
  for (const Seek seek : {Seek::any, Seek::stable}) {
    const Equilibrium found = solve(model, by(Method::virtual_work, seek));
    ASSERT_TRUE(found.found()) << found.why;
    EXPECT_EQ(to_string(found.certificate.stability), "stable");
    EXPECT_NEAR(angle_of(model, found.x, "arm"), scene.stops[1].max, 1e-12);
    EXPECT_LT(test::reaction_of(found.check, "open").moment, 0.0);
    EXPECT_THROW(test::reaction_of(found.check, "over_centre"), std::out_of_range);
  }
}

// --- springs that go slack ---------------------------------------------------------------------------------------

struct SlackCase {
  const char* name;
  const char* spring;
  double start, equilibrium;
};

class Slack : public testing::TestWithParam<SlackCase> {};

TEST_P(Slack, BothMethodsFindTheRest) {
  const StaticModel model(block(2.0, GetParam().start, GetParam().spring));
  for (const Method method : methods) {
    for (const Seek seek : {Seek::any, Seek::stable}) {
      const Equilibrium found = solve(model, by(method, seek));
      ASSERT_TRUE(found.found()) << to_string(method) << ": " << found.why;
      EXPECT_NEAR(test::travel_of(model, found.x, "rail"), GetParam().equilibrium,
                  method == Method::energy ? 1e-9 : 1e-12);
      EXPECT_EQ(to_string(found.certificate.stability), "stable");
    }
  }
}

constexpr const char* hanger =
    "[[spring]]\npoints = [\"ground.top\", \"block.P\"]\nstiffness = 100\nfree_length = 3\nacts = \"tension\"\n";
constexpr const char* cushion =
    "[[spring]]\npoints = [\"ground.bottom\", \"block.P\"]\nstiffness = 100\nfree_length = 3\nacts = \"compression\"\n"
    "[[stop]]\nslide = \"rail\"\nmin = -4.5\n";  // for past its foot the cushion is clear again
constexpr const char* rope_below =
    "[[spring]]\npoints = [\"ground.bottom\", \"block.P\"]\nstiffness = 100\nfree_length = 3\nacts = \"tension\"\n";

INSTANTIATE_TEST_SUITE_P(Springs, Slack,
                         testing::Values(SlackCase{"HangerTaut", hanger, 1.0, 1.8},
                                         SlackCase{"HangerSlackAtFirst", hanger, 4.0, 1.8},
                                         SlackCase{"CushionPressed", cushion, -2.5, -2.2},
                                         SlackCase{"CushionClearAtFirst", cushion, 4.0, -2.2},
                                         SlackCase{"RopeFromBelowSlackAtFirst", rope_below, -4.0, -8.2}),
                         [](const auto& scene) { return std::string(scene.param.name); });

TEST(SlackSpring, ASlackSpringHasNoForce) {
  // A hanger that acts in compression only, already slack.
  Scene scene = block(2.0, 0.0, hanger);
  test::law<LinearSpring>(scene, "spring").acts = LinearSpring::Acts::compression;
  const StaticModel model(scene);
  for (const Method method : methods) {
    EXPECT_EQ(to_string(solve(model, by(method)).status), "not found") << to_string(method);
  }
}

TEST(SlackSpring, ASlackRopeDoesNotActOnThePendulum) {
  const StaticModel model(parse_scene(R"(
    gravity = [0, -10]
    [ground]
    points = { O = [0, 0], S = [1, -1] }
    [body.arm]
    points = { O = [0, 0], P = [1, 0] }
    mass = 1
    center = [1, 0]
    [[pin]]
    name = "hinge"
    points = ["ground.O", "arm.O"]
    [[spring]]
    points = ["ground.S", "arm.P"]
    stiffness = 1000
    free_length = 1.5
    acts = "tension"
    [start]
    arm = -3
  )",
                                      "rope.toml"));
  for (const Method method : methods) {
    const Equilibrium found = solve(model, by(method, Seek::stable));
    ASSERT_TRUE(found.found()) << found.why;
    EXPECT_NEAR(angle_of(model, found.x, "arm"), -M_PI_2, method == Method::energy ? 1e-9 : 1e-12);
    EXPECT_NEAR(test::reaction_of(found.check, "hinge").force.x, 0.0, 1e-8);
  }
}

// --- invariance --------------------------------------------------------------------------------------------------

// A slider-crank with weights, springs of both kinds, a force, a torque and a stop, `size` times as large, its loads
// `load` times as heavy, written in units of which one is `metre` m and `newton` N.
Scene slider_crank(double size, double load, const char* length_name, double metre, const char* force_name,
                   double newton) {
  const double l = size / metre;
  const double f = load / newton;
  return parse_scene(
      fmt::format(R"(
    gravity = [0, {gravity}]
    [units]
    length = "{length_name}"
    force = "{force_name}"
    [ground]
    points = {{ O = [0, 0], S = [{s3}, {s4}] }}
    [body.crank]
    points = {{ O = [0, 0], B = [{s2}, 0] }}
    mass = {mass}
    center = [{s1}, 0]
    [body.rod]
    points = {{ B = [0, 0], C = [{s5}, 0] }}
    mass = {mass}
    center = [{s2}, {s1}]
    [body.block]
    points = {{ C = [0, 0] }}
    mass = {mass}
    [[pin]]
    points = ["ground.O", "crank.O"]
    [[pin]]
    points = ["crank.B", "rod.B"]
    [[pin]]
    name = "wrist"
    points = ["rod.C", "block.C"]
    [[slide]]
    name = "rail"
    points = ["ground.O", "block.C"]
    axis = [0.8, -0.6]
    [[spring]]
    points = ["ground.S", "rod.C"]
    stiffness = {stiffness}
    free_length = {s2}
    [[torsion_spring]]
    bodies = ["crank", "rod"]
    stiffness = {torsional}
    free_angle = 0.5
    [[force]]
    at = "rod.C"
    vector = [{force}, {force}]
    [[torque]]
    on = "crank"
    value = {torque}
    [[stop]]
    slide = "rail"
    min = {s1}
    [start]
    crank = 0.5
    rod = -1
    rail = {s5}
  )",
                  fmt::arg("gravity", -10.0 / metre), fmt::arg("length_name", length_name),
                  fmt::arg("force_name", force_name), fmt::arg("s1", 0.1 * l), fmt::arg("s2", 0.2 * l),
                  fmt::arg("s3", 0.3 * l), fmt::arg("s4", 0.4 * l), fmt::arg("s5", 0.5 * l),
                  fmt::arg("mass", 0.7 * load), fmt::arg("stiffness", 30 * f / l), fmt::arg("torsional", 0.9 * f * l),
                  fmt::arg("force", 3 * f), fmt::arg("torque", 0.4 * f * l)),
      "slider_crank.toml");
}

struct SliderPose {
  double crank, rod, wrist;
};

SliderPose equilibrium_of(const Scene& scene, Method method, double load) {
  const StaticModel model(scene);
  const Equilibrium found = solve(model, by(method));
  EXPECT_TRUE(found.found()) << found.why;
  return {angle_of(model, found.x, "crank"), angle_of(model, found.x, "rod"),
          norm(test::reaction_of(found.check, "wrist").force) / load};
}

class Invariance : public testing::TestWithParam<Method> {
 protected:
  void expect_same(const Scene& scene, double load = 1.0) {
    const SliderPose known = equilibrium_of(slider_crank(1.0, 1.0, "m", 1.0, "N", 1.0), GetParam(), 1.0);
    const SliderPose equilibrium = equilibrium_of(scene, GetParam(), load);
    const double tolerance = GetParam() == Method::energy ? 1e-9 : 1e-12;
    EXPECT_NEAR(equilibrium.crank, known.crank, tolerance);
    EXPECT_NEAR(equilibrium.rod, known.rod, tolerance);
    EXPECT_NEAR(equilibrium.wrist, known.wrist, 100 * tolerance);
  }
};

TEST_P(Invariance, OfUnits) {
  expect_same(slider_crank(1.0, 1.0, "mm", 1e-3, "N", 1.0));
  expect_same(slider_crank(1.0, 1.0, "m", 1.0, "kN", 1e3));
  expect_same(slider_crank(1.0, 1.0, "in", 0.0254, "lbf", 4.4482216152605));
  expect_same(slider_crank(1.0, 1.0, "mm", 1e-3, "kN", 1e3));
}

TEST_P(Invariance, OfSizeFromMicrometresToKilometres) {
  for (const double size : {1e-6, 1e-3, 0.37, 1e3, 1e6}) {
    SCOPED_TRACE(size);
    expect_same(slider_crank(size, 1.0, "m", 1.0, "N", 1.0));
  }
}

TEST_P(Invariance, OfLoadFromMicronewtonsToGiganewtons) {
  for (const double load : {1e-6, 1e-3, 0.37, 1e3, 1e9}) {
    SCOPED_TRACE(load);
    expect_same(slider_crank(1.0, load, "m", 1.0, "N", 1.0), load);
  }
}

TEST_P(Invariance, OfARunRepeated) {
  const StaticModel model(slider_crank(1.0, 1.0, "m", 1.0, "N", 1.0));
  EXPECT_EQ(solve(model, by(GetParam())).x, solve(model, by(GetParam())).x);
}

INSTANTIATE_TEST_SUITE_P(Methods, Invariance, testing::ValuesIn(methods),
                         [](const auto& method) { return method.param == Method::energy ? "Energy" : "VirtualWork"; });

// Balanced in every position by a spring of free length zero, in numbers that are not exact in binary.
TEST(Equilibrium, ABalancedArmStaysWhereItStarts) {
  struct Arm {
    double mass, center, hook, eye, stiffness;
  };
  for (const Arm& arm : {Arm{0.7, 0.35, 0.3, 0.2, 40.0575}, Arm{1.2, 0.5, 0.3, 0.1, 196.2}}) {
    for (const double degrees : {60.0, 30.0, 20.0, 89.9, -75.0, 151.3}) {
      const double start = degrees * M_PI / 180;
      const StaticModel model(parse_scene(fmt::format(R"(
gravity = [0, -9.81]
[ground]
points = {{ O = [0, 0], S = [0, {}] }}
[body.arm]
points = {{ O = [0, 0], A = [{}, 0] }}
mass = {}
center = [{}, 0]
[[pin]]
points = ["ground.O", "arm.O"]
[[spring]]
name = "k"
points = ["ground.S", "arm.A"]
stiffness = {}
free_length = 0
[start]
arm = {:.17g}
)",
                                                      arm.hook, arm.eye, arm.mass, arm.center, arm.stiffness, start),
                                          "arm.toml"));
      for (const Seek seek : {Seek::settle, Seek::any, Seek::stable}) {
        const Equilibrium found = solve(model, {.seek = seek});
        EXPECT_EQ(found.status, Status::confirmed);
        EXPECT_EQ(found.certificate.outcome, Outcome::neutral);
        EXPECT_NEAR(model.to_si(found.x)[0], start, 1e-12) << to_string(seek);
        if (!found.settling) continue;
        EXPECT_EQ(found.settling->end, Settling::End::settled) << "falls by rounding from " << degrees << " deg";
        EXPECT_TRUE(found.settling->sides.empty());
      }
    }
  }
}

// A lamp whose upper arm is balanced in every position, while its lower arm sinks to its stop and the shade swings to
// its rest: the search must not carry the upper arm along.
TEST(Equilibrium, ABalancedArmStaysWhileOtherBodiesFindTheirRest) {
  const StaticModel model(parse_scene(R"(
gravity = [0, -10]
[ground]
points = { O = [0, 0], Q = [0, 0.5], hook = [0, 1] }
[body.lower]
points = { O = [0, 0], eye = [0.25, 0], P = [1, 0] }
mass = 1
center = [0.5, 0]
[body.stay]
points = { Q = [0, 0], R = [1, 0] }
[body.crosshead]
points = { P = [0, 0], R = [0, 0.5], hook = [0, 1] }
[body.upper]
points = { P = [0, 0], eye = [0.25, 0], E = [1, 0] }
mass = 1.5
center = [0.5, 0]
[body.shade]
points = { E = [0, 0] }
mass = 0.25
center = [0.125, 0]
[[pin]]
points = ["upper.E", "shade.E"]
[[pin]]
points = ["ground.O", "lower.O"]
[[pin]]
points = ["ground.Q", "stay.Q"]
[[pin]]
points = ["lower.P", "crosshead.P"]
[[pin]]
points = ["stay.R", "crosshead.R"]
[[pin]]
name = "elbow"
points = ["lower.P", "upper.P"]
[[spring]]
name = "shoulder"
points = ["ground.hook", "lower.eye"]
stiffness = 100
free_length = 0
[[spring]]
name = "forearm"
points = ["crosshead.hook", "upper.eye"]
stiffness = 40
free_length = 0
[[stop]]
bodies = ["ground", "lower"]
min = -1.2
max = 1.2
[start]
lower = 0.7
stay = 0.7
upper = -0.4
shade = -1
)",
                                      "lamp.toml"));
  for (const Seek seek : {Seek::any, Seek::settle}) {
    const Equilibrium found = solve(model, {.seek = seek});
    ASSERT_EQ(found.status, Status::confirmed) << found.why;
    EXPECT_EQ(found.certificate.outcome, Outcome::neutral);
    std::map<std::string, double> at;
    for (std::size_t i = 0; i < found.x.size(); ++i) at[model.layout().coordinates[i].name] = model.to_si(found.x)[i];
    EXPECT_NEAR(at["lower"], 1.2, 1e-12);
    EXPECT_NEAR(at["shade"], -M_PI_2, 1e-9);
    EXPECT_NEAR(at["upper"], -0.4, 1e-8) << to_string(seek);
  }
}

// Its first step, the whole gradient, led past the nearest minimum beside stiff springs, and away from a solution.
TEST(Equilibrium, ShortFirstStepsOfLbfgsStayNear) {
  const StaticModel clamp(read_scene(dataset("toggle_clamp.toml")));
  EXPECT_EQ(solve(clamp, {.method = Method::auglag_lbfgs}).status, Status::confirmed);
  const StaticModel lift(read_scene(dataset("lift.toml")));
  const std::vector<double> near = solve(lift, {.seek = Seek::any}).x;
  for (const double tolerance : {1e-6, 1e-8, 1e-10, 1e-12}) {
    const Equilibrium found = solve(lift, {.method = Method::auglag_lbfgs, .seek = Seek::any, .tolerance = tolerance});
    ASSERT_EQ(found.status, Status::confirmed) << tolerance << ": " << found.why;
    for (std::size_t i = 0; i < near.size(); ++i) EXPECT_NEAR(found.x[i], near[i], 1e-9) << tolerance;
  }
}

}  // namespace
}  // namespace poise::equilibrium_test
