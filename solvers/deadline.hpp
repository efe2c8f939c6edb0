#pragma once

#include <chrono>

namespace poise::solvers {

/// While one lives, long computations of the current thread that look at it end themselves after so many seconds; they
/// then prove nothing.
class Deadline {
 public:
  explicit Deadline(double seconds)
      : before_(current_end),
        end_of_this_(std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                                            std::chrono::duration<double>(seconds))) {
    current_end = &end_of_this_;
  }
  ~Deadline() { current_end = before_; }
  Deadline(const Deadline&) = delete;
  Deadline& operator=(const Deadline&) = delete;

  static bool passed() { return current_end != nullptr && std::chrono::steady_clock::now() > *current_end; }

 private:
  using Time = std::chrono::steady_clock::time_point;
  inline static thread_local const Time* current_end = nullptr;

  const Time* before_;
  Time end_of_this_;
};

}  // namespace poise::solvers
