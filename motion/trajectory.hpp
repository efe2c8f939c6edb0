#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace poise {

/// A motion stored at the nodes of an integrator; SI (rad, m, s). Between nodes it is the polynomial through values,
/// rates and accelerations of four neighbours (degree 11), or of fewer where those are more accurate: near a corner
/// they lie on one side of it. Where accelerations jump, two nodes have the same time, and no polynomial goes through
/// both.
struct Trajectory {
  int coordinates = 0;  ///< n
  int columns = 0;      ///< sensitivities of each coordinate
  std::vector<double> t;
  std::vector<double> q, v, a;        ///< n values per node
  std::vector<double> q_p, v_p, a_p;  ///< n x columns values per node, row by row: d/dp of the above

  std::size_t nodes() const { return t.size(); }
};

/// One coordinate at one node.
struct NodeValues {
  double t = 0.0, q = 0.0, v = 0.0, a = 0.0;
};

/// Estimate of the interpolation error at time t, somewhat too large: the contribution of the last two of the 3
/// conditions per node to the polynomial, by size. Two to four nodes.
double reading_error(std::span<const NodeValues> nodes, double t);

/// Interpolates some coordinates of a trajectory, and their sensitivities, at ascending times.
class TrajectoryReader {
 public:
  /// `trajectory` must outlive this and have at least two nodes. Only `coordinates` are read.
  /// Up to which derivative by time: 0 coordinates alone, 1 their rates, 2 also a_p(). Those beyond are zero.
  TrajectoryReader(const Trajectory& trajectory, std::vector<int> coordinates, int derivatives = 1);

  /// Interpolates at time t, which may lie anywhere, but is fastest between the nodes of the last one.
  void at(double t);
  /// Of the i-th coordinate read; valid until the next at().
  double q(std::size_t i) const { return value_[i * stride_]; }
  double v(std::size_t i) const { return rate_[i * stride_]; }
  double a(std::size_t i) const { return derivative(i, 2); }
  /// The derivative of a() by time.
  double jerk(std::size_t i) const { return derivative(i, 3); }
  /// `columns` sensitivities of the same.
  std::span<const double> q_p(std::size_t i) const { return {value_.data() + i * stride_ + 1, stride_ - 1}; }
  std::span<const double> v_p(std::size_t i) const { return {rate_.data() + i * stride_ + 1, stride_ - 1}; }
  std::span<const double> a_p(std::size_t i) const { return {acceleration_.data() + i * stride_ + 1, stride_ - 1}; }

 private:
  void enter(std::size_t interval);
  double derivative(std::size_t i, std::size_t order) const;
  struct Nodes {
    std::size_t first = 0, count = 0;
  };
  /// The nodes that interpolate the interval with the least error.
  Nodes best_nodes(std::size_t interval) const;

  const Trajectory& trajectory_;
  std::vector<int> coordinates_;
  std::size_t stride_;  // 1 + columns
  int derivatives_;
  std::size_t interval_ = static_cast<std::size_t>(-1);
  double origin_ = 0.0, scale_ = 1.0;  // s = (t - origin) / scale
  double s_ = 0.0;                     // of the last at()
  std::vector<double> node_;           // s of each condition, every node three times
  std::vector<double> newton_;         // divided differences, one row per condition
  std::vector<double> value_, rate_, acceleration_;
};

}  // namespace poise
