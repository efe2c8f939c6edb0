#include "statics/paths/private/branch_curve.hpp"

#include <algorithm>
#include <variant>

#include <fmt/format.h>

#include "statics/bodies/body_measures.hpp"

namespace poise {

std::optional<PathPoint> BranchCurve::between(std::size_t k, double t) {
  const PathPoint &a = branch_.points[k], &b = branch_.points[k + 1];
  if (t == 0.0) return a;
  if (t == 1.0) return b;
  if (k != prepared_) prepare(k);
  for (const std::optional<PathSpot>& spot : spots_) {
    std::optional<PathPoint> point = spot ? between(*spot, k, t) : std::nullopt;
    if (point && is_consistent(*point)) return point;
  }
  return std::nullopt;
}

std::vector<double> BranchCurve::values(const std::vector<SoughtQuantity>& of, const PathPoint& point,
                                        std::string& why) {
  std::vector<double> out;
  for (const QuantityValue& one : reader_.values(of, point)) {
    out.push_back(one.value);
    if (why.empty() && !one.why.empty()) {
      why = fmt::format("it is undefined at {} = {:.6g} {}: {}", varied_.name(), point.parameter / varied_.unit(),
                        varied_.unit_name(), one.why);
    }
  }
  return out;
}

std::optional<PathPoint> BranchCurve::between(PathSpot spot, std::size_t k, double t) {
  const PathPoint &a = branch_.points[k], &b = branch_.points[k + 1];
  solvers::Curve& curve = pieces_.curve(spot.piece);
  Eigen::VectorXd chord = Eigen::VectorXd::Zero(spot.point.z.size());
  const Eigen::Index n = curve.variables();
  const Eigen::VectorXd from = Eigen::VectorXd::Map(a.x.data(), n), to = Eigen::VectorXd::Map(b.x.data(), n);
  const double p_from = varied_.part_at(a.parameter), p_to = varied_.part_at(b.parameter);
  chord.head(n) = to - from;
  chord[chord.size() - 1] = p_to - p_from;
  if (chord.isZero()) return std::nullopt;
  spot.point.z.head(n) = (1 - t) * from + t * to;
  spot.point.z[chord.size() - 1] = (1 - t) * p_from + t * p_to;
  if (!curve.correct(spot.point.z, chord / chord.norm()).converged) return std::nullopt;
  return pieces_.report(spot);
}

// Springs act and stops hold there as the piece of curve says: at an event one end is of another piece.
bool BranchCurve::is_consistent(const PathPoint& point) {
  constexpr double rounding = 1e-9;
  const Scene scene = varied_.scene_at(point.parameter);
  const StaticModel& model = reader_.model(point);
  std::vector<BodyPose<double>> poses = model.poses(point.x);
  poses.resize(scene.bodies.size());
  const auto nothing = [&](const Measure& on) { return rounding / on.dimension().per_scale(varied_.scales()); };
  for (std::size_t e = 0; e < scene.elements.size(); ++e) {
    const auto* spring = std::get_if<LinearSpring>(&scene.elements[e].law);
    if (spring == nullptr || spring->acts == LinearSpring::Acts::both) continue;
    const double stretch = value_of(scene, scene.elements[e].on, poses) - spring->free_length;
    const bool acts = (spring->acts == LinearSpring::Acts::tension) == (stretch > 0.0);
    const bool is_slack = std::find(point.slack_springs.begin(), point.slack_springs.end(), static_cast<int>(e)) !=
                          point.slack_springs.end();
    if (acts == is_slack && std::abs(stretch) > nothing(scene.elements[e].on)) return false;
  }
  for (const Stop& stop : scene.stops) {
    const double g = value_of(scene, stop.on, poses), aside = nothing(stop.on);
    if (g < stop.min - aside || g > stop.max + aside) return false;
  }
  return true;
}

// The multipliers of both ends, from which those between are found: where the piece changes at one end, the stops of
// the other hold between.
void BranchCurve::prepare(std::size_t k) {
  prepared_ = k;
  const PathPoint &a = branch_.points[k], &b = branch_.points[k + 1];
  const std::vector<int>& active = (a.active_stops.size() <= b.active_stops.size() ? a : b).active_stops;
  spots_ = {pieces_.spot(a.x, varied_.part_at(a.parameter), active, 1.0),
            pieces_.spot(b.x, varied_.part_at(b.parameter), active, 1.0)};
}

}  // namespace poise
