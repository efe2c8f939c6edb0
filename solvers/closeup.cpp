#include "solvers/closeup.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "solvers/residuals.hpp"

namespace poise::solvers {
namespace {

constexpr double pressing = 1e3;  // times the error left

}  // namespace

Closeup::Closeup(const Problem& problem, const std::vector<int>& kept)
    : problem_(problem), kept_(kept), at_(problem.make_evaluation()), no_multipliers_(problem.constraints(), 0.0) {}

// A bound that is pressed harder than any error left can change is an equation in a close-up. Any other may turn out
// not to hold: its multiplier is left to the program.
void Closeup::sort_rows() {
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
    double& multiplier = view_.multipliers[row];
    if (view_.near && std::abs(multiplier) > pressing * view_.unit) {
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

void Closeup::list_entries(Block& block) const {
  const auto n = static_cast<std::size_t>(problem_.variables());
  const Pattern& pattern = problem_.jacobian_pattern();
  std::vector<std::vector<std::size_t>> of_row(problem_.constraints());
  for (std::size_t e = 0; e < pattern.size(); ++e) of_row[pattern.row[e]].push_back(e);
  for (std::size_t k = 0; k < block.rows.size(); ++k) {
    for (const std::size_t e : of_row[block.rows[k].row]) {
      block.entries.push_back({e, k * n + static_cast<std::size_t>(pattern.column[e]), block.rows[k].sign});
    }
  }
}

void Closeup::look(View view) {
  view_ = std::move(view);
  if (view_.multipliers.empty()) view_.multipliers = no_multipliers_;
  sort_rows();
  u_.clear();
  if (!view_.near) return;
  const std::vector<double> here(view_.base.size(), 0.0);
  const Evaluation& e = at(here.data());
  slope_at_base_ = slope_of(e);
  // NLopt's augmented Lagrangian takes its first penalty from the ratio of the objective to the squared gaps, up to 10.
  value_at_base_ = 1e-3;
  for (const SignedRow& row : equalities_.rows) {
    const double gap = (e.constraint[row.row] - row.bound) / view_.unit;
    value_at_base_ += 5 * gap * gap;
  }
}

std::vector<double> Closeup::place(const double* u) const {
  std::vector<double> x = view_.base;
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += view_.unit * u[i];
  return x;
}

const Evaluation& Closeup::at(const double* u) {
  if (!u_.empty() && std::equal(u_.begin(), u_.end(), u)) return at_;
  u_.assign(u, u + problem_.variables());
  at_.x = place(u);
  problem_.evaluate(at_);
  ++evaluations_;
  return at_;
}

const std::vector<double>& Closeup::slope_of(const Evaluation& e) {
  unbalanced(problem_, e, view_.multipliers, slope_);
  for (double& s : slope_) s *= view_.scale / view_.unit;
  return slope_;
}

double Closeup::objective(const double* u, double* gradient) {
  const Evaluation& e = at(u);
  double value = 0.0;
  if (view_.near || gradient != nullptr) slope_of(e);
  if (gradient != nullptr) std::copy(slope_.begin(), slope_.end(), gradient);
  if (view_.near) {
    value = value_at_base_;
    for (std::size_t i = 0; i < slope_.size(); ++i) value += 0.5 * (slope_[i] + slope_at_base_[i]) * u[i];
  } else {
    value = e.objective;
    for (int r = 0; r < problem_.equalities(); ++r) value += view_.multipliers[r] * e.constraint[r];
    value *= view_.scale;
  }
  return std::isnan(value) ? std::numeric_limits<double>::infinity() : value;
}

void Closeup::constraints(const Block& block, const double* u, double* values, double* jacobian) {
  const Evaluation& e = at(u);
  for (std::size_t k = 0; k < block.rows.size(); ++k) {
    const SignedRow& row = block.rows[k];
    values[k] = row.sign * (e.constraint[row.row] - row.bound) / view_.unit;
  }
  if (jacobian == nullptr) return;
  std::fill(jacobian, jacobian + block.rows.size() * u_.size(), 0.0);
  for (const Block::Entry& entry : block.entries) jacobian[entry.target] = entry.sign * e.jacobian[entry.source];
}

}  // namespace poise::solvers
