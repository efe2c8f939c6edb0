#include "app/results/motion/control_loop.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "app/result/numbers.hpp"
#include "app/results/parts.hpp"
#include "model/controllers.hpp"

namespace poise::app {
namespace {

using LoopStability = ControlLoop::Stability;
using Poles = std::vector<std::complex<double>>;

constexpr int pole_digits = 9;
// Parts of poles that are smaller, over the largest pole, are rounding.
constexpr double no_part = 1e-12;

Line verdict_on_loop(const Scene& scene, const ControlLoop& loop) {
  if (!loop.known) return bad(no_equilibrium_in_words(scene, loop));
  const bool samples = loop.period > 0.0, is_of_set = !scene.blades.empty();
  const std::string subject = controllers_of(scene).empty() ? "The equilibrium" : "The closed loop";
  if (!scene.blades.empty() && loop.poles.size() == scene.blades.size()) {
    return doubtful(subject + " is held by its blades: all poles are those of a set of equilibria.");
  }
  // Poles of blades, which decay by nothing, stand before those that decay.
  const std::complex<double>& pole =
      loop.poles[loop.stability == LoopStability::stable ? scene.blades.size() : std::size_t{0}];
  const std::string slowest = significant(samples ? std::log(std::abs(pole)) / loop.period : pole.real(), 6);
  switch (loop.stability) {
    case LoopStability::stable:
      return good(fmt::format("{} is stable: what is slowest in it decays at {} 1/s{}.", subject, slowest,
                              is_of_set ? ", to one of a set of equilibria" : ""));
    case LoopStability::marginal:
      return doubtful(fmt::format("{} neither decays nor grows: some pole{} {}.", subject,
                                  is_of_set ? " beside those of its blades" : "",
                                  samples ? "z has the size 1" : "has no real part"));
    case LoopStability::unstable:
      break;
  }
  return bad(fmt::format("{} is unstable: a disturbance grows at {} 1/s.", subject, slowest));
}

void add_poles(Group& group, const std::string& key, const std::string& title, const Poles& poles) {
  double largest = 0.0;
  for (const std::complex<double>& one : poles) largest = std::max(largest, std::abs(one));
  const Format format{.style = Format::Style::significant, .digits = pole_digits, .zero_below = no_part * largest};
  Table& table = group.table(key, title, Rows::columns);
  table.numbers("re", "real", "1/s", each(poles, [](const auto& p) { return p.real(); }), format);
  table.numbers("im", "imaginary", "1/s", each(poles, [](const auto& p) { return p.imag(); }), format);
  table.numbers("", "size", "Hz", each(poles, [](const auto& p) { return std::abs(p) / (2 * M_PI); }),
                {.style = Format::Style::significant, .zero_below = no_part * largest});
  table.numbers(
      "", "damping ratio", "",
      each(poles, [&](const auto& p) { return std::abs(p) > no_part * largest ? -p.real() / std::abs(p) : NAN; }),
      {.style = Format::Style::significant, .zero_below = no_part});
}

/// Poles z of samples with a period.
void add_poles_of_samples(Group& group, const Poles& poles, double period) {
  const Format format{.style = Format::Style::significant, .digits = pole_digits, .zero_below = no_part};
  const Format rounded{.style = Format::Style::significant, .zero_below = no_part};
  Table& table = group.table("z_poles", "Poles z of the closed loop, from sample to sample", Rows::columns);
  table.numbers("re", "real", "", each(poles, [](const auto& z) { return z.real(); }), format);
  table.numbers("im", "imaginary", "", each(poles, [](const auto& z) { return z.imag(); }), format);
  table.numbers("", "size", "", each(poles, [](const auto& z) { return std::abs(z); }), rounded);
  table.numbers("", "growth", "1/s", each(poles, [&](const auto& z) { return std::log(std::abs(z)) / period; }),
                {.style = Format::Style::significant});
}

/// [[a, ...], ...], row by row.
void add_matrix(Group& group, const std::string& key, const Eigen::MatrixXd& matrix) {
  Table& table = group.table(key, "", Rows::list, Verbosity::data);
  for (Eigen::Index j = 0; j < matrix.cols(); ++j) {
    table.data("[]", {matrix.col(j).begin(), matrix.col(j).end()});
  }
}

void add_system(Group& content, const std::string& key, const StateSpace& system) {
  Group& group = content.group(key, "", Verbosity::data);
  group.data("states", system.states);
  group.data("inputs", system.inputs);
  group.data("outputs", system.outputs);
  add_matrix(group, "A", system.a);
  add_matrix(group, "B", system.b);
  add_matrix(group, "C", system.c);
  add_matrix(group, "D", system.d);
}

/// The file of the matrices [A B; C D].
void add_block(Group& content, const StateSpace& system) {
  Eigen::MatrixXd block(system.a.rows() + system.c.rows(), system.a.cols() + system.b.cols());
  block << system.a, system.b, system.c, system.d;
  std::vector<std::string> names = system.states;
  names.insert(names.end(), system.inputs.begin(), system.inputs.end());
  Table& table = content.table("", "", Rows::columns, Verbosity::data);
  table.csv = true;
  for (Eigen::Index j = 0; j < block.cols(); ++j) {
    table.data(names[static_cast<std::size_t>(j)], {block.col(j).begin(), block.col(j).end()});
  }
}

void add_controllers(Group& content, const MotionModel& model, const ControlLoop& loop) {
  const Units& units = model.scene().units;
  const auto element = [&](const ControlAtRest& one) -> const Element& {
    return model.scene().elements[static_cast<std::size_t>(one.element)];
  };
  const auto read_dimension = [&](const ControlAtRest& one) { return element(one).feedback->signal; };
  const auto effort_dimension = [&](const ControlAtRest& one) { return element(one).feedback->output; };
  const auto words = [](double value, const std::string& unit) {
    return fmt::format("{} {}", significant(value, 8), unit);
  };
  const std::vector<ControlAtRest>& rows = loop.controllers;
  Branch& data = content.array("controllers");
  std::vector<std::string> reads, efforts, remarks;
  for (const ControlAtRest& one : rows) {
    const double value = one.value / read_dimension(one).unit(units),
                 effort = one.effort / effort_dimension(one).unit(units);
    Group& part = data.parts.emplace_back();
    part.data("name", element(one).name);
    part.data("reads", value);
    part.data("reads_unit", read_dimension(one).unit_name(units));
    part.data("effort", effort);
    part.data("effort_unit", effort_dimension(one).unit_name(units));
    part.data("limited", one.limited);
    part.data("in_dead_band", one.in_dead_band);
    reads.push_back(words(value, read_dimension(one).unit_name(units)));
    efforts.push_back(words(effort, effort_dimension(one).unit_name(units)));
    remarks.emplace_back(one.limited        ? "at its limit: it does not act on small motions"
                         : one.in_dead_band ? "in its dead band: it does not act on small motions"
                                            : "");
  }
  Table& table = content.group("").table("", "Controllers in equilibrium", Rows::list);
  table.words("", "controller", each(rows, [&](const ControlAtRest& one) { return element(one).name; }));
  table.words("", "reads", std::move(reads));
  table.words("", "effort", std::move(efforts));
  table.remarks(std::move(remarks), Tone::doubtful);
}

void add_blades(Group& content, const MotionModel& model, const ControlLoop& loop) {
  const Scene& scene = model.scene();
  const std::size_t blades = scene.blades.size();
  const std::string pole = loop.period > 0.0 ? "z = 1" : "0";
  content.fact("set",
               blades == 1
                   ? fmt::format("the blade holds other positions beside this one, too: a pole is {}", pole)
                   : fmt::format("the blades hold other positions beside this one, too, in {} directions: as many "
                                 "poles are {}",
                                 blades, pole));
  Table& table = content.table("blades", "Blades in equilibrium", Rows::list);
  table.words("name", "blade", each(scene.blades, &Blade::name));
  table.words("on", "on", each(scene.blades, [&](const Blade& blade) { return scene.name_of(blade.at); }));
  table.numbers("force", "force across its edge", "", in_unit(loop.blade_force, Quantity::force, scene.units)).texts =
      each(loop.blade_force, [&](double force) { return with_unit(model, force, Quantity::force); });
}

void add_delays(Group& content, const MotionModel& model, const ControlLoop& loop) {
  std::vector<std::string> words;
  Branch& data = content.array("delays");
  for (const DelayedControl& one : loop.delayed) {
    const std::string& name = model.scene().elements[static_cast<std::size_t>(one.element)].name;
    words.push_back(fmt::format("{} {} s", name, significant(one.delay, 8)));
    Group& part = data.parts.emplace_back();
    part.data("name", name);
    part.data("delay", one.delay);
  }
  content.fact("delays", fmt::format("{}", fmt::join(words, ", ")));
  content.fact("listed", fmt::format("all poles that are right of {} 1/s, counted; there are infinitely many",
                                     significant(loop.poles_right_of, 6)));
  content.data("poles_right_of", loop.poles_right_of);
}

}  // namespace

const char* name_of_stability(const ControlLoop& loop) {
  switch (loop.stability) {
    case LoopStability::stable:
      return "stable";
    case LoopStability::marginal:
      return "marginal";
    case LoopStability::unstable:
      return "unstable";
  }
  return "";
}

std::string no_equilibrium_in_words(const Scene& scene, const ControlLoop& loop) {
  const std::string_view kept_by = what_keeps(scene);
  return fmt::format("No equilibrium {} its {}: {}.", kept_by == "blades" ? "on" : "with", kept_by, loop.why);
}

Result control_loop_result(const MotionModel& model, const ControlLoop& loop,
                           const std::vector<std::string>& settings) {
  Result out = scene_result(model.scene(), settings);
  out.verdict = verdict_on_loop(model.scene(), loop);
  Group& content = out.content;
  content.data("known", loop.known);
  content.data("why_unknown", loop.why);
  if (!loop.known) return out;
  content.data("stability", name_of_stability(loop));
  const std::vector<double> q = model.to_si(loop.x);
  const std::vector<int> own = states_of_controllers(model.scene(), model.layout());
  std::vector<std::size_t> rows = places(q.size());
  std::erase_if(rows,
                [&](std::size_t i) { return std::find(own.begin(), own.end(), static_cast<int>(i)) != own.end(); });
  const auto quantity = [&](std::size_t i) {
    return model.layout().is_length(static_cast<int>(i)) ? Quantity::length : Quantity::angle;
  };
  Table& coordinates = content.table("coordinates", "", Rows::list, Verbosity::data);
  coordinates.words("name", "", each(rows, [&](std::size_t i) { return model.layout().coordinates[i].name; }));
  coordinates.words("kind", "", each(rows, [&](std::size_t i) {
                      return std::string(quantity(i) == Quantity::length ? "length" : "angle");
                    }));
  coordinates.data("value", each(rows, [&](std::size_t i) { return in_unit(q[i], quantity(i), model.scene().units); }));
  const bool is_controlled = !loop.controllers.empty();
  const auto number = [](const std::vector<std::string>& names, const char* one, const char* several) {
    return count(static_cast<int>(names.size()), one, several);
  };
  content.fact("system",
               fmt::format("{}{}: {}", number(loop.closed.states, "state", "states"),
                           is_controlled ? fmt::format(", {}, {}", number(loop.closed.inputs, "input", "inputs"),
                                                       number(loop.closed.outputs, "output", "outputs"))
                                         : "",
                           fmt::join(loop.closed.states, ", ")));
  if (!loop.blade_force.empty()) add_blades(content, model, loop);
  if (is_controlled) add_controllers(content, model, loop);
  if (loop.period > 0.0) {
    content.fact("samples", fmt::format("each {} s", significant(loop.period, 8)));
    content.data("period", loop.period);
    add_poles_of_samples(content, loop.poles, loop.period);
  } else {
    add_poles(content, "poles", is_controlled ? "Poles of the closed loop" : "Poles", loop.poles);
  }
  if (!loop.delayed.empty()) add_delays(content, model, loop);
  if (is_controlled) add_poles(content, "open_poles", "Poles of the mechanism alone", loop.open_poles);
  add_system(content, "closed_loop", loop.closed);
  if (is_controlled) add_system(content, "open_loop", loop.open);
  add_block(content, loop.closed);
  return out;
}

}  // namespace poise::app
