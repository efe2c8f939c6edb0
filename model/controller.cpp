#include "model/laws/controller.hpp"

#include <algorithm>
#include <utility>

namespace poise {
namespace {

template <int... Id>
std::vector<Number> bare_numbers(std::integer_sequence<int, Id...>) {
  return {number_of_controller<Id>()...};
}

constexpr auto keys_of_points = indexed_keys<Controller::most_points>("table");

/// The value at a point of the table, without its dimension.
template <std::size_t Point>
constexpr Number number_of_point() {
  Number number{keys_of_points[Point].view(), {}, Range::finite};
  number.get = [](const void* item) {
    return std::optional<double>(static_cast<const Controller*>(item)->curve->forces()[Point]);
  };
  number.set = [](void* item, double value) { static_cast<Controller*>(item)->set_point(Point, value); };
  number.scale = [](void*, double) {};  // by Controller::rescale, with the whole curve
  return number;
}

constexpr auto numbers_of_points_of_curve = []<std::size_t... Point>(std::index_sequence<Point...>) {
  return std::array{number_of_point<Point>()...};
}
(std::make_index_sequence<Controller::most_points>());

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
void ControllerOf<double>::declare(const Dimension& read, bool acts, const Dimension& output) {
  const Dimension given_by_it = acts ? dimension::none : output;
  std::vector<Number> each = bare_numbers(std::make_integer_sequence<int, count>{});
  const auto describe = [&](int id, std::string_view key, const Dimension& dimension, bool is_of_output,
                            Range range = Range::finite) {
    Number& number = each[static_cast<std::size_t>(id)];
    number.key = key;
    number.dimension = is_of_output ? given_by_it * dimension : dimension;
    number.effort_power = is_of_output && acts ? 1 : 0;
    number.range = range;
  };
  const Dimension gain = read.power(-1);
  describe(proportional, "proportional", gain, true);
  describe(integral, "integral", gain * dimension::time.power(-1), true);
  describe(derivative, "derivative", gain * dimension::time, true);
  describe(filter, "filter", dimension::time, false, Range::positive);
  describe(reference, "reference", read, false);
  describe(dead_band, "dead_band", read, false, Range::not_negative);
  describe(min, "min", {}, true);
  describe(max, "max", {}, true);
  describe(tracking_time, "tracking_time", dimension::time, false, Range::positive);
  describe(period, "period", dimension::time, false, Range::positive);
  describe(delay, "delay", dimension::time, false, Range::positive);
  constexpr std::array<std::string_view, 3> above{"numerator.0", "numerator.1", "numerator.2"};
  constexpr std::array<std::string_view, 3> below{"denominator.0", "denominator.1", "denominator.2"};
  for (int k = 0; k < 3; ++k) {
    const auto at = static_cast<std::size_t>(k);
    describe(numerator + k, above[at], gain * dimension::time.power(k), true);
    describe(denominator + k, below[at], dimension::time.power(k), false);
  }
  std::vector<Number> out;
  for (int id = 0; id < count; ++id) {
    if (has(id)) out.push_back(each[static_cast<std::size_t>(id)]);
  }
  for (std::size_t k = 0; k < numbers_of_points(); ++k) {
    out.push_back(numbers_of_points_of_curve[k]);
    out.back().dimension = given_by_it;
    out.back().effort_power = acts ? 1 : 0;
  }
  all = std::make_shared<const std::vector<Number>>(std::move(out));
}

}  // namespace poise
