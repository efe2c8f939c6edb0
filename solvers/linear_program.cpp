#include "solvers/linear_program.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace poise::solvers {
namespace {

using Real = long double;
using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

// Coefficients of order one have this rounding after some hundred pivots; it is larger where long double is no longer
// than double.
constexpr Real pivot_rounding = std::max(1e-14L, 9e4L * std::numeric_limits<Real>::epsilon());
constexpr Real no_slope = 1e-10L;  // of an objective along a ray
constexpr int most_pivots = 5000;
constexpr int steps_before_bland = 200;

/// basic = constant + coefficients * nonbasic, for variables numbered: x, then the slacks of the rows, then the
/// artificial one.
class Dictionary {
 public:
  explicit Dictionary(const LinearProgram& p)
      : free_(p.rows.cols()), slacks_(p.rows.rows()), table_(Matrix::Zero(slacks_ + 1, free_ + 2)), scale_(slacks_) {
    for (Eigen::Index i = 0; i < slacks_; ++i) {
      const double largest = free_ > 0 ? p.rows.row(i).cwiseAbs().maxCoeff() : 0.0;
      scale_[i] = largest > 0 ? 1.0L / largest : 1.0L;
      for (Eigen::Index j = 0; j < free_; ++j) table_(i, j) = -scale_[i] * static_cast<Real>(p.rows(i, j));
      table_(i, constant()) = scale_[i] * static_cast<Real>(p.bounds[i]);
      basic_.push_back(free_ + i);
    }
    for (Eigen::Index j = 0; j < free_; ++j) nonbasic_.push_back(j);
    nonbasic_.push_back(artificial());
    objective_ = p.objective.cast<Real>();
  }

  LinearProgramResult run() {
    LinearProgramResult out;
    free_first();
    if (!find_feasible(out)) return out;
    table_.col(column_of_artificial()).setZero();
    set_objective();
    optimise(out);
    return out;
  }

 private:
  Eigen::Index constant() const { return free_ + 1; }
  Eigen::Index artificial() const { return free_ + slacks_; }
  Eigen::Index last() const { return slacks_; }  // row of the objective
  bool is_free(Eigen::Index variable) const { return variable < free_; }

  Eigen::Index column_of_artificial() const {
    for (std::size_t j = 0; j < nonbasic_.size(); ++j) {
      if (nonbasic_[j] == artificial()) return static_cast<Eigen::Index>(j);
    }
    return -1;
  }

  // Variables of any sign become basic, and stay so. One that no row has stays zero.
  void free_first() {
    for (Eigen::Index j = 0; j < free_; ++j) {
      Eigen::Index best = -1;
      Real largest = 1e-11L;
      for (Eigen::Index i = 0; i < slacks_; ++i) {
        if (is_free(basic_[static_cast<std::size_t>(i)]) || std::abs(table_(i, j)) <= largest) continue;
        largest = std::abs(table_(i, j));
        best = i;
      }
      if (best >= 0) {
        pivot(best, j);
      } else {
        for (Eigen::Index i = 0; i < slacks_; ++i) {
          if (!is_free(basic_[static_cast<std::size_t>(i)])) table_(i, j) = 0.0L;
        }
      }
    }
  }

  void pivot(Eigen::Index row, Eigen::Index column) {
    const Real p = table_(row, column);
    std::swap(basic_[static_cast<std::size_t>(row)], nonbasic_[static_cast<std::size_t>(column)]);
    // entering = (leaving - rest) / p
    table_.row(row) /= -p;
    table_(row, column) = 1.0L / p;
    for (Eigen::Index i = 0; i < table_.rows(); ++i) {
      if (i == row) continue;
      const Real factor = table_(i, column);
      if (factor == 0.0L) continue;
      table_(i, column) = 0.0L;
      table_.row(i) += factor * table_.row(row);
    }
  }

  // First phase: least artificial variable that makes all slacks non-negative.
  bool find_feasible(LinearProgramResult& out) {
    const Eigen::Index column = column_of_artificial();
    Eigen::Index worst = -1;
    for (Eigen::Index i = 0; i < slacks_; ++i) {
      if (is_free(basic_[static_cast<std::size_t>(i)])) continue;
      table_(i, column) = 1.0L;
      if (table_(i, constant()) < (worst < 0 ? 0.0L : table_(worst, constant()))) worst = i;
    }
    if (worst < 0) return true;
    table_.row(last()).setZero();
    table_(last(), column) = -1.0L;
    pivot(worst, column);
    if (!climb()) return false;
    // The artificial variable is basic still: zero but for rounding, or the program is infeasible.
    for (Eigen::Index i = 0; i < slacks_; ++i) {
      if (basic_[static_cast<std::size_t>(i)] != artificial()) continue;
      if (table_(i, constant()) > pivot_rounding * 10) {
        out.status = LinearProgramResult::Status::infeasible;
        out.multipliers = Eigen::VectorXd::Zero(slacks_);
        add_multipliers(out.multipliers);
        return false;
      }
      Eigen::Index best = -1;
      Real largest = 0.0L;
      for (Eigen::Index j = 0; j <= free_; ++j) {
        if (is_free(nonbasic_[static_cast<std::size_t>(j)]) || std::abs(table_(i, j)) <= largest) continue;
        largest = std::abs(table_(i, j));
        best = j;
      }
      if (best >= 0) pivot(i, best);
      break;
    }
    return true;
  }

  void set_objective() {
    table_.row(last()).setZero();
    for (Eigen::Index v = 0; v < free_; ++v) {
      const Real c = objective_[v];
      if (c == 0.0L) continue;
      for (std::size_t j = 0; j < nonbasic_.size(); ++j) {
        if (nonbasic_[j] == v) table_(last(), static_cast<Eigen::Index>(j)) += c;
      }
      for (std::size_t i = 0; i < basic_.size(); ++i) {
        if (basic_[i] == v) table_.row(last()) += c * table_.row(static_cast<Eigen::Index>(i));
      }
    }
  }

  bool enters(Eigen::Index j, bool second_phase) const {
    const Eigen::Index variable = nonbasic_[static_cast<std::size_t>(j)];
    if (is_free(variable) || (second_phase && variable == artificial())) return false;
    return table_(last(), j) > pivot_rounding && is_flat_[static_cast<std::size_t>(j)] == 0;
  }

  // Steps up the objective in the last row; false where it is unbounded (`ray_`) or does not end.
  bool climb(bool second_phase = false) {
    is_flat_.assign(nonbasic_.size(), 0);
    for (int step = 0; step < most_pivots; ++step) {
      Eigen::Index column = -1;
      for (Eigen::Index j = 0; j <= free_; ++j) {
        if (!enters(j, second_phase)) continue;
        if (column < 0) {
          column = j;
          continue;
        }
        const bool better = step < steps_before_bland
                                ? table_(last(), j) > table_(last(), column)
                                : nonbasic_[static_cast<std::size_t>(j)] < nonbasic_[static_cast<std::size_t>(column)];
        if (better) column = j;
      }
      if (column < 0) return true;
      Eigen::Index row = -1;
      Real least = 0.0L;
      for (Eigen::Index i = 0; i < slacks_; ++i) {
        if (is_free(basic_[static_cast<std::size_t>(i)]) || table_(i, column) > -1e-13L) continue;
        const Real ratio = std::max(table_(i, constant()), 0.0L) / -table_(i, column);
        if (row < 0 || ratio < least || (ratio == least && takes_precedence(i, row, column, step))) {
          row = i;
          least = ratio;
        }
      }
      if (row < 0 && table_(last(), column) <= no_slope) {
        is_flat_[static_cast<std::size_t>(column)] = 1;
        continue;
      }
      if (row < 0) {
        ray_ = column;
        return false;
      }
      pivot(row, column);
    }
    return false;
  }

  bool takes_precedence(Eigen::Index i, Eigen::Index row, Eigen::Index column, int step) const {
    if (basic_[static_cast<std::size_t>(row)] == artificial()) return false;
    if (basic_[static_cast<std::size_t>(i)] == artificial()) return true;
    if (step >= steps_before_bland) return basic_[static_cast<std::size_t>(i)] < basic_[static_cast<std::size_t>(row)];
    return table_(i, column) < table_(row, column);
  }

  void add_multipliers(Eigen::VectorXd& z) const {
    for (std::size_t j = 0; j < nonbasic_.size(); ++j) {
      const Eigen::Index variable = nonbasic_[j];
      if (is_free(variable) || variable == artificial()) continue;
      const Real price = -table_(last(), static_cast<Eigen::Index>(j));
      const Eigen::Index row = variable - free_;
      if (price > 0.0L) z[row] = static_cast<double>(price * scale_[row]);
    }
  }

  void optimise(LinearProgramResult& out) {
    using Status = LinearProgramResult::Status;
    // A variable that no row has, and that the objective has.
    for (std::size_t j = 0; j < nonbasic_.size(); ++j) {
      const Real slope = table_(last(), static_cast<Eigen::Index>(j));
      if (!is_free(nonbasic_[j]) || std::abs(slope) <= 1e-11L) continue;
      set_point(out.x);
      set_ray(static_cast<Eigen::Index>(j), slope > 0 ? 1.0L : -1.0L, out.ray);
      out.status = Status::unbounded;
      return;
    }
    const bool ended = climb(true);
    set_point(out.x);
    if (ended) {
      out.status = Status::optimal;
      out.multipliers = Eigen::VectorXd::Zero(slacks_);
      add_multipliers(out.multipliers);
    } else if (ray_ >= 0) {
      out.status = Status::unbounded;
      set_ray(ray_, 1.0L, out.ray);
    }
  }

  void set_point(Eigen::VectorXd& x) const {
    x = Eigen::VectorXd::Zero(free_);
    for (std::size_t i = 0; i < basic_.size(); ++i) {
      if (is_free(basic_[i])) x[basic_[i]] = static_cast<double>(table_(static_cast<Eigen::Index>(i), constant()));
    }
  }

  void set_ray(Eigen::Index column, Real sign, Eigen::VectorXd& ray) const {
    ray = Eigen::VectorXd::Zero(free_);
    const Eigen::Index variable = nonbasic_[static_cast<std::size_t>(column)];
    if (is_free(variable)) ray[variable] = static_cast<double>(sign);
    for (std::size_t i = 0; i < basic_.size(); ++i) {
      if (is_free(basic_[i])) ray[basic_[i]] = static_cast<double>(sign * table_(static_cast<Eigen::Index>(i), column));
    }
  }

  Eigen::Index free_, slacks_;
  Matrix table_;
  Vector scale_, objective_;
  std::vector<Eigen::Index> basic_, nonbasic_;
  std::vector<char> is_flat_;  // per column: its slope is rounding
  Eigen::Index ray_ = -1;
};

}  // namespace

LinearProgramResult solve(const LinearProgram& program) { return Dictionary(program).run(); }

}  // namespace poise::solvers
