#pragma once

#include <memory>
#include <span>
#include <vector>

namespace poise::solvers {

/// Positions of the entries of a sparse matrix, none twice; values come in the same order.
struct Pattern {
  int rows = 0;
  int columns = 0;
  std::vector<int> row;
  std::vector<int> column;

  int size() const { return static_cast<int>(row.size()); }
};

/// Intermediate values of a problem at one point.
struct Scratch {
  virtual ~Scratch() = default;
};

/// Values of a problem at one point. Made by Problem::make_evaluation(), refilled by Problem::evaluate().
struct Evaluation {
  std::vector<double> x;             ///< variables
  std::vector<double> gradient;      ///< grad f(x), or the field F(x) where there is no objective
  std::vector<double> constraint;    ///< equalities, then inequalities
  std::vector<double> jacobian;      ///< values in the order of jacobian_pattern()
  std::unique_ptr<Scratch> scratch;  ///< intermediate values of the problem at this x, for its own use; may be null
};

/// Find x with  c(x) = 0,  lower <= g(x) <= upper,  and either f minimal or stationary, or, where the field F is no
/// gradient, F(x) + J^T multipliers = 0. Variables and rows should be scaled to be of order one.
///
/// All members are const and pure. Rows 0 .. equalities()-1 of constraint and Jacobian are c, the others g.
class Problem {
 public:
  virtual ~Problem() = default;

  virtual int variables() const = 0;
  virtual int equalities() const = 0;
  virtual const std::vector<double>& lower() const = 0;  ///< of the inequalities; -inf where there is none
  virtual const std::vector<double>& upper() const = 0;  ///< of the inequalities; +inf where there is none
  /// False if F is not a gradient: then the tangent is not symmetric and f is undefined.
  virtual bool has_objective() const = 0;

  virtual const Pattern& jacobian_pattern() const = 0;
  /// Pattern of  dF/dx + sum multiplier_r d2(row r)/dx2:  lower triangle where has_objective(), else all of it.
  /// The first variables() entries are the diagonal.
  virtual const Pattern& tangent_pattern() const = 0;

  /// Fills all of `at` from at.x.
  virtual void evaluate(Evaluation& at) const = 0;
  /// f at an evaluated point. Separate, because a search for stationary points does not need it.
  virtual double objective(Evaluation& at) const = 0;
  /// Values of the tangent at an evaluated point; one multiplier for each constraint row.
  virtual void tangent(Evaluation& at, std::span<const double> multipliers, std::span<double> values) const = 0;
  /// Creates Evaluation::scratch with its buffers sized.
  virtual std::unique_ptr<Scratch> make_scratch() const { return nullptr; }

  int inequalities() const { return static_cast<int>(lower().size()); }
  int constraints() const { return equalities() + inequalities(); }

  /// An evaluation with all its buffers sized.
  Evaluation make_evaluation() const {
    Evaluation e;
    e.x.resize(variables());
    e.gradient.resize(variables());
    e.constraint.resize(constraints());
    e.jacobian.resize(jacobian_pattern().size());
    e.scratch = make_scratch();
    return e;
  }
};

}  // namespace poise::solvers
