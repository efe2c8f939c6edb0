#pragma once

// Private to this folder.

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>

namespace poise::studies {

/// Chunks that wait to be computed by the threads of this process.
class ChunkQueue {
 public:
  void push(std::uint64_t chunk) {
    const std::scoped_lock lock(mutex_);
    chunks_.push_back(chunk);
    changed_.notify_one();
  }
  /// Nothing will be pushed any more.
  void close() {
    const std::scoped_lock lock(mutex_);
    closed_ = true;
    changed_.notify_all();
  }
  /// Waits for a chunk; none when the queue is closed and empty.
  std::optional<std::uint64_t> pop() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return closed_ || !chunks_.empty(); });
    return front();
  }
  /// None where the queue is empty at this moment.
  std::optional<std::uint64_t> try_pop() {
    const std::scoped_lock lock(mutex_);
    return front();
  }

 private:
  std::optional<std::uint64_t> front() {
    if (chunks_.empty()) return std::nullopt;
    const std::uint64_t chunk = chunks_.front();
    chunks_.pop_front();
    return chunk;
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::uint64_t> chunks_;
  bool closed_ = false;
};

}  // namespace poise::studies
