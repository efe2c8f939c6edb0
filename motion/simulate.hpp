#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "motion/motion_model.hpp"
#include "motion/reduced_motion.hpp"
#include "motion/touch.hpp"
#include "motion/trajectory.hpp"

namespace poise {

/// Initial state of a motion: closed coordinates q and rates v, SI, n values each. Only the rates of the independent
/// coordinates are used, the others follow.
struct MotionState {
  std::vector<double> q, v;
};

/// A prescribed initial coordinate or rate of a motion.
struct StartValue {
  int coordinate = 0;  ///< of the model's layout, < kept
  bool rate = false;
  double value = 0.0;  ///< SI, absolute
};

/// Closes the loops of the scene's start, or takes the closed `q` (SI), and moves to the values `wanted` with the least
/// change of all other degrees of freedom; other independent rates are zero. Without `independent` flexible links begin
/// as they are bent in `q`, or straight, and with the least rates of bending (sums of squares over their springs,
/// weighted by the stiffness), as far as the joints and all that is wanted let them. Changes are those of the
/// coordinates `independent`, where given. Throws InputError if the loops cannot be closed there, or the values
/// contradict each other.
MotionState start_motion(const MotionModel& model, const std::vector<StartValue>& wanted,
                         const std::vector<double>* q = nullptr, const std::vector<int>* independent = nullptr);

struct MotionOptions {
  double duration = 1.0;  ///< s
  /// Relative to the travel and the speed of each coordinate: steps keep their error estimate below a thousandth of it,
  /// and the interpolation error below it.
  double accuracy = 1e-10;
  /// Compute sensitivities to the f initial independent coordinates, the f initial independent rates, then
  /// `influences`.
  bool sensitivities = false;
  /// Steps keep the errors of all sensitivities small, too, which may change where the motion itself hardly does.
  bool accurate_sensitivities = false;
  /// Initial choice of independent coordinates, if it is to be the same in several motions; empty: chosen.
  std::vector<int> independent{};
  std::vector<Influence> influences{};  ///< in the units of the scaled scene, per unit of the caller's number
  std::vector<Variation> variations{};  ///< that influences refer to
  /// Loads and drives that follow curves of time, SI. Steps end at the breaks of these curves.
  std::vector<MotionInput> inputs{};
  int most_steps = 10'000'000;
  const std::atomic<bool>* interrupt = nullptr;
  std::function<void(double)> progress{};  ///< called with the time reached, at every step
};

enum class MotionStatus {
  not_started,
  completed,
  interrupted,
  stuck,       ///< no step succeeds: a dead centre, or loops that open
  torn,        ///< a joint or drive opened whose equation repeated others at the start
  no_inertia,  ///< a degree of freedom has no inertia
  step_limit,
  lifted_off,  ///< what rolls would have to be pulled to what it rolls on
  ran_away,    ///< with controllers, rates grow beyond fastest_controlled
  jammed,      ///< a drive pushes against a stop, or a law of impact would add energy
};

std::string to_string(MotionStatus status);

/// A controlled mechanism with a faster coordinate runs away, and its motion ends: rad/s, or sizes of the mechanism/s.
inline constexpr double fastest_controlled = 1e5;

/// A pose of a motion in which its closures and drives lose rank.
struct SingularPlace {
  double time = 0.0;
  std::string text;      ///< "dead centre of the loop closed by "D": crank and rod are in line"
  std::string position;  ///< "crank = 0 deg, ram = 300 mm"
  std::string branch{};  ///< of one that is passed: how it goes on, "crank at 12.6 rad/s"
};

/// What happens at a limit of a stop at an instant of a motion; SI.
struct ContactEvent {
  enum class Kind {
    impact,    ///< the gap closes: an impulse
    rest,      ///< bounces that become ever shorter have ended: the limit is touched from here on
    lift_off,  ///< the force that keeps it touched has fallen to zero
    graze,     ///< the gap nearly closes, so nearly that whether it does is not known
    stick,     ///< across it nothing slides from here on: friction holds
    slide      ///< something slides that friction has held
  };
  double t = 0.0;
  Kind kind = Kind::impact;
  Touch at{};
  double rate_before = 0.0, rate_after = 0.0;  ///< of the gap: negative where it closes
  double impulse = 0.0;                        ///< N s or N m s
  double energy_lost = 0.0;                    ///< J
  std::vector<double> t_p{};                   ///< of an impact: dt/dp, a value for each sensitivity of the trajectory
  /// False where the motion that follows is one of several: several limits are hit at once and what happens depends on
  /// the order, or it grazes.
  bool unique = true;
};

std::string to_string(ContactEvent::Kind kind);

/// What is touched from a time on.
struct TouchedFrom {
  double t = 0.0;
  std::vector<Touch> touching;
};

/// A motion up to the time reached.
struct Motion {
  MotionStatus status = MotionStatus::not_started;
  std::string why;  ///< one sentence if it did not complete
  Trajectory trajectory;
  std::vector<int> independent;  ///< coordinates whose start values the sensitivities refer to
  std::vector<int> states;       ///< coordinates that are states of controllers
  /// Per node, J; work: done by drives, follower loads, resistances, and (negative) impacts.
  std::vector<double> kinetic, potential, work;
  std::vector<std::vector<double>> drive_force;  ///< per drive, per node: N m or N
  /// Per blade, per node, N: across its edge, to the left of it, on the body of its point.
  std::vector<std::vector<double>> blade_force;
  std::vector<ContactEvent> events;  ///< of stops, in their order
  std::vector<TouchedFrom> touched;  ///< changes of what is touched
  double energy_error = 0.0;  ///< largest |T + V - work - (T + V at start)| / largest energy exchanged; 0 at rest
  /// Largest gap of a joint, coupling or drive at any node, over the mechanism's size (of angles rad), and what it is
  /// of: 'pin "C"'. Those count too whose equations repeated others at the start.
  double gap = 0.0;
  std::string gap_of;
  int freedoms = 0;
  int steps = 0, rejected = 0, evaluations = 0;
  double microseconds = 0.0;
  std::vector<double> singular;              ///< times of passing singular poses, to about a hundredth of a step
  std::optional<SingularPlace> dead_centre;  ///< at which it ends: beyond it the drives cannot take the mechanism

  bool completed() const { return status == MotionStatus::completed; }
};

/// Integrates the motion from `start` under all forces and drives: the reduced equations of ReducedMotion by
/// RungeKutta78, loops closed at every stage, independent coordinates chosen anew where they are ill-conditioned.
/// Blades hold (ReducedMotion); what of their rates is rounding is taken out after each step. Throws InputError where
/// one could hold nothing, or not by itself, where the start goes across its edge, and for friction that sticks beside
/// them.
/// Stops act (Contacts): impacts, contact that lasts, and lift-off are events; throws InputError where it would begin
/// beyond one.
/// The friction of joints acts in a scene that is resisted_by_joints(); throws InputError for other scenes that have
/// some, where the forces that it depends on are not determined, and where drives ask for rates at the start that
/// contradict each other or the joints.
Motion simulate(const MotionModel& model, const MotionState& start, const MotionOptions& options);

/// What the singular poses are that a motion passed, of so many at most. Where branches of motion cross it went on
/// along the one on which rates go on.
std::vector<SingularPlace> singular_places(const MotionModel& model, const Motion& motion, std::size_t most);

/// The largest difference of two motions of one start, relative to the travel of each coordinate, or to this part of
/// that of the one that moves most where it is more: with one of them at a stricter accuracy, the error of the other.
double difference(const Motion& a, const Motion& b, double of_most = 1e-3);

}  // namespace poise
