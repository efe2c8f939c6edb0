#include "statics/paths/loads_along.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "statics/model/mobility.hpp"
#include "statics/paths/private/branch_curve.hpp"
#include "statics/paths/private/extremes.hpp"

namespace poise {
namespace {

constexpr double no_load = std::numeric_limits<double>::quiet_NaN();

bool can_move(const StaticModel& model) {
  return model.mechanism().coordinates() > 0 && analyse_mobility(model).freedoms > 0;
}

/// Of a structure; empty where it is not in balance, `why` says what it lacks.
std::optional<LoadsAt> held_at(const VariedScene& varied, double value, std::string& why) {
  const std::unique_ptr<StaticModel> model = varied.model_at(value);
  const Equilibrium held = solve_or_hold(*model);
  if (held.status != Status::checked) {
    why = held.why;
    return std::nullopt;
  }
  LoadsAt out;
  out.point.parameter = value;
  out.point.x = held.x;
  out.check = held.check;
  if (has_links(model->scene())) out.links = link_loads(model->scene(), model->poses(held.x), held.check);
  return out;
}

LoadsAt loads_at(const VariedScene& varied, const PathPoint& point) {
  const std::unique_ptr<StaticModel> model = varied.model_at(point.parameter);
  const Scene& scene = model->scene();
  const int held = static_cast<int>(scene.stops.size()) - 1;
  std::vector<int> active = point.active_stops;
  if (varied.is_driven()) active.push_back(held);
  LoadsAt out;
  out.point = point;
  out.check = check(*model, point.x, {}, &active);
  if (has_links(scene)) out.links = link_loads(scene, model->poses(point.x), out.check);
  if (varied.is_driven()) {
    std::erase_if(out.check.reactions, [&](const Reaction& reaction) { return reaction.stop == held; });
  }
  return out;
}

/// What is read of the loads in an equilibrium, and by what the largest is found.
struct LoadReading {
  double value = no_load, at = 0.0, load = no_load, s = no_load;
};

constexpr Dimension stress_of_links = dimension::force * dimension::length.power(-2);

struct OfLink {
  const char* key;
  LargestOnLink LinkLoads::*value;
  Dimension dimension;
};
constexpr std::array<OfLink, 6> of_link{{{"normal", &LinkLoads::normal, dimension::force},
                                         {"shear", &LinkLoads::shear, dimension::force},
                                         {"moment", &LinkLoads::moment, dimension::torque},
                                         {"tension", &LinkLoads::tension, stress_of_links},
                                         {"compression", &LinkLoads::compression, stress_of_links},
                                         {"deflection", &LinkLoads::deflection, dimension::length}}};

/// One series, and how it is read.
struct Told {
  LoadSeries series;
  std::function<LoadReading(const LoadsAt&)> read;
};

/// Whether a joint is between two parts of one flexible link.
bool is_within_link(const Scene& scene, const Joint& joint) {
  return std::any_of(scene.flexible_links.begin(), scene.flexible_links.end(), [&](const FlexibleLink& link) {
    const auto has = [&](int body) {
      return std::find(link.bodies.begin(), link.bodies.end(), body) != link.bodies.end();
    };
    return has(joint.a.body) && has(joint.b.body);
  });
}

/// The size of each joint's force; tension of a bar with its sign.
std::vector<Told> of_joints(const Scene& scene) {
  std::vector<Told> out;
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    const Joint& joint = scene.joints[j];
    if (is_within_link(scene, joint)) continue;
    const bool is_bar = joint.keeps_length();
    const auto read = [j, is_bar](const LoadsAt& here) {
      LoadReading out_of{.at = here.point.parameter};
      for (const Reaction& reaction : here.check.reactions) {
        if (reaction.joint != static_cast<int>(j) || !reaction.determined) continue;
        out_of.value = out_of.load = is_bar ? reaction.axial : norm(reaction.force);
      }
      return out_of;
    };
    out.push_back({{joint.name, is_bar ? "axial" : "size", dimension::force, {}, {}, {}}, read});
  }
  return out;
}

/// The largest loads of each link.
std::vector<Told> of_links(const LoadsAt& any) {
  std::vector<Told> out;
  for (std::size_t l = 0; l < any.links.size(); ++l) {
    for (const OfLink& of : of_link) {
      if (any.links[l].flexible && of.value == &LinkLoads::deflection) continue;  // it is drawn as it is bent
      const auto read = [l, value = of.value](const LoadsAt& here) {
        LoadReading out_of{.at = here.point.parameter};
        const LinkLoads& link = here.links[l];
        if (!link.why.empty()) return out_of;
        const LargestOnLink& largest = link.*value;
        out_of.load = largest.value;
        out_of.value = std::abs(largest.value);
        out_of.s = largest.s;
        return out_of;
      };
      out.push_back({{any.links[l].name, of.key, of.dimension, {}, {}, {}}, read});
    }
  }
  return out;
}

/// A stretch of the range on which loads change without a jump: places in their order, and what lies between them.
class Stretch {
 public:
  using Between = std::function<std::optional<LoadsAt>(std::size_t k, double t)>;
  Stretch(std::vector<LoadsAt> places, double range, Between between)
      : places_(std::move(places)), range_(range), between_(std::move(between)) {}

  /// The least value on it (sense -1), or the largest (1).
  LoadReading extreme(const Told& told, double sense) {
    std::vector<LoadReading> samples;
    for (const LoadsAt& place : places_) samples.push_back(told.read(place));
    const Extremes<LoadReading> extremes(std::move(samples), range_,
                                         [&](std::size_t k, double t) -> std::optional<LoadReading> {
                                           const auto [found, is_new] = met_.try_emplace({k, t});
                                           if (is_new) found->second = between_(k, t);
                                           if (!found->second) return std::nullopt;
                                           return told.read(*found->second);
                                         });
    const std::vector<LoadReading> found = extremes.find(sense);
    if (found.empty()) return {};
    LoadReading out = found.front();
    if (extremes.is_unbounded(out))
      out.value = out.load = std::copysign(std::numeric_limits<double>::infinity(), out.load);
    return out;
  }

 private:
  std::vector<LoadsAt> places_;
  double range_;
  Between between_;
  std::map<std::pair<std::size_t, double>, std::optional<LoadsAt>> met_;  // many values are sought at the same places
};

LoadExtreme extreme_over(std::vector<Stretch>& stretches, const std::vector<LoadsAt>& loads, const Told& told,
                         double sense) {
  LoadReading best;
  const auto take = [&](const LoadReading& one) {
    if (std::isnan(best.value) || sense * one.value > sense * best.value) best = one;
  };
  for (Stretch& stretch : stretches) take(stretch.extreme(told, sense));
  for (const LoadsAt& here : loads) take(told.read(here));
  return {best.load, std::isnan(best.value) ? no_load : best.at, best.s};
}

/// What is less than rounding of the forces of the whole mechanism, or than its extremes are found to, is nothing.
void forget_rounding(std::vector<LoadSeries>& all, const Scales& scales) {
  constexpr double of_scale = 1e-13, of_alike = 1e-12, of_own = 10 * extreme_accuracy;
  for (LoadSeries& one : all) {
    double alike = 0.0;
    for (const LoadSeries& other : all) {
      if (other.dimension != one.dimension) continue;
      for (const double value : {other.least.value, other.largest.value}) {
        if (std::isfinite(value)) alike = std::max(alike, std::abs(value));
      }
    }
    double own = std::max(std::abs(one.least.value), std::abs(one.largest.value));
    if (!std::isfinite(own)) own = 0.0;
    const double nothing = std::max({of_own * own, of_alike * alike, of_scale / one.dimension.per_scale(scales)});
    for (LoadExtreme* extreme : {&one.least, &one.largest}) {
      if (std::abs(extreme->value) <= nothing) extreme->value = 0.0;
    }
  }
}

std::vector<LoadSeries> series_of(std::vector<Told> all, const std::vector<LoadsAt>& loads,
                                  std::vector<Stretch>& stretches, const Scales& scales) {
  std::vector<LoadSeries> out;
  for (Told& told : all) {
    for (const LoadsAt& here : loads) told.series.values.push_back(told.read(here).load);
    told.series.least = extreme_over(stretches, loads, told, -1.0);
    told.series.largest = extreme_over(stretches, loads, told, 1.0);
    out.push_back(std::move(told.series));
  }
  forget_rounding(out, scales);
  return out;
}

}  // namespace

bool LoadsAt::has_all_links() const {
  return std::all_of(links.begin(), links.end(), [](const LinkLoads& link) { return link.why.empty(); });
}

LoadsAlong loads_along(const VariedScene& varied, const PathOptions& options) {
  LoadsAlong out;
  const double range = std::abs(varied.to() - varied.from());
  std::vector<Stretch> stretches;
  std::vector<std::unique_ptr<BranchCurve>> curves;
  if (!varied.is_driven() && !can_move(*varied.model_at(varied.from()))) {
    out.is_structure = true;
    out.found.status = Path::Status::traced;
    for (const double value : options.at) {
      std::optional<LoadsAt> here = held_at(varied, value, out.found.why);
      if (!here) {
        out.found.status = Path::Status::incomplete;
        break;
      }
      out.loads.push_back(std::move(*here));
    }
    stretches.emplace_back(out.loads, range, [&](std::size_t k, double t) {
      std::string why;
      return held_at(varied, (1 - t) * options.at[k] + t * options.at[k + 1], why);
    });
  } else {
    out.found = path(varied, options);
    for (const std::vector<PathPoint>& wanted : out.found.wanted) {
      for (const PathPoint& point : wanted) out.loads.push_back(loads_at(varied, point));
    }
    for (const PathBranch& branch : out.found.branches) {
      std::vector<LoadsAt> places;
      for (const PathPoint& point : branch.points) places.push_back(loads_at(varied, point));
      BranchCurve& curve = *curves.emplace_back(std::make_unique<BranchCurve>(varied, branch));
      stretches.emplace_back(std::move(places), range, [&](std::size_t k, double t) -> std::optional<LoadsAt> {
        const std::optional<PathPoint> point = curve.between(k, t);
        if (!point) return std::nullopt;
        return loads_at(varied, *point);
      });
    }
  }
  if (out.loads.empty()) return out;
  out.joints = series_of(of_joints(varied.scene()), out.loads, stretches, varied.scales());
  out.links = series_of(of_links(out.loads.front()), out.loads, stretches, varied.scales());
  return out;
}

}  // namespace poise
