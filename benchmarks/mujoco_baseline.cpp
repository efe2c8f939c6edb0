// MuJoCo as an external solver; external_solver.hpp has the lines it is asked and answers. A program of its own,
// because MuJoCo ends the process where something is wrong.

#include <cstdio>

#include "benchmarks/mujoco_solver.hpp"
#include "benchmarks/plain_server.hpp"

int main() {
  poise::benchmarks::serve_plain(stdout, "mj_step until at rest|Newton on mj_forward",
                                 poise::benchmarks::mujoco_solver);
}
