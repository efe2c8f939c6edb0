#pragma once

#include <string>

#include "app/palette.hpp"
#include "motion/design.hpp"

namespace poise::app {

/// What `poise design` prints: what was found and after how many starts, what it does against the goals, and the
/// dimensions, in the units of the scene. `check` where anything was found.
std::string design_report(const DesignProblem& problem, const DesignResult& result, const DesignCheck& check,
                          double microseconds, const Palette& palette);

/// The same as a JSON object: poise, design {file, title, source}, units {...}, met, why, starts, evaluations, seed,
/// goals and facts {travel, drift, inclination (rad), transmission {pin: rad}, actuators [{name, shortest, longest,
/// least_lever}], shortest, longest, closeness_to_singular}, drive {body, from, to: rad}, points {body.point: [x, y]}.
std::string design_json(const DesignProblem& problem, const DesignResult& result, const DesignCheck& check,
                        std::uint64_t seed);

}  // namespace poise::app
