#include "design/synthesis/read_synthesis.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string_view>

#include <fmt/format.h>

#include "model/text_file.hpp"
#include "model/toml_reader.hpp"

namespace poise {
namespace {

namespace fs = std::filesystem;

constexpr double degree = std::numbers::pi / 180;

/// A design file, of which the tables refer to the document.
class SynthesisFile {
 public:
  explicit SynthesisFile(const fs::path& file)
      : file_(file.string()), document_(parse_toml(read_text_file(file), file_)), root_(document_, {file_, 1, ""}) {}
  SynthesisFile(const SynthesisFile&) = delete;
  SynthesisFile& operator=(const SynthesisFile&) = delete;

  const std::string& name() const { return file_; }
  const TomlTable& root() const { return root_; }
  TomlTable synthesis() const {
    const auto table = root_.find_table("synthesis");
    if (!table) root_.place().fail("expected a table [synthesis]; add it");
    return *table;
  }

 private:
  std::string file_;
  toml::table document_;
  TomlTable root_;
};

SynthesisKind kind_of(const TomlTable& synthesis) {
  const std::vector<std::string> kinds{"poses", "function", "path"};
  return static_cast<SynthesisKind>(choose(synthesis.text("kind"), kinds));
}

std::optional<GrashofKind> read_kind(const TomlTable& table) {
  const auto word = table.find_text("grashof");
  if (!word) return std::nullopt;
  const std::vector<GrashofKind> kinds{GrashofKind::crank_rocker,  GrashofKind::double_crank,
                                       GrashofKind::rocker_crank,  GrashofKind::double_rocker,
                                       GrashofKind::triple_rocker, GrashofKind::change_point};
  std::vector<std::string> words;
  for (const GrashofKind kind : kinds) words.push_back(to_string(kind));
  return kinds[choose(*word, words)];
}

std::vector<BodyPosition> read_poses(const TomlTable& table, double length) {
  constexpr std::size_t fewest = 3, most = 5;
  const std::vector<TomlItem> rows = table.items("poses");
  if (rows.size() < fewest || rows.size() > most) {
    table.place_of("poses").fail(fmt::format("expected 3, 4 or 5 poses [X, Y, ANGLE], found {}", rows.size()));
  }
  std::vector<BodyPosition> out;
  for (const TomlItem& row : rows) {
    const toml::array* const list = row.node->as_array();
    std::array<double, 3> value{};
    bool fits = list != nullptr && list->size() == value.size();
    for (std::size_t k = 0; fits && k < value.size(); ++k) {
      const auto number = (*list)[k].value<double>();
      fits = number && contains(Range::finite, k < 2 ? *number * length : *number);
      value[k] = number.value_or(0.0);
    }
    if (!fits) row.place().fail("expected three finite numbers [X, Y, ANGLE], the angle in degrees");
    out.push_back({{value[0] * length, value[1] * length}, value[2] * degree});
  }
  const auto turned_alike = [](const BodyPosition& a, const BodyPosition& b) {
    return std::abs(std::remainder(a.angle - b.angle, 2 * std::numbers::pi)) < 1e-12;
  };
  bool turns = false;
  for (std::size_t i = 0; i < out.size(); ++i) {
    turns = turns || !turned_alike(out[i], out.front());
    for (std::size_t j = 0; j < i; ++j) {
      if (out[i].at == out[j].at && turned_alike(out[i], out[j])) {
        rows[i].place().fail(fmt::format("expected poses that differ, found the same as pose {}; remove it", j + 1));
      }
    }
  }
  if (!turns) {
    table.place_of("poses").fail("expected poses that turn, found shifts only; any two equal parallel links do that");
  }
  return out;
}

std::vector<Vec2> read_places(const TomlTable& table, std::string_view key, double length) {
  std::vector<Vec2> out;
  if (!table.has(key)) return out;
  for (const TomlTable::Pair& pair : table.pairs(key, length, length)) out.push_back(pair.value);
  return out;
}

PoseTask read_pose_task(const TomlTable& table, double length) {
  table.allow_keys({"kind", "poses", "grashof", "within", "near", "pins", "pivots"});
  PoseTask out;
  out.positions = read_poses(table, length);
  out.wishes.kind = read_kind(table);
  if (table.has("within")) {
    const std::vector<double> sides = table.numbers("within");
    if (sides.size() != 4 || !(sides[0] < sides[2]) || !(sides[1] < sides[3])) {
      table.place_of("within").fail("expected a rectangle [LEFT, LOWER, RIGHT, UPPER]");
    }
    out.wishes.within = Rectangle{length * Vec2{sides[0], sides[1]}, length * Vec2{sides[2], sides[3]}};
  }
  out.near = read_places(table, "near", length);
  out.pins = read_places(table, "pins", length);
  out.pivots = read_places(table, "pivots", length);
  const std::size_t number = out.positions.size();
  const auto only_with = [&](std::string_view key, std::size_t poses) {
    if (table.has(key) && number != poses) {
      table.place_of(key).fail(fmt::format("expected it with {} poses only, found {}; remove it", poses, number));
    }
  };
  only_with("near", 4);
  only_with("pins", 3);
  only_with("pivots", 3);
  if (table.has("near") && out.near.size() != 2) {
    table.place_of("near").fail(fmt::format("expected two places of pivots, found {}", out.near.size()));
  }
  if (number == 3 && out.pins.size() + out.pivots.size() != 2) {
    table.place_of("poses").fail(
        fmt::format("expected with 3 poses two points in pins and pivots together, found {}; give pins = [[X, Y], "
                    "[X, Y]], points of the body, or pivots",
                    out.pins.size() + out.pivots.size()));
  }
  return out;
}

WantedFunction read_function(const TomlTable& table) {
  const TomlText text = table.text("function");
  const Expression y = located(text.place, [&] { return Expression(text.value, {"x"}); });
  const Vec2 range = table.vector("range", 1.0);
  if (range.x == range.y) table.place_of("range").fail("expected two numbers [FROM, TO] that differ");
  WantedFunction out{y, range.x, range.y, 0.0, 0.0};
  for (const auto& [key, turn] :
       {std::pair("input_turn", &out.input_turn), std::pair("output_turn", &out.output_turn)}) {
    const double written = table.number(key, 1.0, Range::finite);
    if (written == 0.0 || std::abs(written) > 360.0) {
      table.place_of(key).fail(fmt::format("expected a turn of at most 360 degrees other than 0, found {}", written));
    }
    *turn = written * degree;
  }
  const double first = out.value(out.from), last = out.value(out.to);
  if (!std::isfinite(first) || !std::isfinite(last) || first == last) {
    text.place.fail(
        "expected a function with finite values at the ends of the range that differ; the output turns from "
        "one to the other");
  }
  return out;
}

/// Fails unless there are as many pairs as the starts that are free ask for.
void check_number(const TomlPlace& place, std::size_t found, const FunctionTask& task) {
  const int free = static_cast<int>(!task.input_start) + static_cast<int>(!task.output_start);
  if (found == static_cast<std::size_t>(3 + free)) return;
  constexpr std::array words{"both input_start and output_start given", "one of input_start and output_start given",
                             "neither input_start nor output_start given"};
  place.fail(fmt::format("expected {}, for {}; found {}", 3 + free, words[static_cast<std::size_t>(free)], found));
}

FunctionSynthesis read_function_task(const TomlTable& table, double length) {
  FunctionSynthesis out;
  FunctionTask& task = out.task;
  const bool by_pairs = table.has("pairs");
  if (by_pairs) {
    table.allow_keys({"kind", "pairs", "input_start", "output_start", "ground", "grashof"});
  } else {
    table.allow_keys({"kind", "function", "range", "input_turn", "output_turn", "input_start", "output_start", "at",
                      "ground", "grashof"});
  }
  task.ground = table.find_number("ground", length, Range::positive).value_or(length);
  task.input_start = table.find_number("input_start", degree, Range::finite);
  task.output_start = table.find_number("output_start", degree, Range::finite);
  out.kind = read_kind(table);
  if (by_pairs) {
    const std::vector<TomlTable::Pair> pairs = table.pairs("pairs", degree, degree);
    check_number(table.place_of("pairs"), pairs.size(), task);
    for (const TomlTable::Pair& pair : pairs) task.turns.push_back(pair.value);
  } else {
    out.wanted = read_function(table);
    const int free = static_cast<int>(!task.input_start) + static_cast<int>(!task.output_start);
    out.points = table.has("at") ? table.numbers("at") : chebyshev_points(out.wanted->from, out.wanted->to, 3 + free);
    check_number(table.place_of("at"), out.points.size(), task);
    const auto [low, high] = std::minmax(out.wanted->from, out.wanted->to);
    for (const double x : out.points) {
      if (!(x >= low && x <= high)) table.place_of("at").fail(fmt::format("expected places in the range, found {}", x));
      task.turns.push_back(out.wanted->turns_at(x));
      if (!std::isfinite(task.turns.back().y)) {
        table.place_of("function").fail(fmt::format("expected a function with a value at x = {}", x));
      }
    }
  }
  for (std::size_t i = 0; i < task.turns.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (task.turns[i].x == task.turns[j].x) {
        table.place_of(by_pairs ? "pairs" : "at")
            .fail(fmt::format("expected different places, found numbers {} and {} the same", j + 1, i + 1));
      }
    }
  }
  if (out.wanted) {
    task.last = out.wanted->input_turn;
  } else {
    const auto [low, high] = std::minmax_element(task.turns.begin(), task.turns.end(),
                                                 [](const Vec2& a, const Vec2& b) { return a.x < b.x; });
    task.first = low->x;
    task.last = high->x;
  }
  return out;
}

}  // namespace

SynthesisKind synthesis_kind(const fs::path& file) { return kind_of(SynthesisFile(file).synthesis()); }

SynthesisProblem read_synthesis(const fs::path& file) {
  const SynthesisFile design(file);
  const TomlTable& root = design.root();
  root.allow_keys({"title", "source", "units", "synthesis"});
  SynthesisProblem out{};
  out.file = design.name();
  if (const auto title = root.find_text("title")) out.title = title->value;
  if (const auto source = root.find_text("source")) out.source = source->value;
  UnitNames names{.angle = "deg"};
  if (const auto units = root.find_table("units")) {
    units->allow_keys({"length"});
    if (const auto length = units->find_text("length")) names.length = length->value;
    TomlPlace place = units->place_of("length");
    place.item.clear();  // the objection names it
    out.units = located(place, [&] { return units_of(names); });
  } else {
    out.units = units_of(names);
  }
  const TomlTable table = design.synthesis();
  switch (kind_of(table)) {
    case SynthesisKind::poses:
      out.task = read_pose_task(table, out.units.length);
      break;
    case SynthesisKind::function:
      out.task = read_function_task(table, out.units.length);
      break;
    case SynthesisKind::path:
      table.place_of("kind").fail("expected \"poses\" or \"function\"");
  }
  return out;
}

}  // namespace poise
