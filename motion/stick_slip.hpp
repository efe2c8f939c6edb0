#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "motion/motion_model.hpp"
#include "motion/reduced_motion.hpp"
#include "motion/varied_model.hpp"

namespace poise {

/// Friction that sticks (DryFriction of width 0) in a motion. Between events every such element
///   slides in one direction s = 1 or -1:  T = s F,  s dg/dt >= 0,
///   or is held:                           g = const,  |T| <= F_s,  T as balance requires,
/// with F_s = F but where its law falls, and then F of the rate, so that the motion is smooth. An event is where s
/// dg/dt of an element that slides, or F_s - |T| of one that is held, falls to zero, and where the F of one that slides
/// turns into another branch of its formula. There every element without rate may slide in either direction or be held:
/// the one choice is taken whose accelerations and forces satisfy  s d2g/dt2 >= 0  and  |T| <= F_s.  Where several do,
/// because an acceleration or F - |T| is zero as it is where a force passes F, or at the end of a dwell, it is the one
/// for which  s dg/dt >= 0  and  |T| <= F  shortly after. Where F_s is above the F with which it begins to slide it
/// stays held where it can. Where F is constant the accelerations are those of a convex minimum, and unique. Of joints
/// F grows with the force in them (ReducedMotion): a choice has as many accelerations as its forces have solutions, all
/// of which are looked at (FrictionForces); those that are consistent must have the same, and the one taken must have
/// unique forces.
class StickSlip {
 public:
  /// The model must outlive this. `motion` is one of the model, for the teeth that it has.
  StickSlip(const MotionModel& model, const std::vector<Variation>& variations,
            const std::vector<Influence>& influences, const ReducedMotion<double>& motion);

  /// Whether the scene has such friction.
  bool acts() const { return !contacts_.empty(); }
  /// For ReducedMotion::set_sliding(): by the rates of `motion`, forwards where there is none.
  std::vector<int> directions(const ReducedMotion<double>& motion);
  /// Notes rates and accelerations at a node of the motion; the margin there.
  double watch(const ReducedMotion<double>& motion);
  /// Least of  s dg/dt / (largest rate yet),  1 - |T| / F  and of the margin of branches over the largest force yet:
  /// negative where an event has passed. After accelerate().
  double margin(const ReducedMotion<double>& motion);
  /// Where the rate of an element that slides in the same direction at the last node and at h after it, where
  /// `motion` is, passes zero twice between them by the cubic through both: the time after the node at which it is
  /// least. 0 if none does.
  double dip(const ReducedMotion<double>& motion, double h);
  /// Whether something is held whose force may pass its bound within a step.
  static bool holds(const ReducedMotion<double>& motion) { return !motion.held().empty(); }
  /// At the event found by the last margin(): keeps what event_time_by() needs.
  void meet(const ReducedMotion<double>& motion);
  /// For event_time_by() after an event at which the force of an element that is held passes F_s above F: that with the
  /// force F_s in place of being held has no acceleration there. Leaves `motion` as it is.
  void begin_to_slide(ReducedMotion<double>& motion, double t, double ahead);
  /// The derivative of the time of the event that was met along changes of q and v, and by an influence of the options
  /// if its index is not negative: -(d rate/dp) / (d2g/dt2), or the same of the acceleration with which an element that
  /// is held begins to slide where its force passes F_s, if F_s is above F; zero where accelerations do not jump, as
  /// where F = F_s, and where F turns.
  double event_time_by(const ReducedMotion<double>& motion, const double* dq, const double* dv, int influence);
  enum class Choice {
    made,
    failed,   ///< there are more than most_at_once elements without rate, or the equations fail
    locked,   ///< of all choices that are consistent the forces would be others soon: they are not unique; or not all
              ///< forces of some choice could be found, or no choice has any
    several,  ///< choices with different accelerations are consistent
    none      ///< none is
  };
  /// Makes one step by Runge and Kutta's formula of order 4, as the motion is set.
  static ReducedMotion<double>::Status advance(ReducedMotion<double>& motion, double t, double h);
  /// Chooses who slides and who is held from t on, and sets and accelerates `motion` so. Choices that agree at t are
  /// told apart by what they do up to `ahead` later. Call forget_event() when all is chosen.
  Choice choose(ReducedMotion<double>& motion, double t, double ahead);
  /// The event that was met lies behind.
  void forget_event() { met_ = turned_ = none; }
  /// The derivative of the value at which an element that is held stays.
  double held_value_by(const ReducedMotion<double>& motion, int element, const double* dq, int variation);

  static constexpr std::size_t most_at_once = 8;

 private:
  struct Contact {
    int element;
    double force;  // F_s, or its constant part
    bool drops;    // F_s is above the F with which it begins to slide
    CompiledMeasure<double> on;
    std::vector<CompiledMeasure<VariedModel::Dual>> varied;  // by variation
    double speed = 0.0;                                      // largest rate yet
    double rate = 0.0, acceleration = 0.0;                   // at the last node
    bool idle = false;  // it slides without rate: what is held or driven holds it, too
    int stop = -1;      // across which it acts where that is touched
  };
  // A size |R| with branches: of the force in a joint with friction, or of teeth that push their wheels apart.
  struct Branched {
    int element;  // of the joint, or behind the elements of the scene
    bool is_teeth;
    double load = 0.0;  // largest yet
    double turn = 0.0;  // ReducedMotion::branch_margin() at the last node
  };
  struct Trial {
    std::vector<int> sliding;
    std::vector<double> acceleration, force;  // of those without rate
    bool is_locked = false;                   // forces may be others than these
    double violation = 0.0;
  };
  static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
  Configuration<double> place(const CompiledMeasure<double>& on, const double* q);
  /// Whether it has no force, because what it acts across is not touched.
  static bool is_open(const Contact& contact, const ReducedMotion<double>& motion);
  /// The derivative of the value of a contact's measure, or of its rate, by the number of a variation.
  double value_by(const Contact& contact, const ReducedMotion<double>& motion, std::size_t variation) const;
  double rate_by(const Contact& contact, const ReducedMotion<double>& motion, std::size_t variation) const;
  double rate(const Contact& contact, const ReducedMotion<double>& motion);
  double acceleration(const Contact& contact, const ReducedMotion<double>& motion);
  /// The sum of the sizes of its terms.
  double size_of_acceleration(const Contact& contact, const ReducedMotion<double>& motion);
  double margin_of(const Contact& contact, const ReducedMotion<double>& motion);
  double turn_margin_of(const Branched& branched, const ReducedMotion<double>& motion);
  /// A state from which choices are tried.
  struct Node {
    double t;
    std::vector<double> q, v;
    std::vector<std::size_t> still;     // contacts without rate
    std::vector<double> rate, largest;  // rates of these, and the largest of their accelerations
    double fastest = 0.0;               // rate of a coordinate
  };
  double gain(const Contact& contact, const ReducedMotion<double>& motion, const Node& node, std::size_t k);
  double worst_after(ReducedMotion<double>& motion, const Node& node, const std::vector<int>& sliding, double h);
  const Trial* tell_apart(ReducedMotion<double>& motion, const Node& node, std::vector<const Trial*> trials,
                          double ahead);
  /// Leaves the trials that hold most of the contacts that drop.
  std::vector<const Trial*> that_hold(std::vector<const Trial*> trials, const std::vector<std::size_t>& still) const;
  void take_derivatives(ReducedMotion<double>& motion, const Contact& contact);
  bool is_carried(const Contact& contact, const ReducedMotion<double>& motion);
  ReducedMotion<double>::Status set(ReducedMotion<double>& motion, double t, const std::vector<double>& q,
                                    const std::vector<double>& v, const std::vector<int>& sliding) const;

  const MotionModel& model_;
  std::vector<Variation> variations_;
  std::vector<Influence> influences_;
  std::vector<Contact> contacts_;
  std::vector<Branched> branched_;
  bool grows_ = false;  // some F grows with a force
  std::vector<Planar<double>> pose_;
  std::size_t least_ = none;    // contact of the last margin()
  std::size_t met_ = none;      // of the event
  bool by_force_ = false;       // its force passes F, or F turns
  std::size_t turning_ = none;  // in branched_: the last margin() is that of its turn
  std::size_t turned_ = none;   // the same of the event
  std::vector<double> slope_,
      bend_;                    // by v and by q, of its rate, or of the acceleration with which it begins to slide
  std::vector<double> direct_;  // and by each influence
  struct OtherHeld {
    int element;
    double by;
  };
  std::vector<OtherHeld> others_;  // and by the values at which others are held
  double met_slope_ = 0.0;         // and by the time
};

}  // namespace poise
