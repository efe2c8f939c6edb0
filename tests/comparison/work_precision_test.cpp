#include "comparison/work_precision.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "comparison/difference.hpp"
#include "comparison/work_precision_summary.hpp"
#include "model/scene.hpp"
#include "tests/app/scenes.hpp"
#include "tests/support/known_answers.hpp"

namespace poise::comparison::work_precision_test {
namespace {

const std::vector<double> decades = {1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14};
const std::vector<Method> independent = {Method::virtual_work, Method::energy};

StaticModel model_of(const char* text) { return StaticModel(parse_scene(text, "scene")); }

/// The pendulum, started at so many rad.
StaticModel pendulum_from(double start) {
  Scene scene = parse_scene(app_tests::pendulum, "scene");
  set_value(scene, "start.rod", start);
  return StaticModel(std::move(scene));
}

/// A rod of 1 m under its weight, which a spring balances at every angle: k h r = m g L.
constexpr const char* balanced_arm = R"(gravity = [0, -10]
[ground]
points = { O = [0, 0], S = [0, 1] }
[body.arm]
points = { O = [0, 0], tip = [1, 0] }
mass = 1
center = [1, 0]
[[pin]]
points = ["ground.O", "arm.O"]
[[spring]]
points = ["ground.S", "arm.tip"]
stiffness = 10
free_length = 0
[start]
arm = 0.3
)";

WorkPrecision measure(const StaticModel& model, std::vector<Method> methods, std::vector<double> tolerances) {
  WorkPrecisionOptions options;
  options.methods = std::move(methods);
  options.tolerances = std::move(tolerances);
  options.repeats = 1;
  return work_precision(model, options);
}

TEST(WorkPrecision, ErrorsOfAPendulumAreThoseFromItsClosedForm) {
  const StaticModel model = model_of(app_tests::pendulum);
  const WorkPrecision result = measure(model, independent, decades);
  ASSERT_EQ(result.equilibria.size(), 1U);
  const ReferenceEquilibrium& equilibrium = result.equilibria.front();
  EXPECT_DOUBLE_EQ(equilibrium.x.front(), -M_PI / 2);
  EXPECT_GE(equilibrium.digits, 40);
  EXPECT_EQ(equilibrium.stability, Stability::stable);
  EXPECT_EQ(equilibrium.found_by, independent);
  EXPECT_FALSE(equilibrium.neutral);
  EXPECT_FALSE(result.interrupted);
  EXPECT_TRUE(result.not_applicable.empty());
  ASSERT_EQ(result.rows.size(), 2 * decades.size());
  for (std::size_t k = 0; k < result.rows.size(); ++k) {
    const WorkPrecisionRow& run = result.rows[k];
    EXPECT_EQ(run.method, independent[k / decades.size()]);
    EXPECT_EQ(run.tolerance, decades[k % decades.size()]);
    EXPECT_EQ(run.ending, Ending::converged);
    EXPECT_TRUE(run.claimed);
    EXPECT_DOUBLE_EQ(run.error.value(), std::abs(run.x.front() + M_PI / 2));
    EXPECT_GT(run.microseconds, 0.0);
    EXPECT_GE(run.evaluations, run.iterations);
    if (k % decades.size() > 0) {
      EXPECT_LE(run.error.value(), result.rows[k - 1].error.value() + 1e-15) << "tighter is no worse";
    }
  }
  EXPECT_LT(result.rows[decades.size() - 1].error.value(), 1e-15);
  EXPECT_LT(result.rows.back().error.value(), 1e-13);
}

TEST(WorkPrecision, NewtonLeavesTheSquareOfItsTolerance) {
  const StaticModel model(read_scene(test::dataset("six_bar.toml")));
  const WorkPrecision result = measure(model, {Method::virtual_work}, {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7});
  double coarsest = 0.0;
  for (const WorkPrecisionRow& run : result.rows) {
    EXPECT_EQ(run.ending, Ending::converged);
    EXPECT_LT(run.error.value(), 10 * run.tolerance * run.tolerance + 1e-14) << run.tolerance;
    coarsest = std::max(coarsest, run.error.value());
  }
  EXPECT_GT(coarsest, 1e-9) << "a loose tolerance is meant to leave an error, or nothing is tested here";
}

TEST(WorkPrecision, CoarseAnswersAreClaimedAndFineOnesConfirmed) {
  const StaticModel model(read_scene(test::dataset("thesis_four_bar.toml")));
  const WorkPrecision result = measure(model, independent, {1e-2, 1e-14});
  for (std::size_t k = 0; k < result.rows.size(); k += 2) {
    EXPECT_EQ(result.rows[k].ending, Ending::converged);
    EXPECT_FALSE(result.rows[k].confirmed) << "it ended too far from the equilibrium";
    EXPECT_GT(result.rows[k].error.value(), 1e-7);
    EXPECT_TRUE(result.rows[k + 1].confirmed);
    EXPECT_LT(result.rows[k + 1].error.value(), 1e-14);
  }
}

TEST(WorkPrecision, EachRunIsMeasuredFromTheNearestEquilibrium) {
  // Started upside down, Newton finds the unstable equilibrium above, and descent leaves it.
  const StaticModel model = pendulum_from(1.5);
  const WorkPrecision result = measure(model, independent, {1e-12});
  ASSERT_EQ(result.equilibria.size(), 2U);
  EXPECT_DOUBLE_EQ(result.equilibria[0].x.front(), M_PI / 2);
  EXPECT_EQ(result.equilibria[0].stability, Stability::unstable);
  EXPECT_EQ(result.equilibria[0].found_by, std::vector<Method>{Method::virtual_work});
  EXPECT_EQ(result.equilibria[1].found_by, std::vector<Method>{Method::energy});
  for (int k = 0; k < 2; ++k) {
    const WorkPrecisionRow& run = result.rows[static_cast<std::size_t>(k)];
    EXPECT_EQ(run.ending, Ending::converged);
    EXPECT_EQ(run.equilibrium, k);
    EXPECT_LT(run.error.value(), 1e-10);
  }
}

TEST(WorkPrecision, TheIndependentMethodsAreWitnessesOfAnyOther) {
  const StaticModel model = model_of(app_tests::pendulum);
  const WorkPrecision result = measure(model, {Method::energy}, {1e-8});
  ASSERT_EQ(result.equilibria.size(), 1U);
  EXPECT_EQ(result.equilibria[0].found_by, (std::vector<Method>{Method::energy, Method::virtual_work}));
  EXPECT_EQ(result.rows.size(), 1U);
}

TEST(WorkPrecision, WholeTurnsAreNoError) {
  const StaticModel model = pendulum_from(4.5);
  const WorkPrecision result = measure(model, independent, {1e-10});
  ASSERT_EQ(result.equilibria.size(), 1U);
  EXPECT_NEAR(result.equilibria[0].x.front(), 1.5 * M_PI, 1e-15);
  for (const WorkPrecisionRow& run : result.rows) EXPECT_LT(run.error.value(), 1e-9);
}

TEST(WorkPrecision, RefusalsAreNamedAndNotRun) {
  const WorkPrecision result = measure(model_of(app_tests::follower), {}, {1e-9});
  EXPECT_GE(result.not_applicable.size(), 1U);
  for (const NotApplicable& refusal : result.not_applicable) {
    EXPECT_TRUE(traits(refusal.method).needs_potential);
    EXPECT_NE(refusal.why.find("\"jet\""), std::string::npos) << refusal.why;
    for (const WorkPrecisionRow& run : result.rows) EXPECT_NE(run.method, refusal.method);
  }
  EXPECT_EQ(result.not_applicable.size() + result.rows.size(), all_methods().size());
  EXPECT_NEAR(result.rows.front().x.front(), 1.0, 1e-12);
}

TEST(WorkPrecision, WithoutEquilibriumNoRunConverges) {
  const WorkPrecision result = measure(model_of(app_tests::runaway), independent, {1e-3, 1e-9});
  EXPECT_TRUE(result.equilibria.empty());
  ASSERT_EQ(result.rows.size(), 4U);
  for (const WorkPrecisionRow& run : result.rows) {
    EXPECT_NE(run.ending, Ending::converged);
    EXPECT_FALSE(run.error);
    EXPECT_EQ(run.equilibrium, -1);
    EXPECT_FALSE(run.confirmed);
    EXPECT_FALSE(run.why.empty());
  }
}

TEST(WorkPrecision, SuccessClaimedFarFromAnyEquilibriumIsElsewhere) {
  // With a tolerance of 0.9 Ipopt accepts the start, 2 rad from the equilibrium.
  const StaticModel model = pendulum_from(0.5);
  const WorkPrecision result = measure(model, {Method::energy}, {0.9, 1e-10});
  ASSERT_EQ(result.rows.size(), 2U);
  EXPECT_EQ(result.rows[0].ending, Ending::elsewhere) << result.rows[0].x.front() << result.rows[0].why;
  EXPECT_TRUE(result.rows[0].claimed);
  EXPECT_FALSE(result.rows[0].error);
  EXPECT_EQ(result.rows[1].ending, Ending::converged);
}

TEST(WorkPrecision, OfAContinuumOfEquilibriaNoneIsFarAway) {
  const StaticModel model = model_of(balanced_arm);
  const WorkPrecision result = measure(model, independent, {1e-6, 1e-12});
  ASSERT_EQ(result.equilibria.size(), 1U);
  EXPECT_TRUE(result.equilibria[0].neutral);
  EXPECT_EQ(result.equilibria[0].found_by, independent);
  for (const WorkPrecisionRow& run : result.rows) {
    EXPECT_EQ(run.ending, Ending::converged);
    EXPECT_LT(run.error.value(), 1e-12);
  }
}

TEST(WorkPrecision, RunsOfMicrosecondsAreRepeatedMore) {
  WorkPrecisionOptions options;
  options.methods = {Method::virtual_work};
  options.tolerances = {1e-9};
  options.repeats = 3;
  const WorkPrecision result = work_precision(model_of(app_tests::pendulum), options);
  ASSERT_EQ(result.rows.size(), 1U);
  EXPECT_GE(result.rows[0].repeats, 3);
  EXPECT_LE(result.rows[0].repeats, 300);
}

TEST(WorkPrecision, InterruptKeepsFinishedRows) {
  const StaticModel model = model_of(app_tests::pendulum);
  std::atomic<bool> stop = false;
  WorkPrecisionOptions options;
  options.methods = {Method::energy};
  options.tolerances = decades;
  options.repeats = 1;
  options.interrupt = &stop;
  options.progress = [&](const std::string& doing) {
    if (doing == "energy at 1e-06") stop = true;
  };
  const WorkPrecision result = work_precision(model, options);
  EXPECT_TRUE(result.interrupted);
  ASSERT_EQ(result.rows.size(), 2U);
  EXPECT_EQ(result.rows.back().tolerance, 1e-4);
  EXPECT_EQ(result.rows.back().ending, Ending::converged);
}

WorkPrecisionRow run_with(Ending ending, bool confirmed, std::optional<double> error) {
  WorkPrecisionRow run;
  run.method = Method::cobyla;
  run.tolerance = 1e-3;
  run.ending = ending;
  run.claimed = ending != Ending::not_converged;
  run.confirmed = confirmed;
  run.error = error;
  run.microseconds = 5.0;
  return run;
}

TEST(WorkPrecisionSummary, StatusesAreToldApart) {
  EXPECT_EQ(status_of(run_with(Ending::converged, true, 0.0)), "confirmed");
  EXPECT_EQ(status_of(run_with(Ending::converged, false, 0.1)), "too coarse");
  EXPECT_EQ(status_of(run_with(Ending::elsewhere, false, std::nullopt)), "elsewhere");
  EXPECT_EQ(status_of(run_with(Ending::not_converged, true, 1e-9)), "not converged");
}

TEST(WorkPrecisionSummary, TolerancesThatChangeNothingShareARun) {
  WorkPrecision result;
  result.rows = {run_with(Ending::converged, true, 1e-4), run_with(Ending::converged, true, 1e-4),
                 run_with(Ending::converged, true, 1e-4), run_with(Ending::converged, true, 1e-9)};
  result.rows[1].microseconds = 7.0;
  result.rows[2].microseconds = 6.0;
  result.rows.push_back(result.rows.back());
  result.rows.back().method = Method::slsqp;
  const std::vector<std::vector<ToleranceSpan>> shared = tolerance_spans(result);
  ASSERT_EQ(shared.size(), 2U) << "methods share nothing";
  ASSERT_EQ(shared[0].size(), 2U);
  EXPECT_EQ(shared[0][0].loosest, &result.rows[0]);
  EXPECT_EQ(shared[0][0].tightest, &result.rows[2]);
  EXPECT_EQ(shared[0][0].microseconds, 6.0) << "the median";
  EXPECT_EQ(shared[0][1].loosest, &result.rows[3]);
}

TEST(Difference, CountsTurnsOnlyWhereSomethingDoes) {
  const StaticModel free = model_of(app_tests::pendulum);
  const Difference d = largest_difference(free, {0.25}, {2 * M_PI});
  EXPECT_NEAR(d.size, 0.25, 1e-15);
  EXPECT_TRUE(d.whole_turns);
  const StaticModel sprung = model_of(app_tests::follower);
  EXPECT_TRUE(turns_count(sprung.scene()));
  EXPECT_DOUBLE_EQ(largest_difference(sprung, {0.25}, {2 * M_PI}).size, 2 * M_PI - 0.25);
}

}  // namespace
}  // namespace poise::comparison::work_precision_test
