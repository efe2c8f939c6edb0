#include "app/terminal/interrupt.hpp"

#include <csignal>

#include <gtest/gtest.h>

#include "app/terminal/output_file.hpp"
#include "tests/app/run_poise.hpp"

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

// A file with a temporary name stays behind for nobody, whenever the program is ended.
TEST(InterruptDeathTest, SignalsThatEndTheProgramRemoveTemporaryFiles) {
  ::testing::FLAGS_gtest_death_test_style = "fast";  // the folder is to be the same
  const app_tests::TempFolder folder;
  const auto prepared = [&] {
    OutputFile file(folder.path("out.json"), "--json");
    file.prepare("half of it");
    return file;
  };
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    EXPECT_EXIT(
        {
          const OutputFile file = prepared();
          if (folder.names().size() != 1) std::_Exit(1);
          std::raise(signal);
        },
        ::testing::KilledBySignal(signal), "");
    EXPECT_TRUE(folder.names().empty()) << signal;
  }
  // The first Ctrl-C lets a command end by itself, the second one does not.
  EXPECT_EXIT(
      {
        watch_for_interrupt();
        const OutputFile file = prepared();
        std::raise(SIGINT);
        if (folder.names().size() != 1) std::_Exit(1);
        std::raise(SIGINT);
      },
      ::testing::KilledBySignal(SIGINT), "");
  EXPECT_TRUE(folder.names().empty());
}

}  // namespace
}  // namespace poise::app::interrupt_test
