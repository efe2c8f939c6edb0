#include "identification/assessment/profile.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <boost/math/distributions/normal.hpp>
#include <fmt/format.h>

#include "solvers/parallel.hpp"

namespace poise {
namespace {

/// Of the interval's expected half width.
constexpr double first_profile_step = 0.25;
constexpr double farthest_from_estimate = 20.0;
constexpr int most_points = 60;
/// Of the limit, relative: where an end is found.
constexpr double found_within = 1e-3;
/// Or where the end lies within so many standard errors.
constexpr double placed_within = 5e-3;

class Profiler {
 public:
  Profiler(const FitProblem& problem, const std::vector<Record>& records, const Fit& fitted, int parameter,
           const ProfileOptions& options)
      : problem_(problem),
        records_(records),
        fitted_(fitted),
        place_(static_cast<std::size_t>(parameter)),
        options_(options) {}

  LikelihoodProfile run() {
    out_.parameter = static_cast<int>(place_);
    const Parameter& p = problem_.parameters()[place_];
    const Estimate& estimate = fitted_.estimates[place_];
    error_ = estimate.is_curved ? fitted_.errors.error[place_] : estimate.standard_error;
    ratio_ = fitted_.identifiability.standard_error[place_] / error_;
    const double near = 1e-9 * p.scale;
    const double at = fitted_.parameters[place_];
    const bool at_min = at <= p.min + near;
    const bool at_max = at >= p.max - near;
    out_.one_sided = at_min || at_max;
    limit_ = out_.one_sided ? boost::math::quantile(boost::math::normal(), 0.95)
                            : fitted_.errors.reach[place_] / fitted_.errors.error[place_];
    const double includes = problem_.unknown_of(place_).includes;
    points_.push_back({at, 0.0});
    out_.low = at_min ? at : end(-1, p.min);
    out_.high = at_max ? at : end(+1, p.max);
    std::sort(points_.begin(), points_.end(), [](const Point& a, const Point& b) { return a.x < b.x; });
    for (const Point& point : points_) {
      out_.value.push_back(point.x + includes);
      out_.growth.push_back(point.growth);
    }
    if (out_.low) *out_.low += includes;
    if (out_.high) *out_.high += includes;
    return std::move(out_);
  }

 private:
  struct Point {
    double x, growth;
  };

  // The end of the interval to one side; a bound of the parameter that is reached first is the end.
  std::optional<double> end(int side, double bound) {
    Fit last = fitted_;
    double x = fitted_.parameters[place_];
    double growth = 0.0;
    double step = first_profile_step * limit_ * error_;
    for (int n = 0; n < most_points; ++n) {
      if (options_.interrupt != nullptr && options_.interrupt->load()) return std::nullopt;
      if (options_.progress) {
        options_.progress(fmt::format("profile of {}, {:.2g} of {:.2g} standard errors {}",
                                      problem_.parameters()[place_].name, growth, limit_, side < 0 ? "down" : "up"));
      }
      double next = x + side * step;
      const bool at_bound = side < 0 ? next <= bound : next >= bound;
      if (at_bound) next = bound;
      const std::optional<Fit> there = fit_at(last, next);
      if (!there) {
        step /= 4;
        if (step < 1e-3 * error_) return std::nullopt;
        continue;
      }
      const double next_growth = growth_of(*there);
      points_.push_back({next, next_growth});
      if (std::abs(next_growth - limit_) < found_within * limit_) return next;
      if (next_growth > limit_) return cross(last, x, growth, next, next_growth);
      if (at_bound) return bound;
      if (std::abs(next - fitted_.parameters[place_]) > farthest_from_estimate * error_) return std::nullopt;
      // The growth is nearly linear: the next point should reach the limit, or half of what is left of it.
      const double slope = (next_growth - growth) / std::abs(next - x);
      const double left = (limit_ - next_growth) / std::max(slope, 0.1 / error_);
      last = *there;
      x = next;
      growth = next_growth;
      step = left > 0.6 * limit_ * error_ ? left / 2 : left;
    }
    return std::nullopt;
  }

  // Regula falsi between a point below the limit and one above.
  std::optional<double> cross(const Fit& from, double below, double growth_below, double above, double growth_above) {
    for (int n = 0; n < 20; ++n) {
      // The cost is not known better than the motions: beyond that the growth is no smooth function of x.
      if (std::abs(above - below) < placed_within * error_) return (above + below) / 2;
      const double share = std::clamp((limit_ - growth_below) / (growth_above - growth_below), 0.1, 0.9);
      const double x = below + share * (above - below);
      const std::optional<Fit> there = fit_at(from, x);
      if (!there) return std::nullopt;
      const double growth = growth_of(*there);
      points_.push_back({x, growth});
      if (std::abs(growth - limit_) < found_within * limit_) return x;
      (growth < limit_ ? below : above) = x;
      (growth < limit_ ? growth_below : growth_above) = growth;
    }
    return std::nullopt;
  }

  std::optional<Fit> fit_at(const Fit& from, double x) const {
    FitOptions options;
    options.from = &from;
    options.held = {{static_cast<int>(place_), x}};
    options.values_only = true;
    options.jobs = options_.jobs;
    options.interrupt = options_.interrupt;
    Fit there = fit(problem_, records_, options);
    if (there.status == FitStatus::failed || there.status == FitStatus::interrupted) return std::nullopt;
    return there;
  }

  double growth_of(const Fit& there) const {
    return std::sqrt(std::max(0.0, 2 * (there.cost - fitted_.cost))) * ratio_;
  }

  const FitProblem& problem_;
  const std::vector<Record>& records_;
  const Fit& fitted_;
  std::size_t place_;
  const ProfileOptions& options_;
  double error_ = 0.0, ratio_ = 1.0, limit_ = 0.0;
  std::vector<Point> points_;
  LikelihoodProfile out_;
};

}  // namespace

LikelihoodProfile profile(const FitProblem& problem, const std::vector<Record>& records, const Fit& fitted,
                          int parameter, const ProfileOptions& options) {
  return Profiler(problem, records, fitted, parameter, options).run();
}

std::vector<LikelihoodProfile> profiles(const FitProblem& problem, const std::vector<Record>& records,
                                        const Fit& fitted, const std::vector<int>& parameters,
                                        const ProfileOptions& options) {
  if (parameters.size() == 1) return {profile(problem, records, fitted, parameters.front(), options)};
  std::vector<std::optional<LikelihoodProfile>> found(parameters.size());
  solvers::ParallelOptions parallel{options.jobs, options.interrupt, {}};
  if (options.progress) {
    parallel.progress = [&](std::size_t done) {
      options.progress(fmt::format("profiles: {} of {}", done, parameters.size()));
    };
  }
  solvers::parallel_for(parameters.size(), parallel, [&](std::size_t i) {
    found[i] = profile(problem, records, fitted, parameters[i], {.jobs = 1, .interrupt = options.interrupt});
  });
  std::vector<LikelihoodProfile> out;
  for (std::optional<LikelihoodProfile>& one : found) {
    if (one) out.push_back(std::move(*one));
  }
  return out;
}

}  // namespace poise
