#pragma once

// A path of closed poses with some coordinates driven, followed step by step. Private to the kinematics.

#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "motion/motion_model.hpp"

namespace poise {

/// The closures of a mechanism, split into columns of free and of driven coordinates. x holds its scaled coordinates q
/// throughout, and behind them the values d of measures that are driven and no coordinates; each adds the row
/// m(q) - d = 0, so that such a d is driven as a coordinate is, and all of q is free.
class SplitClosure {
 public:
  /// `driven` are places in x; `measured` the drives of the scene of which x has the measures.
  SplitClosure(const MotionModel& model, std::vector<int> driven, std::vector<int> measured = {});

  const MotionModel& model() const { return model_; }
  const std::vector<int>& driven() const { return driven_; }
  const std::vector<int>& free() const { return free_; }

  /// Stops whose limits are equal, which have a row each behind those of the closures.
  const std::vector<int>& couplings() const { return couplings_; }
  /// Drives that have a row each behind these.
  const std::vector<int>& measured() const { return measured_; }
  /// Singular values of the free columns count against the largest of them, but against this at least: slopes of
  /// measures by rad and mechanism sizes are of order one, and one alone vanishes against nothing else; those of
  /// closures must be more than rounding.
  double least_scale() const;
  /// Whether some measure of these drives is the same in every pose; its place in measured(), or -1.
  int constant_measure() const;
  /// x of the coordinates q.
  Eigen::VectorXd with_measures(const Eigen::VectorXd& q) const;
  /// q of x.
  std::vector<double> coordinates(const Eigen::VectorXd& x) const { return {x.data(), x.data() + coordinates_}; }

  /// c(x), two rows per closure, one per coupling and one per measure.
  Eigen::VectorXd gap(const Eigen::VectorXd& x) const;
  /// dc/dx.
  Eigen::MatrixXd jacobian(const Eigen::VectorXd& x) const;
  /// Its columns of the free coordinates.
  Eigen::MatrixXd free_columns(const Eigen::MatrixXd& jacobian) const;
  /// (C v)' v = sum_ij d2c/dx_i dx_j v_i v_j: the second time derivative of c without accelerations.
  Eigen::VectorXd curvature(const Eigen::VectorXd& x, const Eigen::VectorXd& v) const;
  /// Closes the loops by minimum-norm steps of the free coordinates. False if they remain open.
  bool close(Eigen::VectorXd& x) const;

 private:
  using Measured = CompiledMeasure<double>;
  /// The rows of measures, by of(measure, configuration at q).
  template <class Of>
  Eigen::VectorXd of_measures(const Eigen::VectorXd& x, Of of) const;

  const MotionModel& model_;
  std::vector<int> driven_, free_, couplings_, measured_;
  std::vector<int> rows_;           // of the constraint vector
  std::vector<Measured> coupled_;   // measures of couplings, in scaled units
  std::vector<Measured> measures_;  // those of measured_
  Eigen::Index coordinates_ = 0;    // in q
};

/// A pose of the path, with its derivatives by the path's parameter.
struct PathPose {
  double at = 0.0;              ///< the parameter
  Eigen::VectorXd x, v, a;      ///< scaled coordinates, dx/d at, d2x/d at2
  double smallest = 1.0;        ///< smallest singular value of the free columns
  double closeness = 1.0;       ///< smallest / largest of them (least_scale()); 1 if nothing is free
  Eigen::VectorXd left, right;  ///< singular vectors of the smallest: closure rows, free coordinates
};

/// Where a path ends before t = 1, and why.
struct PathEnd {
  PathPose pose;
  int stop = -1;  ///< the stop that is reached there; -1: the closures have no solution beyond, or it was interrupted
  bool at_max = false;        ///< which limit of the stop
  bool out_of_steps = false;  ///< as many as allowed were tried
};

/// Follows  d(t) = d0 + t (d1 - d0),  t = 0 .. 1, from a closed pose at t = 0.
class DrivenPath {
 public:
  /// Closeness below which derivatives are not computed at the pose itself.
  static constexpr double singular_below = 1e-5;

  /// Farthest that a coordinate moves in one step, rad or mechanism sizes.
  static constexpr double longest_move = 0.05;

  struct Visitor {
    std::function<void(const PathPose&)> sample;  ///< at each of the parameters asked for
    std::function<void(const PathPose&)> crossing;
  };

  DrivenPath(const SplitClosure& closure, Eigen::VectorXd direction);

  /// Singular values and derivatives of a closed pose. Derivatives are undefined if closeness < singular_below.
  PathPose differentiated(double at, Eigen::VectorXd x) const;

  /// Runs to t = 1 and calls the visitor along the way; `samples` ascend in 0 .. 1. `begin` must have derivatives.
  /// Returns nothing if t = 1 was reached. Otherwise the last pose of the path, with the derivatives of the last
  /// regular pose and its own singular vectors; or the pose at the first stop that the path would pass by more than
  /// StopRoom::rounding, found to rounding, with all its derivatives. A stop that `begin` has passed already is ignored
  /// until the path has returned within it. At most so many steps are tried, so that every path ends.
  std::optional<PathEnd> follow(PathPose begin, const std::vector<double>& samples, const Visitor& visitor,
                                int most_steps, const std::function<bool()>& stopped) const;

 private:
  PathPose interpolated(const PathPose& from, const PathPose& to, double at) const;
  PathPose sampled(const PathPose& from, const PathPose& to, double at) const;
  std::optional<PathPose> crossing_between(const PathPose& a, const PathPose& b, const PathPose& c) const;
  std::optional<PathPose> turning_point(const PathPose& from) const;
  std::optional<PathEnd> stop_between(const PathPose& from, const PathPose& to) const;
  void measure(PathPose& pose, const Eigen::MatrixXd& jacobian) const;

  const SplitClosure& closure_;
  Eigen::VectorXd direction_;  // d1 - d0, scaled
};

}  // namespace poise
