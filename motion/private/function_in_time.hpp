#pragma once

// A function of time in any scalar: what equations written for other programs contain of it (equation_program.hpp).

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <type_traits>
#include <variant>
#include <vector>

#include "model/expression.hpp"
#include "model/expression_value.hpp"
#include "model/input_error.hpp"
#include "model/select.hpp"
#include "model/time_function.hpp"

namespace poise {

template <class T>
T in_time(const SineInTime& sine, const T& t, int derivative) {
  using std::cos;
  using std::sin;
  const T omega(2 * std::numbers::pi * sine.frequency);
  const T turn = omega * t + T(sine.phase);
  const T amplitude(sine.amplitude);
  if (derivative == 0) return T(sine.offset) + amplitude * sin(turn);
  return derivative == 1 ? amplitude * omega * cos(turn) : -(amplitude * omega * omega * sin(turn));
}

/// P(s) of a way, or one of its derivatives by s: a choice between all formulas of it.
template <class T>
T whole_way(Way way, const T& s, int derivative) {
  const std::span<const double> meetings = meetings_of(way);
  T out = along_way(way, s, derivative, 1.0);
  for (std::size_t k = meetings.size(); k-- > 0;) {
    const double before = k > 0 ? meetings[k - 1] : 0.0;
    out = select(s < T(meetings[k]), along_way(way, s, derivative, (before + meetings[k]) / 2), out);
  }
  return out;
}

/// A break belongs to the formula behind it.
template <class T>
T in_time(const RampInTime& ramp, const T& t, int derivative) {
  const double takes = ramp.end - ramp.start;
  const T s = (t - T(ramp.start)) / T(takes);
  const T way = T(ramp.to - ramp.from) * whole_way(ramp.way, s, derivative);
  const T between = derivative == 0 ? T(ramp.from) + way : derivative == 1 ? way / T(takes) : way / T(takes * takes);
  const T before(derivative == 0 ? ramp.from : 0.0), after(derivative == 0 ? ramp.to : 0.0);
  return select(t < T(ramp.start), before, select(t >= T(ramp.end), after, between));
}

template <class T>
T in_time(const StepInTime& step, const T& t, int derivative) {
  return derivative > 0 ? T(0) : select(t < T(step.at), T(step.from), T(step.to));
}

template <class T>
T in_time(const TableInTime& of, const T& t, int derivative) {
  const TimeTable& table = *of.table;
  if (table.between == TimeTable::Between::way) {
    T all(derivative == 0 ? table.value.back() : 0.0);
    for (std::size_t k = table.t.size() - 1; k-- > 0;) {
      const RampInTime ramp{table.value[k], table.value[k + 1], table.t[k], table.t[k + 1], table.way};
      all = select(t < T(table.t[k + 1]), in_time(ramp, t, derivative), all);
    }
    return all;
  }
  const std::size_t pieces = table.pieces.size();
  const auto on = [&](std::size_t k, const T& u) {
    const std::array<double, 4>& c = table.pieces[k];
    if (derivative == 0) return T(c[0]) + u * (T(c[1]) + u * (T(c[2]) + u * T(c[3])));
    if (derivative == 1) return T(c[1]) + u * (T(2 * c[2]) + u * T(3 * c[3]));
    return T(2 * c[2]) + u * T(6 * c[3]);
  };
  const auto beyond = [&](bool last) {
    if (table.between != TimeTable::Between::spline) {
      return derivative > 0 ? T(0) : T(last ? table.value.back() : table.value.front());
    }
    const std::array<double, 4>& c = table.pieces[last ? pieces - 1 : 0];
    const double u = last ? table.t.back() - table.t[pieces - 1] : 0.0;
    const double slope = c[1] + u * (2 * c[2] + u * 3 * c[3]);
    if (derivative > 0) return T(derivative == 1 ? slope : 0.0);
    const double end = c[0] + u * (c[1] + u * (c[2] + u * c[3]));
    return T(end) + T(slope) * (t - T(last ? table.t.back() : table.t.front()));
  };
  T out = beyond(true);
  for (std::size_t k = pieces; k-- > 0;) out = select(t < T(table.t[k + 1]), on(k, t - T(table.t[k])), out);
  return select(t < T(table.t.front()), beyond(false), out);
}

/// A function of time with its first and second derivative.
template <class T>
struct TaylorInTime {
  T value, rate, bend;

  explicit TaylorInTime(double constant) : value(constant), rate(0), bend(0) {}
  TaylorInTime(const T& v, const T& r, const T& b) : value(v), rate(r), bend(b) {}

  /// f(a) with f, f' and f'' there.
  static TaylorInTime of(const TaylorInTime& a, const T& f, const T& first, const T& second) {
    return {f, first * a.rate, second * a.rate * a.rate + first * a.bend};
  }

  friend TaylorInTime operator-(const TaylorInTime& a) { return {-a.value, -a.rate, -a.bend}; }
  friend TaylorInTime operator+(const TaylorInTime& a, const TaylorInTime& b) {
    return {a.value + b.value, a.rate + b.rate, a.bend + b.bend};
  }
  friend TaylorInTime operator-(const TaylorInTime& a, const TaylorInTime& b) { return a + (-b); }
  friend TaylorInTime operator*(const TaylorInTime& a, const TaylorInTime& b) {
    return {a.value * b.value, a.rate * b.value + a.value * b.rate,
            a.bend * b.value + T(2) * a.rate * b.rate + a.value * b.bend};
  }
  friend TaylorInTime operator/(const TaylorInTime& a, const TaylorInTime& b) {
    const T q = a.value / b.value, first = (a.rate - q * b.rate) / b.value;
    return {q, first, (a.bend - T(2) * first * b.rate - q * b.bend) / b.value};
  }
  friend auto operator<(const TaylorInTime& a, const TaylorInTime& b) { return a.value < b.value; }
  friend auto operator>(const TaylorInTime& a, const TaylorInTime& b) { return b < a; }
  template <class Condition>
  requires(!std::is_same_v<Condition, bool>) friend TaylorInTime
      select(const Condition& condition, const TaylorInTime& a, const TaylorInTime& b) {
    return {select(condition, a.value, b.value), select(condition, a.rate, b.rate), select(condition, a.bend, b.bend)};
  }
  friend TaylorInTime sqrt(const TaylorInTime& a) {
    using std::sqrt;
    const T root = sqrt(a.value), first = T(0.5) / root;
    return of(a, root, first, -(first / (T(2) * a.value)));
  }
  friend TaylorInTime exp(const TaylorInTime& a) {
    using std::exp;
    const T power = exp(a.value);
    return of(a, power, power, power);
  }
  friend TaylorInTime log(const TaylorInTime& a) {
    using std::log;
    const T first = T(1) / a.value;
    return of(a, log(a.value), first, -(first * first));
  }
  friend TaylorInTime sin(const TaylorInTime& a) {
    using std::cos;
    using std::sin;
    const T s = sin(a.value);
    return of(a, s, cos(a.value), -s);
  }
  friend TaylorInTime cos(const TaylorInTime& a) {
    using std::cos;
    using std::sin;
    const T c = cos(a.value);
    return of(a, c, -sin(a.value), -c);
  }
  friend TaylorInTime abs(const TaylorInTime& a) { return select(a.value < T(0), -a, a); }
  friend TaylorInTime atan2(const TaylorInTime& y, const TaylorInTime& x) {
    using std::atan2;
    const T square = x.value * x.value + y.value * y.value;
    const T first = (x.value * y.rate - y.value * x.rate) / square;
    const T second = (x.value * y.bend - y.value * x.bend) / square;
    return {atan2(y.value, x.value), first, second - T(2) * first * (x.value * x.rate + y.value * y.rate) / square};
  }
};

template <class T>
T in_time(const FormulaInTime& formula, const T& t, int derivative) {
  std::vector<TaylorInTime<T>> all{{t, T(1), T(0)}};
  for (const double number : formula.values) all.emplace_back(number);
  const TaylorInTime<T> out = formula.expression->value_in<TaylorInTime<T>>(all);
  return T(formula.unit) * (derivative == 0 ? out.value : derivative == 1 ? out.rate : out.bend);
}

template <class T>
T in_time(const TimeLaw& law, const T& t, int derivative);

/// Throws InputError for a velocity or an acceleration, whose integral is no formula; of doubles it has its value.
template <class T>
T in_time(const ComposedInTime& composed, const T& t, int derivative) {
  using How = ComposedInTime::How;
  const std::vector<TimeLaw>& parts = composed.parts;
  if (composed.how == How::integral) {
    throw InputError(
        "the integral of a function of time is not written as code; expected a drive that gives its place, without as");
  }
  if (composed.how == How::piecewise) {
    T out = in_time(parts.back(), t, derivative);
    for (std::size_t k = composed.own.size(); k-- > 0;) {
      out = select(t < T(composed.own[k]), in_time(parts[k], t, derivative), out);
    }
    return out;
  }
  const auto part = [&](std::size_t k) {
    return TaylorInTime<T>(in_time(parts[k], t, 0), in_time(parts[k], t, 1), in_time(parts[k], t, 2));
  };
  TaylorInTime<T> out = part(0);
  for (std::size_t k = 1; k < parts.size(); ++k) out = composed.how == How::sum ? out + part(k) : out * part(k);
  return derivative == 0 ? out.value : derivative == 1 ? out.rate : out.bend;
}

template <class T>
T in_time(const TimeLaw& law, const T& t, int derivative) {
  if constexpr (std::is_same_v<T, double>) return law.at(t, derivative, t);
  return std::visit([&](const auto& one) { return in_time(one, t, derivative); },
                    static_cast<const TimeLaw::variant&>(law));
}

/// The value of a function of time, SI, or its first or second derivative, as TimeFunction::at(t, derivative, t).
template <class T>
T in_time(const TimeFunction& function, const T& t, int derivative) {
  return in_time(function.law, t, derivative);
}

}  // namespace poise
