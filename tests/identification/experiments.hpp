#pragma once

// Experiments for tests: those of datasets/, and small ones built in code.

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "identification/prediction/fit_problem.hpp"

namespace poise::test {

/// datasets/NAME.toml, with settings as for --set.
Experiment experiment(const std::string& name, const std::vector<std::string>& settings = {});

/// The angle of a body, read with that noise (rad).
Sensor angle_of(const Scene& scene, const std::string& body, double noise);

/// A number of the scene that is to be found, without bounds.
Unknown unknown(const std::string& path);

/// A simulated run: `count` readings, the first at time 0, from `release` (SI).
Run simulated(double rate, int count, std::vector<poise::Release> release = {});

/// A sprung mass on a level rail, damped,  m x'' + c x' + k x = 0,  of which m, k and c are unknown; one run of 300
/// readings of x.
Experiment oscillator();

/// Index of the parameter of that name. Throws std::out_of_range where there is none.
std::size_t parameter(const FitProblem& problem, const std::string& name);

/// Nuisances of all runs as they are released.
std::vector<std::vector<double>> released(const FitProblem& problem);

/// d(readings / noise)/d(parameters, then nuisances run by run) of all runs at the truth, each run's readings below the
/// last one's: what the triangles stand for.
Eigen::MatrixXd whole_jacobian(const FitProblem& problem);

/// Derivative by a central difference of fourth order:  (8 (f(h) - f(-h)) - (f(2h) - f(-2h))) / 12 h.
std::vector<double> derivative(const std::function<std::vector<double>(double)>& f, double h);

/// Expects the Jacobian of the first run's predictions, by all numbers and the run's own `nuisances`, to be what
/// differences of predictions say. These have the error of readings over the step where it is short, and where it is
/// long that of events which pass the time of a reading within it: one of two steps has to agree.
void expect_derivatives(const Experiment& e, const std::vector<double>& nuisances);

/// Fits the experiment's own records: every estimate is given, within 5 standard errors of its truth, with a standard
/// error below `most`.
void expect_found(const Experiment& e, double most);

}  // namespace poise::test
