#include "app/results/motion/contact_events.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/draw/chart/motion_charts.hpp"
#include "app/result/numbers.hpp"
#include "app/results/parts.hpp"
#include "model/joint_friction.hpp"

namespace poise::app {
namespace {

const Stop& stop_of(const Scene& scene, const ContactEvent& event) {
  return scene.stops[static_cast<std::size_t>(event.at.stop)];
}

constexpr int digits_of_events = 6;

}  // namespace

void add_contact_events(Group& group, const MotionModel& model, const Motion& motion) {
  const Scene& scene = model.scene();
  const Units& units = scene.units;
  Branch& events = group.array("events");
  std::vector<double> times;
  std::vector<std::string> whats, names, before, after, impulses, losses;
  double lost = 0.0;
  for (const ContactEvent& event : motion.events) {
    const Stop& stop = stop_of(scene, event);
    const Quantity of = quantity_of(stop.on);
    const Quantity effort = effort_of(stop.on);  // an impulse is one over time
    Group& one = events.parts.emplace_back();
    one.data("t", event.t);
    one.data("what", to_string(event.kind));
    one.data("name", stop.name);
    one.data("side", event.at.upper ? "max" : "min");
    one.data("rate_before", event.rate_before / unit_value(of, units));
    one.data("rate_after", event.rate_after / unit_value(of, units));
    one.data("impulse", event.impulse / unit_value(effort, units));
    one.data("energy_lost", event.energy_lost / unit_value(Quantity::energy, units));
    one.data("unique", event.unique);
    lost += event.energy_lost;
    if (times.size() >= shown_contact_events) continue;
    const bool hits = event.kind == ContactEvent::Kind::impact;
    times.push_back(event.t);
    whats.push_back(words_of(event, stop) + (event.unique ? "" : " (one of several)"));
    names.push_back(side_of(event, stop));
    before.push_back(hits ? amount(event.rate_before, of, units, digits_of_events, "/s") : "");
    after.push_back(hits ? amount(event.rate_after, of, units, digits_of_events, "/s") : "");
    impulses.push_back(hits ? amount(event.impulse, effort, units, digits_of_events, " s") : "");
    losses.push_back(hits ? amount(event.energy_lost, Quantity::energy, units, digits_of_events) : "");
  }
  if (motion.events.empty()) return;
  const std::size_t more = motion.events.size() - times.size();
  Table& table = group.table("", "Contacts", Rows::list);
  std::vector<std::string> numbers;
  for (std::size_t k = 0; k < times.size(); ++k) numbers.push_back(std::to_string(k + 1));
  table.words("", "mark", std::move(numbers));
  table.numbers("", "at", "s", std::move(times), {.style = Format::Style::significant});
  table.words("", "what", std::move(whats));
  table.words("", "of", std::move(names));
  table.words("", "gap's rate before", std::move(before));
  table.words("", "after", std::move(after));
  table.words("", "impulse", std::move(impulses));
  table.words("", "energy lost", std::move(losses));
  group.fact("impacts", fmt::format("{} in all take {}{}", count(motion.events.size(), "event", "events"),
                                    amount(lost, Quantity::energy, units, digits_of_events),
                                    more > 0 ? fmt::format("; {} more are in the JSON", more) : ""));
}

Table table_of_contact_events(const MotionModel& model, const Motion& motion) {
  const Scene& scene = model.scene();
  const std::vector<ContactEvent>& events = motion.events;
  const auto in_units = [&](double ContactEvent::*member, Quantity (*quantity)(const Measure&)) {
    return each(events, [&](const ContactEvent& event) {
      return in_unit(event.*member, quantity(stop_of(scene, event).on), scene.units);
    });
  };
  Table table;
  table.data("t", each(events, &ContactEvent::t));
  table.words("what", "", each(events, [](const ContactEvent& event) { return to_string(event.kind); }));
  table.words("name", "", each(events, [&](const ContactEvent& event) { return stop_of(scene, event).name; }));
  table.words("side", "", each(events, [](const ContactEvent& event) { return event.at.upper ? "max" : "min"; }));
  table.data("rate_before", in_units(&ContactEvent::rate_before, poise::quantity_of));
  table.data("rate_after", in_units(&ContactEvent::rate_after, poise::quantity_of));
  table.data("impulse", in_units(&ContactEvent::impulse, effort_of));
  table.data("energy_lost", in_unit(each(events, &ContactEvent::energy_lost), Quantity::energy, scene.units));
  table.words("unique", "", each(events, [](const ContactEvent& event) { return event.unique ? "yes" : "no"; }));
  return table;
}

void warn_of_contacts(Result& out, const Scene& scene, const Motion& motion) {
  const bool hits = std::any_of(motion.events.begin(), motion.events.end(),
                                [](const ContactEvent& event) { return event.kind == ContactEvent::Kind::impact; });
  for (int j = 0; hits && j < static_cast<int>(scene.joints.size()); ++j) {
    if (!grips(scene, j)) continue;
    out.warnings.push_back(doubtful(
        fmt::format("Friction in \"{}\" has no part in the impacts.", scene.joints[static_cast<std::size_t>(j)].name)));
    break;
  }
  const auto first =
      std::find_if(motion.events.begin(), motion.events.end(), [](const ContactEvent& event) { return !event.unique; });
  if (first == motion.events.end()) return;
  const std::string name = stop_of(scene, *first).name;
  const std::string when = fmt::format("From t = {} s on the motion is one of several", significant(first->t, 6));
  const bool grazes = first->kind == ContactEvent::Kind::graze || std::abs(first->impulse) == 0.0;
  out.warnings.push_back(doubtful(
      grazes ? fmt::format("{}: \"{}\" is touched so gently that whether it is is not known.", when, name)
             : fmt::format("{}: at \"{}\" several stops are hit at once, or one that is only just reached, and what "
                           "follows depends on their order, which rigid bodies do not tell.",
                           when, name)));
}

}  // namespace poise::app
