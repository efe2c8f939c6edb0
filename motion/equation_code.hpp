#pragma once

#include <string>
#include <string_view>

#include "motion/equations_of_motion.hpp"

namespace poise {

/// The equation as C99 and as Python: functions that close the loops, and give D, h, c, Q and z'' in SI units. What the
/// C code needs is <math.h>, what the Python code needs is NumPy; neither allocates or keeps anything between calls
/// (the Python code but for its arrays). docs/equations.md has their interface, which heads the text too.
/// Throws InputError as record_equations().
std::string c_code(const EquationsOfMotion& equations);
std::string python_code(const EquationsOfMotion& equations);

/// What the names of the functions in C begin with: the name of the scene's file without its ending, with _ in place of
/// what no name in C may have.
std::string name_in_code(std::string_view file);

}  // namespace poise
