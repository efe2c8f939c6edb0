// Gross misfits: none of noise, whatever is stated of it, and the cause of one.

#include "identification/assessment/misfit.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "identification/assessment/identify.hpp"
#include "solvers/random_stream.hpp"
#include "tests/identification/wheel.hpp"

namespace poise::misfit_test {
namespace {

/// A measured run of the wheel, read at 200 Hz for 4 s with noise of that deviation and correlation.
Experiment measured(double noise, double correlation, bool stated) {
  Experiment out = test::Wheel(1).experiment;
  out.runs.front().data = {"data.csv"};
  out.sensors.front().noise = noise;
  out.sensors.front().noise_known = stated;
  Series series;
  solvers::RandomStream random(5);
  double x = 0.0;
  for (int i = 0; i < 800; ++i) {
    x = correlation * x + std::sqrt(1 - correlation * correlation) * random.normal();
    series.time.push_back(i / 200.0);
    series.value.push_back(test::Wheel::at(series.time.back()) + noise * x);
  }
  out.records = {Record{{series}}};
  return out;
}

// The noise is up to a quarter of the amplitude.
TEST(GrossMisfit, IsNoneOfNoise) {
  for (const double noise : {1e-4, 1e-3, 1e-2, 0.08}) {
    for (const double correlation : {0.0, 0.9}) {
      for (const bool stated : {true, false}) {
        const Identification found = identify(measured(noise, correlation, stated));
        EXPECT_FALSE(found.misfit) << noise << " " << correlation << " " << found.misfit->words;
        EXPECT_TRUE(found.is_believable()) << noise << " " << correlation << " " << stated << ": "
                                           << (found.faults.empty() ? found.fit.why : found.faults[0].words);
      }
    }
  }
}

TEST(GrossMisfit, IsNotHiddenByNoiseThatIsStatedTooLarge) {
  Experiment experiment = measured(1e-4, 0.0, true);
  experiment.sensors.front().noise = 0.1;
  for (double& value : experiment.records[0].sensors[0].value) value += 0.2;
  const Identification found = identify(experiment);
  ASSERT_TRUE(found.misfit);
  EXPECT_NE(found.misfit->words.find(" % of its readings' variation"), std::string::npos) << found.misfit->words;
}

TEST(MisfitCauses, NameTheZeroAndWhatToWrite) {
  Experiment experiment = measured(1e-3, 0.0, true);
  for (double& value : experiment.records[0].sensors[0].value) value += 0.2;
  const Identification found = identify(experiment);
  ASSERT_TRUE(found.misfit);
  ASSERT_FALSE(found.causes.empty());
  EXPECT_EQ(found.causes[0].words, "the zero of the sensor \"wheel\" is off");
  EXPECT_EQ(found.causes[0].cure.substr(0, 10), "zero = -0.") << found.causes[0].cure;
  EXPECT_NEAR(found.causes[0].over_noise, 1.0, 0.1);
  EXPECT_TRUE(found.causes[0].cures);
}

}  // namespace
}  // namespace poise::misfit_test
