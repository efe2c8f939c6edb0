#include "motion/controller_efforts.hpp"

#include "statics/bodies/body_measures.hpp"

namespace poise {

namespace {

ControlOutputs<double> outputs_at(const Scene& scene, const Element& controller, const std::vector<BodyMotion>& motions,
                                  bool all) {
  const Feedback& feedback = *controller.feedback;
  const Controller& law = *controller_of(controller.law);
  const double rate = rate_of(scene, motions, feedback.reads);
  ControlSignals<double> in;
  in.value = law.of_rate ? rate : value_of(scene, feedback.reads, poses_of(motions));
  in.rate = law.of_rate ? 0.0 : rate;
  const auto motion_of = [&](int body) { return motions[static_cast<std::size_t>(body)]; };
  const auto rate_of_state = [&](int body) { return body >= 0 ? motion_of(body).rate : 0.0; };
  in.integral = rate_of_state(feedback.integral);
  if (feedback.filter >= 0) in.place = motion_of(feedback.filter).pose.angle;
  in.filtered = rate_of_state(feedback.filter);
  in.held_effort = rate_of_state(feedback.held[0]);
  in.held_integral = rate_of_state(feedback.held[1]);
  in.held_input = rate_of_state(feedback.held[2]);
  // What others give is asked for only where it tells at once, so that loops with states end.
  const auto effort_of = [&](int other) {
    return outputs_at(scene, scene.elements[static_cast<std::size_t>(other)], motions, false).effort;
  };
  if (all || law.is_direct()) {
    if (feedback.follows >= 0) in.followed = effort_of(feedback.follows);
    if (feedback.reads_from >= 0) in.value = effort_of(feedback.reads_from);
  }
  return law.respond(in);
}

}  // namespace

ControlOutputs<double> control_outputs(const Scene& scene, const Element& controller,
                                       const std::vector<BodyMotion>& motions) {
  return outputs_at(scene, controller, motions, true);
}

}  // namespace poise
