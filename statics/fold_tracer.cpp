#include "statics/fold_tracer.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include <fmt/format.h>

#include "solvers/root.hpp"
#include "statics/event_accuracy.hpp"
#include "statics/tracing_steps.hpp"

namespace poise {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using solvers::FoldPlace;

// Distances along the curve: rad, mechanism sizes, parts of the ranges.
constexpr double first_fold_step = 0.005;
constexpr double least_fold_cosine = 0.8;   // between the directions v of neighbouring points
constexpr double zero_coefficient = 1e-3;   // of those at the ends of the step: at a cusp, and not at a pole
constexpr double run_away = 100.0;          // of a coordinate
constexpr double known_distance = 1e-3;     // the fold that path() met is met again nearer than this
constexpr double in_balance_within = 1e-8;  // residuals of a pose that is an equilibrium

// SI; exactly the ends at 0 and 1.
}  // namespace

// --- pieces ---------------------------------------------------------------------------------------------------------

PieceOfPair::PieceOfPair(const VariedPair& pair, PathPiece piece, std::vector<int> equalities)
    : pair_(pair), piece_(std::move(piece)), equalities_(std::move(equalities)) {}

PieceOfPair::Held::Held(VariedScene scene, const PieceOfPair& of, double held_at)
    : at(held_at),
      varied(std::move(scene)),
      mechanism(varied, of.piece_.acts),
      curve(mechanism, active_rows(of.piece_, of.equalities_, mechanism.equalities())) {}

template <class Make>
solvers::Curve& PieceOfPair::recall(std::deque<std::unique_ptr<Held>>& recent, double at, Make make) {
  for (const std::unique_ptr<Held>& held : recent) {
    if (held->at == at) return held->curve;
  }
  if (recent.size() >= most_recent) recent.pop_front();
  recent.push_back(std::make_unique<Held>(make(), *this, at));
  return recent.back()->curve;
}

solvers::Curve& PieceOfPair::first_varies(double q) {
  return recall(of_q_, q, [&] { return pair_.first_at(pair_.second().value_at(q)); });
}

solvers::Curve& PieceOfPair::second_varies(double p) {
  return recall(of_p_, p, [&] { return pair_.second_at(pair_.first().value_at(p)); });
}

double FoldTracer::first_value(const VectorXd& z) const { return pair_.first().value_at(z[z.size() - 2]); }

double FoldTracer::second_value(const VectorXd& z) const { return pair_.second().value_at(z[z.size() - 1]); }

// --- along a curve --------------------------------------------------------------------------------------------------

std::optional<FoldPlace> FoldTracer::step(Piece& piece, const FoldPlace& here, double h, const VectorXd* bend,
                                          double& badness) {
  FoldPlace next = here;
  next.z = here.z + h * here.tangent;
  if (bend != nullptr) next.z += 0.5 * h * h * *bend;
  const auto correction = piece.system.correct(next, here.tangent, here);
  if (!correction.converged || correction.first > tracing::largest_correction * h) return std::nullopt;
  const double turn = std::acos(std::clamp(piece.system.dot(here.tangent, next.tangent), -1.0, 1.0));
  if (turn > tracing::largest_turn) return std::nullopt;
  const Index n = piece.system.variables();
  if (here.v.head(n).dot(next.v.head(n)) < least_fold_cosine) return std::nullopt;
  badness = std::max(std::sqrt(correction.first / h / tracing::usual_correction), turn / tracing::usual_turn);
  return next;
}

// The place at arclength s of a segment, about.
std::optional<FoldPlace> FoldTracer::at(Piece& piece, const Segment& segment, double s) {
  const double h = segment.h, t = s / h, t2 = t * t, t3 = t2 * t;
  FoldPlace out = segment.a;
  const VectorXd interpolated = (2 * t3 - 3 * t2 + 1) * segment.a.z + h * (t3 - 2 * t2 + t) * segment.a.tangent +
                                (3 * t2 - 2 * t3) * segment.b.z + h * (t3 - t2) * segment.b.tangent;
  out.z = interpolated;
  const VectorXd row = (1 - t) * segment.a.tangent + t * segment.b.tangent;
  if (!piece.system.correct(out, row, segment.a).converged) return std::nullopt;
  if (piece.system.norm(out.z - interpolated) > tracing::largest_deviation * h) return std::nullopt;
  return out;
}

// Where a segment passes `place`, if it does, to rounding.
std::optional<FoldPlace> FoldTracer::crossing_of(Piece& piece, const Segment& segment, const VectorXd& place) {
  const VectorXd chord = segment.b.z - segment.a.z;
  const double length = piece.system.norm(chord);
  const double share = piece.system.dot(place - segment.a.z, chord) / (length * length);
  if (share < -0.05 || share > 1.05) return std::nullopt;
  if (piece.system.norm(segment.a.z + share * chord - place) > 0.3 * length) return std::nullopt;
  double s = share * segment.h;
  std::optional<FoldPlace> found;
  for (int k = 0; k < 4; ++k) {
    found = at(piece, segment, s);
    if (!found) return std::nullopt;
    s += piece.system.dot(place - found->z, found->tangent);
  }
  if (s < -tracing::same_point || s > segment.h + tracing::same_point) return std::nullopt;
  if (piece.system.norm(found->z - place) > tracing::same_point) return std::nullopt;
  return found;
}

// What must stay positive on a piece: gaps of free stops (two each), pushes of active ones, and how far one-way springs
// are from their free length; infinite where nothing is watched.
void FoldTracer::watch(Piece& piece, const VectorXd& z, std::vector<double>& values) {
  const PathPiece& state = piece.family.piece();
  const std::size_t stops = state.side.size();
  values.assign(2 * stops + state.acts.size(), std::numeric_limits<double>::infinity());
  if (values.empty()) return;
  const Index n = piece.system.variables();
  solvers::CurvePoint point;
  point.z = piece.system.first_part(z);
  point.tangent = VectorXd::Zero(point.z.size());
  std::vector<solvers::Curve::Room> rooms;
  piece.family.first_varies(z[z.size() - 1]).rooms(point, rooms);
  Index y = n + static_cast<Index>(piece.family.equalities().size());
  for (std::size_t s = 0; s < stops; ++s) {
    const signed char side = state.side[s];
    if (side == 0) {
      values[2 * s] = rooms[s].lower;
      values[2 * s + 1] = rooms[s].upper;
    } else if (const double push = side * z[y++]; rooms[s].lower + rooms[s].upper != 0.0) {
      values[2 * s + (side > 0 ? 1 : 0)] = push;
    }
  }
  const Scene& scene = pair_.first().scene();
  const std::vector<int> one_way = VariedMechanism::one_way_springs(scene);
  for (std::size_t k = 0; k < one_way.size(); ++k) {
    const auto& spring = std::get<LinearSpring>(scene.elements[one_way[k]].law);
    const double sign = (spring.acts == LinearSpring::Acts::tension) == (state.acts[k] != 0) ? 1.0 : -1.0;
    values[2 * stops + k] = sign * rooms[stops + k].lower;
  }
}

std::string FoldTracer::said_of(const Piece& piece, std::size_t watched) const {
  const PathPiece& state = piece.family.piece();
  const Scene& scene = pair_.first().scene();
  const std::size_t stops = state.side.size();
  if (watched < 2 * stops) {
    return fmt::format("the stop \"{}\" {}", scene.stops[watched / 2].name,
                       state.side[watched / 2] == 0 ? "is met" : "comes off");
  }
  const std::size_t k = watched - 2 * stops;
  return fmt::format("the spring \"{}\" {}", scene.elements[VariedMechanism::one_way_springs(scene)[k]].name,
                     state.acts[k] != 0 ? "goes slack" : "begins to act");
}

std::string FoldTracer::place_text(const VectorXd& z) const {
  const VariedScene &first = pair_.first(), &second = pair_.second();
  return fmt::format("at {} = {:.6g}, {} = {:.6g}", first.name(), first_value(z) / first.unit(), second.name(),
                     second_value(z) / second.unit());
}

// The place after whole turns of bodies that bring it nearest to `other`, if it is an equilibrium there as well.
VectorXd FoldTracer::turned_towards(Piece& piece, const VectorXd& z, const VectorXd& other) const {
  VectorXd out = z;
  for (Index i = 0; i < angles_; ++i) out[i] += 2 * M_PI * std::round((other[i] - z[i]) / (2 * M_PI));
  return out == z || piece.system.residual(out) < in_balance_within ? out : z;
}

bool FoldTracer::is_known(Piece& piece, const VectorXd& z) {
  for (const std::vector<FoldPlace>& places : piece.traced) {
    for (std::size_t k = 1; k < places.size(); ++k) {
      const FoldPlace &a = places[k - 1], &b = places[k];
      const double length = piece.system.norm(b.z - a.z);
      // Most are far away in p and q already.
      if ((a.z.tail(2) - z.tail(2)).norm() > 1.5 * length) continue;
      if (crossing_of(piece, {a, b, length}, turned_towards(piece, z, a.z))) return true;
    }
  }
  return false;
}

FoldTracer::Trace FoldTracer::follow(Piece& piece, const FoldPlace& start, std::size_t most) {
  using End = FoldBranch::End;
  solvers::FoldSystem& system = piece.system;
  Trace out;
  out.places.push_back(start);
  FoldPlace here = start;
  const double longest_step = options_.spacing;
  double h = std::min(first_fold_step, longest_step);
  VectorXd bend;
  std::vector<double> values, next_values;
  watch(piece, here.z, values);
  const auto end = [&](End how, std::string why = {}) {
    out.end = how;
    out.why = std::move(why);
  };
  while (true) {
    if (interrupted()) {
      end(End::interrupted, "interrupted");
      return out;
    }
    if (out.places.size() >= most) {
      end(End::limit, fmt::format("{} points were not enough", options_.most_points));
      return out;
    }
    double badness = 1.0;
    std::optional<FoldPlace> next = step(piece, here, h, bend.size() > 0 ? &bend : nullptr, badness);
    ++out_.steps;
    if (!next) {
      h *= 0.5;
      if (h > tracing::shortest_step) continue;
      end(End::stuck, "no step along the curve succeeds " + place_text(here.z));
      return out;
    }
    const Segment segment{here, std::move(*next), h};
    if (segment.b.z.head(system.variables()).cwiseAbs().maxCoeff() > run_away) {
      end(End::stuck, "the mechanism runs away " + place_text(here.z));
      return out;
    }
    // The first of all ends within the step.
    double until = segment.h;
    FoldPlace last = segment.b;
    std::optional<End> how;
    std::string why;
    const auto cut = [&](const std::function<double(const FoldPlace&)>& f, End kind, const std::string& said) {
      const double fa = f(segment.a), fb = f(segment.b);
      if (!(fb < 0.0)) return;
      std::optional<FoldPlace> place = here;
      const auto s = fa <= 0.0 ? std::optional(0.0)
                               : solvers::root_by_secants(
                                     [&](double at_s) -> std::optional<double> {
                                       place = at(piece, segment, at_s);
                                       if (!place) return std::nullopt;
                                       return f(*place);
                                     },
                                     {0.0, segment.h}, fa, fb, 1e-15);
      if (!s || *s > until) return;
      until = *s;
      last = *place;
      how = kind;
      why = said;
    };
    const Index count = segment.b.z.size();
    watch(piece, segment.b.z, next_values);
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (std::isinf(values[k]) || next_values[k] >= -tracing::overrun) continue;
      std::vector<double> watched;
      cut(
          [&](const FoldPlace& place) {
            watch(piece, place.z, watched);
            return watched[k];
          },
          End::piece, said_of(piece, k));
    }
    for (const Index i : {count - 2, count - 1}) {
      cut([i](const FoldPlace& place) { return place.z[i]; }, End::range, {});
      cut([i](const FoldPlace& place) { return 1.0 - place.z[i]; }, End::range, {});
    }
    if (how == End::range) {
      // Exactly at the end.
      for (const Index i : {count - 2, count - 1}) {
        if (std::abs(last.z[i] - std::round(last.z[i])) < 1e-12) last.z[i] = std::round(last.z[i]);
      }
    } else if (how == End::piece) {
      why += " " + place_text(last.z);
    }
    // Back at the start, perhaps after whole turns.
    if (out.places.size() > 3) {
      if (crossing_of(piece, segment, turned_towards(piece, start.z, segment.b.z)) &&
          std::abs(system.dot(segment.a.tangent, start.tangent)) > 0.9) {
        how = End::closed;
        why.clear();
        last = start;
        last.z = turned_towards(piece, start.z, segment.b.z);
      }
    }
    if (segment.a.coefficient * last.coefficient < 0.0) {
      std::optional<FoldPlace> place;
      const auto s = solvers::root_by_secants(
          [&](double at_s) -> std::optional<double> {
            place = at(piece, segment, at_s);
            if (!place) return std::nullopt;
            return place->coefficient;
          },
          {0.0, segment.h}, segment.a.coefficient, segment.b.coefficient, 1e-12);
      const double usual = std::abs(segment.a.coefficient) + std::abs(segment.b.coefficient);
      const bool is_zero = s && std::abs(place->coefficient) < zero_coefficient * usual;
      if (is_zero && *s <= until) out.cusps.push_back({*place, out.places.size() - 1});
    }
    out.places.push_back(last);
    if (options_.progress && out.places.size() % 16 == 0) {
      options_.progress(first_value(last.z), second_value(last.z), points_ + static_cast<int>(out.places.size()));
    }
    if (how) {
      end(*how, why);
      return out;
    }
    bend = (segment.b.tangent - segment.a.tangent) / segment.h;
    here = segment.b;
    h = std::min(longest_step, h * std::clamp(1.0 / badness, 0.5, 2.0));
    std::swap(values, next_values);
  }
}

FoldTracer::Start FoldTracer::trace_through(const PathPiece& state, const std::vector<int>& equalities,
                                            const std::vector<double>& x, const VectorXd& y, double p, double q) {
  const Index n = static_cast<Index>(x.size());
  std::unique_ptr<Piece>& made = pieces_[state];
  if (!made) made = std::make_unique<Piece>(pair_, state, equalities);
  Piece& piece = *made;
  const auto model = pair_.model_at(pair_.first().value_at(p), pair_.second().value_at(q));
  angles_ = model->layout().angles;
  symmetric_ = !model->mechanism().has_follower_loads();
  energy_ = model->scales().energy();

  FoldPlace start;
  start.z.resize(n + y.size() + 2);
  start.z << VectorXd::Map(x.data(), n), y, p, q;
  const auto begun = piece.system.begin(start);
  if (begun.undisturbed) return Start::symmetric;
  if (!begun.converged || begun.distance > known_distance) return Start::failed;
  if (is_known(piece, start.z)) return Start::known;

  FoldBranch branch;
  FoldPlace other_way = start;
  other_way.tangent = -other_way.tangent;
  const auto left = [&] { return static_cast<std::size_t>(std::max(0, options_.most_points - points_)); };
  Trace forward = follow(piece, start, left());
  points_ += static_cast<int>(forward.places.size());
  Trace backward;
  if (forward.end != FoldBranch::End::closed) backward = follow(piece, other_way, left());
  points_ += static_cast<int>(backward.places.size());

  std::vector<FoldPlace> places;
  const auto add_cusp = [&](const FoldPlace& place) {
    branch.cusps.push_back(static_cast<int>(out_.cusps.size()));
    out_.cusps.push_back(report_cusp(piece, place));
  };
  std::reverse(backward.cusps.begin(), backward.cusps.end());
  for (const Trace::Cusp& cusp : backward.cusps) add_cusp(cusp.place);
  for (const Trace::Cusp& cusp : forward.cusps) add_cusp(cusp.place);
  // The start only once, and all tangents in one sense.
  places.assign(backward.places.rbegin(), backward.places.rend());
  for (FoldPlace& place : places) place.tangent = -place.tangent;
  if (!places.empty()) places.pop_back();
  places.insert(places.end(), forward.places.begin(), forward.places.end());
  for (const FoldPlace& place : places) branch.points.push_back(report(piece, place));
  branch.end = {forward.end == FoldBranch::End::closed ? forward.end : backward.end, forward.end};
  branch.why = {backward.why, forward.why};
  out_.curves.push_back(std::move(branch));
  piece.traced.push_back(std::move(places));
  return Start::traced;
}

// --- what is said of it ---------------------------------------------------------------------------------------------

FoldPoint FoldTracer::report(Piece& piece, const FoldPlace& place) {
  FoldPoint out;
  out.first = first_value(place.z);
  out.second = second_value(place.z);
  out.x.assign(place.z.data(), place.z.data() + piece.system.variables());
  out.coefficient = place.coefficient * energy_;
  out.unstable_directions = piece.system.other_negative_directions(place.z, symmetric_);
  const PathPiece& state = piece.family.piece();
  out.active_stops = active_stops(state, pair_.first().is_driven());
  out.slack_springs = slack_springs(state, VariedMechanism::one_way_springs(pair_.first().scene()));
  return out;
}

FoldCusp FoldTracer::report_cusp(Piece& piece, const FoldPlace& place) {
  FoldCusp out;
  out.at = report(piece, place);
  const auto sensitivity = piece.system.sensitivity(place);
  const Index n = piece.system.variables();
  const auto model = pair_.model_at(out.at.first, out.at.second);
  const solvers::Curve& curve = piece.family.first_varies(place.z[place.z.size() - 1]);
  const KeptEquations kept = kept_equations(curve.active());
  std::vector<Ball> x(out.at.x.begin(), out.at.x.end()), y, v, w;
  for (std::size_t k = 0; k < kept.rows.size(); ++k) y.emplace_back(place.z[n + static_cast<Index>(k)]);
  for (Index i = 0; i < place.v.size(); ++i) v.emplace_back(place.v[i]);
  for (Index i = 0; i < place.w.size(); ++i) w.emplace_back(place.w[i]);
  const auto effect = [&](bool rounded) {
    const BalanceSystem system(model->balls(), kept, rounded);
    std::vector<Ball> errors = system.residual(x, y);
    errors.push_back(system.product(x, y, w, v));
    FirstOrderEffect largest;
    for (const VectorXd& row : {sensitivity.first, sensitivity.second}) {
      const FirstOrderEffect effect_on_one = effect_of(row, errors);
      largest.whole = std::max(largest.whole, effect_on_one.whole);
      largest.spread = std::max(largest.spread, effect_on_one.spread);
    }
    return largest;
  };
  out.error = effect(false).whole;
  out.rounding_effect = effect(true).spread;
  return out;
}

}  // namespace poise
