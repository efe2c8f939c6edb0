#include "design/goals/check_goals.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "model/input_error.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/model/varied_scene.hpp"
#include "statics/paths/over_path.hpp"
#include "statics/paths/path_measures.hpp"
#include "statics/quantities/quantities_at.hpp"
#include "statics/sensitivity/sensitivity.hpp"

namespace poise {
namespace {

constexpr double by_rounding = 1e-9;  // parts of a goal's size by which rounding may miss it

/// The part of a branch between two values, with the points that are wanted there.
PathBranch part_of(const PathBranch& branch, double first, double last, const std::vector<PathPoint>& wanted) {
  PathBranch out = branch;
  const double least = std::min(first, last), most = std::max(first, last);
  const double same = 1e-12 * (std::abs(least) + std::abs(most));
  out.points = wanted;
  for (const PathPoint& point : branch.points) {
    const bool is_new = std::none_of(wanted.begin(), wanted.end(), [&](const PathPoint& one) {
      return std::abs(one.parameter - point.parameter) <= same;
    });
    if (is_new) out.points.push_back(point);
  }
  std::erase_if(out.points, [&](const PathPoint& point) {
    return point.parameter < least - same || point.parameter > most + same;
  });
  const bool falls = branch.points.size() > 1 && branch.points.front().parameter > branch.points.back().parameter;
  std::stable_sort(out.points.begin(), out.points.end(), [&](const PathPoint& a, const PathPoint& b) {
    return falls ? a.parameter > b.parameter : a.parameter < b.parameter;
  });
  return out;
}

/// Values between points at which springs given by points of a curve pass these, to first order: what turns sharply
/// there may do so between the points of a path.
std::vector<double> corners_of(const VariedScene& varied, const Path& found) {
  std::vector<double> out;
  const Scene& scene = varied.scene();
  PathReader reader(varied);
  for (const Element& element : scene.elements) {
    const auto* spring = std::get_if<CurveSpring>(&element.law);
    if (spring == nullptr || found.branches.empty()) continue;
    const SoughtQuantity measure{.name = "", .on = element.on, .dimension = element.on.dimension()};
    const std::vector<PathPoint>& points = found.branches.front().points;
    double before = 0.0;
    for (std::size_t k = 0; k < points.size(); ++k) {
      const double here = reader.value(measure, points[k]);
      for (const double knot : spring->curve().x()) {
        const double x = knot + spring->shift;
        if (k == 0 || !((before - x) * (here - x) < 0.0)) continue;
        const double part = (x - before) / (here - before);
        out.push_back(points[k - 1].parameter + part * (points[k].parameter - points[k - 1].parameter));
      }
      before = here;
    }
  }
  constexpr std::size_t most = 2000;
  if (out.size() > most) out.resize(most);
  return out;
}

SoughtQuantity over(SoughtQuantity::Kind kind, const SoughtQuantity& of) {
  SoughtQuantity out{.name = of.name, .kind = kind, .dimension = of.dimension};
  out.of = {of};
  return out;
}

class GoalChecker {
 public:
  GoalChecker(const GoalProblem& problem, const Scene& scene, const std::vector<int>& rows,
              const std::atomic<bool>* interrupt)
      : problem_(problem), scene_(scene), rows_(rows), interrupt_(interrupt) {}

  GoalCheck run();

 private:
  void check_sweep(int sweep);
  void refine(const VariedScene& varied, int sweep, PathOptions& options) const;
  void check_rest(int sweep);
  void check_on_path(const VariedScene& varied, const Path& found, const std::vector<double>& at,
                     const DesignGoal& goal, CheckedGoal& out);
  void check_equilibrium(const VariedScene& varied, const PathPoint& point, const DesignGoal& goal, CheckedGoal& out);
  void check_lengths(const std::string& where, const std::function<double(const SoughtQuantity&, bool)>& extreme);
  void judge(const DesignGoal& goal, CheckedGoal& out);

  const GoalProblem& problem_;
  const Scene& scene_;
  const std::vector<int>& rows_;
  const std::atomic<bool>* interrupt_;
  std::optional<Scales> scales_;  // of the scene, once they are needed
  GoalCheck out_;
};

/// Compares least and most with the limits.
void GoalChecker::judge(const DesignGoal& goal, CheckedGoal& out) {
  out.has_value = std::isfinite(out.least) && std::isfinite(out.most);
  if (!out.has_value) {
    if (out.why.empty()) out.why = goal.of.name + " has no value at some position";
    return;
  }
  out.margin = std::numeric_limits<double>::infinity();
  const auto see = [&](double margin, double at) {
    if (margin >= out.margin) return;
    out.margin = margin;
    out.worst_at = at;
  };
  if (!goal.curve.empty()) {
    if (goal.within > 0.0) {
      see(goal.within + out.least, out.least_at);
      see(goal.within - out.most, out.most_at);
    }
  } else {
    if (goal.least) see(out.least - *goal.least, out.least_at);
    if (goal.most) see(*goal.most - out.most, out.most_at);
  }
  // What rounding leaves of a value that is asked for exactly is that of the mechanism's own forces and lengths.
  if (!scales_) scales_ = StaticModel(scene_).scales();
  const double natural = 1.0 / goal.of.dimension.per_scale(*scales_);
  const double size = std::max(goal.size(), (goal.is_equation ? 1.0 : 1e-6) * natural);
  out.met = !goal.is_limit() || out.margin >= -by_rounding * size;
}

void GoalChecker::check_lengths(const std::string& where,
                                const std::function<double(const SoughtQuantity&, bool)>& extreme) {
  for (std::size_t c = 0; c < problem_.catalogues.size(); ++c) {
    const Catalogue& catalogue = problem_.catalogues[c];
    const Catalogue::Row& row = catalogue.rows[static_cast<std::size_t>(rows_[c])];
    for (const SoughtQuantity& length : catalogue.lengths) {
      const double least = extreme(length, false), most = extreme(length, true);
      const double unit = problem_.scene.units.length;
      if (least >= row.shortest * (1.0 - by_rounding) && most <= row.longest * (1.0 + by_rounding)) continue;
      out_.why = fmt::format("{} goes from {:.6g} to {:.6g} {}{}, and {} from {:.6g} to {:.6g}", length.name,
                             least / unit, most / unit, problem_.scene.units.length_name, where, row.name,
                             row.shortest / unit, row.longest / unit);
    }
  }
}

void GoalChecker::check_equilibrium(const VariedScene& varied, const PathPoint& point, const DesignGoal& goal,
                                    CheckedGoal& out) {
  out.has_value = true;
  out.least = out.most = point.effort;
  out.least_at = out.most_at = out.worst_at = point.parameter;
  // Let go: the same pose without what drives it.
  const StaticModel model(scene_, varied.scales());
  const Certificate at = certify(model, point.x);
  if (!at.confirmed()) {
    out.why = "no equilibrium is proved there: " + at.statement;
    return;
  }
  constexpr double same_pose = 1e-6;  // rad or mechanism sizes
  if (at.moved > same_pose) {
    out.why = fmt::format("the equilibrium is {:.2g} away from there, in rad or mechanism sizes", at.moved);
    return;
  }
  ++out_.points;
  ++out_.proved;
  const Stability wanted = goal.kind == DesignGoal::Kind::stable ? Stability::stable : Stability::unstable;
  if (at.stability != wanted) {
    out.why = fmt::format("the equilibrium there is {}", to_string(at.stability));
    return;
  }
  out.met = true;
}

void GoalChecker::check_on_path(const VariedScene& varied, const Path& found, const std::vector<double>& at,
                                const DesignGoal& goal, CheckedGoal& out) {
  const PathBranch& branch = found.branches.front();
  std::vector<PathPoint> wanted;
  for (std::size_t k = 0; k < at.size(); ++k) {
    if (!found.wanted[k].empty()) {
      wanted.push_back(found.wanted[k].front());
    } else if (!branch.points.empty() && goal.covers(at[k])) {
      // A range that ends at a stop of the scene ends there but for rounding.
      const double natural = problem_.sweeps[static_cast<std::size_t>(goal.sweep)].natural;
      if (std::abs(branch.points.back().parameter - at[k]) > by_rounding * natural) continue;
      wanted.push_back(branch.points.back());
      wanted.back().parameter = at[k];
    }
  }
  if (goal.kind == DesignGoal::Kind::passes) {
    out.met = true;  // all of the path was followed
    return;
  }
  PathReader reader(varied);
  const bool is_about_one = goal.kind == DesignGoal::Kind::stable || goal.kind == DesignGoal::Kind::unstable;
  if (is_about_one) {
    for (const PathPoint& point : wanted) {
      if (goal.covers(point.parameter)) check_equilibrium(varied, point, goal, out);
    }
    return;
  }
  out.least = std::numeric_limits<double>::infinity();
  out.most = -out.least;
  const auto see = [&](double value, double where) {
    if (!std::isfinite(value)) {
      out.least = out.most = value;
      return;
    }
    if (value < out.least) out.least_at = where;
    if (value > out.most) out.most_at = where;
    out.least = std::min(out.least, value);
    out.most = std::max(out.most, value);
  };
  if (!goal.is_range) {
    for (const PathPoint& point : wanted) {
      if (goal.covers(point.parameter)) see(reader.value(goal.of, point), point.parameter);
    }
    judge(goal, out);
    return;
  }
  const PathBranch part = part_of(branch, goal.first, goal.last, wanted);
  if (!goal.curve.empty()) {
    for (const PathPoint& point : part.points) {
      see(reader.value(goal.of, point) - goal.wanted_at(point.parameter), point.parameter);
    }
    judge(goal, out);
    return;
  }
  const auto extreme = [&](const SoughtQuantity& of) {
    const OverPathValue value = over_path(varied, part, of);
    if (out.why.empty()) out.why = value.why;
    out.extremes.insert(out.extremes.end(), value.at.begin(), value.at.end());
    see(value.value, value.at.empty() ? goal.first : value.at.front());
  };
  if (goal.of.is_over_path()) {
    extreme(goal.of);
  } else {
    extreme(over(SoughtQuantity::Kind::minimum, goal.of));
    extreme(over(SoughtQuantity::Kind::maximum, goal.of));
  }
  if (goal.kind == DesignGoal::Kind::none) {
    out.has_value = std::isfinite(out.least) && std::isfinite(out.most);
    out.met = out.has_value && out.least * out.most > 0.0;
    out.margin = std::min(std::abs(out.least), std::abs(out.most)) * (out.met ? 1.0 : -1.0);
    out.worst_at = std::abs(out.least) < std::abs(out.most) ? out.least_at : out.most_at;
    return;
  }
  judge(goal, out);
}

/// Places between the points of a path at which something may stand out: points of curves of springs, and where the
/// distance from a wanted curve is greatest by the parabola through neighbours.
void GoalChecker::refine(const VariedScene& varied, int sweep, PathOptions& options) const {
  PathOptions rough = options;
  rough.certify = false;
  constexpr int rounds = 3;
  for (int round = 0; round < rounds; ++round) {
    rough.at = options.at;
    const Path found = path(varied, rough);
    if (found.branches.empty()) return;
    std::vector<double> more = round == 0 ? corners_of(varied, found) : std::vector<double>{};
    PathReader reader(varied);
    for (const DesignGoal& goal : problem_.goals) {
      if (goal.sweep != sweep || goal.curve.empty()) continue;
      std::vector<PathPoint> wanted;
      for (const std::vector<PathPoint>& points : found.wanted) {
        if (!points.empty()) wanted.push_back(points.front());
      }
      const std::vector<PathPoint> points = part_of(found.branches.front(), goal.first, goal.last, wanted).points;
      std::vector<double> off;
      for (const PathPoint& point : points)
        off.push_back(reader.value(goal.of, point) - goal.wanted_at(point.parameter));
      for (std::size_t k = 1; k + 1 < points.size(); ++k) {
        const double a = off[k] - off[k - 1], b = off[k + 1] - off[k];
        if (!(a * b < 0.0)) continue;
        const double ha = points[k].parameter - points[k - 1].parameter,
                     hb = points[k + 1].parameter - points[k].parameter;
        const double bend = (b / hb - a / ha) / (ha + hb);
        const double place = points[k].parameter - 0.5 * (a / ha + bend * ha) / bend;
        if ((place - points[k - 1].parameter) * (points[k + 1].parameter - place) > 0.0) more.push_back(place);
      }
    }
    if (more.empty()) return;
    options.at.insert(options.at.end(), more.begin(), more.end());
  }
}

void GoalChecker::check_sweep(int sweep) {
  const Sweep& of = problem_.sweeps[static_cast<std::size_t>(sweep)];
  const bool is_one = of.first == of.last;
  const double last = is_one ? of.first_shown() + 0.01 * of.natural / of.unit : of.last_shown();
  const VariedScene varied(scene_, of.along, of.first_shown(), last);
  PathOptions options;
  options.at = of.at;
  options.interrupt = interrupt_;
  refine(varied, sweep, options);
  const Path found = path(varied, options);
  for (const std::string& note : found.notes) {
    if (std::find(out_.notes.begin(), out_.notes.end(), note) == out_.notes.end()) out_.notes.push_back(note);
  }
  std::string why;
  if (found.status == Path::Status::no_start) why = found.why;
  if (why.empty() && !is_one) {
    const PathBranch& branch = found.branches.front();
    const bool turns = std::any_of(found.events.begin(), found.events.end(), [](const PathEvent& event) {
      return event.kind == PathEvent::Kind::fold || event.kind == PathEvent::Kind::snap;
    });
    if (turns) why = "the path turns, or snaps, before the end of the range";
    // A range that ends at a stop of the scene is blocked there, but for rounding.
    const bool is_whole =
        branch.end == PathBranch::End::range ||
        (!branch.points.empty() && std::abs(branch.points.back().parameter - of.last) <= by_rounding * of.natural);
    if (!is_whole) why = "the path ends before the end of the range: " + branch.why;
  }
  for (const PathBranch& branch : found.branches) {
    out_.points += static_cast<int>(branch.points.size());
    for (const PathPoint& point : branch.points) out_.proved += point.proof == PointProof::proved ? 1 : 0;
  }
  for (std::size_t k = 0; k < problem_.goals.size(); ++k) {
    if (problem_.goals[k].sweep != sweep) continue;
    out_.goals[k].why = why;
    if (why.empty()) check_on_path(varied, found, options.at, problem_.goals[k], out_.goals[k]);
  }
  if (!why.empty()) return;
  check_lengths(" over " + of.along, [&](const SoughtQuantity& length, bool most) {
    if (is_one) return PathReader(varied).value(length, found.wanted.front().front());
    const auto kind = most ? SoughtQuantity::Kind::maximum : SoughtQuantity::Kind::minimum;
    return over_path(varied, found.branches.front(), over(kind, length)).value;
  });
}

void GoalChecker::check_rest(int sweep) {
  const StaticModel model(scene_);
  SolveOptions options;
  options.interrupt = interrupt_;
  std::optional<Equilibrium> rest;
  const auto at_rest = [&]() -> const Equilibrium& {
    if (!rest) {
      rest = solve(model, options);
      ++out_.points;
      out_.proved += rest->found() ? 1 : 0;
    }
    return *rest;
  };
  for (std::size_t k = 0; k < problem_.goals.size(); ++k) {
    const DesignGoal& goal = problem_.goals[k];
    CheckedGoal& out = out_.goals[k];
    if (goal.sweep != sweep) continue;
    if (goal.of.kind == SoughtQuantity::Kind::load_at_fold) {
      const Sensitivities found = sensitivities(model, {goal.of});
      const bool has_value = !found.of.empty() && found.of[0].why.empty();
      if (!has_value) out.why = found.of.empty() ? found.why : found.of[0].why;
      out.least = out.most = has_value ? found.of[0].value : std::numeric_limits<double>::quiet_NaN();
      judge(goal, out);
      continue;
    }
    if (!at_rest().found()) {
      out.why = "no equilibrium is proved in which it comes to rest: " + at_rest().why;
      continue;
    }
    const QuantityValue value =
        quantity_values(resting_place(model, at_rest().x, at_rest().certificate.active_stops), {goal.of})[0];
    out.why = value.why;
    out.least = out.most = value.value;
    judge(goal, out);
  }
  if (!rest || !rest->found()) return;
  check_lengths("", [&](const SoughtQuantity& length, bool) {
    return quantities_at(model, rest->x, rest->certificate.active_stops, {length})[0];
  });
}

GoalCheck GoalChecker::run() {
  out_.goals.resize(problem_.goals.size());
  for (std::size_t s = 0; s < problem_.sweeps.size(); ++s) {
    try {
      if (problem_.sweeps[s].along.empty()) {
        check_rest(static_cast<int>(s));
      } else {
        check_sweep(static_cast<int>(s));
      }
    } catch (const InputError& error) {
      for (std::size_t k = 0; k < problem_.goals.size(); ++k) {
        if (problem_.goals[k].sweep == static_cast<int>(s)) out_.goals[k].why = error.what();
      }
    }
  }
  out_.met = out_.why.empty() &&
             std::all_of(out_.goals.begin(), out_.goals.end(), [](const CheckedGoal& one) { return one.met; });
  return std::move(out_);
}

}  // namespace

GoalCheck check_goals(const GoalProblem& problem, const Scene& scene, const std::vector<int>& rows,
                      const std::atomic<bool>* interrupt) {
  return GoalChecker(problem, scene, rows, interrupt).run();
}

GoalCourse course_of(const GoalProblem& problem, const DesignGoal& goal, const Scene& scene) {
  GoalCourse out;
  const Sweep& sweep = problem.sweeps[static_cast<std::size_t>(goal.sweep)];
  if (!goal.is_range || goal.of.is_over_path() || goal.kind == DesignGoal::Kind::passes) return out;
  try {
    const VariedScene varied(scene, sweep.along, sweep.first_shown(), sweep.last_shown());
    PathOptions options;
    options.certify = false;
    const Path found = path(varied, options);
    if (found.branches.empty()) return out;
    PathReader reader(varied);
    for (const PathPoint& point : found.branches.front().points) {
      if (!goal.covers(point.parameter)) continue;
      out.at.push_back(point.parameter);
      out.value.push_back(reader.value(goal.of, point));
    }
  } catch (const InputError&) {
    return {};  // it cannot be assembled there
  }
  return out;
}

}  // namespace poise
