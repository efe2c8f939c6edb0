#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <vector>

#include "motion/motion_model.hpp"
#include "motion/reduced_motion.hpp"
#include "motion/reduced_system.hpp"
#include "motion/simulate.hpp"
#include "motion/stepping.hpp"
#include "solvers/runge_kutta.hpp"

namespace poise {

/// The state y of a motion (motion/reduced_system.hpp) at its last node, and a step from there by RungeKutta78, which
/// may be repeated with other lengths until it is accepted. Private to simulate().
class MotionStep {
 public:
  /// All must outlive this.
  MotionStep(const MotionModel& model, const MotionOptions& options, ReducedMotion<double>& reduced, int columns)
      : model_(model), options_(options), reduced_(reduced), columns_(columns) {}

  /// At the last node, and at the end of the step made last.
  std::vector<double> y, dydt, y_new, dydt_new;
  std::vector<double> error;    ///< estimate of y_new
  double length = 0.0;          ///< of the step made last
  std::vector<double> node;     ///< all coordinates at the last node
  std::vector<double> held_by;  ///< sensitivities of the values at which friction is held

  std::size_t size() const {
    const int f = reduced_.freedoms();
    return static_cast<std::size_t>(2 * f + 1 + 2 * f * columns_);
  }
  /// Place in y of column c of row k: of z_k, or of w_(k - f).
  std::size_t sensitivity(int k, int c) const {
    return static_cast<std::size_t>(2 * reduced_.freedoms() + 1 + k * columns_ + c);
  }
  /// Changes of all coordinates, their rates and accelerations, n values each.
  struct Changes {
    std::vector<double> q, v, a;
  };
  /// Finds those by column c, of a state like y to which the equations are evaluated; `influence` is the index of that
  /// of the column, negative without one.
  void changes_by(int c, const std::vector<double>& state, int influence, Changes& out) const;
  double work() const { return y[static_cast<std::size_t>(2 * reduced_.freedoms())]; }
  /// Whether the motion has independent coordinates that are ill-conditioned: by the loops, or because coordinates that
  /// are far more sensitive follow from them, as the angle of a cam from its follower near a dwell.
  bool has_poor_coordinates() const;

  /// Makes the equations anew for the coordinates now chosen and what is held.
  void remake();
  /// Sets the rates of y at the node; false where that fails.
  bool evaluate(double t) { return system_->rates(t, y.data(), dydt.data()); }
  /// Sets the rates at the node to those of another state.
  bool evaluate_at(double t, const std::vector<double>& state) { return system_->rates(t, state.data(), dydt.data()); }
  /// Evaluates the end of the step made last.
  bool evaluate_end(double t) { return system_->rates(t + length, y_new.data(), dydt_new.data()); }
  /// Makes a step of h from t, with the rates at its end. False where that fails.
  bool make(double t, double h) {
    return stepper_->step(t, y, dydt, h, y_new, error) && system_->rates(t + h, y_new.data(), dydt_new.data());
  }
  /// Sets the motion to the node again, from which the next attempt starts, not from the pose that failed.
  void return_to_node(double t);
  /// Repeats the step just made, from t, with the length h; the margin there, NaN where that fails.
  template <class Margin>
  double repeat(double t, double h, const Margin& margin) {
    // It starts from the pose of the node, not from the one that the step ended in.
    reduced_.expect(node.data());
    if (!system_->rates(t, y.data(), dydt_new.data()) || !make(t, h)) return std::numeric_limits<double>::quiet_NaN();
    length = h;
    return margin();
  }
  /// Repeats the step just made from t, over which a margin falls from `margin_before` to the negative `margin_after`
  /// at the length `after`, up to its zero, to rounding, by regula falsi.
  template <class Margin>
  void shorten_to_zero(double t, double margin_before, double after, double margin_after, const Margin& margin_of);
  /// Makes the end of the step the next node.
  void accept() {
    y.swap(y_new);
    dydt.swap(dydt_new);
  }

  const ReducedSystem& system() const { return *system_; }
  /// Why evaluating failed.
  ReducedMotion<double>::Status status() const { return system_->status; }
  int evaluations() const { return past_evaluations_ + (system_ ? system_->evaluations : 0); }

 private:
  const MotionModel& model_;
  const MotionOptions& options_;
  ReducedMotion<double>& reduced_;
  int columns_;
  int past_evaluations_ = 0;
  std::unique_ptr<ReducedSystem> system_;
  std::unique_ptr<solvers::RungeKutta78> stepper_;
};

template <class Margin>
void MotionStep::shorten_to_zero(double t, double margin_before, double after, double margin_after,
                                 const Margin& margin_of) {
  double before = 0.0;
  double margin = margin_after;
  bool was_before = false;
  for (int k = 0; k < 100; ++k) {
    const double crossing = before + (after - before) * margin_before / (margin_before - margin_after);
    const bool is_within = margin_before > stepping::past && crossing > before && crossing < after;
    const double h = is_within ? crossing : (before + after) / 2;
    if (!(h > before && h < after)) break;
    margin = repeat(t, h, margin_of);
    if (std::abs(margin) <= stepping::eps) break;
    // An end that stays is given half its weight the next time.
    if (!(margin >= 0)) {
      after = h;
      margin_after = std::isnan(margin) ? -1.0 : margin;
      if (k > 0 && !was_before) margin_before /= 2;
      was_before = false;
    } else {
      before = h;
      margin_before = margin;
      if (k > 0 && was_before) margin_after /= 2;
      was_before = true;
    }
  }
  if (std::isnan(margin)) repeat(t, before, margin_of);
}

}  // namespace poise
