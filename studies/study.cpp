#include "studies/study.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <exception>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>

#include "model/input_error.hpp"
#include "solvers/parallel.hpp"
#include "studies/chunk_queue.hpp"
#include "studies/collector.hpp"
#include "studies/message.hpp"

namespace poise::studies {
namespace {

/// The threads of this process that compute chunks.
class Team {
 public:
  Team(const Study& study, const StudyOptions& options)
      : study_(study), options_(options), threads_(solvers::threads_of(options.jobs)) {}

  int threads() const { return threads_; }
  ChunkQueue& queue() { return queue_; }
  solvers::FirstError& error() { return error_; }
  bool stopped() const { return error_.any() || (options_.interrupt != nullptr && options_.interrupt->load()); }

  /// One thread: computes chunks of the queue until that is closed and empty; once stopped() it only empties it. Calls
  /// `report` for every sample and `deliver` for every chunk.
  void work(const std::function<void(std::uint64_t samples)>& report, const std::function<void(ChunkResult)>& deliver) {
    while (const std::optional<std::uint64_t> chunk = queue_.pop()) {
      ChunkResult result{*chunk, {}};
      const std::uint64_t first = *chunk * study_.chunk();
      const std::uint64_t last = std::min(first + study_.chunk(), study_.samples);
      for (std::uint64_t sample = first; sample < last && !stopped(); ++sample) {
        keeping_errors(sample, [&] {
          const std::vector<double> row = study_.compute(sample);
          if (stopped()) return;  // it may be half a sample
          result.rows.insert(result.rows.end(), row.begin(), row.end());
          report(1);
        });
      }
      keeping_errors(first, [&] { deliver(std::move(result)); });
    }
  }

  template <class Function>
  void keeping_errors(std::uint64_t sample, const Function& function) {
    try {
      function();
    } catch (...) {
      error_.keep(sample, std::current_exception());
    }
  }

 private:
  const Study& study_;
  const StudyOptions& options_;
  int threads_;
  ChunkQueue queue_;
  solvers::FirstError error_;
};

/// What a study is, for comparison.
std::string description(const Study& study) {
  std::string out = fmt::format("{}, {} samples", study.name, study.samples);
  for (const auto& [name, value] : study.identity) out += fmt::format(", {} = {}", name, value);
  return out;
}

/// Messages of other ranks are looked for this often: seldom enough to cost nothing, and every thread has a second
/// chunk to go on with meanwhile.
constexpr auto glance = std::chrono::milliseconds(1);
constexpr std::uint64_t chunks_per_thread = 2;

/// Rank 0, beside its own threads: hands out the chunks of its queue and collects the results.
class Host {
 public:
  Host(const Study& study, Ranks& ranks, Team& team, std::optional<Collector>& collector)
      : study_(study), ranks_(ranks), team_(team), collector_(collector), others_(ranks.size() - 1) {}

  /// Until all other ranks have ended.
  void serve() {
    while (others_ > 0) {
      while (const std::optional<Ranks::Message> message = ranks_.receive()) {
        team_.keeping_errors(0, [&] { answer(*message); });
      }
      std::this_thread::sleep_for(glance);
    }
  }

 private:
  void answer(const Ranks::Message& message) {
    Packed from(message.bytes);
    switch (from.take<Tag>()) {
      case Tag::hello: {
        const auto wanted = from.take<std::uint64_t>();
        if (from.take_text() != description(study_)) {
          const InputError error(
              fmt::format("rank {} was given another study, or is another version; expected the same files and options "
                          "on all ranks",
                          message.from));
          team_.error().keep(0, std::make_exception_ptr(error));
        }
        for (std::uint64_t k = 0; k < wanted; ++k) hand_out(message.from);
        break;
      }
      case Tag::result: {
        const bool wants_more = from.take<bool>();
        const auto chunk = from.take<std::uint64_t>();
        if (wants_more) hand_out(message.from);
        const std::vector<double> rows = from.take_numbers();
        collector_->report(rows.size() / study_.columns.size());
        collector_->put({chunk, rows});
        break;
      }
      case Tag::failed: {
        const auto sample = from.take<std::uint64_t>();
        team_.error().keep(sample, std::make_exception_ptr(std::runtime_error(from.take_text())));
        break;
      }
      case Tag::ended:
        --others_;
        break;
      default:
        break;
    }
  }

  void hand_out(int rank) {
    const std::optional<std::uint64_t> chunk = team_.stopped() ? std::nullopt : team_.queue().try_pop();
    ranks_.send(rank, chunk ? Packed(Tag::chunk).put(*chunk).bytes() : Packed(Tag::nothing).bytes());
  }

  const Study& study_;
  Ranks& ranks_;
  Team& team_;
  std::optional<Collector>& collector_;
  int others_;  // ranks that have not ended
};

/// Another rank, beside its own threads: fetches chunks for them and sends what they deliver.
class Guest {
 public:
  Guest(const Study& study, Ranks& ranks, Team& team) : study_(study), ranks_(ranks), team_(team) {}

  void deliver(ChunkResult result) {
    const std::scoped_lock lock(mutex_);
    delivered_.push_back(std::move(result));
  }

  /// Until rank 0 has no further chunk and all results are sent.
  void serve() {
    std::uint64_t awaited = chunks_per_thread * static_cast<std::uint64_t>(team_.threads());  // answers
    std::uint64_t in_hand = 0;                                                                // chunks
    ranks_.send(0, Packed(Tag::hello).put(awaited).put(description(study_)).bytes());
    while (awaited + in_hand > 0) {
      while (const std::optional<Ranks::Message> message = ranks_.receive()) {
        --awaited;
        Packed answer(message->bytes);
        if (answer.take<Tag>() == Tag::nothing) continue;
        team_.queue().push(answer.take<std::uint64_t>());
        ++in_hand;
      }
      for (const ChunkResult& result : take_delivered()) {
        const bool wants_more = !team_.stopped();
        ranks_.send(0, Packed(Tag::result).put(wants_more).put(result.chunk).put(result.rows).bytes());
        --in_hand;
        if (wants_more) ++awaited;
      }
      std::this_thread::sleep_for(glance);
    }
    team_.queue().close();
    try {
      team_.error().rethrow();
    } catch (const std::exception& error) {
      ranks_.send(
          0, Packed(Tag::failed).put<std::uint64_t>(team_.error().number()).put(std::string(error.what())).bytes());
    }
    ranks_.send(0, Packed(Tag::ended).bytes());
  }

 private:
  std::vector<ChunkResult> take_delivered() {
    const std::scoped_lock lock(mutex_);
    return std::exchange(delivered_, {});
  }

  const Study& study_;
  Ranks& ranks_;
  Team& team_;
  std::mutex mutex_;
  std::vector<ChunkResult> delivered_;
};

/// The part of a rank other than 0.
void run_for_rank_0(const Study& study, Ranks& ranks, Team& team) {
  Guest guest(study, ranks, team);
  solvers::run_threads(1 + team.threads(), [&](int thread) {
    if (thread == 0) {
      guest.serve();
    } else {
      team.work([](std::uint64_t) {}, [&](ChunkResult result) { guest.deliver(std::move(result)); });
    }
  });
}

}  // namespace

std::uint64_t Study::chunk() const {
  constexpr std::uint64_t chunks = 1024, most = 64;
  return std::clamp<std::uint64_t>(samples / chunks, 1, most);
}

StudyOutcome run_study(const Study& study, const StudyOptions& options, const Collector::Collect& collect) {
  Team team(study, options);
  const bool is_shared = options.ranks != nullptr && options.ranks->size() > 1;
  if (is_shared && options.ranks->rank() != 0) {
    run_for_rank_0(study, *options.ranks, team);
    return {};
  }
  std::optional<Collector> collector;
  // Where this fails the other ranks still have to be told that there is nothing to do.
  team.keeping_errors(0, [&] {
    collector.emplace(study, options, collect);
    for (const std::uint64_t chunk : collector->missing()) team.queue().push(chunk);
  });
  team.queue().close();
  const auto work = [&] {
    team.work([&](std::uint64_t samples) { collector->report(samples); },
              [&](ChunkResult result) { collector->put(std::move(result)); });
  };
  if (is_shared) {
    Host host(study, *options.ranks, team, collector);
    solvers::run_threads(1 + team.threads(), [&](int thread) { thread == 0 ? host.serve() : work(); });
  } else {
    solvers::run_threads(team.threads(), [&](int) { work(); });
  }
  team.error().rethrow();
  return collector->finish();
}

}  // namespace poise::studies
