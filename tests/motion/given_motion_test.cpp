#include "motion/given_motion.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "motion/kinematics.hpp"
#include "tests/support/known_answers.hpp"

namespace poise::given_motion_test {
namespace {

// The lift with obd moving as 0.4 + 0.1 sin(7 t), 401 samples of 1 ms.
struct Swing {
  std::vector<double> time, angle, rate, second;
  Swing() {
    for (int k = 0; k <= 400; ++k) {
      const double t = 1e-3 * k;
      time.push_back(t);
      angle.push_back(0.4 + 0.1 * std::sin(7 * t));
      rate.push_back(0.7 * std::cos(7 * t));
      second.push_back(-4.9 * std::sin(7 * t));
    }
  }
};

int coordinate(const MotionModel& model, const std::string& name) {
  const auto& all = model.layout().coordinates;
  return static_cast<int>(std::find_if(all.begin(), all.end(), [&](const Coordinate& c) { return c.name == name; }) -
                          all.begin());
}

class GivenMotionOfTheLift : public testing::TestWithParam<bool> {};

// Against the sweep, whose derivatives come from the loops alone.
TEST_P(GivenMotionOfTheLift, CompletesWhatOneAngleTells) {
  const bool with_rates = GetParam();
  const Scene scene = read_scene(test::dataset("lift.toml"));
  const MotionModel model(scene);
  const Swing swing;
  const auto obd = static_cast<std::size_t>(coordinate(model, "obd"));
  const GivenMotion motion = complete_motion(
      model, swing.time, {{static_cast<int>(obd), swing.angle, with_rates ? swing.rate : std::vector<double>{}}});
  ASSERT_EQ(motion.x.size(), swing.time.size());
  EXPECT_LT(motion.closing, 1e-12);
  for (std::size_t k : {0U, 1U, 150U, 399U, 400U}) {
    SCOPED_TRACE(k);
    const bool inside = k > 1 && k < 399;
    EXPECT_NEAR(motion.v[k][obd], swing.rate[k], inside ? 1e-11 : 1e-9);
    EXPECT_NEAR(motion.a[k][obd], swing.second[k], inside ? 1e-8 : 1e-6);
    const KinematicSample at = sweep(scene, {{"obd", swing.angle[k], swing.angle[k] + 0.01}}).samples.front();
    const std::vector<double> x = model.from_si(at.q), per_angle = model.from_si(at.rate),
                              bend = model.from_si(at.acceleration);
    const double w = motion.v[k][obd], angular_acceleration = motion.a[k][obd];
    for (std::size_t i = 0; i < x.size(); ++i) {
      EXPECT_NEAR(motion.x[k][i], x[i], 1e-11);
      EXPECT_NEAR(motion.v[k][i], per_angle[i] * w, 1e-11);
      EXPECT_NEAR(motion.a[k][i], per_angle[i] * angular_acceleration + bend[i] * w * w, 1e-10);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Each, GivenMotionOfTheLift, testing::Bool(),
                         [](const auto& rates) { return rates.param ? "WithRates" : "AnglesAlone"; });

TEST(GivenMotion, ClosesLoopsThatNoiseOpens) {
  const MotionModel model(read_scene(test::dataset("four_bar_gravity.toml")));
  const KinematicsResult path = sweep(model.scene(), {{"crank", 1.0, 1.2}});
  std::vector<double> time;
  std::vector<SampledCoordinate> samples(3);
  for (int i = 0; i < 3; ++i) samples[static_cast<std::size_t>(i)].coordinate = i;
  for (std::size_t k = 0; k < path.samples.size(); ++k) {
    time.push_back(0.01 * static_cast<double>(k));
    for (std::size_t i = 0; i < 3; ++i) samples[i].value.push_back(path.samples[k].q[i] + 1e-4 * std::sin(9.0 * k + i));
  }
  const GivenMotion motion = complete_motion(model, time, samples);
  EXPECT_GT(motion.closing, 1e-6);
  EXPECT_LT(motion.closing, 3e-4);
  std::vector<Planar<double>> pose(model.mechanism().pose_size());
  std::vector<double> gap(model.mechanism().constraints());
  for (const std::vector<double>& x : motion.x) {
    model.mechanism().place(x.data(), pose.data());
    model.mechanism().constraint(x.data(), pose.data(), gap.data());
    for (double g : gap) EXPECT_NEAR(g, 0.0, 1e-13);
  }
}

TEST(GivenMotion, NamesWhatTheSamplesLeaveOpen) {
  const MotionModel model(read_scene(test::dataset("pendulum_chain.toml")));
  try {
    complete_motion(model, {0.0, 0.1, 0.2}, {{0, {0.0, 0.1, 0.2}, {}}, {2, {0.0, 0.1, 0.2}, {}}});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("the motion of \"middle\" is undetermined"), std::string::npos)
        << error.what();
  }
}

TEST(GivenMotion, RefusesSamplesOfAnotherMechanism) {
  const MotionModel model(read_scene(test::dataset("four_bar_gravity.toml")));
  const std::vector<double> wrong = {0.0, 0.0, 0.0};
  EXPECT_THROW(complete_motion(model, {0.0, 0.1, 0.2}, {{0, wrong, {}}, {1, wrong, {}}, {2, {2.5, 2.5, 2.5}, {}}}),
               InputError);
}

}  // namespace
}  // namespace poise::given_motion_test
