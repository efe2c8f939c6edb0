#pragma once

#include "exchange/formats.hpp"

namespace poise {

/// A drawing in DXF of which each layer is a link, the layer GROUND the ground, and coincident points of two layers a
/// pin.
Imported import_dxf(std::string_view text, const std::string& file, const ImportOptions& options);

/// The links, each on its layer, with circles where pins are.
Exported export_dxf(const Scene& scene, const std::vector<BodyPose<double>>& poses);

}  // namespace poise
