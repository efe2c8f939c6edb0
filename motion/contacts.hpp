#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "motion/impact.hpp"
#include "motion/motion_model.hpp"
#include "motion/reduced_motion.hpp"
#include "motion/stick_slip.hpp"
#include "motion/varied_model.hpp"

namespace poise {

/// The stops of a scene in motion: each limit of one that does not hold its measure is a side with a gap
///   max - g  or  g - min,  >= 0.
/// A side is open, or touched: then its measure is held at the limit (ReducedMotion::set_touching()) by a force that
/// only pushes. An event is where the gap of an open side, or the force of a touched one, falls to zero. Where gaps
/// close, impulses keep them from it (impact()); then of all sides whose gap and rate are zero those are touched whose
/// forces push while the gaps of the others do not close:
///   0 <= force  complementary to  second derivative of the gap >= 0.
/// Where several choices do, because a force or an acceleration is zero as it is where a force passes zero, it is the
/// one that goes on doing so shortly after.
class Contacts {
 public:
  /// The model must outlive this.
  Contacts(const MotionModel& model, const std::vector<Variation>& variations);

  /// Whether the scene has such stops.
  bool act() const { return !sides_.empty(); }
  /// Throws InputError where a gap is negative at the coordinates q, by more than `within` (sizes of the mechanism,
  /// rad; 0: rounding): the motion would begin inside a stop.
  void refuse_start(const double* q, double within = 0.0);
  /// Notes gaps, their rates and accelerations at a node of the motion.
  void watch(const ReducedMotion<double>& motion);
  /// Least force of the sides that are touched, over the largest force yet: negative where one would have to pull.
  /// After accelerate().
  double force_margin(const ReducedMotion<double>& motion);
  /// After force_margin(): the side of the least, none where nothing is touched.
  std::optional<Touch> least() const;
  /// The first time after the last node, up to h where `motion` is, at which the gap of an open side falls to zero by
  /// the polynomials through gaps, rates and accelerations at both ends; 0 if none does.
  double first_hit(const ReducedMotion<double>& motion, double h);
  /// The change of time by which the gap of the side found by first_hit() is zero, from where `motion` is, and its gap.
  struct Miss {
    double gap = 0.0, time = 0.0;
  };
  Miss miss(const ReducedMotion<double>& motion);
  /// The gap of that side at the last node.
  double gap_before() const { return sides_[hit_].gap; }
  /// A gap, its rate and acceleration, and CompiledMeasure::place() of its measure.
  struct End {
    double gap = 0.0, rate = 0.0, acceleration = 0.0;
    std::optional<Planar<double>> place{};
    double turned = 1.0;  ///< of a curved side that is touched: cosine between its slope and that at the last node
  };
  /// The ends of all sides where `motion` is.
  std::vector<End> ends(const ReducedMotion<double>& motion);
  /// Whether first_hit() would follow the gaps in a step of h that ends in `ends`, half-way in which `motion` is: they
  /// do not close on the way from place to place; or this way is short for what the outline or distance is like, and
  /// gaps are those of the polynomials, or far from zero in comparison. Where nothing `turns` far the gaps of other
  /// measures are taken to be. What is touched must not turn far: it could go on as if it touched elsewhere.
  bool are_followed(const ReducedMotion<double>& motion, double h, const std::vector<End>& ends, bool turns);
  /// Whether some gap is no polynomial of lengths.
  bool are_curved() const { return are_curved_; }
  /// The least distance by which a gap passed zero since the last node without touching: its polynomial comes nearer to
  /// zero than `within` and rises again. None if none does.
  std::optional<Touch> grazed(const ReducedMotion<double>& motion, double h, double within);

  /// An impact where `motion` is.
  struct Hit {
    enum class Outcome { none, done, pushed, gains } outcome = Outcome::none;
    std::vector<std::size_t> sides;  ///< whose gaps are zero
    std::vector<ImpactSide> before;  ///< what they have before it
    Impact impact;
    double work = 0.0;         ///< of drives, and of the sides (negative)
    std::vector<double> jump;  ///< of the rates of all coordinates
    std::size_t first = none;  ///< the side that the event is of
  };
  /// Lets gaps that close at the coordinates q and rates v rebound, those of the sides `plastic` without restitution.
  Hit hit(ReducedMotion<double>& motion, double t, const std::vector<double>& q, const std::vector<double>& v,
          const std::vector<char>& plastic = {});
  /// A change of what a jump follows from: of the pose, of the rates before, and of what an influence of the scene says
  /// unless null.
  struct JumpChange {
    const double* dq = nullptr;
    const double* dv = nullptr;
    const Influence* influence = nullptr;
    double* jump = nullptr;  ///< where the derivative of the jump along it is put, a value for each coordinate
  };
  /// After hit(), of the same arguments: the derivatives of the jump.
  void change_jump(ReducedMotion<double>& motion, const Hit& hit, double t, const std::vector<double>& q,
                   const std::vector<double>& v, const std::vector<JumpChange>& changes);
  /// The derivative of the time at which the gap of a side falls to zero, at the rates v of all coordinates, along a
  /// change of q and by a number if `variation` is not negative.
  double hit_time_by(const ReducedMotion<double>& motion, std::size_t side, const double* v, const double* dq,
                     int variation);
  /// After watch(): whether a gap is zero.
  bool is_near() const;
  /// The acceleration of the gap of a side where `motion` is.
  double acceleration(std::size_t side, const ReducedMotion<double>& motion);
  double rebound(std::size_t side) const { return stop_of(sides_[side]).rebound(); }
  /// Coordinates that are angles on which gaps depend.
  const std::vector<int>& angles() const { return angles_; }
  /// Chooses what is touched, and friction, from t on at the coordinates q and rates v; sets and accelerates `motion`
  /// so. `left` is a side whose force has just fallen to zero.
  StickSlip::Choice choose(ReducedMotion<double>& motion, StickSlip& friction, double t, double ahead,
                           const std::vector<double>& q, const std::vector<double>& v, std::optional<Touch> left);

  /// What is known of a side at the last choice.
  struct Side {
    Touch at;
    CompiledMeasure<double> on;
    std::vector<CompiledMeasure<VariedModel::Dual>> varied;         // by variation
    std::optional<CompiledMeasure<double>> slip{};                  // along which it rubs
    std::vector<CompiledMeasure<VariedModel::Dual>> varied_slip{};  // by variation
    double limit = 0.0;
    bool curved = false;                               // no polynomial of lengths
    double feature = 0.0;                              // of a measure with a place: size of what it may pass
    std::optional<Planar<double>> place{};             // at the last node
    std::vector<double> slope{};                       // there, of a curved side that is touched
    double gap = 0.0, rate = 0.0, acceleration = 0.0;  // at the last node
    double speed = 0.0;                                // largest rate yet
    bool touched = false;
    bool idle = false;  // nothing changes its gap, which is zero
  };
  const std::vector<Side>& sides() const { return sides_; }
  /// "stop \"end\" (max)".
  std::string name_of(const Touch& at) const;

  static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

 private:
  struct Gap {
    double value, rate, acceleration;
  };
  Configuration<double> place(const double* q);
  /// Reads the gradient of a side's measure, by the coordinates of its support.
  static void read_slope(const Side& side, const Configuration<double>& here, std::vector<double>& slope);
  static double sign(const Side& side) { return side.at.upper ? -1.0 : 1.0; }
  static double gap(const Side& side, const Configuration<double>& at);
  /// The rate of the gap at the rates v of all coordinates.
  static double rate(const Side& side, const Configuration<double>& at, const double* v);
  /// `here` is where `motion` is.
  static Gap gap_of(const Side& side, const Configuration<double>& here, const ReducedMotion<double>& motion);
  const Stop& stop_of(const Side& side) const;
  /// The rate of a gap that is none, at these rates of all coordinates.
  static double still(const Side& side, const std::vector<double>& v);
  static bool is_moved(const Side& side, const Configuration<double>& here, const ReducedMotion<double>& motion);
  ReducedMotion<double>::Status set(ReducedMotion<double>& motion, StickSlip* friction, double t,
                                    const std::vector<double>& q, const std::vector<double>& v,
                                    const std::vector<std::size_t>& touched);
  /// The slopes of the gaps of these sides, then, if any rub, those along which they do; n values each.
  std::vector<double> slopes_of(const std::vector<std::size_t>& sides, const Configuration<double>& here) const;
  /// The derivatives of these along a change, at the coordinates q, which are `here`.
  std::vector<double> slope_changes(const std::vector<std::size_t>& sides, const Configuration<double>& here,
                                    const double* q, const JumpChange& change) const;
  static double mobility(const Side& side, const Configuration<double>& here, const ReducedMotion<double>& motion);
  double violation_of(const std::vector<std::size_t>& candidates, const std::vector<std::size_t>& touched,
                      const ReducedMotion<double>& motion);

  const MotionModel& model_;
  std::vector<Variation> variations_;
  std::vector<Side> sides_;
  std::vector<int> angles_;
  ImpactLaw law_ = ImpactLaw::energetic;
  bool rubs_ = false, are_curved_ = false;
  std::vector<Planar<double>> pose_;
  std::size_t least_ = none, hit_ = none;
  double strongest_ = 0.0;  // force yet
};

}  // namespace poise
