#include "tests/app/fabricated_path.hpp"

#include <cmath>
#include <string>

#include "model/scene.hpp"
#include "tests/app/run_poise.hpp"

namespace poise::app_tests {
namespace {

constexpr double stiffness = 1000.0, free_length = 1.118033988749894848204587;
constexpr double fold_height = 0.277880091075164758518, fold_load = 42.9143257312246876869530451065;

double load(double y) {
  const double length = std::sqrt(1 + y * y);
  return 2 * stiffness * (free_length - length) * y / length;
}

}  // namespace

VariedScene varied_toggle() { return {read_scene(dataset("von_mises_toggle")), "load.P", 0.0, 60.0}; }

Path toggle_path(const VariedScene& varied) {
  const auto at = [&](double y, double load, Stability stability) {
    PathPoint point;
    point.parameter = load;
    point.stability = stability;
    point.proof = PointProof::proved;
    point.x = varied.model_at(varied.generic())->from_si({y});
    point.unstable_directions = stability == Stability::unstable ? 1 : 0;
    const double stretch = std::sqrt(1 + y * y) - free_length;
    point.energy = stiffness * stretch * stretch + load * y;
    point.radius = 1e-14;
    point.statement = "proved by hand";
    return point;
  };
  Path path;
  path.status = Path::Status::traced;
  PathBranch& branch = path.branches.emplace_back();
  for (int i = 50; i >= -62; --i) {
    const double y = 0.01 * i;
    if (load(y) > 60) break;
    branch.points.push_back(at(y, load(y), std::abs(y) < fold_height ? Stability::unstable : Stability::stable));
  }
  for (const double side : {1.0, -1.0}) {
    PathEvent fold;
    fold.at = at(side * fold_height, side * fold_load, Stability::neutral);
    fold.error = 3e-15;
    fold.rounding_effect = 1e-15;
    branch.events.push_back(static_cast<int>(path.events.size()));
    path.events.push_back(fold);
  }
  PathEvent snap = path.events.front();
  snap.kind = PathEvent::Kind::snap;
  snap.landing = at(-0.6, fold_load, Stability::stable);
  path.events.push_back(snap);
  path.steps = static_cast<int>(branch.points.size());
  return path;
}

}  // namespace poise::app_tests
