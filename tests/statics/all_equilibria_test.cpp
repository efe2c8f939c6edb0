// Sets of equilibria against closed forms and the known sets of datasets/answers.json.

#include "statics/all_equilibria/all_equilibria.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "statics/all_equilibria/private/enclosed_set.hpp"
#include "statics/all_equilibria/private/index_sum.hpp"
#include "statics/all_equilibria/turns.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/elements.hpp"
#include "tests/support/known_answers.hpp"

namespace poise::all_equilibria_test {
namespace {

using nlohmann::json;
using test::angle_of;
using test::dataset;

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

AllEquilibriaOptions sampling(int starts) {
  AllEquilibriaOptions options;
  options.seconds = 0.0;
  options.starts = starts;
  return options;
}

// `count` uniform links of 1 m and 1 kg under gravity 10 m/s^2, and a level force at the tip: from the downward
// vertical tan phi_i = F / ((n - i + 1/2) m g), each link turned round or not.
Scene pulled_chain(int count, double force) {
  Scene scene = test::chain(count, 1.0, 1.0);
  scene.gravity = {0.0, -10.0};
  for (int i = 1; i <= count; ++i) scene.start.angle[static_cast<std::size_t>(i)] = -1.0;
  test::add_force(scene, fmt::format("{}.b", count), {force, 0.0}, "F");
  return scene;
}

StaticModel held_four_bar(double crank) {
  Scene scene = read_scene(dataset("four_bar_gravity.toml"));
  test::add_stop(scene, "motor", 0, 1, crank, crank);
  scene.start.angle[1] = crank;
  return StaticModel(scene);
}

std::map<int, int> by_unstable_directions(const EquilibriumSet& set) {
  std::map<int, int> out;
  for (const Equilibrium& e : set.equilibria) ++out[e.certificate.unstable_directions];
  return out;
}

// --- which there are -------------------------------------------------------------------------------------------------

TEST(AllEquilibria, AChainHasTwoForEachLink) {
  int all = 1;
  for (int n = 1; n <= 5; ++n) {
    all *= 2;
    const StaticModel model(pulled_chain(n, 10.0));
    const EquilibriumSet set = all_equilibria(model, sampling(2000));
    EXPECT_EQ(set.claim, Claim::sampled);
    ASSERT_EQ(set.equilibria.size(), static_cast<std::size_t>(all)) << set.statement;
    int binomial = 1;
    const std::map<int, int> found = by_unstable_directions(set);
    for (int k = 0; k <= n; ++k) {
      EXPECT_EQ(found.at(k), binomial) << n << " links, " << k << " unstable directions";
      binomial = binomial * (n - k) / (k + 1);
    }
    EXPECT_EQ(set.settles_into, 0);
    EXPECT_FALSE(contains(set.statement, "missing")) << set.statement;
    for (const Equilibrium& e : set.equilibria) {
      for (int i = 1; i <= n; ++i) {
        const double phi = e.x[static_cast<std::size_t>(i) - 1] + M_PI_2;
        EXPECT_NEAR(std::tan(phi), 10.0 / ((n - i + 0.5) * 10.0), 1e-12);
      }
    }
  }
}

TEST(AllEquilibria, AreTheKnownSetsOfTheDatasets) {
  const json answers = test::read_json(dataset("answers.json"));
  int sets = 0;
  for (const auto& [name, known] : answers.items()) {
    if (!known.value("complete", false) || !known.contains("equilibria")) continue;
    const StaticModel model(read_scene(dataset(name)));
    if (model.mechanism().coordinates() > 12) continue;
    const EquilibriumSet set = all_equilibria(model, sampling(4000));
    ++sets;
    // On its stop the press can also be assembled with the lower link folded up, which its answer leaves out.
    const std::size_t folded = name == "knee_press.toml" ? 1 : 0;
    EXPECT_EQ(set.equilibria.size(), known.at("equilibria").size() + folded) << name << ": " << set.statement;
    const Turns turns(model);
    for (const json& one : known.at("equilibria")) {
      std::map<std::string, double> values;
      for (const char* kind : {"angles", "travels"}) {
        for (const auto& [body, value] : one.at(kind).items()) values[body] = test::number(value);
      }
      const std::vector<double> x = test::coordinates_at(model, values);
      const auto found = std::find_if(set.equilibria.begin(), set.equilibria.end(), [&](const Equilibrium& e) {
        return turns.distance(e.x, x) <= 1e-9 + e.certificate.radius + e.certificate.rounding_effect;
      });
      ASSERT_NE(found, set.equilibria.end()) << name << ": " << one.dump();
      EXPECT_EQ(found->certificate.unstable_directions, one.at("unstable_directions").get<int>()) << name;
    }
  }
  EXPECT_GE(sets, 10);
}

TEST(AllEquilibria, SaysWhereTurnsOfLoopsAreNotKnownToBeReached) {
  Scene scene = test::chain(4, 1.0, 1.0);
  const PointRef end = scene.add_point(0, "E", {0.8, 0.3});
  test::add_pin(scene, "4.b", scene.name_of(end), "end");
  const double start[] = {1.5, 0.3, -0.5, -1.5};
  for (int i = 0; i < 4; ++i) scene.start.angle[static_cast<std::size_t>(i) + 1] = start[i];
  test::add_torsion_spring(scene, 0, 1, 3.0, 1.5);
  scene.gravity = {0.0, -10.0};
  const EquilibriumSet set = all_equilibria(StaticModel(scene), sampling(50));
  EXPECT_TRUE(contains(set.statement, "turns of their loops to which no motion leads")) << set.statement;
}

// Next to a pose in which it almost lies in one line this four-bar has a summit so narrow that 300 random starts miss
// it.
TEST(AllEquilibria, AreFoundAlongCurvesOfPoses) {
  Scene scene = read_scene(dataset("four_bar_torsion.toml"));
  for (const auto& [path, value] :
       std::map<std::string, double>{{"point.crank.B.x", 1.878229606445824},
                                     {"point.coupler.C.x", 2.6093830349722804},
                                     {"point.rocker.C.x", 3.2632183031206026},
                                     {"torsion_spring.at_A.stiffness", 2.5466721179851626},
                                     {"torsion_spring.at_A.free_angle", -1.680202123762187},
                                     {"torsion_spring.at_B.stiffness", 1.782931932554897},
                                     {"torsion_spring.at_B.free_angle", 1.6396730369693788},
                                     {"torsion_spring.at_C.stiffness", 0.6531879357073122},
                                     {"torsion_spring.at_C.free_angle", 1.8530759238886576},
                                     {"torsion_spring.at_D.stiffness", 0.801622825329451},
                                     {"torsion_spring.at_D.free_angle", 0.5516029020804978}}) {
    set_value(scene, path, value);
  }
  const EquilibriumSet set = all_equilibria(StaticModel(scene), sampling(1));
  ASSERT_EQ(set.equilibria.size(), 4U) << set.statement;
  EXPECT_NEAR(angle_of(StaticModel(scene), set.equilibria[3].x, "crank"), 3.04219, 1e-5);
  EXPECT_TRUE(contains(set.statement, "and along 1 curve of positions")) << set.statement;
}

TEST(AllEquilibria, StandInTheOrderOfTheirEnergy) {
  const StaticModel model(read_scene(dataset("four_bar_gravity.toml")));
  const EquilibriumSet set = all_equilibria(model, sampling(400));
  const double energies[] = {-102.26006938120193, 1.4286232537236320, 40.444542888097554, 192.47914433126287};
  ASSERT_EQ(set.equilibria.size(), 4U);
  // The zero of dead loads is arbitrary: here it is the pins'.
  const double zero = set.equilibria[0].energy.value() - energies[0];
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(set.equilibria[k].energy.value() - zero, energies[k], 1e-9);
  // Its two assembly modes have one stable equilibrium each, and no way leads from one to the other.
  EXPECT_TRUE(set.barriers.empty());
  EXPECT_EQ(set.settles_into, 0);
}

TEST(AllEquilibria, AreTheSameForAnyNumberOfJobs) {
  const StaticModel model(pulled_chain(4, 7.0));
  AllEquilibriaOptions options = sampling(300);
  const EquilibriumSet one = all_equilibria(model, options);
  options.jobs = 4;
  const EquilibriumSet four = all_equilibria(model, options);
  ASSERT_EQ(one.equilibria.size(), four.equilibria.size());
  for (std::size_t k = 0; k < one.equilibria.size(); ++k) EXPECT_EQ(one.equilibria[k].x, four.equilibria[k].x);
  EXPECT_EQ(one.statement, four.statement);
}

TEST(AllEquilibria, AnInterruptKeepsWhatIsThere) {
  const StaticModel model(pulled_chain(3, 7.0));
  std::atomic<bool> interrupt = false;
  AllEquilibriaOptions options = sampling(100000);
  options.interrupt = &interrupt;
  options.searched = [&](int done) { interrupt = done >= 50; };
  const EquilibriumSet set = all_equilibria(model, options);
  EXPECT_TRUE(set.interrupted);
  EXPECT_EQ(set.starts, 50);
  EXPECT_FALSE(set.equilibria.empty());
  EXPECT_TRUE(contains(set.statement, "50 starts")) << set.statement;
}

TEST(AllEquilibria, WhereMostAreMissingManyWereMetOnce) {
  const StaticModel model(pulled_chain(7, 7.0));
  const EquilibriumSet few = all_equilibria(model, sampling(60));
  EXPECT_GT(few.met_once, 10);
  EXPECT_TRUE(contains(few.statement, fmt::format("{} were met by one start only", few.met_once))) << few.statement;
  const EquilibriumSet all = all_equilibria(model, sampling(4000));
  EXPECT_EQ(all.equilibria.size(), 128U);
  EXPECT_EQ(all.met_once, 0);
}

TEST(AllEquilibria, ALampThatRestsEverywhereHasOneForEachAssemblyMode) {
  const EquilibriumSet set = all_equilibria(StaticModel(read_scene(dataset("hard/balanced_lamp.toml"))), sampling(300));
  const auto neutral = std::count_if(set.equilibria.begin(), set.equilibria.end(), [](const Equilibrium& e) {
    return e.certificate.stability == Stability::neutral;
  });
  EXPECT_EQ(neutral, 1) << set.statement;
  EXPECT_TRUE(contains(set.statement, "of neutral ones with the same energy one is given")) << set.statement;
}

// --- what is said of those not found ---------------------------------------------------------------------------------

TEST(AllEquilibria, ACountThatCannotBeSaysThatOneIsMissing) {
  // No start, and no settling but of the scene's start: one equilibrium, of a torus.
  const StaticModel model(pulled_chain(2, 7.0));
  const EquilibriumSet set = all_equilibria(model, sampling(0));
  ASSERT_EQ(set.equilibria.size(), 1U);
  EXPECT_TRUE(contains(set.statement, "at least one is missing")) << set.statement;
  EXPECT_TRUE(contains(set.statement, "are 1, and of all they are 0")) << set.statement;
}

TEST(IndexSum, FiveBarsHaveTheirEquilibriaByIt) {
  Scene scene = test::chain(4, 1.0, 1.0);
  const PointRef end = scene.add_point(0, "E", {0.8, 0.3});
  test::add_pin(scene, "4.b", scene.name_of(end), "end");
  scene.gravity = {1.0, -10.0};
  const double start[] = {1.5, 0.3, -0.5, -1.5};
  for (int i = 0; i < 4; ++i) scene.start.angle[static_cast<std::size_t>(i) + 1] = start[i];
  const StaticModel model(scene);
  const std::optional<long> expected = index_sum(model);
  ASSERT_TRUE(expected.has_value());
  const EquilibriumSet set = all_equilibria(model, sampling(2000));
  long sum = 0;
  for (const auto& [unstable, number] : by_unstable_directions(set)) sum += unstable % 2 == 0 ? number : -number;
  EXPECT_EQ(sum, *expected) << set.statement;
}

// --- with a proof ----------------------------------------------------------------------------------------------------

// The chain of two links, of whose four equilibria a proof has found some.
class WithAProof : public ::testing::Test {
 protected:
  std::vector<std::vector<double>> places() const {
    std::vector<std::vector<double>> out;
    for (const Equilibrium& e : all_equilibria(model, sampling(200)).equilibria) out.push_back(e.x);
    return out;
  }
  EquilibriumSet with(EnclosedSet proof, int starts = 200) const {
    AllEquilibriaOptions options = sampling(starts);
    options.seconds = 1.0;
    proof.applies = true;
    return all_equilibria(
        model, options,
        [&](const StaticModel&, const LoopTurns&, const AllEquilibriaOptions&, const EnclosedPart&) { return proof; });
  }

  const StaticModel model{pulled_chain(2, 7.0)};
};

UndecidedBox box_around(const std::vector<double>& x, double reach) {
  UndecidedBox box{x, x, false, "too flat"};
  for (double& v : box.lower) v -= reach;
  for (double& v : box.upper) v += reach;
  return box;
}

TEST_F(WithAProof, AllAreComplete) {
  EnclosedSet proof{.found = places(), .decided = 1.0, .boxes = 77};
  // Turned fully: the same places.
  proof.found[1][0] += 2.0 * M_PI;
  const EquilibriumSet set = with(proof);
  EXPECT_EQ(set.claim, Claim::complete);
  EXPECT_EQ(set.statement, "4 equilibria, complete, proved");
  EXPECT_EQ(set.equilibria.size(), 4U);
  EXPECT_EQ(set.starts, 0);
  EXPECT_EQ(set.boxes, 77);
  EXPECT_EQ(set.settles_into, 0);
}

TEST_F(WithAProof, UndecidedBoxesMakeItIncomplete) {
  EnclosedSet proof{.found = places(), .decided = 0.75, .boxes = 77};
  proof.undecided.push_back(box_around(proof.found.back(), 0.1));
  proof.found.pop_back();
  const EquilibriumSet set = with(proof);
  EXPECT_EQ(set.claim, Claim::incomplete);
  EXPECT_EQ(set.statement, "4 equilibria, complete but for 1 undecided box, 25 % of the volume");
  EXPECT_EQ(set.equilibria.size(), 4U) << "the one in the box was found from starts";
  EXPECT_EQ(set.starts, 200);
  ASSERT_EQ(set.undecided.size(), 1U);
  EXPECT_EQ(set.undecided[0].why, "too flat");
}

TEST_F(WithAProof, AnEquilibriumWhereItLeavesNoneContradictsIt) {
  EnclosedSet proof{.found = places(), .decided = 1.0};
  proof.found.erase(proof.found.begin());
  const EquilibriumSet set = with(proof, 0);
  EXPECT_EQ(set.claim, Claim::sampled) << "the start settles in the one that is missing";
  EXPECT_TRUE(contains(set.statement, "please report it")) << set.statement;
}

TEST_F(WithAProof, APlaceWithoutACertificateRemainsUndecided) {
  EnclosedSet proof{.found = places(), .decided = 1.0};
  for (double& v : proof.found[2]) v += 0.3;
  const EquilibriumSet set = with(proof);
  EXPECT_EQ(set.claim, Claim::sampled) << "the real one is found, and is in no box";
  ASSERT_EQ(set.undecided.size(), 1U);
  EXPECT_TRUE(contains(set.undecided[0].why, "nothing more is proved")) << set.undecided[0].why;
}

TEST_F(WithAProof, WhatAnUnfinishedOneFoundIsKept) {
  AllEquilibriaOptions options = sampling(0);
  options.seconds = 1.0;
  const auto unfinished = [&](const StaticModel&, const LoopTurns&, const AllEquilibriaOptions&, const EnclosedPart&) {
    return EnclosedSet{.why_not = "time was over", .found = {places()[0], places()[2]}};
  };
  const EquilibriumSet set = all_equilibria(model, options, unfinished);
  EXPECT_EQ(set.claim, Claim::sampled);
  EXPECT_EQ(set.equilibria.size(), 2U);
  EXPECT_EQ(set.statement,
            "2 equilibria found by an unfinished proof and from 0 starts, not proved to be all, because time was over");
}

TEST_F(WithAProof, WhereItDoesNotApplySaysWhy) {
  AllEquilibriaOptions options = sampling(100);
  options.seconds = 1.0;
  const auto none = [](const StaticModel&, const LoopTurns&, const AllEquilibriaOptions&, const EnclosedPart&) {
    return EnclosedSet{.why_not = "it is too large"};
  };
  const EquilibriumSet set = all_equilibria(model, options, none);
  EXPECT_EQ(set.claim, Claim::sampled);
  EXPECT_EQ(set.statement, "4 equilibria found from 100 starts, not proved to be all, because it is too large");
}

// --- turns -----------------------------------------------------------------------------------------------------------

TEST(Turns, AConstantTorqueDoesNotTellThemApart) {
  Scene scene = pulled_chain(1, 1.0);
  scene.elements.push_back(
      test::make_element("constant_force", "torque", Measure::angle_between(0, 1), ConstantForce{2.0}));
  const StaticModel model(scene);
  EXPECT_FALSE(Turns(model).count());
  EXPECT_EQ(all_equilibria(model, sampling(200)).equilibria.size(), 2U);
}

// --- settling and barriers -------------------------------------------------------------------------------------------

// V = k (sqrt(1 + h^2) - L)^2 + P h  at the three heights of the scene file.
TEST(Barriers, OfTheVonMisesToggleAreItsEnergyDifferences) {
  const StaticModel model(read_scene(dataset("von_mises_toggle.toml")));
  const auto energy = [](double h) {
    const double stretch = std::hypot(1.0, h) - 1.118033988749894848;
    return 1000.0 * stretch * stretch + 21.457162865612343844 * h;
  };
  const double up = energy(0.436788903652506562874), top = energy(0.0949167614870496588237),
               down = energy(-0.548097444662501968920);
  const EquilibriumSet set = all_equilibria(model, sampling(200));
  ASSERT_EQ(set.equilibria.size(), 3U);
  ASSERT_EQ(set.barriers.size(), 2U);
  const EquilibriumSet::Barrier &from_below = set.barriers[0], &from_above = set.barriers[1];
  EXPECT_EQ(from_below.from, 0);
  EXPECT_EQ(from_below.to, 1);
  EXPECT_EQ(from_below.over, 2);
  EXPECT_NEAR(from_below.energy, top - down, 1e-9);
  EXPECT_EQ(from_above.from, 1);
  EXPECT_EQ(from_above.to, 0);
  EXPECT_NEAR(from_above.energy, top - up, 1e-9);
  EXPECT_EQ(set.settles_into, 1) << "it stays up";
}

// Energies of the scene file: two stable equilibria on a closed curve of poses, and a summit on either way round.
TEST(Barriers, OfTheBistableFourBarAreThoseOfTheLowerWayRound) {
  const EquilibriumSet set = all_equilibria(StaticModel(read_scene(dataset("four_bar_torsion.toml"))), sampling(300));
  ASSERT_EQ(set.equilibria.size(), 4U);
  ASSERT_EQ(set.barriers.size(), 2U);
  constexpr double second = 14.768911389179283284, lower_summit = 16.089198038929894783;
  EXPECT_EQ(set.barriers[0].over, 2);
  EXPECT_NEAR(set.barriers[0].energy, lower_summit, 1e-12);
  EXPECT_EQ(set.barriers[1].over, 2);
  EXPECT_NEAR(set.barriers[1].energy, lower_summit - second, 1e-12);
  EXPECT_EQ(set.settles_into, 1) << "it starts near the second";
}

TEST(Barriers, APendulumHasNone) {
  const EquilibriumSet set = all_equilibria(StaticModel(pulled_chain(1, 0.0)), sampling(50));
  EXPECT_EQ(set.equilibria.size(), 2U);
  EXPECT_TRUE(set.barriers.empty()) << "both sides lead to the same equilibrium";
}

TEST(Barriers, AreDifferencesOfTheEnergiesListed) {
  for (const char* scene :
       {"six_bar.toml", "von_mises_toggle.toml", "knee_press.toml", "hard/scissor_3_doubled.toml"}) {
    SCOPED_TRACE(scene);
    const EquilibriumSet set =
        all_equilibria(StaticModel(read_scene(dataset(scene))), {.seconds = 0.0, .starts = 200, .settling = true});
    EXPECT_FALSE(set.barriers.empty());
    for (const EquilibriumSet::Barrier& barrier : set.barriers) {
      const double from = *set.equilibria.at(static_cast<std::size_t>(barrier.from)).energy;
      const double over = *set.equilibria.at(static_cast<std::size_t>(barrier.over)).energy;
      EXPECT_NEAR(barrier.energy, over - from, 1e-9 * std::max(std::abs(over), std::abs(from)));
    }
  }
}

TEST(AllEquilibria, SaysWhyTheStartSettlesNowhere) {
  // A torque of more than m g r turns it round for ever.
  Scene scene = pulled_chain(1, 0.0);
  scene.torques.push_back({.name = "motor", .body = 1, .value = 7.0});
  const EquilibriumSet set = all_equilibria(StaticModel(scene), sampling(50));
  EXPECT_TRUE(set.equilibria.empty());
  EXPECT_EQ(set.settles_into, -1);
  EXPECT_FALSE(set.settles_nowhere.empty());
}

TEST(AllEquilibria, OneOfNeutralOnesStandsForAll) {
  // Its centre of mass is on the pin.
  Scene scene = test::chain(1, 1.0, 1.0);
  scene.gravity = {0.0, -10.0};
  scene.bodies[1].center = {0.0, 0.0};
  test::add_force(scene, "1.a", {1.0, 0.0}, "F");
  scene.elements.push_back(test::line_spring("S", test::point(scene, "ground.O"), test::point(scene, "1.b"), 3.0, 0.5));
  const EquilibriumSet set = all_equilibria(StaticModel(scene), sampling(50));
  ASSERT_EQ(set.equilibria.size(), 1U) << set.statement;
  EXPECT_EQ(set.equilibria[0].certificate.stability, Stability::neutral);
  EXPECT_TRUE(contains(set.statement, "neutral")) << set.statement;
}

// --- assemblies ------------------------------------------------------------------------------------------------------

TEST(Assemblies, AHeldFourBarClosesInTwoWays) {
  const StaticModel model = held_four_bar(1.0);
  AllEquilibriaOptions options = sampling(200);
  options.assemblies = true;
  const EquilibriumSet set = all_equilibria(model, options);
  ASSERT_EQ(set.equilibria.size(), 2U) << set.statement;
  // B and D are one diagonal: the coupler and the rocker lie on either side of it.
  const Vec2 b{2 * std::cos(1.0), 2 * std::sin(1.0)};
  double side = 1.0;
  for (const Equilibrium& e : set.equilibria) {
    EXPECT_TRUE(e.certificate.locked);
    const double rocker = angle_of(model, e.x, "rocker");
    const Vec2 c{4 + 3 * std::cos(rocker), 1 + 3 * std::sin(rocker)};
    EXPECT_NEAR(norm(c - b), 3.5, 1e-12);
    side *= (4 - b.x) * (c.y - b.y) - (1 - b.y) * (c.x - b.x);
  }
  EXPECT_LT(side, 0.0);
  EXPECT_GE(set.settles_into, 0);
  EXPECT_TRUE(contains(set.statement, "2 assemblies")) << set.statement;
}

TEST(Assemblies, NeedAMechanismThatCannotMove) {
  AllEquilibriaOptions options = sampling(10);
  options.assemblies = true;
  try {
    all_equilibria(StaticModel(read_scene(dataset("four_bar_gravity.toml"))), options);
    FAIL() << "it moves";
  } catch (const InputError& error) {
    EXPECT_TRUE(contains(error.what(), "1 degree of freedom is left")) << error.what();
  }
}

}  // namespace
}  // namespace poise::all_equilibria_test
