#include "statics/quantities/quantity_value.hpp"

#include <fmt/format.h>

namespace poise {

std::string why_undefined(const SoughtQuantity& of, const NumberedEquations& equations, const std::vector<double>& z,
                          int driven) {
  using Kind = SoughtQuantity::Kind;
  for (const SoughtQuantity& part : of.of) {
    if (of.kind == Kind::ratio) break;
    if (std::string why = why_undefined(part, equations, z, driven); !why.empty()) return why;
  }
  if (of.kind == Kind::load_at_fold) return "a load at a fold belongs to a path, not to a position";
  std::vector<NumberedEquations::Placed<double>> placed;
  equations.place(z.data(), placed);
  const NumberedEquations::Bodies<double> bodies = equations.bodies(equations.numbers().data(), placed);
  const auto norm_of = [](const std::vector<double>& vector) {
    double sum = 0.0;
    for (const double one : vector) sum += one * one;
    return std::sqrt(sum);
  };
  if (of.kind == Kind::push || of.kind == Kind::ratio) {
    const OneMotion<double> motion = one_motion(equations, bodies, placed, driven);
    if (motion.freedoms == 0) return "nothing can move";
    if (motion.freedoms > 1) return fmt::format("it can move in {} ways; expected one that is driven", motion.freedoms);
    std::vector<double> gradient;
    if (of.kind == Kind::ratio) {
      gradient = equations.measure_gradient(of.of[1].on, bodies, placed);
    } else {
      gradient = equations.measure_gradient(Measure::x_of(of.point), bodies, placed);
      const std::vector<double> along_y = equations.measure_gradient(Measure::y_of(of.point), bodies, placed);
      for (std::size_t i = 0; i < gradient.size(); ++i) {
        gradient[i] = of.direction.x * gradient[i] + of.direction.y * along_y[i];
      }
    }
    double rate = 0.0;
    for (std::size_t i = 0; i < gradient.size(); ++i) rate += gradient[i] * motion.rates[i];
    constexpr double still = 1e-12;
    if (std::abs(rate) <= still * norm_of(gradient) * norm_of(motion.rates)) {
      return of.kind == Kind::ratio ? of.of[1].name + " stands still here"
                                    : "the point does not move along that direction here";
    }
  }
  const double value = QuantityPlace<double>(equations, equations.numbers().data(), z.data(), driven).value(of);
  return std::isfinite(value) ? "" : "it is divided by zero here";
}

}  // namespace poise
