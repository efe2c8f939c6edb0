#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace poise::judge {

/// A kind of damage to the records of an experiment on a known mechanism.
struct Damage {
  std::string bench;  ///< "swing", "driven", "double" or "lift": whose records
  std::string kind;
  /// A word of the line that tells its cause; empty where the damage is to be harmless.
  std::string told_by;
  /// Why nothing in the data can tell, where it is so: the estimates may then be wrong.
  std::string undetectable{};
};

/// All kinds: 64 of them or more.
const std::vector<Damage>& damages();

/// What came of one.
struct JudgedDamage {
  enum class Outcome {
    harmless,   ///< believed, and every true value is within 4.5 standard errors of its estimate
    told,       ///< refused, or not believed, with the cause in one of the lines
    told_else,  ///< the same with another cause only
    wrong       ///< believed, but a true value is not within its interval
  };
  Outcome outcome = Outcome::harmless;
  std::string words;  ///< what was said, or the estimate that is wrong

  /// As the kind is to be judged.
  bool is_right(const Damage& damage) const;
};

std::string to_string(JudgedDamage::Outcome outcome);

/// Simulates the bench's runs with noise, damages them, writes them in a folder of their own and identifies.
JudgedDamage judge_damage(const Damage& damage, std::uint64_t seed);

}  // namespace poise::judge
