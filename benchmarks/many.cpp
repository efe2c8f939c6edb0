// poise_many: many variants of a scene at once, per variant beside Newton's method written by hand in plain doubles for
// that one mechanism, from the same start to the same step. Medians over turns of this run; times of wrong answers are
// not printed. Exit code 1 if an answer of Poise is wrong; times do not affect it.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "benchmarks/hand_four_bar.hpp"
#include "benchmarks/hand_toggle_clamp.hpp"
#include "benchmarks/race.hpp"
#include "benchmarks/ratio_table.hpp"
#include "benchmarks/timing.hpp"
#include "benchmarks/yardstick_inputs.hpp"
#include "model/read_scene.hpp"
#include "solvers/parallel.hpp"
#include "statics/many/solve_many.hpp"
#include "statics/sensitivity/tolerance.hpp"

namespace poise::benchmarks {
namespace {

constexpr std::size_t variants = 200'000;
constexpr std::size_t compared = 500;         // variants that are solved one by one too, evenly spread
constexpr double largest_difference = 1e-12;  // rad or m
constexpr double four_bar_limit = 1.0, clamp_limit = 1.3, threads_limit = 1.8;

struct Case {
  std::string name;
  Scene scene;
  std::vector<std::string> numbers;
  std::vector<std::vector<double>> values;

  std::vector<ManyValues> varied() const {
    std::vector<ManyValues> out;
    for (std::size_t k = 0; k < numbers.size(); ++k) out.push_back({numbers[k], values[k]});
    return out;
  }
};

// Each number drawn evenly within a part of its value.
Case drawn(std::string name, Scene scene, std::vector<std::string> numbers, double part) {
  Case out{std::move(name), std::move(scene), std::move(numbers), {}};
  std::size_t k = 0;
  for (const std::string& number : out.numbers) {
    const double value = get_value(out.scene, number), step = 0.6180339887498949 + 0.1 * static_cast<double>(k++);
    std::vector<double> values;
    double at = 0.0;
    for (std::size_t v = 0; v < variants; ++v) {
      at += step;
      at -= std::floor(at);
      values.push_back(value * (1.0 + part * (2.0 * at - 1.0)));
    }
    out.values.push_back(std::move(values));
  }
  return out;
}

// The largest difference of a coordinate from that of solve() alone, relative to one rad or m where it is larger.
double error_of(const Case& of, const ManySolutions& found) {
  double error = 0.0;
  const std::size_t width = found.coordinates.size();
  for (std::size_t k = 0; k < compared; ++k) {
    const std::size_t v = k * variants / compared;
    Scene scene = of.scene;
    for (std::size_t i = 0; i < of.numbers.size(); ++i) set_value(scene, of.numbers[i], of.values[i][v]);
    const StaticModel model(scene);
    const Equilibrium alone = solve(model);
    if (!alone.found() || found.solved_by[v] == SolvedBy::none) return 1.0;
    const std::vector<double> q = model.to_si(alone.x);
    for (std::size_t i = 0; i < width; ++i) error = std::max(error, std::abs(q[i] - found.q[v * width + i]));
  }
  return error;
}

double seconds_in_lanes(const Case& of, Simd simd, int jobs, ManySolutions& found) {
  ManyOptions options;
  options.simd = simd;
  options.jobs = jobs;
  return seconds_of([&] { found = solve_many(of.scene, of.varied(), options); }, 1) / static_cast<double>(variants);
}

// Gives the seconds of the yardstick.
template <class ByHand>
double race_case(RatioTable& table, const Case& of, double limit, ByHand by_hand) {
  std::vector<Simd> all;
  for (const Simd simd : {Simd::plain, Simd::avx2, Simd::avx512}) {
    if (has_simd(simd)) all.push_back(simd);
  }
  std::vector<ManySolutions> found(all.size());
  std::vector<Turn> turns{[&](int) { return seconds_of([&] { by_hand(); }, 1) / static_cast<double>(variants); }};
  for (std::size_t k = 0; k < all.size(); ++k) {
    turns.push_back([&, k](int) { return seconds_in_lanes(of, all[k], 1, found[k]); });
  }
  const std::vector<double> seconds = race(turns, {.seconds = 5.0});
  for (std::size_t k = 0; k < all.size(); ++k) {
    const double error = error_of(of, found[k]);
    table.ratio(fmt::format("{}, {}", of.name, to_string(all[k])), seconds[k + 1], seconds[0], limit,
                error <= largest_difference,
                fmt::format("error {:.1e}, {:.2f} % one by one", error,
                            100.0 * static_cast<double>(found[k].by_search) / static_cast<double>(variants)));
  }
  return seconds[0];
}

void race_threads(RatioTable& table, const Case& of, Simd simd) {
  if (solvers::threads_of(0) < 2) return;
  ManySolutions one, two;
  const std::vector<double> seconds = race({[&](int) { return seconds_in_lanes(of, simd, 1, one); },
                                            [&](int) { return seconds_in_lanes(of, simd, 2, two); }},
                                           {.seconds = 5.0});
  table.speedup(fmt::format("{}, two threads over one", of.name), seconds[1], seconds[0], threads_limit,
                one.q == two.q && one.solved_by == two.solved_by, "");
}

Scene dataset(const char* name) { return read_scene(fmt::format("{}/datasets/{}", POISE_SOURCE_DIR, name)); }

void race_tolerances(RatioTable& table, double per_variant) {
  const StaticModel model(dataset("toggle_clamp.toml"));
  const std::vector<Tolerance> tolerances = parse_tolerances(
      "[tolerances]\n\"point.*\" = 0.02\n\"spring.rubber.stiffness\" = { percent = 5 }\n", "tolerances", model.scene());
  ToleranceOptions options;
  options.samples = 1'000'000;
  options.jobs = 1;
  ToleranceStudy study;
  const double seconds = seconds_of(
      [&] { study = tolerance_study(model, tolerances, {find_quantity(model.scene(), "force.rubber")}, options); }, 1);
  table.ratio("clamp, 10^6 tolerance samples", seconds, 1e6 * per_variant, 1.0, study.samples == options.samples,
              fmt::format("{} numbers, {} followed one by one", tolerances.size(), study.followed));
}

int run() {
  RatioTable table;
  table.head();
  const StaticModel four_bar_model(thesis_four_bar());
  const std::array<double, 3> start = four_bar_start(four_bar_model);
  const Case four_bar = drawn("four-bar", thesis_four_bar(), {"load.lift"}, 0.05);
  double sum = 0.0;  // so that nothing is left out
  race_case(table, four_bar, four_bar_limit, [&] {
    for (std::size_t v = 0; v < variants; ++v) sum += solve_four_bar_by_hand(start).angles[0];
  });
  const Case clamp = drawn("toggle clamp", dataset("toggle_clamp.toml"), {"load.P", "spring.rubber.stiffness"}, 0.05);
  const std::vector<double> clamp_start = StaticModel(clamp.scene).start();
  const double by_hand = race_case(table, clamp, clamp_limit, [&] {
    for (std::size_t v = 0; v < variants; ++v) {
      const HandToggleClampNumbers numbers{clamp.values[0][v], clamp.values[1][v]};
      sum += solve_toggle_clamp_by_hand({clamp_start[0], clamp_start[1], clamp_start[2]}, numbers).angles[0];
    }
  });
  const Simd widest = has_simd(Simd::avx2) ? Simd::avx2 : Simd::plain;
  race_threads(table, four_bar, widest);
  race_threads(table, clamp, widest);
  race_tolerances(table, clamp_limit * by_hand);
  if (!std::isfinite(sum)) return 1;
  return table.all_right() ? 0 : 1;
}

}  // namespace
}  // namespace poise::benchmarks

int main() { return poise::benchmarks::run(); }
