#pragma once

#include "app/result/result.hpp"
#include "motion/simulate.hpp"

namespace poise::app {

/// The events at stops of a motion: in text those that come first, in JSON all.
void add_contact_events(Group& group, const MotionModel& model, const Motion& motion);

/// All of them, one row each, with the keys of the JSON.
Table table_of_contact_events(const MotionModel& model, const Motion& motion);

/// Says from where on a motion is one of several that contacts allow.
void warn_of_contacts(Result& out, const Scene& scene, const Motion& motion);

}  // namespace poise::app
