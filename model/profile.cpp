#include "model/profile.hpp"

#include <cmath>

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

template <class C>
ProfileIn<C> ProfileIn<C>::geneva(int slots) {
  const double k = std::sin(M_PI / slots);
  const double in_slot = std::acos(k), part = in_slot / (2 * M_PI), per_slot = slots / (2 * M_PI);
  return {{{0.0, part, Law::geneva, {0.0, per_slot, k, 0.0, in_slot}},
           {part, 1.0 - part, Law::polynomial, {0.5}},
           {1.0 - part, 1.0, Law::geneva, {1.0, per_slot, k, -in_slot, in_slot}}},
          true,
          1.0};
}

template ProfileIn<double> ProfileIn<double>::geneva(int slots);
template ProfileIn<double>::Piece ProfileIn<double>::standard(std::string_view law, double from, double to,
                                                              double begin, double end);

}  // namespace poise
