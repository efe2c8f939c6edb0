#pragma once

#include <cstdint>

#include "app/result/result.hpp"
#include "motion/design.hpp"

namespace poise::app {

/// What `poise design` shows: whether all goals are met, what was reached of each, and the dimensions. `microseconds`
/// is what the search took.
Result design_result(const DesignProblem& problem, const DesignResult& found, const DesignCheck& check,
                     std::uint64_t seed, double microseconds);

}  // namespace poise::app
