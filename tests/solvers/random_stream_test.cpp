#include "solvers/random_stream.hpp"

#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

namespace poise::solvers::random_stream_test {
namespace {

using Words = std::array<std::uint32_t, 4>;

// The vectors that Random123 publishes for philox4x32-10.
TEST(RandomStream, PhiloxGivesItsKnownAnswers) {
  EXPECT_EQ(philox({0, 0, 0, 0}, {0, 0}), (Words{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  constexpr std::uint32_t all = 0xffffffff;
  EXPECT_EQ(philox({all, all, all, all}, {all, all}), (Words{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (Words{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

double uniform_of(std::uint64_t bits) { return (static_cast<double>(bits >> 12) + 0.5) / 4503599627370496.0; }

TEST(RandomStream, TakesTwoNumbersOfEveryCounter) {
  RandomStream random(0);
  EXPECT_EQ(random.uniform(), uniform_of(0xe169c58d6627e8d5));
  EXPECT_EQ(random.uniform(), uniform_of(0x9b00dbd8bc57ac4c));
  const Words next = philox({1, 0, 0, 0}, {0, 0});
  EXPECT_EQ(random.uniform(), uniform_of(std::uint64_t{next[1]} << 32 | next[0]));
  // {number / 2, stream, sample} and the seed, the lower halves first.
  RandomStream keyed(0x299f31d0a4093822, 0x85a308d3, 0x0370734413198a2e);
  const Words words = philox({0, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0});
  EXPECT_EQ(keyed.uniform(), uniform_of(std::uint64_t{words[1]} << 32 | words[0]));
}

// x with Phi(x) = p; Phi(x) = erfc(-x / sqrt 2) / 2.
TEST(RandomStream, QuantileInvertsTheNormalDistribution) {
  EXPECT_EQ(normal_quantile(0.5), 0.0);
  EXPECT_DOUBLE_EQ(normal_quantile(0.975), 1.959963984540054);
  EXPECT_DOUBLE_EQ(normal_quantile(0.75), 0.6744897501960817);
  EXPECT_DOUBLE_EQ(normal_quantile(1e-10), -6.361340902404056);
  for (double p = 0x1p-53; p < 0.5; p *= 1.1) {
    const double x = normal_quantile(p);
    // A relative error of x moves Phi(x) by x^2 times as much.
    EXPECT_NEAR(0.5 * std::erfc(-x / std::sqrt(2.0)) / p, 1.0, 1e-15 * (2 + x * x)) << p;
  }
  for (const double p : {0x1p-30, 0x1p-7, 0.0625, 0.125, 0.25}) EXPECT_EQ(normal_quantile(1 - p), -normal_quantile(p));
}

// Machines, compilers and libraries have to agree on these bits.
TEST(RandomStream, NormalNumbersHaveKnownBits) {
  RandomStream random(1, 2, 3);
  EXPECT_EQ(random.normal(), -0x1.2e8acbeac1cbcp+0);
  EXPECT_EQ(random.normal(), -0x1.22d5a046b407dp-4);
  EXPECT_EQ(random.normal(), -0x1.97da2b4b8ffddp-1);
  EXPECT_EQ(normal_quantile(0x1p-53), -0x1.06b48528cea51p+3);
  EXPECT_EQ(normal_quantile(0.05), -0x1.a515209676abdp+0);
}

TEST(RandomStream, NumbersAreDistributedAsTheySay) {
  constexpr int n = 200'000;
  RandomStream normals(7), uniforms(7, 1);
  double sum = 0, squares = 0, fourth = 0, mean = 0, product = 0, last = 0;
  int beyond = 0;
  for (int k = 0; k < n; ++k) {
    const double x = normals.normal(), u = uniforms.uniform(-1.0, 3.0);
    ASSERT_TRUE(u > -1.0 && u < 3.0);
    sum += x;
    squares += x * x;
    fourth += x * x * x * x;
    product += x * last;
    last = x;
    mean += u;
    beyond += std::abs(x) > 1.959963984540054 ? 1 : 0;
  }
  const double error = 4 / std::sqrt(n);
  EXPECT_NEAR(sum / n, 0.0, error);
  EXPECT_NEAR(squares / n, 1.0, error * std::sqrt(2.0));
  EXPECT_NEAR(fourth / n, 3.0, error * std::sqrt(96.0));
  EXPECT_NEAR(product / n, 0.0, error);
  EXPECT_NEAR(mean / n, 1.0, error * 4 / std::sqrt(12.0));
  EXPECT_NEAR(1.0 * beyond / n, 0.05, error * std::sqrt(0.05 * 0.95));
}

TEST(RandomStream, KeysGiveOtherNumbers) {
  const double first = RandomStream(1, 0, 0).uniform();
  EXPECT_EQ(RandomStream(1).uniform(), first);
  EXPECT_NE(RandomStream(2, 0, 0).uniform(), first);
  EXPECT_NE(RandomStream(1, 1, 0).uniform(), first);
  EXPECT_NE(RandomStream(1, 0, 1).uniform(), first);
  EXPECT_NE(RandomStream(1, 0, std::uint64_t{1} << 40).uniform(), first);
}

}  // namespace
}  // namespace poise::solvers::random_stream_test
