// Bands of results from tolerances: closed forms, solving every sample anew, the same bits from any number of threads.

#include "statics/sensitivity/tolerance.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "model/input_error.hpp"
#include "model/parameters.hpp"
#include "solvers/random_stream.hpp"
#include "statics/equilibrium/named_equilibrium.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/random_mechanism.hpp"

namespace poise::tolerance_test {
namespace {

using test::dataset;

ToleranceStudy study_of(const Scene& scene, const std::string& text, const std::string& of,
                        const ToleranceOptions& options) {
  const StaticModel model(scene);
  return tolerance_study(model, parse_tolerances(text, "tolerances", scene), {find_quantity(scene, of)}, options);
}

TEST(Tolerance, OfALeverFollowsTheLawOfTheLever) {
  const Scene scene = test::lever();
  const double P = 40.0, a = 0.25, b = 0.5, p_within = 6.0, a_within = 0.03;
  const ToleranceStudy study = study_of(scene,
                                        "[tolerances]\n\"load.P\" = 6\n\"point.lever.load.x\" = { half_width = 0.03, "
                                        "distribution = \"normal\", sigma = 0.01 }\n",
                                        "stop.foot", {.samples = 200'000});
  ASSERT_EQ(study.why, "");
  const ToleranceBand& band = study.of.at(0);
  const double sigma_p = p_within / std::sqrt(3.0), sigma_a = 0.01;
  const double linear = std::hypot(a / b * sigma_p, P / b * sigma_a);
  EXPECT_NEAR(band.nominal, P * a / b, 1e-9);
  EXPECT_NEAR(band.sigma, linear, 1e-9);
  EXPECT_NEAR(band.worst, a / b * p_within + P / b * a_within, 1e-9);
  // S is bilinear: no shift, and a variance that the mixed derivative 1 / b completes exactly.
  const double exact = std::hypot(linear, sigma_p * sigma_a / b);
  ASSERT_TRUE(band.has_second);
  EXPECT_NEAR(band.shift, 0.0, 1e-6);
  EXPECT_NEAR(band.second_sigma, exact, 1e-6);
  ASSERT_TRUE(band.at_least && band.at_most);
  EXPECT_NEAR(*band.at_most, (P + p_within) * (a + a_within) / b, 1e-8);
  EXPECT_NEAR(*band.at_least, (P - p_within) * (a - a_within) / b, 1e-8);
  EXPECT_EQ(study.continued, 200'000U);
  EXPECT_NEAR(band.all.mean, P * a / b, 5 * exact / std::sqrt(200'000.0));
  EXPECT_NEAR(band.all.sigma, exact, 0.01 * exact);
  EXPECT_TRUE(band.is_linear);
}

TEST(Tolerance, FirstOrderAgreesWithAMillionSamplesWhereTheResponseIsLinear) {
  for (const auto& [file, of] :
       {std::pair("thesis_four_bar.toml", "reaction.A"), std::pair("six_bar.toml", "energy")}) {
    const Scene scene = read_scene(dataset(file));
    const ToleranceStudy study = study_of(scene, "[tolerances]\n\"point.*\" = 0.0005\n", of, {.samples = 1'000'000});
    ASSERT_EQ(study.why, "") << file;
    const ToleranceBand& band = study.of.at(0);
    EXPECT_TRUE(band.is_linear) << file;
    EXPECT_NEAR(band.sigma, band.all.sigma, 0.03 * band.all.sigma) << file;
    EXPECT_NEAR(band.nominal, band.all.mean, 0.03 * band.all.sigma) << file;
    EXPECT_LE(band.all.most, band.nominal + 1.01 * band.worst) << file;
    EXPECT_EQ(study.disagreed, 0U) << file;
    EXPECT_EQ(study.rechecked, 1000U) << file;
  }
}

// Every sample of the clamp solved by itself: released from its start, each comes to rest where the study says.
TEST(Tolerance, AgreesWithSolvingEverySampleOfTheClamp) {
  const Scene scene = read_scene(dataset("toggle_clamp.toml"));
  constexpr std::size_t samples = 400;
  const std::string text = "[tolerances]\n\"point.*\" = 0.1\n";
  const ToleranceStudy study = study_of(scene, text, "force.rubber", {.samples = samples, .seed = 7});
  ASSERT_EQ(study.why, "");
  const std::vector<Tolerance> tolerances = parse_tolerances(text, "tolerances", scene);
  std::size_t closed = 0, open = 0;
  double sum = 0.0, least = 0.0;
  for (std::size_t k = 0; k < samples; ++k) {
    Scene changed = scene;
    solvers::RandomStream random(7, 0, k);
    for (const Tolerance& tolerance : tolerances) {
      const ParameterPlace place = parameter(scene, tolerance.number).place;
      const double by = (2 * random.uniform() - 1) * tolerance.half_width;
      set_value_at(changed, place, *value_at(scene, place) + by);
    }
    const NamedEquilibrium rest = solve(changed);
    ASSERT_TRUE(rest.found()) << rest.result().why;
    const double force = rest.force("rubber");
    (force < 0.0 ? closed : open) += 1;
    sum += force;
    least = std::min(least, force);
  }
  EXPECT_EQ(study.continued, closed);
  EXPECT_EQ(study.snapped, open);
  EXPECT_EQ(study.nowhere, 0U);
  EXPECT_GT(open, samples / 40);
  EXPECT_NEAR(study.of[0].all.mean, sum / static_cast<double>(samples), 1e-6 * std::abs(sum));
  EXPECT_NEAR(study.of[0].all.least, least, 1e-6 * std::abs(least));
  EXPECT_EQ(study.of[0].all.most, 0.0);
  EXPECT_FALSE(study.of[0].is_linear);
}

TEST(Tolerance, HasTheSameBitsForAnyNumberOfThreads) {
  const Scene scene = read_scene(dataset("toggle_clamp.toml"));
  const auto study = [&](int jobs, std::uint64_t seed) {
    return study_of(scene, "[tolerances]\n\"point.*\" = 0.1\n", "force.rubber",
                    {.samples = 3000, .seed = seed, .jobs = jobs});
  };
  const ToleranceStudy one = study(1, 1), three = study(3, 1), other = study(2, 2);
  EXPECT_EQ(one.of[0].all.mean, three.of[0].all.mean);
  EXPECT_EQ(one.of[0].all.sigma, three.of[0].all.sigma);
  EXPECT_EQ(one.of[0].histogram, three.of[0].histogram);
  EXPECT_EQ(one.snapped, three.snapped);
  EXPECT_NE(one.of[0].all.mean, other.of[0].all.mean);
}

// Random mechanisms with every joint, element, follower load and stop: a sample that continues is the equilibrium that
// Newton's method finds from the nominal one.
TEST(Tolerance, SamplesOfRandomMechanismsAreEquilibriaNearTheNominalOne) {
  int compared = 0;
  for (std::uint64_t seed = 1; seed <= 32; ++seed) {
    const test::Wish wish{.loops = static_cast<int>(seed % 3),
                          .followers = seed % 4 == 0,
                          .stops = seed % 2 == 0,
                          .couplings = seed > 16};
    const test::PlantedMechanism planted = test::plant_mechanism(seed, wish);
    if (planted.redundant > 0) continue;
    const Scene& scene = planted.in_equilibrium;
    const std::string text = "[tolerances]\n\"*\" = { percent = 0.1 }\n";
    const std::vector<Tolerance> tolerances = parse_tolerances(text, "tolerances", scene);
    const std::string of = "angle." + scene.bodies[1].name;
    const StaticModel model(scene);
    const ToleranceStudy study =
        tolerance_study(model, tolerances, {find_quantity(scene, of)}, {.samples = 1, .seed = seed});
    if (!study.why.empty() || study.continued != 1) continue;
    Scene changed = scene;
    solvers::RandomStream random(seed, 0, 0);
    for (const Tolerance& tolerance : tolerances) {
      const ParameterPlace place = parameter(scene, tolerance.number).place;
      const double by = (2 * random.uniform() - 1) * tolerance.half_width;
      set_value_at(changed, place, *value_at(scene, place) + by);
    }
    const StaticModel other(changed, model.scales());
    if (other.layout().kept != model.layout().kept) continue;
    const Equilibrium found = solve(other, study.equilibrium.x, test::by(Method::virtual_work));
    ASSERT_TRUE(found.found()) << found.why;
    const double expected = other.poses(found.x)[1].angle;
    EXPECT_NEAR(study.of.at(0).all.mean, expected, 1e-8) << "seed " << seed;
    ++compared;
  }
  EXPECT_GE(compared, 6);
}

TEST(Tolerance, KeepsTheSamplesDrawnBeforeAnInterrupt) {
  std::atomic<bool> interrupt = false;
  ToleranceOptions options{.samples = 100'000, .jobs = 1};
  options.solve.interrupt = &interrupt;
  options.progress = [&](std::size_t done) { interrupt = done >= 2000; };
  const ToleranceStudy study = study_of(test::lever(), "[tolerances]\n\"load.P\" = 6\n", "stop.foot", options);
  EXPECT_TRUE(study.interrupted);
  EXPECT_GE(study.samples, 2000U);
  EXPECT_LT(study.samples, 100'000U);
  EXPECT_EQ(study.of.at(0).all.count, study.samples);
  EXPECT_EQ(study.continued, study.samples);
}

// The interrupt comes while some sample settles anew, which then ends without an equilibrium that it would have found.
TEST(Tolerance, ASampleThatAnInterruptStopsIsNotCounted) {
  const Scene scene = read_scene(dataset("toggle_clamp.toml"));
  const std::string text = "[tolerances]\n\"point.*\" = 0.1\n";
  std::size_t interrupted = 0;
  for (int k = 0; k < 6; ++k) {
    std::atomic<bool> interrupt = false;
    ToleranceOptions options{.samples = 200'000, .jobs = 2};
    options.solve.interrupt = &interrupt;
    std::thread later;
    options.progress = [&](std::size_t) {
      if (later.joinable()) return;
      later = std::thread([&interrupt, k] {
        std::this_thread::sleep_for(std::chrono::milliseconds(20 + 7 * k));
        interrupt = true;
      });
    };
    const ToleranceStudy study = study_of(scene, text, "force.rubber", options);
    if (later.joinable()) later.join();
    EXPECT_EQ(study.nowhere, 0U);
    EXPECT_EQ(study.continued + study.snapped, study.samples);
    interrupted += study.interrupted ? 1 : 0;
  }
  EXPECT_GT(interrupted, 0U);
}

// Only the sum of the two torques acts on the arm, and only differences of places on the four-bar.
TEST(Tolerance, SamplesAreNotLostByRounding) {
  Scene arm = read_scene(dataset("hard/cancelling_couple.toml"));
  for (const double T : {1e4, 1e5, 1e6}) {
    set_value_at(arm, parameter(arm, "load.T1").place, T + 0.25);
    set_value_at(arm, parameter(arm, "load.T2").place, -T);
    const ToleranceStudy study = study_of(arm, "[tolerances]\n\"point.*\" = 1e-3\n", "arm", {.samples = 1000});
    ASSERT_EQ(study.why, "") << T;
    EXPECT_EQ(study.continued, 1000U) << T;
    EXPECT_EQ(study.disagreed, 0U) << T;
    EXPECT_NEAR(study.of.at(0).continued.sigma, study.of.at(0).sigma, 0.1 * study.of.at(0).sigma) << T;
  }
  for (const double away : {0.0, 1e4, 1e6}) {
    Scene scene = read_scene(dataset("four_bar_gravity.toml"));
    for (NamedPoint& point : scene.bodies[0].points) {
      point.at.x += away;
      point.at.y -= away;
    }
    const ToleranceStudy study = study_of(scene, "[tolerances]\n\"point.*\" = 1e-3\n", "crank", {.samples = 1000});
    ASSERT_EQ(study.why, "") << away;
    EXPECT_EQ(study.continued, 1000U) << away;
    EXPECT_EQ(study.disagreed, 0U) << away;
  }
}

TEST(Tolerance, OfAConstantIsLinear) {
  for (const char* numbers :
       {"\"load.P\" = { half_width = 1, distribution = \"normal\", sigma = 0 }\n", "\"body.arm.center.x\" = 1\n"}) {
    const ToleranceStudy study = study_of(read_scene(dataset("toggle_clamp.toml")),
                                          std::string("[tolerances]\n") + numbers, "force.rubber", {.samples = 100});
    ASSERT_EQ(study.why, "");
    EXPECT_TRUE(study.of.at(0).is_linear) << numbers;
  }
}

// Rounding of torques of 1e9 N m moves the arm by 1e-6, which is not a loss.
TEST(Tolerance, WhatRoundingLeavesOpenIsCountedOnItsOwn) {
  Scene arm = read_scene(dataset("hard/cancelling_couple.toml"));
  set_value_at(arm, parameter(arm, "load.T1").place, 1e9 + 0.25);
  set_value_at(arm, parameter(arm, "load.T2").place, -1e9);
  const ToleranceStudy study = study_of(arm, "[tolerances]\n\"point.*\" = 1e-3\n", "arm", {.samples = 100});
  ASSERT_EQ(study.why, "");
  EXPECT_EQ(study.undecided, 100U);
  EXPECT_EQ(study.of.at(0).all.count, 0U);
  EXPECT_FALSE(study.of.at(0).is_linear);
}

// Points that are off by 50 mm: where a sample loses its equilibrium the equations beyond are singular to rounding, but
// where it was last followed to all is known.
TEST(Tolerance, ALossIsNoMatterOfRounding) {
  const ToleranceStudy study =
      study_of(read_scene(dataset("car_hood.toml")), "[tolerances]\n\"point.*\" = 0.05\n", "energy", {.samples = 200});
  ASSERT_EQ(study.why, "");
  EXPECT_EQ(study.undecided, 0U);
  EXPECT_GT(study.snapped + study.nowhere, 20U);
  EXPECT_EQ(study.disagreed, 0U);
}

TEST(Tolerance, OfRedundantConstraintsIsRefused) {
  const ToleranceStudy study =
      study_of(read_scene(dataset("redundant_parallelogram.toml")), "[tolerances]\n\"load.*\" = 0.1\n", "energy", {});
  EXPECT_NE(study.why, "");
  EXPECT_TRUE(study.of.empty());
}

TEST(Tolerance, OfALoadAtAFoldIsOfFirstOrder) {
  const Scene scene = read_scene(dataset("von_mises_toggle.toml"));
  const ToleranceStudy study =
      study_of(scene, "[tolerances]\n\"spring.*.stiffness\" = { percent = 10 }\n", "load_at_fold.P", {.samples = 100});
  ASSERT_EQ(study.why, "");
  // The load at the fold is proportional to both stiffnesses together, and so is its worst case.
  EXPECT_NEAR(study.of[0].worst, 0.1 * study.of[0].nominal, 1e-8);
  EXPECT_EQ(study.of[0].all.count, 0U);
}

TEST(Tolerance, FilesAreReadWithTheMostParticularEntry) {
  const Scene scene = test::lever();
  const std::vector<Tolerance> found = parse_tolerances(
      "[tolerances]\n\"point.*\" = 0.1\n\"point.lever.*\" = 0.2\n\"point.lever.foot.y\" = 0.3\n\"point.ground.*\" = "
      "0\n",
      "t", scene);
  ASSERT_EQ(found.size(), 6U);
  for (const Tolerance& one : found) {
    EXPECT_EQ(one.half_width, one.number == "point.lever.foot.y" ? 0.3 : 0.2) << one.number;
    EXPECT_NEAR(one.sigma, one.half_width / std::sqrt(3.0), 1e-15);
  }
}

TEST(Tolerance, BadFilesAreAnsweredWithTheirPlace) {
  const Scene scene = test::lever();
  const auto complaint = [&](const std::string& text) -> std::string {
    try {
      parse_tolerances(text, "t.toml", scene);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const auto expect = [&](const std::string& text, const std::string& part) {
    const std::string said = complaint(text);
    EXPECT_NE(said.find(part), std::string::npos) << text << "\n" << said;
    EXPECT_EQ(said.rfind("t.toml:", 0), 0U) << said;
  };
  expect("", "expected a table [tolerances]");
  expect("[tolerances]\n", "expected one tolerance above zero");
  expect("[tolerances]\n\"load.Q\" = 1\n", "t.toml:2: tolerances.load.Q: expected the path of a number");
  expect("[tolerances]\n\"load.P\" = -1\n", "expected a finite number >= 0");
  expect("[tolerances]\n\"load.P\" = \"wide\"\n", "expected a number");
  expect("[tolerances]\n\"load.P\" = 50\n", "may fall to -10");
  expect("[tolerances]\n\"load.P\" = { half_width = 1, percent = 2 }\n", "either half_width or percent");
  expect("[tolerances]\n\"load.P\" = { half_width = 1, sigma = 2 }\n", "no sigma of its own");
  expect("[tolerances]\n\"load.P\" = { half_width = 1, distribution = \"gauss\" }\n", "uniform");
  expect("[tolerances]\n\"start.lever\" = 1\n",
         "t.toml:2: tolerances.start.lever: this number does not act in statics");
  expect("[tolerances]\n\"gravity.x\" = { percent = 2 }\n", "t.toml:2: tolerances.gravity.x: the number is 0");
  EXPECT_EQ(complaint("[tolerances]\n\"\" = 1\n").find("start."), std::string::npos);
  expect("[tolerance]\n\"load.P\" = 1\n", "did you mean \"tolerances\"?");
}

}  // namespace
}  // namespace poise::tolerance_test
