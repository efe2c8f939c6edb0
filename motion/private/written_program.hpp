#pragma once

#include <string>
#include <vector>

#include "motion/private/equation_program.hpp"

namespace poise {

/// How statements are written in a language.
enum class CodeLanguage { c, python };

/// The statements of a part: a constant for each value that its outputs need, then their entries, "J[3] = x17;". Those
/// that are zero are left out: the arrays are zero before. Every line is indented by `indent`.
std::string written_program(const EquationProgram::Part& part, CodeLanguage language, const std::string& indent);

/// A number with all its digits; infinities by their names in the language.
std::string written_number(double value, CodeLanguage language);

}  // namespace poise
