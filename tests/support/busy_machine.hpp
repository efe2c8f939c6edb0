#pragma once

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

namespace poise::test {

/// While it lives every core has three more threads to run.
class BusyMachine {
 public:
  BusyMachine() {
    for (unsigned k = 0; k < 3 * std::max(1U, std::thread::hardware_concurrency()); ++k) {
      threads_.emplace_back([this] {
        while (!ends_) {
        }
      });
    }
  }
  ~BusyMachine() {
    ends_ = true;
    for (std::thread& thread : threads_) thread.join();
  }
  BusyMachine(const BusyMachine&) = delete;
  BusyMachine& operator=(const BusyMachine&) = delete;

 private:
  std::atomic<bool> ends_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace poise::test
