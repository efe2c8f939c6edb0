#pragma once

#include <optional>
#include <string>
#include <vector>

#include "motion/forces_along.hpp"

namespace poise {

// Contacts of a mechanism with a given motion. A stop, a cam that may lift off, a rope and a chain that may go slack
// press on one side only: the effort Q on the measure g pushes away from the limit. A guided cam presses on either side
// of its groove. Let p = Q at a lower limit and -Q at an upper one; of a guided cam p = Q. A contact that lasts has
//
//   p >= 0     pressing
//   p <  0     what presses on one side would have to pull: it lifts off, or goes slack, and the motion is another
//
// and a guided cam changes sides where p changes its sign, so that its roller knocks through the clearance of the
// groove.

/// A contact.
struct Contact {
  std::size_t stop = 0;  ///< index into Scene::stops
  bool guided = false;   ///< a guided cam: it may also pull
  bool at_max = false;   ///< which limit; of a guided cam false
};

/// Where p changes its sign.
struct ContactChange {
  double at = 0.0;       ///< value of what varies, SI
  bool presses = false;  ///< from there on, p > 0
};

/// The force of one contact over a range, along a motion or in a pose; SI.
struct ContactCourse {
  Contact contact;
  double least = 0.0;     ///< of p; not a number where it is not known
  double least_at = 0.0;  ///< value of what varies there
  bool pulls = false;     ///< p is negative somewhere, by more than rounding
  std::vector<ContactChange> changes;
};

/// The smallest rate at which a contact would have to pull.
struct LiftOff {
  Contact contact;
  std::optional<double> rate;  ///< of the drive, rad/s or m/s; 0: it does at rest; none: at no rate
  double at = 0.0;             ///< value of the drive, SI
};

/// Cams that may lift off, ropes and chains that may go slack, where as many freedoms as they are, or more, are left
/// without a drive: with these contacts the drives determine the motion. Nothing elsewhere.
std::vector<Contact> contacts_to_hold(const Scene& scene);
/// The scene in which they cannot open.
Scene held_in_contact(Scene scene, const std::vector<Contact>& contacts);
/// `held`, and guided cams, in the order of the scene.
std::vector<Contact> contacts_along(const Scene& scene, const std::vector<Contact>& held);

/// The forces of contacts over a range as of forces_over(), with whose poses, `found`, it begins. Places are found to
/// rounding, those of least forces to 1e-9 of the range.
std::vector<ContactCourse> contact_courses(const MotionModel& model, const std::vector<DriveRange>& ranges,
                                           const SweepOptions& options, bool moving,
                                           const std::vector<Contact>& contacts, const ForcesAlong& found);
/// Gives the forces in one pose, or along a motion that is given at times, between which p is the polynomial through
/// the six samples around. Stops that would have to pull are among them too.
std::vector<ContactCourse> contact_courses(const Scene& scene, const std::vector<Contact>& contacts,
                                           const ForcesAlong& found);

/// The smallest rates over a range. At a place p is A + B w + C w^2 in the rate w, but for friction, and its least
/// positive root is found by Newton's method on such parabolas; the least over the range is an extreme, at a place
/// found to 1e-9 of the range.
std::vector<LiftOff> lift_offs(const MotionModel& model, const std::vector<DriveRange>& ranges,
                               const SweepOptions& options, const std::vector<Contact>& contacts);

}  // namespace poise
