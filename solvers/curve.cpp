#include "solvers/curve.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SparseLU>

#include "solvers/linear_algebra.hpp"
#include "solvers/sparse_ldl.hpp"

namespace poise::solvers {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int most_corrections = 8;
constexpr int most_steps_on_sphere = 40;

}  // namespace

struct Curve::Factors {
  // Dense.
  MatrixXd matrix;
  Eigen::PartialPivLU<MatrixXd> lu;
  // Sparse, bordered by a unit row at `unit`.
  Eigen::SparseMatrix<double> sparse;
  std::vector<Eigen::Triplet<double>> triplets;
  Eigen::SparseLU<Eigen::SparseMatrix<double>> sparse_lu;
  int unit = -1, analysed = -1;
};

Curve::Curve(ParametricProblem& problem, std::vector<ActiveRow> active)
    : problem_(problem),
      active_(std::move(active)),
      place_(problem.rows(), -1),
      n_(problem.variables()),
      m_(static_cast<int>(active_.size())),
      size_(n_ + m_ + 1),
      dense_(size_ <= dense_limit),
      values_(problem.values()),
      by_p_(problem.values()),
      tangent_(problem.tangent_pattern().size()),
      y_(problem.rows(), 0.0),
      residual_(size_),
      step_(size_),
      right_(size_),
      row_(size_),
      factors_(std::make_unique<Factors>()) {
  for (int k = 0; k < m_; ++k) place_[active_[k].row] = k;
  if (dense_) factors_->matrix.resize(size_, size_);
}

Curve::~Curve() = default;

double Curve::dot(const VectorXd& a, const VectorXd& b) const {
  return a.head(n_).dot(b.head(n_)) + a[size_ - 1] * b[size_ - 1];
}

double Curve::norm(const VectorXd& a) const { return std::sqrt(dot(a, a)); }

void Curve::evaluate(const VectorXd& z, bool with_tangent) {
  ++evaluations_;
  const std::span<const double> x(z.data(), static_cast<std::size_t>(n_));
  const double p = z[size_ - 1];
  problem_.evaluate(x, p, values_, by_p_);
  for (int k = 0; k < m_; ++k) y_[active_[k].row] = z[n_ + k];
  if (with_tangent) problem_.tangent(x, p, y_, tangent_);
}

void Curve::residual(const VectorXd& z) {
  for (int i = 0; i < n_; ++i) residual_[i] = values_[i];
  const Pattern& pattern = problem_.jacobian_pattern();
  const double* jacobian = values_.data() + problem_.first_entry();
  for (int e = 0; e < pattern.size(); ++e) {
    const int k = place_[pattern.row[e]];
    if (k >= 0) residual_[pattern.column[e]] += jacobian[e] * z[n_ + k];
  }
  for (int k = 0; k < m_; ++k) {
    const auto [row, upper] = active_[k];
    residual_[n_ + k] = values_[problem_.first_row() + row];
    const int inequality = row - problem_.equalities();
    if (inequality < 0) continue;
    residual_[n_ + k] -= values_[(upper ? problem_.first_upper() : problem_.first_lower()) + inequality];
  }
  residual_[size_ - 1] = 0.0;
}

// put(row, column, value), values at the same place to be added.
template <class Put>
void Curve::entries(Put put) const {
  const int p = size_ - 1;
  const Pattern& k_pattern = problem_.tangent_pattern();
  const bool mirror = problem_.symmetric();
  for (int e = 0; e < k_pattern.size(); ++e) {
    const int i = k_pattern.row[e], j = k_pattern.column[e];
    put(i, j, tangent_[e]);
    if (mirror && i != j) put(j, i, tangent_[e]);
  }
  const Pattern& j_pattern = problem_.jacobian_pattern();
  const double* jacobian = values_.data() + problem_.first_entry();
  const double* jacobian_by = by_p_.data() + problem_.first_entry();
  for (int e = 0; e < j_pattern.size(); ++e) {
    const int k = place_[j_pattern.row[e]];
    if (k < 0) continue;
    const int i = j_pattern.column[e];
    put(n_ + k, i, jacobian[e]);
    put(i, n_ + k, jacobian[e]);
    if (jacobian_by[e] != 0.0) put(i, p, jacobian_by[e] * y_[j_pattern.row[e]]);
  }
  for (int i = 0; i < n_; ++i) put(i, p, by_p_[i]);
  for (int k = 0; k < m_; ++k) {
    const auto [row, upper] = active_[k];
    put(n_ + k, p, by_p_[problem_.first_row() + row]);
    const int inequality = row - problem_.equalities();
    if (inequality >= 0) put(n_ + k, p, -by_p_[(upper ? problem_.first_upper() : problem_.first_lower()) + inequality]);
  }
}

void Curve::fill(MatrixXd& matrix) const {
  matrix.setZero();
  entries([&](int i, int j, double value) { matrix(i, j) += value; });
}

bool Curve::factor(const VectorXd& row) {
  Factors& f = *factors_;
  if (dense_) {
    fill(f.matrix);
    f.matrix.row(size_ - 1) = row.transpose();
    f.lu.compute(f.matrix);
    const auto& diagonal = f.lu.matrixLU().diagonal();
    return (diagonal.array().abs() > 0.0).all() && std::isfinite(diagonal.sum());
  }
  Index unit = 0;
  row.cwiseAbs().maxCoeff(&unit);
  f.triplets.clear();
  entries([&](int i, int j, double value) { f.triplets.emplace_back(i, j, value); });
  f.triplets.emplace_back(size_ - 1, static_cast<int>(unit), 1.0);
  f.sparse.resize(size_, size_);
  f.sparse.setFromTriplets(f.triplets.begin(), f.triplets.end());
  f.unit = static_cast<int>(unit);
  if (f.analysed != f.unit) f.sparse_lu.analyzePattern(f.sparse);
  f.analysed = f.unit;
  f.sparse_lu.factorize(f.sparse);
  return f.sparse_lu.info() == Eigen::Success;
}

// Of the determinant of the bordered matrix.
int Curve::sign() const {
  Factors& f = *factors_;
  if (!dense_) return static_cast<int>(f.sparse_lu.signDeterminant());
  const auto& diagonal = f.lu.matrixLU().diagonal();
  int sign = static_cast<int>(f.lu.permutationP().determinant());
  for (Index i = 0; i < diagonal.size(); ++i) {
    if (diagonal[i] < 0.0) sign = -sign;
  }
  return sign;
}

void Curve::solve(VectorXd& b) {
  right_ = b;
  if (dense_) {
    b.noalias() = factors_->lu.solve(right_);
  } else {
    b = factors_->sparse_lu.solve(right_);
  }
}

Curve::Correction Curve::iterate(VectorXd& z, const VectorXd* row, const VectorXd* centre, double radius) {
  Correction out;
  double before = std::numeric_limits<double>::infinity();
  // On the sphere the start may be far from every curve.
  const int limit = centre != nullptr ? most_steps_on_sphere : most_corrections;
  for (out.steps = 1; out.steps <= limit; ++out.steps) {
    evaluate(z, true);
    residual(z);
    if (centre != nullptr) {
      row_ = z - *centre;
      row_.segment(n_, m_).setZero();
      residual_[size_ - 1] = 0.5 * (dot(row_, row_) - radius * radius);
    } else {
      row_ = *row;
    }
    if (!factor(row_)) return out;
    step_ = -residual_;
    solve(step_);
    const double length = norm(step_);
    if (out.steps == 1) out.first = length;
    if (!(length < farthest)) return out;
    z += step_;
    if (length <= small_step) {
      out.converged = true;
      return out;
    }
    if (length > 0.5 * before && centre == nullptr) {
      out.converged = length <= rounding_step;
      return out;
    }
    before = length;
  }
  return out;
}

Curve::Correction Curve::correct(VectorXd& z, const VectorXd& row) { return iterate(z, &row, nullptr, 0.0); }

Curve::Correction Curve::correct_on_sphere(VectorXd& z, const VectorXd& centre, double radius) {
  return iterate(z, nullptr, &centre, radius);
}

bool Curve::deflate(VectorXd& z, const std::vector<VectorXd>& known, int steps) {
  constexpr double longest = 0.5;
  const VectorXd row = VectorXd::Unit(size_, size_ - 1);
  for (int k = 0; k < steps; ++k) {
    evaluate(z, true);
    residual(z);
    if (!factor(row)) return false;
    step_ = -residual_;
    solve(step_);
    double along = 0.0;
    for (const VectorXd& other : known) {
      const VectorXd away = z.head(n_) - other.head(n_);
      const double square = away.squaredNorm();
      if (square == 0.0) return false;
      along -= 2.0 * away.dot(step_.head(n_)) / (square * (1.0 + square));
    }
    step_ /= 1.0 - along;
    const double length = step_.head(n_).norm();
    if (!std::isfinite(length)) return false;
    if (length > longest) step_ *= longest / length;
    z += step_;
    if (length <= small_step) return true;
  }
  return false;
}

bool Curve::differentiate(CurvePoint& point, const VectorXd& like) {
  point.tangent = VectorXd::Unit(size_, size_ - 1);
  solve(point.tangent);
  const double length = norm(point.tangent);
  if (!(length > 0.0) || !std::isfinite(length)) return false;
  point.tangent /= dot(point.tangent, like) < 0.0 ? -length : length;
  point.orientation = sign();
  if (!dense_ && point.tangent[factors_->unit] < 0.0) point.orientation = -point.orientation;
  return true;
}

bool Curve::differentiate_at(CurvePoint& point, const VectorXd& like) {
  evaluate(point.z, true);
  return factor(without_multipliers(like)) && differentiate(point, like);
}

void Curve::equations(const VectorXd& z, VectorXd& residual_out, MatrixXd& matrix) {
  evaluate(z, true);
  residual(z);
  residual_out = residual_.head(size_ - 1);
  matrix.resize(size_, size_);
  fill(matrix);
}

MatrixXd Curve::second(const VectorXd& z, const VectorXd& u) {
  const std::span<const double> x(z.data(), static_cast<std::size_t>(n_));
  evaluate(z, false);
  // y of rows along u.
  std::vector<double> v(problem_.rows(), 0.0), values(values_.size()), by_p(values_.size()), tangent(tangent_.size());
  for (int k = 0; k < m_; ++k) v[active_[k].row] = u[n_ + k];
  problem_.change(x, z[size_ - 1], y_, {u.data(), static_cast<std::size_t>(n_)}, v, u[size_ - 1], values, by_p,
                  tangent);
  // J_p^T y changes by J_p'^T y, which entries() counts, and by J_p^T v.
  VectorXd more = VectorXd::Zero(size_);
  const Pattern& pattern = problem_.jacobian_pattern();
  for (int e = 0; e < pattern.size(); ++e) {
    more[pattern.column[e]] += by_p_[problem_.first_entry() + e] * v[pattern.row[e]];
  }
  std::swap(values_, values);
  std::swap(by_p_, by_p);
  std::swap(tangent_, tangent);
  MatrixXd out(size_, size_);
  fill(out);
  out.col(size_ - 1) += more;
  std::swap(values_, values);
  std::swap(by_p_, by_p);
  std::swap(tangent_, tangent);
  return out;
}

// R(z + e t) - 2 R(z) + R(z - e t) = e^2 R'' t t, up to terms of order e^4.
void Curve::estimate_bend(CurvePoint& point) {
  constexpr double e = 1e-3;
  VectorXd& out = point.bend;
  evaluate(point.z, false);
  residual(point.z);
  out = 2.0 * residual_;
  for (const double side : {e, -e}) {
    step_ = point.z + side * point.tangent;
    evaluate(step_, false);
    residual(step_);
    out -= residual_;
  }
  out /= e * e;
  out[size_ - 1] = 0.0;
  solve(out);
  out -= dot(out, point.tangent) * point.tangent;
}

VectorXd Curve::bend(const CurvePoint& point) {
  VectorXd out = -(second(point.z, point.tangent) * point.tangent);
  out[size_ - 1] = 0.0;
  evaluate(point.z, true);
  if (!factor(without_multipliers(point.tangent))) return VectorXd::Zero(size_);
  solve(out);
  // Normal to the tangent, also where the sparse border is a unit row.
  out -= dot(out, point.tangent) * point.tangent;
  return out;
}

int Curve::negative_directions(const VectorXd& z) {
  evaluate(z, true);
  const int freedoms = n_ - m_;
  if (freedoms <= 0) return 0;
  const Pattern& k_pattern = problem_.tangent_pattern();
  const Pattern& j_pattern = problem_.jacobian_pattern();
  const double* jacobian = values_.data() + problem_.first_entry();
  if (!dense_ && problem_.symmetric()) {
    SparseLdl ldl;
    std::vector<int> row, column;
    std::vector<double> value;
    const auto put = [&](int i, int j, double v) {
      row.push_back(i);
      column.push_back(j);
      value.push_back(v);
    };
    for (int e = 0; e < k_pattern.size(); ++e) put(k_pattern.row[e], k_pattern.column[e], tangent_[e]);
    for (int e = 0; e < j_pattern.size(); ++e) {
      if (place_[j_pattern.row[e]] >= 0) put(n_ + place_[j_pattern.row[e]], j_pattern.column[e], jacobian[e]);
    }
    for (int k = 0; k < m_; ++k) put(n_ + k, n_ + k, 0.0);
    ldl.analyse(n_ + m_, row, column);
    std::fill(ldl.values().begin(), ldl.values().end(), 0.0);
    for (std::size_t e = 0; e < value.size(); ++e) ldl.values()[row[e]] += value[e];
    if (ldl.factor()) return ldl.negative() - m_;
    // Without pivoting a zero pivot ends it.
    if (size_ > spectrum_limit) return -1;
  }
  MatrixXd k = MatrixXd::Zero(n_, n_);
  for (int e = 0; e < k_pattern.size(); ++e) {
    k(k_pattern.row[e], k_pattern.column[e]) += tangent_[e];
    if (problem_.symmetric() && k_pattern.row[e] != k_pattern.column[e]) {
      k(k_pattern.column[e], k_pattern.row[e]) += tangent_[e];
    }
  }
  if (m_ > 0) {
    MatrixXd j = MatrixXd::Zero(n_, m_);
    for (int e = 0; e < j_pattern.size(); ++e) {
      if (place_[j_pattern.row[e]] >= 0) j(j_pattern.column[e], place_[j_pattern.row[e]]) += jacobian[e];
    }
    const MatrixXd z_basis =
        Eigen::HouseholderQR<MatrixXd>(j).householderQ() * MatrixXd::Identity(n_, n_).rightCols(freedoms);
    k = (z_basis.transpose() * k * z_basis).eval();
  }
  if (freedoms == 1) return k(0, 0) < 0.0 ? 1 : 0;
  if (problem_.symmetric()) {
    const VectorXd values = symmetric_eigenvalues<double>(k);
    return static_cast<int>((values.array() < 0.0).count());
  }
  const Eigenpairs pairs = eigenpairs(k);
  int negative = 0;
  for (Index i = 0; i < pairs.values.size(); ++i) {
    negative += pairs.values[i].imag() == 0.0 && pairs.values[i].real() < 0.0;
  }
  return negative;
}

void Curve::rooms(const CurvePoint& point, std::vector<Room>& out) {
  evaluate(point.z, false);
  const int count = problem_.inequalities();
  out.assign(count, {});
  const double p_rate = point.tangent[size_ - 1];
  for (int k = 0; k < count; ++k) {
    const int row = problem_.first_row() + problem_.equalities() + k;
    const int lower = problem_.first_lower() + k, upper = problem_.first_upper() + k;
    out[k].value = values_[row];
    out[k].rate = by_p_[row] * p_rate;
    out[k].lower = values_[row] - values_[lower];
    out[k].upper = values_[upper] - values_[row];
    out[k].lower_rate = (by_p_[row] - by_p_[lower]) * p_rate;
    out[k].upper_rate = (by_p_[upper] - by_p_[row]) * p_rate;
  }
  const Pattern& pattern = problem_.jacobian_pattern();
  for (int e = 0; e < pattern.size(); ++e) {
    const int k = pattern.row[e] - problem_.equalities();
    if (k < 0) continue;
    const double rate = values_[problem_.first_entry() + e] * point.tangent[pattern.column[e]];
    out[k].rate += rate;
    out[k].lower_rate += rate;
    out[k].upper_rate -= rate;
  }
}

bool Curve::depends_on_parameter(const VectorXd& z) {
  evaluate(z, false);
  return std::any_of(by_p_.begin(), by_p_.end(), [](double rate) { return rate != 0.0; });
}

double Curve::largest_left_out(const VectorXd& z) {
  evaluate(z, false);
  double largest = 0.0;
  for (int r = 0; r < problem_.equalities(); ++r) {
    if (place_[r] < 0) largest = std::max(largest, std::abs(values_[problem_.first_row() + r]));
  }
  return largest;
}

VectorXd Curve::without_multipliers(VectorXd z) const {
  z.segment(n_, m_).setZero();
  return z;
}

VectorXd Curve::parameter_sensitivity(const VectorXd& z, const VectorXd& row) {
  evaluate(z, true);
  MatrixXd a(size_, size_);
  fill(a);
  a.row(size_ - 1) = row.transpose();
  return FullyPivotedLu(a.transpose()).solve(VectorXd(VectorXd::Unit(size_, size_ - 1)));
}

VectorXd Curve::gap_gradient(const VectorXd& z, int inequality, bool upper) {
  evaluate(z, false);
  VectorXd out = VectorXd::Zero(size_);
  const int row = problem_.equalities() + inequality;
  const Pattern& pattern = problem_.jacobian_pattern();
  for (int e = 0; e < pattern.size(); ++e) {
    if (pattern.row[e] == row) out[pattern.column[e]] += values_[problem_.first_entry() + e];
  }
  out[size_ - 1] =
      by_p_[problem_.first_row() + row] - by_p_[(upper ? problem_.first_upper() : problem_.first_lower()) + inequality];
  return out;
}

MatrixXd Curve::null_vectors(const VectorXd& z, double tolerance, int least, const VectorXd* along) {
  const double rate = along != nullptr ? second(z, *along).norm() / along->norm() : 0.0;
  evaluate(z, true);
  MatrixXd a(size_, size_);
  fill(a);
  const SingularValues svd = singular_value_decomposition(a);
  const double limit = tolerance * std::max(svd.values[0], rate);
  const Index rank = std::min<Index>((svd.values.array() >= limit).count(), size_ - least);
  return svd.right.rightCols(size_ - rank);
}

double Curve::find_branch_point(VectorXd& z) {
  constexpr int most_iterations = 12;
  double last = std::numeric_limits<double>::infinity();
  evaluate(z, true);
  MatrixXd a(size_, size_);
  fill(a);
  // Borders near the null spaces, kept throughout.
  const SingularValues svd = singular_value_decomposition(a.topRows(size_ - 1));
  const MatrixXd phi = svd.right.rightCols(2);
  const VectorXd psi = svd.left.col(size_ - 2);
  double b = 0.0;
  for (int k = 0; k < most_iterations; ++k) {
    evaluate(z, true);
    residual(z);
    fill(a);
    // [A psi; phi^T 0] (V; g) = (0; I),  (W^T, h) [A psi; phi^T 0] = (0, 1).
    MatrixXd bordered = MatrixXd::Zero(size_ + 1, size_ + 1);
    bordered.topLeftCorner(size_ - 1, size_) = a.topRows(size_ - 1);
    bordered.col(size_).head(size_ - 1) = psi;
    bordered.block(size_ - 1, 0, 2, size_) = phi.transpose();
    const FullyPivotedLu lu(bordered);
    MatrixXd rhs = MatrixXd::Zero(size_ + 1, 2);
    rhs.bottomRows(2).setIdentity();
    const MatrixXd v = lu.solve(rhs);
    const MatrixXd bordered_t = bordered.transpose();
    const VectorXd w = FullyPivotedLu(bordered_t).solve(VectorXd(VectorXd::Unit(size_ + 1, size_)));
    MatrixXd newton = MatrixXd::Zero(size_ + 1, size_ + 1);
    newton.topLeftCorner(size_ - 1, size_) = a.topRows(size_ - 1);
    newton.col(size_).head(size_ - 1) = psi;
    VectorXd right(size_ + 1);
    right.head(size_ - 1) = -(residual_.head(size_ - 1) + b * psi);
    for (int j = 0; j < 2; ++j) {
      // dg_j along d is  -w^T (dA along d) v_j = -w^T (second derivative along v_j) d.
      const MatrixXd along = second(z, v.col(j).head(size_));
      newton.row(size_ - 1 + j).head(size_) = -(w.head(size_ - 1).transpose() * along.topRows(size_ - 1));
      right[size_ - 1 + j] = -v(size_, j);
    }
    const VectorXd d = FullyPivotedLu(newton).solve(right);
    const double length = norm(d.head(size_));
    if (!(length < farthest)) return std::numeric_limits<double>::infinity();
    z += d.head(size_);
    b += d[size_];
    // Quadratic convergence ends in rounding.
    if (length <= 1e-14 || (length <= rounding_step && length > 0.5 * last)) return std::min(last, length);
    last = length;
  }
  return last;
}

}  // namespace poise::solvers
