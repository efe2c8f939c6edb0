#pragma once

#include <optional>

#include "app/result/result.hpp"
#include "design/balance/balance_problem.hpp"
#include "design/balance/near_balance.hpp"
#include "design/balance/shaking_balance.hpp"
#include "design/balance/weight_balance.hpp"

namespace poise::app {

/// What `poise design` shows of weights that springs balance: in every pose, or, where only a range was asked for or
/// nothing else is left, nearly over that.
Result weight_balance_result(const BalanceProblem& problem, const std::optional<WeightBalance>& exact,
                             const std::optional<NearBalance>& nearly);

/// What it shows of counterweights.
Result shaking_balance_result(const BalanceProblem& problem, const ShakingBalance& found);

}  // namespace poise::app
