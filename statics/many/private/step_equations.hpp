#pragma once

#include <string>
#include <utility>
#include <vector>

#include "model/mechanism.hpp"
#include "model/recorded.hpp"

namespace poise {

/// A stop that acts, and on which side.
struct HeldStop {
  int stop = 0;
  bool upper = false;
};

/// A step of Newton's method on the equations of virtual work (solve_many.hpp), recorded.
struct RecordedStep {
  std::vector<Recorded> step;
  /// Pivots are no small part of what they are at the answer, and of that sign; stops that act press, others are free.
  RecordedMask is_good{true};
  /// The stops that act are touched, or would be passed.
  RecordedMask is_touched{true};
};

/// The equations of a mechanism whose stops `held` act, with an order of elimination that is chosen where they are
/// recorded first: at the answer of the scene as it is.
class StepEquations {
 public:
  StepEquations(const Mechanism<Recorded>& mechanism, std::vector<HeldStop> held)
      : mechanism_(mechanism), held_(std::move(held)) {}

  RecordedStep at(const std::vector<Recorded>& x);
  /// Why they cannot be used, in one sentence, after the first at(); empty where they can.
  const std::string& why_not() const { return why_not_; }

 private:
  struct Row {
    int row = 0;
    bool is_bound = false, upper = false;
    int stop = -1;
  };
  using Matrix = std::vector<std::vector<Recorded>>;

  void list_rows();
  void evaluate(const std::vector<Recorded>& x);
  void eliminate();
  void choose_pivot(const std::vector<char>& row_used, const std::vector<char>& column_used, double least);
  void find_multipliers();
  void reduce();
  std::vector<Recorded> solve_reduced();
  void add_pivot(const Recorded& pivot, bool is_positive);
  void check_stops(RecordedStep& out);

  const Mechanism<Recorded>& mechanism_;
  std::vector<HeldStop> held_;
  std::string why_not_;
  bool is_chosen_ = false;
  std::vector<Row> rows_;
  std::vector<int> pivot_row_, pivot_column_;  // in order
  std::vector<int> independent_;               // coordinates
  std::vector<double> nominal_;                // pivots at the answer, in the order of their checks
  std::size_t next_nominal_ = 0;
  std::vector<double> pressing_;  // efforts of held_ at the answer

  std::vector<Planar<Recorded>> pose_;
  std::vector<Recorded> constraint_, force_, multiplier_;
  Matrix work_;   // rows x (coordinates, gap), eliminated
  Matrix lower_;  // rows x pivots: multiples that were subtracted
  std::vector<Recorded> inverse_;
  Matrix motion_;                // N: coordinates x independent
  std::vector<Recorded> close_;  // p
  Matrix reduced_;
  std::vector<Recorded> reduced_force_;
  RecordedMask good_{true};
};

}  // namespace poise
