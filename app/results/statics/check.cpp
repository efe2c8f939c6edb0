#include "app/results/statics/check.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "app/result/numbers.hpp"
#include "app/results/parts.hpp"
#include "model/controllers.hpp"
#include "model/dependent_number.hpp"
#include "model/expression.hpp"
#include "model/input_error.hpp"
#include "model/one_line.hpp"
#include "model/parameters.hpp"
#include "motion/kinematics.hpp"
#include "statics/model/readings.hpp"
#include "statics/quantities/quantity.hpp"

namespace poise::app {
namespace {

Line verdict(const Mobility& mobility, const std::optional<Freedoms>& freedoms) {
  if (!mobility.assembled) return bad("Cannot be assembled: " + mobility.gap + ".");
  if (mobility.freedoms == 0) {
    return good(
        "All loops close; a structure: no degree of freedom that carries a load. poise forces and poise loads "
        "find its forces.");
  }
  if (freedoms && freedoms->is_shaky()) return doubtful("All loops close; " + shaky_in_words(*freedoms) + ".");
  return good(fmt::format("All loops close; {}.", count(mobility.freedoms, "degree of freedom", "degrees of freedom")));
}

void add_bodies(Group& group, const Scene& scene) {
  const std::set<int> states = bodies_of_states(scene);
  std::vector<Body> moving;
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    if (!states.contains(static_cast<int>(i))) moving.push_back(scene.bodies[i]);
  }
  const bool any_mass = std::any_of(moving.begin(), moving.end(), [](const Body& body) { return body.mass > 0; });
  const std::string length = unit_name(Quantity::length, scene.units);
  const auto in_length = [&](double si) { return in_unit(si, Quantity::length, scene.units); };
  Table& table = group.table("bodies", "Bodies", Rows::list);
  table.words("name", "name", each(moving, &Body::name));
  const auto add = [&](const std::string& key, const std::string& title, const std::string& unit, auto value) {
    table.numbers(key, title, unit, each(moving, value)).shown = any_mass;
  };
  add("mass", "mass", unit_name(Quantity::mass, scene.units),
      [&](const Body& body) { return in_unit(body.mass, Quantity::mass, scene.units); });
  add("center[]", "centre x", length, [&](const Body& body) { return in_length(body.center.x); });
  add("center[]", "centre y", length, [&](const Body& body) { return in_length(body.center.y); });
  add("inertia", "inertia", dimension::inertia.unit_name(scene.units),
      [&](const Body& body) { return body.inertia / dimension::inertia.unit(scene.units); });
  table.words("points", "points", each(moving, [](const Body& body) {
                return fmt::format("{}", fmt::join(each(body.points, &NamedPoint::name), ", "));
              }));
}

void add_joints(Group& group, const Scene& scene) {
  Table& table = group.table("joints", "Joints", Rows::list);
  table.words("name", "name", each(scene.joints, &Joint::name));
  table.words("kind", "kind", each(scene.joints, [](const Joint& joint) { return words_of_key(joint.traits().key); }));
  table.words("from", "from", each(scene.joints, [&](const Joint& joint) { return scene.name_of(joint.a); }));
  table.words("to", "to", each(scene.joints, [&](const Joint& joint) { return scene.name_of(joint.b); }));
}

/// "A.P, A.Q", "the arc A.P to A.Q around A.O".
std::string outline_in_words(const Scene& scene, const Outline& outline) {
  const auto name = [&](std::size_t k) { return scene.name_of(outline.points[k]); };
  if (outline.form != Outline::Form::polygon) {
    return fmt::format("the arc {} to {} around {}", name(1), name(2), name(0));
  }
  constexpr std::size_t most = 4;
  if (outline.points.size() > most)
    return fmt::format("{} points {} to {}", outline.points.size(), name(0), name(outline.points.size() - 1));
  std::string out = name(0);
  for (std::size_t k = 1; k < outline.points.size(); ++k) out += ", " + name(k);
  return out;
}

/// What a measure is taken of: "A.P to B.Q", "crank against ground".
std::string measure_in_words(const Scene& scene, const Measure& on) {
  switch (on.kind) {
    case Measure::Kind::angle:
      return scene.bodies[on.body_b].name + " against " + scene.bodies[on.body_a].name;
    case Measure::Kind::distance:
      return scene.name_of(on.a) + " to " + scene.name_of(on.b);
    case Measure::Kind::travel:
      return "travel of " + scene.joints[on.joint].name;
    case Measure::Kind::x:
      return "x of " + scene.name_of(on.b);
    case Measure::Kind::y:
      return "y of " + scene.name_of(on.b);
    case Measure::Kind::component:
      return fmt::format("{} to {} along [{}, {}]", scene.name_of(on.a), scene.name_of(on.b),
                         significant(on.axis.x, force_digits), significant(on.axis.y, force_digits));
    case Measure::Kind::rope: {
      std::string over;
      for (const RopeContact& contact : on.contacts) over += (over.empty() ? "" : ", ") + scene.name_of(contact.at);
      return "rope over " + over;
    }
    case Measure::Kind::clearance:
      return fmt::format("clearance of {} from {}", scene.name_of(on.b), outline_in_words(scene, on.outline));
    case Measure::Kind::along_outline:
      return fmt::format("way of {} along {}", scene.name_of(on.b), outline_in_words(scene, on.outline));
    case Measure::Kind::slip_on_cam:
      return fmt::format("slip of {} on the {}", scene.name_of(on.b),
                         scene.stops[static_cast<std::size_t>(on.stop)].title());
    case Measure::Kind::sum:
      break;
  }
  std::string sum;
  for (const Measure::Term& term : on.terms) {
    sum += (sum.empty() ? "" : " + ") + std::string(term.profile ? "profile of " : "") +
           measure_in_words(scene, term.measure);
  }
  return "sum of " + sum;
}

/// The numbers of every item of one kind: "stiffness 400 N/mm, free_length 14 mm".
std::vector<std::string> numbers_of_items(const Scene& scene, Owner owner, std::size_t items) {
  std::vector<std::string> out(items);
  std::vector<int> points_of_curves(items);
  for (const ParameterRow& row : parameter_table(scene)) {
    const std::optional<double> si = row.place.owner == owner ? value_at(scene, row.place) : std::nullopt;
    if (!si) continue;
    std::string& text = out[static_cast<std::size_t>(row.place.item)];
    const bool is_last = row.path.parts[2].empty() || owner == Owner::time;
    const std::string_view key = row.path.parts[is_last ? 3 : 2];
    if (key.starts_with("curve.")) {
      if (key.ends_with(".x")) ++points_of_curves[static_cast<std::size_t>(row.place.item)];
      continue;
    }
    const std::string unit = row.dimension.unit_name(scene.units);
    text +=
        fmt::format("{}{}{}{}{}{}", text.empty() ? "" : ", ", key, key.empty() ? "" : " ",
                    significant(*si / row.dimension.unit(scene.units), force_digits), unit.empty() ? "" : " ", unit);
  }
  for (std::size_t i = 0; i < items; ++i) {
    if (points_of_curves[i] == 0) continue;
    out[i] += fmt::format("{}curve of {} points", out[i].empty() ? "" : ", ", points_of_curves[i]);
  }
  return out;
}

void add_elements(Group& group, const Scene& scene) {
  Table& table = group.table("elements", "Springs, dampers and other force elements", Rows::list);
  table.words("name", "name", each(scene.elements, &Element::name));
  table.words("kind", "kind", each(scene.elements, &Element::family));
  table.words("on", "on", each(scene.elements, [&](const Element& e) -> std::string {
                if (e.feedback && e.feedback->sets) return e.feedback->sets->path;
                return e.feedback && !e.feedback->acts ? "nothing" : measure_in_words(scene, e.on);
              }));
  table.words("numbers", "numbers", numbers_of_items(scene, Owner::element, scene.elements.size()));
}

void add_loads(Group& group, const Scene& scene) {
  struct Load {
    std::string name, on, value;
  };
  std::vector<Load> loads;
  for (const Force& force : scene.forces) {
    const Dimension dimension = force.numbers()[0].dimension;
    const auto part = [&](double si) { return significant(si / dimension.unit(scene.units), force_digits); };
    const std::string follows = force.follows < 0 ? "" : ", follows " + scene.bodies[force.follows].name;
    const auto pair = [](const std::string& x, const std::string& y) { return fmt::format("[{}, {}]", x, y); };
    const std::string unit = dimension.unit_name(scene.units);
    const std::string value =
        force.has_direction_of_its_own()
            ? fmt::format("{} {} along {}", part(force.size()), unit,
                          pair(significant(force.along.x, force_digits), significant(force.along.y, force_digits)))
            : fmt::format("{} {}", pair(part(force.vector.x), part(force.vector.y)), unit);
    loads.push_back(
        {force.name, scene.name_of(force.at) + (force.to ? " to " + scene.name_of(*force.to) : ""), value + follows});
  }
  const std::vector<std::string> torques = numbers_of_items(scene, Owner::torque, scene.torques.size());
  for (std::size_t i = 0; i < scene.torques.size(); ++i) {
    loads.push_back({scene.torques[i].name, scene.bodies[scene.torques[i].body].name, torques[i]});
  }
  Table& table = group.table("loads", "Loads", Rows::list);
  table.words("name", "name", each(loads, &Load::name));
  table.words("on", "on", each(loads, &Load::on));
  table.words("value", "value", each(loads, &Load::value));
}

/// Adds an item to those that use its named numbers; both components of a load have one function of time.
void add_uses(const DependentNumber& one, std::vector<std::string>& uses) {
  for (const int used : one.expression.uses()) {
    std::string& text = uses[static_cast<std::size_t>(used)];
    if ((", " + text + ", ").find(", " + one.item + ", ") != std::string::npos) continue;
    text += (text.empty() ? "" : ", ") + one.item;
  }
}

/// The first of a list in words, and how many more there are.
std::string first_of_many(const std::string& list) {
  constexpr int most = 2;
  const auto commas = static_cast<int>(std::count(list.begin(), list.end(), ','));
  if (commas < most) return list;
  std::size_t end = 0;
  for (int k = 0; k < most; ++k) end = list.find(',', end + 1);
  return fmt::format("{} and {} more", list.substr(0, end), commas + 1 - most);
}

/// The named numbers, and the items whose expressions use each.
void add_named(Result& out, const Scene& scene) {
  std::vector<std::string> expressions(scene.named_values.size()), uses(scene.named_values.size());
  if (scene.dependents) {
    for (const DependentNumber& one : *scene.dependents) {
      if (one.at.place.owner == Owner::number) {
        expressions[static_cast<std::size_t>(one.at.place.item)] = one.expression.text();
      }
      add_uses(one, uses);
      if (!one.factor) continue;
      for (const DependentNumber& in_time : one.factor->numbers) add_uses(in_time, uses);
    }
  }
  Table& table = out.content.table("numbers", "Numbers with names", Rows::list);
  table.words("name", "name", each(scene.named_values, &SceneNumber::name));
  table.numbers("value", "value", "", each(scene.named_values, &SceneNumber::value));
  table.words("expression", "expression", expressions);
  table.words("used_by", "", uses).shown = false;
  table.words("", "used by", each(uses, first_of_many));
  for (std::size_t i = 0; i < uses.size(); ++i) {
    if (!uses[i].empty()) continue;
    out.warnings.push_back(doubtful(fmt::format("numbers.{} is used by nothing", scene.named_values[i].name)));
  }
}

/// The quantities that the scene gives names.
void add_outputs(Group& content, const Scene& scene) {
  const std::vector<SoughtQuantity> outputs = outputs_of(scene);
  Table& table = content.table("outputs", "Outputs", Rows::list);
  table.words("name", "name", each(outputs, &SoughtQuantity::name));
  table.words("quantity", "quantity", each(scene.outputs, &SceneOutput::text));
  table.words("unit", "unit",
              each(outputs, [&](const SoughtQuantity& one) { return one.dimension.unit_name(scene.units); }));
}

/// Numbers of drives: "start 0 deg, rate 2 deg/s, ...", or of the function of time that one follows, "ramp: from 0 deg,
/// ...".
std::vector<std::string> motions_of_drives(const Scene& scene) {
  std::vector<std::string> out = numbers_of_items(scene, Owner::drive, scene.drives.size());
  const std::vector<std::string> functions = numbers_of_items(scene, Owner::time, scene.time_functions.size());
  for (std::size_t f = 0; f < functions.size(); ++f) {
    const TimeFunction& function = scene.time_functions[f];
    if (function.of != TimeFunction::Of::drive) continue;
    // The table of functions has those of which only some numbers are named.
    const bool is_long =
        std::holds_alternative<FormulaInTime>(function.law) || std::holds_alternative<ComposedInTime>(function.law);
    out[static_cast<std::size_t>(function.item)] =
        std::string(function.kind()) + (functions[f].empty() || is_long ? "" : ": " + functions[f]);
  }
  return out;
}

/// "0.1*sin(w*t)", "sine", "ramp + 2*t", "t^2 until 1 s, then ramp".
std::string law_in_words(const TimeLaw& law) {
  if (const auto* const formula = std::get_if<FormulaInTime>(&law)) return formula->expression->text();
  const auto* const composed = std::get_if<ComposedInTime>(&law);
  if (composed == nullptr) return std::string(law.kind());
  using How = ComposedInTime::How;
  std::string out;
  for (std::size_t k = 0; k < composed->parts.size(); ++k) {
    const std::string part = law_in_words(composed->parts[k]);
    if (composed->how == How::product)
      out += (k > 0 ? " * (" : "(") + part + ")";
    else
      out += (k == 0 ? "" : composed->how == How::sum ? " + " : ", then ") + part;
    if (composed->how == How::piecewise && k < composed->own.size()) {
      out += " until " + significant(composed->own[k], force_digits) + " s";
    }
  }
  if (composed->how == How::integral) {
    return (composed->order == 1 ? "of the velocity " : "of the acceleration ") + out;
  }
  return out;
}

/// What a function of time is of, as in the paths of its numbers: "load F", "spring s.stiffness", "frame y".
std::string owner_in_words(const Scene& scene, const TimeFunction& function) {
  const std::string name(name_of(scene, function));
  switch (function.of) {
    case TimeFunction::Of::drive:
      return "drive " + name;
    case TimeFunction::Of::element: {
      const Element& element = scene.elements[static_cast<std::size_t>(function.item)];
      const Number& number = numbers_of(element.law)[static_cast<std::size_t>(function.part)];
      return element.family() + " " + name + ", " + std::string(number.key_on(&element.on));
    }
    case TimeFunction::Of::frame:
      return "frame, " +
             std::string(function.order == 2   ? "place "
                         : function.order == 1 ? "velocity "
                                               : "acceleration ") +
             name;
    default:
      return "load " + name;
  }
}

void add_functions_of_time(Group& group, const Scene& scene) {
  const std::vector<TimeFunction>& functions = scene.time_functions;
  const std::vector<std::string> numbers = numbers_of_items(scene, Owner::time, functions.size());
  std::vector<std::size_t> all;
  for (std::size_t f = 0; f < functions.size(); ++f) all.push_back(f);
  Table& table = group.table("functions_of_time", "Functions of time", Rows::list);
  table.words("of", "of", each(functions, [&](const TimeFunction& one) { return owner_in_words(scene, one); }));
  table.words("function", "function", each(functions, [](const TimeFunction& one) { return law_in_words(one.law); }));
  table.words("numbers", "numbers", each(all, [&](std::size_t f) { return numbers[f]; }));
}

void add_stops_and_drives(Group& group, const Scene& scene, const Scene& moving) {
  const auto range = [&](const Stop& stop) {
    const Quantity quantity = quantity_of(stop.on);
    const auto limit = [&](double si) {
      return std::isfinite(si) ? significant(in_unit(si, quantity, scene.units), force_digits) : std::string("any");
    };
    return fmt::format("{} to {} {}", limit(stop.min), limit(stop.max), unit_name(quantity, scene.units));
  };
  const auto is_plain = [](const Stop& stop) { return stop.table == "stop"; };
  std::vector<Stop> plain;
  std::copy_if(scene.stops.begin(), scene.stops.end(), std::back_inserter(plain), is_plain);
  Table& stops = group.table("stops", "Stops", Rows::list);
  stops.words("name", "name", each(plain, &Stop::name));
  stops.words("on", "on", each(plain, [&](const Stop& stop) { return measure_in_words(scene, stop.on); }));
  stops.words("range", "range", each(plain, range));
  const std::vector<std::string> numbers = numbers_of_items(scene, Owner::coupling, scene.stops.size());
  std::vector<std::size_t> couplings;
  for (std::size_t i = 0; i < scene.stops.size(); ++i) {
    if (!is_plain(scene.stops[i])) couplings.push_back(i);
  }
  Table& coupled = group.table("couplings", "Couplings, cams and ropes", Rows::list);
  coupled.words("name", "name", each(couplings, [&](std::size_t i) { return scene.stops[i].name; }));
  coupled.words("kind", "kind", each(couplings, [&](std::size_t i) { return scene.stops[i].family(); }));
  coupled.words("on", "on", each(couplings, [&](std::size_t i) { return measure_in_words(scene, scene.stops[i].on); }));
  coupled.words("numbers", "numbers", each(couplings, [&](std::size_t i) { return numbers[i]; }));
  Table& drives = group.table("drives", "Drives", Rows::list);
  drives.words("name", "name", each(scene.drives, &Drive::name));
  drives.words("on", "on", each(scene.drives, [&](const Drive& drive) { return measure_in_words(scene, drive.on); }));
  drives.words("numbers", "numbers", motions_of_drives(moving));
  if (scene.blades.empty()) return;
  Table& blades = group.table("blades", "Blades", Rows::list);
  blades.words("name", "name", each(scene.blades, &Blade::name));
  blades.words("at", "at", each(scene.blades, [&](const Blade& blade) { return scene.name_of(blade.at); }));
  blades.words("on", "on", each(scene.blades, [&](const Blade& blade) {
                 return scene.bodies[static_cast<std::size_t>(blade.on)].name;
               }));
  blades.words("numbers", "numbers", numbers_of_items(scene, Owner::blade, scene.blades.size()));
}

/// Where the start is beyond a stop, and how far closing the loops moves what the scene guesses.
void tell_of_start(Result& out, const StaticModel& model, const Mobility& mobility) {
  const Scene& scene = model.scene();
  const std::vector<double> guess = model.start();
  const Readings readings = read_off(model, guess);
  for (std::size_t i = 0; i < scene.stops.size(); ++i) {
    const Stop& stop = scene.stops[i];
    const double value = readings.stops[i];
    if (stop.table != "stop" || !(value < stop.min || value > stop.max)) continue;
    const Quantity quantity = quantity_of(stop.on);
    const bool is_above = value > stop.max;
    const double beyond = is_above ? value - stop.max : stop.min - value;
    constexpr double rounding = 1e-9;
    if (beyond <= rounding * (quantity == Quantity::angle ? 1.0 : model.scales().length)) continue;
    constexpr int digits = 4;
    out.warnings.push_back(
        doubtful(fmt::format("The start is beyond stop \"{}\": {}, {} {} its {} of {}.", stop.name,
                             with_unit(model, value, quantity, digits), with_unit(model, beyond, quantity, digits),
                             is_above ? "above" : "below", is_above ? "max" : "min",
                             with_unit(model, is_above ? stop.max : stop.min, quantity, digits))));
  }
  if (!mobility.assembled) return;
  std::vector<std::size_t> moved;
  for (std::size_t i = 0; i < guess.size(); ++i) {
    constexpr double visible = 1e-3;  // rad, mechanism sizes
    if (std::abs(mobility.x[i] - guess[i]) > visible) moved.push_back(i);
  }
  std::stable_sort(moved.begin(), moved.end(), [&](std::size_t a, std::size_t b) {
    return std::abs(mobility.x[a] - guess[a]) > std::abs(mobility.x[b] - guess[b]);
  });
  const std::vector<double> from = shown_coordinates(model, guess), to = shown_coordinates(model, mobility.x);
  constexpr std::size_t most = 3;
  std::vector<std::string> words;
  for (const std::size_t i : moved) {
    if (words.size() == most) break;
    const Coordinate& coordinate = model.layout().coordinates[i];
    const auto shown = [&](double si) { return with_unit(model, si, quantity_of(coordinate), 4); };
    words.push_back(fmt::format("{} from {} to {}", coordinate.name, shown(from[i]), shown(to[i])));
  }
  if (words.empty()) return;
  const std::size_t others = moved.size() - words.size();
  if (others > 0) words.push_back(count(static_cast<int>(others), "more coordinate", "more coordinates"));
  out.content.fact("start", "closing the loops moves " + listed(words));
}

/// Limits of stops that a mechanism of one freedom does not reach: driven towards them, past its other stops, it comes
/// to a dead centre first.
void tell_of_limits(Result& out, const StaticModel& model, const Mobility& mobility) {
  const Scene& scene = model.scene();
  if (!mobility.assembled || mobility.freedoms != 1) return;
  const auto is_plain = [](const Stop& stop) { return stop.table == "stop"; };
  Scene free = scene;
  std::erase_if(free.stops, is_plain);
  std::vector<std::string> words;
  const Readings readings = read_off(model, mobility.x);
  for (std::size_t i = 0; i < scene.stops.size(); ++i) {
    const Stop& stop = scene.stops[i];
    if (!is_plain(stop)) continue;
    for (const bool is_max : {false, true}) {
      const double limit = is_max ? stop.max : stop.min;
      if (!std::isfinite(limit) || (is_max ? limit <= readings.stops[i] : limit >= readings.stops[i])) continue;
      KinematicsResult driven;
      try {
        driven = sweep(free, {{stop.name, readings.stops[i], limit, stop.on}}, {.most_steps = 2000});
      } catch (const InputError&) {
        continue;  // its measure does not determine the motion, of which then nothing is said
      }
      if (driven.complete || driven.singular.empty()) continue;
      const SingularPose& last = driven.singular.back();
      if (last.kind != SingularPose::Kind::dead_centre || last.before_range) continue;
      const Quantity quantity = quantity_of(stop.on);
      constexpr int digits = 4;
      words.push_back(fmt::format("{} of \"{}\", {}, is not reached from the start: the {} turns back at {}",
                                  is_max ? "max" : "min", stop.name, with_unit(model, limit, quantity, digits),
                                  quantity == Quantity::angle ? "angle" : "length",
                                  with_unit(model, last.drive.front(), quantity, digits)));
    }
  }
  if (!words.empty()) out.content.fact("limits", fmt::format("{}", fmt::join(words, "; ")));
}

}  // namespace

Result check_result(const StaticModel& model, const Mobility& mobility, const Scene& moving,
                    const std::vector<std::string>& settings) {
  const Scene& scene = model.scene();
  Result out = scene_result(scene, settings);
  std::optional<Freedoms> freedoms;
  if (mobility.assembled) freedoms = freedoms_at(model, mobility.x, mobility.closures - mobility.rank);
  out.verdict = verdict(mobility, freedoms);
  Group& content = out.content;
  content.data("assembled", mobility.assembled);
  content.data("gap", mobility.gap);
  for (const auto& [key, number] :
       {std::pair{"moving_bodies", mobility.bodies}, std::pair{"moving_joints", mobility.joints},
        std::pair{"coordinates", mobility.coordinates}, std::pair{"closure_equations", mobility.closures},
        std::pair{"rank", mobility.rank}, std::pair{"degrees_of_freedom", mobility.freedoms},
        std::pair{"gruebler", mobility.gruebler}}) {
    content.data(key, number);
  }
  content.data("finite_degrees_of_freedom", freedoms ? freedoms->finite : std::nullopt);
  content.data("finite_known_by", to_string(freedoms ? freedoms->by : Freedoms::By::nothing));
  content.fact("mechanism", count(mobility.bodies, "moving body", "moving bodies") + ", " +
                                count(mobility.joints, "joint", "joints"));
  content.fact("model", fmt::format("{}, {} of rank {}", count(mobility.coordinates, "coordinate", "coordinates"),
                                    count(mobility.closures, "closure equation", "closure equations"), mobility.rank));
  content.fact(
      "mobility",
      fmt::format("{}{}; counting bodies and joints (Gruebler) gives {}",
                  mobility.freedoms > 0 ? count(mobility.freedoms, "degree of freedom", "degrees of freedom")
                                        : "no degree of freedom that carries a load",
                  freedoms && freedoms->is_shaky() ? fmt::format(", {} of finite motion", *freedoms->finite) : "",
                  mobility.gruebler),
      mobility.freedoms > 0 ? Tone::plain : Tone::doubtful);
  tell_of_start(out, model, mobility);
  tell_of_limits(out, model, mobility);
  content.fact("constraints",
               mobility.redundant.empty() ? "no constraint repeats or contradicts another"
               : mobility.assembled       ? "some constraints are redundant"
                                          : "some constraints are redundant or conflict",
               mobility.redundant.empty() ? Tone::plain : Tone::doubtful);
  const std::string acceleration = dimension::acceleration.unit_name(scene.units);
  content.data("gravity", std::vector<double>{in_unit(scene.gravity.x, Quantity::length, scene.units),
                                              in_unit(scene.gravity.y, Quantity::length, scene.units)});
  content.fact("gravity", norm(scene.gravity) == 0.0
                              ? "none"
                              : fmt::format("[{}, {}] {}, {} m/s²",
                                            significant(in_unit(scene.gravity.x, Quantity::length, scene.units), 6),
                                            significant(in_unit(scene.gravity.y, Quantity::length, scene.units), 6),
                                            acceleration, significant(norm(scene.gravity), 4)));
  content.list("redundant_joints", mobility.assembled ? "Redundant joints" : "Redundant or conflicting joints",
               mobility.redundant);
  add_named(out, scene);
  add_outputs(content, scene);
  add_bodies(content, scene);
  add_joints(content, scene);
  add_elements(content, scene);
  add_loads(content, scene);
  add_stops_and_drives(content, scene, moving);
  add_functions_of_time(content, moving);
  content.list("kept", "Coordinates of the static model, and why", mobility.kept);
  content.list("dropped", "Left out of statics", mobility.dropped);
  return out;
}

}  // namespace poise::app
