#include "benchmarks/auto_program.hpp"

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <fstream>

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/wait.h>
#include <unistd.h>

namespace poise::benchmarks {
namespace {

namespace fs = std::filesystem;

constexpr const char* debian_folder = "/usr/lib/auto-07p";
constexpr const char* program = "equations.exe";

fs::path auto_folder() {
  const char* named = std::getenv("AUTO_DIR");
  return named != nullptr ? named : debian_folder;
}

// In a folder, without output; true if it succeeds.
bool run_in(const fs::path& folder, const std::vector<std::string>& command) {
  std::vector<char*> arguments;
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
    // AUTO's threads share out the mesh of boundary value problems, which equilibria have not.
    setenv("OMP_NUM_THREADS", "1", 1);
    if (chdir(folder.c_str()) == 0) execvp(arguments.front(), arguments.data());
    _exit(127);
  }
  int status = 0;
  return child > 0 && waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

// What AUTO calls the constants file. IPS = 0: equations without time, so that no eigenvalues are computed.
std::string constants(const AutoRun& run) {
  return fmt::format(
      "NDIM={}, IPS=0, IRS=0, ICP=[1], JAC=1, ILP={}, ISP={}, ISW=1\n"
      "NTST=1, NCOL=4, IAD=3, IPLT=0, NBC=0, NINT=0, MXBF=0, IID=0\n"
      "NMX={}, NPR=0, ITMX=8, ITNW=5, NWTN=3\n"
      "EPSL={:e}, EPSU={:e}, EPSS=1e-5\n"
      "DS={:e}, DSMIN={:e}, DSMAX={:e}, IADS=0\n",
      run.start.size(), int{run.with_events}, int{run.with_events}, run.points, run.tolerance, run.tolerance, run.step,
      1e-3 * run.step, run.step);
}

}  // namespace

AutoProgram::AutoProgram(const std::string& equations) {
  const fs::path library = auto_folder() / "lib";
  std::vector<std::string> command = {"gfortran", "-O2", "-fopenmp"};
  const fs::path sources = POISE_SOURCE_DIR "/benchmarks";
  for (const char* source : {equations.c_str(), "auto_record.f90"}) command.push_back(sources / source);
  std::error_code none;
  for (const auto& file : fs::directory_iterator(library, none)) {
    if (file.path().extension() == ".o") command.push_back(file.path());
  }
  if (!fs::exists(library / "main.o")) {
    why_absent_ = fmt::format("auto-07p is not in {} (Debian package auto-07p, or set AUTO_DIR)", library.string());
    return;
  }
  std::string pattern = (fs::temp_directory_path() / "poise_auto_XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) {
    why_absent_ = "no temporary folder could be made";
    return;
  }
  folder_ = pattern;
  command.insert(command.end(), {"-o", program});
  if (!run_in(folder_, command)) why_absent_ = "gfortran did not compile its equations";
}

AutoProgram::~AutoProgram() {
  std::error_code ignored;
  if (!folder_.empty()) fs::remove_all(folder_, ignored);
}

std::optional<AutoCurve> AutoProgram::run(const AutoRun& run) const {
  std::ofstream(folder_ / "fort.2") << constants(run);
  std::ofstream(folder_ / "start") << fmt::format("{:.17e} {:.17e}\n", run.parameter, fmt::join(run.start, " "));
  const fs::path record = folder_ / "points";
  fs::remove(record);
  const auto begin = std::chrono::steady_clock::now();
  if (!run_in(folder_, {"./" + std::string(program)})) return std::nullopt;
  AutoCurve curve;
  curve.process = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  std::ifstream in(record, std::ios::binary);
  const auto read = [&in](auto* to, std::size_t count) {
    return !!in.read(reinterpret_cast<char*>(to), static_cast<std::streamsize>(count * sizeof *to));
  };
  std::int64_t first = 0, last = 0;  // ns
  AutoCurve::Point point{0.0, std::vector<double>(run.start.size())};
  while (read(&last, 1) && read(&point.parameter, 1) && read(point.u.data(), point.u.size())) {
    if (curve.points.empty()) first = last;
    curve.points.push_back(point);
  }
  if (curve.points.size() < 2) return std::nullopt;
  curve.per_point = 1e-9 * static_cast<double>(last - first) / static_cast<double>(curve.points.size() - 1);
  return curve;
}

}  // namespace poise::benchmarks
