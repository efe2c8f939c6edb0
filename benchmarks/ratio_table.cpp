#include "benchmarks/ratio_table.hpp"

#include <fmt/format.h>

#include "benchmarks/timing.hpp"

namespace poise::benchmarks {

void RatioTable::head() const {
  fmt::print("{:<46}{:>12}{:>12}{:>9}{:>8}\n", "", "Poise", "yardstick", "ratio", "limit");
}

void RatioTable::ratio(const std::string& name, double ours, double theirs, double limit, bool right,
                       const std::string& note) {
  row(name, ours, theirs, fmt::format("{:.2f}", ours / theirs), fmt::format("{:.3g}", limit), ours <= limit * theirs,
      right, note);
}

void RatioTable::speedup(const std::string& name, double ours, double theirs, double least, bool right,
                         const std::string& note) {
  row(name, ours, theirs, fmt::format("{:.1f} x", theirs / ours), fmt::format(">= {:.3g}", least),
      theirs >= least * ours, right, note);
}

void RatioTable::row(const std::string& name, double ours, double theirs, const std::string& ratio,
                     const std::string& limit, bool met, bool right, const std::string& note) {
  all_right_ = all_right_ && right;
  if (!right) {
    fmt::print("{:<46}{:>41}  WRONG   {}\n", name, "", note);
    return;
  }
  fmt::print("{:<46}{:>12}{:>12}{:>9}{:>8}  {:<8}{}\n", name, in_units(ours), in_units(theirs), ratio, limit,
             met ? "met" : "MISSED", note);
}

}  // namespace poise::benchmarks
