#include "motion/profile_borders.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace poise {
namespace {

/// An argument within this distance of a border is at it.
constexpr double at_border = 1e-11;
/// So far it may go back over the border that it comes from: it is not at its end there.
constexpr double room_behind = 1e-10;
constexpr double nudged_by = 3e-13;

/// All terms of a scene with a profile that has borders, in an order that does not depend on numbers.
std::vector<const Measure::Term*> bordered_terms(const Scene& scene) {
  std::vector<const Measure::Term*> out;
  const auto take = [&](const Measure& on) {
    for (const Measure::Term& term : on.terms) {
      if (term.profile && (term.profile->pieces().size() > 1 || !term.profile->periodic())) out.push_back(&term);
    }
  };
  for (const Stop& stop : scene.stops) {
    if (stop.holds()) take(stop.on);
  }
  for (const Drive& drive : scene.drives) take(drive.on);
  for (const Element& element : scene.elements) take(element.on);
  return out;
}

}  // namespace

ProfileBorders::ProfileBorders(const MotionModel& model, const std::vector<Variation>& variations)
    : model_(model), variations_(variations) {
  const std::vector<const Measure::Term*> terms = bordered_terms(model.scaled_scene());
  int scratch = 0;
  const auto place_of = [&](const MotionModel& own, const Measure::Term& term) {
    const double span = term.measure.is_angle() ? 2 * std::numbers::pi : term.span;
    Place out{{own.scaled_scene(), own.layout(), own.mechanism().phasors(), term.measure},
              term.shift,
              span,
              term.profile.get()};
    scratch = std::max(scratch, out.on.scratch_size());
    return out;
  };
  for (const Measure::Term* const term : terms) {
    Argument& argument = arguments_.emplace_back();
    argument.at = place_of(model, *term);
    argument.varied.resize(variations.size());
  }
  for (std::size_t v = 0; v < variations.size() && !terms.empty(); ++v) {
    for (const Variation::Piece& piece : variations[v].pieces) {
      const std::vector<const Measure::Term*> varied = bordered_terms(piece.model->scaled_scene());
      for (std::size_t i = 0; i < varied.size(); ++i) {
        arguments_[i].varied[v].push_back(place_of(*piece.model, *varied[i]));
      }
    }
  }
  pose_.resize(static_cast<std::size_t>(model.mechanism().phasors().pose_size() + scratch));
}

Configuration<double> ProfileBorders::here(const ReducedMotion<double>& motion) {
  const Phasors<double>& phasors = model_.mechanism().phasors();
  phasors.place(motion.q(), pose_.data());
  return {phasors, pose_.data(), pose_.data() + phasors.pose_size()};
}

void ProfileBorders::note(Argument& argument, double u, double rate) {
  constexpr double unlimited = std::numeric_limits<double>::infinity();
  const std::vector<Profile::Piece>& pieces = argument.at.profile->pieces();
  const double turn = argument.at.profile->periodic() ? std::floor(u) : 0.0;
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
    if (argument.at.profile->periodic() || shift == 0.0) borders_of_turn(turn + shift);
  }
}

void ProfileBorders::watch(const ReducedMotion<double>& motion) {
  const Configuration<double> at = here(motion);
  for (Argument& argument : arguments_) {
    note(argument, value(argument.at, at), argument.at.on.along(at, motion.v()) / argument.at.span);
  }
}

double ProfileBorders::margin(const ReducedMotion<double>& motion) {
  const Configuration<double> at = here(motion);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < arguments_.size(); ++i) {
    const double u = value(arguments_[i].at, at);
    const double own = std::min(u - arguments_[i].lower, arguments_[i].upper - u);
    if (!(own < least)) continue;
    least = own;
    least_ = i;
  }
  return least;
}

double ProfileBorders::nudge(const ReducedMotion<double>& motion) {
  const Place& place = arguments_[least_].at;
  return nudged_by * place.span / std::abs(place.on.along(here(motion), motion.v()));
}

double ProfileBorders::border_of(const Place& other, const Place& here, double u) {
  const std::vector<Profile::Piece>&own = here.profile->pieces(), &pieces = other.profile->pieces();
  double nearest = std::numeric_limits<double>::infinity(), out = 0.0;
  const double turn = here.profile->periodic() ? std::floor(u) : 0.0;
  const auto compare = [&](double border, double there) {
    if (!(std::abs(u - border) < nearest)) return;
    nearest = std::abs(u - border);
    out = there;
  };
  for (std::size_t k = 0; k < own.size(); ++k) {
    compare(turn + own[k].from, turn + pieces[k].from);
    compare(turn + own[k].to, turn + pieces[k].to);
  }
  return out;
}

double ProfileBorders::passing_time_by(const ReducedMotion<double>& motion, const double* dq, int variation) {
  const Argument& argument = arguments_[least_];
  const Configuration<double> at = here(motion);
  double change = argument.at.on.along(at, dq) / argument.at.span;
  if (variation >= 0) {
    const auto v = static_cast<std::size_t>(variation);
    const double u = value(argument.at, at);
    for (std::size_t p = 0; p < argument.varied[v].size(); ++p) {
      const Place& other = argument.varied[v][p];
      change += variations_[v].pieces[p].weight * (value(other, at) - border_of(other, argument.at, u));
    }
  }
  const double rate = argument.at.on.along(at, motion.v()) / argument.at.span;
  return rate == 0.0 ? 0.0 : -change / rate;
}

}  // namespace poise
