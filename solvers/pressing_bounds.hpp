#pragma once

// Private to solvers/damped_motion.cpp.

#include <span>
#include <vector>

#include "solvers/damped_problem.hpp"
#include "solvers/kkt.hpp"

namespace poise::solvers {

/// The rows that act on a damped motion: the equalities, and the inequalities at their bounds that press.
class PressingBounds {
 public:
  /// Both must outlive this. `touching` as in DampedOptions.
  PressingBounds(const DampedProblem& problem, double touching, Kkt& kkt);

  /// Begins anew with the equalities alone.
  void begin();

  std::vector<char> active;  ///< per row
  std::vector<double> gap;   ///< of find_gap()
  /// Sets the gaps of the active rows at an evaluated point; those of others are zero.
  void find_gap(const Evaluation& at);

  /// Sets v and the multipliers y with  D v + F + J^T y = 0,  J v = 0. False where that fails.
  bool set_velocity(Evaluation& at, std::span<double> v, std::span<double> y);
  /// The largest force or multiplier yet, and what rounding makes of a multiplier.
  double scale() const { return scale_; }
  double noise() const;

  /// How much a bound pulls that should press.
  double pull(int row, std::span<const double> y) const;
  /// Distance of an inactive inequality from its nearer bound; which one it is, if `upper` is given.
  double distance(const Evaluation& at, int row, char* upper = nullptr) const;
  /// Rate of a row along v.
  double rate(const Evaluation& at, int row, std::span<const double> v) const;

  /// Finds the bounds at `now` that press, with the velocity v that they allow and the multipliers y: first all that
  /// are touched, then those are left out that pull, one by one, and those are taken in again into which the motion
  /// would go. False where there is no velocity.
  bool choose(Evaluation& now, std::span<double> v, std::span<double> y);
  /// Leaves out bounds that repeat others at `now` and press on nothing: they may part from these on the way, so that
  /// all together would hold what only touches them. False where there are none.
  bool release_idle(Evaluation& now, std::span<double> v, std::span<double> y);
  /// Bounds that repeat each other at `now` part on the way, so that the choice by first derivatives may be one that
  /// leads nowhere: takes another set of those that are touched, in which all press and none is gone into. False where
  /// each such set was tried here.
  bool choose_otherwise(Evaluation& now, std::span<double> v, std::span<double> y);

 private:
  double bound(int row) const {
    return upper_[row] != 0 ? problem_.upper()[row - equalities_] : problem_.lower()[row - equalities_];
  }
  double gap_of(const Evaluation& at, int row) const;

  const DampedProblem& problem_;
  double touching_;
  Kkt& kkt_;
  int n_, equalities_, rows_;
  std::vector<char> upper_;  // per row: at its upper bound
  std::vector<char> idle_;   // bounds that are touched and left out, because others of the same direction hold
  std::vector<std::vector<char>> tried_;  // active rows of choose_otherwise(), at
  std::vector<double> tried_at_;
  std::vector<double> resistance_;
  double scale_ = 0.0;
};

}  // namespace poise::solvers
