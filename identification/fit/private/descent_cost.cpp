#include "identification/fit/private/descent_cost.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "solvers/parallel.hpp"

namespace poise {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Motions of a fit that only has to be a start for more readings are less accurate by this factor, down to this.
constexpr double accuracy_of_start = 100.0, least_accuracy = 1e-4;

Index place_of(std::size_t parameter) { return static_cast<Index>(parameter); }

}  // namespace

DescentCost::DescentCost(const FitTask& task, const Weighting& weighting, const FitPoint& start, double window,
                         FitEffort& effort)
    : task_(task), weighting_(weighting), start_(start), window_(window), effort_(effort) {
  Index next = place_of(parameters().size());
  for (const std::vector<double>& nuisances : start.nuisances) {
    first_.push_back(next);
    next += std::ssize(nuisances);
  }
  first_.push_back(next);
  found_accuracy_.assign(task.problem.runs(), 0.0);
  take_ranges();
  add_priors();
  VectorXd x = VectorXd::Zero(next);
  for (std::size_t i = 0; i < parameters().size(); ++i) x[place_of(i)] = start.parameters[i] / parameters()[i].scale;
  here_ = evaluate(x);
  if (is_start() && here_.is_known()) stay_near();
}

void DescentCost::take_ranges() {
  low_ = VectorXd::Constant(first_.back(), -INFINITY);
  high_ = VectorXd::Constant(first_.back(), INFINITY);
  for (std::size_t i = 0; i < parameters().size(); ++i) {
    const Parameter& p = parameters()[i];
    low_[place_of(i)] = p.min / p.scale;
    high_[place_of(i)] = p.max / p.scale;
  }
  for (const auto& [p, value] : task_.options.held) {
    const auto i = static_cast<std::size_t>(p);
    low_[p] = high_[p] = start_.parameters[i] / parameters()[i].scale;
  }
}

void DescentCost::add_priors() {
  for (std::size_t i = 0; i < parameters().size(); ++i) {
    const Unknown& unknown = task_.problem.unknown_of(i);
    if (unknown.prior) priors_.push_back({i, *unknown.prior - unknown.includes, unknown.prior_deviation});
  }
}

/// Few readings leave some directions of the parameters nearly free, and along these a step goes as far as residuals
/// of a wrong start drive it: to dimensions of kilometres, from which there is no way back. So a change of a
/// parameter by its reach counts as much as a reading at the start does.
void DescentCost::stay_near() {
  std::size_t readings = 0;
  for (std::size_t r = 0; r < task_.problem.runs(); ++r) readings += task_.problem.run(r).readings(until(r));
  const double residual =
      std::max(1.0, std::sqrt(2 * here_.cost / static_cast<double>(std::max<std::size_t>(readings, 1))));
  for (std::size_t i = 0; i < parameters().size(); ++i) {
    priors_.push_back({i, start_.parameters[i], task_.problem.reach(i) / residual});
  }
}

/// The time up to which a part of a run is fitted; it contains enough readings for the run's own values.
double DescentCost::until(std::size_t r) const {
  const RunModel& run = task_.problem.run(r);
  if (!is_start() || run.is_at_rest()) return INFINITY;
  const auto least = static_cast<std::size_t>(run.columns()) + 4;
  double part = window_;
  while (part < 1.0 && run.readings(part * run.span()) < least) part *= 1.5;
  return part < 1.0 ? part * run.span() : INFINITY;
}

FitPoint DescentCost::point_at(const VectorXd& x) const {
  FitPoint out = start_;
  for (std::size_t i = 0; i < parameters().size(); ++i) {
    const Parameter& p = parameters()[i];
    const Index at = place_of(i);
    // Ends of ranges are met exactly, and what is held keeps its value.
    out.parameters[i] = low_[at] == high_[at] ? start_.parameters[i] : std::clamp(x[at] * p.scale, p.min, p.max);
  }
  for (std::size_t r = 0; r < out.nuisances.size(); ++r) {
    for (std::size_t i = 0; i < out.nuisances[r].size(); ++i) out.nuisances[r][i] += x[first_[r] + place_of(i)];
  }
  return out;
}

const DescentCost::Place& DescentCost::at(const VectorXd& x) {
  if (here_.x == x) return here_;
  if (there_.x.size() != x.size() || there_.x != x) there_ = evaluate(x);
  return there_;
}

// Costs are added up in the order of the runs, so that the result does not depend on the threads.
DescentCost::Place DescentCost::evaluate(const VectorXd& x) {
  const auto begun = std::chrono::steady_clock::now();
  const FitProblem& problem = task_.problem;
  Place out{.x = x, .runs = std::vector<LinearRun>(problem.runs()), .triangles = {}};
  out.triangles.resize(problem.runs());
  const FitPoint point = point_at(x);
  solvers::parallel_for(problem.runs(), {.jobs = task_.options.jobs}, [&](std::size_t r) {
    const double accuracy =
        is_start() ? std::min(least_accuracy, accuracy_of_start * problem.accuracy(r)) : problem.accuracy(r);
    out.runs[r] = problem.linearized(r, point.parameters, point.nuisances[r], &task_.records[r], until(r), accuracy,
                                     weighting_, task_.options.interrupt, &found_accuracy_[r]);
    out.triangles[r] = FitProblem::triangle_of(out.runs[r].rows, weighting_);
  });
  ++effort_.evaluations;
  seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  ++timed_;
  double sum = 0.0;
  for (const MatrixXd& triangle : out.triangles) {
    if (triangle.size() == 0) return out;
    sum += triangle.col(triangle.cols() - 1).squaredNorm();
  }
  for (const Prior& prior : priors_) {
    const double off = (point.parameters[prior.parameter] - prior.mean) / prior.deviation;
    sum += off * off;
  }
  out.cost = sum / 2;
  return out;
}

Index DescentCost::rows() const {
  Index out = std::ssize(priors_);
  for (const MatrixXd& triangle : here_.triangles) out += triangle.rows();
  return out;
}

DescentCost::Model DescentCost::model(const Place& place) const {
  Model out{MatrixXd::Zero(rows(), low_.size()), VectorXd::Zero(rows())};
  Index row = 0;
  for (std::size_t r = 0; r < place.triangles.size(); ++r) {
    const MatrixXd& triangle = place.triangles[r];
    const Index count = first_[r + 1] - first_[r];
    out.a.block(row, first_[r], triangle.rows(), count) = triangle.leftCols(count);
    const std::vector<int>& used = task_.problem.parameters_of(r);
    for (std::size_t i = 0; i < used.size(); ++i) {
      const double scale = parameters()[static_cast<std::size_t>(used[i])].scale;
      out.a.col(used[i]).segment(row, triangle.rows()) = scale * triangle.col(count + place_of(i));
    }
    out.r.segment(row, triangle.rows()) = triangle.col(triangle.cols() - 1);
    row += triangle.rows();
  }
  for (const Prior& prior : priors_) {
    const double scale = parameters()[prior.parameter].scale;
    out.a(row, place_of(prior.parameter)) = scale / prior.deviation;
    out.r[row++] = (place.x[place_of(prior.parameter)] * scale - prior.mean) / prior.deviation;
  }
  return out;
}

std::vector<std::optional<LinearRun>> DescentCost::take() {
  return {std::make_move_iterator(here_.runs.begin()), std::make_move_iterator(here_.runs.end())};
}

}  // namespace poise
