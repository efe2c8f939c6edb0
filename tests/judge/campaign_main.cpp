// poise_campaign: answers of Poise for random scenes, judged in 50 digits.
//
//   poise_campaign --scenes 20000 --seed 1 [--family NAME] [--jobs 2] [--save FOLDER]
//
// Prints a table per family and the answers that are wrong; exits 1 if there are false claims. Ctrl-C ends it early,
// with the table of what was judged so far.

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/judge/campaign.hpp"
#include "tests/support/random_scenes.hpp"

namespace poise::judge {
namespace {

std::atomic<bool> interrupted = false;

struct Options {
  std::uint64_t scenes = 1000;
  std::uint64_t seed = 1;
  std::uint64_t jobs = 2;
  std::vector<std::string> families = test::scene_families();
  std::filesystem::path save;  // folder for scenes with wrong answers
};

[[noreturn]] void fail(const std::string& message) {
  std::cerr << "poise_campaign: " << message << '\n';
  std::exit(2);
}

Options read_options(const std::vector<std::string>& words) {
  Options out;
  for (std::size_t i = 0; i < words.size(); i += 2) {
    if (i + 1 == words.size()) fail(words[i] + ": expected a value");
    const std::string& value = words[i + 1];
    const auto number = [&] {
      std::size_t end = 0;
      std::uint64_t n = 0;
      try {
        n = std::stoull(value, &end);
      } catch (const std::logic_error&) {
        end = 0;
      }
      if (end != value.size() || n == 0) fail(words[i] + ": expected a positive whole number, found " + value);
      return n;
    };
    if (words[i] == "--scenes") {
      out.scenes = number();
    } else if (words[i] == "--seed") {
      out.seed = number();
    } else if (words[i] == "--jobs") {
      out.jobs = number();
    } else if (words[i] == "--save") {
      out.save = value;
    } else if (words[i] == "--family") {
      const auto& all = test::scene_families();
      if (std::find(all.begin(), all.end(), value) == all.end()) {
        fail(fmt::format("--family: expected one of {}", fmt::join(all, ", ")));
      }
      out.families = {value};
    } else {
      fail("expected --scenes, --seed, --family, --jobs or --save, found " + words[i]);
    }
  }
  return out;
}

// The k-th scene of a run.
std::pair<std::string, std::uint64_t> scene_at(const Options& options, std::uint64_t k) {
  const std::uint64_t families = options.families.size();
  return {options.families[k % families], options.seed * 1000000 + k / families};
}

// Judges every jobs-th scene and writes a line for each answer: scene, verdict, confirmed, tightness, method, why.
void work(const Options& options, std::uint64_t job, int to) {
  std::FILE* out = ::fdopen(to, "w");
  for (std::uint64_t k = job; k < options.scenes; k += options.jobs) {
    const auto [family, seed] = scene_at(options, k);
    fmt::print(out, "{}\tbegin\n", k);
    std::fflush(out);
    for (const JudgedAnswer& answer : judge_answers(family, seed)) {
      fmt::print(out, "{}\t{}\t{}\t{}\t{}\t{}\n", k, static_cast<int>(answer.verdict), answer.confirmed ? 1 : 0,
                 answer.tightness.value_or(0.0), answer.method, answer.why);
    }
    std::fflush(out);
  }
  std::fclose(out);
}

struct Tally {
  std::uint64_t scenes = 0, answers = 0, confirmed = 0;
  std::map<Verdict, std::uint64_t> of;
  std::vector<double> tightness;
};

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> out(1);
  for (const char c : line) {
    if (c == '\t' && out.size() < 6)
      out.emplace_back();
    else
      out.back() += c;
  }
  return out;
}

class Campaign {
 public:
  explicit Campaign(Options options) : options_(std::move(options)) {}

  int run() {
    int ends[2];
    if (::pipe(ends) != 0) fail("no pipe");
    std::vector<pid_t> workers;
    for (std::uint64_t job = 0; job < options_.jobs; ++job) {
      const pid_t pid = ::fork();
      if (pid < 0) fail("no more processes");
      if (pid == 0) {
        ::close(ends[0]);
        work(options_, job, ends[1]);
        std::_Exit(0);
      }
      workers.push_back(pid);
    }
    ::close(ends[1]);
    read_answers(ends[0]);
    for (const pid_t pid : workers) {
      if (interrupted) ::kill(pid, SIGTERM);
      int status = 0;
      ::waitpid(pid, &status, 0);
      if (!interrupted && status != 0) failures_.push_back(fmt::format("a worker ended with status {}", status));
    }
    print();
    return false_claims_ > 0 ? 1 : 0;
  }

 private:
  void read_answers(int from) {
    std::string buffer;
    char chunk[4096];
    while (!interrupted) {
      const ssize_t count = ::read(from, chunk, sizeof chunk);
      if (count <= 0) break;
      buffer.append(chunk, static_cast<std::size_t>(count));
      for (std::size_t end; (end = buffer.find('\n')) != std::string::npos; buffer.erase(0, end + 1)) {
        add(split(buffer.substr(0, end)));
      }
    }
    if (::isatty(2) != 0) std::cerr << '\r' << std::string(40, ' ') << '\r';
    for (const std::uint64_t k : begun_) {
      const auto [family, seed] = scene_at(options_, k);
      if (!interrupted) failures_.push_back(fmt::format("{} {}: no answer", family, seed));
    }
  }

  void add(const std::vector<std::string>& words) {
    const std::uint64_t k = std::stoull(words[0]);
    const auto [family, seed] = scene_at(options_, k);
    Tally& tally = tallies_[family];
    if (words.size() < 6) {
      begun_.push_back(k);
      ++tally.scenes;
      if (::isatty(2) != 0) std::cerr << fmt::format("\rscene {} of {}", k + 1, options_.scenes) << std::flush;
      return;
    }
    std::erase(begun_, k);
    const auto verdict = static_cast<Verdict>(std::stoi(words[1]));
    ++tally.answers;
    tally.confirmed += words[2] == "1";
    ++tally.of[verdict];
    const double tightness = std::stod(words[3]);
    if (tightness > 0.0) tally.tightness.push_back(tightness);
    if (verdict == Verdict::right) return;
    false_claims_ += is_false(verdict);
    failures_.push_back(fmt::format("{} {}, {}: {}: {}", family, seed, words[4], to_string(verdict), words[5]));
    if (options_.save.empty()) return;
    std::filesystem::create_directories(options_.save);
    std::ofstream(options_.save / fmt::format("{}_{}.toml", family, seed))
        << test::scene_text(test::random_scene(family, seed));
  }

  void print() {
    fmt::print("{:14} {:>7} {:>8} {:>10} {:>8} {:>8} {:>8} {:>6} {:>10}   {}\n", "family", "scenes", "answers",
               "confirmed", "none", "outside", "kind", "lost", "undecided", "radius / distance: median, max");
    Tally all;
    for (const std::string& family : options_.families) {
      const Tally& tally = tallies_[family];
      print(family, tally);
      all.scenes += tally.scenes;
      all.answers += tally.answers;
      all.confirmed += tally.confirmed;
      for (const auto& [verdict, count] : tally.of) all.of[verdict] += count;
      all.tightness.insert(all.tightness.end(), tally.tightness.begin(), tally.tightness.end());
    }
    print("all", all);
    std::sort(failures_.begin(), failures_.end());
    for (const std::string& failure : failures_) fmt::print("{}\n", failure);
  }

  static void print(const std::string& family, Tally tally) {
    std::sort(tally.tightness.begin(), tally.tightness.end());
    const std::size_t n = tally.tightness.size();
    const std::string ratio =
        n == 0 ? "" : fmt::format("{:.3g}, {:.3g}", tally.tightness[n / 2], tally.tightness.back());
    fmt::print("{:14} {:7} {:8} {:10} {:8} {:8} {:8} {:6} {:10}   {}\n", family, tally.scenes, tally.answers,
               tally.confirmed, tally.of[Verdict::no_equilibrium], tally.of[Verdict::outside_radius],
               tally.of[Verdict::wrong_kind], tally.of[Verdict::lost], tally.of[Verdict::undecided], ratio);
  }

  Options options_;
  std::map<std::string, Tally> tallies_;
  std::vector<std::uint64_t> begun_;  // scenes without answers yet
  std::vector<std::string> failures_;
  std::uint64_t false_claims_ = 0;
};

}  // namespace
}  // namespace poise::judge

int main(int argc, char** argv) {
  struct sigaction on_interrupt = {};
  on_interrupt.sa_handler = [](int) { poise::judge::interrupted = true; };
  ::sigaction(SIGINT, &on_interrupt, nullptr);
  return poise::judge::Campaign(poise::judge::read_options({argv + 1, argv + argc})).run();
}
