#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "model/profile.hpp"
#include "motion/motion_model.hpp"
#include "motion/reduced_motion.hpp"

namespace poise {

/// Where a motion passes from one piece of a profile (Profile) to the next: there derivatives of accelerations jump, or
/// accelerations themselves, so that no step of an integrator may reach beyond. For terms  P((g - shift) / span)  of
/// stops that hold, drives and force elements: between borders the argument u of each is within its piece.
class ProfileBorders {
 public:
  /// Both must outlive this.
  ProfileBorders(const MotionModel& model, const std::vector<Variation>& variations);

  /// Whether the scene has profiles of more than one piece.
  bool act() const { return !arguments_.empty(); }
  /// Notes the piece that each argument is in, at a border that into which it moves.
  void watch(const ReducedMotion<double>& motion);
  /// Least distance of an argument from the ends of the piece noted: negative where it has left it.
  double margin(const ReducedMotion<double>& motion);
  /// Of the argument of the last margin(): the time in which it moves by 3e-13.
  double nudge(const ReducedMotion<double>& motion);
  /// Of the same: the derivative of the time at which it passes the border u_k along a change of q, and by a number if
  /// `variation` is not negative:  -(du/dp - du_k/dp) / (du/dt).
  double passing_time_by(const ReducedMotion<double>& motion, const double* dq, int variation);

 private:
  /// u of one term, in one scene.
  struct Place {
    CompiledMeasure<double> on;
    double shift = 0.0, span = 1.0;
    const Profile* profile = nullptr;
  };
  struct Argument {
    Place at;
    std::vector<std::vector<Place>> varied;  // by variation and piece
    double lower = -std::numeric_limits<double>::infinity();
    double upper = std::numeric_limits<double>::infinity();
  };
  Configuration<double> here(const ReducedMotion<double>& motion);
  static double value(const Place& place, const Configuration<double>& at) {
    return (place.on.value(at) - place.shift) / place.span;
  }
  static void note(Argument& argument, double u, double rate);
  /// Of the profile of another place of the same term the border that is nearest in this one's.
  static double border_of(const Place& other, const Place& here, double u);

  const MotionModel& model_;
  const std::vector<Variation>& variations_;
  std::vector<Argument> arguments_;
  std::vector<Planar<double>> pose_;
  std::size_t least_ = 0;  // argument of the last margin()
};

}  // namespace poise
