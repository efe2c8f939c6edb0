#pragma once

#include <array>

#include "benchmarks/bare_ipopt.hpp"
#include "statics/model/static_model.hpp"

namespace poise::benchmarks {

/// datasets/thesis_four_bar.toml.
Scene thesis_four_bar();

/// Start of the compiled thesis four-bar: angles of links 4, 6, 7, rad.
std::array<double, 3> four_bar_start(const StaticModel& model);

/// The units of the compiled model, in in and lbf, as the bare program for the four-bar wants them.
BareUnits four_bar_units(const StaticModel& model);

/// The units of a compiled hanging chain, in m and N.
BareUnits chain_units(const StaticModel& model);

}  // namespace poise::benchmarks
