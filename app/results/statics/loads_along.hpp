#pragma once

#include <string>
#include <vector>

#include "app/draw/chart/plot.hpp"
#include "app/result/result.hpp"
#include "statics/paths/loads_along.hpp"

namespace poise::app {

/// Whether what `poise loads --vary` found is complete: the path is traced and all its points are proved, or a
/// structure is in balance; every body is in balance and every link has its internal loads.
bool is_complete(const LoadsAlong& answer);

/// What `poise loads` shows over a range: the smallest and the largest force of every joint, and the largest internal
/// loads of every link, each with the value of the varied number at which it is so large. All values in CSV.
Result loads_along_result(const VariedScene& varied, const LoadsAlong& answer,
                          const std::vector<std::string>& settings);

/// The sizes of joint forces over the varied number, and the largest bending moments of links.
std::vector<Panel> loads_along_panels(const VariedScene& varied, const LoadsAlong& answer);

}  // namespace poise::app
