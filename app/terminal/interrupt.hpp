#pragma once

#include <atomic>

namespace poise::app {

/// From here on the first Ctrl-C raises the flag that is returned, so that a search can stop and tell what it has
/// reached; the second one kills as usual.
const std::atomic<bool>& watch_for_interrupt();

}  // namespace poise::app
