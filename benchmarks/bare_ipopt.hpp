#pragma once

#include <array>
#include <vector>

namespace poise::benchmarks {

/// Minimum energy by Ipopt, programmed for one problem alone: exact derivatives from the formulas below and the options
/// of solvers/ipopt.cpp, without Poise. The reference for Poise's energy method.
struct BareIpoptResult {
  bool solved = false;  ///< as Ipopt reports
  int iterations = 0;
  std::vector<double> angles;  ///< rad
};

/// Units of the numbers given to Ipopt, so that both programs use the same: its step lengths depend on them.
struct BareUnits {
  double length = 1.0;
  double force = 1.0;
};

/// The four-bar of hand_four_bar.hpp (in, lbf):  min over t of
///   V = -(l4 (50 s4 - 13.29/2 c4) + l6 50/2 s6 - l7 10/2 c7)
/// subject to its closure. Hessian of the Lagrangian: diagonal.
BareIpoptResult bare_ipopt_four_bar(const std::array<double, 3>& start, const BareUnits& units);

/// The hanging chain of hand_chain.hpp (m, N), its left and right half measured from their own ends:  min over t of
///   V = sum l w_i sin t_i,  w_i = (ceil(n/2) - i - 1/2) / n
/// subject to its closure. Hessian of the Lagrangian: diagonal.
BareIpoptResult bare_ipopt_chain(const std::vector<double>& start, const BareUnits& units);

}  // namespace poise::benchmarks
