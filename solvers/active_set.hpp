#pragma once

#include <span>
#include <vector>

#include "solvers/problem.hpp"

namespace poise::solvers {

/// How far a row is outside its bounds, with the sign of the side: c for an equality, for an inequality 0 within them.
double violation(const Problem& problem, const Evaluation& at, int row);

struct ActiveSetOptions {
  int releases = 4;        ///< of one inequality in a search, beyond which it counts as cycling
  double touching = 1e-9;  ///< distance from a bound within which a point counts as at the bound
};

/// The active set of a search: the constraint rows imposed as equations. Equalities always are, an inequality while it
/// is held at a bound.
class ActiveSet {
 public:
  /// Considers the rows `kept`, all when empty; any other row is ignored throughout. `problem` must outlive this.
  explicit ActiveSet(const Problem& problem, const std::vector<int>& kept = {}, const ActiveSetOptions& options = {});

  /// The active rows in rising order.
  const std::vector<int>& rows() const { return rows_; }
  /// The same as one flag per constraint row.
  const std::vector<char>& flags() const { return flags_; }
  /// The rows considered, active or not, in rising order.
  const std::vector<int>& kept() const { return kept_; }
  bool holds(int row) const { return flags_[row] != 0; }
  /// Number of times that a row was activated or released.
  int changes() const { return changes_; }

  /// Equalities alone; release counts start at zero.
  void reset();
  /// Equalities alone; release counts are kept.
  void release_inequalities();
  void activate(int row, bool upper);
  /// Activates inequalities beyond a bound by more than `outside`; a negative value also takes those within that
  /// distance of it inside. True if any was activated.
  bool activate_violated(const Evaluation& at, double outside);
  /// Activates inequalities at or beyond a bound.
  bool activate_touched(const Evaluation& at) { return activate_violated(at, -options_.touching); }

  enum class Release { none, released, cycling };
  /// Releases the active inequality whose multiplier has the wrong sign by most, if that is more than `least`: at an
  /// upper bound a multiplier is positive, at a lower one negative. One already released too often stays active and
  /// counts as cycling.
  Release release_wrong_sign(std::span<const double> multipliers, double least);

  /// c, or g minus the bound at which it is held.
  double gap(const Evaluation& at, int row) const;
  /// Gaps of the active rows, 0 of all others; one per constraint row.
  void gaps(const Evaluation& at, std::span<double> out) const;
  /// The largest of the gaps of active rows and the violations of inactive ones.
  double largest_gap(const Evaluation& at) const;
  /// Largest violation of the rows that are not considered.
  double largest_left_out(const Evaluation& at) const;
  /// Sets the multipliers of inactive rows to 0.
  void clear_inactive(std::span<double> multipliers) const;

  /// Where on the line from one point to another the first inactive inequality reaches its bound.
  struct Crossing {
    double fraction = 1.0;  ///< of the line; 1 if the end is beyond no bound by more than the touching distance
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
