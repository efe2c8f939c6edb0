#include "solvers/augmented_lagrangian.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/LU>
#include <Eigen/SparseLU>

#include "solvers/active_set.hpp"
#include "solvers/filter.hpp"
#include "solvers/residuals.hpp"
#include "solvers/vectors.hpp"

namespace poise::solvers {
namespace {

constexpr int dense_unknowns = 60;
constexpr double tangent_shift = 1e-12;  // keeps the tangent regular where rows are dependent
constexpr double first_shift = 1e-10;    // of a tangent that is singular nevertheless, relative to its largest entry
constexpr int shifts = 6;                // each a hundred times the one before
constexpr double longest_step = 3.0;     // rad or mechanism sizes
constexpr int line_halvings = 6;
constexpr int bold_steps = 20;  // full steps taken where the filter accepts no shortened one

// [ H J^T; J -relax ] factored by LU, dense or sparse; inactive rows are identity.
class SaddleFactors {
 public:
  SaddleFactors(const Problem& problem, const std::vector<int>& kept)
      : tangent_(problem.tangent_pattern()),
        n_(problem.variables()),
        size_(n_ + static_cast<int>(kept.size())),
        symmetric_(problem.has_objective()),
        dense_(size_ <= dense_unknowns),
        place_of_(problem.constraints(), -1),
        jacobian_(problem.jacobian_pattern()) {
    for (int s = 0; s < size_ - n_; ++s) place_of_[kept[s]] = n_ + s;
    if (dense_)
      full_.resize(size_, size_);
    else
      lay_out();
    for (int e = 0; e < tangent_.size(); ++e) {
      tangent_slot_.push_back(slot(tangent_.row[e], tangent_.column[e]));
      mirror_slot_.push_back(symmetric_ ? slot(tangent_.column[e], tangent_.row[e]) : 0);
    }
    for (int e = 0; e < jacobian_.size(); ++e) {
      const int row = place_of_[jacobian_.row[e]];
      jacobian_slot_.emplace_back(row < 0 ? 0 : slot(row, jacobian_.column[e]),
                                  row < 0 ? 0 : slot(jacobian_.column[e], row));
    }
    for (int i = 0; i < size_; ++i) diagonal_slot_.push_back(slot(i, i));
  }

  // False where the matrix is singular.
  bool factor(const std::vector<double>& tangent, const Evaluation& at, const ActiveSet& active, double shift) {
    double* a = values();
    std::fill(a, a + count(), 0.0);
    for (int e = 0; e < tangent_.size(); ++e) {
      a[tangent_slot_[e]] += tangent[e];
      if (symmetric_ && tangent_.row[e] != tangent_.column[e]) a[mirror_slot_[e]] += tangent[e];
    }
    for (int e = 0; e < jacobian_.size(); ++e) {
      if (place_of_[jacobian_.row[e]] < 0 || !active.holds(jacobian_.row[e])) continue;
      a[jacobian_slot_[e].first] += at.jacobian[e];
      a[jacobian_slot_[e].second] += at.jacobian[e];
    }
    for (int i = 0; i < n_; ++i) a[diagonal_slot_[i]] += shift;
    for (const int r : active.kept()) a[diagonal_slot_[place_of_[r]]] = active.holds(r) ? -tangent_shift : 1.0;
    if (dense_) {
      full_lu_.compute(full_);
      return true;
    }
    sparse_lu_.factorize(sparse_);
    return sparse_lu_.info() == Eigen::Success;
  }

  // False where the solution is not finite.
  bool solve(const Eigen::VectorXd& right, Eigen::VectorXd& solution) {
    if (dense_)
      solution = full_lu_.solve(right);
    else
      solution = sparse_lu_.solve(right);
    return solution.allFinite();
  }

 private:
  void lay_out() {
    std::vector<Eigen::Triplet<double>> entries;
    const auto both = [&](int i, int j) {
      entries.emplace_back(i, j, 0.0);
      entries.emplace_back(j, i, 0.0);
    };
    for (int e = 0; e < tangent_.size(); ++e) both(tangent_.row[e], tangent_.column[e]);
    for (int e = 0; e < jacobian_.size(); ++e) {
      if (place_of_[jacobian_.row[e]] >= 0) both(place_of_[jacobian_.row[e]], jacobian_.column[e]);
    }
    for (int i = 0; i < size_; ++i) both(i, i);
    sparse_.resize(size_, size_);
    sparse_.setFromTriplets(entries.begin(), entries.end());
    sparse_.makeCompressed();
    sparse_lu_.isSymmetric(true);
    sparse_lu_.setPivotThreshold(1e-3);
    sparse_lu_.analyzePattern(sparse_);
  }

  std::ptrdiff_t slot(int i, int j) { return (dense_ ? &full_(i, j) : &sparse_.coeffRef(i, j)) - values(); }
  double* values() { return dense_ ? full_.data() : sparse_.valuePtr(); }
  Eigen::Index count() const { return dense_ ? full_.size() : sparse_.nonZeros(); }

  const Pattern& tangent_;
  int n_, size_;
  bool symmetric_, dense_;
  std::vector<int> place_of_;  // of a constraint row in the matrix, -1 if it is left out
  const Pattern& jacobian_;
  Eigen::MatrixXd full_;
  Eigen::PartialPivLU<Eigen::MatrixXd> full_lu_;
  Eigen::SparseMatrix<double> sparse_;
  // Ordered by A + A^T: closures of long chains fill whole rows, for which COLAMD, made for A^T A, causes much fill-in.
  Eigen::SparseLU<Eigen::SparseMatrix<double>, Eigen::AMDOrdering<int>> sparse_lu_;
  std::vector<std::ptrdiff_t> tangent_slot_, mirror_slot_, diagonal_slot_;
  std::vector<std::pair<std::ptrdiff_t, std::ptrdiff_t>> jacobian_slot_;
};

class AugmentedLagrangian {
 public:
  AugmentedLagrangian(const Problem& problem, const AugmentedLagrangianOptions& options, const std::vector<int>& rows)
      : problem_(problem),
        options_(options),
        n_(problem.variables()),
        active_(problem, rows),
        factors_(problem, active_.kept()),
        now_(problem.make_evaluation()),
        trial_(problem.make_evaluation()),
        tangent_(problem.tangent_pattern().size()),
        no_multipliers_(problem.constraints(), 0.0),
        y_(problem.constraints(), 0.0),
        lambda_(y_),
        trial_lambda_(y_) {
    right_.resize(n_ + kept_rows());
    unbalanced_.resize(n_);
  }

  SearchResult solve(const std::vector<double>& start) {
    now_.x = start;
    problem_.evaluate(now_);
    result_.evaluations = 1;
    active_.activate_violated(now_, -options_.tolerance);
    const std::vector<double> y = least_squares_multipliers(problem_, now_, active_.rows());
    for (const int r : active_.rows()) lambda_[r] = y[r] / options_.multiplier_scale;
    search();
    result_.x = now_.x;
    measure(now_, lambda_);
    result_.multipliers = y_;
    return std::move(result_);
  }

 private:
  int kept_rows() const { return static_cast<int>(active_.kept().size()); }

  void search() {
    while (true) {
      measure(now_, lambda_);
      if (options_.interrupt != nullptr && options_.interrupt->load()) {
        result_.interrupted = true;
        return end("interrupted");
      }
      if (arrived()) {
        const ActiveSet::Release release = active_.release_wrong_sign(y_, options_.tolerance * force_scale_);
        if (release == ActiveSet::Release::cycling) return end("the active set cycles");
        if (release == ActiveSet::Release::none) return conclude();
        drop_multipliers();
        filter_.clear();
        continue;
      }
      if (result_.iterations == options_.iterations) return end("the iteration limit was reached");
      ++result_.iterations;
      if (!find_step()) return end("the tangent is singular");
      if (!advance()) return end("no step makes further progress");
      if (change_active_set()) filter_.clear();
    }
  }

  void conclude() {
    const char* flaw = objection(now_, active_, y_, options_.tolerance);
    result_.claims_success = flaw == nullptr;
    end(flaw == nullptr ? "converged" : flaw);
  }

  void end(const char* how) {
    result_.status = options_.tangent == Tangent::newton ? "augmented Lagrangian: " : "modified augmented Lagrangian: ";
    result_.status += how;
  }

  // y = k lambda + p c, |F + J^T y| and |c| at an evaluated point.
  void measure(const Evaluation& at, const std::vector<double>& lambda) {
    for (const int r : active_.rows()) {
      y_[r] = options_.multiplier_scale * lambda[r] + options_.penalty * active_.gap(at, r);
    }
    unbalanced(problem_, at, y_, unbalanced_);
    force_ = largest(unbalanced_);
    gap_ = active_.largest_gap(at);
    force_scale_ = 1.0 + largest(at.gradient);
  }

  bool arrived() const { return gap_ <= options_.tolerance && force_ <= options_.tolerance * force_scale_; }

  // Activates violated stops; releases one whose multiplier has the wrong sign by more than the force residual.
  bool change_active_set() {
    const bool joined = active_.activate_violated(now_, options_.tolerance);
    measure(now_, lambda_);
    const bool left = active_.release_wrong_sign(y_, std::max(options_.tolerance * force_scale_, force_)) ==
                      ActiveSet::Release::released;
    if (left) drop_multipliers();
    return joined || left;
  }

  void drop_multipliers() {
    active_.clear_inactive(lambda_);
    active_.clear_inactive(y_);
  }

  // The tangent [K + p J^T J, k J^T; k J, 0] (d, dlambda) = -(F + J^T y, k c) is solved as
  //   K d + J^T w = -(F + J^T y),  J d = -c,  k dlambda = w - p J d = w + p c:
  // J^T J would fill the matrix and square its condition.
  bool find_step() {
    problem_.tangent(now_, options_.tangent == Tangent::newton ? y_ : no_multipliers_, tangent_);
    right_.setZero();
    for (int i = 0; i < n_; ++i) right_[i] = -unbalanced_[i];
    for (int s = 0; s < kept_rows(); ++s) {
      const int r = active_.kept()[s];
      if (active_.holds(r)) right_[n_ + s] = -active_.gap(now_, r);
    }
    double shift = 0.0;
    for (int k = 0; k <= shifts; ++k) {
      if (factors_.factor(tangent_, now_, active_, shift) && factors_.solve(right_, step_)) return true;
      shift = k == 0 ? first_shift * (1.0 + largest(tangent_)) : 100.0 * shift;
    }
    return false;
  }

  // Takes the step, halved until the filter accepts the point. If it accepts none, the residuals have a local minimum
  // that is no equilibrium: the full step then leaves it, and the filter is cleared.
  bool advance() {
    const double whole = std::min(1.0, longest_step / step_.head(n_).cwiseAbs().maxCoeff());
    filter_.remember(gap_, force_);
    double alpha = whole;
    for (int h = 0; h < line_halvings; ++h, alpha *= 0.5) {
      try_step(alpha);
      if (filter_.takes(gap_, force_)) return accept();
    }
    if (++bold_steps_taken_ > bold_steps) return false;
    filter_.clear();
    try_step(whole);
    return filter_.takes(gap_, force_) && accept();
  }

  void try_step(double alpha) {
    for (int i = 0; i < n_; ++i) trial_.x[i] = now_.x[i] + alpha * step_[i];
    for (int s = 0; s < kept_rows(); ++s) {
      const int r = active_.kept()[s];
      const double w = step_[n_ + s];
      const double change = active_.holds(r) ? w + options_.penalty * active_.gap(now_, r) : 0.0;
      trial_lambda_[r] = lambda_[r] + alpha * change / options_.multiplier_scale;
    }
    problem_.evaluate(trial_);
    ++result_.evaluations;
    measure(trial_, trial_lambda_);
  }

  bool accept() {
    std::swap(now_, trial_);
    std::swap(lambda_, trial_lambda_);
    return true;
  }

  const Problem& problem_;
  const AugmentedLagrangianOptions& options_;
  int n_;
  ActiveSet active_;
  SaddleFactors factors_;
  Evaluation now_, trial_;
  std::vector<double> tangent_, no_multipliers_, y_, lambda_, trial_lambda_, unbalanced_;
  Eigen::VectorXd right_, step_;
  double gap_ = 0.0, force_ = 0.0, force_scale_ = 1.0;  // of the point measured last
  Filter filter_;
  int bold_steps_taken_ = 0;
  SearchResult result_;
};

}  // namespace

SearchResult solve_with_augmented_lagrangian(const Problem& problem, const std::vector<double>& start,
                                             const AugmentedLagrangianOptions& options, const std::vector<int>& rows) {
  return AugmentedLagrangian(problem, options, rows).solve(start);
}

}  // namespace poise::solvers
