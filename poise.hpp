#pragma once

// All of Poise in one header: link poise::poise and write #include <poise/poise.hpp>. docs/library.md shows its use;
// the headers named here have the details.

// Scenes, from files and in code
#include "model/joint_friction.hpp"
#include "model/named_measures.hpp"
#include "model/scene.hpp"
#include "model/scene_builder.hpp"

// Statics: equilibria, their stability and forces, what friction holds, and how they change with numbers of the scene
#include "statics/all_equilibria/all_equilibria.hpp"
#include "statics/equilibrium/link_loads.hpp"
#include "statics/equilibrium/named_equilibrium.hpp"
#include "statics/equilibrium/settle.hpp"
#include "statics/friction/held.hpp"
#include "statics/inverse/find_numbers.hpp"
#include "statics/many/solve_many.hpp"
#include "statics/model/mobility.hpp"
#include "statics/paths/fold_curve.hpp"
#include "statics/paths/loads_along.hpp"
#include "statics/paths/over_path.hpp"
#include "statics/paths/path_measures.hpp"
#include "statics/proof/certificate.hpp"
#include "statics/proof/enclosed_values.hpp"
#include "statics/quantities/quantities_at.hpp"
#include "statics/sensitivity/fitted_numbers.hpp"
#include "statics/sensitivity/sensitivity.hpp"
#include "statics/sensitivity/tolerance.hpp"
#include "statics/tracking/tracked_equilibrium.hpp"

// Motion: kinematics, inverse dynamics, free motion, small oscillations, synthesis
#include "motion/design.hpp"
#include "motion/driven_quantities.hpp"
#include "motion/dynamic_stability.hpp"
#include "motion/equation_code.hpp"
#include "motion/equations_of_motion.hpp"
#include "motion/fluctuation.hpp"
#include "motion/force_courses.hpp"
#include "motion/forces_along.hpp"
#include "motion/given_motion.hpp"
#include "motion/inverse_dynamics.hpp"
#include "motion/kinematics.hpp"
#include "motion/loads_in_motion.hpp"
#include "motion/modes.hpp"
#include "motion/periodic_response.hpp"
#include "motion/quantities_along.hpp"
#include "motion/release.hpp"
#include "motion/response.hpp"
#include "motion/simulate.hpp"

// Design: numbers of a scene for which quantities keep limits
#include "design/goals/design_kind.hpp"
#include "design/goals/design_search.hpp"

// Identification: parameters from measured or simulated motion, how well they are known, models compared, runs planned
#include "identification/assessment/bootstrap.hpp"
#include "identification/assessment/carried_numbers.hpp"
#include "identification/assessment/compare_models.hpp"
#include "identification/assessment/identify.hpp"
#include "identification/assessment/input_readings.hpp"
#include "identification/assessment/known_numbers.hpp"
#include "identification/assessment/monte_carlo.hpp"
#include "identification/assessment/plan.hpp"
#include "identification/assessment/profile.hpp"
#include "identification/assessment/validation.hpp"
#include "identification/experiment/experiment.hpp"
#include "identification/experiment/experiment_text.hpp"
#include "identification/fit/fit.hpp"

// Files of other programs
#include "exchange/formats.hpp"
