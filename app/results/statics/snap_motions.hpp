#pragma once

#include "app/results/statics/path.hpp"

namespace poise::app {

/// How the mechanism moves where it snaps: what it hits, how fast, and where and when it comes to rest. Nothing where
/// it was not asked for.
void add_snap_motions(Group& content, const VariedScene& varied, const Path& found, const PathView& view);

}  // namespace poise::app
