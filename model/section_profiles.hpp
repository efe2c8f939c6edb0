#pragma once

// Cross-sections by name. Private to the readers of model/.

#include <string>
#include <vector>

#include "model/toml_reader.hpp"

namespace poise {

/// What a profile is to a beam that bends about its axis of symmetry; SI.
struct SectionProfile {
  double area = 0.0, second_moment = 0.0, height = 0.0;
};

/// The profile that a text names; fails with the nearest name or what was expected of a dimension.
///
///   "IPE 80", "HEA 100", "HEB 100"  doubly symmetric I of EN 10365 (h, b, t_w, t_f, r), bent in the plane of its web:
///     A = 2 b t_f + (h - 2 t_f) t_w + (4 - pi) r^2
///     I = (b h^3 - (b - t_w) (h - 2 t_f)^3) / 12 + 4 of the fillets, (4 - pi) r^2 in all
///   "rectangle BxH"   A = B H,                   I = B H^3 / 12
///   "round D"         A = pi D^2 / 4,            I = pi D^4 / 64
///   "tube DxT"        the round D without the round D - 2 T
///   "box BxHxT"       the rectangle BxH without the rectangle (B - 2 T)x(H - 2 T)
///
/// Dimensions of shapes are lengths of this unit, H across the axis of bending.
SectionProfile read_profile(const TomlText& text, double length_unit);

/// All names of rolled sections.
std::vector<std::string> rolled_sections();

}  // namespace poise
