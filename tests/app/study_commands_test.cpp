// `poise montecarlo` with --output, --resume and --shard, killed, and under mpirun.

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/app/wheel_experiment.hpp"

namespace poise::app_tests::study_commands_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using Words = std::vector<std::string>;

constexpr const char* trials = "40";

std::string small_experiment(const TempFolder& folder) {
  std::string run = one_run;
  run.replace(run.find("rate = 200"), 10, "rate = 40");
  return experiment(folder, std::string(wheel_unknowns) + run);
}

/// All numbers of a result but the time it took.
json numbers(json result) {
  result.erase("seconds");
  return result;
}

json study(const TempFolder& folder, const std::string& file, Words words, int exit_code = 0) {
  words.insert(words.begin(), {"montecarlo", file, "--trials", trials});
  return numbers(run_json(folder, words, exit_code));
}

int run_and_wait(Words words, const std::string& out) {
  words.insert(words.begin(), {"/bin/sh", "-c", "exec \"$@\" > \"$0\" 2>&1", out});
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const pid_t child = ::fork();
  if (child == 0) {
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

bool has_mpirun() { return std::system("command -v mpirun > /dev/null") == 0; }

// Open MPI leaves memory behind at its end, which is not ours to mend.
Words under_mpirun(int ranks, Words words) {
  words.insert(words.begin(), {"/usr/bin/env", "ASAN_OPTIONS=detect_leaks=0", "OMPI_ALLOW_RUN_AS_ROOT=1",
                               "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1", "mpirun", "--oversubscribe", "-n",
                               std::to_string(ranks), POISE_EXECUTABLE});
  return words;
}

TEST(StudyCommands, ResumeReadsWhatIsThere) {
  const TempFolder folder;
  const std::string file = small_experiment(folder), place = folder.path("study").string();
  const json whole = study(folder, file, {"--jobs", "1"});
  EXPECT_EQ(study(folder, file, {"--output", place, "--jobs", "2"}), whole);
  EXPECT_EQ(study(folder, file, {"--output", place, "--resume"}), whole);
  EXPECT_EQ(study(folder, file, {"--jobs", "4"}), whole);
  const ProgramRun run =
      run_poise({"montecarlo", file, "--trials", trials, "--output", place, "--resume", "--verbose"});
  EXPECT_TRUE(has(run.out, "0 computed now, the others read from " + place)) << run.out;
}

TEST(StudyCommands, ShardsMeet) {
  const TempFolder folder;
  const std::string file = small_experiment(folder), place = folder.path("study").string();
  const json whole = study(folder, file, {});
  for (const std::string shard : {"3/3", "1/3", "2/3"}) {
    const json part = study(folder, file, {"--output", place, "--shard", shard});
    EXPECT_EQ(part["shard"], shard);
    EXPECT_EQ(part["trials"], shard == "1/3" ? 14 : 13);
    EXPECT_EQ(part["trials_requested"], 40);
  }
  EXPECT_EQ(study(folder, file, {"--output", place, "--resume"}), whole);
  EXPECT_TRUE(whole["shard"].is_null());
  EXPECT_FALSE(fs::exists(fs::path(place) / "study.csv")) << "nothing was missing";
}

TEST(StudyCommands, AKilledStudyGoesOn) {
  const TempFolder folder;
  const std::string file = small_experiment(folder);
  const fs::path place = folder.path("study");
  const json whole = study(folder, file, {});
  const pid_t child = ::fork();
  if (child == 0) {
    ::execl(POISE_EXECUTABLE, POISE_EXECUTABLE, "montecarlo", file.c_str(), "--trials", trials, "--jobs", "2",
            "--quiet", "--output", place.c_str(), nullptr);
    ::_exit(127);
  }
  const auto lines = [&] {
    const std::string text = contents(place / "study.csv");
    return std::count(text.begin(), text.end(), '\n');
  };
  while (lines() < 20 && ::waitpid(child, nullptr, WNOHANG) == 0)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  EXPECT_EQ(study(folder, file, {"--output", place.string(), "--resume"}), whole);
}

TEST(StudyCommands, InterruptSaysHowToGoOn) {
  const TempFolder folder;
  const std::string file = experiment(folder, std::string(wheel_unknowns) + one_run);
  const std::string out = folder.path("out").string(), place = folder.path("study").string();
  const int code = interrupt_poise({"montecarlo", file, "--trials", "100000", "--jobs", "2", "--output", place}, out,
                                   std::chrono::milliseconds(300));
  EXPECT_EQ(code, 1);
  EXPECT_TRUE(has(contents(out), "The complete chunks are in " + place + ": the same command with --resume goes on."))
      << contents(out);
}

TEST(StudyCommands, ADamagedFileIsNamed) {
  const TempFolder folder;
  const std::string file = small_experiment(folder);
  const fs::path place = folder.path("study");
  const json whole = study(folder, file, {"--output", place.string()});
  std::string text = contents(place / "study.csv");
  char& digit = text[text.find("\n5,") + 30];
  digit = digit == '1' ? '2' : '1';
  folder.write("study/study.csv", text);
  const ProgramRun run =
      run_poise({"montecarlo", file, "--trials", trials, "--output", place.string(), "--resume", "--verbose"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_TRUE(has(run.out, "is damaged (its checksum is wrong) and not used.")) << run.out;
  EXPECT_TRUE(has(run.out, "; 1 computed now")) << run.out;
  EXPECT_EQ(study(folder, file, {"--output", place.string(), "--resume"})["estimates"], whole["estimates"]);
}

TEST(StudyCommands, BadWordsAreNamed) {
  const TempFolder folder;
  const std::string file = small_experiment(folder), place = folder.path("study").string();
  study(folder, file, {"--output", place});
  struct Case {
    Words words;
    std::string says;
  };
  const Case cases[] = {
      {{"--resume"}, "--resume: expected --output DIR"},
      {{"--shard", "1/2"}, "--shard: expected --output DIR"},
      {{"--shard", "3/2", "--output", place}, "--shard: expected i/N, the part i = 1 .. N of N, found \"3/2\""},
      {{"--shard", "0/2", "--output", place}, "--shard: expected i/N"},
      {{"--shard", "1/", "--output", place}, "--shard: expected i/N"},
      {{"--shard", "2", "--output", place}, "--shard: expected i/N"},
      {{"--shard", "1/2x", "--output", place}, "--shard: expected i/N"},
      {{"--output", place}, "exists already; expected a new folder, or --resume to go on with it"},
      {{"--output", place, "--resume", "--seed", "2"}, "\"seed = 1\" where this one has \"seed = 2\""},
      {{"--output", place, "--resume", "--trials", "41"}, "\"trials = 40\" where this one has \"trials = 41\""},
      {{"--output", place, "--resume", "--start", "auto"}, "\"start = given\""},
      {{"--output", place, "--resume", "--set", "body.wheel.mass=2"}, "\"experiment = "},
      {{"--output", file}, "expected a folder, or a place for a new one"}};
  for (const auto& [words, says] : cases) {
    Words all = {"montecarlo", file};
    if (std::find(words.begin(), words.end(), "--trials") == words.end()) all.insert(all.end(), {"--trials", trials});
    all.insert(all.end(), words.begin(), words.end());
    const ProgramRun run = run_poise(all);
    EXPECT_EQ(run.exit_code, 2) << says;
    EXPECT_EQ(run.out, "") << says;
    EXPECT_TRUE(has(run.err, says)) << says << "\n" << run.err;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  }
}

TEST(StudyCommands, RanksDoNotMatter) {
  if (!POISE_HAS_MPI || !has_mpirun()) GTEST_SKIP() << "built without MPI, or there is no mpirun";
  const TempFolder folder;
  const std::string file = small_experiment(folder), out = folder.path("out").string();
  const std::string place = folder.path("study").string();
  const json whole = study(folder, file, {"--jobs", "1"});
  for (const int ranks : {1, 2, 4}) {
    SCOPED_TRACE(ranks);
    const std::string result = folder.path("ranks.json").string();
    Words words = {"montecarlo", file, "--trials", trials, "--json", result};
    if (ranks == 4) words.insert(words.end(), {"--jobs", "2", "--output", place});
    ASSERT_EQ(run_and_wait(under_mpirun(ranks, words), out), 0) << contents(out);
    EXPECT_EQ(numbers(json::parse(contents(result))), whole);
    fs::remove(result);
  }
  EXPECT_EQ(study(folder, file, {"--output", place, "--resume"}), whole);
  // mpirun gives ranks a terminal, whose colours would be in the file.
  ASSERT_EQ(run_and_wait(under_mpirun(1, {"solve", dataset("toggle_clamp")}), out), 0) << contents(out);
  EXPECT_TRUE(has(contents(out), "proved")) << contents(out);
  EXPECT_FALSE(has(contents(out), "\x1b")) << contents(out);
  // A mistake is said once.
  EXPECT_EQ(run_and_wait(under_mpirun(2, {"montecarlo", file, "--output", place, "--trials", trials}), out), 2);
  const std::string said = contents(out), line = "exists already; expected a new folder";
  EXPECT_NE(said.find(line), std::string::npos) << said;
  EXPECT_EQ(said.find(line), said.rfind(line)) << said;
}

TEST(StudyCommands, WithoutMpiRanksAreRefused) {
  const TempFolder folder;
  const std::string program = folder.path("poise").string(), out = folder.path("out").string();
  fs::copy_file(POISE_EXECUTABLE, program);
  const Words words = {"/usr/bin/env", "OMPI_COMM_WORLD_SIZE=2", program, "montecarlo", dataset("lift_experiment")};
  EXPECT_EQ(run_and_wait(words, out), 2);
  EXPECT_TRUE(has(contents(out), "mpirun: this poise has no module for MPI")) << contents(out);
  // So is a module whose libraries are missing; this one is no library at all.
  const std::string module = folder.write("poise_mpi.so", "damaged");
  EXPECT_EQ(run_and_wait(words, out), 2);
  EXPECT_TRUE(has(contents(out), "mpirun: cannot load MPI (" + module + ": ")) << contents(out);
  EXPECT_TRUE(has(contents(out), "every rank would do the whole study")) << contents(out);
  // This program is none of a Debian package, which poise-mpi would fit.
  EXPECT_FALSE(has(contents(out), "poise-mpi")) << contents(out);
  // A module that is cut anywhere is one clear line, not the end by a signal.
  if (POISE_HAS_MPI) {
    const fs::path whole = fs::path(POISE_EXECUTABLE).parent_path() / "poise_mpi.so";
    for (const std::uintmax_t size : {10u, 100u, 1000u, 5000u}) {
      SCOPED_TRACE(size);
      fs::copy_file(whole, module, fs::copy_options::overwrite_existing);
      ASSERT_GT(fs::file_size(module), size);
      fs::resize_file(module, size);
      EXPECT_EQ(run_and_wait(words, out), 2);
      const std::string said = contents(out);
      EXPECT_TRUE(has(said, "mpirun: cannot load MPI (" + module + ": ")) << said;
      EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
    }
    fs::remove(module);
  }
  // A rank that is alone needs no other.
  const Words alone = {
      "/usr/bin/env", "OMPI_COMM_WORLD_SIZE=1", program, "montecarlo", dataset("lift_experiment"), "--trials", "2"};
  EXPECT_EQ(run_and_wait(alone, out), 0) << contents(out);
}

}  // namespace
}  // namespace poise::app_tests::study_commands_test
