#include "model/profile.hpp"

#include <algorithm>
#include <cmath>

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

Profile Profile::spline(const std::vector<double>& u, const std::vector<double>& p, bool periodic,
                        bool has_curved_ends) {
  const Spline<double> curve(u, p, periodic, has_curved_ends);
  std::vector<Piece> out;
  for (std::size_t k = 0; k + 1 < u.size(); ++k) {
    Piece piece{u[k], u[k + 1]};
    std::copy(curve.coefficients()[k].begin(), curve.coefficients()[k].end(), piece.c.begin());
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
