#include "app/results/motion/response.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "app/result/numbers.hpp"
#include "app/results/motion/control_loop.hpp"
#include "app/results/parts.hpp"
#include "model/joint_friction.hpp"

namespace poise::app {
namespace {

using Complex = std::complex<double>;
using Event = ResponseEvent::Kind;

constexpr double not_known = std::numeric_limits<double>::quiet_NaN();
constexpr int response_digits = 6;
constexpr int hertz_digits = 10;

/// Degrees, from -180 (included) to 180: an undamped mechanism that moves against its load is at -180.
double phase_of(Complex value) {
  constexpr double rounding = 1e-9;
  const double phase = std::arg(value) * 180 / M_PI;
  return phase > 180 - rounding ? phase - 360 : phase + 0.0;
}

/// The units in which a response is shown.
struct ResponseUnits {
  ResponseUnits(const Units& units, const ResponseAnswer& answer)
      : quantity(answer.of.dimension.unit(units)),
        excitation(answer.excitation.dimension.unit(units)),
        quantity_name(answer.of.dimension.unit_name(units)),
        excitation_name(answer.excitation.dimension.unit_name(units)) {}

  /// Converts an amplitude per unit of the excitation, SI.
  double per_unit(double si) const { return si * excitation / quantity; }
  std::string per_unit_name() const {
    if (excitation_name.empty()) return quantity_name;
    const std::string below =
        excitation_name.find('/') != std::string::npos || excitation_name.find(' ') != std::string::npos
            ? "(" + excitation_name + ")"
            : excitation_name;
    return (quantity_name.empty() ? "1" : quantity_name) + "/" + below;
  }
  /// "12.3 mm".
  std::string with_unit(double si) const {
    const std::string number = significant(si / quantity, response_digits);
    return quantity_name.empty() ? number : number + " " + quantity_name;
  }

  double quantity, excitation;
  std::string quantity_name, excitation_name;
};

const char* name_of(Resonance::Kind kind) {
  switch (kind) {
    case Resonance::Kind::peak:
      return "peak";
    case Resonance::Kind::least:
      return "least";
    case Resonance::Kind::rest:
      return "rest";
    case Resonance::Kind::unbounded:
      return "unbounded";
  }
  return "";
}

const char* name_of(Event kind) {
  switch (kind) {
    case Event::largest:
      return "largest amplitude";
    case Event::fold:
      return "fold";
    case Event::branch:
      return "branch point";
    case Event::doubling:
      return "period doubling";
    case Event::torus:
      return "second frequency";
  }
  return "";
}

const char* name_of(ResponseBranch::End end) {
  switch (end) {
    case ResponseBranch::End::range:
      return "range";
    case ResponseBranch::End::stop:
      return "stop";
    case ResponseBranch::End::failed:
      return "failed";
    case ResponseBranch::End::limit:
      return "limit";
    case ResponseBranch::End::interrupted:
      return "interrupted";
  }
  return "";
}

std::string with_name(const std::string& number, const std::string& unit) {
  return unit.empty() ? number : number + " " + unit;
}

std::string hertz(double frequency) { return significant(frequency, 7) + " Hz"; }

/// The largest amplitude of the linear response, without what is unbounded.
std::optional<std::pair<double, Complex>> largest_of(const ResponseAnswer& answer) {
  std::optional<std::pair<double, Complex>> out;
  for (std::size_t k = 0; k < answer.frequency.size(); ++k) {
    const Complex value = answer.value[k];
    if (!std::isfinite(std::abs(value))) continue;
    if (!out || std::abs(value) > std::abs(out->second)) out = std::pair(answer.frequency[k], value);
  }
  return out;
}

std::string unbounded_in_words(const ResponseAnswer& answer) {
  std::vector<std::string> at;
  for (const Resonance& one : answer.resonances) {
    if (one.kind != Resonance::Kind::unbounded) continue;
    at.push_back(fmt::format("{} (mode {}, undamped)", hertz(one.frequency), one.mode + 1));
  }
  return at.empty() ? "" : "unbounded at " + listed(at);
}

Line linear_verdict(const ResponseAnswer& answer, const ResponseUnits& units) {
  const std::string unbounded = unbounded_in_words(answer);
  if (!unbounded.empty()) {
    return doubtful(fmt::format("The response of {} to {} is {}.", answer.of.name, answer.excitation.path, unbounded));
  }
  const auto largest = largest_of(answer);
  if (!largest || std::abs(largest->second) == 0.0) {
    return doubtful(fmt::format("{} does not move {}.", answer.excitation.path, answer.of.name));
  }
  return good(fmt::format(
      "Largest response of {}: {} per {} of {}, at {}, phase {} deg.", answer.of.name,
      with_name(significant(units.per_unit(std::abs(largest->second)), response_digits), units.quantity_name),
      units.excitation_name.empty() ? "unit" : units.excitation_name, answer.excitation.path, hertz(largest->first),
      significant(phase_of(largest->second), 4)));
}

/// "sweeping up it jumps down at 0.2232246 Hz, from 3.62603 m to 0.206 m".
std::string jump_in_words(const ResponseEvent& event, const ResponseUnits& units) {
  const char* const sweep = event.upwards ? "up" : "down";
  if (!event.landing) {
    return fmt::format("sweeping {} it leaves its branch at {}, from {}", sweep, hertz(event.at.frequency),
                       units.with_unit(event.at.amplitude));
  }
  return fmt::format("sweeping {} it jumps {} at {}, from {} to {}", sweep,
                     event.landing->amplitude < event.at.amplitude ? "down" : "up", hertz(event.at.frequency),
                     units.with_unit(event.at.amplitude), units.with_unit(event.landing->amplitude));
}

Line periodic_verdict(const ResponseAnswer& answer, const ResponseUnits& units) {
  const PeriodicResponse& found = *answer.periodic;
  if (!found.found) return bad(fmt::format("No periodic motion found {}.", found.why));
  std::string text;
  for (const ResponseEvent& event : found.events) {
    if (event.kind != Event::largest) continue;
    text = fmt::format("Largest amplitude of {}: {} at {}", answer.of.name, units.with_unit(event.at.amplitude),
                       hertz(event.at.frequency));
  }
  for (const ResponseEvent& event : found.events) {
    if (event.jumps) text += "; " + jump_in_words(event, units);
  }
  if (found.is_whole()) return good(text + ".");
  for (const ResponseBranch& branch : found.branches) {
    if (branch.end == ResponseBranch::End::range) continue;
    return doubtful(fmt::format("{}; followed in part only, {}.", text, branch.why));
  }
  return doubtful(text + ".");
}

Line verdict(const Scene& scene, const ResponseAnswer& answer, const ResponseUnits& units) {
  if (answer.loop && !answer.loop->known) return bad(no_equilibrium_in_words(scene, *answer.loop));
  if (!answer.has_equilibrium()) {
    return bad("No equilibrium found about which it could vibrate: " + answer.equilibrium.why);
  }
  const Modes& modes = answer.linear->modes();
  if (!modes.known) return bad("In equilibrium, but without small motions: " + modes.why + ".");
  if (!answer.is_stable()) return bad("Unstable equilibrium: what swings does not stay near it.");
  return answer.periodic ? periodic_verdict(answer, units) : linear_verdict(answer, units);
}

/// `periodic`: smooth friction acts in periodic motions, which are refused where friction sticks. With `holds` drives
/// hold what they move.
std::vector<std::string> left_out(const Scene& scene, bool periodic, bool holds) {
  std::vector<std::string> out;
  for (const Drive& drive : scene.drives) {
    if (!holds) out.push_back(fmt::format("drive \"{}\": what it moves is free here", drive.name));
  }
  for (const std::string& joint : joints_with_friction(scene)) {
    out.push_back(fmt::format("friction of joint {}: while it sticks nothing moves there", joint));
  }
  for (const Element& element : scene.elements) {
    if (is_motor(element.law) && !holds) {
      out.push_back(fmt::format("motor \"{}\": with it no equilibrium is known", element.name));
    }
    const bool takes_part = element.feedback || is_motor(element.law) || stores_energy(element.law);
    if (periodic || takes_part || damps_small_motion(element.law)) continue;
    out.push_back(fmt::format("{} \"{}\": dry friction, which is not linear", element.family(), element.name));
  }
  for (const TimeFunction& function : scene.time_functions) {
    if (function.of == TimeFunction::Of::drive) continue;
    out.push_back(fmt::format("{} of load \"{}\" over time: it has its value at t = 0", function.kind(),
                              name_of(scene, function)));
  }
  return out;
}

std::vector<std::string> stops_of(const Scene& scene, const SmallMotions& motions) {
  std::vector<std::string> out;
  for (const TouchedStop& one : motions.stops) out.push_back(scene.stops[static_cast<std::size_t>(one.stop)].name);
  return out;
}

std::string stops_in_words(const Scene& scene, const SmallMotions& motions) {
  std::vector<std::string> out;
  for (const TouchedStop& touched : motions.stops) {
    const Stop& one = scene.stops[static_cast<std::size_t>(touched.stop)];
    out.push_back(fmt::format("{} \"{}\"", one.table, one.name));
  }
  return listed(out);
}

std::string frequencies_in_words(const Modes& modes) {
  constexpr std::size_t most = 6;
  std::vector<std::string> out;
  for (const Vibration& mode : modes.vibrations) {
    if (mode.frequency == 0.0) continue;
    out.push_back(
        fmt::format("{}{}", hertz(mode.frequency),
                    mode.damping_ratio > 0 ? fmt::format(" (damping {})", significant(mode.damping_ratio, 4)) : ""));
    if (out.size() == most) break;
  }
  return out.empty() ? "none" : fmt::format("{}", fmt::join(out, ", "));
}

void add_facts(Group& group, const Scene& scene, const ResponseAnswer& answer, const ResponseUnits& units) {
  if (answer.loop) {
    const bool is_controlled = !answer.loop->controllers.empty();
    const bool is_alone = !is_controlled && answer.loop->blade_force.empty();
    group.fact("equilibrium", fmt::format("{}{}{}",
                                          is_controlled ? "that which its controllers keep"
                                          : is_alone    ? "that in which its motors hold it"
                                                        : "",
                                          answer.loop->blade_force.empty() ? ""
                                          : is_controlled                  ? ", one of a set with its blades"
                                                                           : "one of a set, which its blades hold",
                                          is_controlled ? "; the response is that of the closed loop" : ""));
  } else {
    group.fact("equilibrium", in_words(answer.equilibrium.certificate),
               tone_of(answer.equilibrium.certificate.stability));
  }
  const FrequencyResponse& linear = *answer.linear;
  group.fact("quantity", fmt::format("{} = {} in the equilibrium", answer.of.name, units.with_unit(linear.at_rest())));
  const std::string swings =
      answer.periodic
          ? fmt::format("{} swings by {}", answer.excitation.path,
                        with_name(significant(answer.amplitude / units.excitation, 6), units.excitation_name))
          : answer.excitation.path + " swings; amplitudes are per unit of it";
  group.fact("excitation", swings + ", as a cosine");
  group.fact("modes", frequencies_in_words(linear.modes()));
  if (!linear.motions().stops.empty()) {
    group.fact("held by", stops_in_words(scene, linear.motions()) + ", which small motions do not leave");
  }
  for (const std::string& one : left_out(scene, answer.periodic.has_value(), static_cast<bool>(answer.loop)))
    group.fact("left out", one, Tone::doubtful);
  for (const SilentMode& mode : linear.silent_modes()) {
    const Vibration& vibration = linear.modes().vibrations[static_cast<std::size_t>(mode.mode)];
    group.fact(fmt::format("mode {}", mode.mode + 1),
               fmt::format("{}: {}", hertz(vibration.frequency),
                           !mode.is_driven ? "not excited by " + answer.excitation.path
                                           : "excited, but " + answer.of.name + " does not move in it"));
  }
}

void add_resonances(Group& group, const ResponseAnswer& answer, const ResponseUnits& units) {
  const std::vector<Resonance>& rows = answer.resonances;
  Table& table = group.table("resonances", "Peaks and troughs", Rows::list);
  table.words("kind", "response", each(rows, [](const Resonance& one) { return name_of(one.kind); })).tones = each(
      rows, [](const Resonance& one) { return one.kind == Resonance::Kind::unbounded ? Tone::doubtful : Tone::plain; });
  table.numbers("frequency", "frequency", "Hz", each(rows, &Resonance::frequency), {.digits = hertz_digits});
  table.numbers("amplitude", "amplitude", units.per_unit_name(),
                each(rows,
                     [&](const Resonance& one) {
                       if (one.kind == Resonance::Kind::rest) return 0.0;
                       const double value = units.per_unit(std::abs(one.value));
                       return std::isfinite(value) ? value : not_known;
                     }),
                {.style = Format::Style::significant, .digits = response_digits});
  table.numbers("phase", "phase", "deg",
                each(rows,
                     [](const Resonance& one) {
                       const bool has_phase = one.kind == Resonance::Kind::peak || one.kind == Resonance::Kind::least;
                       return has_phase ? phase_of(one.value) : not_known;
                     }),
                {.style = Format::Style::significant, .digits = 5});
  table.counts("mode", "mode",
               each(rows, [](const Resonance& one) { return one.mode < 0 ? not_known : one.mode + 1.0; }));
}

void add_response(Group& group, const ResponseAnswer& answer, const ResponseUnits& units) {
  Table& table = group.table("response", answer.periodic ? "" : "Response, to first order", Rows::columns,
                             answer.periodic ? Verbosity::data : Verbosity::normal);
  table.csv = !answer.periodic;
  table.shown = Table::Shown::spread;
  table.numbers("frequency", "frequency", "Hz", answer.frequency, {.style = Format::Style::significant});
  table.numbers("amplitude", "amplitude", units.per_unit_name(),
                each(answer.value, [&](Complex value) { return units.per_unit(std::abs(value)); }),
                {.style = Format::Style::significant, .digits = response_digits});
  table.numbers("phase", "phase", "deg", each(answer.value, [](Complex value) { return phase_of(value); }),
                {.style = Format::Style::significant, .digits = 5});
}

std::vector<PeriodicAnswer> points_of(const std::vector<ResponseEvent>& events) {
  std::vector<PeriodicAnswer> out;
  for (const ResponseEvent& event : events) out.push_back(event.at);
  return out;
}

/// `at_limit` says which are neither stable nor unstable, because a multiplier is on the unit circle; empty: none.
void add_answer_columns(Table& table, const std::vector<PeriodicAnswer>& rows, const ResponseUnits& units,
                        const std::vector<bool>& at_limit = {}) {
  table.numbers("frequency", "frequency", "Hz", each(rows, &PeriodicAnswer::frequency), {.digits = hertz_digits});
  const Format format{.style = Format::Style::significant, .digits = hertz_digits};
  table.numbers("amplitude", "amplitude", units.quantity_name,
                each(rows, [&](const PeriodicAnswer& one) { return one.amplitude / units.quantity; }), format);
  table.numbers("farthest", "farthest", units.quantity_name,
                each(rows, [&](const PeriodicAnswer& one) { return one.farthest / units.quantity; }), format);
  table.numbers("phase", "phase", "deg", each(rows, [](const PeriodicAnswer& one) { return phase_of(one.harmonic); }),
                {.style = Format::Style::significant, .digits = 5});
  Column& stability = table.words("", "stability", {});
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const bool is_limit = !at_limit.empty() && at_limit[k];
    stability.words.emplace_back(is_limit ? "at its limit" : rows[k].stable ? "stable" : "unstable");
    stability.tones.push_back(is_limit ? Tone::plain : rows[k].stable ? Tone::good : Tone::doubtful);
  }
  table.flags("stable", each(rows, [](const PeriodicAnswer& one) { return one.stable ? 1.0 : 0.0; }));
  table.numbers(
      "multiplier", "largest multiplier", "",
      each(rows,
           [](const PeriodicAnswer& one) { return one.multipliers.empty() ? 0.0 : std::abs(one.multipliers.front()); }),
      {.style = Format::Style::significant, .digits = response_digits});
}

void add_periodic(Group& group, const ResponseAnswer& answer, const ResponseUnits& units) {
  const PeriodicResponse& found = *answer.periodic;
  Group& periodic = group.group("periodic");
  periodic.data("found", found.found);
  periodic.data("why", found.why);
  periodic.data("whole", found.is_whole());
  periodic.data("amplitude", answer.amplitude / units.excitation);
  periodic.data("error", found.error);
  periodic.data("motions", found.motions);
  Table& events = periodic.table("events", "Folds, jumps and the largest amplitude", Rows::list);
  events.words("kind", "what", each(found.events, [](const ResponseEvent& one) { return name_of(one.kind); }));
  std::vector<bool> at_limit;
  for (const ResponseEvent& one : found.events) at_limit.push_back(one.kind != Event::largest);
  add_answer_columns(events, points_of(found.events), units, at_limit);
  events.flags("jumps", each(found.events, [](const ResponseEvent& one) { return one.jumps ? 1.0 : 0.0; }));
  events.numbers(
      "landing", "jumps to", units.quantity_name,
      each(found.events,
           [&](const ResponseEvent& one) { return one.landing ? one.landing->amplitude / units.quantity : not_known; }),
      {.style = Format::Style::significant, .digits = response_digits});
  std::vector<PeriodicAnswer> answers;
  for (const std::vector<PeriodicAnswer>& some : found.answers) answers.insert(answers.end(), some.begin(), some.end());
  Table& asked = periodic.table("answers", "Periodic motions at the frequencies asked for", Rows::list);
  asked.shown = Table::Shown::all;
  add_answer_columns(asked, answers, units);
  Branch& branches = periodic.array("branches");
  Table rows;
  std::vector<PeriodicAnswer> all;
  std::vector<double> numbers;
  double residual = 0.0;
  for (std::size_t b = 0; b < found.branches.size(); ++b) {
    const ResponseBranch& branch = found.branches[b];
    Group& one = branches.parts.emplace_back();
    one.data("end", name_of(branch.end));
    one.data("why", branch.why);
    one.data("points", branch.points.size());
    for (const PeriodicAnswer& point : branch.points) {
      all.push_back(point);
      numbers.push_back(static_cast<double>(b + 1));
      residual = std::max(residual, point.residual);
    }
  }
  periodic.data("residual", residual);
  Table& points = periodic.table("points", "Points of the branches", Rows::columns);
  points.csv = true;
  points.shown = Table::Shown::spread;
  points.counts("branch", "branch", numbers);
  add_answer_columns(points, all, units);
  periodic.fact("amplitude",
                "half of greatest less least value; farthest: from the equilibrium; phase: of the first harmonic");
  periodic.fact("errors",
                fmt::format("a period later the state is the same to {} of how far it swings; integration to {} "
                            "(motions ten times as accurate)",
                            small_number(residual), small_number(found.error)));
  periodic.fact("work", fmt::format("{} of one period, Runge-Kutta-Fehlberg of order 8 with derivatives",
                                    count(found.motions, "motion", "motions")));
}

void add_data(Group& group, const Scene& scene, const ResponseAnswer& answer, const ResponseUnits& units) {
  if (answer.loop) {
    group.data("status", to_string(answer.loop->known ? Status::confirmed : Status::not_solved));
    group.data("why", answer.loop->why);
    group.data("stability", name_of_stability(*answer.loop));
  } else {
    group.data("status", to_string(answer.equilibrium.status));
    group.data("why", answer.equilibrium.why);
    group.data("stability", to_string(answer.equilibrium.certificate.stability));
  }
  group.data("known", answer.linear != nullptr && answer.linear->modes().known);
  group.data("why_unknown", answer.linear ? answer.linear->modes().why : "");
  Group& excitation = group.group("excitation");
  excitation.data("name", answer.excitation.path);
  excitation.data("unit", units.excitation_name);
  Group& quantity = group.group("quantity");
  quantity.data("name", answer.of.name);
  quantity.data("unit", units.quantity_name);
  quantity.data("value", answer.linear ? Value(answer.linear->at_rest() / units.quantity) : Value());
  group.data("unit", units.per_unit_name());
  group.data("stops", answer.linear ? stops_of(scene, answer.linear->motions()) : std::vector<std::string>{});
  group.data("left_out", left_out(scene, answer.periodic.has_value(), static_cast<bool>(answer.loop)));
}

void add_silent(Group& group, const ResponseAnswer& answer) {
  const std::vector<SilentMode> silent = answer.linear->silent_modes();
  Table& table = group.table("silent_modes", "", Rows::list, Verbosity::data);
  table.data("mode", each(silent, [](const SilentMode& one) { return one.mode + 1.0; }));
  table.flags("excited", each(silent, [](const SilentMode& one) { return one.is_driven ? 1.0 : 0.0; }));
  table.flags("seen", each(silent, [](const SilentMode& one) { return one.is_seen ? 1.0 : 0.0; }));
}

}  // namespace

bool ResponseAnswer::is_stable() const {
  if (!linear || !linear->modes().known) return false;
  const std::vector<Vibration>& all = linear->modes().vibrations;
  return std::none_of(all.begin(), all.end(), [](const Vibration& mode) {
    return mode.kind == Vibration::Kind::diverges || mode.kind == Vibration::Kind::flutters;
  });
}

bool ResponseAnswer::is_answered() const { return is_stable() && (!periodic || periodic->is_whole()); }

Result response_result(const Scene& scene, const ResponseAnswer& answer, const std::vector<std::string>& settings) {
  const ResponseUnits units(scene.units, answer);
  Result out = scene_result(scene, settings);
  out.verdict = verdict(scene, answer, units);
  add_data(out.content, scene, answer, units);
  const bool has_mobility = answer.linear && !answer.loop;
  add_mobility(out.content, has_mobility ? std::optional(answer.linear->motions().mobility) : std::nullopt);
  if (!answer.linear) return out;
  add_facts(out.content, scene, answer, units);
  if (!answer.linear->modes().known) return out;
  const double still = units.per_unit(answer.at_rest.real());
  if (std::isfinite(still)) {
    out.content.entry("static", "static", still, units.per_unit_name(), {Format::Style::significant}, "at 0 Hz");
  } else {
    out.content.data("static", nullptr);
  }
  if (answer.periodic) add_periodic(out.content, answer, units);
  add_resonances(out.content, answer, units);
  add_response(out.content, answer, units);
  add_silent(out.content, answer);
  return out;
}

std::vector<Panel> response_panels(const Units& all_units, const ResponseAnswer& answer) {
  const ResponseUnits units(all_units, answer);
  std::vector<Panel> out;
  if (!answer.linear || answer.frequency.empty()) return out;
  const auto label = [](const std::string& name, const std::string& unit) {
    return unit.empty() ? name : fmt::format("{} ({})", name, unit);
  };
  const double by = answer.periodic ? answer.amplitude / units.excitation : 1.0;
  Curve linear{.name = answer.periodic ? "to first order" : "",
               .x = answer.frequency,
               .style = answer.periodic ? Curve::Style::dotted : Curve::Style::line,
               .colour = answer.periodic ? 2 : 0};
  Curve phase = linear;
  for (const Complex value : answer.value) {
    linear.y.push_back(by * units.per_unit(std::abs(value)));
    phase.y.push_back(phase_of(value));
  }
  Panel amplitudes{.title = answer.of.name + " under " + answer.excitation.path,
                   .y_label = label("amplitude", answer.periodic ? units.quantity_name : units.per_unit_name()),
                   .tall = true};
  Panel phases{.x_label = "frequency (Hz)", .y_label = "phase (deg)"};
  if (!answer.periodic) {
    amplitudes.log_x = phases.log_x = amplitudes.log_y = true;
    amplitudes.curves.push_back(linear);
    phases.curves.push_back(phase);
    for (const Resonance& one : answer.resonances) {
      if (one.mode < 0 || one.kind != Resonance::Kind::peak) continue;
      amplitudes.marks.push_back({one.frequency, units.per_unit(std::abs(one.value)), std::to_string(one.mode + 1)});
      phases.marks.push_back({one.frequency, phase_of(one.value), std::to_string(one.mode + 1)});
    }
    return {amplitudes, phases};
  }
  // Near its resonance the linear response goes far beyond the others, and would make them small.
  double highest = 0.0;
  for (const bool stable : {true, false}) {
    Curve one{.name = stable ? "stable" : "unstable",
              .style = stable ? Curve::Style::line : Curve::Style::dashed,
              .colour = stable ? 0 : 1};
    Curve its_phase = one;
    for (const ResponseBranch& branch : answer.periodic->branches) {
      for (std::size_t k = 1; k < branch.points.size(); ++k) {
        const PeriodicAnswer& from = branch.points[k - 1];
        const PeriodicAnswer& to = branch.points[k];
        if (to.stable != stable) continue;
        for (const PeriodicAnswer* point : {&from, &to}) {
          for (Curve* curve : {&one, &its_phase}) curve->x.push_back(point->frequency);
          one.y.push_back(point->amplitude / units.quantity);
          its_phase.y.push_back(phase_of(point->harmonic));
          highest = std::max(highest, one.y.back());
        }
        for (Curve* curve : {&one, &its_phase}) {
          curve->x.push_back(not_known);
          curve->y.push_back(not_known);
        }
      }
    }
    if (one.x.empty()) continue;
    amplitudes.curves.push_back(std::move(one));
    phases.curves.push_back(std::move(its_phase));
  }
  constexpr double above = 1.3;
  for (double& y : linear.y) {
    if (y > above * highest) y = not_known;
  }
  amplitudes.curves.push_back(std::move(linear));
  phases.curves.push_back(std::move(phase));
  int number = 0;
  for (const ResponseEvent& event : answer.periodic->events) {
    if (event.kind == Event::largest) continue;
    const double y = event.at.amplitude / units.quantity;
    amplitudes.marks.push_back({event.at.frequency, y, std::to_string(++number)});
    if (!event.landing) continue;
    amplitudes.arrows.push_back({event.at.frequency, y, event.at.frequency, event.landing->amplitude / units.quantity});
  }
  return {amplitudes, phases};
}

}  // namespace poise::app
