#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <set>

#include <fmt/format.h>

#include "design/goals/goal_problem.hpp"
#include "model/csv_table.hpp"
#include "model/dependent_number.hpp"
#include "model/input_error.hpp"
#include "model/named_measures.hpp"
#include "model/nearest_name.hpp"
#include "model/text_file.hpp"
#include "model/time_function.hpp"
#include "model/toml_reader.hpp"
#include "statics/bodies/body_measures.hpp"
#include "statics/model/static_numbers.hpp"
#include "statics/model/varied_scene.hpp"
#include "statics/paths/path_measures.hpp"

namespace poise {
namespace {

constexpr double without_limit = std::numeric_limits<double>::infinity();
constexpr int default_positions = 17;
constexpr std::size_t most_rows = 200, most_positions = 1000;
constexpr double most_combinations = 1e15;

/// The letters, digits, underscores and dots from a place of a text on.
std::string word_at(const std::string& text, std::size_t at) {
  std::size_t end = at;
  while (end < text.size() &&
         (std::isalnum(static_cast<unsigned char>(text[end])) != 0 || text[end] == '.' || text[end] == '_')) {
    ++end;
  }
  return text.substr(at, end - at);
}

class GoalReader {
 public:
  explicit GoalReader(const std::filesystem::path& file);
  GoalProblem read();

 private:
  ParameterRow number_of(const std::string& path, const TomlPlace& place);
  void read_variables();
  void read_whole(const std::string& path, const TomlTable& given);
  void read_ties();
  void read_catalogue(const TomlTable& table);
  void read_goal(const TomlTable& table, std::size_t index);
  void read_kind(const TomlTable& table, DesignGoal& goal);
  void read_positions(const TomlTable& table, DesignGoal& goal);
  void read_quantity(const TomlTable& table, DesignGoal& goal);
  void read_limits(const TomlTable& table, DesignGoal& goal);
  void read_curve(const TomlTable& table, DesignGoal& goal);
  int sweep_of(const TomlTable& table, const std::string& along);
  void spread_positions();

  std::filesystem::path folder_;
  GoalProblem out_;
  std::string text_;
  toml::table document_;
  TomlTable root_;
  Scene moving_;  // with its functions of time
  std::set<std::string> taken_;
  std::vector<int> positions_;  // of each goal with a range
};

GoalReader::GoalReader(const std::filesystem::path& file)
    : folder_(file.parent_path()),
      out_{.file = file.string()},
      text_(read_text_file(file)),
      document_(parse_toml(text_, out_.file)),
      root_(document_, {out_.file, 1, ""}) {}

/// A number that may be chosen: statics uses it, nothing else sets it.
ParameterRow GoalReader::number_of(const std::string& path, const TomlPlace& place) {
  const ParameterRow row = located(place, [&] {
    ParameterRow found = parameter(out_.scene, path);
    check_is_free(out_.scene, found);
    return found;
  });
  if (!acts_in_statics(out_.scene, row.place)) {
    place.fail(
        "equilibrium does not depend on it; expected a load, a stiffness, a dimension or another number that "
        "acts at rest");
  }
  if (value_at(moving_, row.place) != value_at(out_.scene, row.place)) {
    place.fail("a function of time multiplies it; expected a number that does not change with time");
  }
  if (row.place.owner == Owner::section) place.fail("sections are not chosen; expected another number");
  if (!taken_.insert(path).second) place.fail("it is chosen twice; remove one");
  if (row.place.owner == Owner::force &&
      out_.scene.forces[static_cast<std::size_t>(row.place.item)].line_of_action() == Vec2{}) {
    place.fail("expected a force with a direction, its vector is [0, 0]; give it a direction and a size");
  }
  return row;
}

void GoalReader::read_whole(const std::string& path, const TomlTable& given) {
  given.allow_keys({"range", "whole"});
  const Vec2 ends = given.vector("range", 1.0);
  const TomlPlace place = given.place_of("range");
  if (!given.flag("whole", false)) given.place().fail("expected [LEAST, GREATEST], or whole = true beside the range");
  constexpr double most_whole = 9007199254740992.0;  // 2^53, up to which doubles tell whole numbers
  if (std::max(std::abs(ends.x), std::abs(ends.y)) > most_whole) place.fail("expected whole numbers up to 2^53");
  if (ends.x != std::floor(ends.x) || ends.y != std::floor(ends.y) || !(ends.x < ends.y)) {
    place.fail("expected two different whole numbers, the smaller first");
  }
  if (ends.y - ends.x + 1.0 > static_cast<double>(most_rows)) {
    place.fail(fmt::format("expected at most {} whole numbers; take a smaller range", most_rows));
  }
  const ParameterRow row = number_of(path, place);
  const double unit = row.dimension.unit(out_.scene.units);
  Catalogue catalogue{.name = path, .numbers = {row}, .paths = {path}};
  for (double value = ends.x; value <= ends.y; value += 1.0) {
    if (!contains(row.range, value * unit)) place.fail(out_of_range(row.range, value));
    catalogue.rows.push_back({fmt::format("{:.0f}", value), {value * unit}, 0.0, without_limit});
  }
  out_.catalogues.push_back(std::move(catalogue));
}

void GoalReader::read_variables() {
  const std::optional<TomlTable> table = root_.find_table("variables");
  if (!table) return;
  for (const std::string& path : table->keys()) {
    if (table->holds_table(path)) {
      read_whole(path, *table->find_table(path));
      continue;
    }
    const TomlPlace place = table->place_of(path);
    const ParameterRow row = number_of(path, place);
    const double unit = row.dimension.unit(out_.scene.units);
    const Vec2 ends = table->vector(path, unit);
    if (!(ends.x < ends.y)) place.fail("expected [LEAST, GREATEST], two different numbers, the smaller first");
    for (const double end : {ends.x, ends.y}) {
      if (!contains(row.range, end)) place.fail(out_of_range(row.range, end / unit));
    }
    out_.variables.push_back({path, row, ends.x, ends.y});
  }
}

/// Expressions know names without dots: each path of a variable stands for one.
void GoalReader::read_ties() {
  const std::optional<TomlTable> table = root_.find_table("ties");
  if (!table) return;
  std::vector<std::string> names, paths;
  for (std::size_t k = 0; k < out_.variables.size(); ++k) {
    names.push_back(fmt::format("v{}", k));
    paths.push_back(out_.variables[k].path);
  }
  for (const std::string& path : table->keys()) {
    const TomlText given = table->text(path);
    const ParameterRow row = number_of(path, table->place_of(path));
    std::string text;
    for (std::size_t at = 0; at < given.value.size();) {
      const std::string word = word_at(given.value, at);
      const bool is_whole = std::any_of(out_.catalogues.begin(), out_.catalogues.end(),
                                        [&](const Catalogue& one) { return one.name == word; });
      if (is_whole) given.place.fail(word + " is a whole number, which ties do not follow; expected one with a range");
      if (Expression::is_name(word)) {
        given.place.fail(
            fmt::format("expected numbers of [variables], found {}{}", word, did_you_mean_or_list(word, paths)));
      }
      if (word.find('.') == std::string::npos || std::isdigit(static_cast<unsigned char>(word[0])) != 0) {
        text += word.empty() ? given.value.substr(at, 1) : word;
        at += std::max<std::size_t>(1, word.size());
        continue;
      }
      const auto variable = std::find(paths.begin(), paths.end(), word);
      if (variable == paths.end()) {
        given.place.fail(
            fmt::format("expected numbers of [variables], found {}{}", word, did_you_mean_or_list(word, paths)));
      }
      text += "(" + names[static_cast<std::size_t>(variable - paths.begin())] + ")";
      at += word.size();
    }
    try {
      out_.ties.push_back({path, row, Expression(text, names), given.value});
    } catch (const InputError& error) {
      // Without the place in a text that nobody has written.
      const std::string what = error.what();
      given.place.fail(fmt::format("{} in \"{}\"", what.substr(0, what.find(" at character")), given.value));
    }
  }
}

void GoalReader::read_catalogue(const TomlTable& table) {
  table.allow_keys({"file", "items"});
  const TomlText file = table.text("file");
  const std::filesystem::path path = folder_ / file.value;
  out_.files.push_back(path.string());
  std::vector<std::string> header = located(file.place, [&] { return read_csv_header(path); });
  const std::vector<TomlText> items = table.texts("items");
  if (items.empty()) table.place().fail("expected items = [\"TABLE.NAME\"], what a row of the file is chosen for");
  Catalogue out{.name = file.value};
  std::vector<std::string> columns;
  bool has_name = false, has_shortest = false, has_longest = false;
  for (const std::string& column : header) {
    if (column == "name") {
      has_name = true;
    } else if (column == "shortest") {
      has_shortest = true;
    } else if (column == "longest") {
      has_longest = true;
    } else {
      columns.push_back(column);
    }
  }
  if (columns.empty())
    file.place.fail(path.string() + ": expected a column for each number of the item, say stiffness");
  for (const TomlText& item : items) {
    for (const std::string& column : columns) {
      const std::string number = item.value + "." + column;
      out.numbers.push_back(number_of(number, item.place));
      out.paths.push_back(number);
    }
    if (!has_shortest && !has_longest) continue;
    const ParameterPlace& place = out.numbers.back().place;
    if (place.owner != Owner::element) {
      item.place.fail("the catalogue limits lengths; expected a spring or another force element, found another item");
    }
    const Element& element = out_.scene.elements[static_cast<std::size_t>(place.item)];
    out.lengths.push_back({.name = "length of " + item.value, .on = element.on, .dimension = element.on.dimension()});
  }
  std::vector<std::string> numbers = columns;
  if (has_shortest) numbers.emplace_back("shortest");
  if (has_longest) numbers.emplace_back("longest");
  const CsvTable csv = located(file.place, [&] {
    return read_csv(path, numbers, has_name ? std::vector<std::string>{"name"} : std::vector<std::string>{});
  });
  const std::size_t count = csv.line.size();
  if (count == 0) file.place.fail(path.string() + ": expected one row at least");
  if (count > most_rows) {
    file.place.fail(fmt::format("{}: expected at most {} rows, found {}", path.string(), most_rows, count));
  }
  const double length = out.lengths.empty() ? 1.0 : out.lengths.front().dimension.unit(out_.scene.units);
  for (std::size_t k = 0; k < count; ++k) {
    Catalogue::Row row{has_name ? csv.words[0].value[k] : fmt::format("row {}", k + 1), {}, 0.0, without_limit};
    for (std::size_t i = 0; i < out.numbers.size(); ++i) {
      const ParameterRow& number = out.numbers[i];
      const double value = csv.column(columns[i % columns.size()])[k] * number.dimension.unit(out_.scene.units);
      if (!contains(number.range, value)) {
        throw InputError(fmt::format("{}:{}: {}: {}", path.string(), csv.line[k], columns[i % columns.size()],
                                     out_of_range(number.range, csv.column(columns[i % columns.size()])[k])));
      }
      row.values.push_back(value);
    }
    if (has_shortest) row.shortest = csv.column("shortest")[k] * length;
    if (has_longest) row.longest = csv.column("longest")[k] * length;
    if (!(row.shortest <= row.longest)) {
      throw InputError(fmt::format("{}:{}: expected shortest <= longest", path.string(), csv.line[k]));
    }
    out.rows.push_back(std::move(row));
  }
  out_.catalogues.push_back(std::move(out));
}

/// The sweep of what a goal is asked along; its ends are widened by each of its goals.
int GoalReader::sweep_of(const TomlTable& table, const std::string& along) {
  for (std::size_t k = 0; k < out_.sweeps.size(); ++k) {
    if (out_.sweeps[k].along == along) return static_cast<int>(k);
  }
  Sweep sweep{.along = along};
  if (along.empty()) {
    sweep.names = out_.scene;
  } else {
    if (taken_.count(along) != 0) table.place_of("along").fail("it is chosen too; expected what goals are asked along");
    // Any range that the number can have tells its names and unit.
    const VariedScene varied = located(table.place_of("along"), [&] {
      try {
        return VariedScene(out_.scene, along, 0.5, 1.0);
      } catch (const InputError&) {
        return VariedScene(out_.scene, along, table.has("over") ? table.vector("over", 1.0).x : 1.0,
                           table.has("over") ? table.vector("over", 1.0).y : 2.0);
      }
    });
    sweep.unit = varied.unit();
    sweep.unit_name = varied.unit_name();
    if (varied.is_driven()) {
      sweep.natural = 1.0 / varied.scene().stops.back().on.dimension().per_scale(varied.scales());
    }
    sweep.names = named_scene(varied);
    sweep.along = along;
  }
  sweep.first = without_limit;
  sweep.last = -without_limit;
  out_.sweeps.push_back(std::move(sweep));
  return static_cast<int>(out_.sweeps.size()) - 1;
}

void GoalReader::read_positions(const TomlTable& table, DesignGoal& goal) {
  std::string along;
  if (const auto given = table.find_text("along")) along = given->value;
  goal.sweep = sweep_of(table, along);
  Sweep& sweep = out_.sweeps[static_cast<std::size_t>(goal.sweep)];
  if (along.empty()) {
    for (const char* key : {"over", "at", "positions"}) {
      if (table.has(key)) table.place_of(key).fail("expected along = \"...\" beside it, what takes these values");
    }
    sweep.first = sweep.last = 0.0;
    goal.at = {0.0};
    return;
  }
  if (table.has("positions") && !table.has("over")) {
    table.place_of("positions").fail("expected over = [FROM, TO] beside it; values of at are positions themselves");
  }
  if (table.has("over") == table.has("at")) table.place().fail("expected either over = [FROM, TO] or at = VALUE");
  if (table.has("over")) {
    const Vec2 ends = table.vector("over", sweep.unit);
    if (ends.x == ends.y) table.place_of("over").fail("expected two different values");
    goal.is_range = true;
    goal.first = ends.x;
    goal.last = ends.y;
    const long long positions = table.whole_number("positions", 0, default_positions);
    if (positions < 2 || positions > static_cast<long long>(most_positions)) {
      table.place_of("positions").fail(fmt::format("expected a whole number from 2 to {}", most_positions));
    }
    positions_.back() = static_cast<int>(positions);
  } else if (table.holds_list("at")) {
    for (const double value : table.numbers("at")) goal.at.push_back(value * sweep.unit);
    if (goal.at.empty()) table.place_of("at").fail("expected one value at least");
  } else {
    goal.at = {table.number("at", sweep.unit, Range::finite)};
  }
  for (const double value : goal.is_range ? std::vector<double>{goal.first, goal.last} : goal.at) {
    sweep.first = std::min(sweep.first, value);
    sweep.last = std::max(sweep.last, value);
  }
}

void GoalReader::read_kind(const TomlTable& table, DesignGoal& goal) {
  const int kinds = int(table.has("of")) + int(table.has("equilibrium")) + int(table.has("passes"));
  if (kinds != 1) table.place().fail("expected one of: of = \"QUANTITY\", equilibrium = \"stable\", passes = true");
  if (table.has("of")) return;
  table.allow_keys({"equilibrium", "passes", "along", "over", "at", "positions"});
  if (!table.has("along"))
    table.place().fail("expected along = \"...\", the driven measure or number that it is asked of");
  if (table.has("passes")) {
    if (!table.flag("passes", true)) table.place_of("passes").fail("expected true; leave the goal out otherwise");
    if (!table.has("over")) table.place().fail("expected over = [FROM, TO], the range that is to be passed");
    goal.kind = DesignGoal::Kind::passes;
    return;
  }
  constexpr DesignGoal::Kind meanings[] = {DesignGoal::Kind::stable, DesignGoal::Kind::unstable,
                                           DesignGoal::Kind::none};
  goal.kind = meanings[choose(table.text("equilibrium"), {"stable", "unstable", "none"})];
  if (table.holds_list("at")) table.place_of("at").fail("expected one value; make a goal of each");
  const bool needs_range = goal.kind == DesignGoal::Kind::none;
  if (needs_range && !table.has("over")) table.place().fail("expected over = [FROM, TO], where there is to be none");
  if (!needs_range && !table.has("at")) table.place().fail("expected at = VALUE, where it is to be");
  if (!needs_range && table.holds_list("at")) table.place_of("at").fail("expected one value; make a goal of each");
}

void GoalReader::read_quantity(const TomlTable& table, DesignGoal& goal) {
  const Sweep& sweep = out_.sweeps[static_cast<std::size_t>(goal.sweep)];
  using Kind = SoughtQuantity::Kind;
  if (goal.kind != DesignGoal::Kind::quantity) {
    if (goal.kind == DesignGoal::Kind::passes) return;
    if (sweep.along == "loads" || find_parameter(out_.scene, sweep.along)) {
      table.place_of("along").fail(
          "expected a measure that is driven, say angle.BODY or length.ELEMENT: in an equilibrium nothing drives it");
    }
    goal.of = located(table.place_of("along"), [&] { return find_quantity(sweep.names, "force.drive"); });
    for (const Stop& stop : out_.scene.stops) {
      if (!is_same(stop.on, goal.of.on) || goal.at.empty()) continue;
      const double same = 1e-9 * sweep.natural;
      if (std::abs(stop.max - goal.at[0]) <= same) goal.at_stop = 1;
      if (std::abs(stop.min - goal.at[0]) <= same) goal.at_stop = -1;
    }
    return;
  }
  const TomlText of = table.text("of");
  goal.of = located(of.place, [&] { return find_quantity(sweep.names, of.value); });
  for (const Kind kind : {Kind::stress, Kind::link_load, Kind::frequency, Kind::damping, Kind::work}) {
    if (goal.of.has(kind)) of.place.fail("it has no derivatives here; expected another quantity");
  }
  if (goal.of.has(Kind::load_at_fold) && (goal.of.kind != Kind::load_at_fold || !sweep.along.empty())) {
    of.place.fail("expected the load at a fold alone, of the scene at rest: without along");
  }
  if (goal.of.is_over_path() && !goal.of.has(Kind::load_at_fold) && !goal.is_range) {
    of.place.fail("it belongs to a range; expected over = [FROM, TO]");
  }
}

void GoalReader::read_curve(const TomlTable& table, DesignGoal& goal) {
  const TomlText file = table.text("curve");
  const Sweep& sweep = out_.sweeps[static_cast<std::size_t>(goal.sweep)];
  if (!goal.is_range) file.place.fail("expected over = [FROM, TO], the range of the curve");
  const std::filesystem::path path = folder_ / file.value;
  out_.files.push_back(path.string());
  for (const char* key : {"least", "most", "equals"}) {
    if (table.has(key)) table.place_of(key).fail("a curve is wanted; make a goal of each");
  }
  if (goal.of.is_over_path())
    file.place.fail("an extreme over the range is one value; expected a quantity of a position");
  const std::vector<std::string> header = located(file.place, [&] { return read_csv_header(path); });
  if (header.size() != 2) {
    file.place.fail(path.string() + ": expected two columns: the value of what is varied, and the wanted value");
  }
  const CsvTable csv = located(file.place, [&] { return read_csv(path, header); });
  const double unit = goal.of.dimension.unit(out_.scene.units);
  for (std::size_t k = 0; k < csv.line.size(); ++k) {
    goal.curve.emplace_back(csv.values[0][k] * sweep.unit, csv.values[1][k] * unit);
  }
  if (goal.curve.size() < 2) file.place.fail(path.string() + ": expected two rows at least");
  if (goal.curve.front().first > goal.curve.back().first) std::reverse(goal.curve.begin(), goal.curve.end());
  for (std::size_t k = 1; k < goal.curve.size(); ++k) {
    if (!(goal.curve[k - 1].first < goal.curve[k].first)) {
      file.place.fail(path.string() + ": expected values of the first column that rise, or fall");
    }
  }
  const auto [least, most] = std::minmax({goal.first, goal.last});
  const double rounding = 1e-9 * (most - least);
  if (least < goal.curve.front().first - rounding || most > goal.curve.back().first + rounding) {
    file.place.fail(path.string() + ": expected values all over the range of the goal");
  }
  goal.within = table.find_number("within", unit, Range::positive).value_or(0.0);
  if (table.has("aim")) {
    if (goal.within > 0.0) table.place_of("within").fail("it is a limit, and the goal an aim; remove one");
    goal.aim = DesignGoal::Aim::curve;
  } else if (goal.within == 0.0) {
    file.place.fail("expected within = DISTANCE as a limit, or aim = \"curve\"");
  }
}

void GoalReader::read_limits(const TomlTable& table, DesignGoal& goal) {
  const double unit = goal.of.dimension.unit(out_.scene.units);
  if (table.has("aim")) {
    constexpr DesignGoal::Aim meanings[] = {DesignGoal::Aim::least, DesignGoal::Aim::greatest, DesignGoal::Aim::flat,
                                            DesignGoal::Aim::curve};
    goal.aim = meanings[choose(table.text("aim"), {"least", "greatest", "flat", "curve"})];
    goal.weight = table.find_number("weight", 1.0, Range::positive).value_or(1.0);
    for (const char* key : {"least", "most", "equals", "within"}) {
      if (table.has(key)) table.place_of(key).fail("it is a limit, and the goal an aim; make a goal of each");
    }
    if (goal.aim == DesignGoal::Aim::flat && !goal.is_range && goal.at.size() < 2) {
      table.place_of("aim").fail("expected over = [FROM, TO]; a single value is always flat");
    }
    if (goal.aim == DesignGoal::Aim::flat && goal.of.is_over_path()) {
      table.place_of("aim").fail("expected least or greatest; an extreme over the range is a single value");
    }
    if (goal.aim == DesignGoal::Aim::curve && !table.has("curve")) table.place().fail("expected curve = \"FILE.csv\"");
  } else if (table.has("weight")) {
    table.place_of("weight").fail("limits are kept, whatever they weigh; expected an aim beside it, or none");
  }
  if (table.has("curve") && !goal.is_limit() && goal.aim != DesignGoal::Aim::curve) {
    table.place_of("aim").fail("expected \"curve\", since a curve is wanted");
  }
  if (table.has("curve")) {
    read_curve(table, goal);
    return;
  }
  if (!goal.is_limit()) return;
  goal.least = table.find_number("least", unit, Range::finite);
  goal.most = table.find_number("most", unit, Range::finite);
  if (const auto value = table.find_number("equals", unit, Range::finite)) {
    if (goal.least || goal.most) table.place_of("equals").fail("expected either equals or least and most");
    const double within = table.find_number("within", unit, Range::positive).value_or(0.0);
    goal.is_equation = within == 0.0;
    if (goal.is_equation && goal.is_range && !goal.of.is_over_path()) {
      table.place_of("equals").fail("expected within = DISTANCE beside it: no mechanism keeps a value exactly");
    }
    goal.least = *value - within;
    goal.most = *value + within;
  } else if (table.has("within")) {
    table.place_of("within").fail("expected equals or curve beside it");
  }
  if (!goal.least && !goal.most) table.place().fail("expected least, most, equals, curve or aim");
  if (goal.least && goal.most && !(*goal.least <= *goal.most)) {
    table.place_of("least").fail("expected least <= most; swap them");
  }
}

void GoalReader::read_goal(const TomlTable& table, std::size_t index) {
  table.allow_keys({"of", "equilibrium", "passes", "along", "over", "at", "positions", "least", "most", "equals",
                    "within", "curve", "aim", "weight"});
  DesignGoal goal;
  goal.line = table.place().line;
  positions_.push_back(0);
  read_kind(table, goal);
  read_positions(table, goal);
  read_quantity(table, goal);
  if (goal.kind == DesignGoal::Kind::quantity) read_limits(table, goal);
  if (goal.kind == DesignGoal::Kind::quantity) {
    goal.name = goal.of.name;
  } else {
    constexpr const char* words[] = {"", "stable equilibrium", "unstable equilibrium", "no equilibrium on the path",
                                     "passes"};
    goal.name = words[static_cast<int>(goal.kind)];
  }
  if (index >= most_positions) table.place().fail("expected at most 1000 goals");
  out_.goals.push_back(std::move(goal));
}

/// Positions of each sweep: those that goals name, the ends, points of curves, and an even spread over each range.
void GoalReader::spread_positions() {
  for (std::size_t s = 0; s < out_.sweeps.size(); ++s) {
    Sweep& sweep = out_.sweeps[s];
    std::vector<double> at;
    bool falls = true;
    for (std::size_t k = 0; k < out_.goals.size(); ++k) {
      const DesignGoal& goal = out_.goals[k];
      if (goal.sweep != static_cast<int>(s)) continue;
      falls = falls && goal.is_range && goal.first > goal.last;
      // Derivatives of what belongs to a range, and what tolerances do to it, are those of the positions.
      constexpr int fewest_of_range = 33;
      if (goal.is_range && goal.of.is_over_path()) positions_[k] = std::max(positions_[k], fewest_of_range);
      at.insert(at.end(), goal.at.begin(), goal.at.end());
      for (int i = 0; goal.is_range && i < positions_[k]; ++i) {
        at.push_back(i + 1 == positions_[k] ? goal.last
                                            : goal.first + (goal.last - goal.first) * i / (positions_[k] - 1));
      }
      for (const auto& [value, wanted] : goal.curve) {
        if (goal.covers(value)) at.push_back(value);
      }
      const bool is_about_one = goal.kind == DesignGoal::Kind::stable || goal.kind == DesignGoal::Kind::unstable;
      // The force that holds the measure has to change its sign there: it is looked at on both sides.
      const double beside = 0.01 * std::max(std::abs(sweep.last - sweep.first), 0.1 * sweep.natural);
      if (is_about_one && goal.at_stop < 1) at.push_back(goal.at[0] + beside);
      if (is_about_one && goal.at_stop > -1) at.push_back(goal.at[0] - beside);
    }
    std::sort(at.begin(), at.end());
    const double same = 1e-12 * std::max({std::abs(at.front()), std::abs(at.back()), 1e-3 * sweep.natural});
    at.erase(std::unique(at.begin(), at.end(), [&](double a, double b) { return b - a <= same; }), at.end());
    if (falls) std::reverse(at.begin(), at.end());
    sweep.first = at.front();
    sweep.last = at.back();
    sweep.at = std::move(at);
  }
}

GoalProblem GoalReader::read() {
  root_.allow_keys({"title", "source", "scene", "tolerances", "share", "variables", "ties", "catalogue", "goal"});
  if (const auto title = root_.find_text("title")) out_.title = title->value;
  if (const auto source = root_.find_text("source")) out_.source = source->value;
  const TomlText scene = root_.text("scene");
  out_.scene_file = folder_ / scene.value;
  out_.scene_text = located(scene.place, [&] { return read_text_file(out_.scene_file); });
  moving_ = parse_scene(out_.scene_text, out_.scene_file.string());
  out_.scene = at_time(moving_, 0.0);
  refuse_blades(out_.scene, "designs");
  read_variables();
  read_ties();
  for (const TomlTable& table : root_.tables("catalogue")) read_catalogue(table);
  if (out_.variables.empty() && out_.catalogues.empty()) {
    root_.place().fail("expected [variables] or [[catalogue]]: what may be chosen; add one");
  }
  std::size_t index = 0;
  for (const TomlTable& table : root_.tables("goal")) read_goal(table, index++);
  if (out_.goals.empty()) root_.place().fail("expected [[goal]] with what is wanted; add one");
  spread_positions();
  if (const auto file = root_.find_text("tolerances")) {
    out_.files.push_back((folder_ / file->value).string());
    out_.tolerance_file = out_.files.back();
    out_.tolerance_text = located(file->place, [&] { return read_text_file(out_.tolerance_file); });
    out_.tolerances = parse_tolerances(out_.tolerance_text, out_.tolerance_file, out_.scene);
  }
  if (const auto share = root_.find_text("share")) {
    if (out_.tolerances.empty()) share->place.fail("expected tolerances = \"FILE\" beside it");
    out_.worst_corner = choose(*share, {"worst corner", "99.7 %"}) == 0;
  }
  return std::move(out_);
}

}  // namespace

namespace {

double shown_exactly(double si, double unit) {
  const double near = si / unit;
  for (const double shown : {near, std::nextafter(near, HUGE_VAL), std::nextafter(near, -HUGE_VAL)}) {
    if (shown * unit == si) return shown;
  }
  return near;
}

}  // namespace

double Sweep::first_shown() const { return shown_exactly(first, unit); }
double Sweep::last_shown() const { return shown_exactly(last, unit); }

bool DesignGoal::covers(double value) const {
  const double rounding = 1e-12 * (std::abs(first) + std::abs(last) + std::abs(value));
  if (is_range) return value >= std::min(first, last) - rounding && value <= std::max(first, last) + rounding;
  return std::any_of(at.begin(), at.end(),
                     [&](double one) { return std::abs(one - value) <= 1e-12 * std::abs(value); });
}

double DesignGoal::wanted_at(double value) const {
  auto after = std::lower_bound(curve.begin() + 1, curve.end() - 1, value,
                                [](const std::pair<double, double>& one, double x) { return one.first < x; });
  const auto [x1, y1] = *after;
  const auto [x0, y0] = *(after - 1);
  return y0 + (y1 - y0) * (value - x0) / (x1 - x0);
}

double DesignGoal::size() const {
  double out = within;
  for (const std::optional<double>& limit : {least, most}) out = std::max(out, std::abs(limit.value_or(0.0)));
  for (const auto& [value, wanted] : curve) out = std::max(out, std::abs(wanted));
  return out;
}

double GoalProblem::combinations() const {
  double out = 1.0;
  for (const Catalogue& one : catalogues) out = std::min(most_combinations, out * static_cast<double>(one.rows.size()));
  return out;
}

GoalProblem read_goals(const std::filesystem::path& file) { return GoalReader(file).read(); }

}  // namespace poise
