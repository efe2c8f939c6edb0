#include "app/results/statics/loads_along.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "app/result/numbers.hpp"
#include "app/results/parts.hpp"
#include "app/results/statics/loads.hpp"
#include "statics/paths/path_words.hpp"

namespace poise::app {
namespace {

const Format format_of_extremes{.style = Format::Style::significant, .digits = force_digits};

void add_joint_extremes(Group& content, const VariedScene& varied, const std::vector<LoadSeries>& joints) {
  const Units& units = varied.scene().units;
  Table& table = content.table("joints", "Joint forces", Rows::list);
  table.words("name", "joint", each(joints, &LoadSeries::item));
  table.words("", "force",
              each(joints, [](const LoadSeries& one) { return std::string(one.key == "axial" ? "tension" : "size"); }));
  for (const auto& [extreme, key, title] :
       {std::tuple{&LoadSeries::least, "least", "smallest"}, std::tuple{&LoadSeries::largest, "largest", "largest"}}) {
    const auto of = [&, extreme = extreme](const LoadSeries& one) -> const LoadExtreme& { return one.*extreme; };
    table.numbers(key, title, unit_name(Quantity::force, units),
                  each(joints, [&](const LoadSeries& one) { return in_unit(of(one).value, Quantity::force, units); }),
                  format_of_extremes);
    table.numbers(std::string(key) + "_at", "at " + varied.name(), varied.unit_name(),
                  each(joints, [&](const LoadSeries& one) { return of(one).at / varied.unit(); }), format_of_extremes);
  }
  table.footnotes = {"sizes, of bars the tension; - where statics does not determine it"};
}

void add_link_extremes(Group& content, const VariedScene& varied, const std::vector<LoadSeries>& links) {
  const Units& units = varied.scene().units;
  Table& table = content.table("links", "Largest internal loads of links", Rows::list);
  table.words("name", "link", each(links, &LoadSeries::item));
  table.words("load", "load", each(links, &LoadSeries::key));
  table.numbers("value", "largest", "",
                each(links, [&](const LoadSeries& one) { return one.largest.value / one.dimension.unit(units); }),
                format_of_extremes);
  table.words("unit", "unit", each(links, [&](const LoadSeries& one) { return one.dimension.unit_name(units); }));
  table.numbers("at", "at " + varied.name(), varied.unit_name(),
                each(links, [&](const LoadSeries& one) { return one.largest.at / varied.unit(); }), format_of_extremes);
  table.numbers("s", "s", unit_name(Quantity::length, units),
                each(links, [&](const LoadSeries& one) { return in_unit(one.largest.s, Quantity::length, units); }),
                format_of_extremes);
  if (!links.empty()) table.footnotes = {"s: along the line of the link"};
}

void add_equilibria_loads(Group& content, const VariedScene& varied, const LoadsAlong& answer) {
  const std::vector<LoadsAt>& loads = answer.loads;
  const Units& units = varied.scene().units;
  Table& table = content.table("equilibria", "", Rows::columns, Verbosity::data);
  table.csv = !loads.empty();
  table.data("parameter", each(loads, [&](const LoadsAt& here) { return here.point.parameter / varied.unit(); })).unit =
      varied.unit_name();
  if (varied.is_driven()) {
    const double unit = varied.effort_dimension().unit(units);
    table.data("effort", each(loads, [&](const LoadsAt& here) { return here.point.effort / unit; })).unit =
        varied.effort_dimension().unit_name(units);
  }
  table.words("stability", "", each(loads, [&](const LoadsAt& here) {
                return answer.is_structure ? std::string("structure") : to_string(here.point.stability);
              }));
  const auto add = [&](const std::string& kind, const LoadSeries& one) {
    std::vector<double> values = one.values;
    for (double& value : values) value /= one.dimension.unit(units);
    table.data(fmt::format("{}.{}.{}", kind, one.item, one.key), std::move(values)).unit =
        one.dimension.unit_name(units);
  };
  for (const LoadSeries& one : answer.joints) add("reaction", one);
  for (const LoadSeries& one : answer.links) add("link", one);
}

/// The loads before and behind a snap are those of two poses that no equilibria connect.
std::string snap_in_words(const VariedScene& varied, const PathEvent& event) {
  const std::string unit = varied.unit_name().empty() ? "" : " " + varied.unit_name();
  return fmt::format("At {} = {}{} {}", varied.name(), significant(event.at.parameter / varied.unit(), force_digits),
                     unit,
                     event.landing ? "the mechanism snaps; the loads behind are those of where it lands."
                                   : "it loses its stability, and comes to rest nowhere.");
}

Line verdict_over_range(const VariedScene& varied, const LoadsAlong& answer) {
  const std::string unit = varied.unit_name().empty() ? "" : " " + varied.unit_name();
  const auto shown = [&](double si) { return significant(si / varied.unit(), force_digits); };
  const std::string range =
      fmt::format("{} = {} to {}{}", varied.name(), shown(varied.from()), shown(varied.to()), unit);
  if (answer.loads.empty()) {
    return bad(fmt::format("No loads over {}: {}", range,
                           sentence_of(answer.found.why.empty() ? to_string(answer.found.status) : answer.found.why)));
  }
  const std::string of = count(static_cast<int>(answer.loads.size()), "equilibrium", "equilibria");
  if (is_complete(answer) && answer.is_structure) {
    return good(fmt::format("Loads at {} over {}, in balance as a structure, in which nothing can move.",
                            count(static_cast<int>(answer.loads.size()), "value", "values"), range));
  }
  if (is_complete(answer)) return good(fmt::format("Loads in {} over {}, all proved.", of, range));
  std::string why = answer.found.why;
  for (const LoadsAt& here : answer.loads) {
    if (!why.empty()) break;
    if (!here.check.is_equilibrium()) why = here.check.objection;
    for (const LinkLoads& link : here.links) {
      if (why.empty() && !link.why.empty()) why = fmt::format("\"{}\": {}", link.name, link.why);
    }
  }
  if (why.empty() && answer.found.status != Path::Status::traced) why = to_string(answer.found.status);
  if (why.empty()) why = count(answer.found.unproved(), "point", "points") + " not proved";
  return bad(fmt::format("Loads in {} over {}, not complete: {}", of, range, sentence_of(why)));
}

}  // namespace

bool is_complete(const LoadsAlong& answer) {
  return answer.found.status == Path::Status::traced && answer.found.unproved() == 0 && !answer.loads.empty() &&
         std::all_of(answer.loads.begin(), answer.loads.end(),
                     [](const LoadsAt& here) { return here.check.is_equilibrium() && here.has_all_links(); });
}

Result loads_along_result(const VariedScene& varied, const LoadsAlong& answer,
                          const std::vector<std::string>& settings) {
  Result out = scene_result(varied.scene(), settings);
  out.verdict = verdict_over_range(varied, answer);
  for (const std::string& note : answer.found.notes) out.warnings.push_back(doubtful(note));
  for (const PathEvent& event : answer.found.events) {
    if (event.kind == PathEvent::Kind::snap) out.warnings.push_back(doubtful(snap_in_words(varied, event)));
  }
  Group& content = out.content;
  content.data("stress_unit", stress_unit(varied.scene().units));
  content.data("status", to_string(answer.found.status));
  content.data("why", answer.found.why);
  content.data("structure", answer.is_structure);
  Group& parameter = content.group("parameter", "", Verbosity::data);
  parameter.data("name", varied.name());
  parameter.data("from", varied.from() / varied.unit());
  parameter.data("to", varied.to() / varied.unit());
  parameter.data("unit", varied.unit_name());
  parameter.data("driven", varied.is_driven() ? Value(varied.driven_words()) : Value());
  if (varied.is_driven()) content.fact("driven", fmt::format("{}: {}", varied.name(), varied.driven_words()));
  add_joint_extremes(content, varied, answer.joints);
  add_link_extremes(content, varied, answer.links);
  add_equilibria_loads(content, varied, answer);
  return out;
}

std::vector<Panel> loads_along_panels(const VariedScene& varied, const LoadsAlong& answer) {
  constexpr std::size_t most_curves = 12;
  const Units& units = varied.scene().units;
  const std::string unit = varied.unit_name().empty() ? "" : " (" + varied.unit_name() + ")";
  const std::vector<double> x =
      each(answer.loads, [&](const LoadsAt& here) { return here.point.parameter / varied.unit(); });
  std::vector<Panel> panels;
  const auto add = [&](const std::string& title, const std::string& label, std::vector<LoadSeries> all) {
    const auto size = [](const LoadSeries& one) {
      return std::max(std::abs(one.least.value), std::abs(one.largest.value));
    };
    std::stable_sort(all.begin(), all.end(),
                     [&](const LoadSeries& a, const LoadSeries& b) { return size(a) > size(b); });
    if (all.size() > most_curves) all.resize(most_curves);
    if (all.empty()) return;
    Panel& panel = panels.emplace_back(Panel{.title = title, .x_label = varied.name() + unit, .y_label = label});
    for (LoadSeries& one : all) {
      for (double& value : one.values) value /= one.dimension.unit(units);
      panel.curves.push_back({.name = one.item, .x = x, .y = std::move(one.values)});
    }
  };
  add("joint forces", "force (" + unit_name(Quantity::force, units) + ")", answer.joints);
  std::vector<LoadSeries> moments = answer.links;
  std::erase_if(moments, [](const LoadSeries& one) { return one.key != "moment"; });
  add("largest bending moments of links", "moment (" + unit_name(Quantity::moment, units) + ")", std::move(moments));
  return panels;
}

}  // namespace poise::app
