#pragma once

#include <cstddef>
#include <cstdint>
#include <random>

namespace poise::comparison {

/// Uniform numbers that are the same on every platform for the same seed.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  /// In [low, high).
  double uniform(double low, double high) {
    return low + (high - low) * 0x1p-53 * static_cast<double>(engine_() >> 11);
  }
  /// 0 .. count-1.
  int index(std::size_t count) { return static_cast<int>(uniform(0.0, static_cast<double>(count))); }
  bool chance(double probability) { return uniform(0.0, 1.0) < probability; }

 private:
  std::mt19937_64 engine_;
};

}  // namespace poise::comparison
