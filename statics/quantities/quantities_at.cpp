#include "statics/quantities/quantities_at.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>

#include "statics/bodies/body_measures.hpp"
#include "statics/quantities/linear_response.hpp"
#include "statics/quantities/quantity_value.hpp"

namespace poise {
namespace {

using Kind = SoughtQuantity::Kind;

/// The place in acting() of a stop, -1 where it is none of these.
int place_of(const NumberedEquations& equations, int stop) {
  for (std::size_t h = 0; h < equations.acting().size(); ++h) {
    if (equations.acting()[h].stop == stop) return static_cast<int>(h);
  }
  return -1;
}

}  // namespace

std::vector<double> quantities_at(const StaticModel& model, const std::vector<double>& x,
                                  const std::vector<int>& active, const std::vector<SoughtQuantity>& of, int driven) {
  std::vector<double> out;
  if (std::all_of(of.begin(), of.end(), [](const SoughtQuantity& one) { return one.kind == Kind::measure; })) {
    std::vector<BodyPose<double>> poses = model.poses(x);
    poses.resize(model.scene().bodies.size());
    for (const SoughtQuantity& one : of) out.push_back(value_of(model.scene(), one.on, poses));
    return out;
  }
  constexpr double rank_tolerance = solvers::known_to::solution;
  const LinearResponse response = response_at(model, x, active, rank_tolerance);
  const NumberedEquations& equations = response.equations();
  const int place = place_of(equations, driven);
  const Eigen::MatrixXd open = solvers::null_space<double>(response.by_unknowns(), rank_tolerance);
  QuantityPlace<double> at(equations, equations.numbers().data(), response.z().data(), place);
  for (const SoughtQuantity& one : of) {
    double value = std::numeric_limits<double>::quiet_NaN();
    if (response.why().empty()) value = at.value(one) / one.dimension.per_scale(model.scales());
    if (open.cols() > 0) {
      constexpr double nothing = 1e-9;
      const Eigen::VectorXd by = gradient_of(one, equations, equations.numbers(), response.z(), place).by_unknowns;
      const bool is_open = (open.transpose() * by).cwiseAbs().maxCoeff() > nothing * by.norm();
      if (is_open && !by.isZero()) value = std::numeric_limits<double>::quiet_NaN();
    }
    out.push_back(value);
  }
  return out;
}

}  // namespace poise
