#include "motion/private/written_program.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>

#include <fmt/format.h>

namespace poise {
namespace {

using Nodes = std::vector<Recording::Node>;

/// What the outputs depend on.
std::vector<char> needed_nodes(const EquationProgram::Part& part) {
  const Nodes& nodes = part.recording.nodes();
  std::vector<char> needed(nodes.size(), 0);
  for (const ProgramOutput& output : part.outputs) {
    for (const Recorded& value : output.values) {
      if (!value.is_known()) needed[static_cast<std::size_t>(value.node())] = 1;
    }
  }
  for (std::size_t k = nodes.size(); k-- > 0;) {
    if (needed[k] == 0) continue;
    for (const int of : nodes[k].of) {
      if (of >= 0) needed[static_cast<std::size_t>(of)] = 1;
    }
  }
  return needed;
}

/// This is how an operation on a, b and c is written in either language.
struct Spelling {
  const char* c;
  const char* python;
};

Spelling spelling_of(LaneOp op) {
  switch (op) {
    case LaneOp::add:
      return {"{0} + {1}", "{0} + {1}"};
    case LaneOp::subtract:
      return {"{0} - {1}", "{0} - {1}"};
    case LaneOp::multiply:
      return {"{0} * {1}", "{0} * {1}"};
    case LaneOp::divide:
      return {"{0} / {1}", "{0} / {1}"};
    case LaneOp::negate:
      return {"-{0}", "-{0}"};
    case LaneOp::square_root:
      return {"sqrt({0})", "np.sqrt({0})"};
    case LaneOp::absolute:
      return {"fabs({0})", "np.abs({0})"};
    case LaneOp::floor:
      return {"floor({0})", "np.floor({0})"};
    case LaneOp::least:
      return {"{1} < {0} ? {1} : {0}", "{1} if {1} < {0} else {0}"};
    case LaneOp::greatest:
      return {"{0} < {1} ? {1} : {0}", "{1} if {0} < {1} else {0}"};
    case LaneOp::sine:
      return {"sin({0})", "np.sin({0})"};
    case LaneOp::cosine:
      return {"cos({0})", "np.cos({0})"};
    case LaneOp::tangent:
      return {"tan({0})", "np.tan({0})"};
    case LaneOp::arc_tangent:
      return {"atan({0})", "np.arctan({0})"};
    case LaneOp::arc_tangent_of:
      return {"atan2({0}, {1})", "np.arctan2({0}, {1})"};
    case LaneOp::exponential:
      return {"exp({0})", "np.exp({0})"};
    case LaneOp::exponential_less_one:
      return {"expm1({0})", "np.expm1({0})"};
    case LaneOp::logarithm:
      return {"log({0})", "np.log({0})"};
    case LaneOp::logarithm_of_more:
      return {"log1p({0})", "np.log1p({0})"};
    case LaneOp::power:
      return {"pow({0}, {1})", "np.power({0}, {1})"};
    case LaneOp::hyperbolic_sine:
      return {"sinh({0})", "np.sinh({0})"};
    case LaneOp::hyperbolic_cosine:
      return {"cosh({0})", "np.cosh({0})"};
    case LaneOp::hyperbolic_tangent:
      return {"tanh({0})", "np.tanh({0})"};
    case LaneOp::less:
      return {"{0} < {1}", "{0} < {1}"};
    case LaneOp::less_or_equal:
      return {"{0} <= {1}", "{0} <= {1}"};
    case LaneOp::equal:
      return {"{0} == {1}", "{0} == {1}"};
    case LaneOp::both:
      return {"{0} && {1}", "{0} and {1}"};
    case LaneOp::either:
      return {"{0} || {1}", "{0} or {1}"};
    case LaneOp::opposite:
      return {"!{0}", "not {0}"};
    case LaneOp::choice:
      return {"{0} ? {1} : {2}", "{1} if {0} else {2}"};
    case LaneOp::constant:
    case LaneOp::input:
    case LaneOp::multiply_add:
    case LaneOp::multiply_subtract:
    case LaneOp::subtract_product:
    case LaneOp::sine_and_cosine:
      break;
  }
  throw std::logic_error("no operation that is recorded");
}

bool is_mask(LaneOp op) {
  switch (op) {
    case LaneOp::less:
    case LaneOp::less_or_equal:
    case LaneOp::equal:
    case LaneOp::both:
    case LaneOp::either:
    case LaneOp::opposite:
      return true;
    default:
      return false;
  }
}

}  // namespace

std::string written_number(double value, CodeLanguage language) {
  if (std::isinf(value)) {
    const char* const infinity = language == CodeLanguage::c ? "HUGE_VAL" : "np.inf";
    return fmt::format("{}{}", value < 0 ? "-" : "", infinity);
  }
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

std::string written_program(const EquationProgram::Part& part, CodeLanguage language, const std::string& indent) {
  const Nodes& nodes = part.recording.nodes();
  const std::vector<char> needed = needed_nodes(part);
  const bool is_c = language == CodeLanguage::c;
  const char* const end = is_c ? ";\n" : "\n";
  std::vector<std::string> names(nodes.size());
  std::size_t inputs = 0;
  int numbers = 0;
  std::string text;
  // The first input is a number, and each of the others an array of all coordinates.
  std::size_t coordinates = 0;
  for (const Recording::Node& node : nodes) coordinates += node.op == LaneOp::input ? 1U : 0U;
  coordinates = (coordinates - 1) / (part.inputs.size() - 1);
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const Recording::Node& node = nodes[k];
    if (node.op == LaneOp::input) {
      names[k] = inputs == 0
                     ? part.inputs[0]
                     : fmt::format("{}[{}]", part.inputs[1 + (inputs - 1) / coordinates], (inputs - 1) % coordinates);
      ++inputs;
      continue;
    }
    if (needed[k] == 0) continue;
    if (node.op == LaneOp::constant) {
      names[k] = written_number(node.value, language);
      continue;
    }
    const auto operand = [&](int of) { return of >= 0 ? names[static_cast<std::size_t>(of)] : std::string(); };
    const Spelling spelling = spelling_of(node.op);
    names[k] = fmt::format("x{}", ++numbers);
    const char* const type = !is_c ? "" : is_mask(node.op) ? "const int " : "const double ";
    text += fmt::format("{}{}{} = {}{}", indent, type, names[k],
                        fmt::format(fmt::runtime(is_c ? spelling.c : spelling.python), operand(node.of[0]),
                                    operand(node.of[1]), operand(node.of[2])),
                        end);
  }
  for (const ProgramOutput& output : part.outputs) {
    for (std::size_t i = 0; i < output.values.size(); ++i) {
      const Recorded& value = output.values[i];
      if (value.is_known() && value.value() == 0.0) continue;
      text += fmt::format(
          "{}{}[{}] = {}{}", indent, output.name, i,
          value.is_known() ? written_number(value.value(), language) : names[static_cast<std::size_t>(value.node())],
          end);
    }
  }
  return text;
}

}  // namespace poise
