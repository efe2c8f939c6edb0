#pragma once

#include <cstddef>
#include <vector>

#include "solvers/interval.hpp"

namespace poise {

using solvers::Interval;

// Sums and dense matrices of intervals. They need solvers::RoundingUp.

/// Row by row.
struct IntervalMatrix {
  IntervalMatrix(std::size_t r, std::size_t c) : rows(r), columns(c), entries(r * c, Interval(0)) {}
  Interval& operator()(std::size_t i, std::size_t j) { return entries[i * columns + j]; }
  const Interval& operator()(std::size_t i, std::size_t j) const { return entries[i * columns + j]; }

  std::size_t rows, columns;
  std::vector<Interval> entries;
};

/// Adds factor a to a sum.
inline void add_product(Interval& sum, double factor, const Interval& a) {
  if (factor >= 0)
    sum = Interval::from(sum.minus_lower() + factor * a.minus_lower(), sum.upper() + factor * a.upper());
  else
    sum = Interval::from(sum.minus_lower() + -factor * a.upper(), sum.upper() + -factor * a.minus_lower());
}

inline IntervalMatrix product(const IntervalMatrix& a, const IntervalMatrix& b) {
  IntervalMatrix out(a.rows, b.columns);
  for (std::size_t i = 0; i < a.rows; ++i) {
    for (std::size_t k = 0; k < a.columns; ++k) {
      for (std::size_t j = 0; j < b.columns; ++j) out(i, j) += a(i, k) * b(k, j);
    }
  }
  return out;
}

inline IntervalMatrix transposed(const IntervalMatrix& a) {
  IntervalMatrix out(a.columns, a.rows);
  for (std::size_t i = 0; i < a.rows; ++i) {
    for (std::size_t j = 0; j < a.columns; ++j) out(j, i) = a(i, j);
  }
  return out;
}

/// Gaussian elimination of the first `c` columns, with the pivot of a column in the row where it is furthest from zero;
/// `done` marks these rows. False if a column has none.
inline bool eliminate(IntervalMatrix& a, std::size_t c, std::vector<char>& done) {
  done.assign(a.rows, 0);
  for (std::size_t k = 0; k < c; ++k) {
    std::size_t pivot = a.rows;
    double most = 0.0;
    for (std::size_t i = 0; i < a.rows; ++i) {
      if (done[i] != 0 || !(a(i, k).mignitude() > most)) continue;
      most = a(i, k).mignitude();
      pivot = i;
    }
    if (pivot == a.rows) return false;
    done[pivot] = 1;
    for (std::size_t i = 0; i < a.rows; ++i) {
      if (done[i] != 0) continue;
      const Interval factor = a(i, k) / a(pivot, k);
      for (std::size_t j = k + 1; j < a.columns; ++j) a(i, j) -= factor * a(pivot, j);
    }
  }
  return true;
}

}  // namespace poise
