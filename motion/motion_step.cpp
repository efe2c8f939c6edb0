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

void MotionStep::return_to_node(double t) {
  const ReducedMotion<double>::Status status = system_->status;
  reduced_.expect(node.data());
  system_->rates(t, y.data(), dydt.data());
  system_->status = status;
}

}  // namespace poise
