#include "design/synthesis/private/exact_algebra.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>
#include <tuple>
#include <utility>

#include "model/planar.hpp"

namespace poise::synthesis {
namespace {

using BallPoint = Planar<Ball>;
using LongComplex = std::complex<long double>;

/// a / b.
BallPoint quotient(const BallPoint& a, const BallPoint& b) {
  const Ball square = dot(b, b);
  const BallPoint product = a * conj(b);
  return {product.x / square, product.y / square};
}

BallPoint value_at(const BallPolynomial& p, const BallPoint& z) {
  BallPoint sum{};
  for (std::size_t k = p.size(); k-- > 0;) sum = sum * z + BallPoint{p[k], Ball()};
  return sum;
}

BallPolynomial derivative_of(const BallPolynomial& p) {
  BallPolynomial out;
  for (std::size_t k = 1; k < p.size(); ++k) out.push_back(Ball(static_cast<int>(k)) * p[k]);
  return out;
}

/// Zeros by the simultaneous steps of Weierstrass (Durand and Kerner).
std::vector<LongComplex> approximate_roots(const BallPolynomial& p) {
  constexpr int most_steps = 500;
  constexpr long double nothing = 1e-18L;
  const std::size_t degree = p.size() - 1;
  std::vector<LongComplex> c;
  for (const Ball& one : p) c.emplace_back(static_cast<long double>(one.middle() / p.back().middle()));
  // Zeros are of the size of the largest of these means.
  long double size = 0.0L;
  for (std::size_t k = 0; k < degree; ++k) {
    size = std::max(size, std::pow(std::abs(c[k]), 1.0L / static_cast<long double>(degree - k)));
  }
  std::vector<LongComplex> z;
  for (std::size_t k = 0; k < degree; ++k) {
    z.push_back(size * std::polar(0.9L, 0.4L + 2.0L * pi_of<long double>() * static_cast<long double>(k) / degree));
  }
  for (int step = 0; step < most_steps; ++step) {
    long double moved = 0.0L;
    for (std::size_t k = 0; k < degree; ++k) {
      LongComplex value = 0.0L, others = 1.0L;
      for (std::size_t j = c.size(); j-- > 0;) value = value * z[k] + c[j];
      for (std::size_t j = 0; j < degree; ++j) {
        if (j != k) others *= z[k] - z[j];
      }
      if (others == 0.0L) others = nothing;
      const LongComplex change = value / others;
      z[k] -= change;
      moved = std::max(moved, std::abs(change));
    }
    if (moved <= nothing * size) break;
  }
  return z;
}

/// Newton's steps at the full precision of balls from a place; the place itself where they do not converge.
BallPoint polished(const BallPolynomial& p, const BallPolynomial& slope, const LongComplex& z) {
  constexpr int steps = 4;
  const auto start = [&] {
    return BallPoint{Ball(static_cast<double>(z.real())), Ball(static_cast<double>(z.imag()))};
  };
  BallPoint at = start();
  for (int k = 0; k < steps; ++k) {
    const BallPoint next = at - quotient(value_at(p, at), value_at(slope, at));
    if (!next.x.is_finite() || !next.y.is_finite()) return start();
    at = {next.x.midpoint(), next.y.midpoint()};
  }
  return at;
}

/// Radii of the circles of Smith; not finite where points coincide.
std::vector<Ball> radii_of(const BallPolynomial& p, const std::vector<BallPoint>& z) {
  std::vector<Ball> out;
  for (std::size_t k = 0; k < z.size(); ++k) {
    Ball product = abs(p.back());
    for (std::size_t j = 0; j < z.size(); ++j) {
      if (j != k) product *= hypot(z[k].x - z[j].x, z[k].y - z[j].y);
    }
    const BallPoint value = value_at(p, z[k]);
    out.push_back(Ball(static_cast<int>(z.size())) * hypot(value.x, value.y) / product);
  }
  return out;
}

/// Places of real zeros where zeros coincide: approximations of a multiple zero scatter around it by a root of
/// rounding, but their middle is right almost to rounding.
std::vector<Ball> real_places_of(std::vector<LongComplex> near) {
  constexpr long double together = 1e-3L, nearly_real = 1e-7L;
  std::vector<Ball> out;
  while (!near.empty()) {
    const LongComplex first = near.back();
    const auto apart = std::partition(near.begin(), near.end(), [&](const LongComplex& z) {
      return std::abs(z - first) > together * (1.0L + std::abs(first));
    });
    const auto number = static_cast<long double>(near.end() - apart);
    const LongComplex middle = std::accumulate(apart, near.end(), LongComplex(0.0L)) / number;
    near.erase(apart, near.end());
    if (std::abs(middle.imag()) <= nearly_real * (1.0L + std::abs(middle))) {
      out.emplace_back(static_cast<double>(middle.real()));
    }
  }
  std::sort(out.begin(), out.end(), [](const Ball& a, const Ball& b) { return a.middle() < b.middle(); });
  return out;
}

}  // namespace

BallRows null_space(BallRows a) {
  const std::size_t rows = a.size(), columns = a.front().size();
  std::vector<std::size_t> order(columns);
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (std::size_t k = 0; k < rows; ++k) {
    std::size_t row = k, column = k;
    double largest = -1.0;
    for (std::size_t i = k; i < rows; ++i) {
      for (std::size_t j = k; j < columns; ++j) {
        const double size = std::abs(a[i][order[j]].middle());
        if (size > largest) std::tie(largest, row, column) = std::tuple(size, i, j);
      }
    }
    std::swap(a[k], a[row]);
    std::swap(order[k], order[column]);
    // Rounding of the input leaves this much where the rank is not full.
    constexpr double nothing = 4e-15;
    const Ball pivot = a[k][order[k]];
    if (pivot.contains_zero() || largest < nothing) return {};
    for (Ball& one : a[k]) one = one / pivot;
    for (std::size_t i = 0; i < rows; ++i) {
      if (i == k) continue;
      const Ball factor = a[i][order[k]];
      for (std::size_t j = 0; j < columns; ++j) a[i][j].subtract_product(factor, a[k][j]);
    }
  }
  BallRows out;
  for (std::size_t free = rows; free < columns; ++free) {
    std::vector<Ball> vector(columns);
    vector[order[free]] = Ball(1);
    for (std::size_t k = 0; k < rows; ++k) vector[order[k]] = -a[k][order[free]];
    out.push_back(std::move(vector));
  }
  return out;
}

BallPolynomial operator+(const BallPolynomial& a, const BallPolynomial& b) {
  BallPolynomial out(std::max(a.size(), b.size()));
  for (std::size_t k = 0; k < a.size(); ++k) out[k] += a[k];
  for (std::size_t k = 0; k < b.size(); ++k) out[k] += b[k];
  return out;
}

BallPolynomial operator-(const BallPolynomial& a, const BallPolynomial& b) {
  BallPolynomial out(std::max(a.size(), b.size()));
  for (std::size_t k = 0; k < a.size(); ++k) out[k] += a[k];
  for (std::size_t k = 0; k < b.size(); ++k) out[k] -= b[k];
  return out;
}

BallPolynomial operator*(const BallPolynomial& a, const BallPolynomial& b) {
  BallPolynomial out(a.size() + b.size() - 1);
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < b.size(); ++j) out[i + j] += a[i] * b[j];
  }
  return out;
}

Ball value_of(const BallPolynomial& p, const Ball& x) {
  Ball sum;
  for (std::size_t k = p.size(); k-- > 0;) sum = sum * x + p[k];
  return sum;
}

PolynomialRoots roots_of(const BallPolynomial& p) {
  PolynomialRoots out;
  if (p.size() < 2 || p.back().contains_zero()) return out;
  const std::vector<LongComplex> near = approximate_roots(p);
  const BallPolynomial slope = derivative_of(p);
  std::vector<BallPoint> z;
  for (const LongComplex& one : near) z.push_back(polished(p, slope, one));
  std::vector<Ball> radii = radii_of(p, z);
  // A point so near to the real axis that its circle reaches it is moved there, where it proves a real zero.
  for (std::size_t k = 0; k < z.size(); ++k) {
    if (!(abs(z[k].y) > radii[k])) z[k].y = Ball();
  }
  radii = radii_of(p, z);
  out.isolated = true;
  for (std::size_t k = 0; k < z.size(); ++k) {
    out.isolated = out.isolated && radii[k].is_finite();
    for (std::size_t j = 0; j < k; ++j) {
      out.isolated = out.isolated && hypot(z[k].x - z[j].x, z[k].y - z[j].y) > radii[k] + radii[j];
    }
  }
  if (!out.isolated) {
    out.real = real_places_of(near);
    return out;
  }
  for (std::size_t k = 0; k < z.size(); ++k) {
    if (z[k].y == Ball()) {
      out.real.push_back(Ball::of_both(z[k].x - radii[k], z[k].x + radii[k]));
    } else {
      ++out.others;
    }
  }
  std::sort(out.real.begin(), out.real.end(), [](const Ball& a, const Ball& b) { return a.middle() < b.middle(); });
  return out;
}

std::vector<std::vector<double>> generic_rotation(std::size_t size, int attempt) {
  std::vector<std::vector<double>> out(size, std::vector<double>(size));
  for (std::size_t i = 0; i < size; ++i) out[i][i] = 1.0;
  double angle = 0.7 + 1.1 * attempt;
  for (std::size_t i = 0; i < size; ++i) {
    for (std::size_t j = i + 1; j < size; ++j) {
      const double c = std::cos(angle), s = std::sin(angle);
      for (std::vector<double>& row : out) {
        std::tie(row[i], row[j]) = std::tuple(c * row[i] - s * row[j], s * row[i] + c * row[j]);
      }
      angle += 0.9;
    }
  }
  return out;
}

}  // namespace poise::synthesis
