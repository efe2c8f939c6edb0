#pragma once

#include <string>
#include <vector>

#include "app/draw/figure.hpp"
#include "statics/all_equilibria/all_equilibria.hpp"
#include "statics/model/static_model.hpp"

namespace poise::app {

/// The mechanism in all equilibria of a set that has some, side by side in one scale and frame (SVG); of many the
/// first, those of least energy. `captions` has a line for each, `heading` is the verdict, a warning where it is not
/// `confirmed`.
std::string equilibria_picture(const StaticModel& model, const EquilibriumSet& set,
                               const std::vector<std::string>& captions, const std::string& heading, bool confirmed);

/// The same as cards, 20 to 200 at most, so that a page can hold them; `captions` as above.
Figure equilibria_figure(const StaticModel& model, const EquilibriumSet& set, const std::vector<std::string>& captions);

}  // namespace poise::app
