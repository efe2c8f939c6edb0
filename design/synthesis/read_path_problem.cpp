#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "design/synthesis/path_curve.hpp"
#include "design/synthesis/path_problem.hpp"
#include "model/input_error.hpp"
#include "model/text_file.hpp"
#include "model/toml_reader.hpp"

namespace poise {
namespace {

constexpr double path_degree = std::numbers::pi / 180;
constexpr double exact_tolerance = 1e-9;      // of the size of the points
constexpr double rounding_of_points = 1e-14;  // of the largest coordinate
constexpr double longest_share = 100.0, shortest_share = 0.01;
constexpr int points_of_curve = 128;
constexpr std::size_t most_path_points = 100'000;

Units path_units(const TomlTable& root) {
  UnitNames names;
  names.angle = "deg";
  if (const auto table = root.find_table("units")) {
    table->allow_keys({"length"});
    if (const auto length = table->find_text("length")) {
      names.length = length->value;
      return located(length->place, [&] { return units_of(names); });
    }
  }
  return units_of(names);
}

void read_curve(const TomlTable& table, const TomlText& name, PathProblem& out) {
  const std::filesystem::path file = std::filesystem::path(out.file).parent_path() / name.value;
  const CurveLine line = located(name.place, [&] { return read_curve_file(file); });
  out.curve = true;
  out.closed = line.closed;
  const int count = static_cast<int>(table.whole_number("samples", 16, points_of_curve));
  if (count > 10'000) table.place_of("samples").fail("expected at most 10000 places on the curve");
  out.points = spread_evenly(line, count);
  for (Vec2& p : out.points) {
    p = out.units.length * p;
    if (!contains(Range::finite, p.x) || !contains(Range::finite, p.y)) {
      name.place.fail("expected coordinates of 1e-50 m to 1e50 m, or 0; scale the curve");
    }
  }
}

void read_points(const TomlTable& table, PathProblem& out) {
  const double length = out.units.length;
  const auto curve = table.find_text("curve");
  if (curve && table.has("points")) curve->place.fail("expected points or a curve, found both; remove one");
  if (!curve && !table.has("points")) {
    table.place().fail("expected points = [[X, Y], ...] or curve = \"FILE\"; add one");
  }
  if (curve) {
    read_curve(table, *curve, out);
  } else {
    if (table.has("samples")) table.place_of("samples").fail("expected a curve with it; remove it");
    for (const TomlTable::Pair& pair : table.pairs("points", length, length)) {
      if (!out.points.empty() && pair.value == out.points.back()) {
        pair.place.fail("expected another point than the one before; remove it");
      }
      out.points.push_back(pair.value);
    }
    const std::size_t count = out.points.size();
    if (count < 2 || count > most_path_points) {
      table.place_of("points").fail(fmt::format("expected 2 to {} points, found {}", most_path_points, count));
    }
  }
  Vec2 mean{};
  for (const Vec2& p : out.points) mean += (1.0 / static_cast<double>(out.points.size())) * p;
  for (const Vec2& p : out.points) out.size = std::max(out.size, norm(p - mean));
  if (!(out.size > 0.0)) table.place_of(curve ? "curve" : "points").fail("expected points that differ");
}

void read_crank(const TomlTable& table, PathProblem& out) {
  const std::size_t count = out.points.size();
  if (table.has("crank") && table.has("crank_step")) {
    table.place_of("crank_step").fail("expected crank or crank_step, found both; remove one");
  }
  for (const std::string_view key : {"crank", "crank_step"}) {
    if (out.curve && table.has(key)) table.place_of(key).fail("expected points with it, found a curve; remove it");
  }
  if (table.has("crank")) {
    for (const double angle : table.numbers("crank")) out.crank.push_back(angle * path_degree);
    if (out.crank.size() != count) {
      table.place_of("crank").fail(
          fmt::format("expected an angle for each of the {} points, found {}", count, out.crank.size()));
    }
    out.start_free = table.flag("crank_free", false);
  } else if (table.has("crank_free")) {
    table.place_of("crank_free").fail("expected crank = [...] with it; add that or remove it");
  }
  if (const auto step = table.find_number("crank_step", path_degree, Range::finite)) {
    if (*step == 0.0) table.place_of("crank_step").fail("expected an angle other than 0");
    for (std::size_t i = 0; i < count; ++i) out.crank.push_back(*step * static_cast<double>(i));
    out.start_free = true;
  }
  if (const auto from = table.find_text("crank_from")) {
    out.from_ground = choose(*from, {"x", "ground"}) == 1;
    if (out.crank.empty()) from->place.fail("expected crank = [...] or crank_step with it; add one or remove it");
    if (out.from_ground && out.linkage == PathLinkage::slider_crank) {
      from->place.fail("expected \"x\" for a slider-crank, whose ground has no second pivot");
    }
  }
}

void read_limits(const TomlTable& table, PathProblem& out) {
  const double length = out.units.length;
  const bool four_bar = out.linkage == PathLinkage::four_bar;
  if (table.has("pivots")) {
    if (!four_bar) table.place_of("pivots").fail("expected a four-bar with it, found a slider-crank; remove it");
    const auto pairs = table.pairs("pivots", length, length);
    if (pairs.size() != 2) {
      table.place_of("pivots").fail(fmt::format("expected two pivots [[X, Y], [X, Y]], found {}", pairs.size()));
    }
    if (pairs[0].value == pairs[1].value) pairs[1].place.fail("expected two different pivots");
    out.pivots = {pairs[0].value, pairs[1].value};
  }
  out.limits.longest = table.find_number("longest", length, Range::positive).value_or(longest_share * out.size);
  out.limits.shortest = table.find_number("shortest", length, Range::positive)
                            .value_or(std::min(shortest_share * out.size, 0.5 * out.limits.longest));
  if (!(out.limits.shortest < out.limits.longest)) {
    table.place_of(table.has("shortest") ? "shortest" : "longest")
        .fail("expected shortest below longest; make longest larger");
  }
  if (table.has("within")) {
    const std::vector<double> ends = table.numbers("within");
    if (ends.size() != 4 || !(ends[0] < ends[2] && ends[1] < ends[3])) {
      table.place_of("within").fail(
          "expected [LEFT, LOWER, RIGHT, UPPER] of a rectangle, with LEFT < RIGHT, LOWER < UPPER");
    }
    out.limits.within = {length * Vec2{ends[0], ends[1]}, length * Vec2{ends[2], ends[3]}};
    if (out.pivots) table.place_of("within").fail("expected pivots or a place for them, found both; remove one");
  }
  out.limits.full_turn = table.flag("full_turn", false);
  if (const auto angle = table.find_number("transmission", path_degree, Range::positive)) {
    const TomlPlace place = table.place_of("transmission");
    if (!out.limits.full_turn) place.fail("expected full_turn = true with it; add that or remove it");
    if (!(*angle < 0.5 * std::numbers::pi)) place.fail("expected an angle below 90 degrees");
    out.limits.transmission = *angle;
  }
  out.order = table.flag("order", true);
  double largest = 0.0;
  for (const Vec2& p : out.points) largest = std::max({largest, std::abs(p.x), std::abs(p.y)});
  out.tolerance = table.find_number("tolerance", length, Range::positive)
                      .value_or(exact_tolerance * out.size + rounding_of_points * largest);
  out.within_error = table.find_number("within_error", length, Range::positive);
}

}  // namespace

int PathProblem::freedom() const {
  const int given = static_cast<int>(points.size());
  const int all = (linkage == PathLinkage::four_bar ? 9 : 8) - (pivots ? 4 : 0);
  return crank.empty() ? all - given : all + (start_free ? 1 : 0) - 2 * given;
}

PathProblem read_path_problem(const std::filesystem::path& file) {
  const std::string text = read_text_file(file);
  PathProblem out;
  out.file = file.string();
  const toml::table document = parse_toml(text, out.file);
  const TomlTable root(document, {out.file, 1, ""});
  root.allow_keys({"title", "source", "units", "synthesis"});
  if (const auto title = root.find_text("title")) out.title = title->value;
  if (const auto source = root.find_text("source")) out.source = source->value;
  out.units = path_units(root);
  const auto table = root.find_table("synthesis");
  if (!table) root.place().fail("expected a table [synthesis]; add it");
  table->allow_keys({"kind", "linkage", "points", "curve", "samples", "crank", "crank_step", "crank_free", "crank_from",
                     "order", "full_turn", "pivots", "within", "longest", "shortest", "transmission", "tolerance",
                     "within_error"});
  choose(table->text("kind"), {"path"});
  if (const auto linkage = table->find_text("linkage")) {
    const bool slider = choose(*linkage, {"four-bar", "slider-crank"}) == 1;
    out.linkage = slider ? PathLinkage::slider_crank : PathLinkage::four_bar;
  }
  read_points(*table, out);
  read_crank(*table, out);
  read_limits(*table, out);
  return out;
}

}  // namespace poise
