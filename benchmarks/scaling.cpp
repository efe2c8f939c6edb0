// poise_scaling: growth of time and memory with the size of a mechanism, from ten elements to a hundred thousand: links
// of a hanging chain, windows of a ladder (one loop and four angles each). Every size runs in a separate process. Times
// are the least of many turns, to exclude other load of the machine; times of wrong answers are not printed. Exit code
// 1 if an answer is wrong; times do not affect it.

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "benchmarks/apart.hpp"
#include "benchmarks/hand_chain.hpp"
#include "benchmarks/hand_four_bar.hpp"
#include "benchmarks/known_answers.hpp"
#include "benchmarks/timing.hpp"
#include "benchmarks/yardstick_inputs.hpp"
#include "comparison/series.hpp"
#include "solvers/ipopt.hpp"
#include "solvers/newton.hpp"
#include "statics/equilibrium/equilibrium.hpp"

namespace poise::benchmarks {
namespace {

constexpr int sizes[] = {10, 100, 1000, 10000, 100000};
constexpr int smallest = 10;  // its peak is the memory of code and libraries
constexpr int judged_from = 100, judged_to = 100000;
constexpr int sparse_from = 1000;     // the check of smaller ones is dense
constexpr double growth_limit = 1.5;  // of the time per element in between
constexpr double hand_limit = 3.0;    // longest chain, Poise over the Newton written by hand
constexpr int ladder_judged = 10000;
constexpr double ladder_limit = 62.5;    // over a four-bar by hand for each window
constexpr double memory_limit = 1000.0;  // bytes per coordinate
constexpr int ipopt_to = 10000;
constexpr double patience = 300.0;  // s, for one size
constexpr double ipopt_patience = 60.0;
constexpr double shortest_turn = 5e-4;  // s; quicker work runs several times per turn
constexpr double seconds_per_race = 1.5;
constexpr int fewest_turns = 5;

enum class Series { chain, ladder };

struct Subject {
  Series series;
  const char* name;  // of comparison/series.hpp
  const char* element;
};

constexpr Subject subjects[] = {{Series::chain, "hanging chain", "link"}, {Series::ladder, "window ladder", "window"}};

// Peaks are of the whole process, kB, so far.
struct Ours {
  int coordinates = 0;
  int iterations = 0;
  bool right = false;
  double search = 0.0;       // s: Newton constructed before
  double model = 0.0;        // s: compiling the scene
  double everything = 0.0;   // s: compiling, closing loops, analysis, search, check
  double certificate = 0.0;  // s: of the result, the scene compiled in ball arithmetic before
  double by_hand = 0.0;      // s: the chain; for a ladder as many four-bars as it has windows
  double scene_peak = 0.0;
  double model_peak = 0.0;
  double search_peak = 0.0;
  double whole_peak = 0.0;
};

struct Theirs {
  int iterations = 0;
  bool right = false;
  double search = 0.0;  // s
  double peak = 0.0;    // kB, scene and compiled model included
};

// Least seconds of several pieces of work, run turn by turn.
std::vector<double> race(const std::vector<std::function<void()>>& works) {
  std::vector<int> times;
  std::vector<double> least;
  for (const auto& work : works) {
    least.push_back(seconds_of(work, 1));
    times.push_back(std::max(1, static_cast<int>(shortest_turn / least.back())));
  }
  const auto begin = std::chrono::steady_clock::now();
  const auto time_left = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() <
           seconds_per_race * static_cast<double>(works.size());
  };
  for (int turn = 0; turn < fewest_turns || time_left(); ++turn) {
    for (std::size_t k = 0; k < works.size(); ++k) least[k] = std::min(least[k], seconds_of(works[k], times[k]));
  }
  return least;
}

// The chain against its reference; the ladder upright and symmetric, which is its only stable equilibrium.
bool is_right(Series series, const StaticModel& model, const std::vector<double>& x, double error) {
  if (series == Series::chain) return chain_error(x) <= error;
  double worst = 0.0;
  for (std::size_t i = 0; i + 3 < x.size(); i += 4) {
    const auto off = [](double a, double b) { return std::abs(std::remainder(a + b + M_PI, 2 * M_PI)); };
    worst = std::max({worst, off(x[i], x[i + 1]), off(x[i + 2], x[i + 3])});
  }
  return worst <= error && certify(model, x).stability == Stability::stable;
}

Ours measure_ours(const Subject& subject, int size) {
  Ours out;
  Scene scene = comparison::series_scene(subject.name, size);
  out.scene_peak = peak_memory();
  const StaticModel model(std::move(scene));
  out.model_peak = peak_memory();
  const std::vector<double> start = model.start();
  {
    solvers::Newton newton(model.problem());
    newton.solve(start);
    out.search_peak = peak_memory();
  }
  const Equilibrium equilibrium = solve(model, {.seek = Seek::any});
  out.whole_peak = peak_memory();
  out.coordinates = model.mechanism().coordinates();
  out.iterations = equilibrium.iterations;

  solvers::Newton newton(model.problem());
  const solvers::NewtonResult* found = nullptr;
  HandChain by_hand(size);
  const std::array<double, 3> four_bar = four_bar_start(StaticModel(thesis_four_bar()));
  HandFourBarResult four_bar_by_hand;
  const auto build = [&] { return StaticModel(model.scene()); };
  std::vector<std::function<void()>> works = {[&] { found = &newton.solve(start); }, [&] { build(); },
                                              [&] { solve(build()); }};
  if (subject.series == Series::chain) {
    works.emplace_back([&] { by_hand.solve(start); });
  } else {
    works.emplace_back([&] {
      for (int k = 0; k < size; ++k) four_bar_by_hand = solve_four_bar_by_hand(four_bar);
    });
  }
  const std::vector<double> seconds = race(works);
  out.certificate = seconds_of([&] { certify(model, equilibrium.reached); }, 1);
  out.search = seconds[0];
  out.model = seconds[1];
  out.everything = seconds[2];
  out.by_hand = seconds[3];
  out.right = equilibrium.found() && is_right(subject.series, model, equilibrium.x, virtual_work_error) &&
              is_right(subject.series, model, found->x, virtual_work_error);
  return out;
}

Theirs measure_ipopt(const Subject& subject, int size) {
  const StaticModel model(comparison::series_scene(subject.name, size));
  const std::vector<double> start = model.start();
  solvers::SearchResult found = solvers::solve_with_ipopt(model.problem(), start);
  Theirs out;
  out.peak = peak_memory();
  out.search = race({[&] { found = solvers::solve_with_ipopt(model.problem(), start); }}).front();
  out.iterations = found.iterations;
  out.right = is_right(subject.series, model, found.x, energy_error);
  return out;
}

const char* verdict(bool met) { return met ? "met" : "MISSED"; }

// What one series showed, size by size; nothing where it failed or took too long.
struct Shown {
  std::vector<std::optional<Ours>> ours;
  std::vector<std::optional<Theirs>> ipopt;
};

Shown measure(const Subject& subject) {
  Shown out;
  bool ipopt_keeps_up = true;
  for (const int size : sizes) {
    out.ours.push_back(run_apart<Ours>([&] { return measure_ours(subject, size); }, patience));
    out.ipopt.emplace_back();
    if (size > ipopt_to || !ipopt_keeps_up) continue;
    out.ipopt.back() = run_apart<Theirs>([&] { return measure_ipopt(subject, size); }, ipopt_patience);
    ipopt_keeps_up = out.ipopt.back().has_value();
  }
  return out;
}

std::string per_element(double seconds, int size) { return fmt::format("{:.0f} ns", 1e9 * seconds / size); }

void print_times(const Subject& subject, const Shown& shown) {
  fmt::print(
      "Time per {} (search: Newton constructed before; everything: compiling, closing loops, analysis, search, "
      "check)\n",
      subject.element);
  fmt::print("{:>8}{:>7}{:>12}{:>12}{:>12}{:>12}{:>12}{:>8}{:>12}{:>7}\n", subject.element, "steps", "search", "model",
             "everything", "in all", "by hand", "ratio", "Ipopt", "steps");
  for (std::size_t k = 0; k < std::size(sizes); ++k) {
    const int size = sizes[k];
    fmt::print("{:>8}", size);
    if (!shown.ours[k] || !shown.ours[k]->right) {
      fmt::print("  {}\n", shown.ours[k] ? "WRONG" : "failed, or took too long");
      continue;
    }
    const Ours& ours = *shown.ours[k];
    fmt::print("{:>7}{:>12}{:>12}{:>12}{:>12}", ours.iterations, per_element(ours.search, size),
               per_element(ours.model, size), per_element(ours.everything, size), in_units(ours.everything));
    fmt::print("{:>12}{:>8.2f}", per_element(ours.by_hand, size), ours.search / ours.by_hand);
    if (size > ipopt_to)
      fmt::print("  skipped\n");
    else if (!shown.ipopt[k])
      fmt::print("  not within {:.0f} s\n", ipopt_patience);
    else if (!shown.ipopt[k]->right)
      fmt::print("  WRONG\n");
    else
      fmt::print("{:>12}{:>7}\n", per_element(shown.ipopt[k]->search, size), shown.ipopt[k]->iterations);
  }
}

// Bytes per coordinate of a peak beyond that of the smallest mechanism.
double per_coordinate(double peak, double least, int coordinates) { return 1024.0 * (peak - least) / coordinates; }

void print_memory(const Shown& shown) {
  fmt::print("Peak memory, bytes per coordinate beyond what {} elements take, so far\n", smallest);
  fmt::print("{:>8}{:>13}{:>12}{:>12}{:>12}{:>12}{:>12}\n", "", "coordinates", "scene", "model", "search", "everything",
             "Ipopt");
  for (std::size_t k = 1; k < std::size(sizes); ++k) {
    if (!shown.ours[k] || !shown.ours[0]) continue;
    const Ours& ours = *shown.ours[k];
    const Ours& least = *shown.ours[0];
    const auto bytes = [&](double peak, double from) {
      return fmt::format("{:.0f}", per_coordinate(peak, from, ours.coordinates - least.coordinates));
    };
    fmt::print("{:>8}{:>13}{:>12}{:>12}{:>12}{:>12}", sizes[k], ours.coordinates,
               bytes(ours.scene_peak, least.scene_peak), bytes(ours.model_peak, least.model_peak),
               bytes(ours.search_peak, least.search_peak), bytes(ours.whole_peak, least.whole_peak));
    if (shown.ipopt[k] && shown.ipopt[0])
      fmt::print("{:>12}\n", bytes(shown.ipopt[k]->peak, shown.ipopt[0]->peak));
    else
      fmt::print("{:>12}\n", "skipped");
  }
}

const Ours* at(const Shown& shown, int size) {
  const auto place = std::find(std::begin(sizes), std::end(sizes), size) - std::begin(sizes);
  const auto& ours = shown.ours[static_cast<std::size_t>(place)];
  return ours && ours->right ? &*ours : nullptr;
}

void print_limit(const std::string& what, double value, double limit, const char* unit) {
  fmt::print("{:<56}{:>10.4g}{:>8.4g} {:<6}{}\n", what, value, limit, unit, verdict(value <= limit));
}

void print_limits(const Subject& subject, const Shown& shown) {
  const Ours* from = at(shown, judged_from);
  const Ours* to = at(shown, judged_to);
  if (from != nullptr && to != nullptr) {
    const auto growth = [&](double before, double after, int size = judged_from) {
      return after / judged_to / (before / size);
    };
    print_limit(fmt::format("growth of the search per {}, {} over {}", subject.element, judged_to, judged_from),
                growth(from->search, to->search), growth_limit, "");
    if (subject.series == Series::chain) {
      print_limit("  of the Newton written by hand, for comparison", growth(from->by_hand, to->by_hand), growth_limit,
                  "");
    }
    if (const Ours* sparse = at(shown, sparse_from); sparse != nullptr) {
      print_limit(fmt::format("growth of everything per {}, {} over {}", subject.element, judged_to, sparse_from),
                  growth(sparse->everything, to->everything, sparse_from), growth_limit, "");
    }
    const Ours& least = *shown.ours[0];
    const int more = to->coordinates - least.coordinates;
    print_limit(fmt::format("memory of scene, model and search at {}", judged_to),
                per_coordinate(to->search_peak, least.search_peak, more), memory_limit, "B");
    print_limit("  with check and reactions", per_coordinate(to->whole_peak, least.whole_peak, more), memory_limit,
                "B");
  }
  for (const auto& [size, limit] : {std::pair{100, 10.0}, std::pair{10000, 2000.0}}) {
    if (const Ours* ours = at(shown, size); ours != nullptr) {
      print_limit(fmt::format("certificate of {} {}s", size, subject.element), 1e3 * ours->certificate, limit, "ms");
    }
  }
  if (subject.series == Series::chain && to != nullptr)
    print_limit(fmt::format("search of {} links over the Newton by hand", judged_to), to->search / to->by_hand,
                hand_limit, "");
  const Ours* ladder = at(shown, ladder_judged);
  if (subject.series == Series::ladder && ladder != nullptr) {
    print_limit(fmt::format("search of {} windows over as many four-bars by hand", ladder_judged),
                ladder->search / ladder->by_hand, ladder_limit, "");
    print_limit("  everything", ladder->everything / ladder->by_hand, ladder_limit, "");
  }
}

bool all_right(const Shown& shown) {
  return std::all_of(shown.ours.begin(), shown.ours.end(), [](const auto& ours) { return ours && ours->right; });
}

bool measure_all() {
  bool right = true;
  for (const Subject& subject : subjects) {
    fmt::print("{}\n\n", subject.name);
    const Shown shown = measure(subject);
    print_times(subject, shown);
    fmt::print("\n");
    print_memory(shown);
    fmt::print("\n");
    print_limits(subject, shown);
    fmt::print("\n");
    right = right && all_right(shown);
  }
  return right;
}

}  // namespace
}  // namespace poise::benchmarks

int main() { return poise::benchmarks::measure_all() ? 0 : 1; }
