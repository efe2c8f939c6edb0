#pragma once

// A function of time in any scalar: what equations written for other programs contain of it (equation_program.hpp).

#include <array>
#include <cstddef>
#include <numbers>
#include <variant>

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

/// A break belongs to the formula behind it.
template <class T>
T in_time(const RampInTime& ramp, const T& t, int derivative) {
  const double takes = ramp.end - ramp.start;
  const T s = (t - T(ramp.start)) / T(takes), rise(ramp.to - ramp.from);
  T way(0), before(0), after(0);
  if (derivative == 0) {
    before = T(ramp.from);
    after = T(ramp.to);
    way = T(ramp.from) + rise * (ramp.smooth ? s * s * s * (T(10) + s * (T(-15) + s * T(6))) : s);
  } else if (derivative == 1) {
    const T flat = T(1) - s;
    way = rise * (ramp.smooth ? T(30) * s * s * flat * flat : T(1)) / T(takes);
  } else if (ramp.smooth) {
    way = rise * (T(60) * s * (T(1) + s * (T(-3) + T(2) * s))) / T(takes * takes);
  }
  return select(t < T(ramp.start), before, select(t >= T(ramp.end), after, way));
}

template <class T>
T in_time(const StepInTime& step, const T& t, int derivative) {
  return derivative > 0 ? T(0) : select(t < T(step.at), T(step.from), T(step.to));
}

template <class T>
T in_time(const TableInTime& of, const T& t, int derivative) {
  const TimeTable& table = *of.table;
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

/// The value of a function of time, SI, or its first or second derivative, as TimeFunction::at(t, derivative, t).
template <class T>
T in_time(const TimeFunction& function, const T& t, int derivative) {
  return std::visit([&](const auto& law) { return in_time(law, t, derivative); }, function.law);
}

}  // namespace poise
