#include "identification/fit.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

#include <boost/math/distributions/normal.hpp>
#include <ceres/ceres.h>
#include <fmt/format.h>
#include <glog/logging.h>

#include "identification/autocorrelation.hpp"
#include "identification/ceres_costs.hpp"
#include "identification/curvature.hpp"
#include "identification/first_readings.hpp"
#include "identification/frequencies.hpp"
#include "identification/oscillation_start.hpp"
#include "identification/run_influence.hpp"
#include "identification/twins.hpp"
#include "solvers/linear_algebra.hpp"
#include "solvers/not_a_number.hpp"
#include "solvers/parallel.hpp"
#include "solvers/random_stream.hpp"

namespace poise {
namespace {

/// Of the estimated noise: rounds, and the relative change at which they end.
constexpr int most_noise_rounds = 30;
constexpr double noise_is_found = 1e-3;
/// Of a fit whose residuals are as stated, that one of its tests says they are not.
constexpr double chance_level = 1e-3;
/// A ratio of residuals to noise above this indicates a local minimum or an incomplete model.
constexpr double suspicious_ratio = 1.3;
/// From here on other starts are tried although the model is in phase with the records: an incomplete model leads from
/// all of them to one minimum.
constexpr double doubtful_from = 3.0;
/// A local minimum leaves at least this part of the readings' variation in the residuals.
constexpr double lost_from = 0.1;

/// Minima whose sums of squared residuals, over the noise, differ by less than this are equally good: of two, noise
/// prefers the wrong one by that much with a probability of at most Phi(-sqrt(16)) = 3e-5.
constexpr double equally_good = 16.0;
/// Ratio of the frequencies of successive starts that are tried where a minimum is local.
constexpr double next_frequency = 1.15;
constexpr int most_octaves = 2;
/// Of these, and of those at aliases, so many are fitted to the whole records: the best ones of a shorter fit.
constexpr std::size_t most_scaled = 3, most_aliases = 8;
/// How often a lower cost found beside the minimum leads to another one.
constexpr int most_improvements = 3;
/// Of minima with other dimensions, so many are compared. A number agrees in all of them where it changes by less than
/// this part of its standard error.
constexpr std::size_t most_twins = 3;
/// Parameters that are tried where sensors do not read all states: so many, changed by up to this factor.
constexpr std::uint64_t most_far = 24;
constexpr double far_factor = 3.0;
/// A part of a parameter's reach that changes frequencies, if it does, by more than this part squared.
constexpr double slightly = 1e-3;
constexpr double agrees_within = 0.3;
/// An interval that is longer by this part of it is said to be.
constexpr double nearly_straight = 0.1;
/// As many equally good minima are sought.
constexpr std::size_t enough_alternatives = 3;
/// Motions of a fit that only has to be a start for more readings are less accurate by this factor, down to this.
constexpr double accuracy_of_start = 100.0, least_accuracy = 1e-4;

class Fitting {
 public:
  Fitting(const FitProblem& problem, const std::vector<Record>& records, const FitOptions& options)
      : problem_(problem), records_(records), options_(options) {
    out_.weighting = problem.weighting();
  }

  Fit run() {
    const auto begun = std::chrono::steady_clock::now();
    search();
    if (best_cost_ < INFINITY) {
      if (options_.values_only) {
        keep_values();
      } else {
        if (options_.from == nullptr) estimate_noise();
        evaluate();
      }
    }
    const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - begun;
    out_.microseconds = took.count();
    return std::move(out_);
  }

 private:
  struct Minimum {
    double cost = INFINITY;
    FitPoint point;
    bool operator<(const Minimum& other) const { return cost < other.cost; }
  };

  void search() {
    for (const Record& record : records_) {
      out_.readings += static_cast<int>(record.count());
      for (std::size_t k = 0; k < record.sensors.size(); ++k) {
        const std::vector<double>& values = record.sensors[k].value;
        if (values.empty()) continue;
        const Eigen::Map<const Eigen::ArrayXd> reading(values.data(), static_cast<Eigen::Index>(values.size()));
        const double noise = out_.weighting.noise[k];
        signal_ += (reading - reading.mean()).square().sum() / (noise * noise);
      }
    }
    const auto parameters = static_cast<int>(problem_.parameters().size() - options_.held.size());
    const int found = parameters + (options_.holds_starts ? 0 : problem_.nuisances());
    out_.degrees_of_freedom = out_.readings - found;
    if (out_.degrees_of_freedom <= 0) {
      out_.status = FitStatus::failed;
      out_.why = fmt::format("{} readings do not determine {} values; add readings", out_.readings, found);
      return;
    }
    // First guesses are least squares, or follow from few readings.
    if (out_.weighting.loss != Loss::squares) {
      for (const Record& record : records_) cleaned_.push_back(without_outliers(record));
    }
    if (options_.from != nullptr) {
      out_.start = "from another fit";
      out_.weighting = options_.from->weighting;
      FitPoint point{options_.from->parameters, {}};
      for (const RunFit& run : options_.from->runs) point.nuisances.push_back(run.nuisances);
      for (const auto& [p, value] : options_.held) point.parameters[static_cast<std::size_t>(p)] = value;
      if (options_.holds_starts || found == 0) {
        best_cost_ = cost_of(point);
        best_ = std::move(point);
        failure_ = "the motion could not be computed";
      } else if (parameters == 0 && !options_.values_only) {
        attempt(std::move(point), {0.1, 0.35, 1.0});  // other records: the starts are guesses
      } else {
        attempt(std::move(point), {1.0});
      }
      if (stopped() || !(best_cost_ < INFINITY)) {
        out_.status = stopped() ? FitStatus::interrupted : FitStatus::failed;
        out_.why = stopped() ? "interrupted" : failure_;
      }
      return;
    }
    std::optional<OscillationStart> oscillations;
    if (!options_.use_starts) {
      say("fitting a damped sine to every record");
      oscillations = start_from_oscillations(problem_, for_guesses());
    }
    bool guesses = !oscillations;
    if (oscillations) {
      out_.start = "from damped sines fitted to the records and linear least squares, no guess needed";
      attempt({oscillations->parameters, oscillations->nuisances}, {1.0});
    } else {
      out_.start = "as given, fitted over windows that grow to the whole records";
      attempt(given(0), {0.1, 0.35, 1.0});
    }
    for (int retry = 1; retry <= options_.retries && !stopped() && (is_suspicious() || is_doubtful()); ++retry) {
      say(fmt::format("residuals are {:.3g} times the noise: trying another start, {} of {}",
                      residual_over_noise(best_cost_), retry, options_.retries));
      guesses = true;
      const double before = best_cost_;
      attempt(given(retry), {0.03, 0.08, 0.2, 0.45, 1.0});
      // The same minimum from another start: the model is incomplete.
      if (std::abs(best_cost_ - before) < 1e-3 * before && last_cost_ < 1.001 * before) break;
    }
    if (!stopped() && best_cost_ < INFINITY) attempt_aliases();
    if (!stopped() && is_suspicious()) {
      guesses = true;
      attempt_scaled_frequencies();
      if (!is_suspicious()) attempt_aliases();
    }
    if (!guesses && any_release_is_a_guess()) out_.start += "; the release of measured runs was not used";
    if (stopped()) {
      out_.status = FitStatus::interrupted;
      out_.why = best_cost_ < INFINITY ? "interrupted; the values reached so far are shown"
                                       : "interrupted before the first step; no values were reached";
    } else if (!(best_cost_ < INFINITY)) {
      out_.status = FitStatus::failed;
      out_.why = failure_.empty() ? "no minimum was reached from any start" : failure_;
    }
  }

  const std::vector<Record>& for_guesses() const { return cleaned_.empty() ? records_ : cleaned_; }

  /// In a local minimum the model is out of phase with the records: a large part of the variation is left.
  bool is_suspicious() const {
    return residual_over_noise(best_cost_) > suspicious_ratio && 2 * best_cost_ > lost_from * lost_from * signal_;
  }

  bool is_doubtful() const { return residual_over_noise(best_cost_) > doubtful_from; }

  /// Whether a run states a release that is neither the truth of a simulation nor a known start.
  bool any_release_is_a_guess() const {
    const std::vector<Run>& runs = problem_.experiment().runs;
    return std::any_of(runs.begin(), runs.end(),
                       [](const Run& run) { return !run.is_simulated() && run.unknown_start && !run.release.empty(); });
  }

  /// The experiment's starts, from the first retry on changed at random by up to 30 %.
  FitPoint given(int retry) {
    FitPoint point;
    point.parameters = options_.starts.empty() ? problem_.starts() : options_.starts;
    solvers::RandomStream random(static_cast<std::uint64_t>(retry));
    for (std::size_t i = 0; retry > 0 && i < point.parameters.size(); ++i) {
      const Parameter& p = problem_.parameters()[i];
      point.parameters[i] = std::clamp(point.parameters[i] + p.scale * random.uniform(-0.3, 0.3), p.min, p.max);
    }
    for (std::size_t r = 0; r < problem_.runs(); ++r) {
      const RunModel& run = problem_.run(r);
      point.nuisances.push_back(first_guess(run, problem_.unknowns_of(r, point.parameters), for_guesses()[r]));
    }
    return point;
  }

  void attempt(FitPoint point, const std::vector<double>& windows) {
    ++out_.tries;
    double cost = INFINITY;
    bool moved = false;
    for (const double window : windows) {
      if (stopped()) break;
      if (windows.size() > 1) say(fmt::format("fitting the first {:.0f} % of every record", 100 * window));
      // A window that fails is skipped: a longer one may still succeed.
      const double reached = minimise(point, window);
      if (window == 1.0) cost = reached;
      moved = moved || reached < INFINITY;
    }
    // Interrupted in a window, or within the first step of the next one: what the whole records say of that point.
    if (stopped() && moved && !(best_cost_ < INFINITY)) cost = cost_of(point);
    last_cost_ = cost;
    if (cost < best_cost_) {
      best_cost_ = cost;
      best_ = std::move(point);
    }
  }

  /// Of the whole records; infinite where a motion fails.
  double cost_of(const FitPoint& point) const {
    return problem_.cost(point.parameters, point.nuisances, records_, out_.weighting, options_.jobs);
  }

  /// A start with a wrong frequency ends in a local minimum: the experiment's starts with all frequencies scaled, over
  /// short windows, then the best of these over the whole records.
  void attempt_scaled_frequencies() {
    say("residuals exceed the noise: trying starts with other frequencies");
    const FitPoint start = given(0);
    const Frequencies frequencies(problem_, start);
    if (frequencies.modes().empty()) return;
    struct Start {
      double cost;
      FitPoint point;
    };
    std::vector<Start> starts;
    const int most = static_cast<int>(most_octaves * std::log(2.0) / std::log(next_frequency));
    constexpr double window = 0.05;
    for (int k = -most; k <= most && !stopped(); ++k) {
      std::vector<double> wanted;
      for (const Frequencies::Mode& mode : frequencies.modes()) {
        wanted.push_back(mode.frequency * std::pow(next_frequency, k));
      }
      FitPoint point = start;
      if (k != 0) {
        const auto found = frequencies.parameters_with(wanted, start.parameters);
        if (!found) continue;
        point.parameters = *found;
      }
      ++out_.tries;
      const double cost = minimise(point, window);
      if (cost < INFINITY) starts.push_back({cost, std::move(point)});
    }
    std::sort(starts.begin(), starts.end(), [](const Start& a, const Start& b) { return a.cost < b.cost; });
    for (std::size_t i = 0; i < std::min(most_scaled, starts.size()) && !stopped() && is_suspicious(); ++i) {
      attempt(std::move(starts[i].point), {0.1, 0.2, 0.45, 1.0});
    }
  }

  /// Fits from parameters with the frequencies that the readings may be mistaken for, and compares the minima.
  void attempt_aliases() {
    const FitPoint start = given(0);
    std::vector<Minimum> minima = {{best_cost_, best_}};
    // What is found may have aliases that the first minimum had not.
    for (int round = 0; round < 2 && !stopped(); ++round) {
      const FitPoint from = best_;
      const Frequencies frequencies(problem_, from);
      aliased_ = frequencies.have_aliases(start.parameters);
      if (!aliased_ && !is_suspicious()) break;
      std::vector<Minimum> starts;
      for (std::vector<double>& parameters : frequencies.alternatives(start.parameters, records_)) {
        if (stopped()) return;
        if (starts.empty()) say("trying other frequencies that the readings allow");
        starts.push_back(with_nuisances(from, std::move(parameters), frequencies));
      }
      std::sort(starts.begin(), starts.end());
      const std::size_t before = minima.size();
      for (std::size_t i = 0; i < std::min(most_aliases, starts.size()) && !stopped(); ++i) {
        if (!(starts[i].cost < INFINITY)) break;
        ++out_.tries;
        FitPoint& point = starts[i].point;
        const double cost = minimise(point, 1.0);
        if (cost < INFINITY) minima.push_back({cost, point});
        if (cost < best_cost_) {
          best_cost_ = cost;
          best_ = point;
        }
        if (find_alternatives(minima); out_.alternatives.size() >= enough_alternatives) return;
      }
      if (minima.size() == before || !frequencies.differ(best_.parameters)) break;
    }
    find_alternatives(minima);
  }

  Alternative alternative(const std::vector<double>& parameters, const Frequencies& frequencies, double more) const {
    Alternative out;
    out.more = more;
    for (const Frequencies::Mode& mode : frequencies.modes()) {
      if (mode.runs.front() == 0) out.frequency.push_back(mode.frequency);
    }
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      out.values.push_back(parameters[i] + problem_.unknown_of(i).includes);
    }
    return out;
  }

  /// Sum of squared residuals over the noise, less that of the best point.
  double more_than_best(double cost) const {
    const double noise = std::max(1.0, residual_over_noise(best_cost_));
    return 2 * (cost - best_cost_) / (noise * noise);
  }

  /// The minima that are as good as the best one, unless it is the only one.
  void find_alternatives(std::vector<Minimum>& minima) {
    out_.alternatives.clear();
    std::sort(minima.begin(), minima.end());
    std::vector<Frequencies> distinct;
    for (const Minimum& minimum : minima) {
      const double more = more_than_best(minimum.cost);
      if (!(more < equally_good)) break;
      const auto same = [&](const Frequencies& one) { return !one.differ(minimum.point.parameters); };
      if (std::any_of(distinct.begin(), distinct.end(), same)) continue;
      distinct.emplace_back(problem_, minimum.point);
      out_.alternatives.push_back(alternative(minimum.point.parameters, distinct.back(), more));
    }
    if (out_.alternatives.size() < 2) out_.alternatives.clear();
  }

  /// Other parameters with the nuisances of a minimum moved to where its cost, linearised, is least; the cost there.
  /// Small motions are linear in their starts.
  Minimum with_nuisances(const FitPoint& from, std::vector<double> parameters, const Frequencies& frequencies) const {
    const std::vector<double> there = frequencies.at(parameters);
    const double faster = there.empty() ? 1.0 : there.front() / frequencies.modes().front().frequency;
    Minimum out{0.0, {std::move(parameters), from.nuisances}};
    for (std::size_t r = 0; r < problem_.runs(); ++r) {
      const RunModel& run = problem_.run(r);
      std::vector<double>& nuisances = out.point.nuisances[r];
      if (run.start_is_unknown()) {
        std::for_each(nuisances.end() - run.freedoms(), nuisances.end(), [&](double& rate) { rate *= faster; });
      }
      const Eigen::MatrixXd R =
          problem_.triangle(r, out.point.parameters, nuisances, &records_[r], INFINITY, 1e-5, out_.weighting);
      if (R.size() == 0) return {INFINITY, std::move(out.point)};
      const Eigen::Index n = run.nuisances();
      out.cost += R.col(R.cols() - 1).tail(R.rows() - n).squaredNorm() / 2;
      if (n == 0) continue;
      const Eigen::VectorXd step =
          solvers::minimum_norm_solution<double>(R.topLeftCorner(n, n), R.col(R.cols() - 1).head(n));
      for (Eigen::Index i = 0; i < n; ++i) nuisances[static_cast<std::size_t>(i)] -= step[i];
    }
    return out;
  }

  /// The time up to which a part of run r is fitted; it contains enough readings for the run's own values.
  double until(std::size_t r, double window) const {
    const RunModel& run = problem_.run(r);
    if (window == 1.0) return INFINITY;
    const auto least = static_cast<std::size_t>(run.columns()) + 4;
    double part = window;
    while (part < 1.0 && run.readings(part * run.span()) < least) part *= 1.5;
    return part < 1.0 ? part * run.span() : INFINITY;
  }

  /// Few readings leave some directions of the parameters nearly free, and along these a step goes as far as residuals
  /// of a wrong start drive it: to dimensions of kilometres, from which there is no way back. So a change of a
  /// parameter by its reach counts as much as a reading at the start does.
  void stay_near(ceres::Problem& problem, const std::vector<double>& parameters, double window,
                 std::vector<double>& scaled) const {
    double cost = 0.0;
    if (!problem.Evaluate({}, &cost, nullptr, nullptr, nullptr)) return;
    std::size_t readings = 0;
    for (std::size_t r = 0; r < problem_.runs(); ++r) readings += problem_.run(r).readings(until(r, window));
    const double residual =
        std::max(1.0, std::sqrt(2 * cost / static_cast<double>(std::max<std::size_t>(readings, 1))));
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      problem.AddResidualBlock(
          new PriorCost(parameters[i], problem_.reach(i) / residual, problem_.parameters()[i].scale), nullptr,
          &scaled[i]);
    }
  }

  double minimise(FitPoint& point, double window) {
    const std::vector<Parameter>& parameters = problem_.parameters();
    std::vector<double> scaled;
    for (std::size_t i = 0; i < parameters.size(); ++i) scaled.push_back(point.parameters[i] / parameters[i].scale);
    std::vector<std::vector<double>> shifts;
    for (const auto& nuisances : point.nuisances) shifts.emplace_back(nuisances.size(), 0.0);
    const bool is_start = window < 1.0;
    RunsInParallel runs(options_.jobs);
    ceres::Problem::Options problem_options;
    problem_options.evaluation_callback = &runs;
    ceres::Problem problem(problem_options);
    struct OfRun {
      RunCost* cost;
      std::vector<double*> blocks;
    };
    std::vector<OfRun> costs;
    for (std::size_t r = 0; r < problem_.runs(); ++r) {
      std::vector<double*> blocks;
      for (const int p : problem_.parameters_of(r)) blocks.push_back(&scaled[static_cast<std::size_t>(p)]);
      if (!shifts[r].empty()) blocks.push_back(shifts[r].data());
      const double accuracy =
          is_start ? std::min(least_accuracy, accuracy_of_start * problem_.accuracy(r)) : problem_.accuracy(r);
      auto* cost = new RunCost(problem_, r, records_[r], until(r, window), accuracy, out_.weighting, point.nuisances[r],
                               out_.evaluations, options_.interrupt);
      problem.AddResidualBlock(cost, nullptr, blocks);
      runs.add(*cost, blocks);
      costs.push_back({cost, std::move(blocks)});
    }
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      const Unknown& unknown = problem_.unknown_of(i);
      if (unknown.prior) {
        problem.AddResidualBlock(
            new PriorCost(*unknown.prior - unknown.includes, unknown.prior_deviation, parameters[i].scale), nullptr,
            &scaled[i]);
      }
    }
    if (is_start) stay_near(problem, point.parameters, window, scaled);
    for (const auto& [p, value] : options_.held)
      problem.SetParameterBlockConstant(&scaled[static_cast<std::size_t>(p)]);
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.logging_type = ceres::SILENT;
    options.max_num_iterations = 60;
    // Trial dimensions with which the mechanism cannot be assembled make a step invalid, and the next one shorter.
    options.max_num_consecutive_invalid_steps = 20;
    options.function_tolerance = is_start ? 1e-3 : options_.function_tolerance;
    options.parameter_tolerance = 1e-14;
    options.gradient_tolerance = 1e-12;
    // Full steps are tried first: small oscillations are nearly linear in the parameters.
    options.initial_trust_region_radius = 1e6;
    options.update_state_every_iteration = true;
    Watch watch(options_.interrupt, is_start, options.function_tolerance, [&] {
      for (std::size_t i = 0; i < parameters.size(); ++i) {
        const Parameter& p = parameters[i];
        if (scaled[i] < p.min / p.scale || scaled[i] > p.max / p.scale) return true;
      }
      return false;
    });
    options.callbacks.push_back(&watch);
    const std::optional<double> cost = minimise_within_ranges(problem, options, scaled);
    if (!cost) {
      failure_ = why_failed(point);
      return INFINITY;
    }
    for (std::size_t i = 0; i < parameters.size(); ++i) point.parameters[i] = scaled[i] * parameters[i].scale;
    for (std::size_t r = 0; r < problem_.runs(); ++r) {
      for (std::size_t i = 0; i < shifts[r].size(); ++i) point.nuisances[r][i] += shifts[r][i];
    }
    computed_.clear();
    computed_at_ = point;
    for (OfRun& run : costs) {
      if (!is_start) computed_.push_back(run.cost->take(run.blocks.data()));
    }
    return *cost;
  }

  std::string why_failed(const FitPoint& start) const {
    for (std::size_t r = 0; r < problem_.runs(); ++r) {
      const std::string why = problem_.why_no_motion(r, start.parameters, start.nuisances[r]);
      if (!why.empty()) {
        return fmt::format("the motion of run \"{}\" could not be computed at the start: {}",
                           problem_.run(r).run().name, why);
      }
    }
    return "no step from the start reduced the cost";
  }

  /// Ceres' own bounds cost a line search in every step, so ranges are kept by an active set: a parameter that leaves
  /// its range is held at the bound, and released where its gradient points inside again, as long as that lowers the
  /// cost.
  std::optional<double> minimise_within_ranges(ceres::Problem& problem, const ceres::Solver::Options& options,
                                               std::vector<double>& scaled) {
    const std::vector<Parameter>& parameters = problem_.parameters();
    std::vector<char> held(parameters.size(), 0);
    const auto is_given = [&](std::size_t i) {
      return std::any_of(options_.held.begin(), options_.held.end(),
                         [&](const auto& one) { return one.first == static_cast<int>(i); });
    };
    const bool starts_from_fit = out_.iterations > 0 || options_.from != nullptr;
    for (std::size_t i = 0; i < parameters.size() && starts_from_fit; ++i) {
      // A parameter that a shorter window, or another fit, left at a bound is held there at first.
      if (scaled[i] * parameters[i].scale > parameters[i].min && scaled[i] * parameters[i].scale < parameters[i].max) {
        continue;
      }
      held[i] = 1;
      problem.SetParameterBlockConstant(&scaled[i]);
    }
    double reached = INFINITY;
    for (std::size_t round = 0;; ++round) {
      const std::optional<double> cost = solve(problem, options);
      if (!cost || stopped() || round > 2 * parameters.size()) return cost;
      bool changed = false;
      for (std::size_t i = 0; i < parameters.size(); ++i) {
        const double kept =
            std::clamp(scaled[i], parameters[i].min / parameters[i].scale, parameters[i].max / parameters[i].scale);
        if (kept == scaled[i] || is_given(i)) continue;
        scaled[i] = kept;
        held[i] = 1;
        problem.SetParameterBlockConstant(&scaled[i]);
        changed = true;
      }
      if (changed) continue;
      if (*cost > reached * (1 - options.function_tolerance)) return cost;
      reached = *cost;
      for (std::size_t i = 0; i < parameters.size() && round <= parameters.size(); ++i) {
        if (held[i] == 0 || is_given(i)) continue;
        problem.SetParameterBlockVariable(&scaled[i]);
        ceres::Problem::EvaluateOptions only;
        only.parameter_blocks = {&scaled[i]};
        std::vector<double> gradient;
        problem.Evaluate(only, nullptr, nullptr, &gradient, nullptr);
        const bool at_min = scaled[i] * parameters[i].scale <= parameters[i].min;
        if (!gradient.empty() && (at_min ? gradient[0] < 0 : gradient[0] > 0)) {
          held[i] = 0;
          changed = true;
        } else {
          problem.SetParameterBlockConstant(&scaled[i]);
        }
      }
      if (!changed) return cost;
    }
  }

  /// The cost reached.
  std::optional<double> solve(ceres::Problem& problem, const ceres::Solver::Options& options) {
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    out_.iterations += static_cast<int>(summary.iterations.size());
    if (!summary.IsSolutionUsable()) return std::nullopt;
    return summary.final_cost;
  }

  double residual_over_noise(double cost) const { return std::sqrt(2 * cost / out_.degrees_of_freedom); }
  bool stopped() const { return options_.interrupt != nullptr && options_.interrupt->load(); }
  void say(const std::string& what) const {
    if (options_.progress) options_.progress(what);
  }

  /// Whether the noise of sensor k is estimated: where it is not stated, and always the scale of Student's t.
  bool estimates_noise(std::size_t k) const {
    return !problem_.experiment().sensors[k].noise_known || out_.weighting.loss == Loss::student;
  }

  /// The noise of a sensor follows from the residuals of the fit, which follows from the noise of all: by turns. With
  /// the values that the readings of each sensor determine subtracted from their number, the sizes are those of
  /// restricted maximum likelihood (D. A. Harville, 1977).
  void estimate_noise() {
    const std::size_t sensors = out_.weighting.noise.size();
    bool any = false;
    for (std::size_t k = 0; k < sensors; ++k) any = any || estimates_noise(k);
    for (int round = 0; any && round < most_noise_rounds && !stopped(); ++round) {
      say(fmt::format("estimating the noise of the sensors, round {}", round + 1));
      if (!linearize() || out_.errors.sensors.empty()) return;
      double change = 0.0;
      for (std::size_t k = 0; k < sensors; ++k) {
        const double ratio = out_.errors.sensors[k].ratio;
        if (!estimates_noise(k) || !(ratio > 0)) continue;
        out_.weighting.noise[k] *= ratio;
        change = std::max(change, std::abs(ratio - 1));
      }
      FitPoint point = best_;
      const double cost = minimise(point, 1.0);
      if (!(cost < INFINITY)) return;
      best_cost_ = cost;
      best_ = std::move(point);
      if (change < noise_is_found) return;
    }
  }

  /// Runs, identifiability and standard errors at the best point; false where a motion fails.
  bool linearize() {
    // The last evaluation of a fit is often that of its result.
    const bool computed = computed_.size() == problem_.runs() && computed_at_ == best_;
    linear_.assign(problem_.runs(), {});
    std::vector<Eigen::MatrixXd> triangles(problem_.runs());
    solvers::parallel_for(problem_.runs(), {.jobs = options_.jobs}, [&](std::size_t r) {
      linear_[r] = computed && computed_[r] ? std::move(*computed_[r])
                                            : problem_.linearized(r, best_.parameters, best_.nuisances[r], &records_[r],
                                                                  INFINITY, problem_.accuracy(r), out_.weighting);
      triangles[r] = triangle_of(linear_[r]);
    });
    computed_.clear();
    out_.identifiability = assess(problem_, best_.parameters, best_.nuisances, triangles, out_.weighting);
    if (!out_.identifiability.ok) return false;
    out_.errors = standard_errors(problem_, out_.identifiability.covariance, linear_, out_.weighting);
    return true;
  }

  static Eigen::MatrixXd triangle_of(const LinearRun& run) {
    Eigen::MatrixXd rows = run.rows;
    if (rows.size() == 0) return {};
    if (rows.rows() < rows.cols()) rows.conservativeResizeLike(Eigen::MatrixXd::Zero(rows.cols(), rows.cols()));
    return solvers::triangular_factor(rows);
  }

  /// Standard errors of combinations, and correlations, by what the residuals allow.
  void lead_with_residuals() {
    std::vector<double> shown;
    for (const Estimate& estimate : out_.estimates) shown.push_back(estimate.value);
    for (Identifiability::Combination& known : out_.identifiability.combinations) {
      known.standard_error = out_.errors.of(known.gradient(shown));
    }
    auto& correlation = out_.identifiability.correlation;
    const Eigen::VectorXd error = out_.errors.covariance.diagonal().cwiseSqrt();
    for (std::size_t i = 0; i < correlation.size(); ++i) {
      for (std::size_t j = 0; j < correlation.size(); ++j) {
        const auto row = static_cast<Eigen::Index>(i);
        const auto column = static_cast<Eigen::Index>(j);
        if (correlation[i][j]) correlation[i][j] = out_.errors.covariance(row, column) / (error[row] * error[column]);
      }
    }
  }

  void keep_values() {
    out_.parameters = best_.parameters;
    out_.cost = best_cost_;
    for (std::size_t r = 0; r < problem_.runs(); ++r) {
      RunFit& run = out_.runs.emplace_back();
      run.name = problem_.run(r).run().name;
      run.nuisances = best_.nuisances[r];
    }
    if (out_.status == FitStatus::not_run) out_.status = FitStatus::converged;
  }

  /// Fills the result from the best point, and again from a better one that it leads to.
  void evaluate() {
    const FitStatus so_far = out_.status;
    describe();
    for (int round = 0; round < most_improvements && (correct_for_curvature() || attempt_twins()); ++round) {
      out_.status = so_far;
      out_.runs.clear();
      out_.rms.clear();
      out_.estimates.clear();
      describe();
    }
    compare_twins();
    if (is_to_be_questioned()) examine_runs(problem_, records_, linear_, options_, out_);
  }

  bool is_to_be_questioned() const {
    return out_.usable() && out_.identifiability.ok && options_.from == nullptr && !stopped();
  }

  /// Whether the sensors of a run read fewer angles and travels than it has degrees of freedom: then the same readings
  /// may be those of another mechanism in other states.
  bool hides_states() const {
    const std::vector<Sensor>& sensors = problem_.experiment().sensors;
    for (std::size_t r = 0; r < problem_.runs(); ++r) {
      int read = 0;
      for (std::size_t k = 0; k < sensors.size(); ++k) {
        if (!problem_.run(r).times()[k].empty() && sensors[k].reads_coordinate()) ++read;
      }
      if (read < problem_.run(r).freedoms()) return true;
    }
    return false;
  }

  /// Parameters that the frequencies depend on.
  std::vector<std::size_t> that_change(const Frequencies& frequencies) const {
    const std::vector<double> here = frequencies.at(best_.parameters);
    std::vector<std::size_t> out;
    for (std::size_t i = 0; i < best_.parameters.size(); ++i) {
      std::vector<double> moved = best_.parameters;
      moved[i] += slightly * problem_.reach(i);
      const std::vector<double> there = frequencies.at(moved);
      bool changes = there.size() != here.size();
      for (std::size_t k = 0; k < here.size() && !changes; ++k) {
        changes = std::abs(there[k] - here[k]) > slightly * slightly * here[k];
      }
      if (changes) out.push_back(i);
    }
    return out;
  }

  /// Parameters that have the frequencies of the minimum: from those with some of `changed` moved at random, numbers
  /// that keep their sign by up to a factor, others by up to their reach. Nothing where none are found there.
  std::optional<std::vector<double>> with_same_frequencies(const Frequencies& frequencies,
                                                           const std::vector<std::size_t>& changed,
                                                           std::uint64_t number) const {
    solvers::RandomStream random(number);
    std::vector<double> out = best_.parameters;
    for (const std::size_t i : changed) {
      const Parameter& p = problem_.parameters()[i];
      const bool keeps = random.uniform() < 0.5;
      const double by = random.uniform(-1, 1);
      if (keeps) continue;
      out[i] = p.min >= 0 && out[i] > 0 ? out[i] * std::pow(far_factor, by) : out[i] + problem_.reach(i) * by;
      out[i] = std::clamp(out[i], p.min, p.max);
    }
    std::vector<double> wanted;
    for (const Frequencies::Mode& mode : frequencies.modes()) wanted.push_back(mode.frequency);
    return frequencies.parameters_with(wanted, out);
  }

  /// Minima of fits from such parameters where the sensors do not read all states: those of the lowest cost that differ
  /// from each other by more than the intervals say.
  std::vector<Minimum> with_other_states() {
    std::vector<Minimum> out;
    if (!hides_states()) return out;
    const Frequencies frequencies(problem_, best_);
    const std::vector<std::size_t> changed = that_change(frequencies);
    if (changed.empty()) return out;
    say("trying other parameters with the same frequencies");
    std::vector<Minimum> starts;
    for (std::uint64_t k = 1; k <= most_far && !stopped(); ++k) {
      std::optional<std::vector<double>> parameters = with_same_frequencies(frequencies, changed, k);
      if (!parameters || !differ(*parameters, best_.parameters)) continue;
      starts.push_back(with_nuisances(best_, std::move(*parameters), frequencies));
    }
    std::sort(starts.begin(), starts.end());
    std::vector<std::vector<double>> tried;
    for (Minimum& start : starts) {
      if (stopped() || out.size() >= most_twins || !(start.cost < INFINITY)) break;
      const auto same = [&](const std::vector<double>& one) { return !differ(one, start.point.parameters); };
      if (std::any_of(tried.begin(), tried.end(), same)) continue;
      tried.push_back(start.point.parameters);
      ++out_.tries;
      start.cost = minimise(start.point, 1.0);
      if (start.cost < INFINITY) out.push_back(std::move(start));
    }
    return out;
  }

  /// Fits from other dimensions with which the mechanism moves alike. True where one of these minima is better.
  bool attempt_twins() {
    if (!is_to_be_questioned()) return false;
    if (!other_states_) other_states_ = with_other_states();
    twins_ = *other_states_;
    const std::size_t known = twins_.size();
    for (FitPoint& point : twins(problem_, out_)) {
      if (stopped() || twins_.size() >= known + most_twins) break;
      say("trying other dimensions with which it moves alike");
      ++out_.tries;
      const double cost = minimise(point, 1.0);
      if (cost < INFINITY) twins_.push_back({cost, std::move(point)});
    }
    if (twins_.empty()) return false;
    const Minimum& least = *std::min_element(twins_.begin(), twins_.end());
    if (!(more_than_best(least.cost) < -1)) return false;
    Minimum before{best_cost_, std::move(best_)};
    best_cost_ = least.cost;
    best_ = least.point;
    twins_.push_back(before);
    other_states_->push_back(std::move(before));
    return true;
  }

  /// Those of the minima found by attempt_twins() that are as good as the best one, and other than its intervals say.
  void compare_twins() {
    std::vector<double> own;
    for (const Estimate& estimate : out_.estimates) own.push_back(estimate.value);
    std::vector<Alternative> others;
    for (const Minimum& twin : twins_) {
      const double more = more_than_best(twin.cost);
      if (!(std::abs(more) < equally_good)) continue;
      Alternative other = alternative(twin.point.parameters, Frequencies(problem_, twin.point), more);
      const auto same = [&](const Alternative& one) { return !differ(one.values, other.values); };
      if (!differ(own, other.values) || std::any_of(others.begin(), others.end(), same)) continue;
      others.push_back(std::move(other));
    }
    if (others.empty()) return;
    out_.alternatives = {alternative(best_.parameters, Frequencies(problem_, best_), 0.0)};
    out_.alternatives.insert(out_.alternatives.end(), others.begin(), others.end());
    out_.status = FitStatus::ambiguous;
    std::vector<std::string> names;
    for (std::size_t i = 0; i < out_.estimates.size(); ++i) {
      Estimate& estimate = out_.estimates[i];
      const bool agrees = estimate.withheld || std::all_of(others.begin(), others.end(), [&](const Alternative& one) {
                            return std::abs(one.values[i] - estimate.value) <= agrees_within * estimate.standard_error;
                          });
      if (agrees) continue;
      estimate.withheld = true;
      estimate.why = "several minima";
      names.push_back(estimate.name);
    }
    out_.why = fmt::format(
        "{} minima explain the readings equally well, with different values of {}; narrow min and max of the unknowns",
        out_.alternatives.size(), fmt::join(names, ", "));
  }

  /// Whether shown values differ by more than the intervals say.
  bool differ(const std::vector<double>& a, const std::vector<double>& b) const {
    for (std::size_t i = 0; i < a.size(); ++i) {
      const Estimate& estimate = out_.estimates[i];
      if (estimate.withheld) continue;
      const double reach = std::max(estimate.value - estimate.low, estimate.high - estimate.value);
      if (std::abs(a[i] - b[i]) > reach) return true;
    }
    return false;
  }

  /// Intervals where the cost is no parabola. True where a lower cost was found instead.
  bool correct_for_curvature() {
    if (!is_to_be_questioned()) return false;
    Curvature found = find_curvature(problem_, records_, out_, linear_, options_);
    out_.check_evaluations += found.evaluations;
    if (found.better) {
      best_.parameters = found.better->parameters;
      for (std::size_t r = 0; r < problem_.runs(); ++r) best_.nuisances[r] = found.better->runs[r].nuisances;
      FitPoint point = best_;
      const double cost = minimise(point, 1.0);
      best_cost_ = std::min(cost, found.better->cost);
      if (cost <= found.better->cost) best_ = std::move(point);
      return true;
    }
    out_.traces = found.traces;
    for (std::size_t i = 0; i < out_.estimates.size(); ++i) {
      if (std::isnan(found.low[i])) continue;
      const double includes = problem_.unknown_of(i).includes;
      widen(i, found.low[i] + includes, found.high[i] + includes);
      if (found.open[i] == 0 || out_.estimates[i].withheld) continue;
      withhold(i, fmt::format("not identifiable from these data: the cost grows {:.2g} times slower than the parabola "
                              "at its minimum",
                              found.open[i]));
    }
    return false;
  }

  void widen(std::size_t i, double low, double high) {
    Estimate& estimate = out_.estimates[i];
    const double reach = out_.errors.reach[i];
    const double longer = std::max({reach, estimate.value - low, high - estimate.value});
    estimate.low = std::min(estimate.low, low);
    estimate.high = std::max(estimate.high, high);
    if (longer <= (1 + nearly_straight) * reach) return;
    estimate.is_curved = true;
    estimate.standard_error = out_.errors.error[i] * longer / reach;
    const FitProblem::Scale scale = problem_.scale_of(i, estimate.value);
    const bool large = scale.size > 0 && estimate.standard_error > scale.size / identifiable_from;
    estimate.poorly_determined = large;
    if (large && scale.is_own_size && !estimate.withheld) withhold(i, "not identifiable from these data");
  }

  void withhold(std::size_t i, const std::string& why) {
    out_.estimates[i].withheld = true;
    out_.estimates[i].why = why;
    out_.identifiability.identifiable[i] = false;
  }

  void describe() {
    out_.parameters = best_.parameters;
    out_.cost = best_cost_;
    linearize();
    double squares_over_noise = 0.0;
    const std::size_t sensors = problem_.experiment().sensors.size();
    std::vector<double> squares(sensors, 0.0);
    std::vector<std::size_t> readings(sensors, 0);
    for (std::size_t r = 0; r < problem_.runs(); ++r) {
      const Residuals e = residuals_of(linear_[r]);
      out_.runs.push_back(evaluate_run(r, e, squares));
      for (std::size_t k = 0; k < e.size(); ++k) {
        readings[k] += e[k].size();
        for (const double x : e[k]) squares_over_noise += x * x;
      }
    }
    out_.residual_over_noise = std::sqrt(squares_over_noise / out_.degrees_of_freedom);
    out_.residual_over_noise_sigma = size_error(readings);
    for (std::size_t k = 0; k < sensors; ++k) {
      out_.rms.push_back(std::sqrt(squares[k] / static_cast<double>(readings[k])));
    }
    if (out_.status == FitStatus::not_run) judge();
    out_.outliers = outliers(problem_, linear_, out_.weighting);
    for (std::size_t i = 0; i < problem_.parameters().size(); ++i) {
      const Parameter& p = problem_.parameters()[i];
      const Unknown& unknown = problem_.unknown_of(i);
      Estimate estimate;
      estimate.name = p.name;
      estimate.unit = unknown.unit;
      estimate.value = best_.parameters[i] + unknown.includes;
      estimate.truth = p.truth + unknown.includes;
      if (out_.identifiability.ok) {
        const bool known = std::isfinite(out_.identifiability.standard_error[i]);
        estimate.standard_error = known ? out_.errors.error[i] : INFINITY;
        const double reach = known ? out_.errors.reach[i] : INFINITY;
        estimate.low = estimate.value - reach;
        estimate.high = estimate.value + reach;
        if (!out_.identifiability.identifiable[i]) estimate.why = "not identifiable from these data";
        const double scale = problem_.scale_of(i, estimate.value).size;
        estimate.poorly_determined = scale > 0 && estimate.standard_error > scale / identifiable_from;
      }
      const double near = 1e-9 * p.scale;
      // Along a null the fit may stop anywhere.
      const bool free = out_.identifiability.ok && std::isinf(estimate.standard_error);
      if (!free && (best_.parameters[i] <= p.min + near || best_.parameters[i] >= p.max - near)) {
        estimate.at_bound = true;
        estimate.why = fmt::format("at the bound {:.6g}", estimate.value / estimate.unit);
      }
      if (out_.status == FitStatus::ambiguous) estimate.why = "several minima";
      estimate.withheld = !estimate.why.empty();
      out_.estimates.push_back(std::move(estimate));
    }
    if (out_.identifiability.ok) lead_with_residuals();
  }

  /// "the readings do not distinguish frequencies of 4.6 Hz and 5.4 Hz; ..."
  std::string ambiguity() const {
    std::vector<std::string> frequencies;
    for (const Alternative& one : out_.alternatives) {
      std::string text;
      for (const double f : one.frequency) text += fmt::format("{}{:.4g}", text.empty() ? "" : " with ", f);
      frequencies.push_back(text + " Hz");
    }
    const std::string last = frequencies.back();
    frequencies.pop_back();
    return fmt::format(
        "{} minima explain the readings equally well, with frequencies of {} and {}; read faster or at uneven times, "
        "or narrow min and max of the unknowns",
        out_.alternatives.size(), fmt::join(frequencies, ", "), last);
  }

  static Residuals residuals_of(const LinearRun& run) {
    Residuals e;
    for (std::size_t k = 0; k + 1 < run.first.size(); ++k) {
      const auto own = run.residuals(k);
      e.emplace_back(own.begin(), own.end());
    }
    return e;
  }

  void judge() {
    if (!out_.alternatives.empty()) {
      out_.status = FitStatus::ambiguous;
      out_.why = ambiguity();
      return;
    }
    compare_with_noise();
    if (aliased_ && out_.status == FitStatus::misfit && out_.residual_over_noise > suspicious_ratio) {
      out_.status = FitStatus::failed;
      out_.why = fmt::format(
          "the residuals are {:.3g} times the stated noise, and the readings allow other frequencies, none of which "
          "explains them better; read faster, or start closer to the parameters",
          out_.residual_over_noise);
    }
  }

  /// By how much the root mean square of all residuals over their noise scatters.
  double size_error(const std::vector<std::size_t>& readings) const {
    if (out_.errors.sensors.empty()) return std::sqrt(0.5 / out_.degrees_of_freedom);
    double variance = 0.0;
    double all = 0.0;
    for (std::size_t k = 0; k < readings.size(); ++k) {
      const double degrees = out_.errors.sensors[k].degrees;
      const auto count = static_cast<double>(readings[k]);
      if (degrees > 0) variance += count * count / (2 * degrees);
      all += count;
    }
    return std::sqrt(variance) / all;
  }

  /// Converged if the residuals of every stated noise, in total and in every run, are as large as it says.
  void compare_with_noise() {
    out_.status = FitStatus::converged;
    const std::vector<Sensor>& sensors = problem_.experiment().sensors;
    struct Tested {
      std::string of;
      NoiseTest test;
    };
    std::vector<Tested> totals, parts;
    for (std::size_t k = 0; k < sensors.size() && k < out_.errors.sensors.size(); ++k) {
      if (estimates_noise(k)) continue;
      totals.push_back({sensors.size() > 1 ? " of " + sensors[k].name : "", out_.errors.sensors[k]});
      for (std::size_t r = 0; problem_.runs() > 1 && r < problem_.runs(); ++r) {
        const NoiseTest& test = out_.errors.runs_noise[r][k];
        if (std::isnan(test.ratio)) continue;
        parts.push_back({fmt::format(" of {} in run \"{}\"", sensors[k].name, problem_.run(r).run().name), test});
      }
    }
    const double least = chance_level / static_cast<double>(totals.size() + parts.size());
    std::string sizes;
    bool larger = false;
    bool smaller = false;
    const auto compare = [&](const std::vector<Tested>& all) {
      for (const Tested& one : all) {
        if (one.test.chance() >= least) continue;
        (one.test.ratio > 1 ? larger : smaller) = true;
        sizes += fmt::format("{}{:.3g} times the stated noise{}, expected 1 ± {:.2g} (95 %)", sizes.empty() ? "" : "; ",
                             one.test.ratio, one.of, one.test.reach());
      }
    };
    compare(totals);
    if (sizes.empty()) compare(parts);
    if (sizes.empty()) return;
    out_.status = FitStatus::misfit;
    out_.why = "the residuals are " + sizes + ": ";
    if (larger) {
      const std::vector<std::string> inputs = measured_inputs(problem_.experiment());
      out_.why += fmt::format(
          "the model is incomplete, {}; standard errors are multiplied by that factor",
          inputs.empty()
              ? "or the noise is larger than stated"
              : fmt::format("the noise is larger than stated, or inputs that count as exact have errors ({})",
                            fmt::join(inputs, ", ")));
      if (out_.residual_over_noise > doubtful_from) {
        out_.why += fmt::format("; or a better minimum exists, {} tried",
                                out_.tries == 1 ? "1 start was" : fmt::format("{} starts were", out_.tries));
      }
    } else {
      out_.why +=
          "the noise is smaller than stated, or the readings have been smoothed; standard errors are those of "
          "the stated noise";
    }
  }

  RunFit evaluate_run(std::size_t r, const Residuals& e, std::vector<double>& squares) const {
    RunFit out;
    out.name = problem_.run(r).run().name;
    out.nuisances = best_.nuisances[r];
    // Of all that are compared, of runs and sensors, one exceeds it by chance.
    const double remarkable = boost::math::quantile(
        complement(boost::math::normal(), chance_level / static_cast<double>(2 * problem_.runs() * e.size())));
    for (std::size_t k = 0; k < e.size(); ++k) {
      const auto samples = static_cast<double>(e[k].size());
      double square = 0.0;
      for (const double x : e[k]) square += x * x;
      const double noise = out_.weighting.noise[k];
      squares[k] += square * noise * noise;
      out.rms.push_back(e[k].empty() ? not_a_number : noise * std::sqrt(square / samples));
      const Autocorrelation lagged = autocorrelation(records_[r].sensors[k].time, e[k]);
      out.autocorrelation.push_back(lagged.value);
      out.correlated.push_back(std::abs(lagged.value) * std::sqrt(1.0 + lagged.pairs) > remarkable);
      out.mean.push_back(-noise * std::accumulate(e[k].begin(), e[k].end(), 0.0) / samples);
      out.shifted.push_back(!out_.errors.runs_noise.empty() &&
                            std::abs(out_.errors.runs_noise[r][k].offset) > remarkable);
    }
    return out;
  }

  const FitProblem& problem_;
  const std::vector<Record>& records_;
  const FitOptions& options_;
  Fit out_;
  std::vector<Record> cleaned_;
  FitPoint best_;
  std::vector<Minimum> twins_;
  // Once tried; also minima that were the best ones.
  std::optional<std::vector<Minimum>> other_states_;
  std::vector<LinearRun> linear_;  // at the best point
  // Runs linearized by the last minimise(), at the point that it found.
  std::vector<std::optional<LinearRun>> computed_;
  FitPoint computed_at_;
  double best_cost_ = INFINITY, last_cost_ = INFINITY;
  bool aliased_ = false;  // the times of the readings allow other frequencies than those found
  double signal_ = 0.0;   // sum of squared readings about their means, over noise
  std::string failure_;
};

}  // namespace

std::string to_string(FitStatus status) {
  switch (status) {
    case FitStatus::not_run:
      return "not run";
    case FitStatus::converged:
      return "converged";
    case FitStatus::misfit:
      return "misfit";
    case FitStatus::ambiguous:
      return "ambiguous";
    case FitStatus::failed:
      return "failed";
    case FitStatus::interrupted:
      return "interrupted";
  }
  return "";
}

Fit fit(const FitProblem& problem, const std::vector<Record>& records, const FitOptions& options) {
  return Fitting(problem, records, options).run();
}

void quiet_ceres() { FLAGS_minloglevel = google::GLOG_FATAL; }

}  // namespace poise
