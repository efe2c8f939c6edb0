#pragma once

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace poise {

/// LU factors of a small dense square matrix with row pivoting, kept in place: nothing allocates after resize(), as the
/// innermost loop of a simulation requires.
template <class T>
class SmallLu {
 public:
  void resize(int n) {
    n_ = n;
    a_.resize(static_cast<std::size_t>(n) * n);
    swapped_.resize(n);
  }
  int size() const { return n_; }
  /// The matrix to factor, row by row.
  T* matrix() { return a_.data(); }

  /// Factors matrix(); returns the smallest pivot relative to the largest entry of its column of the matrix: 0 if the
  /// matrix is singular, 1 for an orthogonal diagonal one.
  T factor() {
    using std::abs;
    T worst(1);
    for (int k = 0; k < n_; ++k) {
      int p = k;
      T column(0);
      for (int i = 0; i < n_; ++i) {
        const T size = abs(at(i, k));
        if (size > column) column = size;
        if (i > k && size > abs(at(p, k))) p = i;
      }
      swapped_[k] = p;
      if (p != k) {
        for (int j = 0; j < n_; ++j) std::swap(at(k, j), at(p, j));
      }
      const T pivot = at(k, k);
      if (pivot == 0) return T(0);
      const T ratio = abs(pivot) / column;
      if (ratio < worst) worst = ratio;
      for (int i = k + 1; i < n_; ++i) {
        T& l = at(i, k);
        if (l == 0) continue;
        l /= pivot;
        for (int j = k + 1; j < n_; ++j) at(i, j) -= l * at(k, j);
      }
    }
    return worst;
  }

  /// b <- A^-1 b.
  void solve(T* b) const {
    for (int k = 0; k < n_; ++k) {
      if (swapped_[k] != k) std::swap(b[k], b[swapped_[k]]);
    }
    for (int i = 1; i < n_; ++i) {
      for (int j = 0; j < i; ++j) b[i] -= at(i, j) * b[j];
    }
    for (int i = n_ - 1; i >= 0; --i) {
      for (int j = i + 1; j < n_; ++j) b[i] -= at(i, j) * b[j];
      b[i] /= at(i, i);
    }
  }

  /// b <- A^-T b.
  void solve_transposed(T* b) const {
    for (int i = 0; i < n_; ++i) {
      for (int j = 0; j < i; ++j) b[i] -= at(j, i) * b[j];
      b[i] /= at(i, i);
    }
    for (int i = n_ - 2; i >= 0; --i) {
      for (int j = i + 1; j < n_; ++j) b[i] -= at(j, i) * b[j];
    }
    for (int k = n_ - 1; k >= 0; --k) {
      if (swapped_[k] != k) std::swap(b[k], b[swapped_[k]]);
    }
  }

 private:
  T& at(int i, int j) { return a_[static_cast<std::size_t>(i) * n_ + j]; }
  const T& at(int i, int j) const { return a_[static_cast<std::size_t>(i) * n_ + j]; }

  int n_ = 0;
  std::vector<T> a_;
  std::vector<int> swapped_;
};

}  // namespace poise
