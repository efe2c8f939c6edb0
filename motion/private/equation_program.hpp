#pragma once

#include <string>
#include <vector>

#include "model/recorded.hpp"
#include "motion/equations_of_motion.hpp"

namespace poise {

/// An array of numbers that a program computes from its inputs.
struct ProgramOutput {
  std::string name;
  std::vector<Recorded> values;
};

/// What the parts of an equation of motion are as functions without loops and branches: of inputs, which are the time
/// and arrays, outputs. Functions in pieces are choices between all of their pieces.
struct EquationProgram {
  struct Part {
    Recording recording;
    std::vector<std::string> inputs;  ///< in the order of their nodes: "t", then arrays of all coordinates
    std::vector<ProgramOutput> outputs;
  };
  Part closing;  ///< g, g_t and J of t, q
  Part forces;   ///< M, k, V_q, Q and b of t, q, v
};

/// Records them. Throws InputError where what is computed depends on a decision that is no function in pieces.
EquationProgram record_equations(const EquationsOfMotion& equations);

}  // namespace poise
