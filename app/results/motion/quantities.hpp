#pragma once

#include <optional>
#include <vector>

#include "app/result/result.hpp"
#include "motion/quantities_along.hpp"
#include "statics/model/scaled_model.hpp"

namespace poise::app {

/// Quantities over a motion, SI.
struct QuantitiesInTime {
  /// One that has one value for the whole motion: max(Q), work(Q).
  struct Once {
    SoughtQuantity of;
    double value = 0.0;
    double at = 0.0;  ///< when, of max(Q) and min(Q); not a number of all else
  };
  bool are_all = false;                 ///< nothing else of the motion was asked for
  std::vector<std::string> left_out{};  ///< outputs of the scene that have no meaning in a motion, and why
  std::vector<Once> once{};
  std::vector<SoughtQuantity> of{};
  double duration = 0.0;  ///< of the motion, s
  std::vector<double> time{};
  std::vector<std::vector<double>> value{};  ///< of each, per time; not a number where it is undefined
  std::vector<QuantityRange> range{};        ///< of each, over the whole motion
  double imbalance = 0.0;                    ///< QuantitiesAlong::imbalance()

  bool empty() const { return of.empty() && once.empty(); }
};

/// Their values at these times, which lie in the motion of this duration, s.
QuantitiesInTime quantities_in_time(const std::vector<SoughtQuantity>& of, const std::vector<double>& time,
                                    double duration, QuantitiesAlong& along);

/// The table over time, as text at some of the times, which is the one for CSV where they are all; the least, the
/// greatest and the mean values; in JSON `quantities` and their times `quantity_times`. `error`: to which the motion is
/// known, of the range of each coordinate; where it is not `is_confirmed`, each row of the CSV says so.
void add_quantities_in_time(Group& group, const QuantitiesInTime& found, const ScaledModel& model,
                            const std::optional<double>& error, bool is_confirmed);

}  // namespace poise::app
