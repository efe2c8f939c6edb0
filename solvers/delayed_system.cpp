#include "solvers/delayed_system.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "solvers/linear_algebra.hpp"

namespace poise::solvers {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

/// M(s) at a place.
class CharacteristicMatrix {
 public:
  explicit CharacteristicMatrix(const DelayedSystem& system) : system_(system) {}

  ForcedAnswer answer(const Complex& s, const Eigen::VectorXd& b, const Eigen::VectorXd& e) const {
    const Index n = system_.a.rows(), k = system_.d.rows();
    const Eigen::PartialPivLU<MatrixXcd> lu(at(s));
    Eigen::VectorXcd pushes(n + k), pushes_by_s = Eigen::VectorXcd::Zero(n + k);
    const Eigen::VectorXcd given = echoes(s).cwiseProduct(e.cast<Complex>());
    pushes << b.cast<Complex>(), given;
    pushes_by_s.tail(k) = -system_.delays.cast<Complex>().cwiseProduct(given);
    const Eigen::VectorXcd x = lu.solve(pushes), by_s = lu.solve(Eigen::VectorXcd(pushes_by_s - slope(s) * x));
    return {x.head(n), by_s.head(n)};
  }
  /// The derivative of log det M(s):  trace(M^-1 M').
  Complex log_slope(const Complex& s) const {
    const Eigen::PartialPivLU<MatrixXcd> lu(at(s));
    return lu.solve(slope(s)).trace();
  }
  /// det M(s) over its size.
  Complex direction(const Complex& s) const {
    const Eigen::PartialPivLU<MatrixXcd> lu(at(s));
    Complex out = lu.permutationP().determinant();
    for (Index i = 0; i < lu.matrixLU().rows(); ++i) {
      const Complex pivot = lu.matrixLU()(i, i);
      out *= pivot / std::max(std::abs(pivot), 1e-300);
    }
    return out;
  }

 private:
  MatrixXcd at(const Complex& s) const {
    const Index n = system_.a.rows(), k = system_.d.rows();
    const Eigen::VectorXcd e = echoes(s);
    MatrixXcd out(n + k, n + k);
    out.topLeftCorner(n, n) = s * MatrixXcd::Identity(n, n) - system_.a;
    out.topRightCorner(n, k) = -system_.b.cast<Complex>();
    out.bottomLeftCorner(k, n) = -(e.asDiagonal() * system_.c.cast<Complex>());
    out.bottomRightCorner(k, k) = MatrixXcd::Identity(k, k) - e.asDiagonal() * system_.d.cast<Complex>();
    return out;
  }
  MatrixXcd slope(const Complex& s) const {
    const Index n = system_.a.rows(), k = system_.d.rows();
    const Eigen::VectorXcd e = system_.delays.cwiseProduct(echoes(s));
    MatrixXcd out = MatrixXcd::Zero(n + k, n + k);
    out.topLeftCorner(n, n).setIdentity();
    out.bottomLeftCorner(k, n) = e.asDiagonal() * system_.c.cast<Complex>();
    out.bottomRightCorner(k, k) = e.asDiagonal() * system_.d.cast<Complex>();
    return out;
  }
  Eigen::VectorXcd echoes(const Complex& s) const {
    return (-s * system_.delays.cast<Complex>()).array().exp().matrix();
  }

  const DelayedSystem& system_;
};

/// The matrix that takes values at the points cos(j pi / N), j = 0 .. N, of a polynomial to those of its derivative.
MatrixXd chebyshev_derivative(int degree) {
  const Index count = degree + 1;
  const auto x = [&](Index j) { return std::cos(M_PI * static_cast<double>(j) / degree); };
  const auto weight = [&](Index j) { return (j == 0 || j == degree ? 2.0 : 1.0) * (j % 2 == 0 ? 1.0 : -1.0); };
  MatrixXd out = MatrixXd::Zero(count, count);
  for (Index i = 0; i < count; ++i) {
    for (Index j = 0; j < count; ++j) {
      if (i != j) out(i, j) = weight(i) / weight(j) / (x(i) - x(j));
    }
    out(i, i) = -out.row(i).sum();
  }
  return out;
}

/// The eigenvalues of the system with each delayed signal as a polynomial of this degree over its delay.
Eigen::VectorXcd approximate_poles(const DelayedSystem& system, int degree) {
  const Index n = system.a.rows(), k = system.d.rows(), size = n + k * degree;
  const MatrixXd by_values = chebyshev_derivative(degree);
  // The place of signal i at the point j >= 1; the last one is what is given now.
  const auto place = [&](Index i, Index j) { return n + i * degree + j - 1; };
  MatrixXd out = MatrixXd::Zero(size, size);
  out.topLeftCorner(n, n) = system.a;
  for (Index i = 0; i < k; ++i) {
    out.col(place(i, degree)).head(n) += system.b.col(i);
    const double per_time = 2.0 / system.delays[i];
    for (Index j = 1; j <= degree; ++j) {
      for (Index m = 1; m <= degree; ++m) out(place(i, j), place(i, m)) += per_time * by_values(j, m);
      const double by_new = per_time * by_values(j, 0);
      out.row(place(i, j)).head(n) += by_new * system.c.row(i);
      for (Index other = 0; other < k; ++other) out(place(i, j), place(other, degree)) += by_new * system.d(i, other);
    }
  }
  return eigenpairs(out).values;
}

bool is_right_of(const Complex& a, const Complex& b) {
  return a.real() != b.real() ? a.real() > b.real() : a.imag() > b.imag();
}

/// Newton's method from an approximation in the upper half plane; none where it does not converge near it.
std::optional<Complex> pole_near(const CharacteristicMatrix& m, const Complex& begin, double size) {
  constexpr int most_steps = 60;
  constexpr double rounding = 4e-15;
  Complex s = begin;
  for (int step = 0; step < most_steps; ++step) {
    const Complex slope = m.log_slope(s);
    if (!std::isfinite(std::abs(slope))) return s;  // M(s) is singular to rounding
    const Complex move = 1.0 / slope;
    s -= move;
    if (std::abs(s - begin) > size) return std::nullopt;
    if (std::abs(move) <= rounding * (std::abs(s) + 1.0)) return s;
  }
  // At a multiple root the last steps are as large as its rounding.
  constexpr double of_multiple = 1e-6;
  return std::abs(1.0 / m.log_slope(s)) <= of_multiple * (std::abs(s) + 1.0) ? std::optional(s) : std::nullopt;
}

/// The change of arg det M(s) along the straight line from a to b.
double turn_between(const CharacteristicMatrix& m, const Complex& a, const Complex& at_a, const Complex& b,
                    const Complex& at_b, int depth) {
  const double turn = std::arg(at_b / at_a);
  const double length = std::abs(b - a);
  constexpr double little = 0.4;
  constexpr int most_halvings = 60;
  const bool is_short =
      std::abs(turn) < little && length * std::abs(m.log_slope(a)) < 1.0 && length * std::abs(m.log_slope(b)) < 1.0;
  if (is_short || depth == most_halvings) return turn;
  const Complex middle = (a + b) / 2.0, at_middle = m.direction(middle);
  return turn_between(m, a, at_a, middle, at_middle, depth + 1) +
         turn_between(m, middle, at_middle, b, at_b, depth + 1);
}

/// The turns of det M(s) along a path.
double turns_along(const CharacteristicMatrix& m, const std::vector<Complex>& path) {
  double turn = 0.0;
  for (std::size_t k = 0; k + 1 < path.size(); ++k) {
    turn += turn_between(m, path[k], m.direction(path[k]), path[k + 1], m.direction(path[k + 1]), 0);
  }
  return turn / (2 * M_PI);
}

/// How many poles are right of the line Re s = sigma, and within `reach`: twice the turns around their upper half.
long count_right_of(const CharacteristicMatrix& m, double sigma, double reach) {
  return std::lround(2 * turns_along(m, {{sigma + reach, 0.0}, {sigma + reach, reach}, {sigma, reach}, {sigma, 0.0}}));
}

/// Whether poles that are found more than once are roots of as many times, so that none that is counted is another.
bool are_multiple(const CharacteristicMatrix& m, const std::vector<Complex>& poles) {
  constexpr double near = 1e-4;
  return std::all_of(poles.begin(), poles.end(), [&](const Complex& s) {
    const double half = near * (1.0 + std::abs(s));
    const auto is_here = [&](const Complex& other) {
      return std::max(std::abs((other - s).real()), std::abs((other - s).imag())) < half;
    };
    const long found = std::count_if(poles.begin(), poles.end(), is_here);
    if (found == 1) return true;
    const Complex right(half, 0.0), up(0.0, half);
    return found == std::lround(turns_along(
                        m, {s + right - up, s + right + up, s - right + up, s - right - up, s + right - up}));
  });
}

/// No pole right of the line Re s = sigma is farther from it:  |s| <= |A| + |B| |(I - E D)^-1 E C|.
double reach_right_of(const DelayedSystem& system, double sigma) {
  const auto norm = [](const MatrixXd& m) { return m.size() == 0 ? 0.0 : m.norm(); };
  const double echo = std::exp(std::max(0.0, -sigma * system.delays.maxCoeff()));
  double round = 1.0, rounds = 1.0;
  for (Index i = 1; i < system.d.rows(); ++i) {
    round *= echo * norm(system.d);
    rounds += round;
  }
  return norm(system.a) + norm(system.b) * rounds * echo * norm(system.c) + std::abs(sigma) + 1.0;
}

}  // namespace

ForcedAnswer forced_answer(const DelayedSystem& system, const Complex& s, const Eigen::VectorXd& b,
                           const Eigen::VectorXd& e) {
  return CharacteristicMatrix(system).answer(s, b, e);
}

std::optional<RightmostPoles> rightmost_poles(const DelayedSystem& system, int least) {
  const CharacteristicMatrix m(system);
  for (const int degree : {16, 32, 64}) {
    const Eigen::VectorXcd found = approximate_poles(system, degree);
    std::vector<Complex> near(found.begin(), found.end());
    std::sort(near.begin(), near.end(), is_right_of);
    if (static_cast<int>(near.size()) <= least) continue;
    // The line is in the widest gap of real parts behind the first ones.
    double sigma = 0.0, widest = -1.0;
    constexpr std::size_t candidates = 5;
    const std::size_t first = static_cast<std::size_t>(std::max(least, 1)) - 1;
    for (std::size_t k = first; k < std::min(first + candidates, near.size() - 1); ++k) {
      const double gap = near[k].real() - near[k + 1].real();
      if (gap <= widest) continue;
      widest = gap;
      sigma = (near[k].real() + near[k + 1].real()) / 2;
    }
    RightmostPoles out;
    out.right_of = sigma;
    const double reach = reach_right_of(system, sigma);
    for (const Complex& one : near) {
      if (one.real() < sigma || one.imag() < 0.0) continue;
      const std::optional<Complex> exact = pole_near(m, one, reach);
      if (!exact || exact->real() < sigma) continue;
      out.poles.emplace_back(exact->real(), std::abs(exact->imag()));
      if (one.imag() > 0.0) out.poles.push_back(std::conj(out.poles.back()));
    }
    std::sort(out.poles.begin(), out.poles.end(), is_right_of);
    const bool is_all = count_right_of(m, sigma, reach) == static_cast<long>(out.poles.size());
    if (is_all && are_multiple(m, out.poles)) return out;
  }
  return std::nullopt;
}

}  // namespace poise::solvers
