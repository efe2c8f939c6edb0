#include "solvers/random_stream.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include <Random123/philox.h>

namespace poise::solvers {
namespace {

/// The polynomial of these coefficients, the constant one first.
double polynomial(std::span<const double> coefficients, double x) {
  double sum = 0.0;
  for (std::size_t k = coefficients.size(); k-- > 0;) sum = sum * x + coefficients[k];
  return sum;
}

/// log x, in place of the library's, whose last bit is its own:  log(m 2^e) = e log 2 + 2 artanh((m - 1) / (m + 1)).
double logarithm(double x) {
  constexpr double log_2 = 0.693147180559945309417, root_half = 0.707106781186547524401;
  int exponent = 0;
  double m = std::frexp(x, &exponent);
  if (m < root_half) {
    m *= 2;
    --exponent;
  }
  const double s = (m - 1) / (m + 1);
  // |s| < 0.172: the terms that are left out are below 1e-19.
  double sum = 0.0;
  for (int power = 23; power >= 1; power -= 2) sum = sum * (s * s) + 1.0 / power;
  return exponent * log_2 + 2 * s * sum;
}

}  // namespace

std::array<std::uint32_t, 4> philox(const std::array<std::uint32_t, 4>& counter,
                                    const std::array<std::uint32_t, 2>& key) {
  using Generator = r123::Philox4x32_R<10>;
  const Generator::ctr_type words = Generator()({{counter[0], counter[1], counter[2], counter[3]}}, {{key[0], key[1]}});
  return {words[0], words[1], words[2], words[3]};
}

double normal_quantile(double p) {
  constexpr double middle_over[] = {3.3871328727963666080e0, 1.3314166789178437745e2, 1.9715909503065514427e3,
                                    1.3731693765509461125e4, 4.5921953931549871457e4, 6.7265770927008700853e4,
                                    3.3430575583588128105e4, 2.5090809287301226727e3};
  constexpr double middle_under[] = {1.0,
                                     4.2313330701600911252e1,
                                     6.8718700749205790830e2,
                                     5.3941960214247511077e3,
                                     2.1213794301586595867e4,
                                     3.9307895800092710610e4,
                                     2.8729085735721942674e4,
                                     5.2264952788528545610e3};
  constexpr double tail_over[] = {1.42343711074968357734e0,  4.63033784615654529590e0, 5.76949722146069140550e0,
                                  3.64784832476320460504e0,  1.27045825245236838258e0, 2.41780725177450611770e-1,
                                  2.27238449892691845833e-2, 7.74545014278341407640e-4};
  constexpr double tail_under[] = {1.0,
                                   2.05319162663775882187e0,
                                   1.67638483018380384940e0,
                                   6.89767334985100004550e-1,
                                   1.48103976427480074590e-1,
                                   1.51986665636164571966e-2,
                                   5.47593808499534494600e-4,
                                   1.05075007164441684324e-9};
  constexpr double end_over[] = {6.65790464350110377720e0,  5.46378491116411436990e0,  1.78482653991729133580e0,
                                 2.96560571828504891230e-1, 2.65321895265761230930e-2, 1.24266094738807843860e-3,
                                 2.71155556874348757815e-5, 2.01033439929228813265e-7};
  constexpr double end_under[] = {1.0,
                                  5.99832206555887937690e-1,
                                  1.36929880922735805310e-1,
                                  1.48753612908506148525e-2,
                                  7.86869131145613259100e-4,
                                  1.84631831751005468180e-5,
                                  1.42151175831644588870e-7,
                                  2.04426310338993978564e-15};
  const double q = p - 0.5;
  if (std::abs(q) <= 0.425) {
    const double r = 0.180625 - q * q;
    return q * polynomial(middle_over, r) / polynomial(middle_under, r);
  }
  const double r = std::sqrt(-logarithm(std::min(p, 1 - p)));
  const double size = r <= 5.0 ? polynomial(tail_over, r - 1.6) / polynomial(tail_under, r - 1.6)
                               : polynomial(end_over, r - 5.0) / polynomial(end_under, r - 5.0);
  return q < 0 ? -size : size;
}

RandomStream::RandomStream(std::uint64_t seed, std::uint32_t stream, std::uint64_t sample)
    : key_{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)},
      counter_{0, stream, static_cast<std::uint32_t>(sample), static_cast<std::uint32_t>(sample >> 32)} {}

double RandomStream::uniform() {
  if (!half_used_) {
    words_ = philox(counter_, key_);
    ++counter_[0];
  }
  const std::size_t at = half_used_ ? 2 : 0;
  half_used_ = !half_used_;
  const std::uint64_t bits = words_[at] | static_cast<std::uint64_t>(words_[at + 1]) << 32;
  return (static_cast<double>(bits >> 12) + 0.5) * 0x1p-52;
}

}  // namespace poise::solvers
