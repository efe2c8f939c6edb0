#include "app/commands/commands.hpp"

#include <algorithm>
#include <cctype>
#include <optional>
#include <string_view>
#include <variant>

#include <fmt/format.h>

#include "model/input_error.hpp"
#include "model/nearest_name.hpp"

namespace poise::app {
namespace {

std::vector<std::string> names_of(const std::vector<CommandEntry>& commands) {
  std::vector<std::string> out;
  for (const CommandEntry& entry : commands) out.push_back(entry.command.name);
  return out;
}

struct KindOfTarget {
  const char* operator()(const bool*) const { return "flag"; }
  const char* operator()(const int*) const { return "whole number"; }
  const char* operator()(const std::uint64_t*) const { return "whole number"; }
  const char* operator()(const double*) const { return "number"; }
  const char* operator()(const std::string*) const { return "text"; }
  const char* operator()(const std::vector<std::string>*) const { return "list"; }
  template <class Value>
  const char* operator()(const std::optional<Value>*) const {
    return (*this)(static_cast<const Value*>(nullptr));
  }
};

}  // namespace

const char* kind_of(const Option& option) { return std::visit(KindOfTarget{}, option.target); }

std::vector<CommandEntry> all_commands() {
  return {
      {check_command(), "datasets/six_bar.toml", InPage::of_scene},
      {solve_command(), "datasets/toggle_clamp.toml --set load.P=30 --svg clamp.svg --json clamp.json",
       InPage::of_scene},
      {equilibria_command(), "datasets/four_bar_gravity.toml --svg equilibria.svg", InPage::of_scene},
      {hold_command(), "datasets/friction/wedge.toml --vary load.P", InPage::of_scene},
      {view_command(), "datasets/toggle_clamp.toml", InPage::no},
      {path_command(), "datasets/von_mises_toggle.toml --vary load.P=0..60 --svg toggle.svg", InPage::of_scene},
      {find_command(),
       "datasets/toggle_clamp.toml --vary spring.rubber.stiffness=200..800 --for \"force.rubber = -700\"",
       InPage::of_scene},
      {sensitivity_command(), "datasets/toggle_clamp.toml --of force.rubber,fold.load.P", InPage::of_scene},
      {tolerance_command(),
       "datasets/toggle_clamp.toml --tolerances datasets/toggle_clamp_tolerances.toml --of force.rubber",
       InPage::of_scene},
      {loads_command(), "datasets/structures/three_hinged_portal.toml --svg loads.svg", InPage::of_scene},
      {compare_command(), "datasets/car_hood.toml --svg hood.svg", InPage::of_scene},
      {kinematics_command(), "datasets/lift.toml --drive stroke=0.5..0.79 --point platform.Q --svg lift.svg",
       InPage::of_scene},
      {motion_command(), "datasets/lift.toml --duration 2 --release obd=0.005 --csv swing.csv", InPage::of_scene},
      {modes_command(), "datasets/lift.toml", InPage::of_scene},
      {response_command(), "datasets/forced_machine.toml --excite load.F --of y.machine.C --svg response.svg",
       InPage::of_scene},
      {running_command(), "datasets/machines/motor_slider_crank.toml --svg running.svg", InPage::of_scene},
      {forces_command(), "datasets/lift.toml --drive stroke=0.5..0.79 --svg forces.svg", InPage::of_scene},
      {equations_command(), "datasets/double_pendulum.toml --from start --code pendulum.c --python pendulum.py",
       InPage::of_scene},
      {design_command(), "datasets/wall_bed_design.toml --scene found.toml --html design.html", InPage::no},
      {identify_command(), "datasets/lift_experiment.toml --svg fit.svg", InPage::of_experiment},
      {validate_command(), "datasets/lift_experiment.toml --with fit.json", InPage::of_experiment},
      {identifiability_command(), "datasets/lift_experiment_empty.toml", InPage::of_experiment},
      {plan_command(), "datasets/lift_plan.toml --experiment planned.toml", InPage::of_experiment},
      {montecarlo_command(), "datasets/lift_experiment.toml --trials 300", InPage::of_experiment},
      {import_command(), "datasets/exchange/four_bar.txt --scene four_bar.toml", InPage::no},
      {export_command(), "datasets/six_bar.toml --dxf six_bar.dxf", InPage::no},
      {stress_command(), "--methods virtual-work,energy --starts 100", InPage::no},
  };
}

std::string expected_commands(const std::vector<CommandEntry>& commands) {
  const std::vector<std::string> names = names_of(commands);
  return fmt::format("expected a command: {} or {}", fmt::join(names.begin(), names.end() - 1, ", "), names.back());
}

const Command& command_named(const std::vector<CommandEntry>& commands, const std::string& name) {
  const auto found = std::find_if(commands.begin(), commands.end(),
                                  [&](const CommandEntry& entry) { return entry.command.name == name; });
  if (found != commands.end()) return found->command;
  throw InputError(fmt::format("poise: {}, found \"{}\"{}", expected_commands(commands), name,
                               did_you_mean(name, names_of(commands))));
}

const Option& option_named(const Command& command, const std::string& name) {
  std::vector<std::string> names;
  for (const Option& option : command.options) {
    if (option.name == name) return option;
    names.push_back(option.name);
  }
  throw InputError(no_such_option(command.name, name, names));
}

std::string no_such_option(const std::string& command, const std::string& option,
                           const std::vector<std::string>& options) {
  return fmt::format("poise: {} has no option \"{}\"{}", command, option, did_you_mean_or_list(option, options));
}

std::string line_of(const std::vector<std::string>& words) {
  constexpr std::string_view plain = "-_./=,:+@%";
  const auto is_plain = [&](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || plain.find(c) != std::string_view::npos;
  };
  std::string line = "poise";
  for (const std::string& word : words) {
    const bool is_bare = !word.empty() && std::all_of(word.begin(), word.end(), is_plain);
    line += is_bare ? " " : " '";
    for (const char c : word) line += c == '\'' ? std::string("'\\''") : std::string(1, c);
    if (!is_bare) line += '\'';
  }
  return line;
}

}  // namespace poise::app
