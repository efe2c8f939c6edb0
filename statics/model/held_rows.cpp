#include "statics/model/held_rows.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>

#include <Eigen/QR>
#include <fmt/format.h>

#include "statics/model/curvature.hpp"

namespace poise {
namespace {

constexpr std::uint64_t poses_for_rank = 6;
constexpr std::uint64_t poses_for_stiffness = 300;
constexpr double spread_of_poses = 0.3;  // rad or mechanism sizes
constexpr double implied = 1e-7;         // share of the greatest row that others leave of one that they imply
constexpr double closed_row = 1e-12;     // mechanism sizes
constexpr double open_row = 1e-8;
constexpr int most_closing_steps = 20;

// Whether rows that are closed in poses near x close all rows there.
bool imply(const Mechanism<double>& mechanism, const std::vector<int>& rows, const std::vector<int>& all,
           const std::vector<double>& start) {
  int closings = 0;
  for (std::uint64_t k = 0; k < poses_for_rank; ++k) {
    solvers::RandomStream random(1, 3, k);
    std::vector<double> x = start;
    for (double& value : x) value += random.uniform(-0.3 * spread_of_poses, 0.3 * spread_of_poses);
    for (int step = 0; step < most_closing_steps; ++step) {
      const DensePoint<double> point(mechanism, x, rows);
      const Eigen::VectorXd gaps = gaps_of(mechanism, rows, point.constraint);
      if (gaps.size() == 0 || gaps.lpNorm<Eigen::Infinity>() < closed_row) {
        if (gaps_of(mechanism, all, point.constraint).lpNorm<Eigen::Infinity>() > open_row) return false;
        ++closings;
        break;
      }
      const Eigen::VectorXd by = point.jacobian.completeOrthogonalDecomposition().solve(gaps);
      for (std::size_t i = 0; i < x.size(); ++i) x[i] -= by[static_cast<Eigen::Index>(i)];
    }
  }
  return closings > 0;
}

}  // namespace

std::vector<int> permanent_rows(const Mechanism<double>& mechanism) {
  std::vector<int> rows(static_cast<std::size_t>(mechanism.equalities()));
  std::iota(rows.begin(), rows.end(), 0);
  for (int s = 0; s < mechanism.stops(); ++s) {
    const auto stop = static_cast<std::size_t>(s);
    if (mechanism.lower()[stop] == mechanism.upper()[stop]) rows.push_back(mechanism.stop_row(s));
  }
  return rows;
}

Eigen::VectorXd gaps_of(const Mechanism<double>& mechanism, const std::vector<int>& rows,
                        const std::vector<double>& constraint) {
  Eigen::VectorXd out(static_cast<Eigen::Index>(rows.size()));
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const int stop = rows[r] - mechanism.equalities();
    const double value = constraint[static_cast<std::size_t>(rows[r])];
    out[static_cast<Eigen::Index>(r)] = stop < 0 ? value : value - mechanism.upper()[static_cast<std::size_t>(stop)];
  }
  return out;
}

double passed_by(const Mechanism<double>& mechanism, int stop, const std::vector<double>& constraint) {
  const double value = constraint[static_cast<std::size_t>(mechanism.stop_row(stop))];
  const auto s = static_cast<std::size_t>(stop);
  return std::max({mechanism.lower()[s] - value, value - mechanism.upper()[s], 0.0});
}

std::string stops_at_limits(const ScaledModel& model, const std::vector<double>& x) {
  constexpr double near = 1e-6;
  const Mechanism<double>& m = model.mechanism();
  std::vector<Planar<double>> pose(m.pose_size());
  std::vector<double> c(m.constraints());
  m.place(x.data(), pose.data());
  m.constraint(x.data(), pose.data(), c.data());
  std::string out;
  for (int s = 0; s < m.stops(); ++s) {
    const double value = c[static_cast<std::size_t>(m.stop_row(s))];
    const auto at = static_cast<std::size_t>(s);
    if (value < m.upper()[at] - near && value > m.lower()[at] + near) continue;
    const Stop& stop = model.scene().stops[at];
    out += (out.empty() ? "" : " and ") + stop.title();
  }
  return out;
}

int freedoms_of(const StaticModel& model, const std::vector<double>& x, double tolerance) {
  const DensePoint<double> point(model.mechanism(), x, permanent_rows(model.mechanism()));
  // Rows that others imply in every pose may be rounding alone, of which a rank says nothing.
  if (point.jacobian.rows() == 0 || point.jacobian.lpNorm<Eigen::Infinity>() < closed_row) {
    return model.mechanism().coordinates();
  }
  return model.mechanism().coordinates() -
         static_cast<int>(solvers::rank<double>(point.jacobian.transpose(), tolerance));
}

std::optional<std::vector<double>> random_closed_pose(solvers::Newton& closing, std::vector<double> x, double reach,
                                                      solvers::RandomStream random) {
  for (double& value : x) value += random.uniform(-reach, reach);
  const solvers::NewtonResult& pose = closing.close(x);
  if (pose.end != solvers::NewtonEnd::converged) return std::nullopt;
  return pose.x;
}

bool has_stiffer_poses(const StaticModel& model, const std::vector<double>& start, int freedoms,
                       const std::function<bool()>& stopped) {
  solvers::Newton closing(model.problem());
  for (std::uint64_t k = 0; k < poses_for_stiffness && !stopped(); ++k) {
    const auto x = random_closed_pose(closing, start, M_PI, solvers::RandomStream(1, 4, k));
    if (x && freedoms_of(model, *x, solvers::known_to::singular_point) < freedoms) return true;
  }
  return false;
}

int repeated_rows(const StaticModel& model, const std::vector<double>& start) {
  const std::vector<int> rows = permanent_rows(model.mechanism());
  std::size_t fewest = rows.size();
  solvers::Newton closing(model.problem());
  for (std::uint64_t k = 0; k < poses_for_rank && !rows.empty(); ++k) {
    const std::optional<std::vector<double>> x =
        k == 0 ? start : random_closed_pose(closing, start, spread_of_poses, solvers::RandomStream(1, 2, k));
    if (!x) continue;
    Eigen::MatrixXd basis = DensePoint<double>(model.mechanism(), *x, rows).jacobian.transpose();
    const double size = basis.size() == 0 ? 0.0 : basis.colwise().norm().maxCoeff();
    std::vector<int> independent;
    Eigen::Index used = 0;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      Eigen::VectorXd rest = basis.col(static_cast<Eigen::Index>(r));
      // Twice, for what the first time leaves to rounding.
      for (int time = 0; time < 2; ++time) {
        rest -= basis.leftCols(used) * (basis.leftCols(used).transpose() * rest);
      }
      if (!(rest.norm() > std::max(implied * size, closed_row))) continue;
      basis.col(used++) = rest.normalized();
      independent.push_back(rows[r]);
    }
    if (independent.size() < fewest && imply(model.mechanism(), independent, rows, start)) fewest = independent.size();
  }
  return static_cast<int>(rows.size() - fewest);
}

}  // namespace poise
