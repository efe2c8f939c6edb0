#pragma once

// `poise design FILE`: the kinds of design files, each searched by a function of its own.

#include <cstdint>
#include <optional>
#include <string>

#include "app/commands/command.hpp"
#include "app/commands/options.hpp"
#include "solvers/nonlinear_program.hpp"

namespace poise::app {

struct DesignRequest {
  Request common;  ///< `scene` is the design file
  std::uint64_t seed = 1;
  std::optional<int> starts{};  ///< searches, at most
  int jobs = 0;                 ///< threads; 0: as many as there are cores
  int trade_off = 0;            ///< of goals: points of the trade-off of two aims
  solvers::ProgramMethod method = solvers::ProgramMethod::slsqp;
  std::string method_word = "slsqp";
};

/// Each reads its kind of design file, searches, writes what was asked for and returns the exit code.
int run_guidance(const DesignRequest& request, const Palette& palette);   ///< [goal]: a straight line and a level body
int run_synthesis(const DesignRequest& request, const Palette& palette);  ///< [synthesis]: linkages through points
int run_balance(const DesignRequest& request, const Palette& palette);    ///< [balance]: springs and counterweights
int run_goals(const DesignRequest& request, const Palette& palette);      ///< [[goal]]: any quantities
/// [synthesis] with kind = "path": a coupler point through points or along a curve.
int run_path_synthesis(const DesignRequest& request, const Palette& palette);

}  // namespace poise::app
