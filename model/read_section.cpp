#include "model/read_section.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "model/nearest_name.hpp"
#include "model/section_profiles.hpp"

namespace poise {
namespace {

/// The points of the body that the key `line` names; without it both points of a body that has two.
std::vector<int> read_line(const TomlTable& table, const Body& body) {
  std::vector<int> line;
  if (!table.has("line")) {
    if (body.points.size() == 2) return {0, 1};
    table.place().fail("expected the key line, because \"" + body.name + "\" has " +
                       std::to_string(body.points.size()) +
                       " points; add line = [\"A\", \"B\", ...], its points in order along its axis");
  }
  std::vector<std::string> names;
  for (const NamedPoint& point : body.points) names.push_back(point.name);
  for (const TomlText& text : table.texts("line")) {
    const auto found = std::find(names.begin(), names.end(), text.value);
    if (found == names.end()) {
      text.place.fail("expected a point of \"" + body.name + "\", found \"" + text.value + "\"" +
                      did_you_mean_or_list(text.value, names));
    }
    const int point = static_cast<int>(found - names.begin());
    if (std::find(line.begin(), line.end(), point) != line.end()) {
      text.place.fail("expected every point once, found \"" + text.value + "\" twice");
    }
    if (!line.empty() &&
        body.points[static_cast<std::size_t>(line.back())].at == body.points[static_cast<std::size_t>(point)].at) {
      text.place.fail("expected a line, found \"" + text.value + "\" at the place of the point before it");
    }
    line.push_back(point);
  }
  if (line.size() < 2) table.place_of("line").fail("expected two points or more");
  return line;
}

}  // namespace

CrossSection read_section(const TomlTable& table, const Body& body) {
  std::vector<std::string_view> keys{"profile", "line", "flexible"};
  if (table.flag("flexible", false)) keys.emplace_back("elements");
  for (const Number& number : CrossSection::numbers) keys.push_back(number.key);
  table.allow_keys(keys);
  CrossSection section;
  const std::optional<TomlText> profile = table.find_text("profile");
  if (profile) {
    const SectionProfile named = read_profile(*profile, table.unit(dimension::length));
    section.area = named.area;
    section.second_moment = named.second_moment;
    section.height = named.height;
  }
  for (const Number& number : CrossSection::numbers) {
    const double unit = table.unit(number.dimension);
    const bool is_given_by_profile = profile && number.key != "modulus";
    const bool needed = number.key != "left" && !is_given_by_profile;
    const std::optional<double> value =
        needed ? table.number(number.key, unit, number.range) : table.find_number(number.key, unit, number.range);
    if (value) located(table.place_of(number.key), [&] { number.set(&section, *value); });
  }
  section.line = read_line(table, body);
  return section;
}

}  // namespace poise
