#include "solvers/newton.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "solvers/kkt.hpp"

namespace poise::solvers {
namespace {

constexpr double armijo = 1e-4;         // share of the predicted fall that a step must achieve
constexpr double filter_margin = 0.01;  // by which a point must be better than those left behind
constexpr double closed_within = 1e-8;  // gaps below it count as none for the filter
constexpr int stationary_halvings = 12;
constexpr int halvings = 30;    // of one step
constexpr int pull_backs = 20;  // chord steps back to the constraints after one trial step
constexpr int kicks = 20;       // away from points where branches of motion cross
constexpr int tries_per_kick = 30;
constexpr int neighbours = 8;         // coordinates, at most, that are displaced by themselves
constexpr int restarts = 30;          // perturbed starts for closing loops
constexpr int fresh_starts = 30;      // displaced starts of a whole run
constexpr int fresh_up_to = 300;      // coordinates; beyond, a displaced start is as bad as any
constexpr int releases = 4;           // of one inequality, against cycling
constexpr double run_away = 100.0;    // distance from the start, rad or mechanism sizes, that counts as unbounded
constexpr int stationary_steps = 80;  // before descent is tried instead
constexpr double touching = 1e-9;     // an inequality this far violated counts as met
constexpr double loose_gap = 0.05;    // gap over step length above which loops are closed before descending
constexpr double heavy = 1e3;         // multipliers of so many times the loads make a lock possible
constexpr double settled = 0.3;       // part by which rounding may change such multipliers where there is none
constexpr double rounded_gap = 2e-16;
constexpr double next_to_fold = 1e-5;   // step that rounded residuals may still leave
constexpr double first_release = 0.25;  // share of the holding load that load stepping lets go at once
constexpr double least_release = 1e-3;

// Not a number where any entry is none: no comparison that follows may pass over it.
double largest(const std::vector<double>& v) {
  double worst = 0.0;
  for (double e : v) {
    if (std::isnan(e)) return e;
    worst = std::max(worst, std::abs(e));
  }
  return worst;
}

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

}  // namespace

std::string describe(Outcome outcome) {
  switch (outcome) {
    case Outcome::not_solved:
      return "nothing has been tried";
    case Outcome::converged:
      return "converged";
    case Outcome::not_closed:
      return "the loops could not be closed from this start";
    case Outcome::stalled:
      return "no step led any further";
    case Outcome::locked:
      return "the joints lock: no finite forces in them hold the loads here";
    case Outcome::unbounded:
      return "the energy falls without end: the mechanism runs away";
    case Outcome::iteration_limit:
      return "the iteration limit was reached";
    case Outcome::interrupted:
      return "interrupted";
  }
  return "unknown";
}

class Newton::Run {
 public:
  Run(const Problem& problem, NewtonOptions given)
      : options(given),
        problem_(problem),
        n_(problem.variables()),
        m_(problem.constraints()),
        equalities_(problem.equalities()) {
    const bool dense =
        !problem.has_objective() || (n_ <= options.dense_limit && n_ * (n_ - equalities_) <= options.dense_work);
    kkt_ = dense ? make_null_space(problem, options.safeguards.rank_revealing) : make_sparse_kkt(problem);
    restarts_ = dense ? restarts : 3;
    fresh_starts_ = n_ <= fresh_up_to ? fresh_starts : 0;
    now_ = problem.make_evaluation();
    trial_ = problem.make_evaluation();
    tangent_.resize(problem.tangent_pattern().size());
    for (auto* v : {&step_, &residual_, &start_, &pull_, &kicked_from_, &displaced_, &hold_}) v->resize(n_);
    for (auto* v : {&y_, &y_next_, &y_before_, &gap_, &trial_gap_}) v->resize(m_);
    side_.resize(m_);
    releases_.resize(m_);
    filter_.reserve(stationary_steps);
    result.x.resize(n_);
    result.multipliers.resize(m_);
    result.active.resize(m_);
  }

  void solve(const double* x) {
    reset(x);
    if (options.goal == Goal::stationary || !problem_.has_objective()) {
      gap(now_, gap_);
      const bool open = largest(gap_) > touching;
      note(seek_stationary());
      if (gave_up() && open) {
        // From an open start redundant constraints cannot be told from independent ones.
        restart_from(start_);
        if (close_loops()) note(seek_stationary());
      }
      if (gave_up() && problem_.has_objective()) {
        restart_from(start_);
        result.descended = true;
        note(seek_minimum());
      }
    } else {
      note(seek_minimum());
    }
    if (gave_up() && options.safeguards.restarts) begin_elsewhere();
    if (gave_up() && options.safeguards.load_stepping) step_loads();
    finish();
  }

  // From the start displaced at random and closed, ever farther.
  void begin_elsewhere() {
    const bool down = result.descended || (options.goal == Goal::minimum && problem_.has_objective());
    for (int k = 0; k < fresh_starts_ && gave_up(); ++k) {
      displace_start(M_PI * (k + 1) / fresh_starts_);
      note(down ? seek_minimum() : close_loops() ? seek_stationary() : Outcome::not_closed);
      if (result.outcome == Outcome::not_closed) result.outcome = Outcome::stalled;
      result.restarted = result.outcome == Outcome::converged;
    }
  }

  void displace_start(double reach) {
    std::uniform_real_distribution<double> uniform(-reach, reach);
    displaced_ = start_;
    for (double& x : displaced_) x += uniform(random_);
    restart_from(displaced_);
  }

  void close(const double* x) {
    reset(x);
    result.outcome = close_loops() ? Outcome::converged : Outcome::not_closed;
    finish();
  }

  NewtonOptions options;
  NewtonResult result;

 private:
  void reset(const double* x) {
    random_.seed(20220531);
    std::copy(x, x + n_, start_.begin());
    result.outcome = Outcome::not_solved;
    result.iterations = result.evaluations = result.factorizations = 0;
    result.constraint_error = result.force_error = result.last_step = 0.0;
    result.descended = result.restarted = result.load_stepped = result.met_lock = false;
    held_ = 0.0;
    restart_from(start_);
  }

  void note(Outcome outcome) {
    result.outcome = outcome;
    result.met_lock = result.met_lock || outcome == Outcome::locked;
  }

  void restart_from(const std::vector<double>& x) {
    now_.x = x;
    std::fill(side_.begin(), side_.end(), 0);
    std::fill(releases_.begin(), releases_.end(), 0);
    for (int r = 0; r < m_; ++r) result.active[r] = r < equalities_;
    std::fill(y_.begin(), y_.end(), 0.0);
    fresh_multipliers_ = false;
    shift_ = 0.0;
    evaluate(now_);
    activate_touched();
  }

  bool gave_up() const {
    return result.outcome == Outcome::stalled || result.outcome == Outcome::locked ||
           result.outcome == Outcome::iteration_limit;
  }

  void finish() {
    result.x = now_.x;
    result.multipliers = y_;
    gap(now_, gap_);
    result.constraint_error = largest(gap_);
    lagrangian_gradient(now_, y_);
    result.force_error = largest(residual_);
  }

  void evaluate(Evaluation& at) {
    problem_.evaluate(at);
    ++result.evaluations;
    if (held_ == 0.0) return;
    for (int i = 0; i < n_; ++i) at.gradient[i] -= held_ * hold_[i];
    at.objective -= held_ * dot(hold_, at.x);
  }

  // --- inequalities -------------------------------------------------------------------------------------------------

  double bound(int row) const {
    return side_[row] > 0 ? problem_.upper()[row - equalities_] : problem_.lower()[row - equalities_];
  }

  // How far a row is outside its bounds: positive above, negative below, zero inside.
  double violation(const Evaluation& at, int row) const {
    const double g = at.constraint[row];
    return std::max(0.0, g - problem_.upper()[row - equalities_]) +
           std::min(0.0, g - problem_.lower()[row - equalities_]);
  }

  bool activate_violated(const Evaluation& at) {
    bool any = false;
    for (int r = equalities_; r < m_; ++r) {
      if (result.active[r]) continue;
      const double v = violation(at, r);
      if (std::abs(v) <= 1e-14) continue;
      activate(r, v > 0 ? 1 : -1);
      any = true;
    }
    return any;
  }

  // A start that closing has put on a bound rests on it until its multiplier pulls.
  void activate_touched() {
    for (int r = equalities_; r < m_; ++r) {
      const double g = now_.constraint[r];
      if (g >= problem_.upper()[r - equalities_] - touching)
        activate(r, 1);
      else if (g <= problem_.lower()[r - equalities_] + touching)
        activate(r, -1);
    }
  }

  void activate(int row, int side) {
    result.active[row] = 1;
    side_[row] = static_cast<signed char>(side);
    fresh_multipliers_ = false;
  }

  enum class Pulling { none, released, cycling };

  // Lets go of the inequality that pulls hardest, if any pulls by more than `least`: at an upper bound an honest
  // multiplier is positive, at a lower one negative. One that was let go again and again is not a place to rest.
  Pulling release_pulling(const std::vector<double>& y, double least) {
    int worst = -1;
    double strongest = std::max(least, 1e-13 * (1.0 + largest(now_.gradient)));
    for (int r = equalities_; r < m_; ++r) {
      if (!result.active[r]) continue;
      if (problem_.lower()[r - equalities_] == problem_.upper()[r - equalities_]) continue;
      const double pull = -side_[r] * y[r];
      if (pull > strongest) {
        strongest = pull;
        worst = r;
      }
    }
    if (worst < 0) return Pulling::none;
    if (releases_[worst] >= releases) return Pulling::cycling;
    result.active[worst] = 0;
    side_[worst] = 0;
    y_[worst] = 0.0;
    ++releases_[worst];
    fresh_multipliers_ = false;
    return Pulling::released;
  }

  // --- residuals ----------------------------------------------------------------------------------------------------

  void gap(const Evaluation& at, std::vector<double>& out) const {
    for (int r = 0; r < m_; ++r) {
      if (r < equalities_)
        out[r] = at.constraint[r];
      else
        out[r] = result.active[r] ? at.constraint[r] - bound(r) : 0.0;
    }
  }

  // residual_ = F + J^T y
  void lagrangian_gradient(const Evaluation& at, const std::vector<double>& y) {
    residual_ = at.gradient;
    const Pattern& pattern = problem_.jacobian_pattern();
    for (std::size_t e = 0; e < pattern.size(); ++e) residual_[pattern.column[e]] += at.jacobian[e] * y[pattern.row[e]];
  }

  double lagrangian(const Evaluation& at, const std::vector<double>& gaps, const std::vector<double>& y) const {
    return at.objective + dot(gaps, y);
  }

  // Jacobian, multipliers, gap_, residual_ and their norms at now_.
  void linearize() {
    gap(now_, gap_);
    kkt_->set_jacobian(now_, result.active);
    if (fresh_multipliers_) {
      kkt_->multipliers(now_.gradient.data(), y_.data());
    } else {
      kkt_->least_squares_multipliers(now_.gradient.data(), y_.data());
      fresh_multipliers_ = true;
    }
    lagrangian_gradient(now_, y_);
    gap_norm_ = std::max(std::sqrt(dot(gap_, gap_)), closed_within);
    force_norm_ = std::sqrt(dot(residual_, residual_));
  }

  Kkt::Factors factor(double shift) {
    ++result.factorizations;
    return kkt_->factor(shift);
  }

  // step_ and y_next_ of the factored system at now_.
  void solve_for_step() {
    kkt_->solve(residual_.data(), gap_.data(), step_.data(), y_next_.data());
    for (int r = 0; r < m_; ++r) y_next_[r] += y_[r];
  }

  bool at_rest() const {
    return largest(gap_) <= options.rounding && largest(residual_) <= options.rounding * (1.0 + largest(now_.gradient));
  }

  bool interrupted() const { return options.interrupt != nullptr && options.interrupt->load(); }

  void carry_multipliers(double alpha) {
    for (int r = 0; r < m_; ++r) y_[r] += alpha * (y_next_[r] - y_[r]);
  }

  void apply_last_step() {
    for (int i = 0; i < n_; ++i) now_.x[i] += step_[i];
    evaluate(now_);
    carry_multipliers(1.0);
  }

  // --- closing loops ------------------------------------------------------------------------------------------------

  bool close_loops() {
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    double best = std::numeric_limits<double>::infinity();
    for (int attempt = 0;; ++attempt) {
      // At first stops that were met are held, so that a start just beyond one comes to rest on it; where too many of
      // them hold to leave a way, they only count while violated.
      const double left = close_once(attempt == 0);
      if (left <= touching) return true;
      if (left < best) {
        best = left;
        pull_ = now_.x;
      }
      if (attempt == restarts_ || interrupted()) break;
      const double reach = 0.1 + 3.0 * attempt / restarts_;
      now_.x = start_;
      for (double& x : now_.x) x += reach * uniform(random_);
      evaluate(now_);
    }
    now_.x = pull_;
    evaluate(now_);
    return false;
  }

  // Shortest steps to c = 0, halved until |c| falls. Inequalities join where they are violated, and stay or not
  // (`hold`). Returns the largest |c| left.
  double close_once(bool hold = true) {
    double left = 0.0;
    for (int k = 0; k < options.iterations; ++k) {
      if (!hold) std::fill(result.active.begin() + equalities_, result.active.end(), 0);
      activate_violated(now_);
      gap(now_, gap_);
      left = largest(gap_);
      if (!(left > options.rounding) || interrupted()) break;
      kkt_->set_jacobian(now_, result.active);
      kkt_->set_identity();
      factor(0.0);
      kkt_->solve(nullptr, gap_.data(), step_.data(), nullptr);
      ++result.iterations;
      const double before = dot(gap_, gap_);
      double alpha = std::min(1.0, options.longest_step / largest(step_));
      bool fell = false;
      for (int h = 0; h < halvings && !fell; ++h, alpha *= 0.5) {
        for (int i = 0; i < n_; ++i) trial_.x[i] = now_.x[i] + alpha * step_[i];
        evaluate(trial_);
        if (hold)
          gap(trial_, trial_gap_);
        else
          violations(trial_, trial_gap_);
        fell = dot(trial_gap_, trial_gap_) <= (1.0 - armijo * alpha) * before;
      }
      if (!fell) break;
      std::swap(now_, trial_);
    }
    if (!hold) activate_touched();
    return left;
  }

  void violations(const Evaluation& at, std::vector<double>& out) const {
    for (int r = 0; r < m_; ++r) out[r] = r < equalities_ ? at.constraint[r] : violation(at, r);
  }

  // --- any equilibrium nearby ---------------------------------------------------------------------------------------

  Outcome seek_stationary() {
    fresh_multipliers_ = false;
    filter_.clear();
    linearize();
    double last = std::numeric_limits<double>::infinity();
    for (int k = 0; k < stationary_steps; ++k) {
      if (interrupted()) return Outcome::interrupted;
      problem_.tangent(now_, y_.data(), tangent_.data());
      kkt_->set_tangent(tangent_.data());
      const bool neutral = factor(0.0) == Kkt::Factors::singular;
      solve_for_step();
      ++result.iterations;
      const double length = largest(step_);
      result.last_step = length;
      // Next to a fold rounding moves the step far more than the tolerance: residuals that are nothing but rounding
      // then end the run once steps no longer shrink, as they do where a neutral freedom leaves no step to measure.
      const bool no_shorter = neutral || (length <= next_to_fold && length > 0.25 * last);
      last = length;
      if (length <= options.step_tolerance || (no_shorter && at_rest())) {
        const Pulling pulling = release_pulling(y_next_, 0.0);
        if (pulling == Pulling::cycling) return Outcome::stalled;
        if (pulling == Pulling::released) {
          filter_.clear();
          linearize();
          continue;
        }
        return arrive(length <= options.step_tolerance);
      }
      if (!std::isfinite(length)) return Outcome::stalled;
      if (!shorten_until_new(options.safeguards.line_search ? std::min(1.0, options.longest_step / length) : 1.0)) {
        return at_rest() ? arrive(false) : Outcome::stalled;
      }
      if (activate_violated(now_)) {
        filter_.clear();
        linearize();
      }
    }
    return Outcome::iteration_limit;
  }

  // Ends a run whose steps or residuals met their tolerances. Where J loses rank no finite multipliers balance F;
  // beside such a pose rounded closures let them seem to. They are heavy there, and would be others had the closures
  // been rounded otherwise.
  Outcome arrive(bool with_last_step) {
    if (with_last_step) apply_last_step();
    const double most = largest(y_);
    if (!(most > heavy * (1.0 + largest(now_.gradient)))) return Outcome::converged;
    kkt_->set_jacobian(now_, result.active);
    problem_.tangent(now_, y_.data(), tangent_.data());
    kkt_->set_tangent(tangent_.data());
    factor(0.0);
    for (int r = 0; r < m_; ++r) trial_gap_[r] = result.active[r] ? (r % 2 == 0 ? rounded_gap : -rounded_gap) : 0.0;
    kkt_->solve(nullptr, trial_gap_.data(), step_.data(), y_next_.data());
    return largest(y_next_) <= settled * most ? Outcome::converged : Outcome::locked;
  }

  // A filter (Fletcher, Leyffer 2002): full Newton steps may open loops for a while, and no fixed weight of gaps
  // against forces suits a chain of ten links and one of a hundred thousand. A point is new when against every point
  // left behind it is better in gap or in force.
  void remember() {
    if (filter_.size() == filter_.capacity()) filter_.erase(filter_.begin());
    filter_.emplace_back((1.0 - filter_margin) * gap_norm_, (1.0 - filter_margin) * force_norm_);
  }

  bool is_new() const {
    return std::isfinite(gap_norm_) && std::isfinite(force_norm_) &&
           std::all_of(filter_.begin(), filter_.end(),
                       [&](const auto& left) { return gap_norm_ <= left.first || force_norm_ <= left.second; });
  }

  // Halves the step until the filter takes it; leaves now_ there, linearized. Which constraints repeat each other shows
  // only where they hold: with redundant ones every trial is pulled back first.
  bool shorten_until_new(double alpha) {
    remember();
    const bool redundant = kkt_->redundant();
    std::copy(now_.x.begin(), now_.x.end(), pull_.begin());
    std::copy(y_.begin(), y_.end(), y_before_.begin());
    for (int h = 0; h < stationary_halvings; ++h, alpha *= 0.5) {
      for (int i = 0; i < n_; ++i) trial_.x[i] = pull_[i] + alpha * step_[i];
      evaluate(trial_);
      if (redundant && !pull_back(1e-13)) continue;
      std::swap(now_, trial_);
      for (int r = 0; r < m_; ++r) y_[r] = y_before_[r] + alpha * (y_next_[r] - y_before_[r]);
      linearize();
      if (is_new() || !options.safeguards.line_search) return true;
    }
    std::copy(pull_.begin(), pull_.end(), now_.x.begin());
    std::copy(y_before_.begin(), y_before_.end(), y_.begin());
    evaluate(now_);
    linearize();
    return false;
  }

  // --- stable equilibrium -------------------------------------------------------------------------------------------

  Outcome seek_minimum() {
    if (!close_loops()) return interrupted() ? Outcome::interrupted : Outcome::not_closed;
    Outcome outcome = descend_to_rest();
    const int most = options.safeguards.restarts ? kicks : 0;
    for (int k = 0; k < most && (outcome == Outcome::stalled || outcome == Outcome::locked) && kick(); ++k) {
      note(outcome);
      outcome = descend_to_rest();
    }
    return outcome;
  }

  // Where branches of motion cross, J loses rank and no step along its null space need lead on. From there random
  // displacements, closed again by shortest steps, are tried until one has less energy: of all coordinates by turns
  // and of a few neighbours, which lets one loop out of its lock and leaves the others in peace.
  bool kick() {
    const double before = now_.objective;
    kicked_from_ = now_.x;
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    for (int k = 0; k < tries_per_kick && !interrupted(); ++k) {
      const bool all = k % 2 == 0;
      const double reach = all ? std::pow(10.0, -3.0 + 2.5 * k / tries_per_kick) : M_PI * k / tries_per_kick;
      const int width = all ? n_ : 1 + static_cast<int>(random_() % neighbours);
      const int first = all ? 0 : static_cast<int>(random_() % n_);
      for (int i = 0; i < n_; ++i) now_.x[i] = kicked_from_[i];
      for (int i = first; i < std::min(n_, first + width); ++i) now_.x[i] += reach * uniform(random_);
      evaluate(now_);
      if (close_once() <= touching && now_.objective < before - 1e-13 * (1.0 + std::abs(before))) return true;
    }
    now_.x = kicked_from_;
    evaluate(now_);
    return false;
  }

  Outcome descend_to_rest() {
    fresh_multipliers_ = false;
    double last = std::numeric_limits<double>::infinity();
    for (int k = 0; k < options.iterations; ++k) {
      if (interrupted()) return Outcome::interrupted;
      linearize();
      problem_.tangent(now_, y_.data(), tangent_.data());
      kkt_->set_tangent(tangent_.data());
      const Kkt::Factors factors = factor(0.0);
      ++result.iterations;
      if (factors == Kkt::Factors::singular && at_rest()) {
        const Pulling pulling = release_pulling(y_, 0.0);
        if (pulling == Pulling::released) continue;
        return pulling == Pulling::none ? arrive(false) : Outcome::stalled;
      }
      const bool bowl = factors == Kkt::Factors::positive;
      const bool corrects = options.safeguards.inertia_correction;
      if (!bowl && corrects) shift_to_bowl();
      solve_for_step();
      const double length = largest(step_);
      result.last_step = length;
      if (!std::isfinite(length)) return Outcome::stalled;
      if (largest(gap_) > 1e-10 && largest(gap_) > loose_gap * length) {
        // A step that mostly closes loops says nothing of descent: close them first.
        trial_ = now_;
        if (pull_back(1e-13))
          std::swap(now_, trial_);
        else if (close_once() > touching)
          return Outcome::stalled;
        continue;
      }
      const Pulling pulling = release_pulling(y_next_, length <= 1e-3 ? 0.0 : 10.0 * largest(residual_));
      if (pulling == Pulling::released) continue;
      if (pulling == Pulling::cycling && length <= 1e-3) return Outcome::stalled;
      const bool rounded = at_rest() && length <= next_to_fold && length > 0.25 * last;
      last = length;
      if (bowl && (length <= options.step_tolerance || rounded)) {
        return arrive(true);
      }
      const bool saddle = !bowl && corrects && length < 0.01;
      if (saddle && leave_saddle()) continue;
      if (!descend(options.safeguards.line_search ? std::min(1.0, options.longest_step / length) : 1.0)) {
        return bowl && at_rest() ? arrive(false) : Outcome::stalled;
      }
      if (std::any_of(now_.x.begin(), now_.x.end(), [](double x) { return !std::isfinite(x); })) {
        return Outcome::stalled;
      }
      for (int i = 0; i < n_; ++i) {
        if (std::abs(now_.x[i] - start_[i]) > run_away) return Outcome::unbounded;
      }
    }
    return Outcome::iteration_limit;
  }

  // Smallest tried shift that makes the tangent positive definite on the null space of J.
  void shift_to_bowl() {
    double scale = 0.0;
    for (int i = 0; i < n_; ++i) scale = std::max(scale, std::abs(tangent_[i]));
    double shift = std::max({shift_ / 16.0, 1e-8 * scale, 1e-12});
    while (factor(shift) != Kkt::Factors::positive && shift < 1e12 * (1.0 + scale)) shift *= 4.0;
    shift_ = shift;
  }

  // Inverse iteration with the barely positive definite factors turns any vector towards the most negative curvature.
  bool leave_saddle() {
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    for (double& p : pull_) p = uniform(random_);
    for (int k = 0; k < 4; ++k) {
      kkt_->solve(pull_.data(), nullptr, step_.data(), nullptr);
      const double length = largest(step_);
      if (!(length > 0.0)) return false;
      for (int i = 0; i < n_; ++i) pull_[i] = step_[i] / length;
    }
    const double sign = dot(now_.gradient, pull_) > 0 ? -1.0 : 1.0;
    for (const double s : {sign, -sign}) {
      for (int i = 0; i < n_; ++i) step_[i] = s * pull_[i];
      y_next_ = y_;
      if (descend(0.2)) return true;
    }
    return false;
  }

  // Halves the step until, pulled back to the constraints, the Lagrangian has fallen. A step that meets an inequality
  // ends there, and the inequality becomes active.
  bool descend(double alpha) {
    lagrangian_gradient(now_, y_next_);
    const double slope = std::min(0.0, dot(residual_, step_));
    const double before = lagrangian(now_, gap_, y_next_);
    const double noise = 1e-14 * (1.0 + std::abs(now_.objective)) + dot(gap_, gap_);
    const double longest = largest(step_);
    for (int h = 0; h < halvings; ++h) {
      for (int i = 0; i < n_; ++i) trial_.x[i] = now_.x[i] + alpha * step_[i];
      evaluate(trial_);
      const double reach = alpha * longest;
      int met = -1;
      if (pull_back(std::clamp(reach * reach, 1e-13, options.closure_tolerance))) {
        const double fraction = first_crossing(met);
        if (fraction < 1.0) {
          alpha *= fraction;
          if (alpha * longest > 1e-15) continue;
        }
        const bool fell = lagrangian(trial_, trial_gap_, y_next_) <= before + armijo * alpha * slope + noise;
        if (fell || (alpha == 1.0 && -slope < noise) || !options.safeguards.line_search) {
          if (met >= 0)
            activate(met, violation_side(met));
          else
            carry_multipliers(alpha);
          std::swap(now_, trial_);
          return true;
        }
      }
      alpha *= 0.5;
    }
    return false;
  }

  // Chord steps with the factors at hand until the active rows of trial_ hold to `tolerance`.
  bool pull_back(double tolerance) {
    gap(trial_, trial_gap_);
    double left = largest(trial_gap_);
    for (int k = 0; k < pull_backs && left > tolerance; ++k) {
      kkt_->restore(trial_gap_.data(), residual_.data());
      if (!(largest(residual_) <= options.longest_step)) return false;
      for (int i = 0; i < n_; ++i) trial_.x[i] += residual_[i];
      evaluate(trial_);
      gap(trial_, trial_gap_);
      const double now_left = largest(trial_gap_);
      if (!(now_left < 0.7 * left)) return false;
      left = now_left;
    }
    return left <= tolerance;
  }

  // --- load stepping ------------------------------------------------------------------------------------------------

  // Release (1 - held_) grows from 0 to 1; a step that gives up goes back and lets go of less.
  void step_loads() {
    restart_from(start_);
    if (!close_loops()) return;
    linearize();
    std::copy(residual_.begin(), residual_.end(), hold_.begin());
    kicked_from_ = now_.x;
    const bool down = options.goal == Goal::minimum && problem_.has_objective();
    double release = first_release;
    for (double let_go = 0.0; let_go < 1.0;) {
      const double next = std::min(1.0, let_go + release);
      held_ = 1.0 - next;
      restart_from(kicked_from_);
      const Outcome outcome = down ? descend_to_rest() : seek_stationary();
      note(outcome);
      if (outcome == Outcome::interrupted || outcome == Outcome::unbounded) break;
      if (outcome == Outcome::converged) {
        let_go = next;
        kicked_from_ = now_.x;
        release *= 2.0;
      } else {
        release *= 0.25;
        if (release < least_release) break;
      }
    }
    held_ = 0.0;
    result.load_stepped = result.outcome == Outcome::converged;
    evaluate(now_);
  }

  // Where between now_ (0) and trial_ (1) the first inequality not yet active is met; 1 when it lies within touching
  // of trial_ (then `met` names it) or none is met.
  double first_crossing(int& met) const {
    double first = 1.0;
    for (int r = equalities_; r < m_; ++r) {
      if (result.active[r]) continue;
      const double v = violation(trial_, r);
      if (v == 0.0) continue;
      if (std::abs(v) <= touching) {
        met = r;
        continue;
      }
      const double travelled = trial_.constraint[r] - now_.constraint[r];
      // Aim just beyond the bound, so that the next trial lands within touching outside and not short of it.
      first = std::min(first, std::max(0.0, 1.0 - (v - std::copysign(0.5 * touching, v)) / travelled));
    }
    if (first < 1.0) met = -1;
    return first;
  }

  int violation_side(int row) const { return violation(trial_, row) > 0 ? 1 : -1; }

  const Problem& problem_;
  int n_, m_, equalities_;
  int restarts_ = restarts;
  int fresh_starts_ = fresh_starts;
  std::unique_ptr<Kkt> kkt_;
  Evaluation now_, trial_;
  std::vector<double> hold_;  // artificial load that balances the closed start, and the share of it not let go
  double held_ = 0.0;
  std::vector<double> tangent_, step_, residual_, start_, pull_, kicked_from_, displaced_, y_, y_next_, y_before_, gap_,
      trial_gap_;
  std::vector<signed char> side_;
  std::vector<int> releases_;
  bool fresh_multipliers_ = false;
  std::minstd_rand random_;  // the same for every run, so that runs repeat
  double shift_ = 0.0;
  double gap_norm_ = 0.0;                          // |c| at now_, linearized; closed_within where it is less
  double force_norm_ = 0.0;                        // |F + J^T y| at now_, linearized
  std::vector<std::pair<double, double>> filter_;  // (gap, force) that no later point of a run may be worse than
};

Newton::Newton(const Problem& problem, NewtonOptions options) : run_(std::make_unique<Run>(problem, options)) {}
Newton::~Newton() = default;

const NewtonResult& Newton::solve(const double* x) {
  run_->solve(x);
  return run_->result;
}

const NewtonResult& Newton::close(const double* x) {
  run_->close(x);
  return run_->result;
}

NewtonOptions& Newton::options() { return run_->options; }

}  // namespace poise::solvers
