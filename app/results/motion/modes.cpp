#include "app/results/motion/modes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <fmt/format.h>

#include "app/present/numbers.hpp"
#include "app/results/parts.hpp"

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
    return {.text = "No equilibrium found about which it could oscillate: " + answer.equilibrium.why,
            .tone = Tone::bad};
  }
  const Modes& modes = answer.modes;
  if (!modes.known) return {.text = "In equilibrium, but without small motions: " + modes.why + ".", .tone = Tone::bad};
  const auto number = [&](Kind kind) {
    return static_cast<int>(std::count_if(modes.vibrations.begin(), modes.vibrations.end(),
                                          [&](const Vibration& v) { return v.kind == kind; }));
  };
  std::vector<std::string> leaves;
  if (number(Kind::diverges) > 0) leaves.push_back(count(number(Kind::diverges), "mode diverges", "modes diverge"));
  if (number(Kind::flutters) > 0) leaves.push_back(count(number(Kind::flutters), "mode flutters", "modes flutter"));
  if (!leaves.empty()) return {.text = "Unstable equilibrium: " + listed(leaves) + ".", .tone = Tone::bad};
  const std::string all = count(static_cast<int>(modes.vibrations.size()), "mode", "modes");
  if (number(Kind::neutral) > 0) {
    return {.text = fmt::format("Neutral equilibrium: {} of {} without a restoring force.", number(Kind::neutral), all),
            .tone = Tone::doubtful};
  }
  if (modes.vibrations.empty()) return {.text = "Stable equilibrium; nothing is free to move.", .tone = Tone::good};
  const bool oscillates = number(Kind::oscillates) > 0;
  return {.text = fmt::format("{} this equilibrium: stable, {}.",
                              oscillates ? "It oscillates about" : "It returns without oscillation to", all),
          .tone = Tone::good};
}

void add_facts(Group& group, const MotionModel& model, const ModesAnswer& answer) {
  const Modes& modes = answer.modes;
  group.fact("equilibrium", in_words(answer.equilibrium.check), tone_of(answer.equilibrium.check.stability));
  std::string mobility = fmt::format("{}, of {}", count(modes.freedoms, "degree of freedom", "degrees of freedom"),
                                     count(model.layout().kept, "coordinate that moves", "coordinates that move"));
  if (modes.known && modes.massless > 0)
    mobility += fmt::format("; {} without inertia follow the others", modes.massless);
  if (modes.held > 0) mobility += "; held by " + count(modes.held, "active stop", "active stops");
  group.fact("mobility", mobility);
  if (modes.known && !model.scene().drives.empty()) {
    group.fact("left out", "drives: what they move is free here");
  }
}

void add_modes(Group& group, const MotionModel& model, const Modes& modes) {
  std::vector<std::string> kinds, shapes;
  std::vector<Tone> tones;
  std::vector<double> frequencies, ratios, damped, growths;
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  for (const Vibration& mode : modes.vibrations) {
    const bool has_frequency = mode.kind != Kind::diverges && mode.kind != Kind::neutral;
    kinds.emplace_back(name_of(mode.kind));
    tones.push_back(tone_of_kind(mode.kind));
    frequencies.push_back(mode.kind == Kind::diverges ? unknown : mode.frequency);
    ratios.push_back(has_frequency ? mode.damping_ratio : unknown);
    damped.push_back(has_frequency ? mode.damped_frequency : unknown);
    growths.push_back(mode.growth);
    shapes.push_back(shape_in_words(model, mode));
  }
  Table& table = group.table("", "Modes, shapes in rad and mechanism sizes", Rows::list);
  table.words("", "mode", std::move(kinds)).tones = std::move(tones);
  table.numbers("", "frequency", "Hz", std::move(frequencies), {.digits = frequency_digits});
  table.numbers("", "damping ratio", "", std::move(ratios), {.digits = damping_digits});
  table.numbers("", "damped", "Hz", std::move(damped), {.digits = frequency_digits});
  table.numbers("", "growth", "1/s", std::move(growths), {.digits = damping_digits});
  table.words("", "shape", std::move(shapes));
}

/// {re: [...], im: [...]}.
template <class Numbers>
void add_complex(Group& group, const std::string& key, const Numbers& numbers) {
  std::vector<double> re, im;
  for (const std::complex<double>& z : numbers) {
    re.push_back(z.real());
    im.push_back(z.imag());
  }
  Table& table = group.table(key, "", Rows::columns, Verbosity::data);
  table.data("re", std::move(re));
  table.data("im", std::move(im));
}

void add_data(Group& group, const MotionModel& model, const ModesAnswer& answer) {
  const Modes& modes = answer.modes;
  group.data("status", to_string(answer.equilibrium.status));
  group.data("why", answer.equilibrium.why);
  group.data("stability", to_string(answer.equilibrium.check.stability));
  group.data("degrees_of_freedom", modes.freedoms);
  group.data("massless", modes.massless);
  group.data("held", modes.held);
  group.data("known", modes.known);
  group.data("why_unknown", modes.why);
  const std::vector<double> q = answer.x.empty() ? answer.x : model.to_si(answer.x);
  std::vector<std::string> names, kinds;
  std::vector<double> values;
  for (std::size_t i = 0; i < q.size(); ++i) {
    const Coordinate& c = model.layout().coordinates[i];
    const bool angle = c.kind == Coordinate::Kind::angle;
    names.push_back(c.name);
    kinds.emplace_back(angle ? "angle" : "length");
    values.push_back(in_unit(q[i], angle ? Quantity::angle : Quantity::length, model.scene().units));
  }
  Table& coordinates = group.table("coordinates", "", Rows::list, Verbosity::data);
  coordinates.words("name", "", std::move(names));
  coordinates.words("kind", "", std::move(kinds));
  coordinates.data("value", std::move(values));
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
  if (!answer.equilibrium.found()) return out;
  add_facts(out.content, model, answer);
  add_modes(out.content, model, answer.modes);
  const std::vector<Element>& elements = model.scene().elements;
  if (answer.modes.known && std::any_of(elements.begin(), elements.end(),
                                        [](const Element& e) { return std::holds_alternative<DryFriction>(e.law); })) {
    out.warnings.push_back(
        {.text = "Dry friction is left out, which is not linear: it damps small oscillations more than shown here.",
         .tone = Tone::doubtful});
  }
  out.content.group("", "Numerics", Verbosity::verbose)
      .fact("statics", fmt::format("{}; {}", to_string(answer.equilibrium.status), answer.equilibrium.why));
  return out;
}

}  // namespace poise::app
