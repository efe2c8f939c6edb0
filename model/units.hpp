#pragma once

#include <string>

namespace poise {

/// SI values of the units of a scene file. Every number in a Scene is SI (m, N, kg, rad); the units are kept to show
/// results in the units of the file.
struct Units {
  std::string length_name = "m";
  std::string force_name = "N";
  std::string mass_name = "kg";
  std::string angle_name = "rad";
  double length = 1.0;
  double force = 1.0;
  double mass = 1.0;
  double angle = 1.0;
};

/// The names by which units are chosen, those of [units] in a scene file: m, mm, in, ft; N, kN, lbf; kg, g, lb; rad,
/// deg.
struct UnitNames {
  std::string length = "m";
  std::string force = "N";
  std::string mass = "kg";
  std::string angle = "rad";
};

/// The units of these names. Throws InputError naming those there are where one is unknown.
Units units_of(const UnitNames& names);

}  // namespace poise
