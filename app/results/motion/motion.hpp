#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/result/result.hpp"
#include "app/results/motion/quantities.hpp"
#include "motion/confirmed_motion.hpp"
#include "motion/forces_in_time.hpp"
#include "motion/motion_record.hpp"

namespace poise::app {

/// What `poise motion` found.
struct MotionAnswer {
  std::string start;      ///< how it began, in words
  double duration = 0.0;  ///< asked for, s
  double accuracy = 0.0;  ///< asked for
  ConfirmedMotion found;
  MotionRecord record;                   ///< without noise
  QuantitiesInTime shown{};              ///< what was asked for, or the outputs of the scene
  std::optional<ForceHistory> forces{};  ///< where they were asked for

  /// Confirmed; and all forces in balance, made by the motors that were named.
  bool is_good() const {
    return found.confirmed() &&
           (!forces || (forces->found.complete && forces->balanced() && (!forces->motors || forces->motors->is_made)));
  }
};

/// What `poise motion` shows: verdict, start, where everything that moves began, ended and turned round, drives,
/// energies, numerics. The table for CSV is `measured`: the record, with noise where that was asked for; empty
/// where no CSV is. Where quantities alone are asked for they take its place, and that of the tables of what moves.
Result motion_result(const MotionModel& model, const MotionAnswer& answer, const MotionRecord& measured,
                     const std::vector<std::string>& settings);

/// The result where no equilibrium was found to start from.
Result no_origin_result(const MotionModel& model, const std::string& why, const std::vector<std::string>& settings);

}  // namespace poise::app
