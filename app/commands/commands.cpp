#include "app/commands/commands.hpp"

#include <algorithm>
#include <cctype>
#include <string_view>

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

}  // namespace

std::vector<CommandEntry> all_commands() {
  return {
      {check_command(), "datasets/six_bar.toml"},
      {solve_command(), "datasets/toggle_clamp.toml --set load.P=30 --svg clamp.svg --json clamp.json"},
      {equilibria_command(), "datasets/four_bar_gravity.toml --svg equilibria.svg"},
      {hold_command(), "datasets/friction/wedge.toml --vary load.P"},
      {view_command(), "datasets/toggle_clamp.toml"},
      {path_command(), "datasets/von_mises_toggle.toml --vary load.P=0..60 --svg toggle.svg"},
      {find_command(),
       "datasets/toggle_clamp.toml --vary spring.rubber.stiffness=200..800 --for \"force.rubber = -700\""},
      {sensitivity_command(), "datasets/toggle_clamp.toml --of force.rubber,fold.load.P"},
      {tolerance_command(),
       "datasets/toggle_clamp.toml --tolerances datasets/toggle_clamp_tolerances.toml --of force.rubber"},
      {loads_command(), "datasets/structures/three_hinged_portal.toml --svg loads.svg"},
      {compare_command(), "datasets/car_hood.toml --svg hood.svg"},
      {kinematics_command(), "datasets/lift.toml --drive stroke=0.5..0.79 --point platform.Q --svg lift.svg"},
      {motion_command(), "datasets/lift.toml --duration 2 --release obd=0.005 --csv swing.csv"},
      {modes_command(), "datasets/lift.toml"},
      {forces_command(), "datasets/lift.toml --drive stroke=0.5..0.79 --svg forces.svg"},
      {design_command(), "datasets/wall_bed_design.toml --scene found.toml --html design.html"},
      {identify_command(), "datasets/lift_experiment.toml --svg fit.svg"},
      {validate_command(), "datasets/lift_experiment.toml --with fit.json"},
      {identifiability_command(), "datasets/lift_experiment_empty.toml"},
      {plan_command(), "datasets/lift_plan.toml --experiment planned.toml"},
      {montecarlo_command(), "datasets/lift_experiment.toml --trials 300"},
      {import_command(), "datasets/exchange/four_bar.txt --scene four_bar.toml"},
      {export_command(), "datasets/six_bar.toml --dxf six_bar.dxf"},
      {stress_command(), "--methods virtual-work,energy --starts 100"},
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
