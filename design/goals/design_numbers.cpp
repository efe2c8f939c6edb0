#include "design/goals/design_numbers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "model/dependent_number.hpp"

namespace poise {
namespace {

double value_of(const ChosenNumber& one, double part) {
  return part == 0.0 ? one.from : part == 1.0 ? one.to : one.from + part * (one.to - one.from);
}

/// Values of the variables in the units of the scene, by which ties are expressed.
std::vector<double> shown_values(const GoalProblem& problem, const DesignPoint& point) {
  std::vector<double> out;
  for (std::size_t k = 0; k < problem.variables.size(); ++k) {
    const ChosenNumber& one = problem.variables[k];
    out.push_back(value_of(one, point.parts[static_cast<Eigen::Index>(k)]) /
                  one.row.dimension.unit(problem.scene.units));
  }
  return out;
}

/// Forces whose direction follows from named numbers, so that both components count.
std::vector<int> forces_that_follow(const Scene& scene) {
  std::vector<int> out;
  if (!scene.dependents) return out;
  for (const DependentNumber& one : *scene.dependents) {
    if (one.at.of == DependentPlace::Of::force) out.push_back(one.at.place.item);
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

}  // namespace

std::vector<ChosenValue> chosen_values(const GoalProblem& problem, const DesignPoint& point) {
  std::vector<ChosenValue> out;
  for (std::size_t k = 0; k < problem.variables.size(); ++k) {
    const ChosenNumber& one = problem.variables[k];
    out.push_back({&one.row, value_of(one, point.parts[static_cast<Eigen::Index>(k)])});
  }
  if (!problem.ties.empty()) {
    const std::vector<double> shown = shown_values(problem, point);
    for (const TiedNumber& tie : problem.ties) {
      out.push_back({&tie.row, tie.of.value(shown) * tie.row.dimension.unit(problem.scene.units)});
    }
  }
  for (std::size_t c = 0; c < problem.catalogues.size(); ++c) {
    const Catalogue& catalogue = problem.catalogues[c];
    const Catalogue::Row& row = catalogue.rows[static_cast<std::size_t>(point.rows[c])];
    for (std::size_t i = 0; i < catalogue.numbers.size(); ++i) out.push_back({&catalogue.numbers[i], row.values[i]});
  }
  return out;
}

std::vector<std::pair<int, double>> slopes_of_tie(const GoalProblem& problem, const DesignPoint& point,
                                                  std::size_t tie) {
  const TiedNumber& of = problem.ties[tie];
  const Units& units = problem.scene.units;
  const std::vector<double> shown = shown_values(problem, point);
  std::vector<std::pair<int, double>> out;
  for (const int k : of.of.uses()) {
    const ChosenNumber& one = problem.variables[static_cast<std::size_t>(k)];
    std::vector<double> along(shown.size(), 0.0);
    along[static_cast<std::size_t>(k)] = (one.to - one.from) / one.row.dimension.unit(units);
    const double slope = of.of.slope(shown, along) * of.row.dimension.unit(units);
    if (std::isfinite(slope)) out.emplace_back(k, slope);
  }
  return out;
}

Scene scene_at(const GoalProblem& problem, const DesignPoint& point) {
  Scene out = problem.scene;
  std::vector<ChosenValue> left = chosen_values(problem, point);
  for (const ChosenValue& one : left) {
    if (std::isfinite(one.value) && contains(one.row->range, one.value)) continue;
    throw InputError(one.row->path.text() + ": " +
                     out_of_range(one.row->range, one.value / one.row->dimension.unit(problem.scene.units)));
  }
  // Limits of a stop contradict each other in one order and not in the other: what cannot be set is set after others.
  while (!left.empty()) {
    std::vector<ChosenValue> later;
    std::string why;
    for (const ChosenValue& one : left) {
      try {
        set_value_at(out, one.row->place, one.value);
      } catch (const InputError& error) {
        later.push_back(one);
        why = one.row->path.text() + ": " + error.what();
      }
    }
    if (later.size() == left.size()) throw InputError(why);
    left = std::move(later);
  }
  return out;
}

DesignPoint own_point(const GoalProblem& problem) {
  DesignPoint out{Eigen::VectorXd(static_cast<Eigen::Index>(problem.variables.size())), {}};
  for (std::size_t k = 0; k < problem.variables.size(); ++k) {
    const ChosenNumber& one = problem.variables[k];
    const double own = value_at(problem.scene, one.row.place).value_or(one.from);
    out.parts[static_cast<Eigen::Index>(k)] = std::clamp((own - one.from) / (one.to - one.from), 0.0, 1.0);
  }
  for (const Catalogue& catalogue : problem.catalogues) {
    int best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t r = 0; r < catalogue.rows.size(); ++r) {
      double apart = 0.0;
      for (std::size_t i = 0; i < catalogue.numbers.size(); ++i) {
        const double own = value_at(problem.scene, catalogue.numbers[i].place).value_or(0.0);
        const double value = catalogue.rows[r].values[i];
        apart = std::max(apart, std::abs(value - own) / std::max({std::abs(own), std::abs(value), 1e-300}));
      }
      if (apart < least) best = static_cast<int>(r);
      least = std::min(least, apart);
    }
    out.rows.push_back(best);
  }
  return out;
}

DesignNumbers::DesignNumbers(const GoalProblem& problem, const Scene& scene, const Scales& scales)
    : problem_(&problem),
      scales_(scales),
      list_(std::make_shared<const NumberList>(scaled(scene, scales), forces_that_follow(scene))) {
  for (const ChosenValue& one : chosen_values(problem, own_point(problem))) {
    rows_.push_back(list_->row(one.row->place));
  }
}

std::vector<double> DesignNumbers::at(const DesignPoint& point) const {
  std::vector<double> p = list_->values();
  const std::vector<ChosenValue> chosen = chosen_values(*problem_, point);
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    p[static_cast<std::size_t>(rows_[k])] = chosen[k].value * chosen[k].row->dimension.per_scale(scales_);
  }
  return p;
}

DesignNumbers::Slopes DesignNumbers::slopes(const DesignPoint& point, const std::vector<double>& p) const {
  const std::size_t variables = problem_->variables.size();
  Slopes out(variables);
  const auto add = [&](std::size_t k, int row, double slope) {
    if (slope == 0.0) return;
    out[k].emplace_back(row, slope);
    for (const auto& [place, by] : list_->followers(row, p)) out[k].emplace_back(place, by * slope);
  };
  for (std::size_t k = 0; k < variables; ++k) {
    const ChosenNumber& one = problem_->variables[k];
    add(k, rows_[k], (one.to - one.from) * one.row.dimension.per_scale(scales_));
  }
  for (std::size_t t = 0; t < problem_->ties.size(); ++t) {
    const double unit = problem_->ties[t].row.dimension.per_scale(scales_);
    for (const auto& [k, slope] : slopes_of_tie(*problem_, point, t)) {
      add(static_cast<std::size_t>(k), rows_[variables + t], slope * unit);
    }
  }
  return out;
}

}  // namespace poise
