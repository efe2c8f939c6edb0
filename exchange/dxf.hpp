#pragma once

#include <string>
#include <vector>

#include "exchange/formats.hpp"

namespace poise {

/// A drawing in DXF of which each layer is a link, the layer GROUND the ground, and coincident points of two layers a
/// pin.
Imported import_dxf(std::string_view text, const std::string& file, const ImportOptions& options);

/// A position of a scene, whose numbers may be others than in other positions.
struct NamedPosition {
  std::string name;  ///< of its layer
  Scene scene;
  std::vector<BodyPose<double>> poses;
};

/// All positions in one drawing, each on a layer of its own, for people to look at: links cannot be told apart there.
/// The ground is drawn as it is in the first.
Exported export_dxf_positions(const std::vector<NamedPosition>& positions);

/// The links, each on its layer, with circles where pins are.
Exported export_dxf(const Scene& scene, const std::vector<BodyPose<double>>& poses);

}  // namespace poise
