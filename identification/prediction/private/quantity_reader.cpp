#include "identification/prediction/private/quantity_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace poise {
namespace {

/// The load or number of an element that follows a curve.
void take(const MotionInput& input, double t, Scene& scene) {
  const auto item = static_cast<std::size_t>(input.item);
  const double c = input.at(t, 0, std::numeric_limits<double>::quiet_NaN());
  switch (input.of) {
    case MotionInput::Of::torque:
      scene.torques[item].value = input.multiplies ? c * scene.torques[item].value : c;
      break;
    case MotionInput::Of::force: {
      Force& force = scene.forces[item];
      force.vector = c * (input.multiplies ? force.vector : force.unit_or_zero());
      break;
    }
    case MotionInput::Of::element:
      std::visit(
          [&](auto& law) {
            const Number& number = numbers_of_law(law)[static_cast<std::size_t>(input.number())];
            number.set(&law, input.multiplies ? c * number.get(&law).value() : c);
          },
          scene.elements[item].law);
      break;
    case MotionInput::Of::drive:
    case MotionInput::Of::frame:
      break;
  }
}

bool is_of(const MotionInput& input, const TimeFunction& function) {
  return input.of == function.of && input.item == function.item &&
         (input.of != MotionInput::Of::element || input.number() == function.part);
}

/// What f changes by its argument, from its values at h, -h, 2 h and -2 h.
double difference(const std::array<double, 4>& f, double h) { return (8 * (f[0] - f[1]) - (f[2] - f[3])) / (12 * h); }

constexpr std::array steps = {1.0, -1.0, 2.0, -2.0};

}  // namespace

QuantityReader::QuantityReader(std::shared_ptr<const MotionModel> model, SoughtQuantity of,
                               std::vector<MotionInput> inputs)
    : model_(std::move(model)),
      of_(std::move(of)),
      inputs_(std::move(inputs)),
      quantities_(std::make_unique<const MovingQuantities>(model_->scene(), *model_)) {}

double QuantityReader::read(double t, const MovingState& state) {
  const Scene& then = at(t);
  return quantities_->value(of_, forces_in_motion(then, *model_, state.x, state.v, state.a), then);
}

const Scene& QuantityReader::at(double t) {
  const Scene& scene = model_->scene();
  if (!is_timed()) return scene;
  if (then_ && then_at_ == t) return *then_;
  Scene written = scene;
  std::erase_if(written.time_functions, [&](const TimeFunction& function) {
    return std::any_of(inputs_.begin(), inputs_.end(),
                       [&](const MotionInput& input) { return is_of(input, function); });
  });
  for (const MotionInput& input : inputs_) take(input, t, written);
  then_ = at_time(std::move(written), t);
  then_at_ = t;
  return *then_;
}

VariedQuantity::VariedQuantity(QuantityReader here, std::vector<Number> numbers)
    : here_(std::move(here)), numbers_(std::move(numbers)) {}

double VariedQuantity::along(double t, const MovingState& state, const MovingState& change) {
  constexpr double step = 1e-4;  // of coordinates, and of the largest of rates and accelerations
  const auto largest = [](const std::vector<double>& values, double least) {
    for (const double value : values) least = std::max(least, std::abs(value));
    return least;
  };
  const double far = std::max({largest(change.x, 0.0), largest(change.v, 0.0) / largest(state.v, 1.0),
                               largest(change.a, 0.0) / largest(state.a, 1.0)});
  if (far == 0.0) return 0.0;
  const double h = step / far;
  std::array<double, 4> values{};
  MovingState there = state;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    for (std::size_t i = 0; i < state.x.size(); ++i) {
      there.x[i] = state.x[i] + steps[k] * h * change.x[i];
      there.v[i] = state.v[i] + steps[k] * h * change.v[i];
      there.a[i] = state.a[i] + steps[k] * h * change.a[i];
    }
    values[k] = here_.read(t, there);
  }
  return difference(values, h);
}

double VariedQuantity::by_time(double t, const MovingState& state, std::vector<double> jerk) {
  constexpr double step = 1e-5;  // s
  const double moving = along(t, state, {state.v, state.a, std::move(jerk)});
  if (!here_.is_timed()) return moving;
  std::array<double, 4> values{};
  for (std::size_t k = 0; k < steps.size(); ++k) values[k] = here_.read(t + steps[k] * step, state);
  return moving + difference(values, step);
}

double VariedQuantity::by_number(std::size_t i, double t, const MovingState& state) {
  Number& number = numbers_[i];
  std::array<double, 4> values{};
  for (std::size_t k = 0; k < values.size(); ++k) values[k] = number.moved[k].read(t, state);
  if (!number.one_sided) return difference(values, number.step);
  const double here = here_.read(t, state);
  return (-25 * here + 48 * values[0] - 36 * values[1] + 16 * values[2] - 3 * values[3]) / (12 * number.step);
}

}  // namespace poise
