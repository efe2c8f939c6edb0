#pragma once

#include <chrono>
#include <optional>

namespace poise::solvers {

/// While one lives, long computations of the current thread that report their work to it end themselves where it is
/// used up; they then prove nothing. The limit is a number of operations, the same however busy the machine is, or
/// seconds in their place where a person asked for them.
class WorkLimit {
 public:
  WorkLimit(double operations, std::optional<double> seconds) : before_(current), operations_(operations) {
    if (seconds) {
      end_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(*seconds));
    }
    current = this;
  }
  ~WorkLimit() { current = before_; }
  WorkLimit(const WorkLimit&) = delete;
  WorkLimit& operator=(const WorkLimit&) = delete;

  /// Whether so many operations more are allowed, which then count as done.
  static bool allows(double operations) { return current == nullptr || current->take(operations); }

  /// Some computation was denied its operations.
  bool exceeded() const { return exceeded_; }

 private:
  using Clock = std::chrono::steady_clock;

  bool take(double operations) {
    if (end_) {
      exceeded_ = exceeded_ || Clock::now() > *end_;
    } else {
      operations_ -= operations;
      exceeded_ = exceeded_ || operations_ < 0.0;
    }
    return !exceeded_;
  }

  inline static thread_local WorkLimit* current = nullptr;

  WorkLimit* before_;
  double operations_;
  std::optional<Clock::time_point> end_{};
  bool exceeded_ = false;
};

}  // namespace poise::solvers
