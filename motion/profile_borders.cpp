#include "motion/profile_borders.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace poise {
namespace {

/// An argument within this distance of a border is at it.
constexpr double at_border = 1e-11;
/// So far it may go back over the border that it comes from: it is not at its end there.
constexpr double room_behind = 1e-10;
constexpr double nudged_by = 3e-13;

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
  for (std::size_t s = 0; s < scene.stops.size(); ++s) {
    if (scene.stops[s].holds()) take(scene.stops[s].on, static_cast<int>(s));
  }
  for (const Drive& drive : scene.drives) take(drive.on, -1);
  for (const Element& element : scene.elements) take(element.on, -1);
  return out;
}

}  // namespace

ProfileBorders::ProfileBorders(const MotionModel& model, const std::vector<Variation>& variations) : model_(model) {
  int scratch = 0;
  for (const BorderedTerm& one : bordered_terms(model.scaled_scene())) {
    const Measure::Term& term = one.sum.terms[one.term];
    Argument& argument = arguments_.emplace_back();
    argument.at = {{model.scaled_scene(), model.layout(), model.mechanism().phasors(), term.measure},
                   profile_of<double>(term)};
    scratch = std::max(scratch, argument.at.on.scratch_size());
  }
  pose_.resize(static_cast<std::size_t>(model.mechanism().phasors().pose_size() + scratch));
  if (arguments_.empty()) return;
  variations_ = variations;
  for (const Variation& variation : variations) {
    const std::vector<BorderedTerm> terms = bordered_terms(variation.compiled().scene());
    for (std::size_t i = 0; i < terms.size(); ++i) {
      const auto& [sum, term, stop] = terms[i];
      arguments_[i].varied.push_back({variation.compiled().measure(sum.terms[term].measure),
                                      variation.compiled().numbers().term(sum, term, stop).profile()});
    }
  }
}

Configuration<double> ProfileBorders::here(const ReducedMotion<double>& motion) {
  const Phasors<double>& phasors = model_.mechanism().phasors();
  phasors.place(motion.q(), pose_.data());
  return {phasors, pose_.data(), pose_.data() + phasors.pose_size()};
}

void ProfileBorders::note(Argument& argument, double u, double rate) {
  constexpr double unlimited = std::numeric_limits<double>::infinity();
  const std::vector<Profile::Piece>& pieces = argument.at.of.profile->pieces();
  const double turn = argument.at.of.profile->periodic() ? std::floor(u) : 0.0;
  argument.lower = -unlimited;
  argument.upper = unlimited;
  const auto border = [&](double at) {
    const bool is_here = std::abs(u - at) <= at_border;
    if (is_here ? rate >= 0 : at < u)
      argument.lower = std::max(argument.lower, is_here ? at - room_behind : at);
    else
      argument.upper = std::min(argument.upper, is_here ? at + room_behind : at);
  };
  const auto borders_of_turn = [&](double shift) {
    border(pieces.front().from + shift);
    for (const Profile::Piece& piece : pieces) border(piece.to + shift);
  };
  for (const double shift : {-1.0, 0.0, 1.0}) {
    if (argument.at.of.profile->periodic() || shift == 0.0) borders_of_turn(turn + shift);
  }
}

void ProfileBorders::watch(const ReducedMotion<double>& motion) {
  const Configuration<double> at = here(motion);
  for (Argument& argument : arguments_) {
    note(argument, argument.at.value(at), argument.at.on.along(at, motion.v()) / argument.at.of.span);
  }
}

double ProfileBorders::margin(const ReducedMotion<double>& motion) {
  const Configuration<double> at = here(motion);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < arguments_.size(); ++i) {
    const double u = arguments_[i].at.value(at);
    const double own = std::min(u - arguments_[i].lower, arguments_[i].upper - u);
    if (!(own < least)) continue;
    least = own;
    least_ = i;
  }
  return least;
}

double ProfileBorders::nudge(const ReducedMotion<double>& motion) {
  const Place<double>& place = arguments_[least_].at;
  return nudged_by * place.of.span / std::abs(place.on.along(here(motion), motion.v()));
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

double ProfileBorders::passing_time_by(const ReducedMotion<double>& motion, const double* dq, int variation) {
  const Argument& argument = arguments_[least_];
  const Configuration<double> at = here(motion);
  double change = argument.at.on.along(at, dq) / argument.at.of.span;
  if (variation >= 0) {
    change -= border_less_argument_by(motion, argument, static_cast<std::size_t>(variation), argument.at.value(at));
  }
  const double rate = argument.at.on.along(at, motion.v()) / argument.at.of.span;
  return rate == 0.0 ? 0.0 : -change / rate;
}

}  // namespace poise
