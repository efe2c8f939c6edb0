#include "motion/controller_efforts.hpp"

#include <algorithm>
#include <variant>

#include <fmt/format.h>

#include "model/controllers.hpp"
#include "model/input_error.hpp"
#include "statics/bodies/body_measures.hpp"

namespace poise {

namespace {

void add_to(const Feedback& setting, double output, Law& law) {
  std::visit(
      [&](auto& one) {
        const Number& number = numbers_of_law(one)[static_cast<std::size_t>(setting.sets->number)];
        number.set(&one, *number.get(&one) + output);
      },
      law);
}

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
    if (feedback.reads_force >= 0) {
      Element read = scene.elements[static_cast<std::size_t>(feedback.reads_force)];
      const int setting = controller_that_sets(scene, feedback.reads_force);
      if (setting >= 0)
        add_to(*scene.elements[static_cast<std::size_t>(setting)].feedback, effort_of(setting), read.law);
      const double g = value_of(scene, read.on, poses_of(motions)), w = rate_of(scene, motions, read.on);
      in.value = std::visit([&](const auto& one) { return whole_force(one, g, w).value; }, read.law);
    }
  }
  return law.respond(in);
}

}  // namespace

ControlOutputs<double> control_outputs(const Scene& scene, const Element& controller,
                                       const std::vector<BodyMotion>& motions) {
  return outputs_at(scene, controller, motions, true);
}

void refuse_idle_controllers(const MotionModel& model) {
  const Scene& scene = model.scaled_scene();
  for (const Element& element : scene.elements) {
    if (!element.feedback || !element.feedback->acts) continue;
    const CompiledMeasure<double> on(scene, model.layout(), model.mechanism().phasors(), element.on);
    if (!on.support().empty()) continue;
    throw InputError(fmt::format(
        "{}:{}: controller \"{}\": expected a measure that can change, the joints keep the one on which it acts, so "
        "that it does nothing; let it act on another one",
        scene.file, element.line, element.name));
  }
}

const Scene& with_set_numbers(const Scene& scene, const std::vector<BodyMotion>& motions, std::optional<Scene>& room) {
  const auto sets_any = [](const Element& one) { return one.feedback && one.feedback->sets; };
  if (std::none_of(scene.elements.begin(), scene.elements.end(), sets_any)) return scene;
  Scene& out = room.emplace(scene);
  for (std::size_t e = 0; e < scene.elements.size(); ++e) {
    const Element& controller = scene.elements[e];
    if (!sets_any(controller)) continue;
    out.elements[e].feedback->sets.reset();
    const Feedback::Sets& sets = *controller.feedback->sets;
    const double output = control_outputs(scene, controller, motions).effort;
    const auto item = static_cast<std::size_t>(sets.item);
    if (sets.of == TimeFunction::Of::element) add_to(*controller.feedback, output, out.elements[item].law);
    if (sets.of == TimeFunction::Of::force) out.forces[item].vector += output * out.forces[item].along;
    if (sets.of == TimeFunction::Of::torque) out.torques[item].value += output;
  }
  return out;
}

}  // namespace poise
