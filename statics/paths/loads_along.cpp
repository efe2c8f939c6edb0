#include "statics/paths/loads_along.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "statics/model/mobility.hpp"

namespace poise {
namespace {

bool can_move(const StaticModel& model) {
  return model.mechanism().coordinates() > 0 && analyse_mobility(model).freedoms > 0;
}

/// In balance at each value, as far as it is.
LoadsAlong along_structure(const VariedScene& varied, const PathOptions& options) {
  LoadsAlong out;
  out.is_structure = true;
  out.found.status = Path::Status::traced;
  for (const double value : options.at) {
    const std::unique_ptr<StaticModel> model = varied.model_at(value);
    const Equilibrium held = solve_or_hold(*model);
    if (held.status != Status::checked) {
      out.found.status = Path::Status::incomplete;
      out.found.why = held.why;
      return out;
    }
    LoadsAt& here = out.loads.emplace_back();
    here.point.parameter = value;
    here.point.x = held.x;
    here.check = held.check;
    if (has_links(model->scene())) here.links = link_loads(model->scene(), model->poses(held.x), held.check);
  }
  return out;
}

}  // namespace

bool LoadsAt::has_all_links() const {
  return std::all_of(links.begin(), links.end(), [](const LinkLoads& link) { return link.why.empty(); });
}

LoadsAlong loads_along(const VariedScene& varied, const PathOptions& options) {
  if (!varied.is_driven() && !can_move(*varied.model_at(varied.from()))) return along_structure(varied, options);
  LoadsAlong out;
  out.found = path(varied, options);
  for (const std::vector<PathPoint>& wanted : out.found.wanted) {
    for (const PathPoint& point : wanted) {
      const std::unique_ptr<StaticModel> model = varied.model_at(point.parameter);
      const Scene& scene = model->scene();
      const int held = static_cast<int>(scene.stops.size()) - 1;
      std::vector<int> active = point.active_stops;
      if (varied.is_driven()) active.push_back(held);
      LoadsAt& here = out.loads.emplace_back();
      here.point = point;
      here.check = check(*model, point.x, {}, &active);
      if (has_links(scene)) here.links = link_loads(scene, model->poses(point.x), here.check);
      if (!varied.is_driven()) continue;
      std::erase_if(here.check.reactions, [&](const Reaction& reaction) { return reaction.stop == held; });
    }
  }
  return out;
}

}  // namespace poise
