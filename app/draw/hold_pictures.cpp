#include "app/draw/hold_pictures.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <list>
#include <utility>

#include <fmt/format.h>

#include "app/draw/followed.hpp"
#include "app/draw/frames.hpp"
#include "app/draw/mechanism.hpp"
#include "app/result/numbers.hpp"
#include "model/parameters.hpp"
#include "statics/bodies/body_measures.hpp"

namespace poise::app {
namespace {

/// In the middle of the two bodies' points of a [[friction]] on a distance, at the centre of a pulley, at a joint's
/// second point.
std::vector<Vec2> places_of(const Scene& scene, const std::vector<Slip>& slips, const Poses& poses) {
  const std::vector<Rubbing> all = rubbing(scene);
  std::vector<Vec2> out;
  for (const Slip& slip : slips) {
    const Rubbing& one = all[slip.of];
    if (one.joint >= 0 || one.rope >= 0) {
      const PointRef at = one.joint >= 0 ? scene.joints[static_cast<std::size_t>(one.joint)].b
                                         : one.on.contacts[static_cast<std::size_t>(one.contact)].at;
      out.push_back(poses[static_cast<std::size_t>(at.body)].world(scene.local(at)));
      continue;
    }
    const std::vector<UnitEffort> efforts = unit_efforts(scene, one.on, poses);
    if (!efforts.empty()) out.push_back(0.5 * (efforts.front().a + efforts.front().b));
  }
  return out;
}

MechanismPicture picture_of_hold(const StaticModel& model, const std::vector<double>& x, const std::vector<Slip>& slips,
                                 const std::string& heading, bool decided) {
  MechanismPicture out{.poses = model.poses(x), .heading = heading, .confirmed = decided};
  out.slipping = places_of(model.scene(), slips, out.poses);
  return out;
}

/// "floor and wall".
std::string names_of(const Scene& scene, const std::vector<Slip>& slips) {
  const std::vector<Rubbing> all = rubbing(scene);
  std::vector<std::string> names;
  for (const Slip& slip : slips) names.push_back(all[slip.of].name);
  return listed(names);
}

/// The values shown, SI: the range that is held and a third of it on both sides, where the number may go there; beside
/// an end, or in place of one that is infinite, twice the size of what is known.
std::pair<double, double> span_of(const HeldRange& range) {
  constexpr double beyond = 1.0 / 3;
  const double low = range.lower.value, high = range.upper.value;
  double size = std::abs(range.present);
  for (const double end : {low, high}) {
    if (std::isfinite(end)) size = std::max(size, std::abs(end));
  }
  if (size == 0.0) size = 1.0;
  const double width = std::isfinite(low) && std::isfinite(high) && high > low ? high - low : size;
  // Numbers that may not be negative stay positive.
  const double below = std::max(low - beyond * width, low > 0.0 ? low / 2 : -std::numeric_limits<double>::infinity());
  const double from = std::isinf(low) ? std::min(range.present, high) - 2 * size : range.lower.at_limit ? low : below;
  const double to = std::isinf(high)       ? std::max(range.present, low) + 2 * size
                    : range.upper.at_limit ? high
                                           : high + beyond * width;
  return {from, to};
}

/// A number of a scene, or "loads", a factor of all loads.
class Numbered {
 public:
  Numbered(const Scene& scene, const std::string& name) : scene_(scene), name_(name) {
    if (name == "loads") {
      for (int f = 0; f < static_cast<int>(scene.forces.size()); ++f) places_.push_back({Owner::force, f});
      for (int t = 0; t < static_cast<int>(scene.torques.size()); ++t) places_.push_back({Owner::torque, t});
      for (const ParameterPlace& place : places_) whole_.push_back(value_at(scene, place).value_or(0.0));
      return;
    }
    const ParameterRow row = parameter(scene, name);
    si = row.dimension.unit(scene.units);
    unit = row.dimension.unit_name(scene.units);
    if (row.place.owner != Owner::number) places_ = {row.place};
  }
  /// The scene where the number has a value, SI. A force may be negative: it is reversed.
  Scene at(double value) const {
    Scene out = scene_;
    if (places_.empty()) set_value(out, name_, value / si);
    for (std::size_t i = 0; i < places_.size(); ++i)
      set_value_at(out, places_[i], whole_.empty() ? value : whole_[i] * value);
    return out;
  }

  double si = 1.0;     ///< of one unit
  std::string unit{};  ///< its name

 private:
  const Scene& scene_;
  std::string name_;
  std::vector<ParameterPlace> places_;  ///< none of a named number, on which others depend
  std::vector<double> whole_;           ///< of loads: their values at the factor 1
};

}  // namespace

std::string hold_picture(const StaticModel& model, const std::vector<double>& x, const HeldPose& pose,
                         const std::string& heading, bool decided) {
  return draw_mechanism(model.scene(), picture_of_hold(model, x, pose.slips, heading, decided));
}

Figure hold_figure(const StaticModel& model, const std::vector<double>& x, const HeldPose& pose,
                   const std::string& heading, bool decided) {
  const Position position{.scene = &model.scene(),
                          .picture = picture_of_hold(model, x, pose.slips, heading, decided),
                          .tone = pose.verdict == Holding::held ? Tone::good : Tone::bad};
  return {.title = "The position", .drawing = draw_frames({position}, "The mechanism, with what slips first")};
}

Figure hold_figure(const StaticModel& model, const std::vector<double>& x, const HeldRange& range,
                   const std::string& number, const std::string& heading, bool decided) {
  constexpr std::size_t frames = 61;
  const auto [from, to] = span_of(range);
  if (!range.any || !(from < to)) return hold_figure(model, x, range.now, heading, decided);
  const Scene& scene = model.scene();
  const Numbered numbered(scene, number);
  Play play{.label = number, .unit = numbered.unit};
  std::list<Scene> scenes;
  std::vector<Position> positions;
  // The nearest of equal parts gives way to the scene's own value, where the page opens.
  const double part = std::clamp((range.present - from) / (to - from), 0.0, 1.0);
  const auto own = static_cast<std::size_t>(std::lround(part * (frames - 1)));
  play.rest = own;
  for (std::size_t k = 0; k < frames; ++k) {
    const double value =
        k == own ? std::clamp(range.present, from, to) : from + (to - from) * static_cast<double>(k) / (frames - 1);
    const bool is_above = value > range.upper.value;
    const bool is_held = value >= range.lower.value && !is_above;
    const std::vector<Slip> slips = is_held ? std::vector<Slip>{} : (is_above ? range.upper : range.lower).slips;
    const std::string verdict = is_held ? "held" : slips.empty() ? "slips" : "slips: " + names_of(scene, slips);
    const std::string caption = fmt::format("{} = {}{}{}: {}", number, significant(value / numbered.si, 4),
                                            numbered.unit.empty() ? "" : " ", numbered.unit, verdict);
    scenes.push_back(numbered.at(value));
    positions.push_back({.scene = &scenes.back(),
                         .picture = picture_of_hold(model, x, slips, caption, decided),
                         .tone = is_held ? Tone::good : Tone::bad});
    play.values.push_back(value / numbered.si);
  }
  Figure figure{.title = "Held or not, as " + number + " changes"};
  animate(figure, std::move(positions), std::move(play), "The mechanism, with what slips", {});
  return figure;
}

}  // namespace poise::app
