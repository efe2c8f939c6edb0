#pragma once

#include <chrono>

namespace poise::solvers {

/// While one lives, long computations of the current thread that look at it end themselves after so many seconds; they
/// then prove nothing.
class Deadline {
 public:
  explicit Deadline(double seconds)
      : before_(end_),
        end_of_this_(std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                                            std::chrono::duration<double>(seconds))) {
    end_ = &end_of_this_;
  }
  ~Deadline() { end_ = before_; }
  Deadline(const Deadline&) = delete;
  Deadline& operator=(const Deadline&) = delete;

  static bool passed() { return end_ != nullptr && std::chrono::steady_clock::now() > *end_; }

 private:
  using Time = std::chrono::steady_clock::time_point;
  inline static thread_local const Time* end_ = nullptr;

  const Time* before_;
  Time end_of_this_;
};

}  // namespace poise::solvers
