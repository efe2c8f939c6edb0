#include "tests/app/wheel_experiment.hpp"

#include <csignal>
#include <thread>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

namespace poise::app_tests {
namespace {

/// Whether a process handles SIGINT itself: until then it would be killed.
bool watches_for_interrupt(pid_t process) {
  const std::string status = contents("/proc/" + std::to_string(process) + "/status"), key = "SigCgt:";
  const std::size_t caught = status.find(key);
  return caught != std::string::npos &&
         (std::stoull(status.substr(caught + key.size()), nullptr, 16) >> (SIGINT - 1) & 1U) != 0;
}

}  // namespace

using nlohmann::json;

std::string experiment(const TempFolder& folder, const std::string& text) {
  folder.write("wheel.toml", wheel);
  return folder.write("experiment.toml", text);
}

json run_json(const TempFolder& folder, std::vector<std::string> words, int exit_code) {
  const std::string file = folder.path("result.json").string();
  words.insert(words.end(), {"--json", file});
  const ProgramRun run = run_poise(words);
  EXPECT_EQ(run.exit_code, exit_code) << run.out << run.err;
  return json::parse(contents(file));
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

int interrupt_poise(const std::vector<std::string>& arguments, const std::string& out,
                    std::chrono::milliseconds after) {
  const pid_t child = ::fork();
  if (child == 0) {
    std::vector<std::string> words = {POISE_EXECUTABLE};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    ::dup2(::open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDOUT_FILENO);
    ::execv(POISE_EXECUTABLE, argv.data());
    ::_exit(127);
  }
  // However long a slow machine, or one with sanitizers, needs to get there.
  while (!watches_for_interrupt(child) && ::waitpid(child, nullptr, WNOHANG) == 0) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  std::this_thread::sleep_for(after);
  ::kill(child, SIGINT);
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace poise::app_tests
