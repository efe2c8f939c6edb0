#pragma once

// Random functions of time, as text of a scene and as numbers, for judges of motion.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "solvers/random_stream.hpp"

namespace poise::judge {

inline constexpr double full_turn = 2 * std::numbers::pi;
inline constexpr double earth_gravity = 9.81;

inline int pick(solvers::RandomStream& random, int from, int to) {
  return std::min(to, from + static_cast<int>(random.uniform(0.0, 1.0) * (to - from + 1)));
}
inline bool chance(solvers::RandomStream& random, double part) { return random.uniform() < part; }

/// A function of time, as text and as a mean over an interval.
struct Course {
  enum class Kind { constant, sine, ramp, smooth_ramp, step, table } kind = Kind::constant;
  std::array<double, 4> a{};
  std::vector<double> times{}, values{};

  static Course random(solvers::RandomStream& random, double duration) {
    Course out;
    out.kind = static_cast<Kind>(pick(random, 0, 5));
    const double begin = random.uniform(0.0, 0.5) * duration;
    const double from = chance(random, 0.5) ? 0.0 : random.uniform(-1.0, 1.0), to = random.uniform(-1.0, 1.0);
    switch (out.kind) {
      case Kind::constant:
        break;
      case Kind::sine:
        out.a = {random.uniform(0.3, 1.0), random.uniform(0.3, 3.0), chance(random, 0.5) ? 0.0 : random.uniform(-3, 3),
                 chance(random, 0.5) ? 0.0 : random.uniform(-0.5, 0.5)};
        break;
      case Kind::ramp:
      case Kind::smooth_ramp:
        out.a = {from, to, begin, begin + random.uniform(0.05, 0.5) * duration};
        break;
      case Kind::step:
        out.a = {from, to, begin, 0.0};
        break;
      case Kind::table: {
        double t = chance(random, 0.5) ? 0.0 : begin;
        for (int k = pick(random, 2, 6); k-- > 0; t += random.uniform(0.02, 0.3) * duration) {
          out.times.push_back(t);
          out.values.push_back(chance(random, 0.3) ? 0.0 : random.uniform(-1.0, 1.0));
        }
      }
    }
    return out;
  }

  std::string text() const {
    switch (kind) {
      case Kind::constant:
        return "";
      case Kind::sine:
        return fmt::format(
            "time = {{ sine = {{ amplitude = {:.17g}, frequency = {:.17g}, phase = {:.17g}, offset = {:.17g} }} }}\n",
            a[0], a[1], a[2], a[3]);
      case Kind::ramp:
      case Kind::smooth_ramp:
        return fmt::format(
            "time = {{ ramp = {{ from = {:.17g}, to = {:.17g}, start = {:.17g}, end = {:.17g}, law = \"{}\" }} }}\n",
            a[0], a[1], a[2], a[3], kind == Kind::ramp ? "linear" : "polynomial_345");
      case Kind::step:
        return fmt::format("time = {{ step = {{ from = {:.17g}, to = {:.17g}, at = {:.17g} }} }}\n", a[0], a[1], a[2]);
      case Kind::table: {
        std::vector<std::string> points;
        for (std::size_t k = 0; k < times.size(); ++k) {
          points.push_back(fmt::format("[{:.17g}, {:.17g}]", times[k], values[k]));
        }
        return fmt::format("time = {{ table = [{}], interpolation = \"linear\" }}\n", fmt::join(points, ", "));
      }
    }
    return "";
  }

  double at(double t) const {
    switch (kind) {
      case Kind::constant:
        return 1.0;
      case Kind::sine:
        return a[3] + a[0] * std::sin(full_turn * a[1] * t + a[2]);
      case Kind::ramp:
      case Kind::smooth_ramp: {
        const double s = std::clamp((t - a[2]) / (a[3] - a[2]), 0.0, 1.0);
        return a[0] + (a[1] - a[0]) * (kind == Kind::ramp ? s : s * s * s * (10 + s * (6 * s - 15)));
      }
      case Kind::step:
        return t < a[2] ? a[0] : a[1];
      case Kind::table: {
        const auto after = std::upper_bound(times.begin(), times.end(), t);
        if (after == times.begin()) return values.front();
        if (after == times.end()) return values.back();
        const auto k = static_cast<std::size_t>(after - times.begin());
        return values[k - 1] + (values[k] - values[k - 1]) * (t - times[k - 1]) / (times[k] - times[k - 1]);
      }
    }
    return 0.0;
  }

  double mean(double t, double h) const {
    if (kind != Kind::step) return at(t + h / 2);
    const double before = std::clamp((a[2] - t) / h, 0.0, 1.0);
    return before * a[0] + (1 - before) * a[1];
  }
};

/// How a body is driven from where it stands: by a rate and a sine, or along a smooth ramp.
struct DriveCourse {
  bool is_ramp = false;
  double rate = 0.0, amplitude = 0.0, frequency = 0.0, phase = 0.0;
  Course ramp{};

  static DriveCourse random(solvers::RandomStream& random, double duration) {
    DriveCourse out;
    out.is_ramp = chance(random, 0.4);
    if (out.is_ramp) {
      const double begin = random.uniform(0.0, 0.4) * duration;
      out.ramp = {Course::Kind::smooth_ramp,
                  {0.0, random.uniform(-1.5, 1.5), begin, begin + random.uniform(0.2, 0.6) * duration}};
    } else {
      if (chance(random, 0.7)) out.rate = random.uniform(-1.0, 1.0);
      if (chance(random, 0.7)) {
        out.amplitude = random.uniform(0.05, 0.5);
        out.frequency = random.uniform(0.3, 2.0);
        out.phase = random.uniform(-3.0, 3.0);
      }
    }
    return out;
  }
  std::string text() const {
    if (is_ramp) return ramp.text();
    return fmt::format("rate = {:.17g}\namplitude = {:.17g}\nfrequency = {:.17g}\nphase = {:.17g}\n", rate, amplitude,
                       frequency, phase);
  }
  /// What it has moved by.
  double value_at(double t) const {
    if (is_ramp) return ramp.at(t);
    return rate * t + amplitude * (std::sin(full_turn * frequency * t + phase) - std::sin(phase));
  }
  double rate_at(double t) const {
    if (!is_ramp) return rate + amplitude * full_turn * frequency * std::cos(full_turn * frequency * t + phase);
    const double length = ramp.a[3] - ramp.a[2], s = std::clamp((t - ramp.a[2]) / length, 0.0, 1.0);
    return ramp.a[1] / length * 30 * s * s * (1 - s) * (1 - s);
  }
  double acceleration_at(double t) const {
    const double omega = full_turn * frequency;
    if (!is_ramp) return -amplitude * omega * omega * std::sin(omega * t + phase);
    const double length = ramp.a[3] - ramp.a[2], s = std::clamp((t - ramp.a[2]) / length, 0.0, 1.0);
    return ramp.a[1] / (length * length) * 60 * s * (1 - s) * (1 - 2 * s);
  }
};

struct Load {
  double size = 0.0;
  Course course{};
  double mean(double t, double h) const { return size * course.mean(t, h); }
};

inline Load random_load(solvers::RandomStream& random, double size, double duration) {
  return {(chance(random, 0.5) ? 1 : -1) * random.uniform(0.3, 1.0) * size, Course::random(random, duration)};
}

}  // namespace poise::judge
