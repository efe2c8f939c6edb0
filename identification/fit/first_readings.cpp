#include "identification/fit/first_readings.hpp"

#include <algorithm>
#include <cmath>

namespace poise {

std::vector<double> started_from_readings(const RunModel& run, const std::vector<double>& unknowns,
                                          std::vector<double> nuisances, const Record& record) {
  if (!run.start_is_unknown()) return nuisances;
  const std::vector<double> start = run.start_from_readings(unknowns.data(), record);
  std::copy(start.begin(), start.end(), nuisances.begin() + (run.equilibrium_is_unknown() ? 1 : 0));
  return nuisances;
}

std::vector<double> first_guess(const RunModel& run, const std::vector<double>& unknowns, const Record& record) {
  if (record.empty() || !run.run().release.empty()) return run.released();
  return started_from_readings(run, unknowns, run.released(), record);
}

std::vector<double> rms_from_first_readings(const FitProblem& problem, const Fit& fitted,
                                            const std::vector<Record>& records) {
  const std::vector<Sensor>& sensors = problem.experiment().sensors;
  std::vector<double> squares(sensors.size(), 0.0);
  std::vector<std::size_t> readings(sensors.size(), 0);
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    std::vector<double> nuisances;
    try {
      nuisances = started_from_readings(problem.run(r), problem.unknowns_of(r, fitted.parameters),
                                        fitted.runs[r].nuisances, records[r]);
    } catch (const InputError&) {
      return {};  // no pose has these readings and closes the loops
    }
    const Residuals e = problem.residuals(r, fitted.parameters, nuisances, records[r]);
    if (e.empty()) return {};
    for (std::size_t k = 0; k < e.size(); ++k) {
      for (const double x : e[k]) squares[k] += x * x;
      readings[k] += e[k].size();
    }
  }
  for (std::size_t k = 0; k < sensors.size(); ++k) {
    squares[k] = sensors[k].noise * std::sqrt(squares[k] / static_cast<double>(readings[k]));
  }
  return squares;
}

}  // namespace poise
