#include "statics/sensitivity/differences.hpp"

#include <algorithm>
#include <cmath>

namespace poise {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Changes of each number over which differences are taken.
VectorXd steps_of(const FittedNumbers& numbers) {
  constexpr double of_sigma = 0.05, of_itself = 1e-4;
  VectorXd out(numbers.covariance.rows());
  for (Index i = 0; i < out.size(); ++i) {
    const FittedNumbers::Number& number = numbers.numbers[static_cast<std::size_t>(i)];
    const double own = number.value != 0 ? std::abs(number.value) : number.unit;
    out[i] = std::max(of_sigma * std::sqrt(std::max(0.0, numbers.covariance(i, i))), of_itself * own);
  }
  return out;
}

class Differences {
 public:
  Differences(const FittedNumbers& numbers, const Scene& scene,
              const std::function<std::optional<std::vector<double>>(const Scene&)>& at)
      : numbers_(numbers), scene_(scene), at_(at), steps_(steps_of(numbers)) {}

  std::optional<std::vector<double>> values(const VectorXd& moved) const {
    Scene scene = scene_;
    numbers_.put_into(scene, moved);
    return at_(scene);
  }

  /// Differentiates each result where the numbers are moved; a reason says where one of the values cannot be computed.
  std::vector<ResultGradient> gradients(const VectorXd& moved, const std::vector<ComputedResult>& results) const {
    const Index n = steps_.size();
    std::vector<ResultGradient> out(results.size());
    for (std::size_t q = 0; q < out.size(); ++q) {
      out[q].value = results[q].value;
      if (!std::isfinite(results[q].value)) out[q].why = "it has no value";
      out[q].by = VectorXd::Zero(n);
    }
    for (Index i = 0; i < n; ++i) {
      const VectorXd step = steps_[i] * VectorXd::Unit(n, i);
      const auto up = values(moved + step), down = values(moved - step);
      for (std::size_t q = 0; q < out.size(); ++q) {
        out[q].by[i] = up && down ? ((*up)[q] - (*down)[q]) / (2 * steps_[i]) : NAN;
        // What is less than the errors of both values is none.
        if (std::abs(out[q].by[i]) * steps_[i] <= results[q].error) out[q].by[i] = 0.0;
        if (std::isnan(out[q].by[i])) {
          out[q].why =
              "it cannot be computed with other values of " + numbers_.numbers[static_cast<std::size_t>(i)].name;
        }
      }
    }
    return out;
  }

  /// Finds for each result the first direction that moves it.
  std::vector<std::string> what_moves(const std::vector<ComputedResult>& results) const {
    constexpr double part = 1e-3;
    std::vector<std::string> out(results.size());
    for (const FittedNumbers::Direction& one : numbers_.unknown) {
      double largest = 0.0;
      for (Index i = 0; i < one.part.size(); ++i) {
        const FittedNumbers::Number& number = numbers_.numbers[static_cast<std::size_t>(i)];
        const double own = number.value != 0 ? std::abs(number.value) : number.unit;
        largest = std::max(largest, std::abs(one.part[i]) / own);
      }
      const VectorXd moved = part / largest * one.part;
      const auto up = values(moved), down = values(-moved);
      for (std::size_t q = 0; q < out.size(); ++q) {
        const bool is_still = up && down && std::abs((*up)[q] - (*down)[q]) <= 2 * results[q].error;
        if (!is_still && out[q].empty()) out[q] = one.words;
      }
    }
    return out;
  }

 private:
  const FittedNumbers& numbers_;
  const Scene& scene_;
  const std::function<std::optional<std::vector<double>>(const Scene&)>& at_;
  VectorXd steps_;
};

}  // namespace

std::vector<PredictedResult> predict_by_differences(
    const FittedNumbers& numbers, const Scene& scene, const std::vector<ComputedResult>& results,
    const std::function<std::optional<std::vector<double>>(const Scene&)>& at) {
  const Differences differences(numbers, scene, at);
  const std::vector<std::string> open = differences.what_moves(results);
  const std::vector<ResultGradient> here = differences.gradients(VectorXd::Zero(numbers.covariance.rows()), results);
  std::vector<std::vector<ResultGradient>> moved(results.size());
  if (numbers.numbers.size() <= most_second_order) {
    for (const VectorXd& by : numbers.moves()) {
      const std::vector<ResultGradient> there = differences.gradients(by, results);
      for (std::size_t q = 0; q < results.size(); ++q) moved[q].push_back(there[q]);
    }
  }
  FittedNumbers known = numbers;
  known.unknown.clear();
  std::vector<PredictedResult> out;
  for (std::size_t q = 0; q < results.size(); ++q) {
    out.push_back(predict(known, results[q].name, results[q].dimension, here[q], moved[q]));
    if (out.back().why.empty()) out.back().undetermined = open[q];
  }
  return out;
}

}  // namespace poise
