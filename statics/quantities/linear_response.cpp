#include "statics/quantities/linear_response.hpp"

#include <algorithm>
#include <utility>

#include <ceres/jet.h>

#include "statics/bodies/body_measures.hpp"
#include "statics/quantities/quantity_value.hpp"

namespace poise {
namespace {

constexpr int lanes = 8;  // derivatives computed at once
using Dual = ceres::Jet<double, lanes>;

/// Calls at(first, count, z, p) with `count` variables from `first` of (z, p) as those by which is derived; all of them
/// from `from` to `end`.
template <class At>
void for_each_block(const std::vector<double>& z, const std::vector<double>& p, int from, int end, At at) {
  std::vector<Dual> dual_z(z.begin(), z.end()), dual_p(p.begin(), p.end());
  const int n = static_cast<int>(z.size());
  const auto variable = [&](int k) -> Dual& { return k < n ? dual_z[k] : dual_p[k - n]; };
  for (int first = from; first < end; first += lanes) {
    const int count = std::min(lanes, end - first);
    for (int k = 0; k < count; ++k) variable(first + k).v[k] = 1.0;
    at(first, count, dual_z.data(), dual_p.data());
    for (int k = 0; k < count; ++k) variable(first + k).v[k] = 0.0;
  }
}

}  // namespace

std::vector<double> poses_of(const StaticModel& model, const std::vector<double>& x) {
  std::vector<double> out;
  const std::vector<BodyPose<double>> poses = model.mechanism().poses(x.data());
  for (std::size_t i = 1; i < model.scene().bodies.size(); ++i) {
    out.insert(out.end(), {poses[i].origin.x, poses[i].origin.y, poses[i].angle});
  }
  return out;
}

std::vector<ActingStop> acting_at(const Scene& scene, const std::vector<double>& poses,
                                  const std::vector<int>& active) {
  std::vector<BodyPose<double>> placed(1);
  for (std::size_t i = 0; i + 2 < poses.size(); i += 3) placed.push_back({{poses[i], poses[i + 1]}, poses[i + 2]});
  std::vector<ActingStop> out;
  for (const int s : active) {
    const Stop& stop = scene.stops[s];
    const double g = value_of(scene, stop.on, placed);
    out.push_back({s, std::abs(stop.max - g) < std::abs(stop.min - g)});
  }
  return out;
}

namespace {

/// The chain rule: what follows from a number changes with it. One row per derivative.
template <class Derivatives>
void add_followers(const NumberedEquations& equations, const std::vector<double>& numbers, Derivatives& by_numbers) {
  for (const int row : equations.list()->leaders()) {
    for (const auto& [at, slope] : equations.list()->followers(row, numbers)) {
      by_numbers.col(row) += slope * by_numbers.col(at);
    }
  }
}

}  // namespace

ResidualDerivatives differentiate(const NumberedEquations& equations, const std::vector<double>& numbers,
                                  const std::vector<double>& z, bool by_numbers) {
  const int n = equations.unknowns();
  ResidualDerivatives out;
  out.by_unknowns.resize(n, n);
  if (by_numbers) out.by_numbers.resize(n, static_cast<Eigen::Index>(numbers.size()));
  out.residual.resize(n);
  std::vector<Dual> r(n);
  std::vector<NumberedEquations::Placed<Dual>> placed;
  const int variables = n + (by_numbers ? static_cast<int>(numbers.size()) : 0);
  for_each_block(z, numbers, 0, variables, [&](int first, int count, const Dual* dual_z, const Dual* dual_p) {
    equations.residual(dual_p, dual_z, r.data(), placed);
    for (int i = 0; i < n; ++i) {
      out.residual[i] = r[i].a;
      for (int k = 0; k < count; ++k) {
        (first + k < n ? out.by_unknowns(i, first + k) : out.by_numbers(i, first + k - n)) = r[i].v[k];
      }
    }
  });
  if (by_numbers) add_followers(equations, numbers, out.by_numbers);
  return out;
}

QuantityGradient gradient_of(const SoughtQuantity& of, const NumberedEquations& equations,
                             const std::vector<double>& numbers, const std::vector<double>& z, int driven) {
  const int n = equations.unknowns();
  QuantityGradient out;
  out.by_unknowns.resize(n);
  out.by_numbers.resize(static_cast<Eigen::Index>(numbers.size()));
  for_each_block(z, numbers, 0, n + static_cast<int>(numbers.size()),
                 [&](int first, int count, const Dual* dual_z, const Dual* dual_p) {
                   QuantityPlace<Dual> place(equations, dual_p, dual_z, driven);
                   const Dual value = place.value(of);
                   out.value = value.a;
                   out.why = place.why();
                   for (int k = 0; k < count; ++k) {
                     (first + k < n ? out.by_unknowns[first + k] : out.by_numbers[first + k - n]) = value.v[k];
                   }
                 });
  Eigen::Map<Eigen::RowVectorXd> row(out.by_numbers.data(), out.by_numbers.size());
  add_followers(equations, numbers, row);
  return out;
}

Eigen::VectorXd gradient_by_efforts(const SoughtQuantity& of, const NumberedEquations& equations,
                                    const std::vector<double>& z, int driven) {
  Eigen::VectorXd out(equations.unknowns() - equations.poses());
  for_each_block(z, equations.numbers(), equations.poses(), equations.unknowns(),
                 [&](int first, int count, const Dual* dual_z, const Dual* dual_p) {
                   const Dual value = QuantityPlace<Dual>(equations, dual_p, dual_z, driven).value(of);
                   for (int k = 0; k < count; ++k) out[first + k - equations.poses()] = value.v[k];
                 });
  return out;
}

LinearResponse::LinearResponse(NumberedEquations equations, std::vector<double> poses, double rank_tolerance)
    : equations_(std::move(equations)), z_(std::move(poses)), rank_tolerance_(rank_tolerance) {
  z_.resize(equations_.unknowns(), 0.0);
  equations_.count_turns(z_.data());
  const Eigen::Index n = equations_.unknowns(), bodies = equations_.poses();
  at_ = differentiate(equations_, equations_.numbers(), z_, true);
  const Eigen::VectorXd efforts = solvers::minimum_norm_solution<double>(
      at_.by_unknowns.block(0, bodies, bodies, n - bodies), -at_.residual.head(bodies), rank_tolerance);
  std::copy(efforts.begin(), efforts.end(), z_.begin() + bodies);
  at_ = differentiate(equations_, equations_.numbers(), z_, true);
  constexpr int most_steps = 6;
  constexpr double converged = 1e-13, farthest = 1e-6;
  const std::vector<double> from = z_;
  double change = 0.0;
  for (int step = 0; step < most_steps; ++step) {
    const Eigen::VectorXd dz = next_step();
    for (Eigen::Index i = 0; i < n; ++i) z_[i] += dz[i];
    at_ = differentiate(equations_, equations_.numbers(), z_, true);
    change = n > 0 ? dz.cwiseAbs().maxCoeff() : 0.0;
    if (change < converged) break;
  }
  double moved = 0.0;
  for (Eigen::Index i = 0; i < bodies; ++i) moved = std::max(moved, std::abs(z_[i] - from[i]));
  if (!(change < 1e-9) || !(moved < farthest)) why_ = "the free-body equations do not converge to the equilibrium";
}

Eigen::VectorXd LinearResponse::next_step() const {
  return solvers::minimum_norm_solution<double>(at_.by_unknowns, -at_.residual, rank_tolerance_);
}

LinearResponse response_at(const StaticModel& model, const std::vector<double>& x, const std::vector<int>& active,
                           double rank_tolerance) {
  const Scene scene = model.scaled_scene();
  const std::vector<double> poses = poses_of(model, x);
  return {NumberedEquations(scene, acting_at(scene, poses, active)), poses, rank_tolerance};
}

}  // namespace poise
