#include "design/goals/goal_evaluation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "model/gas_struts.hpp"
#include "model/input_error.hpp"
#include "statics/sensitivity/sensitivity.hpp"

namespace poise {
namespace {

using Asked = SoughtQuantity::Kind;

constexpr double nothing_beside = 1e-3;  // parts of the mechanism's forces, lengths and work: the size of a goal of 0
constexpr double balanced = 1e-6;        // of the size of a goal: the force in an equilibrium
constexpr double clearly = 1e-6;         // of those: a force that is not zero

bool is_of_range(Asked kind) {
  return kind == Asked::maximum || kind == Asked::minimum || kind == Asked::span || kind == Asked::mean;
}

/// Weights w of values at ascending or descending places x for which  sum w y  is the integral over |dx| of the curve
/// of third order through each four neighbours: exact for cubics.
std::vector<double> weights_of_integral(const std::vector<double>& x) {
  const std::size_t n = x.size();
  std::vector<double> out(n, 0.0);
  for (std::size_t k = 0; k + 1 < n; ++k) {
    const std::size_t count = std::min<std::size_t>(4, n);
    const std::size_t first = std::min(k > 0 ? k - 1 : 0, n - count);
    // Gauss' rule of two points integrates cubics exactly.
    for (const double sign : {-1.0, 1.0}) {
      const double at = 0.5 * (x[k] + x[k + 1]) + sign * 0.5 * (x[k + 1] - x[k]) / std::sqrt(3.0);
      for (std::size_t i = first; i < first + count; ++i) {
        double weight = 0.5 * std::abs(x[k + 1] - x[k]);
        for (std::size_t j = first; j < first + count; ++j) {
          if (j != i) weight *= (at - x[j]) / (x[i] - x[j]);
        }
        out[i] += weight;
      }
    }
  }
  return out;
}

GoalTerm combined(Asked kind, const GoalTerm& a, const GoalTerm& b) {
  GoalTerm out{a.at, 0.0, {}};
  switch (kind) {
    case Asked::sum:
      out.value = a.value + b.value;
      out.by = a.by + b.by;
      break;
    case Asked::difference:
      out.value = a.value - b.value;
      out.by = a.by - b.by;
      break;
    case Asked::product:
      out.value = a.value * b.value;
      out.by = a.by * b.value + a.value * b.by;
      break;
    default:
      out.value = a.value / b.value;
      out.by = (a.by - out.value * b.by) / b.value;
  }
  return out;
}

}  // namespace

GoalEvaluation::GoalEvaluation(const GoalProblem& problem)
    : problem_(&problem),
      asked_(problem.sweeps.size()),
      goals_(problem.goals.size()),
      lengths_(problem.sweeps.size()),
      values_(problem.sweeps.size()),
      corrections_(problem.goals.size(), 0.0),
      tighter_(problem.goals.size()) {
  for (std::size_t k = 0; k < problem.goals.size(); ++k) {
    const DesignGoal& goal = problem.goals[k];
    if (goal.kind == DesignGoal::Kind::passes || goal.of.kind == Asked::load_at_fold) continue;
    ask_inner(goal.sweep, goal.of, goals_[k]);
  }
  for (std::size_t s = 0; s < problem.sweeps.size(); ++s) {
    for (const Catalogue& catalogue : problem.catalogues) {
      for (const SoughtQuantity& length : catalogue.lengths) lengths_[s].push_back(ask(static_cast<int>(s), length));
    }
    sweeps_.emplace_back(problem, static_cast<int>(s), asked_[s]);
  }
  may_contradict_ = !problem.ties.empty() ||
                    std::any_of(problem.variables.begin(), problem.variables.end(), [](const ChosenNumber& one) {
                      return one.row.place.owner == Owner::stop || one.row.place.owner == Owner::number;
                    });
  const Scales scales = StaticModel(problem.scene).scales();
  for (const DesignGoal& goal : problem.goals) {
    const double natural = nothing_beside / goal.of.dimension.per_scale(scales);
    sizes_.push_back(std::max(goal.size(), natural));
  }
}

int GoalEvaluation::ask(int sweep, const SoughtQuantity& of) {
  std::vector<SoughtQuantity>& asked = asked_[static_cast<std::size_t>(sweep)];
  for (std::size_t k = 0; k < asked.size(); ++k) {
    if (asked[k].name == of.name) return static_cast<int>(k);
  }
  asked.push_back(of);
  return static_cast<int>(asked.size()) - 1;
}

void GoalEvaluation::ask_inner(int sweep, const SoughtQuantity& of, OfGoal& out) {
  if (is_of_range(of.kind)) {
    out.asked.push_back(ask(sweep, of.of[0]));
  } else if (of.is_over_path()) {
    for (const SoughtQuantity& part : of.of) ask_inner(sweep, part, out);
  } else if (of.kind != Asked::number) {
    out.asked.push_back(ask(sweep, of));
  }
}

void GoalEvaluation::set_interrupt(const std::atomic<bool>* interrupt) {
  for (SweepPositions& sweep : sweeps_) sweep.set_interrupt(interrupt);
}

void GoalEvaluation::forget() {
  for (SweepPositions& sweep : sweeps_) sweep.forget();
}

int GoalEvaluation::blocking_element() const {
  for (const SweepPositions& sweep : sweeps_) {
    const int stop = sweep.blocking_stop();
    if (stop >= 0 && stop < static_cast<int>(problem_->scene.stops.size())) {
      return strut_of(problem_->scene, problem_->scene.stops[static_cast<std::size_t>(stop)]);
    }
  }
  return -1;
}

EvaluationCounts GoalEvaluation::counts() const {
  EvaluationCounts out;
  for (const SweepPositions& sweep : sweeps_) {
    out.evaluations += sweep.counts().evaluations;
    out.followed += sweep.counts().followed;
    out.paths += sweep.counts().paths;
  }
  return out;
}

GoalTerm GoalEvaluation::term_at(std::size_t sweep, std::size_t k, Eigen::Index asked) const {
  const SweepValues& values = values_[sweep];
  const auto variables = static_cast<Eigen::Index>(problem_->variables.size());
  return {sweeps_[sweep].at()[k], values.value(static_cast<Eigen::Index>(k), asked),
          values.by.empty() ? Eigen::RowVectorXd::Zero(variables).eval() : Eigen::RowVectorXd(values.by[k].row(asked))};
}

GoalTerm GoalEvaluation::extreme_over(const DesignGoal& goal, Asked kind, int asked) const {
  const auto s = static_cast<std::size_t>(goal.sweep);
  const auto q = static_cast<Eigen::Index>(asked);
  const std::vector<double>& at = sweeps_[s].at();
  GoalTerm most, least;
  bool is_first = true;
  for (std::size_t k = 0; k < at.size(); ++k) {
    if (!goal.covers(at[k])) continue;
    const GoalTerm here = term_at(s, k, q);
    if (is_first || here.value > most.value) most = here;
    if (is_first || here.value < least.value) least = here;
    is_first = false;
  }
  if (kind == Asked::maximum) return most;
  return kind == Asked::minimum ? least : combined(Asked::difference, most, least);
}

GoalTerm GoalEvaluation::mean_over(const DesignGoal& goal, int asked) const {
  const auto s = static_cast<std::size_t>(goal.sweep);
  std::vector<GoalTerm> terms;
  std::vector<double> places;
  for (std::size_t k = 0; k < sweeps_[s].at().size(); ++k) {
    if (!goal.covers(sweeps_[s].at()[k])) continue;
    terms.push_back(term_at(s, k, static_cast<Eigen::Index>(asked)));
    places.push_back(terms.back().at);
  }
  const std::vector<double> weights = weights_of_integral(places);
  GoalTerm out{goal.first, 0.0, Eigen::RowVectorXd::Zero(terms.front().by.size())};
  for (std::size_t k = 0; k < terms.size(); ++k) {
    const double part = weights[k] / std::abs(places.back() - places.front());
    out.value += part * terms[k].value;
    out.by += part * terms[k].by;
  }
  return out;
}

/// The value over a range of an expression of extremes and means.
GoalTerm GoalEvaluation::over_range(const DesignGoal& goal, const SoughtQuantity& of, const std::vector<int>& asked,
                                    std::size_t& next) const {
  const auto variables = static_cast<Eigen::Index>(problem_->variables.size());
  if (of.kind == Asked::number) return {goal.first, of.constant, Eigen::RowVectorXd::Zero(variables)};
  if (of.kind == Asked::mean) return mean_over(goal, asked[next++]);
  if (is_of_range(of.kind)) return extreme_over(goal, of.kind, asked[next++]);
  const GoalTerm a = over_range(goal, of.of[0], asked, next);
  const GoalTerm b = over_range(goal, of.of[1], asked, next);
  return combined(of.kind, a, b);
}

bool GoalEvaluation::put_fold(std::size_t goal, const DesignPoint& point, bool with_derivatives, GoalValues& out) {
  const DesignGoal& of = problem_->goals[goal];
  const StaticModel model(scene_at(*problem_, point));
  const Sensitivities found = sensitivities(model, {of.of});
  if (found.of.empty() || !found.of[0].why.empty() || !std::isfinite(found.of[0].value)) {
    why_ = of.name + ": " + (found.of.empty() ? found.why : found.of[0].why);
    return false;
  }
  const auto variables = static_cast<Eigen::Index>(problem_->variables.size());
  GoalTerm term{0.0, found.of[0].value, Eigen::RowVectorXd::Zero(variables)};
  const auto derivative = [&](const std::string& path) {
    for (const Sensitivity& one : found.of[0].by) {
      if (one.number == path && one.why.empty()) return one.derivative;
    }
    return 0.0;
  };
  if (with_derivatives) {
    for (Eigen::Index k = 0; k < variables; ++k) {
      const ChosenNumber& one = problem_->variables[static_cast<std::size_t>(k)];
      term.by[k] = derivative(one.path) * (one.to - one.from);
    }
    for (std::size_t t = 0; t < problem_->ties.size(); ++t) {
      const double by_tie = derivative(problem_->ties[t].path);
      for (const auto& [k, slope] : slopes_of_tie(*problem_, point, t)) term.by[k] += by_tie * slope;
    }
  }
  out.terms[goal] = {std::move(term)};
  return true;
}

bool GoalEvaluation::put_terms(std::size_t goal, const DesignPoint& point, bool with_derivatives, GoalValues& out) {
  const DesignGoal& of = problem_->goals[goal];
  if (of.kind == DesignGoal::Kind::passes) return true;
  if (of.of.kind == Asked::load_at_fold) return put_fold(goal, point, with_derivatives, out);
  const auto s = static_cast<std::size_t>(of.sweep);
  std::vector<GoalTerm>& terms = out.terms[goal];
  if (of.of.is_over_path()) {
    std::size_t next = 0;
    terms = {over_range(of, of.of, goals_[goal].asked, next)};
    terms[0].value += corrections_[goal];
  } else {
    const auto q = static_cast<Eigen::Index>(goals_[goal].asked[0]);
    const std::vector<double>& at = sweeps_[s].at();
    const bool has_both_sides = of.kind == DesignGoal::Kind::stable || of.kind == DesignGoal::Kind::unstable;
    for (std::size_t k = 0; k < at.size(); ++k) {
      if (!has_both_sides && !of.covers(at[k])) continue;
      terms.push_back(term_at(s, k, q));
    }
  }
  for (const GoalTerm& term : terms) {
    if (std::isfinite(term.value) && (!with_derivatives || term.by.allFinite())) continue;
    why_ = of.name + " has no value at all positions";
    return false;
  }
  return true;
}

/// That of the nearest position.
double GoalEvaluation::tightened_at(std::size_t goal, double at) const {
  double out = 0.0, nearest = std::numeric_limits<double>::infinity();
  for (const auto& [place, amount] : tighter_[goal]) {
    if (std::abs(place - at) < nearest) out = amount;
    nearest = std::min(nearest, std::abs(place - at));
  }
  return out;
}

void GoalEvaluation::put_limits(std::size_t goal, const std::vector<GoalTerm>& terms, GoalValues& out) const {
  const DesignGoal& of = problem_->goals[goal];
  const double size = sizes_[goal];
  const int index = static_cast<int>(goal);
  for (const GoalTerm& term : terms) {
    const double tighter = tightened_at(goal, term.at);
    if (!of.curve.empty()) {
      const double off = term.value - of.wanted_at(term.at);
      out.limits.push_back({index, term.at, (off - of.within + tighter) / size, term.by / size, false});
      out.limits.push_back({index, term.at, (-off - of.within + tighter) / size, -term.by / size, false});
      continue;
    }
    if (of.is_equation) {
      out.limits.push_back({index, term.at, (term.value - *of.least) / size, term.by / size, true});
      continue;
    }
    if (of.least) {
      out.limits.push_back({index, term.at, (*of.least - term.value + tighter) / size, -term.by / size, false});
    }
    if (of.most)
      out.limits.push_back({index, term.at, (term.value - *of.most + tighter) / size, term.by / size, false});
  }
}

/// The force that would hold the driven measure vanishes there, and changes its sign as stability wants it; where there
/// is to be no equilibrium it has one sign all over the range.
void GoalEvaluation::put_equilibrium(std::size_t goal, const std::vector<GoalTerm>& terms, GoalValues& out) const {
  const DesignGoal& of = problem_->goals[goal];
  const double size = sizes_[goal];
  const int index = static_cast<int>(goal);
  const auto require = [&](const GoalTerm& term, double sign) {
    out.limits.push_back(
        {index, term.at, clearly / nothing_beside - sign * term.value / size, -sign * term.by / size, false});
  };
  if (of.kind == DesignGoal::Kind::none) {
    double sum = 0.0;
    for (const GoalTerm& term : terms) sum += term.value;
    for (const GoalTerm& term : terms) require(term, sum < 0.0 ? -1.0 : 1.0);
    return;
  }
  const double middle = of.at[0], sense = of.kind == DesignGoal::Kind::stable ? 1.0 : -1.0;
  const GoalTerm *before = nullptr, *after = nullptr;
  for (const GoalTerm& term : terms) {
    if (term.at < middle && !of.covers(term.at) && (before == nullptr || term.at > before->at)) before = &term;
    if (term.at > middle && !of.covers(term.at) && (after == nullptr || term.at < after->at)) after = &term;
    if (of.covers(term.at) && of.at_stop != 0) {
      // The stop holds what presses on it: the drive would have to pull it off.
      require(term, of.at_stop > 0 ? -1.0 : 1.0);
      continue;
    }
    // Certificates judge the equilibrium itself; the force there is a difference of larger ones.
    if (of.covers(term.at)) out.limits.push_back({index, term.at, term.value / size, term.by / size, true, balanced});
  }
  if (before != nullptr && of.at_stop == 0) require(*before, -sense);
  if (after != nullptr && of.at_stop == 0) require(*after, sense);
}

void GoalEvaluation::put_lengths(const DesignPoint& point, GoalValues& out) const {
  for (std::size_t s = 0; s < sweeps_.size(); ++s) {
    std::size_t next = 0;
    for (std::size_t c = 0; c < problem_->catalogues.size(); ++c) {
      const Catalogue& catalogue = problem_->catalogues[c];
      const Catalogue::Row& row = catalogue.rows[static_cast<std::size_t>(point.rows[c])];
      for (std::size_t i = 0; i < catalogue.lengths.size(); ++i) {
        const auto q = static_cast<Eigen::Index>(lengths_[s][next++]);
        for (std::size_t k = 0; k < sweeps_[s].at().size(); ++k) {
          const double length = values_[s].value(static_cast<Eigen::Index>(k), q);
          const Eigen::RowVectorXd by =
              values_[s].by.empty() ? Eigen::RowVectorXd() : Eigen::RowVectorXd(values_[s].by[k].row(q));
          const double at = sweeps_[s].at()[k];
          if (row.shortest > 0.0) {
            out.limits.push_back({-1, at, (row.shortest - length) / row.shortest, -by / row.shortest, false});
          }
          if (std::isfinite(row.longest)) {
            out.limits.push_back({-1, at, (length - row.longest) / row.longest, by / row.longest, false});
          }
        }
      }
    }
  }
}

bool GoalEvaluation::evaluate(const DesignPoint& point, bool with_derivatives, GoalValues& out) {
  out.limits.clear();
  out.aims.clear();
  out.terms.assign(problem_->goals.size(), {});
  try {
    if (may_contradict_) scene_at(*problem_, point);
    for (std::size_t s = 0; s < sweeps_.size(); ++s) {
      if (asked_[s].empty() && problem_->sweeps[s].along.empty()) continue;  // of loads at folds alone
      if (!sweeps_[s].evaluate(point, with_derivatives, values_[s], why_)) return false;
    }
    put_lengths(point, out);
    for (std::size_t k = 0; k < problem_->goals.size(); ++k) {
      const DesignGoal& goal = problem_->goals[k];
      if (!put_terms(k, point, with_derivatives, out)) return false;
      if (goal.kind == DesignGoal::Kind::passes) continue;
      if (!goal.is_limit()) {
        GoalAim aim{static_cast<int>(k), out.terms[k]};
        const double sign = goal.aim == DesignGoal::Aim::greatest ? -1.0 : 1.0;
        for (GoalTerm& term : aim.terms) {
          if (goal.aim == DesignGoal::Aim::curve) term.value -= goal.wanted_at(term.at);
          term.value *= sign / sizes_[k];
          term.by *= sign / sizes_[k];
        }
        out.aims.push_back(std::move(aim));
        continue;
      }
      if (goal.kind == DesignGoal::Kind::quantity) {
        put_limits(k, out.terms[k], out);
      } else {
        put_equilibrium(k, out.terms[k], out);
      }
    }
  } catch (const InputError& error) {
    why_ = error.what();
    return false;
  }
  return true;
}

}  // namespace poise
