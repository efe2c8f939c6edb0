#pragma once

#include "exchange/formats.hpp"

namespace poise {

/// A file of the program Linkage (.linkage2): connectors, links, anchors, inputs and straight sliders.
Imported import_linkage2(std::string_view text, const std::string& file, const ImportOptions& options);

}  // namespace poise
