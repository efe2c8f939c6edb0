#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace poise {

/// To which extremes and integrals along a curve are found, of the largest size of the value.
inline constexpr double extreme_accuracy = 1e-9;

/// Extremes of a value along a curve that is known at places and can be evaluated between neighbours. A Sample has the
/// `value`, not a number where there is none, and `at`, the parameter of its place.
template <class Sample>
class Extremes {
 public:
  /// Evaluates the curve at the part t of the way from a place to the next; nothing where that is not possible.
  using Between = std::function<std::optional<Sample>(std::size_t k, double t)>;

  /// `range`: the size of that of the parameter.
  Extremes(std::vector<Sample> samples, double range, Between between)
      : samples_(std::move(samples)), range_(range), between_(std::move(between)) {
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (const Sample& one : samples_) {
      if (std::isnan(one.value)) continue;
      least = std::min(least, one.value);
      most = std::max(most, one.value);
    }
    size_ = std::max({0.0, -least, most});
    is_flat_ = most - least <= extreme_accuracy * size_;
  }

  /// Where sense times the value is largest: several where it is attained several times, none where nothing has a
  /// value.
  std::vector<Sample> find(double sense) const {
    std::vector<Sample> found;
    for (std::size_t k = 0; k < samples_.size(); ++k) {
      if (std::isnan(samples_[k].value)) continue;
      if (is_flat_) return {samples_[k]};
      const auto is_above = [&](std::size_t other) {
        return sense * samples_[other].value > sense * samples_[k].value;
      };
      if ((k > 0 && is_above(k - 1)) || (k + 1 < samples_.size() && is_above(k + 1))) continue;
      Sample best = samples_[k];
      if (k > 0) refine(k - 1, sense, best);
      if (k + 1 < samples_.size()) refine(k, sense, best);
      found.push_back(best);
    }
    std::vector<Sample> out;
    const auto most = std::max_element(found.begin(), found.end(), [&](const Sample& a, const Sample& b) {
      return sense * a.value < sense * b.value;
    });
    for (const Sample& one : found) {
      if (std::abs(one.value - most->value) > extreme_accuracy * size_) continue;
      // Where an extreme is flat, its place is known to the root of rounding.
      constexpr double same_place = 1e-5;
      const bool is_new = std::none_of(out.begin(), out.end(), [&](const Sample& other) {
        return std::abs(other.at - one.at) <= same_place * range_;
      });
      if (!is_new) continue;
      out.push_back(one);
      out.back().value = most->value;
    }
    return out;
  }

  /// An extreme so far beyond all places of the curve that the value has a pole there.
  bool is_unbounded(const Sample& extreme) const {
    constexpr double unbounded = 1e3;
    return std::abs(extreme.value) > unbounded * std::max(size_, std::numeric_limits<double>::min());
  }

 private:
  // Between a place and the next, by golden sections to rounding of the value.
  void refine(std::size_t k, double sense, Sample& best) const {
    constexpr double golden = 0.3819660112501051;
    constexpr int most = 60;
    double from = 0.0, to = 1.0, t = golden, u = 1.0 - golden;
    const auto value = [&](double part) {
      const std::optional<Sample> sample = between_(k, part);
      if (!sample) return std::numeric_limits<double>::quiet_NaN();
      if (sense * sample->value > sense * best.value) best = *sample;
      return sense * sample->value;
    };
    double at_t = value(t), at_u = value(u);
    // Beside a kink, as where a size falls to nothing, the value is known only as well as its place.
    const auto is_coarse = [&] { return to - from > 1e-7 || std::abs(at_t - at_u) > 0.01 * extreme_accuracy * size_; };
    for (int step = 0; step < most && !std::isnan(at_t) && !std::isnan(at_u) && is_coarse(); ++step) {
      if (at_t > at_u) {
        to = u;
        u = t;
        at_u = at_t;
        t = from + golden * (to - from);
        at_t = value(t);
      } else {
        from = t;
        t = u;
        at_t = at_u;
        u = to - golden * (to - from);
        at_u = value(u);
      }
    }
  }

  std::vector<Sample> samples_;
  double range_;
  Between between_;
  double size_ = 0.0;
  bool is_flat_ = false;
};

}  // namespace poise
