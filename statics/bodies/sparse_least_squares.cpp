#include "statics/bodies/sparse_least_squares.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace poise {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

constexpr double relax = 1e-12;
constexpr int refinements = 20;
constexpr int projections = 4;
constexpr double unmet = 1e-9;  // relative to the right-hand side
constexpr double smallest_singular_value = 1e-6;
constexpr double probe_takes_part = 1e-6;  // of a probe of order one
constexpr int long_column = 32;            // entries

// Calls visit(i, j, value) for one triangle of the matrix to be factored, duplicate entries one by one.
template <class Visit>
void for_each_entry(const Sparse& a, double shift, Visit visit) {
  const int rows = static_cast<int>(a.rows());
  int extra = rows;
  for (Eigen::Index c = 0; c < a.outerSize(); ++c) {
    if (a.innerVector(c).nonZeros() > long_column) {
      visit(extra, extra, -1.0);
      for (Sparse::InnerIterator i(a, c); i; ++i) visit(extra, static_cast<int>(i.row()), i.value());
      ++extra;
      continue;
    }
    for (Sparse::InnerIterator i(a, c); i; ++i) {
      for (Sparse::InnerIterator j(a, c); j && j.row() <= i.row(); ++j) {
        visit(static_cast<int>(i.row()), static_cast<int>(j.row()), i.value() * j.value());
      }
    }
  }
  for (int i = 0; i < rows; ++i) visit(i, i, shift);
}

// The same random numbers of order one for every call.
Eigen::VectorXd probe(Eigen::Index size) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(0.5, 1.5);
  return Eigen::VectorXd::NullaryExpr(size, [&] { return uniform(random); });
}

TouchedNullSpace touched(const Eigen::VectorXd& part) {
  TouchedNullSpace out;
  for (const double p : part) out.touches.push_back(std::abs(p) > probe_takes_part);
  return out;
}

bool is_empty(const TouchedNullSpace& null) {
  return std::find(null.touches.begin(), null.touches.end(), true) == null.touches.end();
}

}  // namespace

SparseLeastSquares::SparseLeastSquares(const Sparse& a) : a_(a) {
  even_rows();
  analyse();
  factor(relax);
}

void SparseLeastSquares::even_rows() {
  scale_ = Eigen::VectorXd::Zero(a_.rows());
  for (Eigen::Index c = 0; c < a_.outerSize(); ++c) {
    for (Sparse::InnerIterator i(a_, c); i; ++i) scale_[i.row()] += i.value() * i.value();
    long_columns_ += a_.innerVector(c).nonZeros() > long_column;
  }
  for (double& s : scale_) s = s > 0 ? 1.0 / std::sqrt(s) : 1.0;
  for (Eigen::Index c = 0; c < a_.outerSize(); ++c) {
    for (Sparse::InnerIterator i(a_, c); i; ++i) i.valueRef() *= scale_[i.row()];
  }
}

void SparseLeastSquares::analyse() {
  std::size_t entries = 0;
  for_each_entry(a_, relax, [&](int, int, double) { ++entries; });
  std::vector<int> column;
  target_.reserve(entries);
  column.reserve(entries);
  for_each_entry(a_, relax, [&](int i, int j, double) {
    target_.push_back(i);
    column.push_back(j);
  });
  const auto size = static_cast<std::size_t>(a_.rows()) + static_cast<std::size_t>(long_columns_);
  factors_.analyse(static_cast<int>(size), target_, column);
  right_.resize(size);
}

void SparseLeastSquares::factor(double shift) {
  std::vector<double>& values = factors_.values();
  std::fill(values.begin(), values.end(), 0.0);
  const int* target = target_.data();
  for_each_entry(a_, shift, [&](int, int, double value) { values[*target++] += value; });
  factors_.factor();
}

// b = (A A^T + e I)^-1 b
void SparseLeastSquares::apply_inverse(Eigen::VectorXd& b) {
  std::fill(right_.begin(), right_.end(), 0.0);
  std::copy(b.begin(), b.end(), right_.begin());
  factors_.solve(right_);
  std::copy(right_.begin(), right_.begin() + b.size(), b.begin());
}

Eigen::VectorXd SparseLeastSquares::solve(const Eigen::VectorXd& b) { return solve_even(scale_.cwiseProduct(b)); }

Eigen::VectorXd SparseLeastSquares::solve_even(const Eigen::VectorXd& b) {
  Eigen::VectorXd left = b;
  Eigen::VectorXd x = refine(left);
  if (left.cwiseAbs().maxCoeff() <= unmet * b.cwiseAbs().maxCoeff()) return x;
  // The part of b that no x can satisfy becomes so large in the inverse that its rounding matters: it is removed and
  // the system solved once more.
  project(left);
  left = b - left;
  return refine(left);
}

// Every term of x is A^T times a vector, and so is orthogonal to the null space. Leaves b - A x in b.
Eigen::VectorXd SparseLeastSquares::refine(Eigen::VectorXd& b) {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(a_.cols());
  Eigen::VectorXd inverse, step;
  double last = std::numeric_limits<double>::infinity();
  for (int k = 0; k < refinements; ++k) {
    inverse = b;
    apply_inverse(inverse);
    step = a_.transpose() * inverse;
    const double length = step.cwiseAbs().maxCoeff();
    if (!(length < 0.5 * last)) break;
    last = length;
    x += step;
    b -= a_ * step;
    if (length <= std::numeric_limits<double>::epsilon() * x.cwiseAbs().maxCoeff()) break;
  }
  return x;
}

// e (A A^T + e I)^-1 leaves the null space of A^T unchanged, and reduces all other components.
void SparseLeastSquares::project(Eigen::VectorXd& b) {
  for (int k = 0; k < projections; ++k) {
    apply_inverse(b);
    b *= relax;
  }
}

// Number of singular values of A below 1e-6, as many in all as it has rows: A A^T - t I has a negative eigenvalue for
// each.
int SparseLeastSquares::count_small() {
  factor(-smallest_singular_value * smallest_singular_value);
  const int count = factors_.negative() - long_columns_;
  factor(relax);
  return count;
}

// The projection of a random vector has a component in every unknown that takes part in the null space.
TouchedNullSpace SparseLeastSquares::null_space() {
  const Eigen::VectorXd any = probe(a_.cols());
  TouchedNullSpace out = touched(any - solve_even(a_ * any));
  if (!is_empty(out)) out.dimension = static_cast<int>(a_.cols() - a_.rows()) + count_small();
  return out;
}

TouchedNullSpace SparseLeastSquares::left_null_space() {
  Eigen::VectorXd part = probe(a_.rows());
  project(part);
  TouchedNullSpace out = touched(part);
  if (!is_empty(out)) out.dimension = count_small();
  return out;
}

}  // namespace poise
