#include "solvers/damped_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "solvers/kkt.hpp"
#include "solvers/passed_distances.hpp"
#include "solvers/pressing_bounds.hpp"
#include "solvers/vectors.hpp"

namespace poise::solvers {
namespace {

constexpr double eps = std::numeric_limits<double>::epsilon();
constexpr int most_columns = 7;           // of the extrapolation
constexpr int largest_dense_motion = 48;  // variables up to which factors are dense
constexpr int closings = 10;              // Newton steps onto the constraints
constexpr double finish_within = 0.2;     // first Newton step of the finish, rad or mechanism sizes
constexpr double contraction = 0.25;      // of the second
constexpr int finish_steps = 12;
constexpr double separation = 0.1;    // distance at which motions count as having parted
constexpr int event_steps = 60;       // to locate an event
constexpr double least_step = 1e-14;  // of time, relative to the first one

}  // namespace

class DampedMotion::Integrator {
 public:
  Integrator(const DampedProblem& problem, const DampedOptions& given)
      : problem_(problem),
        options_(given),
        n_(problem.variables()),
        equalities_(problem.equalities()),
        rows_(problem.constraints()),
        symmetric_(problem.has_objective()),
        kkt_(!symmetric_ || n_ <= largest_dense_motion ? make_null_space(problem) : make_sparse_kkt(problem)),
        now_(problem.make_evaluation()),
        next_(problem.make_evaluation()),
        trial_(problem.make_evaluation()),
        bounds_(problem, given.touching, *kkt_),
        distances_(problem, given.touching, bounds_),
        switch_now_(problem.switches().size()),
        switch_next_(problem.switches().size()) {
    for (auto* v : {&velocity_, &velocity_next_, &step_, &field_, &delta_, &delta_column_}) v->resize(n_);
    for (auto* v : {&y_, &y_next_, &y_trial_}) v->resize(rows_);
    for (auto* v : {&tangent_, &resistance_, &values_, &first_tangent_, &first_resistance_}) {
      v->resize(problem.tangent_pattern().size());
    }
    for (auto& column : table_) column.resize(n_);
    result.x.resize(n_);
  }

  void run(std::span<const double> x, double tolerance) {
    tolerance_ = tolerance > 0.0 ? tolerance : options_.tolerance;
    // The smaller the tolerance the higher the order that takes least work.
    columns_ = std::clamp(static_cast<int>(1.5 - 0.55 * std::log10(tolerance_)), 3, most_columns - 1);
    begin(x);
    result.arrival = follow();
    result.x = now_.x;
    result.active = bounds_.active;
    result.evaluations += distances_.evaluations;
    result.error = worst_error_;
    result.margin = separation / growth_most_;
  }

  DampedResult result;

 private:
  bool interrupted() const { return options_.interrupt != nullptr && options_.interrupt->load(); }

  void evaluate(Evaluation& at) {
    problem_.evaluate(at);
    ++result.evaluations;
  }

  void begin(std::span<const double> x) {
    start_.assign(x.begin(), x.end());
    std::copy(x.begin(), x.end(), now_.x.begin());
    result.steps = result.evaluations = 0;
    result.rounding_decides = false;
    bounds_.begin();
    distances_.evaluations = 0;
    growth_ = growth_most_ = 1.0;
    error_ = worst_error_ = 0.0;
    finish_below_ = finish_within;
    for (int i = 0; i < n_; ++i) delta_[i] = 1.0 + 0.5 * std::sin(1.0 + 2.0 * i);
    const double length = std::sqrt(dot(delta_, delta_));
    for (double& d : delta_) d /= length;
    evaluate(now_);
  }

  // --- the motion -------------------------------------------------------------------------------------------------

  Arrival follow() {
    if (!bounds_.choose(now_, velocity_, y_)) return Arrival::singular;
    double h = 0.0, first = 0.0;
    for (;; ++result.steps) {
      if (interrupted()) return Arrival::interrupted;
      if (result.steps >= options_.steps) return Arrival::step_limit;
      if (!set_tangent(now_, y_)) return Arrival::singular;
      if (is_at_rest()) {
        close_at_rest();
        return judge_rest();
      }
      if (finish()) return Arrival::rest;
      if (h == 0.0) {
        h = first = 0.1 * options_.longest_step / largest(velocity_);
      }
      if (!step(h) || h < least_step * first) {
        if (interrupted()) return Arrival::interrupted;
        if (!bounds_.release_idle(now_, velocity_, y_) && !bounds_.choose_otherwise(now_, velocity_, y_))
          return Arrival::singular;
        h = 0.0;
        continue;
      }
      double far = 0.0;
      for (int i = 0; i < n_; ++i) far = std::max(far, std::abs(now_.x[i] - start_[i]));
      if (far > options_.run_away) return Arrival::runs_away;
      if (creeps_ && bounds_.choose_otherwise(now_, velocity_, y_)) {
        h = 0.0;
      } else if (creeps_) {
        return set_tangent(now_, y_) ? judge_rest() : Arrival::singular;
      }
    }
  }

  // K and D at an evaluated point with its multipliers.
  bool set_tangent(Evaluation& at, std::span<const double> y) {
    problem_.tangent(at, y, first_tangent_);
    problem_.resistance(at, first_resistance_);
    stiffest_ = largest(first_tangent_);
    return std::isfinite(stiffest_);
  }

  // The force left over is rounding.
  bool is_at_rest() {
    multiply(first_resistance_, velocity_, field_);
    return largest(field_) <= 4 * eps * (bounds_.scale() + stiffest_ * std::max(1.0, largest(now_.x)));
  }

  // A bound that was met last is met within a tolerance. Where it leaves nothing that could move, no step closes the
  // rest.
  void close_at_rest() {
    bounds_.find_gap(now_);
    if (largest(bounds_.gap) <= 4 * eps) return;
    std::fill(step_.begin(), step_.end(), 0.0);
    if (try_to_finish(std::numeric_limits<double>::infinity())) set_tangent(now_, y_);
  }

  // out = A v for values of the tangent's pattern.
  void multiply(std::span<const double> values, std::span<const double> v, std::span<double> out) const {
    const Pattern& pattern = problem_.tangent_pattern();
    std::fill(out.begin(), out.end(), 0.0);
    for (int e = 0; e < pattern.size(); ++e) {
      const int i = pattern.row[e], j = pattern.column[e];
      out[i] += values[e] * v[j];
      if (symmetric_ && i != j) out[j] += values[e] * v[i];
    }
  }

  Arrival judge_rest() {
    if (!symmetric_) return Arrival::rest;
    kkt_->set_jacobian(now_, bounds_.active);
    // Curvature that is rounding counts as none.
    values_ = first_tangent_;
    const double shift = 1e-12 * std::max(stiffest_, bounds_.scale());
    for (int i = 0; i < n_; ++i) values_[i] += shift;
    return kkt_->factor_tangent(values_) == Kkt::Factors::positive ? Arrival::rest : Arrival::unstable;
  }

  // Newton's method to the equilibrium near `now`, where it cannot lead elsewhere. Leaves `now` unchanged if it fails.
  bool finish() {
    kkt_->set_jacobian(now_, bounds_.active);
    const Kkt::Factors factors = kkt_->factor_tangent(first_tangent_);
    if (symmetric_ ? factors != Kkt::Factors::positive : factors == Kkt::Factors::singular) return false;
    kkt_->solve(now_.gradient, {}, step_);
    const double first = largest(step_);
    if (!(first <= finish_below_)) return false;
    if (!symmetric_ && !(first <= 1e-3 * finish_within)) return false;
    if (try_to_finish(first)) return true;
    finish_below_ = 0.5 * first;
    return false;
  }

  bool try_to_finish(double first) {
    if (distances_.may_be_passed(now_, step_)) return false;
    set_switches(now_, switch_now_);
    y_trial_ = y_;
    trial_.x = now_.x;
    double last = first;
    for (int k = 0; k < finish_steps; ++k) {
      for (int i = 0; i < n_; ++i) trial_.x[i] += step_[i];
      evaluate(trial_);
      kkt_->set_jacobian(trial_, bounds_.active);
      kkt_->multipliers(trial_.gradient, y_trial_);
      problem_.tangent(trial_, y_trial_, values_);
      kkt_->set_jacobian(trial_, bounds_.active);
      const Kkt::Factors factors = kkt_->factor_tangent(values_);
      if (symmetric_ ? factors != Kkt::Factors::positive : factors == Kkt::Factors::singular) return false;
      bounds_.find_gap(trial_);
      kkt_->unbalanced(trial_.gradient, y_trial_, field_);
      kkt_->solve(field_, bounds_.gap, step_);
      const double length = largest(step_);
      if (!std::isfinite(length)) return false;
      if (length <= 4 * eps || (length <= 1e-9 && length > contraction * last)) break;
      if (length > (k == 0 ? contraction : 0.5) * last) return false;
      last = length;
    }
    if (!stays_within_bounds(trial_)) return false;
    // The step left over is rounding.
    for (int i = 0; i < n_; ++i) now_.x[i] = trial_.x[i];
    std::swap(y_, y_trial_);
    evaluate(now_);
    return true;
  }

  // The same bounds press, no other is violated, and every switch is on its side.
  bool stays_within_bounds(Evaluation& at) {
    for (int r = equalities_; r < rows_; ++r) {
      if (bounds_.active[r] != 0 ? bounds_.pull(r, y_trial_) > bounds_.noise() : bounds_.distance(at, r) < -1e-12)
        return false;
    }
    set_switches(at, switch_next_);
    for (std::size_t k = 0; k < switch_now_.size(); ++k) {
      if (switch_now_[k] * switch_next_[k] < 0 && std::abs(switch_next_[k]) > 1e-9) return false;
    }
    return true;
  }

  // One step of about h, shorter where its error or an event demands it; h becomes a proposal for the next.
  bool step(double& h) {
    double too_long = std::numeric_limits<double>::infinity();
    set_switches(now_, switch_now_);
    for (int k = 0; k < event_steps; ++k) {
      if (interrupted()) return false;
      double proposal = 0.0;
      if (!extrapolate(h, proposal)) {
        h = proposal;
        if (!(h > 0.0)) return false;
        continue;
      }
      const double part = until_event(h);
      if (part < 1.0) {
        // Beyond an event: shorten.
        too_long = h;
        h *= part;
        continue;
      }
      accept();
      if (met_event_) {
        if (!bounds_.choose(now_, velocity_, y_)) return false;
        finish_below_ = finish_within;
      }
      h = met_event_ ? 0.5 * h : std::min(proposal, too_long < 1e300 ? std::max(h, too_long) : proposal);
      return true;
    }
    return false;
  }

  void accept() {
    std::swap(now_, next_);
    std::swap(velocity_, velocity_next_);
    std::swap(y_, y_next_);
    if (options_.passed) options_.passed(now_.x);
    double grown = std::sqrt(dot(delta_column_, delta_column_));
    if (std::isfinite(grown) && grown > 0.0) {
      for (int i = 0; i < n_; ++i) delta_[i] = delta_column_[i] / grown;
    } else {
      grown = 1.0;
    }
    growth_ = std::max(1.0, growth_ * grown);
    growth_most_ = std::max(growth_most_, growth_);
    error_ = error_ * grown + error_of_step_;
    worst_error_ = std::max(worst_error_, error_);
    creeps_ = moved_ <= 1e-13;
  }

  // The extrapolated step of length h from `now` to `next`, with velocity and multipliers there. If it fails `proposal`
  // is a shorter h; else one for the next step.
  bool extrapolate(double h, double& proposal) {
    proposal = 0.25 * h;
    double last = std::numeric_limits<double>::infinity();
    for (int j = 1; j <= std::min(most_columns, columns_ + 2); ++j) {
      if (!sub_steps(h, j)) return false;
      // Aitken-Neville: table_[k] becomes T(j, k).
      previous_ = trial_.x;
      double error = 0.0;
      for (int k = 1; k <= j; ++k) {
        double change = 0.0;
        std::swap(table_[k], previous_);  // table_[k] = T(j, k), previous_ = T(j - 1, k)
        if (k == j) break;
        const double ratio = static_cast<double>(j) / (j - k) - 1.0;
        scratch_.resize(n_);
        for (int i = 0; i < n_; ++i) {
          const double by = (table_[k][i] - previous_[i]) / ratio;
          scratch_[i] = table_[k][i] + by;
          change = std::max(change, std::abs(by));
        }
        std::swap(previous_, scratch_);
        error = change;
      }
      if (j == 1) {
        moved_ = 0.0;
        for (int i = 0; i < n_; ++i) moved_ = std::max(moved_, std::abs(table_[1][i] - now_.x[i]));
        if (moved_ > 2.0 * options_.longest_step) {
          proposal = h * std::max(0.1, options_.longest_step / moved_);
          return false;
        }
        continue;
      }
      if (!std::isfinite(error)) return false;
      const double allowed = tolerance_;
      if (error <= allowed) {
        const double factor = 0.85 * std::pow(allowed / std::max(error, 1e-6 * allowed), 1.0 / j);
        proposal = h * std::clamp(factor * (j < columns_ ? 1.6 : j == columns_ ? 1.0 : 0.8), 0.3, 8.0);
        error_of_step_ = error;
        return close_next(j);
      }
      if (error > 4.0 * last || (j == 2 && error > 100.0 * std::pow(allowed, 0.5))) break;
      last = error;
    }
    proposal = 0.3 * h;
    return false;
  }

  bool close_next(int j) {
    next_.x = table_[j];
    evaluate(next_);
    if (!close(next_)) return false;
    return bounds_.set_velocity(next_, velocity_next_, y_next_);
  }

  // j linearly implicit Euler steps of length h / j, each of which also closes the gaps that the last has left; ends in
  // trial_, with the displacement that delta_ grows to.
  bool sub_steps(double h, int j) {
    const double inverse = j / h;
    delta_column_ = delta_;
    y_trial_ = y_;
    for (int k = 0; k < j; ++k) {
      Evaluation& at = k == 0 ? now_ : trial_;
      if (k > 0) {
        evaluate(at);
        problem_.tangent(at, y_trial_, tangent_);
        problem_.resistance(at, resistance_);
      }
      const std::vector<double>& stiffness = k == 0 ? first_tangent_ : tangent_;
      const std::vector<double>& damping = k == 0 ? first_resistance_ : resistance_;
      for (std::size_t e = 0; e < values_.size(); ++e) values_[e] = stiffness[e] + inverse * damping[e];
      if (!kkt_->set_jacobian(at, bounds_.active)) return false;
      const Kkt::Factors factors = kkt_->factor_tangent(values_);
      if (symmetric_ ? factors != Kkt::Factors::positive : factors == Kkt::Factors::singular) return false;
      bounds_.find_gap(at);
      kkt_->solve(at.gradient, bounds_.gap, step_);
      kkt_->solved_multipliers(at.gradient, y_trial_);
      if (!(largest(step_) <= 4.0 * options_.longest_step)) return false;
      multiply(damping, delta_column_, field_);
      for (double& f : field_) f *= -inverse;
      kkt_->solve(field_, {}, delta_column_);
      for (int i = 0; i < n_; ++i) trial_.x[i] = at.x[i] + step_[i];
    }
    return true;
  }

  // Steps onto the active rows in the metric of values_, the matrix of the last step.
  bool close(Evaluation& at) {
    double last = std::numeric_limits<double>::infinity();
    for (int k = 0; k < closings; ++k) {
      bounds_.find_gap(at);
      const double left = largest(bounds_.gap);
      if (left <= 4 * eps || (k > 0 && left > 0.25 * last && left <= 1e-12)) return true;
      if (!(left < last)) return false;
      last = left;
      if (!kkt_->set_jacobian(at, bounds_.active) || kkt_->factor_tangent(values_) == Kkt::Factors::singular)
        return false;
      kkt_->solve({}, bounds_.gap, step_);
      if (!(largest(step_) <= 2.0 * options_.longest_step)) return false;
      for (int i = 0; i < n_; ++i) at.x[i] += step_[i];
      evaluate(at);
    }
    return false;
  }

  // The share of the step from now to next after which the first bound or switch is met, or a bound begins to pull; 1
  // if none is, or where it has just been: then met_event_ is set.
  double until_event(double h) {
    met_event_ = false;
    double part = 1.0;
    const auto consider = [&](double before, double after, double tolerance) {
      if (after > 0.0) return;
      if (after >= -tolerance || h * largest(velocity_) < 1e-13) {
        met_event_ = true;
        return;
      }
      // Aims at the middle of what is allowed beyond.
      const double share = (before + 0.5 * tolerance) / (before - after);
      part = std::min(part, std::clamp(share, 1e-3, 0.98));
    };
    for (int r = equalities_; r < rows_; ++r) {
      if (bounds_.active[r] != 0) {
        const double slack = 1e-9 * (bounds_.scale() + 1e-300);
        const double before = -bounds_.pull(r, y_), after = -bounds_.pull(r, y_next_);
        if (after < -bounds_.noise()) consider(std::max(before, 0.0), after, std::max(slack, bounds_.noise()));
      } else {
        consider(bounds_.distance(now_, r), bounds_.distance(next_, r), options_.touching);
      }
    }
    set_switches(next_, switch_next_);
    for (std::size_t k = 0; k < switch_now_.size(); ++k) {
      const double before = std::abs(switch_now_[k]);
      const double after = switch_now_[k] < 0 ? -switch_next_[k] : switch_next_[k];
      if (before <= 1e-10) continue;  // just passed
      consider(before, after, 1e-10);
    }
    return std::min(part, distances_.until_passing({now_, velocity_}, {next_, velocity_next_}));
  }

  void set_switches(Evaluation& at, std::vector<double>& values) {
    problem_.switch_measures(at, values);
    for (std::size_t k = 0; k < values.size(); ++k) values[k] = problem_.switches()[k].past(values[k]);
  }

  const DampedProblem& problem_;
  DampedOptions options_;
  int n_, equalities_, rows_;
  bool symmetric_;
  std::unique_ptr<Kkt> kkt_;
  Evaluation now_, next_, trial_;
  PressingBounds bounds_;
  PassedDistances distances_;
  std::vector<double> start_, velocity_, velocity_next_, step_, field_, delta_, delta_column_;
  std::vector<double> y_, y_next_, y_trial_;
  std::vector<double> tangent_, resistance_, values_, first_tangent_, first_resistance_;
  std::vector<double> switch_now_, switch_next_, previous_, scratch_;
  std::vector<double> table_[most_columns + 1];
  double tolerance_ = 0.0, stiffest_ = 0.0;
  double growth_ = 1.0, growth_most_ = 1.0, error_ = 0.0, worst_error_ = 0.0, error_of_step_ = 0.0, moved_ = 0.0;
  double finish_below_ = finish_within;
  int columns_ = 3;  // of the extrapolation that steps aim at
  bool met_event_ = false, creeps_ = false;
};

DampedMotion::DampedMotion(const DampedProblem& problem, const DampedOptions& options)
    : integrator_(std::make_unique<Integrator>(problem, options)) {}
DampedMotion::~DampedMotion() = default;

const DampedResult& DampedMotion::run(std::span<const double> x, double tolerance) {
  integrator_->run(x, tolerance);
  return integrator_->result;
}

}  // namespace poise::solvers
