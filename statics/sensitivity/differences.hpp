#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "statics/sensitivity/fitted_numbers.hpp"

namespace poise {

/// A result that is known to within `error`, SI.
struct ComputedResult {
  std::string name;
  Dimension dimension{};
  double value = 0.0, error = 0.0;
};

/// Predictions of results whose derivatives are not known, by central differences of what `at` gives of a scene with
/// other numbers: the values of all results, or nothing where they cannot be computed. Numbers are moved by a twentieth
/// of a standard deviation, or by 1e-4 of themselves where that is more. A direction that the readings leave open moves
/// a result where its values at both sides, 1e-3 of a number away, differ by more than twice their errors. Second order
/// of at most `most_second_order` numbers.
std::vector<PredictedResult> predict_by_differences(
    const FittedNumbers& numbers, const Scene& scene, const std::vector<ComputedResult>& results,
    const std::function<std::optional<std::vector<double>>(const Scene&)>& at);

inline constexpr std::size_t most_second_order = 4;

}  // namespace poise
