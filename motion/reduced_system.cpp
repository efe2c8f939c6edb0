#include "motion/reduced_system.hpp"

#include <algorithm>

namespace poise {

using Status = ReducedMotion<double>::Status;

ReducedSystem::ReducedSystem(ReducedMotion<double>& reduced, const std::vector<Influence>& influences, int columns)
    : reduced_(reduced),
      influences_(influences),
      columns_(columns),
      freedoms_(reduced.freedoms()),
      alpha_p_(influences.size() * static_cast<std::size_t>(freedoms_)) {}

bool ReducedSystem::rates(double t, const double* y, double* dydt) {
  ++evaluations;
  const int f = freedoms_;
  status = reduced_.place(t, y);
  if (status != Status::ok) return false;
  reduced_.move(y + f);
  status = reduced_.accelerate();
  if (status != Status::ok) return false;
  std::copy(y + f, y + 2 * f, dydt);
  std::copy(reduced_.alpha(), reduced_.alpha() + f, dydt + f);
  dydt[2 * f] = reduced_.power();
  if (columns_ == 0) return true;
  reduced_.linearize();
  for (std::size_t p = 0; p < influences_.size(); ++p) {
    reduced_.influence(influences_[p], &alpha_p_[p * static_cast<std::size_t>(f)]);
  }
  const double* s = y + 2 * f + 1;
  double* ds = dydt + 2 * f + 1;
  for (int c = 0; c < columns_; ++c, s += 2 * f, ds += 2 * f) {
    std::copy(s + f, s + 2 * f, ds);
    const double* own = c < 2 * f ? nullptr : &alpha_p_[static_cast<std::size_t>((c - 2 * f) * f)];
    for (int j = 0; j < f; ++j) {
      double sum = own != nullptr ? own[j] : 0.0;
      for (int k = 0; k < f; ++k) sum += reduced_.alpha_z(k)[j] * s[k] + reduced_.alpha_w(k)[j] * s[f + k];
      ds[f + j] = sum;
    }
  }
  return true;
}

}  // namespace poise
