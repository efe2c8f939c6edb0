// poise_contact_work: work against precision of motions with impacts, in Poise and in MuJoCo, Simbody and Box2D where
// they are installed. For every program and setting the error of the states read, against exact ones, and the time of
// the processor, all measured in this run; models are made beforehand. Beside each setting of another program stands
// the fastest one of Poise whose error is a thousand times smaller.

#include "benchmarks/contact_work.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <exception>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "benchmarks/contact_truth.hpp"
#include "benchmarks/ratio_table.hpp"
#include "benchmarks/timing.hpp"

namespace poise::benchmarks {
namespace {

constexpr double smaller = 1e-3;    // part of another program's error that Poise is to reach
constexpr double most_times = 2.0;  // of the time of the other program, in which it is to reach it
constexpr int fewest_runs = 3;
constexpr double time_for_runs = 0.05;  // s
// Errors that are asked for. Those above the first are no answers.
constexpr double asked[] = {1e-1, 1e-2, 1e-3};

double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Measured {
  std::string program, value, note;
  double error = std::numeric_limits<double>::infinity(), seconds = 0.0;
  double known = error;  // the error that counts
};

double error_of(const std::vector<ContactState>& states, const ContactTruth& truth) {
  double most = 0.0;
  for (std::size_t k = 0; k < states.size(); ++k) {
    const double place = std::abs(states[k].place - truth.states[k].place) / truth.travel;
    const double rate = std::abs(states[k].rate - truth.states[k].rate) / truth.speed;
    // One that is not a number is no answer.
    most = place + rate >= 0.0 ? std::max({most, place, rate}) : std::numeric_limits<double>::infinity();
  }
  return most;
}

// The fastest of several runs.
Measured measure(const ContactSetting& setting, const ContactTruth& truth) {
  Measured out{.program = setting.program, .value = setting.value, .note = {}};
  try {
    const std::unique_ptr<ContactMotion> motion = setting.make();
    out.seconds = std::numeric_limits<double>::infinity();
    double spent = 0.0;
    for (int runs = 0; runs < fewest_runs || spent < time_for_runs; ++runs) {
      motion->begin();
      const double from = processor_seconds();
      const std::vector<ContactState> states = motion->move();
      const double took = processor_seconds() - from;
      out.seconds = std::min(out.seconds, took);
      spent += took;
      out.error = error_of(states, truth);
    }
    out.note = motion->note();
  } catch (const std::exception& failure) {
    out.error = std::numeric_limits<double>::infinity();
    out.note = failure.what();
  }
  return out;
}

// A setting may be right by chance, on which nobody can rely: as its error counts that of the next finer setting of the
// same program where it is larger.
std::vector<Measured> measure(const std::vector<ContactSetting>& settings, const ContactTruth& truth) {
  std::vector<Measured> out;
  for (const ContactSetting& setting : settings) out.push_back(measure(setting, truth));
  for (std::size_t k = 0; k < out.size(); ++k) {
    const bool has_finer = k + 1 < out.size() && out[k + 1].program == out[k].program;
    out[k].known = has_finer ? std::max(out[k].error, out[k + 1].error) : out[k].error;
  }
  return out;
}

const Measured* fastest(const std::vector<Measured>& of, double error) {
  const Measured* best = nullptr;
  for (const Measured& one : of) {
    if (one.known <= error && (best == nullptr || one.seconds < best->seconds)) best = &one;
  }
  return best;
}

// None where none of them is installed.
std::vector<ContactSetting> settings_of_others([[maybe_unused]] const ContactProblem& problem) {
  std::vector<ContactSetting> out;
  [[maybe_unused]] const auto add = [&](const std::vector<ContactSetting>& more) {
    out.insert(out.end(), more.begin(), more.end());
  };
#ifdef POISE_BOX2D
  add(box2d_settings(problem));
#endif
#ifdef POISE_MUJOCO
  add(mujoco_settings(problem));
#endif
#ifdef POISE_SIMBODY
  add(simbody_settings(problem));
#endif
  return out;
}

void print(const Measured& one, const std::string& beside) {
  fmt::print("  {:<32}{:<16}{:>9}{:>12}  {}\n", one.program, one.value,
             std::isfinite(one.error) ? fmt::format("{:.1e}", one.error) : "none", in_units(one.seconds), beside);
}

// What is compared in the end: the fastest of the others for an error asked for, and Poise.
struct Row {
  std::string name, note;
  double ours = 0.0, theirs = 0.0;
  bool found = false;
};

std::vector<Row> compare(const ContactProblem& problem) {
  const ContactTruth truth = truth_of(problem);
  fmt::print("\n{}: {} impacts\n  {:<32}{:<16}{:>9}{:>12}  Poise at a thousandth of the error\n", problem.title,
             truth.impacts, "", "", "error", "time");
  const std::vector<Measured> poise = measure(poise_settings(problem), truth);
  const std::vector<Measured> others = measure(settings_of_others(problem), truth);
  for (const Measured& one : poise) print(one, one.note);
  for (const Measured& one : others) {
    const Measured* const ours = fastest(poise, smaller * one.known);
    print(one, one.known > asked[0] ? ""
               : ours == nullptr    ? "none"
                                 : fmt::format("{}, {:.2g} x", in_units(ours->seconds), ours->seconds / one.seconds));
  }
  std::vector<Row> rows;
  for (double error : asked) {
    const Measured* const theirs = fastest(others, error);
    if (theirs == nullptr) continue;
    const Measured* const ours = fastest(poise, smaller * theirs->known);
    Row& row = rows.emplace_back();
    row.name = fmt::format("{}, {:.0e}", problem.name, error);
    row.theirs = theirs->seconds;
    row.found = ours != nullptr;
    row.ours = row.found ? ours->seconds : 0.0;
    row.note = fmt::format("{}, {}, error {:.1e}", theirs->program, theirs->value, theirs->known);
    if (row.found) row.note += fmt::format("; {}, error {:.1e}", ours->value, ours->known);
  }
  return rows;
}

int compare_all() {
#ifndef POISE_BOX2D
  fmt::print("left out: Box2D (cmake/setup.sh baselines)\n");
#endif
#ifndef POISE_MUJOCO
  fmt::print("left out: MuJoCo (cmake/setup.sh baselines)\n");
#endif
#ifndef POISE_SIMBODY
  fmt::print("left out: Simbody (cmake/setup.sh baselines)\n");
#endif
  // Read first while the bounces are high, so that what lies still already is far off, and then at rest.
  const std::vector<ContactProblem> problems = {
      {ContactScene::ball, "bouncing ball", "Bouncing ball, read after 2 and 5 s", {2.0, 5.0}},
      {ContactScene::block, "rocking block", "Rocking block, read after 2 s", {2.0}},
      {ContactScene::toggle, "toggle on its stop", "Toggle falling onto its stop, read after 0.8 and 3 s", {0.8, 3.0}}};
  std::vector<Row> rows;
  for (const ContactProblem& problem : problems) {
    const std::vector<Row> more = compare(problem);
    rows.insert(rows.end(), more.begin(), more.end());
  }
  RatioTable table;
  fmt::print("\n");
  table.head();
  for (const Row& row : rows) table.ratio(row.name, row.ours, row.theirs, most_times, row.found, row.note);
  fmt::print(
      "\nYardsticks: of the settings of the other programs the fastest one with at most that error. Poise: the fastest "
      "setting\nwhose error is a thousand times smaller. Errors are of places and rates, over those at the first "
      "impact; as error of a\nsetting counts that of the next finer one where it is larger.\n");
  return table.all_right() ? 0 : 1;
}

}  // namespace
}  // namespace poise::benchmarks

int main() { return poise::benchmarks::compare_all(); }
