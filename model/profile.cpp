#include "model/profile.hpp"

#include <cmath>

#include <Eigen/LU>

namespace poise {

Profile::Piece Profile::standard(std::string_view law, double from, double to, double begin, double end) {
  Piece piece{from, to};
  const double rise = end - begin;
  piece.c[0] = begin;
  if (law == "harmonic" || law == "cycloidal") {
    piece.law = law == "harmonic" ? Law::harmonic : Law::cycloidal;
    piece.c[1] = rise;
  } else if (law == "polynomial_345") {
    piece.c[3] = 10 * rise;
    piece.c[4] = -15 * rise;
    piece.c[5] = 6 * rise;
  }
  return piece;
}

// The second derivatives M_k at the points follow from the continuity of the first ones,
//   h_k M_k + 2 (h_k + h_k+1) M_k+1 + h_k+1 M_k+2 = 6 (d_k+1 - d_k),   d_k = (P_k+1 - P_k) / h_k.
Profile Profile::spline(const std::vector<double>& u, const std::vector<double>& p, bool periodic,
                        bool has_curved_ends) {
  using Eigen::Index;
  const Index pieces = static_cast<Index>(u.size()) - 1;
  const auto length = [&](Index k) { return u[static_cast<std::size_t>(k) + 1] - u[static_cast<std::size_t>(k)]; };
  const auto slope = [&](Index k) {
    return (p[static_cast<std::size_t>(k) + 1] - p[static_cast<std::size_t>(k)]) / length(k);
  };
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(pieces + 1, pieces + 1);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(pieces + 1);
  for (Index k = 1; k < pieces + (periodic ? 1 : 0); ++k) {
    const Index before = k - 1, after = k % pieces;
    a(k, before) += length(before);
    a(k, k) += 2 * (length(before) + length(after));
    a(k, after + 1) += length(after);
    b[k] = 6 * (slope(after) - slope(before));
  }
  // M = 0, or one cubic over two pieces; three points have a parabola.
  const auto bend = [&](Index at, Index next, Index piece, Index beside) {
    a(at, at) = 1.0;
    if (!has_curved_ends) return;
    const double ratio = pieces > 2 ? length(piece) / length(beside) : 0.0;
    a(at, next) = -(1.0 + ratio);
    if (pieces > 2) a(at, 2 * next - at) = ratio;
  };
  if (periodic) {
    a(0, 0) = 1.0;
    a(0, pieces) = -1.0;
  } else {
    bend(0, 1, 0, 1);
    bend(pieces, pieces - 1, pieces - 1, pieces - 2);
  }
  const Eigen::VectorXd m = a.partialPivLu().solve(b);
  std::vector<Piece> out;
  for (Index k = 0; k < pieces; ++k) {
    const double h = length(k);
    const double begin = p[static_cast<std::size_t>(k)], end = p[static_cast<std::size_t>(k) + 1];
    Piece piece{u[static_cast<std::size_t>(k)], u[static_cast<std::size_t>(k) + 1]};
    piece.c[0] = begin;
    piece.c[1] = end - begin - h * h * (2 * m[k] + m[k + 1]) / 6;
    piece.c[2] = h * h * m[k] / 2;
    piece.c[3] = h * h * (m[k + 1] - m[k]) / 6;
    out.push_back(piece);
  }
  return {std::move(out), periodic};
}

bool Profile::is_short(const Piece& piece) {
  const auto c = [&](std::size_t k) { return Vec2{piece.c[1 + k], piece.c[5 + k]}; };
  const Vec2 a = c(1), b = 2.0 * c(2), d = 3.0 * c(3);
  const double q_0 = dot(a, a);
  constexpr double margin = 0.99;  // for rounding, also of the scalars that evaluate the piece
  double sum = 0.0, power = 1.0;
  for (const double q : {2 * dot(a, b), dot(b, b) + 2 * dot(a, d), 2 * dot(b, d), dot(d, d)}) {
    power *= 4 * most_t;
    sum += std::abs(q) * power;
  }
  const double turned_back = most_t * std::abs(dot(a, b)) + most_t * most_t * std::abs(dot(a, d));
  return sum < margin * q_0 && turned_back < margin * q_0;
}

}  // namespace poise
