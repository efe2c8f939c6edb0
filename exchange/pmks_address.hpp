#pragma once

#include "exchange/formats.hpp"

namespace poise {

/// The address in which the program PMKS+ keeps a mechanism: links, pins, sliders, masses and forces, with 1/1000 of a
/// unit. The text is the address alone, its part behind the question mark, or a shortcut with a line URL=.
Imported import_pmks_address(std::string_view text, const std::string& file, const ImportOptions& options);

/// Such an address. Springs, stops, couplings and all else that moves nothing by itself is left out.
Exported export_pmks_address(const Scene& scene, const std::vector<BodyPose<double>>& poses);

}  // namespace poise
