#include "app/report/modes_report.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "app/json_parts.hpp"
#include "app/report/parts.hpp"
#include "app/table.hpp"

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
    case Kind::swings:
      return "swings";
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

std::string verdict(const ModesAnswer& answer, const Palette& palette) {
  if (!answer.rest.found()) return palette.paint(Tone::bad, "No rest about which it could swing.");
  const Modes& modes = answer.modes;
  if (!modes.known) return palette.paint(Tone::bad, "At rest, but how it moves about it is not known.");
  const auto number = [&](Kind kind) {
    return static_cast<int>(std::count_if(modes.vibrations.begin(), modes.vibrations.end(),
                                          [&](const Vibration& v) { return v.kind == kind; }));
  };
  std::string leaves;
  if (number(Kind::diverges) > 0) leaves = count(number(Kind::diverges), "mode diverges", "modes diverge");
  if (number(Kind::flutters) > 0) {
    leaves += (leaves.empty() ? "" : ", ") + count(number(Kind::flutters), "mode flutters", "modes flutter");
  }
  if (!leaves.empty()) return palette.paint(Tone::bad, "It leaves this rest: " + leaves + ".");
  if (number(Kind::neutral) > 0) {
    return palette.paint(Tone::doubtful, "It stays near this rest but for " +
                                             count(number(Kind::neutral), "neutral direction", "neutral directions") +
                                             ".");
  }
  return palette.paint(Tone::good, "It comes back to this rest: " +
                                       count(static_cast<int>(modes.vibrations.size()), "mode", "modes") + ".");
}

std::string facts(const MotionModel& model, const ModesAnswer& answer, const Palette& palette) {
  const Scene& scene = model.scene();
  const Modes& modes = answer.modes;
  std::string out = fact("rest", fmt::format("{}; {}", to_string(answer.rest.status), answer.rest.why), palette);
  if (!answer.rest.found()) return out;
  out += fact("statics", palette.paint(tone_of(answer.rest.check.stability), in_words(answer.rest.check)), palette);
  std::string freedoms = fmt::format("{}, of {}", modes.freedoms,
                                     count(model.layout().kept, "coordinate that moves", "coordinates that move"));
  if (modes.known && modes.massless > 0)
    freedoms += fmt::format("; {} without inertia follow the others", modes.massless);
  if (modes.held > 0) freedoms += "; held by " + count(modes.held, "stop that presses", "stops that press");
  out += fact("freedoms", freedoms, palette);
  if (!modes.known) return out + fact("why", modes.why, palette);
  if (std::any_of(scene.elements.begin(), scene.elements.end(),
                  [](const Element& e) { return std::holds_alternative<DryFriction>(e.law); })) {
    out += fact("left out", "dry friction, which is not linear: small swings see more of it than this tells", palette);
  }
  if (!scene.drives.empty()) out += fact("left out", "drives: what they move is free here", palette);
  return out;
}

std::string mode_section(const MotionModel& model, const Modes& modes, const Palette& palette) {
  std::vector<Cell> kinds;
  std::vector<std::string> shapes;
  std::vector<double> frequencies, ratios, damped, growths;
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  for (const Vibration& mode : modes.vibrations) {
    const bool comes_back = mode.kind == Kind::swings || mode.kind == Kind::decays || mode.kind == Kind::flutters;
    kinds.push_back({name_of(mode.kind), tone_of_kind(mode.kind)});
    frequencies.push_back(mode.kind == Kind::diverges ? unknown : mode.frequency);
    ratios.push_back(comes_back ? mode.damping_ratio : unknown);
    damped.push_back(comes_back ? mode.damped_frequency : unknown);
    growths.push_back(mode.growth);
    shapes.push_back(shape_in_words(model, mode));
  }
  Table table;
  table.add_text_column("mode", kinds);
  table.add_number_column("frequency (Hz)", aligned(frequencies, frequency_digits));
  table.add_number_column("damping ratio", aligned(ratios, damping_digits));
  table.add_number_column("damped (Hz)", aligned(damped, frequency_digits));
  table.add_number_column("growth (1/s)", aligned(growths, damping_digits));
  table.add_text_column("shape", shapes);
  return section("Modes, shapes in rad and mechanism sizes", table.print(palette), palette);
}

Json mode_json(const Vibration& mode) {
  Json out = {{"kind", name_of(mode.kind)},
              {"frequency", json_number(mode.frequency)},
              {"damping_ratio", json_number(mode.damping_ratio)},
              {"damped_frequency", json_number(mode.damped_frequency)},
              {"growth", json_number(mode.growth)},
              {"roots", Json::array()},
              {"shape", Json::array()}};
  const auto pair = [](const std::complex<double>& z) { return Json{json_number(z.real()), json_number(z.imag())}; };
  for (const auto& root : mode.roots) out["roots"].push_back(pair(root));
  for (const auto& part : mode.shape) out["shape"].push_back(pair(part));
  return out;
}

}  // namespace

std::string modes_report(const MotionModel& model, const ModesAnswer& answer, const Palette& palette) {
  return heading(model, palette) + verdict(answer, palette) + "\n" + facts(model, answer, palette) +
         mode_section(model, answer.modes, palette);
}

std::string modes_json(const MotionModel& model, const ModesAnswer& answer, const std::vector<std::string>& settings) {
  const Scene& scene = model.scene();
  const Modes& modes = answer.modes;
  Json out = {{"poise", POISE_VERSION},
              {"scene", json_scene(scene, settings)},
              {"units", json_units(scene.units)},
              {"status", to_string(answer.rest.status)},
              {"why", answer.rest.why},
              {"stability", to_string(answer.rest.check.stability)},
              {"coordinates", Json::array()},
              {"freedoms", modes.freedoms},
              {"massless", modes.massless},
              {"held", modes.held},
              {"known", modes.known},
              {"why_unknown", modes.why},
              {"modes", Json::array()}};
  const std::vector<double> q = answer.x.empty() ? answer.x : model.to_si(answer.x);
  for (std::size_t i = 0; i < q.size(); ++i) {
    const Coordinate& c = model.layout().coordinates[i];
    const bool angle = c.kind == Coordinate::Kind::angle;
    const Quantity quantity = angle ? Quantity::angle : Quantity::length;
    out["coordinates"].push_back({{"name", c.name},
                                  {"kind", angle ? "angle" : "length"},
                                  {"rest", json_number(in_unit(q[i], quantity, scene.units))}});
  }
  for (const Vibration& mode : modes.vibrations) out["modes"].push_back(mode_json(mode));
  return json_text(out, scene);
}

}  // namespace poise::app
