#pragma once

#include <span>
#include <vector>

#include "solvers/problem.hpp"

namespace poise::solvers {

/// How far a row is outside its bounds, with the sign of the side: c for an equality, for an inequality 0 within them.
double violation(const Problem& problem, const Evaluation& at, int row);

struct ActiveSetOptions {
  int releases = 4;        ///< of one inequality in a search, before it counts as cycling
  double touching = 1e-9;  ///< distance from a bound within which a point is at it
};

/// Which constraint rows hold during a search: the equalities always, an inequality while it is at a bound.
class ActiveSet {
 public:
  /// Of the rows `kept`, all where empty; any other row is ignored throughout. `problem` must outlive this.
  explicit ActiveSet(const Problem& problem, const std::vector<int>& kept = {}, const ActiveSetOptions& options = {});

  /// Those that hold now, in rising order.
  const std::vector<int>& rows() const { return rows_; }
  /// The same as one flag per constraint row.
  const std::vector<char>& flags() const { return flags_; }
  /// All that were chosen, in rising order.
  const std::vector<int>& kept() const { return kept_; }
  bool holds(int row) const { return flags_[row] != 0; }
  /// Grows whenever a row joins or leaves.
  int changes() const { return changes_; }

  /// Equalities alone, nothing released yet.
  void reset();
  /// Equalities alone.
  void release_inequalities();
  void activate(int row, bool upper);
  /// Inequalities beyond a bound by more than `outside` join; a negative value also takes those that are so close to it
  /// from inside. True where any joined.
  bool activate_violated(const Evaluation& at, double outside);
  /// Inequalities at or beyond a bound join.
  bool activate_touched(const Evaluation& at) { return activate_violated(at, -options_.touching); }

  enum class Pulling { none, released, cycling };
  /// Lets go of the inequality that pulls hardest, if one pulls by more than `least`: at an upper bound an honest
  /// multiplier is positive, at a lower one negative. One released too often already stays, and is cycling.
  Pulling release_pulling(std::span<const double> multipliers, double least);

  /// c, or g less the bound at which it is held.
  double gap(const Evaluation& at, int row) const;
  /// Gaps of the rows that hold, 0 of all others; one per constraint row.
  void gaps(const Evaluation& at, std::span<double> out) const;
  /// Largest gap of rows that hold and violation of those that do not.
  double largest_gap(const Evaluation& at) const;
  /// Largest violation of the rows that were not chosen.
  double largest_left_out(const Evaluation& at) const;
  /// multipliers = 0 for rows that do not hold.
  void clear_inactive(std::span<double> multipliers) const;

  /// Where on the way from one point to another an inequality that does not hold is met first.
  struct Crossing {
    double fraction = 1.0;  ///< of the way; 1 where the end is at most touching beyond a bound
    int row = -1;           ///< the inequality at whose bound the end lies
    bool upper = false;     ///< which bound
  };
  Crossing first_crossing(const Evaluation& from, const Evaluation& to) const;

 private:
  void list_rows();

  const Problem& problem_;
  ActiveSetOptions options_;
  int equalities_;
  std::vector<int> kept_, rows_;
  int first_inequality_;  // place in kept_
  std::vector<char> flags_;
  std::vector<char> upper_;  // per constraint row: held at its upper bound
  std::vector<int> releases_;
  int changes_ = 0;
};

}  // namespace poise::solvers
