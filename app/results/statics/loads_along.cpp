#include "app/results/statics/loads_along.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "app/result/numbers.hpp"
#include "app/results/parts.hpp"
#include "app/results/statics/loads.hpp"
#include "statics/paths/path_words.hpp"

namespace poise::app {
namespace {

constexpr double no_load = std::numeric_limits<double>::quiet_NaN();
constexpr Dimension stress_of_links = dimension::force * dimension::length.power(-2);

/// A value along the path, of a joint or a link.
struct LoadSeries {
  std::string item, key, title;
  Dimension dimension{};
  std::vector<double> values, at_s;  ///< SI, not a number where there is none; of a link where on its line
  bool by_size = true;               ///< the largest is that by size; otherwise the smallest counts too

  std::size_t place(bool smallest) const {
    std::size_t best = values.size();
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (std::isnan(values[k])) continue;
      const double now = by_size ? std::abs(values[k]) : values[k];
      const double most = best == values.size() ? now : by_size ? std::abs(values[best]) : values[best];
      if (best == values.size() || (smallest ? now < most : now > most)) best = k;
    }
    return best;
  }
};

/// Whether a joint is between two parts of one flexible link.
bool is_within_link(const Scene& scene, const Joint& joint) {
  return std::any_of(scene.flexible_links.begin(), scene.flexible_links.end(), [&](const FlexibleLink& link) {
    const auto has = [&](int body) {
      return std::find(link.bodies.begin(), link.bodies.end(), body) != link.bodies.end();
    };
    return has(joint.a.body) && has(joint.b.body);
  });
}

/// The size of each joint's force; tension of a bar with its sign.
std::vector<LoadSeries> joint_series(const VariedScene& varied, const std::vector<LoadsAt>& loads) {
  std::vector<LoadSeries> out;
  const std::vector<Joint>& joints = varied.scene().joints;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (is_within_link(varied.scene(), joints[j])) continue;
    const bool is_bar = joints[j].keeps_length();
    LoadSeries one{joints[j].name, is_bar ? "axial" : "size", is_bar ? "tension" : "size", dimension::force, {}, {},
                   false};
    for (const LoadsAt& here : loads) {
      const auto found = std::find_if(here.check.reactions.begin(), here.check.reactions.end(),
                                      [&](const Reaction& r) { return r.joint == static_cast<int>(j); });
      const bool is_known = found != here.check.reactions.end() && found->determined;
      one.values.push_back(!is_known ? no_load : is_bar ? found->axial : norm(found->force));
    }
    out.push_back(std::move(one));
  }
  return out;
}

struct OfLink {
  const char *key, *title;
  LargestOnLink LinkLoads::*value;
  Dimension dimension;
};
constexpr std::array<OfLink, 6> of_link{{{"normal", "N", &LinkLoads::normal, dimension::force},
                                         {"shear", "V", &LinkLoads::shear, dimension::force},
                                         {"moment", "M", &LinkLoads::moment, dimension::torque},
                                         {"tension", "tension", &LinkLoads::tension, stress_of_links},
                                         {"compression", "compression", &LinkLoads::compression, stress_of_links},
                                         {"deflection", "deflection", &LinkLoads::deflection, dimension::length}}};

/// The largest loads of each link in each equilibrium.
std::vector<LoadSeries> link_series(const std::vector<LoadsAt>& loads) {
  std::vector<LoadSeries> out;
  const std::size_t links = loads.empty() ? 0 : loads.front().links.size();
  for (std::size_t l = 0; l < links; ++l) {
    for (const OfLink& of : of_link) {
      const LinkLoads& first = loads.front().links[l];
      if (first.flexible && of.value == &LinkLoads::deflection) continue;  // it is drawn as it is bent
      LoadSeries one{first.name, of.key, of.title, of.dimension, {}, {}};
      for (const LoadsAt& here : loads) {
        const LinkLoads& link = here.links[l];
        one.values.push_back(link.why.empty() ? (link.*of.value).value : no_load);
        one.at_s.push_back(link.why.empty() ? (link.*of.value).s : no_load);
      }
      out.push_back(std::move(one));
    }
  }
  return out;
}

double parameter_of_place(const VariedScene& varied, const std::vector<LoadsAt>& loads, std::size_t place) {
  return place < loads.size() ? loads[place].point.parameter / varied.unit() : no_load;
}

double value_of_place(const std::vector<double>& values, std::size_t place) {
  return place < values.size() ? values[place] : no_load;
}

void add_joint_extremes(Group& content, const VariedScene& varied, const std::vector<LoadsAt>& loads,
                        const std::vector<LoadSeries>& joints) {
  const Units& units = varied.scene().units;
  const std::string force = unit_name(Quantity::force, units);
  Table& table = content.table("joints", "Joint forces", Rows::list);
  table.words("name", "joint", each(joints, &LoadSeries::item));
  table.words("", "force", each(joints, &LoadSeries::title));
  const Format format{.style = Format::Style::significant, .digits = force_digits};
  for (const bool smallest : {true, false}) {
    const std::string key = smallest ? "least" : "largest", title = smallest ? "smallest" : "largest";
    table.numbers(key, title, force,
                  each(joints,
                       [&](const LoadSeries& one) {
                         return in_unit(value_of_place(one.values, one.place(smallest)), Quantity::force, units);
                       }),
                  format);
    table.numbers(
        key + "_at", "at " + varied.name(), varied.unit_name(),
        each(joints, [&](const LoadSeries& one) { return parameter_of_place(varied, loads, one.place(smallest)); }),
        format);
  }
  table.footnotes = {"sizes, of bars the tension; - where statics does not determine it"};
}

void add_link_extremes(Group& content, const VariedScene& varied, const std::vector<LoadsAt>& loads,
                       const std::vector<LoadSeries>& links) {
  const Units& units = varied.scene().units;
  const Format format{.style = Format::Style::significant, .digits = force_digits};
  Table& table = content.table("links", "Largest internal loads of links", Rows::list);
  table.words("name", "link", each(links, &LoadSeries::item));
  table.words("load", "load", each(links, &LoadSeries::key));
  table.numbers("value", "largest", "",
                each(links,
                     [&](const LoadSeries& one) {
                       return value_of_place(one.values, one.place(false)) / one.dimension.unit(units);
                     }),
                format);
  table.words("unit", "unit", each(links, [&](const LoadSeries& one) { return one.dimension.unit_name(units); }));
  table.numbers("at", "at " + varied.name(), varied.unit_name(),
                each(links, [&](const LoadSeries& one) { return parameter_of_place(varied, loads, one.place(false)); }),
                format);
  table.numbers("s", "s", unit_name(Quantity::length, units),
                each(links,
                     [&](const LoadSeries& one) {
                       return in_unit(value_of_place(one.at_s, one.place(false)), Quantity::length, units);
                     }),
                format);
  if (!links.empty()) table.footnotes = {"s: along the line of the link"};
}

void add_equilibria_loads(Group& content, const VariedScene& varied, const std::vector<LoadsAt>& loads,
                          bool is_structure, const std::vector<LoadSeries>& joints,
                          const std::vector<LoadSeries>& links) {
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
                return is_structure ? std::string("structure") : to_string(here.point.stability);
              }));
  const auto add = [&](const std::string& kind, const LoadSeries& one) {
    std::vector<double> values = one.values;
    for (double& value : values) value /= one.dimension.unit(units);
    table.data(fmt::format("{}.{}.{}", kind, one.item, one.key), std::move(values)).unit =
        one.dimension.unit_name(units);
  };
  for (const LoadSeries& one : joints) add("reaction", one);
  for (const LoadSeries& one : links) add("link", one);
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
  const std::vector<LoadSeries> joints = joint_series(varied, answer.loads), links = link_series(answer.loads);
  add_joint_extremes(content, varied, answer.loads, joints);
  add_link_extremes(content, varied, answer.loads, links);
  add_equilibria_loads(content, varied, answer.loads, answer.is_structure, joints, links);
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
    const auto largest = [](const LoadSeries& one) { return std::abs(value_of_place(one.values, one.place(false))); };
    std::stable_sort(all.begin(), all.end(),
                     [&](const LoadSeries& a, const LoadSeries& b) { return largest(a) > largest(b); });
    if (all.size() > most_curves) all.resize(most_curves);
    if (all.empty()) return;
    Panel& panel = panels.emplace_back(Panel{.title = title, .x_label = varied.name() + unit, .y_label = label});
    for (LoadSeries& one : all) {
      for (double& value : one.values) value /= one.dimension.unit(units);
      panel.curves.push_back({.name = one.item, .x = x, .y = std::move(one.values)});
    }
  };
  add("joint forces", "force (" + unit_name(Quantity::force, units) + ")", joint_series(varied, answer.loads));
  std::vector<LoadSeries> moments = link_series(answer.loads);
  std::erase_if(moments, [](const LoadSeries& one) { return one.key != "moment"; });
  add("largest bending moments of links", "moment (" + unit_name(Quantity::moment, units) + ")", std::move(moments));
  return panels;
}

}  // namespace poise::app
