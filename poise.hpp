#pragma once

// All of Poise in one header: link poise::poise and write #include <poise/poise.hpp>. docs/library.md shows its use;
// the headers named here have the details.

// Scenes, from files and in code
#include "model/joint_friction.hpp"
#include "model/scene.hpp"
#include "model/scene_builder.hpp"

// Statics: equilibria, their stability and forces, and how they change with a number of the scene
#include "statics/all_equilibria/all_equilibria.hpp"
#include "statics/equilibrium/named_equilibrium.hpp"
#include "statics/model/mobility.hpp"
#include "statics/paths/path_measures.hpp"

// Motion: kinematics, inverse dynamics, free motion, small oscillations, synthesis
#include "motion/design.hpp"
#include "motion/inverse_dynamics.hpp"
#include "motion/kinematics.hpp"
#include "motion/modes.hpp"
#include "motion/simulate.hpp"

// Identification: parameters from measured or simulated motion, how well they are known, models compared, runs planned
#include "identification/assessment/bootstrap.hpp"
#include "identification/assessment/compare_models.hpp"
#include "identification/assessment/identify.hpp"
#include "identification/assessment/input_readings.hpp"
#include "identification/assessment/known_numbers.hpp"
#include "identification/assessment/monte_carlo.hpp"
#include "identification/assessment/plan.hpp"
#include "identification/assessment/profile.hpp"
#include "identification/assessment/validation.hpp"
#include "identification/experiment/experiment.hpp"
#include "identification/fit/fit.hpp"
