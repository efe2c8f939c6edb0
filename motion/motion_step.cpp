#include "motion/motion_step.hpp"

namespace poise {

bool MotionStep::has_poor_coordinates() const {
  return reduced_.rank() > 0 &&
         (reduced_.pivot() < stepping::good_pivot || reduced_.steepness() > 1 / stepping::good_pivot);
}

void MotionStep::remake() {
  past_evaluations_ = evaluations();
  system_ = std::make_unique<ReducedSystem>(model_.scaled_scene(), reduced_, options_.influences, options_.variations,
                                            columns_);
  system_->set_held(held_by);
  stepper_ = std::make_unique<solvers::RungeKutta78>(*system_);
  for (std::vector<double>* values : {&dydt, &dydt_new, &y_new, &error}) values->resize(y.size());
}

void MotionStep::changes_by(int c, const std::vector<double>& state, int influence, Changes& out) const {
  const auto n = static_cast<std::size_t>(reduced_.coordinates());
  const int f = reduced_.freedoms();
  const double* own = influence < 0 ? nullptr : system_->alpha_p(influence);
  const bool moves = influence >= 0 && options_.influences[static_cast<std::size_t>(influence)].moves();
  for (auto* part : {&out.q, &out.v, &out.a}) part->assign(n, 0.0);
  const auto add = [&](const double* by, double factor) {
    for (auto* part : {&out.q, &out.v, &out.a}) {
      for (std::size_t i = 0; i < n; ++i) (*part)[i] += *by++ * factor;
    }
  };
  if (moves) add(system_->moved_p(influence), 1.0);
  for (int k = 0; k < f; ++k) {
    const double dz = state[sensitivity(k, c)], dw = state[sensitivity(f + k, c)];
    const double more = own != nullptr && !moves ? own[k] : 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      out.q[i] += reduced_.B(k)[i] * dz;
      out.v[i] += reduced_.v_z(k)[i] * dz + reduced_.B(k)[i] * dw;
      out.a[i] += reduced_.a_z(k)[i] * dz + reduced_.a_w(k)[i] * dw + reduced_.B(k)[i] * more;
    }
  }
  for (std::size_t h = 0; h < reduced_.held().size(); ++h) add(system_->moved_held(h), system_->held_by(h)[c]);
}

void MotionStep::return_to_node(double t) {
  const ReducedMotion<double>::Status status = system_->status;
  reduced_.expect(node.data());
  system_->rates(t, y.data(), dydt.data());
  system_->status = status;
}

}  // namespace poise
