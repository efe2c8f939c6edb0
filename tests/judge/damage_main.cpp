// poise_damage: damaged records, which identification must tell the cause of, or bear.
//
//   poise_damage [SEED] [WORD]
//
// Judges all kinds of damage, or those whose bench or kind contains the word; prints what came of each and a summary.
// Exit code 1 if any is wrong, or told with another cause only.

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <string>

#include <fmt/format.h>

#include "identification/fit/fit.hpp"
#include "tests/judge/damaged_records.hpp"

int main(int argc, char** argv) {
  using namespace poise::judge;
  const auto seed = static_cast<std::uint64_t>(argc > 1 ? std::atoll(argv[1]) : 1);
  const std::string word = argc > 2 ? argv[2] : "";
  poise::quiet_ceres();
  int kinds = 0, harmless = 0, told = 0, not_to_tell = 0, bad = 0;
  for (const Damage& damage : damages()) {
    const std::string name = damage.bench + ", " + damage.kind;
    if (name.find(word) == std::string::npos) continue;
    ++kinds;
    const auto begun = std::chrono::steady_clock::now();
    JudgedDamage judged;
    try {
      judged = judge_damage(damage, seed);
    } catch (const std::exception& error) {
      judged = {JudgedDamage::Outcome::wrong, error.what()};
    }
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begun;
    harmless += judged.outcome == JudgedDamage::Outcome::harmless;
    told += judged.outcome == JudgedDamage::Outcome::told;
    not_to_tell += judged.outcome == JudgedDamage::Outcome::wrong && judged.is_right(damage);
    bad += !judged.is_right(damage);
    fmt::print("{:<28} {:<20} {:5.1f} s  {}{}\n", name, to_string(judged.outcome), took.count(),
               judged.words.substr(0, 400),
               damage.undetectable.empty() ? "" : " [cannot be told: " + damage.undetectable + "]");
    std::fflush(stdout);
  }
  fmt::print("{} kinds of damage: {} harmless, {} told, {} wrong that nothing can tell, {} bad\n", kinds, harmless,
             told, not_to_tell, bad);
  return bad > 0 ? 1 : 0;
}
