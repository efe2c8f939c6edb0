#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "model/profile.hpp"
#include "motion/motion_model.hpp"
#include "motion/reduced_motion.hpp"
#include "motion/varied_model.hpp"

namespace poise {

/// Where a motion passes from one piece of a profile (Profile) to the next: there derivatives of accelerations jump, or
/// accelerations themselves, so that no step of an integrator may reach beyond. For terms  P((g - shift) / span)  of
/// stops that hold, drives and force elements: between borders the argument u of each is within its piece.
class ProfileBorders {
 public:
  /// The model must outlive this.
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
  /// u of one term, in the numbers of the scene or of a variation.
  template <class T>
  struct Place {
    CompiledMeasure<T> on;
    ProfileOf<T> of;

    T value(const Configuration<T>& at) const { return (on.value(at) - of.shift) / of.span; }
  };
  struct Argument {
    Place<double> at;
    std::vector<Place<VariedModel::Dual>> varied;  // by variation
    double lower = -std::numeric_limits<double>::infinity();
    double upper = std::numeric_limits<double>::infinity();
  };
  Configuration<double> here(const ReducedMotion<double>& motion);
  static void note(Argument& argument, double u, double rate);
  /// The derivative by the number of a variation of the border that is nearest to u, less that of u.
  double border_less_argument_by(const ReducedMotion<double>& motion, const Argument& argument, std::size_t variation,
                                 double u) const;

  const MotionModel& model_;
  std::vector<Variation> variations_;
  std::vector<Argument> arguments_;
  std::vector<Planar<double>> pose_;
  std::size_t least_ = 0;  // argument of the last margin()
};

}  // namespace poise
