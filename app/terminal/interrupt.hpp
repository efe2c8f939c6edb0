#pragma once

#include <atomic>
#include <string>

namespace poise::app {

/// From here on the first Ctrl-C, or the first SIGTERM (of mpirun and of batch systems, before they kill), raises the
/// flag that is returned, so that a search can stop and report what it has reached; the second one ends the program.
const std::atomic<bool>& watch_for_interrupt();

/// While it lives, SIGINT, SIGTERM and SIGHUP remove a file before they end the program: one that has no meaning to
/// anybody else. Signals that the program handles itself, or ignores, are left to it, and the others are again what
/// they were when the last of these objects is gone.
class RemovedAtEnd {
 public:
  explicit RemovedAtEnd(std::string file);
  ~RemovedAtEnd();
  RemovedAtEnd(const RemovedAtEnd&) = delete;
  RemovedAtEnd& operator=(const RemovedAtEnd&) = delete;

 private:
  std::string file_;
};

}  // namespace poise::app
