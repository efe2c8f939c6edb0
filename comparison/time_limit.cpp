#include "comparison/time_limit.hpp"

#include <chrono>

namespace poise::comparison {

TimeLimit::TimeLimit(double seconds, const std::atomic<bool>* other)
    : watcher_([this, seconds, other](const std::stop_token& stop) { watch(stop, seconds, other); }) {}

void TimeLimit::watch(const std::stop_token& stop, double seconds, const std::atomic<bool>* other) {
  constexpr auto glance = std::chrono::milliseconds(20);
  const auto begin = std::chrono::steady_clock::now();
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    const double left = seconds - std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (left <= 0.0 || (other != nullptr && *other)) {
      raised_ = true;
      return;
    }
    const auto wait = std::min<std::chrono::duration<double>>(glance, std::chrono::duration<double>(left));
    woken_.wait_for(lock, stop, wait, [] { return false; });
  }
}

}  // namespace poise::comparison
