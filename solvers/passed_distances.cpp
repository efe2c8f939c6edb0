#include "solvers/passed_distances.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "solvers/cubic.hpp"
#include "solvers/vectors.hpp"

namespace poise::solvers {
namespace {

constexpr double least_velocity_cosine = 0.8;  // between velocities
constexpr int deepest = 40;                    // halvings of a step's way

double first_norm(std::span<const double> v) {
  double sum = 0.0;
  for (const double value : v) sum += std::abs(value);
  return sum;
}

}  // namespace

PassedDistances::PassedDistances(const DampedProblem& problem, double touching, PressingBounds& bounds)
    : problem_(problem),
      touching_(touching),
      bounds_(bounds),
      n_(problem.variables()),
      trial_(problem.make_evaluation()),
      measures_(problem.switches().size()),
      gradient_(n_),
      way_(n_),
      way_now_(n_),
      way_next_(n_) {
  for (const Limit& limit : problem.limits()) {
    if (limit.threshold.of_distance) {
      watched_.push_back({problem.equalities() + limit.inequality, -1, limit.threshold, limit.sign});
    }
  }
  for (std::size_t k = 0; k < problem.switches().size(); ++k) {
    const Threshold& threshold = problem.switches()[k];
    if (threshold.of_distance) watched_.push_back({-1, static_cast<int>(k), threshold, 1.0});
  }
}

double PassedDistances::measure(Evaluation& at, const Watched& w) {
  if (w.row >= 0) return at.constraint[w.row];
  problem_.switch_measures(at, measures_);
  return measures_[w.which];
}

double PassedDistances::slope_along(Evaluation& at, const Watched& w, std::span<const double> direction) {
  if (w.row >= 0) return bounds_.rate(at, w.row, direction);
  problem_.switch_gradient(at, w.which, gradient_);
  return dot(gradient_, direction);
}

PassedDistances::Sample PassedDistances::sample(Evaluation& at, const Watched& w, double tau,
                                                std::span<const double> direction) {
  const double g = measure(at, w);
  return {tau, w.threshold.past(g), w.threshold.slope(g) * slope_along(at, w, direction)};
}

PassedDistances::Sample PassedDistances::sample(const Watched& w, double side, double tau) {
  for (int i = 0; i < n_; ++i) {
    const Cubic x(now_->at.x[i], way_now_[i], next_->at.x[i], way_next_[i], 1.0);
    trial_.x[i] = x.at(tau);
    way_[i] = x.slope(tau);
  }
  problem_.evaluate(trial_);
  ++evaluations;
  const Sample found = sample(trial_, w, tau, way_);
  return {tau, side * found.value, side * found.slope};
}

bool PassedDistances::may_pass(const Watched& w, double length, Evaluation& from, Evaluation& to) {
  if (w.row >= 0 && bounds_.active[w.row] != 0) return false;
  return std::abs(measure(from, w) - w.threshold.at) + std::abs(measure(to, w) - w.threshold.at) <= 2.0 * length;
}

bool PassedDistances::may_be_passed(Evaluation& at, std::span<const double> step) {
  const double length = first_norm(step);
  return std::any_of(watched_.begin(), watched_.end(), [&](const Watched& w) { return may_pass(w, length, at, at); });
}

// Makes a velocity's direction the slope of a curve of that length; of no velocity, that of the chord.
void PassedDistances::set_way(std::span<const double> velocity, double length, std::span<double> way) const {
  const double speed = std::sqrt(dot(velocity, velocity));
  for (int i = 0; i < n_; ++i) {
    way[i] = speed > 0.0 ? length / speed * velocity[i] : next_->at.x[i] - now_->at.x[i];
  }
}

double PassedDistances::until_passing(const Moving& now, const Moving& next) {
  if (watched_.empty()) return 1.0;
  now_ = &now;
  next_ = &next;
  for (int i = 0; i < n_; ++i) way_[i] = next.at.x[i] - now.at.x[i];
  const double length = std::sqrt(dot(way_, way_)), sum = first_norm(way_);
  double first = 1.0;
  bool has_way = false;
  for (const Watched& w : watched_) {
    if (sum <= 1e-8 || !may_pass(w, sum, now.at, next.at)) continue;
    if (!has_way) {
      has_way = true;
      set_way(now.velocity, length, way_now_);
      set_way(next.velocity, length, way_next_);
      // The curve tells nothing of a way that turns far.
      if (sum > 1e-3 && dot(way_now_, way_next_) < least_velocity_cosine * length * length) return 0.5;
    }
    Sample a = sample(now.at, w, 0.0, way_now_), b = sample(next.at, w, 1.0, way_next_);
    const bool starts_there = std::abs(a.value) <= 1e-10;
    const double side = w.row >= 0 ? w.sign : std::copysign(1.0, starts_there ? a.slope : a.value);
    for (Sample* s : {&a, &b}) {
      s->value *= side;
      s->slope *= side;
    }
    // Where it begins at the threshold, the integrator does not see it pass.
    if (starts_there && b.value < -touching_) return 0.5;
    first = std::min(first, first_passing(w, side, a, b, deepest));
  }
  if (first == 1.0) return 1.0;
  // The share of the way as a share of time, by the speeds at both ends.
  const double speed = largest(now.velocity), speed_next = largest(next.velocity);
  const double begins = 2.0 * speed / (speed + speed_next);
  const double share = 2.0 * first / (begins + std::sqrt(begins * begins + 4.0 * (1.0 - begins) * first));
  return std::clamp(share, 1e-3, 0.98);
}

// Where between a and b on the curve a distance is known to be past its threshold; 1 if it does not pass.
double PassedDistances::first_passing(const Watched& w, double side, const Sample& a, const Sample& b, int depth) {
  const double h = b.tau - a.tau;
  const Cubic whole(a.value, a.slope, b.value, b.slope, h);
  const Sample mid = sample(w, side, 0.5 * (a.tau + b.tau));
  if (mid.value < -touching_) return mid.tau;
  // Each half has 1/16 of the error in the middle.
  const double error =
      0.25 * std::max(std::abs(whole.at(0.5) - mid.value), 0.1 * std::abs(whole.slope(0.5) - h * mid.slope));
  double first = 1.0;
  for (const auto& [from, to] : {std::pair(a, mid), std::pair(mid, b)}) {
    const double least = Cubic(from.value, from.slope, to.value, to.slope, 0.5 * h).least();
    if (least >= error - touching_ || depth == 0) continue;
    first = std::min(first, first_passing(w, side, from, to, depth - 1));
    if (first < 1.0) break;
  }
  return first;
}

}  // namespace poise::solvers
