#include "identification/assessment/determined_inertia.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "identification/assessment/carried_numbers.hpp"
#include "identification/identifiability/base_parameters.hpp"

namespace poise {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Whether a number that the readings leave open moves the result.
bool is_of_open_number(const FittedNumbers& numbers, const PredictedResult& result) {
  return std::any_of(result.shares.begin(), result.shares.end(), [&](const PredictedResult::Share& share) {
    return std::any_of(numbers.unknown.begin(), numbers.unknown.end(), [&](const FittedNumbers::Direction& open) {
      return open.part[static_cast<Index>(share.number)] != 0.0;
    });
  });
}

/// A base parameter in a scene with the numbers, moved by so much, with its derivatives by differences: it is at most
/// quadratic in each mass, place of a centre and inertia, so that central differences of these are exact.
class InertiaByNumbers {
 public:
  InertiaByNumbers(const FittedNumbers& numbers, const Scene& scene, const BaseParameters::Sum& sum)
      : numbers_(numbers), scene_(scene), sum_(sum) {}

  ResultGradient at(const VectorXd& moved) const {
    const Index n = numbers_.covariance.rows();
    ResultGradient out{.value = value(moved), .why = {}, .by = VectorXd(n), .rounding = VectorXd(n)};
    constexpr double part = 1e-3, rounding = 64 * std::numeric_limits<double>::epsilon();
    double size = 0.0;
    for (const BaseParameters::Term& term : sum_.terms) size += std::abs(value_of({{}, {term}}, scene_));
    for (Index i = 0; i < n; ++i) {
      const FittedNumbers::Number& number = numbers_.numbers[static_cast<std::size_t>(i)];
      const VectorXd step = part * (number.value != 0.0 ? std::abs(number.value) : number.unit) * VectorXd::Unit(n, i);
      const auto slope = [&](double by) {
        return (value(moved + by * step) - value(moved - by * step)) / (2 * by * step[i]);
      };
      out.by[i] = slope(1.0);
      // An expression of the number may be no polynomial.
      out.rounding[i] = rounding * size / step[i] + 2 * std::abs(slope(2.0) - out.by[i]);
    }
    return out;
  }

 private:
  double value(const VectorXd& moved) const {
    Scene scene = scene_;
    numbers_.put_into(scene, moved);
    return value_of(sum_, scene);
  }

  const FittedNumbers& numbers_;
  const Scene& scene_;
  const BaseParameters::Sum& sum_;
};

}  // namespace

std::vector<PredictedResult> determined_inertia(const FitProblem& problem, const Identification& answer) {
  const bool has_sums = !answer.fit.identifiability.combinations.empty();
  if (!problem.experiment().parts.empty() || problem.runs() == 0 || has_sums) return {};
  const std::optional<FittedNumbers> carried = carried_numbers(problem, answer);
  if (!carried || carried->unknown.empty()) return {};
  Scene scene = problem.experiment().scene;
  const FittedNumbers numbers = carried->of(scene);
  if (numbers.unknown.empty()) return {};
  numbers.put_into(scene);
  std::vector<PredictedResult> out;
  for (const BaseParameters::Sum& sum : base_parameters(scene).sums) {
    const InertiaByNumbers by_numbers(numbers, scene, sum);
    std::vector<ResultGradient> moved;
    for (const VectorXd& by : numbers.moves()) moved.push_back(by_numbers.at(by));
    const VectorXd here = VectorXd::Zero(numbers.covariance.rows());
    PredictedResult one = predict(numbers, sum.words, dimension_of(sum), by_numbers.at(here), moved);
    if (one.is_known() && one.sigma > 0.0 && is_of_open_number(numbers, one)) out.push_back(std::move(one));
  }
  return out;
}

}  // namespace poise
