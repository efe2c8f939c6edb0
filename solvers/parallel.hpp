#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>

namespace poise::solvers {

/// The number of threads that `jobs` stands for: itself, or where it is 0 the cores that this process may run on.
int threads_of(int jobs);

/// Calls body(0) .. body(threads - 1), each on a thread of its own, body(0) on the caller's, and returns when all have
/// ended. `body` must not throw.
void run_threads(int threads, const std::function<void(int thread)>& body);

/// Of the exceptions thrown by numbered pieces of work on several threads, that of the lowest number.
class FirstError {
 public:
  bool any() const { return any_; }
  std::size_t number() const { return number_; }
  void keep(std::size_t number, std::exception_ptr error);
  /// Throws it again, if there is one.
  void rethrow() const;

 private:
  std::mutex mutex_;
  std::atomic<bool> any_ = false;
  std::size_t number_ = 0;
  std::exception_ptr error_;
};

struct ParallelOptions {
  int jobs = 0;  ///< threads; 0: as many as there are cores
  const std::atomic<bool>* interrupt = nullptr;
  std::function<void(std::size_t done)> progress{};  ///< after every item; by one thread at a time
};

/// Calls work(0) .. work(count - 1), begun in this order, on several threads. An interrupt and an exception let the
/// items that have begun end, and no other begin. Returns how many were done. Throws what the lowest item that failed
/// has thrown: the same for any number of threads.
std::size_t parallel_for(std::size_t count, const ParallelOptions& options,
                         const std::function<void(std::size_t item)>& work);

}  // namespace poise::solvers
