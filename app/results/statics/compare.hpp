#pragma once

#include <string>
#include <vector>

#include "app/result/result.hpp"
#include "statics/equilibrium/answer.hpp"

namespace poise::app {

/// What `poise compare` shows: whether the methods agree, one row for each, and the positions side by side.
Result compare_result(const StaticModel& model, const std::vector<Answer>& answers,
                      const std::vector<std::string>& settings);

}  // namespace poise::app
