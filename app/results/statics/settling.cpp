#include "app/results/statics/settling.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/result/numbers.hpp"
#include "app/results/parts.hpp"

namespace poise::app {
namespace {

constexpr std::size_t most_shown = 6;  // coordinates of a pose in a line of text

/// What the motion that settles is resisted by: where there is one freedom, that decides nothing.
void show_resistance(Group& content, const Settling& settling) {
  if (settling.freedoms <= 1) return;
  content.fact("resisted", settling.by_dampers ? "by its dampers" : "alike in all coordinates (rad, sizes)",
               Tone::plain, Verbosity::verbose);
}

std::string stops_in_words(const StaticModel& model, const std::vector<int>& stops) {
  std::vector<std::string> names;
  for (const int s : stops)
    names.push_back(fmt::format("\"{}\"", model.scene().stops[static_cast<std::size_t>(s)].name));
  return names.empty() ? "" : " on " + std::string(names.size() == 1 ? "stop " : "stops ") + listed(names);
}

/// "upper 4.1441 deg, gib 1.5687 mm".
std::string pose_in_words(const StaticModel& model, const std::vector<double>& x) {
  const std::vector<double> q = shown_coordinates(model, x);
  std::string text;
  for (std::size_t i = 0; i < std::min(q.size(), most_shown); ++i) {
    const Coordinate& coordinate = model.layout().coordinates[i];
    text +=
        fmt::format("{}{} {}", i == 0 ? "" : ", ", coordinate.name, with_unit(model, q[i], quantity_of(coordinate)));
  }
  return text + (q.size() > most_shown ? ", ..." : "");
}

std::string side_in_words(const StaticModel& model, const Settling::Side& side) {
  if (side.end != Settling::End::settled) return to_string(side.end);
  return "falls to " + pose_in_words(model, side.x) + stops_in_words(model, side.active_stops);
}

std::string doubt(const Settling& settling) {
  if (settling.margin == 0.0) {
    return "In doubt: the motion from the start leads onto an unstable equilibrium, and what disturbs it decides where "
           "it "
           "goes from there.";
  }
  if (settling.freedoms > 1 && std::isfinite(settling.margin)) {
    return fmt::format(
        "In doubt: on its way the mechanism passes within {} (rad or sizes) of motions that end elsewhere.",
        small_number(settling.margin));
  }
  return "In doubt: on its way the mechanism passes a place where rounding decides whether it stops.";
}

std::vector<std::string> stop_names(const StaticModel& model, const std::vector<int>& stops) {
  std::vector<std::string> names;
  for (const int s : stops) names.push_back(model.scene().stops[static_cast<std::size_t>(s)].name);
  return names;
}

}  // namespace

void show_settling(Result& result, const StaticModel& model, const Equilibrium& equilibrium) {
  if (!equilibrium.settling) return;
  const Settling& settling = *equilibrium.settling;
  Group& content = result.content;
  if (settling.end == Settling::End::settled) {
    const bool is_free = model.scene().blades.empty();
    content.fact("reached", is_free ? "from the start when released with heavy damping"
                                    : "from the start when released with heavy damping, if its blades were taken away");
  } else if (settling.end == Settling::End::start_unstable) {
    content.fact("reached", "the start itself, an equilibrium that the mechanism leaves when it is disturbed");
  }
  show_resistance(content, settling);
  for (std::size_t k = 0; k < settling.sides.size(); ++k) {
    content.fact(fmt::format("side {}", k + 1), side_in_words(model, settling.sides[k]));
  }
  if (settling.in_doubt) result.warnings.push_back(doubtful(doubt(settling)));
}

void show_settling_effort(Group& group, const Equilibrium& equilibrium) {
  if (!equilibrium.settling) return;
  group.fact("settling", fmt::format("{}, {}", count(equilibrium.settling->evaluations, "evaluation", "evaluations"),
                                     duration(equilibrium.settling->microseconds)));
}

void add_settling_data(Group& group, const StaticModel& model, const Equilibrium& equilibrium) {
  if (!equilibrium.settling) {
    group.data("settled", nullptr);
    return;
  }
  const Settling& settling = *equilibrium.settling;
  Group& data = group.group("settled", "", Verbosity::data);
  data.data("end", to_string(settling.end));
  data.data("why", settling.why);
  add_coordinate_data(data, "pose", model, settling.x);
  data.list("stops", "", stop_names(model, settling.active_stops), Verbosity::data);
  data.data("in_doubt", settling.in_doubt);
  data.data("margin", settling.margin);
  data.data("freedoms", settling.freedoms);
  data.data("resistance", settling.by_dampers ? "dampers" : "coordinates");
  data.data("evaluations", settling.evaluations);
  data.data("microseconds", settling.microseconds);
  Branch& sides = data.array("sides");
  for (const Settling::Side& side : settling.sides) {
    Group& one = sides.parts.emplace_back();
    one.data("end", to_string(side.end));
    add_coordinate_data(one, "pose", model, side.x);
    one.list("stops", "", stop_names(model, side.active_stops), Verbosity::data);
  }
}

}  // namespace poise::app
