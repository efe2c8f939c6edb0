#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "statics/sensitivity/fitted_numbers.hpp"
#include "statics/sensitivity/sensitivity.hpp"

namespace poise {

/// By how much a number of a scene may differ from its value.
struct Tolerance {
  /// A fitted number is normal, with the covariance that it has with the others of FittedNumbers.
  enum class Distribution { uniform, normal, fitted };

  std::string number;  ///< its path
  Dimension dimension{};
  double half_width = 0.0;  ///< SI
  Distribution distribution = Distribution::uniform;
  double sigma = 0.0;  ///< standard deviation, SI: half_width / sqrt(3) of a uniform number, else / 3 unless given
};

/// Reads a file of tolerances (docs/sensitivity.md): under [tolerances] a path or a pattern ("point.*") and its half
/// width in the scene's units, or a table with half_width or percent, distribution and sigma. A path goes before a
/// pattern and a longer pattern before a shorter one. Throws InputError with file, line and item.
std::vector<Tolerance> read_tolerances(const std::filesystem::path& file, const Scene& scene);
std::vector<Tolerance> parse_tolerances(std::string_view text, const std::string& name, const Scene& scene);

struct ToleranceOptions {
  std::size_t samples = 100'000;
  std::uint64_t seed = 1;
  int jobs = 0;  ///< threads; 0: as many as there are cores
  SolveOptions solve{};
  /// Estimates that the scene has, whose errors count beside the tolerances, all without one: in draws a number at its
  /// bound lies beyond it by the size of a normal number, and the others follow it.
  const FittedNumbers* fitted = nullptr;
  std::function<void(std::size_t done)> progress{};  ///< samples; by one thread at a time
};

/// Of samples: mean and standard deviation (NaN of one), extremes, and quantiles.
struct SampleStatistics {
  std::size_t count = 0;
  double mean = 0.0, sigma = 0.0, least = 0.0, most = 0.0;
  double low = 0.0, median = 0.0, high = 0.0;  ///< at 2.5, 50 and 97.5 per cent
};

/// What tolerances do to one quantity, SI.
struct ToleranceBand {
  SoughtQuantity of;
  std::string why;  ///< one sentence; nothing could be computed
  double nominal = 0.0;
  // First order, with s the derivatives: sigma^2 = sum s^2 sigma_i^2, of fitted numbers s^T V s, and worst = sum |s|
  // half_width, in which those do not count.
  std::vector<double> slopes;  ///< one per tolerance
  std::vector<double> shares;  ///< of sigma^2, one per tolerance; of fitted numbers s_i (V s)_i
  double sigma = 0.0, worst = 0.0;
  /// The quantity where all numbers are at the ends that first order says are worst; empty where the equilibrium does
  /// not continue to there.
  std::optional<double> at_least, at_most;
  // Second order, with h the second derivatives, of fitted numbers along the axes of V: shift = 1/2 sum h_ii sigma_i^2,
  // and sigma^2 + 1/4 sum h_ii^2 (mu4_i - sigma_i^4) + sum_{i<j} h_ij^2 sigma_i^2 sigma_j^2, mu4 the fourth moment.
  bool has_second = false;
  double shift = 0.0, second_sigma = 0.0;
  // Samples. Those that continue, and all that have a value.
  SampleStatistics continued, all;
  std::vector<std::size_t> histogram;  ///< of all, bins of equal width from all.least to all.most
  /// The response is linear to within `linear_to`: first order agrees with the samples that continue, and with second
  /// order.
  bool is_linear = false;

  static constexpr double linear_to = 0.03;
};

struct ToleranceStudy {
  Equilibrium equilibrium;
  std::string why;                    ///< one sentence; there is no regular equilibrium
  std::vector<Tolerance> tolerances;  ///< behind them the fitted numbers
  std::vector<ToleranceBand> of;
  std::size_t asked = 0, samples = 0;        ///< fewer samples than asked for where it was interrupted
  std::size_t continued = 0;                 ///< the nominal equilibrium continues to them
  std::size_t followed = 0;                  ///< of these: by small steps from the nominal scene
  std::size_t snapped = 0;                   ///< it does not; they settle elsewhere
  std::size_t nowhere = 0;                   ///< it does not, and no equilibrium was found or they cannot be assembled
  std::size_t undecided = 0;                 ///< rounding leaves open whether it does; they are in no statistics
  std::size_t rechecked = 0, disagreed = 0;  ///< of those that continue: followed by small steps too
  bool interrupted = false;
};

/// What tolerances do to quantities at the settled equilibrium.
///
/// Of fewest_in_lanes = 2000 samples and more those that SceneInLanes solves from the nominal equilibrium, with the
/// same stops and one-way springs, are taken from there. Each other sample p is solved by the chord method  z <- z -
/// A^-1 R(z, p)  with A = dR/dz of the nominal scene, from z + dz/dp (p - nominal). It is taken where every step is at
/// most 0.3 of the one before and no stop or one-way spring comes on or off. All others are followed from the nominal
/// scene in small steps of all numbers together, by Newton's method, with stops that come on and off; a stable
/// equilibrium remains one as long as det dR/dz keeps its sign. Both end where the steps are at most 1e-11 or what
/// rounding moves, 4 eps |A^-1| (|A| |z| + |dR/dp| |p|); a sample whose steps end in rounding of more than 1e-6 is not
/// decided. Where none continues, the sample settles anew from the scene's start. One sample in 1000 of those taken is
/// followed too.
///
/// Sample k depends on the seed and k alone. Loads at folds have first order only. Throws InputError as
/// sensitivities() does, and where a number has both a tolerance and an estimate.
ToleranceStudy tolerance_study(const StaticModel& model, const std::vector<Tolerance>& tolerances,
                               const std::vector<SoughtQuantity>& of, const ToleranceOptions& options = {});

}  // namespace poise
