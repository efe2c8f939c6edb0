#pragma once

#include <string>
#include <vector>

#include "app/draw/figure.hpp"
#include "app/draw/mechanism.hpp"
#include "statics/equilibrium/link_loads.hpp"
#include "statics/paths/loads_along.hpp"

namespace poise::app {

/// Normal force, shear force, bending moment and deflection of links, each drawn on the mechanism, one picture below
/// the other, as an SVG document. `heading` is the verdict, a warning where it is not `confirmed`.
std::string loads_picture(const Scene& scene, const Poses& poses, const std::vector<LinkLoads>& links,
                          const std::string& heading, bool confirmed);

/// The same pictures side by side.
Figure loads_figure(const Scene& scene, const Poses& poses, const std::vector<LinkLoads>& links, bool confirmed);

/// Over the range of a number, of which there are loads, with `panels` over it: the bending moment of the links, where
/// none bends the normal force, drawn on the mechanism; of scenes without links the forces of the joints.
Figure loads_figure(const VariedScene& varied, const LoadsAlong& answer, std::vector<Panel> panels, bool confirmed);

}  // namespace poise::app
