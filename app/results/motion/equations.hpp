#pragma once

#include <string>
#include <vector>

#include "app/result/result.hpp"
#include "motion/equations_of_motion.hpp"

namespace poise::app {

/// What `poise equations` found.
struct EquationsAnswer {
  std::string position;  ///< where it is, in words
  EquationsOfMotion equations;
  EquationState state;
  EquationNumbers numbers;
};

/// What `poise equations` shows: the parts of the equation of motion in a position, SI.
Result equations_result(const EquationsAnswer& answer, const std::vector<std::string>& settings);

}  // namespace poise::app
