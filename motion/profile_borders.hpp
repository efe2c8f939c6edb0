#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "model/profile.hpp"
#include "motion/motion_model.hpp"
#include "motion/reduced_motion.hpp"
#include "motion/varied_model.hpp"

namespace poise {

/// Where a motion passes from one piece of a profile (Profile), or of the law of a force element, to the next: there
/// derivatives of accelerations jump, or accelerations themselves, so that no step of an integrator may reach beyond.
/// For terms  P((g - shift) / span)  of stops that hold, drives and force elements, and for laws with borders of their
/// measure g or of its rate (model/laws/law_force.hpp): between borders the argument u of each is within its piece. Of
/// a law it is g, or the rate over the largest yet. Controllers change at the ends of their dead band, where u is the
/// error, and at their limits, where it is the effort without them; over the size of these, or of its terms if more.
class ProfileBorders {
 public:
  /// The model must outlive this.
  ProfileBorders(const MotionModel& model, const std::vector<Variation>& variations,
                 const std::vector<Influence>& influences);

  /// Whether the scene has profiles or laws of more than one piece.
  bool act() const { return !arguments_.empty(); }
  /// Notes the piece that each argument is in, at a border that into which it moves.
  void watch(const ReducedMotion<double>& motion);
  /// Least distance of an argument from the ends of the piece noted: negative where it has left it.
  double margin(const ReducedMotion<double>& motion);
  /// Of the argument of the last margin(): the time in which it moves by 3e-13.
  double nudge(const ReducedMotion<double>& motion);
  /// The time by which the state must go on to be behind a border that an argument is at; 0 where none is at one.
  double nudge_at_border(const ReducedMotion<double>& motion);
  /// The derivative of the time at which the argument found by margin() passes its border u_k along changes of q
  /// and v, and by an influence if its index is not negative:  -(du/dp - du_k/dp) / (du/dt).
  double passing_time_by(const ReducedMotion<double>& motion, const double* dq, const double* dv, int influence);

 private:
  /// u of one term, in the numbers of the scene or of a variation.
  template <class T>
  struct Place {
    CompiledMeasure<T> on;
    ProfileOf<T> of;

    T value(const Configuration<T>& at) const { return (on.value(at) - of.shift) / of.span; }
  };
  /// The measure of a law, or its rate.
  struct OfLaw {
    int element;
    bool is_rate;
    CompiledMeasure<double> on;
    std::vector<CompiledMeasure<VariedModel::Dual>> varied;  // by variation
    std::vector<double> borders;
    double size = 1.0;  // of u
  };
  /// The error of a controller, or its effort.
  struct OfController {
    int element;
    bool is_effort;
    std::vector<double> borders;
    double size = 1.0;  // of u
  };
  struct Argument {
    Place<double> at;
    std::vector<Place<VariedModel::Dual>> varied;  // by variation
    std::optional<OfLaw> law{};                    // in place of a profile
    std::optional<OfController> controller{};
    double lower = -std::numeric_limits<double>::infinity();
    double upper = std::numeric_limits<double>::infinity();
  };
  void add_laws(const MotionModel& model, int& scratch);
  void add_controllers();
  /// The sum of the sizes of the terms of its argument, to which that is rounded.
  double terms_of(const OfController& controller, const ReducedMotion<double>& motion) const;
  /// Its law with all numbers at the time, and what it knows, with rates of change.
  struct Known {
    ControllerOf<Tangent<double>> law;
    ControlSignals<Tangent<double>> in;
  };
  Known known_by(int element, const ReducedMotion<double>& motion, bool all) const;
  Tangent<double> in_time(const OfController& controller, const ReducedMotion<double>& motion) const;
  Configuration<double> here(const ReducedMotion<double>& motion);
  double value(const Argument& argument, const Configuration<double>& at, const ReducedMotion<double>& motion) const;
  double rate(const Argument& argument, const Configuration<double>& at, const ReducedMotion<double>& motion) const;
  template <class Use>
  static void for_borders(const Argument& argument, double u, Use use);
  static void note(Argument& argument, double u, double rate);
  double law_passing_time_by(const ReducedMotion<double>& motion, const OfLaw& law, const double* dq, const double* dv,
                             int influence);
  double border_of_law_by(const OfLaw& law, std::size_t border, const Influence& influence) const;
  /// The derivative by the number of a variation of the border that is nearest to u, less that of u.
  double border_less_argument_by(const ReducedMotion<double>& motion, const Argument& argument, std::size_t variation,
                                 double u) const;

  const MotionModel& model_;
  std::vector<Variation> variations_;
  std::vector<Influence> influences_;
  std::vector<Argument> arguments_;
  mutable std::vector<Planar<double>> pose_;
  std::size_t least_ = 0;  // argument of the last margin()
};

}  // namespace poise
