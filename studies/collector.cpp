#include "studies/collector.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace poise::studies {

Collector::Collector(const Study& study, const StudyOptions& options, const Collect& collect)
    : study_(study),
      options_(options),
      collect_(collect),
      chunks_((study.samples + study.chunk() - 1) / study.chunk()),
      next_(options.shard - 1) {
  if (!options.folder.empty()) folder_.emplace(study, options);
  for (std::uint64_t c = next_; c < chunks_; c += options.shards) {
    outcome_.asked += samples_of(c);
    if (folder_ && folder_->has(c)) known_ += samples_of(c);
  }
  if (folder_) outcome_.warnings = folder_->warnings();
}

std::uint64_t Collector::samples_of(std::uint64_t chunk) const {
  return std::min(study_.samples - chunk * study_.chunk(), study_.chunk());
}

std::vector<std::uint64_t> Collector::missing() const {
  std::vector<std::uint64_t> out;
  for (std::uint64_t c = options_.shard - 1; c < chunks_; c += options_.shards) {
    if (!folder_ || !folder_->has(c)) out.push_back(c);
  }
  return out;
}

void Collector::put(ChunkResult result) {
  const std::scoped_lock lock(mutex_);
  const std::uint64_t samples = result.rows.size() / study_.columns.size();
  // Files have whole chunks only.
  if (samples == 0 || (folder_ && samples < samples_of(result.chunk))) return;
  outcome_.computed += samples;
  if (folder_) {
    folder_->append(result.chunk, result.rows);
  } else {
    waiting_.emplace(result.chunk, std::move(result.rows));
  }
  collect_in_order();
}

void Collector::report(std::uint64_t samples) {
  const std::scoped_lock lock(mutex_);
  known_ += samples;
  if (options_.progress) options_.progress(known_);
}

StudyOutcome Collector::finish() {
  for (; next_ < chunks_; next_ += options_.shards) collect_next();
  outcome_.interrupted = outcome_.done < outcome_.asked;
  return outcome_;
}

void Collector::collect_in_order() {
  while (next_ < chunks_ && collect_next()) next_ += options_.shards;
}

/// False where chunk next_ is not there yet.
bool Collector::collect_next() {
  std::vector<double> rows;
  if (folder_ && folder_->has(next_)) {
    rows = folder_->read(next_);
  } else if (auto found = waiting_.extract(next_)) {
    rows = std::move(found.mapped());
  } else {
    return false;
  }
  const std::size_t columns = study_.columns.size();
  for (std::size_t row = 0; row < rows.size() / columns; ++row) {
    collect_(next_ * study_.chunk() + row, &rows[row * columns]);
    ++outcome_.done;
  }
  return true;
}

}  // namespace poise::studies
