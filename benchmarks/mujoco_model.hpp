#pragma once

#include <string>

#include <mujoco/mujoco.h>

namespace poise::benchmarks {

/// MuJoCo's bound on the impedance of constraints.
constexpr double stiffest_impedance = 0.9999;

/// A model made from MJCF text, to be deleted by mj_deleteModel(). Throws std::invalid_argument where MuJoCo refuses
/// it.
mjModel* mujoco_model(const std::string& mjcf);

}  // namespace poise::benchmarks
