#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace poise::judge {

/// Up to four coordinates, on the stack.
using FewByFew = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 4, 4>;
using Few = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 4, 1>;

/// A mechanism whose friction sticks, with equations of motion of its own, M(q) q'' = Q(q, q', t) - sum J^T T, written
/// by hand for its kind.
struct RubbingMechanism {
  std::string kind, scene;                 ///< the scene as text
  std::vector<std::string> names;          ///< what q is in the scene: bodies that turn and joints that slide
  std::vector<double> start, start_rates;  ///< of q
  double duration = 0.0, accuracy = 0.0;
  int contacts = 0;

  virtual ~RubbingMechanism() = default;
  virtual FewByFew mass(const Few& q) const = 0;
  /// Mean of Q from t to t + h, at q and v.
  virtual Few force(double t, double h, const Few& q, const Few& v) const = 0;
  /// Row of a contact: its rate is J q' - driven_rate.
  virtual Few row(int contact, const Few& q) const = 0;
  virtual double driven_rate(int contact, double t) const = 0;
  /// |T| <= bound.
  virtual double bound(int contact, double t) const = 0;
};

/// One to four freedoms and one to nine contacts: blocks on blocks or on a driven belt, wheels on one axle, links that
/// hang or are sprung, slider cranks with friction in all joints; under loads and drives that are sines, ramps, steps
/// and tables, from rest or moving.
std::unique_ptr<RubbingMechanism> rubbing_mechanism(std::uint64_t seed);

/// q at the times k duration / samples, k = 0 .. samples, by `steps` equal steps: half of the way with the old rates,
/// new rates by  M (v+ - v) = h Q + sum J^T p,  |p| <= h F,  p opposite to  J v+ - u  unless that is zero, and half of
/// the way with these. It knows of no events.
std::vector<Few> small_steps(const RubbingMechanism& mechanism, int steps, int samples);

/// What a motion of the program says beside that.
struct JudgedRubbing {
  std::string kind;
  bool confirmed = false;
  std::string why;       ///< where it is not
  double error = 0.0;    ///< as printed
  double beyond = 0.0;   ///< largest |difference| / (error of the program + error of the small steps)
  double apart = 0.0;    ///< that difference, rad or m
  double unknown = 0.0;  ///< and the error of the small steps, from others up to eight times as long
  std::string where;     ///< coordinate and time of it
};
/// `finer`: by up to 16448 steps times that.
JudgedRubbing judge_rubbing(std::uint64_t seed, int finer = 1);

}  // namespace poise::judge
