#pragma once

#include <span>
#include <vector>

#include "solvers/problem.hpp"

namespace poise::solvers {

/// A Problem in the form of programs for constrained minimisation, function by function, in units of the error that
/// remains at a base point:
///
///   x = base + unit u,   min  scale (L(x) - L(base)) / unit^2,   c(x) / unit = 0,   +-(g(x) - bound) / unit <= 0
///
/// with L = f + sum y c over the equalities, which has the minima of f on c = 0. Near the solution, bounds with a
/// clearly non-zero multiplier count as equalities.
///
/// The value of f has a rounding error of about 1e-16, which hides steps below 1e-8. Near the solution the difference
/// is therefore taken from gradients, (grad L(x) + grad L(base)) (x - base) / 2, with an error of third order in the
/// step; programs that compare values then reach full precision. Every new point is evaluated once, completely.
class RescaledProblem {
 public:
  /// Base point and units.
  struct Frame {
    std::vector<double> base;
    std::vector<double> multipliers;  ///< y; one per constraint row, none when empty
    double unit = 1.0;
    double scale = 1.0;
    bool near = false;  ///< differences of L from gradients; otherwise the value of L itself, and unit is 1
  };

  /// sign (row - bound), required to be zero or <= 0.
  struct SignedRow {
    int row = 0;
    double sign = 1.0;
    double bound = 0.0;
  };

  /// Rows of one kind and where their Jacobian lies in a dense matrix, row by row.
  struct Block {
    struct Entry {
      int source = 0;  ///< in Evaluation::jacobian
      int target = 0;
      double sign = 1.0;
    };
    std::vector<SignedRow> rows;
    std::vector<Entry> entries;
  };

  /// Of the rows `kept`. `problem` must outlive this.
  RescaledProblem(const Problem& problem, const std::vector<int>& kept);

  void set_frame(Frame frame);
  std::vector<double> place(std::span<const double> u) const;
  /// The point at which the problem was evaluated last.
  const std::vector<double>& last() const { return at_.x; }
  int evaluations() const { return evaluations_; }

  /// The objective, infinite instead of NaN; fills its gradient if that is not empty.
  double objective(std::span<const double> u, std::span<double> gradient);
  /// Values of a block; fills its dense Jacobian if that is not empty.
  void constraints(const Block& block, std::span<const double> u, std::span<double> values, std::span<double> jacobian);

  const Block& equalities() const { return equalities_; }
  const Block& inequalities() const { return inequalities_; }

 private:
  void sort_rows();
  void list_entries(Block& block) const;
  const Evaluation& at(std::span<const double> u);
  const std::vector<double>& slope_of(const Evaluation& e);

  const Problem& problem_;
  std::vector<int> kept_;
  Block equalities_, inequalities_;
  Frame frame_;
  Evaluation at_;
  std::vector<double> u_;  // of at_; empty before the first evaluation in a frame
  std::vector<double> no_multipliers_, slope_, slope_at_base_;
  double value_at_base_ = 0.0;
  int evaluations_ = 0;
};

}  // namespace poise::solvers
