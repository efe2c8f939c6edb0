#pragma once

#include <optional>
#include <string>
#include <vector>

#include "comparison/catalogue.hpp"

namespace poise::comparison {

/// What is known of a case says of one answer.
struct Verdict {
  enum class Kind {
    arrived,
    inexact,  ///< a known equilibrium, but farther from it than rounding explains
    wrong,    ///< confirmed by the check and contradicted by what is known
    denied,   ///< claimed by the solver, denied by the check
    failed    ///< nothing claimed
  };
  Kind kind = Kind::failed;
  /// From the nearest known equilibrium, rad or mechanism sizes; empty where there is none.
  std::optional<double> error{};
  std::optional<double> allowed{};  ///< what rounding may do there, Check::accuracy
  std::string why{};                ///< where it did not arrive
};

/// Holds answers against what is known of a case.
///
/// list         The nearest known equilibrium must be near enough and of the stability that the check tells. Near
///              enough for an arrival is max(1e-9, Check::accuracy); what lies farther, but within what the check's
///              bounds on imbalance, gaps and stops let pass, is inexact. Beyond that a complete list contradicts the
///              answer.
/// open list    An answer near no known equilibrium is refined in 50 digits, which must find one as near.
/// everywhere   The answer must be neutral.
/// locked       It must be said that the joints lock. Who goes on to a rest elsewhere must say it too, and 50 digits
///              must find that rest.
/// none         Nothing may be confirmed; where nothing is claimed either the method has arrived.
class CaseCheck {
 public:
  /// `hard` and `model` must outlive this. Throws InputError where a known equilibrium names no body or travel.
  CaseCheck(const HardCase& hard, const StaticModel& model);

  Verdict verdict_on(const Equilibrium& rest) const;

 private:
  struct Value {
    int index;  ///< of the body, or the coordinate
    double value;
  };
  struct Target {
    std::vector<Value> angles, travels;
    Stability stability;
  };
  struct Bounds {
    double arrived, confirmed;
  };

  Target target_of(const KnownEquilibrium& known) const;
  double distance(const std::vector<double>& x, const std::vector<BodyPose<double>>& poses, const Target& target) const;
  Bounds bounds_at(const Equilibrium& rest) const;
  Verdict verdict_on_confirmed(const Equilibrium& rest) const;
  Verdict verdict_by_list(const Equilibrium& rest) const;
  Verdict verdict_by_reference(const Equilibrium& rest) const;
  static Verdict verdict_by_distance(double apart, const Equilibrium& rest, const Bounds& bounds);

  const HardCase& hard_;
  const StaticModel& model_;
  std::vector<Target> known_;
};

}  // namespace poise::comparison
