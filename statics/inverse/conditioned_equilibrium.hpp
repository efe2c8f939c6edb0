#pragma once

// Equilibria in which quantities have given values, with as many numbers of the scene unknown.

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "statics/inverse/enclosing.hpp"
#include "statics/inverse/least_norm_newton.hpp"
#include "statics/inverse/unknown_numbers.hpp"
#include "statics/quantities/numbered_equations.hpp"
#include "statics/quantities/quantity.hpp"

namespace poise {

/// Q(z, p) = value, in the units of the equations' scene.
struct Condition {
  SoughtQuantity of;
  double value = 0.0;
};

/// Which stops act, on the sides on which they do, and which of them (place in the list) is a driven measure, -1: none.
struct ActingSet {
  std::vector<ActingStop> stops;
  int driven = -1;
};

/// The square system in u = (z, s), with z of the equations of equilibrium and s the parts of the sought numbers,
///
///   R(z, p(s)) = 0,   Q_k(z, p(s)) = value_k,   k = 1 .. numbers().count()
///
/// (statics/quantities/numbered_equations.hpp, quantity_value.hpp). Refers to the numbers.
class ConditionedEquilibrium {
 public:
  ConditionedEquilibrium(const UnknownNumbers& numbers, ActingSet acting, std::vector<Condition> conditions);

  struct Point {
    std::vector<double> z, s;
  };

  const UnknownNumbers& numbers() const { return *numbers_; }
  const ActingSet& acting() const { return acting_; }
  /// The equilibrium with bodies at `poses`, three values of each, where the numbers have the parts s: with the
  /// multipliers of least size. To be called before others: it counts the whole turns of joints.
  Point begin(std::vector<double> poses, std::vector<double> s);
  /// Q_k - value_k. Not a number where a quantity is undefined.
  Eigen::VectorXd excess(const Point& at) const;
  /// Newton's method on all equations, from a point that it improves. False where it does not converge.
  bool solve(Point& at) const;
  /// The same with the equation  along . (u - through) = 0  in place of the conditions; of one number only.
  bool solve_across(Point& at, const Point& through, const Eigen::VectorXd& along) const;
  /// To first order, how far each part s moves where every number of the scene, and every value, changes by two units
  /// in its last place: what their rounding leaves open.
  std::vector<double> rounding_effect(const Point& at) const;
  Eigen::VectorXd difference(const Point& from, const Point& to) const;

  /// Krawczyk's operator (solvers/krawczyk.hpp), without joints that repeat others. It is also proved that stops that
  /// do not act are not overrun, and that those that act press.
  SolutionProof prove(const Point& at) const;

 private:
  template <class T>
  void evaluate(const T* p, const T* z, std::vector<T>& out) const;
  LeftSides differentiate(const Point& at) const;
  template <class Replace>
  bool improve(Point& at, Replace replace) const;
  int size() const { return equations_.unknowns() + numbers_->count(); }

  class Prover;

  const UnknownNumbers* numbers_;
  ActingSet acting_;
  std::vector<Condition> conditions_;
  NumberedEquations equations_;
};

}  // namespace poise
