#include "solvers/parallel.hpp"

#include <algorithm>
#include <thread>
#include <utility>
#include <vector>

#include <sched.h>

namespace poise::solvers {

int threads_of(int jobs) {
  if (jobs > 0) return jobs;
  // A batch system or mpirun may have given this process only some of the machine's cores.
  cpu_set_t cores;
  if (sched_getaffinity(0, sizeof(cores), &cores) == 0) return CPU_COUNT(&cores);
  return static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
}

void run_threads(int threads, const std::function<void(int)>& body) {
  std::vector<std::jthread> others;
  for (int t = 1; t < threads; ++t) others.emplace_back(body, t);
  body(0);
}

void FirstError::keep(std::size_t number, std::exception_ptr error) {
  const std::scoped_lock lock(mutex_);
  if (error_ && number_ <= number) return;
  number_ = number;
  error_ = std::move(error);
  any_ = true;
}

void FirstError::rethrow() const {
  if (error_) std::rethrow_exception(error_);
}

std::size_t parallel_for(std::size_t count, const ParallelOptions& options,
                         const std::function<void(std::size_t)>& work) {
  std::atomic<std::size_t> next = 0;
  std::mutex reporting;
  std::size_t done = 0;
  FirstError error;
  const auto stopped = [&] { return error.any() || (options.interrupt != nullptr && options.interrupt->load()); };
  const auto take_items = [&](int) {
    for (std::size_t i = next++; i < count && !stopped(); i = next++) {
      try {
        work(i);
        const std::scoped_lock lock(reporting);
        ++done;
        if (options.progress) options.progress(done);
      } catch (...) {
        error.keep(i, std::current_exception());
      }
    }
  };
  run_threads(static_cast<int>(std::min<std::size_t>(count, static_cast<std::size_t>(threads_of(options.jobs)))),
              take_items);
  error.rethrow();
  return done;
}

}  // namespace poise::solvers
