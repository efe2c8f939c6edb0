#pragma once

#include <string>
#include <vector>

#include "app/result/result.hpp"
#include "statics/model/mobility.hpp"
#include "statics/model/static_model.hpp"

namespace poise::app {

/// What `poise check` shows: bodies, joints, mobility, redundant constraints, what the model keeps and drops.
/// `moving`: the scene of the model with its functions of time.
Result check_result(const StaticModel& model, const Mobility& mobility, const Scene& moving,
                    const std::vector<std::string>& settings);

}  // namespace poise::app
