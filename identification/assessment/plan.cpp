#include "identification/assessment/plan.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "identification/assessment/carried_numbers.hpp"
#include "identification/fit/first_readings.hpp"
#include "model/input_error.hpp"
#include "solvers/linear_algebra.hpp"
#include "solvers/nlopt.hpp"
#include "solvers/parallel.hpp"
#include "solvers/random_stream.hpp"
#include "statics/sensitivity/sensitivity.hpp"

namespace poise {
namespace {
namespace fs = std::filesystem;

/// Singular values of A below these, absolute and relative to the largest, count as these in a criterion: it is finite
/// where some parameters are not identifiable yet, and rounding does not decide between candidates.
constexpr double least_singular_value = 1e-2;
constexpr double least_relative = 1e-6;
/// Part of log det M in every criterion: it decides where the smallest eigenvalues of M are equal.
constexpr double part_of_determinant = 1e-6;
/// An exchange must improve a criterion, a logarithm, by this.
constexpr double least_gain = 1e-7;
constexpr int random_starts = 4;
constexpr int evaluations_per_number = 40;
constexpr int most_evaluations = 1500;
constexpr double not_possible = 1e6;  // a criterion worse than all others, finite for NLopt

enum Stream : std::uint32_t { shifts, starts };

/// What a standard error is compared with: the parameter's scale where the experiment gives one, else its value.
std::vector<double> scales_of(const FitProblem& problem) {
  std::vector<double> scales;
  const std::vector<double> truths = problem.truths();
  for (std::size_t i = 0; i < truths.size(); ++i) {
    const Unknown& unknown = problem.unknown_of(i);
    const double shown = std::abs(truths[i] + unknown.includes);
    const double other = problem.scale_of(i).size_or(unknown.unit);
    scales.push_back(unknown.scale ? *unknown.scale : shown > 0 ? shown : other);
  }
  return scales;
}

std::map<std::string, std::size_t> places_of(const FitProblem& problem) {
  std::map<std::string, std::size_t> places;
  for (std::size_t i = 0; i < problem.parameters().size(); ++i) places.emplace(problem.parameters()[i].name, i);
  return places;
}

std::vector<std::vector<double>> nuisances_of(const FitProblem& problem) {
  std::vector<std::vector<double>> out;
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    out.push_back(
        first_guess(problem.run(r), problem.unknowns_of(r, problem.truths()), problem.experiment().records[r]));
  }
  return out;
}

/// The triangle of run r at the scene's values, as assess() computes it.
Eigen::MatrixXd triangle_of(const FitProblem& problem, std::size_t r, const std::vector<double>& nuisances) {
  return problem.triangle(r, problem.truths(), nuisances, nullptr, INFINITY, std::min(1e-8, problem.accuracy(r)),
                          problem.weighting());
}

/// Of A, descending, from the eigenvalues of A^T A.
std::vector<double> singular_values_of(const Eigen::MatrixXd& information) {
  std::vector<double> out;
  for (const double value : solvers::symmetric_eigenvalues<double>(information)) {
    out.push_back(std::sqrt(std::max(0.0, value)));
  }
  std::reverse(out.begin(), out.end());
  return out;
}

/// The value of the range at u in [0, 1], rounded to some thousandths of the range, as a person sets it.
double value_at(const PlanChoice& choice, double u) {
  const double digits = 3 - std::floor(std::log10(choice.max - choice.min));
  const double power = std::pow(10.0, std::abs(digits));
  const double value = choice.min + u * (choice.max - choice.min);
  const double rounded = digits >= 0 ? std::round(value * power) / power : std::round(value / power) * power;
  return std::clamp(rounded, choice.min, choice.max);
}

/// A point for each combination of values that are listed, each with at least `count` / combinations points of the
/// ranges: their corners where these are few, then the additive recurrence  u_i = frac(s + i (1/g, 1/g^2, ...)),
/// g^(d + 1) = g + 1,  which fills the unit cube evenly, stretched so that some points lie on its faces.
std::vector<std::vector<double>> fill(const std::vector<PlanChoice>& choices, int count, solvers::RandomStream random) {
  std::vector<std::size_t> lists, ranges;
  std::size_t combinations = 1;
  for (std::size_t c = 0; c < choices.size(); ++c) {
    (choices[c].is_list() ? lists : ranges).push_back(c);
    if (choices[c].is_list()) combinations *= choices[c].values.size();
  }
  const std::size_t d = ranges.size();
  const std::size_t points = d == 0 ? 1 : std::max<std::size_t>(1, static_cast<std::size_t>(count) / combinations);
  const std::size_t corners = d < 16 && (std::size_t{1} << d) <= points ? std::size_t{1} << d : 0;
  double g = 1.5;
  for (int i = 0; i < 60; ++i) g = std::pow(1 + g, 1.0 / static_cast<double>(d + 1));
  std::vector<double> shift(d);
  for (double& s : shift) s = random.uniform();
  std::vector<std::vector<double>> out;
  for (std::size_t combination = 0; combination < combinations; ++combination) {
    for (std::size_t i = 0; i < points; ++i) {
      std::vector<double>& point = out.emplace_back(choices.size());
      std::size_t left = combination;
      for (const std::size_t c : lists) {
        point[c] = choices[c].values[left % choices[c].values.size()];
        left /= choices[c].values.size();
      }
      for (std::size_t k = 0; k < d; ++k) {
        double u = static_cast<double>((i >> k) & 1U);
        if (i >= corners) {
          const double along = shift[k] + static_cast<double>(i) * std::pow(g, -static_cast<double>(k + 1));
          u = std::clamp(1.2 * (along - std::floor(along)) - 0.1, 0.0, 1.0);
        }
        point[ranges[k]] = value_at(choices[ranges[k]], u);
      }
    }
  }
  return out;
}

class Planner {
 public:
  Planner(const FitProblem& own, const ExperimentText& text, const PlanOptions& options)
      : own_(own),
        text_(text),
        options_(options),
        limits_(own.experiment().plan.value()),
        scales_(scales_of(own)),
        places_(places_of(own)),
        folder_(fs::path(own.experiment().file).parent_path()) {
    const auto count = static_cast<Eigen::Index>(scales_.size());
    made_ = Eigen::MatrixXd::Zero(count, count);
    for (std::size_t i = 0; i < scales_.size(); ++i) {
      const auto at = static_cast<Eigen::Index>(i);
      if (own.unknown_of(i).prior) made_(at, at) = std::pow(scales_[i] / own.unknown_of(i).prior_deviation, 2);
    }
  }

  Plan plan() {
    out_.templates = static_cast<int>(text_.templates().size());
    tell("computing the runs of the experiment");
    assess_own();
    if (!out_.why.empty()) return std::move(out_);
    Design best;
    const std::vector<std::vector<double>> all_common = fill_common();
    for (std::size_t i = 0; i < all_common.size() && !interrupted(); ++i) {
      const std::string place =
          all_common.size() == 1 ? "" : fmt::format("common values {} of {}: ", i + 1, all_common.size());
      Design design = choose(candidates(all_common[i]), place);
      if (!design.runs.empty() && (best.runs.empty() || design.score < best.score - least_gain))
        best = std::move(design);
    }
    out_.candidates = cache_.size();
    out_.skipped = static_cast<std::size_t>(
        std::count_if(cache_.begin(), cache_.end(), [](const auto& known) { return known.second.size() == 0; }));
    if (best.runs.empty()) {
      out_.interrupted = interrupted();
      out_.why = out_.interrupted               ? "interrupted before the first candidate had been computed"
                 : out_.skipped_because.empty() ? "no run is as short as the time that is left"
                                                : "no run within the limits can be made: " + out_.skipped_because;
      return std::move(out_);
    }
    if (!interrupted()) refine(best);
    out_.runs = in_order(best.runs);
    out_.interrupted = interrupted();
    tell("computing the standard errors of the plan");
    assess_steps();
    return std::move(out_);
  }

 private:
  struct Design {
    std::vector<PlannedRun> runs;
    double score = 0.0;
  };
  struct Candidate {
    PlannedRun run;
    double duration;
    const Eigen::MatrixXd* information;
  };

  bool interrupted() const { return options_.interrupt != nullptr && options_.interrupt->load(); }
  void tell(const std::string& what) const {
    if (options_.progress) options_.progress(what);
  }

  /// To be made small: log c^T M^-1 c of a prediction; else -log det M, log trace M^-1 or -log of the least eigenvalue.
  double score(const Eigen::MatrixXd& information) const {
    if (options_.prediction) return score_of_prediction(information);
    const Eigen::VectorXd found = solvers::symmetric_eigenvalues<double>(information);
    const double floor =
        std::pow(std::max(least_singular_value, least_relative * std::sqrt(std::max(0.0, found.maxCoeff()))), 2);
    const Eigen::ArrayXd values = found.array().max(floor);
    const double determinant = -values.log().sum();
    switch (limits_.criterion) {
      case PlanCriterion::determinant:
        return determinant;
      case PlanCriterion::trace:
        return std::log(values.inverse().sum()) + part_of_determinant * determinant;
      case PlanCriterion::largest:
        return -std::log(values.minCoeff()) + part_of_determinant * determinant;
    }
    throw std::logic_error("an unknown criterion");
  }

  double score_of_prediction(const Eigen::MatrixXd& information) const {
    const solvers::SymmetricEigen found = solvers::symmetric_eigen(information);
    const double most = std::sqrt(std::max(0.0, found.values.maxCoeff()));
    const double floor = std::pow(std::max(least_singular_value, least_relative * most), 2);
    const Eigen::ArrayXd values = found.values.array().max(floor);
    const Eigen::VectorXd scales =
        Eigen::Map<const Eigen::VectorXd>(scales_.data(), static_cast<Eigen::Index>(scales_.size()));
    const Eigen::ArrayXd parts = found.vectors.transpose() * scales.cwiseProduct(options_.prediction->by);
    return std::log((parts.square() / values).sum()) - part_of_determinant * values.log().sum();
  }

  /// A_r^T A_r of run r of a problem, for the parameters of own_.
  Eigen::MatrixXd information(const FitProblem& problem, std::size_t r, const Eigen::MatrixXd& triangle) const {
    if (triangle.size() == 0) return {};
    const Eigen::Index nuisances = problem.run(r).nuisances();
    const Eigen::Index unknowns = problem.run(r).unknowns();
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(unknowns, made_.cols());
    for (Eigen::Index c = 0; c < unknowns; ++c) {
      const int p = problem.parameters_of(r)[static_cast<std::size_t>(c)];
      const std::size_t at = places_.at(problem.parameters()[static_cast<std::size_t>(p)].name);
      A.col(static_cast<Eigen::Index>(at)) = scales_[at] * triangle.block(nuisances, nuisances + c, unknowns, 1);
    }
    return A.transpose() * A;
  }

  /// Information of a run that may be made; empty where it cannot be.
  Eigen::MatrixXd compute(const PlannedRun& run, std::string& why) const {
    try {
      const Experiment experiment = parse_experiment(text_.with({run}, false, folder_), own_.experiment().file);
      const FitProblem problem(experiment);
      Eigen::MatrixXd out = information(problem, 0, triangle_of(problem, 0, nuisances_of(problem).front()));
      if (out.size() > 0) return out;
      why = problem.why_no_motion(problem.truths(), nuisances_of(problem));
      if (why.empty()) why = "some derivatives of its motion are no finite numbers";
      return out;
    } catch (const std::runtime_error& error) {
      why = error.what();
      return {};
    }
  }

  /// Computes the information of these runs, where it is not known yet.
  void compute(const std::vector<PlannedRun>& runs, const std::string& what) {
    std::vector<PlannedRun> fresh;
    for (const PlannedRun& run : runs) {
      if (!cache_.contains(run)) fresh.push_back(run);
    }
    std::sort(fresh.begin(), fresh.end());
    fresh.erase(std::unique(fresh.begin(), fresh.end()), fresh.end());
    std::vector<Eigen::MatrixXd> found(fresh.size());
    std::vector<std::string> why(fresh.size());
    std::vector<char> done(fresh.size(), 0);
    solvers::ParallelOptions parallel{options_.jobs, options_.interrupt, {}};
    if (!what.empty()) {
      parallel.progress = [&](std::size_t n) { tell(fmt::format("{}{} of {} candidates", what, n, fresh.size())); };
    }
    solvers::parallel_for(fresh.size(), parallel, [&](std::size_t i) {
      found[i] = compute(fresh[i], why[i]);
      done[i] = 1;
    });
    for (std::size_t i = 0; i < fresh.size(); ++i) {
      if (done[i] == 0) continue;
      ++out_.evaluations;
      if (found[i].size() == 0 && out_.skipped_because.empty()) out_.skipped_because = without_place(why[i]);
      cache_.emplace(fresh[i], std::move(found[i]));
    }
  }

  /// A message without the place in the text that was made for the candidate.
  std::string without_place(const std::string& message) const {
    const std::string file = own_.experiment().file + ":";
    if (!message.starts_with(file)) return message;
    const std::size_t after = message.find(": ", file.size());
    return after == std::string::npos ? message : message.substr(after + 2);
  }

  /// Null where it cannot be made.
  const Eigen::MatrixXd* known(const PlannedRun& run) const {
    const auto at = cache_.find(run);
    return at == cache_.end() || at->second.size() == 0 ? nullptr : &at->second;
  }

  std::vector<PlanChoice> choices(bool common) const {
    std::vector<PlanChoice> out;
    for (const PlanChoice& choice : limits_.vary) {
      if (choice.common == common) out.push_back(choice);
    }
    return out;
  }

  std::vector<std::vector<double>> fill_common() const {
    const std::vector<PlanChoice> common = choices(true);
    const int ranges =
        static_cast<int>(std::count_if(common.begin(), common.end(), [](const auto& c) { return !c.is_list(); }));
    int count = ranges == 0 ? 1 : 8 * ranges;
    for (const PlanChoice& choice : common) count *= choice.is_list() ? static_cast<int>(choice.values.size()) : 1;
    return fill(common, count, solvers::RandomStream(options_.seed, shifts, 1));
  }

  std::vector<PlannedRun> candidates(const std::vector<double>& common) const {
    std::vector<PlannedRun> out;
    const int count = std::max(1, limits_.candidates / std::max(1, out_.templates));
    const auto points = fill(choices(false), count, solvers::RandomStream(options_.seed, shifts));
    for (std::size_t like = 0; like < text_.templates().size(); ++like) {
      for (const std::vector<double>& point : points) {
        PlannedRun run{like, {}};
        auto own = point.begin();
        auto shared = common.begin();
        for (const PlanChoice& choice : limits_.vary) run.values.push_back(choice.common ? *shared++ : *own++);
        out.push_back(std::move(run));
      }
    }
    return out;
  }

  /// The best design of several starts, out of these candidates.
  Design choose(const std::vector<PlannedRun>& runs, const std::string& place) {
    compute(runs, "computing " + place);
    std::vector<Candidate> all;
    for (const PlannedRun& run : runs) {
      const double duration = text_.duration(run);
      if (known(run) != nullptr && duration <= limits_.time.value_or(INFINITY))
        all.push_back({run, duration, known(run)});
    }
    if (all.empty()) return {};
    tell("choosing runs");
    std::vector<std::vector<std::size_t>> begins = {added({}, all, false)};
    if (limits_.time && !interrupted()) begins.push_back(added({}, all, true));
    for (int i = 0; i < random_starts && !interrupted(); ++i) {
      solvers::RandomStream random(options_.seed, starts, static_cast<std::uint64_t>(i));
      std::vector<std::size_t> begin;
      for (int k = 0; k < limits_.runs; ++k) {
        const auto at =
            std::min(all.size() - 1, static_cast<std::size_t>(random.uniform() * static_cast<double>(all.size())));
        if (all[at].duration <= time_left(begin, all)) begin.push_back(at);
      }
      begins.push_back(std::move(begin));
    }
    Design best;
    for (std::vector<std::size_t>& design : begins) {
      exchange(design, all);
      design = added(std::move(design), all, false);
      const double found = score(sum(design, all));
      if (!best.runs.empty() && found >= best.score - least_gain) continue;
      best = {{}, found};
      for (const std::size_t i : design) best.runs.push_back(all[i].run);
    }
    return best;
  }

  double time_left(const std::vector<std::size_t>& design, const std::vector<Candidate>& all) const {
    double left = limits_.time.value_or(INFINITY) * (1 + 1e-12);
    for (const std::size_t i : design) left -= all[i].duration;
    return left;
  }

  Eigen::MatrixXd sum(const std::vector<std::size_t>& design, const std::vector<Candidate>& all) const {
    Eigen::MatrixXd out = made_;
    for (const std::size_t i : design) out += *all[i].information;
    return out;
  }

  /// Adds the candidate that improves the criterion most, or most per second, until there are as many as allowed.
  std::vector<std::size_t> added(std::vector<std::size_t> design, const std::vector<Candidate>& all,
                                 bool per_second) const {
    while (design.size() < static_cast<std::size_t>(limits_.runs)) {
      const Eigen::MatrixXd before = sum(design, all);
      const double worth = score(before);
      const double left = time_left(design, all);
      std::size_t best = all.size();
      double most = -INFINITY;
      for (std::size_t i = 0; i < all.size(); ++i) {
        if (all[i].duration > left) continue;
        const double gain = (worth - score(before + *all[i].information)) / (per_second ? all[i].duration : 1.0);
        if (best < all.size() && gain <= most + least_gain) continue;
        best = i;
        most = gain;
      }
      if (best == all.size()) break;
      design.push_back(best);
    }
    return design;
  }

  /// Exchanges a run of the design for the best candidate in its place, as long as that improves the criterion.
  void exchange(std::vector<std::size_t>& design, const std::vector<Candidate>& all) const {
    double now = score(sum(design, all));
    for (bool improved = true; improved && !interrupted();) {
      improved = false;
      for (std::size_t slot = 0; slot < design.size(); ++slot) {
        std::vector<std::size_t> others = design;
        others.erase(others.begin() + static_cast<std::ptrdiff_t>(slot));
        const Eigen::MatrixXd rest = sum(others, all);
        const double left = time_left(others, all);
        for (std::size_t i = 0; i < all.size(); ++i) {
          if (all[i].duration > left) continue;
          const double found = score(rest + *all[i].information);
          if (found >= now - least_gain) continue;
          now = found;
          design[slot] = i;
          improved = true;
        }
      }
    }
  }

  /// Moves all numbers of the runs within their ranges.
  void refine(Design& design) {
    struct Place {
      std::size_t run, choice;  // run: past the end where the number is common
    };
    std::vector<Place> places;
    std::vector<double> start;
    for (std::size_t c = 0; c < limits_.vary.size(); ++c) {
      const PlanChoice& choice = limits_.vary[c];
      if (choice.is_list()) continue;
      for (std::size_t r = 0; r < (choice.common ? 1 : design.runs.size()); ++r) {
        places.push_back({choice.common ? design.runs.size() : r, c});
        start.push_back((design.runs[r].values[c] - choice.min) / (choice.max - choice.min));
      }
    }
    if (places.empty()) return;
    const auto runs_at = [&](const double* u) {
      std::vector<PlannedRun> runs = design.runs;
      for (std::size_t i = 0; i < places.size(); ++i) {
        const auto [run, c] = places[i];
        const double value = value_at(limits_.vary[c], u[i]);
        for (std::size_t r = 0; r < runs.size(); ++r) {
          if (r == run || run == runs.size()) runs[r].values[c] = value;
        }
      }
      return runs;
    };
    const int most = std::min(most_evaluations, evaluations_per_number * static_cast<int>(places.size()));
    int evaluation = 0;
    const auto f = [&](const double* u) {
      tell(fmt::format("refining: {} of at most {}", ++evaluation, most));
      const std::vector<PlannedRun> runs = runs_at(u);
      double time = 0.0;
      for (const PlannedRun& run : runs) time += text_.duration(run);
      const double excess = time / limits_.time.value_or(INFINITY) - 1;
      if (excess > 1e-12) return not_possible * (1 + excess);
      compute(runs, "");
      Eigen::MatrixXd information = made_;
      for (const PlannedRun& run : runs) {
        const Eigen::MatrixXd* const one = known(run);
        if (one == nullptr) return not_possible;
        information += *one;
      }
      return score(information);
    };
    const std::vector<double> lower(places.size(), 0.0);
    const std::vector<double> upper(places.size(), 1.0);
    const solvers::NloptResult found = solvers::minimise_with_nlopt(
        f, lower, upper, start,
        {.evaluations = most, .good_enough = -INFINITY, .step_tolerance = 1e-3, .interrupt = options_.interrupt});
    if (found.value < design.score - least_gain) design = {runs_at(found.x.data()), found.value};
  }

  /// Each run the best after those before it.
  std::vector<PlannedRun> in_order(std::vector<PlannedRun> runs) const {
    std::vector<PlannedRun> out;
    Eigen::MatrixXd information = made_;
    while (!runs.empty()) {
      std::size_t best = 0;
      double least = INFINITY;
      for (std::size_t i = 0; i < runs.size(); ++i) {
        const double found = score(information + *known(runs[i]));
        if (found >= least - least_gain) continue;
        least = found;
        best = i;
      }
      information += *known(runs[best]);
      out.push_back(runs[best]);
      runs.erase(runs.begin() + static_cast<std::ptrdiff_t>(best));
    }
    return out;
  }

  std::vector<Eigen::MatrixXd> triangles_of(const FitProblem& problem) const {
    const std::vector<std::vector<double>> nuisances = nuisances_of(problem);
    std::vector<Eigen::MatrixXd> out(problem.runs());
    solvers::parallel_for(problem.runs(), {options_.jobs, nullptr, {}},
                          [&](std::size_t r) { out[r] = triangle_of(problem, r, nuisances[r]); });
    return out;
  }

  /// Computes it for some runs; it is infinite where a null of theirs moves the result, or a parameter of no run.
  double error_of_prediction(const FitProblem& problem, const Identifiability& found,
                             const std::map<std::string, std::size_t>& there) const {
    FittedNumbers numbers;
    numbers.covariance = found.covariance;
    numbers.numbers.resize(problem.parameters().size());
    numbers.unknown = nulls_of(problem, problem.truths(), found);
    const auto count = static_cast<Eigen::Index>(problem.parameters().size());
    ResultGradient result{
        .value = 0.0, .why = "", .by = Eigen::VectorXd::Zero(count), .rounding = Eigen::VectorXd::Zero(count)};
    for (std::size_t i = 0; i < scales_.size(); ++i) {
      const auto own = static_cast<Eigen::Index>(i);
      const auto at = there.find(own_.parameters()[i].name);
      if (at == there.end() && options_.prediction->by[own] != 0) return INFINITY;
      if (at == there.end()) continue;
      result.by[static_cast<Eigen::Index>(at->second)] = options_.prediction->by[own];
      result.rounding[static_cast<Eigen::Index>(at->second)] = options_.prediction->rounding[own];
    }
    const PredictedResult predicted = predict(numbers, options_.prediction->name, {}, result);
    return predicted.is_known() ? predicted.sigma : INFINITY;
  }

  PlanStep step_of(const FitProblem& problem, const std::vector<Eigen::MatrixXd>& triangles) const {
    const Identifiability found =
        assess(problem, problem.truths(), nuisances_of(problem), triangles, problem.weighting());
    PlanStep out;
    out.ok = found.ok;
    out.why = found.why;
    if (!found.ok) return out;
    out.worst = 0.0;
    out.not_identifiable = found.null_directions;
    const std::map<std::string, std::size_t> there = places_of(problem);
    for (std::size_t i = 0; i < scales_.size(); ++i) {
      const std::string& name = own_.parameters()[i].name;
      const auto at = there.find(name);
      if (at == there.end()) out.without_run.push_back(name);
      const bool is_known = at != there.end() && found.identifiable[at->second];
      out.standard_error.push_back(is_known ? found.standard_error[at->second] : INFINITY);
      out.worst = std::max(out.worst, out.standard_error.back() / scales_[i]);
    }
    if (options_.prediction) out.prediction = error_of_prediction(problem, found, there);
    return out;
  }

  /// What the runs of the file determine; those that have been measured count for the plan.
  void assess_own() {
    const std::vector<Eigen::MatrixXd> triangles = triangles_of(own_);
    out_.own = step_of(own_, triangles);
    Eigen::MatrixXd all = made_;
    for (std::size_t r = 0; r < own_.runs(); ++r) {
      const Eigen::MatrixXd one = information(own_, r, triangles[r]);
      const bool is_made = !own_.run(r).run().is_simulated();
      if (one.size() == 0 && is_made) out_.why = out_.own.why;
      if (one.size() == 0) continue;
      all += one;
      if (is_made) made_ += one;
    }
    if (out_.own.ok) out_.own.singular_values = singular_values_of(all);
  }

  void assess_steps() {
    std::vector<Eigen::MatrixXd> triangles;
    for (std::size_t count = out_.runs.size(); count >= 1; --count) {
      const std::vector<PlannedRun> first(out_.runs.begin(), out_.runs.begin() + static_cast<std::ptrdiff_t>(count));
      const Experiment experiment = parse_experiment(text_.with(first, true, folder_), own_.experiment().file);
      const FitProblem problem(experiment);
      // Runs at rest are behind those in motion, whichever were planned first.
      if (triangles.empty() || problem.any_at_rest()) triangles = triangles_of(problem);
      triangles.resize(problem.runs());
      PlanStep step = step_of(problem, triangles);
      Eigen::MatrixXd sum = made_;
      for (const PlannedRun& run : first) sum += *known(run);
      step.singular_values = singular_values_of(sum);
      out_.steps.insert(out_.steps.begin(), std::move(step));
    }
  }

  const FitProblem& own_;
  const ExperimentText& text_;
  const PlanOptions& options_;
  const PlanLimits& limits_;
  std::vector<double> scales_;
  std::map<std::string, std::size_t> places_;
  fs::path folder_;
  Eigen::MatrixXd made_;  // information of priors and measured runs
  std::map<PlannedRun, Eigen::MatrixXd> cache_;
  Plan out_;
};

}  // namespace

PlannedPrediction planned_prediction(const FitProblem& problem, Scene scene, const std::string& quantity) {
  FittedNumbers numbers;
  numbers.file = problem.experiment().file;
  const auto count = static_cast<Eigen::Index>(problem.parameters().size());
  numbers.covariance = Eigen::MatrixXd::Zero(count, count);
  const std::vector<double> truths = problem.truths();
  for (std::size_t i = 0; i < truths.size(); ++i) {
    const Unknown& unknown = problem.unknown_of(i);
    FittedNumbers::Number& number = numbers.numbers.emplace_back();
    number.name = problem.parameters()[i].name;
    number.path = unknown.path;
    number.value = truths[i];
    if (unknown.of_sensor) number.origin = FittedNumbers::Number::Origin::sensor;
    if (unknown.per.empty() || unknown.of_sensor) continue;
    throw InputError(
        fmt::format("{}: {} has one value for each {}, and {} would not know which; take one value for all",
                    numbers.file, unknown.name, unknown.per, quantity));
  }
  numbers = numbers.of(scene);
  numbers.put_into(scene);
  const SoughtQuantity of = find_quantity(scene, quantity);
  const StaticModel model(std::move(scene));
  const Sensitivities found = sensitivities(model, {of});
  const ResultGradient gradient =
      found.why.empty() ? gradient_by(numbers, found.of.front()) : ResultGradient{.why = found.why, .by = {}};
  if (!gradient.why.empty()) {
    throw InputError(fmt::format("{}: {} has no derivatives: {}", model.scene().file, quantity, gradient.why));
  }
  const double unit = of.dimension.unit(model.scene().units);
  PlannedPrediction out{of.name, of.dimension.unit_name(model.scene().units), gradient.value / unit,
                        Eigen::VectorXd::Zero(count), Eigen::VectorXd::Zero(count)};
  const std::map<std::string, std::size_t> places = places_of(problem);
  for (std::size_t i = 0; i < numbers.numbers.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(places.at(numbers.numbers[i].name));
    out.by[at] = gradient.by[static_cast<Eigen::Index>(i)] / unit;
    out.rounding[at] = gradient.rounding[static_cast<Eigen::Index>(i)] / unit;
  }
  if (!out.by.isZero(0.0)) return out;
  throw InputError(fmt::format("{}: no number that is to be identified moves {}", numbers.file, quantity));
}

Plan plan_runs(const FitProblem& own, const ExperimentText& text, const PlanOptions& options) {
  return Planner(own, text, options).plan();
}

}  // namespace poise
