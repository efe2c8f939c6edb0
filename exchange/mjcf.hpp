#pragma once

// MJCF, the files of MuJoCo: a tree of bodies with hinges and slides, which equalities close to loops.

#include "exchange/formats.hpp"

namespace poise {

Imported import_mjcf(std::string_view text, const std::string& file, const ImportOptions& options);

/// The x axis of the scene is x of the file, y is z. The pose that the file draws is the one of `poses`, from which
/// loops are closed. Throws InputError naming what MJCF does not have.
Exported export_mjcf(const Scene& scene, const std::vector<BodyPose<double>>& poses);

}  // namespace poise
