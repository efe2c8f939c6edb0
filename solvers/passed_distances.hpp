#pragma once

// Private to solvers/damped_motion.cpp.

#include <span>
#include <vector>

#include "solvers/damped_problem.hpp"
#include "solvers/pressing_bounds.hpp"

namespace poise::solvers {

/// Limits and switches that concern distances. Between the ends of a step a distance may dip below its threshold and
/// rise again, however narrowly. This is looked for on a curve between the ends: the Hermite cubic with the directions
/// of the velocities, whatever their sizes, which differ widely where fast motions die away.
class PassedDistances {
 public:
  /// Both must outlive this. `touching` as in DampedOptions.
  PassedDistances(const DampedProblem& problem, double touching, PressingBounds& bounds);

  /// An evaluated point with the velocity there.
  struct Moving {
    Evaluation& at;
    std::span<const double> velocity;
  };
  /// The share of the step between two points after which the first distance has passed its threshold; 1 if none does.
  double until_passing(const Moving& now, const Moving& next);
  /// Whether some distance comes so near a threshold that a step from an evaluated point might pass it.
  bool may_be_passed(Evaluation& at, std::span<const double> step);

  int evaluations = 0;

 private:
  // A limit (row) or switch.
  struct Watched {
    int row, which;
    Threshold threshold;
    double sign;  // of a limit
  };
  struct Sample {
    double tau, value, slope;
  };

  double measure(Evaluation& at, const Watched& w);
  double slope_along(Evaluation& at, const Watched& w, std::span<const double> direction);
  Sample sample(Evaluation& at, const Watched& w, double tau, std::span<const double> direction);
  // On the curve; trial_ becomes its pose.
  Sample sample(const Watched& w, double side, double tau);
  // Whether it comes so near its threshold that a motion of this length might pass it. No coordinate moves a point by
  // much more than itself, and back again by twice that.
  bool may_pass(const Watched& w, double length, Evaluation& from, Evaluation& to);
  void set_way(std::span<const double> velocity, double length, std::span<double> way) const;
  // Where between a and b on the curve a distance is known to be past its threshold; 1 if it does not pass.
  double first_passing(const Watched& w, double side, const Sample& a, const Sample& b, int depth);

  const DampedProblem& problem_;
  double touching_;
  PressingBounds& bounds_;
  int n_;
  std::vector<Watched> watched_;
  const Moving *now_ = nullptr, *next_ = nullptr;  // ends of the step in hand
  Evaluation trial_;
  std::vector<double> measures_, gradient_;
  std::vector<double> way_, way_now_, way_next_;
};

}  // namespace poise::solvers
