#pragma once

#include <array>
#include <cstdint>

namespace poise::solvers {

/// The bijection Philox4x32-10 of the counter for the key (Salmon, Moraes, Dror and Shaw, "Parallel random numbers: as
/// easy as 1, 2, 3", SC 2011).
std::array<std::uint32_t, 4> philox(const std::array<std::uint32_t, 4>& counter,
                                    const std::array<std::uint32_t, 2>& key);

/// The quantile of the standard normal distribution at p, 0 < p < 1: x with Phi(x) = p, to 16 digits (Wichura,
/// Algorithm AS 241, Applied Statistics 37, 1988). Made of sums, products, quotients and a square root alone, whose
/// rounding IEEE 754 prescribes, so that all machines give the same bits.
double normal_quantile(double p);

/// Random numbers that depend on their key (seed, stream, sample) and on their place after it alone, on no other
/// numbers that have been drawn: samples can be computed in any order, by any thread, on any machine, with the same
/// bits. Samples and streams of one seed are independent of each other.
///
/// Number n of a key takes 64 bits of philox() at the counter {n / 2, stream, sample}, with the seed as its key.
class RandomStream {
 public:
  explicit RandomStream(std::uint64_t seed, std::uint32_t stream = 0, std::uint64_t sample = 0);

  /// In (0, 1): (k + 1/2) / 2^52 for k = 0 .. 2^52 - 1.
  double uniform();
  /// In [low, high].
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Of mean 0 and standard deviation 1: the normal_quantile() of uniform().
  double normal() { return normal_quantile(uniform()); }

 private:
  std::array<std::uint32_t, 2> key_;
  std::array<std::uint32_t, 4> counter_;
  std::array<std::uint32_t, 4> words_{};
  bool half_used_ = false;
};

}  // namespace poise::solvers
