#include "solvers/quintic_spline.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace poise::solvers {
namespace {

constexpr std::size_t degree = 5;
constexpr std::size_t order = degree + 1;
using Row = std::array<double, order>;

/// The B-splines of degree 5 on some breaks, with the ends as knots of multiplicity 6 (C. de Boor, A Practical Guide to
/// Splines, 2001, chapters IX and X).
class BSplines {
 public:
  explicit BSplines(const std::vector<double>& breaks) {
    knots_.assign(degree, breaks.front());
    knots_.insert(knots_.end(), breaks.begin(), breaks.end());
    knots_.insert(knots_.end(), degree, breaks.back());
  }

  std::size_t count() const { return knots_.size() - order; }

  /// The interval that contains t, by the knot it begins at; the six B-splines that are not zero there are
  /// interval - 5 ... interval.
  std::size_t interval(double t) const {
    const auto last = knots_.end() - static_cast<std::ptrdiff_t>(order);
    const auto after = std::upper_bound(knots_.begin() + degree + 1, last, t);
    return static_cast<std::size_t>(after - knots_.begin()) - 1;
  }

  /// Their values at t by the recurrence of Cox and de Boor.
  Row values(std::size_t interval, double t) const {
    Row b{1.0};
    for (std::size_t k = 1; k <= degree; ++k) {
      double carried = 0.0;
      for (std::size_t i = 0; i < k; ++i) {
        const double right = knots_[interval + 1 + i];
        const double left = knots_[interval + 1 + i - k];
        const double part = b[i] / (right - left);
        b[i] = carried + (right - t) * part;
        carried = (t - left) * part;
      }
      b[k] = carried;
    }
    return b;
  }

  /// The polynomial of an interval about its beginning, from the coefficients of the B-splines.
  Row polynomial(std::size_t interval, const std::vector<double>& coefficients) const {
    Row c;
    for (std::size_t i = 0; i < order; ++i) c[i] = coefficients[interval - degree + i];
    const double t = knots_[interval];
    Row out;
    double factorial = 1.0;
    for (std::size_t d = 0; d <= degree; ++d) {
      // The d-th derivative is a spline of degree 5 - d with the coefficients c; de Boor's algorithm evaluates it.
      Row point = c;
      const std::size_t left = degree - d;
      for (std::size_t k = 1; k <= left; ++k) {
        for (std::size_t i = left; i >= k; --i) {
          const double from = knots_[interval - left + i];
          const double to = knots_[interval + 1 + i - k];
          const double part = (t - from) / (to - from);
          point[i] = (1 - part) * point[i - 1] + part * point[i];
        }
      }
      out[d] = point[left] / factorial;
      factorial *= static_cast<double>(d + 1);
      for (std::size_t i = 0; i < left; ++i) {
        const double width = knots_[interval + 1 + i] - knots_[interval + 1 + i - left];
        c[i] = static_cast<double>(left) * (c[i + 1] - c[i]) / width;
      }
    }
    return out;
  }

  const std::vector<double>& knots() const { return knots_; }

 private:
  std::vector<double> knots_;
};

/// Least squares with six consecutive entries in each row, by Givens rotations into a banded triangle.
class BandedLeastSquares {
 public:
  explicit BandedLeastSquares(std::size_t columns) : triangle_(columns), right_(columns, 0.0) {
    for (Row& row : triangle_) row.fill(0.0);
  }

  void add(std::size_t first, Row row, double value) {
    for (std::size_t column = first; column < std::min(first + order, triangle_.size()); ++column) {
      Row& above = triangle_[column];
      const double length = std::hypot(above[0], row[0]);
      if (length > 0.0) {
        const double c = above[0] / length;
        const double s = row[0] / length;
        for (std::size_t i = 0; i < order; ++i) {
          const double upper = above[i];
          above[i] = c * upper + s * row[i];
          row[i] = c * row[i] - s * upper;
        }
        const double upper = right_[column];
        right_[column] = c * upper + s * value;
        value = c * value - s * upper;
      }
      std::rotate(row.begin(), row.begin() + 1, row.end());
      row[degree] = 0.0;
    }
    rest_ += value * value;
  }

  /// Sum of the squared residuals.
  double rest() const { return rest_; }

  std::vector<double> solve() const {
    std::vector<double> x = right_;
    for (std::size_t i = x.size(); i-- > 0;) {
      for (std::size_t j = 1; j < order && i + j < x.size(); ++j) x[i] -= triangle_[i][j] * x[i + j];
      x[i] /= triangle_[i][0];
    }
    return x;
  }

 private:
  std::vector<Row> triangle_;
  std::vector<double> right_;
  double rest_ = 0.0;
};

BandedLeastSquares fitted(const BSplines& basis, const std::vector<double>& t, const std::vector<double>& y) {
  BandedLeastSquares rows(basis.count());
  for (std::size_t i = 0; i < t.size(); ++i) {
    const std::size_t interval = basis.interval(t[i]);
    rows.add(interval - degree, basis.values(interval, t[i]), y[i]);
  }
  return rows;
}

QuinticSpline spline_of(const BSplines& basis, const std::vector<double>& coefficients) {
  QuinticSpline out;
  for (std::size_t k = degree; k + order < basis.knots().size(); ++k) {
    out.breaks.push_back(basis.knots()[k]);
    out.pieces.push_back(basis.polynomial(k, coefficients));
  }
  out.breaks.push_back(basis.knots().back());
  return out;
}

}  // namespace

QuinticSpline interpolating_spline(const std::vector<double>& t, const std::vector<double>& y) {
  std::vector<double> breaks{t.front()};
  breaks.insert(breaks.end(), t.begin() + 3, t.end() - 3);
  breaks.push_back(t.back());
  const BSplines basis(breaks);
  return spline_of(basis, fitted(basis, t, y).solve());
}

std::optional<QuinticSpline> smoothing_spline(const std::vector<double>& t, const std::vector<double>& y,
                                              double noise) {
  const std::size_t points = t.size();
  double least = std::numeric_limits<double>::infinity();
  std::optional<QuinticSpline> best;
  for (std::size_t intervals = 1; 2 * intervals <= points && intervals + degree < points;
       intervals = std::max(intervals + 1, intervals * 5 / 4)) {
    std::vector<double> breaks{t.front()};
    for (std::size_t k = 1; k < intervals; ++k) {
      const double place = static_cast<double>(k) * static_cast<double>(points - 1) / static_cast<double>(intervals);
      const auto before = static_cast<std::size_t>(place);
      const double part = place - static_cast<double>(before);
      breaks.push_back(t[before] + part * (t[before + 1] - t[before]));
    }
    breaks.push_back(t.back());
    const BSplines basis(breaks);
    const BandedLeastSquares rows = fitted(basis, t, y);
    const double rest = rows.rest() / (noise * noise);
    const double estimate = rest + 2 * static_cast<double>(basis.count());
    if (!(estimate < least)) continue;
    least = estimate;
    best.reset();
    // Squares of noise sum to the degrees of freedom, with the standard deviation sqrt(2 degrees of freedom).
    const auto left = static_cast<double>(points - basis.count());
    if (rest <= left + 5 * std::sqrt(2 * left)) best = spline_of(basis, rows.solve());
  }
  return best;
}

}  // namespace poise::solvers
