#pragma once

#include <memory>
#include <vector>

#include "motion/reduced_motion.hpp"
#include "solvers/runge_kutta.hpp"

namespace poise {

/// Equations of motion as a first-order system, with f degrees of freedom:
///   y = z, w, work, then of z and of w a row of sensitivities for each coordinate,  dz (f rows), dw (f rows)
///   y' = w, alpha, power,                                                           dw, alpha_z dz + alpha_w dw +
///   alpha_p.
/// The first sensitivities are those of the initial z and w, the others those of the influences.
///
/// Rounding eps of the loops' closure makes alpha uncertain by eps rate^2 / pivot^3. Near singular poses it is
/// therefore evaluated in long double (without effect where that is the same as double).
class ReducedSystem : public solvers::OdeSystem {
 public:
  /// All must outlive this; `scene` is that of `reduced`, `columns` sensitivities are 0, or those of the initial state
  /// and one per influence.
  ReducedSystem(const Scene& scene, ReducedMotion<double>& reduced, const std::vector<Influence>& influences,
                const std::vector<Variation>& variations, int columns);
  ~ReducedSystem() override;

  int size() const override { return 2 * freedoms_ + 1 + 2 * freedoms_ * columns_; }
  bool rates(double t, const double* y, double* dydt) override;

  /// The derivative of alpha by influence p, of the state evaluated last.
  const double* alpha_p(int p) const { return alpha_p_.data() + static_cast<std::size_t>(p * freedoms_); }
  /// Of an influence that moves(): the derivatives of q, v and a at fixed z and w, one after the other.
  const double* moved_p(int p) const {
    return moved_p_.data() + 3 * static_cast<std::size_t>(p * reduced_.coordinates());
  }

  /// The values at which friction is held change, too: their sensitivities, a row for each of ReducedMotion::held().
  void set_held(std::vector<double> by) { held_by_ = std::move(by); }
  const double* held_by(std::size_t h) const { return held_by_.data() + h * static_cast<std::size_t>(columns_); }
  /// q, v and a by the value at which the h-th is held, at fixed z and w, of the state evaluated last.
  const double* moved_held(std::size_t h) const {
    return moved_held_.data() + 3 * h * static_cast<std::size_t>(reduced_.coordinates());
  }

  int evaluations = 0;
  /// Why rates() failed.
  ReducedMotion<double>::Status status = ReducedMotion<double>::Status::ok;

 private:
  class Fine;
  template <class T>
  void fill(ReducedMotion<T>& motion, const double* y, double* dydt);

  const Scene& scene_;
  ReducedMotion<double>& reduced_;
  const std::vector<Influence>& influences_;
  const std::vector<Variation>& variations_;
  int columns_;
  int freedoms_;
  double t_ = 0.0;  // of the state evaluated last
  std::vector<double> alpha_p_, moved_p_, held_by_, alpha_held_, moved_held_;
  std::unique_ptr<Fine> fine_;  // made at first use
};

}  // namespace poise
