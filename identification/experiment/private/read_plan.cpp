#include "identification/experiment/private/read_plan.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "model/nearest_name.hpp"
#include "model/parameters.hpp"

namespace poise {
namespace {

constexpr int most_planned_runs = 100;
constexpr double most_planned_combinations = 10'000;
constexpr double most_common = 100;

class PlanReader {
 public:
  PlanReader(const SceneNames& names, const Experiment& experiment) : names_(names), experiment_(experiment) {}

  PlanLimits read(const TomlTable& table) {
    table.allow_keys({"runs", "criterion", "time", "candidates", "vary"});
    PlanLimits plan;
    plan.line = table.place().line;
    if (!table.has("runs")) table.place().fail("expected the key runs, the most runs to make; add runs = NUMBER");
    plan.runs = at_most(table, "runs", 1, most_planned_runs, plan.runs);
    if (const auto word = table.find_text("criterion")) {
      plan.criterion = static_cast<PlanCriterion>(choose(*word, {"D", "A", "E"}));
    }
    plan.time = table.find_number("time", 1.0, Range::positive);
    plan.candidates = at_most(table, "candidates", 1, 100'000, plan.candidates);
    check_templates(table);
    for (const TomlTable& item : table.tables("vary")) plan.vary.push_back(read_choice(item));
    check_sizes(table, plan.vary);
    check_inputs(table, plan.vary);
    return plan;
  }

 private:
  static int at_most(const TomlTable& table, const char* key, int least, int most, int otherwise) {
    const long long number = table.whole_number(key, least, otherwise);
    if (number > most) table.place_of(key).fail(fmt::format("expected at most {}, found {}", most, number));
    return static_cast<int>(number);
  }

  void check_templates(const TomlTable& table) const {
    if (std::none_of(experiment_.runs.begin(), experiment_.runs.end(), [](const Run& r) { return r.is_simulated(); })) {
      table.place().fail(
          "expected a simulated run, the template of planned runs; add a [[run]] without data, or a [[static]] without "
          "readings");
    }
    for (const Run& run : experiment_.runs) {
      if (!run.is_simulated() || run.is_at_rest() == plans_rest()) continue;
      table.place().fail(fmt::format(
          "expected simulated runs, the templates of planned ones, in motion alone or at rest alone; leave run \"{}\" "
          "in line {} out, or give it data",
          run.name, run.line));
    }
    for (const Unknown& unknown : experiment_.unknowns) {
      if (unknown.per != "run") continue;
      table.place().fail(
          fmt::format("expected unknowns that several runs share, \"{}\" in line {} has per = \"run\"; "
                      "give it a label of the runs instead",
                      unknown.name, unknown.line));
    }
  }

  /// Whether the templates are at rest.
  bool plans_rest() const {
    const auto first = std::find_if(experiment_.runs.begin(), experiment_.runs.end(),
                                    [](const Run& run) { return run.is_simulated(); });
    return first != experiment_.runs.end() && first->is_at_rest();
  }

  /// A planned reading at rest has one row: its inputs have one number each.
  void check_inputs(const TomlTable& table, const std::vector<PlanChoice>& vary) const {
    for (const Run& run : experiment_.runs) {
      if (!run.is_simulated()) continue;
      for (const RowInput& input : run.row_inputs) {
        const bool is_varied = std::any_of(vary.begin(), vary.end(), [&](const PlanChoice& choice) {
          return choice.table == "inputs" && choice.key == input.path;
        });
        const bool is_one = std::equal(input.values.begin() + 1, input.values.end(), input.values.begin());
        if (is_varied || is_one) continue;
        table.place().fail(
            fmt::format("expected one number of each input that is not varied, \"{}\" of run \"{}\" in line {} has "
                        "several; vary inputs.{}, or leave one",
                        input.path, run.name, input.line, input.path));
      }
    }
  }

  void read_input(const TomlText& what, const PlanChoice& choice) const {
    for (const Run& run : experiment_.runs) {
      if (!run.is_simulated()) continue;
      std::vector<std::string> valid;
      for (const RowInput& input : run.row_inputs) valid.push_back("inputs." + input.path);
      if (std::find(valid.begin(), valid.end(), what.value) != valid.end()) continue;
      what.place.fail(fmt::format("expected an input of run \"{}\" in line {}, found \"{}\"{}", run.name, run.line,
                                  choice.key, did_you_mean_or_list(what.value, valid)));
    }
  }

  PlanChoice read_choice(const TomlTable& item) {
    item.allow_keys({"what", "min", "max", "values", "common"});
    PlanChoice choice;
    const TomlText what = item.text("what");
    choice.what = what.value;
    choice.line = item.place().line;
    const auto [other, is_new] = lines_.emplace(what.value, what.place.line);
    if (!is_new) what.place.fail(fmt::format("expected another number, line {} varies it", other->second));
    read_what(what, choice);
    choice.common = item.flag("common", false);
    if (choice.common) check_common(item.place_of("common"), choice);
    choice.values = item.numbers("values");
    if (item.has("values")) {
      if (!choice.is_list()) item.place_of("values").fail("expected a number; give min and max for a range");
      if (item.has("min") || item.has("max")) {
        item.place_of("values").fail("expected either values or min and max, found both; take one of them out");
      }
      return choice;
    }
    choice.min = item.number("min", 1.0, Range::finite);
    choice.max = item.number("max", 1.0, Range::finite);
    if (!(choice.min < choice.max)) {
      item.place_of("max").fail(fmt::format("expected max > min = {:.12g}; exchange them", choice.min));
    }
    return choice;
  }

  void read_what(const TomlText& what, PlanChoice& choice) const {
    choice.key = what.value;
    const bool is_of_rest = what.value.starts_with("inputs.");
    if (!what.value.starts_with("set.") && is_of_rest != plans_rest()) {
      what.place.fail(plans_rest()
                          ? "expected inputs.PATH or set.PATH of planned readings at rest, found \"" + what.value + "\""
                          : "expected inputs.PATH of planned readings at rest only, the templates are in motion");
    }
    if (what.value == "duration") return;
    const std::size_t dot = std::min(what.value.find('.'), what.value.size());
    choice.table = what.value.substr(0, dot);
    choice.key = what.value.substr(std::min(dot + 1, what.value.size()));
    TomlText key = what;
    key.value = choice.key;
    if (choice.table == "inputs") {
      read_input(what, choice);
    } else if (choice.table == "set") {
      located(what.place, [&] { return get_value(experiment_.scene, choice.key); });
    } else if (choice.table == "release" || choice.table == "release_rate") {
      if (names_.index_of_joint(choice.key) >= 0)
        names_.travelling_joint(key);
      else
        names_.movable_body(key);
    } else if (what.value == "rest.at") {
      for (const Run& run : experiment_.runs) {
        if (!run.is_simulated() || run.equilibrium) continue;
        what.place.fail(
            fmt::format("expected runs with a rest, run \"{}\" in line {} has none; add it there", run.name, run.line));
      }
    } else {
      what.place.fail("expected duration, rest.at, release.NAME, release_rate.NAME or set.PATH, found \"" + what.value +
                      "\"" + did_you_mean(choice.table, {"duration", "rest", "release", "release_rate", "set"}));
    }
  }

  void check_common(const TomlPlace& place, const PlanChoice& choice) const {
    if (choice.table != "set") place.fail("expected a number of the scene, set.PATH; leave common out");
    for (const Run& run : experiment_.runs) {
      if (run.is_simulated()) continue;
      place.fail(fmt::format(
          "expected simulated runs only, run \"{}\" has been made and would change; leave common out", run.name));
    }
  }

  static void check_sizes(const TomlTable& table, const std::vector<PlanChoice>& vary) {
    if (vary.empty()) table.place().fail("expected what may be chosen; add [[plan.vary]]");
    double combinations = 1.0;
    double common = 1.0;
    for (const PlanChoice& choice : vary) {
      if (choice.is_list()) (choice.common ? common : combinations) *= static_cast<double>(choice.values.size());
    }
    if (combinations <= most_planned_combinations && common <= most_common) return;
    table.place_of("vary").fail(
        fmt::format("expected at most {} combinations of listed values, of common ones {}; list fewer, or give ranges",
                    most_planned_combinations, most_common));
  }

  const SceneNames& names_;
  const Experiment& experiment_;
  NameLines lines_;
};

}  // namespace

PlanLimits read_plan(const TomlTable& table, const SceneNames& names, const Experiment& experiment) {
  return PlanReader(names, experiment).read(table);
}

}  // namespace poise
