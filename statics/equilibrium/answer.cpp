#include "statics/equilibrium/answer.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace poise {
namespace {

double applied_loads(const StaticModel& model) {
  const Scene& scene = model.scene();
  double sum = 0.0;
  for (const Force& force : scene.forces) sum += scene.size_of(force);
  for (const Torque& torque : scene.torques) sum += std::abs(torque.value) / model.scales().length;
  for (const Body& body : scene.bodies) sum += body.mass * norm(scene.gravity);
  return sum;
}

double preloads(const StaticModel& model, const Readings& now) {
  const Readings start = read_off(model, assemble(model));
  double sum = 0.0;
  for (std::size_t i = 0; i < now.elements.size(); ++i) {
    const double force = std::min(std::abs(start.elements[i].force), std::abs(now.elements[i].force));
    const bool is_moment = model.scene().elements[i].on.is_angle();
    sum += is_moment ? force / model.scales().length : force;
  }
  return sum;
}

}  // namespace

std::string in_few_words(const Equilibrium& equilibrium) {
  const Certificate& certificate = equilibrium.certificate;
  if (!equilibrium.found()) return to_string(equilibrium.status);
  const bool is_neutral = certificate.outcome == Outcome::neutral && certificate.stability != Stability::neutral;
  const std::string proved = certificate.outcome == Outcome::degenerate ? "degenerate, proved"
                             : is_neutral                               ? "neutral, proved"
                                                                        : "proved";
  return proved + (certificate.stability == Stability::unknown ? std::string(", stability unknown")
                                                               : ": " + to_string(certificate.stability));
}

std::optional<double> error_of(const Answer& answer) {
  if (!answer.equilibrium.found()) return std::nullopt;
  return answer.equilibrium.certificate.moved;
}

Answer measure(const StaticModel& model, Equilibrium equilibrium) {
  Answer answer{std::move(equilibrium), {}, {}, {}};
  const std::vector<double>& x = answer.equilibrium.x;
  const bool searched =
      answer.equilibrium.status != Status::not_applicable && answer.equilibrium.status != Status::not_solved;
  const bool finite = std::all_of(x.begin(), x.end(), [](double v) { return std::isfinite(v); });
  if (searched && finite && !x.empty()) answer.readings = read_off(model, x);
  const std::vector<ElementForce>& forces = answer.equilibrium.check.element_forces;
  for (std::size_t e = 0; answer.readings && e < forces.size(); ++e) {
    answer.readings->elements[e].force = forces[e].value;
    answer.readings->elements[e].radius = forces[e].radius;
  }
  if (answer.equilibrium.found()) {
    answer.reference = refine(model, x);
    answer.radii = enclose_values(model, answer.equilibrium.certificate, answer.equilibrium.check.reactions);
  }
  const bool is_in_balance = answer.equilibrium.found() || answer.equilibrium.status == Status::checked;
  if (!answer.readings || !is_in_balance) return answer;
  // Without self-stress no closure repeats others.
  const bool is_regular = answer.equilibrium.check.redundancy == 0;
  answer.freedoms = freedoms_at(model, x, is_regular ? std::optional(0) : std::nullopt);
  return answer;
}

std::optional<HeavyReaction> heavy_reaction(const StaticModel& model, const Answer& answer, double times) {
  const std::vector<Reaction>& reactions = answer.equilibrium.check.reactions;
  const auto heaviest = std::max_element(reactions.begin(), reactions.end(), [](const Reaction& a, const Reaction& b) {
    return norm(a.force) < norm(b.force);
  });
  if (heaviest == reactions.end() || !answer.readings) return std::nullopt;
  const double force = norm(heaviest->force);
  const double applied = applied_loads(model);
  // Closing the loops of the start takes longer than all else here.
  if (applied <= 0.0 || force < times * applied) return std::nullopt;
  const double load = applied + preloads(model, *answer.readings);
  if (force < times * load) return std::nullopt;
  return HeavyReaction{heaviest->kind, heaviest->name, force, load};
}

}  // namespace poise
