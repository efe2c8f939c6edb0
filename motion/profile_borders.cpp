#include "motion/profile_borders.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace poise {
namespace {

/// An argument within this distance of a border is at it.
constexpr double at_border = 1e-11;
/// So far it may go back over the border that it comes from: it is not at its end there.
constexpr double room_behind = 1e-10;
constexpr double nudged_by = 3e-13;
/// Least size of a rate in the units of the scaled scene: so that what rests crosses no border by rounding.
constexpr double slowest = 1e-6;

/// A term of a scene with a profile that has borders.
struct BorderedTerm {
  const Measure& sum;
  std::size_t term;
  int stop;  // -1 of other sums
};

/// All of them, in an order that does not depend on numbers.
std::vector<BorderedTerm> bordered_terms(const Scene& scene) {
  std::vector<BorderedTerm> out;
  const auto take = [&](const Measure& on, int stop) {
    for (std::size_t k = 0; k < on.terms.size(); ++k) {
      const Measure::Term& term = on.terms[k];
      if (term.profile && (term.profile->pieces().size() > 1 || !term.profile->periodic()))
        out.push_back({on, k, stop});
    }
  };
  for (std::size_t s = 0; s < scene.stops.size(); ++s) take(scene.stops[s].on, static_cast<int>(s));
  for (const Drive& drive : scene.drives) take(drive.on, -1);
  for (const Element& element : scene.elements) take(element.on, -1);
  return out;
}

/// The derivatives of the borders of a law by one of its numbers.
std::vector<double> borders_by_number(const Law& law, bool is_rate, int number) {
  using Dual = VariedModel::Dual;
  const std::vector<Dual> borders = std::visit(
      [&](const auto& l) {
        std::vector<Dual> numbers;
        for (const Number& one : numbers_of_law(l)) numbers.emplace_back(one.get(&l).value_or(0.0));
        numbers[static_cast<std::size_t>(number)].v[0] = 1.0;
        return borders_of<Dual>(l.with(numbers.data()), is_rate);
      },
      law);
  std::vector<double> out;
  for (const Dual& border : borders) out.push_back(border.v[0]);
  return out;
}

/// A number that a controller has.
const Number& number_of_id(const Controller& controller, int id) {
  const unsigned below = controller.given & ((1U << id) - 1U);
  return controller.all_numbers()[static_cast<std::size_t>(std::popcount(below))];
}

/// Whether a function of time moves borders of an element's law: then they are not known at other times.
bool borders_vary_in_time(const Scene& scene, int element, bool is_rate) {
  const Law& law = scene.elements[static_cast<std::size_t>(element)].law;
  return std::any_of(scene.time_functions.begin(), scene.time_functions.end(), [&](const TimeFunction& function) {
    if (function.of != TimeFunction::Of::element || function.item != element) return false;
    const std::vector<double> by = borders_by_number(law, is_rate, function.part);
    return std::any_of(by.begin(), by.end(), [](double one) { return one != 0.0; });
  });
}

}  // namespace

ProfileBorders::ProfileBorders(const MotionModel& model, const std::vector<Variation>& variations,
                               const std::vector<Influence>& influences)
    : model_(model), variations_(variations), influences_(influences) {
  int scratch = 0;
  for (const BorderedTerm& one : bordered_terms(model.scaled_scene())) {
    const Measure::Term& term = one.sum.terms[one.term];
    Argument& argument = arguments_.emplace_back();
    argument.at = {{model.scaled_scene(), model.layout(), model.mechanism().phasors(), term.measure},
                   profile_of<double>(term)};
    scratch = std::max(scratch, argument.at.on.scratch_size());
  }
  for (const Variation& variation : variations) {
    const std::vector<BorderedTerm> terms = bordered_terms(variation.compiled().scene());
    for (std::size_t i = 0; i < terms.size(); ++i) {
      const auto& [sum, term, stop] = terms[i];
      arguments_[i].varied.push_back({variation.compiled().measure(sum.terms[term].measure),
                                      variation.compiled().numbers().term(sum, term, stop).profile()});
    }
  }
  add_laws(model, scratch);
  add_controllers();
  const int size = std::max(model.mechanism().phasors().pose_size() + scratch, model.mechanism().pose_size());
  pose_.resize(static_cast<std::size_t>(size));
}

void ProfileBorders::add_controllers() {
  const Scene& scene = model_.scaled_scene();
  for (std::size_t e = 0; e < scene.elements.size(); ++e) {
    const Controller* const law = controller_of(scene.elements[e].law);
    if (law == nullptr) continue;
    const auto varies = [&](int id) {
      const Number& own = number_of_id(*law, id);
      return std::any_of(scene.time_functions.begin(), scene.time_functions.end(), [&](const TimeFunction& function) {
        return function.of == TimeFunction::Of::element && function.item == static_cast<int>(e) &&
               numbers_of(scene.elements[e].law)[static_cast<std::size_t>(function.part)].key == own.key;
      });
    };
    if (law->has(Controller::period)) continue;  // it decides at its samples alone, where steps end
    OfController effort{static_cast<int>(e), true, {}};
    for (const int id : {Controller::min, Controller::max}) {
      if (law->has(id) && !varies(id)) effort.borders.push_back(law->values[static_cast<std::size_t>(id)]);
    }
    if (!effort.borders.empty()) {
      const double way = effort.borders.back() - effort.borders.front(), one = std::abs(effort.borders.front());
      effort.size = way > 0.0 ? way : one > 0.0 ? one : 1.0;
      arguments_.emplace_back().controller = std::move(effort);
    }
    const bool has_band = law->has(Controller::dead_band);
    if (has_band && varies(Controller::dead_band)) continue;
    const double half = has_band ? law->values[Controller::dead_band] : 0.0;
    OfController error{static_cast<int>(e), false, {}};
    if (half > 0.0) error.borders = {-half, half};
    if (law->curve) {
      for (const double x : law->curve->x()) {
        if (x != 0.0 || half == 0.0) error.borders.push_back(x < 0.0 ? x - half : x + half);
      }
    }
    if (error.borders.empty()) continue;
    for (const double border : error.borders) error.size = std::max(error.size, std::abs(border));
    arguments_.emplace_back().controller = std::move(error);
  }
}

ProfileBorders::Known ProfileBorders::known_by(int element, const ReducedMotion<double>& motion, bool all) const {
  const Mechanism<double>& m = model_.mechanism();
  const Controller& law = *controller_of(m.law_of(element));
  std::vector<Tangent<double>> numbers;
  for (const Number& number : law.all_numbers()) numbers.emplace_back(number.get(&law).value());
  const double t = motion.time(), near = std::isnan(motion.near()) ? t : motion.near();
  for (const MotionInput& input : motion.inputs()) {
    if (input.of != MotionInput::Of::element || input.item != element) continue;
    Tangent<double>& number = numbers[static_cast<std::size_t>(input.number())];
    const Tangent<double> now{input.at(t, 0, near), input.at(t, 1, near)};
    number = input.multiplies ? number * now : now;
  }
  Known out{law.with(numbers.data()), {}};
  out.in = Controller::tangents(m.own_signals_of(element, pose_.data(), motion.v()),
                                m.own_signals_along(element, pose_.data(), motion.v(), motion.v(), motion.a()));
  const Feedback& feedback = *model_.scene().elements[static_cast<std::size_t>(element)].feedback;
  const auto effort_of = [&](int other) {
    const Known there = known_by(other, motion, false);
    return there.law.respond(there.in).effort;
  };
  // What others give is asked for only where it tells at once, so that loops with states end.
  if (!all && !law.is_direct()) return out;
  if (feedback.follows >= 0) out.in.followed = effort_of(feedback.follows);
  if (feedback.reads_from >= 0) out.in.value = effort_of(feedback.reads_from);
  if (feedback.reads_force >= 0) {
    const ControlChange<double> in_time{.dq = motion.v(), .dv = motion.a()};
    const ForcesInTime<double> laws = motion.forces_in_time();
    out.in.value = {m.signals_of(element, pose_.data(), motion.v(), laws).value,
                    m.signals_along(element, pose_.data(), motion.v(), in_time, laws).value};
  }
  return out;
}

/// The argument of a controller at the state of the motion, and its rate.
Tangent<double> ProfileBorders::in_time(const OfController& controller, const ReducedMotion<double>& motion) const {
  const Known known = known_by(controller.element, motion, true);
  const Tangent<double> out = controller.is_effort
                                  ? known.law.respond(known.in).unlimited
                                  : known.law.values[Controller::reference] + known.in.followed - known.in.value;
  return out / Tangent<double>(controller.size);
}

double ProfileBorders::terms_of(const OfController& controller, const ReducedMotion<double>& motion) const {
  const Known known = known_by(controller.element, motion, true);
  const Controller& law = *controller_of(model_.mechanism().law_of(controller.element));
  const auto number = [&](int id) { return law.has(id) ? std::abs(law.values[static_cast<std::size_t>(id)]) : 0.0; };
  const double value = std::abs(known.in.value.value), filtered = law.unit * std::abs(known.in.filtered.value);
  const double place = law.unit * std::abs(known.in.place.value);
  const double error = number(Controller::reference) + std::abs(known.in.followed.value) + value;
  if (!controller.is_effort) return error;
  const double rate =
      law.has(Controller::filter) ? (value + filtered) / number(Controller::filter) : std::abs(known.in.rate.value);
  double sum = number(Controller::proportional) * error +
               number(Controller::integral) * law.unit * std::abs(known.in.integral.value) +
               number(Controller::derivative) * rate;
  if (law.curve) sum += std::abs(law.curve->force(error).first) + std::abs(law.curve->force(-error).first);
  if (law.order > 0) {
    const double below = law.order == 1
                             ? number(Controller::denominator) * filtered
                             : number(Controller::denominator) * place + number(Controller::denominator + 1) * filtered;
    const double change = (error + below) / number(Controller::denominator + law.order);
    sum += number(Controller::numerator) * (law.order == 1 ? filtered : place) +
           number(Controller::numerator + 1) * (law.order == 1 ? change : filtered) +
           number(Controller::numerator + 2) * change;
  }
  return sum;
}

void ProfileBorders::add_laws(const MotionModel& model, int& scratch) {
  const Scene& scene = model.scaled_scene();
  for (std::size_t e = 0; e < scene.elements.size(); ++e) {
    for (const bool is_rate : {false, true}) {
      OfLaw of{static_cast<int>(e), is_rate, {}, {}, borders_of(scene.elements[e].law, is_rate)};
      if (of.borders.empty() || borders_vary_in_time(model.scene(), static_cast<int>(e), is_rate)) continue;
      of.on = {scene, model.layout(), model.mechanism().phasors(), scene.elements[e].on};
      if (of.on.support().empty()) continue;
      scratch = std::max(scratch, of.on.scratch_size());
      for (const Variation& variation : variations_) {
        of.varied.push_back(variation.compiled().measure(variation.compiled().scene().elements[e].on));
      }
      if (is_rate) of.size = slowest;
      arguments_.emplace_back().law = std::move(of);
    }
  }
}

double ProfileBorders::value(const Argument& argument, const Configuration<double>& at,
                             const ReducedMotion<double>& motion) const {
  if (argument.controller) return in_time(*argument.controller, motion).value;
  if (!argument.law) return argument.at.value(at);
  const OfLaw& law = *argument.law;
  return (law.is_rate ? law.on.along(at, motion.v()) : law.on.value(at)) / law.size;
}

double ProfileBorders::rate(const Argument& argument, const Configuration<double>& at,
                            const ReducedMotion<double>& motion) const {
  if (argument.controller) return in_time(*argument.controller, motion).slope;
  if (!argument.law) return argument.at.on.along(at, motion.v()) / argument.at.of.span;
  const OfLaw& law = *argument.law;
  if (!law.is_rate) return law.on.along(at, motion.v());
  return (law.on.along(at, motion.a()) + law.on.second(at, motion.v(), motion.v())) / law.size;
}

Configuration<double> ProfileBorders::here(const ReducedMotion<double>& motion) {
  const Phasors<double>& phasors = model_.mechanism().phasors();
  phasors.place(motion.q(), pose_.data());
  return {phasors, pose_.data(), pose_.data() + phasors.pose_size()};
}

/// use(border) with the borders of an argument of the value u, of a profile those of the turn before to the turn
/// behind.
template <class Use>
void ProfileBorders::for_borders(const Argument& argument, double u, Use use) {
  if (argument.controller) {
    for (const double at : argument.controller->borders) use(at / argument.controller->size);
    return;
  }
  if (argument.law) {
    for (const double at : argument.law->borders) use(at / argument.law->size);
    return;
  }
  const std::vector<Profile::Piece>& pieces = argument.at.of.profile->pieces();
  const bool is_periodic = argument.at.of.profile->periodic();
  const double turn = is_periodic ? std::floor(u) : 0.0;
  for (const double shift : {-1.0, 0.0, 1.0}) {
    if (!is_periodic && shift != 0.0) continue;
    use(pieces.front().from + turn + shift);
    for (const Profile::Piece& piece : pieces) use(piece.to + turn + shift);
  }
}

void ProfileBorders::note(Argument& argument, double u, double rate) {
  constexpr double unlimited = std::numeric_limits<double>::infinity();
  argument.lower = -unlimited;
  argument.upper = unlimited;
  for_borders(argument, u, [&](double at) {
    const bool is_here = std::abs(u - at) <= at_border;
    if (is_here ? rate >= 0 : at < u)
      argument.lower = std::max(argument.lower, is_here ? at - room_behind : at);
    else
      argument.upper = std::min(argument.upper, is_here ? at + room_behind : at);
  });
}

double ProfileBorders::nudge_at_border(const ReducedMotion<double>& motion) {
  const Configuration<double> at = here(motion);
  double out = 0.0;
  for (const Argument& argument : arguments_) {
    const double u = value(argument, at, motion), speed = std::abs(rate(argument, at, motion));
    if (speed == 0.0) continue;
    for_borders(argument, u, [&](double border) {
      if (std::abs(u - border) <= at_border) out = std::max(out, (nudged_by + std::abs(u - border)) / speed);
    });
  }
  return out;
}

void ProfileBorders::watch(const ReducedMotion<double>& motion) {
  const Configuration<double> at = here(motion);
  for (Argument& argument : arguments_) {
    if (argument.law && argument.law->is_rate) {
      argument.law->size = std::max(argument.law->size, std::abs(argument.law->on.along(at, motion.v())));
    }
    if (argument.controller) {
      argument.controller->size = std::max(argument.controller->size, terms_of(*argument.controller, motion));
    }
    note(argument, value(argument, at, motion), rate(argument, at, motion));
  }
}

double ProfileBorders::margin(const ReducedMotion<double>& motion) {
  const Configuration<double> at = here(motion);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < arguments_.size(); ++i) {
    const double u = value(arguments_[i], at, motion);
    const double own = std::min(u - arguments_[i].lower, arguments_[i].upper - u);
    if (!(own < least)) continue;
    least = own;
    least_ = i;
  }
  return least;
}

double ProfileBorders::nudge(const ReducedMotion<double>& motion) {
  return nudged_by / std::abs(rate(arguments_[least_], here(motion), motion));
}

double ProfileBorders::border_less_argument_by(const ReducedMotion<double>& motion, const Argument& argument,
                                               std::size_t variation, double u) const {
  using Dual = VariedModel::Dual;
  const Place<Dual>& place = argument.varied[variation];
  const double argument_by = variations_[variation].compiled().derivative(
      place.on, motion.q(), [&](const Configuration<Dual>& there) { return place.value(there); });
  // The borders of other profiles are no numbers, or nothing jumps there that acts on motion: a spline is smooth
  // enough.
  if (!place.of.rolling) return -argument_by;
  const std::vector<Profile::Piece>& pieces = argument.at.of.profile->pieces();
  const double turn = argument.at.of.profile->periodic() ? std::floor(u) : 0.0;
  double nearest = std::numeric_limits<double>::infinity(), border_by = 0.0;
  const auto compare = [&](double border, const Dual& there) {
    if (!(std::abs(u - turn - border) < nearest)) return;
    nearest = std::abs(u - turn - border);
    border_by = there.v[0];
  };
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    compare(pieces[k].from, place.of.rolling->pieces()[k].from);
    compare(pieces[k].to, place.of.rolling->pieces()[k].to);
  }
  return border_by - argument_by;
}

double ProfileBorders::passing_time_by(const ReducedMotion<double>& motion, const double* dq, const double* dv,
                                       int influence) {
  const Argument& argument = arguments_[least_];
  if (argument.controller) return 0.0;  // accelerations do not jump there
  if (argument.law) return law_passing_time_by(motion, *argument.law, dq, dv, influence);
  const Configuration<double> at = here(motion);
  double change = argument.at.on.along(at, dq) / argument.at.of.span;
  const int variation = influence >= 0 ? influences_[static_cast<std::size_t>(influence)].variation : -1;
  if (variation >= 0) {
    change -= border_less_argument_by(motion, argument, static_cast<std::size_t>(variation), argument.at.value(at));
  }
  const double passing = rate(argument, at, motion);
  return passing == 0.0 ? 0.0 : -change / passing;
}

double ProfileBorders::law_passing_time_by(const ReducedMotion<double>& motion, const OfLaw& law, const double* dq,
                                           const double* dv, int influence) {
  const Configuration<double> at = here(motion);
  const double* v = motion.v();
  double change = law.is_rate ? law.on.along(at, dv) + law.on.second(at, v, dq) : law.on.along(at, dq);
  const double passing = law.is_rate ? law.on.along(at, motion.a()) + law.on.second(at, v, v) : law.on.along(at, v);
  if (passing == 0.0) return 0.0;
  if (influence >= 0) {
    const Influence& by = influences_[static_cast<std::size_t>(influence)];
    if (by.variation >= 0) {
      const auto variation = static_cast<std::size_t>(by.variation);
      const std::vector<VariedModel::Dual> rates(v, v + motion.coordinates());
      change += variations_[variation].compiled().derivative(
          law.varied[variation], motion.q(), [&](const Configuration<VariedModel::Dual>& there) {
            return law.is_rate ? law.varied[variation].along(there, rates.data()) : law.varied[variation].value(there);
          });
    }
    const double now = law.is_rate ? law.on.along(at, v) : law.on.value(at);
    const auto nearest = std::min_element(law.borders.begin(), law.borders.end(),
                                          [&](double a, double b) { return std::abs(a - now) < std::abs(b - now); });
    change -= border_of_law_by(law, static_cast<std::size_t>(nearest - law.borders.begin()), by);
  }
  return -change / passing;
}

double ProfileBorders::border_of_law_by(const OfLaw& law, std::size_t border, const Influence& by) const {
  if (by.variation >= 0) {
    const VariedModel& compiled = variations_[static_cast<std::size_t>(by.variation)].compiled();
    return borders_of(compiled.mechanism().law_of(law.element), law.is_rate)[border].v[0];
  }
  const bool is_own = by.body < 0 && by.drive < 0 && by.force.of == ForceNumber::Of::element &&
                      by.force.item == law.element && by.force.time_number < 0;
  if (!is_own) return 0.0;
  return by.by * borders_by_number(model_.scaled_scene().elements[static_cast<std::size_t>(law.element)].law,
                                   law.is_rate, by.force.number)[border];
}

}  // namespace poise
