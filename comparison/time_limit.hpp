#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace poise::comparison {

/// A flag that is set after a time limit, or shortly after another flag.
class TimeLimit {
 public:
  /// `other` may be null, or must outlive this.
  TimeLimit(double seconds, const std::atomic<bool>* other);

  const std::atomic<bool>& raised() const { return raised_; }

 private:
  void watch(const std::stop_token& stop, double seconds, const std::atomic<bool>* other);

  std::atomic<bool> raised_ = false;
  std::mutex mutex_;
  std::condition_variable_any woken_;
  std::jthread watcher_;  // last: it uses all the others
};

}  // namespace poise::comparison
