#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "model/number.hpp"

namespace poise {

/// A motor that prescribes its measure as a function of time t, with unlimited force:
///   g(t) = start + rate t + acceleration t^2/2 + amplitude (sin(2 pi frequency t + phase) - sin(phase)).
/// rad or m. Statics leaves drives out.
struct Drive {
  std::string name;
  Measure on;
  std::optional<double> start;  ///< absent: the value in the assembled pose
  double rate = 0.0;
  double acceleration = 0.0;
  double amplitude = 0.0;
  double frequency = 0.0;  ///< Hz
  double phase = 0.0;      ///< rad
  int line = 0;

  /// g(t) - start, or its first or second derivative by time.
  template <class S>
  S moved(const S& t, int derivative) const {
    using std::cos;
    using std::sin;
    const S omega = 2 * std::numbers::pi * static_cast<S>(frequency);
    const S turn = omega * t + static_cast<S>(phase);
    if (derivative == 0) {
      return S(rate) * t + S(acceleration) * t * t / 2 + S(amplitude) * (sin(turn) - sin(static_cast<S>(phase)));
    }
    if (derivative == 1) return S(rate) + S(acceleration) * t + S(amplitude) * omega * cos(turn);
    return S(acceleration) - S(amplitude) * omega * omega * sin(turn);
  }

  /// The derivative of moved(t, derivative) + start by numbers[number].
  template <class S>
  S moved_by(int number, const S& t, int derivative) const {
    using std::cos;
    using std::sin;
    const S two_pi = 2 * static_cast<S>(std::numbers::pi);
    const S omega = two_pi * static_cast<S>(frequency);
    const S turn = omega * t + static_cast<S>(phase);
    const S a(amplitude);
    switch (number) {
      case 0:
        return derivative == 0 ? S(1) : S(0);
      case 1:
        return derivative == 0 ? t : derivative == 1 ? S(1) : S(0);
      case 2:
        return derivative == 0 ? t * t / 2 : derivative == 1 ? t : S(1);
      case 3:
        return derivative == 0   ? sin(turn) - sin(static_cast<S>(phase))
               : derivative == 1 ? omega * cos(turn)
                                 : -omega * omega * sin(turn);
      case 4:
        return two_pi * a *
               (derivative == 0   ? t * cos(turn)
                : derivative == 1 ? cos(turn) - omega * t * sin(turn)
                                  : -omega * (2 * sin(turn) + omega * t * cos(turn)));
      default:
        return a * (derivative == 0   ? cos(turn) - cos(static_cast<S>(phase))
                    : derivative == 1 ? -omega * sin(turn)
                                      : -omega * omega * cos(turn));
    }
  }

  static const std::array<Number, 6> numbers;
};

inline constexpr std::array<Number, 6> Drive::numbers = [] {
  const auto of_measure = [](Number number) {
    number.measure_power = 1;
    return number;
  };
  Number at_start = of_measure(optional_number<&Drive::start>("start", {}));
  at_start.range_of_measure = true;
  return std::array{at_start,
                    of_measure(plain_number<&Drive::rate>("rate", dimension::time.power(-1))),
                    of_measure(plain_number<&Drive::acceleration>("acceleration", dimension::time.power(-2))),
                    of_measure(plain_number<&Drive::amplitude>("amplitude", {})),
                    plain_number<&Drive::frequency>("frequency", dimension::time.power(-1), Range::not_negative),
                    plain_number<&Drive::phase>("phase", dimension::angle)};
}();

}  // namespace poise
