#include "motion/controller_efforts.hpp"

#include "statics/bodies/body_measures.hpp"

namespace poise {

ControlOutputs<double> control_outputs(const Scene& scene, const Element& controller,
                                       const std::vector<BodyMotion>& motions) {
  const Feedback& feedback = *controller.feedback;
  const Controller& law = *controller_of(controller.law);
  const double rate = rate_of(scene, motions, feedback.reads);
  ControlSignals<double> in;
  in.value = law.of_rate ? rate : value_of(scene, feedback.reads, poses_of(motions));
  in.rate = law.of_rate ? 0.0 : rate;
  const auto motion_of = [&](int body) { return motions[static_cast<std::size_t>(body)]; };
  if (feedback.integral >= 0) in.integral = motion_of(feedback.integral).rate;
  if (feedback.filter >= 0) {
    in.place = motion_of(feedback.filter).pose.angle;
    in.filtered = motion_of(feedback.filter).rate;
  }
  return law.respond(in);
}

}  // namespace poise
