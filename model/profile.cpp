#include "model/profile.hpp"

#include <algorithm>

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

Profile Profile::spline(const std::vector<double>& u, const std::vector<double>& p, bool periodic) {
  const Spline<double> curve(u, p, periodic);
  std::vector<Piece> out;
  for (std::size_t k = 0; k + 1 < u.size(); ++k) {
    Piece piece{u[k], u[k + 1]};
    std::copy(curve.coefficients()[k].begin(), curve.coefficients()[k].end(), piece.c.begin());
    out.push_back(piece);
  }
  return {std::move(out), periodic};
}

}  // namespace poise
