#include "motion/fluctuation.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "model/input_error.hpp"
#include "motion/forces_along.hpp"

namespace poise {
namespace {

constexpr double whole_turn = 2 * std::numbers::pi;

/// The trigonometric polynomial through n values at equal distances over a period:
///   mean + sum_j (cosine_j cos(j x) + sine_j sin(j x)),   x from 0 to 2 pi.
struct Series {
  explicit Series(const std::vector<double>& values) {
    const std::size_t n = values.size();
    std::vector<double> cosines(n), sines(n);
    for (std::size_t k = 0; k < n; ++k) {
      cosines[k] = std::cos(whole_turn * static_cast<double>(k) / static_cast<double>(n));
      sines[k] = std::sin(whole_turn * static_cast<double>(k) / static_cast<double>(n));
    }
    for (const double value : values) mean += value / static_cast<double>(n);
    for (std::size_t j = 1; 2 * j <= n; ++j) {
      double a = 0.0, b = 0.0;
      for (std::size_t k = 0; k < n; ++k) {
        a += values[k] * cosines[j * k % n];
        b += values[k] * sines[j * k % n];
      }
      // The highest wave of an even number of values has no sine, and half the cosine.
      const double share = (2 * j == n ? 1.0 : 2.0) / static_cast<double>(n);
      cosine.push_back(share * a);
      sine.push_back(2 * j == n ? 0.0 : share * b);
    }
  }

  /// The integral from 0 to x of the series less its mean.
  double integral(double x) const {
    double sum = 0.0;
    for (std::size_t j = 1; j <= cosine.size(); ++j) {
      const double wave = static_cast<double>(j);
      sum += (cosine[j - 1] * std::sin(wave * x) + sine[j - 1] * (1 - std::cos(wave * x))) / wave;
    }
    return sum;
  }

  double mean = 0.0;
  std::vector<double> cosine, sine;
};

/// The extreme of values at equal distances over a period: of the parabola through the best and its neighbours. The
/// place is counted in distances.
Fluctuation::Place extreme_of(const std::vector<double>& values, double sign) {
  const std::size_t n = values.size();
  std::size_t best = 0;
  for (std::size_t k = 1; k < n; ++k) {
    if (sign * values[k] > sign * values[best]) best = k;
  }
  const double before = values[(best + n - 1) % n], here = values[best], after = values[(best + 1) % n];
  const double bend = before - 2 * here + after;
  const double aside = bend != 0.0 ? (before - after) / (2 * bend) : 0.0;
  return {static_cast<double>(best) + aside, here - (before - after) * aside / 4};
}

/// What n poses tell.
Fluctuation found_in(const std::vector<double>& torques, double from, double to) {
  const std::vector<double> period(torques.begin(), torques.end() - 1);
  const Series series(period);
  const auto n = static_cast<double>(period.size());
  Fluctuation out;
  out.poses = static_cast<int>(period.size());
  out.mean = series.mean;
  const auto angle = [&](double share) { return from + (to - from) * (share - std::floor(share)); };
  for (const double sign : {-1.0, 1.0}) {
    Fluctuation::Place place = extreme_of(period, sign);
    place.angle = angle(place.angle / n);
    (sign < 0 ? out.least : out.greatest) = place;
  }
  constexpr std::size_t finer = 8;
  std::vector<double> energy(finer * period.size());
  for (std::size_t k = 0; k < energy.size(); ++k) {
    energy[k] = series.integral(whole_turn * static_cast<double>(k) / static_cast<double>(energy.size())) *
                (to - from) / whole_turn;
  }
  const Fluctuation::Place most = extreme_of(energy, 1.0), least = extreme_of(energy, -1.0);
  out.swing = most.value - least.value;
  out.slowest_at = angle(most.angle / static_cast<double>(energy.size()));
  out.fastest_at = angle(least.angle / static_cast<double>(energy.size()));
  return out;
}

double largest_size_of(const std::vector<double>& values) {
  double out = 0.0;
  for (const double one : values) out = std::max(out, std::abs(one));
  return out;
}

void expect_period(const std::vector<double>& torques) {
  if (std::any_of(torques.begin(), torques.end(), [](double one) { return !std::isfinite(one); })) {
    throw InputError(
        "the torque of the drive is undefined in part of the period; expected a motion without dead "
        "points whose forces are determined");
  }
  constexpr double same = 1e-6;
  const double apart = std::abs(torques.front() - torques.back());
  if (apart <= same * largest_size_of(torques)) return;
  throw InputError(
      fmt::format("the torque of the drive at the end of the range differs by {:.3g} N m from that at its "
                  "start; expected a whole period, perhaps of several turns",
                  apart));
}

}  // namespace

Fluctuation fluctuation_of(const std::function<std::vector<double>(int)>& torques, double from, double to,
                           int least_poses, int most_poses) {
  constexpr double enough = 1e-9, enough_of_torque = 1e-6;
  std::vector<double> found = torques(least_poses);
  expect_period(found);
  Fluctuation out = found_in(found, from, to);
  for (int poses = 2 * least_poses;; poses *= 2) {
    const Fluctuation before = std::move(out);
    found = torques(poses);
    expect_period(found);
    out = found_in(found, from, to);
    out.mean_error = std::abs(out.mean - before.mean);
    out.swing_error = std::abs(out.swing - before.swing);
    const double largest = largest_size_of(found);
    const double torque_error =
        std::max(std::abs(out.least.value - before.least.value), std::abs(out.greatest.value - before.greatest.value));
    const bool stays =
        out.swing_error <= enough * largest * std::abs(to - from) && torque_error <= enough_of_torque * largest;
    if (stays || 2 * poses > most_poses) return out;
  }
}

Fluctuation fluctuation_over(const MotionModel& model, const DriveRange& range, const SweepOptions& options) {
  const std::vector<Drive>& drives = model.scene().drives;
  if (drives.size() != 1 || !drives.front().on.is_angle()) {
    throw InputError("the flywheel of one turning drive is asked for; expected one --drive of the angle of a body");
  }
  const double turns = std::abs(range.to - range.from) / whole_turn;
  constexpr double whole = 1e-9;
  if (turns < 0.5 || std::abs(turns - std::round(turns)) > whole * turns) {
    throw InputError(fmt::format(
        "{:.6g} turns are no period; expected a range of whole turns, say {}=0..360 in degrees", turns, range.name));
  }
  const auto torques = [&](int poses) {
    SweepOptions finer = options;
    finer.steps = poses;
    const ForcesAlong found = forces_over(model, {range}, finer, true);
    if (!found.complete) throw InputError("the drive does not turn through the whole range: " + found.why);
    std::vector<double> out;
    for (const Forces& pose : found.poses) {
      const bool is_known = pose.balanced && pose.drives.front().determined && !pose.friction.has_no_forces();
      out.push_back(is_known ? pose.drives.front().value : std::numeric_limits<double>::quiet_NaN());
    }
    return out;
  };
  constexpr int most_poses = 5000, fewest = 24;
  Fluctuation out = fluctuation_of(torques, range.from, range.to, std::max(options.steps, fewest), most_poses);
  out.drive = drives.front().name;
  out.speed = std::abs(options.rate);
  return out;
}

}  // namespace poise
