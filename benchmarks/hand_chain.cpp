#include "benchmarks/hand_chain.hpp"

#include <algorithm>
#include <cmath>

#include "comparison/series.hpp"

namespace poise::benchmarks {
namespace {

constexpr double step_tolerance = 1e-9;
constexpr int most_steps = 50;

// Solves the symmetric system [a b; b d] (x, y) = (p, q).
void solve_two(double a, double b, double d, double p, double q, double& x, double& y) {
  const double scale = 1.0 / (a * d - b * b);
  x = scale * (d * p - b * q);
  y = scale * (a * q - b * p);
}

}  // namespace

HandChain::HandChain(int links)
    : links_(links), length_(1.0 / links), angle_(links), cos_(links), sin_(links), inverse_(links) {}

bool HandChain::solve(const std::vector<double>& start) {
  for (int i = 0; i < links_; ++i) {
    angle_[i] = start[i];
    cos_[i] = std::cos(start[i]);
    sin_[i] = std::sin(start[i]);
  }
  guess_multipliers();
  for (iterations_ = 1; iterations_ <= most_steps; ++iterations_) {
    if (step() <= step_tolerance) return true;
  }
  return false;
}

// Least squares: J J^T (x, y) = -J F. All lengths cancel.
void HandChain::guess_multipliers() {
  double a = 0.0, b = 0.0, d = 0.0, p = 0.0, q = 0.0;
  for (int i = 0; i < links_; ++i) {
    const double force = (1.0 - (i + 0.5) * length_) * cos_[i];
    a += sin_[i] * sin_[i];
    b -= sin_[i] * cos_[i];
    d += cos_[i] * cos_[i];
    p += sin_[i] * force;
    q -= cos_[i] * force;
  }
  solve_two(a, b, d, p, q, x_, y_);
}

// One Newton step; returns max |d|. Everything is divided by the link length, which drops out of d.
double HandChain::step() {
  double gap_x = -links_ * comparison::chain_span, gap_y = 0.0;
  double a = 0.0, b = 0.0, d = 0.0, p = 0.0, q = 0.0;
  for (int i = 0; i < links_; ++i) {
    const double c = cos_[i], s = sin_[i];
    const double weight = 1.0 - (i + 0.5) * length_;
    const double inverse = -1.0 / ((weight + y_) * s + x_ * c);
    inverse_[i] = inverse;
    const double force = inverse * weight * c;
    gap_x += c;
    gap_y += s;
    a += inverse * s * s;
    b -= inverse * s * c;
    d += inverse * c * c;
    p += s * force;
    q -= c * force;
  }
  solve_two(a, b, d, gap_x + p, gap_y + q, x_, y_);
  double longest = 0.0;
  for (int i = 0; i < links_; ++i) {
    const double weight = 1.0 - (i + 0.5) * length_;
    const double move = inverse_[i] * (x_ * sin_[i] - (weight + y_) * cos_[i]);
    longest = std::max(longest, std::abs(move));
    angle_[i] += move;
    cos_[i] = std::cos(angle_[i]);
    sin_[i] = std::sin(angle_[i]);
  }
  return longest;
}

}  // namespace poise::benchmarks
