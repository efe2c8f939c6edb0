#include "benchmarks/apart.hpp"

#include <chrono>
#include <csignal>
#include <cstdio>
#include <exception>
#include <fstream>
#include <string>
#include <vector>

#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

namespace poise::benchmarks {
namespace {

[[noreturn]] void be_the_child(const std::function<void(void*)>& work, std::size_t size, int out) {
  std::vector<char> result(size);
  try {
    work(result.data());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    _exit(1);
  }
  const ssize_t written = write(out, result.data(), size);
  _exit(written == static_cast<ssize_t>(size) ? 0 : 1);
}

// Reads `size` bytes, written at once, within `seconds`.
bool receive(int in, void* result, std::size_t size, double seconds) {
  pollfd ready{in, POLLIN, 0};
  if (poll(&ready, 1, static_cast<int>(1e3 * seconds)) <= 0) return false;
  return read(in, result, size) == static_cast<ssize_t>(size);
}

}  // namespace

double peak_memory() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    double amount = 0.0;
    if (word == "VmHWM:" && status >> amount) return amount;
  }
  return 0.0;
}

bool run_apart(const std::function<void(void*)>& work, void* result, std::size_t size, double seconds) {
  int ends[2];
  if (pipe(ends) != 0) return false;
  std::fflush(nullptr);  // the child must not print the parent's buffered output
  const pid_t child = fork();
  if (child < 0) return false;
  if (child == 0) {
    close(ends[0]);
    be_the_child(work, size, ends[1]);
  }
  close(ends[1]);
  const bool received = receive(ends[0], result, size, seconds);
  close(ends[0]);
  if (!received) kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  return received;
}

}  // namespace poise::benchmarks
