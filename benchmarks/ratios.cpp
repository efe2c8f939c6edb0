// poise_ratios: the speed Poise promises, as one table. Every ratio is of two solvers measured in this run, turn by
// turn, medians over the turns; times of wrong answers are not printed. Exit code 1 if an answer is wrong; times do not
// affect it.

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "benchmarks/bare_ipopt.hpp"
#include "benchmarks/hand_chain.hpp"
#include "benchmarks/hand_four_bar.hpp"
#include "benchmarks/hand_toggle_clamp.hpp"
#include "benchmarks/known_answers.hpp"
#include "benchmarks/race.hpp"
#include "benchmarks/timing.hpp"
#include "benchmarks/yardstick_inputs.hpp"
#include "comparison/series.hpp"
#include "solvers/ipopt.hpp"
#include "solvers/newton.hpp"

namespace poise::benchmarks {
namespace {

constexpr double hand_limit = 3.0;    // Poise's Newton over the one written by hand
constexpr double ipopt_limit = 1.2;   // Poise's Ipopt over the bare program
constexpr double curve_limit = 1.5;   // springs of a curve over linear springs
constexpr double linear_limit = 2.0;  // growth of Poise's time per link and step over the yardstick's

// Result of one solution.
struct Answer {
  int iterations = 0;
  double error = 0.0;  // rad, m or N
};

struct Solver {
  std::function<void()> solve;
  std::function<Answer()> answer;  // of the last solve()
};

struct Race {
  double ours = 0.0, theirs = 0.0;  // median seconds per solution
  Answer our_answer, their_answer;
};

Race race(const Solver& ours, const Solver& theirs) {
  const auto turn = [](const Solver& solver) -> Turn {
    return [&solver](int times) { return seconds_of(solver.solve, times); };
  };
  const std::vector<double> seconds = benchmarks::race({turn(ours), turn(theirs)});
  return {seconds[0], seconds[1], ours.answer(), theirs.answer()};
}

class Table {
 public:
  void head() const {
    fmt::print("{:<34}{:>11}{:>11}{:>8}{:>7}  {:<8}{:>8}{:>10}{:>10}{:>16}\n", "", "Poise", "yardstick", "ratio",
               "limit", "", "steps", "error", "error", "ns/link/step");
  }

  // `links` of a chain, or 0.
  void row(const std::string& name, const Race& race, double limit, double largest_error, int links = 0) {
    const std::string steps = fmt::format("{}/{}", race.our_answer.iterations, race.their_answer.iterations);
    const std::string errors = fmt::format("{:>10.1e}{:>10.1e}", race.our_answer.error, race.their_answer.error);
    if (!(std::max(race.our_answer.error, race.their_answer.error) <= largest_error)) {
      fmt::print("{:<34}{:>37}  {:<8}{:>8}{}\n", name, "", "WRONG", steps, errors);
      all_right_ = false;
      return;
    }
    const double ratio = race.ours / race.theirs;
    const std::string per_link =
        links == 0 ? ""
                   : fmt::format("{:>9.1f}/{:.1f}", 1e9 * race.ours / links / race.our_answer.iterations,
                                 1e9 * race.theirs / links / race.their_answer.iterations);
    fmt::print("{:<34}{:>11}{:>11}{:>8.2f}{:>7.1f}  {:<8}{:>8}{}{}\n", name, in_units(race.ours), in_units(race.theirs),
               ratio, limit, verdict(ratio <= limit), steps, errors, per_link);
  }

  // Growth of the time per link and step from the short chain to the long one. With caches the reference's grows too;
  // beyond that Poise must be linear.
  void growth(const std::string& name, const Race& short_chain, int short_links, const Race& long_chain, int long_links,
              double limit) {
    const auto grows = [&](double before, double after, int steps_before, int steps_after) {
      return (after / long_links / steps_after) / (before / short_links / steps_before);
    };
    const double ours =
        grows(short_chain.ours, long_chain.ours, short_chain.our_answer.iterations, long_chain.our_answer.iterations);
    const double theirs = grows(short_chain.theirs, long_chain.theirs, short_chain.their_answer.iterations,
                                long_chain.their_answer.iterations);
    fmt::print("{:<34}{:>11}{:>11}{:>8.2f}{:>7.1f}  {}\n", name, fmt::format("x {:.2f}", ours),
               fmt::format("x {:.2f}", theirs), ours / theirs, limit, verdict(ours / theirs <= limit));
  }

  bool all_right() const { return all_right_; }

 private:
  const char* verdict(bool met) { return met ? "met" : "MISSED"; }

  bool all_right_ = true;
};

void race_four_bars(Table& table) {
  const StaticModel model(thesis_four_bar());
  const std::vector<double> x = model.start();
  const std::array<double, 3> start = four_bar_start(model);

  solvers::Newton newton(model.problem());
  const solvers::NewtonResult* found = nullptr;
  HandFourBarResult by_hand;
  table.row("four-bar, virtual work",
            race({[&] { found = &newton.solve(x); },
                  [&] {
                    return Answer{found->iterations, four_bar_error(found->x.data())};
                  }},
                 {[&] { by_hand = solve_four_bar_by_hand(start); },
                  [&] {
                    return Answer{by_hand.iterations, four_bar_error(by_hand.angles.data())};
                  }}),
            hand_limit, virtual_work_error);

  solvers::SearchResult ipopt;
  BareIpoptResult bare;
  table.row("four-bar, energy",
            race({[&] { ipopt = solvers::solve_with_ipopt(model.problem(), x); },
                  [&] {
                    return Answer{ipopt.iterations, four_bar_error(ipopt.x.data())};
                  }},
                 {[&] { bare = bare_ipopt_four_bar(start, four_bar_units(model)); },
                  [&] {
                    return Answer{bare.iterations, four_bar_error(bare.angles.data())};
                  }}),
            ipopt_limit, energy_error);
}

void race_toggle_clamps(Table& table) {
  const StaticModel model(read_scene(POISE_SOURCE_DIR "/datasets/toggle_clamp.toml"));
  const std::vector<double> x = model.start();
  const std::array<double, 3> start = {x.at(0), x.at(1), x.at(2)};

  solvers::Newton newton(model.problem());
  const solvers::NewtonResult* found = nullptr;
  HandToggleClampResult by_hand;
  table.row("toggle clamp, virtual work",
            race({[&] { found = &newton.solve(x); },
                  [&] {
                    return Answer{found->iterations, toggle_clamp_error(found->x.data())};
                  }},
                 {[&] { by_hand = solve_toggle_clamp_by_hand(start); },
                  [&] {
                    const double force_error = std::abs(by_hand.clamping_force / toggle_clamp_force - 1.0);
                    return Answer{by_hand.iterations, std::max(toggle_clamp_error(by_hand.angles.data()), force_error)};
                  }}),
            hand_limit, virtual_work_error);
}

Race race_chains(Table& table, int links) {
  const StaticModel model(comparison::hanging_chain_scene(links));
  const std::vector<double> start = model.start();
  solvers::Newton newton(model.problem());
  HandChain by_hand(links);
  const solvers::NewtonResult* found = nullptr;
  const Race result = race({[&] { found = &newton.solve(start); },
                            [&] {
                              return Answer{found->iterations, chain_error(found->x)};
                            }},
                           {[&] { by_hand.solve(start); },
                            [&] {
                              return Answer{by_hand.iterations(), chain_error(by_hand.angles())};
                            }});
  table.row(fmt::format("chain of {} links, virtual work", links), result, hand_limit, virtual_work_error, links);
  return result;
}

void race_chain_energies(Table& table, int links) {
  const StaticModel model(comparison::hanging_chain_scene(links));
  const std::vector<double> start = model.start();
  solvers::SearchResult ipopt;
  BareIpoptResult bare;
  table.row(fmt::format("chain of {} links, energy", links),
            race({[&] { ipopt = solvers::solve_with_ipopt(model.problem(), start); },
                  [&] {
                    return Answer{ipopt.iterations, chain_error(ipopt.x)};
                  }},
                 {[&] { bare = bare_ipopt_chain(start, chain_units(model)); },
                  [&] {
                    return Answer{bare.iterations, chain_error(bare.angles)};
                  }}),
            ipopt_limit, energy_error);
}

// An arm held by many springs of one force each; with curves every one goes through 20 points of that line, and is that
// line again, so that both solutions take the same steps.
Scene fan_of_springs(bool curves) {
  constexpr int springs = 60;
  constexpr std::size_t points = 20;
  Scene scene;
  const int arm = scene.add_body("arm");
  Joint pin;
  pin.a = scene.add_point(0, "O", {0, 0});
  pin.b = scene.add_point(arm, "O", {0, 0});
  scene.add_joint(pin);
  scene.start.angle[1] = 0.3;
  for (int k = 0; k < springs; ++k) {
    const double turn = 0.1 * k;
    Element element;
    element.table = "spring";
    element.name = fmt::format("{}", k);
    element.on = Measure::distance_between(scene.add_point(0, element.name, 2.0 * unit(turn)),
                                           scene.add_point(arm, element.name, {0.5 + 0.01 * k, 0.1}));
    const double stiffness = 1.0 + 0.1 * k, free_length = 1.0 + 0.02 * k;
    std::vector<double> x, force;
    for (std::size_t i = 0; i < points; ++i) {
      x.push_back(0.25 * static_cast<double>(i));
      force.push_back(stiffness * (x.back() - free_length));
    }
    if (curves)
      element.law = CurveSpring(std::move(x), std::move(force), true);
    else
      element.law = LinearSpring{stiffness, free_length};
    scene.elements.push_back(std::move(element));
  }
  return scene;
}

void race_curves(Table& table) {
  const StaticModel curved(fan_of_springs(true)), linear(fan_of_springs(false));
  solvers::Newton on_curves(curved.problem()), on_lines(linear.problem());
  const std::vector<double> start = linear.start();
  const solvers::NewtonResult *found = nullptr, *expected = nullptr;
  table.row("60 spring curves over linear ones",
            race({[&] { found = &on_curves.solve(start); },
                  [&] {
                    return Answer{found->iterations, std::abs(found->x[0] - expected->x[0])};
                  }},
                 {[&] { expected = &on_lines.solve(start); },
                  [&] {
                    return Answer{expected->iterations, 0.0};
                  }}),
            curve_limit, virtual_work_error);
}

bool measure() {
  Table table;
  table.head();
  race_four_bars(table);
  race_toggle_clamps(table);
  race_curves(table);
  race_chains(table, 10);
  const Race short_chain = race_chains(table, 100);
  race_chains(table, 1000);
  race_chains(table, 10000);
  const Race long_chain = race_chains(table, 100000);
  table.growth("time per link, 1e5 over 1e2", short_chain, 100, long_chain, 100000, linear_limit);
  for (int links = 10; links <= 10000; links *= 10) race_chain_energies(table, links);
  fmt::print(
      "\nYardsticks: virtual work, a Newton written by hand for the one mechanism, or Poise with linear springs; "
      "energy, a bare Ipopt program with "
      "the\n"
      "same options and units. steps and error: Poise, then yardstick; error against the reference, rad, m or N.\n");
  return table.all_right();
}

}  // namespace
}  // namespace poise::benchmarks

int main() { return poise::benchmarks::measure() ? 0 : 1; }
