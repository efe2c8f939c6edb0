#include "statics/inverse/find_numbers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "model/input_error.hpp"
#include "solvers/root.hpp"
#include "statics/all_equilibria/all_equilibria.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/inverse/fold_equations.hpp"
#include "statics/inverse/private/sought_numbers.hpp"
#include "statics/paths/path_measures.hpp"
#include "statics/quantities/linear_response.hpp"
#include "statics/sensitivity/sensitivity.hpp"

namespace poise {
namespace {

using Point = ConditionedEquilibrium::Point;
constexpr double not_known = std::numeric_limits<double>::infinity();
constexpr double same_pose = 1e-7;  // rad or mechanism sizes

/// One number, along curves of equilibria.
class NumberFinder {
 public:
  NumberFinder(const VariedScene& varied, const WantedValue& wanted, const FindOptions& options)
      : varied_(varied), wanted_{wanted}, options_(options) {}

  FoundSet run();

 private:
  struct Solution {
    FoundNumbers found;
    std::vector<double> poses;
  };

  bool is_interrupted() const { return options_.path.interrupt != nullptr && *options_.path.interrupt; }
  void follow_own();
  void follow_sets();
  /// Follows the curve through `x` at the first value of a range, of coordinates like those of `varied`.
  void follow(const VariedScene& varied, PathOptions::From from, const std::vector<double>& x = {});
  bool is_on_curves(const StaticModel& model, const std::vector<double>& x, double value) const;
  void search(const VariedScene& varied, const Path& path);
  void search(const SoughtNumbers& sought, const VariedScene& varied, const std::vector<PathPoint>& points,
              const std::vector<double>& excess);
  std::vector<char> level_points(const std::vector<PathPoint>& points, const std::vector<double>& excess);
  CurvePoint see(const SoughtNumbers& sought, const VariedScene& varied, const PathPoint& point) const {
    return sought.see(point, *varied.model_at(point.parameter), {varied.part_at(point.parameter)});
  }
  bool between(const SoughtNumbers& sought, const CurvePoint& a, const CurvePoint& b, double part, bool changes_sign);
  bool between_by_values(const VariedScene& varied, const PathPoint& a, const PathPoint& b);
  bool take(const SoughtNumbers& sought, const ConditionedEquilibrium& system, const Point& at, const CurvePoint& a,
            const CurvePoint& b);
  void note_nearest(const PathPoint& point, double value);

  const VariedScene& varied_;
  std::vector<WantedValue> wanted_;
  FindOptions options_;
  FoundSet out_;
  std::vector<Solution> solutions_;
  struct Followed {
    VariedScene varied;
    Path path;
  };
  std::vector<Followed> followed_;
  double least_ = not_known;
  bool has_start_ = false, has_value_ = false;
  std::string does_not_apply_;  // why a curve could not be begun, of bad input
};

void NumberFinder::follow(const VariedScene& varied, PathOptions::From from, const std::vector<double>& x) {
  PathOptions options = options_.path;
  options.certify = false;
  options.certificate = {};  // of the start, which is found whatever time the proof of a value has
  options.at.clear();
  options.from = from;
  options.start = x;
  ++out_.paths;
  Path found;
  try {
    found = path(varied, options);
  } catch (const InputError& error) {
    // It cannot be assembled there, or does not depend on the number there.
    found.status = Path::Status::no_start;
    found.why = error.what();
    if (does_not_apply_.empty()) does_not_apply_ = error.what();
  }
  if (found.status == Path::Status::no_start) {
    if (out_.why.empty()) out_.why = found.why;
    return;
  }
  has_start_ = true;
  out_.curves += static_cast<int>(found.branches.size());
  out_.whole = out_.whole && found.status == Path::Status::traced;
  out_.branch_points +=
      static_cast<int>(std::count_if(found.events.begin(), found.events.end(),
                                     [](const PathEvent& one) { return one.kind == PathEvent::Kind::branch; }));
  search(varied, found);
  followed_.push_back({varied, std::move(found)});
}

/// Whether a pose at a value of the number is on a curve that was followed, or between its points.
bool NumberFinder::is_on_curves(const StaticModel& model, const std::vector<double>& x, double value) const {
  const std::vector<double> here = poses_of(model, x);
  for (const Followed& followed : followed_) {
    const VariedScene& varied = followed.varied;
    const double unit = varied.scales().length / model.scales().length;
    const auto like_here = [&](const PathPoint& point) {
      return with_lengths_in(unit, poses_of(*varied.model_at(point.parameter), point.x));
    };
    for (const PathBranch& branch : followed.path.branches) {
      for (std::size_t k = 0; k + 1 < branch.points.size(); ++k) {
        const PathPoint &a = branch.points[k], &b = branch.points[k + 1];
        if ((a.parameter - value) * (b.parameter - value) > 0.0) continue;
        const std::vector<double> from = like_here(a), to = like_here(b);
        if (std::max(apart(from, here), apart(to, here)) <= 1.5 * apart(from, to) + same_pose) return true;
      }
    }
  }
  return false;
}

// From the first value of the range; and from the scene's own value within it, where the equilibrium is another one.
void NumberFinder::follow_own() {
  follow(varied_, options_.path.from);
  if (varied_.is_driven() || is_interrupted() || varied_.name() == "loads") return;
  const double own = get_value(varied_.scene(), varied_.name()) * varied_.unit();
  const auto [least, most] = std::minmax({varied_.from(), varied_.to()});
  if (!(own > least && own < most)) return;
  const auto model = varied_.model_at(own);
  SolveOptions options;
  options.interrupt = options_.path.interrupt;
  options.seek = options_.path.from == PathOptions::From::settle ? Seek::settle : Seek::any;
  const Equilibrium at = solve(*model, options);
  if (!at.found() || is_on_curves(*model, at.x, own)) return;
  for (const double end : {varied_.from(), varied_.to()}) {
    const VariedScene part(varied_.scene(), varied_.name(), own / varied_.unit(), end / varied_.unit());
    follow(part, options_.path.from);
  }
}

void NumberFinder::follow_sets() {
  const double middle = 0.5 * (varied_.from() + varied_.to()), unit = varied_.unit();
  Scene scene = varied_.scene();
  if (varied_.is_driven()) scene.stops.pop_back();
  Claim claim = Claim::complete;
  for (const double value : {varied_.from(), varied_.to(), middle}) {
    const auto model = varied_.model_at(value);
    AllEquilibriaOptions options;
    options.settling = false;
    options.certificate = options_.path.certificate;
    options.interrupt = options_.path.interrupt;
    const EquilibriumSet set = all_equilibria(*model, options);
    claim = std::max(claim, set.claim);
    for (const Equilibrium& one : set.equilibria) {
      if (is_interrupted()) return;
      if (is_on_curves(*model, one.x, value)) continue;
      for (const double end : {varied_.from(), varied_.to()}) {
        if (end == value) continue;
        const VariedScene part = VariedScene(scene, varied_.name(), value / unit, end / unit).in(scene, varied_);
        follow(part, PathOptions::From::given, one.x);
      }
    }
  }
  out_.sets = claim == Claim::complete
                  ? "the sets of equilibria at both ends of the range and in its middle are complete, proved; curves "
                    "that close between these are not excluded"
                  : "the sets of equilibria at both ends of the range and in its middle are not proved to be complete";
}

void NumberFinder::note_nearest(const PathPoint& point, double value) {
  const double excess = std::abs(value - wanted_[0].value);
  // The excess does not tell which is closer to a value far beyond all others.
  const bool is_closer = excess < least_ || (excess == least_ && out_.nearest &&
                                             (value > out_.nearest->values[0]) == (wanted_[0].value > value));
  if (!is_closer) return;
  least_ = excess;
  FoundNumbers nearest;
  nearest.numbers = {point.parameter};
  nearest.radii = {not_known};
  nearest.values = {value};
  nearest.at = point;
  out_.nearest = std::move(nearest);
}

void NumberFinder::search(const VariedScene& varied, const Path& path) {
  const SoughtNumbers sought({&varied}, wanted_);
  PathReader reader(varied, options_.others);
  for (const PathBranch& branch : path.branches) {
    std::vector<double> excess;
    QuantityCourse& course = out_.courses.emplace_back();
    for (const PathPoint& point : branch.points) {
      course.numbers.push_back(point.parameter);
      course.values.push_back(reader.value(wanted_[0].of, point));
      excess.push_back(course.values.back() - wanted_[0].value);
      if (std::isfinite(excess.back())) {
        has_value_ = true;
        note_nearest(point, course.values.back());
      }
    }
    search(sought, varied, branch.points, excess);
  }
}

/// Marks the points in whose neighbourhood the quantity has the value and does not change, and notes their range.
std::vector<char> NumberFinder::level_points(const std::vector<PathPoint>& points, const std::vector<double>& excess) {
  constexpr double rounding = 1e-12, nothing = 1e-3;  // the latter of the mechanism's lengths, forces and work
  constexpr std::size_t fewest = 3;
  const double natural = 1.0 / wanted_[0].of.dimension.per_scale(varied_.scales());
  double scale = std::max(std::abs(wanted_[0].value), nothing * natural);
  for (const double one : excess) {
    if (std::isfinite(one)) scale = std::max(scale, std::abs(one));
  }
  std::vector<char> out(points.size(), 0);
  for (std::size_t first = 0; first < points.size();) {
    std::size_t end = first;
    while (end < points.size() && std::abs(excess[end]) <= rounding * scale) ++end;
    if (end - first >= fewest) {
      out_.all_along.emplace_back(points[first].parameter, points[end - 1].parameter);
      std::fill(out.begin() + static_cast<std::ptrdiff_t>(first), out.begin() + static_cast<std::ptrdiff_t>(end), 1);
    }
    first = std::max(end, first + 1);
  }
  return out;
}

// Between two points where the quantity passes the value; around a point where it comes near to it and turns back: the
// parabola through three points says how far.
void NumberFinder::search(const SoughtNumbers& sought, const VariedScene& varied, const std::vector<PathPoint>& points,
                          const std::vector<double>& excess) {
  const auto is_known = [&](std::size_t k) { return std::isfinite(excess[k]); };
  const std::vector<char> is_level = level_points(points, excess);
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (is_interrupted()) return;
    if (!is_known(k) || is_level[k] != 0 || (k + 1 < points.size() && is_level[k + 1] != 0)) continue;
    if (k + 1 < points.size() && is_known(k + 1) && excess[k] * excess[k + 1] <= 0.0) {
      const double change = excess[k] - excess[k + 1];
      between(sought, see(sought, varied, points[k]), see(sought, varied, points[k + 1]),
              change == 0.0 ? 0.5 : excess[k] / change, true);
    }
    if (k == 0 || k + 1 >= points.size() || !is_known(k - 1) || !is_known(k + 1)) continue;
    const double before = excess[k - 1], here = excess[k], after = excess[k + 1];
    const bool turns = before * here > 0.0 && here * after > 0.0 && std::abs(here) <= std::abs(before) &&
                       std::abs(here) <= std::abs(after);
    const double fall = std::abs(before - here) + std::abs(after - here);
    if (!turns || std::abs(here) > fall) continue;
    const CurvePoint middle = see(sought, varied, points[k]);
    for (const auto& other : {points[k - 1], points[k + 1]}) {
      for (const double part : {0.1, 0.5}) between(sought, middle, see(sought, varied, other), part, false);
    }
  }
}

bool NumberFinder::take(const SoughtNumbers& sought, const ConditionedEquilibrium& system, const Point& at,
                        const CurvePoint& a, const CurvePoint& b) {
  if (!within_ranges(at) || !sought.holds(system, at)) return false;
  const std::vector<double> poses = poses_at(at, varied_.scene());
  const double from_a = apart(a.poses, poses), from_b = apart(b.poses, poses);
  const double number_apart = std::abs(a.s[0] - b.s[0]);
  const double length = apart(a.poses, b.poses) + number_apart;
  constexpr double rounding = 1e-9;
  if (std::max(from_a, from_b) > 1.5 * length + rounding) return false;
  const double part = from_a + from_b > 0.0 ? from_a / (from_a + from_b) : 0.5;
  std::vector<double> x = a.at->x;
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += part * (b.at->x[i] - a.at->x[i]);
  const VariedScene& varied = sought.range(0);
  const double number = varied.value_at(at.s[0]);
  const double unit = varied.scales().length;
  const std::vector<double> poses_si = with_lengths_in(unit, poses);
  for (const Solution& other : solutions_) {
    const double near = 1e-9 * std::abs(varied.to() - varied.from());
    if (std::abs(other.found.numbers[0] - number) > near) continue;
    if (apart(other.poses, poses_si) < 1e-6 * std::max(1.0, unit)) return true;
  }
  const auto model = varied.model_at(number);
  solutions_.push_back({sought.examine(system, at, *model, x, options_.path.certificate), poses_si});
  return true;
}

/// The place between two points of a curve at which a quantity without derivatives has the value, by secants.
bool NumberFinder::between_by_values(const VariedScene& varied, const PathPoint& a, const PathPoint& b) {
  Certificate at;
  double number = 0.0;
  const double scale = wanted_[0].value == 0.0 ? 1.0 : std::abs(wanted_[0].value);
  const auto excess = [&](double part) -> std::optional<double> {
    number = a.parameter + part * (b.parameter - a.parameter);
    const auto model = varied.model_at(number);
    std::vector<double> x = a.x;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += part * (b.x[i] - a.x[i]);
    at = certify(*model, x, options_.path.certificate);
    if (!at.confirmed()) return std::nullopt;
    const int driven = varied.is_driven() ? static_cast<int>(model->scene().stops.size()) - 1 : -1;
    const RestingPlace place = resting_place(*model, at.x, at.active_stops, driven, options_.others);
    const double value = quantity_values(place, {wanted_[0].of})[0].value;
    if (!std::isfinite(value)) return std::nullopt;
    return (value - wanted_[0].value) / scale;
  };
  const std::optional<double> from = excess(0.0), to = excess(1.0);
  if (!from || !to || *from * *to > 0.0) return false;
  const std::optional<double> part = solvers::root_by_secants(excess, {0.0, 1.0}, *from, *to, 1e-15);
  if (!part) return false;
  const std::optional<double> left = excess(*part);
  if (!left) return false;
  FoundNumbers found;
  found.numbers = {number};
  found.radii = {not_known};
  found.values = {wanted_[0].value + *left * scale};
  found.at = a;
  found.at.parameter = number;
  found.at.x = at.x;
  found.at.stability = at.stability;
  found.at.unstable_directions = at.unstable_directions;
  found.at.proof = PointProof::failed;
  found.at.statement = "the quantity has no derivatives, so that the number is not enclosed; the equilibrium is proved";
  solutions_.push_back({std::move(found), {}});
  return true;
}

// Newton's method from the straight line; where that leads elsewhere, halves of the piece of curve between, on which
// the quantity changes its sign.
bool NumberFinder::between(const SoughtNumbers& sought, const CurvePoint& a, const CurvePoint& b, double part,
                           bool changes_sign) {
  if (is_found_by_others(wanted_[0].of)) return changes_sign && between_by_values(sought.range(0), *a.at, *b.at);
  for (const CurvePoint* side : {&a, &b}) {
    ConditionedEquilibrium system = sought.equations(side->stops);
    Point from = system.begin(a.poses, a.s), to = system.begin(b.poses, b.s);
    const auto on_line = [](const Point& p, const Point& q, double t) {
      Point out = p;
      for (std::size_t i = 0; i < out.z.size(); ++i) out.z[i] += t * (q.z[i] - p.z[i]);
      out.s[0] += t * (q.s[0] - p.s[0]);
      return out;
    };
    constexpr int most_halvings = 40;
    double from_sign = 0.0;
    for (int k = 0; k < most_halvings; ++k) {
      Point at = on_line(from, to, k == 0 ? part : 0.5);
      if (system.solve(at) && take(sought, system, at, a, b)) return true;
      if (!changes_sign) break;
      const Point through = on_line(from, to, 0.5);
      Point middle = through;
      if (!system.solve_across(middle, through, system.difference(from, to))) break;
      if (k == 0) from_sign = system.excess(from)[0];
      const double here = system.excess(middle)[0];
      if (!std::isfinite(here)) break;
      ((here > 0.0) == (from_sign > 0.0) ? from : to) = middle;
    }
    if (a.stops.size() == b.stops.size()) {
      const bool alike = std::equal(a.stops.begin(), a.stops.end(), b.stops.begin(), [](const auto& p, const auto& q) {
        return p.stop == q.stop && p.upper == q.upper;
      });
      if (alike) break;
    }
  }
  return false;
}

FoundSet NumberFinder::run() {
  follow_own();
  if (options_.all && !is_interrupted()) follow_sets();
  std::sort(solutions_.begin(), solutions_.end(),
            [](const Solution& a, const Solution& b) { return a.found.numbers[0] < b.found.numbers[0]; });
  for (Solution& one : solutions_) out_.values.push_back(std::move(one.found));
  using Status = FoundSet::Status;
  const bool has_found = !out_.values.empty() || !out_.all_along.empty();
  out_.status = is_interrupted() ? Status::interrupted
                : has_found      ? Status::found
                : !has_start_    ? Status::no_start
                : !has_value_    ? Status::undefined
                                 : Status::none;
  if (out_.status == Status::no_start && !does_not_apply_.empty()) throw InputError(does_not_apply_);
  if (out_.status == Status::found) {
    out_.why.clear();
    out_.nearest.reset();
  }
  return out_;
}

/// Values of a number for which a load at a fold has a value: the fold is found anew at each number, with its
/// derivative.
class FoldFinder {
 public:
  FoldFinder(const VariedScene& varied, const WantedValue& wanted, const FindOptions& options)
      : varied_(varied), wanted_(wanted), options_(options) {}

  FoundSet run();

 private:
  struct AtFold {
    double excess = 0.0, slope = 0.0;  // by the part of the range
  };
  std::optional<AtFold> fold_at(double part);
  void prove(FoundNumbers& found) const;

  const VariedScene& varied_;
  const WantedValue& wanted_;
  const FindOptions& options_;
  FoundSet out_;
};

std::optional<FoldFinder::AtFold> FoldFinder::fold_at(double part) {
  const double number = varied_.value_at(part);
  SensitivityOptions options;
  options.solve.interrupt = options_.path.interrupt;
  ++out_.paths;
  const Sensitivities found = sensitivities(*varied_.model_at(number), {wanted_.of}, options);
  if (!found.why.empty() || !found.of[0].why.empty()) {
    if (out_.why.empty()) out_.why = found.why.empty() ? found.of[0].why : found.why;
    return std::nullopt;
  }
  AtFold out{found.of[0].value - wanted_.value, 0.0};
  for (const Sensitivity& one : found.of[0].by) {
    if (one.number == varied_.name() && one.why.empty()) {
      out.slope = one.derivative * (varied_.to() - varied_.from());
    }
  }
  if (!out_.nearest || std::abs(out.excess) < std::abs(out_.nearest->values[0] - wanted_.value)) {
    out_.nearest = FoundNumbers{{number}, {not_known}, {found.of[0].value}, {}, false};
  }
  return out;
}

/// The fold with the wanted load, from that of the path over the load at the number that was found.
void FoldFinder::prove(FoundNumbers& found) const {
  found.at.statement = "the fold is found by a path over the load at this number; it is not enclosed";
  const Scene there = varied_.scene_at(found.numbers[0]);
  const double unit = wanted_.of.dimension.unit(there.units), wanted = wanted_.value / unit;
  const double own = get_value(there, wanted_.of.load), beyond = wanted + 0.25 * (wanted - own);
  if (own == wanted) return;
  const VariedScene over_load(there, wanted_.of.load, own, beyond);
  PathOptions options = options_.path;
  options.certify = false;
  options.at.clear();
  const Path followed = path(over_load, options);
  const auto fold = std::find_if(followed.events.begin(), followed.events.end(),
                                 [](const PathEvent& event) { return event.kind == PathEvent::Kind::fold; });
  if (fold == followed.events.end()) return;
  Scene loaded = varied_.scene();
  set_value(loaded, wanted_.of.load, wanted);
  const VariedScene over_number(loaded, varied_.name(), varied_.from() / varied_.unit(), varied_.to() / varied_.unit());
  const auto model = over_load.model_at(fold->at.parameter);
  const std::vector<double> poses =
      with_lengths_in(over_load.scales().length / over_number.scales().length, poses_of(*model, fold->at.x));
  // Where a stop comes off the curve turns in a corner: its force is zero there.
  const auto stop = std::find_if(followed.events.begin(), followed.events.end(), [&](const PathEvent& event) {
    constexpr double same = 1e-9;
    return event.kind == PathEvent::Kind::stop &&
           std::abs(event.at.parameter - fold->at.parameter) <= same * std::abs(fold->at.parameter);
  });
  std::vector<int> active = fold->at.active_stops;
  double part = varied_.part_at(found.numbers[0]);
  const double given = part;
  SolutionProof proof;
  double open = 0.0;
  if (stop != followed.events.end()) {
    SoughtQuantity force;
    force.kind = SoughtQuantity::Kind::stop_reaction;
    force.item = stop->item;
    force.dimension = over_number.scene().stops[static_cast<std::size_t>(stop->item)].on.effort_dimension();
    const SoughtNumbers sought({&over_number}, {{force, 0.0}});
    if (std::find(active.begin(), active.end(), stop->item) == active.end()) active.push_back(stop->item);
    ConditionedEquilibrium equations = sought.equations(acting_at(sought.scaled_scene(), poses, active));
    Point at = equations.begin(poses, {part});
    if (!equations.solve(at)) return;
    part = at.s[0];
    open = equations.rounding_effect(at)[0];
    proof = equations.prove(at);
  } else {
    const UnknownNumbers numbers(over_number.reference_scene(), over_number.scales(), {&over_number});
    FoldEquations equations(numbers, acting_at(numbers.list()->scene(), poses, active));
    FoldEquations::Point at;
    if (!equations.solve(poses, part, at)) return;
    part = at.s;
    open = equations.rounding_effect(at);
    proof = equations.prove(at);
  }
  constexpr double near = 1e-6;
  if (!(std::abs(part - given) < near)) return;
  if (!proof.proved) {
    found.at.statement = proof.why;
    return;
  }
  found.proved = true;
  found.numbers = {varied_.value_at(proof.part[0])};
  found.values = {wanted_.value};
  found.at.parameter = found.numbers[0];
  const double range = std::abs(varied_.to() - varied_.from());
  found.radii = {range * (proof.radius[0] + open) +
                 std::numeric_limits<double>::epsilon() * (std::abs(varied_.from()) + range)};
  found.at.statement =
      "exactly one fold with that load is near this number; that the path over the load meets it first is found, not "
      "proved";
}

FoundSet FoldFinder::run() {
  using Status = FoundSet::Status;
  constexpr int slices = 8;
  std::vector<std::optional<AtFold>> at;
  const auto is_interrupted = [&] { return options_.path.interrupt != nullptr && *options_.path.interrupt; };
  QuantityCourse& course = out_.courses.emplace_back();
  for (int k = 0; k <= slices && !is_interrupted(); ++k) {
    const double part = static_cast<double>(k) / slices;
    at.push_back(fold_at(part));
    course.numbers.push_back(varied_.value_at(part));
    course.values.push_back(at.back() ? at.back()->excess + wanted_.value : std::numeric_limits<double>::quiet_NaN());
  }
  for (std::size_t k = 0; k + 1 < at.size() && !is_interrupted(); ++k) {
    if (!at[k] || !at[k + 1] || !(at[k]->excess * at[k + 1]->excess <= 0.0)) continue;
    const double from = static_cast<double>(k) / slices, to = static_cast<double>(k + 1) / slices;
    const double start = from + (to - from) * at[k]->excess / (at[k]->excess - at[k + 1]->excess);
    double excess = 0.0;
    const auto part = solvers::root_by_newton(
        [&](double s) -> std::optional<solvers::ValueAndSlope> {
          const std::optional<AtFold> there = fold_at(s);
          if (!there) return std::nullopt;
          excess = there->excess;
          return solvers::ValueAndSlope{there->excess, there->slope};
        },
        {from, to}, start, at[k]->excess > 0.0, {.step = 1e-14, .steps = 30});
    constexpr double known_to = 1e-9;
    if (!part || std::abs(excess) > known_to * std::max(std::abs(wanted_.value), std::abs(at[k]->excess))) continue;
    FoundNumbers found;
    found.numbers = {varied_.value_at(*part)};
    found.radii = {not_known};
    found.values = {wanted_.value + excess};
    found.at.parameter = found.numbers[0];
    found.at.proof = PointProof::critical;
    prove(found);
    out_.values.push_back(std::move(found));
  }
  out_.curves = static_cast<int>(at.size());
  out_.status = is_interrupted()       ? Status::interrupted
                : !out_.values.empty() ? Status::found
                : out_.nearest         ? Status::none
                                       : Status::undefined;
  if (!out_.values.empty()) {
    out_.nearest.reset();
    out_.why.clear();
  }
  return out_;
}

}  // namespace

FoundSet find_numbers(const VariedScene& varied, const WantedValue& wanted, const FindOptions& options) {
  if (wanted.of.kind == SoughtQuantity::Kind::load_at_fold) return FoldFinder(varied, wanted, options).run();
  return NumberFinder(varied, wanted, options).run();
}

}  // namespace poise
