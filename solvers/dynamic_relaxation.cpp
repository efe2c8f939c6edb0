#include "solvers/dynamic_relaxation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>

#include "solvers/active_set.hpp"
#include "solvers/residuals.hpp"
#include "solvers/vectors.hpp"

namespace poise::solvers {
namespace {

constexpr double of_stiffness = 0.3;          // mass over stiffness; explicit unit time steps are stable above 1/4
constexpr double of_force = 0.5;              // mass over force, for loads whose stiffness passes zero
constexpr double least_mass = 1e-6;           // relative to the largest
constexpr double longest_displacement = 0.2;  // rad or mechanism sizes
constexpr double closure_shift = 1e-13;       // keeps J M^-1 J^T regular where rows are dependent
constexpr int dense_rows = 60;
constexpr int closure_refinements = 6;
constexpr int pull_backs = 12;       // chord steps back to the constraints after one time step
constexpr double near_enough = 0.1;  // share of the tolerance to which constraints are kept
constexpr int closing_steps = 50;
constexpr int shift_halvings = 12;
constexpr double run_away = 100.0;  // distance from the start that counts as divergence

// J M^-1 J^T of the active rows, factored; inactive rows are identity.
class ConstraintFactors {
 public:
  ConstraintFactors(const Problem& problem, const std::vector<int>& kept)
      : pattern_(problem.jacobian_pattern()),
        place_of_(problem.constraints(), -1),
        dense_(static_cast<int>(kept.size()) <= dense_rows) {
    std::vector<Eigen::Triplet<double>> entries;
    for (int s = 0; s < static_cast<int>(kept.size()); ++s) place_of_[kept[s]] = s;
    for (int e = 0; e < pattern_.size(); ++e) {
      if (place_of_[pattern_.row[e]] >= 0) entries.emplace_back(place_of_[pattern_.row[e]], pattern_.column[e], 0.0);
    }
    jacobian_.resize(static_cast<Eigen::Index>(kept.size()), problem.variables());
    jacobian_.setFromTriplets(entries.begin(), entries.end());
    for (int e = 0; e < pattern_.size(); ++e) {
      const int row = place_of_[pattern_.row[e]];
      slot_.push_back(row < 0 ? 0 : &jacobian_.coeffRef(row, pattern_.column[e]) - jacobian_.valuePtr());
    }
    weighted_ = jacobian_;
  }

  void factor(const Evaluation& at, const ActiveSet& active, const Eigen::VectorXd& mass) {
    if (jacobian_.rows() == 0) return;
    std::fill(jacobian_.valuePtr(), jacobian_.valuePtr() + jacobian_.nonZeros(), 0.0);
    for (int e = 0; e < pattern_.size(); ++e) {
      const int row = pattern_.row[e];
      if (place_of_[row] >= 0 && active.holds(row)) jacobian_.valuePtr()[slot_[e]] += at.jacobian[e];
    }
    weighted_ = jacobian_ * mass.cwiseInverse().asDiagonal();
    square_ = weighted_ * jacobian_.transpose();
    double scale = 0.0;
    for (const int r : active.rows()) scale = std::max(scale, square_.coeff(place_of_[r], place_of_[r]));
    for (const int r : active.kept())
      square_.coeffRef(place_of_[r], place_of_[r]) += active.holds(r) ? closure_shift * scale : 1.0;
    if (dense_) {
      full_ = square_;
      full_factors_.compute(full_);
      return;
    }
    if (!analysed_) sparse_factors_.analyzePattern(square_);
    analysed_ = true;
    sparse_factors_.factorize(square_);
  }

  // s = (J M^-1 J^T)^-1 b with iterative refinement, because the product has the squared condition of J.
  const Eigen::VectorXd& solve(const Eigen::VectorXd& b) {
    solution_.setZero(b.size());
    left_ = b;
    double last = std::numeric_limits<double>::infinity();
    for (int k = 0; k < closure_refinements; ++k) {
      const double size = left_.cwiseAbs().maxCoeff();
      if (!(size < 0.1 * last)) break;
      last = size;
      solution_ += once(left_);
      left_ = b;
      field_ = jacobian_.transpose() * solution_;
      left_ -= weighted_ * field_;
    }
    return solution_;
  }

  int place(int row) const { return place_of_[row]; }
  const Eigen::SparseMatrix<double>& jacobian() const { return jacobian_; }
  const Eigen::SparseMatrix<double>& weighted() const { return weighted_; }  // J M^-1

 private:
  Eigen::VectorXd once(const Eigen::VectorXd& b) {
    if (dense_) return full_factors_.solve(b);
    return sparse_factors_.solve(b);
  }

  const Pattern& pattern_;
  std::vector<int> place_of_;  // of a constraint row, -1 if it is left out
  bool dense_, analysed_ = false;
  Eigen::SparseMatrix<double> jacobian_, weighted_, square_;
  std::vector<std::ptrdiff_t> slot_;
  Eigen::MatrixXd full_;
  Eigen::LDLT<Eigen::MatrixXd> full_factors_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> sparse_factors_;
  Eigen::VectorXd solution_, left_, field_;
};

class DynamicRelaxation {
 public:
  DynamicRelaxation(const Problem& problem, const SearchOptions& options, const std::vector<int>& rows)
      : problem_(problem),
        options_(options),
        n_(problem.variables()),
        active_(problem, rows),
        factors_(problem, active_.kept()),
        now_(problem.make_evaluation()),
        trial_(problem.make_evaluation()),
        tangent_(problem.tangent_pattern().size()),
        y_(problem.constraints(), 0.0),
        unbalanced_(problem.variables()),
        mass_(Eigen::VectorXd::Ones(problem.variables())),
        bound_(mass_),
        rate_(Eigen::VectorXd::Zero(problem.variables())),
        shift_(rate_),
        right_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(active_.kept().size()))) {}

  SearchResult solve(const std::vector<double>& start) {
    start_ = start;
    now_.x = start;
    evaluate(now_);
    search();
    result_.x = now_.x;
    result_.multipliers = y_;
    return std::move(result_);
  }

 private:
  void search() {
    if (!close_from_start()) return end("the constraints could not be closed from this start");
    balance();
    rest();
    while (true) {
      if (options_.interrupt != nullptr && options_.interrupt->load()) {
        result_.interrupted = true;
        return end("interrupted");
      }
      balance();
      const ActiveSet::Release released = release();
      if (released == ActiveSet::Release::cycling) return end("the active set cycles");
      if (released == ActiveSet::Release::released) continue;
      if (arrived()) {
        const char* flaw = objection(now_, active_, y_, options_.tolerance);
        result_.claims_success = flaw == nullptr;
        return end(flaw == nullptr ? "converged" : flaw);
      }
      if (result_.iterations == options_.iterations) return end("the iteration limit was reached");
      ++result_.iterations;
      if (!move()) return end("no step makes further progress");
      if (ran_away()) return end("the motion diverges");
    }
  }

  void end(const char* how) { result_.status = std::string("dynamic relaxation: ") + how; }

  void evaluate(Evaluation& at) {
    problem_.evaluate(at);
    ++result_.evaluations;
  }

  void factor() { factors_.factor(now_, active_, mass_); }

  Eigen::Map<const Eigen::VectorXd> field() const { return {now_.gradient.data(), n_}; }

  Eigen::Map<const Eigen::VectorXd> residual() const { return {unbalanced_.data(), n_}; }

  // y with J M^-1 (F + J^T y) = 0: the remaining force then acts along the constraints only.
  void balance() {
    std::fill(y_.begin(), y_.end(), 0.0);
    if (right_.size() > 0) {
      right_ = -(factors_.weighted() * field());
      const Eigen::VectorXd& y = factors_.solve(right_);
      for (const int r : active_.rows()) y_[r] = y[factors_.place(r)];
    }
    unbalanced(problem_, now_, y_, unbalanced_);
    force_scale_ = 1.0 + largest(now_.gradient);
  }

  ActiveSet::Release release() {
    const double noise = std::max(options_.tolerance * force_scale_, largest(unbalanced_));
    const ActiveSet::Release released = active_.release_wrong_sign(y_, noise);
    if (released == ActiveSet::Release::released) factor();
    return released;
  }

  bool arrived() const {
    return active_.largest_gap(now_) <= options_.tolerance && largest(unbalanced_) <= options_.tolerance * force_scale_;
  }

  // With a unit time step, explicit integration is stable if every mass is at least a quarter of its row sum of the
  // stiffness (Gershgorin). Where loads turn with x, stiffness passes zero while the force is largest; so forces count
  // as well.
  void choose_masses(bool keep_larger) {
    problem_.tangent(now_, y_, tangent_);
    const Pattern& pattern = problem_.tangent_pattern();
    bound_ = of_force * field().cwiseAbs();
    for (int e = 0; e < pattern.size(); ++e) {
      const double size = of_stiffness * std::abs(tangent_[e]);
      bound_[pattern.row[e]] += size;
      if (problem_.has_objective() && pattern.row[e] != pattern.column[e]) bound_[pattern.column[e]] += size;
    }
    const Pattern& jacobian = problem_.jacobian_pattern();
    for (int e = 0; e < jacobian.size(); ++e) {
      bound_[jacobian.column[e]] += of_force * std::abs(now_.jacobian[e] * y_[jacobian.row[e]]);
    }
    bound_ = bound_.cwiseMax(std::max(least_mass * bound_.maxCoeff(), std::numeric_limits<double>::min()));
    if (keep_larger)
      mass_ = mass_.cwiseMax(bound_);
    else
      mass_ = bound_;
    factor();
  }

  // One time step; false if no step keeps the constraints.
  bool move() {
    const double power = -rate_.dot(residual());
    if (power < 0.0) return back_to_peak(power);
    rate_ -= (resting_ ? 0.5 : 1.0) * residual().cwiseQuotient(mass_);
    last_power_ = resting_ ? -rate_.dot(residual()) : power;
    resting_ = false;
    const double fastest = rate_.cwiseAbs().maxCoeff();
    if (fastest > longest_displacement) rate_ *= longest_displacement / fastest;
    switch (displace(rate_)) {
      case Moved::not_at_all:
        return false;
      case Moved::in_part:
        rest();
        return true;
      case Moved::whole:
        break;
    }
    choose_masses(true);
    keep_rates_along_constraints();
    return true;
  }

  // Negative power: the kinetic energy had its peak within the last step, by linear interpolation of the power. Goes
  // back there and sets the rates to zero.
  bool back_to_peak(double power) {
    const bool moved = displace(-power / (power - last_power_) * rate_) != Moved::not_at_all;
    rest();
    return moved;
  }

  void rest() {
    rate_.setZero();
    resting_ = true;
    choose_masses(false);
  }

  enum class Moved { not_at_all, in_part, whole };

  // Moves by `shift`, halved until the constraints can be kept, and sets the rates to the displacement.
  Moved displace(const Eigen::VectorXd& shift) {
    shift_ = shift;
    for (int h = 0; h < shift_halvings; ++h, shift_ *= 0.5) {
      for (int i = 0; i < n_; ++i) trial_.x[i] = now_.x[i] + shift_[i];
      evaluate(trial_);
      if (!pull_back()) continue;
      for (int i = 0; i < n_; ++i) rate_[i] = trial_.x[i] - now_.x[i];
      std::swap(now_, trial_);
      if (!take_violated()) return Moved::not_at_all;
      return h == 0 ? Moved::whole : Moved::in_part;
    }
    return leave_singular_pose(shift) ? Moved::in_part : Moved::not_at_all;
  }

  bool take_violated() {
    if (!active_.activate_violated(now_, options_.tolerance)) return true;
    factor();
    return close();
  }

  // Where J loses rank the factors at now_ do not lead back to the constraints; close by, J has full rank again.
  bool leave_singular_pose(const Eigen::VectorXd& shift) {
    left_ = now_.x;
    for (int i = 0; i < n_; ++i) now_.x[i] += shift[i];
    evaluate(now_);
    factor();
    if (is_finite(now_) && close() && take_violated()) return true;
    now_.x = left_;
    evaluate(now_);
    factor();
    return false;
  }

  // Removes from the rates the part normal to the constraints.
  void keep_rates_along_constraints() {
    if (right_.size() == 0) return;
    right_ = factors_.jacobian() * rate_;
    const Eigen::VectorXd& s = factors_.solve(right_);
    rate_ -= factors_.weighted().transpose() * s;
  }

  void gaps(const Evaluation& at) {
    right_.setZero();
    for (const int r : active_.rows()) right_[factors_.place(r)] = active_.gap(at, r);
  }

  static bool is_finite(const Evaluation& at) {
    return std::isfinite(largest(at.x) + largest(at.gradient) + largest(at.constraint));
  }

  // Chord steps with the factors at now_ until the active rows hold at trial_.
  bool pull_back() {
    if (right_.size() == 0) return is_finite(trial_);
    gaps(trial_);
    double left = right_.cwiseAbs().maxCoeff();
    for (int k = 0; k < pull_backs && left > near_enough * options_.tolerance; ++k) {
      const Eigen::VectorXd back = factors_.weighted().transpose() * factors_.solve(right_);
      for (int i = 0; i < n_; ++i) trial_.x[i] -= back[i];
      evaluate(trial_);
      gaps(trial_);
      const double now = right_.cwiseAbs().maxCoeff();
      if (!(now < 0.5 * left)) break;
      left = now;
    }
    return right_.cwiseAbs().maxCoeff() <= options_.tolerance && is_finite(trial_);
  }

  // The loops first: stops violated on the way need not be violated where the loops are closed.
  bool close_from_start() {
    factor();
    const bool closed = close();
    if (!active_.activate_violated(now_, -options_.tolerance)) return closed;
    factor();
    return close();
  }

  // Shortest steps, in the metric of the masses, to where the active rows hold.
  bool close() {
    if (right_.size() == 0) return true;
    for (int k = 0; k < closing_steps; ++k) {
      gaps(now_);
      const double before = right_.squaredNorm();
      if (right_.cwiseAbs().maxCoeff() <= near_enough * options_.tolerance) return true;
      const Eigen::VectorXd back = factors_.weighted().transpose() * factors_.solve(right_);
      double alpha = std::min(1.0, 1.0 / back.cwiseAbs().maxCoeff());
      bool fell = false;
      for (int h = 0; h < shift_halvings && !fell; ++h, alpha *= 0.5) {
        for (int i = 0; i < n_; ++i) trial_.x[i] = now_.x[i] - alpha * back[i];
        evaluate(trial_);
        gaps(trial_);
        fell = right_.squaredNorm() < before;
      }
      if (!fell) break;
      std::swap(now_, trial_);
      factor();
    }
    gaps(now_);
    return right_.cwiseAbs().maxCoeff() <= options_.tolerance;
  }

  bool ran_away() const {
    for (int i = 0; i < n_; ++i) {
      if (!(std::abs(now_.x[i] - start_[i]) <= run_away)) return true;
    }
    return false;
  }

  const Problem& problem_;
  const SearchOptions& options_;
  int n_;
  ActiveSet active_;
  ConstraintFactors factors_;
  Evaluation now_, trial_;
  std::vector<double> start_, left_, tangent_, y_, unbalanced_;
  Eigen::VectorXd mass_, bound_, rate_, shift_, right_;
  double force_scale_ = 1.0;
  double last_power_ = 0.0;
  bool resting_ = true;
  SearchResult result_;
};

}  // namespace

SearchResult solve_with_dynamic_relaxation(const Problem& problem, const std::vector<double>& start,
                                           const SearchOptions& options, const std::vector<int>& rows) {
  return DynamicRelaxation(problem, options, rows).solve(start);
}

}  // namespace poise::solvers
