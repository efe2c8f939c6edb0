#include "design/goals/design_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <utility>

#include <fmt/format.h>

#include "design/goals/private/local_search.hpp"
#include "design/goals/private/robust_goals.hpp"
#include "model/input_error.hpp"
#include "solvers/parallel.hpp"
#include "solvers/random_stream.hpp"

namespace poise {
namespace {

constexpr int starts_at_once =
    8;  // of a batch, whose results are looked at together: the same for any number of threads
constexpr int draws_of_start = 5;
constexpr int most_rounds = 12;    // of checks that bring new positions
constexpr double same_aim = 1e-6;  // relative
constexpr int stale_batches = 2;   // without a better aim
constexpr int most_confirmed = 6;  // ends that are checked

/// The rows that a number of all combinations stands for.
std::vector<int> rows_of(const GoalProblem& problem, long combination) {
  std::vector<int> out;
  for (const Catalogue& one : problem.catalogues) {
    const auto count = static_cast<long>(one.rows.size());
    out.push_back(static_cast<int>(combination % count));
    combination /= count;
  }
  return out;
}

/// Ends that are as good stay in their order.
void sort_best_first(std::vector<LocalEnd>& ends) {
  std::stable_sort(ends.begin(), ends.end(),
                   [](const LocalEnd& a, const LocalEnd& b) { return a.is_better_than(b, 0.0); });
}

class DesignSearch {
 public:
  DesignSearch(const GoalProblem& problem, const GoalSearchOptions& options)
      : problem_(problem),
        options_(options),
        tightened_(problem.goals.size()),
        corrections_(problem.goals.size(), 0.0) {}

  GoalDesign run();

 private:
  bool is_interrupted() const { return options_.interrupt != nullptr && options_.interrupt->load(); }
  void say(const std::string& what) const {
    if (options_.progress) options_.progress(what);
  }
  bool has_aims() const {
    return std::any_of(problem_.goals.begin(), problem_.goals.end(), [](const DesignGoal& g) { return !g.is_limit(); });
  }
  GoalEvaluation evaluation() const {
    GoalEvaluation out(problem_);
    out.set_interrupt(options_.interrupt);
    out.tighten(tightened_);
    out.correct(corrections_);
    return out;
  }
  DesignPoint start_of(int index) const;
  LocalEnd search_from(const GoalProblem& problem, GoalEvaluation& evaluation, const DesignPoint& from,
                       bool with_aims = true) const;
  LocalEnd search_from_start(int index);
  void count(const EvaluationCounts& more);
  void search_starts();
  bool confirm(LocalEnd end);
  void confirm_ends();
  bool add_positions(const LocalEnd& end, const GoalCheck& check);
  bool correct_ranges(const LocalEnd& end, const GoalCheck& check);
  bool make_robust(LocalEnd& end);
  void search_rows();
  void try_all_rows();
  std::vector<std::vector<char>> blocked_rows();
  void find_conflict();
  bool can_meet(const std::vector<int>& kept);
  void find_active();
  void trade_off();
  void finish();
  void check_tolerances();

  GoalProblem problem_;  // with the positions that checks have brought
  GoalSearchOptions options_;
  GoalEvaluation::Tightening tightened_;
  std::vector<double> corrections_;
  GoalDesign out_;
  LocalEnd best_;
  std::vector<LocalEnd> ends_;
  int least_again_ = 0;  // searches that end at the best one's miss
  std::mutex mutex_;
};

void DesignSearch::count(const EvaluationCounts& more) {
  const std::lock_guard lock(mutex_);
  out_.counts.evaluations += more.evaluations;
  out_.counts.followed += more.followed;
  out_.counts.paths += more.paths;
}

DesignPoint DesignSearch::start_of(int index) const {
  DesignPoint out = own_point(problem_);
  if (index == 0) return out;
  solvers::RandomStream random(options_.seed, 0, static_cast<std::uint64_t>(index));
  for (Eigen::Index k = 0; k < out.parts.size(); ++k) out.parts[k] = random.uniform();
  return out;
}

/// A local search, whose end counts where the path that begins at the scene's start comes to the same positions: those
/// that were followed while numbers changed may be of another equilibrium. From there it goes on otherwise.
LocalEnd DesignSearch::search_from(const GoalProblem& problem, GoalEvaluation& evaluation, const DesignPoint& from,
                                   bool with_aims) const {
  constexpr int most = 3;
  LocalEnd end = local_search(problem, evaluation, from, {options_.method, options_.interrupt, {}, with_aims});
  for (int round = 0; end.keeps && !is_interrupted(); ++round) {
    evaluation.forget();
    LocalEnd anew = values_at(problem, evaluation, end.point);
    if (anew.keeps) break;
    if (!anew.has_values || round + 1 == most) return anew;
    end = local_search(problem, evaluation, anew.point, {options_.method, options_.interrupt, {}, with_aims});
  }
  return end;
}

/// The scene's own numbers are the first start; of the others each takes the first of some draws that has values.
LocalEnd DesignSearch::search_from_start(int index) {
  GoalEvaluation evaluation = this->evaluation();
  LocalEnd out;
  for (int draw = 0; draw < (index == 0 ? 1 : draws_of_start) && !is_interrupted(); ++draw) {
    const DesignPoint from = start_of(index == 0 ? 0 : index + draw * 1'000'003);
    out = search_from(problem_, evaluation, from);
    if (out.has_values) break;
  }
  out.index = index;
  count(evaluation.counts());
  return out;
}

void DesignSearch::search_starts() {
  int stale = 0, confirmed = 0;
  for (int first = 0; first < options_.starts && !is_interrupted(); first += starts_at_once) {
    const int count = first == 0 ? 1 : std::min(starts_at_once, options_.starts - first);
    std::vector<LocalEnd> ends(static_cast<std::size_t>(count));
    solvers::parallel_for(ends.size(), {options_.jobs, options_.interrupt, {}},
                          [&](std::size_t k) { ends[k] = search_from_start(first + static_cast<int>(k)); });
    if (first == 0) first = 1 - starts_at_once;
    bool is_better = false;
    for (LocalEnd& end : ends) {
      ++out_.starts;
      if (!end.has_values) continue;
      if (end.keeps) ++out_.met_starts;
      constexpr double same_miss = 1e-6;
      if (!end.keeps && best_.has_values && end.missed >= best_.missed * (1.0 - same_miss) &&
          end.missed <= best_.missed * (1.0 + same_miss)) {
        ++least_again_;
      } else if (end.is_better_than(best_, 0.0)) {
        least_again_ = 0;
      }
      if (end.is_better_than(best_, same_aim)) {
        is_better = true;
        best_ = end;
        out_.best_again = 0;
      }
      if (end.keeps && !best_.is_better_than(end, same_aim)) ++out_.best_again;
      ends_.push_back(std::move(end));
    }
    constexpr int fruitless = 3 * starts_at_once;
    if (!best_.has_values && out_.starts > fruitless) return;   // nothing that is chosen lets it be assembled
    if (!best_.keeps && least_again_ >= starts_at_once) break;  // the same least miss from many starts
    say(fmt::format("{} of {} starts, missed {:.3g}", out_.starts, options_.starts, std::sqrt(best_.missed)));
    stale = is_better ? 0 : stale + 1;
    if (!best_.keeps || (has_aims() && stale < stale_batches)) continue;
    // The best of those that the check has not refused yet.
    sort_best_first(ends_);
    while (!ends_.empty() && ends_.front().keeps && confirmed < most_confirmed && !is_interrupted()) {
      const LocalEnd end = ends_.front();
      ends_.erase(ends_.begin());
      ++confirmed;
      if (confirm(end)) return;
    }
    if (confirmed >= most_confirmed) return;
    best_ = ends_.empty() ? LocalEnd{} : ends_.front();
  }
  // What is left where aims were still rising, or nothing keeps all limits.
  sort_best_first(ends_);
  while (!ends_.empty() && confirmed < most_confirmed) {
    const LocalEnd end = ends_.front();
    ends_.erase(ends_.begin());
    ++confirmed;
    if (confirm(end) || !end.keeps) return;
  }
}

/// Positions at which limits are missed between those that the search has looked at; false where there is none.
bool DesignSearch::add_positions(const LocalEnd& end, const GoalCheck& check) {
  bool any = correct_ranges(end, check);
  for (std::size_t k = 0; k < problem_.goals.size(); ++k) {
    const DesignGoal& goal = problem_.goals[k];
    const CheckedGoal& found = check.goals[k];
    if (!goal.is_range || !found.has_value) continue;
    if (found.met && goal.is_limit()) continue;
    std::vector<double>& at = problem_.sweeps[static_cast<std::size_t>(goal.sweep)].at;
    const double near = 1e-7 * std::abs(at.back() - at.front());
    std::vector<double> places = found.extremes;
    if (!goal.of.is_over_path()) places.insert(places.end(), {found.worst_at, found.least_at, found.most_at});
    for (const double place : places) {
      const bool is_new = std::none_of(at.begin(), at.end(), [&](double one) { return std::abs(one - place) <= near; });
      if (!is_new || !goal.covers(place)) continue;
      const bool falls = at.front() > at.back();
      at.insert(falls ? std::lower_bound(at.begin(), at.end(), place, std::greater<>())
                      : std::lower_bound(at.begin(), at.end(), place),
                place);
      any = true;
    }
  }
  return any;
}

/// What the positions miss of extremes and means over ranges.
bool DesignSearch::correct_ranges(const LocalEnd& end, const GoalCheck& check) {
  bool any = false;
  GoalEvaluation evaluation = this->evaluation();
  GoalValues values;
  if (!evaluation.evaluate(end.point, false, values)) return false;
  for (std::size_t k = 0; k < problem_.goals.size(); ++k) {
    const CheckedGoal& found = check.goals[k];
    if (!problem_.goals[k].is_range || !problem_.goals[k].of.is_over_path() || !found.has_value) continue;
    const double off = found.most - values.terms[k].front().value;
    // A correction that is out of date would hold the aims back, or mislead tolerances.
    constexpr double nothing = 1e-8;
    if (std::abs(off) <= nothing * evaluation.size_of(static_cast<int>(k))) continue;
    corrections_[k] += off;
    any = true;
  }
  return any;
}

/// Limits are tightened by what tolerances move their quantities by, to first order, until that no longer changes.
bool DesignSearch::make_robust(LocalEnd& end) {
  if (problem_.tolerances.empty()) return true;
  LocalEnd at = end;
  bool is_found = false;
  double before = 0.0;
  for (int round = 0; round < most_rounds && !is_interrupted(); ++round) {
    tightened_ = tightening(problem_, at.point, corrections_);
    if (tightened_.empty()) break;
    GoalEvaluation evaluation = this->evaluation();
    const LocalEnd here = values_at(problem_, evaluation, at.point);
    const int index = at.index;
    if (here.has_values && here.keeps) {
      // It keeps the limits as tightened there: the next search may still gain, since less is needed than before.
      const bool gains = !is_found || here.aim < before - same_aim * std::abs(before);
      if (!gains) break;
      end = here;
      end.index = index;
      is_found = true;
      before = here.aim;
    }
    at = local_search(problem_, evaluation, at.point, {options_.method, options_.interrupt, {}});
    at.index = index;
    count(evaluation.counts());
    if (!at.has_values) break;
  }
  if (is_found) return true;
  tightened_.assign(problem_.goals.size(), {});
  return false;
}

bool DesignSearch::confirm(LocalEnd end) {
  bool is_robust = true;
  tightened_.assign(problem_.goals.size(), {});
  for (int round = 0; round < most_rounds && !is_interrupted(); ++round) {
    say(fmt::format("checking what was found, round {}", round + 1));
    is_robust = !end.keeps || make_robust(end);
    GoalCheck check;
    std::optional<Scene> scene;
    try {
      scene = scene_at(problem_, end.point);
      check = check_goals(problem_, *scene, end.point.rows, options_.interrupt);
    } catch (const InputError& error) {
      out_.why = error.what();
      return false;
    }
    const bool is_kept = end.keeps && check.met && is_robust;
    if (is_kept || !out_.scene || !out_.check.met) {
      out_.point = end.point;
      out_.scene = std::move(scene);
      out_.check = check;
      out_.missed = std::sqrt(end.missed);
      out_.aims = end.aims;
    }
    const bool is_new = round + 1 < most_rounds && add_positions(end, check);
    if (!is_new || !end.keeps) return is_kept;
    // Aims too are judged by the places between positions, once more.
    GoalEvaluation evaluation = this->evaluation();
    const int index = end.index;
    const LocalEnd next = local_search(problem_, evaluation, end.point, {options_.method, options_.interrupt, {}});
    count(evaluation.counts());
    if (!next.has_values || (is_kept && !next.keeps)) return is_kept;
    end = next;
    end.index = index;
  }
  return out_.check.met && is_robust;
}

/// Checks the best ends of a search of rows until one is confirmed, or none of those left keeps all limits.
void DesignSearch::confirm_ends() {
  sort_best_first(ends_);
  if (!ends_.empty()) best_ = ends_.front();
  for (int k = 0; k < most_confirmed && k < static_cast<int>(ends_.size()) && !is_interrupted(); ++k) {
    const LocalEnd& end = ends_[static_cast<std::size_t>(k)];
    if (confirm(end) || !end.keeps) return;
  }
}

/// Of each catalogue the rows that block a path by their own stops, where poses follow from the drive and the numbers
/// of the rows alone.
std::vector<std::vector<char>> DesignSearch::blocked_rows() {
  std::vector<std::vector<char>> out;
  const DesignPoint own = own_point(problem_);
  // Numbers of anything but force elements might move the poses for all rows.
  bool are_forces = true;
  for (const Catalogue& one : problem_.catalogues) {
    for (const ParameterRow& row : one.numbers) are_forces = are_forces && row.place.owner == Owner::element;
  }
  for (std::size_t c = 0; c < problem_.catalogues.size(); ++c) {
    const Catalogue& catalogue = problem_.catalogues[c];
    GoalEvaluation evaluation = this->evaluation();
    GoalValues values;
    evaluation.evaluate(own, false, values);
    std::vector<char>& blocked = out.emplace_back(catalogue.rows.size(), 0);
    for (std::size_t r = 0; are_forces && r < catalogue.rows.size(); ++r) {
      DesignPoint point = own;
      point.rows[c] = static_cast<int>(r);
      if (evaluation.evaluate(point, false, values)) continue;
      const int element = evaluation.blocking_element();
      const bool is_own =
          element >= 0 && std::any_of(catalogue.numbers.begin(), catalogue.numbers.end(), [&](const ParameterRow& one) {
            return one.place.owner == Owner::element && one.place.item == element;
          });
      blocked[r] = is_own ? 1 : 0;
    }
    count(evaluation.counts());
  }
  return out;
}

/// Without other variables: all combinations, each evaluated.
void DesignSearch::try_all_rows() {
  constexpr long most = 200'000, chunk = 64;
  const double all = problem_.combinations();
  const long count = static_cast<long>(std::min(all, static_cast<double>(most)));
  const long chunks = (count + chunk - 1) / chunk;
  const std::vector<std::vector<char>> blocked = blocked_rows();
  std::vector<std::vector<LocalEnd>> best(static_cast<std::size_t>(chunks));
  std::vector<long> tried(static_cast<std::size_t>(chunks)), lengths(tried), proofs(tried);
  std::vector<int> kept(static_cast<std::size_t>(chunks));
  solvers::parallel_for(
      best.size(),
      {options_.jobs, options_.interrupt,
       [&](std::size_t done) { say(fmt::format("{} of {} combinations", static_cast<long>(done) * chunk, count)); }},
      [&](std::size_t c) {
        GoalEvaluation evaluation = this->evaluation();
        GoalValues values;
        evaluation.evaluate(own_point(problem_), false, values);  // from whose positions the others are found
        for (long k = static_cast<long>(c) * chunk; k < std::min(count, (static_cast<long>(c) + 1) * chunk); ++k) {
          // Evenly spread where there are too many.
          const double combination = std::floor(static_cast<double>(k) * (all / static_cast<double>(count)));
          const DesignPoint point{Eigen::VectorXd(), rows_of(problem_, static_cast<long>(combination))};
          bool is_blocked = false;
          for (std::size_t i = 0; i < point.rows.size(); ++i) {
            is_blocked = is_blocked || blocked[i][static_cast<std::size_t>(point.rows[i])] != 0;
          }
          if (is_blocked) {
            ++proofs[c];
            continue;
          }
          LocalEnd end = values_at(problem_, evaluation, point);
          end.index = static_cast<int>(k);
          ++(end.misses_length ? lengths : tried)[c];
          if (!end.has_values) continue;
          if (end.keeps) ++kept[c];
          best[c].push_back(std::move(end));
          sort_best_first(best[c]);
          if (best[c].size() > most_confirmed) best[c].pop_back();
        }
        this->count(evaluation.counts());
      });
  for (std::size_t c = 0; c < best.size(); ++c) {
    out_.catalogue.tried += tried[c];
    out_.catalogue.by_length += lengths[c];
    out_.catalogue.by_proof += proofs[c];
    out_.met_starts += kept[c];
    for (LocalEnd& end : best[c]) ends_.push_back(std::move(end));
  }
  out_.catalogue.left = static_cast<long>(problem_.combinations()) - out_.catalogue.tried - out_.catalogue.by_length -
                        out_.catalogue.by_proof;
  confirm_ends();
}

/// With other variables: combinations in the order of what they miss at the scene's own numbers, each searched.
void DesignSearch::search_rows() {
  if (problem_.variables.empty()) {
    try_all_rows();
    return;
  }
  constexpr long most_ranked = 4096;
  const double all = problem_.combinations();
  const long ranked = static_cast<long>(std::min(all, static_cast<double>(most_ranked)));
  std::vector<LocalEnd> ranks(static_cast<std::size_t>(ranked));
  solvers::parallel_for(ranks.size(), {options_.jobs, options_.interrupt, {}}, [&](std::size_t k) {
    GoalEvaluation evaluation = this->evaluation();
    // Evenly spread where there are too many.
    const double combination = static_cast<double>(k) * (all / static_cast<double>(ranked));
    ranks[k] =
        values_at(problem_, evaluation, {own_point(problem_).parts, rows_of(problem_, static_cast<long>(combination))});
    ranks[k].index = static_cast<int>(k);
    count(evaluation.counts());
  });
  sort_best_first(ranks);
  const std::size_t tried = std::min(ranks.size(), static_cast<std::size_t>(std::max(options_.starts, 1)));
  for (std::size_t first = 0; first < tried && !is_interrupted(); first += starts_at_once) {
    const std::size_t count_here = std::min(static_cast<std::size_t>(starts_at_once), tried - first);
    std::vector<LocalEnd> ends(count_here);
    solvers::parallel_for(count_here, {options_.jobs, options_.interrupt, {}}, [&](std::size_t k) {
      GoalEvaluation evaluation = this->evaluation();
      const LocalEnd& from = ranks[first + k];
      ends[k] = search_from(problem_, evaluation, from.point);
      for (int more = 1; more <= 2 && !ends[k].keeps && !is_interrupted(); ++more) {
        DesignPoint other = start_of(static_cast<int>(first + k) * 2 + more);
        other.rows = from.point.rows;
        evaluation.forget();
        const LocalEnd end = search_from(problem_, evaluation, other);
        if (end.is_better_than(ends[k], 0.0)) ends[k] = end;
      }
      ends[k].index = static_cast<int>(first + k);
      count(evaluation.counts());
    });
    for (LocalEnd& end : ends) {
      ++out_.starts;
      ++out_.catalogue.tried;
      if (!end.has_values) continue;
      if (end.keeps) ++out_.met_starts;
      if (end.is_better_than(best_, 0.0)) best_ = end;
      ends_.push_back(std::move(end));
    }
    say(fmt::format("{} of {} combinations, missed {:.3g}", out_.catalogue.tried, tried, std::sqrt(best_.missed)));
    if (best_.keeps && !has_aims()) break;
  }
  out_.catalogue.left = static_cast<long>(all) - out_.catalogue.tried;
  confirm_ends();
}

/// The problem with some of its goals, and the positions that these need.
GoalProblem with_goals(const GoalProblem& problem, const std::vector<int>& kept) {
  GoalProblem out = problem;
  out.goals.clear();
  out.sweeps.clear();
  std::vector<int> place(problem.sweeps.size(), -1);
  for (const int k : kept) {
    DesignGoal goal = problem.goals[static_cast<std::size_t>(k)];
    int& sweep = place[static_cast<std::size_t>(goal.sweep)];
    if (sweep < 0) {
      sweep = static_cast<int>(out.sweeps.size());
      out.sweeps.push_back(problem.sweeps[static_cast<std::size_t>(goal.sweep)]);
    }
    goal.sweep = sweep;
    out.goals.push_back(std::move(goal));
  }
  for (std::size_t s = 0; s < out.sweeps.size(); ++s) {
    Sweep& sweep = out.sweeps[s];
    if (sweep.along.empty()) continue;
    std::erase_if(sweep.at, [&](double at) {
      return std::none_of(out.goals.begin(), out.goals.end(), [&](const DesignGoal& goal) {
        const bool has_both_sides = goal.kind == DesignGoal::Kind::stable || goal.kind == DesignGoal::Kind::unstable;
        return goal.sweep == static_cast<int>(s) && (has_both_sides || goal.covers(at));
      });
    });
    sweep.first = sweep.at.front();
    sweep.last = sweep.at.back();
  }
  return out;
}

/// Whether searches from the best numbers, the scene's own and some random ones meet these goals, with any rows.
bool DesignSearch::can_meet(const std::vector<int>& kept) {
  constexpr int few = 6;
  const GoalProblem part = with_goals(problem_, kept);
  const int last = problem_.variables.empty() && best_.has_values ? 0 : few;
  const long rows = problem_.catalogues.empty() ? 1 : static_cast<long>(problem_.combinations());
  for (long c = 0; c < rows; ++c) {
    for (int k = best_.has_values ? -1 : 0; k < last && !is_interrupted(); ++k) {
      GoalEvaluation evaluation(part);
      evaluation.set_interrupt(options_.interrupt);
      DesignPoint from = k < 0 ? best_.point : start_of(k);
      from.rows = rows_of(problem_, c);
      const LocalEnd end = search_from(part, evaluation, from, false);
      count(evaluation.counts());
      if (end.has_values && end.keeps) return true;
    }
  }
  return false;
}

/// Goals are left out one after the other as long as those that remain cannot be met; before that single ones and pairs
/// are tried.
void DesignSearch::find_conflict() {
  std::vector<int> limits;
  for (std::size_t k = 0; k < problem_.goals.size(); ++k) {
    if (problem_.goals[k].is_limit()) limits.push_back(static_cast<int>(k));
  }
  constexpr std::size_t most = 24, most_in_pairs = 8;
  // Every choice of rows is searched for every set of goals.
  const double most_choices = problem_.variables.empty() ? 4096.0 : 16.0;
  if (limits.empty() || limits.size() > most || problem_.combinations() > most_choices || can_meet(limits)) return;
  say("looking for goals that conflict");
  for (const int k : limits) {
    if (is_interrupted()) return;
    if (limits.size() > 1 && can_meet({k})) continue;
    out_.conflict = {k};
    out_.conflict_is_smallest = true;
    return;
  }
  for (std::size_t a = 0; a < limits.size() && limits.size() > 2 && limits.size() <= most_in_pairs; ++a) {
    for (std::size_t b = a + 1; b < limits.size(); ++b) {
      if (is_interrupted()) return;
      if (can_meet({limits[a], limits[b]})) continue;
      out_.conflict = {limits[a], limits[b]};
      out_.conflict_is_smallest = true;
      return;
    }
  }
  std::vector<int> kept = limits;
  for (const int k : limits) {
    if (is_interrupted()) return;
    std::vector<int> fewer = kept;
    std::erase(fewer, k);
    if (!fewer.empty() && !can_meet(fewer)) kept = std::move(fewer);
  }
  out_.conflict = std::move(kept);
  out_.conflict_is_smallest =
      out_.conflict.size() <= 2 || (out_.conflict.size() == 3 && limits.size() <= most_in_pairs);
}

/// Multipliers of limits and bounds that hold the aims:  grad f + sum m grad c = 0,  m >= 0, by least squares.
void DesignSearch::find_active() {
  const auto is_aim = [](const DesignGoal& goal) { return !goal.is_limit(); };
  if (problem_.variables.empty() || std::count_if(problem_.goals.begin(), problem_.goals.end(), is_aim) != 1) return;
  const int aim =
      static_cast<int>(std::find_if(problem_.goals.begin(), problem_.goals.end(), is_aim) - problem_.goals.begin());
  GoalEvaluation evaluation = this->evaluation();
  const std::vector<HeldBack> held = holding_back(problem_, evaluation, out_.point);
  count(evaluation.counts());
  for (const HeldBack& one : held) {
    ActiveLimit limit{"", one.variable >= 0, one.goal, 0.0};
    // The multiplier is of parts of sizes, and the gain of units: of those of the aim over those of the limit.
    limit.gain = one.gain * evaluation.size_of(aim);
    if (one.variable >= 0) {
      const ChosenNumber& number = problem_.variables[static_cast<std::size_t>(one.variable)];
      const double end = one.is_upper ? number.to : number.from;
      limit.gain /= number.to - number.from;
      limit.dimension = number.row.dimension;
      limit.name = fmt::format("{} {} {:.6g} {}", number.path,
                               one.is_upper ? "<=" : ">=", end / number.row.dimension.unit(problem_.scene.units),
                               number.row.dimension.unit_name(problem_.scene.units));
    } else {
      if (one.goal < 0) continue;  // the length of a row, which is what it is
      const DesignGoal& goal = problem_.goals[static_cast<std::size_t>(one.goal)];
      limit.name = goal.name;
      limit.gain /= evaluation.size_of(one.goal);
      limit.dimension = goal.of.dimension;
    }
    out_.active.push_back(std::move(limit));
  }
}

/// The best of the second aim for each level of the first, between the best of each alone.
void DesignSearch::trade_off() {
  std::vector<int> aims;
  for (std::size_t k = 0; k < problem_.goals.size(); ++k) {
    if (!problem_.goals[k].is_limit()) aims.push_back(static_cast<int>(k));
  }
  if (options_.trade_off < 2 || aims.size() != 2 || !out_.check.met) return;
  GoalEvaluation evaluation = this->evaluation();
  const auto best_of = [&](double first, double second, std::vector<double> levels, const DesignPoint& from) {
    GoalProblem weighted = problem_;
    weighted.goals[static_cast<std::size_t>(aims[0])].weight = first;
    weighted.goals[static_cast<std::size_t>(aims[1])].weight = second;
    return local_search(weighted, evaluation, from, {options_.method, options_.interrupt, std::move(levels)});
  };
  constexpr double nearly_none = 1e-6;
  const LocalEnd one = best_of(1.0, nearly_none, {}, out_.point), other = best_of(nearly_none, 1.0, {}, out_.point);
  if (!one.keeps || !other.keeps) return;
  out_.trade_off.goals = aims;
  const auto keep = [&](const LocalEnd& end) {
    const auto shown = [&](std::size_t k) {
      const DesignGoal& goal = problem_.goals[static_cast<std::size_t>(aims[k])];
      return (goal.aim == DesignGoal::Aim::greatest ? -1.0 : 1.0) * end.aims[k] * evaluation.size_of(aims[k]);
    };
    out_.trade_off.first.push_back(shown(0));
    out_.trade_off.second.push_back(shown(1));
    out_.trade_off.points.push_back(end.point);
  };
  for (int k = 0; k < options_.trade_off && !is_interrupted(); ++k) {
    say(fmt::format("trade-off: {} of {}", k + 1, options_.trade_off));
    if (k == 0 || k + 1 == options_.trade_off) {
      keep(k == 0 ? one : other);
      continue;
    }
    const double part = static_cast<double>(k) / (options_.trade_off - 1);
    const double level = one.aims[0] + part * (other.aims[0] - one.aims[0]);
    const double rounding = 1e-6 * std::abs(other.aims[0] - one.aims[0]);
    LocalEnd best;
    DesignPoint between = one.point;
    between.parts += part * (other.point.parts - one.point.parts);
    for (const DesignPoint& from : {one.point, between, other.point, start_of(1), start_of(2)}) {
      const LocalEnd end = best_of(nearly_none, 1.0, {level, not_limited}, from);
      const bool is_on_level = end.keeps && end.aims[0] <= level + rounding;
      if (is_on_level && (!best.keeps || end.aims[1] < best.aims[1])) best = end;
    }
    if (best.keeps) keep(best);
  }
  count(evaluation.counts());
}

void DesignSearch::finish() {
  using Status = GoalDesign::Status;
  try {
    if (!out_.scene && best_.has_values) {
      out_.scene = scene_at(problem_, best_.point);
      out_.point = best_.point;
      out_.check = check_goals(problem_, *out_.scene, best_.point.rows);
      out_.missed = std::sqrt(best_.missed);
      out_.aims = best_.aims;
    }
  } catch (const InputError& error) {
    out_.why = error.what();
  }
  if (out_.scene && out_.check.met) {
    out_.status = Status::met;
    find_active();
    trade_off();
    if (!problem_.tolerances.empty()) check_tolerances();
    return;
  }
  if (is_interrupted()) {
    out_.status = Status::interrupted;
    return;
  }
  out_.status = !best_.has_values ? Status::no_start : out_.met_starts > 0 ? Status::not_confirmed : Status::not_met;
  if (out_.met_starts == 0) find_conflict();
  // A set that the numbers shown meet is no conflict: the few searches for it have failed.
  const bool is_met = std::all_of(out_.conflict.begin(), out_.conflict.end(), [&](int k) {
    return static_cast<std::size_t>(k) < out_.check.goals.size() && out_.check.goals[static_cast<std::size_t>(k)].met;
  });
  if (is_met) out_.conflict.clear();
}

/// A sample that misses a limit disproves a worst corner, whatever first order says.
void DesignSearch::check_tolerances() {
  say("sampling the tolerances");
  out_.robust = verify_tolerances(problem_, out_.point, corrections_, options_);
  const RobustCheck& found = out_.robust;
  constexpr double share = 0.997;
  const bool is_kept =
      problem_.worst_corner ? found.corners_kept && found.kept == found.samples : found.kept >= share * found.samples;
  if (!is_kept) out_.status = GoalDesign::Status::not_robust;
}

GoalDesign DesignSearch::run() {
  say("evaluating the scene's own numbers");
  out_.catalogue.combinations = problem_.combinations();
  try {
    out_.before = check_goals(problem_, problem_.scene, own_point(problem_).rows, options_.interrupt);
  } catch (const InputError& error) {
    out_.before.why = error.what();
  }
  {
    // Why nothing could be evaluated, where nothing can.
    GoalEvaluation evaluation = this->evaluation();
    GoalValues values;
    if (!evaluation.evaluate(own_point(problem_), true, values)) out_.why = evaluation.why();
  }
  if (problem_.catalogues.empty()) {
    search_starts();
  } else {
    search_rows();
  }
  finish();
  return std::move(out_);
}

}  // namespace

GoalDesign design_for_goals(const GoalProblem& problem, const GoalSearchOptions& options) {
  return DesignSearch(problem, options).run();
}

}  // namespace poise
