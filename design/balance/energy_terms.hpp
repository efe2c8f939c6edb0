#pragma once

#include <compare>
#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "design/balance/pose_form.hpp"

namespace poise {

/// A function of the pose: a product of up to two lengths and of the cosine, or sine, of one angle or of the difference
/// of two:  s_a s_b cos(theta_up - theta_down). Indices of coordinates, -1 for none. Such functions are independent,
/// but for closures.
struct PoseFunction {
  int length_a = -1, length_b = -1;  ///< length_a <= length_b
  int up = -1, down = -1;            ///< an angle alone is `up`; of two, up < down

  int lengths() const { return (length_a >= 0 ? 1 : 0) + (length_b >= 0 ? 1 : 0); }
  bool has_angle() const { return up >= 0; }
  friend auto operator<=>(const PoseFunction&, const PoseFunction&) = default;
};

/// An energy as a sum of coefficients (x of cosines, y of sines) times functions. N m over the unit of the lengths, m.
using EnergyTerms = std::map<PoseFunction, Vec2>;

/// Adds  factor Re(conj(a) b).
void add_product(EnergyTerms& out, double factor, const PhasorTerms& a, const PhasorTerms& b);
EnergyTerms sum(EnergyTerms a, const EnergyTerms& b, double factor = 1.0);
/// Potential of a force that keeps its direction, at a place:  -F . p.
EnergyTerms potential(const PhasorTerms& place, Vec2 force);
/// Half the square of the distance of two places.
EnergyTerms half_square(const PhasorTerms& a, const PhasorTerms& b);
/// The value where the coordinates are q.
double value(const EnergyTerms& terms, const std::vector<double>& q);

/// The functions that energies of a mechanism are sums of, as the components of vectors. Where loops close, products
/// of the closures and of phasors are zero, and express some of the functions by others (elimination with full
/// pivoting): what is left is a sum of functions that no such product relates, so that it is constant in all poses if
/// its components are zero. Without closures, which open chains and parallelograms do not have, also only then.
class FunctionSpace {
 public:
  /// `of`: energies whose functions are wanted.
  FunctionSpace(const PoseForm& form, const std::vector<EnergyTerms>& of);

  struct Component {
    PoseFunction function;
    bool is_sine = false;
  };
  /// Those that are left, without the constant.
  const std::vector<Component>& components() const { return components_; }
  /// An energy in these components, each for lengths measured in the size of the mechanism, N m.
  Eigen::VectorXd vector(const EnergyTerms& terms) const;
  /// Number of independent relations that the closures give.
  int relations() const { return relations_; }
  /// Whether the components and the constant are found to be independent on poses in which the loops close, by their
  /// values in random ones: then an energy is constant only if its components are zero. Certain without closures.
  bool is_complete() const { return complete_; }
  /// "cos(arm - fore)", "travel of gib".
  std::string name(const Component& component) const;

 private:
  Eigen::VectorXd in_all(const EnergyTerms& terms) const;
  void eliminate(const std::vector<EnergyTerms>& relations);
  bool found_independent() const;

  const PoseForm& form_;
  std::map<PoseFunction, Eigen::Index> first_;  // place of the cosine; that of the sine is the next
  std::vector<Component> all_;
  Eigen::MatrixXd rows_;  // relations, solved for `pivots_`
  std::vector<Eigen::Index> pivots_, kept_;
  std::vector<Component> components_;
  int relations_ = 0;
  bool complete_ = true;
};

}  // namespace poise
