#include "model/profile.hpp"

namespace poise {

template <class C>
typename ProfileIn<C>::Piece ProfileIn<C>::standard(std::string_view law, double from, double to, double begin,
                                                    double end) {
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

template ProfileIn<double>::Piece ProfileIn<double>::standard(std::string_view law, double from, double to,
                                                              double begin, double end);

}  // namespace poise
