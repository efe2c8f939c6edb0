#include "app/results/design/goals.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "app/draw/chart/goals_chart.hpp"
#include "app/result/numbers.hpp"
#include "app/results/parts.hpp"
#include "model/rewritten_scene.hpp"

namespace poise::app {
namespace {

constexpr int digits_of_choice = 6, digits_of_value = 6;  // the scene written has all
constexpr double at_limit = 1e-6;                         // parts of a goal's size: a margin of rounding
constexpr double without_value = std::numeric_limits<double>::quiet_NaN();

/// "12.5 N", "3" without a unit.
std::string measured(double si, const Dimension& dimension, const Units& units, int digits = digits_of_value) {
  const std::string unit = dimension.unit_name(units);
  return significant(si / dimension.unit(units), digits) + (unit.empty() ? "" : " " + unit);
}

std::string in_sweep(const Sweep& sweep, double si) {
  return significant(si / sweep.unit, digits_of_value) + (sweep.unit_name.empty() ? "" : " " + sweep.unit_name);
}

/// "over angle.bed = 0 deg to 90 deg"; empty at rest.
std::string sweep_in_words(const GoalProblem& problem, const DesignGoal& goal) {
  const Sweep& sweep = problem.sweeps[static_cast<std::size_t>(goal.sweep)];
  if (sweep.along.empty()) return "";
  if (goal.is_range) {
    return fmt::format("over {} = {} to {}", sweep.along, significant(goal.first / sweep.unit, digits_of_value),
                       in_sweep(sweep, goal.last));
  }
  if (goal.at.size() > 1) return fmt::format("at {} values of {}", goal.at.size(), sweep.along);
  return fmt::format("at {} = {}", sweep.along, in_sweep(sweep, goal.at.front()));
}

std::string with_spaces(std::initializer_list<std::string> words) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() || word.empty() ? "" : " ") + word;
  return out;
}

std::string required_in_words(const GoalProblem& problem, const DesignGoal& goal) {
  const Units& units = problem.scene.units;
  const auto shown = [&](double si) { return measured(si, goal.of.dimension, units); };
  switch (goal.aim) {
    case DesignGoal::Aim::least:
      return "as small as possible";
    case DesignGoal::Aim::greatest:
      return "as large as possible";
    case DesignGoal::Aim::flat:
      return "as flat as possible";
    case DesignGoal::Aim::curve:
      return "as near to the curve as possible";
    case DesignGoal::Aim::none:
      break;
  }
  if (goal.kind != DesignGoal::Kind::quantity) return "";
  if (!goal.curve.empty()) return "within " + shown(goal.within) + " of the curve";
  if (goal.is_equation) return "= " + shown(*goal.least);
  if (goal.least && goal.most) return shown(*goal.least) + " to " + shown(*goal.most);
  return goal.least ? ">= " + shown(*goal.least) : "<= " + shown(*goal.most);
}

std::string reached_in_words(const GoalProblem& problem, const DesignGoal& goal, const CheckedGoal& found) {
  const Units& units = problem.scene.units;
  if (goal.kind != DesignGoal::Kind::quantity && goal.kind != DesignGoal::Kind::none) return found.met ? "yes" : "no";
  if (!found.has_value) return "-";
  const std::string least = measured(found.least, goal.of.dimension, units);
  const std::string most = measured(found.most, goal.of.dimension, units);
  const std::string what = goal.curve.empty() ? "" : "off by ";
  return what + (least == most ? least : least + " to " + most);
}

std::string margin_in_words(const GoalProblem& problem, const DesignGoal& goal, const CheckedGoal& found) {
  const bool has_limits =
      goal.is_limit() && !(goal.is_equation && found.met) && goal.kind == DesignGoal::Kind::quantity;
  if (!has_limits || !found.has_value || !std::isfinite(found.margin)) return "";
  constexpr int digits = 3;
  if (found.met && found.margin <= at_limit * goal.size()) return "none";
  return measured(found.margin, goal.of.dimension, problem.scene.units, digits);
}

/// "push.bed.hand.y from -25 N to 25 N over angle.bed = 0 deg to 90 deg".
std::string goal_in_words(const GoalProblem& problem, const DesignGoal& goal) {
  const bool is_between = goal.is_limit() && !goal.is_equation && goal.curve.empty() && goal.least && goal.most;
  return with_spaces(
      {goal.name, is_between ? "from" : "", required_in_words(problem, goal), sweep_in_words(problem, goal)});
}

std::string goals_named(const GoalProblem& problem, const std::vector<int>& goals) {
  std::string out;
  for (std::size_t k = 0; k < goals.size(); ++k) {
    out += k == 0 ? "" : k + 1 == goals.size() ? " and " : ", ";
    out += goal_in_words(problem, problem.goals[static_cast<std::size_t>(goals[k])]);
  }
  return out;
}

Line verdict_of(const GoalProblem& problem, const GoalDesign& found) {
  using Status = GoalDesign::Status;
  switch (found.status) {
    case Status::met: {
      const bool has_aims =
          std::any_of(problem.goals.begin(), problem.goals.end(), [](const DesignGoal& g) { return !g.is_limit(); });
      const std::string what =
          has_aims ? "Numbers that keep all limits, the best that the searches found" : "Numbers that meet all goals";
      return good(fmt::format("{}; checked along the paths, {} of {} points proved.", what, found.check.proved,
                              found.check.points));
    }
    case Status::not_met:
      if (found.conflict.size() == 1) {
        return bad(fmt::format("Not met: no numbers were found for {}{}.", goals_named(problem, found.conflict),
                               found.scene ? "; these come nearest" : ""));
      }
      if (!found.conflict.empty()) {
        return bad(fmt::format("Not met: no numbers were found that meet together {}; these come nearest.",
                               goals_named(problem, found.conflict)));
      }
      return bad("No numbers were found that meet all goals; these come nearest.");
    case Status::not_robust:
      return bad(
          fmt::format("These numbers meet all goals, but not within their tolerances: {} of {} samples keep all "
                      "limits.",
                      found.robust.kept, found.robust.samples));
    case Status::not_confirmed:
      return bad("The search meets all goals, but the check along the paths does not.");
    case Status::interrupted:
      return bad("Interrupted; the best numbers so far.");
    case Status::no_start:
      if (!found.conflict.empty()) {
        return bad(fmt::format("Not met: at no start is there a value for {}: {}.",
                               goals_named(problem, found.conflict), found.why));
      }
      break;
  }
  return bad(fmt::format("Nothing could be evaluated at any start: {}.", found.why.empty() ? "no values" : found.why));
}

void add_choice(Group& content, const GoalProblem& problem, const GoalDesign& found) {
  const Units& units = problem.scene.units;
  std::vector<std::string> paths, shown, ranges, units_of;
  std::vector<double> values, before;
  const auto add = [&](const ParameterRow& row, double value, const std::string& range) {
    paths.push_back(row.path.text());
    const double unit = row.dimension.unit(units);
    values.push_back(value / unit);
    before.push_back(value_at(problem.scene, row.place).value_or(without_value) / unit);
    shown.push_back(significant(values.back(), digits_of_choice));
    ranges.push_back(range);
    units_of.push_back(row.dimension.unit_name(units));
  };
  const std::vector<ChosenValue> chosen = chosen_values(problem, found.point);
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    std::string range;
    if (k < problem.variables.size()) {
      const ChosenNumber& one = problem.variables[k];
      const double unit = one.row.dimension.unit(units), part = found.point.parts[static_cast<Eigen::Index>(k)];
      range = fmt::format("{} to {}", significant(one.from / unit, digits_of_value),
                          significant(one.to / unit, digits_of_value));
      if (part <= 0.0 || part >= 1.0) range += part <= 0.0 ? ", at its least" : ", at its greatest";
    } else if (k < problem.variables.size() + problem.ties.size()) {
      range = "= " + problem.ties[k - problem.variables.size()].text;
    }
    add(*chosen[k].row, chosen[k].value, range);
  }
  Table& table = content.table("numbers", "Numbers found", Rows::by_name);
  table.words("name", "number", paths);
  Column& value = table.numbers("value", "value", "", values);
  value.texts = shown;
  table.words("unit", "unit", units_of);
  Column& own = table.numbers("before", "before", "", before, {.style = Format::Style::significant});
  own.format.digits = digits_of_value;
  table.words("", "range", ranges);
  std::vector<std::string> names, rows;
  for (std::size_t c = 0; c < problem.catalogues.size(); ++c) {
    names.push_back(problem.catalogues[c].name);
    rows.push_back(problem.catalogues[c].rows[static_cast<std::size_t>(found.point.rows[c])].name);
  }
  if (names.empty()) return;
  Table& catalogue = content.table("rows", "Rows chosen", Rows::by_name);
  catalogue.words("name", "catalogue", names);
  catalogue.words("row", "row", rows);
}

/// What JSON says of each goal beside what text shows, in the units of the scene.
void add_goal_numbers(Table& table, const GoalProblem& problem, const GoalDesign& found) {
  const Units& units = problem.scene.units;
  struct Row {
    std::string kind, aim, quantity, unit, along, along_unit, why;
    double from, to, least_wanted, most_wanted, within, before_least, before_most, least, most, least_at, most_at,
        margin, margin_at, moved, conflicts, met;
  };
  const auto or_nothing = [](bool has, double value) { return has ? value : without_value; };
  std::vector<Row> rows;
  for (std::size_t k = 0; k < problem.goals.size(); ++k) {
    const DesignGoal& goal = problem.goals[k];
    const Sweep& sweep = problem.sweeps[static_cast<std::size_t>(goal.sweep)];
    const CheckedGoal& check = found.check.goals[k];
    const CheckedGoal before = k < found.before.goals.size() ? found.before.goals[k] : CheckedGoal{};
    const bool is_swept = !sweep.along.empty(), has_curve = !goal.curve.empty();
    const bool has_margin = check.has_value && goal.is_limit() && !goal.is_equation;
    const double unit = goal.of.dimension.unit(units);
    constexpr const char* kinds[] = {"quantity", "stable", "unstable", "none", "passes"};
    constexpr const char* aims[] = {"", "least", "greatest", "flat", "curve"};
    const double first = goal.is_range ? goal.first : goal.at.front(),
                 last = goal.is_range ? goal.last : goal.at.back();
    rows.push_back(
        {.kind = kinds[static_cast<int>(goal.kind)],
         .aim = aims[static_cast<int>(goal.aim)],
         .quantity = goal.of.name,
         .unit = goal.of.dimension.unit_name(units),
         .along = sweep.along,
         .along_unit = sweep.unit_name,
         .why = check.why,
         .from = or_nothing(is_swept, first / sweep.unit),
         .to = or_nothing(is_swept, last / sweep.unit),
         .least_wanted = or_nothing(!has_curve, goal.least.value_or(without_value) / unit),
         .most_wanted = or_nothing(!has_curve, goal.most.value_or(without_value) / unit),
         .within = or_nothing(goal.within > 0.0, goal.within / unit),
         .before_least = or_nothing(before.has_value, before.least / unit),
         .before_most = or_nothing(before.has_value, before.most / unit),
         .least = or_nothing(check.has_value, check.least / unit),
         .most = or_nothing(check.has_value, check.most / unit),
         .least_at = or_nothing(check.has_value && is_swept, check.least_at / sweep.unit),
         .most_at = or_nothing(check.has_value && is_swept, check.most_at / sweep.unit),
         .margin = or_nothing(has_margin, check.margin / unit),
         .margin_at = or_nothing(has_margin && is_swept, check.worst_at / sweep.unit),
         .moved = or_nothing(k < found.robust.tightened.size(),
                             k < found.robust.tightened.size() ? found.robust.tightened[k] / unit : 0.0),
         .conflicts = std::count(found.conflict.begin(), found.conflict.end(), static_cast<int>(k)) > 0 ? 1.0 : 0.0,
         .met = check.met ? 1.0 : 0.0});
  }
  const auto word = [&](const std::string& key, std::string Row::*of) {
    Column& column = table.words(key, "", each(rows, of));
    column.kind = Column::Kind::word_or_null;
    column.shown = false;
  };
  word("kind", &Row::kind);
  word("aim", &Row::aim);
  word("quantity", &Row::quantity);
  word("unit", &Row::unit);
  word("along", &Row::along);
  word("along_unit", &Row::along_unit);
  word("why", &Row::why);
  const std::pair<const char*, double Row::*> numbers[] = {
      {"from", &Row::from},
      {"to", &Row::to},
      {"least_wanted", &Row::least_wanted},
      {"most_wanted", &Row::most_wanted},
      {"within", &Row::within},
      {"before_least", &Row::before_least},
      {"before_most", &Row::before_most},
      {"least", &Row::least},
      {"most", &Row::most},
      {"least_at", &Row::least_at},
      {"most_at", &Row::most_at},
      {"margin", &Row::margin},
      {"margin_at", &Row::margin_at},
      {"moved_by_tolerances", &Row::moved},
  };
  for (const auto& [key, of] : numbers) table.data(key, each(rows, of));
  table.flags("conflicts", each(rows, &Row::conflicts));
  table.flags("met", each(rows, &Row::met));
}

void add_goal_table(Group& content, const GoalProblem& problem, const GoalDesign& found) {
  struct Row {
    std::string name, required, before, reached, margin, moved, verdict;
    bool met;
  };
  std::vector<Row> rows;
  std::vector<std::string> notes;
  for (std::size_t k = 0; k < problem.goals.size(); ++k) {
    const DesignGoal& goal = problem.goals[k];
    const CheckedGoal& check = found.check.goals[k];
    const bool is_moved = k < found.robust.tightened.size() && goal.is_limit() && !goal.is_equation &&
                          goal.kind == DesignGoal::Kind::quantity;
    constexpr int digits = 3;
    rows.push_back(
        {with_spaces({goal.name, sweep_in_words(problem, goal)}), required_in_words(problem, goal),
         k < found.before.goals.size() ? reached_in_words(problem, goal, found.before.goals[k]) : "-",
         reached_in_words(problem, goal, check), margin_in_words(problem, goal, check),
         is_moved ? "+-" + measured(found.robust.tightened[k], goal.of.dimension, problem.scene.units, digits) : "",
         !goal.is_limit() ? "aim"
         : check.met      ? "met"
                          : "missed",
         check.met});
    if (!check.met && !check.why.empty()) notes.push_back(fmt::format("{}: {}", rows.back().name, check.why));
  }
  Table& table = content.table("goals", "Goals", Rows::list);
  table.words("goal", "goal", each(rows, &Row::name));
  table.words("required", "required", each(rows, &Row::required));
  table.words("", "before", each(rows, &Row::before));
  table.words("", "reached", each(rows, &Row::reached));
  table.words("", "margin", each(rows, &Row::margin));
  if (found.robust.asked) table.words("", "tolerances", each(rows, &Row::moved));
  Column& verdict = table.words("", "", each(rows, &Row::verdict));
  verdict.tones = each(rows, [](const Row& row) { return row.met ? Tone::good : Tone::bad; });
  add_goal_numbers(table, problem, found);
  table.footnotes = notes;
}

void add_robust(Group& content, const GoalProblem& problem, const GoalDesign& found) {
  if (!found.robust.asked) return;
  const RobustCheck& robust = found.robust;
  Group& group = content.group("robust", "With tolerances");
  group.data("samples", robust.samples);
  group.data("kept", robust.kept);
  group.data("corners_kept", robust.corners_kept);
  group.fact("samples", fmt::format("{} of {} keep all limits", robust.kept, robust.samples));
  group.fact("corners", robust.corners_kept ? "the corners that are worst to first order keep all limits"
                                            : "a corner that is worst to first order misses a limit");
  const bool has_equation =
      std::any_of(problem.goals.begin(), problem.goals.end(), [](const DesignGoal& one) { return one.is_equation; });
  if (has_equation)
    group.note("Values that are asked for exactly are those of the numbers themselves, not of samples.");
  if (robust.widest.empty()) return;
  std::vector<std::string> names, units_of;
  std::vector<double> given, widest;
  for (std::size_t k = 0; k < robust.tolerances.size(); ++k) {
    const Tolerance& one = robust.tolerances[k];
    const double unit = one.dimension.unit(problem.scene.units);
    names.push_back(one.number);
    given.push_back(one.half_width / unit);
    widest.push_back(std::isfinite(robust.widest[k]) ? robust.widest[k] / unit : without_value);
    units_of.push_back(one.dimension.unit_name(problem.scene.units));
  }
  Table& table =
      group.table("widest", "Widest tolerances that keep the limits, to first order, at least cost", Rows::by_name);
  table.words("name", "number", names);
  table.numbers("given", "given +-", "", given, {.style = Format::Style::significant});
  table.numbers("widest", "widest +-", "", widest, {.style = Format::Style::significant, .digits = 4});
  table.words("unit", "unit", units_of);
}

void add_conflict(Group& content, const GoalProblem& problem, const GoalDesign& found) {
  std::vector<std::string> goals;
  for (const int k : found.conflict) {
    goals.push_back(goal_in_words(problem, problem.goals[static_cast<std::size_t>(k)]));
  }
  content.list("conflict",
               goals.size() == 1            ? "The goal that no search has met, even alone"
               : found.conflict_is_smallest ? "The fewest goals that no search has met together"
                                            : "Goals that no search has met together; it has without any one of them",
               goals);
  content.data("conflict_is_smallest", found.conflict_is_smallest);
}

void add_what_holds_back(Group& content, const GoalProblem& problem, const GoalDesign& found) {
  if (found.active.empty()) return;
  const auto aim =
      std::find_if(problem.goals.begin(), problem.goals.end(), [](const DesignGoal& g) { return !g.is_limit(); });
  const Units& units = problem.scene.units;
  std::vector<double> gains;
  std::vector<std::string> of;
  for (const ActiveLimit& one : found.active) {
    gains.push_back(one.gain * one.dimension.unit(units) / aim->of.dimension.unit(units));
    const std::string unit = aim->of.dimension.unit_name(units), per = one.dimension.unit_name(units);
    of.push_back(fmt::format("{} for 1 {}", unit, per));
  }
  Table& table = content.table("holds_back", "What holds the aim back, and what loosening it gains", Rows::list);
  table.words("limit", "limit", each(found.active, &ActiveLimit::name));
  table.numbers("gain", "gain", "", gains, {.style = Format::Style::significant, .digits = 3});
  table.words("unit", "unit", of);
}

void add_trade_off(Group& content, const GoalProblem& problem, const GoalDesign& found) {
  const std::optional<TradedAims> aims = traded_aims(problem, found);
  if (!aims) return;
  Table& of = content.table("trade_off_aims", "", Rows::list, Verbosity::data);
  of.words("name", "", {aims->names[0], aims->names[1]});
  of.words("unit", "", {aims->units[0], aims->units[1]});
  Table& table = content.table("trade_off", "Trade-off of the two aims, at the positions of the search", Rows::list);
  table.shown = Table::Shown::all;
  constexpr Format format{.style = Format::Style::significant};
  table.numbers("first", aims->names[0], aims->units[0], aims->values[0], format);
  table.numbers("second", aims->names[1], aims->units[1], aims->values[1], format);
  for (std::size_t k = 0; k < problem.variables.size(); ++k) {
    const ChosenNumber& one = problem.variables[k];
    const double unit = one.row.dimension.unit(problem.scene.units);
    std::vector<double> values;
    for (const DesignPoint& point : found.trade_off.points)
      values.push_back(chosen_values(problem, point)[k].value / unit);
    table.numbers("numbers[]", one.path, one.row.dimension.unit_name(problem.scene.units), values, format);
  }
}

void add_search(Group& content, const GoalProblem& problem, const GoalDesign& found, std::uint64_t seed,
                double microseconds) {
  Group& numerics = content.group("search", "Search");
  numerics.data("seed", seed);
  numerics.data("starts", found.starts);
  numerics.data("met", found.met_starts);
  numerics.data("again", found.best_again);
  numerics.data("evaluations", found.counts.evaluations);
  numerics.data("paths", found.counts.paths);
  numerics.data("combinations", found.catalogue.combinations);
  numerics.data("tried", found.catalogue.tried);
  numerics.data("by_length", found.catalogue.by_length);
  numerics.data("by_proof", found.catalogue.by_proof);
  numerics.data("left", found.catalogue.left);
  if (!problem.catalogues.empty()) {
    const CatalogueCounts& rows = found.catalogue;
    numerics.fact(
        "rows", fmt::format("{:.0f} combinations: {} tried, {} excluded by a length, {} not tried{}", rows.combinations,
                            rows.tried, rows.by_length, rows.left, rows.left == 0 ? "; so these are all" : ""));
  }
  if (found.starts > 0) {
    numerics.fact(
        "searches",
        fmt::format("{}; all limits kept in {}{}", found.starts, found.met_starts,
                    found.best_again > 1 ? fmt::format(", the best aims reached in {}", found.best_again) : ""));
  }
  numerics.fact("effort",
                fmt::format("{}, {} followed anew, {}",
                            count(static_cast<int>(found.counts.evaluations), "evaluation", "evaluations"),
                            count(static_cast<int>(found.counts.paths), "path", "paths"), duration(microseconds)));
  const bool is_met = found.status == GoalDesign::Status::met;
  const bool tried_all = problem.variables.empty() && found.catalogue.left == 0;
  numerics.note(tried_all ? "All combinations were evaluated, and nothing else may be chosen."
                : is_met  ? "Searches are local: that there are no better numbers is not proved."
                          : "Searches are local: that no numbers meet the goals is not proved.",
                Tone::plain);
}

}  // namespace

Result goals_result(const GoalProblem& problem, const GoalDesign& found, std::uint64_t seed, double microseconds) {
  Result out = scene_result(problem.scene, {});
  out.title = problem.title.empty() ? problem.file : problem.title;
  out.source = problem.source;
  out.verdict = verdict_of(problem, found);
  Group& content = out.content;
  Group& design = content.group("design", "", Verbosity::data);
  design.data("file", problem.file);
  design.data("title", problem.title);
  design.data("source", problem.source);
  constexpr const char* statuses[] = {"met", "not met", "not robust", "not confirmed", "no start", "interrupted"};
  content.data("status", statuses[static_cast<int>(found.status)]);
  content.data("met", found.status == GoalDesign::Status::met);
  content.data("why", found.why);
  if (found.scene) {
    warn_of_friction(out, problem.scene);
    for (const std::string& note : found.check.notes) out.warnings.push_back(doubtful(note));
    if (!found.check.why.empty()) out.warnings.push_back(bad(found.check.why + "."));
    add_choice(content, problem, found);
    add_goal_table(content, problem, found);
    content.data("points", found.check.points);
    content.data("proved", found.check.proved);
    add_robust(content, problem, found);
  }
  add_conflict(content, problem, found);
  add_what_holds_back(content, problem, found);
  add_trade_off(content, problem, found);
  add_search(content, problem, found, seed, microseconds);
  return out;
}

std::string scene_text_of(const GoalProblem& problem, const GoalDesign& found) {
  if (!found.scene) return "";
  Scene scene = parse_scene(problem.scene_text, problem.scene_file.string());
  for (const ChosenValue& one : chosen_values(problem, found.point)) set_value_at(scene, one.row->place, one.value);
  return rewritten_scene(problem.scene_text, problem.scene_file.string(), scene);
}

}  // namespace poise::app
