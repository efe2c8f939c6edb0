#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "statics/model/varied_scene.hpp"
#include "statics/paths/path.hpp"
#include "statics/paths/varied_pair.hpp"
#include "statics/quantities/quantities_at.hpp"

namespace poise {

/// A quantity that is to have a value, SI.
struct WantedValue {
  SoughtQuantity of;
  double value = 0.0;
};

/// Numbers with which an equilibrium has the wanted values.
struct FoundNumbers {
  std::vector<double> numbers;  ///< SI
  /// The exact ones are this close, SI; infinite where that is not proved. Proved of the numbers as the doubles that
  /// they became; to first order also of those that round to them, and of the values.
  std::vector<double> radii;
  std::vector<double> values;  ///< of the quantities there, SI
  PathPoint at;                ///< the equilibrium; of a fold load the fold. `proof` is of both, `statement` says what
  bool proved = false;         ///< exactly one solution near, and an equilibrium there that is confirmed
};

struct FindOptions {
  /// How the curve is followed; `certify` and `at` are ignored.
  PathOptions path{};
  /// Also along the curves through all equilibria that are found at both ends of the range and in its middle.
  bool all = false;
  /// Finds stresses and modes; without it they have no value.
  OtherQuantities others{};
  /// Values of the second number, evenly spaced, from whose curves is begun where two are sought.
  int slices = 5;
};

/// The quantity over the one number that is sought, along a branch of a curve, SI; not a number where it is undefined.
struct QuantityCourse {
  std::vector<double> numbers, values;
};

struct FoundSet {
  enum class Status {
    not_started,
    found,      ///< at least one
    none,       ///< none on the curves that were followed; `nearest` is the closest point of these
    no_start,   ///< no equilibrium at the first value
    undefined,  ///< a quantity has no value anywhere on the curves
    interrupted
  };
  Status status = Status::not_started;
  std::string why;                   ///< one sentence, empty where found
  std::vector<FoundNumbers> values;  ///< in the order of the first number
  /// Ranges of the one number, SI, all along which the quantity has the value at points of the curves, to rounding:
  /// where a stop holds it, say. Nothing is proved of these.
  std::vector<std::pair<double, double>> all_along;
  std::optional<FoundNumbers> nearest;  ///< where none is found
  std::vector<QuantityCourse> courses;  ///< of one number, in the order of the curves
  int branch_points = 0;                ///< of the curves, whose other branches were not followed
  int curves = 0;                       ///< that were followed
  bool whole = true;                    ///< each of them to an end of the range, or closed
  std::string sets;                     ///< with `all`: what is known of the sets that were begun from
  int paths = 0;                        ///< curves followed for it, of all kinds
};

/// The values in its range of a number for which a quantity has the wanted value in equilibrium: along the curve of
/// equilibria through the scene's own (path()), folds included, each place where the quantity passes the value, or
/// comes near to it and turns, is where Newton's method starts on
///
///   R(z, p(s)) = 0,   Q(z, p(s)) = value
///
/// and each solution is proved (statics/inverse/conditioned_equilibrium.hpp), with the certificate of its equilibrium.
/// A quantity that others find has no derivatives: its value is met by secants along the curve, and is not proved.
///
/// A load at a fold has the value where the fold of the path over that load, from the scene's own equilibrium on, is
/// at it: `wanted.of` is then compared at values of the number. That a fold with that load is there is proved
/// (statics/inverse/fold_equations.hpp), not that it is the first.
FoundSet find_numbers(const VariedScene& varied, const WantedValue& wanted, const FindOptions& options = {});

/// Two numbers for two conditions, from the places on some curves at which they are closest to holding.
FoundSet find_numbers(const VariedPair& pair, const std::vector<WantedValue>& wanted, const FindOptions& options = {});

}  // namespace poise
