#pragma once

#include <atomic>
#include <csignal>

namespace poise::python {

/// While it lives in the main thread, Ctrl-C raises a flag, so that the work stops and Python gets what it has. One
/// that follows within two seconds is Python's too, which raises KeyboardInterrupt when the work returns, so that a
/// loop over calls ends. In other threads, which Python has no signals for, and where the program has a handler of its
/// own, it does nothing. Begins and ends with the lock of the interpreter.
class InterruptScope {
 public:
  explicit InterruptScope(std::atomic<bool>& flag);
  ~InterruptScope();
  InterruptScope(const InterruptScope&) = delete;
  InterruptScope& operator=(const InterruptScope&) = delete;

  /// At the end of the work: where Ctrl-C came and what the work gives does not say so, it is Python's.
  void hand_back_unless(bool is_told) const;

 private:
  std::atomic<bool>& flag_;
  bool is_installed_ = false;
  std::atomic<bool>* outer_ = nullptr;
};

}  // namespace poise::python
