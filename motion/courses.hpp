#pragma once

#include <string>
#include <vector>

#include "model/quantity.hpp"
#include "motion/kinematics.hpp"

namespace poise {

/// Something that changes over the range of a sweep: the angle of a body, a length (travel of a joint, place of a body
/// that no chain of joints ties to the ground) or a coordinate of a point. SI, one entry per sample.
struct Course {
  std::string name;
  Quantity quantity = Quantity::angle;
  std::vector<double> value, rate, acceleration;
};

/// The values of drive k over the range.
Course drive_course(const Scene& scene, const KinematicsResult& result, std::size_t k,
                    const std::vector<DriveRange>& ranges);
/// Every body that turns, then every length.
std::vector<Course> coordinate_courses(const Scene& scene, const KinematicsResult& result);
/// x and y of every point of every moving body: "crank.B.x".
std::vector<Course> point_courses(const Scene& scene, const KinematicsResult& result);

}  // namespace poise
