#include "app/terminal/interrupt.hpp"

#include <csignal>

#include <gtest/gtest.h>

namespace poise::app::interrupt_test {
namespace {

// In a process of its own: nothing else should run with the handler in place.
TEST(InterruptDeathTest, FirstSignalSetsTheFlagAndTheSecondEndsTheProgram) {
  ::testing::FLAGS_gtest_death_test_style = "threadsafe";
  EXPECT_EXIT(
      {
        const std::atomic<bool>& interrupted = watch_for_interrupt();
        if (interrupted) std::_Exit(1);
        std::raise(SIGINT);
        std::_Exit(interrupted ? 0 : 2);
      },
      ::testing::ExitedWithCode(0), "");
  EXPECT_EXIT(
      {
        watch_for_interrupt();
        std::raise(SIGINT);
        std::raise(SIGINT);
      },
      ::testing::KilledBySignal(SIGINT), "");
}

}  // namespace
}  // namespace poise::app::interrupt_test
