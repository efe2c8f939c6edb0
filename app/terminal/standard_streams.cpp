#include "app/terminal/standard_streams.hpp"

#include <array>
#include <csignal>
#include <cstdio>

#include <fcntl.h>
#include <unistd.h>

namespace poise::app {

void hold_standard_streams() {
  constexpr std::array<const char*, 3> instead = {"/dev/null", "/dev/full", "/dev/null"};
  for (int number = 0; number < static_cast<int>(instead.size()); ++number) {
    if (::fcntl(number, F_GETFD) != -1) continue;
    // The lowest free number is this one: those below are open.
    [[maybe_unused]] const int opened =
        ::open(instead[static_cast<std::size_t>(number)], number == STDIN_FILENO ? O_RDONLY : O_WRONLY);
  }
}

void say(std::string_view text) {
  // A reader that went away is no reason to end by a signal in place of the exit code.
  struct sigaction ignore {};
  struct sigaction before {};
  ignore.sa_handler = SIG_IGN;
  ::sigaction(SIGPIPE, &ignore, &before);
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
  ::sigaction(SIGPIPE, &before, nullptr);
}

}  // namespace poise::app
