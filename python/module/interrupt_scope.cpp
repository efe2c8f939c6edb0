#include "python/module/interrupt_scope.hpp"

#include <cstdint>
#include <ctime>

#include <pybind11/pybind11.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace py = pybind11;

namespace poise::python {
namespace {

constexpr std::int64_t at_once = 2'000'000'000;  // ns: between two Ctrl-C that mean more than one call

std::atomic<std::atomic<bool>*> raised_by_signal = nullptr;
std::atomic<bool> was_signal = false;
std::atomic<std::int64_t> last_signal = 0;  // ns
struct sigaction of_python {};

bool is_main_thread() { return ::syscall(SYS_gettid) == ::getpid(); }

bool has_handler_of_python() {
  const py::module_ signal = py::module_::import("signal");
  return signal.attr("getsignal")(SIGINT).is(signal.attr("default_int_handler"));
}

void on_interrupt(int signal) {
  std::atomic<bool>* const flag = raised_by_signal;
  timespec clock{};
  ::clock_gettime(CLOCK_MONOTONIC, &clock);
  const std::int64_t now = std::int64_t{clock.tv_sec} * 1'000'000'000 + clock.tv_nsec;
  const bool again = last_signal != 0 && now - last_signal <= at_once;
  last_signal = now;
  const bool is_first = flag != nullptr && !flag->exchange(true);
  was_signal = true;
  if (again || !is_first) of_python.sa_handler(signal);
}

}  // namespace

InterruptScope::InterruptScope(std::atomic<bool>& flag) : flag_(flag) {
  if (!is_main_thread()) return;
  if (raised_by_signal.load() == nullptr && !has_handler_of_python()) return;
  is_installed_ = true;
  outer_ = raised_by_signal.exchange(&flag_);
  if (outer_ != nullptr) return;
  was_signal = false;
  struct sigaction ours {};
  ours.sa_handler = on_interrupt;
  ::sigemptyset(&ours.sa_mask);
  ::sigaction(SIGINT, &ours, &of_python);
}

InterruptScope::~InterruptScope() {
  if (!is_installed_) return;
  raised_by_signal = outer_;
  if (outer_ == nullptr) ::sigaction(SIGINT, &of_python, nullptr);
}

void InterruptScope::hand_back_unless(bool is_told) const {
  if (is_installed_ && was_signal && flag_ && !is_told) PyErr_SetInterrupt();
}

}  // namespace poise::python
