#include "identification/fit/private/minimise.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include <ceres/ceres.h>
#include <fmt/format.h>

#include "identification/fit/private/descent_cost.hpp"
#include "solvers/linear_algebra.hpp"

namespace poise {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Steps that are tried, and those in turn whose motions cannot be computed.
constexpr int most_steps = 100, most_without_motion = 20;
/// A step is taken where the cost falls by more than this part of what is predicted.
constexpr double least_success = 1e-3;
/// Full steps are tried first: small oscillations are nearly linear in the parameters.
constexpr double first_radius = 1e6, largest_radius = 1e16;
/// A step after one that failed is shorter by this at least: a motion costs far more than a step.
constexpr double shorter_after_failure = 0.5;

/// Relative error of the cost that follows from the integration errors of the motions.
constexpr double noise_of_cost = 1e-4;
/// Steps that failed by no more than that, in turn, after which no further one is tried.
constexpr int most_idle = 3;
/// Predicted relative decrease of the cost below which no further step is tried after one that failed: the decrease is
/// then smaller than what integration errors change, and shorter steps would fail, too.
constexpr double least_decrease = 1e-5;
/// The same where the result is a start for more readings, and the tolerance of its cost.
constexpr double least_decrease_of_start = 1e-3, tolerance_of_start = 1e-3;
/// A fit ends where a full step is predicted to decrease the cost by less than this part of the tolerance,
constexpr double sure = 1e-2;
/// or by less than this part of what the cost grows by at one standard error, where the size of the residuals is that
/// of the noise: no estimate changes by more than a thousandth of its standard error then.
constexpr double part_of_standard_error = 1e-6;
/// After a step that failed, one ends besides where the parameters are predicted to change by less than a tenth of
/// their standard errors, this part of what the cost grows by at one, while the whole decrease is a small part of the
/// cost: what is left then are the starts of runs, along which the cost of bodies that friction holds is full of kinks.
constexpr double part_of_parameters = 1e-2, small_decrease = 1e-3;
/// Decreases below this part of the cost are rounding, and so are distances of variables from the ends of their ranges.
constexpr double rounding = 1e-15, at_end = 1e-12;

/// The part of a step from x that leaves no range.
double part_within(const VectorXd& low, const VectorXd& high, const VectorXd& x, const VectorXd& step) {
  double out = 1.0;
  for (Index i = 0; i < x.size(); ++i) {
    if (step[i] == 0.0) continue;
    const double room = (step[i] > 0 ? high[i] : low[i]) - x[i];
    if (std::abs(step[i]) > std::abs(room)) out = std::min(out, room / step[i]);
  }
  return out;
}

/// Steps of some variables, straight on as far as the first end of a range.
class WithinRanges : public ceres::Manifold {
 public:
  WithinRanges(const VectorXd& low, const VectorXd& high, std::vector<Index> free)
      : low_(low), high_(high), free_(std::move(free)) {}

  int AmbientSize() const override { return static_cast<int>(low_.size()); }
  int TangentSize() const override { return static_cast<int>(free_.size()); }
  bool Plus(const double* from, const double* delta, double* to) const override {
    const Eigen::Map<const VectorXd> x(from, low_.size());
    VectorXd step = VectorXd::Zero(low_.size());
    for (std::size_t k = 0; k < free_.size(); ++k) step[free_[k]] = delta[k];
    const double part = part_within(low_, high_, x, step);
    Eigen::Map<VectorXd> reached(to, low_.size());
    reached = x + part * step;
    for (const Index i : free_) {
      // The end that is met is met exactly.
      const double room = (step[i] > 0 ? high_[i] : low_[i]) - x[i];
      if (part < 1.0 && std::abs(part * step[i]) >= std::abs(room)) reached[i] = x[i] + room;
      reached[i] = std::clamp(reached[i], low_[i], high_[i]);
    }
    return true;
  }
  bool PlusJacobian(const double* /*x*/, double* jacobian) const override {
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Eigen::Map<Rows> out(jacobian, low_.size(), std::ssize(free_));
    out.setZero();
    for (std::size_t k = 0; k < free_.size(); ++k) out(free_[k], static_cast<Index>(k)) = 1.0;
    return true;
  }
  bool Minus(const double* to, const double* from, double* delta) const override {
    for (std::size_t k = 0; k < free_.size(); ++k) delta[k] = to[free_[k]] - from[free_[k]];
    return true;
  }
  bool MinusJacobian(const double* /*x*/, double* jacobian) const override {
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Eigen::Map<Rows> out(jacobian, std::ssize(free_), low_.size());
    out.setZero();
    for (std::size_t k = 0; k < free_.size(); ++k) out(static_cast<Index>(k), free_[k]) = 1.0;
    return true;
  }

 private:
  const VectorXd &low_, &high_;
  std::vector<Index> free_;
};

/// The residuals for Ceres, which asks for them first and, where it accepts the point, for the Jacobian.
class CostForCeres : public ceres::CostFunction {
 public:
  explicit CostForCeres(DescentCost& cost) : cost_(cost) {
    mutable_parameter_block_sizes()->push_back(static_cast<int>(cost.low().size()));
    set_num_residuals(static_cast<int>(cost.rows()));
  }
  bool Evaluate(const double* const* blocks, double* residuals, double** jacobians) const override {
    const Index columns = cost_.low().size();
    const DescentCost::Place& place = cost_.at(Eigen::Map<const VectorXd>(blocks[0], columns));
    if (!place.is_known()) return false;
    const DescentCost::Model model = cost_.model(place);
    Eigen::Map<VectorXd>(residuals, model.r.size()) = model.r;
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Eigen::Map<Rows>(jacobians[0], model.r.size(), columns) = model.a;
    return true;
  }

 private:
  DescentCost& cost_;
};

/// A descent by Ceres in rounds: in each of them some variables are held at the ends of their ranges and the others
/// descend, until another choice is the better one, or a step fails. A place is computed once, also for the round after
/// it, so that a round costs no motion by itself.
class Descent : ceres::IterationCallback {
 public:
  Descent(const FitTask& task, const Weighting& weighting, const FitPoint& start, double window, FitEffort& effort)
      : task_(task), window_(window), effort_(effort), cost_(task, weighting, start, window, effort) {}

  /// Returns the cost reached, nothing where the start has none.
  std::optional<double> run() {
    if (!cost_.here().is_known()) return std::nullopt;
    look_ahead();
    while (!ends_ && !task_.stopped()) round();
    if (without_motion_ > most_without_motion && !moved_) return std::nullopt;
    return here();
  }

  FitPoint point() const { return cost_.point(); }
  std::vector<std::optional<LinearRun>> take_runs() { return cost_.take(); }

 private:
  /// The next step.
  struct Plan {
    std::vector<Index> free;  // variables that it changes
    double part = 1.0;        // that leaves no range
    double gain = 0.0;        // decrease of the cost by the whole step, to first order in the residuals
    double decrease = 0.0;    // the same by that part
    double length = 0.0;      // of that part, in units of the damping
  };

  bool is_start() const { return cost_.is_start(); }
  double here() const { return cost_.here().cost; }
  double tolerance() const { return is_start() ? tolerance_of_start : task_.options.function_tolerance; }

  // --- the step ahead -----------------------------------------------------------------------------------------------

  /// Decides on the next step from a new place, or that there is none.
  void look_ahead() {
    const DescentCost::Model model = cost_.model(cost_.here());
    const Index n = model.a.cols();
    damping_ = (1.0 + model.a.colwise().norm().transpose().array()).matrix();
    MatrixXd rows = MatrixXd::Zero(std::max(model.a.rows(), n + 1), n + 1);
    rows.topRows(model.a.rows()) << model.a, model.r;
    triangle_ = solvers::triangular_factor(rows).topRows(n);
    plan_ = plan(radius_);
    whole_ = plan(largest_radius);
    ends_ = steps_ >= most_steps || !(plan_.gain > rounding * here()) || is_flat();
  }

  double decrease_by(const VectorXd& step) const {
    const VectorXd after = triangle_.col(triangle_.rows()) + triangle_.leftCols(triangle_.rows()) * step;
    return (triangle_.col(triangle_.rows()).squaredNorm() - after.squaredNorm()) / 2;
  }

  /// Holds variables at ends of their ranges where their gradients, or the step of the others, pull them outwards.
  Plan plan(double radius) const {
    const VectorXd& low = cost_.low();
    const VectorXd& high = cost_.high();
    const VectorXd& x = cost_.here().x;
    const Index n = x.size();
    const auto is_low = [&](Index i) { return x[i] <= low[i] + at_end; };
    const auto is_high = [&](Index i) { return x[i] >= high[i] - at_end; };
    const auto leaves = [&](Index i, double towards) {
      return towards == 0.0 || (is_low(i) && towards < 0) || (is_high(i) && towards > 0);
    };
    const VectorXd gradient = triangle_.leftCols(n).transpose() * triangle_.col(n);
    Plan out;
    for (Index i = 0; i < n; ++i) {
      const bool is_at_end = is_low(i) || is_high(i);
      if (low[i] < high[i] && !(is_at_end && leaves(i, -gradient[i]))) out.free.push_back(i);
    }
    VectorXd step;
    do {
      step = step_of(out.free, radius);
    } while (std::erase_if(out.free, [&](Index i) { return step[i] != 0.0 && leaves(i, step[i]); }) > 0);
    out.part = part_within(low, high, x, step);
    out.gain = decrease_by(step);
    out.decrease = decrease_by(out.part * step);
    out.length = out.part * damping_.cwiseProduct(step).norm();
    return out;
  }

  /// Levenberg and Marquardt's step, as Ceres computes it.
  VectorXd step_of(const std::vector<Index>& free, double radius) const {
    const Index n = triangle_.rows();
    const Index m = std::ssize(free);
    VectorXd out = VectorXd::Zero(n);
    if (m == 0) return out;
    MatrixXd rows = MatrixXd::Zero(n + m, m + 1);
    rows.topRows(n) << triangle_(Eigen::all, free), -triangle_.col(n);
    for (Index k = 0; k < m; ++k) rows(n + k, k) = damping_[free[static_cast<std::size_t>(k)]] / std::sqrt(radius);
    const MatrixXd factor = solvers::triangular_factor(rows);
    const VectorXd found = factor.topLeftCorner(m, m).triangularView<Eigen::Upper>().solve(factor.col(m).head(m));
    for (Index k = 0; k < m; ++k) out[free[static_cast<std::size_t>(k)]] = found[k];
    return out;
  }

  /// What the cost grows by at one standard error where the size of the residuals is that of the noise.
  double growth_at_error() const { return here() / std::max(1, task_.degrees_of_freedom()); }

  /// What is left to gain is not worth a motion, whatever the radius is.
  bool is_flat() const {
    const double gain = std::max(plan_.gain, whole_.gain);
    const double noise = is_start() ? 0.0 : part_of_standard_error * growth_at_error();
    return gain < std::max((is_start() ? 1.0 : sure) * tolerance() * here(), noise);
  }

  /// What is left to gain is nearly all that of the starts of runs.
  bool is_of_starts() const {
    const Index parameters = std::ssize(task_.problem.parameters());
    std::vector<Index> starts = whole_.free;
    std::erase_if(starts, [&](Index i) { return i < parameters; });
    if (is_start() || starts.size() == whole_.free.size() || whole_.gain > small_decrease * here()) return false;
    return whole_.gain - decrease_by(step_of(starts, largest_radius)) < part_of_parameters * growth_at_error();
  }

  // --- rounds -------------------------------------------------------------------------------------------------------

  void round() {
    CostForCeres residuals(cost_);
    WithinRanges ranges(cost_.low(), cost_.high(), plan_.free);
    ceres::Problem::Options owns;
    owns.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    owns.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ceres::Problem problem(owns);
    VectorXd x = cost_.here().x;
    problem.AddResidualBlock(&residuals, nullptr, x.data());
    problem.SetManifold(x.data(), &ranges);
    ceres::Solver::Summary summary;
    ceres::Solve(settings(), &problem, &summary);
    // Ceres ends by itself where a step changes nothing that counts.
    ends_ = ends_ || summary.termination_type != ceres::USER_SUCCESS;
  }

  ceres::Solver::Options settings() {
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.logging_type = ceres::SILENT;
    options.max_num_iterations = most_steps;
    // A part of a step may be as small as it likes, and is not expected to do more than that part of it.
    options.function_tolerance = plan_.part < 1.0 ? 0.0 : tolerance();
    options.parameter_tolerance = options.gradient_tolerance = 0.0;
    options.min_relative_decrease = least_success * plan_.part;
    options.initial_trust_region_radius = radius_;
    // A variable whose change by its unit changes the residuals by less than the noise is damped as if it did by as
    // much: along a null a step would go as far as rounding drives it.
    options.min_lm_diagonal = 1.0;
    options.callbacks.push_back(this);
    return options;
  }

  /// Where Ceres has tried a step.
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& step) override {
    // Not as a failure, with which Ceres would not hand over the values reached.
    constexpr auto ends_round = ceres::SOLVER_TERMINATE_SUCCESSFULLY;
    if (task_.stopped()) return ends_round;
    if (step.iteration == 0) return ceres::SOLVER_CONTINUE;
    ++steps_;
    ++effort_.iterations;
    if (!step.step_is_successful) {
      // `cost` is what a step that failed led to: without limit where the motion could not be computed.
      ends_ = fails_for_good(step.cost < std::numeric_limits<double>::max(), step.cost_change);
      if (!ends_) shorten();
      return ends_round;
    }
    cost_.accept();
    moved_ = true;
    without_motion_ = idle_ = 0;
    narrower_ = 2.0;
    const Plan done = plan_;
    // A bound that cut a step short says nothing against its length.
    radius_ = done.part < 1.0 ? std::max(radius_, step.trust_region_radius) : step.trust_region_radius;
    look_ahead();
    say_progress(done.decrease);
    return ends_ || plan_.free != done.free || done.part < 1.0 || plan_.part < 1.0 ? ends_round
                                                                                   : ceres::SOLVER_CONTINUE;
  }

  /// Whether no shorter step would succeed either after this one that failed.
  bool fails_for_good(bool is_computed, double change) {
    if (steps_ >= most_steps) return true;
    if (!is_computed) return ++without_motion_ > most_without_motion;
    without_motion_ = 0;
    idle_ = std::abs(change) < noise_of_cost * here() ? idle_ + 1 : 0;
    const double least = is_start() ? least_decrease_of_start : least_decrease;
    return idle_ >= most_idle || plan_.gain < least * here() || is_of_starts();
  }

  /// Damps the next step until it is short enough after one that failed.
  void shorten() {
    const double longest = shorter_after_failure * plan_.length;
    do {
      radius_ /= narrower_;
      narrower_ *= 2;
      plan_ = plan(radius_);
      ends_ = !(plan_.gain > rounding * here());
    } while (plan_.length > longest && !ends_);
  }

  /// Says how long the descent takes if steps gain ever less by the factor of the last two.
  void say_progress(double decrease) {
    if (!task_.options.progress) return;
    std::string left;
    const double limit = (is_start() ? 1.0 : sure) * tolerance() * here();
    if (!ends_ && decrease > plan_.decrease && plan_.decrease > limit) {
      const double steps =
          std::min(std::log(limit / plan_.decrease) / std::log(plan_.decrease / decrease), 1.0 * most_steps);
      const double seconds = (1.0 + steps) * cost_.seconds();
      if (seconds >= 1.0) left = fmt::format(", about {:.0f} s left", seconds);
    }
    const std::string part = is_start() ? fmt::format(" the first {:.0f} % of every record", 100 * window_) : "";
    task_.say(fmt::format("fitting{}: step {}, cost {:.6g}{}", part, steps_, here(), left));
  }

  const FitTask& task_;
  double window_;
  FitEffort& effort_;
  DescentCost cost_;
  VectorXd damping_;                               // of each variable: its scale in the trust region
  MatrixXd triangle_;                              // of the cost about this place, and its residuals
  Plan plan_, whole_;                              // with the radius, and without any
  double radius_ = first_radius;                   // of the trust region: the inverse of the damping
  double narrower_ = 2.0;                          // factor by which the radius falls next
  int steps_ = 0, without_motion_ = 0, idle_ = 0;  // tried; and those in turn that failed so
  bool moved_ = false;                             // some step succeeded
  bool ends_ = false;
};

std::string why_failed(const FitProblem& problem, const FitPoint& start) {
  const std::string why = problem.why_no_motion(start.parameters, start.nuisances);
  return why.empty() ? "no step from the start reduced the cost" : why;
}

}  // namespace

Minimum minimise(const FitTask& task, const Weighting& weighting, const FitPoint& start, double window,
                 FitEffort& effort) {
  Descent descent(task, weighting, start, window, effort);
  const std::optional<double> cost = descent.run();
  if (!cost) return {.point = start, .why_not = task.stopped() ? "interrupted" : why_failed(task.problem, start)};
  Minimum out{.cost = *cost, .point = descent.point()};
  if (window == 1.0) out.computed = descent.take_runs();
  return out;
}

Minimum minimise_as_check(const FitTask& task, const Weighting& weighting, const FitPoint& start, FitEffort& effort) {
  FitEffort own;
  Minimum out = minimise(task, weighting, start, 1.0, own);
  effort.iterations += own.iterations;
  effort.check_evaluations += own.evaluations;
  return out;
}

}  // namespace poise
