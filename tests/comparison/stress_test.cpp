#include "comparison/stress.hpp"

#include <atomic>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "comparison/case_check.hpp"
#include "tests/comparison/toy_catalogue.hpp"

namespace poise::comparison::stress_test {
namespace {

using test::both_equilibria;
using test::toy_case;
using test::toy_equilibrium;
using test::ToyCatalogue;

constexpr int starts = 40;

// One cell of the case with `rest` after its scene.
Cell cell_of(const std::string& scene, const std::string& equilibrium, Method method = Method::virtual_work) {
  const ToyCatalogue catalogue(toy_case("toy", scene, equilibrium));
  StressOptions options;
  options.methods = {method};
  options.starts = starts;
  options.work = 1e6;
  return stress(catalogue.read(), options).at(0).cells.at(0);
}

// Converged or false: all of them.
void expect_all_converge(const Cell& cell) {
  EXPECT_EQ(cell.starts, starts);
  EXPECT_EQ(cell.converged, starts) << cell.why;
  EXPECT_EQ(cell.false_claims + cell.denied_by_check, 0) << cell.why;
  EXPECT_TRUE(solved(cell));
}

void expect_all_false(const Cell& cell) {
  EXPECT_EQ(cell.starts, starts);
  EXPECT_EQ(cell.false_claims, starts) << cell.why;
  EXPECT_EQ(cell.converged, 0);
  EXPECT_FALSE(cell.why.empty());
  EXPECT_FALSE(solved(cell));
}

const std::string complete = "complete = true\n";

TEST(Stress, APendulumConvergesToItsKnownEquilibria) {
  const Cell nearest = cell_of("pendulum", complete + both_equilibria());
  expect_all_converge(nearest);
  EXPECT_LT(nearest.error.value(), 1e-12);
  EXPECT_GT(nearest.iterations.value(), 0);
  EXPECT_GT(nearest.microseconds.value(), 0);
  // It hangs straight whatever it weighs: what is left is the rounding of pi / 2.
  EXPECT_GT(nearest.allowed.value(), 6e-17);
  EXPECT_LT(nearest.allowed.value(), 1e-15);
  expect_all_converge(cell_of("pendulum", complete + "seek = \"stable\"\n" + both_equilibria()));
  expect_all_converge(cell_of("pendulum", complete + "seek = \"stable\"\n" + both_equilibria(), Method::energy));
}

TEST(Stress, AnAnswerOfAWrongListIsWrong) {
  expect_all_false(cell_of("pendulum", complete + toy_equilibrium("rod", "-1.570797", "stable") +
                                           toy_equilibrium("rod", "1.570797", "unstable")));
  // The right places with each other's stability.
  expect_all_false(cell_of("pendulum", complete + toy_equilibrium("rod", test::hanging_down, "unstable") +
                                           toy_equilibrium("rod", test::standing_up, "stable")));
  // A list that is called complete and lacks one: half of the starts, about, go there.
  const Cell lacks = cell_of("pendulum", complete + toy_equilibrium("rod", test::hanging_down, "stable"));
  EXPECT_GT(lacks.false_claims, starts / 5);
  EXPECT_GT(lacks.converged, starts / 5);
  EXPECT_EQ(lacks.false_claims + lacks.converged, starts);
}

TEST(Stress, SoftnessExcusesNoError) {
  // 1e-7 rad from the known place, held by a curvature of a thousandth: an imbalance of 1e-10 of the load. What is
  // proved is known far better than that, so one of the two is wrong.
  for (const char* known : {"-1.5707962267948966", "-1.57078632"}) {
    expect_all_false(
        cell_of("soft_pendulum", complete + "seek = \"stable\"\n" + toy_equilibrium("rod", known, "stable")));
  }
}

TEST(Stress, FiftyDigitsDecideForAnOpenList) {
  expect_all_converge(cell_of("pendulum", ""));
  expect_all_converge(cell_of("pendulum", toy_equilibrium("rod", test::hanging_down, "stable")));
  expect_all_converge(cell_of("pendulum", toy_equilibrium("rod", "0.3", "stable")));
  expect_all_false(cell_of("pendulum", "seek = \"stable\"\n" + toy_equilibrium("rod", test::hanging_down, "unstable")));
}

TEST(Stress, TurnsCountOnlyWhereTheyAreSaidTo) {
  const std::string once_around = complete + "seek = \"stable\"\nreach = 0.1\n";
  const std::string turned = toy_equilibrium("rod", "4.7123889803846898577", "stable");
  expect_all_converge(cell_of("pendulum", once_around + turned));
  expect_all_false(cell_of("pendulum", once_around + "turns_count = true\n" + turned));
  expect_all_converge(
      cell_of("pendulum", once_around + "turns_count = true\n" + toy_equilibrium("rod", test::hanging_down, "stable")));
}

TEST(Stress, TravelsAreComparedInMetres) {
  const auto at = [](const std::string& travel) {
    return complete + "[[case.equilibrium]]\ntravels = { rail = " + travel + " }\nstability = \"stable\"\n";
  };
  expect_all_converge(cell_of("against_the_stop", at("0.25")));
  expect_all_false(cell_of("against_the_stop", at("0.2501")));
}

TEST(Stress, WithoutEquilibriumNothingMayBeClaimed) {
  const std::string none = "expect = \"none\"\nwhy = \"nothing holds it\"\n";
  const Cell runs_away = cell_of("runaway", none);
  expect_all_converge(runs_away);
  EXPECT_FALSE(runs_away.why.empty());
  EXPECT_FALSE(runs_away.error);
  const Cell cell = cell_of("pendulum", none);
  expect_all_false(cell);
  EXPECT_NE(cell.why.find("nothing holds it"), std::string::npos) << cell.why;
}

TEST(Stress, ASingularConfigurationHasToBeSaid) {
  const std::string locked = "expect = \"locked\"\nwhy = \"no finite pull\"\nreach = 0\n";
  expect_all_converge(cell_of("taut_bars", locked));
  // The equilibrium is right, but the singular configuration is not reported.
  const Cell cell = cell_of("pendulum", locked);
  EXPECT_EQ(cell.converged + cell.false_claims, 0);
  EXPECT_NE(cell.why.find("without a report that the start is locked"), std::string::npos) << cell.why;
  // Nor where nothing is confirmed.
  const Cell silent = cell_of("runaway", locked);
  EXPECT_EQ(silent.converged + silent.false_claims, 0);
}

TEST(Stress, EquilibriumEverywhereIsNeutral) {
  expect_all_converge(cell_of("balanced_beam", "everywhere = true\n"));
  expect_all_false(cell_of("pendulum", "everywhere = true\n"));
}

TEST(Stress, ARefusalIsNoFailure) {
  const std::string known = complete + "reach = 0.5\nturns_count = true\n" + toy_equilibrium("rod", "1.0", "stable");
  expect_all_converge(cell_of("follower", known));
  const Cell other = cell_of("follower", known, Method::energy);
  EXPECT_FALSE(other.applies);
  EXPECT_EQ(other.starts, 0);
  EXPECT_NE(other.why.find("jet"), std::string::npos) << other.why;
  EXPECT_FALSE(other.iterations || other.microseconds);
  // The stability found must be exactly the known one.
  expect_all_false(cell_of("follower", complete + "reach = 0.5\n" + toy_equilibrium("rod", "1.0", "unknown")));
}

TEST(Stress, StartsAreSeededByTheNameOfTheCase) {
  const std::string equilibrium = complete + both_equilibria();
  const ToyCatalogue catalogue(toy_case("a", "pendulum", equilibrium) + toy_case("b", "pendulum", equilibrium));
  StressOptions options;
  options.methods = {Method::virtual_work};
  options.starts = 200;
  const auto all = stress(catalogue.read(), options), again = stress(catalogue.read(), options);
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].cells[0].error, again[0].cells[0].error);
  EXPECT_EQ(all[0].cells[0].iterations, again[0].cells[0].iterations);
  // Alone, a case has the starts that it has among others.
  const auto alone = stress({catalogue.read()[1]}, options);
  EXPECT_EQ(alone[0].cells[0].error, all[1].cells[0].error);
}

TEST(Stress, DoesNotDependOnTheThreads) {
  std::string cases;
  for (const char* name : {"a", "b", "c", "d", "e"}) cases += toy_case(name, "pendulum", complete + both_equilibria());
  const ToyCatalogue catalogue(cases);
  StressOptions options;
  options.methods = {Method::virtual_work, Method::energy};
  options.starts = 20;
  const auto alone = stress(catalogue.read(), options);
  options.jobs = 3;
  const auto shared = stress(catalogue.read(), options);
  ASSERT_EQ(shared.size(), 5U);
  for (std::size_t c = 0; c < 5; ++c) {
    EXPECT_EQ(shared[c].hard.name, alone[c].hard.name);
    ASSERT_EQ(shared[c].cells.size(), 2U);
    for (std::size_t k = 0; k < 2; ++k) {
      EXPECT_EQ(shared[c].cells[k].converged, alone[c].cells[k].converged);
      EXPECT_EQ(shared[c].cells[k].iterations, alone[c].cells[k].iterations);
      EXPECT_EQ(shared[c].cells[k].error, alone[c].cells[k].error);
    }
  }
}

TEST(Stress, OnlyVirtualWorkHasNoLimit) {
  const ToyCatalogue catalogue(toy_case("toy", "pendulum", "starts = 30\n"));
  StressOptions options;
  options.methods = {Method::virtual_work, Method::energy};
  options.work = 1e-9;
  const auto cells = stress(catalogue.read(), options).at(0).cells;
  EXPECT_EQ(cells[0].starts, 30);
  EXPECT_EQ(cells[1].starts, 1);
}

TEST(Stress, ASlowStartIsGivenUp) {
  // The stable equilibrium of a long chain is far from random angles: Ipopt would take tens of iterations, and has 100
  // times 10 evaluations of a small mechanism, each of which counts 1 + 300 + 75 here.
  HardCase hard;
  hard.name = "chain";
  hard.series = "hanging chain";
  hard.size = 3000;
  StressOptions options;
  options.methods = {Method::energy};
  options.work = 100;
  const Cell cell = stress({hard}, options).at(0).cells.at(0);
  EXPECT_EQ(cell.starts, 1);
  EXPECT_EQ(cell.converged, 0);
  EXPECT_TRUE(cell.why.starts_with("Ipopt: iteration limit")) << cell.why;
}

TEST(Stress, AnInterruptKeepsWhatThereIs) {
  const ToyCatalogue catalogue(toy_case("a", "pendulum") + toy_case("b", "pendulum"));
  std::atomic<bool> interrupt = false;
  std::vector<std::string> told;
  StressOptions options;
  options.methods = {Method::virtual_work, Method::energy};
  options.starts = 2;
  options.interrupt = &interrupt;
  options.progress = [&](const std::string& doing) {
    told.push_back(doing);
    interrupt = told.size() == 4;
  };
  const auto results = stress(catalogue.read(), options);
  ASSERT_EQ(results.size(), 2U);
  EXPECT_EQ(results[0].cells.size(), 2U);
  EXPECT_EQ(results[1].cells.size(), 1U);
  EXPECT_EQ(told.front(), "a (1 of 2) by virtual-work");
  interrupt = true;
  EXPECT_TRUE(stress(catalogue.read(), options).empty());
}

TEST(Stress, SafeguardsAreSwitchedOffOneByOne) {
  const ToyCatalogue catalogue(toy_case("toy", "pendulum", complete + "seek = \"stable\"\n" + both_equilibria()));
  StressOptions options;
  options.starts = starts;
  options.work = 1e6;
  const auto cells = stress_safeguards(catalogue.read(), options).at(0).cells;
  ASSERT_EQ(cells.size(), safeguard_variants().size());
  expect_all_converge(cells[0]);
  // Newton is drawn to the maximum as well, and has to be brought back.
  EXPECT_EQ(safeguard_variants()[2].name, "inertia correction");
  EXPECT_GT(cells[2].iterations.value(), cells[0].iterations.value());
  // Steps as long as they come fly around the pin.
  EXPECT_EQ(safeguard_variants()[3].name, "line search");
  EXPECT_LT(cells[3].converged, starts);
  for (const Cell& cell : cells) EXPECT_EQ(cell.false_claims, 0);
}

TEST(Stress, WithoutScalingTheAnswerIsTheSamePlace) {
  // A pendulum of a micrometre: sizes and loads far from one.
  Scene scene = parse_scene(app_tests::pendulum, "pendulum.toml");
  scene.bodies[1].points[1].at = {2e-6, 0.0};
  scene.bodies[1].center = {2e-6, 0.0};
  const StaticModel model(scene);
  for (const bool scaling : {true, false}) {
    SolveOptions options;
    options.scaling = scaling;
    const Equilibrium equilibrium = solve(model, {-1.2}, options);
    ASSERT_EQ(equilibrium.x.size(), 1U);
    EXPECT_TRUE(equilibrium.found()) << equilibrium.why;
    EXPECT_NEAR(equilibrium.x[0], -M_PI / 2, 1e-12) << scaling;
  }
}

TEST(Stress, UnknownNamesOfASeriesAreReported) {
  HardCase hard;
  hard.name = "chain";
  hard.series = "hanging chain";
  hard.size = 3;
  hard.known.push_back({{{"bar9", 0.0}}, {}, Stability::stable});
  try {
    stress({hard}, {});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "case \"chain\", known equilibrium 1: there is no \"bar9\" in it; did you mean \"bar1\"?");
  }
}

// Answers made up, so that what solvers never do is checked too.
class CaseCheckTest : public testing::Test {
 protected:
  Verdict verdict_on(double angle, Stability stability, double radius = 1e-14) const {
    Equilibrium equilibrium;
    equilibrium.status = Status::confirmed;
    equilibrium.x = {angle};
    equilibrium.certificate.outcome = Outcome::proved;
    equilibrium.certificate.stability = stability;
    equilibrium.certificate.radius = radius;
    return CaseCheck(hard, model).verdict_on(equilibrium);
  }

  static Scene scene() { return parse_scene(app_tests::pendulum, "pendulum.toml"); }

  StaticModel model{scene()};
  HardCase hard;
};

TEST_F(CaseCheckTest, OfTwoThatNearlyCoincideTheNearerDecides) {
  hard.complete = true;
  hard.known = {{{{"rod", 0.1}}, {}, Stability::stable}, {{{"rod", 0.1 + 1e-8}}, {}, Stability::unstable}};
  const double loose = 1e-7;
  EXPECT_EQ(verdict_on(0.1 + 2e-9, Stability::stable, loose).kind, Verdict::Kind::converged);
  EXPECT_EQ(verdict_on(0.1 + 2e-9, Stability::unstable, loose).kind, Verdict::Kind::false_claim);
  EXPECT_EQ(verdict_on(0.1 + 8e-9, Stability::unstable, loose).kind, Verdict::Kind::converged);
  EXPECT_EQ(verdict_on(0.1 + 8e-9, Stability::stable, loose).kind, Verdict::Kind::false_claim);
  EXPECT_EQ(verdict_on(0.1, Stability::unknown, loose).kind, Verdict::Kind::failed);
}

TEST_F(CaseCheckTest, NoConditionExcusesAnotherPlace) {
  hard.complete = true;
  hard.known = {{{{"rod", 0.1}}, {}, Stability::stable}};
  EXPECT_EQ(verdict_on(0.102, Stability::stable, 1.0).kind, Verdict::Kind::false_claim);
  EXPECT_EQ(verdict_on(0.102, Stability::stable, std::numeric_limits<double>::infinity()).kind,
            Verdict::Kind::false_claim);
  EXPECT_EQ(verdict_on(0.1, Stability::stable).kind, Verdict::Kind::converged);
  EXPECT_EQ(verdict_on(0.1 + 1e-8, Stability::stable).kind, Verdict::Kind::false_claim);
  EXPECT_EQ(verdict_on(std::nan(""), Stability::stable).kind, Verdict::Kind::false_claim);
}

TEST_F(CaseCheckTest, AnEquilibriumBeyondASingularConfigurationMustBeConfirmed) {
  hard.answer = KnownAnswer::locked;
  Equilibrium equilibrium;
  equilibrium.status = Status::confirmed;
  equilibrium.met_singular = true;
  equilibrium.x = {-M_PI / 2};
  equilibrium.certificate.radius = 1e-14;
  EXPECT_EQ(CaseCheck(hard, model).verdict_on(equilibrium).kind, Verdict::Kind::converged);
  equilibrium.x = {-1.0};
  EXPECT_EQ(CaseCheck(hard, model).verdict_on(equilibrium).kind, Verdict::Kind::false_claim);
}

TEST_F(CaseCheckTest, DistinguishesUnconfirmedClaimsFromFailures) {
  hard.known = {{{{"rod", 0.1}}, {}, Stability::stable}};
  Equilibrium equilibrium;
  equilibrium.x = {0.1};
  equilibrium.why = "it stopped";
  equilibrium.status = Status::not_confirmed;
  EXPECT_EQ(CaseCheck(hard, model).verdict_on(equilibrium).kind, Verdict::Kind::denied_by_check);
  equilibrium.status = Status::not_found;
  EXPECT_EQ(CaseCheck(hard, model).verdict_on(equilibrium).kind, Verdict::Kind::failed);
  EXPECT_EQ(CaseCheck(hard, model).verdict_on(equilibrium).why, "it stopped");
  hard.known.clear();
  hard.answer = KnownAnswer::none;
  EXPECT_EQ(CaseCheck(hard, model).verdict_on(equilibrium).kind, Verdict::Kind::converged);
  equilibrium.status = Status::not_confirmed;
  EXPECT_EQ(CaseCheck(hard, model).verdict_on(equilibrium).kind, Verdict::Kind::denied_by_check);
  hard.answer = KnownAnswer::locked;
  EXPECT_EQ(CaseCheck(hard, model).verdict_on(equilibrium).kind, Verdict::Kind::denied_by_check);
  equilibrium.certificate.singular = true;
  EXPECT_EQ(CaseCheck(hard, model).verdict_on(equilibrium).kind, Verdict::Kind::converged);
}

TEST(Median, IsTheMiddle) {
  EXPECT_FALSE(median({}));
  EXPECT_EQ(median({3.0}), 3.0);
  EXPECT_EQ(median({5.0, 1.0, 3.0}), 3.0);
  EXPECT_EQ(median({7.0, 1.0, 5.0, 3.0}), 4.0);
}

}  // namespace
}  // namespace poise::comparison::stress_test
