#pragma once

#include <string>
#include <vector>

#include "statics/model/static_model.hpp"

namespace poise::test {

// All equilibria by a program that knows nothing of Poise: PHCpack (J. Verschelde, "Algorithm 795: PHCpack", ACM
// Transactions on Mathematical Software 25, 1999), a separate process. It follows paths to all isolated complex
// solutions of polynomial equations, in doubles: strong evidence of a count, no proof.

/// Whether the program `phc` can be run.
bool has_phc();

/// The equations of a scene as polynomials.
struct Polynomials {
  std::vector<std::string> equations;  ///< left sides, zero is right, in the input format of phc
  std::string why_not;                 ///< half a sentence where the scene has none: "a spring acts on an angle"
};

/// In scaled units, with c_k = cos x_k, s_k = sin x_k of every coordinate, which must be an angle, the multipliers m_r
/// of the closures and, of every spring with free length g0, its length l and its tension t per length:
///   c_k^2 + s_k^2 = 1,  closures = 0,  dL/dx_k = 0,  l^2 = |d|^2,  t l = k (l - g0)
///   with L = V_load + sum k/2 |d|^2 (springs of free length zero) + sum t/2 |d|^2 (the others) + m . closures.
/// `assemblies`: the first two only.
Polynomials polynomials(const StaticModel& model, bool assemblies = false);

/// What phc finds.
struct PhcSolutions {
  bool ran = false;  ///< it was not stopped by the time allowed
  int complex = 0;   ///< isolated solutions, real ones included
  /// Scaled coordinates, in (-pi, pi], of the real ones whose springs have positive lengths.
  std::vector<std::vector<double>> real;
  double seconds = 0.0;
};

/// Runs phc in a folder of its own. Throws std::invalid_argument where the scene has no polynomials.
PhcSolutions solve_with_phc(const StaticModel& model, bool assemblies = false, int seconds = 60);

}  // namespace poise::test
