// poise_studies_benchmark [TRIALS [ROUNDS]]: `poise montecarlo` of the lift on one thread, on two threads, and on one
// and two ranks under mpirun, turn by turn. Wall time tells what a free machine does; processor time, which other
// programs disturb little, what threads and ranks cost. Passes or fails nothing; exit code 1 where a study fails.

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <optional>
#include <string>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace poise::benchmarks {
namespace {

struct Cost {
  double wall = 0.0, processor = 0.0;  // s
  double peak_memory = 0.0;            // MB, of the largest process
};

/// Runs a command whose output is thrown away, and counts what it and all its descendants cost.
std::optional<Cost> cost_of(std::vector<std::string> words) {
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const auto begun = std::chrono::steady_clock::now();
  const pid_t child = ::fork();
  if (child == 0) {
    for (const int stream : {STDOUT_FILENO, STDERR_FILENO}) ::dup2(::open("/dev/null", O_WRONLY), stream);
    ::execvp(argv[0], argv.data());
    ::_exit(127);
  }
  int status = 0;
  rusage used{};
  ::wait4(child, &status, 0, &used);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) return std::nullopt;
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return Cost{std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count(),
              seconds(used.ru_utime) + seconds(used.ru_stime), static_cast<double>(used.ru_maxrss) / 1024};
}

struct Way {
  std::string name;
  std::vector<std::string> before, after;  // of the words of the study
  int cores = 1;
  std::vector<Cost> costs{};
};

double median(const std::vector<Cost>& costs, double Cost::*value) {
  std::vector<double> values;
  for (const Cost& cost : costs) values.push_back(cost.*value);
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

bool measure(const std::string& trials, int rounds) {
  // Open MPI refuses root otherwise, as which containers run.
  ::setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
  ::setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
  std::vector<Way> ways = {{"--jobs 1", {}, {"--jobs", "1"}, 1},
                           {"--jobs 2", {}, {"--jobs", "2"}, 2},
                           {"mpirun -n 1", {"mpirun", "-n", "1"}, {"--jobs", "1"}, 1},
                           {"mpirun -n 2", {"mpirun", "-n", "2"}, {"--jobs", "1"}, 2}};
  for (int round = 0; round < rounds; ++round) {
    for (Way& way : ways) {
      std::vector<std::string> words = way.before;
      words.insert(words.end(), {POISE_EXECUTABLE, "montecarlo", POISE_SOURCE_DIR "/datasets/lift_experiment.toml",
                                 "--start", "auto", "--trials", trials});
      words.insert(words.end(), way.after.begin(), way.after.end());
      if (const std::optional<Cost> cost = cost_of(words)) way.costs.push_back(*cost);
    }
  }
  bool complete = true;
  fmt::print("{} fits of the lift, medians of {}\n\n", trials, rounds);
  fmt::print("{:<14}{:>12}{:>12}{:>22}{:>22}{:>14}\n", "", "wall", "fits/s", "of ideal wall time", "processor time",
             "peak memory");
  for (const Way& way : ways) {
    if (way.costs.empty()) {
      fmt::print("{:<14}failed, or there is no mpirun\n", way.name);
      complete = false;
      continue;
    }
    const double wall = median(way.costs, &Cost::wall), processor = median(way.costs, &Cost::processor);
    const double alone = median(ways[0].costs, &Cost::wall), alone_processor = median(ways[0].costs, &Cost::processor);
    fmt::print("{:<14}{:>10.1f} s{:>12.1f}{:>20.1f} %{:>20.1f} %{:>11.1f} MB\n", way.name, wall,
               std::stod(trials) / wall, 100 * alone / way.cores / wall, 100 * processor / alone_processor,
               median(way.costs, &Cost::peak_memory));
  }
  return complete;
}

}  // namespace
}  // namespace poise::benchmarks

int main(int argc, char** argv) {
  return poise::benchmarks::measure(argc > 1 ? argv[1] : "200", argc > 2 ? std::max(1, std::atoi(argv[2])) : 3) ? 0 : 1;
}
