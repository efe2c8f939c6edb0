#pragma once

#include <array>
#include <utility>
#include <vector>

#include "motion/decisions.hpp"
#include "motion/motion_input.hpp"
#include "motion/motion_model.hpp"
#include "motion/reduced_motion.hpp"
#include "motion/simulate.hpp"

namespace poise {

/// What controllers with a delay T gave in the past of a motion: at t each gives the effort u that it decided at t - T,
/// before the start what it decides at the start. What is given is the rate of a body (Feedback::held), which follows
///   rate' = u'(t - T)
/// and is set to u(t - T) where that jumps. u is kept over each step as a polynomial through what is decided at the
/// roots of a Chebyshev polynomial within it, and so are its derivatives u_p at constant time:
///   rate_p = u_p(t - T) - u'(t - T) T_p.
/// Private to simulate().
class Delays : public TorquesOfPast {
 public:
  /// Both must outlive this.
  Delays(const MotionModel& model, const MotionOptions& options);
  /// Sets the index of the influence that each column of sensitivities is of, negative without one.
  void set_columns(std::vector<int> influences) { influence_of_ = std::move(influences); }

  bool act() const { return !all_.empty(); }
  double shortest() const;
  /// Whether the rate of this coordinate is what one gives.
  bool gives(int coordinate) const;
  std::vector<double> delays() const;
  /// Whether what one decides depends at once on what another one, or itself, gives.
  bool are_chained() const { return are_chained_; }
  /// The derivative of the k-th delay by a column.
  double delay_by(std::size_t k, std::size_t column) const;
  /// Throws InputError for derivatives that are not known: of a motion with stops or friction that sticks, where
  /// the times of events move, and by the time of a step.
  void refuse_derivatives(bool has_events) const;
  /// Throws InputError for the derivative by a delay where what the k-th controller gives jumps at once for several
  /// reasons, which move in different ways with the delay.
  [[noreturn]] void refuse_mixed(std::size_t k) const;

  /// A column of sensitivities, and how places and rates change along it, n values each.
  struct Column {
    std::size_t index = 0;
    std::vector<double> dq{}, dv{};
  };
  /// What a controller gives from an instant on: the rate of the coordinate.
  struct Given {
    int coordinate;
    double rate;
  };
  /// Decides at the start, which `motion` is evaluated at. Where controllers with delays follow each other it takes
  /// more rounds than there are delays until all know what the others give.
  std::vector<Given> begin(const ReducedMotion<double>& motion);
  /// The derivatives of these by a column.
  std::vector<Given> begin_by(ReducedMotion<double>& motion, const Column& column);
  int rounds() const { return static_cast<int>(all_.size()); }
  /// What is given just behind t; times within `apart` of each other are one.
  std::vector<Given> just_behind(double t, double apart) const;
  /// Whether what is given, or its slope, jumps at t by more than rounding.
  bool jump_at(double t, double apart) const;
  /// The derivatives of these by a column.
  std::vector<Given> just_behind_by(double t, double apart, std::size_t column) const;

  static constexpr int points = 6;
  /// The times at which what is decided over a step is to be kept.
  static std::array<double, points> times_within(double from, double to);
  /// Keeps what is decided at the k-th of these times, which `motion` is evaluated at.
  void keep(double from, double to, int k, const ReducedMotion<double>& motion);
  /// Keeps the derivatives of these by a column, after keep().
  void keep_by(int k, ReducedMotion<double>& motion, const Column& column);

  const std::vector<One>& at(double t, double near) const override;
  const std::vector<Change>& changes_at(double t, double near) const override;

 private:
  struct Delayed {
    int element, coordinate;
    double delay;
    double inertia;                   ///< of the coordinate, scaled
    double before = 0.0;              ///< u at the start, SI
    double largest = 0.0;             ///< size of u yet
    std::vector<double> before_by{};  ///< derivatives by the columns
  };
  /// What was decided over one step: each controller has the coefficients of a sum of Chebyshev polynomials.
  struct Piece {
    double from, to;
    std::vector<std::array<double, points>> coefficients;
    std::vector<std::array<double, points>> by;  // their derivatives, of each controller by each column
  };
  double decided(const Delayed& one, const ReducedMotion<double>& motion);
  std::vector<double> decided_by(ReducedMotion<double>& motion, double t, const Column& column);
  std::size_t columns() const { return influence_of_.size(); }
  std::size_t place_of(std::size_t controller, std::size_t column) const { return controller * columns() + column; }
  const Piece* piece_at(double s, double near) const;

  const MotionModel& model_;
  const MotionOptions& options_;
  Decisions decisions_;
  std::vector<int> influence_of_;
  std::vector<Delayed> all_;
  std::vector<int> elements_;
  bool are_chained_ = false;
  std::vector<Piece> pieces_;
  std::vector<Planar<double>> pose_;
  mutable std::vector<One> torques_;
  mutable std::vector<Change> changes_;
};

}  // namespace poise
