#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/draw/chart/plot.hpp"
#include "app/json.hpp"
#include "app/quantity.hpp"
#include "motion/courses.hpp"
#include "motion/kinematics.hpp"

namespace poise::app {

// What `poise kinematics` writes. All values in the units of the scene, rates per second.

/// Columns: drive.NAME of each drive; NAME, NAME.rate, NAME.second of all courses; closeness_to_singular.
std::string kinematics_csv(const Scene& scene, const KinematicsResult& result, const std::vector<DriveRange>& ranges);

/// {name, limit: "min" or "max", value} of the stop at which a range ends, or null.
Json json_stop(const std::optional<MetStop>& stop, const Scene& scene);

/// What an axis says of it: `, up to the stop "cowl"`, or nothing.
std::string up_to_stop(const std::optional<MetStop>& stop, const Scene& scene);

/// A JSON object: poise, scene {file, title, source, set}, units {...}, complete, why, stop (as json_stop: it is met in
/// the last sample), drives [{name, from, to}], samples [{drive {name: value}, angles, lengths {name: [value, rate,
/// second]}, points {body.point: {position, velocity, acceleration: [x, y]}}, closeness_to_singular}], singular [{kind,
/// before_range, drive {name: value}, text}].
std::string kinematics_json(const Scene& scene, const KinematicsResult& result, const std::vector<DriveRange>& ranges,
                            const std::vector<std::string>& settings);

/// Values, rates and second derivatives of angles and of lengths over the first drive.
std::vector<Panel> kinematics_panels(const Scene& scene, const KinematicsResult& result,
                                     const std::vector<DriveRange>& ranges);

}  // namespace poise::app
