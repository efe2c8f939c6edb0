#include "app/results/statics/loads.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/result/numbers.hpp"
#include "app/results/parts.hpp"
#include "app/results/statics/quantities.hpp"

namespace poise::app {
namespace {

constexpr Dimension stress = dimension::force * dimension::length.power(-2);

bool stands(const Equilibrium& equilibrium) { return equilibrium.found() || equilibrium.status == Status::checked; }

std::string how(const Equilibrium& equilibrium) {
  if (equilibrium.found()) return "in equilibrium, " + in_few_words(equilibrium);
  return equilibrium.why.find("structure") != std::string::npos ? "in balance as a structure, in which nothing can move"
                                                                : "in balance by free-body statics, not proved";
}

Line verdict(const LoadsAnswer& answer) {
  const Equilibrium& equilibrium = answer.equilibrium;
  if (!stands(equilibrium)) {
    return bad(fmt::format("No internal loads: no equilibrium, {}.", to_string(equilibrium.status)));
  }
  const auto known =
      std::count_if(answer.links.begin(), answer.links.end(), [](const LinkLoads& link) { return link.why.empty(); });
  const int links = static_cast<int>(answer.links.size());
  const std::string of = answer.is_complete() ? count(links, "link", "links")
                                              : fmt::format("{} of {}", known, count(links, "link", "links"));
  const std::string text = fmt::format("Internal loads of {}, {}.", of, how(equilibrium));
  return answer.is_complete() ? good(text) : doubtful(text);
}

/// What a reader must know of how a link was taken.
void warn(Result& result, const ScaledModel& model, const std::vector<LinkLoads>& links) {
  for (const LinkLoads& link : links) {
    const std::string& name = link.name;
    if (!link.why.empty()) {
      result.warnings.push_back(bad(fmt::format("No internal loads of \"{}\": {}.", name, link.why)));
    }
    for (const LinkAction& action : link.actions) {
      const bool is_weight = action.name == "weight" || action.name == "weight and inertia";
      if (action.arm == 0.0 && !is_weight) continue;
      const std::string place = with_unit(model, action.s, Quantity::length, 4);
      const std::string where = action.arm == 0.0
                                    ? fmt::format("at {} along its line", place)
                                    : fmt::format("{} beside its line, through a rigid arm at {} along it",
                                                  with_unit(model, action.arm, Quantity::length, 4), place);
      const std::string why =
          !is_weight ? ""
          : link.spread > 0.0
              ? fmt::format(" for what its moment of inertia leaves: {:.6g} kg of its mass are spread along the line",
                            link.spread)
              : ": its centre of mass is not the middle of its line, along which weight is spread otherwise";
      result.warnings.push_back(doubtful(fmt::format("The {} of \"{}\" acts {}{}.", action.name, name, where, why)));
    }
    const double stressed = std::max(link.tension.value, -link.compression.value);
    if (stressed > 0.01 * link.section.modulus) {
      result.warnings.push_back(
          doubtful(fmt::format("The strain of \"{}\" reaches {:.2g}: beyond what linear beam theory describes.", name,
                               stressed / link.section.modulus)));
    }
    constexpr double small = 0.05;
    if (link.deflection.value > small * link.length) {
      result.warnings.push_back(doubtful(
          fmt::format("The deflection of \"{}\" is {:.2g} of its length, so large that it changes the loads; they are "
                      "those of the rigid link.",
                      name, link.deflection.value / link.length)));
    }
    if (link.buckling_factor && *link.buckling_factor <= 1.0) {
      result.warnings.push_back(bad(fmt::format("\"{}\" buckles: its compression is {:.4g} times Euler's load.", name,
                                                1.0 / *link.buckling_factor)));
    }
  }
}

/// Shows no digits of a column's numbers beyond their radii, which are in its unit.
void limit_digits(Column& column, const std::vector<double>& radii) {
  for (std::size_t i = 0; i < column.numbers.size(); ++i) {
    column.texts.push_back(significant(column.numbers[i], column.format.digits, radii[i]));
  }
}

/// How far internal forces and moments of a link may be from the exact ones, SI, where those that act on it are known
/// to `force`, in all, of the mechanism's `size`: moments by arms no longer than twice that, stresses and deflections
/// by what beams make of these.
struct RadiiOfLink {
  RadiiOfLink(const LinkLoads& link, double all_forces, double size)
      : force(all_forces),
        moment(2.0 * size * force),
        stress(force / link.section.area + moment * link.section.height / link.section.second_moment),
        deflection(moment * link.length * link.length / (link.section.modulus * link.section.second_moment)) {}

  double force, moment, stress, deflection;
};

void add_links(Group& group, const ScaledModel& model, const std::vector<LinkLoads>& links, double radius) {
  const Units& units = model.scene().units;
  Table& table = group.table("links", "Largest internal loads", Rows::list);
  table.words("name", "link", each(links, [](const LinkLoads& link) { return link.name; }));
  const auto radii = [&](double RadiiOfLink::*which, double unit) {
    return each(links, [&](const LinkLoads& l) { return RadiiOfLink(l, radius, model.scales().length).*which / unit; });
  };
  const auto add = [&](const std::string& key, const std::string& title, const std::string& unit, double si_unit,
                       LargestOnLink LinkLoads::*which, double RadiiOfLink::*known_to) {
    const std::vector<double> values = each(links, [&](const LinkLoads& l) { return (l.*which).value; });
    std::vector<double> shown = values;
    for (double& value : shown) value /= si_unit;
    limit_digits(table.numbers(key, title, unit, std::move(shown),
                               {.style = Format::Style::significant, .digits = force_digits}),
                 radii(known_to, si_unit));
    table.data(key + "_at",
               in_unit(each(links, [&](const LinkLoads& l) { return (l.*which).s; }), Quantity::length, units));
  };
  const auto add_quantity = [&](const std::string& key, const std::string& title, Quantity quantity,
                                LargestOnLink LinkLoads::*which, double RadiiOfLink::*known_to) {
    add(key, title, unit_name(quantity, units), unit_value(quantity, units), which, known_to);
  };
  add_quantity("normal", "N", Quantity::force, &LinkLoads::normal, &RadiiOfLink::force);
  add_quantity("shear", "V", Quantity::force, &LinkLoads::shear, &RadiiOfLink::force);
  add_quantity("moment", "M", Quantity::moment, &LinkLoads::moment, &RadiiOfLink::moment);
  const std::string of_stress = stress.unit_name(units);
  add("tension", "tension", of_stress, stress.unit(units), &LinkLoads::tension, &RadiiOfLink::stress);
  add("compression", "compression", of_stress, stress.unit(units), &LinkLoads::compression, &RadiiOfLink::stress);
  // Flexible links are drawn and measured as they are bent.
  const auto of_rigid = [](const LinkLoads& l, double value) { return l.flexible ? NAN : value; };
  const auto add_of_rigid = [&](const std::string& key, Quantity quantity, auto&& value) {
    table.data(key, in_unit(each(links, [&](const LinkLoads& l) { return of_rigid(l, value(l)); }), quantity, units));
  };
  limit_digits(table.numbers("deflection", "deflection", unit_name(Quantity::length, units),
                             in_unit(each(links, [&](const LinkLoads& l) { return of_rigid(l, l.deflection.value); }),
                                     Quantity::length, units),
                             {.style = Format::Style::significant, .digits = force_digits}),
               radii(&RadiiOfLink::deflection, unit_value(Quantity::length, units)));
  add_of_rigid("deflection_at", Quantity::length, [](const LinkLoads& l) { return l.deflection.s; });
  add_of_rigid("turn_first", Quantity::angle, [](const LinkLoads& l) { return l.turn_first; });
  add_of_rigid("turn_last", Quantity::angle, [](const LinkLoads& l) { return l.turn_last; });
  Column& factor = table.numbers("buckling_factor", "buckling", "",
                                 each(links, [](const LinkLoads& l) { return or_gap(l.buckling_factor); }),
                                 {.style = Format::Style::significant, .digits = 4});
  factor.shown =
      std::any_of(links.begin(), links.end(), [](const LinkLoads& l) { return l.buckling_factor.has_value(); });
  table.data("length", in_unit(each(links, [](const LinkLoads& l) { return l.length; }), Quantity::length, units));
  table.data("imbalance", each(links, [&](const LinkLoads& l) { return of_rigid(l, l.imbalance); }));
  table.flags("flexible", each(links, &LinkLoads::flexible));
  table.footnotes = {
      "N: normal force, tension positive; V = dM/ds; M: bending moment, positive where it stretches the right of the "
      "line; stresses in the extreme fibres",
      "deflection: from bending alone, against the line through both ends of the link"};
  if (factor.shown) {
    table.footnotes.emplace_back(
        "buckling: Euler's load of the link between its two pins over its compression; of links that no other force "
        "acts on");
  }
}

void add_actions(Group& group, const ScaledModel& model, const std::vector<LinkLoads>& links, double radius) {
  struct Row {
    std::string link, name;
    double from, to, x, y, moment, arm;
  };
  std::vector<Row> rows;
  for (const LinkLoads& link : links) {
    for (const LinkAction& action : link.actions) {
      rows.push_back(
          {link.name, action.name, action.s, action.s, action.force.x, action.force.y, action.moment, action.arm});
    }
    for (const LineAction& action : link.line_actions) {
      const Vec2 whole = action.whole();
      rows.push_back({link.name, action.name, action.from, action.to, whole.x, whole.y, 0.0, 0.0});
    }
  }
  Table& table = group.table("actions", "What acts on them, along the axes of the link", Rows::list);
  table.words("link", "link", each(rows, &Row::link));
  table.words("name", "what", each(rows, &Row::name));
  add_column(table, model, "from", "from", Quantity::length, each(rows, &Row::from), force_digits);
  add_column(table, model, "to", "to", Quantity::length, each(rows, &Row::to), force_digits);
  const auto add = [&](const std::string& key, const std::string& title, Quantity quantity,
                       const std::vector<double>& si,
                       double known_to) { add_column(table, model, key, title, quantity, si, force_digits, known_to); };
  add("force[]", "Fx", Quantity::force, each(rows, &Row::x), radius);
  add("force[]", "Fy", Quantity::force, each(rows, &Row::y), radius);
  add("moment", "moment", Quantity::moment, each(rows, &Row::moment), 2.0 * model.scales().length * radius);
  table.data("arm", in_unit(each(rows, &Row::arm), Quantity::length, model.scene().units));
  table.footnotes = {"places along the line of the link; even loads act from one place to another"};
}

void add_diagrams(Group& group, const ScaledModel& model, const std::vector<BodyPose<double>>& poses,
                  const std::vector<LinkLoads>& links, int steps) {
  const Units& units = model.scene().units;
  std::vector<std::string> names;
  std::vector<LinkSample> samples;
  std::vector<LinkState> states;
  std::vector<Vec2> at;
  for (const LinkLoads& link : links) {
    for (const LinkSample& sample : link.sampled(steps)) {
      names.push_back(link.name);
      samples.push_back(sample);
      states.push_back(sample.state);
      at.push_back(poses[static_cast<std::size_t>(link.frame)].world(sample.state.at));
    }
  }
  Table& table = group.table("diagrams", "", Rows::list, Verbosity::data);
  table.csv = true;
  const std::string length = unit_name(Quantity::length, units);
  table.words("link", "", std::move(names));
  const auto add = [&](const std::string& key, Quantity quantity, const std::vector<double>& si) {
    table.data(key, in_unit(si, quantity, units)).unit = unit_name(quantity, units);
  };
  const auto of = [&](double LinkState::*member) { return each(states, member); };
  add("s", Quantity::length, each(samples, &LinkSample::s));
  add("x", Quantity::length, each(at, [](Vec2 p) { return p.x; }));
  add("y", Quantity::length, each(at, [](Vec2 p) { return p.y; }));
  add("normal", Quantity::force, of(&LinkState::normal));
  add("shear", Quantity::force, of(&LinkState::shear));
  add("moment", Quantity::moment, of(&LinkState::moment));
  for (const auto& [key, member] :
       {std::pair{"stress_left", &LinkState::stress_left}, std::pair{"stress_right", &LinkState::stress_right}}) {
    std::vector<double> values = of(member);
    for (double& value : values) value /= stress.unit(units);
    table.data(key, std::move(values)).unit = stress.unit_name(units);
  }
  add("deflection", Quantity::length, each(states, [](const LinkState& state) { return norm(state.deflection); }));
  add("turn", Quantity::angle, of(&LinkState::turn));
}

/// Tables and diagrams of all links, whose forces are in all known to `radius`; only data of those that have none.
void add_all(Group& content, const ScaledModel& model, const std::vector<BodyPose<double>>& poses,
             const std::vector<LinkLoads>& all, int steps, double radius) {
  const auto links = chosen_of(all, [](const LinkLoads& link) { return link.why.empty(); });
  add_links(content, model, links, radius);
  add_actions(content, model, links, radius);
  add_diagrams(content, model, poses, links, steps);
  const auto refused = chosen_of(all, [](const LinkLoads& link) { return !link.why.empty(); });
  Table& none = content.table("without", "", Rows::list, Verbosity::data);
  none.words("name", "", each(refused, [&](const LinkLoads& l) { return l.name; }));
  none.words("why", "", each(refused, &LinkLoads::why));
}

/// The sum of the proved distances of all reactions and forces of elements from the exact ones, N; moments over the
/// mechanism's size.
double radius_of_forces(const StaticModel& model, const Check& check) {
  double sum = 0.0;
  const auto add = [&](double radius) {
    if (std::isfinite(radius)) sum += radius;
  };
  for (const Reaction& reaction : check.reactions) {
    add(reaction.radius);
    add(reaction.moment_radius / model.scales().length);
  }
  for (std::size_t e = 0; e < check.element_forces.size(); ++e) {
    const bool is_moment = model.scene().elements[e].on.is_angle();
    add(check.element_forces[e].radius / (is_moment ? model.scales().length : 1.0));
  }
  return sum;
}

}  // namespace

bool LoadsAnswer::is_complete() const {
  return stands(equilibrium) &&
         std::all_of(links.begin(), links.end(), [](const LinkLoads& l) { return l.why.empty(); });
}

std::string stress_unit(const Units& units) { return stress.unit_name(units); }

Result loads_result(const StaticModel& model, const LoadsAnswer& answer, int steps,
                    const std::vector<SoughtQuantity>& show, const std::vector<std::string>& settings) {
  const Scene& scene = model.scene();
  Result out = scene_result(scene, settings);
  out.verdict = verdict(answer);
  warn(out, model, answer.links);
  warn_of_blades(out, scene);
  const Equilibrium& equilibrium = answer.equilibrium;
  Group& content = out.content;
  content.data("stress_unit", stress_unit(scene.units));
  content.data("status", to_string(equilibrium.status));
  content.data("stability", to_string(equilibrium.certificate.stability));
  content.data("why", equilibrium.why);
  const std::vector<BodyPose<double>> poses = model.poses(equilibrium.x);
  add_all(content, model, poses, answer.links, steps, radius_of_forces(model, equilibrium.check));
  if (stands(equilibrium) && !show.empty()) {
    std::vector<int> active;
    for (const Reaction& reaction : equilibrium.check.reactions) {
      if (reaction.of_stop()) active.push_back(reaction.stop);
    }
    const RestingPlace place = resting_place(model, equilibrium.x, active, -1, other_quantity);
    add_quantities(content, show, quantity_values(place, show), scene.units);
  }
  add_forces_on_bodies(content, model, poses, equilibrium.check);
  return out;
}

bool MovingLoadsAnswer::is_complete() const {
  return found.why.empty() && found.forces.balanced &&
         std::all_of(found.links.begin(), found.links.end(), [](const LinkLoads& l) { return l.why.empty(); });
}

Result loads_result(const MotionModel& model, const MovingLoadsAnswer& answer, int steps,
                    const std::vector<std::string>& settings) {
  const LoadsInMotion& found = answer.found;
  Result out = scene_result(model.scene(), settings);
  const auto known =
      std::count_if(found.links.begin(), found.links.end(), [](const LinkLoads& link) { return link.why.empty(); });
  const std::string of = count(static_cast<int>(found.links.size()), "link", "links");
  if (!found.why.empty()) {
    out.verdict = bad(fmt::format("No internal loads at t = {} s: {}.", answer.time, found.why));
  } else if (!found.forces.balanced) {
    out.verdict = bad(
        fmt::format("No internal loads at t = {} s: \"{}\" is not in balance.", answer.time, found.forces.worst_body));
  } else if (answer.is_complete()) {
    out.verdict = good(fmt::format("Internal loads of {}, in motion at t = {} s.", of, answer.time));
  } else {
    out.verdict = doubtful(fmt::format("Internal loads of {} of {}, in motion at t = {} s.", known, of, answer.time));
  }
  warn(out, model, found.links);
  Group& content = out.content;
  content.data("stress_unit", stress_unit(model.scene().units));
  content.data("time", answer.time);
  content.data("why", found.why);
  add_all(content, model, found.poses, found.links, steps, 0.0);
  if (found.why.empty()) {
    add_forces_on_bodies(content, model, {forces_on_bodies(at_time(model.scene(), answer.time), found.forces)});
  } else {
    content.data("forces_on_bodies", nullptr);
  }
  return out;
}

}  // namespace poise::app
