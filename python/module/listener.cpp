#include "python/module/listener.hpp"

#include <utility>

#include "python/module/conversion.hpp"
#include "python/module/lock.hpp"

namespace poise::python {

Listener::Listener(py::object callable, std::atomic<bool>& interrupt)
    : callable_(std::move(callable)), interrupt_(interrupt) {}

void Listener::operator()(const std::string& doing) {
  wait_where_python_ends();
  const py::gil_scoped_acquire lock;
  const auto now = std::chrono::steady_clock::now();
  if (error_ || now - last_ < std::chrono::milliseconds(100)) return;
  last_ = now;
  try {
    callable_(text_of(doing));
  } catch (py::error_already_set& error) {
    error_.emplace(error);
    interrupt_ = true;
  }
}

void Listener::rethrow() const {
  if (error_) throw py::error_already_set(*error_);
}

}  // namespace poise::python
