#pragma once

#include <atomic>

namespace poise::app {

/// From here on the first Ctrl-C, or the first SIGTERM (of mpirun and of batch systems, before they kill), raises the
/// flag that is returned, so that a search can stop and report what it has reached; the second one ends the program.
const std::atomic<bool>& watch_for_interrupt();

}  // namespace poise::app
