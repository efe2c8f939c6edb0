#include "app/results/statics/hold.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "app/result/numbers.hpp"
#include "app/results/parts.hpp"
#include "model/parameters.hpp"
#include "statics/model/readings.hpp"

namespace poise::app {
namespace {

std::string_view word_of(Holding verdict) {
  return verdict == Holding::held ? "held" : verdict == Holding::slips ? "slips" : "not decided";
}

/// "forwards" along the order of its points.
std::string_view way_of(bool forwards) {
  return forwards ? "running towards its last point" : "running towards its first point";
}

std::string quoted(const Rubbing& one) { return fmt::format("{} \"{}\"", one.kind, one.name); }

/// "travel" or "angle" of what slips.
std::string_view measure_of(const Rubbing& one) {
  return one.joint >= 0 ? (one.on.is_angle() ? "angle" : "travel") : (one.on.is_angle() ? "angle" : "length");
}

std::string slip_in_words(const Rubbing& one, bool increases) {
  if (one.rope >= 0) return fmt::format("{}, {}", quoted(one), way_of(increases));
  return fmt::format("{}, its {} {}", quoted(one), measure_of(one), increases ? "growing" : "falling");
}

std::string slips_in_words(const std::vector<Rubbing>& all, const std::vector<Slip>& slips) {
  std::string out;
  for (const Slip& slip : slips) {
    out += (out.empty() ? "" : "; ") + slip_in_words(all[slip.of], slip.increases);
  }
  return out;
}

void add_slips(Group& group, const std::vector<Rubbing>& all, const std::vector<Slip>& slips) {
  Table& table = group.table("slips", "", Rows::list, Verbosity::data);
  table.words("name", "", each(slips, [&](const Slip& s) { return all[s.of].name; }));
  table.words("kind", "", each(slips, [&](const Slip& s) { return std::string(all[s.of].kind); }));
  table.flags("increases", each(slips, [](const Slip& s) { return s.increases ? 1.0 : 0.0; }));
}

std::optional<double> finite(double value) { return std::isfinite(value) ? std::optional(value) : std::nullopt; }

/// The unit and dimension of the number that is varied.
struct Unit {
  double si = 1.0;
  std::string name;
};

Unit unit_of(const Scene& scene, const std::string& number) {
  if (number == "loads") return {};
  const Dimension dimension = parameter(scene, number).dimension;
  return {dimension.unit(scene.units), dimension.unit_name(scene.units)};
}

std::string with(double value, const Unit& unit, double radius = 0.0) {
  return significant(value / unit.si, 10, radius / unit.si) + (unit.name.empty() ? "" : " " + unit.name);
}

std::string end_in_words(const HeldEnd& end, const Unit& unit, std::string_view without_end) {
  if (std::isinf(end.value)) return std::string(without_end) + (end.proved ? " (proved)" : " (in double precision)");
  std::string out = with(end.value, unit, end.radius);
  if (end.at_limit) return out + ", where the range ends" + (end.proved ? " (proved)" : "");
  if (end.radius > 0.0) out += " +- " + small_number(end.radius / unit.si);
  return out + (end.proved ? " (proved)" : " (in double precision)");
}

std::string range_in_words(const HeldRange& range, const HoldView& view, const Unit& unit) {
  const auto& [lower, upper] = std::pair(range.lower, range.upper);
  const std::string low = std::isinf(lower.value) ? "any negative value" : with(lower.value, unit, lower.radius);
  if (std::isinf(upper.value) && std::isinf(lower.value)) return fmt::format("at any {}", view.number);
  if (std::isinf(upper.value)) return fmt::format("for {} from {} upwards, without end", view.number, low);
  if (std::isinf(lower.value))
    return fmt::format("for {} up to {}", view.number, with(upper.value, unit, upper.radius));
  return fmt::format("for {} from {} to {}", view.number, low, with(upper.value, unit, upper.radius));
}

void add_end(Group& group, const std::string& key, const std::string& label, const HeldEnd& end, const Unit& unit,
             const std::vector<Rubbing>& all) {
  Group& one = group.group(key);
  one.data("value", finite(end.value / unit.si));
  one.data("without_end", std::isinf(end.value));
  one.data("at_limit", end.at_limit);
  one.data("proved", end.proved);
  one.data("radius", end.radius / unit.si);
  add_slips(one, all, end.slips);
  one.fact(label, end_in_words(end, unit, "without end: friction grows with what it has to hold"));
  if (!end.slips.empty()) one.fact("beyond it", slips_in_words(all, end.slips));
}

/// "held" and the like, of the present value of a number.
std::string now_in_words(const HeldRange& range) {
  switch (range.now.verdict) {
    case Holding::held:
      return range.contains_now ? "held" : "held, outside of the range that was asked for";
    case Holding::slips:
      return "not held";
    case Holding::not_decided:
      break;
  }
  return "not decided";
}

void add_range(Group& content, const StaticModel& model, const HeldRange& range, const HoldView& view,
               const std::vector<Rubbing>& all) {
  const Unit unit = unit_of(model.scene(), view.number);
  Group& group = content.group("range", "Held by friction as " + view.number + " changes");
  group.data("number", view.number);
  group.data("unit", unit.name);
  group.data("present", range.present / unit.si);
  group.data("found", range.any);
  group.data("contains_present", range.contains_now);
  group.data("why", range.why);
  group.fact("now", with(range.present, unit) + ", " + now_in_words(range));
  if (!range.any) {
    group.fact("", range.why.empty() ? "no value of it that was asked for is held" : range.why);
    return;
  }
  add_end(group, "lower", "from", range.lower, unit, all);
  add_end(group, "upper", "to", range.upper, unit, all);
  group.data("ideal", range.ideal ? std::optional(*range.ideal / unit.si) : std::nullopt);
  group.data("efficiency", range.efficiency());
  group.data("efficiency_back", range.efficiency_back());
  if (!range.ideal) return;
  group.fact("ideal", with(*range.ideal, unit) + " balances it without friction");
  // A quotient with an end of the range is known no better than that end.
  const auto part = [](const HeldEnd& end) {
    return end.radius > 0.0 && std::isfinite(end.value) ? end.radius / std::abs(end.value) : 0.0;
  };
  const double known_to = std::max(part(range.lower), part(range.upper));
  const auto quotient = [&](double value) { return significant(value, 6, known_to * value); };
  if (range.efficiency()) {
    group.fact("efficiency", fmt::format("{} where {} drives it", quotient(*range.efficiency()), view.number));
  }
  if (range.efficiency_back()) {
    const double back = *range.efficiency_back();
    group.fact("driven back", back > 0 ? quotient(back) : "not at all: it locks by itself");
  }
}

void add_efforts(Group& content, const StaticModel& model, const HeldPose& pose, const std::vector<Rubbing>& all) {
  if (pose.efforts.size() != all.size()) return;
  const auto quantity = [&](std::size_t i) { return all[i].on.is_angle() ? Quantity::moment : Quantity::force; };
  const std::vector<std::size_t> rows = places(all.size());
  Table& table = content.table(
      "friction", "Friction that holds it with the least share of the bounds, in double precision", Rows::list);
  table.words("name", "joint", each(all, &Rubbing::name));
  table.words("kind", "kind", each(all, [](const Rubbing& one) { return std::string(one.kind); }));
  const auto add = [&](const std::string& key, const char* title, double FrictionEffort::*number) {
    const auto in_units = [&](std::size_t i) {
      return in_unit(pose.efforts[i].*number, quantity(i), model.scene().units);
    };
    table.numbers(key, title, "", each(rows, in_units)).texts =
        each(rows, [&](std::size_t i) { return with_unit(model, pose.efforts[i].*number, quantity(i)); });
  };
  add("effort", "friction", &FrictionEffort::effort);
  add("bound", "bound", &FrictionEffort::bound);
  const auto unit = [&](std::size_t i) { return unit_name(quantity(i), model.scene().units); };
  table.words("unit", "", each(rows, unit)).shown = false;
}

std::string margin_in_words(const HeldPose& pose) {
  const double k = pose.least_factor;
  if (std::isnan(k)) return "";
  if (k == 0.0) return "in equilibrium without friction";
  if (std::isinf(k)) return "no friction in these joints would hold it";
  const double bracket = pose.factor_upper - pose.factor_lower;
  const double radius = std::isnan(bracket) ? 0.0 : bracket;
  if (k < 1.0) {
    return fmt::format("{} of it suffices: a safety of {}", significant(k, 6, radius),
                       significant(1 / k, 6, radius / (k * k)));
  }
  return fmt::format("{} times as much would be needed", significant(k, 6, radius));
}

/// ": uses 69.9 % of it, a safety of 1.43"; empty where it needs none.
std::string share_in_words(const HeldPose& pose) {
  const double k = pose.least_factor;
  if (!(k > 0.0 && k < 1.0)) return "";
  constexpr int digits = 3;
  return fmt::format(": uses {} % of it, a safety of {}", significant(100.0 * k, digits), significant(1.0 / k, digits));
}

std::string bracket_in_words(const HeldPose& pose) {
  if (!std::isfinite(pose.factor_lower) || !std::isfinite(pose.factor_upper)) return "in double precision";
  return fmt::format("proved to {}", small_number(pose.factor_upper - pose.factor_lower));
}

Line verdict_of(const HeldPose& pose, const HoldView& view) {
  const std::string where = view.at_rest ? "at the equilibrium without friction" : "as drawn";
  const std::string doubt = pose.proved ? "" : ", in double precision";
  switch (pose.verdict) {
    case Holding::held:
      return {.text = fmt::format("Held by friction {}{}{}.", where, doubt, share_in_words(pose)),
              .tone = pose.proved ? Tone::good : Tone::doubtful};
    case Holding::slips:
      return {.text = fmt::format("Slips {}{}: friction cannot hold it.", where, doubt),
              .tone = pose.proved ? Tone::plain : Tone::doubtful};
    case Holding::not_decided:
      break;
  }
  return bad(fmt::format("Not decided {}: {}.", where, pose.why));
}

}  // namespace

std::string held_in_words(const HeldPose& pose) {
  const std::string margin = margin_in_words(pose);
  std::string out(word_of(pose.verdict));
  if (pose.verdict == Holding::not_decided) return out + ": " + pose.why;
  out += pose.proved ? " (proved)" : " (in double precision)";
  return margin.empty() ? out : out + "; " + margin;
}

void add_held_data(Group& group, const StaticModel& model, const HeldPose& pose) {
  const std::vector<Rubbing> all = rubbing(model.scene());
  group.data("verdict", std::string(word_of(pose.verdict)));
  group.data("proved", pose.proved);
  group.data("why", pose.why);
  group.data("least_factor", finite(pose.least_factor));
  group.data("safety", finite(1.0 / pose.least_factor));
  group.data("factor_lower", finite(pose.factor_lower));
  group.data("factor_upper", finite(pose.factor_upper));
  add_slips(group, all, pose.slips);
}

Result hold_result(const StaticModel& model, const std::vector<double>& x, const HeldPose& pose, const HoldView& view,
                   const std::vector<std::string>& settings) {
  Result out = scene_result(model.scene(), settings);
  const std::vector<Rubbing> all = rubbing(model.scene());
  out.verdict = verdict_of(pose, view);
  warn_of_unloaded_bearings(out, model.scene());
  if (view.range && view.range->any) {
    out.verdict.text +=
        fmt::format(" It holds {}.", range_in_words(*view.range, view, unit_of(model.scene(), view.number)));
  }
  Group& content = out.content;
  content.data("at_rest", view.at_rest);
  add_held_data(content, model, pose);
  content.fact("friction", margin_in_words(pose));
  if (pose.least_factor > 0.0 && std::isfinite(pose.least_factor)) {
    content.fact("margin", bracket_in_words(pose), Tone::plain, Verbosity::verbose);
  }
  if (!pose.slips.empty()) content.fact("slips first", slips_in_words(all, pose.slips));
  if (view.range) add_range(content, model, *view.range, view, all);
  add_efforts(content, model, pose, all);
  add_forces_on_bodies(content, model, {pose.on_bodies});
  add_coordinate_data(content, "pose", model, x);
  const Readings readings = read_off(model, x);
  add_coordinates(content, model, {&readings}, {"pose"}, view.radius);
  return out;
}

}  // namespace poise::app
