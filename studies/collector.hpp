#pragma once

// Private to this folder.

#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <vector>

#include "studies/study.hpp"
#include "studies/study_folder.hpp"

namespace poise::studies {

/// The rows of a chunk, one behind the other; fewer than it has samples where the work was interrupted.
struct ChunkResult {
  std::uint64_t chunk = 0;
  std::vector<double> rows;
};

/// Takes the results of threads and ranks as they come, stores them and passes their rows on in the order of the
/// samples. put() and report() are for several threads.
class Collector {
 public:
  using Collect = std::function<void(std::uint64_t sample, const double* row)>;

  /// Throws InputError as run_study(). Keeps references to all of these.
  Collector(const Study& study, const StudyOptions& options, const Collect& collect);

  /// The chunks that are to be computed, ascending.
  std::vector<std::uint64_t> missing() const;
  void put(ChunkResult result);
  /// Shows the progress after so many further samples.
  void report(std::uint64_t samples);
  /// Passes on what is left, behind gaps too; to be called at the end.
  StudyOutcome finish();

 private:
  std::uint64_t samples_of(std::uint64_t chunk) const;
  void collect_in_order();
  bool collect_next();

  const Study& study_;
  const StudyOptions& options_;
  const Collect& collect_;
  std::uint64_t chunks_;
  std::uint64_t next_;  // chunk to pass on
  std::optional<StudyFolder> folder_;
  std::map<std::uint64_t, std::vector<double>> waiting_;  // for those before them, where no folder has them
  StudyOutcome outcome_;
  std::uint64_t known_ = 0;  // samples computed or read
  std::mutex mutex_;
};

}  // namespace poise::studies
