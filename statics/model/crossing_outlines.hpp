#pragma once

#include <vector>

#include "model/mechanism.hpp"
#include "model/scene.hpp"

namespace poise {

/// The first contact between outlines of two bodies that are in one another by more than `deep`, m, with the bodies at
/// these poses, SI; null where there is none. No corner of one need be inside of the other: they may cross as the bars
/// of an X do, which no clearance of a corner tells.
const Stop* crossing_outlines(const Scene& scene, const std::vector<BodyPose<double>>& poses, double deep);

}  // namespace poise
