#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace poise {

class InputErrors;

/// What a residual of e standard deviations of the noise adds to the sum that a fit minimises, rho(e^2).
enum class Loss {
  squares,  ///< s
  huber,    ///< s up to k^2, from there 2 k sqrt(s) - k^2, k = 1.345
  cauchy,   ///< c^2 log(1 + s / c^2), c = 2.385
  student   ///< (n + 1) log(1 + s / n), n = 4: the likelihood of Student's t distribution, whose scale is the noise
};

std::string to_string(Loss loss);
/// Empty for any other word.
std::optional<Loss> loss_of(std::string_view word);
/// The words, in the order of Loss.
inline constexpr std::array<std::string_view, 4> loss_words = {"squares", "huber", "cauchy", "student"};

/// How the residuals of a fit count. k and c make estimates 95 % as efficient as least squares where the noise is
/// normal. Source: P. J. Huber, E. M. Ronchetti, Robust Statistics, 2nd ed., ch. 7; P. W. Holland, R. E. Welsch,
/// Robust regression using iteratively reweighted least-squares, 1977.
struct Weighting {
  std::vector<double> noise;  ///< per sensor: standard deviation of a reading, SI
  Loss loss = Loss::squares;
  /// Per run, or empty: what the noise of its inputs does to residuals, which count as far as they are more than that;
  /// null of a run without such noise.
  std::vector<std::shared_ptr<const InputErrors>> inputs{};
  /// The noise of inputs over what is stated that makes the residuals likeliest, where that is likelier beyond chance;
  /// less than 1 it is taken, and more is left to the model.
  double input_noise = 1.0;

  const InputErrors* input_errors(std::size_t run) const { return run < inputs.size() ? inputs[run].get() : nullptr; }
  /// rho(s) at s = e^2.
  double cost(double s) const;
  /// d rho/ds, the weight of a residual: 1 in least squares.
  double weight(double s) const;
  /// Derivative of psi(e) = e weight(e^2) by e.
  double psi_slope(double s) const;
};

}  // namespace poise
