#pragma once

#include <string>

namespace poise::benchmarks {

/// Prints times beside yardsticks, each ratio with its limit. Times of wrong answers are not printed.
class RatioTable {
 public:
  void head() const;

  void ratio(const std::string& name, double ours, double theirs, double limit, bool right, const std::string& note);

  /// How many times slower the yardstick is.
  void speedup(const std::string& name, double ours, double theirs, double least, bool right, const std::string& note);

  bool all_right() const { return all_right_; }

 private:
  void row(const std::string& name, double ours, double theirs, const std::string& ratio, const std::string& limit,
           bool met, bool right, const std::string& note);

  bool all_right_ = true;
};

}  // namespace poise::benchmarks
