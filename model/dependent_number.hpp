#pragma once

// Numbers of a scene that follow from others: expressions of the numbers that the table [numbers] gives names.

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "model/expression.hpp"
#include "model/parameters.hpp"

namespace poise {

/// Where a dependent number stands: a row of the parameter table, or a component that has no row of its own.
struct DependentPlace {
  enum class Of {
    row,      ///< `place` in the table
    force,    ///< component of a force's vector, whose magnitude is the row `place`
    axis,     ///< component of a joint's axis; `place` names the joint
    factor,   ///< factor of a term of the sum on which the item `place` acts
    left_out  ///< number of the function of time of a drive, which a scene at one time has none of
  };
  Of of = Of::row;
  ParameterPlace place;
  int component = 0;  ///< 0 x, 1 y; of a factor its term
};

struct HeldFactor;

/// A number that a scene file writes as an expression of named numbers: in the units of the file, as a number there.
struct DependentNumber {
  DependentPlace at;
  std::string item;  ///< "spring \"k\".stiffness"
  Expression expression;
  Dimension dimension;
  Range range = Range::finite;
  /// This is c(t) in a scene at one time: the expression of a load or of a number of a spring is multiplied by it, from
  /// gravity it is subtracted; null of others.
  std::shared_ptr<const HeldFactor> factor{};

  /// Its value in the units of the file. Not a number, or infinite, where it has none. Throws InputError where the
  /// numbers of c(t) contradict each other.
  double value(std::span<const double> named) const;
  /// Its derivative, as Expression::slope().
  double slope(std::span<const double> named, std::span<const double> slopes) const;
  /// Its second derivative, as Expression::bend().
  double bend(std::span<const double> named, std::span<const double> slopes, std::span<const double> bends) const;
  /// Named numbers that it follows from, ascending.
  std::vector<int> uses() const;
  /// The expression, with the factor named behind it.
  std::string text() const;
};

/// c(t) of a load at one time t, with the expressions that numbers of the function are. A number of the function that
/// follows from named ones makes every component of the load follow from them.
struct HeldFactor {
  TimeFunction function;
  double time = 0.0;                     ///< s
  std::vector<DependentNumber> numbers;  ///< of the function, at places of the scene that had it
  Units units;

  /// The function with the numbers that follow from the named ones.
  TimeFunction at(std::span<const double> named) const;
  /// The derivative of c(t) of this function along changes of the named numbers; not a number where it has none.
  double slope(const TimeFunction& function, std::span<const double> named, std::span<const double> slopes) const;
  /// The second derivative, where these change at the rates `slopes` and those rise at the rates `bends`.
  double bend(const TimeFunction& function, std::span<const double> named, std::span<const double> slopes,
              std::span<const double> bends) const;
};

/// Makes the dependent numbers of a scene those of the scene at the time t: to be called before its functions of time
/// are taken from it.
void hold_dependents(Scene& scene, double t);

/// What a row of the table follows from, of a force also one of its components; null where it is a number.
const DependentNumber* dependent_number(const Scene& scene, const ParameterPlace& place);

/// Throws InputError where a row follows from an expression, and so cannot be set or varied by itself; names the
/// expression and the numbers to set instead.
void check_is_free(const Scene& scene, const ParameterRow& row);

/// Values of the named numbers, in their order.
std::vector<double> named_values(const Scene& scene);

/// Values of the scene's dependent numbers, in its order, where the named ones that are not expressions have these
/// values; in the scene's units: SI, or those of a scaled scene. Throws InputError where one has none, or is 0 or
/// negative where it has to be positive; with `in_range` where it leaves its range.
std::vector<double> dependent_values(const Scene& scene, std::vector<double> named, bool in_range);

/// Their derivatives there by a named number that is not an expression, along all expressions between them. Not a
/// number where an expression has none.
std::vector<double> dependents_by(const Scene& scene, int by, std::vector<double> named);

/// How all dependent numbers follow from one named number that is not an expression: 0 not at all, 1 affinely, which is
/// proved, 2 otherwise.
std::vector<int> dependent_degrees(const Scene& scene, int named);

/// First and second derivatives of dependent numbers along a change of the named ones.
struct DependentDerivatives {
  std::vector<double> slopes, bends;
};
/// Derives all dependent numbers along a change of the named numbers that are no expressions, at the rates `slopes`;
/// those of others are ignored.
DependentDerivatives dependents_along(const Scene& scene, std::vector<double> slopes, std::vector<double> named);

/// Gives all dependent numbers the values that follow from the named ones. Throws InputError as dependent_values()
/// does, and where two of them contradict each other.
void follow_expressions(Scene& scene, bool in_range);

}  // namespace poise
