#include "app/results/motion/modes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "app/result/numbers.hpp"
#include "app/results/parts.hpp"
#include "model/joint_friction.hpp"

namespace poise::app {
namespace {

using Kind = Vibration::Kind;

constexpr int frequency_digits = 10;
constexpr int damping_digits = 6;
// Coordinates of a shape that are shown, and the smallest part shown.
constexpr std::size_t shown_parts = 4;
constexpr double smallest_part = 0.005;

const char* name_of(Kind kind) {
  switch (kind) {
    case Kind::oscillates:
      return "oscillates";
    case Kind::decays:
      return "decays";
    case Kind::neutral:
      return "neutral";
    case Kind::diverges:
      return "diverges";
    case Kind::flutters:
      return "flutters";
  }
  return "";
}

Tone tone_of_kind(Kind kind) {
  if (kind == Kind::diverges || kind == Kind::flutters) return Tone::bad;
  return kind == Kind::neutral ? Tone::doubtful : Tone::plain;
}

/// "obd +1.00, fa +0.93": parts in rad and mechanism sizes, the largest 1; of a complex shape size and phase.
std::string shape_in_words(const MotionModel& model, const Vibration& mode) {
  const Layout& layout = model.layout();
  std::vector<std::complex<double>> part = mode.shape;
  for (std::size_t i = static_cast<std::size_t>(layout.angles); i < part.size(); ++i) part[i] /= model.scales().length;
  std::vector<std::size_t> order(part.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return std::abs(part[a]) > std::abs(part[b]); });
  const bool is_real = std::all_of(part.begin(), part.end(), [](const auto& p) { return p.imag() == 0.0; });
  std::string text;
  for (std::size_t k = 0; k < std::min(shown_parts, order.size()); ++k) {
    const std::complex<double> p = part[order[k]] / std::abs(part[order[0]]);
    if (!(std::abs(p) >= smallest_part)) break;
    if (k > 0) text += ", ";
    text += layout.coordinates[order[k]].name;
    text += is_real ? fmt::format(" {:+.2f}", p.real())
                    : fmt::format(" {:.2f} at {:.0f} deg", std::abs(p), std::arg(p) * 180 / M_PI + 0.0);
  }
  return text;
}

Line verdict(const ModesAnswer& answer) {
  if (!answer.equilibrium.found()) {
    return bad("No equilibrium found about which it could oscillate: " + answer.equilibrium.why);
  }
  const Modes& modes = answer.modes;
  if (!modes.known) return bad("In equilibrium, but without small motions: " + modes.why + ".");
  const auto number = [&](Kind kind) {
    return static_cast<int>(std::count_if(modes.vibrations.begin(), modes.vibrations.end(),
                                          [&](const Vibration& v) { return v.kind == kind; }));
  };
  std::vector<std::string> unstable;
  if (number(Kind::diverges) > 0) unstable.push_back(count(number(Kind::diverges), "mode diverges", "modes diverge"));
  if (number(Kind::flutters) > 0) unstable.push_back(count(number(Kind::flutters), "mode flutters", "modes flutter"));
  if (!unstable.empty()) return bad("Unstable equilibrium: " + listed(unstable) + ".");
  const std::string all = count(static_cast<int>(modes.vibrations.size()), "mode", "modes");
  if (number(Kind::neutral) > 0) {
    return doubtful(
        fmt::format("Neutral equilibrium: {} of {} without a restoring force.", number(Kind::neutral), all));
  }
  if (modes.vibrations.empty()) return good("Stable equilibrium; nothing is free to move.");
  const bool oscillates = number(Kind::oscillates) > 0;
  return good(fmt::format("{} this equilibrium: stable, {}.",
                          oscillates ? "It oscillates about" : "It returns without oscillation to", all));
}

void add_facts(Group& group, const MotionModel& model, const ModesAnswer& answer) {
  const Modes& modes = answer.modes;
  group.fact("equilibrium", in_words(answer.equilibrium.certificate),
             tone_of(answer.equilibrium.certificate.stability));
  std::string mobility = fmt::format("{}, of {}", count(modes.freedoms, "degree of freedom", "degrees of freedom"),
                                     count(model.layout().kept, "coordinate that moves", "coordinates that move"));
  if (modes.known && modes.massless > 0)
    mobility += fmt::format("; {} without inertia follow the others", modes.massless);
  const auto held = static_cast<int>(modes.stops.size());
  if (held > 0) mobility += "; held by " + count(held, "stop that presses", "stops that press");
  group.fact("mobility", mobility);
  if (modes.known && !model.scene().drives.empty()) {
    group.fact("left out", "drives: what they move is free here");
  }
}

/// Contacts that the modes keep closed, with their forces, and those that only touch.
void add_contacts_of_modes(Result& result, const MotionModel& model, const Modes& modes) {
  std::vector<TouchedStop> all = modes.stops;
  all.insert(all.end(), modes.just_touched.begin(), modes.just_touched.end());
  const auto stop_of = [&](const TouchedStop& one) -> const Stop& {
    return model.scene().stops[static_cast<std::size_t>(one.stop)];
  };
  Branch& data = result.content.array("contacts");
  for (const TouchedStop& one : all) {
    Group& contact = data.parts.emplace_back();
    contact.data("name", stop_of(one).name);
    contact.data("limit", one.at_max ? "max" : "min");
    contact.data("force", in_unit(one.force, effort_of(stop_of(one).on), model.scene().units));
    contact.data("kept", one.force > 0.0);
  }
  if (all.empty()) return;
  Table& table = result.content.group("", "", Verbosity::normal).table("", "Contacts", Rows::list);
  table.words("", "contact", each(all, [&](const TouchedStop& one) { return stop_of(one).title(); }));
  table.words("", "presses with", each(all, [&](const TouchedStop& one) {
                return with_unit(model, one.force, effort_of(stop_of(one).on));
              }));
  table.words("", "", each(all, [](const TouchedStop& one) {
                return one.force > 0.0 ? "kept closed: small motions slide along it, larger ones lift off"
                                       : "just touches: the modes are of motion away from it";
              }));
  if (modes.just_touched.empty() || !modes.known) return;
  result.warnings.push_back(doubtful(fmt::format(
      "Touched without a force: {}. The modes are those of motion on the free side; a motion that comes back strikes.",
      listed(each(modes.just_touched, [&](const TouchedStop& one) { return stop_of(one).title(); })))));
}

void add_modes(Group& group, const MotionModel& model, const Modes& modes) {
  const std::vector<Vibration>& rows = modes.vibrations;
  const auto if_it_oscillates = [&](double Vibration::*value) {
    return each(rows, [&](const Vibration& mode) {
      return mode.kind == Kind::diverges || mode.kind == Kind::neutral ? NAN : mode.*value;
    });
  };
  Table& table = group.table("", "Modes, shapes in rad and mechanism sizes", Rows::list);
  table.words("", "mode", each(rows, [](const Vibration& mode) { return name_of(mode.kind); })).tones =
      each(rows, [](const Vibration& mode) { return tone_of_kind(mode.kind); });
  table.numbers("", "frequency", "Hz",
                each(rows, [](const Vibration& mode) { return mode.kind == Kind::diverges ? NAN : mode.frequency; }),
                {.digits = frequency_digits});
  table.numbers("", "damping ratio", "", if_it_oscillates(&Vibration::damping_ratio), {.digits = damping_digits});
  table.numbers("", "damped", "Hz", if_it_oscillates(&Vibration::damped_frequency), {.digits = frequency_digits});
  table.numbers("", "growth", "1/s", each(rows, &Vibration::growth), {.digits = damping_digits});
  table.words("", "shape", each(rows, [&](const Vibration& mode) { return shape_in_words(model, mode); }));
}

/// {re: [...], im: [...]}.
template <class Numbers>
void add_complex(Group& group, const std::string& key, const Numbers& numbers) {
  Table& table = group.table(key, "", Rows::columns, Verbosity::data);
  table.data("re", each(numbers, [](const std::complex<double>& z) { return z.real(); }));
  table.data("im", each(numbers, [](const std::complex<double>& z) { return z.imag(); }));
}

void add_data(Group& group, const MotionModel& model, const ModesAnswer& answer) {
  const Modes& modes = answer.modes;
  group.data("status", to_string(answer.equilibrium.status));
  group.data("why", answer.equilibrium.why);
  group.data("stability", to_string(answer.equilibrium.certificate.stability));
  group.data("degrees_of_freedom", modes.freedoms);
  group.data("massless", modes.massless);
  group.data("held", modes.stops.size());
  group.data("known", modes.known);
  group.data("why_unknown", modes.why);
  const std::vector<double> q = answer.x.empty() ? answer.x : model.to_si(answer.x);
  const std::vector<std::size_t> rows = places(q.size());
  const auto coordinate = [&](std::size_t i) -> const Coordinate& { return model.layout().coordinates[i]; };
  const auto is_angle = [&](std::size_t i) { return coordinate(i).kind == Coordinate::Kind::angle; };
  Table& coordinates = group.table("coordinates", "", Rows::list, Verbosity::data);
  coordinates.words("name", "", each(rows, [&](std::size_t i) { return coordinate(i).name; }));
  coordinates.words("kind", "", each(rows, [&](std::size_t i) { return is_angle(i) ? "angle" : "length"; }));
  coordinates.data("value", each(rows, [&](std::size_t i) {
                     return in_unit(q[i], is_angle(i) ? Quantity::angle : Quantity::length, model.scene().units);
                   }));
  Branch& list = group.array("modes");
  for (const Vibration& mode : modes.vibrations) {
    Group& one = list.parts.emplace_back();
    one.data("kind", name_of(mode.kind));
    one.data("frequency", mode.frequency);
    one.data("damping_ratio", mode.damping_ratio);
    one.data("damped_frequency", mode.damped_frequency);
    one.data("growth", mode.growth);
    add_complex(one, "roots", mode.roots);
    add_complex(one, "shape", mode.shape);
  }
}

}  // namespace

Result modes_result(const MotionModel& model, const ModesAnswer& answer, const std::vector<std::string>& settings) {
  Result out = scene_result(model.scene(), settings);
  out.verdict = verdict(answer);
  add_data(out.content, model, answer);
  const Freedoms& freedoms = answer.modes.mobility;
  add_mobility(out.content, answer.x.empty() ? std::nullopt : std::optional(freedoms));
  if (!answer.equilibrium.found()) return out;
  if (freedoms.is_shaky()) {
    const char* const of_modes =
        "; modes along the others are of no motion that the joints allow, and rest on joint forces that are not "
        "determined";
    out.warnings.push_back(
        doubtful(fmt::format("Here {}{}.", shaky_in_words(freedoms), answer.modes.known ? of_modes : "")));
  }
  add_facts(out.content, model, answer);
  add_contacts_of_modes(out, model, answer.modes);
  add_modes(out.content, model, answer.modes);
  const std::vector<Element>& elements = model.scene().elements;
  if (answer.modes.known && (!joints_with_friction(model.scene()).empty() ||
                             std::any_of(elements.begin(), elements.end(), [](const Element& e) {
                               return std::holds_alternative<DryFriction>(e.law);
                             }))) {
    out.warnings.push_back(
        doubtful("Dry friction is left out, which is not linear: it damps small oscillations more than shown here."));
  }
  if (std::any_of(elements.begin(), elements.end(), [](const Element& e) { return is_motor(e.law); })) {
    out.warnings.push_back(
        doubtful("Motors are left out: with them no equilibrium is known; poise running finds how they turn it."));
  }
  out.content.group("", "Numerics", Verbosity::verbose)
      .fact("statics", fmt::format("{}; {}", to_string(answer.equilibrium.status), answer.equilibrium.why));
  return out;
}

}  // namespace poise::app
