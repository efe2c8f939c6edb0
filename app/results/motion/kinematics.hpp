#pragma once

#include <string>
#include <vector>

#include "app/result/result.hpp"
#include "motion/courses.hpp"
#include "statics/quantities/quantity.hpp"

namespace poise::app {

/// What `poise kinematics` was asked to show beside the driven quantities.
struct KinematicsView {
  std::vector<std::string> points{};   ///< "coupler.P"
  bool all = false;                    ///< every angle and slide too
  std::vector<SoughtQuantity> show{};  ///< with the loads and the drives at rest
};

/// What `poise kinematics` shows: the driven quantities, the points asked for, singular poses; every angle, slide and
/// point in JSON and CSV, docs/json.md. `rate`, SI, is that of the first drive that moves. Throws InputError where a
/// point is none of a moving body.
Result kinematics_result(const Scene& scene, const KinematicsResult& found, const std::vector<DriveRange>& ranges,
                         double rate, const KinematicsView& view, const std::vector<std::string>& settings);

/// What drives are: "upper: angle of upper in the world".
std::vector<std::string> drives_in_words(const Scene& scene, const std::vector<std::string>& names);

/// {name, limit: "min" or "max", value} of the stop at which a range ends, or null.
void add_met_stop(Group& group, const std::optional<MetStop>& stop, const Scene& scene);

}  // namespace poise::app
