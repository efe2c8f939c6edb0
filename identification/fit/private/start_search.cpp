#include "identification/fit/private/start_search.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "identification/fit/first_readings.hpp"
#include "identification/fit/oscillation_start.hpp"
#include "identification/fit/private/alternatives.hpp"
#include "identification/fit/private/following_nuisances.hpp"
#include "identification/fit/regression_start.hpp"
#include "solvers/random_stream.hpp"

namespace poise {
namespace {

/// A local minimum leaves at least this part of the readings' variation in the residuals.
constexpr double lost_from = 0.1;
/// Ratio of the frequencies of successive starts that are tried where a minimum is local.
constexpr double next_frequency = 1.15;
constexpr int most_octaves = 2;
/// So many of these, and of those at aliases, are fitted to the whole records: the best ones of a shorter fit.
constexpr std::size_t most_scaled = 3, most_aliases = 8;
/// The part of the records of that shorter fit.
constexpr double shorter = 0.05;
/// As many equally good minima are sought.
constexpr std::size_t enough_alternatives = 3;

/// Returns the sum of squared readings about their means, over the noise.
double signal_of(const std::vector<Record>& records, const Weighting& weighting) {
  double out = 0.0;
  for (const Record& record : records) {
    for (std::size_t k = 0; k < record.sensors.size(); ++k) {
      const std::vector<double>& values = record.sensors[k].value;
      if (values.empty()) continue;
      const Eigen::Map<const Eigen::ArrayXd> reading(values.data(), static_cast<Eigen::Index>(values.size()));
      const double noise = weighting.noise[k];
      out += (reading - reading.mean()).square().sum() / (noise * noise);
    }
  }
  return out;
}

class StartSearch {
 public:
  StartSearch(const FitTask& task, const Weighting& weighting, FitEffort& effort)
      : task_(task), weighting_(weighting), effort_(effort) {}

  /// Searches from damped sines or the experiment's starts, and from others where what is found is not convincing.
  FoundMinimum run() {
    signal_ = signal_of(task_.records, weighting_);
    if (weighting_.loss != Loss::squares) {
      for (const Record& record : task_.records) cleaned_.push_back(without_outliers(record));
    }
    bool uses_starts = !attempt_continued() && !attempt_oscillations();
    if (uses_starts) {
      out_.start =
          task_.problem.all_at_rest() ? "as given" : "as given, fitted over windows that grow to the whole records";
      attempt(given(0), {0.1, 0.35, 1.0});
    }
    if (!task_.stopped() && is_suspicious()) attempt_regression();
    uses_starts = attempt_changed_starts() || uses_starts;
    if (!task_.stopped() && out_.best.is_reached()) attempt_aliases();
    if (!task_.stopped() && is_suspicious()) {
      uses_starts = true;
      attempt_scaled_frequencies();
      if (!is_suspicious()) attempt_aliases();
    }
    if (!uses_starts && any_release_is_a_guess()) out_.start += "; the release of measured runs was not used";
    if (task_.stopped()) {
      out_.status = FitStatus::interrupted;
      out_.why = out_.best.is_reached() ? "interrupted; the values reached so far are shown"
                                        : "interrupted before the first step; the values shown are those of the start";
      if (!out_.best.is_reached()) out_.best.point = {given(0).parameters, {}};
    } else if (!out_.best.is_reached()) {
      out_.status = FitStatus::failed;
      out_.why = failure_.empty() ? "no minimum was reached from any start" : failure_;
    }
    return std::move(out_);
  }

  /// Descends from the values of another fit.
  FoundMinimum go_on() {
    const FitOptions& options = task_.options;
    out_.start = "from another fit";
    FitPoint point{options.from->parameters, {}};
    for (const RunFit& run : options.from->runs) point.nuisances.push_back(run.nuisances);
    for (const auto& [p, value] : options.held) point.parameters[static_cast<std::size_t>(p)] = value;
    if (options.holds_starts || task_.sought == 0) {
      const double cost = cost_of(point);
      if (!std::isfinite(cost)) failure_ = task_.problem.why_no_motion(point.parameters, point.nuisances);
      out_.best = {.cost = cost, .point = std::move(point)};
    } else if (options.held.size() == task_.problem.parameters().size() && !options.values_only) {
      attempt(std::move(point), {0.1, 0.35, 1.0});  // other records: the starts are guesses
    } else {
      attempt(std::move(point), {1.0});
    }
    if (task_.stopped() || !out_.best.is_reached()) {
      out_.status = task_.stopped() ? FitStatus::interrupted : FitStatus::failed;
      out_.why = task_.stopped() ? "interrupted" : failure_;
    }
    return std::move(out_);
  }

 private:
  // --- what is found so far -----------------------------------------------------------------------------------------

  /// In a local minimum the model is out of phase with the records: a large part of the variation is left.
  bool is_suspicious() const {
    const double cost = out_.best.cost;
    return task_.residual_over_noise(cost) > suspicious_from && 2 * cost > lost_from * lost_from * signal_;
  }

  bool is_doubtful() const { return task_.residual_over_noise(out_.best.cost) > doubtful_from; }

  /// Says whether a run states a release that is neither the truth of a simulation nor a known start.
  bool any_release_is_a_guess() const {
    const std::vector<Run>& runs = task_.problem.experiment().runs;
    return std::any_of(runs.begin(), runs.end(),
                       [](const Run& run) { return !run.is_simulated() && run.unknown_start && !run.release.empty(); });
  }

  void keep(Minimum found) {
    if (found.cost < out_.best.cost) out_.best = std::move(found);
  }

  // --- one start ----------------------------------------------------------------------------------------------------

  Minimum descend(const FitPoint& start, double window) {
    Minimum out = minimise(task_, weighting_, start, window, effort_);
    if (!out.is_reached()) failure_ = out.why_not;
    return out;
  }

  /// Fits windows that grow, and keeps what is better than what was found before. Returns the cost over the whole
  /// records.
  double attempt(FitPoint start, std::vector<double> windows) {
    ++effort_.tries;
    if (task_.problem.all_at_rest()) windows = {1.0};  // their rows are no course in time
    Minimum reached{.point = std::move(start)};
    bool moved = false;
    for (const double window : windows) {
      if (task_.stopped()) break;
      if (windows.size() > 1) task_.say(fmt::format("fitting the first {:.0f} % of every record", 100 * window));
      // A window that fails is skipped: a longer one may still succeed.
      reached = descend(reached.point, window);
      moved = moved || reached.is_reached();
      if (window < 1.0) reached.cost = INFINITY;
    }
    // Interrupted in a window, or within the first step of the next one: what the whole records say of that point.
    if (task_.stopped() && moved && !out_.best.is_reached()) reached.cost = cost_of(reached.point);
    const double cost = reached.cost;
    keep(std::move(reached));
    return cost;
  }

  /// Returns the cost over the whole records, infinite where a motion fails.
  double cost_of(const FitPoint& point) const {
    return task_.problem.cost(point.parameters, point.nuisances, task_.records, weighting_, task_.options.jobs);
  }

  // --- starts -------------------------------------------------------------------------------------------------------

  /// Records for first guesses, which are least squares, or follow from few readings.
  const std::vector<Record>& for_guesses() const { return cleaned_.empty() ? task_.records : cleaned_; }

  /// Goes on from another fit; false where there is none, or nothing is reached from it.
  bool attempt_continued() {
    if (task_.options.continued == nullptr) return false;
    out_.start = "from what an earlier fit had reached";
    attempt(given(0), {1.0});
    return out_.best.is_reached();
  }

  /// Starts from damped sines; false where the experiment's starts are wanted, or the records are no such oscillations.
  bool attempt_oscillations() {
    if (task_.options.use_starts) return false;
    task_.say("fitting a damped sine to every record");
    const std::optional<OscillationStart> oscillations = start_from_oscillations(task_.problem, for_guesses());
    if (!oscillations) return false;
    out_.start = "from damped sines fitted to the records and linear least squares, no guess needed";
    attempt({oscillations->parameters, oscillations->nuisances}, {1.0});
    return true;
  }

  /// Returns the first guess of a run's nuisances with these parameters.
  std::vector<double> guess(std::size_t r, const std::vector<double>& parameters) const {
    return first_guess(task_.problem.run(r), task_.problem.unknowns_of(r, parameters), for_guesses()[r]);
  }

  /// Starts from the numbers with which the equations of motion have the accelerations of the readings.
  void attempt_regression() {
    task_.say("fitting the equations of motion to smoothed readings");
    const std::optional<std::vector<double>> parameters = start_from_regression(task_.problem, for_guesses());
    if (!parameters) return;
    FitPoint point{*parameters, {}};
    for (std::size_t r = 0; r < task_.problem.runs(); ++r) point.nuisances.push_back(guess(r, *parameters));
    const double before = out_.best.cost;
    if (attempt(std::move(point), {0.03, 0.08, 0.2, 0.45, 1.0}) < before) {
      out_.start = "from the equations of motion fitted to smoothed readings, no guess needed";
    }
  }

  /// Returns the experiment's starts, or what the fit had reached that this one goes on from; from the first retry on
  /// changed at random by up to 30 %.
  FitPoint given(int retry) const {
    const FitProblem& problem = task_.problem;
    const Fit* const before = task_.options.continued;
    FitPoint point;
    point.parameters = before != nullptr              ? before->parameters
                       : task_.options.starts.empty() ? problem.starts()
                                                      : task_.options.starts;
    solvers::RandomStream random(static_cast<std::uint64_t>(retry));
    for (std::size_t i = 0; retry > 0 && i < point.parameters.size(); ++i) {
      const Parameter& p = problem.parameters()[i];
      point.parameters[i] = std::clamp(point.parameters[i] + p.scale * random.uniform(-0.3, 0.3), p.min, p.max);
    }
    for (std::size_t r = 0; r < problem.runs(); ++r) {
      const bool known = before != nullptr && retry == 0 && r < before->runs.size();
      point.nuisances.push_back(known ? before->runs[r].nuisances : guess(r, point.parameters));
    }
    return point;
  }

  /// Starts from starts that are changed at random; false where there was no need to.
  bool attempt_changed_starts() {
    const int retries = task_.options.retries;
    bool any = false;
    for (int retry = 1; retry <= retries && !task_.stopped() && (is_suspicious() || is_doubtful()); ++retry) {
      const double before = out_.best.cost;
      task_.say(fmt::format("residuals are {:.3g} times the noise: trying another start, {} of {}",
                            task_.residual_over_noise(before), retry, retries));
      any = true;
      const double cost = attempt(given(retry), {0.03, 0.08, 0.2, 0.45, 1.0});
      // Another start that leads to the same minimum shows that the model is incomplete.
      if (std::abs(out_.best.cost - before) < 1e-3 * before && cost < 1.001 * before) break;
    }
    return any;
  }

  /// A start with a wrong frequency ends in a local minimum, so all frequencies of the experiment's starts are scaled:
  /// these are fitted over short windows, then the best of them over the whole records.
  void attempt_scaled_frequencies() {
    task_.say("residuals exceed the noise: trying starts with other frequencies");
    const FitPoint start = given(0);
    const Frequencies frequencies(task_.problem, start);
    if (frequencies.modes().empty()) return;
    std::vector<Minimum> starts;
    const int most = static_cast<int>(most_octaves * std::log(2.0) / std::log(next_frequency));
    for (int k = -most; k <= most && !task_.stopped(); ++k) {
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
      ++effort_.tries;
      Minimum found = descend(point, shorter);
      if (found.is_reached()) starts.push_back(std::move(found));
    }
    std::sort(starts.begin(), starts.end());
    for (std::size_t i = 0; i < std::min(most_scaled, starts.size()) && !task_.stopped() && is_suspicious(); ++i) {
      attempt(std::move(starts[i].point), {0.1, 0.2, 0.45, 1.0});
    }
  }

  // --- other frequencies that the readings allow --------------------------------------------------------------------

  /// Fits from parameters with the frequencies that the readings may be mistaken for, and compares the minima.
  void attempt_aliases() {
    const FitPoint start = given(0);
    std::vector<Minimum> minima = {{.cost = out_.best.cost, .point = out_.best.point}};
    // What is found may have aliases that the first minimum had not.
    for (int round = 0; round < 2 && !task_.stopped(); ++round) {
      const FitPoint from = out_.best.point;
      const Frequencies frequencies(task_.problem, from);
      out_.is_aliased = frequencies.have_aliases(start.parameters);
      if (!out_.is_aliased && !is_suspicious()) break;
      const std::vector<Minimum> starts = starts_at_aliases(from, start, frequencies);
      if (task_.stopped()) return;
      const std::size_t before = minima.size();
      for (std::size_t i = 0; i < std::min(most_aliases, starts.size()) && !task_.stopped(); ++i) {
        if (!starts[i].is_reached()) break;
        ++effort_.tries;
        Minimum found = descend(starts[i].point, 1.0);
        if (found.is_reached()) minima.push_back({.cost = found.cost, .point = found.point});
        keep(std::move(found));
        out_.alternatives = alternatives_among(task_, minima, out_.best.cost);
        if (out_.alternatives.size() >= enough_alternatives) return;
      }
      if (minima.size() == before || !frequencies.differ(out_.best.point.parameters)) break;
    }
    out_.alternatives = alternatives_among(task_, std::move(minima), out_.best.cost);
  }

  /// Lists parameters with the frequencies that the readings allow, the most likely first.
  std::vector<Minimum> starts_at_aliases(const FitPoint& from, const FitPoint& start, const Frequencies& frequencies) {
    std::vector<Minimum> out;
    for (std::vector<double>& parameters : frequencies.alternatives(start.parameters, task_.records)) {
      if (task_.stopped()) break;
      if (out.empty()) task_.say("trying other frequencies that the readings allow");
      out.push_back(with_following_nuisances(task_, weighting_, from, std::move(parameters), frequencies));
    }
    std::sort(out.begin(), out.end());
    return out;
  }

  const FitTask& task_;
  const Weighting& weighting_;
  FitEffort& effort_;
  std::vector<Record> cleaned_;  // of outliers; empty in least squares
  double signal_ = 0.0;          // signal_of() the records
  std::string failure_;          // of the last descent that failed
  FoundMinimum out_;
};

}  // namespace

FoundMinimum search_minimum(const FitTask& task, const Weighting& weighting, FitEffort& effort) {
  return StartSearch(task, weighting, effort).run();
}

FoundMinimum continue_fit(const FitTask& task, const Weighting& weighting, FitEffort& effort) {
  return StartSearch(task, weighting, effort).go_on();
}

}  // namespace poise
