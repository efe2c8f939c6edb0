#pragma once

#include "exchange/formats.hpp"

namespace poise {

/// A list of joints as the program PMKS reads it: in each line the names of the links that a joint joins, R, P or RP,
/// its place, of P and RP the direction of the slide in degrees, and flags. The link "ground" is the ground.
Imported import_pmks_text(std::string_view text, const std::string& file, const ImportOptions& options);

}  // namespace poise
