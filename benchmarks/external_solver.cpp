#include "benchmarks/external_solver.hpp"

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <sstream>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

namespace poise::benchmarks {
namespace {

constexpr int patience = 60000;  // ms, for one answer

[[noreturn]] void become(const std::vector<std::string>& command, int in, int out) {
  dup2(in, STDIN_FILENO);
  dup2(out, STDOUT_FILENO);
  // Threads of BLAS only slow down matrices this small.
  for (const char* threads : {"OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"}) setenv(threads, "1", 1);
  std::vector<char*> arguments;
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  execvp(arguments.front(), arguments.data());
  _exit(127);
}

}  // namespace

ExternalSolver::ExternalSolver(std::string name, const std::vector<std::string>& command) : name_(std::move(name)) {
  std::signal(SIGPIPE, SIG_IGN);  // write() reports a process that has ended
  if (!launch(command)) {
    why_absent_ = "no process could be started";
    return;
  }
  if (!ask("methods")) {
    why_absent_ = why_not_;
    end();
    return;
  }
  std::istringstream words(answer_);
  for (std::string method; std::getline(words, method, '|');) methods_.push_back(method);
}

ExternalSolver::~ExternalSolver() { end(); }

bool ExternalSolver::launch(const std::vector<std::string>& command) {
  int requests[2], answers[2];
  if (pipe2(requests, O_CLOEXEC) != 0) return false;
  if (pipe2(answers, O_CLOEXEC) != 0) {
    close(requests[0]);
    close(requests[1]);
    return false;
  }
  process_ = fork();
  if (process_ == 0) become(command, requests[0], answers[1]);
  close(requests[0]);
  close(answers[1]);
  to_ = requests[1];
  from_ = answers[0];
  return process_ > 0;
}

void ExternalSolver::end() {
  if (to_ >= 0) close(to_);
  if (from_ >= 0) close(from_);
  to_ = from_ = -1;
  if (process_ > 0) {
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }
  process_ = -1;
}

bool ExternalSolver::read_line() {
  for (;;) {
    if (const std::size_t end_of_line = unread_.find('\n'); end_of_line != std::string::npos) {
      answer_ = unread_.substr(0, end_of_line);
      unread_.erase(0, end_of_line + 1);
      return true;
    }
    pollfd ready{from_, POLLIN, 0};
    if (poll(&ready, 1, patience) <= 0) {
      why_not_ = "took too long and was ended";
      return false;
    }
    char some[4096];
    const ssize_t count = read(from_, some, sizeof some);
    if (count <= 0) {
      why_not_ = "its process ended";
      return false;
    }
    unread_.append(some, static_cast<std::size_t>(count));
  }
}

// True if the answer is "ok"; answer_ then has the rest of it.
bool ExternalSolver::ask(const std::string& request) {
  if (process_ < 0) return false;
  const std::string line = request + "\n";
  if (write(to_, line.data(), line.size()) != static_cast<ssize_t>(line.size()) || !read_line()) {
    if (why_not_.empty()) why_not_ = "its process ended";
    end();
    return false;
  }
  const bool ok = answer_.rfind("ok", 0) == 0;
  answer_.erase(0, std::min<std::size_t>(3, answer_.size()));
  if (!ok) why_not_ = answer_;
  return ok;
}

std::optional<double> ExternalSolver::idle() {
  if (!ask("idle")) return std::nullopt;
  return std::stod(answer_);
}

bool ExternalSolver::take(const std::string& scene) { return ask("scene " + scene); }

bool ExternalSolver::start_from(const std::vector<double>& x) {
  variables_ = x.size();
  return ask(fmt::format("start {}", fmt::join(x, " ")));
}

std::optional<SolverAnswer> ExternalSolver::solve(int method, double accuracy, int times) {
  if (!ask(fmt::format("solve {} {} {}", method, accuracy, times))) return std::nullopt;
  SolverAnswer answer;
  std::istringstream words(answer_);
  words >> answer.seconds >> answer.evaluations >> answer.claimed;
  for (double value = 0.0; words >> value;) answer.x.push_back(value);
  if (answer.x.size() != variables_) return std::nullopt;  // reading ends at a number that is not finite
  return answer;
}

}  // namespace poise::benchmarks
