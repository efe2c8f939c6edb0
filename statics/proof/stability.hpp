#pragma once

#include <string>

namespace poise {

/// Stability of an equilibrium by the inertia of its reduced Hessian (Morse index).
enum class Stability { unknown, stable, unstable, neutral };

/// "stable", "unstable", ...
std::string to_string(Stability stability);

}  // namespace poise
