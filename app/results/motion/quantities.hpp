#pragma once

#include <optional>
#include <vector>

#include "app/result/result.hpp"
#include "model/units.hpp"
#include "motion/quantities_along.hpp"

namespace poise::app {

/// Quantities over a motion, SI.
struct QuantitiesInTime {
  std::vector<SoughtQuantity> of;
  std::vector<double> time;
  std::vector<std::vector<double>> value;  ///< of each, per time; not a number where it is undefined
  std::vector<QuantityRange> range;        ///< of each, over the whole motion
  double imbalance = 0.0;                  ///< QuantitiesAlong::imbalance()
};

/// Their values at these times, which lie in the motion.
QuantitiesInTime quantities_in_time(const std::vector<SoughtQuantity>& of, const std::vector<double>& time,
                                    QuantitiesAlong& along);

/// The table over time, as text at some of the times, which is the one for CSV; the least, the greatest and the mean
/// values; in JSON `quantities` and their times `quantity_times`. `error`: to which the motion is known, of the range
/// of each coordinate; without one, and where it is not `is_confirmed`, each row of the CSV says so.
void add_quantities_in_time(Group& group, const QuantitiesInTime& found, const Units& units,
                            const std::optional<double>& error, bool is_confirmed);

}  // namespace poise::app
