#include "statics/paths/private/path_crossings.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "solvers/cubic.hpp"
#include "solvers/root.hpp"
#include "statics/paths/private/tracing_steps.hpp"

namespace poise {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double shortest_split = 1e-5;  // rad and so on: steps are halved down to it to tell events apart
constexpr double pole_growth = 100.0;    // of multipliers, towards a dead centre

bool can_split(const PathSegment& segment) { return segment.h > shortest_split; }

}  // namespace

// --- along a segment ------------------------------------------------------------------------------------------------

double PathCrossings::arc(const PathSpot& a, const PathSpot& b) {
  const solvers::Curve& system = pieces_.curve(a.piece);
  const double chord = system.norm(b.point.z - a.point.z);
  const double half = 0.5 * std::acos(std::clamp(system.dot(a.point.tangent, b.point.tangent), -1.0, 1.0));
  return half > 1e-6 ? chord * half / std::sin(half) : chord;
}

// Hermite polynomial of degree 5 through the ends with their first and second derivatives, and a row across the curve.
void PathCrossings::interpolate(const PathSegment& segment, double s) {
  const solvers::CurvePoint &a = segment.a.point, &b = segment.b.point;
  const double h = segment.h, t = s / h, u = 1.0 - t;
  const double t3 = t * t * t, u3 = u * u * u;
  z_ =
      (u3 * (1 + t * (3 + 6 * t))) * a.z + (h * u3 * t * (1 + 3 * t)) * a.tangent + (0.5 * h * h * u3 * t * t) * a.bend;
  z_ +=
      (t3 * (1 + u * (3 + 6 * u))) * b.z - (h * t3 * u * (1 + 3 * u)) * b.tangent + (0.5 * h * h * t3 * u * u) * b.bend;
  row_ = u * a.tangent + t * b.tangent;
  row_ = pieces_.curve(segment.a.piece).without_multipliers(std::move(row_));
}

std::optional<PathSpot> PathCrossings::at(const PathSegment& segment, double s) {
  solvers::Curve& system = pieces_.curve(segment.a.piece);
  interpolate(segment, s);
  PathSpot out = segment.a;
  out.point.z = z_;
  if (!system.correct(out.point.z, row_).converged || !system.differentiate(out.point, row_)) return std::nullopt;
  if (system.norm(out.point.z - z_) > tracing::largest_deviation * segment.h) return std::nullopt;
  out.negative = s < 0.5 * segment.h ? segment.a.negative : segment.b.negative;
  return out;
}

bool PathCrossings::place(const PathSegment& segment, double s, PathSpot& spot) {
  interpolate(segment, s);
  spot.point.z = z_;
  return pieces_.curve(segment.a.piece).correct(spot.point.z, row_).converged;
}

std::optional<PathCrossings::Root> PathCrossings::root(const PathSegment& segment, double from, double h,
                                                       const Function& f, double fa, double fb) {
  std::optional<PathSpot> spot;
  const auto value = [&](double s) -> std::optional<double> {
    spot = at(segment, from + s);
    if (!spot) return std::nullopt;
    return f(*spot);
  };
  const std::optional<double> s = solvers::root_by_secants(value, {0.0, h}, fa, fb, 1e-15 * h);
  if (!s) return std::nullopt;
  return Root{*s, std::move(*spot)};
}

// --- folds and branch points ----------------------------------------------------------------------------------------

std::optional<PathSpot> PathCrossings::fold(const PathSegment& segment, double& s) {
  solvers::Curve& system = pieces_.curve(segment.a.piece);
  std::optional<PathSpot> spot;
  const auto rate = [&](double place) -> std::optional<solvers::ValueAndSlope> {
    spot = at(segment, place);
    if (!spot) return std::nullopt;
    const VectorXd bend = system.bend(spot->point);
    return solvers::ValueAndSlope{spot->rate(), bend[bend.size() - 1]};
  };
  const double begin = segment.a.rate(), end = segment.b.rate();
  const auto found = solvers::root_by_newton(rate, {0.0, segment.h}, segment.h * begin / (begin - end), begin > 0.0,
                                             {.step = 1e-14, .width = 1e-14, .steps = 40});
  if (!found) return std::nullopt;
  s = *found;
  return spot;
}

std::optional<PathSpot> PathCrossings::branch_point(const PathSegment& segment, double& s, bool& is_pole) {
  solvers::Curve& system = pieces_.curve(segment.a.piece);
  const bool dense = system.unknowns() <= solvers::Curve::spectrum_limit;
  std::optional<PathSpot> best;
  const double width = (dense ? 1e-4 : 1e-12) * segment.h;
  solvers::Bracket bracket{0.0, segment.h};
  const auto is_before = [&](double& place) -> std::optional<bool> {
    best = at(segment, place);
    if (!best) best = at(segment, place = bracket.from + 0.4987 * (bracket.to - bracket.from));
    if (!best) return std::nullopt;
    s = place;
    return best->point.orientation == segment.a.point.orientation;
  };
  solvers::bisect(bracket, is_before, [&](const solvers::Bracket& at) { return at.width() <= width; });
  if (!best) return best;
  // The determinant also changes its sign through infinity, where multipliers do: a dead centre.
  is_pole = system.active().size() > 0 &&
            pieces_.heaviest_multiplier(*best) > pole_growth * (1.0 + std::max(pieces_.heaviest_multiplier(segment.a),
                                                                               pieces_.heaviest_multiplier(segment.b)));
  if (is_pole || !dense) return best;
  PathSpot found = *best;
  const double last = system.find_branch_point(found.point.z);
  if (!(last < 1e-7) || system.norm(found.point.z - best->point.z) > 100 * width + 1e-6) return std::nullopt;
  return found;
}

std::optional<PathSpot> PathCrossings::multiple_point(const PathSegment& segment, double& s) {
  solvers::Curve& system = pieces_.curve(segment.a.piece);
  std::optional<PathSpot> best;
  const auto is_before = [&](double place) -> std::optional<bool> {
    std::optional<PathSpot> spot = at(segment, place);
    if (!spot) return std::nullopt;
    s = place;
    best = std::move(spot);
    return system.negative_directions(best->point.z) == segment.a.negative;
  };
  solvers::Bracket bracket{0.0, segment.h};
  solvers::bisect_at_most(50, bracket, is_before);
  return best;
}

// --- all crossings --------------------------------------------------------------------------------------------------

bool PathCrossings::find(const PathSegment& segment, const std::vector<PathPieces::Watched>& before,
                         const std::vector<PathPieces::Watched>& after, const PathSpot* start,
                         std::vector<PathCrossing>& out) {
  if (!find_ends_of_piece(segment, before, after, out)) return false;
  if (!find_folds(segment, out) || !find_branches(segment, out) || !find_multiples(segment, out)) return false;
  if (!find_end_of_range(segment, 0.0, out) || !find_end_of_range(segment, 1.0, out)) return false;
  if (start != nullptr) find_start(segment, *start, out);
  return true;
}

// Finds where stops and springs change.
bool PathCrossings::find_ends_of_piece(const PathSegment& segment, const std::vector<PathPieces::Watched>& before,
                                       const std::vector<PathPieces::Watched>& after, std::vector<PathCrossing>& out) {
  const double h = segment.h;
  for (std::size_t k = 0; k < before.size(); ++k) {
    const PathPieces::Watched &at_a = before[k], &at_b = after[k];
    if (std::isinf(at_a.value) || std::isinf(at_b.value)) continue;
    if (at_b.value >= -tracing::overrun) {
      const bool may_dip = at_a.value > tracing::overrun && at_a.smooth_rate < 0.0 && at_b.smooth_rate > 0.0;
      if (can_split(segment) && may_dip &&
          solvers::Cubic(at_a.smooth, at_a.smooth_rate, at_b.smooth, at_b.smooth_rate, h).least() < 0.0) {
        return false;
      }
      continue;
    }
    if (at_a.value <= tracing::overrun && at_a.rate > 0.0 && can_split(segment)) return false;
    PathCrossing crossing{PathCrossing::Kind::watched, 0.0, static_cast<int>(k), segment.a};
    if (at_a.value > 0.0) {
      std::vector<PathPieces::Watched> between;
      const auto value = [&](const PathSpot& spot) {
        pieces_.watch(spot, between);
        return between[k].value;
      };
      auto found = root(segment, 0.0, h, value, at_a.value, at_b.value);
      if (!found) return false;
      crossing.s = found->s;
      crossing.spot = std::move(found->spot);
    }
    out.push_back(std::move(crossing));
  }
  return true;
}

bool PathCrossings::find_folds(const PathSegment& segment, std::vector<PathCrossing>& out) {
  const double ra = segment.a.rate(), rb = segment.b.rate();
  if (!(std::abs(ra) > tracing::standstill || std::abs(rb) > tracing::standstill)) return true;
  if ((ra > 0.0) != (rb > 0.0)) {
    PathCrossing crossing{PathCrossing::Kind::fold};
    std::optional<PathSpot> spot = fold(segment, crossing.s);
    if (!spot) return false;
    crossing.spot = std::move(*spot);
    out.push_back(std::move(crossing));
    return true;
  }
  if (!can_split(segment)) return true;
  // The parameter's rate, a parabola through both ends and with the right mean: does it vanish twice?
  const double mean = (segment.b.p() - segment.a.p()) / segment.h;
  const double middle = 1.5 * mean - 0.25 * (ra + rb);
  return (middle > 0.0) == (ra > 0.0);
}

bool PathCrossings::find_branches(const PathSegment& segment, std::vector<PathCrossing>& out) {
  if (segment.a.point.orientation == segment.b.point.orientation) return true;
  PathCrossing crossing{PathCrossing::Kind::branch};
  bool is_pole = false;
  std::optional<PathSpot> spot = branch_point(segment, crossing.s, is_pole);
  if (!spot) return false;
  crossing.spot = std::move(*spot);
  if (is_pole) crossing.kind = PathCrossing::Kind::dead_centre;
  out.push_back(std::move(crossing));
  return true;
}

// Finds where eigenvalues change their sign of which folds and branch points, found before, tell nothing.
bool PathCrossings::find_multiples(const PathSegment& segment, std::vector<PathCrossing>& out) {
  const PathSpot &a = segment.a, &b = segment.b;
  const auto known = static_cast<int>(std::count_if(
      out.begin(), out.end(), [](const PathCrossing& c) { return c.kind != PathCrossing::Kind::watched; }));
  const int change = b.negative - a.negative;
  const bool is_unexplained =
      a.negative >= 0 && b.negative >= 0 && change != 0 && std::abs(change) != known && (change + known) % 2 == 0 &&
      pieces_.curve(a.piece).unknowns() <= solvers::Curve::spectrum_limit && pieces_.curve(a.piece).symmetric();
  if (!is_unexplained) return true;
  if (can_split(segment)) return false;
  PathCrossing crossing{PathCrossing::Kind::multiple};
  std::optional<PathSpot> spot = multiple_point(segment, crossing.s);
  if (!spot) return false;
  crossing.spot = std::move(*spot);
  out.push_back(std::move(crossing));
  return true;
}

// Finds where the parameter reaches an end of its range, 0 or 1.
bool PathCrossings::find_end_of_range(const PathSegment& segment, double limit, std::vector<PathCrossing>& out) {
  const PathSpot &a = segment.a, &b = segment.b;
  const double h = segment.h, ra = a.rate(), rb = b.rate();
  const auto beyond_limit = [limit](const PathSpot& spot) { return limit == 0.0 ? -spot.p() : spot.p() - 1.0; };
  const double beyond = beyond_limit(b);
  if (beyond < 0.0 || (beyond == 0.0 && (limit == 0.0) == (rb > 0.0))) return true;
  double begin = beyond_limit(a);
  double from = 0.0;
  if (begin >= 0.0 && (limit == 0.0) == (ra > 0.0) && std::abs(ra) > tracing::standstill) {
    // It leads into the range, and out again behind a fold.
    const auto fold = std::find_if(
        out.begin(), out.end(), [](const PathCrossing& crossing) { return crossing.kind == PathCrossing::Kind::fold; });
    if (fold == out.end() && can_split(segment)) return false;
    if (fold != out.end()) {
      from = fold->s;
      begin = beyond_limit(fold->spot);
    }
  }
  if (begin >= 0.0) {
    out.push_back({PathCrossing::Kind::range, from, -1, a});
    return true;
  }
  auto found = root(segment, from, h - from, beyond_limit, begin, std::max(beyond, 1e-300));
  if (!found) return false;
  PathCrossing crossing{PathCrossing::Kind::range, from + found->s, -1, std::move(found->spot)};
  if (std::optional<PathSpot> spot = pieces_.at_parameter(crossing.spot, limit)) crossing.spot = std::move(*spot);
  VectorXd& z = crossing.spot.point.z;
  z[z.size() - 1] = limit;
  out.push_back(std::move(crossing));
  return true;
}

// Finds where the curve is back at the start of the branch, perhaps after whole turns.
void PathCrossings::find_start(const PathSegment& segment, const PathSpot& start, std::vector<PathCrossing>& out) {
  const PathSpot &a = segment.a, &b = segment.b;
  const double h = segment.h;
  if (start.piece != a.piece || !(std::abs(b.p() - start.p()) < 1.5 * h)) return;
  solvers::Curve& system = pieces_.curve(a.piece);
  const Index n = system.variables();
  const auto coordinates = [&](const PathSpot& spot) {
    return std::vector<double>(spot.point.z.data(), spot.point.z.data() + n);
  };
  const std::vector<double> turned =
      pieces_.unwound(coordinates(start), coordinates(b), PathPieces::Turns::forces_and_stops);
  VectorXd origin = start.point.z;
  origin.head(n) = VectorXd::Map(turned.data(), n);
  const VectorXd& t = start.point.tangent;
  const double fa = system.dot(a.point.z - origin, t), fb = system.dot(b.point.z - origin, t);
  if (!(fa < 0.0 && fb >= 0.0 && system.norm(b.point.z - origin) < 1.5 * h)) return;
  const auto along = [&](const PathSpot& spot) { return system.dot(spot.point.z - origin, t); };
  auto found = root(segment, 0.0, h, along, fa, std::max(fb, 1e-300));
  if (!found || !(system.norm(found->spot.point.z - origin) < tracing::same_point)) return;
  out.push_back({PathCrossing::Kind::start, found->s, -1, std::move(found->spot)});
}
}  // namespace poise
