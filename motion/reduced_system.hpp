#pragma once

#include <vector>

#include "motion/reduced_motion.hpp"
#include "solvers/runge_kutta.hpp"

namespace poise {

/// Equations of motion as a system of first order, with f freedoms:
///   y = z, w, work, then for each sensitivity  dz (f), dw (f)
///   y' = w, alpha, power,                      dw, alpha_z dz + alpha_w dw + alpha_p.
/// The first 2 f sensitivities are those of the initial z and w, the others those of the influences.
class ReducedSystem : public solvers::OdeSystem {
 public:
  /// Both must outlive this; `columns` sensitivities, 0 or 2 f and one per influence.
  ReducedSystem(ReducedMotion<double>& reduced, const std::vector<Influence>& influences, int columns);

  int size() const override { return 2 * freedoms_ + 1 + 2 * freedoms_ * columns_; }
  bool rates(double t, const double* y, double* dydt) override;

  /// The derivative of alpha by influence p, of the state evaluated last.
  const double* alpha_p(int p) const { return &alpha_p_[static_cast<std::size_t>(p * freedoms_)]; }

  int evaluations = 0;
  /// Why rates() has failed.
  ReducedMotion<double>::Status status = ReducedMotion<double>::Status::ok;

 private:
  ReducedMotion<double>& reduced_;
  const std::vector<Influence>& influences_;
  int columns_;
  int freedoms_;
  std::vector<double> alpha_p_;
};

}  // namespace poise
