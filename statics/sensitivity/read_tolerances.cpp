#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "model/dependent_number.hpp"
#include "model/input_error.hpp"
#include "model/nearest_name.hpp"
#include "model/parameters.hpp"
#include "model/text_file.hpp"
#include "model/toml_reader.hpp"
#include "statics/model/static_numbers.hpp"
#include "statics/sensitivity/tolerance.hpp"

namespace poise {
namespace {

constexpr double farthest_draw = 6.0;  // standard deviations of a normal number, which is drawn again beyond

/// "*" stands for any text.
bool matches(std::string_view pattern, std::string_view text) {
  const std::size_t star = pattern.find('*');
  if (star == std::string_view::npos) return pattern == text;
  if (!text.starts_with(pattern.substr(0, star))) return false;
  const std::string_view rest = pattern.substr(star + 1);
  for (std::size_t from = star; from <= text.size(); ++from) {
    if (matches(rest, text.substr(from))) return true;
  }
  return false;
}

/// Statics uses it, and it is given.
bool is_used(const Scene& scene, const ParameterRow& row) {
  if (!acts_in_statics(scene, row.place)) return false;
  if (row.place.owner == Owner::number && dependent_number(scene, row.place) != nullptr) return false;
  const std::optional<double> value = value_at(scene, row.place);
  return value && std::isfinite(*value);
}

/// Half width as given: a number, or a table.
Tolerance read_one(const TomlTable& table, const std::string& key, const ParameterRow& row, double value,
                   const Units& units) {
  const double unit = row.dimension.unit(units);
  Tolerance out{.number = row.path.text(), .dimension = row.dimension};
  if (!table.holds_table(key)) {
    out.half_width = table.number(key, unit, Range::not_negative);
    out.sigma = out.half_width / std::sqrt(3.0);
    return out;
  }
  const TomlTable given = *table.find_table(key);
  given.allow_keys({"half_width", "percent", "distribution", "sigma"});
  if (given.has("half_width") == given.has("percent")) {
    given.place().fail("expected either half_width or percent");
  }
  out.half_width = given.has("percent") ? given.number("percent", 0.01, Range::not_negative) * std::abs(value)
                                        : given.number("half_width", unit, Range::not_negative);
  if (const auto word = given.find_text("distribution")) {
    constexpr Tolerance::Distribution meanings[] = {Tolerance::Distribution::uniform, Tolerance::Distribution::normal};
    out.distribution = meanings[choose(*word, {"uniform", "normal"})];
  }
  const bool is_normal = out.distribution == Tolerance::Distribution::normal;
  if (given.has("sigma") && !is_normal) {
    given.place_of("sigma").fail("a uniform number has no sigma of its own; add distribution = \"normal\"");
  }
  out.sigma = given.find_number("sigma", unit, Range::not_negative)
                  .value_or(out.half_width / (is_normal ? 3.0 : std::sqrt(3.0)));
  return out;
}

void check_range(const Scene& scene, const ParameterRow& row, double value, const Tolerance& tolerance,
                 const TomlPlace& place) {
  const bool is_normal = tolerance.distribution == Tolerance::Distribution::normal;
  const double reach =
      is_normal ? std::max(tolerance.half_width, farthest_draw * tolerance.sigma) : tolerance.half_width;
  const double unit = row.dimension.unit(scene.units);
  if (!contains(row.range, value - reach)) {
    place.fail(fmt::format("{} = {} may fall to {}, {}", tolerance.number, value / unit, (value - reach) / unit,
                           out_of_range(row.range, (value - reach) / unit)));
  }
  if (row.place.owner == Owner::force &&
      scene.forces[static_cast<std::size_t>(row.place.item)].line_of_action() == Vec2{}) {
    place.fail(tolerance.number + " is zero and has no direction; give the force a direction and a size");
  }
  if (row.place.owner == Owner::number) {
    for (const double end : {value - reach, value + reach}) {
      Scene there = scene;
      // The message names the path itself.
      located({place.file, place.line, "tolerances"}, [&] { set_value(there, tolerance.number, end); });
    }
  }
  if (row.place.owner == Owner::stop) {
    const Stop& stop = scene.stops[row.place.item];
    if (stop.max - stop.min < 2 * reach) {
      place.fail(fmt::format("{}: expected less than half of the distance from min to max", tolerance.number));
    }
  }
}

}  // namespace

std::vector<Tolerance> parse_tolerances(std::string_view text, const std::string& name, const Scene& scene) {
  const toml::table document = parse_toml(text, name);
  const TomlTable root(document, {name, 1, ""});
  root.allow_keys({"tolerances"});
  const std::optional<TomlTable> table = root.find_table("tolerances");
  if (!table) root.place().fail("expected a table [tolerances], say [tolerances] and \"point.*\" = 0.1");
  const std::vector<std::string> keys = table->keys();
  const std::vector<ParameterRow> rows = parameter_table(scene);
  std::vector<std::string> known, used;
  for (const ParameterRow& row : rows) {
    known.push_back(row.path.text());
    if (is_used(scene, row)) used.push_back(known.back());
  }
  std::vector<char> counts(keys.size(), 0);
  std::vector<Tolerance> out;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (!is_used(scene, rows[k])) continue;
    std::optional<std::size_t> best;
    for (std::size_t i = 0; i < keys.size(); ++i) {
      if (!matches(keys[i], known[k])) continue;
      counts[i] = 1;
      const auto rank = [&](const std::string& key) {
        return std::pair(key.find('*') == std::string::npos, key.size());
      };
      if (!best || rank(keys[*best]) < rank(keys[i])) best = i;
    }
    if (!best) continue;
    const double value = *value_at(scene, rows[k].place);
    Tolerance one = read_one(*table, keys[*best], rows[k], value, scene.units);
    check_range(scene, rows[k], value, one, table->place_of(keys[*best]));
    if (one.half_width > 0.0 || one.sigma > 0.0) {
      out.push_back(std::move(one));
    } else if (value == 0.0 && table->holds_table(keys[*best]) && table->find_table(keys[*best])->has("percent") &&
               keys[*best] == known[k]) {
      table->place_of(keys[*best]).fail("the number is 0, of which a percentage is 0; give a half_width");
    }
  }
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (counts[i]) continue;
    if (std::find(known.begin(), known.end(), keys[i]) != known.end()) {
      table->place_of(keys[i]).fail("this number does not act in statics, or is not given; leave it out");
    }
    table->place_of(keys[i]).fail("expected the path of a number that statics uses, or a pattern of such" +
                                  did_you_mean_or_list(keys[i], used));
  }
  if (out.empty()) table->place().fail("expected one tolerance above zero at least");
  return out;
}

std::vector<Tolerance> read_tolerances(const std::filesystem::path& file, const Scene& scene) {
  return parse_tolerances(read_text_file(file), file.string(), scene);
}

}  // namespace poise
