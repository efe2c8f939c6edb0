#pragma once

// Which numbers of a scene its equilibria depend on.

#include "model/parameters.hpp"
#include "model/scene.hpp"

namespace poise {

/// Whether equilibria may depend on a number: not on those of drives, guesses and friction in joints, moments of
/// inertia, and elements that store no energy; on a named one where they do on something that follows from it.
bool acts_in_statics(const Scene& scene, const ParameterPlace& place);

}  // namespace poise
