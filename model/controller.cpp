#include "model/laws/controller.hpp"

#include <algorithm>
#include <utility>

namespace poise {
namespace {

template <int... Id>
std::vector<Number> bare_numbers(std::integer_sequence<int, Id...>) {
  return {number_of_controller<Id>()...};
}

}  // namespace

namespace detail {

void set_number_of_controller(Controller& controller, int id, double value) {
  const auto at = [&](int k) { return controller.values[static_cast<std::size_t>(k)]; };
  const bool is_above = id == Controller::min && controller.has(Controller::max) && !(value < at(Controller::max));
  const bool is_below = id == Controller::max && controller.has(Controller::min) && !(value > at(Controller::min));
  if (is_above || is_below) throw InputError("expected min < max; set the other limit first, or exchange them");
  if (id == Controller::integral && controller.has(Controller::tracking_time) && value == 0.0) {
    throw InputError("expected an integral gain other than 0, which tracking_time is of");
  }
  if (controller.order > 0 && id == Controller::denominator + controller.order && value == 0.0) {
    throw InputError("expected another highest coefficient than 0; leave it out, or give its size");
  }
  controller.values[static_cast<std::size_t>(id)] = value;
}

}  // namespace detail

template <>
void ControllerOf<double>::declare(bool reads_angle) {
  const Dimension read = (reads_angle ? dimension::angle : dimension::length) * dimension::time.power(of_rate ? -1 : 0);
  std::vector<Number> each = bare_numbers(std::make_integer_sequence<int, count>{});
  const auto describe = [&](int id, std::string_view key, const Dimension& dimension, int effort_power,
                            Range range = Range::finite) {
    Number& number = each[static_cast<std::size_t>(id)];
    number.key = key;
    number.dimension = dimension;
    number.effort_power = effort_power;
    number.range = range;
  };
  const Dimension gain = read.power(-1);
  describe(proportional, "proportional", gain, 1);
  describe(integral, "integral", gain * dimension::time.power(-1), 1);
  describe(derivative, "derivative", gain * dimension::time, 1);
  describe(filter, "filter", dimension::time, 0, Range::positive);
  describe(reference, "reference", read, 0);
  describe(dead_band, "dead_band", read, 0, Range::not_negative);
  describe(min, "min", {}, 1);
  describe(max, "max", {}, 1);
  describe(tracking_time, "tracking_time", dimension::time, 0, Range::positive);
  constexpr std::array<std::string_view, 3> above{"numerator.0", "numerator.1", "numerator.2"};
  constexpr std::array<std::string_view, 3> below{"denominator.0", "denominator.1", "denominator.2"};
  for (int k = 0; k < 3; ++k) {
    const auto at = static_cast<std::size_t>(k);
    describe(numerator + k, above[at], gain * dimension::time.power(k), 1);
    describe(denominator + k, below[at], dimension::time.power(k), 0);
  }
  std::vector<Number> out;
  for (int id = 0; id < count; ++id) {
    if (has(id)) out.push_back(each[static_cast<std::size_t>(id)]);
  }
  all = std::make_shared<const std::vector<Number>>(std::move(out));
}

}  // namespace poise
