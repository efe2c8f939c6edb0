#pragma once

#include <initializer_list>
#include <memory>
#include <optional>
#include <vector>

#include "model/mechanism.hpp"
#include "model/phasor_sum.hpp"
#include "solvers/interval.hpp"
#include "statics/all_equilibria/private/crossing_branches.hpp"
#include "statics/all_equilibria/private/element_peaks.hpp"
#include "statics/all_equilibria/private/merged_mechanism.hpp"
#include "statics/all_equilibria/private/newton_operator.hpp"
#include "statics/all_equilibria/private/off_branch.hpp"
#include "statics/model/static_model.hpp"

namespace poise {

using solvers::Interval;

/// A box of scaled coordinates: an interval each, angles unwrapped.
using CoordinateBox = std::vector<Interval>;

/// Width of its widest interval, rad or mechanism sizes.
double widest(const CoordinateBox& box);
/// The lower and the upper ends of its intervals.
std::vector<double> lower_corner(const CoordinateBox& box);
std::vector<double> upper_corner(const CoordinateBox& box);

/// Rounds of a loop whose bodies make full turns, in which springs on angles wind up. After N rounds angle i has made
/// N turns[i] full turns, and forces have changed by N change, since the springs are linear. A box with several rounds
/// is written as that of round zero.
struct Winding {
  std::vector<int> turns;
  std::vector<Interval> change;
};

/// Which stops are active: their rows must have that value, and their force presses. Others are between their limits
/// and have no force.
enum class StopState : signed char { at_lower = -1, inactive = 0, at_upper = 1, permanent = 2 };

/// Decides in interval arithmetic whether a box holds equilibria, with given stops active:
///
///   F_i(x) + sum_r y_r d c_r / d x_i = 0,   c_r(x) = b_r      (y of any size)
///
/// with r the rows of closures, of stops that hold a measure, and of active stops. Where `repeated` of these are
/// implied by others whatever the pose, as many are left out of balance, in each box those that are nearest to the
/// others.
///
/// Its functions need solvers::RoundingUp. Nothing is kept between calls but memory, so that each thread has its own.
/// docs/equilibria.md has the mathematics.
class BoxProver {
 public:
  /// `without_branch_of`: boxes are empty in which all equilibria are on its neutral branch
  /// (statics/all_equilibria/private/off_branch.hpp).
  BoxProver(const StaticModel& model, std::vector<StopState> stops, int repeated,
            const NeutralMotions* without_branch_of = nullptr);

  enum class Decision {
    empty,     ///< no equilibrium
    locked,    ///< closures nearly lose rank: an equilibrium has a multiplier above `joint_force`
    crossing,  ///< nothing is decided of a change point; the box is around it, and halves would tell no more
    unique,    ///< at most one, which exists: `at` is near it
    open       ///< nothing is decided; the box may be smaller
  };
  struct Verdict {
    Decision decision = Decision::open;
    std::vector<double> at{};
    double joint_force = 0.0;
    int split = 0;        ///< coordinate to be halved
    double split_at = 0;  ///< where
    /// Cuts there: of two copies of the box one keeps the lower part, the other the upper.
    void cut(CoordinateBox& lower, CoordinateBox& upper) const;
  };
  Verdict examine(CoordinateBox& box);
  /// Examines a box with several rounds, of which impossible ones are taken out of `rounds`; it does not decide that an
  /// equilibrium is unique. The mechanism must have no stops.
  Verdict examine(CoordinateBox& box, const Winding& winding, Interval& rounds);

  /// Narrows the box by closures alone. `empty`: it has no closed pose; `unique`: for given values of coordinates, as
  /// many as there are freedoms, at most one; else `open`.
  Verdict examine_closed_poses(CoordinateBox& box);

  /// Elements that may have no length in boxes that were found empty.
  const ElementPeaks& peaks() const { return peaks_; }

  /// Narrows the box by closures, and by the equations of balance of coordinates that are in no closure. False if it is
  /// empty.
  bool contract(CoordinateBox& box, bool balance = true);

 private:
  // c + sum of lengths along unit vectors, fixed in the frame of one angle, or in the ground (-1).
  struct Group {
    int angle = -1;
    Planar<Interval> constant{};
    struct Along {
      int length;
      Planar<Interval> direction;
    };
    std::vector<Along> lengths{};
    Interval direction{};  // of the constant
  };
  using Loop = std::vector<Group>;
  struct Gap {
    int coordinate = -1;
    double from = 0, to = 0;
  };

  // A row of balance that gives a coordinate from others, for certain where its stiffness for it excludes zero.
  struct Step {
    int row, gives;
    std::size_t entry;  // of the stiffness
  };

  // A loop that gives two coordinates from others.
  struct Dyad {
    std::size_t loop;
    int first, second;
  };
  // Derivatives of its gap by both, and by each driver what the other coordinates change in it; the last is the rest.
  struct DyadEquations {
    Planar<Interval> by_first{}, by_second{};
    std::vector<Planar<Interval>> others{};
  };

  // A force element along the distance of two points, and everything else.
  struct Distance {
    int element;
    Law law;
    PhasorSum<Interval> between;
    std::unique_ptr<Mechanism<Interval>> rest{};
  };

  std::vector<char> driving();
  Planar<Interval> arm(const Group& group, const CoordinateBox& box) const;
  Planar<Interval> term(const Group& group, const CoordinateBox& box) const;
  void turn(int angle, const CoordinateBox& box);
  bool contract_loop(const Loop& loop, CoordinateBox& box);
  bool contract_pair(const Loop& loop, std::size_t i, std::size_t j, CoordinateBox& box);
  bool contract_triangle(const Loop& loop, std::size_t i, std::size_t j, const Planar<Interval>& rest,
                         CoordinateBox& box);
  bool are_drivers_narrow(const CoordinateBox& box) const;
  bool contract_dyads(CoordinateBox& box);
  bool contract_dyad(const Dyad& dyad, CoordinateBox& box);
  bool contract_followed_triangle(const Dyad& dyad, CoordinateBox& box);
  bool follow(int i, const Interval& det, const std::vector<Interval>& by, CoordinateBox& box);
  void add_followed(const Group& group, const CoordinateBox& box, DyadEquations& to, const Dyad& dyad);
  template <class Take>
  void for_each_derivative(const Group& group, const CoordinateBox& box, const std::vector<Planar<Interval>>& units,
                           const Take& take);
  Planar<Interval> gap_at_middle(const Loop& loop) const;
  Planar<Interval> close_middle(const Dyad& dyad, const CoordinateBox& box);
  void set_middle(int i, double x, const CoordinateBox& box);
  void forget(int i, const CoordinateBox& box);
  Interval* followed(int i) { return &follow_[static_cast<std::size_t>(i) * (drivers_.size() + 1)]; }
  bool contract_balance(CoordinateBox& box);
  bool contract_stops(CoordinateBox& box);
  bool shoot(CoordinateBox& box);
  bool contract_arm(const Group& group, const Planar<Interval>& along, Planar<Interval>& others,
                    const Interval& square_of_length, CoordinateBox& box);
  bool narrow(CoordinateBox& box, int coordinate, const Interval& to);
  bool narrow_to_any(CoordinateBox& box, int angle, std::initializer_list<Interval> any);

  void evaluate(const CoordinateBox& box);
  bool choose_dependent();
  bool contract_rows(CoordinateBox& box);
  bool motions(CoordinateBox& box);
  bool balance_possible(CoordinateBox& box);
  bool balance_possible(const Winding& winding, Interval& rounds) const;
  bool solve_transposed(std::vector<Interval>& y) const;
  Decision near_singular(const CoordinateBox& box);
  bool may_touch_stops(const CoordinateBox& box);
  void look_for_crossing(const CoordinateBox& box);
  bool is_decided_by_crossing(CoordinateBox& box, Verdict& verdict);
  bool is_refused_by_elements(const CoordinateBox& box);
  void find_levers(Distance& on, const CoordinateBox& box);
  bool is_balanced_by(const Distance& on, const Planar<Interval>& d, const Interval& pull);
  bool is_passed(const Distance& on, const Interval& length, const Interval& pull);
  Decision newton(const CoordinateBox& box, CoordinateBox& out, std::vector<double>& at);
  std::vector<double> least_multipliers(const std::vector<double>& x) const;
  bool satisfies_other_rows(const CoordinateBox& solution);
  bool may_rest_on_stops(const CoordinateBox& solution);
  void split(const CoordinateBox& box, Verdict& verdict) const;

  const StaticModel& model_;
  const Mechanism<double>& plain_;
  MergedMechanism mechanism_;
  std::vector<Distance> distances_;
  ElementPeaks peaks_;
  std::vector<StopState> stops_;
  std::vector<int> rows_;       // constraint rows that hold; the first m_ are taken for independent
  std::vector<double> bounds_;  // their values
  std::vector<int> equation_;   // per constraint row, or -1
  int n_ = 0, m_ = 0, angles_ = 0;
  std::vector<Loop> loops_;
  std::vector<char> is_free_;           // coordinates in no row
  std::vector<char> drives_;            // coordinates that all others follow from
  std::vector<int> drivers_;            // these
  std::vector<Dyad> dyads_;             // how, where it is by loops, in order
  std::vector<Step> steps_;             // how, where it is by balance
  std::vector<int> parameters_;         // coordinates that no step gives
  std::vector<int> open_rows_;          // of balance, that are no step
  bool follows_ = false;                // all steps can be made in the box in hand
  std::vector<Planar<Interval>> unit_;  // per angle, of the box in hand
  int loose_ = -1;                      // a coordinate of the first dyad that does not follow and is wide by itself
  Gap gap_;
  std::vector<Interval> parts_;
  std::optional<NewtonOperator> newton_;  // made when a box is small enough for it
  std::optional<OffBranch> off_branch_;
  std::optional<CrossingBranches> crossings_;             // of rows whose value is zero
  std::vector<CrossingBranches::Region> regions_;         // that were found
  std::vector<std::vector<double>> looked_for_crossing_;  // near these
  // Workspace.
  std::vector<Planar<Interval>> pose_;
  std::vector<Interval> jacobian_, constraint_, force_, tangent_, multipliers_;
  std::vector<Interval> dense_;           // m x n
  std::vector<Interval> product_;         // R dense
  std::vector<Interval> stiffness_;       // n x n
  std::vector<Planar<Interval>> levers_;  // of an element, by freedom
  std::vector<Interval> along_;           // forces of everything else, by freedom
  std::vector<Interval> left_;            // (m + 1) x n: what elimination leaves of the Jacobian and the force
  CoordinateBox thin_;
  std::vector<Planar<Interval>> thin_unit_;
  DyadEquations dyad_;
  std::vector<Interval> dyad_by_;
  std::vector<Interval> follow_;  // n x (drivers + 1): dx / dp, and the last column what the middle leaves open
  std::vector<double> middle_, inverse_;
  std::vector<int> dependent_, free_columns_;
  double least_pivot_ = 0.0;
  std::vector<char> row_done_, column_done_;
  std::vector<Interval>
      motion_;  // n x (freedoms + 1): dx / dp, and the last column what closes the loops of the middle
};

}  // namespace poise
