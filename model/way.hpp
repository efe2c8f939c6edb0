#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <string_view>

namespace poise {

/// How a value goes from one to another within a time: P(s) from P(0) = 0 to P(1) = 1.
///   linear          s
///   cubic           3 s^2 - 2 s^3, without rate at both ends
///   polynomial_345  10 s^3 - 15 s^4 + 6 s^5, without rate and acceleration there
///   trapezoidal     constant acceleration in the first third, constant rate 3/2, constant deceleration in the last
///   s_curve         the same rates at 0, 1/3, 2/3 and 1, with an acceleration that rises and falls linearly between
enum class Way { linear, polynomial_345, cubic, trapezoidal, s_curve };

/// Their words in scene files, in this order.
inline constexpr std::array<std::string_view, 5> way_words{"linear", "polynomial_345", "cubic", "trapezoidal",
                                                           "s_curve"};

/// How many derivatives by time are continuous where it begins and ends, and between: 0, 1 or 2.
constexpr int smoothness_of(Way way) {
  return way == Way::linear ? 0 : way == Way::cubic || way == Way::trapezoidal ? 1 : 2;
}

/// Places s between 0 and 1 at which formulas meet.
inline std::span<const double> meetings_of(Way way) {
  static constexpr std::array<double, 4> all{1.0 / 6, 1.0 / 3, 2.0 / 3, 5.0 / 6};
  if (way == Way::trapezoidal) return std::span(all).subspan(1, 2);
  return way == Way::s_curve ? std::span(all) : std::span<const double>();
}

/// P(s), or one of its first three derivatives by s, with the formula that holds at `near`.
template <class S>
S along_way(Way way, const S& s, int derivative, double near) {
  const auto one_of = [&](const S& value, const S& first, const S& second, double third) {
    return derivative == 0 ? value : derivative == 1 ? first : derivative == 2 ? second : S(third);
  };
  switch (way) {
    case Way::linear:
      return one_of(s, S(1), S(0), 0.0);
    case Way::cubic:
      return one_of(s * s * (S(3) - S(2) * s), S(6) * s * (S(1) - s), S(6) - S(12) * s, -12.0);
    case Way::polynomial_345:
      if (derivative == 3) return S(60) * (S(1) + s * (S(-6) + S(6) * s));
      return one_of(s * s * s * (S(10) + s * (S(-15) + S(6) * s)), S(30) * s * s * (S(1) - s) * (S(1) - s),
                    S(60) * s * (S(1) + s * (S(-3) + S(2) * s)), 0.0);
    default:
      break;
  }
  constexpr double third = 1.0 / 3, fastest = 1.5;
  // The last third is the first one backwards: P(s) = 1 - P(1 - s).
  if (near >= 1.0 - third) {
    const S mirrored = along_way(way, S(S(1) - s), derivative, std::min(1.0 - near, third * (1.0 - 1e-15)));
    return derivative == 0 ? S(S(1) - mirrored) : derivative == 2 ? S(-mirrored) : mirrored;
  }
  if (near >= third) return one_of(S(fastest) * (s - S(third / 2)), S(fastest), S(0), 0.0);
  if (way == Way::trapezoidal) {
    const double a = fastest / third;
    return one_of(S(a / 2) * s * s, S(a) * s, S(a), 0.0);
  }
  const double jerk = 4.0 * fastest / (third * third);
  if (near < third / 2) return one_of(S(jerk / 6) * s * s * s, S(jerk / 2) * s * s, S(jerk) * s, jerk);
  const S left = S(third) - s;
  return one_of(S(fastest) * (s - S(third / 2)) + S(jerk / 6) * left * left * left,
                S(fastest) - S(jerk / 2) * left * left, S(jerk) * left, -jerk);
}

}  // namespace poise
