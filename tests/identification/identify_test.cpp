// The one call of the library, as its users write it.

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "poise.hpp"
#include "tests/identification/wheel.hpp"
#include "tests/support/known_answers.hpp"

namespace poise::identify_test {
namespace {

TEST(Identify, OneCallFindsTheNumbersOfALift) {
  const Identification found = identify(read_experiment(test::dataset("lift_experiment.toml")));
  EXPECT_EQ(found.fit.status, FitStatus::converged) << found.fit.why;
  EXPECT_EQ(found.records.size(), 6U);
  for (const char* name : {"mP", "J_O", "k", "c"}) {
    const Estimate& estimate = found.estimate(name);
    EXPECT_FALSE(estimate.withheld) << name << ": " << estimate.why;
    EXPECT_NEAR(estimate.value, estimate.truth, 4 * estimate.standard_error) << name;
  }
  EXPECT_TRUE(found.profiles.empty());
  EXPECT_FALSE(found.bootstrap);
}

TEST(Identify, FindsProfilesAndABootstrapWhereAsked) {
  const test::Wheel wheel(3);
  std::vector<std::string> said;
  IdentifyOptions options{.profiles = {"torsion_spring.coil.stiffness"}, .bootstrap = 20};
  options.fit.progress = [&](const std::string& doing) { said.push_back(doing); };
  const Identification found = identify(wheel.experiment, options);
  ASSERT_EQ(found.profiles.size(), 1U);
  const Estimate& k = found.estimate("torsion_spring.coil.stiffness");
  ASSERT_TRUE(found.profiles[0].low && found.profiles[0].high);
  EXPECT_NEAR(*found.profiles[0].low, k.low, 0.02 * k.standard_error);
  EXPECT_NEAR(*found.profiles[0].high, k.high, 0.02 * k.standard_error);
  ASSERT_TRUE(found.bootstrap);
  EXPECT_EQ(found.bootstrap->samples, 20);
  ASSERT_GE(said.size(), 3U);
  EXPECT_EQ(said[0], "simulating the runs");
  EXPECT_EQ(said[1], "fitting");
}

TEST(Identify, SaysWhichNamesThereAre) {
  const test::Wheel wheel(1);
  const FitProblem problem(wheel.experiment);
  const auto error_of = [](const auto& call) {
    try {
      call();
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(error_of([&] {
              identify(problem, {.profiles = {"nothing"}});
            }).find("nothing: expected the name of an unknown; known here: "),
            std::string::npos);
  EXPECT_EQ(error_of([] { Identification().estimate("k"); }), "k: expected the name of an estimate; the fit has none");
}

}  // namespace
}  // namespace poise::identify_test
