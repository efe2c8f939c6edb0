#include "model/read_measure.hpp"

#include <string>
#include <utility>

namespace poise {
namespace {

/// What a term of a sum may have.
const MeasureKeys single_measures{"bodies", "points", "slide", "x", "y", "rope"};

std::string_view meaning_of(std::string_view measure) {
  if (measure == "bodies") return "relative angle";
  if (measure == "points") return "distance, or component along an axis";
  if (measure == "slide") return "travel";
  if (measure == "rope") return "length over points and pulleys";
  return measure == "sum" ? "of the others" : "of a point";
}

[[noreturn]] void fail_without_measure(const TomlTable& table, const MeasureKeys& measures) {
  if (measures.size() == 1) {
    // The meaning of the key.
    table.two_texts(measures.front());
  }
  std::string list;
  for (const std::string_view measure : measures) {
    list += (list.empty() ? "" : ", ") + std::string(measure) + " (" + std::string(meaning_of(measure)) + ")";
  }
  table.place().fail("expected one of the keys " + list);
}

/// The one of these keys that the table has; empty if it has none. Fails if it has several.
std::optional<std::string_view> measure_key(const TomlTable& table, const MeasureKeys& measures) {
  std::optional<std::string_view> key;
  for (const std::string_view measure : measures) {
    if (!table.has(measure)) continue;
    if (key) fail_without_measure(table, measures);
    key = measure;
  }
  return key;
}

}  // namespace

const MeasureKeys& all_measures() {
  static const MeasureKeys all{"bodies", "points", "slide", "x", "y", "rope", "sum"};
  return all;
}

Measure MeasureReader::read(const TomlTable& table, const MeasureKeys& measures,
                            const std::vector<std::string_view>& others) const {
  const std::optional<std::string_view> key = measure_key(table, measures);
  std::vector<std::string_view> allowed{"name"};
  if (key)
    allowed.push_back(*key);
  else
    allowed.insert(allowed.end(), measures.begin(), measures.end());
  if (key == "points") allowed.emplace_back("axis");
  allowed.insert(allowed.end(), others.begin(), others.end());
  table.allow_keys(allowed);
  if (!key) fail_without_measure(table, measures);
  return under(table, *key);
}

Measure MeasureReader::under(const TomlTable& table, std::string_view key) const {
  if (key == "bodies") {
    const auto [a, b] = names_.two_bodies(table);
    return Measure::angle_between(a, b);
  }
  if (key == "points") {
    const auto [a, b] = names_.two_points(table);
    const std::optional<Vec2> axis = table.find_vector("axis", 1.0);
    if (!axis) return Measure::distance_between(a, b);
    if (*axis == Vec2{}) table.place_of("axis").fail("expected a direction, found [0, 0]; give for example [1, 0]");
    return Measure::component_along(a, b, *axis);
  }
  if (key == "slide") return Measure::travel_of(names_.travelling_joint(table.text("slide")));
  if (key == "x") return Measure::x_of(names_.point(table.text("x")));
  if (key == "y") return Measure::y_of(names_.point(table.text("y")));
  if (key == "rope") return Measure::rope_over(contacts(table, key));
  std::vector<Measure::Term> sum = terms(table);
  const std::vector<TomlTable> places = table.tables("sum");
  for (std::size_t k = 0; k < sum.size(); ++k) {
    if (sum[k].measure.is_angle() != sum.front().measure.is_angle()) {
      places[k].place().fail(
          "expected terms that are all angles (bodies) or all lengths (points, slide, x, y, rope); a [[coupling]] may "
          "mix them");
    }
  }
  return Measure::sum_of(std::move(sum));
}

std::vector<Measure::Term> MeasureReader::terms(const TomlTable& table) const {
  std::vector<Measure::Term> out;
  for (const TomlTable& term : table.tables("sum")) {
    Measure measure = read(term, single_measures, {"factor"});
    out.push_back({term.number("factor", 1.0, Range::finite), std::move(measure)});
  }
  if (out.empty()) {
    table.place_of("sum").fail("expected one term or more, for example { factor = NUMBER, slide = \"...\" }");
  }
  return out;
}

std::vector<RopeContact> MeasureReader::contacts(const TomlTable& table, std::string_view key, bool may_rub) const {
  std::vector<RopeContact> out;
  const std::vector<TomlItem> items = table.items(key);
  for (const TomlItem& item : items) {
    RopeContact contact;
    if (item.text) {
      contact.at = names_.point(*item.text);
    } else if (!item.table) {
      item.place().fail(
          "expected a point \"BODY.POINT\", or a pulley { pulley = \"BODY.POINT\", radius = NUMBER, turn = ... }");
    } else {
      if (!may_rub && item.table->has("friction")) {
        item.table->place_of("friction")
            .fail(
                "expected no friction: a rope rubs on its pulleys in a [[rope]] without stiffness alone; remove the "
                "key");
      }
      item.table->allow_keys({"pulley", "radius", "turn", "friction"});
      contact.at = names_.point(item.table->text("pulley"));
      contact.radius = item.table->number("radius", item.table->unit(dimension::length), Range::positive);
      contact.turn = choose(item.table->text("turn"), {"counterclockwise", "clockwise"}) == 0 ? 1 : -1;
      contact.friction = item.table->find_number("friction", 1.0, Range::not_negative);
    }
    const bool is_end = out.empty() || out.size() + 1 == items.size();
    if (is_end && item.table) {
      item.table->place().fail("expected a point at the end of the rope; pulleys are in between");
    }
    if (!out.empty() && out.back().at == contact.at) {
      item.place().fail("expected another point than the one before");
    }
    out.push_back(contact);
  }
  if (out.size() < 2) {
    table.place_of(key).fail(
        "expected two points or more, for example [\"ground.A\", { pulley = \"arm.C\", radius = 30, turn = "
        "\"clockwise\" }, \"load.B\"]");
  }
  return out;
}

bool MeasureReader::reads_angle(const TomlTable& table, const MeasureKeys& measures) {
  const std::optional<std::string_view> key = measure_key(table, measures);
  if (key != "sum") return key == "bodies";
  const std::vector<TomlTable> terms = table.tables("sum");
  return !terms.empty() && terms.front().has("bodies");
}

}  // namespace poise
