#pragma once

#include <vector>

#include "solvers/problem.hpp"

namespace poise::solvers {

/// The conditions of a stationary point of a Problem as one square system of residuals in z = (x, y), y the
/// multipliers of the rows kept; defined in solvers/least_squares.hpp. Its sparse Jacobian is exact.
class StationarySystem {
 public:
  /// From x = start, y by least squares. `problem` must outlive this.
  StationarySystem(const Problem& problem, const std::vector<double>& start, const std::vector<int>& rows);

  int size() const { return static_cast<int>(residual_.size()); }
  const std::vector<double>& start() const { return start_; }
  /// Entries first_of(row) .. first_of(row + 1) - 1 of the Jacobian lie in the columns column_of(entry).
  int first_of(int row) const { return first_[row]; }
  int column_of(int entry) const { return entries_[entry].column; }

  void evaluate(const std::vector<double>& z);
  /// Computes the Jacobian at the point evaluated last.
  void differentiate();

  double residual(int row) const { return residual_[row]; }
  double slope(int entry) const { return slope_[entry]; }
  /// Largest residual, forces relative to 1 + max |F|, gaps without their weight. Infinite instead of NaN.
  double error() const;
  int evaluations() const { return evaluations_; }

  std::vector<double> x_of(const std::vector<double>& z) const;
  std::vector<double> multipliers_of(const std::vector<double>& z) const;

 private:
  enum class Kind { tangent, transposed, row, own };
  struct Entry {
    int row = 0;
    int column = 0;
    Kind kind = Kind::tangent;
    int source = 0;  // in the tangent or the Jacobian of the problem
    int kept = 0;    // which of the rows kept, Kind::row and Kind::own
  };

  int kept_rows() const { return static_cast<int>(kept_.size()); }
  void list_entries();
  void meet(int kept);

  const Problem& problem_;
  std::vector<int> kept_;
  int n_;
  Evaluation at_;
  bool evaluated_ = false;
  int evaluations_ = 0;
  std::vector<double> start_, y_, force_, tangent_, residual_, slope_;
  std::vector<double> by_row_, by_multiplier_;  // derivatives of the residual of each row kept
  std::vector<Entry> entries_;
  std::vector<int> first_;
};

}  // namespace poise::solvers
