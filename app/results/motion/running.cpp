#include "app/results/motion/running.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/draw/chart/quantity_charts.hpp"
#include "app/result/numbers.hpp"
#include "app/results/parts.hpp"

namespace poise::app {
namespace {

constexpr double whole_turn_in_rad = 2 * M_PI;
constexpr int digits_of_running = 10;

std::string per_minute(double speed) { return fmt::format("{:.7g} turns/min", speed * 60 / whole_turn_in_rad); }

std::string speed_in_words(double speed, const Units& units) {
  return fmt::format("{:.9g} {}/s", speed / units.angle, unit_name(Quantity::angle, units));
}

double angle_in_turn(double angle, const Units& units) {
  return (angle - whole_turn_in_rad * std::floor(angle / whole_turn_in_rad)) / units.angle;
}

Line verdict(const RunningAnswer& answer, const Units& units) {
  const SteadyRunning& found = answer.found;
  if (!found.found) return bad("No steady running found: " + found.why + ".");
  const std::string speed = fmt::format("{}, {}", speed_in_words(found.mean, units), per_minute(found.mean));
  if (found.stable) return good(fmt::format("It runs steadily at {} on average; stable.", speed));
  constexpr double as_large = 1e-6;
  const bool stays = std::abs(found.multipliers.front()) < 1 + as_large;
  return doubtful(fmt::format("It can run at {} on average, but not stably: a disturbance {}.", speed,
                              stays ? "stays, as no torque holds this speed" : "grows"));
}

void add_speeds(Group& group, const RunningAnswer& answer, const Units& units) {
  const SteadyRunning& found = answer.found;
  const std::string angle = unit_name(Quantity::angle, units);
  const Format exact{.style = Format::Style::significant, .digits = digits_of_running};
  group.entry("period", "period", found.period, "s", exact,
              fmt::format("({} of {}, {})", answer.turns == 1 ? "one turn" : fmt::format("{} turns", answer.turns),
                          answer.turning, found.direction > 0 ? "counter-clockwise" : "clockwise"));
  group.entry("mean_speed", "mean speed", found.mean / units.angle, angle + "/s", exact,
              "(" + per_minute(found.mean) + ")");
  const auto extreme = [&](const char* key, const char* label, const SpeedAt& at) {
    group.entry(key, label, at.speed / units.angle, angle + "/s", exact,
                fmt::format("at {:.4g} {}", angle_in_turn(at.angle, units), angle));
    group.data(std::string(key) + "_at", angle_in_turn(at.angle, units));
  };
  extreme("slowest", "slowest", found.slowest);
  extreme("fastest", "fastest", found.fastest);
  group.entry("fluctuation", "fluctuation", found.fluctuation(), "", {.style = Format::Style::significant},
              "(fastest - slowest) / mean");
}

void add_stability(Group& group, const SteadyRunning& found) {
  std::vector<std::string> words;
  for (const std::complex<double>& one : found.multipliers) {
    const double zero = 1e-9;
    words.push_back(
        std::abs(one.imag()) > zero
            ? fmt::format("{:.6g} {} {:.6g} i", one.real(), one.imag() > 0 ? "+" : "-", std::abs(one.imag()))
            : fmt::format("{:.6g}", std::abs(one.real()) > zero ? one.real() : 0.0));
  }
  group.fact("multipliers", fmt::format("{}: what is left of a disturbance after a period", fmt::join(words, ", ")),
             found.stable ? Tone::plain : Tone::doubtful);
  group.data("stable", found.stable);
  Table& table = group.table("multipliers", "", Rows::columns, Verbosity::data);
  table.data("re", each(found.multipliers, [](const std::complex<double>& z) { return z.real(); }));
  table.data("im", each(found.multipliers, [](const std::complex<double>& z) { return z.imag(); }));
  group.entry("residual", "residual", found.residual, "", {.style = Format::Style::error},
              "(of the state after a period, in a motion a hundred times as accurate)");
  group.entry("error", "error", found.error, "", {.style = Format::Style::error}, "(of the motion)",
              Verbosity::verbose);
  group.data("periods", found.periods);
}

void add_motors(Group& group, const MotionModel& model, const RunningAnswer& answer) {
  const Units& units = model.scene().units;
  const std::vector<std::size_t> rows = places(answer.motors.size());
  const auto name = [&](std::size_t k) -> const std::string& {
    return model.scene().elements[static_cast<std::size_t>(answer.motors[k].item)].name;
  };
  const auto unit = [&](std::size_t k) { return answer.motors[k].dimension.unit(units); };
  Table& table = group.table("motors", "Motors", Rows::list);
  table.words("name", "motor", each(rows, name));
  // A motor drives with the opposite of the force with which it resists.
  const auto column = [&](const char* key, const char* title, auto value) {
    table.numbers(key, title, "", each(rows, [&](std::size_t k) { return value(answer.ranges[k]) / unit(k); }),
                  {.style = Format::Style::significant, .digits = 8});
  };
  column("mean", "mean effort", [](const QuantityRange& range) { return -range.mean; });
  column("least", "least", [](const QuantityRange& range) { return -range.greatest.value; });
  column("greatest", "greatest", [](const QuantityRange& range) { return -range.least.value; });
  table.words("unit", "", each(rows, [&](std::size_t k) { return answer.motors[k].dimension.unit_name(units); }));
  table.numbers("power", "mean power", "W", answer.power, {.style = Format::Style::significant, .digits = 8});
}

void add_joints(Group& group, const MotionModel& model, const RunningAnswer& answer) {
  const Units& units = model.scene().units;
  const std::vector<std::size_t> rows = places(answer.joints.size());
  const auto range = [&](std::size_t k) -> const QuantityRange& { return answer.ranges[answer.motors.size() + k]; };
  const std::string unit = unit_name(Quantity::force, units);
  double largest = 0.0;
  for (const std::size_t k : rows) largest = std::max(largest, range(k).greatest.value);
  const Format format{.style = Format::Style::significant, .digits = 8, .zero_below = 1e-10 * largest / units.force};
  Table& table = group.table("joint_forces", "Forces of joints over the period", Rows::list);
  table.words("name", "joint", each(rows, [&](std::size_t k) {
                return model.scene().joints[static_cast<std::size_t>(answer.joints[k].item)].name;
              }));
  const auto column = [&](const char* key, const char* title, auto value) {
    table.numbers(key, title, unit, each(rows, [&](std::size_t k) { return value(range(k)) / units.force; }), format);
  };
  column("mean", "mean", [](const QuantityRange& one) { return one.mean; });
  column("least", "least", [](const QuantityRange& one) { return one.least.value; });
  column("greatest", "greatest", [](const QuantityRange& one) { return one.greatest.value; });
  table.numbers("greatest_at", "at", "s", each(rows, [&](std::size_t k) { return range(k).greatest.time; }),
                {.style = Format::Style::significant});
}

void add_record(Group& group, const MotionModel& model, const RunningAnswer& answer) {
  const Units& units = model.scene().units;
  Table& table = group.table("record", "", Rows::columns, Verbosity::data);
  table.csv = true;
  table.data("time", answer.shown.time);
  table.data("angle", each(answer.angle, [&](double one) { return one / units.angle; }));
  table.data("speed", each(answer.speed, [&](double one) { return one / units.angle; }));
  for (std::size_t k = 0; k < answer.shown.of.size(); ++k) {
    const double unit = answer.shown.of[k].dimension.unit(units);
    table.data(answer.shown.of[k].name, each(answer.shown.value[k], [&](double one) { return one / unit; }));
  }
}

}  // namespace

Result running_result(const MotionModel& model, const RunningAnswer& answer, const std::vector<std::string>& settings) {
  const Units& units = model.scene().units;
  Result out = scene_result(model.scene(), settings);
  out.verdict = verdict(answer, units);
  out.content.data("found", answer.found.found);
  out.content.data("why", answer.found.why);
  out.content.data("turning", answer.turning);
  out.content.data("turns", answer.turns);
  if (!answer.found.found) return out;
  Group& facts = out.content.group("");
  add_speeds(facts, answer, units);
  add_stability(facts, answer.found);
  add_motors(out.content, model, answer);
  add_joints(out.content, model, answer);
  add_record(out.content, model, answer);
  return out;
}

std::vector<Panel> running_panels(const Units& units, const RunningAnswer& answer) {
  const std::string angle = unit_name(Quantity::angle, units);
  const std::vector<double> x = each(answer.angle, [&](double one) { return one / units.angle; });
  Panel speeds{.title = fmt::format("Speed of {}", answer.turning), .y_label = angle + "/s"};
  speeds.curves.push_back({.name = "", .x = x, .y = each(answer.speed, [&](double one) { return one / units.angle; })});
  std::vector<Panel> out{std::move(speeds)};
  for (Panel& panel : quantity_panels(answer.shown.of, answer.shown.value, units, x,
                                      fmt::format("angle of {} ({})", answer.turning, angle))) {
    out.push_back(std::move(panel));
  }
  return out;
}

}  // namespace poise::app
