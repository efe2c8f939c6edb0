#include "identification/assessment/misfit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <memory>
#include <utility>

#include <Eigen/Core>
#include <fmt/format.h>

#include "identification/assessment/private/altered.hpp"
#include "identification/assessment/private/cause_candidates.hpp"
#include "identification/assessment/residuals.hpp"
#include "identification/fit/first_readings.hpp"
#include "solvers/linear_algebra.hpp"
#include "solvers/parallel.hpp"

namespace poise {
namespace {

constexpr double gross_from = 3.0, part_of_signal = 0.1;
/// A cause that leaves more than this part of the residuals of the columns is none, or, where what it leaves may be
/// noise, more than this part.
constexpr double lowers_to = 1.0 / 3.0, cures_to = 0.5;

/// Per sensor: standard deviation of the readings about their means in the runs, SI.
std::vector<double> signals(const std::vector<Record>& records, std::size_t sensors) {
  std::vector<double> out;
  for (std::size_t k = 0; k < sensors; ++k) {
    double squares = 0.0;
    double count = 0.0;
    for (const Record& record : records) {
      const std::vector<double>& values = record.sensors[k].value;
      if (values.empty()) continue;
      const Eigen::Map<const Eigen::ArrayXd> y(values.data(), static_cast<Eigen::Index>(values.size()));
      squares += (y - y.mean()).square().sum();
      count += static_cast<double>(values.size());
    }
    out.push_back(std::sqrt(squares / std::max(count, 1.0)));
  }
  return out;
}

/// The largest noise that the readings of a sensor can have, SI.
double largest_noise(const std::vector<Record>& records, std::size_t sensor) {
  double squares = 0.0;
  double count = 0.0;
  for (const Record& record : records) {
    const Series& series = record.sensors[sensor];
    if (series.value.empty()) continue;
    squares += static_cast<double>(series.value.size()) * std::pow(noise_at_most(series), 2);
    count += static_cast<double>(series.value.size());
  }
  return count > 0 ? std::sqrt(squares / count) : INFINITY;
}

/// An experiment as a candidate with its number has it.
struct Altered {
  std::shared_ptr<const Experiment> experiment;
  std::shared_ptr<const FitProblem> problem;
};

/// Where a candidate has got to.
struct Reached {
  std::vector<double> parameters;
  std::vector<std::vector<double>> nuisances;
  double number = 0.0;
  double over_noise = INFINITY;  ///< of all residuals in the window
  double worst = INFINITY;       ///< of the sensor with the largest
  /// The same as over_noise, each residual in the unit that its column was taken to have. With a factor of 1/1000 any
  /// readings are noise, but in their own unit they are as unexplained as before.
  double of_columns = INFINITY;
};

/// The values as a file gives them: "J = 0.03, c = 0.02".
std::string words_of(const FitProblem& problem, const std::vector<double>& parameters) {
  std::vector<std::string> out;
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    const Parameter& one = problem.parameters()[p];
    const Unknown& unknown = problem.experiment().unknowns[static_cast<std::size_t>(one.unknown)];
    out.push_back(fmt::format("{} = {:.5g}", one.name, (parameters[p] + unknown.includes) / unknown.unit));
  }
  return fmt::format("{}", fmt::join(out, ", "));
}

/// The fit of one candidate.
class CauseFit {
 public:
  CauseFit(const CauseCandidate& candidate, const Experiment& experiment, const FitProblem& written, const Fit& fitted,
           const std::atomic<bool>* interrupt)
      : candidate_(candidate), experiment_(experiment), written_(written), fitted_(fitted), interrupt_(interrupt) {
    at_.number = candidate.start;
  }

  const Reached& reached() const { return at_; }
  void give_up() { at_.over_noise = at_.worst = at_.of_columns = INFINITY; }

  /// Begins from the better one of the experiment's starts and the estimates.
  void begin(double window, int steps) {
    const Altered altered = at(candidate_.start);
    std::vector<std::vector<double>> starts = {altered.problem->starts()};
    if (!fitted_.parameters.empty()) {
      starts.push_back(starts.front());
      for (std::size_t i = 0; i < starts[1].size(); ++i) {
        for (std::size_t j = 0; j < fitted_.parameters.size(); ++j) {
          if (written_.parameters()[j].name == altered.problem->parameters()[i].name) {
            starts[1][i] = fitted_.parameters[j];
          }
        }
      }
    }
    Reached best;
    for (const std::vector<double>& start : starts) {
      at_ = {.parameters = start, .nuisances = {}, .number = candidate_.start};
      for (std::size_t r = 0; r < altered.problem->runs(); ++r) {
        const RunModel& run = altered.problem->run(r);
        at_.nuisances.push_back(run.nuisances() == 0 ? std::vector<double>()
                                                     : first_guess(run, altered.problem->unknowns_of(r, start),
                                                                   altered.experiment->records[r]));
      }
      go_on(window, steps);
      if (at_.over_noise < best.over_noise) best = at_;
    }
    at_ = std::move(best);
  }

  /// Goes on for at most so many steps over the first part `window` of each record.
  void go_on(double window, int steps) {
    constexpr double settled = 1e-3, less = 0.2, more = 8.0, most_damping = 1e6;
    if (at_.parameters.empty()) return;
    Altered altered = at(at_.number);
    std::vector<Eigen::MatrixXd> rows;
    if (!linearize(altered, window, at_, rows)) {
      give_up();
      return;
    }
    double damping = 1e-3;
    for (int step = 0; step < steps && damping < most_damping && !is_stopped(); ++step) {
      Reached next = moved(*altered.problem, rows, damping);
      Altered there = next.number == at_.number ? altered : at(next.number);
      std::vector<Eigen::MatrixXd> rows_there;
      const bool better = linearize(there, window, next, rows_there) && next.over_noise < at_.over_noise;
      if (!better) {
        damping *= more;
        continue;
      }
      const bool is_settled = next.over_noise > (1 - settled) * at_.over_noise;
      at_ = std::move(next);
      altered = std::move(there);
      rows = std::move(rows_there);
      damping *= less;
      if (is_settled) break;
    }
  }

 private:
  bool is_stopped() const { return interrupt_ != nullptr && interrupt_->load(); }

  Altered at(double number) const {
    auto experiment = std::make_shared<Experiment>(experiment_);
    candidate_.change(*experiment, number);
    auto problem = std::make_shared<const FitProblem>(*experiment);
    return {std::move(experiment), std::move(problem)};
  }

  /// Sets the rows of each run,  [d e/d nuisances, d e/d unknowns, d e/d number, e],  and how large e is; false where a
  /// motion fails.
  bool linearize(const Altered& altered, double window, Reached& at, std::vector<Eigen::MatrixXd>& rows) const {
    const FitProblem& problem = *altered.problem;
    const std::size_t sensors = altered.experiment->sensors.size();
    const double step = at.number + candidate_.step > candidate_.most ? -candidate_.step : candidate_.step;
    const Altered beside = candidate_.has_number() ? this->at(at.number + step) : Altered();
    std::vector<double> squares(sensors, 0.0), counts(sensors, 0.0);
    for (std::size_t r = 0; r < problem.runs(); ++r) {
      const LinearRun run =
          problem.linearized(r, at.parameters, at.nuisances[r], &altered.experiment->records[r],
                             until(problem.run(r), window), problem.accuracy(r), problem.weighting(), interrupt_);
      if (run.rows.size() == 0 || !run.rows.allFinite()) return false;
      for (std::size_t k = 0; k < sensors; ++k) {
        squares[k] += run.residuals(k).squaredNorm();
        counts[k] += static_cast<double>(run.residuals(k).size());
      }
      rows.push_back(run.rows);
      if (!candidate_.has_number()) continue;
      const Residuals there =
          beside.problem->residuals(r, at.parameters, at.nuisances[r], beside.experiment->records[r]);
      if (there.empty()) return false;
      Eigen::MatrixXd& own = rows.back();
      const Eigen::Index last = own.cols() - 1;
      own.conservativeResize(Eigen::NoChange, own.cols() + 1);
      own.col(last + 1) = own.col(last);
      for (std::size_t k = 0; k < sensors; ++k) {
        for (Eigen::Index i = run.first[k]; i < run.first[k + 1]; ++i) {
          const auto reading = static_cast<std::size_t>(i - run.first[k]);
          own(i, last) = reading < there[k].size() ? (there[k][reading] - own(i, last + 1)) / step : 0.0;
        }
      }
    }
    double all = 0.0;
    double all_of_columns = 0.0;
    double readings = 0.0;
    at.worst = 0.0;
    for (std::size_t k = 0; k < sensors; ++k) {
      const Sensor& now = altered.experiment->sensors[k];
      const Sensor& was = experiment_.sensors[k];
      all += squares[k];
      all_of_columns += squares[k] * std::pow(now.noise / was.noise * was.unit / now.unit, 2);
      readings += counts[k];
      if (counts[k] > 0) at.worst = std::max(at.worst, std::sqrt(squares[k] / counts[k]));
    }
    at.over_noise = std::sqrt(all / std::max(readings, 1.0));
    at.of_columns = std::sqrt(all_of_columns / std::max(readings, 1.0));
    return std::isfinite(at.over_noise);
  }

  /// The end of the window of a run, which holds enough readings for the values of the run itself.
  static double until(const RunModel& run, double window) {
    const auto least = static_cast<std::size_t>(run.columns()) + 4;
    while (window < 1.0 && run.readings(window * run.span()) < least) window *= 1.5;
    return window < 1.0 ? window * run.span() : INFINITY;
  }

  /// x of  min |A x + b|^2 + damping |D x|^2,  D the lengths of the columns of A.
  static Eigen::VectorXd damped_step(Eigen::MatrixXd a, const Eigen::VectorXd& b, double damping) {
    Eigen::VectorXd length = a.colwise().norm();
    for (double& l : length) l = l > 0 ? l : 1.0;
    const Eigen::Index rows = a.rows(), columns = a.cols();
    a = a * length.cwiseInverse().asDiagonal();
    a.conservativeResize(rows + columns, Eigen::NoChange);
    a.bottomRows(columns) = std::sqrt(damping) * Eigen::MatrixXd::Identity(columns, columns);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(rows + columns);
    right.head(rows) = -b;
    return length.cwiseInverse().cwiseProduct(solvers::minimum_norm_solution<double>(a, right));
  }

  Reached moved(const FitProblem& problem, const std::vector<Eigen::MatrixXd>& rows, double damping) const {
    const auto parameters = static_cast<Eigen::Index>(at_.parameters.size());
    const Eigen::Index extra = candidate_.has_number() ? 1 : 0;
    std::vector<Eigen::MatrixXd> triangles;
    Eigen::Index height = parameters;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      Eigen::MatrixXd a = rows[r];
      if (a.rows() < a.cols()) {
        const Eigen::Index before = a.rows();
        a.conservativeResize(a.cols(), Eigen::NoChange);
        a.bottomRows(a.cols() - before).setZero();
      }
      triangles.push_back(solvers::triangular_factor(a));
      height += problem.run(r).unknowns() + extra;
    }
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(height, parameters + extra);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(height);
    for (Eigen::Index p = 0; p < parameters; ++p) {
      const auto at = static_cast<std::size_t>(p);
      const Unknown& unknown = problem.unknown_of(at);
      if (!unknown.prior) continue;
      a(p, p) = 1 / unknown.prior_deviation;
      b[p] = (at_.parameters[at] + unknown.includes - *unknown.prior) / unknown.prior_deviation;
    }
    Eigen::Index row = parameters;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const Eigen::Index nuisances = problem.run(r).nuisances(), unknowns = problem.run(r).unknowns();
      const Eigen::Index own = unknowns + extra;
      const auto& triangle = triangles[r];
      for (Eigen::Index c = 0; c < unknowns; ++c) {
        a.block(row, problem.parameters_of(r)[static_cast<std::size_t>(c)], own, 1) =
            triangle.block(nuisances, nuisances + c, own, 1);
      }
      if (extra > 0) a.block(row, parameters, own, 1) = triangle.block(nuisances, nuisances + unknowns, own, 1);
      b.segment(row, own) = triangle.block(nuisances, nuisances + own, own, 1);
      row += own;
    }
    const Eigen::VectorXd x = damped_step(std::move(a), b, damping);
    Reached out = at_;
    for (Eigen::Index p = 0; p < parameters; ++p) {
      const auto at = static_cast<std::size_t>(p);
      const Parameter& parameter = problem.parameters()[at];
      out.parameters[at] = std::clamp(at_.parameters[at] + x[p], parameter.min, parameter.max);
    }
    if (extra > 0) out.number = std::clamp(at_.number + x[parameters], candidate_.least, candidate_.most);
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const Eigen::Index nuisances = problem.run(r).nuisances(), unknowns = problem.run(r).unknowns();
      if (nuisances == 0) continue;
      const auto& triangle = triangles[r];
      Eigen::VectorXd right = triangle.block(0, nuisances + unknowns + extra, nuisances, 1);
      for (Eigen::Index c = 0; c < unknowns; ++c) {
        right +=
            triangle.block(0, nuisances + c, nuisances, 1) * x[problem.parameters_of(r)[static_cast<std::size_t>(c)]];
      }
      if (extra > 0) right += triangle.block(0, nuisances + unknowns, nuisances, 1) * x[parameters];
      const Eigen::VectorXd shift = damped_step(triangle.topLeftCorner(nuisances, nuisances), right, damping);
      for (Eigen::Index i = 0; i < nuisances; ++i) out.nuisances[r][static_cast<std::size_t>(i)] += shift[i];
    }
    return out;
  }

  const CauseCandidate& candidate_;
  const Experiment& experiment_;
  const FitProblem& written_;
  const Fit& fitted_;
  const std::atomic<bool>* interrupt_;
  Reached at_;
};

/// A root mean square of all residuals over the noise.
double over_noise_of(const std::vector<double>& noise, const Fit& fitted, const std::vector<Record>& records) {
  double squares = 0.0;
  double readings = 0.0;
  for (std::size_t k = 0; k < fitted.rms.size(); ++k) {
    double count = 0.0;
    for (const Record& record : records) count += static_cast<double>(record.sensors[k].value.size());
    if (count == 0) continue;
    squares += count * std::pow(fitted.rms[k] / noise[k], 2);
    readings += count;
  }
  return readings > 0 ? std::sqrt(squares / readings) : INFINITY;
}

/// The time after which small changes of the start have grown to 30 times those in the beginning, s, the shortest of
/// all runs, where they then grow to 1000 times: no start tells such a motion for long.
std::optional<double> forgets_start_after(const FitProblem& problem, const Fit& fitted) {
  constexpr double beginning = 0.05, grown = 30, chaotic = 1000;
  std::optional<double> out;
  for (std::size_t r = 0; r < std::min(problem.runs(), fitted.runs.size()); ++r) {
    const RunModel& run = problem.run(r);
    const auto starts = static_cast<std::size_t>(2 * run.freedoms()), width = static_cast<std::size_t>(run.columns());
    Prediction predicted;
    if (run.is_at_rest() || !run.start_is_unknown() || !run.scene().time_functions.empty()) continue;
    run.predict(problem.unknowns_of(r, fitted.parameters).data(), fitted.runs[r].nuisances.data(), INFINITY,
                problem.accuracy(r), true, predicted);
    if (!predicted.ok) continue;
    // Each start and sensor has its own largest change in the beginning, largest of all, and time when it has grown.
    std::size_t row = 0;
    for (const std::vector<double>& times : run.times()) {
      for (std::size_t c = width - starts; c < width; ++c) {
        double first = 0.0, largest = 0.0;
        std::optional<double> when;
        for (std::size_t i = 0; i < times.size(); ++i) {
          const double by = std::abs(predicted.jacobian[(row + i) * width + c]);
          if (times[i] <= beginning * run.span()) first = std::max(first, by);
          largest = std::max(largest, by);
          if (!when && first > 0 && by > grown * first) when = times[i];
        }
        if (when && largest > chaotic * first) out = std::min(out.value_or(INFINITY), *when);
      }
      row += times.size();
    }
  }
  return out;
}

/// Pieces of about that length, with as many digits as a person would write.
void add_pieces(double length, std::vector<CauseCandidate>& to) {
  const double unit = std::pow(10.0, std::floor(std::log10(length)) - 1);
  length = unit * std::round(length / unit);
  CauseCandidate& one = to.emplace_back();
  one.words = fmt::format("no start tells the motion for long: its small changes have grown to 30 times after {:.3g} s",
                          length);
  one.cure = [length](double) { return fmt::format("piece = {:.3g} in the run", length); };
  one.change = [length](Experiment& e, double) { cut_into_pieces(e, length); };
  one.shows_late = true;
}

/// Where residuals are white in all runs, and no larger than the noise that the readings themselves can have, the noise
/// alone is stated too small.
std::optional<MisfitCause> understated_noise(const FitProblem& problem, const Fit& fitted,
                                             const std::vector<Record>& records) {
  constexpr double like_noise = 1.5;
  if (fitted.status != FitStatus::converged && fitted.status != FitStatus::misfit) return std::nullopt;
  const auto is_white = [](const RunFit& run) { return run.is_white() && !run.is_shifted(); };
  if (!std::all_of(fitted.runs.begin(), fitted.runs.end(), is_white)) return std::nullopt;
  const std::vector<Sensor>& sensors = problem.experiment().sensors;
  MisfitCause out{"the noise is stated too small, residuals are white", "", 1.0, true};
  for (std::size_t k = 0; k < sensors.size() && k < fitted.rms.size(); ++k) {
    if (std::isnan(fitted.rms[k]) || fitted.rms[k] <= gross_from * sensors[k].noise) continue;
    if (!sensors[k].noise_known || !(fitted.rms[k] < like_noise * largest_noise(records, k))) return std::nullopt;
    out.cure +=
        fmt::format("{}noise = {:.3g} in the sensor \"{}\"", out.cure.empty() ? "" : ", ",
                    fitted.rms[k] / sensors[k].dimension().unit(problem.experiment().scene.units), sensors[k].name);
  }
  return out.cure.empty() ? std::nullopt : std::optional(out);
}

}  // namespace

std::vector<double> compared_noise(const Experiment& experiment, const std::vector<Record>& records) {
  std::vector<double> out;
  for (std::size_t k = 0; k < experiment.sensors.size(); ++k) {
    const Sensor& sensor = experiment.sensors[k];
    out.push_back(sensor.noise_known ? sensor.noise : largest_noise(records, k));
  }
  return out;
}

std::optional<GrossMisfit> gross_misfit(const FitProblem& problem, const Fit& fitted,
                                        const std::vector<Record>& records) {
  if (!fitted.usable()) return std::nullopt;
  const std::vector<Sensor>& sensors = problem.experiment().sensors;
  const std::vector<double> signal = signals(records, sensors.size());
  const std::vector<double> noise = compared_noise(problem.experiment(), records);
  std::optional<GrossMisfit> out;
  for (std::size_t k = 0; k < sensors.size() && k < fitted.rms.size(); ++k) {
    if (std::isnan(fitted.rms[k])) continue;
    const bool is_robust = fitted.weighting.loss != Loss::squares && k < fitted.errors.sensors.size();
    const double size = is_robust ? fitted.errors.sensors[k].ratio * fitted.weighting.noise[k] : fitted.rms[k];
    GrossMisfit one{.sensor = k, .over_noise = size / noise[k], .of_signal = size / signal[k], .words = {}};
    const bool by_noise = one.over_noise > gross_from;
    const auto by_signal = [&] {
      return one.of_signal > part_of_signal && size > gross_from * largest_noise(records, k) &&
             std::any_of(fitted.runs.begin(), fitted.runs.end(), [&](const RunFit& run) { return run.correlated[k]; });
    };
    if (!by_noise && !by_signal()) continue;
    if (out && one.over_noise <= out->over_noise) continue;
    one.words = by_noise
                    ? fmt::format("residuals of {} are {:.3g} times the {}", sensors[k].name, one.over_noise,
                                  sensors[k].noise_known ? "stated noise" : "largest noise that its readings can have")
                    : fmt::format("residuals of {} are {:.2g} % of its readings' variation, and no independent noise",
                                  sensors[k].name, 100 * one.of_signal);
    out = std::move(one);
  }
  return out;
}

std::vector<MisfitCause> misfit_causes(const FitProblem& problem, const Fit& fitted, const std::vector<Record>& records,
                                       const CauseOptions& options) {
  Experiment experiment = problem.experiment();
  // What is tried is about clocks and columns of what was measured.
  if (std::any_of(experiment.runs.begin(), experiment.runs.end(), [](const Run& run) { return run.is_simulated(); })) {
    return {};
  }
  if (std::optional<MisfitCause> small = understated_noise(problem, fitted, records)) return {std::move(*small)};
  experiment.records = records;
  experiment.loss = Loss::squares;
  const std::vector<double> noise = compared_noise(experiment, records);
  if (std::any_of(noise.begin(), noise.end(), [](double n) { return !std::isfinite(n); })) return {};
  for (std::size_t k = 0; k < noise.size(); ++k) experiment.sensors[k].noise = noise[k];
  std::vector<CauseCandidate> candidates =
      cause_candidates(experiment, fitted.runs.empty() ? std::vector<std::size_t>{} : worst_first(fitted));
  if (const std::optional<double> length = forgets_start_after(problem, fitted)) add_pieces(*length, candidates);
  std::vector<std::unique_ptr<CauseFit>> fits;
  for (const CauseCandidate& one : candidates) {
    fits.push_back(std::make_unique<CauseFit>(one, experiment, problem, fitted, options.interrupt));
  }
  // Where two causes explain the readings equally well, the one without an unknown number is likelier.
  constexpr double for_number = 1.1;
  const auto size = [&](std::size_t i) {
    return fits[i]->reached().of_columns * (candidates[i].has_number() ? for_number : 1.0);
  };
  std::vector<std::size_t> left;
  for (std::size_t i = 0; i < fits.size(); ++i) left.push_back(i);
  struct Stage {
    double window;
    int steps;
    std::size_t most;  // of the candidates
  };
  constexpr std::array stages = {Stage{0.12, 6, 1000}, Stage{0.3, 6, 24}, Stage{0.6, 8, 8}, Stage{1.0, 15, 6}};
  for (const Stage& stage : stages) {
    if (left.size() > stage.most) left.resize(stage.most);
    // What is written is always fitted to all.
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      if (i > 0 && !candidates[i].shows_late) continue;
      if (std::find(left.begin(), left.end(), i) == left.end()) left.push_back(i);
    }
    solvers::parallel_for(left.size(), {options.jobs, options.interrupt, {}}, [&](std::size_t n) {
      CauseFit& one = *fits[left[n]];
      try {
        if (&stage == stages.data()) {
          one.begin(stage.window, stage.steps);
        } else {
          one.go_on(stage.window, stage.steps);
        }
      } catch (const std::exception&) {
        one.give_up();  // no pose has such readings
      }
    });
    if (options.interrupt != nullptr && options.interrupt->load()) return {};
    std::stable_sort(left.begin(), left.end(), [&](std::size_t a, std::size_t b) { return size(a) < size(b); });
  }
  const Reached& as_written = fits.front()->reached();
  const bool is_explained = as_written.worst <= gross_from;
  const auto explains = [&](std::size_t i, double before) {
    return fits[i]->reached().worst <= gross_from && fits[i]->reached().of_columns < cures_to * before;
  };
  const bool is_better_explained =
      std::any_of(left.begin(), left.end(), [&](std::size_t i) { return i > 0 && explains(i, as_written.of_columns); });
  if (is_explained && !is_better_explained) {  // whatever else is changed then explains the readings too
    const std::string cure = fmt::format("give starts near {}", words_of(problem, as_written.parameters));
    return {{candidates.front().words, cure, as_written.over_noise, true}};
  }
  const double written =
      std::min(as_written.over_noise, fitted.usable() ? over_noise_of(noise, fitted, records) : INFINITY);
  const auto cures = [&](std::size_t i) { return explains(i, written); };
  const auto part_cures = [&](CauseCandidate::LeavesOut part) {
    return std::any_of(left.begin(), left.end(),
                       [&](std::size_t i) { return candidates[i].leaves_out == part && cures(i); });
  };
  // Where the records fit without their beginning as well as without their end, neither is something else: what is
  // wrong adds up along them.
  const bool adds_up = part_cures(CauseCandidate::LeavesOut::beginning) && part_cures(CauseCandidate::LeavesOut::end);
  std::vector<MisfitCause> out;
  std::optional<double> first;
  constexpr double as_good = 1.3;
  constexpr std::size_t most_causes = 4;
  for (const std::size_t i : left) {
    const Reached& reached = fits[i]->reached();
    if (i == 0 || !(cures(i) || reached.of_columns < lowers_to * written) || out.size() == most_causes) continue;
    if (adds_up && candidates[i].leaves_out != CauseCandidate::LeavesOut::nothing) continue;
    if (first && size(i) > as_good * *first) break;
    if (!first) first = reached.of_columns;
    if (!out.empty() && candidates[i].has_number()) continue;
    out.push_back({candidates[i].words, candidates[i].cure(reached.number), reached.over_noise, cures(i)});
  }
  return out;
}

}  // namespace poise
