// Models of the same readings: errors on runs held out, tests of nested models and their size under correlation.

#include "identification/assessment/compare_models.hpp"

#include <cmath>
#include <deque>
#include <vector>

#include <gtest/gtest.h>

#include "solvers/random_stream.hpp"
#include "tests/identification/wheel.hpp"

namespace poise::compare_models_test {
namespace {

// A wheel with a damper, read in runs of 1 s; the records are those of the true damping, with noise of correlation phi.
struct Rig {
  Experiment measured;
  std::vector<Record> records;

  Rig(double damping, double phi, std::uint64_t seed, int runs = 6) {
    measured = test::Wheel(runs).experiment;
    for (int r = 0; r < runs; ++r) {
      Run& run = measured.runs[static_cast<std::size_t>(r)];
      run.duration = 1.0;
      run.name = std::to_string(r);
    }
    Experiment truth = measured;
    set_value(truth.scene, "torsion_damper.air.coefficient", damping);
    const FitProblem problem(truth);
    for (std::size_t r = 0; r < problem.runs(); ++r) {
      Record record = problem.ideal_record(r);
      solvers::RandomStream random(seed, static_cast<std::uint32_t>(r));
      double x = random.normal();
      for (double& y : record.sensors[0].value) {
        y += test::Wheel::noise * x;
        x = phi * x + std::sqrt(1 - phi * phi) * random.normal();
      }
      records.push_back(record);
      measured.runs[r].data = {"wheel.csv"};
    }
    measured.records = records;
  }

  Experiment with_damping() const {
    Experiment out = measured;
    out.unknowns.push_back(test::unknown("torsion_damper.air.coefficient"));
    return out;
  }
};

ModelComparison compare(const Rig& rig) {
  const Experiment damped = rig.with_damping();
  const FitProblem simple(rig.measured), full(damped);
  return compare_models({&simple, &full});
}

TEST(CompareModels, PrefersTheModelThatPredictsRunsHeldOut) {
  const ModelComparison found = compare(Rig(0.002, 0.0, 1));
  EXPECT_EQ(found.preferred, 1U);
  EXPECT_EQ(found.folds, 6);
  ASSERT_EQ(found.tests.size(), 1U);
  EXPECT_EQ(found.tests[0].simple, 0U);
  EXPECT_EQ(found.tests[0].full, 1U);
  EXPECT_EQ(found.tests[0].added, 1);
  EXPECT_LT(found.tests[0].p, 1e-4);
  EXPECT_LT(found.tests[0].f_p, 1e-4);
  EXPECT_GT(found.models[0].aic, 10.0);
  EXPECT_EQ(found.models[1].aic, 0.0);
  EXPECT_GT(found.models[0].held_out_all, found.models[1].held_out_all);
  EXPECT_NEAR(found.models[1].held_out_all, 1.0, 0.1);
  for (const double own : found.models[1].own) EXPECT_NEAR(own, 1.0, 0.25);
  EXPECT_GT(found.loss[0], 2 * found.loss_error[0]);
}

// One model, its search begun elsewhere: rounding prefers neither.
TEST(CompareModels, PrefersNoneOfEqualModels) {
  const Rig rig(0.002, 0.0, 1, 3);
  const Experiment near = rig.with_damping();
  Experiment far = near;
  far.unknowns[0].start = 15.0;
  far.unknowns[1].start = 0.01;
  const FitProblem simple(rig.measured), one(near), other(far);
  const ModelComparison found = compare_models({&simple, &one, &other});
  EXPECT_EQ(found.equally_good, (std::vector<std::size_t>{1, 2}));
  EXPECT_EQ(found.preferred, 1U);
  EXPECT_NE(found.models[1].held_out_all, found.models[2].held_out_all) << "the test shows something";
  EXPECT_TRUE(compare(rig).equally_good.empty());
}

// A number that changes no reading makes a model no better: errors held out are equal but for rounding.
TEST(CompareModels, PrefersFewerParametersWhereErrorsAreEqual) {
  const Rig rig(0.002, 0.0, 1, 3);
  const Experiment damped = rig.with_damping();
  Experiment more = damped;
  more.unknowns.push_back(test::unknown("gravity.x"));
  const FitProblem full(more), simple(damped);
  const ModelComparison found = compare_models({&full, &simple});
  EXPECT_EQ(found.preferred, 1U);
  EXPECT_TRUE(found.equally_good.empty());
}

// The held-out error of a run is that of a fit to the other runs, by hand.
TEST(CompareModels, HeldOutErrorIsThatOfAFitToTheOthers) {
  const Rig rig(0.002, 0.0, 2, 3);
  const ModelComparison found = compare(rig);
  Experiment two = rig.measured, third = rig.measured;
  two.runs.pop_back();
  two.records.pop_back();
  third.runs = {rig.measured.runs[2]};
  third.records = {rig.records[2]};
  const FitProblem train(two), held(third);
  const Fit trained = fit(train, two.records);
  Fit start;
  start.weighting = held.weighting();
  start.parameters = trained.parameters;
  start.runs.resize(1);
  start.runs[0].nuisances = held.run(0).released();
  FitOptions options;
  options.from = &start;
  options.held = {{0, trained.parameters[0]}};
  const Fit tested = fit(held, third.records, options);
  EXPECT_NEAR(found.models[0].held_out[2], std::sqrt(2 * tested.cost / 100), 1e-3);
}

// Where the simpler model holds, its rejection at 5 % happens in 5 % of the cases, correlated or not: 30 cases each.
TEST(CompareModels, RejectsATrueModelRarely) {
  for (const double phi : {0.0, 0.8}) {
    int rejected = 0;
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
      const ModelComparison found = compare(Rig(0.0, phi, 100 + seed, 4));
      ASSERT_EQ(found.tests.size(), 1U);
      rejected += found.tests[0].p < 0.05 ? 1 : 0;
    }
    EXPECT_LE(rejected, 6) << "binomial(30, 0.05): more than 6 with a probability of 6e-4; phi " << phi;
  }
}

TEST(CompareModels, RefusesOtherReadings) {
  const Rig one(0.0, 0.0, 1, 2), other(0.0, 0.0, 2, 2);
  const FitProblem a(one.measured), b(other.measured);
  EXPECT_THROW(compare_models({&a, &b}), InputError);
}

}  // namespace
}  // namespace poise::compare_models_test
