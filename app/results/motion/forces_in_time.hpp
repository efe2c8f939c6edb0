#pragma once

#include "app/result/result.hpp"
#include "motion/forces_in_time.hpp"

namespace poise::app {

/// All forces of a simulated motion: the largest of each, when, the work of drives or motors, internal loads of links
/// and where on their line; in JSON `forces`.
void add_forces_in_time(Group& group, const MotionModel& model, const ForceHistory& found);

/// Adds the forces at every time as columns of the record, whose rows are `rows`: those of an interrupted run are
/// filled up.
void add_force_columns(Table& table, const Scene& scene, const ForceHistory& found, std::size_t rows);

/// What is wrong with them, to follow what was simulated: ", but a and b cannot make this motion: ..."; empty where
/// nothing is.
std::string objection_to_forces(const MotionModel& model, const ForceHistory& found);

}  // namespace poise::app
