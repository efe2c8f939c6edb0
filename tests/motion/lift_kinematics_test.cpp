// What the lift of datasets/lift.toml does over its stroke, against datasets/lift_facts.json.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "motion/driven_path.hpp"
#include "motion/kinematics.hpp"
#include "solvers/linear_algebra.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/known_answers.hpp"

namespace poise::lift_kinematics_test {
namespace {

constexpr double degree = std::numbers::pi / 180;

std::size_t coordinate_of(const KinematicsResult& result, const std::string& name) {
  const auto found = std::find(result.coordinates.begin(), result.coordinates.end(), name);
  if (found == result.coordinates.end()) throw std::out_of_range(name);
  return static_cast<std::size_t>(found - result.coordinates.begin());
}

Vec2 place_in(const Scene& scene, const KinematicSample& at, const std::string& point) {
  const PointRef p = test::point(scene, point);
  return at.bodies[p.body].pose.world(scene.local(p));
}

class Lift : public testing::Test {
 protected:
  Lift() : facts_(test::read_json(test::dataset("lift_facts.json"))), scene_(read_scene(test::dataset("lift.toml"))) {
    from_ = facts_["angle_of_obd"][0];
    to_ = facts_["angle_of_obd"][1];
    SweepOptions options;
    options.steps = 120;  // as the facts were sampled
    result_ = sweep(scene_, {{"obd", from_, to_}}, options);
  }

  struct Extent {
    double min = 1e300, max = -1e300;
  };
  template <class F>
  Extent extent(F f) const {
    Extent out;
    for (const KinematicSample& at : result_.samples) {
      out.min = std::min(out.min, f(at));
      out.max = std::max(out.max, f(at));
    }
    return out;
  }

  nlohmann::json facts_;
  Scene scene_;
  double from_, to_;
  KinematicsResult result_;
};

TEST_F(Lift, TravelsAsStraightAndLevelAsItsFacts) {
  ASSERT_TRUE(result_.complete) << result_.why;
  EXPECT_TRUE(result_.singular.empty());
  for (const std::string point : {"P", "Q"}) {
    const Extent x = extent([&](const auto& at) { return place_in(scene_, at, "platform." + point).x; });
    const Extent y = extent([&](const auto& at) { return place_in(scene_, at, "platform." + point).y; });
    EXPECT_NEAR(y.max - y.min, facts_["travel_" + point].get<double>(), 1e-10);
    EXPECT_NEAR((x.max - x.min) / 2, facts_["half_drift_" + point].get<double>(), 1e-10);
  }
  // The facts count the inclination from the mean of the sampled angles.
  const int platform = test::point(scene_, "platform.P").body;
  double mean = 0.0;
  for (const KinematicSample& at : result_.samples) {
    mean += at.bodies[platform].pose.angle / static_cast<double>(result_.samples.size());
  }
  const Extent angle = extent([&](const auto& at) { return at.bodies[platform].pose.angle; });
  EXPECT_NEAR((angle.max - angle.min) / degree,
              facts_["inclination_deg"][1].get<double>() - facts_["inclination_deg"][0].get<double>(), 1e-8);
  EXPECT_LT(std::max(angle.max - mean, mean - angle.min), 0.6 * degree);
}

TEST_F(Lift, PushesItsCylinderAsItsFacts) {
  const std::size_t stroke = coordinate_of(result_, "stroke");
  const Extent length = extent([&](const auto& at) { return at.q[stroke]; });
  EXPECT_NEAR(length.min, facts_["cylinder"][0].get<double>(), 1e-10);
  EXPECT_NEAR(length.max, facts_["cylinder"][1].get<double>(), 1e-10);
  // The facts' lever arms are differences of neighbouring samples.
  Extent lever;
  for (std::size_t k = 1; k < result_.samples.size(); ++k) {
    const KinematicSample &here = result_.samples[k], &before = result_.samples[k - 1];
    const double mean = (here.q[stroke] - before.q[stroke]) / (here.drive[0] - before.drive[0]);
    lever = {std::min(lever.min, mean), std::max(lever.max, mean)};
    EXPECT_NEAR((here.rate[stroke] + before.rate[stroke]) / 2, mean, 2e-6);  // driven at 1 rad/s
  }
  EXPECT_NEAR(lever.min, facts_["lever_arm"][0].get<double>(), 1e-10);
  EXPECT_NEAR(lever.max, facts_["lever_arm"][1].get<double>(), 1e-10);
  for (const auto& fact : facts_["stroke"]) {
    const double q = fact["q"];
    const KinematicsResult there = sweep(scene_, {{"obd", q, q}});
    ASSERT_EQ(there.samples.size(), 1u) << there.why;
    EXPECT_NEAR(place_in(scene_, there.samples[0], "platform.Q").y, fact["yQ"].get<double>(), 1e-11);
    EXPECT_NEAR(there.samples[0].q[stroke], fact["l"].get<double>(), 1e-12);
    EXPECT_NEAR(there.samples[0].rate[stroke], fact["dl_dq"].get<double>(), 1e-8);
  }
}

TEST_F(Lift, KeepsItsTransmissionAnglesAndItsBranches) {
  struct Corner {
    const char *pin, *tip, *one, *other;
  };
  for (const Corner& corner : {Corner{"F", "def.F", "def.D", "fa.A"}, Corner{"C", "bpc.C", "bpc.B", "ecg.E"},
                               Corner{"L", "platform.L", "platform.P", "gl.G"}}) {
    const Extent angle = extent([&](const auto& at) {
      const Vec2 tip = place_in(scene_, at, corner.tip);
      const Vec2 one = place_in(scene_, at, corner.one) - tip, other = place_in(scene_, at, corner.other) - tip;
      return std::atan2(std::abs(cross(one, other)), std::abs(dot(one, other))) / degree;
    });
    EXPECT_NEAR(angle.min, facts_["least_transmission_deg"][corner.pin].get<double>(), 1e-8) << corner.pin;
  }
}

// Condition of the loops in m and rad with the driven angle held.
TEST_F(Lift, KeepsAwayFromSingularPosesAsItsFacts) {
  const MotionModel model(scene_);
  const Measure on = find_drive(scene_, "obd").on;
  const SplitClosure closure(model, {model.layout().links[static_cast<std::size_t>(on.body_b)].frame});
  std::vector<double> conditions;
  for (const KinematicSample& at : result_.samples) {
    const std::vector<double> x = model.from_si(at.q);
    Eigen::MatrixXd jacobian =
        closure.jacobian(Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size())));
    for (int k = 0; k < model.layout().angles; ++k) jacobian.col(k) *= model.scales().length;
    const Eigen::VectorXd values = solvers::singular_value_decomposition(closure.free_columns(jacobian)).values;
    conditions.push_back(values[0] / values[values.size() - 1]);
  }
  std::sort(conditions.begin(), conditions.end());
  EXPECT_NEAR(conditions.front(), facts_["condition"]["least"].get<double>(), 1e-6);
  EXPECT_NEAR(conditions[conditions.size() / 2], facts_["condition"]["median"].get<double>(), 1e-6);
  EXPECT_NEAR(conditions.back(), facts_["condition"]["largest"].get<double>(), 1e-6);
}

}  // namespace
}  // namespace poise::lift_kinematics_test
