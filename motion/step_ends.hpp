#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

#include "motion/contacts.hpp"
#include "motion/motion_step.hpp"
#include "motion/profile_borders.hpp"
#include "motion/stick_slip.hpp"

namespace poise {

/// Finds where a step that was made passes an event of friction or contact or a border of a profile, and repeats it up
/// to there.
/// Private to simulate().
class StepEnds {
 public:
  /// All must outlive this.
  StepEnds(ReducedMotion<double>& reduced, MotionStep& step, StickSlip& friction, Contacts& contacts,
           ProfileBorders& borders)
      : reduced_(reduced),
        step_(step),
        friction_(friction),
        contacts_(contacts),
        borders_(borders),
        n_(static_cast<std::size_t>(reduced.coordinates())) {}

  /// Notes the margins at a node.
  void watch();

  /// Shortens the step just made from t to where the gap of a stop falls to zero. False if none does.
  bool meets_hit(double t);
  /// Shortens the step just made from t to the first event in it at which the force of something held or touched
  /// passes its bound, or the rate of something that slides zero. False if there is none.
  bool meets_event(double t);
  /// Whether the event just met is that of this margin: of friction, or else of a contact.
  bool is_of_friction();
  /// Whether something held or touched at the last node is beyond its bound already, as where accelerations have
  /// jumped.
  bool is_past() const { return margin_ < -stepping::past; }

  struct Border {
    bool is_reached = false;
    double rest = 0.0;  ///< of the way to it, s, where the step ends short of it
  };
  /// Shortens the step just made from t to where it passes a border of a profile, or to short of it.
  Border meets_border(double t);
  /// The steps towards a border ahead begin anew.
  void forget_approach() { approaches_ = 0; }

 private:
  // Nothing is known of friction before it is decided what is at rest.
  double friction_margin() {
    return reduced_.sliding() == nullptr ? std::numeric_limits<double>::infinity() : friction_.margin(reduced_);
  }
  double margin() { return std::min(friction_margin(), contacts_.force_margin(reduced_)); }
  double turned() const;
  bool follows_gaps(double t, bool turns);
  void state_within(double x);
  double margin_within(double t, double x);
  double first_passing(double t, double margin_at_end);

  ReducedMotion<double>& reduced_;
  MotionStep& step_;
  StickSlip& friction_;
  Contacts& contacts_;
  ProfileBorders& borders_;
  std::size_t n_;
  double margin_ = 0.0;         // of friction and contacts at the last node
  double border_margin_ = 0.0;  // of the borders of profiles, there
  int approaches_ = 0;          // steps that ended short of the border ahead
  std::vector<double> end_;     // coordinates at the end of the step just made
  std::vector<double> within_;  // z and w within it
};

}  // namespace poise
