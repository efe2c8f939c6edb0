#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace poise::judge {

/// Up to four coordinates, on the stack.
using Small = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 4, 1>;
using SmallSquare = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 4, 4>;

/// A contact that can only push: gap(q, t) >= 0. At an impact its rate becomes -restitution times that before.
/// With `friction`, |tangential impulse| <= friction times the normal one, against the rate along `tangent`.
struct OneSidedContact {
  std::string name;
  double restitution = 0.0, friction = 0.0;
};
/// Dry friction of constant size, or that of an element.
struct DryContact {
  double bound = 0.0;
};

/// A mechanism with contacts, with equations of motion of its own, M(q) q'' = Q(q, q', t) + sum J^T p, written by hand
/// for its kind.
struct ContactMechanism {
  std::string kind, scene;                 ///< the scene as text
  std::vector<std::string> names;          ///< what q is in the scene: bodies that turn and joints that slide
  std::vector<double> start, start_rates;  ///< of q
  double duration = 0.0, accuracy = 0.0;
  std::vector<OneSidedContact> contacts;
  std::vector<DryContact> rubs;
  std::vector<double> jumps;  ///< times at which loads jump, where steps end: friction would hide part of a step

  virtual ~ContactMechanism() = default;
  virtual SmallSquare mass(const Small& q) const = 0;
  /// Mean of Q from t to t + h, at q and v.
  virtual Small force(double t, double h, const Small& q, const Small& v) const = 0;
  virtual double gap(std::size_t contact, double t, const Small& q) const = 0;
  /// Derivative of the gap by q.
  virtual Small row(std::size_t contact, double t, const Small& q) const = 0;
  /// Derivative of the gap by t.
  virtual double driven_rate(std::size_t, double, const Small&) const { return 0.0; }
  /// The derivative by q of the way along a contact with friction.
  virtual Small tangent(std::size_t, const Small& q) const { return Small::Zero(q.size()); }
  virtual Small rub_row(std::size_t, const Small& q) const { return Small::Zero(q.size()); }
};

/// One to four freedoms: blocks on a rail that strike walls and each other, links that strike walls and floors or their
/// stops, slider cranks that strike a stop, points that fly and slide between floor and walls or hang on ropes,
/// followers that lift off cams, discs that are thrown into a room; with springs, dampers and dry friction, under loads
/// and drives that are sines, ramps, steps and tables.
std::unique_ptr<ContactMechanism> contact_mechanism(std::uint64_t seed);

/// Steps that know of no events: half of the way with the old rates, new rates by
///   M (v+ - v) = h Q + sum J^T p,   0 <= p  compl.  J v+ + restitution J v >= 0   of contacts whose gap is closed
///   there,
/// (J. J. Moreau 1988), and half of the way with these. A step in which a contact closes, or after which others press
/// or rub than before, is taken again at a quarter of its length, down to `shortest`; other steps are `longest`.
struct StepLengths {
  double longest = 0.0, shortest = 0.0;
};
struct SteppedMotion {
  std::vector<Small> q, v;  ///< at the times asked for
  std::int64_t steps = 0;
  bool complete = true;         ///< not given up after `most_steps`
  std::vector<double> impacts;  ///< times at which an open contact closed, of more than `least_impact` (m/s or rad/s)
};
inline constexpr std::int64_t most_steps = 4'000'000;
inline constexpr double least_impact = 1e-6;
SteppedMotion step_motion(const ContactMechanism& mechanism, const StepLengths& lengths,
                          const std::vector<double>& times);

/// What the program says beside that.
struct JudgedContacts {
  std::string kind;
  int exit_code = -1;
  bool confirmed = false;
  std::string why;              ///< what it says where it is not, or that it could not be judged
  bool judged = false;          ///< the steps came to an end
  std::optional<double> until;  ///< the first event that is not unique, s; only what is before is compared
  double error = 0.0;           ///< as printed
  double beyond = 0.0;          ///< largest |difference| / (error of the program + error of the steps)
  double apart = 0.0;           ///< that difference, rad or m
  double unknown = 0.0;         ///< and the error of the steps, from longer ones
  std::string where;            ///< coordinate and time of it
  int impacts = 0;              ///< of the steps
};
/// Runs `program`, a path of poise, in `folder`. `finer`: steps as much shorter.
JudgedContacts judge_contacts(std::uint64_t seed, const std::string& program, const std::string& folder,
                              double finer = 1.0);

/// What the program says of a motion that is `longer` times as long, at every event of it.
struct WatchedEvents {
  std::string kind;
  int exit_code = -1;
  bool confirmed = false;
  std::string why;  ///< what it says where it is not
  int events = 0, impacts = 0;
  double gained = -1.0;  ///< largest energy gained in an impact, over impulse times mean size of the rates
  double passed = 0.0;   ///< largest gap below zero, over what the error that is printed allows
  double depth = 0.0;    ///< of it, rad or m
  std::string where;
};
WatchedEvents watch_events(std::uint64_t seed, const std::string& program, const std::string& folder, double longer);

}  // namespace poise::judge
