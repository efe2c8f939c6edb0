// Simbody as an external solver; external_solver.hpp has the lines it is asked and answers. A program of its own,
// because Simbody's library brings an old Ipopt along whose names are those of ours.

#include <cstdio>

#include <unistd.h>

#include "benchmarks/plain_server.hpp"
#include "benchmarks/simbody_solver.hpp"

int main() {
  // Simbody's Ipopt talks to the standard output, which is taken.
  std::FILE* out = fdopen(dup(STDOUT_FILENO), "w");
  if (out == nullptr || std::freopen("/dev/null", "w", stdout) == nullptr) return 1;
  poise::benchmarks::serve_plain(out, "LocalEnergyMinimizer|Optimizer, exact Jacobian",
                                 poise::benchmarks::simbody_solver);
}
