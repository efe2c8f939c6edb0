#pragma once

// Private to solvers/curve_motion.cpp.

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "solvers/cubic.hpp"
#include "solvers/damped_problem.hpp"
#include "solvers/kkt.hpp"

namespace poise::solvers {

/// Points of the curve c(x) = 0 of a problem with one freedom, and on it the functions that a damped motion watches:
/// r of CurveMotion, distances from bounds, and measures of switches, positive on the side that the motion is on.
class CurvePoints {
 public:
  explicit CurvePoints(const DampedProblem& problem);

  struct Point {
    Evaluation at;
    std::vector<double> t;             ///< unit tangent, along the motion
    std::vector<double> value, slope;  ///< r, of bounds, of switches times their side; by arclength
    double noise = 0.0;                ///< of r
    double sigma = 0.0;                ///< in the frame of the left end of an interval: t_left . (x - x_left)
  };
  Point make() const;

  int functions() const { return first_switch() + static_cast<int>(problem_.switches().size()); }
  /// Functions are r, then the bounds, then the switches.
  int first_switch() const { return 1 + static_cast<int>(bounds_.size()); }
  const std::vector<Limit>& bounds() const { return bounds_; }
  /// What rounding makes of a function.
  double noise_of(const Point& p, int function) const;

  /// Sets p to the start x of a motion, with the tangent in the direction of the force. False where the curve has none.
  bool begin(std::span<const double> x, Point& p);
  /// Corrects p, with p.at.x near it, to the point of the curve at sigma in the frame of `left`, with its functions.
  /// False where that fails, or leads to where the curve turns far or to another branch of it.
  bool reach(const Point& left, double sigma, Point& p);
  /// Reaches a point between two points of the curve likewise, from the cubic through both.
  bool reach_between(const Point& left, const Point& a, const Point& b, double sigma, Point& p);
  /// From p on, branches are told apart by the rows that are independent there.
  void choose_rows_at(const Point& p);
  /// From p on, switches count positive on the side that the motion is on, or turns to.
  void turn_switches(Point& p);
  /// The cubic of a function between two points, by sigma in the frame of `left`.
  static Cubic cubic(const Point& left, const Point& a, const Point& b, int function);

  std::vector<char> active;  ///< rows of the curve
  int evaluations = 0;

 private:
  bool factor(Point& p);
  bool set_tangent(Point& p, std::span<const double> along);
  void set_functions(Point& p);
  void set_distances(Point& p);
  void set_switches(Point& p);
  bool correct(const Point& left, double sigma, Point& p);
  void dense_jacobian(const Point& p);
  void choose_rows(const Point& p, std::vector<int>& rows);
  double orientation(const Point& p, const std::vector<int>& rows);
  bool same_branch(const Point& from, const Point& to);

  const DampedProblem& problem_;
  int n_, equalities_;
  bool dense_;
  std::unique_ptr<Kkt> kkt_;
  std::vector<Limit> bounds_;
  std::vector<std::pair<int, std::size_t>> bound_entries_;  // entries of the Jacobian, each with a bound of its row
  std::vector<double> gap_, step_, field_, y_, tangent_, measures_;
  std::vector<double> side_;  // of switches: 1 or -1
  double scale_ = 0.0;        // largest force or multiplier yet
  std::vector<int> rows_, other_rows_;
  Eigen::MatrixXd full_, square_;
};

}  // namespace poise::solvers
