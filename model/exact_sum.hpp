#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace poise {

/// The exact sum of doubles, as few doubles of increasing magnitude that do not overlap (Shewchuk 1997,
/// Grow-Expansion): sums that cancel have no parts. A sum that overflows is infinite.
class ExactSum {
 public:
  void clear() { parts_.clear(); }

  void add(double x) {
    std::size_t kept = 0;
    for (const double part : parts_) {
      const double sum = x + part;
      const double of_part = sum - x;
      const double lost = (x - (sum - of_part)) + (part - of_part);
      if (std::abs(lost) > 0) parts_[kept++] = lost;  // not NaN, after an overflow
      x = sum;
    }
    parts_.resize(kept);
    if (x != 0) parts_.push_back(x);
  }
  void add(const ExactSum& other, double sign = 1.0) {
    for (const double part : std::vector<double>(other.parts_)) add(sign * part);
  }

  const std::vector<double>& parts() const { return parts_; }

  /// The sum in the scalar T, the smallest parts first.
  template <class T>
  T to() const {
    T sum(0);
    for (const double part : parts_) sum += static_cast<T>(part);
    return sum;
  }

 private:
  std::vector<double> parts_;
};

}  // namespace poise
