#pragma once

#include <string>
#include <vector>

#include "app/result/result.hpp"
#include "model/units.hpp"
#include "statics/quantities/quantity.hpp"
#include "statics/sensitivity/fitted_numbers.hpp"

namespace poise::app {

/// The quantities of a position that are predicted where none are asked for: angles and travels, forces of elements and
/// of joints, stops, and the outputs of the scene.
std::vector<SoughtQuantity> predicted_by_default(const Scene& scene);

/// The section and the data "predictions": every result with its interval, where it has one, and what it is uncertain
/// by; with warnings on those that the fit does not determine or that are not linear. Returns whether all have one.
bool add_predictions(Result& result, const FittedNumbers& numbers, const std::vector<PredictedResult>& predictions,
                     const Units& units);

/// "37.10 ± 0.40 N (95 %), three quarters of it from k": of a result that is known.
std::string prediction_in_words(const FittedNumbers& numbers, const PredictedResult& prediction, const Units& units);

}  // namespace poise::app
