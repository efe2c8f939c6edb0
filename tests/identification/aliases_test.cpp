// Fits of oscillations that are read too slowly: what the readings do not distinguish is never called converged.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "comparison/random.hpp"
#include "identification/fit/fit.hpp"
#include "identification/identifiability/frequencies.hpp"
#include "tests/identification/experiments.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/seed.hpp"

namespace poise::aliases_test {
namespace {

std::vector<double> evenly(double rate, int count) {
  std::vector<double> times;
  for (int i = 0; i < count; ++i) times.push_back(i / rate);
  return times;
}

TEST(Aliases, OfEvenTimesAreMultiplesOfTheRateMoreOrLess) {
  std::vector<double> found = aliases(evenly(10, 60), 5.4, 1.35, 21.6);
  std::sort(found.begin(), found.end());
  const std::vector<double> expected = {4.6, 14.6, 15.4};
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(found[i], expected[i], 0.01);
}

TEST(Aliases, FastReadingsHaveNone) { EXPECT_TRUE(aliases(evenly(100, 600), 5.4, 1.35, 21.6).empty()); }

TEST(Aliases, UnevenTimesHaveNone) {
  comparison::Random random(1);
  std::vector<double> times = evenly(10, 60);
  for (double& t : times) t += random.uniform(0.0, 0.09);
  EXPECT_TRUE(aliases(times, 5.4, 1.35, 21.6).empty());
}

// Wheels on one shaft, each on a torsion spring and a damper to the one before, as simple oscillators as there are.
Experiment wheels(int count, const std::vector<double>& stiffness, double damping) {
  Experiment e;
  e.scene = test::chain(count, 0.0, 1.0);
  for (std::size_t i = 1; i <= static_cast<std::size_t>(count); ++i) {
    e.scene.bodies[i].center = {0, 0};
    e.scene.bodies[i].inertia = 1.0;
    test::add_torsion_spring(e.scene, static_cast<int>(i) - 1, static_cast<int>(i), stiffness[i - 1]);
    e.scene.elements.back().name = "k" + std::to_string(i);
    Element damper = e.scene.elements.back();
    damper.name = "c" + std::to_string(i);
    damper.table = "torsion_damper";
    damper.law = Damper{damping};
    e.scene.elements.push_back(damper);
    const std::string body = std::to_string(i);
    e.sensors.push_back(test::angle_of(e.scene, body, 1e-3));
    e.unknowns.push_back(test::unknown("torsion_spring.k" + body + ".stiffness"));
    e.unknowns.back().min = 0.0;
  }
  return e;
}

double stiffness_of(double hertz) { return std::pow(2 * M_PI * hertz, 2); }

Release turned(int body, double angle) {
  Release release;
  release.body = body;
  release.value = angle;
  return release;
}

// k1 y1 + k2 (y1 - y2) = w^2 y1,  k2 (y2 - y1) = w^2 y2  in the absolute angles.
TEST(Aliases, FrequenciesOfTwoWheels) {
  Experiment e = wheels(2, {300, 200}, 0.1);
  e.runs = {test::simulated(100, 100, {turned(1, 0.01)})};
  const FitProblem problem(e);
  const std::vector<double> found =
      problem.run(0).natural_frequencies(problem.run(0).scene_values().data(), 0.0, {0.0, 0.0});
  ASSERT_EQ(found.size(), 2U);
  const double mean = (300 + 2 * 200) / 2.0;
  const double apart = std::sqrt(mean * mean - 300 * 200);
  EXPECT_NEAR(found[0], std::sqrt(mean - apart) / (2 * M_PI), 1e-9);
  EXPECT_NEAR(found[1], std::sqrt(mean + apart) / (2 * M_PI), 1e-9);
}

TEST(Aliases, OscillationAboveHalfTheRateIsAmbiguous) {
  Experiment e = wheels(1, {stiffness_of(5.4)}, 0.2);
  e.runs = {test::simulated(10, 60, {turned(1, 0.1)})};
  e.unknowns[0].start = stiffness_of(4.5);
  const FitProblem problem(e);
  const Fit found = fit(problem, problem.records());
  EXPECT_EQ(found.status, FitStatus::ambiguous);
  EXPECT_FALSE(found.usable());
  ASSERT_GE(found.alternatives.size(), 2U);
  for (const double hertz : {4.6, 5.4}) {
    EXPECT_TRUE(std::any_of(found.alternatives.begin(), found.alternatives.end(), [&](const Alternative& one) {
      return std::abs(one.frequency[0] - hertz) < 0.01;
    })) << hertz;
  }
  EXPECT_NE(found.why.find("4.6 Hz"), std::string::npos) << found.why;
  EXPECT_NE(found.why.find("5.4 Hz"), std::string::npos) << found.why;
  for (const Estimate& estimate : found.estimates) EXPECT_TRUE(estimate.withheld);
}

TEST(Aliases, ARangeThatHoldsOneOfThemDecides) {
  Experiment e = wheels(1, {stiffness_of(5.4)}, 0.2);
  e.runs = {test::simulated(10, 60, {turned(1, 0.1)})};
  e.unknowns[0].start = stiffness_of(5.1);
  e.unknowns[0].min = stiffness_of(5.0);
  e.unknowns[0].max = stiffness_of(8.0);
  const FitProblem problem(e);
  const Fit found = fit(problem, problem.records());
  EXPECT_EQ(found.status, FitStatus::converged) << found.why;
  EXPECT_NEAR(found.estimates[0].value, stiffness_of(5.4), 5 * found.estimates[0].standard_error);
}

// Few readings have residuals of 1.3 times the noise by chance in some of a hundred records: that is no wrong
// frequency.
TEST(Aliases, ARightFrequencyIsNotRefusedByChance) {
  int usable = 0;
  constexpr int records = 100;
  for (std::uint64_t seed = 1; seed <= records; ++seed) {
    Experiment e = wheels(1, {stiffness_of(4.0)}, 0.2);
    e.runs = {test::simulated(10, 30, {turned(1, 0.1)})};
    e.runs[0].seed = seed;
    e.unknowns[0].start = stiffness_of(4.1);
    e.unknowns[0].max = stiffness_of(5.0);
    const FitProblem problem(e);
    const Fit found = fit(problem, problem.records());
    usable += found.usable() ? 1 : 0;
    EXPECT_NE(found.status, FitStatus::failed) << seed << ": " << found.why;
  }
  EXPECT_GE(usable, records - 3);
}

TEST(Aliases, StiffnessTenTimesOffIsFound) {
  for (const double factor : {0.1, 0.3, 3.0, 10.0}) {
    Experiment e = wheels(1, {stiffness_of(5.4)}, 0.2);
    e.runs = {test::simulated(200, 1200, {turned(1, 0.1)})};
    e.unknowns[0].start = factor * stiffness_of(5.4);
    const FitProblem problem(e);
    const Fit found = fit(problem, problem.records());
    EXPECT_EQ(found.status, FitStatus::converged) << factor << ": " << found.why;
    ASSERT_EQ(found.estimates.size(), 1U);
    EXPECT_NEAR(found.estimates[0].value, stiffness_of(5.4), 5 * found.estimates[0].standard_error) << factor;
  }
}

// Random oscillators of one and two degrees of freedom, small and large motions, one and two runs, read from 1.1 to 25
// times per oscillation, with starts up to ten times off.
Experiment random_experiment(comparison::Random& random) {
  const double hertz = std::exp(random.uniform(std::log(1.0), std::log(6.0)));
  const int kind = random.index(4);
  Experiment e;
  if (kind == 3) {  // a pendulum that swings widely
    e.scene = test::chain(1, 1.0, 1.0);
    const double inertia = std::exp(random.uniform(-2.5, 0.5));
    e.scene.gravity = {0, -9.81};
    e.scene.bodies[1].center = {0.5, 0};
    e.scene.bodies[1].inertia = inertia;
    e.scene.start.angle[1] = -M_PI / 2 + random.uniform(0.1, 2.0);
    e.sensors = {test::angle_of(e.scene, "1", 1e-3)};
    e.unknowns = {test::unknown("body.1.inertia")};
    e.unknowns[0].min = 0.0;
  } else {
    const int count = kind == 2 ? 2 : 1;
    std::vector<double> k;
    for (int i = 0; i < count; ++i) k.push_back(stiffness_of(hertz) * std::exp(random.uniform(-0.5, 0.5)));
    e = wheels(count, k, random.uniform(0.0, 0.6));
    if (random.chance(0.5)) {
      e.unknowns.push_back(test::unknown("torsion_damper.c1.coefficient"));
      e.unknowns.back().min = 0.0;
      e.unknowns.back().start = 0.2;
    }
    if (kind == 1) {  // a known spring beside the unknown one determines the inertia, too
      test::add_torsion_spring(e.scene, 0, 1, 1.0);
      e.scene.elements.back().name = "known";
      e.unknowns.push_back(test::unknown("body.1.inertia"));
      e.unknowns.back().min = 0.0;
    }
  }
  // From well sampled to read far too slowly.
  const double f = kind == 3 ? 0.5 / M_PI * std::sqrt(4.9 / (0.25 + e.scene.bodies[1].inertia)) : hertz;
  const double rate = f * std::exp(random.uniform(std::log(1.1), std::log(25.0)));
  const int readings = 30 + random.index(70);
  const int runs = kind == 1 ? 2 : 1;
  for (int r = 0; r < runs; ++r) {
    Release release;
    release.body = kind == 2 ? 1 + random.index(2) : 1;
    release.value = kind == 3 ? *e.scene.start.angle[1] : random.uniform(0.02, 0.3);
    Run run = test::simulated(rate, readings, {release});
    run.name = "run " + std::to_string(r);
    run.seed = static_cast<std::uint64_t>(random.index(1000000));
    if (kind == 1) {
      const double known = (r == 0 ? 0.3 : 1.5) * stiffness_of(hertz);
      run.changes.push_back({"torsion_spring.known.stiffness", known, 0});
    }
    e.runs.push_back(run);
  }
  for (Unknown& unknown : e.unknowns) {
    if (unknown.start) continue;
    const double off = std::exp(random.uniform(-2.3, 2.3));
    const double truth = unknown.path.find("stiffness") != std::string::npos
                             ? std::get<LinearSpring>(e.scene.elements[unknown.path[16] == '2' ? 2 : 0].law).stiffness
                             : e.scene.bodies[1].inertia;
    unknown.start = truth * off;
  }
  return e;
}

// POISE_ALIAS_CASES=N tries N of them, POISE_FIRST_ALIAS_CASE=I begins with case I.
TEST(Aliases, NoWrongValueIsCalledConverged) {
  const auto number = [](const char* name, int otherwise) {
    const char* const text = std::getenv(name);
    return text != nullptr ? std::atoi(text) : otherwise;
  };
  const int cases = number("POISE_ALIAS_CASES", test::cases(5, 20));
  const int first = number("POISE_FIRST_ALIAS_CASE", 0);
  int converged = 0;
  int ambiguous = 0;
  for (int i = first; i < first + cases; ++i) {
    comparison::Random random(static_cast<std::uint64_t>(1000 + i));
    const Experiment e = random_experiment(random);
    const FitProblem problem(e);
    const Fit found = fit(problem, problem.records());
    ambiguous += found.status == FitStatus::ambiguous ? 1 : 0;
    if (!found.usable()) continue;
    ++converged;
    for (const Estimate& estimate : found.estimates) {
      if (estimate.withheld) continue;
      EXPECT_LT(std::abs(estimate.value - estimate.truth), 6 * estimate.standard_error)
          << "case " << i << ", " << to_string(found.status) << ": " << estimate.name;
    }
  }
  EXPECT_GE(converged, cases / 3);
  EXPECT_GE(ambiguous, cases / 5);
}

}  // namespace
}  // namespace poise::aliases_test
