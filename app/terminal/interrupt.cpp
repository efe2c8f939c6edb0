#include "app/terminal/interrupt.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <mutex>
#include <utility>

#include <unistd.h>

namespace poise::app {
namespace {

static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler must not wait for a lock");
static_assert(std::atomic<const char*>::is_always_lock_free, "nor a signal handler that removes files");

std::atomic<bool> watched = false, interrupted = false;
std::array<std::atomic<const char*>, 32> removed_files{};  // more than any command writes at once
std::mutex handling;                                       // of what RemovedAtEnd does to signals

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

/// What handle_where_it_ends_the_program() has changed; another handler that was put in its place since stays.
void let_it_end_the_program(int signal) {
  struct sigaction now {};
  if (::sigaction(signal, nullptr, &now) == 0 && now.sa_handler == on_end) std::signal(signal, SIG_DFL);
}

}  // namespace

const std::atomic<bool>& watch_for_interrupt() {
  watched = true;
  std::signal(SIGINT, on_end);
  std::signal(SIGTERM, on_end);
  return interrupted;
}

RemovedAtEnd::RemovedAtEnd(std::string file) : file_(std::move(file)) {
  const std::lock_guard<std::mutex> lock(handling);
  for (std::atomic<const char*>& place : removed_files) {
    const char* free = nullptr;
    if (place.compare_exchange_strong(free, file_.c_str())) break;
  }
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) handle_where_it_ends_the_program(signal);
}

RemovedAtEnd::~RemovedAtEnd() {
  const std::lock_guard<std::mutex> lock(handling);
  for (std::atomic<const char*>& place : removed_files) {
    const char* own = file_.c_str();
    if (place.compare_exchange_strong(own, nullptr)) break;
  }
  const bool is_last = std::all_of(removed_files.begin(), removed_files.end(),
                                   [](const std::atomic<const char*>& place) { return place.load() == nullptr; });
  if (!is_last || watched) return;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) let_it_end_the_program(signal);
}

}  // namespace poise::app
