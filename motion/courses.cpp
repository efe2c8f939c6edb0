#include "motion/courses.hpp"

#include <utility>

namespace poise {

Course drive_course(const Scene& scene, const KinematicsResult& result, std::size_t k,
                    const std::vector<DriveRange>& ranges) {
  Course out{ranges[k].name, quantity_of(find_drive(scene, ranges[k].name).on), {}, {}, {}};
  for (const KinematicSample& sample : result.samples) {
    out.value.push_back(sample.drive[k]);
    out.rate.push_back(sample.drive_rate[k]);
    out.acceleration.push_back(0.0);
  }
  return out;
}

std::vector<Course> coordinate_courses(const Scene& scene, const KinematicsResult& result) {
  std::vector<Course> out;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (!result.turns[i]) continue;
    Course course{scene.bodies[i].name, Quantity::angle, {}, {}, {}};
    for (const KinematicSample& sample : result.samples) {
      course.value.push_back(sample.bodies[i].pose.angle);
      course.rate.push_back(sample.bodies[i].rate);
      course.acceleration.push_back(sample.bodies[i].angular_acceleration);
    }
    out.push_back(std::move(course));
  }
  for (std::size_t t = 0; t < result.coordinates.size(); ++t) {
    if (result.is_angle[t]) continue;
    Course course{result.coordinates[t], Quantity::length, {}, {}, {}};
    for (const KinematicSample& sample : result.samples) {
      course.value.push_back(sample.q[t]);
      course.rate.push_back(sample.rate[t]);
      course.acceleration.push_back(sample.acceleration[t]);
    }
    out.push_back(std::move(course));
  }
  return out;
}

std::vector<Course> point_courses(const Scene& scene, const KinematicsResult& result) {
  std::vector<Course> out;
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    for (const NamedPoint& p : scene.bodies[i].points) {
      const std::string name = scene.bodies[i].name + "." + p.name;
      Course x{name + ".x", Quantity::length, {}, {}, {}};
      Course y{name + ".y", Quantity::length, {}, {}, {}};
      for (const KinematicSample& sample : result.samples) {
        const BodyMotion& body = sample.bodies[i];
        const Vec2 at = body.pose.world(p.at), v = body.velocity_of(p.at), a = body.acceleration_of(p.at);
        x.value.push_back(at.x);
        y.value.push_back(at.y);
        x.rate.push_back(v.x);
        y.rate.push_back(v.y);
        x.acceleration.push_back(a.x);
        y.acceleration.push_back(a.y);
      }
      out.push_back(std::move(x));
      out.push_back(std::move(y));
    }
  }
  return out;
}

}  // namespace poise
