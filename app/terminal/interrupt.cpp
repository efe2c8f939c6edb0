#include "app/terminal/interrupt.hpp"

#include <array>
#include <cerrno>
#include <csignal>
#include <utility>

#include <unistd.h>

namespace poise::app {
namespace {

static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler must not wait for a lock");
static_assert(std::atomic<const char*>::is_always_lock_free, "nor a signal handler that removes files");

std::atomic<bool> watched = false, interrupted = false;
std::array<std::atomic<const char*>, 32> removed_files{};  // more than any command writes at once

void on_end(int signal) {
  const int error = errno;
  const bool is_first = watched && signal != SIGHUP && !interrupted.exchange(true);
  if (!is_first) {
    for (const std::atomic<const char*>& file : removed_files) {
      if (const char* const path = file.load(); path != nullptr) ::unlink(path);
    }
    std::signal(signal, SIG_DFL);
    std::raise(signal);  // it ends the program when this function returns
  }
  errno = error;
}

/// Unless it is ignored, as nohup and shells have background jobs do.
void handle_where_it_ends_the_program(int signal) {
  struct sigaction now {};
  if (::sigaction(signal, nullptr, &now) == 0 && now.sa_handler == SIG_DFL) std::signal(signal, on_end);
}

}  // namespace

const std::atomic<bool>& watch_for_interrupt() {
  watched = true;
  std::signal(SIGINT, on_end);
  std::signal(SIGTERM, on_end);
  return interrupted;
}

RemovedAtEnd::RemovedAtEnd(std::string file) : file_(std::move(file)) {
  for (std::atomic<const char*>& place : removed_files) {
    const char* free = nullptr;
    if (place.compare_exchange_strong(free, file_.c_str())) break;
  }
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) handle_where_it_ends_the_program(signal);
}

RemovedAtEnd::~RemovedAtEnd() {
  for (std::atomic<const char*>& place : removed_files) {
    const char* own = file_.c_str();
    if (place.compare_exchange_strong(own, nullptr)) break;
  }
}

}  // namespace poise::app
