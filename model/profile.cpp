#include "model/profile.hpp"

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
Profile Profile::spline(const std::vector<double>& u, const std::vector<double>& p, bool periodic) {
  using Eigen::Index;
  const Index pieces = static_cast<Index>(u.size()) - 1;
  const auto length = [&](Index k) { return u[static_cast<std::size_t>(k) + 1] - u[static_cast<std::size_t>(k)]; };
  const auto slope = [&](Index k) {
    return (p[static_cast<std::size_t>(k) + 1] - p[static_cast<std::size_t>(k)]) / length(k);
  };
  Eigen::VectorXd m = Eigen::VectorXd::Zero(pieces + 1);
  // Periodic: the unknowns are M_1 to M_n, with M_0 = M_n; natural: M_1 to M_n-1.
  const Index unknowns = periodic ? pieces : pieces - 1;
  if (unknowns > 0) {
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(unknowns, unknowns);
    Eigen::VectorXd b(unknowns);
    for (Index k = 0; k < unknowns; ++k) {
      const Index before = k, after = (k + 1) % pieces;
      a(k, k) += 2 * (length(before) + length(after));
      if (k > 0 || periodic) a(k, (k + unknowns - 1) % unknowns) += length(before);
      if (k + 1 < unknowns || periodic) a(k, (k + 1) % unknowns) += length(after);
      b[k] = 6 * (slope(after) - slope(before));
    }
    m.segment(1, unknowns) = a.partialPivLu().solve(b);
    if (periodic) m[0] = m[pieces];
  }
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

}  // namespace poise
