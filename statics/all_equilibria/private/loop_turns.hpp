#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "solvers/random_stream.hpp"
#include "statics/all_equilibria/turns.hpp"
#include "statics/model/static_model.hpp"

namespace poise {

/// The full turns that the bodies of loops can have made, where springs or stops tell turns apart. A body in a loop
/// that cannot turn round keeps its turns for ever: the same pose with one turn more is that of another mechanism,
/// whose spring was wound by a turn before its last pin went in. So only poses that motion from the scene's start leads
/// to count, and of other assembly modes those that motion leads to from their pose and turns with springs on angles
/// least wound and stops on angles not passed, as far as turns can do that, and of these turns those next to the start.
///
/// Known of mechanisms with one freedom, whose poses are curves  c(x) = 0,  followed all round by steps of `step`,
/// shorter ones where curves come near to each other, and of those that cannot move. Others are taken to reach
/// everything. Along the curves the equilibria are the places where the force changes its sign.
class LoopTurns {
 public:
  static constexpr double step = 0.03;      ///< rad or mechanism sizes
  static constexpr double far_away = 20.0;  ///< mechanism sizes: a curve that goes on for ever

  /// `turns` must outlive this; `start` is closed.
  LoopTurns(const StaticModel& model, const Turns& turns, const std::vector<double>& start);

  /// Whether springs or stops tell turns of loops apart, and whether it is known which ones count: the mechanism has
  /// one freedom at most, and no curves of its poses cross, where it could go from one to the other.
  bool matter() const { return matter_; }
  bool known() const { return matter_ && freedoms_ <= 1 && is_certain_; }
  /// Follows the curve through the closed pose x, turned so that its least energy is the least at any turns, unless the
  /// curve is one of those that are known, whatever its turns.
  void add(const std::vector<double>& x);
  /// The closed pose at the turn in which it is on a known curve; as it is if it is on none.
  std::vector<double> at_known_turn(std::vector<double> x) const;
  /// Whether a pose on a known curve is between limits of all coordinates, full turns of angles left out.
  bool passes(const std::vector<double>& lower, const std::vector<double>& upper) const;
  /// Called where it is found that curves may be missing: then they are not known().
  void doubt() { is_certain_ = false; }
  /// Whether the mechanism has one freedom, and is small enough for its curves to be followed, whether turns matter or
  /// not.
  bool is_followed() const { return is_followed_; }
  std::size_t curves() const { return courses_.size(); }
  /// Rounds that are followed each way, of a curve along which bodies make full turns.
  static constexpr int most_rounds = 8;
  bool winds() const;
  /// The least and greatest value of every coordinate on a known curve, and the full turns that it makes in one round;
  /// `rounds` each way are followed, none of a curve on which no body makes full turns.
  struct Range {
    std::vector<double> lower, upper;
    std::vector<int> turns;
    int rounds = 0;
  };
  std::vector<Range> ranges() const;
  /// Poses where the force along the curves changes its sign, at several turns where the mechanism goes round.
  std::vector<std::vector<double>> changes_of_force() const;
  /// Whether motion leads to the closed pose x; true if it is on no curve that is known.
  bool reaches(const std::vector<double>& x) const;
  /// The closed pose near x by shortest steps, stops left out; empty where they do not converge.
  std::vector<double> closed(std::vector<double> x) const;
  /// Largest difference of coordinates, full turns of angles left out.
  double distance(const std::vector<double>& a, const std::vector<double>& b) const;
  /// A pose on one of the curves, at a turn at random where the mechanism goes round.
  std::vector<double> pose(solvers::RandomStream& random) const;

 private:
  struct Course {
    std::vector<std::vector<double>> poses;
    std::vector<double> period;  // change of x after one round, of a curve that does not close zero
  };
  class WoundSprings;
  static bool winds(const Course& course);
  Course follow(const std::vector<double>& x);
  struct Step {
    std::vector<double> to, along;
    double length = 0.0;
  };
  std::optional<Step> step_from(const std::vector<double>& at, const std::vector<double>& along) const;
  bool is_singular(const std::vector<double>& x, double pivot) const;
  std::pair<std::vector<double>, double> least_wound(std::vector<double> x, WoundSprings& wound) const;
  std::vector<double> tangent(const std::vector<double>& x, const std::vector<double>& like) const;
  double force_along(const std::vector<double>& x, const std::vector<double>& way) const;
  std::vector<double> change_between(std::vector<double> a, std::vector<double> b,
                                     const std::vector<double>& way) const;
  std::vector<double> turned(const Course& course, std::size_t pose, int rounds) const;

  const StaticModel& model_;
  const Turns& turns_;
  std::vector<double> start_;
  std::vector<int> rows_;  // that hold in every pose
  int freedoms_ = 0;
  bool matter_ = false, is_followed_ = false;
  bool is_certain_ = true;  // no curves cross, and each was followed all round or so far that it goes on for ever
  std::vector<Course> courses_;
};

}  // namespace poise
