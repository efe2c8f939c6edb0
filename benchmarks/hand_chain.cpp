#include "benchmarks/hand_chain.hpp"

#include <algorithm>
#include <cmath>

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

std::vector<double> arc_start(int links) {
  // The span falls as the arc closes, from 1 at phi = 0 to 0 at a full circle.
  double low = 0.0, high = 2.0 * M_PI / links;
  for (int k = 0; k < 200; ++k) {
    const double phi = 0.5 * (low + high);
    const double span = std::sin(0.5 * links * phi) / (links * std::sin(0.5 * phi));
    (span > chain_span ? low : high) = phi;
  }
  std::vector<double> angles(links);
  for (int i = 0; i < links; ++i) angles[i] = (i - 0.5 * (links - 1)) * low;
  return angles;
}

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
  double gap_x = -links_ * chain_span, gap_y = 0.0;
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
