#pragma once

#include <vector>

#include "solvers/problem.hpp"

namespace poise::solvers {

/// Largest magnitude; 0 for none. Infinite where any entry is not a number.
double largest(const std::vector<double>& v);

/// out = F + J^T y, with one multiplier for each constraint row.
void unbalanced(const Problem& problem, const Evaluation& at, const std::vector<double>& y, std::vector<double>& out);

/// max |F + J^T y| / (1 + max |F|): what the programs compare with their tolerance.
double force_error(const Problem& problem, const Evaluation& at, const std::vector<double>& y);

/// How far a row is outside its bounds, with the sign of the side: c for an equality, for an inequality 0 within them.
double violation(const Problem& problem, const Evaluation& at, int row);

/// The y with minimal |F + J^T y|, and of those the shortest, zero for rows not in `rows`. One per constraint row.
std::vector<double> least_squares_multipliers(const Problem& problem, const Evaluation& at,
                                              const std::vector<int>& rows);

/// Which constraint rows hold during a search: the equalities chosen always, an inequality while it is at a bound.
class HeldRows {
 public:
  /// Of the rows `kept`, all where empty; any other row is ignored throughout. `problem` must outlive this.
  HeldRows(const Problem& problem, const std::vector<int>& kept);

  /// Those that hold now, in rising order.
  const std::vector<int>& rows() const { return held_; }
  /// All that were chosen, in rising order.
  const std::vector<int>& kept() const { return kept_; }
  bool holds(int row) const { return side_[row] != 0; }

  /// c, or g less the bound that it is held at.
  double gap(const Evaluation& at, int row) const;
  /// Largest gap of rows that hold and violation of those that do not.
  double largest_gap(const Evaluation& at) const;

  /// Largest violation of the rows that were not chosen.
  double largest_left_out(const Evaluation& at) const;

  /// Holds the inequalities that are more than `outside` beyond a bound; a negative value also takes those that are so
  /// close to it from inside. True where any joined.
  bool hold_violated(const Evaluation& at, double outside);

  enum class Pulling { none, released, cycling };
  /// Lets go of the inequality that pulls hardest, if one pulls by more than `least`: at an upper bound an honest
  /// multiplier is positive, at a lower one negative. One released more than a few times is cycling.
  Pulling release_pulling(const std::vector<double>& y, double least);

 private:
  void list_held();

  const Problem& problem_;
  std::vector<int> kept_, held_;
  std::vector<signed char> side_;  // per constraint row: 0 does not hold, 1 equality or upper bound, -1 lower bound
  std::vector<int> releases_;
};

/// Why a point at which all tolerances are met is no answer all the same, a clause for a person; null where it is one.
/// Multipliers beyond a million times the field balance nothing: J loses rank there. Rows left out as repeating others
/// at the start need not do so here; they must hold to 1e-9, or the tolerance where that is looser.
const char* objection(const Evaluation& at, const HeldRows& held, const std::vector<double>& y, double tolerance);

}  // namespace poise::solvers
