#pragma once

#include <cstddef>

#include <Eigen/Core>

#include "motion/inverse_dynamics.hpp"
#include "motion/motion_model.hpp"
#include "motion/reduced_motion.hpp"

namespace poise {

/// The conditions C w = 0 of blades on rates of the independent coordinates, without what drives move: a row for each
/// blade, where `motion` is placed.
Eigen::MatrixXd blade_conditions(const ReducedMotion<double>& motion);

/// The part of a row, f values, that no sum of rows of `conditions` gives.
Eigen::VectorXd left_by(const Eigen::MatrixXd& conditions, Eigen::VectorXd row);

/// Throws InputError where, at the pose that `motion` is placed in, the point of a blade cannot move across its edge
/// anyway, or the condition of a blade follows from those before it: then their forces are not determined. And for
/// friction that sticks, which may hold what blades hold.
void refuse_idle_blades(const MotionModel& model, const ReducedMotion<double>& motion);

/// Throws InputError where, after accelerate(), the rates of `motion` go across the edge of a blade.
void refuse_rates_across_blades(const MotionModel& model, const ReducedMotion<double>& motion);

/// The force of a blade of the scene among these forces, N: across its edge, to the left of it, on the body of its
/// point. NaN where it is not determined.
double blade_force(const Scene& scene, std::size_t blade, const Forces& forces);

}  // namespace poise
