#include "app/terminal/progress.hpp"

#include <chrono>
#include <cstdlib>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "app/terminal/standard_streams.hpp"

namespace poise::app {
namespace {

using namespace std::chrono_literals;

bool can_be_seen() {
  const char* terminal = std::getenv("TERM");
  return isatty(STDERR_FILENO) == 1 && terminal != nullptr && std::string_view(terminal) != "dumb";
}

constexpr const char* clear_line = "\r\x1b[K";

}  // namespace

Progress::Progress(std::function<void(const std::string&)> listener) : listener_(std::move(listener)) {
  if (!listener_ && can_be_seen()) watcher_ = std::jthread([this](const std::stop_token& stop) { watch(stop); });
}

Progress::~Progress() { done(); }

void Progress::now(std::string doing) {
  const std::lock_guard lock(mutex_);
  doing_ = std::move(doing);
  if (listener_) listener_(doing_);
}

void Progress::now_and_then(const std::function<std::string()>& doing) {
  const auto time = std::chrono::steady_clock::now();
  if (time - last_ < 100ms) return;
  last_ = time;
  now(doing());
}

void Progress::done() {
  if (!watcher_.joinable()) return;
  watcher_.request_stop();
  watcher_.join();
}

void Progress::watch(const std::stop_token& stop) {
  const auto begin = std::chrono::steady_clock::now();
  bool shown = false;
  std::unique_lock lock(mutex_);
  while (!woken_.wait_for(lock, stop, shown ? 200ms : 1000ms, [] { return false; }) && !stop.stop_requested()) {
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(std::chrono::steady_clock::now() - begin);
    say(fmt::format("{}poise: {} ... {} s", clear_line, doing_, seconds.count()));
    shown = true;
  }
  if (shown) say(clear_line);
}

}  // namespace poise::app
