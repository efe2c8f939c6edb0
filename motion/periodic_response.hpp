#pragma once

#include <atomic>
#include <complex>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "motion/response.hpp"

namespace poise {

/// A periodic motion under a load  P + A cos(2 pi f t)  with the period 1/f. SI.
struct PeriodicAnswer {
  double frequency = 0.0;                           ///< Hz
  std::vector<double> place, rate;                  ///< of the independent coordinates at t = 0
  double amplitude = 0.0;                           ///< of the quantity: half of greatest less least value
  double farthest = 0.0;                            ///< its largest distance from the value in the equilibrium
  std::complex<double> harmonic{};                  ///< c of its part  Re(c exp(2 pi i f t))
  bool stable = false;                              ///< all Floquet multipliers are within the unit circle
  std::vector<std::complex<double>> multipliers{};  ///< largest first
  double residual = 0.0;  ///< of the state after a period, over how far each coordinate swings
};

/// Where the answers change their kind along a branch.
struct ResponseEvent {
  enum class Kind {
    largest,   ///< amplitude of all answers
    fold,      ///< the branch turns back in frequency: a multiplier is 1
    branch,    ///< another branch crosses: a multiplier is 1 without a fold
    doubling,  ///< a motion of twice the period branches off: a multiplier is -1
    torus      ///< a second frequency appears: two multipliers are on the unit circle (Neimark and Sacker)
  };
  Kind kind = Kind::largest;
  PeriodicAnswer at;
  /// A stable branch ends at this fold: as the frequency goes on, the motion jumps, to the stable answer nearest in
  /// amplitude where one is known.
  bool jumps = false;
  bool upwards = false;  ///< of a fold: the branch comes from lower frequencies
  std::optional<PeriodicAnswer> landing{};
};

/// A branch of answers as it was followed, its points close enough that lines join them.
struct ResponseBranch {
  enum class End { range, stop, failed, limit, interrupted };
  std::vector<PeriodicAnswer> points;
  End end = End::range;
  std::string why{};  ///< unless it ended at the range's end
};

struct PeriodicOptions {
  double amplitude = 0.0;       ///< A, SI
  double from = 0.0, to = 0.0;  ///< Hz
  std::vector<double> at{};     ///< frequencies within, Hz, of which all answers are wanted
  int most_points = 2000;       ///< of a branch
  const std::atomic<bool>* interrupt = nullptr;
  std::function<void(double)> progress{};  ///< called with the frequency of each point
};

/// The periodic motions over a range of frequencies.
struct PeriodicResponse {
  bool found = false;  ///< some branch has points
  std::string why{};   ///< if not
  std::vector<ResponseBranch>
      branches{};                       ///< from the low end of the range; if it does not reach the other, from there
  std::vector<ResponseEvent> events{};  ///< along the branches in turn, the largest amplitude last
  std::vector<std::vector<PeriodicAnswer>> answers{};  ///< at each frequency asked for, by amplitude
  /// The largest difference of the motions of events and answers from those of ten times the accuracy, over how far
  /// each coordinate swings.
  double error = 0.0;
  int motions = 0;  ///< simulated

  bool is_whole() const;
};

/// Throws InputError naming the first of what the motions do not have: friction, drives, stops that hold in the
/// equilibrium, an excitation that is no load.
void refuse_without_periodic_response(const Scene& scene, const FrequencyResponse& linear,
                                      const Excitation& excitation);

/// Shooting: the state y = (z, w) at t = 0 solves  phi(y, f) - y = 0  with phi the state after a period, by Newton's
/// method; simulate() gives phi and its exact derivatives. Branches are followed in (y, log f) by pseudo-arclength,
/// through folds: there the tangent has no part in f, which is found by secants. The derivative of phi by y has the
/// Floquet multipliers as its eigenvalues.
///
/// `scene` is scene_at_rest(), x the coordinates of an equilibrium of its model, `linear` its response there.
PeriodicResponse periodic_response(const Scene& scene, const MotionModel& model, const std::vector<double>& x,
                                   const FrequencyResponse& linear, const Excitation& excitation,
                                   const SoughtQuantity& of, const PeriodicOptions& options);

}  // namespace poise
