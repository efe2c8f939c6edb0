#pragma once

// The cost that a descent lowers, as a function of one vector of variables.

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "identification/fit/private/fit_task.hpp"
#include "identification/identifiability/frequencies.hpp"

namespace poise {

/// Half the sum of squares of the residuals of all runs, each run reduced to the rows of FitProblem::triangle(), and of
/// priors. Variables: parameters in units of their scales, then the nuisances of all runs, SI, as differences from the
/// start.
class DescentCost {
 public:
  /// The cost at some values, computed once.
  struct Place {
    Eigen::VectorXd x;
    std::vector<LinearRun> runs;
    std::vector<Eigen::MatrixXd> triangles;  ///< of these
    double cost = INFINITY;                  ///< infinite where a motion could not be computed

    bool is_known() const { return cost < INFINITY; }
  };
  /// cost(x + d) = |a d + r|^2 / 2  to first order in the residuals.
  struct Model {
    Eigen::MatrixXd a;
    Eigen::VectorXd r;
  };

  /// Computes the cost at `start`, over the readings of the first part `window` of every record. `weighting` and
  /// `start` must outlive this.
  DescentCost(const FitTask& task, const Weighting& weighting, const FitPoint& start, double window, FitEffort& effort);

  /// Whether the result only has to be a start for a fit to more readings.
  bool is_start() const { return window_ < 1.0; }
  /// Ranges of the variables; both ends are the same for parameters that keep their values.
  const Eigen::VectorXd& low() const { return low_; }
  const Eigen::VectorXd& high() const { return high_; }

  /// The place that the descent has reached.
  const Place& here() const { return here_; }
  /// The place with these values: here, the one asked for last, or one computed now, all runs in parallel.
  const Place& at(const Eigen::VectorXd& x);
  /// Goes to the place asked for last.
  void accept() { std::swap(here_, there_); }
  Model model(const Place& place) const;
  Eigen::Index rows() const;

  FitPoint point() const { return point_at(here_.x); }
  /// The runs linearized here, once.
  std::vector<std::optional<LinearRun>> take();
  /// Mean time that the motions of one place take, s.
  double seconds() const { return seconds_ / timed_; }

 private:
  struct Prior {
    std::size_t parameter;
    double mean, deviation;
  };

  const std::vector<Parameter>& parameters() const { return task_.problem.parameters(); }
  void take_ranges();
  void add_priors();
  void stay_near();
  double until(std::size_t run) const;
  FitPoint point_at(const Eigen::VectorXd& x) const;
  Place evaluate(const Eigen::VectorXd& x);

  const FitTask& task_;
  const Weighting& weighting_;
  const FitPoint& start_;
  double window_;
  FitEffort& effort_;
  std::vector<Eigen::Index> first_;     // variable of each run's first nuisance; one more for the end
  std::vector<double> found_accuracy_;  // of each run's motion before, where that is chaotic
  Eigen::VectorXd low_, high_;
  std::vector<Prior> priors_;
  Place here_, there_;
  double seconds_ = 0.0;
  int timed_ = 0;
};

}  // namespace poise
