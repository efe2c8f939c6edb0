#include "identification/assessment/bootstrap.hpp"

#include <algorithm>
#include <cmath>

#include "identification/assessment/residuals.hpp"
#include "solvers/parallel.hpp"
#include "solvers/random_stream.hpp"

namespace poise {
namespace {

/// Independent residuals that one block holds.
constexpr double block_holds = 20.0;

class Resampling {
 public:
  Resampling(const FitProblem& problem, const std::vector<Record>& records, const Fit& fitted)
      : problem_(problem), records_(records) {
    double values = static_cast<double>(fitted.parameters.size());
    for (std::size_t r = 0; r < problem.runs(); ++r) {
      fits_.push_back(residuals_of(problem, fitted, records, r));
      values += static_cast<double>(fitted.runs[r].nuisances.size());
    }
    for (std::size_t r = 0; r < problem.runs(); ++r) {
      std::vector<std::size_t>& sources = sources_.emplace_back();
      for (std::size_t from = 0; from < problem.runs(); ++from) {
        if (reads_all(from, r)) sources.push_back(from);
      }
    }
    const double readings = fitted.readings;
    enlarged_ = std::sqrt(readings / std::max(1.0, readings - values));
    const double independent = fitted.errors.independent;
    double longest = 0.0;
    for (std::size_t r = 0; r < problem.runs(); ++r) {
      if (!problem.run(r).is_at_rest()) longest = std::max(longest, problem.run(r).span());
    }
    if (longest == 0.0) return;
    block_ = independent > block_holds ? longest * block_holds / independent : INFINITY;
    if (!(2 * block_ < longest)) block_ = INFINITY;
  }

  double block() const { return block_; }

  std::vector<Record> draw(solvers::RandomStream random) const {
    std::vector<Record> out = records_;
    for (std::size_t r = 0; r < out.size(); ++r) {
      const double span = problem_.run(r).span();
      const double block = std::min(block_, span);
      for (std::size_t k = 0; k < out[r].sensors.size(); ++k) out[r].sensors[k].value = fits_[r].prediction[k];
      if (problem_.run(r).is_at_rest()) {
        for (std::size_t k = 0; k < out[r].sensors.size(); ++k) add_row_by_row(r, k, random, out[r]);
        continue;
      }
      // Blocks of all sensors at once; a random sign makes their mean vanish, as that of the noise does.
      for (double begin = 0.0; begin <= span; begin += std::max(block, 1e-12)) {
        const std::vector<std::size_t>& sources = sources_[r];
        const std::size_t from = sources[std::min(
            sources.size() - 1, static_cast<std::size_t>(random.uniform() * static_cast<double>(sources.size())))];
        const double slack = std::max(0.0, problem_.run(from).span() - block);
        const double at = std::isinf(block_) ? 0.0 : slack * random.uniform();
        const double sign = random.uniform() < 0.5 ? -enlarged_ : enlarged_;
        for (std::size_t k = 0; k < out[r].sensors.size(); ++k) add(r, k, begin, block, from, at, sign, out[r]);
        if (std::isinf(block_)) break;
      }
    }
    return out;
  }

 private:
  // Whether run `from`, at rest or in motion as run r, has residuals of every sensor that is read in that.
  bool reads_all(std::size_t from, std::size_t r) const {
    if (problem_.run(from).is_at_rest() != problem_.run(r).is_at_rest()) return false;
    for (std::size_t k = 0; k < records_[r].sensors.size(); ++k) {
      if (!problem_.run(r).times()[k].empty() && problem_.run(from).times()[k].empty()) return false;
    }
    return true;
  }

  // Adds to each reading of sensor k in a run at rest, where readings are independent, some residual of one of its
  // sources.
  void add_row_by_row(std::size_t r, std::size_t k, solvers::RandomStream& random, Record& out) const {
    const auto any_of = [&](std::size_t count) {
      return std::min(count - 1, static_cast<std::size_t>(random.uniform() * static_cast<double>(count)));
    };
    for (double& value : out.sensors[k].value) {
      const std::vector<double>& e = fits_[sources_[r][any_of(sources_[r].size())]].residual[k];
      value += (random.uniform() < 0.5 ? -enlarged_ : enlarged_) * e[any_of(e.size())];
    }
  }

  // Adds to the readings of sensor k in run r at begin .. begin + block the residuals of run `from` at `at` and later.
  void add(std::size_t r, std::size_t k, double begin, double block, std::size_t from, double at, double sign,
           Record& out) const {
    const std::vector<double>& times = problem_.run(r).times()[k];
    const std::vector<double>& source = problem_.run(from).times()[k];
    const std::vector<double>& e = fits_[from].residual[k];
    if (times.empty()) return;
    const auto first = std::lower_bound(times.begin(), times.end(), begin) - times.begin();
    const auto offset = std::lower_bound(source.begin(), source.end(), at) - source.begin();
    const auto length = static_cast<std::ptrdiff_t>(source.size());
    for (std::ptrdiff_t i = first; i < static_cast<std::ptrdiff_t>(times.size()); ++i) {
      const auto place = static_cast<std::size_t>(i);
      if (!std::isinf(block_) && times[place] >= begin + block) break;
      // A run that is shorter than the block is read again from its beginning.
      out.sensors[k].value[place] += sign * e[static_cast<std::size_t>((offset + i - first) % length)];
    }
  }

  const FitProblem& problem_;
  const std::vector<Record>& records_;
  std::vector<RunResiduals> fits_;
  std::vector<std::vector<std::size_t>> sources_;  // per run: those whose residuals it may be given
  double enlarged_ = 1.0, block_ = INFINITY;       // of motions
};

double percentile(const std::vector<double>& ascending, double part) {
  const double at = part * static_cast<double>(ascending.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(ascending.size() - 1, below + 1);
  return ascending[below] + (at - static_cast<double>(below)) * (ascending[above] - ascending[below]);
}

}  // namespace

Bootstrap bootstrap(const FitProblem& problem, const std::vector<Record>& records, const Fit& fitted,
                    const BootstrapOptions& options) {
  const Resampling resampling(problem, records, fitted);
  const std::size_t parameters = fitted.parameters.size();
  std::vector<std::vector<double>> found(static_cast<std::size_t>(options.samples));
  solvers::ParallelOptions parallel{options.jobs, options.interrupt, {}};
  if (options.progress) parallel.progress = [&](std::size_t done) { options.progress(static_cast<int>(done)); };
  std::vector<char> done(found.size(), 0);
  solvers::parallel_for(found.size(), parallel, [&](std::size_t sample) {
    FitOptions fit_options;
    fit_options.from = &fitted;
    fit_options.jobs = 1;
    fit_options.interrupt = options.interrupt;
    const Fit again = fit(problem, resampling.draw(solvers::RandomStream(options.seed, 0, sample)), fit_options);
    if (again.status == FitStatus::interrupted) return;
    done[sample] = 1;
    if (again.status != FitStatus::failed) found[sample] = again.parameters;
  });
  Bootstrap out;
  out.block = resampling.block();
  out.interrupted = options.interrupt != nullptr && options.interrupt->load();
  std::vector<std::vector<double>> values(parameters);
  for (std::size_t sample = 0; sample < found.size(); ++sample) {
    if (done[sample] == 0) continue;
    if (found[sample].empty()) {
      ++out.failed;
      continue;
    }
    ++out.samples;
    for (std::size_t p = 0; p < parameters; ++p) {
      values[p].push_back(found[sample][p] + problem.unknown_of(p).includes);
    }
  }
  if (out.interrupted && out.samples < Bootstrap::least_samples) return out;
  for (std::size_t p = 0; p < parameters && out.samples > 1; ++p) {
    double mean = 0.0;
    double squares = 0.0;
    for (const double value : values[p]) mean += value / out.samples;
    for (const double value : values[p]) squares += (value - mean) * (value - mean) / (out.samples - 1);
    out.standard_error.push_back(std::sqrt(squares));
    std::sort(values[p].begin(), values[p].end());
    out.low.push_back(percentile(values[p], 0.025));
    out.high.push_back(percentile(values[p], 0.975));
  }
  return out;
}

}  // namespace poise
