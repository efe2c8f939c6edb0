#pragma once

// Mass, centre and inertia of links as the drawing tools "Mass" and "Mass of a plate" write them. With the area A of
// the outline less that of the holes, its polar moment J about its centre, the density per area and unit of thickness r
// and the thickness t
//
//   mass = "r*t*A" or "r*t*(A_outline - pi/4*(d1^2 + ...))",   inertia = "r*t*J"
//
// and of a mass m that is spread over a link, with its radius of gyration i: mass = m, inertia = "m*i^2".

#include <string>
#include <utility>
#include <vector>

#include "model/scene.hpp"
#include "model/scene_text.hpp"

namespace poise::app {

/// What a plate is made of, as TOML.
struct PlateWords {
  std::string thickness;  ///< a number in the scene's length, or an expression
  std::string density;    ///< kg/m^3
  std::string holes;      ///< round points of the link, with their diameters: "A 8, B 6"
};

/// A plate with the outline of the link's points; a hole inside is no corner of it. `grain`: m, of places.
TomlKeys mass_of_plate(const Body& link, const PlateWords& words, const Units& units, double grain);

/// A mass, as TOML, that is spread over a bar or over the polygon of the link's points.
TomlKeys spread_mass(const Body& link, const std::string& mass, const Units& units, double grain);

/// The links whose points are elsewhere than before, and whose masses, centres and inertias were those that one of
/// these tools had written, with what it writes now. Both scenes have the same items.
std::vector<std::pair<std::string, TomlKeys>> masses_that_follow(const Scene& before, const Scene& after, double grain);

}  // namespace poise::app
