#pragma once

#include <memory>
#include <span>

#include "solvers/damped_problem.hpp"

namespace poise::solvers {

/// The damped motion of a problem with one freedom: along the curve c(x) = 0, in the direction of the force, to the
/// first point where
///
///   r(s) = -F(x(s)) . t(s) = 0   (t the unit tangent),
///
/// or where an inequality reaches its bound. The curve is followed by its arclength s, in both of which D has no part.
/// No zero of r is passed over: with the exact slope r' = -t^T (dF/dx + y . d2c) t (y of least |F + J^T y|) each
/// interval has a cubic Hermite interpolant of r, whose error is measured in its middle; the interval is passed only
/// if the interpolants of both halves stay above that error, and else it is halved. The same is done with limits and
/// switches (see Threshold), at which an interval ends. Steps across a gap between two branches of the curve
/// change the sign of det [J; t^T] and are halved too.
class CurveMotion {
 public:
  /// `problem` must outlive this.
  explicit CurveMotion(const DampedProblem& problem, const DampedOptions& options = {});
  ~CurveMotion();
  CurveMotion(const CurveMotion&) = delete;
  CurveMotion& operator=(const CurveMotion&) = delete;

  /// Moves from a point with c(x) = 0. Arrival::rest at once where r vanishes to within rounding.
  const DampedResult& run(std::span<const double> x);

 private:
  class Tracer;
  std::unique_ptr<Tracer> tracer_;
};

}  // namespace poise::solvers
