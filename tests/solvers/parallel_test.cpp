#include "solvers/parallel.hpp"

#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace poise::solvers::parallel_test {
namespace {

TEST(ParallelFor, DoesEveryItemOnce) {
  for (const int jobs : {0, 1, 2, 7}) {
    std::vector<int> times(100, 0);
    std::size_t reported = 0;
    const std::size_t done =
        parallel_for(times.size(), {.jobs = jobs, .progress = [&](std::size_t k) { EXPECT_EQ(k, ++reported); }},
                     [&](std::size_t item) { ++times[item]; });
    EXPECT_EQ(done, 100U);
    EXPECT_EQ(reported, 100U);
    EXPECT_EQ(times, std::vector<int>(100, 1));
  }
  EXPECT_EQ(parallel_for(0, {}, [](std::size_t) { FAIL(); }), 0U);
}

TEST(ParallelFor, StopsWhenInterrupted) {
  for (const int jobs : {1, 3}) {
    std::atomic<bool> stop = false;
    std::atomic<int> begun = 0;
    const std::size_t done = parallel_for(1000, {.jobs = jobs, .interrupt = &stop}, [&](std::size_t item) {
      ++begun;
      if (item == 5) stop = true;
    });
    EXPECT_EQ(static_cast<int>(done), begun);
    EXPECT_GE(done, 6U);
    EXPECT_LT(done, 1000U);
  }
}

TEST(ParallelFor, ThrowsWhatTheLowestItemThrew) {
  for (const int jobs : {1, 2, 4}) {
    try {
      parallel_for(100, {.jobs = jobs}, [](std::size_t item) {
        if (item >= 10) throw std::runtime_error("item " + std::to_string(item));
      });
      FAIL() << "nothing thrown";
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "item 10");
    }
  }
}

TEST(ParallelFor, ThreadsAreThoseAskedForOrTheCores) {
  EXPECT_EQ(threads_of(3), 3);
  EXPECT_GE(threads_of(0), 1);
}

}  // namespace
}  // namespace poise::solvers::parallel_test
