#include "solvers/complementarity.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Dense>

namespace poise::solvers {
namespace {

/// Columns of w_1 .. w_m, z_1 .. z_m, the artificial variable, and the right-hand side.
class Tableau {
 public:
  Tableau(const Eigen::MatrixXd& M, const Eigen::VectorXd& q)
      : m_(q.size()), t_(Eigen::MatrixXd::Zero(m_, 2 * m_ + 2)), basis_(static_cast<std::size_t>(m_)) {
    t_.leftCols(m_).setIdentity();
    t_.middleCols(m_, m_) = -M;
    t_.col(2 * m_).setConstant(-1.0);
    t_.col(2 * m_ + 1) = q;
    for (Eigen::Index i = 0; i < m_; ++i) basis_[static_cast<std::size_t>(i)] = i;
  }

  Eigen::Index artificial() const { return 2 * m_; }
  double value(Eigen::Index row) const { return t_(row, 2 * m_ + 1); }
  Eigen::Index basic(Eigen::Index row) const { return basis_[static_cast<std::size_t>(row)]; }

  /// The row that leaves where a column enters: the lexicographically least ratio; the artificial variable first among
  /// equals. -1 if none does.
  Eigen::Index leaving(Eigen::Index column) const {
    const double least_entry = 1e-12 * (1.0 + t_.col(column).cwiseAbs().maxCoeff());
    Eigen::Index best = -1;
    for (Eigen::Index i = 0; i < m_; ++i) {
      if (t_(i, column) <= least_entry) continue;
      if (best < 0 || is_before(i, best, column)) best = i;
    }
    return best;
  }

  void enter(Eigen::Index column, Eigen::Index row) {
    t_.row(row) /= t_(row, column);
    for (Eigen::Index i = 0; i < m_; ++i) {
      if (i != row && t_(i, column) != 0.0) t_.row(i) -= t_(i, column) * t_.row(row);
    }
    basis_[static_cast<std::size_t>(row)] = column;
  }

 private:
  bool is_before(Eigen::Index i, Eigen::Index k, Eigen::Index column) const {
    const auto ratio = [&](Eigen::Index row, Eigen::Index of) { return t_(row, of) / t_(row, column); };
    const double a = ratio(i, 2 * m_ + 1), b = ratio(k, 2 * m_ + 1);
    const double same = 1e-13 * (std::abs(a) + std::abs(b));
    if (std::abs(a - b) > same) return a < b;
    if (basic(i) == artificial()) return true;
    if (basic(k) == artificial()) return false;
    for (Eigen::Index j = 0; j < m_; ++j) {
      const double x = ratio(i, j), y = ratio(k, j);
      if (std::abs(x - y) > 1e-13 * (std::abs(x) + std::abs(y))) return x < y;
    }
    return false;
  }

  Eigen::Index m_;
  Eigen::MatrixXd t_;
  std::vector<Eigen::Index> basis_;
};

std::optional<Eigen::VectorXd> by_lemke(const Eigen::MatrixXd& M, const Eigen::VectorXd& q) {
  const Eigen::Index m = q.size();
  Eigen::VectorXd z = Eigen::VectorXd::Zero(m);
  Tableau tableau(M, q);
  Eigen::Index row = 0;
  q.minCoeff(&row);
  Eigen::Index left = tableau.basic(row);
  tableau.enter(tableau.artificial(), row);
  const Eigen::Index most = 50 * (m + 1);
  for (Eigen::Index k = 0; k < most && left != tableau.artificial(); ++k) {
    // The complement of what has left enters.
    const Eigen::Index column = left < m ? left + m : left - m;
    row = tableau.leaving(column);
    if (row < 0) return std::nullopt;
    left = tableau.basic(row);
    tableau.enter(column, row);
  }
  if (left != tableau.artificial()) return std::nullopt;
  for (Eigen::Index i = 0; i < m; ++i) {
    const Eigen::Index of = tableau.basic(i);
    if (of >= m && of < 2 * m) z[of - m] = std::max(0.0, tableau.value(i));
  }
  return z;
}

/// How far a solution is from one, over the largest of q: a large z whose terms cancel is none.
double residual(const Eigen::MatrixXd& M, const Eigen::VectorXd& q, const Eigen::VectorXd& z) {
  const Eigen::VectorXd w = M * z + q;
  const double size = q.cwiseAbs().maxCoeff();
  double worst = 0.0;
  for (Eigen::Index i = 0; i < q.size(); ++i) worst = std::max(worst, z[i] > 0.0 ? std::abs(w[i]) : -w[i]);
  return worst / size;
}

/// The solution whose z are zero where these are, to the digits of its equations: those of the method are of its
/// largest number. These z where rounding would make it none.
Eigen::VectorXd sharpened(const Eigen::MatrixXd& M, const Eigen::VectorXd& q, const Eigen::VectorXd& z) {
  std::vector<Eigen::Index> free;
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    if (z[i] > 0.0) free.push_back(i);
  }
  if (free.empty()) return z;
  const Eigen::VectorXd found = M(free, free).completeOrthogonalDecomposition().solve(-q(free));
  if (found.minCoeff() < 0.0) return z;
  Eigen::VectorXd out = Eigen::VectorXd::Zero(q.size());
  out(free) = found;
  return residual(M, q, out) <= residual(M, q, z) ? out : z;
}

/// The choice of the z that are not zero whose solution is one.
std::optional<Eigen::VectorXd> by_choices(const Eigen::MatrixXd& M, const Eigen::VectorXd& q, double within) {
  constexpr Eigen::Index most = 10;
  const Eigen::Index m = q.size();
  if (m > most) return std::nullopt;
  for (std::uint32_t choice = 1; choice < std::uint32_t{1} << m; ++choice) {
    std::vector<Eigen::Index> free;
    for (Eigen::Index i = 0; i < m; ++i) {
      if ((choice >> i & 1U) != 0) free.push_back(i);
    }
    const Eigen::VectorXd found = M(free, free).completeOrthogonalDecomposition().solve(-q(free));
    if (found.minCoeff() < 0.0) continue;
    Eigen::VectorXd z = Eigen::VectorXd::Zero(m);
    z(free) = found;
    if (residual(M, q, z) <= within) return z;
  }
  return std::nullopt;
}

}  // namespace

std::optional<Eigen::VectorXd> solve_complementarity(const Eigen::MatrixXd& M, const Eigen::VectorXd& q) {
  constexpr double within = 1e-9;
  if (q.size() == 0 || q.minCoeff() >= 0.0) return Eigen::VectorXd::Zero(q.size());
  if (const std::optional<Eigen::VectorXd> z = by_lemke(M, q); z && residual(M, q, *z) <= within) {
    return sharpened(M, q, *z);
  }
  return by_choices(M, q, within);
}

}  // namespace poise::solvers
