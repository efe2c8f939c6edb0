#include "app/report/parts.hpp"

#include <cmath>

#include <fmt/format.h>

#include "app/shown_values.hpp"
#include "app/table.hpp"
#include "statics/pose_values.hpp"

namespace poise::app {
inline namespace replaced {
namespace {

/// What stands in a section of coordinates.
struct CoordinateKind {
  const char* title;
  const char* noun;
  Quantity quantity;
};

std::string coordinate_section(const StaticModel& model, const CoordinateKind& kind,
                               const std::vector<std::vector<NamedValue>>& columns,
                               const std::vector<std::string>& titles, const Palette& palette) {
  if (columns.empty() || columns.front().empty()) return "";
  const Units& units = model.scene().units;
  const Quantity quantity = kind.quantity;
  // The same decimals for all columns, and for angles that have made many turns.
  const double scale = in_unit(quantity == Quantity::angle ? M_PI : model.scales().length, quantity, units);
  Table table;
  std::vector<std::string> names;
  std::vector<Cell> notes;
  for (const NamedValue& shown : columns.front()) {
    names.push_back(shown.name);
    notes.push_back({shown.determined ? "" : "free: bears nothing, left at its start", Tone::faint});
  }
  table.add_text_column(kind.noun, names);
  for (std::size_t c = 0; c < columns.size(); ++c) {
    std::vector<double> values;
    for (const NamedValue& shown : columns[c]) values.push_back(shown.value);
    table.add_number_column(titles[c], aligned(in_units(model, quantity, values), coordinate_digits, scale));
  }
  table.add_text_column("", notes);
  return section(with_unit(kind.title, quantity, units), table.print(palette), palette);
}

}  // namespace

std::string with_unit(const std::string& title, Quantity quantity, const Units& units) {
  return fmt::format("{} ({})", title, unit_name(quantity, units));
}

std::string heading(const std::string& title, const std::string& source, const Palette& palette) {
  std::string out = palette.paint(Tone::strong, one_line(title)) + "\n";
  if (!source.empty()) out += palette.paint(Tone::faint, "source: " + one_line(source)) + "\n";
  return out + "\n";
}

std::string heading(const ScaledModel& model, const Palette& palette) {
  const Scene& scene = model.scene();
  return heading(scene.title.empty() ? scene.file : scene.title, scene.source, palette);
}

std::string fact(const std::string& name, const std::string& text, const Palette& palette) {
  return "  " + palette.paint(Tone::faint, fmt::format("{:<13}", name)) + text + "\n";
}

std::string section(const std::string& title, const std::string& body, const Palette& palette) {
  return body.empty() ? "" : "\n" + palette.paint(Tone::strong, title) + "\n" + body;
}

std::string list_section(const std::string& title, const std::vector<std::string>& items, const Palette& palette) {
  const std::size_t shown = items.size() <= Table::shown_rows + 1 ? items.size() : Table::shown_rows;
  std::string out;
  for (std::size_t i = 0; i < shown; ++i) out += "  " + items[i] + "\n";
  if (shown < items.size()) {
    out += palette.paint(Tone::faint, fmt::format("  ... and {} more", items.size() - shown)) + "\n";
  }
  return section(title, out, palette);
}

std::string left_out_section(const StaticModel& model, const Palette& palette) {
  return list_section("Left out of statics", model.layout().dropped, palette);
}

std::string friction_line(const Scene& scene, const Palette& palette) {
  std::vector<std::string> names;
  for (const Element& element : scene.elements) {
    const auto* friction = std::get_if<DryFriction>(&element.law);
    if (friction != nullptr && friction->force != 0.0) names.push_back("\"" + element.name + "\"");
  }
  if (names.empty()) return "";
  return palette.paint(Tone::doubtful, fmt::format("Dry friction is left out: {} may hold the mechanism elsewhere too.",
                                                   listed(names))) +
         "\n";
}

Tone tone_of(Status status) { return status == Status::confirmed ? Tone::good : Tone::bad; }

Tone tone_of(Stability stability) {
  switch (stability) {
    case Stability::stable:
      return Tone::good;
    case Stability::unstable:
      return Tone::bad;
    case Stability::neutral:
    case Stability::unknown:
      return Tone::doubtful;
  }
  return Tone::plain;
}

std::string in_words(const Check& check) {
  std::string text = to_string(check.stability);
  const auto add = [&](int number, const std::string& what) {
    if (number > 0) text += ", " + count(number, what + " direction", what + " directions");
  };
  add(check.unstable_directions, "falling");
  add(check.neutral_directions, "neutral");
  return text;
}

std::string coordinate_sections(const StaticModel& model, const std::vector<const Answer*>& answers,
                                const std::vector<std::string>& titles, const Palette& palette) {
  std::vector<std::vector<NamedValue>> angles, travels, places;
  for (const Answer* answer : answers) {
    angles.push_back(angles_of(model, *answer->readings));
    travels.push_back(travels_of(model, *answer->readings));
    places.push_back(places_of(model, *answer->readings));
  }
  return coordinate_section(model, {"Angles", "body", Quantity::angle}, angles, titles, palette) +
         coordinate_section(model, {"Slides", "joint", Quantity::length}, travels, titles, palette) +
         coordinate_section(model, {"Places of free bodies", "body", Quantity::length}, places, titles, palette);
}

}  // namespace replaced
}  // namespace poise::app
