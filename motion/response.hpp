#pragma once

#include <complex>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "model/parameters.hpp"
#include "motion/control_loop.hpp"
#include "motion/modes.hpp"
#include "motion/small_motions.hpp"
#include "solvers/root.hpp"
#include "statics/quantities/quantity.hpp"

namespace poise {

/// A number of a scene that swings about its value:  p = p0 + a cos(2 pi f t).
struct Excitation {
  std::string path;  ///< "load.P", "spring.mounts.free_length"
  Dimension dimension;
  ForceNumber number;

  bool is_load() const { return number.of != ForceNumber::Of::element; }
};

/// The excitation by the number of a path: the size of a load, a number of an element that stores energy, or the
/// reference of a controller. Throws InputError for all other numbers, and for a force without direction.
Excitation excitation_of(const Scene& scene, const std::string& path);

/// The scene of statics, at the time t = 0, in which a force that is zero then keeps the direction that it is written
/// with.
Scene scene_at_rest(Scene scene);

/// Throws InputError "NAME: why" for a quantity whose response is not known: all but measures, forces of elements that
/// store energy, their rates by time, and what is made of these by arithmetic.
void refuse_without_response(const Scene& scene, const SoughtQuantity& of);

/// Where the amplitude over the frequency is greatest or least.
struct Resonance {
  enum class Kind {
    peak,      ///< a maximum
    least,     ///< a minimum
    rest,      ///< a minimum at which the quantity rests
    unbounded  ///< the natural frequency of an undamped mode
  };
  Kind kind = Kind::peak;
  double frequency = 0.0;        ///< Hz
  std::complex<double> value{};  ///< H there; infinite where unbounded
  int mode = -1;                 ///< index into Modes::vibrations: the nearest in frequency; -1 of minima
};

/// Modes of which the response tells nothing.
struct SilentMode {
  int mode = 0;           ///< index into Modes::vibrations
  bool is_driven = true;  ///< the excitation does work in it
  bool is_seen = true;    ///< the quantity moves in it
};

/// The steady vibration about an equilibrium under a number p of the scene that swings, to first order:
///   M y'' + C y' + K y = b a cos(2 pi f t),   o = o0 + d (p - p0) + g . y + h . y',
///   H(f) = d + (g + s h)^T (s^2 M + s C + K)^-1 b,   s = 2 pi i f,
/// where d is not zero for the force of the element whose number p is, so that  o - o0 = a |H| cos(2 pi f t + arg H).
/// M, C, K and y are those of SmallMotions; b is the generalized force per unit of p. All derivatives are exact, also
/// that of |H|^2 by f, by whose roots extremes are found. Directions without inertia follow at once. SI.
///
/// With controllers or blades it is that of the closed loop (ControlLoop), delays exact:
///   H = d + (g, h)^T [I 0] M(s)^-1 [b; E e];
/// modes are then its poles, without those of blades, which no load excites.
class FrequencyResponse {
 public:
  /// x: scaled coordinates of an equilibrium of the model.
  FrequencyResponse(const MotionModel& model, const std::vector<double>& x, const Excitation& excitation,
                    const SoughtQuantity& of);
  /// With controllers or blades. Throws InputError where they have periods; the loop must be known.
  FrequencyResponse(const MotionModel& model, ControlLoop loop, const Excitation& excitation, const SoughtQuantity& of);

  const SmallMotions& motions() const { return motions_; }
  const Modes& modes() const { return modes_; }
  /// The quantity in the equilibrium.
  double at_rest() const { return at_rest_; }

  /// H, per unit of p. Not a number at 0 Hz where a mode has no restoring force.
  std::complex<double> at(double frequency) const;
  /// The complex amplitude of all coordinates of the model per unit of p, SI.
  std::vector<std::complex<double>> shape(double frequency) const;
  /// Without rounding, H is real: nothing damps.
  bool is_undamped() const { return undamped_; }

  /// All extremes within the range, by frequency.
  std::vector<Resonance> resonances(double from, double to) const;
  /// So many frequencies, two at least, evenly spaced on a logarithmic scale.
  static std::vector<double> frequencies(double from, double to, int count);
  /// Modes that the excitation does not drive, or in which the quantity does not move. Not known, and none, with loads
  /// that follow a body and with controllers.
  std::vector<SilentMode> silent_modes() const;
  /// A range of frequencies about those of all modes; none where no mode oscillates.
  std::optional<solvers::Bracket> usual_range() const;

 private:
  struct ValueAndSlope {
    std::complex<double> value;
    double slope = 0.0;  // d|H|^2/df
  };
  struct ModePart {
    std::complex<double> residue;  // (phi . b) (phi . (g + s h))
    double size = 0.0;             // that it could have
    bool is_driven = false, is_seen = false;
  };
  ModePart part_of(const Vibration& mode) const;
  Eigen::VectorXcd solve(double omega, const Eigen::VectorXcd& right) const;
  ValueAndSlope at_and_slope(double frequency) const;
  Eigen::VectorXd reduced_shape(const Vibration& mode) const;
  std::vector<Resonance> unbounded(double from, double to) const;
  void add_extremes(const std::vector<double>& frequencies, std::vector<Resonance>& out) const;
  std::vector<double> looked_at(double from, double to) const;
  int nearest_mode(double frequency) const;

  Eigen::VectorXd decided_by(const Excitation& excitation) const;
  Eigen::VectorXd read(const std::vector<double>& x, const Excitation& excitation, const SoughtQuantity& of);

  const MotionModel& model_;
  std::optional<ControlLoop> loop_;
  Eigen::VectorXd push_, reads_;  // of the loop: b and (g, h) over its states
  Eigen::VectorXd decided_;       // e of it, by controllers with delays
  SmallMotions motions_;
  Modes modes_;
  double at_rest_ = 0.0;
  Eigen::VectorXd force_;               // b
  Eigen::VectorXd by_place_, by_rate_;  // g, h
  double direct_ = 0.0;                 // d
  bool undamped_ = false;
};

}  // namespace poise
