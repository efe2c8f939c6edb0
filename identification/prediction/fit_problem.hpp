#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "identification/experiment/weighting.hpp"
#include "identification/prediction/run_model.hpp"
#include "solvers/random_stream.hpp"

namespace poise {

/// One value to be estimated: an unknown of the experiment, or, where that has a value per run or label, one of these.
struct Parameter {
  int unknown = 0;   ///< index into Experiment::unknowns
  std::string name;  ///< "k", or "k (low)"
  double start = 0;  ///< value in the scene, or of the sensor, SI, from which a fit starts
  double truth = 0;  ///< value as it is written there
  double scale = 1;  ///< |start|; where it is 0 the scale, or one unit
  double min, max;   ///< of the value in the scene
};

/// (predicted - read) / noise of a run: per sensor, one for each of its readings.
using Residuals = std::vector<std::vector<double>>;

/// A run about some values: what its readings are less than predicted, and how the predictions change.
struct LinearRun {
  /// [d e/d nuisances, d e/d unknowns, e]  with e = (predicted - read) / noise, one row for each reading.
  Eigen::MatrixXd rows;
  std::vector<Eigen::Index> first;  ///< row of each sensor's first reading; one more for the end

  /// e of one sensor.
  auto residuals(std::size_t sensor) const {
    return rows.col(rows.cols() - 1).segment(first[sensor], first[sensor + 1] - first[sensor]);
  }
};

/// An experiment as a least-squares problem:  minimise 1/2 sum rho(((predicted - read) / noise)^2), rho(s) = s in least
/// squares, over the parameters and, for every run, its nuisances. Const after construction: runs can be evaluated on
/// several threads.
class FitProblem {
 public:
  /// `experiment` must outlive this. Throws InputError where a run cannot be set up.
  explicit FitProblem(const Experiment& experiment);

  const Experiment& experiment() const { return experiment_; }
  const std::vector<Parameter>& parameters() const { return parameters_; }
  std::size_t runs() const { return models_.size(); }
  /// Whether some run is at rest, or all are.
  bool any_at_rest() const;
  bool all_at_rest() const;
  const RunModel& run(std::size_t r) const { return models_[r]; }
  /// Parameters that run r depends on, in the order of its unknowns.
  const std::vector<int>& parameters_of(std::size_t r) const { return used_[r]; }
  /// The values of these, in that order, among the values of all parameters.
  std::vector<double> unknowns_of(std::size_t r, const std::vector<double>& parameters) const;
  /// The number of the scene that a parameter is; null for one of a sensor.
  const SceneParameter* number(int parameter) const;
  /// Whether it is one of the numbers that change no motion if all are multiplied by one factor.
  bool scales_with_force(int parameter) const;
  Dimension dimension(int parameter) const {
    return dimension_of(experiment_, unknown_of(static_cast<std::size_t>(parameter)));
  }
  /// The unknown that a parameter is a value of.
  const Unknown& unknown_of(std::size_t parameter) const {
    return experiment_.unknowns[static_cast<std::size_t>(parameters_[parameter].unknown)];
  }
  /// How large a change of a parameter matters, SI: as its unknown says, else its range, else its prior mean or
  /// standard deviation, else its own size: in the scene or at the start, or `estimated` where that is larger than
  /// what is not zero there. 0 where none of these is known or other than zero.
  struct Scale {
    double size = 0.0;
    bool is_own_size = false;  ///< the last of these

    double size_or(double otherwise) const { return size > 0 ? size : otherwise; }
  };
  Scale scale_of(std::size_t parameter, double estimated = 0.0) const;
  /// A change of a parameter by which the mechanism becomes another one, SI: of a length the size of the mechanism, of
  /// masses, forces and numbers of sensors Parameter::scale; else RunModel::reach().
  double reach(std::size_t parameter) const;
  /// Nuisances of all runs together.
  int nuisances() const;
  /// Readings of all runs and sensors together.
  std::size_t readings() const;

  /// Accuracy of simulate() at which its error is far below the noise of run r.
  double accuracy(std::size_t r) const { return accuracy_[r]; }
  /// Readings of a run without noise, and with it, at the scene's own values. Throws std::runtime_error where the
  /// motion fails.
  Record ideal_record(std::size_t r) const;
  void add_noise(Record& record, solvers::RandomStream random) const;
  /// The records of the experiment: measured, or simulated with the runs' seeds.
  std::vector<Record> records() const;

  /// Noise as stated, or first guessed from the readings, and the loss of the experiment; without Weighting::inputs.
  Weighting weighting() const;
  /// Weighting::inputs at these values; empty where no run has an input with noise.
  std::vector<std::shared_ptr<const InputErrors>> input_errors(const std::vector<double>& parameters,
                                                               const std::vector<std::vector<double>>& nuisances,
                                                               int jobs) const;

  /// Of run r up to the time `until`, s. Without `record` e is 0. Without rows where the motion fails, or `interrupt`
  /// is set before it ends. A chaotic motion is computed more accurately, by how much it takes a motion to find: unless
  /// `found` is null it has the accuracy found near these values, 0 where that is not known, and takes that of this
  /// one.
  LinearRun linearized(std::size_t r, const std::vector<double>& parameters, const std::vector<double>& nuisances,
                       const Record* record, double until, double accuracy, const Weighting& weighting,
                       const std::atomic<bool>* interrupt = nullptr, double* found = nullptr) const;
  /// The triangle R of  Q R = W linearized().rows,  W^2 the weights of the residuals: everything that an iteration
  /// needs of a run, (columns + 1) square. Its last column R_e has  |R_e|^2 = sum rho(e^2),  and R^T R_e holds the
  /// gradient of half of that. Empty where the motion fails, or is interrupted.
  Eigen::MatrixXd triangle(std::size_t r, const std::vector<double>& parameters, const std::vector<double>& nuisances,
                           const Record* record, double until, double accuracy, const Weighting& weighting,
                           const std::atomic<bool>* interrupt = nullptr) const;
  /// The same of the rows of a run linearized there.
  static Eigen::MatrixXd triangle_of(Eigen::MatrixXd rows, const Weighting& weighting);
  /// A sentence on the first run whose motion, or the derivatives of which, fail with these values; empty without any.
  std::string why_no_motion(const std::vector<double>& parameters,
                            const std::vector<std::vector<double>>& nuisances) const;
  /// e itself over the whole record at the stated noise, without derivatives; empty where the motion fails.
  Residuals residuals(std::size_t r, const std::vector<double>& parameters, const std::vector<double>& nuisances,
                      const Record& record) const;

  /// Half the sum of rho over all residuals and priors, without derivatives; infinite where a motion fails. The runs
  /// are computed on `jobs` threads, 0: all cores; the result does not depend on it.
  double cost(const std::vector<double>& parameters, const std::vector<std::vector<double>>& nuisances,
              const std::vector<Record>& records, const Weighting& weighting, int jobs) const;

  /// Relative sensitivities  p dy/dp / noise  of run r: by how many standard deviations of the noise a reading would
  /// change if a parameter grew by 100 %, to first order. Per sensor, per parameter as in parameters_of(r), per time;
  /// p is the shown value. Empty where the motion fails.
  std::vector<std::vector<std::vector<double>>> sensitivities(std::size_t r, const std::vector<double>& parameters,
                                                              const std::vector<double>& nuisances) const;

  std::vector<double> starts() const;
  std::vector<double> truths() const;

 private:
  const Experiment& experiment_;
  std::vector<Parameter> parameters_;
  std::vector<RunModel> models_;
  std::vector<std::vector<int>> used_;
  std::vector<double> accuracy_;
};

}  // namespace poise
