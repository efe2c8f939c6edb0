#include "tests/support/motions.hpp"

#include <numeric>
#include <stdexcept>

#include <gtest/gtest.h>

#include "motion/body_motion.hpp"
#include "motion/equilibrium_pose.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "tests/support/build_scene.hpp"

namespace poise::test {

int coordinate_of(const MotionModel& model, const std::string& name) {
  const Scene& scene = model.scene();
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    if (scene.bodies[i].name == name) return model.layout().links[i].frame;
  }
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    if (scene.joints[j].name == name) return model.layout().travel[j];
  }
  throw std::out_of_range("the scene has no \"" + name + "\"");
}

MotionState released(const MotionModel& model, const Release& release, const std::vector<double>* q) {
  std::vector<StartValue> wanted;
  for (const auto& [name, value] : release.places) wanted.push_back({coordinate_of(model, name), false, value});
  for (const auto& [name, value] : release.rates) wanted.push_back({coordinate_of(model, name), true, value});
  return start_motion(model, wanted, q);
}

std::vector<double> equilibrium_of(const MotionModel& model) {
  const StaticModel statics(model.scene());
  const Equilibrium equilibrium = solve(statics);
  EXPECT_TRUE(equilibrium.found()) << equilibrium.why;
  return model.to_si(motion_coordinates(model, statics, equilibrium.x));
}

Motion moved(const MotionModel& model, const MotionState& start, double duration, double accuracy) {
  MotionOptions options;
  options.duration = duration;
  options.accuracy = accuracy;
  Motion motion = simulate(model, start, options);
  EXPECT_TRUE(motion.completed()) << motion.why;
  return motion;
}

std::vector<double> q_at(const Motion& motion, std::size_t node) {
  const auto n = static_cast<std::ptrdiff_t>(motion.trajectory.coordinates);
  const auto first = motion.trajectory.q.begin() + static_cast<std::ptrdiff_t>(node) * n;
  return {first, first + n};
}

std::vector<double> v_at(const Motion& motion, std::size_t node) {
  const auto n = static_cast<std::ptrdiff_t>(motion.trajectory.coordinates);
  const auto first = motion.trajectory.v.begin() + static_cast<std::ptrdiff_t>(node) * n;
  return {first, first + n};
}

PointState end_of(const MotionModel& model, const Motion& motion, const std::string& name) {
  const std::size_t last = motion.trajectory.nodes() - 1;
  const std::vector<double> v = model.from_si(v_at(motion, last));
  const auto bodies = body_motions(model, model.from_si(q_at(motion, last)), v, std::vector<double>(v.size(), 0.0));
  const PointRef ref = point(model.scene(), name);
  const BodyMotion& body = bodies[static_cast<std::size_t>(ref.body)];
  const Vec2& local = model.scene().local(ref);
  return {body.pose.world(local), body.velocity_of(local)};
}

std::vector<Reading> read_at(const Motion& motion, const std::vector<double>& times) {
  const auto n = static_cast<std::size_t>(motion.trajectory.coordinates);
  std::vector<int> all(n);
  std::iota(all.begin(), all.end(), 0);
  TrajectoryReader reader(motion.trajectory, all);
  std::vector<Reading> readings;
  for (double t : times) {
    reader.at(t);
    Reading& reading = readings.emplace_back();
    for (std::size_t i = 0; i < n; ++i) {
      reading.q.push_back(reader.q(i));
      reading.v.push_back(reader.v(i));
    }
  }
  return readings;
}

}  // namespace poise::test
