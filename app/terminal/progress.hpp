#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace poise::app {

/// Tells a person who waits what is going on: one line on standard error, from one second on, gone when it is done.
/// Silent where standard error is no terminal.
class Progress {
 public:
  Progress();
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// From now on this is being done: "refining in 50 digits".
  void now(std::string doing);
  /// Takes the line away, before something else is printed.
  void done();

 private:
  void watch(const std::stop_token& stop);

  std::mutex mutex_;
  std::condition_variable_any woken_;
  std::string doing_;
  std::jthread watcher_;
};

}  // namespace poise::app
