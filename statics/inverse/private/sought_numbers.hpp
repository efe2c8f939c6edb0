#pragma once

#include <vector>

#include "statics/inverse/conditioned_equilibrium.hpp"
#include "statics/inverse/find_numbers.hpp"

namespace poise {

/// A point of a curve as the equations see it.
struct CurvePoint {
  const PathPoint* at = nullptr;
  std::vector<double> poses;  ///< three values of each body, scaled
  std::vector<double> s;      ///< parts of the ranges
  std::vector<ActingStop> stops;
};

/// The equations of a scene with sought numbers, for whichever stops act. The first range may be a driven measure.
/// Refers to the ranges, which have the same scales.
class SoughtNumbers {
 public:
  SoughtNumbers(std::vector<const VariedScene*> ranges, const std::vector<WantedValue>& wanted);

  /// `s`: parts of all ranges at the point, which is of a curve with this model there.
  CurvePoint see(const PathPoint& point, const StaticModel& model, std::vector<double> s) const;
  /// The equations where these stops act, a driven measure last.
  ConditionedEquilibrium equations(const std::vector<ActingStop>& stops) const;
  const Scene& scaled_scene() const { return numbers_.list()->scene(); }
  const VariedScene& range(std::size_t k) const { return *ranges_[k]; }
  std::size_t count() const { return ranges_.size(); }
  /// Whether the quantities have their values at a point that Newton's method stopped at: beside a pole it may stop
  /// where they are far from these.
  bool holds(const ConditionedEquilibrium& system, const ConditionedEquilibrium::Point& at) const;
  /// A solution with its proof, and with the certificate of the equilibrium of `model`, the scene with these numbers,
  /// that is near x.
  FoundNumbers examine(const ConditionedEquilibrium& system, const ConditionedEquilibrium::Point& at,
                       const StaticModel& model, const std::vector<double>& x, const CertificateOptions& options) const;

 private:
  std::vector<const VariedScene*> ranges_;
  UnknownNumbers numbers_;
  std::vector<WantedValue> wanted_;
  std::vector<Condition> conditions_;
};

/// The largest difference of places of bodies.
double apart(const std::vector<double>& a, const std::vector<double>& b);

/// Places of the bodies at a solution, scaled.
std::vector<double> poses_at(const ConditionedEquilibrium::Point& at, const Scene& scene);

/// Places of bodies, three values of each, with lengths in a unit of which the old one is so many.
std::vector<double> with_lengths_in(double unit, std::vector<double> poses);

/// All parts are in the ranges, to rounding.
bool within_ranges(const ConditionedEquilibrium::Point& at);

}  // namespace poise
