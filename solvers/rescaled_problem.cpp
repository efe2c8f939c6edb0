#include "solvers/rescaled_problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "solvers/residuals.hpp"

namespace poise::solvers {
namespace {

constexpr double pressing = 1e3;  // times the error left

}  // namespace

RescaledProblem::RescaledProblem(const Problem& problem, const std::vector<int>& kept)
    : problem_(problem), kept_(kept), at_(problem.make_evaluation()), no_multipliers_(problem.constraints(), 0.0) {}

// A bound whose multiplier is larger than the remaining error can change is an equation there. Any other may become
// inactive: its multiplier is left to the program.
void RescaledProblem::sort_rows() {
  equalities_ = {};
  inequalities_ = {};
  for (const int row : kept_) {
    const int inequality = row - problem_.equalities();
    if (inequality < 0) {
      equalities_.rows.push_back({row, 1.0, 0.0});
      continue;
    }
    const double lower = problem_.lower()[inequality];
    const double upper = problem_.upper()[inequality];
    double& multiplier = frame_.multipliers[row];
    if (frame_.near && std::abs(multiplier) > pressing * frame_.unit) {
      equalities_.rows.push_back({row, 1.0, multiplier > 0 ? upper : lower});
      continue;
    }
    multiplier = 0.0;
    if (lower == upper) {
      equalities_.rows.push_back({row, 1.0, upper});
      continue;
    }
    if (std::isfinite(upper)) inequalities_.rows.push_back({row, 1.0, upper});
    if (std::isfinite(lower)) inequalities_.rows.push_back({row, -1.0, lower});
  }
  list_entries(equalities_);
  list_entries(inequalities_);
}

void RescaledProblem::list_entries(Block& block) const {
  const int n = problem_.variables();
  const Pattern& pattern = problem_.jacobian_pattern();
  std::vector<std::vector<int>> of_row(problem_.constraints());
  for (int e = 0; e < pattern.size(); ++e) of_row[pattern.row[e]].push_back(e);
  for (int k = 0; k < static_cast<int>(block.rows.size()); ++k) {
    for (const int e : of_row[block.rows[k].row]) {
      block.entries.push_back({e, k * n + pattern.column[e], block.rows[k].sign});
    }
  }
}

void RescaledProblem::set_frame(Frame frame) {
  frame_ = std::move(frame);
  if (frame_.multipliers.empty()) frame_.multipliers = no_multipliers_;
  sort_rows();
  u_.clear();
  if (!frame_.near) return;
  const std::vector<double> here(frame_.base.size(), 0.0);
  const Evaluation& e = at(here);
  slope_at_base_ = slope_of(e);
  // NLopt's augmented Lagrangian takes its first penalty from the ratio of the objective to the squared gaps, up to 10.
  value_at_base_ = 1e-3;
  for (const SignedRow& row : equalities_.rows) {
    const double gap = (e.constraint[row.row] - row.bound) / frame_.unit;
    value_at_base_ += 5 * gap * gap;
  }
}

std::vector<double> RescaledProblem::place(std::span<const double> u) const {
  std::vector<double> x = frame_.base;
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += frame_.unit * u[i];
  return x;
}

const Evaluation& RescaledProblem::at(std::span<const double> u) {
  if (!u_.empty() && std::equal(u_.begin(), u_.end(), u.begin())) return at_;
  u_.assign(u.begin(), u.end());
  at_.x = place(u);
  problem_.evaluate(at_);
  ++evaluations_;
  return at_;
}

const std::vector<double>& RescaledProblem::slope_of(const Evaluation& e) {
  unbalanced(problem_, e, frame_.multipliers, slope_);
  for (double& s : slope_) s *= frame_.scale / frame_.unit;
  return slope_;
}

double RescaledProblem::objective(std::span<const double> u, std::span<double> gradient) {
  const Evaluation& e = at(u);
  double value = 0.0;
  if (frame_.near || !gradient.empty()) slope_of(e);
  if (!gradient.empty()) std::copy(slope_.begin(), slope_.end(), gradient.begin());
  if (frame_.near) {
    value = value_at_base_;
    for (std::size_t i = 0; i < slope_.size(); ++i) value += 0.5 * (slope_[i] + slope_at_base_[i]) * u[i];
  } else {
    value = problem_.objective(at_);
    for (int r = 0; r < problem_.equalities(); ++r) value += frame_.multipliers[r] * e.constraint[r];
    value *= frame_.scale;
  }
  return std::isnan(value) ? std::numeric_limits<double>::infinity() : value;
}

void RescaledProblem::constraints(const Block& block, std::span<const double> u, std::span<double> values,
                                  std::span<double> jacobian) {
  const Evaluation& e = at(u);
  for (std::size_t k = 0; k < block.rows.size(); ++k) {
    const SignedRow& row = block.rows[k];
    values[k] = row.sign * (e.constraint[row.row] - row.bound) / frame_.unit;
  }
  if (jacobian.empty()) return;
  std::fill(jacobian.begin(), jacobian.end(), 0.0);
  for (const Block::Entry& entry : block.entries) jacobian[entry.target] = entry.sign * e.jacobian[entry.source];
}

}  // namespace poise::solvers
