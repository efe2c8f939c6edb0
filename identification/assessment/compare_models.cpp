#include "identification/assessment/compare_models.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <fmt/format.h>

#include "identification/fit/some_runs.hpp"
#include "model/dependent_number.hpp"
#include "model/parameters.hpp"
#include "solvers/not_a_number.hpp"

namespace poise {
namespace {

constexpr std::size_t most_folds = 10;

void expect_same_readings(const FitProblem& a, const FitProblem& b) {
  const auto fail = [&](const std::string& what) {
    throw InputError(
        fmt::format("{}: expected the readings of {}: {}", b.experiment().file, a.experiment().file, what));
  };
  const auto& first = a.experiment();
  const auto& second = b.experiment();
  if (first.sensors.size() != second.sensors.size()) fail("the numbers of sensors differ");
  for (std::size_t k = 0; k < first.sensors.size(); ++k) {
    const Sensor& s = first.sensors[k];
    const Sensor& t = second.sensors[k];
    if (s.name != t.name) fail(fmt::format("sensor \"{}\" is \"{}\" here", s.name, t.name));
    if (s.noise_known != t.noise_known || (s.noise_known && s.noise != t.noise)) {
      fail(fmt::format("the noise of sensor \"{}\" differs", s.name));
    }
  }
  if (first.loss != second.loss) fail("the losses differ");
  for (const Experiment* const one : {&first, &second}) {
    for (const Run& run : one->runs) {
      for (const RunInput& input : run.inputs) {
        if (!(input.noise > 0)) continue;
        throw InputError(fmt::format(
            "{}: expected inputs without noise, found that of \"{}\" in run \"{}\"; leave it out of both experiments",
            one->file, input.path, run.name));
      }
    }
  }
  if (a.runs() != b.runs()) fail(fmt::format("{} runs here, {} there", b.runs(), a.runs()));
  for (std::size_t r = 0; r < a.runs(); ++r) {
    if (a.run(r).run().name != b.run(r).run().name) {
      fail(fmt::format("run \"{}\" is \"{}\" here", a.run(r).run().name, b.run(r).run().name));
    }
  }
  const std::vector<Record> one = a.records();
  const std::vector<Record> other = b.records();
  for (std::size_t r = 0; r < one.size(); ++r) {
    for (std::size_t k = 0; k < one[r].sensors.size(); ++k) {
      if (one[r].sensors[k].time != other[r].sensors[k].time || one[r].sensors[k].value != other[r].sensors[k].value) {
        fail(
            fmt::format("those of {} in run \"{}\" differ; simulated runs of different models differ, write one to a "
                        "file and name that as data",
                        first.sensors[k].name, a.run(r).run().name));
      }
    }
  }
}

class Comparing {
 public:
  Comparing(const std::vector<const FitProblem*>& problems, const CompareOptions& options)
      : problems_(problems), options_(options), records_(problems.front()->records()) {}

  ModelComparison run() {
    for (const FitProblem* problem : problems_) {
      ModelFit& model = out_.models.emplace_back();
      model.fit = fit(*problem, records_, options_.fit);
      if (stopped()) return std::move(out_);
    }
    find_scale();
    compare_costs();
    test_nested();
    cross_validate();
    choose();
    return std::move(out_);
  }

 private:
  bool stopped() {
    out_.interrupted = options_.fit.interrupt != nullptr && options_.fit.interrupt->load();
    return out_.interrupted;
  }
  void say(const std::string& what) const {
    if (options_.fit.progress) options_.fit.progress(what);
  }
  std::string name_of(std::size_t m) const { return problems_[m]->experiment().file; }

  // The noise of all models is the least that one of them leaves, where it is not stated.
  void find_scale() {
    weighting_ = problems_.front()->weighting();
    for (std::size_t k = 0; k < weighting_.noise.size(); ++k) {
      if (problems_.front()->experiment().sensors[k].noise_known && weighting_.loss != Loss::student) continue;
      weighting_.noise[k] = INFINITY;
      for (const ModelFit& model : out_.models) {
        weighting_.noise[k] = std::min(weighting_.noise[k], model.fit.weighting.noise[k]);
      }
    }
  }

  /// Sum of rho and number of readings of one run of a problem, at the common noise; none where the motion fails.
  std::optional<std::pair<double, double>> cost_of(const FitProblem& problem, std::size_t r,
                                                   const std::vector<double>& parameters,
                                                   const std::vector<double>& nuisances, const Record& record) const {
    const Residuals e = problem.residuals(r, parameters, nuisances, record);
    if (e.empty()) return std::nullopt;
    double sum = 0.0;
    double count = 0.0;
    for (std::size_t k = 0; k < e.size(); ++k) {
      const double scale = problem.experiment().sensors[k].noise / weighting_.noise[k];
      for (const double x : e[k]) sum += weighting_.cost(scale * scale * x * x);
      count += static_cast<double>(e[k].size());
    }
    return std::pair{sum, count};
  }

  void compare_costs() {
    double least = INFINITY;
    for (std::size_t m = 0; m < out_.models.size(); ++m) {
      ModelFit& model = out_.models[m];
      for (std::size_t r = 0; r < records_.size(); ++r) {
        const auto own = model.fit.runs.empty() ? std::nullopt
                                                : cost_of(*problems_[m], r, model.fit.parameters,
                                                          model.fit.runs[r].nuisances, records_[r]);
        model.own.push_back(own ? std::sqrt(own->first / own->second) : not_a_number);
        model.cost += own ? own->first / 2 : INFINITY;
      }
      const double left = std::max(1, model.fit.degrees_of_freedom);
      least = std::min(least, 2 * model.cost / left);
    }
    size_ = std::max(1.0, least);
    const auto fullest = std::min_element(out_.models.begin(), out_.models.end(),
                                          [](const ModelFit& a, const ModelFit& b) { return a.cost < b.cost; });
    const std::size_t parameters = fullest->fit.errors.error.size();
    double scatter = 0.0;
    for (std::size_t p = 0; p < parameters; ++p)
      scatter += inflation(fullest->fit, p) / static_cast<double>(parameters);
    if (parameters == 0) scatter = 1.0;
    const double independent = std::max(2.0, fullest->fit.readings / scatter);
    evidence_ = size_ * scatter;
    double best = INFINITY;
    double best_bic = INFINITY;
    for (std::size_t m = 0; m < out_.models.size(); ++m) {
      ModelFit& model = out_.models[m];
      const auto count = static_cast<double>(problems_[m]->parameters().size());
      const double evidence = 2 * model.cost / evidence_;
      model.aic = evidence + 2 * count;
      model.bic = evidence + std::log(independent) * count;
      best = std::min(best, model.aic);
      best_bic = std::min(best_bic, model.bic);
    }
    for (ModelFit& model : out_.models) {
      model.aic -= best;
      model.bic -= best_bic;
    }
  }

  /// (leading error / white error)^2 of a parameter: by how much its score scatters more than independent readings'.
  static double inflation(const Fit& fitted, std::size_t p) {
    const double white = fitted.errors.white[p];
    return white > 0 && std::isfinite(fitted.errors.error[p]) ? std::pow(fitted.errors.error[p] / white, 2) : 1.0;
  }

  /// Whether model b has all unknowns of a, and the same scene but for the values of its own unknowns.
  bool is_contained(std::size_t a, std::size_t b) const {
    const Experiment& simple = problems_[a]->experiment();
    const Experiment& full = problems_[b]->experiment();
    if (problems_[a]->parameters().size() >= problems_[b]->parameters().size()) return false;
    for (const Unknown& unknown : simple.unknowns) {
      const auto same = [&](const Unknown& u) {
        return u.part == unknown.part && u.path == unknown.path && (u.per == unknown.per || u.per == "run");
      };
      if (std::none_of(full.unknowns.begin(), full.unknowns.end(), same)) return false;
    }
    for (const Run& run : simple.runs) {
      if (!differ_by_unknowns(simple.scene_of(run.part), full, run.part)) return false;
    }
    for (std::size_t k = 0; k < simple.sensors.size(); ++k) {
      if (!differ_by_unknowns(simple.sensors[k], full, k)) return false;
    }
    return true;
  }

  /// The same of the numbers of a sensor. Readings are compared in its quantity: of zero and factor, only what is
  /// unknown of them counts.
  static bool differ_by_unknowns(const Sensor& sensor, const Experiment& full, std::size_t k) {
    const bool is_free = std::any_of(full.unknowns.begin(), full.unknowns.end(), [&](const Unknown& unknown) {
      return unknown.of_sensor && unknown.of_sensor->sensor == k && unknown.of_sensor->of == SensorNumber::Of::delay;
    });
    return is_free || sensor.delay == full.sensors[k].delay;
  }

  /// Whether a scene is that of a part of an experiment but for the values of the part's unknowns.
  static bool differ_by_unknowns(const Scene& scene, const Experiment& full, std::size_t part) {
    const Scene& other = full.scene_of(part);
    const std::vector<ParameterRow> rows = parameter_table(scene);
    const std::vector<ParameterRow> others = parameter_table(other);
    if (rows.size() != others.size()) return false;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const std::string path = rows[i].path.text();
      if (path != others[i].path.text()) return false;
      const bool is_free = std::any_of(full.unknowns.begin(), full.unknowns.end(), [&](const Unknown& unknown) {
        return unknown.part == part && unknown.path == path;
      });
      // What follows from an unknown by the same expression differs as it does.
      const DependentNumber *const own = dependent_number(scene, rows[i].place), *const theirs = dependent_number(
                                                                                     other, others[i].place);
      if (own != nullptr && theirs != nullptr && own->expression.text() == theirs->expression.text()) continue;
      if (!is_free && value_at(scene, rows[i].place) != value_at(other, others[i].place)) return false;
    }
    return true;
  }

  void test_nested() {
    for (std::size_t a = 0; a < problems_.size(); ++a) {
      for (std::size_t b = 0; b < problems_.size(); ++b) {
        if (a == b || !is_contained(a, b)) continue;
        const Fit& full = out_.models[b].fit;
        if (full.errors.error.empty() || !full.usable() || !out_.models[a].fit.usable()) continue;
        NestedTest test{a, b};
        double inflated = 0.0;
        bool at_bound = false;
        for (std::size_t p = 0; p < full.parameters.size(); ++p) {
          const auto& known = problems_[a]->parameters();
          const std::string& name = problems_[b]->parameters()[p].name;
          if (std::any_of(known.begin(), known.end(), [&](const Parameter& q) { return q.name == name; })) continue;
          ++test.added;
          inflated += inflation(full, p);
          const Parameter& parameter = problems_[b]->parameters()[p];
          const Unknown& unknown = problems_[b]->unknown_of(p);
          const double fixed = written_value(problems_[a]->experiment(), unknown);
          at_bound = at_bound || fixed <= parameter.min || fixed >= parameter.max;
        }
        const double size = std::max(1.0, 2 * out_.models[b].cost / std::max(1, full.degrees_of_freedom));
        const double scale = size * inflated / test.added;
        test.ratio = std::max(0.0, 2 * (out_.models[a].cost - out_.models[b].cost) / scale);
        const double share = test.added == 1 && at_bound ? 0.5 : 1.0;
        using boost::math::cdf;
        using boost::math::complement;
        test.p = share * cdf(complement(boost::math::chi_squared(test.added), test.ratio));
        test.f = test.ratio / test.added;
        const double independent =
            static_cast<double>(full.readings) * test.added / inflated - static_cast<double>(full.parameters.size());
        test.f_p = share * cdf(complement(boost::math::fisher_f(test.added, std::max(1.0, independent)), test.f));
        out_.tests.push_back(test);
      }
    }
  }

  void cross_validate() {
    const std::size_t runs = records_.size();
    for (ModelFit& model : out_.models) model.held_out.assign(runs, not_a_number);
    if (runs < 2) return;
    const std::size_t folds = std::min(runs, most_folds);
    out_.folds = static_cast<int>(folds);
    for (std::size_t m = 0; m < out_.models.size(); ++m) {
      const Fit& found = out_.models[m].fit;
      if (!found.usable()) continue;
      double sum = 0.0;
      double count = 0.0;
      for (std::size_t fold = 0; fold < folds && !stopped(); ++fold) {
        say(fmt::format("{}: holding out runs, {} of {}", name_of(m), fold + 1, folds));
        std::vector<std::size_t> kept, left;
        for (std::size_t r = 0; r < runs; ++r) (r % folds == fold ? left : kept).push_back(r);
        hold_out(m, kept, left, sum, count);
      }
      out_.models[m].held_out_all = std::any_of(out_.models[m].held_out.begin(), out_.models[m].held_out.end(),
                                                [](double x) { return std::isnan(x); })
                                        ? not_a_number
                                        : std::sqrt(sum / count);
    }
  }

  void hold_out(std::size_t m, const std::vector<std::size_t>& kept, const std::vector<std::size_t>& left, double& sum,
                double& count) {
    const FitProblem& whole = *problems_[m];
    const Fit& found = out_.models[m].fit;
    const SomeRuns train(whole, records_, kept);
    const Fit seed = train.seed(found);
    FitOptions options = options_.fit;
    options.from = &seed;
    options.progress = {};
    const Fit trained = fit(train.problem(), train.records(), options);
    if (!trained.usable()) return;
    const SomeRuns test(whole, records_, left);
    Fit start = test.seed(found);
    options.from = &start;
    for (std::size_t i = 0; i < test.places().size(); ++i) {
      const auto& places = train.places();
      const auto same = std::find(places.begin(), places.end(), test.places()[i]);
      if (same == places.end()) return;
      start.parameters[i] = trained.parameters[static_cast<std::size_t>(same - places.begin())];
      options.held.emplace_back(static_cast<int>(i), start.parameters[i]);
    }
    const Fit tested = fit(test.problem(), test.records(), options);
    if (tested.runs.empty()) return;
    for (std::size_t i = 0; i < left.size(); ++i) {
      const auto own = cost_of(test.problem(), i, tested.parameters, tested.runs[i].nuisances, test.records()[i]);
      if (!own) return;
      out_.models[m].held_out[left[i]] = std::sqrt(own->first / own->second);
      sum += own->first;
      count += own->second;
    }
  }

  void choose() {
    std::vector<std::size_t> chosen(out_.models.size());
    std::iota(chosen.begin(), chosen.end(), std::size_t{0});
    // Those of them whose value is the least one, within the rounding of that; all where none has a value.
    const auto keep_least = [&](auto&& value_of, auto&& rounding_of) {
      std::size_t best = chosen.size();
      for (std::size_t i = 0; i < chosen.size(); ++i) {
        const double value = value_of(out_.models[chosen[i]]);
        if (std::isfinite(value) && (best == chosen.size() || value < value_of(out_.models[chosen[best]]))) best = i;
      }
      if (best == chosen.size()) return;
      const ModelFit& least = out_.models[chosen[best]];
      const double most = value_of(least) + rounding_of(least);
      std::erase_if(chosen, [&](std::size_t m) { return !(value_of(out_.models[m]) <= most); });
    };
    const double within = options_.fit.function_tolerance;
    keep_least([](const ModelFit& model) { return model.held_out_all > 0 ? model.held_out_all : not_a_number; },
               [&](const ModelFit& least) { return std::sqrt(within) * least.held_out_all; });
    keep_least([](const ModelFit& model) { return model.aic; },
               [&](const ModelFit& least) { return std::max(1e-3, 2 * least.cost / evidence_ * within); });
    out_.preferred = chosen.front();
    if (chosen.size() > 1 && std::isfinite(out_.models[chosen.front()].aic)) out_.equally_good = chosen;
    const std::vector<double>& best = out_.models[out_.preferred].held_out;
    for (const ModelFit& model : out_.models) {
      std::vector<double> more;
      for (std::size_t r = 0; r < best.size(); ++r) {
        const double difference = model.held_out[r] * model.held_out[r] - best[r] * best[r];
        if (std::isfinite(difference)) more.push_back(difference);
      }
      const double n = static_cast<double>(more.size());
      double mean = 0.0;
      double squares = 0.0;
      for (const double x : more) mean += x / n;
      for (const double x : more) squares += (x - mean) * (x - mean);
      out_.loss.push_back(more.empty() ? not_a_number : mean);
      out_.loss_error.push_back(more.size() < 2 ? not_a_number : std::sqrt(squares / (n - 1) / n));
    }
  }

  const std::vector<const FitProblem*>& problems_;
  const CompareOptions& options_;
  std::vector<Record> records_;
  Weighting weighting_;
  double size_ = 1.0;      // mean square of the best model's residuals over the noise, at least 1
  double evidence_ = 1.0;  // the sum of squares that counts as one: size_ and the inflation by correlation
  ModelComparison out_;
};

}  // namespace

void leave_out_alike(const std::vector<Experiment*>& experiments) {
  const std::size_t runs = experiments.front()->runs.size();
  const std::size_t sensors = experiments.front()->sensors.size();
  for (const Experiment* const experiment : experiments) {
    if (experiment->runs.size() != runs || experiment->sensors.size() != sensors) return;
  }
  for (std::size_t r = 0; r < runs; ++r) {
    double end = 0.0;
    for (const Experiment* const experiment : experiments) {
      for (const Series& series : experiment->records[r].sensors) {
        if (!series.time.empty()) end = std::max(end, series.time.back());
      }
    }
    for (std::size_t k = 0; k < sensors; ++k) {
      TimeRange common{-INFINITY, INFINITY};
      for (const Experiment* const experiment : experiments) {
        const TimeRange own = compared_times(*experiment, experiment->runs[r], k, end);
        common = {std::max(common.from, own.from), std::min(common.to, own.to)};
      }
      for (Experiment* const experiment : experiments) {
        if (experiment->runs[r].is_simulated()) continue;
        experiment->runs[r].left_out += leave_out(common, experiment->records[r].sensors[k]);
      }
    }
  }
}

ModelComparison compare_models(const std::vector<const FitProblem*>& problems, const CompareOptions& options) {
  for (const FitProblem* problem : problems) expect_same_readings(*problems.front(), *problem);
  return Comparing(problems, options).run();
}

}  // namespace poise
