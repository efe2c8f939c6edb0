#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

namespace poise::app {

/// Shows what is being done: one line on standard error, after the first second, removed when it is done.
/// Silent where standard error is no terminal. Where somebody listens it is told to that function at once, and not
/// shown.
class Progress {
 public:
  explicit Progress(std::function<void(const std::string&)> listener = {});
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// From now on this is being done: "refining in 50 digits".
  void now(std::string doing);
  /// The same of what is called often, ten times a second at most; `doing` makes the text.
  void now_and_then(const std::function<std::string()>& doing);
  /// Removes the line, before something else is printed.
  void done();

 private:
  void watch(const std::stop_token& stop);

  std::mutex mutex_;
  std::condition_variable_any woken_;
  std::function<void(const std::string&)> listener_;
  std::string doing_;
  std::chrono::steady_clock::time_point last_{};  // of now_and_then()
  std::jthread watcher_;
};

}  // namespace poise::app
