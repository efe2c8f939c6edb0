#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "identification/fit/fit.hpp"

namespace poise {

/// What a fit found, as far as later predictions need it. SI throughout; NaN where it is withheld.
struct FittedModel {
  struct Parameter {
    std::string name, path;
    double value = 0.0;    ///< in the scene
    std::string withheld;  ///< why it is; empty where it is not
  };
  struct Sensor {
    std::string name;
    double noise = 0.0;  ///< standard deviation of one reading, as stated or estimated
    double rms = 0.0;    ///< of the fit's own residuals
  };
  std::string file;
  bool is_unfinished = false;  ///< the fit was interrupted: its values are no estimates, and have no covariance
  std::vector<Parameter> parameters;
  Eigen::MatrixXd covariance;  ///< of these
  std::vector<Sensor> sensors;
};

/// Gives sensors whose noise the experiment does not state that of the fit, by name.
void take_noise(const FittedModel& model, Experiment& experiment);

enum class Starts {
  fitted,   ///< with the equilibria, to the records that are predicted
  measured  ///< estimated from the first readings of every run; equilibria as the runs state them
};

/// Records predicted by a model that was fitted to other ones, the held-out error e:
///   V = covariance of the parameters,  A = d readings / d parameters, fitted starts and equilibria eliminated:
///   the uncertainty of the parameters alone explains a root mean square of  sqrt(mean diag(A V A^T)).
/// A fit of the parameters to the records predicted shows what no parameters of this model can explain in them.
struct Validation {
  Fit fit;                               ///< of the starts, with the parameters held
  Eigen::MatrixXd covariance;            ///< of the experiment's parameters
  std::vector<double> identification;    ///< per sensor: root mean square of the fit's own residuals; NaN if unknown
  std::vector<double> from_parameters;   ///< per sensor: what the uncertainty of the parameters explains
  std::vector<double> refitted;          ///< per sensor: root mean square that a fit of these records leaves; or empty
  std::optional<double> ratio;           ///< held-out error over the fit's own: rms over noise of the common sensors
  std::optional<double> ratio_refitted;  ///< the same over what a fit of these records leaves
};

/// The experiment's parameters, SI, in the scene: those of the model by name. Throws InputError naming one that the
/// model lacks, withholds or has for another path.
std::vector<double> parameters_of(const FitProblem& problem, const FittedModel& model);

/// Predicts the records with the parameters of the model. Throws InputError as parameters_of().
Validation validate(const FitProblem& problem, const std::vector<Record>& records, const FittedModel& model,
                    Starts starts, const FitOptions& options = {});

}  // namespace poise
