#pragma once

#include <atomic>
#include <chrono>
#include <optional>
#include <string>

#include <pybind11/pybind11.h>

namespace poise::python {

/// Tells Python what is being done, ten times a second at most, from any thread. Where that raises an exception the
/// work is stopped, and the exception is Python's when the work has ended.
class Listener {
 public:
  /// `callable` of one text, or None.
  Listener(pybind11::object callable, std::atomic<bool>& interrupt);

  bool is_wanted() const { return !callable_.is_none(); }
  void operator()(const std::string& doing);
  /// Throws what the callable has raised. With the interpreter's lock.
  void rethrow() const;

 private:
  pybind11::object callable_;
  std::atomic<bool>& interrupt_;
  std::chrono::steady_clock::time_point last_{};
  std::optional<pybind11::error_already_set> error_;
};

}  // namespace poise::python
