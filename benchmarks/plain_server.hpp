#pragma once

#include <cstdio>
#include <functional>
#include <memory>
#include <string>

#include "benchmarks/plain_mechanism.hpp"

namespace poise::benchmarks {

using MakePlainSolver = std::function<std::unique_ptr<PlainSolver>(const PlainMechanism&)>;

/// Answers on `out` what external_solver.hpp asks on the standard input, until that ends. `methods` are their names,
/// NAME|NAME|..., in the order in which the solver counts them; mechanisms are in the scene's scaled units.
void serve_plain(std::FILE* out, const std::string& methods, const MakePlainSolver& make);

}  // namespace poise::benchmarks
