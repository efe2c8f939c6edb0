#include "solvers/augmented_lagrangian.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/LU>
#include <Eigen/SparseLU>

#include "solvers/residuals.hpp"

namespace poise::solvers {
namespace {

constexpr int dense_unknowns = 60;
constexpr double relax = 1e-12;          // keeps the tangent regular where rows repeat each other
constexpr double first_shift = 1e-10;    // of a tangent that is singular even so, as a part of its largest entry
constexpr int shifts = 6;                // each a hundred times the one before
constexpr double longest_step = 3.0;     // rad or mechanism sizes
constexpr double filter_margin = 0.01;   // by which a point must be better than those left behind
constexpr double closed_within = 1e-9;   // gaps below it count as none for the filter
constexpr std::size_t filter_size = 40;  // points remembered
constexpr int halvings = 6;
constexpr int bold_steps = 20;  // whole steps taken although no shorter one leads on

// [ H J^T; J -relax ] factored by LU, dense or sparse; rows that do not hold are identity.
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
    for (std::size_t s = 0; s < kept.size(); ++s) place_of_[kept[s]] = n_ + static_cast<int>(s);
    if (dense_)
      full_.resize(size_, size_);
    else
      lay_out();
    for (std::size_t e = 0; e < tangent_.size(); ++e) {
      tangent_slot_.push_back(slot(tangent_.row[e], tangent_.column[e]));
      mirror_slot_.push_back(symmetric_ ? slot(tangent_.column[e], tangent_.row[e]) : 0);
    }
    for (std::size_t e = 0; e < jacobian_.size(); ++e) {
      const int row = place_of_[jacobian_.row[e]];
      jacobian_slot_.emplace_back(row < 0 ? 0 : slot(row, jacobian_.column[e]),
                                  row < 0 ? 0 : slot(jacobian_.column[e], row));
    }
    for (int i = 0; i < size_; ++i) diagonal_slot_.push_back(slot(i, i));
  }

  // False where the matrix is singular.
  bool factor(const std::vector<double>& tangent, const Evaluation& at, const HeldRows& held, double shift) {
    double* a = values();
    std::fill(a, a + count(), 0.0);
    for (std::size_t e = 0; e < tangent.size(); ++e) {
      a[tangent_slot_[e]] += tangent[e];
      if (symmetric_ && tangent_.row[e] != tangent_.column[e]) a[mirror_slot_[e]] += tangent[e];
    }
    for (std::size_t e = 0; e < jacobian_.size(); ++e) {
      if (place_of_[jacobian_.row[e]] < 0 || !held.holds(jacobian_.row[e])) continue;
      a[jacobian_slot_[e].first] += at.jacobian[e];
      a[jacobian_slot_[e].second] += at.jacobian[e];
    }
    for (int i = 0; i < n_; ++i) a[diagonal_slot_[i]] += shift;
    for (const int r : held.kept()) a[diagonal_slot_[place_of_[r]]] = held.holds(r) ? -relax : 1.0;
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
    for (std::size_t e = 0; e < tangent_.size(); ++e) both(tangent_.row[e], tangent_.column[e]);
    for (std::size_t e = 0; e < jacobian_.size(); ++e) {
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
  std::vector<int> place_of_;  // of a constraint row in the matrix, -1 where it is left out
  const Pattern& jacobian_;
  Eigen::MatrixXd full_;
  Eigen::PartialPivLU<Eigen::MatrixXd> full_lu_;
  Eigen::SparseMatrix<double> sparse_;
  // By columns of A + A^T: closures of long chains fill whole rows, which COLAMD, made for A^T A, takes badly.
  Eigen::SparseLU<Eigen::SparseMatrix<double>, Eigen::AMDOrdering<int>> sparse_lu_;
  std::vector<std::ptrdiff_t> tangent_slot_, mirror_slot_, diagonal_slot_;
  std::vector<std::pair<std::ptrdiff_t, std::ptrdiff_t>> jacobian_slot_;
};

class Run {
 public:
  Run(const Problem& problem, const AugmentedLagrangianOptions& options, const std::vector<int>& rows)
      : problem_(problem),
        options_(options),
        held_(problem, rows),
        factors_(problem, held_.kept()),
        now_(problem.make_evaluation()),
        trial_(problem.make_evaluation()),
        tangent_(problem.tangent_pattern().size()),
        no_multipliers_(problem.constraints(), 0.0),
        y_(problem.constraints(), 0.0),
        lambda_(y_),
        trial_lambda_(y_) {
    const auto n = problem.variables();
    right_.resize(n + static_cast<Eigen::Index>(held_.kept().size()));
    unbalanced_.resize(n);
    filter_.reserve(filter_size);
  }

  SearchResult solve(const std::vector<double>& start) {
    now_.x = start;
    problem_.evaluate(now_);
    result_.evaluations = 1;
    held_.hold_violated(now_, -options_.tolerance);
    const std::vector<double> y = least_squares_multipliers(problem_, now_, held_.rows());
    for (const int r : held_.rows()) lambda_[r] = y[r] / options_.multiplier_scale;
    search();
    result_.x = now_.x;
    measure(now_, lambda_);
    result_.multipliers = y_;
    return std::move(result_);
  }

 private:
  void search() {
    while (true) {
      measure(now_, lambda_);
      if (options_.interrupt != nullptr && options_.interrupt->load()) {
        result_.interrupted = true;
        return end("interrupted");
      }
      if (arrived()) {
        const HeldRows::Pulling pulling = held_.release_pulling(y_, options_.tolerance * force_scale_);
        if (pulling == HeldRows::Pulling::cycling) return end("an inequality is met and left again and again");
        if (pulling == HeldRows::Pulling::none) return judge();
        drop_multipliers();
        filter_.clear();
        continue;
      }
      if (result_.iterations == options_.iterations) return end("the iteration limit was reached");
      ++result_.iterations;
      if (!find_step()) return end("the tangent is singular");
      if (!advance()) return end("no step led any further");
      if (change_held()) filter_.clear();
    }
  }

  void judge() {
    const char* flaw = objection(now_, held_, y_, options_.tolerance);
    result_.claims_success = flaw == nullptr;
    end(flaw == nullptr ? "converged" : flaw);
  }

  void end(const char* how) {
    result_.status = options_.tangent == Tangent::newton ? "augmented Lagrangian: " : "modified augmented Lagrangian: ";
    result_.status += how;
  }

  // y = k lambda + p c, |F + J^T y| and |c| at an evaluated point.
  void measure(const Evaluation& at, const std::vector<double>& lambda) {
    for (const int r : held_.rows()) {
      y_[r] = options_.multiplier_scale * lambda[r] + options_.penalty * held_.gap(at, r);
    }
    unbalanced(problem_, at, y_, unbalanced_);
    force_ = largest(unbalanced_);
    gap_ = held_.largest_gap(at);
    force_scale_ = 1.0 + largest(at.gradient);
  }

  bool arrived() const { return gap_ <= options_.tolerance && force_ <= options_.tolerance * force_scale_; }

  // Violated stops join; one that pulls by more than what is out of balance leaves.
  bool change_held() {
    const bool joined = held_.hold_violated(now_, options_.tolerance);
    measure(now_, lambda_);
    const bool left =
        held_.release_pulling(y_, std::max(options_.tolerance * force_scale_, force_)) == HeldRows::Pulling::released;
    if (left) drop_multipliers();
    return joined || left;
  }

  void drop_multipliers() {
    for (const int r : held_.kept()) {
      if (!held_.holds(r)) lambda_[r] = y_[r] = 0.0;
    }
  }

  // The tangent [K + p J^T J, k J^T; k J, 0] (d, dlambda) = -(F + J^T y, k c) is solved as
  //   K d + J^T w = -(F + J^T y),  J d = -c,  k dlambda = w - p J d = w + p c:
  // J^T J would fill the matrix and square its condition.
  bool find_step() {
    problem_.tangent(now_, (options_.tangent == Tangent::newton ? y_ : no_multipliers_).data(), tangent_.data());
    const Eigen::Index n = problem_.variables();
    right_.setZero();
    for (Eigen::Index i = 0; i < n; ++i) right_[i] = -unbalanced_[i];
    const std::vector<int>& kept = held_.kept();
    for (std::size_t s = 0; s < kept.size(); ++s) {
      if (held_.holds(kept[s])) right_[n + static_cast<Eigen::Index>(s)] = -held_.gap(now_, kept[s]);
    }
    double shift = 0.0;
    for (int k = 0; k <= shifts; ++k) {
      if (factors_.factor(tangent_, now_, held_, shift) && factors_.solve(right_, step_)) return true;
      shift = k == 0 ? first_shift * (1.0 + largest(tangent_)) : 100.0 * shift;
    }
    return false;
  }

  // Takes the step, halved until the point is new. Where none is, residuals are in a dip that is no rest: the whole
  // step then jumps out of it, and the filter starts afresh.
  bool advance() {
    const double whole = std::min(1.0, longest_step / step_.head(problem_.variables()).cwiseAbs().maxCoeff());
    remember();
    double alpha = whole;
    for (int h = 0; h < halvings; ++h, alpha *= 0.5) {
      try_step(alpha);
      if (is_new()) return accept();
    }
    if (++bold_steps_taken_ > bold_steps) return false;
    filter_.clear();
    try_step(whole);
    return is_new() && accept();
  }

  void try_step(double alpha) {
    const Eigen::Index n = problem_.variables();
    for (Eigen::Index i = 0; i < n; ++i) trial_.x[i] = now_.x[i] + alpha * step_[i];
    const std::vector<int>& kept = held_.kept();
    for (std::size_t s = 0; s < kept.size(); ++s) {
      const int r = kept[s];
      const double w = step_[n + static_cast<Eigen::Index>(s)];
      const double change = held_.holds(r) ? w + options_.penalty * held_.gap(now_, r) : 0.0;
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

  void remember() {
    if (filter_.size() == filter_size) filter_.erase(filter_.begin());
    filter_.emplace_back((1.0 - filter_margin) * std::max(gap_, closed_within), (1.0 - filter_margin) * force_);
  }

  // A filter: better, in gap or in force, than every point left behind.
  bool is_new() const {
    if (!std::isfinite(gap_) || !std::isfinite(force_)) return false;
    const double gap = std::max(gap_, closed_within);
    return std::all_of(filter_.begin(), filter_.end(),
                       [&](const auto& left) { return gap <= left.first || force_ <= left.second; });
  }

  const Problem& problem_;
  const AugmentedLagrangianOptions& options_;
  HeldRows held_;
  SaddleFactors factors_;
  Evaluation now_, trial_;
  std::vector<double> tangent_, no_multipliers_, y_, lambda_, trial_lambda_, unbalanced_;
  Eigen::VectorXd right_, step_;
  double gap_ = 0.0, force_ = 0.0, force_scale_ = 1.0;  // of the point measured last
  std::vector<std::pair<double, double>> filter_;
  int bold_steps_taken_ = 0;
  SearchResult result_;
};

}  // namespace

SearchResult solve_with_augmented_lagrangian(const Problem& problem, const std::vector<double>& start,
                                             const AugmentedLagrangianOptions& options, const std::vector<int>& rows) {
  return Run(problem, options, rows).solve(start);
}

}  // namespace poise::solvers
