#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "studies/ranks.hpp"

namespace poise::studies {

/// Many samples that are computed each by itself: trials of a Monte Carlo study, say. A sample is a row of numbers, one
/// for each column, and depends on its index alone (solvers/random_stream.hpp).
struct Study {
  std::string name;  ///< what it is: "montecarlo"
  /// What its numbers depend on, each with a name: {"seed", "1"}. Files of a study with other values are refused.
  std::vector<std::pair<std::string, std::string>> identity;
  std::vector<std::string> columns;
  std::uint64_t samples = 0;
  /// The numbers of one sample; called by several threads at once.
  std::function<std::vector<double>(std::uint64_t sample)> compute;

  /// Samples are handed out, and stored, in chunks of this many: at most about a thousand chunks, or 64 samples each.
  std::uint64_t chunk() const;
};

struct StudyOptions {
  int jobs = 0;                                  ///< threads of each process; 0: all its cores
  const std::atomic<bool>* interrupt = nullptr;  ///< chunks that are not complete are then lost, where files are kept
  std::function<void(std::uint64_t done)> progress{};  ///< with the samples there are; by one thread at a time
  Ranks* ranks = nullptr;                              ///< the processes that share the work; null: this one alone
  std::string folder{};                                ///< where files are kept; empty: none are
  bool resume = false;                                 ///< go on with what the folder has, if anything
  std::uint64_t shard = 1, shards = 1;                 ///< compute part `shard`, from 1, of so many
};

struct StudyOutcome {
  std::uint64_t asked = 0;     ///< samples of this shard
  std::uint64_t done = 0;      ///< of these: computed now or read from the folder
  std::uint64_t computed = 0;  ///< of these: computed now
  bool interrupted = false;
  std::vector<std::string> warnings;  ///< of damaged files
};

/// Computes the samples of a study that its folder does not have and passes all of them to `collect`, in the order of
/// their index: for any number of threads and ranks, and however often the study was interrupted, with the same bits.
/// Memory does not grow with the number of samples. On ranks other than 0 nothing is collected and no file written.
///
/// Throws what the lowest sample that failed has thrown, and InputError where the folder has files and is not to be
/// resumed, where these belong to another study, and where ranks were given different ones.
StudyOutcome run_study(const Study& study, const StudyOptions& options,
                       const std::function<void(std::uint64_t sample, const double* row)>& collect);

}  // namespace poise::studies
