#include "statics/inverse/private/sought_numbers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "statics/quantities/linear_response.hpp"

namespace poise {

SoughtNumbers::SoughtNumbers(std::vector<const VariedScene*> ranges, const std::vector<WantedValue>& wanted)
    : ranges_(std::move(ranges)),
      numbers_(ranges_[0]->reference_scene(), ranges_[0]->scales(), ranges_),
      wanted_(wanted) {
  for (const WantedValue& one : wanted) {
    conditions_.push_back({one.of, one.value * one.of.dimension.per_scale(ranges_[0]->scales())});
  }
}

CurvePoint SoughtNumbers::see(const PathPoint& point, const StaticModel& model, std::vector<double> s) const {
  CurvePoint out{&point, poses_of(model, point.x), std::move(s), {}};
  std::vector<int> active = point.active_stops;
  if (ranges_[0]->is_driven()) active.push_back(static_cast<int>(model.scene().stops.size()) - 1);
  out.stops = acting_at(model.scaled_scene(), out.poses, active);
  return out;
}

ConditionedEquilibrium SoughtNumbers::equations(const std::vector<ActingStop>& stops) const {
  return {numbers_, {stops, ranges_[0]->is_driven() ? static_cast<int>(stops.size()) - 1 : -1}, conditions_};
}

bool SoughtNumbers::holds(const ConditionedEquilibrium& system, const ConditionedEquilibrium::Point& at) const {
  constexpr double rounding = 1e-8;  // of the value, or of lengths, forces and work of the mechanism
  const Eigen::VectorXd excess = system.excess(at);
  for (std::size_t k = 0; k < conditions_.size(); ++k) {
    const double size = std::max(1.0, std::abs(conditions_[k].value));
    if (!(std::abs(excess[static_cast<Eigen::Index>(k)]) <= rounding * size)) return false;
  }
  return true;
}

FoundNumbers SoughtNumbers::examine(const ConditionedEquilibrium& system, const ConditionedEquilibrium::Point& at,
                                    const StaticModel& model, const std::vector<double>& x,
                                    const CertificateOptions& options) const {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  constexpr double same_pose = 1e-7;    // rad or mechanism sizes
  constexpr double from_a_line = 1e-2;  // how far a curve is from a straight line between two of its points
  FoundNumbers out;
  const SolutionProof proof = system.prove(at);
  const std::vector<double> open = system.rounding_effect(at);
  for (std::size_t k = 0; k < count(); ++k) {
    out.numbers.push_back(range(k).value_at(proof.part[k]));
    const double length = std::abs(range(k).to() - range(k).from());
    const double rounding = std::numeric_limits<double>::epsilon() * (std::abs(range(k).from()) + length);
    out.radii.push_back(proof.proved ? length * (proof.radius[k] + open[k]) + rounding : infinity);
  }
  const Eigen::VectorXd excess = system.excess(at);
  for (std::size_t k = 0; k < wanted_.size(); ++k) {
    const double scale = wanted_[k].of.dimension.per_scale(ranges_[0]->scales());
    out.values.push_back(wanted_[k].value + excess[static_cast<Eigen::Index>(k)] / scale);
  }
  CertificateOptions near = options;
  near.farthest = from_a_line;
  const Certificate certificate = certify(model, x, near);
  out.at.parameter = out.numbers[0];
  out.at.x = certificate.x;
  out.at.stability = certificate.stability;
  out.at.unstable_directions = certificate.unstable_directions;
  out.at.radius = certificate.radius;
  out.at.active_stops = certificate.active_stops;
  if (range(0).is_driven()) std::erase(out.at.active_stops, static_cast<int>(model.scene().stops.size()) - 1);
  const bool is_same =
      certificate.confirmed() && apart(poses_at(at, model.scene()), poses_of(model, certificate.x)) < same_pose;
  const bool is_regular = proof.neutral == 0 || certificate.outcome == Outcome::neutral;
  out.proved = proof.proved && is_same && is_regular;
  out.at.proof = out.proved ? PointProof::proved : PointProof::failed;
  out.at.statement = !certificate.confirmed() ? certificate.statement
                     : !is_same               ? "the certificate is of another equilibrium near it"
                     : !is_regular            ? "the equations are singular there"
                     : proof.proved           ? certificate.statement
                                              : proof.why;
  return out;
}

double apart(const std::vector<double>& a, const std::vector<double>& b) {
  double out = 0.0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) out = std::max(out, std::abs(a[i] - b[i]));
  return out;
}

std::vector<double> poses_at(const ConditionedEquilibrium::Point& at, const Scene& scene) {
  return {at.z.begin(), at.z.begin() + 3 * (static_cast<std::ptrdiff_t>(scene.bodies.size()) - 1)};
}

std::vector<double> with_lengths_in(double unit, std::vector<double> poses) {
  for (std::size_t i = 0; i < poses.size(); ++i) poses[i] *= i % 3 == 2 ? 1.0 : unit;
  return poses;
}

bool within_ranges(const ConditionedEquilibrium::Point& at) {
  constexpr double rounding = 1e-12;
  return std::all_of(at.s.begin(), at.s.end(), [](double s) { return s >= -rounding && s <= 1.0 + rounding; });
}

}  // namespace poise
