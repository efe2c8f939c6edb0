#pragma once

// Other minima of a fit, from the frequencies of the predicted motions.

#include <optional>
#include <vector>

#include "identification/prediction/fit_problem.hpp"

namespace poise {

/// Parameters and nuisances of a fit, SI.
struct FitPoint {
  std::vector<double> parameters;
  std::vector<std::vector<double>> nuisances;  ///< per run

  friend bool operator==(const FitPoint&, const FitPoint&) = default;
};

/// Frequencies from `low` to `high`, Hz, other than `frequency`, of oscillations that have nearly the same readings at
/// these times: where the mean of  exp(2 pi i (f -+ frequency) t)  over the times has a peak above 1/2.
/// For times that are evenly spaced by 1/rate these are  |n rate +- frequency|;  uneven times may leave none.
std::vector<double> aliases(const std::vector<double>& times, double frequency, double low, double high);

/// The frequencies of all runs as functions of the parameters, about the poses that the runs have on average at one
/// point. Runs with the same frequencies count once.
class Frequencies {
 public:
  struct Mode {
    std::vector<std::size_t> runs;  ///< that have it
    std::size_t order = 0;          ///< among the frequencies of a run, ascending
    double frequency = 0.0;         ///< Hz at the point; of one degree of freedom that of the motion, however large
    double span = 0.0;              ///< s, the longest record of these runs
  };

  /// Where the motion of a run cannot be computed, that run has no modes.
  Frequencies(const FitProblem& problem, FitPoint point);

  const std::vector<Mode>& modes() const { return modes_; }
  /// Of all modes, Hz; empty where a run has no such pose.
  std::vector<double> at(const std::vector<double>& parameters) const;
  /// Parameters from `from` on at which the modes have the frequencies `wanted`, Hz (any where it is NaN), as nearly
  /// as the ranges allow, by the least changes of the parameters' logarithms.
  std::optional<std::vector<double>> parameters_with(const std::vector<double>& wanted,
                                                     const std::vector<double>& from) const;
  /// Whether the times of the readings leave aliases of a mode, between a quarter of and four times its frequency at
  /// `start`, and from half to twice that at the point.
  bool have_aliases(const std::vector<double>& start) const;
  /// Parameters at which the modes have such frequencies, or others in that range that explain `records`. At most 200,
  /// those first that explain them best as undamped oscillations.
  std::vector<std::vector<double>> alternatives(const std::vector<double>& start,
                                                const std::vector<Record>& records) const;
  /// Whether a mode's frequency at `parameters` differs from that at the point by more than its records resolve.
  bool differ(const std::vector<double>& parameters) const;

 private:
  struct Swing {  // how a run moves at the point
    std::vector<double> pose;
    double equilibrium = 0.0;
    double ratio = 1.0;  // frequency of the motion over the natural one
  };
  /// Per mode: its frequency at the point and its aliases.
  std::vector<std::vector<double>> with_aliases(const std::vector<double>& start) const;
  Swing swing_of(std::size_t run, double span) const;
  std::vector<double> of_run(std::size_t run, const std::vector<double>& parameters) const;
  /// d log(frequency)/d(coordinates of the parameters), one row per mode.
  Eigen::MatrixXd slopes(const std::vector<double>& parameters, const std::vector<double>& here) const;
  /// Sum of squares over the noise that oscillations of these frequencies leave of a record.
  double unexplained(std::size_t run, const Record& record, const std::vector<double>& frequencies) const;
  /// Frequencies that explain a record better than those around, Hz.
  std::vector<double> lines(std::size_t run, const Record& record, double low, double high) const;
  double coordinate(std::size_t parameter, double value) const;
  double value(std::size_t parameter, double coordinate) const;

  const FitProblem& problem_;
  FitPoint point_;
  std::vector<Swing> swings_;
  std::vector<Mode> modes_;
};

}  // namespace poise
