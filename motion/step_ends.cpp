#include "motion/step_ends.hpp"

#include <cmath>
#include <limits>

#include "motion/private/quintic.hpp"

namespace poise {
namespace {

using stepping::past;

/// Within a step a margin is looked at more closely where it comes so near to zero.
constexpr double close_to_event = 0.05;
/// More than that many events of friction in one step are looked for among those that are left after the first.
constexpr int most_events_of_step = 8;
/// A border of a profile is reached at this distance of the argument.
constexpr double just_before = 1e-13;

}  // namespace

void StepEnds::watch() {
  // At the start nothing is known of what is at rest, which has no friction there; the same node is added again with
  // it.
  if (reduced_.sliding() != nullptr) friction_.watch(reduced_);
  if (contacts_.act()) contacts_.watch(reduced_);
  if (reduced_.sliding() != nullptr || contacts_.act()) margin_ = margin();
  if (!borders_.act()) return;
  borders_.watch(reduced_);
  border_margin_ = borders_.margin(reduced_);
}

bool StepEnds::meets_hit(double t) {
  // Over small angles gaps are polynomials of the time as coordinates are; half-way in a step of several turns they may
  // be so by chance.
  constexpr double little = 0.3, too_far = 1.0;
  constexpr int most_repeats = 6, most_halvings = 40;
  const auto is_followed = [&] {
    const bool turns = turned() > little;
    if (!turns && !contacts_.are_curved()) return true;
    return !(turned() > too_far) && follows_gaps(t, turns);
  };
  for (int k = 0; k < most_halvings && !is_followed(); ++k) {
    step_.repeat(t, step_.length / 2, [] { return 0.0; });
  }
  const double whole = step_.length;
  double at = contacts_.first_hit(reduced_, whole);
  if (at == 0.0) return false;
  const auto gap = [this] { return contacts_.miss(reduced_).gap; };
  double last = std::numeric_limits<double>::infinity();
  for (int k = 0; k < most_repeats; ++k) {
    const double off = step_.repeat(t, at, gap);
    const Contacts::Miss miss = contacts_.miss(reduced_);
    // Rounding of the place, or no better than before.
    if (std::abs(off) <= 4 * stepping::eps || !(std::abs(off) < 0.5 * last)) break;
    const double next = at + miss.time;
    if (!(next > 0.0 && next <= whole) || next == at) break;
    last = std::abs(off);
    at = next;
  }
  constexpr double near = 1e-12;
  if (contacts_.miss(reduced_).gap < near) return true;
  // It only comes near zero; or what is nearest of an outline changes on the way, and it is inside at the end.
  const double at_end = step_.repeat(t, whole, gap);
  if (!(at_end < -past)) return false;
  step_.shorten_to_zero(t, contacts_.gap_before(), whole, at_end, gap);
  return contacts_.miss(reduced_).gap < near;
}

bool StepEnds::is_of_friction() { return friction_margin() <= contacts_.force_margin(reduced_); }

bool StepEnds::meets_event(double t) {
  const auto margin = [this] { return this->margin(); };
  bool met = false;
  // Before an event there may be another one.
  for (int k = 0; k < most_events_of_step; ++k) {
    const double margin_at_end = margin();
    const bool holds = StickSlip::holds(reduced_) || !reduced_.touching().empty();
    double after = holds ? first_passing(t, margin_at_end) : 0.0;
    if (after == 0.0 && margin_at_end < -past) {
      step_.shorten_to_zero(t, margin_, step_.length, margin_at_end, margin);
      met = true;
      continue;
    }
    if (after == 0.0 && friction_.acts()) after = friction_.dip(reduced_, step_.length);
    if (after == 0.0) break;
    const double whole = step_.length;
    const double margin_after = step_.repeat(t, after, margin);
    if (!(margin_after < -past)) {
      step_.repeat(t, whole, margin);
      break;
    }
    step_.shorten_to_zero(t, margin_, after, margin_after, margin);
    met = true;
  }
  if (met) margin();
  return met;
}

// Sets `within_` to the state a part x of the way through the step just made, of the quintic through places, rates and
// accelerations at both ends.
void StepEnds::state_within(double x) {
  const auto f = static_cast<std::size_t>(reduced_.freedoms());
  const double h = step_.length;
  const std::vector<double>&y = step_.y, &y_new = step_.y_new, &dydt = step_.dydt, &dydt_new = step_.dydt_new;
  within_.resize(2 * f);
  for (std::size_t k = 0; k < f; ++k) {
    const Quintic p{h, y[k], y[f + k], dydt[f + k], y_new[k], y_new[f + k], dydt_new[f + k]};
    within_[k] = p.at(x);
    within_[f + k] = p.slope(x) / h;
  }
}

// Computes the margin there; NaN where that fails.
double StepEnds::margin_within(double t, double x) {
  state_within(x);
  if (reduced_.evaluate(t + x * step_.length, within_.data(), within_.data() + reduced_.freedoms()) !=
      ReducedMotion<double>::Status::ok) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  return margin();
}

// The angle by which something turns in the step just made on which gaps depend.
double StepEnds::turned() const {
  double most = 0.0;
  for (const int i : contacts_.angles()) {
    const double way = std::abs(reduced_.q()[i] - step_.node[static_cast<std::size_t>(i)]);
    most = std::max({most, way, step_.length * std::abs(reduced_.v()[i])});
  }
  return most;
}

// Whether the gaps half-way in the step just made are those of their polynomials, or not near zero.
bool StepEnds::follows_gaps(double t, bool turns) {
  const std::vector<Contacts::End> ends = contacts_.ends(reduced_);
  end_.assign(reduced_.q(), reduced_.q() + n_);
  state_within(0.5);
  reduced_.expect(step_.node.data());
  step_.evaluate(t);
  const bool placed = reduced_.place(t + step_.length / 2, within_.data()) == ReducedMotion<double>::Status::ok;
  const bool follows = placed && contacts_.are_followed(reduced_, step_.length, ends, turns);
  reduced_.expect(end_.data());
  step_.evaluate_end(t);
  return follows;
}

// Finds the time within the step just made at which a margin that is positive at the node has passed zero, 0 if it does
// not. Between the places looked at margins are parabolas, of which the lowest point is looked at.
double StepEnds::first_passing(double t, double margin_at_end) {
  constexpr int places = 5;
  double margins[places + 1] = {margin_};
  double passed = 0.0;
  end_.assign(reduced_.q(), reduced_.q() + n_);
  // The way begins at the node, whose rates these are already; those at the end are needed on it.
  reduced_.expect(step_.node.data());
  step_.evaluate(t);
  for (int k = 1; k <= places && passed == 0.0; ++k) {
    margins[k] = k == places ? margin_at_end : margin_within(t, static_cast<double>(k) / places);
    if (margins[k] < -past && k < places) passed = static_cast<double>(k) / places;
    if (k < 2 || passed > 0.0) continue;
    const double before = margins[k - 2], low = margins[k - 1], after = margins[k];
    const double bend = before - 2 * low + after;
    if (!(low <= before && low <= after && bend > 0)) continue;
    const double x = (k - 1 + (before - after) / (2 * bend)) / places;
    const double least = low - (before - after) * (before - after) / (8 * bend);
    if (least < close_to_event && margin_within(t, x) < -past) passed = x;
  }
  reduced_.expect(end_.data());
  step_.evaluate_end(t);
  return passed * step_.length;
}

StepEnds::Border StepEnds::meets_border(double t) {
  // The step ends just before it, where the formulas of this piece hold.
  const auto margin = [this] { return borders_.margin(reduced_) - just_before; };
  const double margin_after = margin();
  if (!(margin_after < -past)) return {};
  step_.shorten_to_zero(t, border_margin_, step_.length, margin_after, margin);
  if (step_.has_poor_coordinates()) {
    // A profile may begin to dwell there, where its own measure is no coordinate any more: others are chosen on the
    // way.
    step_.repeat(t, step_.length / 2, margin);
    return {};
  }
  if (approaches_ == stepping::steps_at_border) {
    approaches_ = 0;
    return {.is_reached = true};
  }
  ++approaches_;
  const double rest = stepping::shorter_at_border * step_.length;
  step_.repeat(t, step_.length - rest, margin);
  return {.rest = rest};
}

}  // namespace poise
