#include "statics/paths/private/fold_tracer.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include <fmt/format.h>

#include "solvers/root.hpp"
#include "statics/paths/private/event_accuracy.hpp"
#include "statics/paths/private/tracing_steps.hpp"

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

}  // namespace

// --- pieces ---------------------------------------------------------------------------------------------------------

PieceOfPair::PieceOfPair(const VariedPair& pair, PathPiece piece, std::vector<int> equalities)
    : pair_(pair), piece_(std::move(piece)), equalities_(std::move(equalities)) {}

PieceOfPair::OneVaries::OneVaries(VariedScene scene, const PieceOfPair& of, double other_at)
    : at(other_at),
      varied(std::move(scene)),
      mechanism(varied, of.piece_.acts),
      curve(mechanism, active_rows(of.piece_, of.equalities_, mechanism.equalities())) {}

template <class Make>
solvers::Curve& PieceOfPair::recall(std::deque<std::unique_ptr<OneVaries>>& recent, double at, Make make) {
  for (const std::unique_ptr<OneVaries>& one : recent) {
    if (one->at == at) return one->curve;
  }
  if (recent.size() >= most_recent) recent.pop_front();
  recent.push_back(std::make_unique<OneVaries>(make(), *this, at));
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

// The way along one curve, from its start to what ends it.
class FoldTracer::Walk {
 public:
  Walk(FoldTracer& of, Piece& piece, const FoldPlace& start, std::size_t most)
      : tracer_(of),
        piece_(piece),
        start_(start),
        most_(most),
        here_(start),
        h_(std::min(first_fold_step, of.options_.spacing)) {
    out_.places.push_back(start);
    tracer_.watch(piece_, here_.z, values_);
  }

  Trace run() {
    while (may_go_on() && make_step()) {
      find_ends();
      if (out_.places.size() > 3) find_start();
      find_cusp();
      out_.places.push_back(last_);
      show_progress();
      if (how_) {
        end(*how_, why_);
        break;
      }
      advance();
    }
    return std::move(out_);
  }

 private:
  using Function = std::function<double(const FoldPlace&)>;

  bool end(FoldBranch::End how, std::string why) {
    out_.end = how;
    out_.why = std::move(why);
    return false;
  }

  bool may_go_on() {
    if (tracer_.interrupted()) return end(FoldBranch::End::interrupted, "interrupted");
    if (out_.places.size() < most_) return true;
    return end(FoldBranch::End::limit, fmt::format("{} points were not enough", tracer_.options_.most_points));
  }

  // Makes a step that keeps to the curve. False if there is none, or it leads away.
  bool make_step() {
    std::optional<FoldPlace> next;
    while (!next) {
      next = tracer_.step(piece_, here_, h_, bend_.size() > 0 ? &bend_ : nullptr, badness_);
      ++tracer_.out_.steps;
      if (next) break;
      h_ *= 0.5;
      if (!(h_ > tracing::shortest_step)) {
        return end(FoldBranch::End::stuck, "no step along the curve succeeds " + tracer_.place_text(here_.z));
      }
      if (!may_go_on()) return false;
    }
    segment_ = {here_, std::move(*next), h_};
    if (segment_.b.z.head(piece_.system.variables()).cwiseAbs().maxCoeff() > run_away) {
      return end(FoldBranch::End::stuck, "the mechanism runs away " + tracer_.place_text(here_.z));
    }
    return true;
  }

  // Finds the first of all ends of the piece and of the ranges within the step.
  void find_ends() {
    until_ = segment_.h;
    last_ = segment_.b;
    how_.reset();
    why_.clear();
    tracer_.watch(piece_, segment_.b.z, next_values_);
    for (std::size_t k = 0; k < values_.size(); ++k) {
      if (std::isinf(values_[k]) || next_values_[k] >= -tracing::overrun) continue;
      std::vector<double> watched;
      const auto value = [&](const FoldPlace& place) {
        tracer_.watch(piece_, place.z, watched);
        return watched[k];
      };
      cut(value, FoldBranch::End::piece, tracer_.said_of(piece_, k));
    }
    const Index count = segment_.b.z.size();
    for (const Index i : {count - 2, count - 1}) {
      cut([i](const FoldPlace& place) { return place.z[i]; }, FoldBranch::End::range, {});
      cut([i](const FoldPlace& place) { return 1.0 - place.z[i]; }, FoldBranch::End::range, {});
    }
    if (how_ == FoldBranch::End::range) {
      // Numbers are exactly those of the end.
      for (const Index i : {count - 2, count - 1}) {
        if (std::abs(last_.z[i] - std::round(last_.z[i])) < 1e-12) last_.z[i] = std::round(last_.z[i]);
      }
    } else if (how_ == FoldBranch::End::piece) {
      why_ += " " + tracer_.place_text(last_.z);
    }
  }

  // Ends the step where a function falls below zero, if it does so before what was found yet.
  void cut(const Function& f, FoldBranch::End kind, const std::string& said) {
    const double fa = f(segment_.a), fb = f(segment_.b);
    if (!(fb < 0.0)) return;
    FoldPlace place = here_;
    const std::optional<double> s = fa <= 0.0 ? std::optional(0.0) : root_of(f, fa, fb, 1e-15, place);
    if (!s || *s > until_) return;
    until_ = *s;
    last_ = std::move(place);
    how_ = kind;
    why_ = said;
  }

  // The root of a function on the step, with its place.
  std::optional<double> root_of(const Function& f, double fa, double fb, double width, FoldPlace& place) {
    const auto value_at = [&](double s) -> std::optional<double> {
      std::optional<FoldPlace> found = tracer_.at(piece_, segment_, s);
      if (!found) return std::nullopt;
      place = std::move(*found);
      return f(place);
    };
    return solvers::root_by_secants(value_at, {0.0, segment_.h}, fa, fb, width);
  }

  // Finds whether the curve is back at the start, perhaps after whole turns.
  void find_start() {
    const VectorXd start = tracer_.turned_towards(piece_, start_.z, segment_.b.z);
    if (!tracer_.crossing_of(piece_, segment_, start)) return;
    if (!(std::abs(piece_.system.dot(segment_.a.tangent, start_.tangent)) > 0.9)) return;
    how_ = FoldBranch::End::closed;
    why_.clear();
    last_ = start_;
    last_.z = start;
  }

  void find_cusp() {
    const FoldPlace &a = segment_.a, &b = segment_.b;
    if (!(a.coefficient * last_.coefficient < 0.0)) return;
    FoldPlace place = here_;
    const auto s =
        root_of([](const FoldPlace& at) { return at.coefficient; }, a.coefficient, b.coefficient, 1e-12, place);
    const double usual = std::abs(a.coefficient) + std::abs(b.coefficient);
    const bool is_zero = s && std::abs(place.coefficient) < zero_coefficient * usual;
    if (is_zero && *s <= until_) out_.cusps.push_back({std::move(place), out_.places.size() - 1});
  }

  void show_progress() const {
    const std::size_t done = out_.places.size();
    if (!tracer_.options_.progress || done % 16 != 0) return;
    tracer_.options_.progress(tracer_.first_value(last_.z), tracer_.second_value(last_.z),
                              tracer_.points_ + static_cast<int>(done));
  }

  void advance() {
    bend_ = (segment_.b.tangent - segment_.a.tangent) / segment_.h;
    here_ = segment_.b;
    h_ = std::min(tracer_.options_.spacing, h_ * std::clamp(1.0 / badness_, 0.5, 2.0));
    std::swap(values_, next_values_);
  }

  FoldTracer& tracer_;
  Piece& piece_;
  const FoldPlace& start_;
  std::size_t most_;
  Trace out_;
  FoldPlace here_;
  double h_;       // length of the next step
  VectorXd bend_;  // at `here_`; empty at the start
  std::vector<double> values_, next_values_;
  // The step in hand.
  Segment segment_{};
  double badness_ = 1.0;  // by which it is too long
  double until_ = 0.0;    // where it ends
  FoldPlace last_;        // there
  std::optional<FoldBranch::End> how_;
  std::string why_;
};

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
  Trace forward = Walk(*this, piece, start, left()).run();
  points_ += static_cast<int>(forward.places.size());
  Trace backward;
  if (forward.end != FoldBranch::End::closed) backward = Walk(*this, piece, other_way, left()).run();
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
