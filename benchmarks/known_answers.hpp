#pragma once

#include <vector>

namespace poise::benchmarks {

/// A time counts only if its answer is right. Reference values for the thesis four-bar and the toggle clamp from their
/// files in datasets/, for the hanging chain from the references (static.hanging_chain_span06), all known to more
/// digits than a double holds.

inline constexpr double virtual_work_error = 1e-12;  ///< limit for virtual work, rad or m or N
inline constexpr double energy_error = 1e-9;         ///< limit for the energy method

/// Largest error of the angles of links 4, 6, 7 against the equilibrium nearest the printed pose, rad.
double four_bar_error(const double* angles);

/// Largest error of the angles of handle, link and arm of datasets/toggle_clamp.toml against the clamp closed on its
/// stop, rad.
double toggle_clamp_error(const double* angles);

/// Its clamping force there, N.
inline constexpr double toggle_clamp_force = 724.53765593476838031;

/// Error of a hanging chain given by the angles of its links, rad: the largest of the errors of its sag, m, of its
/// horizontal pull, N, read off the balance of the first link as (1 - 1/n) / (2 tan |t_0|), and of its closure, m.
/// The references know n = 10, 100, ... 100000; any other n throws std::invalid_argument.
double chain_error(const std::vector<double>& angles);

}  // namespace poise::benchmarks
