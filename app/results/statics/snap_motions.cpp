#include "app/results/statics/snap_motions.hpp"

#include <cstddef>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/result/each.hpp"
#include "app/result/numbers.hpp"
#include "app/results/parts.hpp"

namespace poise::app {
namespace {

constexpr int digits_of_snaps = 5;

const Stop& stop_hit(const Scene& scene, const SnapMotion& motion) {
  return scene.stops[static_cast<std::size_t>(motion.hit->at.stop)];
}

std::vector<std::string> touched_in(const Scene& scene, const SnapMotion& motion) {
  return each(motion.touched, [&](int stop) { return scene.stops[static_cast<std::size_t>(stop)].name; });
}

std::string in_words(const Scene& scene, const SnapMotion& motion) {
  if (!motion.why.empty()) return motion.why;
  std::string text;
  if (motion.hit) {
    const Stop& stop = stop_hit(scene, motion);
    text = fmt::format("it hits {} after {} s at {}, which takes {}; ", stop.title(),
                       significant(motion.hit->t, digits_of_snaps),
                       amount(-motion.hit->rate_before, quantity_of(stop.on), scene.units, digits_of_snaps, "/s"),
                       amount(motion.hit->energy_lost, Quantity::energy, scene.units, digits_of_snaps));
  }
  if (!motion.rests) {
    return text + fmt::format("it still moves after {} s: little damps it", significant(motion.time, digits_of_snaps));
  }
  text += fmt::format("it comes to rest after {} s", significant(motion.time, digits_of_snaps));
  const std::vector<std::string> against = touched_in(scene, motion);
  return text + (against.empty() ? "" : " against " + listed(against));
}

}  // namespace

void add_snap_motions(Group& content, const VariedScene& varied, const Path& found, const PathView& view) {
  const Scene& scene = varied.scene();
  Branch& snaps = content.array("snaps");
  for (const auto& [event, motion] : view.motions) {
    Group& one = snaps.parts.emplace_back();
    const double at = found.events[event].at.parameter / varied.unit();
    one.data("event", event);
    one.data("parameter", at);
    one.data("why", motion.why.empty() ? Value() : Value(motion.why));
    one.data("rests", motion.rests);
    one.data("time", motion.time);
    if (motion.hit) {
      const Stop& stop = stop_hit(scene, motion);
      Group& hit = one.group("hit", "", Verbosity::data);
      hit.data("name", stop.name);
      hit.data("t", motion.hit->t);
      hit.data("rate", -motion.hit->rate_before / unit_value(quantity_of(stop.on), scene.units));
      hit.data("energy_lost", motion.hit->energy_lost / unit_value(Quantity::energy, scene.units));
    } else {
      one.data("hit", nullptr);
    }
    std::vector<std::string> names;
    std::vector<double> values;
    one.data("against", touched_in(scene, motion));
    for (std::size_t c = 0; c < motion.end.size(); ++c) {
      names.push_back(motion.channels[c].name);
      values.push_back(motion.end[c] / unit_value(motion.channels[c].quantity, scene.units));
    }
    Table& end = one.table("end", "", Rows::by_name, Verbosity::data);
    end.words("name", "", names);
    end.data("value", values);
    content.fact("snap", fmt::format("at {} = {}: {}", varied.name(), significant(at, 6), in_words(scene, motion)));
  }
}

}  // namespace poise::app
