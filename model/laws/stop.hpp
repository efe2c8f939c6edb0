#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>

#include "model/input_error.hpp"
#include "model/number.hpp"

namespace poise {

/// A stop keeps min <= g <= max of the measure g: rad or m. An absent limit is infinite.
struct Stop {
  std::string name;
  Measure on;
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  int line = 0;

  static const std::array<Number, 2> numbers;

 private:
  template <bool is_max>
  static constexpr Number limit(std::string_view key) {
    Number number{key, {}, Range::finite};
    number.measure_power = 1;
    number.range_of_measure = true;
    number.get = [](const void* item) {
      const Stop& stop = *static_cast<const Stop*>(item);
      return std::optional<double>(is_max ? stop.max : stop.min);
    };
    number.set = [](void* item, double value) {
      Stop& stop = *static_cast<Stop*>(item);
      const double lower = is_max ? stop.min : value;
      const double upper = is_max ? value : stop.max;
      if (!(lower <= upper)) throw InputError("expected min <= max; set the other limit first");
      stop.min = lower;
      stop.max = upper;
    };
    number.scale = [](void* item, double factor) {
      Stop& stop = *static_cast<Stop*>(item);
      (is_max ? stop.max : stop.min) *= factor;
    };
    return number;
  }
};

inline constexpr std::array<Number, 2> Stop::numbers{limit<false>("min"), limit<true>("max")};

}  // namespace poise
