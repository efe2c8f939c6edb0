#include "statics/path_tracer.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <utility>

#include <fmt/format.h>

#include "solvers/cubic.hpp"
#include "solvers/root.hpp"
#include "solvers/vectors.hpp"
#include "statics/curvature.hpp"
#include "statics/event_accuracy.hpp"
#include "statics/tracing_steps.hpp"

namespace poise {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Distances along the curve: rad, mechanism sizes, parts of the parameter's range.
constexpr double first_step = 0.01;
constexpr double shortest_split = 1e-5;    // steps are halved down to it to tell events apart
constexpr double standstill = 1e-9;        // rate of the parameter below which it does not vary
constexpr double pole_growth = 100.0;      // of multipliers, towards a dead centre
constexpr double heavy_multipliers = 1e3;  // in the model's unit of force, next to a dead centre
constexpr double farthest_turn = 100.0;    // rad, of a mechanism that has not run away
constexpr double farthest_travel = 20.0;   // mechanism sizes, the same
constexpr double taken_apart = 1e-9;       // gap of joints that repeat others
constexpr double same_pose = 1e-9;         // of forces and measures after whole turns
constexpr double departure = 1e-3;         // radius of the sphere on which curves leave a branch point
constexpr int most_switches = 8;           // of pieces at one point

}  // namespace

// Two spots of a piece, h apart.
struct PathTracer::Segment {
  PathSpot a, b;
  double h;
};

// An event between the ends of a segment.
struct PathTracer::Crossing {
  enum class Kind { fold, branch, multiple, watched, range, start, dead_centre } kind;
  double s = 0.0;
  int watched = -1;
  PathSpot spot{};
};

PathTracer::PathTracer(const VariedScene& varied, const PathOptions& options, Path& out)
    : varied_(varied), options_(options), out_(out), one_way_(VariedMechanism::one_way_springs(varied.scene())) {
  for (const double value : options.at) wanted_.push_back(varied.part_at(value));
}

PathTracer::~PathTracer() = default;

int PathTracer::evaluations() const {
  int sum = 0;
  for (const auto& [piece, curve] : curves_) sum += curve->evaluations();
  return sum;
}

// SI. What is zero but for the rounding of p is zero: equilibria are neutral exactly there, if at all.
double PathTracer::value_at(double p) const {
  const double value = varied_.value_at(p);
  return std::abs(value) <= 0x1p-51 * std::max(std::abs(varied_.from()), std::abs(varied_.to())) ? 0.0 : value;
}

// --- pieces ---------------------------------------------------------------------------------------------------------

solvers::Curve& PathTracer::curve(const PathPiece& piece) {
  std::unique_ptr<solvers::Curve>& made = curves_[piece];
  if (made) return *made;
  std::unique_ptr<VariedMechanism>& mechanism = mechanisms_[piece.acts];
  if (!mechanism) mechanism = std::make_unique<VariedMechanism>(varied_, piece.acts);
  made = std::make_unique<solvers::Curve>(*mechanism, active_rows(piece, equalities_, mechanism->equalities()));
  return *made;
}

PathSpot PathTracer::guess(const std::vector<double>& x, double p, const std::vector<int>& active_stops) {
  const auto model = varied_.model_at(value_at(p));
  const Mechanism<double>& m = model->mechanism();
  angles_ = m.layout().angles;
  if (equalities_.empty()) equalities_ = independent_closures(m, x);
  has_left_out_ = static_cast<int>(equalities_.size()) < m.equalities();
  PathSpot out;
  out.piece = piece_at(*model, x, active_stops);
  std::vector<int> rows;
  for (const solvers::ActiveRow& active : active_rows(out.piece, equalities_, m.equalities())) {
    rows.push_back(active.row);
  }
  solvers::Curve& system = curve(out.piece);
  VectorXd& z = out.point.z;
  z.resize(system.unknowns());
  z.head(m.coordinates()) = VectorXd::Map(x.data(), m.coordinates());
  if (m.coordinates() <= solvers::Curve::spectrum_limit) {
    const DensePoint<double> point(m, x, rows);
    z.segment(m.coordinates(), static_cast<Index>(rows.size())) = point.multipliers();
  } else {
    z.segment(m.coordinates(), static_cast<Index>(rows.size())).setZero();
  }
  z[z.size() - 1] = p;
  return out;
}

std::optional<PathSpot> PathTracer::spot(const std::vector<double>& x, double p, const std::vector<int>& active_stops,
                                         double direction) {
  PathSpot out = guess(x, p, active_stops);
  solvers::Curve& system = curve(out.piece);
  VectorXd& z = out.point.z;
  const VectorXd along = direction * VectorXd::Unit(z.size(), z.size() - 1);
  // At a fold the parameter cannot be held: the point is there already.
  if (!system.correct(z, along).converged || !system.differentiate_at(out.point, along)) return std::nullopt;
  system.estimate_bend(out.point);
  out.negative = system.negative_directions(z);
  return out;
}

std::optional<std::vector<double>> PathTracer::deflated(const std::vector<double>& x, double p,
                                                        const std::vector<PathSpot>& known, int steps) {
  PathSpot out = guess(x, p, {});
  std::vector<VectorXd> places;
  for (const PathSpot& spot : known) places.push_back(spot.point.z);
  if (!curve(out.piece).deflate(out.point.z, places, steps)) return std::nullopt;
  return report(out).x;
}

PathPoint PathTracer::report(const PathSpot& spot, bool critical) const {
  PathPoint out;
  if (critical) out.proof = PointProof::critical;
  const solvers::Curve& system = *curves_.at(spot.piece);
  out.parameter = value_at(spot.p());
  out.x.assign(spot.point.z.data(), spot.point.z.data() + system.variables());
  out.unstable_directions = std::max(0, spot.negative);
  out.stability = spot.negative > 0 ? Stability::unstable : spot.negative == 0 ? Stability::stable : Stability::unknown;
  // Loads that follow bodies may make it flutter.
  const int freedoms = system.variables() - static_cast<int>(system.active().size());
  if (!system.symmetric() && freedoms > 1 && out.stability == Stability::stable) out.stability = Stability::unknown;
  out.active_stops = active_stops(spot.piece, varied_.is_driven());
  out.slack_springs = slack_springs(spot.piece, one_way_);
  if (varied_.is_driven()) {
    // The last multiplier; a torque scales as work.
    const bool is_angle = varied_.scene().stops.back().on.is_angle();
    const double scale = is_angle ? varied_.scales().energy() : varied_.scales().force;
    out.effort = -spot.point.z[spot.point.z.size() - 2] * scale;
  }
  return out;
}

// What must stay positive on a piece: gaps of free stops (two each), pushes of active ones, and how far one-way springs
// are from their free length; infinite where nothing is watched.
void PathTracer::watch(const PathSpot& spot, std::vector<Watched>& out) {
  const std::size_t stops = spot.piece.side.size();
  out.assign(2 * stops + one_way_.size(), {});
  if (out.empty()) return;
  solvers::Curve& system = curve(spot.piece);
  std::vector<solvers::Curve::Room> rooms;
  system.rooms(spot.point, rooms);
  // A distance passes its least value in a sharp bend, half its square does not: (g^2 - b^2) / 2 with the gap e = g - b
  // is e (2 g - e) / 2.
  const auto above = [](const solvers::Curve::Room& room, bool is_distance) {
    Watched w{room.lower, room.lower_rate, room.lower, room.lower_rate};
    if (is_distance) {
      w.smooth = 0.5 * room.lower * (2 * room.value - room.lower);
      w.smooth_rate = room.value * room.rate - (room.value - room.lower) * (room.rate - room.lower_rate);
    }
    return w;
  };
  const auto below = [](const solvers::Curve::Room& room, bool is_distance) {
    Watched w{room.upper, room.upper_rate, room.upper, room.upper_rate};
    if (is_distance && std::isfinite(room.upper)) {
      w.smooth = 0.5 * room.upper * (2 * room.value + room.upper);
      w.smooth_rate = (room.value + room.upper) * (room.rate + room.upper_rate) - room.value * room.rate;
    }
    return w;
  };
  Index y = system.variables() + static_cast<Index>(equalities_.size());
  for (std::size_t s = 0; s < stops; ++s) {
    const signed char side = spot.piece.side[s];
    const bool is_distance = varied_.scene().stops[s].on.kind == Measure::Kind::distance;
    if (side != 0) {
      const bool both = rooms[s].lower + rooms[s].upper == 0.0 || (varied_.is_driven() && s + 1 == stops);
      const double push = side * spot.point.z[y], rate = side * spot.point.tangent[y];
      if (!both) out[2 * s + (side > 0 ? 1 : 0)] = {push, rate, push, rate};
      ++y;
      continue;
    }
    out[2 * s] = above(rooms[s], is_distance);
    out[2 * s + 1] = below(rooms[s], is_distance);
  }
  for (std::size_t k = 0; k < one_way_.size(); ++k) {
    const Element& element = varied_.scene().elements[one_way_[k]];
    const auto& spring = std::get<LinearSpring>(element.law);
    const bool is_above = (spring.acts == LinearSpring::Acts::tension) == (spot.piece.acts[k] != 0);
    Watched w = above(rooms[stops + k], element.on.kind == Measure::Kind::distance);
    if (!is_above) w = {-w.value, -w.rate, -w.smooth, -w.smooth_rate};
    out[2 * stops + k] = w;
  }
}

// The unknowns of one piece as those of another: multipliers of rows that are not active there are left out, those of
// rows that come on are zero.
VectorXd PathTracer::mapped(const VectorXd& z, const PathPiece& from_piece, const PathPiece& to_piece) {
  const solvers::Curve& from = curve(from_piece);
  const solvers::Curve& to = curve(to_piece);
  const Index n = from.variables();
  VectorXd out = VectorXd::Zero(to.unknowns());
  out.head(n) = z.head(n);
  out[out.size() - 1] = z[z.size() - 1];
  std::map<int, double> multiplier;
  for (std::size_t k = 0; k < from.active().size(); ++k) {
    multiplier[from.active()[k].row] = z[n + static_cast<Index>(k)];
  }
  for (std::size_t k = 0; k < to.active().size(); ++k) {
    const auto known = multiplier.find(to.active()[k].row);
    if (known != multiplier.end()) out[n + static_cast<Index>(k)] = known->second;
  }
  return out;
}

// The same point on the piece beyond the one that `watched` bounds, with the tangent that leads into it.
std::optional<PathSpot> PathTracer::switched(const PathSpot& spot, int watched) {
  const int stops = static_cast<int>(spot.piece.side.size());
  PathSpot out;
  out.piece = spot.piece;
  if (watched < 2 * stops) {
    signed char& side = out.piece.side[watched / 2];
    side = side != 0 ? 0 : watched % 2 == 0 ? -1 : 1;
  } else {
    out.piece.acts[watched - 2 * stops] ^= 1;
  }
  solvers::Curve& to = curve(out.piece);
  out.point.z = mapped(spot.point.z, spot.piece, out.piece);
  VectorXd like = mapped(spot.point.tangent, spot.piece, out.piece);
  if (to.unknowns() <= solvers::Curve::spectrum_limit) {
    const MatrixXd null = to.null_vectors(out.point.z, 1e-9, 1);
    if (null.cols() != 1 || !(to.norm(null.col(0)) > 1e-12)) return std::nullopt;
    like = null.col(0) / to.norm(null.col(0));
  }
  if (!to.differentiate_at(out.point, like)) return std::nullopt;
  to.estimate_bend(out.point);
  std::vector<Watched> beyond;
  // The row that was watched is watched from the other side now.
  watch(out, beyond);
  if (beyond[watched].rate < 0.0) out.reverse();
  out.negative = to.negative_directions(out.point.z);
  return out;
}

std::vector<double> PathTracer::unwound(const std::vector<double>& x, const std::vector<double>& near, Turns turns) {
  if (!somewhere_) somewhere_ = varied_.model_at(value_at(0.5));
  const Mechanism<double>& m = somewhere_->mechanism();
  std::vector<double> out = x;
  for (int k = 0; k < m.layout().angles; ++k) out[k] += 2 * M_PI * std::round((near[k] - x[k]) / (2 * M_PI));
  if (out == x) return out;
  const auto values_at = [&](const std::vector<double>& at) {
    std::vector<Planar<double>> pose(m.pose_size());
    VectorXd values(m.coordinates() + m.constraints());
    m.place(at.data(), pose.data());
    m.negative_force(at.data(), pose.data(), values.data());
    m.constraint(at.data(), pose.data(), values.data() + m.coordinates());
    if (turns == Turns::forces) values.tail(m.stops()).setZero();
    return values;
  };
  return (values_at(out) - values_at(x)).cwiseAbs().maxCoeff() < same_pose ? out : x;
}

bool PathTracer::depends(const PathSpot& spot) {
  solvers::Curve& system = curve(spot.piece);
  // Beside the spot: a load along a straight column changes nothing on it.
  VectorXd beside = spot.point.z;
  for (int i = 0; i < system.variables(); ++i) beside[i] += 0.1 * std::sin(1.0 + i);
  return system.depends_on_parameter(beside);
}

double PathTracer::heaviest_multiplier(const PathSpot& spot) {
  const solvers::Curve& system = curve(spot.piece);
  return system.active().empty()
             ? 0.0
             : spot.point.z.segment(system.variables(), spot.point.z.size() - system.variables() - 1)
                   .lpNorm<Eigen::Infinity>();
}

bool PathTracer::is_far(const PathSpot& spot) {
  const Index n = curve(spot.piece).variables();
  const auto largest = [](const auto& part) { return part.size() > 0 ? part.cwiseAbs().maxCoeff() : 0.0; };
  return largest(spot.point.z.head(angles_)) > farthest_turn ||
         largest(spot.point.z.segment(angles_, n - angles_)) > farthest_travel;
}

// Whether a fold is, but for whole turns, one that the branch has passed before.
bool PathTracer::repeats(const PathSpot& fold) {
  const PathPoint here = report(fold);
  const double range = std::abs(varied_.to() - varied_.from());
  for (const int e : out_.branches[branch_].events) {
    const PathEvent& event = out_.events[e];
    if (event.kind != PathEvent::Kind::fold || event.at.active_stops != here.active_stops) continue;
    if (std::abs(event.at.parameter - here.parameter) > same_pose * range) continue;
    const std::vector<double> x = unwound(here.x, event.at.x, Turns::forces);
    if (solvers::largest_difference(x, event.at.x) < tracing::same_point) return true;
  }
  return false;
}

// --- along a segment ------------------------------------------------------------------------------------------------

// Hermite polynomial of degree 5 through the ends with their first and second derivatives, and a row across the curve.
void PathTracer::interpolate(const Segment& segment, double s) {
  const solvers::CurvePoint &a = segment.a.point, &b = segment.b.point;
  const double h = segment.h, t = s / h, u = 1.0 - t;
  const double t3 = t * t * t, u3 = u * u * u;
  z_ =
      (u3 * (1 + t * (3 + 6 * t))) * a.z + (h * u3 * t * (1 + 3 * t)) * a.tangent + (0.5 * h * h * u3 * t * t) * a.bend;
  z_ +=
      (t3 * (1 + u * (3 + 6 * u))) * b.z - (h * t3 * u * (1 + 3 * u)) * b.tangent + (0.5 * h * h * t3 * u * u) * b.bend;
  row_ = u * a.tangent + t * b.tangent;
  row_ = curve(segment.a.piece).without_multipliers(std::move(row_));
}

std::optional<PathSpot> PathTracer::at(const Segment& segment, double s) {
  solvers::Curve& system = curve(segment.a.piece);
  interpolate(segment, s);
  PathSpot out = segment.a;
  out.point.z = z_;
  if (!system.correct(out.point.z, row_).converged || !system.differentiate(out.point, row_)) return std::nullopt;
  if (system.norm(out.point.z - z_) > tracing::largest_deviation * segment.h) return std::nullopt;
  out.negative = s < 0.5 * segment.h ? segment.a.negative : segment.b.negative;
  return out;
}

// Root of f on a segment, of opposite signs at its ends.
namespace {
struct RootOnSegment {
  double s;
  PathSpot spot;
};
template <class At, class F>
std::optional<RootOnSegment> root_on_segment(At at, F f, double h, double fa, double fb) {
  std::optional<PathSpot> spot;
  const auto value = [&](double s) -> std::optional<double> {
    spot = at(s);
    if (!spot) return std::nullopt;
    return f(*spot);
  };
  const std::optional<double> s = solvers::root_by_secants(value, {0.0, h}, fa, fb, 1e-15 * h);
  if (!s) return std::nullopt;
  return RootOnSegment{*s, std::move(*spot)};
}
}  // namespace

std::optional<PathSpot> PathTracer::find_fold(const Segment& segment, double& s) {
  solvers::Curve& system = curve(segment.a.piece);
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

std::optional<PathSpot> PathTracer::find_branch(const Segment& segment, double& s, bool& is_pole) {
  solvers::Curve& system = curve(segment.a.piece);
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
            heaviest_multiplier(*best) >
                pole_growth * (1.0 + std::max(heaviest_multiplier(segment.a), heaviest_multiplier(segment.b)));
  if (is_pole || !dense) return best;
  PathSpot found = *best;
  const double last = system.find_branch_point(found.point.z);
  if (!(last < 1e-7) || system.norm(found.point.z - best->point.z) > 100 * width + 1e-6) return std::nullopt;
  return found;
}

// Where several eigenvalues change their sign together.
std::optional<PathSpot> PathTracer::find_multiple(const Segment& segment, double& s) {
  solvers::Curve& system = curve(segment.a.piece);
  std::optional<PathSpot> best;
  const auto is_before = [&](double place) -> std::optional<bool> {
    std::optional<PathSpot> spot = at(segment, place);
    if (!spot) return std::nullopt;
    s = place;
    best = std::move(spot);
    return system.negative_directions(best->point.z) == segment.a.negative;
  };
  solvers::Bracket bracket{0.0, segment.h};
  int halvings = 0;
  solvers::bisect(bracket, is_before, [&](const solvers::Bracket&) { return halvings++ == 50; });
  return best;
}

// The spot with the parameter held at p, nearly where it is already; empty where Newton's method leads elsewhere.
std::optional<PathSpot> PathTracer::held(const PathSpot& spot, double p) {
  solvers::Curve& system = curve(spot.piece);
  PathSpot out = spot;
  VectorXd& z = out.point.z;
  z[z.size() - 1] = p;
  const bool found = system.correct(z, VectorXd::Unit(z.size(), z.size() - 1)).converged &&
                     system.norm(z - spot.point.z) < tracing::same_point;
  return found ? std::optional(std::move(out)) : std::nullopt;
}

void PathTracer::add_point(const PathSpot& spot, bool critical) {
  out_.branches[branch_].points.push_back(report(spot, critical));
  if (options_.progress && out_.branches[branch_].points.size() % 64 == 0) {
    options_.progress(out_.branches[branch_].points.back().parameter,
                      static_cast<int>(out_.branches[branch_].points.size()));
  }
}

// Points between two places of a segment, ends left out, and those at wanted parameters, with the end.
void PathTracer::fill(const Segment& segment, double from, double to, const PathSpot& begin, const PathSpot& end) {
  for (std::size_t k = 0; k < wanted_.size(); ++k) {
    const double w = wanted_[k];
    const double fa = begin.p() - w, fb = end.p() - w;
    if (fb == 0.0) {
      out_.wanted[k].push_back(report(end));
      continue;
    }
    if (fa == 0.0 || (fa > 0.0) == (fb > 0.0)) continue;
    auto found = root_on_segment([&](double s) { return at(segment, from + s); },
                                 [&](const PathSpot& q) { return q.p() - w; }, to - from, fa, fb);
    if (!found) continue;
    std::optional<PathSpot> spot = held(found->spot, w);
    if (!spot) continue;
    spot->negative = begin.negative;
    PathPoint point = report(*spot);
    point.parameter = options_.at[k];
    out_.wanted[k].push_back(std::move(point));
  }
  const int parts = static_cast<int>(std::ceil((to - from) / options_.spacing));
  if (parts < 2) return;
  solvers::Curve& system = curve(segment.a.piece);
  PathSpot spot = begin;
  for (int k = 1; k < parts; ++k) {
    interpolate(segment, from + (to - from) * k / parts);
    spot.point.z = z_;
    if (system.correct(spot.point.z, row_).converged) add_point(spot);
  }
}

// --- events ---------------------------------------------------------------------------------------------------------

int PathTracer::add_event(PathEvent event, int branch) {
  const int index = static_cast<int>(out_.events.size());
  out_.events.push_back(std::move(event));
  out_.branches[branch].events.push_back(index);
  return index;
}

int PathTracer::add_event(PathEvent event, const PathSpot& spot) {
  event.at = report(spot, true);
  return add_event(std::move(event), branch_);
}

// First-order distance of the parameter of an event from the exact one, as parts of its value: of a fold, or of a
// change of what is watched, where balance holds with the stop at its bound and without force.
void PathTracer::judge(PathEvent& event, const PathSpot& spot, int watched) {
  PathPiece piece = spot.piece;
  const int stops = static_cast<int>(piece.side.size());
  const bool is_stop = watched >= 0 && watched < 2 * stops;
  if (is_stop) piece.side[watched / 2] = 0;
  solvers::Curve& system = curve(piece);
  if (system.unknowns() > solvers::Curve::spectrum_limit) return;
  const VectorXd z = mapped(spot.point.z, spot.piece, piece);
  VectorXd row;
  if (is_stop) {
    row = system.gap_gradient(z, watched / 2, watched % 2 == 1);
  } else if (watched >= 0) {
    row = system.gap_gradient(z, stops + watched - 2 * stops, false);
  } else {
    row = system.without_multipliers(spot.point.tangent);
  }
  const VectorXd w = system.parameter_sensitivity(z, row);
  const PathPoint point = report(spot);
  const auto model = varied_.model_at(point.parameter);
  std::vector<solvers::ActiveRow> rows = system.active();
  if (is_stop) rows.push_back({.row = model->mechanism().stop_row(watched / 2), .upper = watched % 2 == 1});
  const KeptEquations kept = kept_equations(rows);
  std::vector<Ball> x(point.x.begin(), point.x.end()), y(kept.rows.size(), Ball(0.0));
  const Index n = system.variables();
  for (std::size_t k = 0; k < system.active().size(); ++k) y[k] = Ball(z[n + static_cast<Index>(k)]);
  const auto effect = [&](bool rounded) {
    return effect_of(w, BalanceSystem(model->balls(), kept, rounded).residual(x, y));
  };
  const double range = std::abs(varied_.to() - varied_.from());
  // A value of exactly zero has all its digits.
  const double value = point.parameter == 0.0 ? range : std::abs(point.parameter);
  // A free length, which is no row of the model, is met to the rounding of its number and of the length's.
  const double length = is_stop || watched < 0
                            ? 0.0
                            : std::abs(w[w.size() - 1]) * 0x1p-51 * std::max(1.0, z.head(n).cwiseAbs().maxCoeff());
  event.error = (effect(false).whole + length) * range / value;
  event.rounding_effect = (effect(true).spread + length) * range / value;
}

// All curves through a branch point: points of them on a small sphere round it, from starts in all directions of the
// null space there.
void PathTracer::depart(const PathSpot& spot, int event, const VectorXd& along) {
  solvers::Curve& system = curve(spot.piece);
  if (system.unknowns() > solvers::Curve::spectrum_limit) return;
  const VectorXd& centre = spot.point.z;
  const MatrixXd null = system.null_vectors(centre, 1e-6, 2, &along);
  const Index k = null.cols();
  const int starts = k == 2 ? 24 : 40 * static_cast<int>(k * k);
  std::vector<VectorXd> found;
  std::minstd_rand random(20261122);
  std::normal_distribution<double> normal;
  for (int i = 0; i < starts; ++i) {
    VectorXd share(k);
    if (k == 2) {
      share << std::cos(2 * M_PI * (i + 0.25) / starts), std::sin(2 * M_PI * (i + 0.25) / starts);
    } else {
      for (Index j = 0; j < k; ++j) share[j] = normal(random);
    }
    VectorXd d = null * share;
    const double length = system.norm(d);
    if (!(length > 1e-6 * d.norm())) continue;
    VectorXd z = centre + departure / length * d;
    if (!system.correct_on_sphere(z, centre, departure).converged) continue;
    if (system.norm(z - centre) > 1.01 * departure || system.norm(z - centre) < 0.99 * departure) continue;
    const bool known = std::any_of(found.begin(), found.end(),
                                   [&](const VectorXd& other) { return system.norm(z - other) < 1e-3 * departure; });
    if (!known) found.push_back(z);
  }
  // The curve itself passes here: its two directions are followed already.
  for (VectorXd& z : found) {
    PathSpot start = spot;
    start.point.z = z;
    VectorXd outward = (z - centre) / departure;
    if (!system.differentiate_at(start.point, outward)) continue;
    system.estimate_bend(start.point);
    start.negative = system.negative_directions(z);
    const double cosine = system.dot(outward, along) / system.norm(along);
    const bool own = std::abs(cosine) > 0.98;
    departures_.push_back({.event = event, .start = std::move(start), .used = own});
  }
}

// --- the trace ------------------------------------------------------------------------------------------------------

// Length of the arc between the ends, of a circle through both with their tangents.
double PathTracer::arc(const Segment& segment) {
  const solvers::Curve& system = curve(segment.a.piece);
  const double chord = system.norm(segment.b.point.z - segment.a.point.z);
  const double half =
      0.5 * std::acos(std::clamp(system.dot(segment.a.point.tangent, segment.b.point.tangent), -1.0, 1.0));
  return half > 1e-6 ? chord * half / std::sin(half) : chord;
}

std::optional<PathSpot> PathTracer::step(const PathSpot& here, double h, double& badness) {
  solvers::Curve& system = curve(here.piece);
  PathSpot next = here;
  next.point.z = here.point.z + h * here.point.tangent + (0.5 * h * h) * here.point.bend;
  const VectorXd row = system.without_multipliers(here.point.tangent);
  const auto correction = system.correct(next.point.z, row);
  if (!correction.converged || correction.first > tracing::largest_correction * h) return std::nullopt;
  if (!system.differentiate(next.point, row)) return std::nullopt;
  const double cosine = std::clamp(system.dot(here.point.tangent, next.point.tangent), -1.0, 1.0);
  const double turn = std::acos(cosine);
  if (turn > tracing::largest_turn) return std::nullopt;
  system.estimate_bend(next.point);
  badness = std::max(std::sqrt(correction.first / h / tracing::usual_correction), turn / tracing::usual_turn);
  next.negative = system.negative_directions(next.point.z);
  return next;
}

std::vector<PathTracer::Loss> PathTracer::trace(const PathSpot& start, int from_event, Until until) {
  curve(start.piece);  // compiled before the clock starts
  const auto begin = std::chrono::steady_clock::now();
  std::vector<Loss> losses = follow(start, from_event, until);
  out_.microseconds += std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count();
  return losses;
}

std::vector<PathTracer::Loss> PathTracer::follow(const PathSpot& start, int from_event, Until until) {
  branch_ = static_cast<int>(out_.branches.size());
  out_.branches.emplace_back();
  out_.branches[branch_].from = from_event;
  const auto end = [&](PathBranch::End how, std::string why = {}) {
    out_.branches[branch_].end = how;
    out_.branches[branch_].why = std::move(why);
  };
  std::vector<Loss> losses;
  if (from_event >= 0 && out_.events[from_event].kind == PathEvent::Kind::branch) {
    out_.branches[branch_].points.push_back(out_.events[from_event].at);
  }
  add_point(start);
  for (std::size_t k = 0; k < wanted_.size(); ++k) {
    if (start.p() == wanted_[k]) out_.wanted[k].push_back(report(start));
  }
  PathSpot here = start;
  double h = std::min(first_step, options_.longest_step);
  int switches = 0, steps = 0;
  std::vector<Watched> watched, next_watched;
  watch(here, watched);
  const auto place_text = [&](const PathSpot& spot) {
    return fmt::format("at {} = {:.6g}", varied_.name(), value_at(spot.p()) / varied_.unit());
  };
  const auto parameter_text = [&] { return place_text(here); };
  const auto dead_centre_text = [&](const PathSpot& spot) {
    return "towards a dead centre, where the closures lose rank, joint forces grow without bound " + place_text(spot);
  };
  while (true) {
    if (interrupted()) {
      end(PathBranch::End::interrupted);
      return losses;
    }
    if (static_cast<int>(out_.branches[branch_].points.size()) >= options_.most_points) {
      end(PathBranch::End::limit, fmt::format("{} points were not enough", options_.most_points));
      return losses;
    }
    // A step that keeps to the curve and whose events can be told apart.
    Segment segment;
    std::vector<Crossing> crossings;
    double badness = 1.0;
    while (true) {
      if (h < tracing::shortest_step) {
        if (heaviest_multiplier(here) > heavy_multipliers) {
          end(PathBranch::End::singular, dead_centre_text(here));
        } else {
          end(PathBranch::End::stuck, "no step along the curve succeeds " + parameter_text());
        }
        return losses;
      }
      std::optional<PathSpot> next = step(here, h, badness);
      ++out_.steps;
      if (!next) {
        h *= 0.5;
        continue;
      }
      segment = {here, std::move(*next), 0.0};
      segment.h = arc(segment);
      crossings.clear();
      watch(segment.b, next_watched);
      if (find_crossings(segment, watched, next_watched, steps > 2 ? &start : nullptr, crossings)) break;
      h *= 0.5;
    }
    ++steps;
    solvers::Curve& system = curve(here.piece);
    if (has_left_out_ && system.largest_left_out(segment.b.point.z) > taken_apart) {
      end(PathBranch::End::stuck, "joints that repeat others no longer fit together " + parameter_text());
      return losses;
    }
    // What is driven may turn as often as it is asked to.
    if (!varied_.is_driven() && is_far(segment.b)) {
      end(PathBranch::End::stuck, "the mechanism runs away " + parameter_text());
      return losses;
    }
    std::sort(crossings.begin(), crossings.end(), [](const Crossing& a, const Crossing& b) { return a.s < b.s; });
    double from = 0.0;
    PathSpot begin = here;
    bool switched_piece = false;
    double direction = here.rate() >= 0.0 ? 1.0 : -1.0;
    for (Crossing& crossing : crossings) {
      fill(segment, from, crossing.s, begin, crossing.spot);
      from = crossing.s;
      PathSpot& spot = crossing.spot;
      if (crossing.kind == Crossing::Kind::range || crossing.kind == Crossing::Kind::start) {
        add_point(spot);
        end(crossing.kind == Crossing::Kind::range ? PathBranch::End::range : PathBranch::End::closed);
        return losses;
      }
      if (crossing.kind == Crossing::Kind::dead_centre) {
        end(PathBranch::End::singular, dead_centre_text(spot));
        return losses;
      }
      PathSpot after = segment.b;
      PathEvent event;
      if (crossing.kind == Crossing::Kind::watched) {
        const int stops = static_cast<int>(spot.piece.side.size());
        const bool is_stop = crossing.watched < 2 * stops;
        event.kind = is_stop ? PathEvent::Kind::stop : PathEvent::Kind::slack;
        event.item = is_stop ? crossing.watched / 2 : one_way_[crossing.watched - 2 * stops];
        event.on = is_stop ? spot.piece.side[event.item] == 0 : spot.piece.acts[crossing.watched - 2 * stops] == 0;
        std::optional<PathSpot> beyond = ++switches > most_switches ? std::nullopt : switched(spot, crossing.watched);
        spot.negative = begin.negative;
        add_point(spot, true);
        judge(event, spot, crossing.watched);
        const int index = add_event(event, spot);
        if (!beyond) {
          const std::string at_place = place_text(spot);
          if (switches > most_switches) {
            end(PathBranch::End::singular, "several stops or springs change together " + at_place);
          } else if (is_stop && event.on) {
            end(varied_.is_driven() ? PathBranch::End::blocked : PathBranch::End::singular,
                fmt::format("the stop \"{}\" leaves no motion {}", varied_.scene().stops[event.item].name, at_place));
          } else {
            end(PathBranch::End::singular, "beyond it a whole set of poses is in equilibrium " + at_place);
          }
          return losses;
        }
        const bool turns = beyond->rate() * spot.rate() < 0.0 && std::abs(beyond->rate()) > standstill;
        int fold = -1;
        if (turns) {
          PathEvent kink;
          kink.kind = PathEvent::Kind::fold;
          kink.error = event.error;
          kink.rounding_effect = event.rounding_effect;
          fold = add_event(kink, spot);
        }
        const bool lost = spot.negative == 0 && (beyond->negative > 0 || turns);
        if (lost) losses.push_back({fold >= 0 ? fold : index, spot, direction});
        if (lost && until == Until::unstable) {
          end(PathBranch::End::snapped);
          return losses;
        }
        // What is reached here by the curve is lost by a mechanism that comes from the other side.
        if (beyond->negative == 0 && (spot.negative > 0 || turns)) {
          losses.push_back({fold >= 0 ? fold : index, *beyond, beyond->rate() >= 0.0 ? -1.0 : 1.0});
        }
        here = std::move(*beyond);
        switched_piece = true;
        break;
      }
      switch (crossing.kind) {
        case Crossing::Kind::fold:
          event.kind = PathEvent::Kind::fold;
          judge(event, spot, -1);
          break;
        default:
          event.kind = PathEvent::Kind::branch;
          event.error = 1e-15;
          break;
      }
      // Degenerate: what is said of it is said of the side it was reached on.
      spot.negative = begin.negative;
      const VectorXd place = spot.point.z;
      int index = -1;
      if (event.kind == PathEvent::Kind::branch) {
        for (const auto& [known, z] : branch_points_) {
          if (z.size() == place.size() && curve(spot.piece).norm(z - place) < tracing::same_point) index = known;
        }
      }
      if (crossing.kind == Crossing::Kind::fold && repeats(spot)) {
        add_point(spot, true);
        end(PathBranch::End::closed, "it repeats itself after whole turns");
        return losses;
      }
      const bool is_new = index < 0;
      if (is_new) {
        index = add_event(event, spot);
      } else {
        out_.branches[branch_].events.push_back(index);
      }
      add_point(spot, true);
      if (event.kind == PathEvent::Kind::branch) {
        VectorXd along = segment.b.point.z - segment.a.point.z;
        if (is_new) {
          branch_points_.emplace_back(index, place);
          if (options_.branches) depart(spot, index, along);
        } else {
          mark_used(index, spot, along);
        }
      }
      // A mechanism that is loaded further cannot follow a curve that turns back.
      const bool turns = until == Until::unstable && crossing.kind == Crossing::Kind::fold;
      const bool lost = begin.negative == 0 && (after.negative > 0 || turns);
      if (lost) losses.push_back({index, spot, direction});
      if (lost && until == Until::unstable) {
        end(PathBranch::End::snapped);
        return losses;
      }
      if (crossing.kind == Crossing::Kind::fold) direction = -direction;
      if (begin.negative > 0 && after.negative == 0) losses.push_back({index, spot, -direction});
      spot.negative = after.negative;
      begin = spot;
    }
    if (!switched_piece) {
      fill(segment, from, segment.h, begin, segment.b);
      here = std::move(segment.b);
      switches = 0;
      add_point(here);
      h = std::min(options_.longest_step, h * std::clamp(1.0 / badness, 0.5, 2.0));
      std::swap(watched, next_watched);
    } else {
      h = std::min({h, first_step, options_.longest_step});
      watch(here, watched);
    }
  }
}

// A branch point that was found before is passed: its curves in this direction need not be followed again.
void PathTracer::mark_used(int event, const PathSpot& spot, const VectorXd& along) {
  solvers::Curve& system = curve(spot.piece);
  for (Departure& d : departures_) {
    if (d.event != event || d.start.point.z.size() != along.size()) continue;
    const VectorXd outward = d.start.point.z - spot.point.z;
    const double cosine = system.dot(outward, along) / (system.norm(outward) * system.norm(along));
    if (std::abs(cosine) > 0.98) d.used = true;
  }
}

// The events of a segment; false if it should be halved to tell them apart.
bool PathTracer::find_crossings(const Segment& segment, const std::vector<Watched>& before,
                                const std::vector<Watched>& after, const PathSpot* start, std::vector<Crossing>& out) {
  const PathSpot &a = segment.a, &b = segment.b;
  const double h = segment.h;
  const bool can_split = h > shortest_split;
  // Stops and springs.
  for (std::size_t k = 0; k < before.size(); ++k) {
    const Watched &at_a = before[k], &at_b = after[k];
    if (std::isinf(at_a.value) || std::isinf(at_b.value)) continue;
    if (at_b.value >= -tracing::overrun) {
      const bool may_dip = at_a.value > tracing::overrun && at_a.smooth_rate < 0.0 && at_b.smooth_rate > 0.0;
      if (can_split && may_dip &&
          solvers::Cubic(at_a.smooth, at_a.smooth_rate, at_b.smooth, at_b.smooth_rate, h).least() < 0.0) {
        return false;
      }
      continue;
    }
    if (at_a.value <= tracing::overrun && at_a.rate > 0.0 && can_split) return false;
    Crossing crossing{Crossing::Kind::watched, 0.0, static_cast<int>(k), a};
    if (at_a.value > 0.0) {
      std::vector<Watched> between;
      auto found = root_on_segment([&](double s) { return at(segment, s); },
                                   [&](const PathSpot& spot) {
                                     watch(spot, between);
                                     return between[k].value;
                                   },
                                   h, at_a.value, at_b.value);
      if (!found) return false;
      crossing.s = found->s;
      crossing.spot = std::move(found->spot);
    }
    out.push_back(std::move(crossing));
  }
  // Folds.
  int folds = 0, branches = 0;
  const double ra = a.rate(), rb = b.rate();
  if (std::abs(ra) > standstill || std::abs(rb) > standstill) {
    if ((ra > 0.0) != (rb > 0.0)) {
      Crossing crossing{Crossing::Kind::fold};
      std::optional<PathSpot> spot = find_fold(segment, crossing.s);
      if (!spot) return false;
      crossing.spot = std::move(*spot);
      out.push_back(std::move(crossing));
      ++folds;
    } else if (can_split) {
      // The parameter's rate, a parabola through both ends and with the right mean: does it vanish twice?
      const double mean = (b.p() - a.p()) / h;
      const double middle = 1.5 * mean - 0.25 * (ra + rb);
      if ((middle > 0.0) != (ra > 0.0)) return false;
    }
  }
  if (a.point.orientation != b.point.orientation) {
    Crossing crossing{Crossing::Kind::branch};
    bool is_pole = false;
    std::optional<PathSpot> spot = find_branch(segment, crossing.s, is_pole);
    if (!spot) return false;
    crossing.spot = std::move(*spot);
    if (is_pole) crossing.kind = Crossing::Kind::dead_centre;
    out.push_back(std::move(crossing));
    ++branches;
  }
  const int change = b.negative - a.negative;
  if (a.negative >= 0 && b.negative >= 0 && change != 0 && std::abs(change) != folds + branches &&
      (change + folds + branches) % 2 == 0 && curve(a.piece).unknowns() <= solvers::Curve::spectrum_limit &&
      curve(a.piece).symmetric()) {
    if (can_split) return false;
    Crossing crossing{Crossing::Kind::multiple};
    std::optional<PathSpot> spot = find_multiple(segment, crossing.s);
    if (!spot) return false;
    crossing.spot = std::move(*spot);
    out.push_back(std::move(crossing));
  }
  // The ends of the range.
  for (const double limit : {0.0, 1.0}) {
    const double beyond = limit == 0.0 ? -b.p() : b.p() - 1.0;
    if (beyond < 0.0 || (beyond == 0.0 && (limit == 0.0) == (rb > 0.0))) continue;
    double begin = limit == 0.0 ? -a.p() : a.p() - 1.0;
    double from = 0.0;
    if (begin >= 0.0 && (limit == 0.0) == (ra > 0.0) && std::abs(ra) > standstill) {
      // It leads into the range, and out again behind a fold.
      const auto fold = std::find_if(out.begin(), out.end(),
                                     [](const Crossing& crossing) { return crossing.kind == Crossing::Kind::fold; });
      if (fold == out.end() && can_split) return false;
      if (fold != out.end()) {
        from = fold->s;
        begin = limit == 0.0 ? -fold->spot.p() : fold->spot.p() - 1.0;
      }
    }
    if (begin >= 0.0) {
      out.push_back({Crossing::Kind::range, from, -1, a});
      continue;
    }
    auto found = root_on_segment([&](double s) { return at(segment, from + s); },
                                 [&](const PathSpot& spot) { return limit == 0.0 ? -spot.p() : spot.p() - 1.0; },
                                 h - from, begin, std::max(beyond, 1e-300));
    if (!found) return false;
    Crossing crossing{Crossing::Kind::range, from + found->s, -1, std::move(found->spot)};
    if (std::optional<PathSpot> spot = held(crossing.spot, limit)) crossing.spot = std::move(*spot);
    VectorXd& z = crossing.spot.point.z;
    z[z.size() - 1] = limit;
    out.push_back(std::move(crossing));
  }
  // Back at the start of the branch, perhaps after whole turns.
  if (start != nullptr && start->piece == a.piece && std::abs(b.p() - start->p()) < 1.5 * h) {
    solvers::Curve& system = curve(a.piece);
    const Index n = system.variables();
    const auto coordinates = [&](const PathSpot& spot) {
      return std::vector<double>(spot.point.z.data(), spot.point.z.data() + n);
    };
    const std::vector<double> turned = unwound(coordinates(*start), coordinates(b), Turns::forces_and_stops);
    VectorXd origin = start->point.z;
    origin.head(n) = VectorXd::Map(turned.data(), n);
    const VectorXd& t = start->point.tangent;
    const double fa = system.dot(a.point.z - origin, t), fb = system.dot(b.point.z - origin, t);
    if (fa < 0.0 && fb >= 0.0 && system.norm(b.point.z - origin) < 1.5 * h) {
      auto found = root_on_segment([&](double s) { return at(segment, s); },
                                   [&](const PathSpot& spot) { return system.dot(spot.point.z - origin, t); }, h, fa,
                                   std::max(fb, 1e-300));
      if (found && system.norm(found->spot.point.z - origin) < tracing::same_point) {
        out.push_back({Crossing::Kind::start, found->s, -1, std::move(found->spot)});
      }
    }
  }
  return true;
}

}  // namespace poise
