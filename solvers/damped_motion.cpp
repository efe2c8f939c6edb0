#include "solvers/damped_motion.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "solvers/cubic.hpp"
#include "solvers/kkt.hpp"
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
constexpr double separation = 0.1;             // distance at which motions count as having parted
constexpr int event_steps = 60;                // to locate an event
constexpr double least_velocity_cosine = 0.8;  // between velocities
constexpr int deepest = 40;                    // halvings of a step's way
constexpr double least_step = 1e-14;           // of time, relative to the first one
constexpr double tried_within = 1e-9;          // way back from which the same bounds are not tried again
constexpr std::size_t most_touched = 8;        // bounds of which all sets are tried
constexpr double goes_into = 1e-9;             // rate, relative to the velocity, that is rounding

}  // namespace

class DampedMotion::Method {
 public:
  Method(const DampedProblem& problem, const DampedOptions& given)
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
        active_(rows_, 0),
        upper_(rows_, 0),
        idle_(rows_, 0),
        switch_now_(problem.switches().size()),
        switch_next_(problem.switches().size()),
        measures_(problem.switches().size()) {
    for (const Limit& limit : problem.limits()) {
      if (limit.threshold.of_distance)
        distances_.push_back({equalities_ + limit.inequality, -1, limit.threshold, limit.sign});
    }
    for (std::size_t k = 0; k < problem.switches().size(); ++k) {
      const Threshold& threshold = problem.switches()[k];
      if (threshold.of_distance) distances_.push_back({-1, static_cast<int>(k), threshold, 1.0});
    }
    for (auto* v :
         {&velocity_, &velocity_next_, &step_, &field_, &delta_, &delta_column_, &way_, &way_now_, &way_next_})
      v->resize(n_);
    for (auto* v : {&y_, &y_next_, &y_trial_, &gap_}) v->resize(rows_);
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
    result.active = active_;
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
    std::fill(active_.begin(), active_.end(), 0);
    std::fill(active_.begin(), active_.begin() + equalities_, 1);
    std::fill(idle_.begin(), idle_.end(), 0);
    tried_.clear();
    growth_ = growth_most_ = 1.0;
    error_ = worst_error_ = 0.0;
    scale_ = 0.0;
    finish_below_ = finish_within;
    for (int i = 0; i < n_; ++i) delta_[i] = 1.0 + 0.5 * std::sin(1.0 + 2.0 * i);
    const double length = std::sqrt(dot(delta_, delta_));
    for (double& d : delta_) d /= length;
    evaluate(now_);
  }

  // --- velocity and bounds ------------------------------------------------------------------------------------------

  double bound(int row) const {
    return upper_[row] != 0 ? problem_.upper()[row - equalities_] : problem_.lower()[row - equalities_];
  }

  double gap_of(const Evaluation& at, int row) const {
    return row < equalities_ ? at.constraint[row] : at.constraint[row] - bound(row);
  }

  // Of the active rows.
  void find_gap(const Evaluation& at) {
    for (int r = 0; r < rows_; ++r) gap_[r] = active_[r] != 0 ? gap_of(at, r) : 0.0;
  }

  // v and the multipliers y with  D v + F + J^T y = 0,  J v = 0.
  bool set_velocity(Evaluation& at, std::span<double> v, std::span<double> y) {
    problem_.resistance(at, values_);
    if (!kkt_->set_jacobian(at, active_) || kkt_->factor_tangent(values_) == Kkt::Factors::singular) return false;
    kkt_->solve(at.gradient, {}, v);
    kkt_->solved_multipliers(at.gradient, y);
    scale_ = std::max({scale_, largest(at.gradient), largest(y)});
    return std::isfinite(largest(v));
  }

  double noise() const { return 16 * eps * scale_; }
  // How much a bound pulls that should press.
  double pull(int row, std::span<const double> y) const {
    const int k = row - equalities_;
    if (problem_.lower()[k] == problem_.upper()[k]) return 0.0;
    return upper_[row] != 0 ? -y[row] : y[row];
  }

  // Distance of an inactive inequality from its nearer bound; which one it is, if `upper` is given.
  double distance(const Evaluation& at, int row, char* upper = nullptr) const {
    const int k = row - equalities_;
    const double below = problem_.upper()[k] - at.constraint[row];
    const double above = at.constraint[row] - problem_.lower()[k];
    if (upper != nullptr) *upper = below < above ? 1 : 0;
    return std::min(below, above);
  }

  double rate(const Evaluation& at, int row, std::span<const double> v) const {
    const Pattern& pattern = problem_.jacobian_pattern();
    double sum = 0.0;
    for (int e = 0; e < pattern.size(); ++e) {
      if (pattern.row[e] == row) sum += at.jacobian[e] * v[pattern.column[e]];
    }
    return sum;
  }

  // The bounds at `now` that press, with the velocity that they allow: first all that are touched, then those are left
  // out that pull, one by one, and those are taken in again into which the motion would go.
  bool choose_bounds() {
    for (int r = equalities_; r < rows_; ++r) {
      if (active_[r] == 0 && idle_[r] == 0 && distance(now_, r, &upper_[r]) <= options_.touching) active_[r] = 1;
    }
    for (int k = 0; k < 4 * rows_ + 4; ++k) {
      if (!set_velocity(now_, velocity_, y_)) return false;
      int worst = -1;
      double most = noise();
      for (int r = equalities_; r < rows_; ++r) {
        if (active_[r] == 0 || pull(r, y_) <= most) continue;
        worst = r;
        most = pull(r, y_);
      }
      if (worst >= 0) {
        active_[worst] = 0;
        continue;
      }
      for (int r = equalities_; r < rows_ && worst < 0; ++r) {
        char upper = 0;
        if (active_[r] != 0 || distance(now_, r, &upper) > options_.touching) continue;
        const double into = rate(now_, r, velocity_) * (upper != 0 ? 1.0 : -1.0);
        if (into <= 1e-12 * (1.0 + largest(velocity_))) continue;
        worst = r;
        upper_[r] = upper;
      }
      if (worst < 0) return true;
      active_[worst] = 1;
      idle_[worst] = 0;
    }
    return true;
  }

  // Bounds that repeat others at `now` and press on nothing: they may part from these on the way, so that all together
  // would hold what only touches them. False where there are none.
  bool release_idle() {
    if (!set_velocity(now_, velocity_, y_) || !kkt_->redundant()) return false;
    bool any = false;
    for (int r = equalities_; r < rows_; ++r) {
      if (active_[r] == 0 || y_[r] != 0.0 || problem_.lower()[r - equalities_] == problem_.upper()[r - equalities_]) {
        continue;
      }
      active_[r] = 0;
      idle_[r] = 1;
      any = true;
    }
    return any && choose_bounds();
  }

  // Bounds that repeat each other at `now` part on the way, so that the choice by first derivatives may be one that
  // leads nowhere: another set of those that are touched, in which all press and none is gone into. False where each
  // such set was tried here.
  bool choose_otherwise() {
    double moved = 0.0;
    for (int i = 0; i < n_ && !tried_.empty(); ++i) moved = std::max(moved, std::abs(now_.x[i] - tried_at_[i]));
    if (moved > tried_within) tried_.clear();
    tried_at_ = now_.x;
    std::vector<int> touched;
    for (int r = equalities_; r < rows_; ++r) {
      const int k = r - equalities_;
      if (problem_.lower()[k] == problem_.upper()[k]) continue;
      if (active_[r] != 0 || distance(now_, r, &upper_[r]) <= options_.touching) touched.push_back(r);
    }
    if (touched.size() > most_touched) return false;
    const std::vector<char> active = active_, idle = idle_;
    for (unsigned set = 1U << touched.size(); set-- > 0;) {
      for (std::size_t k = 0; k < touched.size(); ++k) {
        active_[touched[k]] = (set >> k & 1U) != 0 ? 1 : 0;
        idle_[touched[k]] = 1 - active_[touched[k]];
      }
      if (std::find(tried_.begin(), tried_.end(), active_) != tried_.end()) continue;
      tried_.push_back(active_);
      if (!set_velocity(now_, velocity_, y_) || kkt_->redundant()) continue;
      const bool holds = std::all_of(touched.begin(), touched.end(), [&](int r) {
        return active_[r] != 0
                   ? pull(r, y_) <= noise()
                   : rate(now_, r, velocity_) * (upper_[r] != 0 ? 1.0 : -1.0) <= goes_into * (1.0 + largest(velocity_));
      });
      if (holds) return true;
    }
    active_ = active;
    idle_ = idle;
    return false;
  }

  // --- the motion
  // -----------------------------------------------------------------------------------------------------

  Arrival follow() {
    if (!choose_bounds()) return Arrival::singular;
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
        if (!release_idle() && !choose_otherwise()) return Arrival::singular;
        h = 0.0;
        continue;
      }
      double far = 0.0;
      for (int i = 0; i < n_; ++i) far = std::max(far, std::abs(now_.x[i] - start_[i]));
      if (far > options_.run_away) return Arrival::runs_away;
      if (creeps_ && choose_otherwise()) {
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
    return largest(field_) <= 4 * eps * (scale_ + stiffest_ * std::max(1.0, largest(now_.x)));
  }

  // A bound that was met last is met within a tolerance. Where it leaves nothing that could move, no step closes the
  // rest.
  void close_at_rest() {
    find_gap(now_);
    if (largest(gap_) <= 4 * eps) return;
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
    kkt_->set_jacobian(now_, active_);
    // Curvature that is rounding counts as none.
    values_ = first_tangent_;
    const double shift = 1e-12 * std::max(stiffest_, scale_);
    for (int i = 0; i < n_; ++i) values_[i] += shift;
    return kkt_->factor_tangent(values_) == Kkt::Factors::positive ? Arrival::rest : Arrival::unstable;
  }

  // Newton's method to the equilibrium near `now`, where it cannot lead elsewhere. Leaves `now` unchanged if it fails.
  bool finish() {
    kkt_->set_jacobian(now_, active_);
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
    if (may_pass_distances(first_norm(step_))) return false;
    set_switches(now_, switch_now_);
    y_trial_ = y_;
    trial_.x = now_.x;
    double last = first;
    for (int k = 0; k < finish_steps; ++k) {
      for (int i = 0; i < n_; ++i) trial_.x[i] += step_[i];
      evaluate(trial_);
      kkt_->set_jacobian(trial_, active_);
      kkt_->multipliers(trial_.gradient, y_trial_);
      problem_.tangent(trial_, y_trial_, values_);
      kkt_->set_jacobian(trial_, active_);
      const Kkt::Factors factors = kkt_->factor_tangent(values_);
      if (symmetric_ ? factors != Kkt::Factors::positive : factors == Kkt::Factors::singular) return false;
      find_gap(trial_);
      kkt_->unbalanced(trial_.gradient, y_trial_, field_);
      kkt_->solve(field_, gap_, step_);
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
      if (active_[r] != 0 ? pull(r, y_trial_) > noise() : distance(at, r) < -1e-12) return false;
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
        if (!choose_bounds()) return false;
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
    return set_velocity(next_, velocity_next_, y_next_);
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
      if (!kkt_->set_jacobian(at, active_)) return false;
      const Kkt::Factors factors = kkt_->factor_tangent(values_);
      if (symmetric_ ? factors != Kkt::Factors::positive : factors == Kkt::Factors::singular) return false;
      find_gap(at);
      kkt_->solve(at.gradient, gap_, step_);
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
      find_gap(at);
      const double left = largest(gap_);
      if (left <= 4 * eps || (k > 0 && left > 0.25 * last && left <= 1e-12)) return true;
      if (!(left < last)) return false;
      last = left;
      if (!kkt_->set_jacobian(at, active_) || kkt_->factor_tangent(values_) == Kkt::Factors::singular) return false;
      kkt_->solve({}, gap_, step_);
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
      if (active_[r] != 0) {
        const double slack = 1e-9 * (scale_ + 1e-300);
        const double before = -pull(r, y_), after = -pull(r, y_next_);
        if (after < -noise()) consider(std::max(before, 0.0), after, std::max(slack, noise()));
      } else {
        consider(distance(now_, r), distance(next_, r), options_.touching);
      }
    }
    set_switches(next_, switch_next_);
    for (std::size_t k = 0; k < switch_now_.size(); ++k) {
      const double before = std::abs(switch_now_[k]);
      const double after = switch_now_[k] < 0 ? -switch_next_[k] : switch_next_[k];
      if (before <= 1e-10) continue;  // just passed
      consider(before, after, 1e-10);
    }
    return std::min(part, until_passing());
  }

  void set_switches(Evaluation& at, std::vector<double>& values) {
    problem_.switch_measures(at, values);
    for (std::size_t k = 0; k < values.size(); ++k) values[k] = problem_.switches()[k].past(values[k]);
  }

  // --- distances ----------------------------------------------------------------------------------------------------
  //
  // Between the ends of a step a distance may dip below a threshold and rise again, however narrowly. This is looked
  // for on a curve between the ends: the Hermite cubic with the directions of the velocities, whatever their sizes,
  // which differ widely where fast motions die away.

  // A limit (row) or switch that concerns a distance.
  struct Watched {
    int row, which;
    Threshold threshold;
    double sign;  // of a limit
  };
  struct Sample {
    double tau, value, slope;
  };

  double measure(Evaluation& at, const Watched& w) {
    if (w.row >= 0) return at.constraint[w.row];
    problem_.switch_measures(at, measures_);
    return measures_[w.which];
  }

  double slope_along(Evaluation& at, const Watched& w, std::span<const double> direction) {
    if (w.row >= 0) return rate(at, w.row, direction);
    problem_.switch_gradient(at, w.which, field_);
    return dot(field_, direction);
  }

  Sample sample(Evaluation& at, const Watched& w, double tau, std::span<const double> direction) {
    const double g = measure(at, w);
    return {tau, w.threshold.past(g), w.threshold.slope(g) * slope_along(at, w, direction)};
  }

  // On the curve; trial_ becomes its pose.
  Sample sample(const Watched& w, double side, double tau) {
    for (int i = 0; i < n_; ++i) {
      const Cubic x(now_.x[i], way_now_[i], next_.x[i], way_next_[i], 1.0);
      trial_.x[i] = x.at(tau);
      way_[i] = x.slope(tau);
    }
    evaluate(trial_);
    const Sample found = sample(trial_, w, tau, way_);
    return {tau, side * found.value, side * found.slope};
  }

  // Whether some distance comes so near a threshold that a motion of this length might pass it. No coordinate moves a
  // point by much more than itself, and back again by twice that.
  bool may_pass(const Watched& w, double length, Evaluation& end) {
    if (w.row >= 0 && active_[w.row] != 0) return false;
    return std::abs(measure(now_, w) - w.threshold.at) + std::abs(measure(end, w) - w.threshold.at) <= 2.0 * length;
  }
  bool may_pass_distances(double length) {
    return std::any_of(distances_.begin(), distances_.end(),
                       [&](const Watched& w) { return may_pass(w, length, now_); });
  }

  static double first_norm(std::span<const double> v) {
    double sum = 0.0;
    for (const double value : v) sum += std::abs(value);
    return sum;
  }

  // A velocity's direction as the slope of a curve of that length; of no velocity, that of the chord.
  void set_way(std::span<const double> velocity, double length, std::span<double> way) {
    const double speed = std::sqrt(dot(velocity, velocity));
    for (int i = 0; i < n_; ++i) {
      way[i] = speed > 0.0 ? length / speed * velocity[i] : next_.x[i] - now_.x[i];
    }
  }

  // The share of the step after which the first watched distance has passed its threshold; 1 if none does.
  double until_passing() {
    if (distances_.empty()) return 1.0;
    for (int i = 0; i < n_; ++i) way_[i] = next_.x[i] - now_.x[i];
    const double length = std::sqrt(dot(way_, way_)), sum = first_norm(way_);
    double first = 1.0;
    bool has_way = false;
    for (const Watched& w : distances_) {
      if (sum <= 1e-8 || !may_pass(w, sum, next_)) continue;
      if (!has_way) {
        has_way = true;
        set_way(velocity_, length, way_now_);
        set_way(velocity_next_, length, way_next_);
        // The curve tells nothing of a way that turns far.
        if (sum > 1e-3 && dot(way_now_, way_next_) < least_velocity_cosine * length * length) return 0.5;
      }
      Sample a = sample(now_, w, 0.0, way_now_), b = sample(next_, w, 1.0, way_next_);
      const bool starts_there = std::abs(a.value) <= 1e-10;
      const double side = w.row >= 0 ? w.sign : std::copysign(1.0, starts_there ? a.slope : a.value);
      for (Sample* s : {&a, &b}) {
        s->value *= side;
        s->slope *= side;
      }
      // Where it begins at the threshold, until_event() does not see it pass.
      if (starts_there && b.value < -options_.touching) return 0.5;
      first = std::min(first, first_passing(w, side, a, b, deepest));
    }
    if (first == 1.0) return 1.0;
    // The share of the way as a share of time, by the speeds at both ends.
    const double speed = largest(velocity_), speed_next = largest(velocity_next_);
    const double begins = 2.0 * speed / (speed + speed_next);
    const double share = 2.0 * first / (begins + std::sqrt(begins * begins + 4.0 * (1.0 - begins) * first));
    return std::clamp(share, 1e-3, 0.98);
  }

  // Where between a and b on the curve a distance is known to be past its threshold; 1 if it does not pass.
  double first_passing(const Watched& w, double side, const Sample& a, const Sample& b, int depth) {
    const double h = b.tau - a.tau;
    const Cubic whole(a.value, a.slope, b.value, b.slope, h);
    const Sample mid = sample(w, side, 0.5 * (a.tau + b.tau));
    if (mid.value < -options_.touching) return mid.tau;
    // Each half has 1/16 of the error in the middle.
    const double error =
        0.25 * std::max(std::abs(whole.at(0.5) - mid.value), 0.1 * std::abs(whole.slope(0.5) - h * mid.slope));
    double first = 1.0;
    for (const auto& [from, to] : {std::pair(a, mid), std::pair(mid, b)}) {
      const double least = Cubic(from.value, from.slope, to.value, to.slope, 0.5 * h).least();
      if (least >= error - options_.touching || depth == 0) continue;
      first = std::min(first, first_passing(w, side, from, to, depth - 1));
      if (first < 1.0) break;
    }
    return first;
  }

  const DampedProblem& problem_;
  DampedOptions options_;
  int n_, equalities_, rows_;
  bool symmetric_;
  std::unique_ptr<Kkt> kkt_;
  Evaluation now_, next_, trial_;
  std::vector<char> active_, upper_;
  std::vector<std::vector<char>> tried_;  // active rows of choose_otherwise(), at
  std::vector<double> tried_at_;
  std::vector<char> idle_;  // bounds that are touched and left out, because others of the same direction hold
  std::vector<double> start_, velocity_, velocity_next_, step_, field_, delta_, delta_column_;
  std::vector<double> y_, y_next_, y_trial_, gap_;
  std::vector<double> tangent_, resistance_, values_, first_tangent_, first_resistance_;
  std::vector<double> switch_now_, switch_next_, measures_, previous_, scratch_;
  std::vector<Watched> distances_;
  std::vector<double> way_, way_now_, way_next_;
  std::vector<double> table_[most_columns + 1];
  double tolerance_ = 0.0, scale_ = 0.0, stiffest_ = 0.0;
  double growth_ = 1.0, growth_most_ = 1.0, error_ = 0.0, worst_error_ = 0.0, error_of_step_ = 0.0, moved_ = 0.0;
  double finish_below_ = finish_within;
  int columns_ = 3;  // of the extrapolation that steps aim at
  bool met_event_ = false, creeps_ = false;
};

DampedMotion::DampedMotion(const DampedProblem& problem, const DampedOptions& options)
    : method_(std::make_unique<Method>(problem, options)) {}
DampedMotion::~DampedMotion() = default;

const DampedResult& DampedMotion::run(std::span<const double> x, double tolerance) {
  method_->run(x, tolerance);
  return method_->result;
}

}  // namespace poise::solvers
