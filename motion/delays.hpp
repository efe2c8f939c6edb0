#pragma once

#include <array>
#include <vector>

#include "motion/motion_input.hpp"
#include "motion/motion_model.hpp"
#include "motion/reduced_motion.hpp"

namespace poise {

/// What controllers with a delay T gave in the past of a motion: at t each gives the effort u that it decided at t - T,
/// before the start what it decides at the start. What is given is the rate of a body (Feedback::held), which follows
///   rate' = u'(t - T)
/// and is set to u(t - T) where that jumps. u is kept over each step as a polynomial through what is decided at the
/// roots of a Chebyshev polynomial within it. Private to simulate().
class Delays : public TorquesOfPast {
 public:
  /// The model must outlive this.
  explicit Delays(const MotionModel& model);

  bool act() const { return !all_.empty(); }
  double shortest() const;
  std::vector<double> delays() const;
  /// Throws InputError for derivatives of a motion with delays, which are not known.
  void refuse_derivatives() const;

  /// What a controller gives from an instant on: the rate of the coordinate.
  struct Given {
    int coordinate;
    double rate;
  };
  /// Decides at the start, which `motion` is evaluated at. Where controllers with delays follow each other it takes as
  /// many rounds as there are delays until all know what the others give.
  std::vector<Given> begin(const ReducedMotion<double>& motion);
  int rounds() const { return static_cast<int>(all_.size()); }
  /// What is given just behind t; times within `apart` of each other are one.
  std::vector<Given> just_behind(double t, double apart) const;

  static constexpr int points = 6;
  /// The times at which what is decided over a step is to be kept.
  static std::array<double, points> times_within(double from, double to);
  /// Keeps what is decided at the k-th of these times, which `motion` is evaluated at.
  void keep(double from, double to, int k, const ReducedMotion<double>& motion);

  const std::vector<One>& at(double t, double near) const override;

 private:
  struct Delayed {
    int element, coordinate;
    double delay;
    double inertia;  ///< of the coordinate, scaled
    double before;   ///< u at the start, SI
  };
  /// What was decided over one step: each controller has the coefficients of a sum of Chebyshev polynomials.
  struct Piece {
    double from, to;
    std::vector<std::array<double, points>> coefficients;
  };
  double decided(const Delayed& one, const ReducedMotion<double>& motion);
  const Piece* piece_at(double s, double near) const;

  const MotionModel& model_;
  std::vector<Delayed> all_;
  std::vector<Piece> pieces_;
  std::vector<Planar<double>> pose_;
  mutable std::vector<One> torques_;
};

}  // namespace poise
