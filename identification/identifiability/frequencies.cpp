#include "identification/identifiability/frequencies.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "solvers/linear_algebra.hpp"
#include "solvers/not_a_number.hpp"

namespace poise {
namespace {

/// Frequencies are sought from those at the start divided by this to those times this, and half as far about those of
/// the point.
constexpr double reach_of_bins = 4.0;
/// Oscillations are alike at the times of readings where the mean of their relative phase factor is above this.
constexpr double alike_frequencies = 0.5;
/// More readings than these of one record are not compared: fewer leave more candidates, never less.
constexpr std::size_t most_times = 512;
constexpr std::size_t most_assignments = 2000;
/// Of these, so many that explain the readings best are solved for the parameters.
constexpr std::size_t most_solved = 100;
/// Lines of a spectrum count from this part of the strongest one on.
constexpr double least_line = 0.3;

/// |mean of exp(2 pi i f t)|.
double coherence(const std::vector<double>& times, double f) {
  std::complex<double> sum = 0.0;
  for (const double t : times) sum += std::polar(1.0, 2 * std::numbers::pi * f * t);
  return std::abs(sum) / static_cast<double>(times.size());
}

/// Where other frequencies than `found` are sought.
std::pair<double, double> range(double found, double at_start) {
  return {std::min(2 * found, at_start) / reach_of_bins, std::max(found / 2, at_start) * reach_of_bins};
}

/// Adds a frequency unless one is known that a record of that span does not distinguish from it.
void add(std::vector<double>& known, double f, double span) {
  for (const double other : known) {
    if (std::abs(f - other) * span < 0.5) return;
  }
  known.push_back(f);
}

}  // namespace

std::vector<double> aliases(const std::vector<double>& times, double frequency, double low, double high) {
  std::vector<double> used(times.begin(),
                           times.begin() + static_cast<std::ptrdiff_t>(std::min(times.size(), most_times)));
  std::vector<double> out;
  if (used.size() < 3) return out;
  const double span = used.back() - used.front();
  // The mean spacing bounds the first alias of even times; closer readings only raise it.
  double closest = span;
  for (std::size_t i = 1; i < used.size(); ++i) closest = std::min(closest, used[i] - used[i - 1]);
  const double step = 1 / (8 * span);
  for (const double sign : {-1.0, 1.0}) {
    // Differences (or sums) of frequencies below the resolution of the record are the same oscillation.
    const auto apart = [&](double f) { return std::abs(f + sign * frequency); };
    double before = 0.0;
    double here = 0.0;
    const auto steps = static_cast<long>(std::ceil((high - low) / step)) + 2;
    for (long i = -1; i <= steps; ++i) {
      const double f = low + static_cast<double>(i) * step;
      const double next = apart(f) * span < 1 ? 0.0 : coherence(used, f + sign * frequency);
      if (here > alike_frequencies && here >= before && here > next && f - step >= low - step &&
          f - step <= high + step) {
        // The vertex of the parabola through the peak.
        const double bend = before - 2 * here + next;
        const double shift = bend < 0 && before > 0 && next > 0 ? 0.5 * (before - next) / bend : 0.0;
        const double peak = f - step + shift * step;
        if (peak > 0) add(out, peak, span);
      }
      before = here;
      here = next;
    }
  }
  return out;
}

Frequencies::Frequencies(const FitProblem& problem, FitPoint point) : problem_(problem), point_(std::move(point)) {
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    // A driven run moves at the frequencies of its inputs too.
    if (problem.run(r).has_inputs()) {
      swings_.emplace_back();
      continue;
    }
    const double span = problem.run(r).span();
    swings_.push_back(swing_of(r, span));
    const std::vector<double> found = of_run(r, point_.parameters);
    for (std::size_t k = 0; k < found.size(); ++k) {
      if (!(found[k] > 0)) continue;
      const auto same = std::find_if(modes_.begin(), modes_.end(), [&](const Mode& mode) {
        return mode.order == k && problem.parameters_of(mode.runs.front()) == problem.parameters_of(r) &&
               std::abs(mode.frequency - found[k]) < 1e-9 * found[k];
      });
      if (same == modes_.end()) {
        modes_.push_back({{r}, k, found[k], span});
      } else {
        same->runs.push_back(r);
        same->span = std::max(same->span, span);
      }
    }
  }
}

Frequencies::Swing Frequencies::swing_of(std::size_t r, double span) const {
  const RunModel& run = problem_.run(r);
  const std::vector<double>& nuisances = point_.nuisances[r];
  Swing out;
  out.equilibrium = run.equilibrium_is_unknown() ? nuisances[0] : run.equilibrium_at();
  const std::vector<double> unknowns = problem_.unknowns_of(r, point_.parameters);
  const Motion motion = run.move(unknowns.data(), nuisances.data(), span, 1e-4, false);
  if (!motion.completed()) return out;
  const Trajectory& path = motion.trajectory;
  const auto n = static_cast<std::size_t>(path.coordinates);
  for (const int i : run.independent()) {
    double area = 0.0;
    for (std::size_t s = 1; s < path.nodes(); ++s) {
      area += (path.t[s] - path.t[s - 1]) *
              (path.q[s * n + static_cast<std::size_t>(i)] + path.q[(s - 1) * n + static_cast<std::size_t>(i)]) / 2;
    }
    out.pose.push_back(area / (path.t.back() - path.t.front()));
  }
  if (run.freedoms() != 1) return out;
  const auto at = static_cast<std::size_t>(run.independent()[0]);
  std::vector<double> crossings;
  for (std::size_t s = 1; s < path.nodes(); ++s) {
    const double a = path.q[(s - 1) * n + at] - out.pose[0];
    const double b = path.q[s * n + at] - out.pose[0];
    if ((a < 0) != (b < 0)) crossings.push_back(path.t[s - 1] + (path.t[s] - path.t[s - 1]) * a / (a - b));
  }
  const std::vector<double> natural = run.natural_frequencies(unknowns.data(), out.equilibrium, out.pose);
  if (crossings.size() < 4 || natural.empty() || !(natural[0] > 0)) return out;
  // Whole periods, so that both halves of an uneven oscillation count.
  const std::size_t halves = (crossings.size() - 1) / 2 * 2;
  const double moved = static_cast<double>(halves) / 2 / (crossings[halves] - crossings[0]);
  if (moved > natural[0] / 3 && moved < 3 * natural[0]) out.ratio = moved / natural[0];
  return out;
}

std::vector<double> Frequencies::of_run(std::size_t r, const std::vector<double>& parameters) const {
  const Swing& swing = swings_[r];
  const RunModel& run = problem_.run(r);
  if (swing.pose.empty() && !run.has_equilibrium()) return {};
  const std::vector<double> unknowns = problem_.unknowns_of(r, parameters);
  std::vector<double> out = run.natural_frequencies(unknowns.data(), swing.equilibrium, swing.pose);
  for (double& f : out) f *= swing.ratio;
  return out;
}

std::vector<double> Frequencies::at(const std::vector<double>& parameters) const {
  std::vector<double> out;
  std::vector<double> of;
  for (std::size_t i = 0; i < modes_.size(); ++i) {
    const std::size_t r = modes_[i].runs.front();
    if (i == 0 || r != modes_[i - 1].runs.front()) of = of_run(r, parameters);
    if (of.size() <= modes_[i].order || !(of[modes_[i].order] > 0)) return {};
    out.push_back(of[modes_[i].order]);
  }
  return out;
}

// Logarithms where a parameter cannot change its sign.
double Frequencies::coordinate(std::size_t i, double value) const {
  const Parameter& p = problem_.parameters()[i];
  return p.min >= 0 && p.start > 0 ? std::log(std::max(value, 1e-12 * p.scale)) : value / p.scale;
}

double Frequencies::value(std::size_t i, double coordinate) const {
  const Parameter& p = problem_.parameters()[i];
  return std::clamp(p.min >= 0 && p.start > 0 ? std::exp(coordinate) : coordinate * p.scale, p.min, p.max);
}

Eigen::MatrixXd Frequencies::slopes(const std::vector<double>& parameters, const std::vector<double>& here) const {
  constexpr double step = 1e-4;
  Eigen::MatrixXd out =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(modes_.size()), static_cast<Eigen::Index>(parameters.size()));
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    for (const double by : {step, -step}) {  // the other way where the first leaves the range
      std::vector<double> moved = parameters;
      moved[i] = value(i, coordinate(i, parameters[i]) + by);
      if (moved[i] == parameters[i]) continue;
      const std::vector<double> there = at(moved);
      if (there.empty()) continue;
      for (std::size_t k = 0; k < here.size(); ++k) {
        out(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i)) = std::log(there[k] / here[k]) / by;
      }
      break;
    }
  }
  return out;
}

std::optional<std::vector<double>> Frequencies::parameters_with(const std::vector<double>& wanted,
                                                                const std::vector<double>& from) const {
  constexpr double longest = 1.0;  // of a step, in the logarithm of a parameter
  std::vector<double> p = from;
  std::vector<double> best;
  double least = std::numeric_limits<double>::infinity();
  for (int iteration = 0; iteration < 12; ++iteration) {
    const std::vector<double> here = at(p);
    if (here.empty()) break;
    Eigen::VectorXd missing = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(here.size()));
    for (std::size_t k = 0; k < here.size(); ++k) {
      if (!std::isnan(wanted[k])) missing[static_cast<Eigen::Index>(k)] = std::log(wanted[k] / here[k]);
    }
    if (missing.norm() < least) {
      least = missing.norm();
      best = p;
    }
    if (missing.norm() < 1e-4) break;
    Eigen::MatrixXd by = slopes(p, here);
    for (std::size_t k = 0; k < here.size(); ++k) {
      if (std::isnan(wanted[k])) by.row(static_cast<Eigen::Index>(k)).setZero();
    }
    Eigen::VectorXd step = solvers::minimum_norm_solution<double>(by, missing, 1e-6);
    // What would leave its range there stays, and the others move instead.
    bool stays = false;
    for (std::size_t i = 0; i < p.size(); ++i) {
      const auto column = static_cast<Eigen::Index>(i);
      const Parameter& range = problem_.parameters()[i];
      const bool out = (p[i] <= range.min && step[column] < 0) || (p[i] >= range.max && step[column] > 0);
      if (out) by.col(column).setZero();
      stays = stays || out;
    }
    if (stays) step = solvers::minimum_norm_solution<double>(by, missing, 1e-6);
    const double size = step.cwiseAbs().maxCoeff();
    if (!std::isfinite(size) || size < 1e-9) break;
    if (size > longest) step *= longest / size;
    for (std::size_t i = 0; i < p.size(); ++i) {
      p[i] = value(i, coordinate(i, p[i]) + step[static_cast<Eigen::Index>(i)]);
    }
  }
  if (best.empty() || best == from) return std::nullopt;
  return best;
}

// A line spectrum: of every run and sensor the least squares of  1, cos, sin  at one or two frequencies.
double Frequencies::unexplained(std::size_t r, const Record& record, const std::vector<double>& frequencies) const {
  double sum = 0.0;
  for (std::size_t k = 0; k < record.sensors.size(); ++k) {
    if (problem_.experiment().sensors[k].reads_impacts()) continue;
    const std::vector<double>& times = problem_.run(r).times()[k];
    const auto rows = static_cast<Eigen::Index>(std::min(times.size(), most_times));
    const auto columns = static_cast<Eigen::Index>(1 + 2 * frequencies.size());
    if (rows <= columns) continue;
    Eigen::MatrixXd whole(rows, columns + 1);
    for (Eigen::Index i = 0; i < rows; ++i) {
      const double t = times[static_cast<std::size_t>(i)];
      whole(i, 0) = 1.0;
      for (std::size_t m = 0; m < frequencies.size(); ++m) {
        const double phase = 2 * std::numbers::pi * frequencies[m] * t;
        whole(i, 1 + 2 * static_cast<Eigen::Index>(m)) = std::cos(phase);
        whole(i, 2 + 2 * static_cast<Eigen::Index>(m)) = std::sin(phase);
      }
      whole(i, columns) = record.sensors[k].value[static_cast<std::size_t>(i)];
    }
    const double noise = problem_.experiment().sensors[k].noise;
    const double rest = solvers::triangular_factor(whole)(columns, columns);
    sum += rest * rest / (noise * noise);
  }
  return sum;
}

std::vector<double> Frequencies::lines(std::size_t r, const Record& record, double low, double high) const {
  double step = INFINITY;
  for (const std::vector<double>& times : problem_.run(r).times()) {
    if (times.size() < 3) continue;
    step = std::min(step, 1 / (4 * (times[std::min(times.size(), most_times) - 1] - times.front())));
  }
  std::vector<double> out;
  if (!(step < INFINITY)) return out;
  const double all = unexplained(r, record, {});
  std::vector<double> rest;
  const auto steps = static_cast<std::size_t>(std::min(1e5, (high - low) / step)) + 3;
  for (std::size_t i = 0; i < steps; ++i) {
    rest.push_back(unexplained(r, record, {low + step * static_cast<double>(i)}));
  }
  const double least = *std::min_element(rest.begin(), rest.end());
  for (std::size_t i = 1; i + 1 < rest.size(); ++i) {
    if (rest[i] > rest[i - 1] || rest[i] > rest[i + 1] || all - rest[i] < least_line * (all - least)) continue;
    const double bend = rest[i - 1] - 2 * rest[i] + rest[i + 1];
    const double shift = bend > 0 ? 0.5 * (rest[i - 1] - rest[i + 1]) / bend : 0.0;
    out.push_back(low + step * (static_cast<double>(i) + shift));
  }
  return out;
}

std::vector<std::vector<double>> Frequencies::with_aliases(const std::vector<double>& start) const {
  const std::vector<double> at_start = at(start);
  std::vector<std::vector<double>> out;
  for (std::size_t k = 0; k < modes_.size(); ++k) {
    const Mode& mode = modes_[k];
    const auto [low, high] = range(mode.frequency, at_start.empty() ? mode.frequency : at_start[k]);
    std::vector<double>& found = out.emplace_back(1, mode.frequency);
    for (const std::size_t r : mode.runs) {
      for (const std::vector<double>& times : problem_.run(r).times()) {
        for (const double f : aliases(times, mode.frequency, low, high)) add(found, f, mode.span);
      }
    }
  }
  return out;
}

bool Frequencies::have_aliases(const std::vector<double>& start) const {
  const std::vector<std::vector<double>> all = with_aliases(start);
  return std::any_of(all.begin(), all.end(), [](const std::vector<double>& of_mode) { return of_mode.size() > 1; });
}

std::vector<std::vector<double>> Frequencies::alternatives(const std::vector<double>& start,
                                                           const std::vector<Record>& records) const {
  std::vector<std::vector<double>> out;
  const std::vector<double> here = at(point_.parameters);
  if (here.empty()) return out;
  const std::vector<double> at_start = at(start);
  std::vector<std::vector<double>> options = with_aliases(start);
  for (std::size_t k = 0; k < modes_.size(); ++k) {
    const Mode& mode = modes_[k];
    const auto [low, high] = range(mode.frequency, at_start.empty() ? mode.frequency : at_start[k]);
    const std::size_t r = mode.runs.front();
    for (const double f : lines(r, records[r], low, high)) add(options[k], f, mode.span);
  }
  // As many modes as the parameters can move independently are given each of their options; the others follow.
  const Eigen::MatrixXd by = slopes(point_.parameters, here).transpose();
  if (by.isZero(0.0)) return out;
  const solvers::PivotOrder order = solvers::pivot_order<double>(by, 1e-3);
  struct Combination {
    double unexplained = 0.0;
    std::vector<double> wanted;
  };
  std::vector<Combination> combinations;
  std::vector<std::size_t> choice(static_cast<std::size_t>(order.rank), 0);
  const auto next = [&] {
    for (std::size_t i = 0; i < choice.size(); ++i) {
      if (++choice[i] < options[static_cast<std::size_t>(order.columns[static_cast<std::size_t>(i)])].size()) {
        return true;
      }
      choice[i] = 0;
    }
    return false;
  };
  do {
    Combination& one = combinations.emplace_back();
    one.wanted.assign(modes_.size(), not_a_number);
    for (std::size_t i = 0; i < choice.size(); ++i) {
      const auto k = static_cast<std::size_t>(order.columns[i]);
      one.wanted[k] = options[k][choice[i]];
    }
    // The frequencies of a run are ascending.
    for (std::size_t k = 0; k < modes_.size(); ++k) {
      for (std::size_t l = k + 1; l < modes_.size(); ++l) {
        if (modes_[k].runs.front() == modes_[l].runs.front() && one.wanted[k] > one.wanted[l]) {
          std::swap(one.wanted[k], one.wanted[l]);
        }
      }
    }
    for (std::size_t r = 0; r < problem_.runs(); ++r) {
      std::vector<double> lines;
      for (std::size_t k = 0; k < modes_.size(); ++k) {
        if (modes_[k].runs.front() == r && !std::isnan(one.wanted[k])) lines.push_back(one.wanted[k]);
      }
      if (!lines.empty()) one.unexplained += unexplained(r, records[r], lines);
    }
  } while (combinations.size() < most_assignments && next());
  std::stable_sort(combinations.begin(), combinations.end(),
                   [](const Combination& a, const Combination& b) { return a.unexplained < b.unexplained; });
  if (combinations.size() > most_solved) combinations.resize(most_solved);
  for (const Combination& one : combinations) {
    for (const std::vector<double>* from : {&point_.parameters, &start}) {
      std::optional<std::vector<double>> found = parameters_with(one.wanted, *from);
      if (!found) continue;
      // The others must have one of their options, too, as far as the chosen ones determine them.
      const std::vector<double> there = at(*found);
      bool fits = !there.empty();
      for (std::size_t k = 0; fits && k < there.size(); ++k) {
        const auto from_there = [&](double f) { return std::abs(f - there[k]); };
        const double nearest = *std::min_element(options[k].begin(), options[k].end(),
                                                 [&](double a, double b) { return from_there(a) < from_there(b); });
        const bool chosen = !std::isnan(one.wanted[k]);
        fits = from_there(chosen ? one.wanted[k] : nearest) < (chosen ? 1 : 2) / modes_[k].span + 0.03 * there[k];
      }
      const bool is_new = std::none_of(out.begin(), out.end(), [&](const std::vector<double>& known) {
        double apart = 0.0;
        for (std::size_t i = 0; i < known.size(); ++i) {
          apart = std::max(apart, std::abs(coordinate(i, known[i]) - coordinate(i, (*found)[i])));
        }
        return apart < 1e-3;
      });
      if (fits && is_new) out.push_back(std::move(*found));
      if (order.rank == 1) break;  // of several parameters several values may have these frequencies
    }
  }
  return out;
}

bool Frequencies::differ(const std::vector<double>& parameters) const {
  const std::vector<double> there = at(parameters);
  if (there.empty()) return true;
  for (std::size_t k = 0; k < there.size(); ++k) {
    if (std::abs(there[k] - modes_[k].frequency) * modes_[k].span > 0.5) return true;
  }
  return false;
}

}  // namespace poise
