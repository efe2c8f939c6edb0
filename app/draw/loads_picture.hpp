#pragma once

#include <string>
#include <vector>

#include "app/draw/figure.hpp"
#include "app/draw/mechanism.hpp"
#include "statics/equilibrium/link_loads.hpp"

namespace poise::app {

/// Normal force, shear force, bending moment and deflection of links, each drawn on the mechanism, one picture below
/// the other, as an SVG document. `heading` is the verdict, a warning where it is not `confirmed`.
std::string loads_picture(const Scene& scene, const Poses& poses, const std::vector<LinkLoads>& links,
                          const std::string& heading, bool confirmed);

/// The same pictures side by side.
Figure loads_figure(const Scene& scene, const Poses& poses, const std::vector<LinkLoads>& links, bool confirmed);

}  // namespace poise::app
