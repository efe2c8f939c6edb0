#pragma once

#include <cstddef>
#include <vector>

#include "model/planar.hpp"

namespace poise {

/// Forces in joints that friction makes grow, and that make friction grow. With the sizes g_i of the forces R_i in n
/// joints that slide,
///
///   g_i = |R_i|_i,   R_i = force_i + sum_j response_ij g_j,
///
/// force the part without friction, response_ij what a size of 1 in joint j makes of the force in joint i through the
/// friction in j. |R| is the largest w . R over a set K of vectors w:
///
///   normal    the size of a normal force |x|                        K: (1, 0), (-1, 0)
///   carriage  the greater of |x| and |y|, y of the couple           K: (1, 0), (-1, 0), (0, 1), (0, -1)
///   pin       the norm                                              K: the unit circle
///
/// Such equations may have one solution, several, or none (P. Painleve, "Sur les lois du frottement de glissement",
/// Comptes Rendus 121 (1895), 112-115).
class FrictionForces {
 public:
  enum class Size { normal, carriage, pin };

  explicit FrictionForces(std::vector<Size> sizes);

  std::size_t joints() const { return sizes_.size(); }
  Size size(std::size_t i) const { return sizes_[i]; }
  Planar<double>& force(std::size_t i) { return force_[i]; }
  Planar<double>& response(std::size_t i, std::size_t j) { return response_[i * joints() + j]; }

  /// Whether there is one solution, whatever the forces without friction are. Sufficient: the fixed point contracts, I
  /// - (|response_ij|) having positive pivots; or the generalised Jacobians I - (w_i . response_ij) all have a positive
  /// determinant, which is affine in each w_i, so that its least value is at corners of the sets K, with a polygon
  /// around the circle of a pin. Then the map is one to one (B. H. Pourciau, "Global invertibility of nonsmooth
  /// mappings", Journal of Mathematical Analysis and Applications 131 (1988), 170-179); of normal forces alone this is
  /// necessary, too. Does not allocate.
  bool is_unique();

  struct All {
    std::vector<std::vector<double>> sizes;  ///< g of each solution
    bool complete = true;                    ///< there are no others, in double precision
  };
  /// All solutions. Cells are one corner of each K, or an arc of directions of the force in a pin; one in which a
  /// linear program finds no solution is left out, one in which the determinant has one sign has at most one, which
  /// Newton's method finds; arcs of others are halved.
  All all();

 private:
  struct Part;
  struct Search;
  static double size_of(Size size, const Planar<double>& force);
  void find_active();
  bool contracts();
  double determinant();
  int sign_at_corners();

  std::vector<Size> sizes_;
  std::vector<Planar<double>> force_, response_;
  // Scratch: joints whose size has a response, and corners of their sets K.
  std::vector<std::size_t> active_;
  std::vector<Planar<double>> corners_;
  std::vector<std::size_t> first_corner_, corner_;
  std::vector<double> matrix_;
};

}  // namespace poise
