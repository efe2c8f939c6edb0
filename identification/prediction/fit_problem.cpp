#include "identification/prediction/fit_problem.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "identification/prediction/private/run_start.hpp"
#include "model/input_error.hpp"
#include "solvers/linear_algebra.hpp"
#include "solvers/parallel.hpp"

namespace poise {
namespace {

/// Errors of integration may grow so much; the most accurate motion that is computed where they grow more.
constexpr double harmless_growth = 20.0, finest_accuracy = 1e-13;
/// The growth is about that of a motion nearby: one of that motion's accuracy is accurate enough but for this factor.
constexpr double nearly_known = 0.25;

/// Where friction switches over, steps are as long as the switch-over, and the error of a motion is some hundred times
/// what the integrator estimates: measured on the double pendulum with dry friction, whose cost then scatters by more
/// than a thousandth of a standard error (docs/motion.md).
constexpr double steep_part = 0.01;

/// Whether it has dry friction that turns with the rate over a width.
bool switches_over(const Scene& scene) {
  return std::any_of(scene.elements.begin(), scene.elements.end(), [](const Element& element) {
    const auto* friction = std::get_if<DryFriction>(&element.law);
    return friction != nullptr && friction->width > 0;
  });
}

/// The number of the scene that an unknown is. Throws InputError where the motion does not depend on it.
SceneParameter scene_number(const Experiment& experiment, const Unknown& unknown) {
  const std::optional<SceneParameter> number = SceneParameter::find(experiment.scene_of(unknown.part), unknown.path);
  if (number) return *number;
  throw InputError(
      fmt::format("{}:{}: unknown \"{}\": expected a number that the motion depends on: none of [start], no limit "
                  "or coefficient that a stop does not have, and no start that its drive leaves out",
                  experiment.file_of(unknown.part), unknown.line, unknown.path));
}

/// How much more than in its first tenth a motion multiplies changes of its start, and so errors, in all: the largest
/// ratio of |d reading/d(start)| of any sensor.
double growth_of_errors(const RunModel& model, const Prediction& prediction, double until) {
  const Eigen::Index width = model.columns();
  const Eigen::Index start = model.unknowns() + (model.equilibrium_is_unknown() ? 1 : 0);
  double growth = 1.0;
  const double* first = prediction.jacobian.data();
  for (const std::size_t count : model.counts(until)) {
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const auto rows = static_cast<Eigen::Index>(count);
    const auto by_start = Eigen::Map<const Rows>(first, rows, width).middleCols(start, model.freedoms());
    if (rows > 0) {
      const double early = by_start.topRows(rows / 10 + 1).cwiseAbs().maxCoeff();
      if (early > 0) growth = std::max(growth, by_start.cwiseAbs().maxCoeff() / early);
    }
    first += rows * width;
  }
  return growth;
}

/// One degree of freedom that nothing drives is not chaotic.
bool may_be_chaotic(const RunModel& model) {
  const bool is_driven = model.has_inputs() || !model.scene().drives.empty();
  return model.start_is_unknown() && (model.freedoms() > 1 || is_driven);
}

/// Of a run, again more accurately where the motion is chaotic: so that the cost stays smooth. `found`, unless null, is
/// the accuracy with which that was done near these values, 0 where it is not known; it becomes the one of this motion.
Prediction predict(const RunModel& model, const std::vector<double>& unknowns, const std::vector<double>& nuisances,
                   double until, double accuracy, bool jacobian, const std::atomic<bool>* interrupt = nullptr,
                   double* found = nullptr) {
  Prediction out;
  const bool examined = may_be_chaotic(model);
  // A start that is tried may be one that the mechanism cannot have, as beyond a stop.
  const auto compute = [&](double to, bool derivatives) {
    try {
      model.predict(unknowns.data(), nuisances.data(), until, to, derivatives, out, interrupt);
    } catch (const InputError& error) {
      out.ok = false;
      out.why = error.what();
    }
  };
  const double first = found != nullptr && *found > 0.0 ? std::min(*found, accuracy) : accuracy;
  compute(first, jacobian || examined);
  if (!out.ok || !examined) return out;
  const double finer = std::max(finest_accuracy, accuracy * harmless_growth / growth_of_errors(model, out, until));
  const bool is_known = first < accuracy;
  if (found != nullptr) *found = first;
  if (!(finer < (is_known ? nearly_known * first : accuracy))) return out;
  compute(finer, jacobian);
  if (found != nullptr) *found = finer;
  return out;
}

/// The errors that it makes are told from readings, which outliers spoil.
void refuse_noise_of_inputs(const Experiment& experiment) {
  for (const Run& run : experiment.runs) {
    for (const RunInput& input : run.inputs) {
      if (!(input.noise > 0)) continue;
      throw InputError(
          at_line(experiment.file_of(run.part), input.line) +
          fmt::format("input \"{}\".noise: expected loss = \"squares\" with it, found \"{}\"; leave out one "
                      "of them",
                      input.path, to_string(experiment.loss)));
    }
  }
}

}  // namespace

FitProblem::FitProblem(const Experiment& experiment) : experiment_(experiment) {
  std::map<std::pair<std::string, std::string>, int> known;  // by name and group
  for (std::size_t r = 0; r < experiment.runs.size(); ++r) {
    const Run& run = experiment.runs[r];
    std::vector<SceneParameter> numbers;
    std::vector<SensorNumber> sensor_numbers;
    std::vector<int> of_sensors;
    used_.emplace_back();
    for (std::size_t u = 0; u < experiment.unknowns.size(); ++u) {
      const Unknown& unknown = experiment.unknowns[u];
      if (unknown.part != run.part) continue;
      const std::string group = group_of(unknown.per, run);
      const auto [at, fresh] = known.try_emplace({unknown.name, group}, static_cast<int>(parameters_.size()));
      if (unknown.of_sensor) {
        sensor_numbers.push_back(*unknown.of_sensor);
        of_sensors.push_back(at->second);
      } else {
        numbers.push_back(scene_number(experiment, unknown));
        used_.back().push_back(at->second);
      }
      if (!fresh) continue;
      Parameter p;
      p.unknown = static_cast<int>(u);
      p.name = group.empty() ? unknown.name : unknown.name + " (" + group + ")";
      p.min = unknown.min - unknown.includes;
      p.max = unknown.max - unknown.includes;
      p.truth = written_value(experiment, unknown);
      p.start = unknown.start ? *unknown.start - unknown.includes : p.truth;
      parameters_.push_back(p);
      const double shown = p.start + unknown.includes;
      parameters_.back().scale = shown != 0 ? std::abs(shown) : scale_of(parameters_.size() - 1).size_or(unknown.unit);
    }
    used_.back().insert(used_.back().end(), of_sensors.begin(), of_sensors.end());
    models_.emplace_back(experiment, r, std::move(numbers), std::move(sensor_numbers));
  }
  if (experiment.loss != Loss::squares) refuse_noise_of_inputs(experiment);
  for (const RunModel& model : models_) {
    double noise = INFINITY;
    for (std::size_t k = 0; k < experiment.sensors.size(); ++k) {
      if (!model.times()[k].empty()) noise = std::min(noise, experiment.sensors[k].noise);
    }
    const std::vector<double> start = model.released();
    // A motion's error is about its accuracy times how far it travels; radians and metres are both of order one.
    double amplitude = 1.0;
    // A release that is a mere guess says nothing of it.
    const bool stated = model.run().is_simulated() || !model.start_is_unknown();
    if (model.has_equilibrium() && stated && !model.run().release.empty()) {
      amplitude = 0.0;
      for (const Release& release : model.run().release) amplitude = std::max(amplitude, std::abs(release.value));
    }
    const double accuracy = std::clamp(1e-3 * noise / std::max(amplitude, 1e-12), 1e-10, 1e-6);
    accuracy_.push_back(switches_over(model.scene()) ? std::max(1e-10, steep_part * accuracy) : accuracy);
  }
}

bool FitProblem::any_at_rest() const {
  return std::any_of(models_.begin(), models_.end(), [](const RunModel& run) { return run.is_at_rest(); });
}

bool FitProblem::all_at_rest() const {
  return std::all_of(models_.begin(), models_.end(), [](const RunModel& run) { return run.is_at_rest(); });
}

std::vector<double> FitProblem::unknowns_of(std::size_t r, const std::vector<double>& parameters) const {
  std::vector<double> out;
  for (const int p : used_[r]) out.push_back(parameters[static_cast<std::size_t>(p)]);
  return out;
}

const SceneParameter* FitProblem::number(int parameter) const {
  for (std::size_t r = 0; r < models_.size(); ++r) {
    const auto at = static_cast<std::size_t>(std::find(used_[r].begin(), used_[r].end(), parameter) - used_[r].begin());
    if (at < models_[r].numbers().size()) return &models_[r].numbers()[at];
  }
  return nullptr;
}

bool FitProblem::scales_with_force(int parameter) const {
  const SceneParameter* const of_scene = number(parameter);
  return of_scene != nullptr && of_scene->scales_with_force();
}

FitProblem::Scale FitProblem::scale_of(std::size_t parameter, double estimated) const {
  const Parameter& p = parameters_[parameter];
  const Unknown& unknown = unknown_of(parameter);
  if (unknown.scale) return {*unknown.scale, false};
  if (std::isfinite(p.max - p.min)) return {p.max - p.min, false};
  if (unknown.prior) return {*unknown.prior != 0 ? std::abs(*unknown.prior) : unknown.prior_deviation, false};
  const double truth = p.truth + unknown.includes;
  const double own = std::abs(truth != 0 ? truth : p.start + unknown.includes);
  return {own > 0 ? std::max(own, std::abs(estimated)) : 0.0, true};
}

double FitProblem::reach(std::size_t parameter) const {
  const Parameter& p = parameters_[parameter];
  const SceneParameter* const of_scene = number(static_cast<int>(parameter));
  if (of_scene == nullptr || of_scene->scales_with_force()) return p.scale;
  const std::size_t part = unknown_of(parameter).part;
  const auto run =
      std::find_if(models_.begin(), models_.end(), [&](const RunModel& model) { return model.run().part == part; });
  return std::max(p.scale, run->reach(*of_scene));
}

int FitProblem::nuisances() const {
  int sum = 0;
  for (const RunModel& model : models_) sum += model.nuisances();
  return sum;
}

std::size_t FitProblem::readings() const {
  std::size_t sum = 0;
  for (const RunModel& model : models_) sum += model.readings(INFINITY);
  return sum;
}

std::vector<double> FitProblem::starts() const {
  std::vector<double> values;
  for (const Parameter& p : parameters_) values.push_back(p.start);
  return values;
}

std::vector<double> FitProblem::truths() const {
  std::vector<double> values;
  for (const Parameter& p : parameters_) values.push_back(p.truth);
  return values;
}

Record FitProblem::ideal_record(std::size_t r) const {
  const RunModel& model = models_[r];
  Prediction prediction;
  model.predict(model.scene_values().data(), model.released().data(), INFINITY, 1e-10, false, prediction);
  if (!prediction.ok) {
    throw std::runtime_error(fmt::format("run \"{}\" cannot be simulated: {}", model.run().name, prediction.why));
  }
  Record record;
  auto from = prediction.reading.begin();
  for (const std::vector<double>& times : model.times()) {
    const auto to = from + static_cast<std::ptrdiff_t>(times.size());
    record.sensors.push_back({times, {from, to}});
    from = to;
  }
  return record;
}

void FitProblem::add_noise(Record& record, solvers::RandomStream random) const {
  for (std::size_t k = 0; k < record.sensors.size(); ++k) {
    for (double& reading : record.sensors[k].value) reading += experiment_.sensors[k].noise * random.normal();
  }
}

std::vector<Record> FitProblem::records() const {
  std::vector<Record> out;
  for (std::size_t r = 0; r < models_.size(); ++r) {
    if (!models_[r].run().is_simulated()) {
      out.push_back(experiment_.records[r]);
      if (models_[r].is_at_rest()) continue;
      for (Series& series : out.back().sensors) series = at_rest_once(std::move(series));
      continue;
    }
    out.push_back(ideal_record(r));
    // Runs with the same seed have different noise.
    add_noise(out.back(), solvers::RandomStream(models_[r].run().seed, static_cast<std::uint32_t>(r)));
  }
  return out;
}

Weighting FitProblem::weighting() const {
  Weighting out;
  for (const Sensor& sensor : experiment_.sensors) out.noise.push_back(sensor.noise);
  out.loss = experiment_.loss;
  return out;
}

std::vector<std::shared_ptr<const InputErrors>> FitProblem::input_errors(
    const std::vector<double>& parameters, const std::vector<std::vector<double>>& nuisances, int jobs) const {
  std::vector<std::shared_ptr<const InputErrors>> out(runs());
  solvers::parallel_for(runs(), {.jobs = jobs}, [&](std::size_t r) {
    out[r] = models_[r].input_errors(unknowns_of(r, parameters).data(), nuisances[r].data(), accuracy_[r]);
  });
  if (std::all_of(out.begin(), out.end(), [](const auto& one) { return one == nullptr; })) out.clear();
  return out;
}

LinearRun FitProblem::linearized(std::size_t r, const std::vector<double>& parameters,
                                 const std::vector<double>& nuisances, const Record* record, double until,
                                 double accuracy, const Weighting& weighting, const std::atomic<bool>* interrupt,
                                 double* found) const {
  const RunModel& model = models_[r];
  const std::vector<double> unknowns = unknowns_of(r, parameters);
  const Prediction prediction = predict(model, unknowns, nuisances, until, accuracy, true, interrupt, found);
  if (!prediction.ok) return {};
  LinearRun out;
  const Eigen::Index p = model.unknowns();
  const Eigen::Index m = model.columns();
  out.rows.resize(static_cast<Eigen::Index>(prediction.reading.size()), m + 1);
  Eigen::Index row = 0;
  const std::vector<std::size_t> counts = model.counts(until);
  for (std::size_t k = 0; k < counts.size(); ++k) {
    const double per_noise = 1.0 / weighting.noise[k];
    out.first.push_back(row);
    for (std::size_t s = 0; s < counts[k]; ++s, ++row) {
      const double* jacobian = &prediction.jacobian[static_cast<std::size_t>(row * m)];
      for (Eigen::Index c = p; c < m; ++c) out.rows(row, c - p) = per_noise * jacobian[c];
      for (Eigen::Index c = 0; c < p; ++c) out.rows(row, m - p + c) = per_noise * jacobian[c];
      out.rows(row, m) =
          record != nullptr
              ? per_noise * (prediction.reading[static_cast<std::size_t>(row)] - record->sensors[k].value[s])
              : 0.0;
    }
  }
  out.first.push_back(row);
  if (const InputErrors* const errors = weighting.input_errors(r)) {
    errors->whiten(out.rows, out.first, weighting.noise);
    if (record != nullptr) errors->subtract_offset(out.rows.col(m), out.first);
  }
  if (!out.rows.allFinite()) return {};
  return out;
}

Eigen::MatrixXd FitProblem::triangle(std::size_t r, const std::vector<double>& parameters,
                                     const std::vector<double>& nuisances, const Record* record, double until,
                                     double accuracy, const Weighting& weighting,
                                     const std::atomic<bool>* interrupt) const {
  return triangle_of(linearized(r, parameters, nuisances, record, until, accuracy, weighting, interrupt).rows,
                     weighting);
}

Eigen::MatrixXd FitProblem::triangle_of(Eigen::MatrixXd rows, const Weighting& weighting) {
  if (rows.size() == 0) return {};
  const Eigen::Index last = rows.cols() - 1;
  double beyond = 0.0;  // sum of rho(s) - weight(s) s, which is not negative since rho is concave
  if (weighting.loss != Loss::squares) {
    for (Eigen::Index i = 0; i < rows.rows(); ++i) {
      const double s = rows(i, last) * rows(i, last);
      const double weight = weighting.weight(s);
      rows.row(i) *= std::sqrt(weight);
      beyond += weighting.cost(s) - weight * s;
    }
  }
  if (rows.rows() <= last) rows.conservativeResizeLike(Eigen::MatrixXd::Zero(last + 1, last + 1));
  Eigen::MatrixXd triangle = solvers::triangular_factor(rows);
  // The last entry is a residual that no step changes: with it the costs, and not only their gradients, are exact.
  triangle(last, last) = std::sqrt(triangle(last, last) * triangle(last, last) + beyond);
  return triangle.allFinite() ? triangle : Eigen::MatrixXd();  // squares may overflow
}

std::string FitProblem::why_no_motion(const std::vector<double>& parameters,
                                      const std::vector<std::vector<double>>& nuisances) const {
  for (std::size_t r = 0; r < runs(); ++r) {
    for (const bool derivatives : {false, true}) {
      const Prediction found =
          predict(models_[r], unknowns_of(r, parameters), nuisances[r], INFINITY, accuracy_[r], derivatives);
      if (found.ok) continue;
      return fmt::format("{} of run \"{}\" could not be computed{}{}", models_[r].computed(), models_[r].run().name,
                         found.why.empty() ? "" : ": ", found.why);
    }
  }
  return "";
}

Residuals FitProblem::residuals(std::size_t r, const std::vector<double>& parameters,
                                const std::vector<double>& nuisances, const Record& record) const {
  const RunModel& model = models_[r];
  const std::vector<double> unknowns = unknowns_of(r, parameters);
  const Prediction prediction = predict(model, unknowns, nuisances, INFINITY, accuracy_[r], false);
  if (!prediction.ok) return {};
  Residuals e;
  auto predicted = prediction.reading.begin();
  for (std::size_t k = 0; k < record.sensors.size(); ++k) {
    std::vector<double>& of_sensor = e.emplace_back();
    for (const double reading : record.sensors[k].value) {
      of_sensor.push_back((*predicted++ - reading) / experiment_.sensors[k].noise);
    }
  }
  return e;
}

double FitProblem::cost(const std::vector<double>& parameters, const std::vector<std::vector<double>>& nuisances,
                        const std::vector<Record>& records, const Weighting& weighting, int jobs) const {
  std::vector<double> squares(runs(), 0.0);
  solvers::parallel_for(runs(), {.jobs = jobs}, [&](std::size_t r) {
    const Residuals e = residuals(r, parameters, nuisances[r], records[r]);
    if (e.empty()) {
      squares[r] = INFINITY;
      return;
    }
    std::vector<Eigen::Index> first{0};
    for (const std::vector<double>& of_sensor : e) first.push_back(first.back() + std::ssize(of_sensor));
    Eigen::MatrixXd rows(first.back(), 1);
    for (std::size_t k = 0; k < e.size(); ++k) {
      const double scale = experiment_.sensors[k].noise / weighting.noise[k];
      for (std::size_t s = 0; s < e[k].size(); ++s) rows(first[k] + static_cast<Eigen::Index>(s), 0) = scale * e[k][s];
    }
    if (const InputErrors* const errors = weighting.input_errors(r)) {
      errors->whiten(rows, first, weighting.noise);
      errors->subtract_offset(rows.col(0), first);
    }
    for (const double x : rows.reshaped()) squares[r] += weighting.cost(x * x);
  });
  double sum = 0.0;
  for (const double of_run : squares) sum += of_run;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const Unknown& unknown = unknown_of(i);
    if (!unknown.prior) continue;
    sum += std::pow((parameters[i] + unknown.includes - *unknown.prior) / unknown.prior_deviation, 2);
  }
  return sum / 2;
}

std::vector<std::vector<std::vector<double>>> FitProblem::sensitivities(std::size_t r,
                                                                        const std::vector<double>& parameters,
                                                                        const std::vector<double>& nuisances) const {
  const RunModel& model = models_[r];
  const std::vector<double> unknowns = unknowns_of(r, parameters);
  const Prediction prediction = predict(model, unknowns, nuisances, INFINITY, accuracy_[r], true);
  if (!prediction.ok) return {};
  const auto columns = static_cast<std::size_t>(model.columns());
  std::vector<std::vector<std::vector<double>>> out;
  const double* row = prediction.jacobian.data();
  for (std::size_t k = 0; k < model.times().size(); ++k) {
    std::vector<std::vector<double>>& of_sensor = out.emplace_back(unknowns.size());
    for (std::size_t s = 0; s < model.times()[k].size(); ++s, row += columns) {
      for (std::size_t c = 0; c < unknowns.size(); ++c) {
        const double shown = unknowns[c] + unknown_of(static_cast<std::size_t>(used_[r][c])).includes;
        of_sensor[c].push_back(shown * row[c] / experiment_.sensors[k].noise);
      }
    }
  }
  return out;
}

}  // namespace poise
