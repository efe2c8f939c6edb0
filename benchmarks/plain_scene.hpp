#pragma once

#include <vector>

#include "benchmarks/plain_mechanism.hpp"
#include "statics/model/static_model.hpp"

namespace poise::benchmarks {

/// A scene in plain numbers: pins, slides, springs between two points, dead forces, torques and stops of angles. Throws
/// InputError where there is anything else.
PlainMechanism plain(const Scene& scene);

/// The pose at scaled coordinates x.
PlainPose plain_pose(const StaticModel& model, const std::vector<double>& x);

/// The scaled coordinates of a pose.
std::vector<double> coordinates(const StaticModel& model, const PlainPose& pose);

}  // namespace poise::benchmarks
