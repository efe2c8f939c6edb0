#include "design/synthesis/path_search.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <optional>

#include "design/synthesis/path_curve.hpp"
#include "design/synthesis/private/path_starts.hpp"
#include "solvers/parallel.hpp"

namespace poise {
namespace {

// In the unit in which the points have the size 1.
constexpr double passed = 1e-20;      // sum of squares of points that are passed
constexpr double limits_kept = 1e-9;  // how far a linkage may be beyond its limits
constexpr double margin_of_turn = 1e-6;
constexpr double same_sums = 1e-3;  // by which the sums of two fits differ at least
constexpr int draws_of_start = 60, rounds_of_limits = 25, iterations_of_fit = 400, iterations_of_rough_fit = 72;
constexpr std::size_t points_of_search = 64, fits_to_end = 24, fits_of_all_points = 8;
constexpr int table_of_curves = 4000, starts_of_table = 60;
constexpr int places_of_error = 400;
constexpr double least_angle = 1e-6;  // of transmission, rad

struct Fitted {
  PathVector x{};
  std::vector<double> t{};
  std::vector<int> closures{};
  double sum = std::numeric_limits<double>::infinity();
  bool converged = false;
};

PathVector as_unknowns(const std::vector<double>& x) {
  PathVector out{};
  std::copy(x.begin(), x.end(), out.begin());
  return out;
}

double sum_of(const PathFit::Task& task, const Fitted& of) {
  const PathFit fit(task, of.closures);
  std::array<double, 3> residuals{}, by_own{};
  std::array<double, 3 * path_unknowns> by_shared{};
  double sum = 0.0;
  for (int i = 0; i < fit.points(); ++i) {
    fit.evaluate(i, of.x, of.t[i], residuals, by_shared, by_own);
    for (const double r : residuals) sum += r * r;
  }
  return sum;
}

// By least squares, with shifts of the limits until they hold.
Fitted fitted(const PathFit::Task& task, const PathStart& start, bool exact, const std::atomic<bool>* interrupt) {
  Fitted out{start.x, start.t, start.closures};
  PathFit fit(task, start.closures);
  SquaresOptions options;
  options.iterations = iterations_of_fit;
  options.enough = 1e-28;
  options.hopeless = exact ? 1e-8 : -1.0;
  options.interrupt = interrupt;
  double beyond = std::numeric_limits<double>::infinity();
  for (int round = 0; round < rounds_of_limits; ++round) {
    SquaresResult result = least_squares_of_points(fit, {out.x.begin(), out.x.end()}, out.t, options);
    if (!std::isfinite(result.sum)) return {};
    out.x = as_unknowns(result.x);
    out.t = std::move(result.t);
    out.converged = result.converged;
    beyond = fit.tighten(out.x);
    if (beyond <= limits_kept) break;
    // What is not near after the first rounds is not brought nearer by more.
    if (exact && round >= 3 && sum_of(task, out) > 1e-6) break;
  }
  if (beyond > limits_kept) return {};
  out.sum = sum_of(task, out);
  if (exact) out.converged = out.sum <= passed;
  return out;
}

// A first fit, which ends where its sum falls slowly, and whose sum counts what is beyond the limits.
Fitted roughly_fitted(const PathFit::Task& task, const PathStart& start, const std::atomic<bool>* interrupt) {
  SquaresOptions options;
  options.iterations = iterations_of_rough_fit;
  options.hopeless = 0.0;
  options.interrupt = interrupt;
  SquaresResult result =
      least_squares_of_points(PathFit(task, start.closures), {start.x.begin(), start.x.end()}, start.t, options);
  return {as_unknowns(result.x), std::move(result.t), start.closures, result.sum, false};
}

PathStart with_links_of(const std::vector<double>& x, const std::vector<Vec2>& points) {
  const Vec2 first{x[4], x[5]}, second{x[6], x[7]};
  const Vec2 between = first - second;
  const double coupler = norm(between);
  FourBar linkage{{x[0], x[1]}, {x[2], x[3]}, std::abs(x[8]), coupler, std::abs(x[9]), {}};
  linkage.point = (1 / coupler) * (first * conj(between));
  PathStart out{unknowns_of(linkage), {}, {}};
  for (const PathVisit& visit : visits_of(PathLinkage::four_bar, out.x, points)) {
    out.t.push_back(visit.angle);
    out.closures.push_back(visit.closure);
  }
  return out;
}

// Both links of a four-bar by the condition that they keep their lengths: unknowns of LinkFit.
struct LinkStart {
  std::vector<double> x, turns;
};

LinkStart links_of(const PathStart& start) {
  const FourBar linkage = four_bar_of(start.x);
  LinkStart out;
  for (std::size_t i = 0; i < start.t.size(); ++i) {
    const auto pose = pose_of(linkage, start.t[i], start.closures[i]);
    out.turns.push_back(pose ? pose->coupler_angle : out.turns.empty() ? 0.0 : out.turns.back());
  }
  const double begin = out.turns.front();
  const Vec2 first = unit(begin);
  const Vec2 near = first * linkage.point, far = first * (linkage.point - Vec2{linkage.coupler, 0.0});
  out.x = {linkage.a.x, linkage.a.y, linkage.b.x, linkage.b.y,   near.x,
           near.y,      far.x,       far.y,       linkage.input, linkage.output};
  for (double& turn : out.turns) turn = std::remainder(turn - begin, 2 * std::numbers::pi);
  return out;
}

LinkStart random_links(const PathFit::Task& task, solvers::RandomStream& random) {
  constexpr double reach = 1.7;
  LinkStart out;
  for (int j = 0; j < 8; ++j) out.x.push_back(random.uniform(-reach, reach));
  if (task.pivots_given) std::copy_n(task.pivots.begin(), 4, out.x.begin());
  out.turns.push_back(0.0);
  const double most = task.pivots_given ? std::numbers::pi : 0.5 * std::numbers::pi;
  while (out.turns.size() < task.points.size()) out.turns.push_back(random.uniform(-most, most));
  for (const int link : {0, 1}) {
    const Vec2 pivot{out.x[2 * link], out.x[2 * link + 1]}, arm{out.x[4 + 2 * link], out.x[5 + 2 * link]};
    double sum = 0.0;
    for (std::size_t i = 0; i < task.points.size(); ++i) sum += norm(task.points[i] - unit(out.turns[i]) * arm - pivot);
    out.x.push_back(sum / static_cast<double>(task.points.size()));
  }
  return out;
}

// Each point may then have a closure of its own.
std::optional<PathStart> by_links(const PathFit::Task& task, LinkStart start, bool exact,
                                  const std::atomic<bool>* interrupt) {
  SquaresOptions options;
  options.iterations = exact ? iterations_of_fit : iterations_of_rough_fit;
  options.enough = 1e-28;
  options.hopeless = exact ? 1e-8 : 0.0;
  options.interrupt = interrupt;
  const LinkFit fit(task.points, task.pivots_given);
  const SquaresResult result = least_squares_of_points(fit, std::move(start.x), std::move(start.turns), options);
  if (!std::isfinite(result.sum) || (exact && result.sum > 1e-16)) return std::nullopt;
  PathStart out = with_links_of(result.x, task.points);
  for (const double value : out.x) {
    if (!std::isfinite(value)) return std::nullopt;
  }
  return out;
}

/// The points moved and scaled to size 1 about the origin.
class Normal {
 public:
  explicit Normal(const PathProblem& problem) : problem_(problem), size_(problem.size) {
    for (const Vec2& p : problem.points) mean_ += (1.0 / static_cast<double>(problem.points.size())) * p;
  }

  PathFit::Task task(const std::vector<Vec2>& points) const {
    PathFit::Task out;
    out.linkage = problem_.linkage;
    for (const Vec2& p : points) out.points.push_back(inside(p));
    out.timed = !problem_.crank.empty();
    out.start_free = problem_.start_free;
    out.from_ground = problem_.from_ground;
    out.limits = problem_.limits;
    out.limits.shortest /= size_;
    out.limits.longest /= size_;
    if (out.limits.within) {
      for (Vec2& corner : *out.limits.within) corner = inside(corner);
    }
    if (problem_.pivots) {
      out.pivots_given = true;
      const Vec2 a = inside((*problem_.pivots)[0]), b = inside((*problem_.pivots)[1]);
      out.pivots[at_a] = a.x;
      out.pivots[at_a + 1] = a.y;
      out.pivots[at_b] = b.x;
      out.pivots[at_b + 1] = b.y;
    }
    return out;
  }

  PathVector outside(PathVector x) const {
    for (const int pivot : {at_a, at_b}) {
      if (pivot == at_b && problem_.linkage == PathLinkage::slider_crank) {
        x[at_b + 1] *= size_;
        continue;
      }
      x[pivot] = size_ * x[pivot] + mean_.x;
      x[pivot + 1] = size_ * x[pivot + 1] + mean_.y;
    }
    for (const int link : {at_crank, at_coupler, at_output}) x[link] += std::log(size_);
    x[at_point] *= size_;
    x[at_point + 1] *= size_;
    if (problem_.pivots) {
      const auto& [a, b] = *problem_.pivots;
      x[at_a] = a.x;
      x[at_a + 1] = a.y;
      x[at_b] = b.x;
      x[at_b + 1] = b.y;
    }
    return x;
  }

 private:
  Vec2 inside(const Vec2& p) const { return (1 / size_) * (p - mean_); }

  const PathProblem& problem_;
  double size_;
  Vec2 mean_{};
};

class Searches {
 public:
  Searches(const PathFit::Task& task, const PathProblem& problem, std::vector<double> crank,
           const PathSearchOptions& options)
      : task_(task),
        crank_(std::move(crank)),
        exact_(problem.exact()),
        by_links_too_(task.linkage == PathLinkage::four_bar && !task.timed),
        // Where finitely many linkages pass the points more searches are needed to find one.
        linkages_(problem.freedom() == 0 && !problem.pivots ? 2 : 1),
        options_(options) {
    if (problem.closed && !exact_ && !problem.pivots) {
      table_ = curve_starts(task, options.seed, table_of_curves, std::min(starts_of_table, options.starts));
    }
  }

  /// From random linkages by distances and by links, and in exact tasks from random links.
  std::vector<Fitted> search(std::size_t item) const {
    constexpr std::uint32_t stream_of_starts = 1;
    solvers::RandomStream random(options_.seed, stream_of_starts, item);
    std::vector<Fitted> out;
    for (int k = 0; k < linkages_; ++k) {
      const std::optional<PathStart> start =
          item < table_.size() ? table_[item] : drawn_start(task_, crank_, random, draws_of_start);
      if (!start) continue;
      out.push_back(first_fit(*start));
      if (by_links_too_) add(links_of(*start), out);
    }
    for (int k = 0; by_links_too_ && exact_ && k < (task_.pivots_given ? 6 : 1); ++k) {
      add(random_links(task_, random), out);
    }
    return out;
  }

 private:
  void add(LinkStart links, std::vector<Fitted>& out) const {
    std::optional<PathStart> solved = by_links(task_, std::move(links), exact_, options_.interrupt);
    if (!solved) return;
    if (exact_) {
      // A crank that does not turn fully is told later, as a defect.
      PathFit::Task free = task_;
      free.limits.full_turn = false;
      out.push_back(fitted(free, *solved, exact_, options_.interrupt));
      if (!task_.limits.full_turn) return;
    }
    // One closure for all, which is what a crank can drive.
    const auto positive = std::count(solved->closures.begin(), solved->closures.end(), 1);
    const int most = 2 * positive >= static_cast<long>(solved->closures.size()) ? 1 : -1;
    std::fill(solved->closures.begin(), solved->closures.end(), most);
    out.push_back(first_fit(*solved));
  }

  Fitted first_fit(const PathStart& start) const {
    return exact_ ? fitted(task_, start, true, options_.interrupt) : roughly_fitted(task_, start, options_.interrupt);
  }

  const PathFit::Task& task_;
  std::vector<double> crank_;
  bool exact_, by_links_too_;
  int linkages_;
  const PathSearchOptions& options_;
  std::vector<PathStart> table_;
};

bool same_linkage(const PathVector& a, const PathVector& b, double size, double tolerance) {
  for (int j = 0; j < at_start; ++j) {
    const bool logarithm = j >= at_crank && j <= at_output;
    const double scale = logarithm ? 1.0 : std::max({size, std::abs(a[j]), std::abs(b[j])});
    if (!(std::abs(a[j] - b[j]) <= tolerance * scale)) return false;
  }
  return true;
}

std::vector<PathVector> representations(const PathProblem& problem, const PathVector& x) {
  if (problem.linkage != PathLinkage::four_bar || problem.pivots) return {x};
  std::vector<PathVector> out;
  for (const FourBar& linkage : same_curve(four_bar_of(x))) {
    if (linkage.input > 0.0 && linkage.coupler > 0.0 && linkage.output > 0.0) out.push_back(unknowns_of(linkage));
  }
  return out;
}

double ground_angle_of(const PathVector& x) { return std::atan2(x[at_b + 1] - x[at_a + 1], x[at_b] - x[at_a]); }

void judge(const PathProblem& problem, PathSolution& of) {
  of.range = crank_range(problem.linkage, of.x);
  double squares = 0.0;
  of.largest = 0.0;
  for (std::size_t i = 0; i < problem.points.size(); ++i) {
    const CouplerPlace pose = coupler_place(problem.linkage, of.x, of.visits[i].angle, of.visits[i].closure);
    const double distance = norm(pose.point - problem.points[i]) + pose.gap;
    squares += distance * distance;
    of.largest = std::max(of.largest, distance);
  }
  of.rms = std::sqrt(squares / static_cast<double>(problem.points.size()));
  const bool order = problem.order && problem.crank.empty() && !problem.curve;
  of.defects = defects_of(of.range, of.visits, order, problem.limits.full_turn);
  of.transmission = least_transmission(problem.linkage, of.x, of.range, of.visits);
  of.defects.transmission = of.transmission < problem.limits.transmission - least_angle;
}

void judge_curve(const PathProblem& problem, PathSolution& of) {
  const CurveLine wanted{problem.points, problem.closed};
  CurveLine drawn{{}, problem.closed};
  if (problem.closed) {
    for (const PathVisit& v : once_round(of.range, of.visits.front(), places_of_error)) {
      drawn.points.push_back(coupler_place(problem.linkage, of.x, v.angle, v.closure).point);
    }
  } else {
    const auto& [first, last] = std::pair(of.visits.front(), of.visits.back());
    // From one end to the other through the angles of the points between.
    double turn = 0.0;
    for (std::size_t i = 1; i < of.visits.size(); ++i) {
      turn += std::remainder(of.visits[i].angle - of.visits[i - 1].angle, 2 * std::numbers::pi);
    }
    for (int k = 0; k <= places_of_error; ++k) {
      const double angle = first.angle + turn * k / places_of_error;
      drawn.points.push_back(coupler_place(problem.linkage, of.x, angle, last.closure).point);
    }
  }
  double squares = 0.0;
  of.curve_largest = 0.0;
  for (const bool back : {false, true}) {
    for (const double d : curve_distances(back ? drawn : wanted, back ? wanted : drawn, places_of_error)) {
      squares += d * d;
      of.curve_largest = std::max(of.curve_largest, d);
    }
  }
  of.curve_rms = std::sqrt(squares / (2 * places_of_error));
}

double size_of_links(const PathVector& x) {
  return std::exp(x[at_crank]) + std::exp(x[at_coupler]) + std::exp(x[at_output]);
}

bool better(const PathProblem& problem, const PathSolution& a, const PathSolution& b) {
  if (a.defects.any() != b.defects.any()) return b.defects.any();
  // Those of the same curve differ by rounding only, which these 24 bits leave out.
  const auto error = [&](const PathSolution& of) {
    return of.largest <= problem.tolerance ? 0.0F : static_cast<float>(of.rms);
  };
  if (error(a) != error(b)) return error(a) < error(b);
  // Cognates have the same angle but for rounding.
  constexpr double digits = 1e6;
  const double angle_a = std::round(digits * a.transmission), angle_b = std::round(digits * b.transmission);
  if (angle_a != angle_b) return angle_a > angle_b;
  return size_of_links(a.x) < size_of_links(b.x);
}

// Whether the crank of another linkage of the same curve has the angles that are given; sets its first angle.
bool keeps_timing(const PathProblem& problem, PathSolution& of) {
  constexpr double same_angles = 1e-7;
  const double ground = problem.from_ground ? ground_angle_of(of.x) : 0.0;
  const double begin = of.visits.front().angle - ground - problem.crank.front();
  for (std::size_t i = 0; i < of.visits.size(); ++i) {
    const double off = of.visits[i].angle - ground - problem.crank[i] - (problem.start_free ? begin : 0.0);
    if (std::abs(std::remainder(off, 2 * std::numbers::pi)) > same_angles) return false;
  }
  if (problem.start_free) of.x[at_start] = begin;
  for (std::size_t i = 0; i < of.visits.size(); ++i) {
    of.visits[i].angle = problem.crank[i] + ground + (problem.start_free ? begin : 0.0);
  }
  judge(problem, of);
  return true;
}

// Of the linkages that draw the same curve the best one that keeps the limits.
std::optional<PathSolution> best_form(const PathProblem& problem, const PathVector& x, const Fitted& from) {
  std::optional<PathSolution> best;
  std::vector<Vec2> places;
  for (std::size_t i = 0; i < problem.points.size(); ++i) {
    double angle = from.t[i];
    if (!problem.crank.empty()) {
      angle = problem.crank[i] + (problem.start_free ? x[at_start] : 0.0);
      if (problem.from_ground) angle += ground_angle_of(x);
    }
    places.push_back(coupler_place(problem.linkage, x, angle, from.closures[i]).point);
    if (i == 0) best = PathSolution{x};
    best->visits.push_back({angle, from.closures[i]});
  }
  judge(problem, *best);
  best->converged = from.converged;
  for (const PathVector& form : representations(problem, x)) {
    PathLimits limits = problem.limits;
    limits.full_turn = false;
    const std::vector<double> beyond = beyond_limits(problem.linkage, form, limits);
    if (*std::max_element(beyond.begin(), beyond.end()) > 1e-8 * problem.size) continue;
    PathSolution next{form, visits_of(problem.linkage, form, places)};
    judge(problem, next);
    next.converged = from.converged;
    if (!problem.crank.empty() && !keeps_timing(problem, next)) continue;
    // Near a dead point the crank's angle of a place is known to fewer digits.
    const bool as_near = next.largest <= std::max(problem.tolerance, (1.0 + 1e-6) * best->largest);
    if (as_near && better(problem, next, *best)) best = std::move(next);
  }
  // The first angle within half a turn of 0.
  const double turns = 2 * std::numbers::pi * std::round(best->visits.front().angle / (2 * std::numbers::pi));
  for (PathVisit& visit : best->visits) visit.angle -= turns;
  if (problem.start_free) best->x[at_start] -= turns;
  return best;
}

std::vector<Vec2> thinned(const std::vector<Vec2>& points, std::vector<double>& crank) {
  if (points.size() <= points_of_search) return points;
  std::vector<Vec2> out;
  std::vector<double> angles;
  for (std::size_t k = 0; k < points_of_search; ++k) {
    const std::size_t at = k * (points.size() - 1) / (points_of_search - 1);
    out.push_back(points[at]);
    if (!crank.empty()) angles.push_back(crank[at]);
  }
  crank = std::move(angles);
  return out;
}

// The fit of few of the points is continued for all, each beginning at the nearest place of the curve.
Fitted refined(const PathFit::Task& all, const PathProblem& problem, const Fitted& few,
               const std::atomic<bool>* interrupt) {
  if (!std::isfinite(few.sum)) return {};
  PathStart start{few.x, {}, {}};
  if (all.timed) {
    start.t = problem.crank;
    start.closures.assign(all.points.size(), few.closures.front());
    return fitted(all, start, false, interrupt);
  }
  const CrankRange range = crank_range(all.linkage, few.x);
  const std::vector<PathVisit> places = once_round(range, {few.t.front(), few.closures.front()}, places_of_error);
  std::vector<Vec2> at;
  for (const PathVisit& v : places) at.push_back(coupler_place(all.linkage, few.x, v.angle, v.closure).point);
  for (const Vec2& p : all.points) {
    std::size_t nearest = 0;
    for (std::size_t k = 1; k < at.size(); ++k) {
      if (norm(at[k] - p) < norm(at[nearest] - p)) nearest = k;
    }
    start.t.push_back(places[nearest].angle);
    start.closures.push_back(places[nearest].closure);
  }
  return fitted(all, start, false, interrupt);
}

// The best of the first fits, continued to their ends, and then for all points where these were of few. After an
// interrupt each is still evaluated, and varied no more.
std::vector<Fitted> ended_fits(const Normal& normal, const PathFit::Task& task, const PathProblem& problem,
                               std::vector<Fitted> found, const PathSearchOptions& options) {
  const auto by_sum = [](const Fitted& a, const Fitted& b) { return a.sum < b.sum; };
  const solvers::ParallelOptions parallel{options.jobs, nullptr, {}};
  std::vector<Fitted> different;
  for (Fitted& fit : found) {
    if (!std::isfinite(fit.sum) || different.size() == fits_to_end) break;
    // Fits on their way to the same minimum.
    if (!different.empty() && fit.sum <= (1.0 + same_sums) * different.back().sum) continue;
    different.push_back(std::move(fit));
  }
  found = std::move(different);
  solvers::parallel_for(found.size(), parallel, [&](std::size_t k) {
    found[k] = fitted(task, {found[k].x, found[k].t, found[k].closures}, false, options.interrupt);
  });
  std::stable_sort(found.begin(), found.end(), by_sum);
  if (task.points.size() == problem.points.size()) return found;
  found.resize(std::min(found.size(), fits_of_all_points));
  PathFit::Task all = normal.task(problem.points);
  all.limits = task.limits;
  solvers::parallel_for(found.size(), parallel,
                        [&](std::size_t k) { found[k] = refined(all, problem, found[k], options.interrupt); });
  std::stable_sort(found.begin(), found.end(), by_sum);
  return found;
}

}  // namespace

std::vector<FourBar> same_curve(const FourBar& linkage) {
  std::vector<FourBar> out{linkage};
  for (const FourBar& cognate : roberts_cognates(linkage)) out.push_back(cognate);
  for (std::size_t k = 0; k < 3; ++k) {
    const FourBar& of = out[k];
    out.push_back({of.b, of.a, of.output, of.coupler, of.input, {of.coupler - of.point.x, -of.point.y}});
  }
  return out;
}

PathAnswer search_paths(const PathProblem& problem, const PathSearchOptions& options) {
  const Normal normal(problem);
  const bool exact = problem.exact();
  std::vector<double> crank = problem.crank;
  PathFit::Task task = normal.task(thinned(problem.points, crank));
  if (task.limits.full_turn) task.limits.margin_of_turn = margin_of_turn;
  const Searches searches(task, problem, std::move(crank), options);
  PathAnswer answer;
  std::vector<std::vector<Fitted>> by_start(static_cast<std::size_t>(options.starts));
  answer.starts =
      static_cast<int>(solvers::parallel_for(by_start.size(), {options.jobs, options.interrupt, options.progress},
                                             [&](std::size_t k) { by_start[k] = searches.search(k); }));
  std::vector<Fitted> found;
  for (std::vector<Fitted>& fits : by_start) {
    std::move(fits.begin(), fits.end(), std::back_inserter(found));
  }
  std::stable_sort(found.begin(), found.end(), [&](const Fitted& a, const Fitted& b) {
    // All that pass the points are the same at this place; their order is that of the starts.
    return (exact && a.sum <= passed ? 0.0 : a.sum) < (exact && b.sum <= passed ? 0.0 : b.sum);
  });
  if (!exact) found = ended_fits(normal, task, problem, std::move(found), options);
  for (const Fitted& fit : found) answer.converged += fit.converged ? 1 : 0;
  const double tolerance = exact ? 1e-5 : 1e-3;
  bool ended = false;
  std::vector<std::vector<PathVector>> known;
  for (const Fitted& fit : found) {
    if (!std::isfinite(fit.sum)) break;
    if (exact && fit.sum > passed && !answer.solutions.empty()) break;
    if (ended && !fit.converged) continue;
    const PathVector x = normal.outside(fit.x);
    const bool again = std::any_of(known.begin(), known.end(), [&](const std::vector<PathVector>& forms) {
      return std::any_of(forms.begin(), forms.end(),
                         [&](const PathVector& form) { return same_linkage(form, x, problem.size, tolerance); });
    });
    if (again) continue;
    known.push_back(representations(problem, x));
    std::optional<PathSolution> solution = best_form(problem, x, fit);
    // With a point at a dead point, to rounding, neither angle nor branch are known.
    if (solution && exact && solution->transmission < least_angle) solution.reset();
    if (solution) {
      if (problem.curve) judge_curve(problem, *solution);
      answer.within += solution->largest <= problem.tolerance ? 1 : 0;
      ended = ended || fit.converged;
      answer.solutions.push_back(std::move(*solution));
    }
  }
  std::stable_sort(answer.solutions.begin(), answer.solutions.end(),
                   [&](const PathSolution& a, const PathSolution& b) { return better(problem, a, b); });
  if (answer.solutions.size() > options.kept) answer.solutions.resize(options.kept);
  answer.interrupted = options.interrupt != nullptr && options.interrupt->load();
  return answer;
}

}  // namespace poise
