#include "statics/paths/private/path_tracer.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "solvers/vectors.hpp"
#include "statics/paths/private/event_accuracy.hpp"
#include "statics/paths/private/tracing_steps.hpp"

namespace poise {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Distances along the curve: rad, mechanism sizes, parts of the parameter's range.
constexpr double first_step = 0.01;
constexpr double heavy_multipliers = 1e3;  // in the model's unit of force, next to a dead centre
constexpr double departure = 1e-3;         // radius of the sphere on which curves leave a branch point
constexpr int most_switches = 8;           // of pieces at one point

}  // namespace

PathTracer::PathTracer(const VariedScene& varied, const PathOptions& options, PathPieces& pieces, Path& out)
    : varied_(varied), options_(options), pieces_(pieces), out_(out), crossings_(pieces) {
  for (const double value : options.at) wanted_.push_back(varied.part_at(value));
}

// --- points ---------------------------------------------------------------------------------------------------------

void PathTracer::add_point(const PathSpot& spot, bool critical) {
  out_.branches[branch_].points.push_back(pieces_.report(spot, critical));
  if (options_.progress && out_.branches[branch_].points.size() % 64 == 0) {
    options_.progress(out_.branches[branch_].points.back().parameter,
                      static_cast<int>(out_.branches[branch_].points.size()));
  }
}

// Adds points between two places of a segment, ends left out, and those at wanted parameters, with the end.
void PathTracer::fill(const PathSegment& segment, double from, double to, const PathSpot& begin, const PathSpot& end) {
  for (std::size_t k = 0; k < wanted_.size(); ++k) {
    const double w = wanted_[k];
    const double fa = begin.p() - w, fb = end.p() - w;
    if (fb == 0.0) {
      out_.wanted[k].push_back(pieces_.report(end));
      continue;
    }
    if (fa == 0.0 || (fa > 0.0) == (fb > 0.0)) continue;
    const auto beyond = [w](const PathSpot& q) { return q.p() - w; };
    auto found = crossings_.root(segment, from, to - from, beyond, fa, fb);
    if (!found) continue;
    std::optional<PathSpot> spot = pieces_.at_parameter(found->spot, w);
    if (!spot) continue;
    spot->negative = begin.negative;
    PathPoint point = pieces_.report(*spot);
    point.parameter = options_.at[k];
    out_.wanted[k].push_back(std::move(point));
  }
  const int parts = static_cast<int>(std::ceil((to - from) / options_.spacing));
  if (parts < 2) return;
  PathSpot spot = begin;
  for (int k = 1; k < parts; ++k) {
    if (crossings_.place(segment, from + (to - from) * k / parts, spot)) add_point(spot);
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
  event.at = pieces_.report(spot, true);
  return add_event(std::move(event), branch_);
}

// Finds the first-order distance of the parameter of an event from the exact one, as parts of its value: of a fold, or
// of a change of what is watched, where balance holds with the stop at its bound and without force.
void PathTracer::judge(PathEvent& event, const PathSpot& spot, int watched) {
  PathPiece piece = spot.piece;
  const int stops = static_cast<int>(piece.side.size());
  const bool is_stop = watched >= 0 && watched < 2 * stops;
  if (is_stop) piece.side[watched / 2] = 0;
  solvers::Curve& system = pieces_.curve(piece);
  if (system.unknowns() > solvers::Curve::spectrum_limit) return;
  const VectorXd z = pieces_.mapped(spot.point.z, spot.piece, piece);
  VectorXd row;
  if (is_stop) {
    row = system.gap_gradient(z, watched / 2, watched % 2 == 1);
  } else if (watched >= 0) {
    row = system.gap_gradient(z, stops + watched - 2 * stops, false);
  } else {
    row = system.without_multipliers(spot.point.tangent);
  }
  const VectorXd w = system.parameter_sensitivity(z, row);
  const PathPoint point = pieces_.report(spot);
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

// Finds all curves through a branch point by their points on a small sphere round it, from starts in all directions of
// the null space there.
void PathTracer::depart(const PathSpot& spot, int event, const VectorXd& along) {
  solvers::Curve& system = pieces_.curve(spot.piece);
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

// The event of a branch point that was met there before; -1 where none was.
int PathTracer::known_branch_point(const PathSpot& spot) {
  int out = -1;
  const VectorXd& place = spot.point.z;
  for (const auto& [event, z] : branch_points_) {
    if (z.size() == place.size() && pieces_.curve(spot.piece).norm(z - place) < tracing::same_point) out = event;
  }
  return out;
}

// A branch point that was found before is passed: its curves in this direction need not be followed again.
void PathTracer::mark_used(int event, const PathSpot& spot, const VectorXd& along) {
  solvers::Curve& system = pieces_.curve(spot.piece);
  for (Departure& d : departures_) {
    if (d.event != event || d.start.point.z.size() != along.size()) continue;
    const VectorXd outward = d.start.point.z - spot.point.z;
    const double cosine = system.dot(outward, along) / (system.norm(outward) * system.norm(along));
    if (std::abs(cosine) > 0.98) d.used = true;
  }
}

// Whether a fold is, but for whole turns, one that the branch has passed before.
bool PathTracer::repeats(const PathSpot& fold) {
  const PathPoint here = pieces_.report(fold);
  const double range = std::abs(varied_.to() - varied_.from());
  for (const int e : out_.branches[branch_].events) {
    const PathEvent& event = out_.events[e];
    if (event.kind != PathEvent::Kind::fold || event.at.active_stops != here.active_stops) continue;
    if (std::abs(event.at.parameter - here.parameter) > tracing::same_pose * range) continue;
    const std::vector<double> x = pieces_.unwound(here.x, event.at.x, PathPieces::Turns::forces);
    if (solvers::largest_difference(x, event.at.x) < tracing::same_point) return true;
  }
  return false;
}

// --- steps ----------------------------------------------------------------------------------------------------------

std::optional<PathSpot> PathTracer::step(const PathSpot& here, double h, double& badness) {
  solvers::Curve& system = pieces_.curve(here.piece);
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

// --- the trace ------------------------------------------------------------------------------------------------------

// The way along one branch, from its start to what ends it. Steps of it return whether it goes on.
class PathTracer::Walk {
 public:
  Walk(PathTracer& of, const PathSpot& start, int from_event, Until until)
      : tracer_(of), pieces_(of.pieces_), start_(start), until_(until), here_(start) {
    const PathOptions& options = tracer_.options_;
    h_ = std::min(first_step, options.longest_step);
    Path& out = tracer_.out_;
    tracer_.branch_ = static_cast<int>(out.branches.size());
    out.branches.emplace_back().from = from_event;
    if (from_event >= 0 && out.events[from_event].kind == PathEvent::Kind::branch) {
      branch().points.push_back(out.events[from_event].at);
    }
    tracer_.add_point(start);
    for (std::size_t k = 0; k < tracer_.wanted_.size(); ++k) {
      if (start.p() == tracer_.wanted_[k]) out.wanted[k].push_back(pieces_.report(start));
    }
    pieces_.watch(here_, watched_);
  }

  std::vector<Loss> run() {
    while (may_go_on() && make_step() && is_sound() && pass_crossings()) {
    }
    return std::move(losses_);
  }

 private:
  PathBranch& branch() { return tracer_.out_.branches[tracer_.branch_]; }

  bool end(PathBranch::End how, std::string why = {}) {
    branch().end = how;
    branch().why = std::move(why);
    return false;
  }

  bool may_go_on() {
    if (tracer_.interrupted()) return end(PathBranch::End::interrupted);
    const int most = tracer_.options_.most_points;
    if (static_cast<int>(branch().points.size()) < most) return true;
    return end(PathBranch::End::limit, fmt::format("{} points were not enough", most));
  }

  // Makes a step that keeps to the curve and whose events can be told apart.
  bool make_step() {
    for (; h_ >= tracing::shortest_step; h_ *= 0.5) {
      std::optional<PathSpot> next = tracer_.step(here_, h_, badness_);
      ++tracer_.out_.steps;
      if (!next) continue;
      segment_.a = here_;
      segment_.b = std::move(*next);
      segment_.h = tracer_.crossings_.arc(segment_.a, segment_.b);
      crossings_.clear();
      pieces_.watch(segment_.b, next_watched_);
      // Where a branch begins it is not back at its start.
      const PathSpot* const start = steps_ > 2 ? &start_ : nullptr;
      if (!tracer_.crossings_.find(segment_, watched_, next_watched_, start, crossings_)) continue;
      ++steps_;
      return true;
    }
    if (pieces_.heaviest_multiplier(here_) > heavy_multipliers) return end_at_dead_centre(here_);
    return end(PathBranch::End::stuck, "no step along the curve succeeds " + place_text(here_));
  }

  bool is_sound() {
    if (pieces_.is_torn(segment_.b)) {
      return end(PathBranch::End::stuck, "joints that repeat others no longer fit together " + place_text(here_));
    }
    // What is driven may turn as often as it is asked to.
    if (!tracer_.varied_.is_driven() && pieces_.is_far(segment_.b)) {
      return end(PathBranch::End::stuck, "the mechanism runs away " + place_text(here_));
    }
    return true;
  }

  // Takes the events of the step in their order; goes on from its end, or in the next piece.
  bool pass_crossings() {
    std::sort(crossings_.begin(), crossings_.end(),
              [](const PathCrossing& a, const PathCrossing& b) { return a.s < b.s; });
    double from = 0.0;
    passed_ = here_;
    direction_ = here_.rate() >= 0.0 ? 1.0 : -1.0;
    for (PathCrossing& crossing : crossings_) {
      tracer_.fill(segment_, from, crossing.s, passed_, crossing.spot);
      from = crossing.s;
      switch (crossing.kind) {
        case PathCrossing::Kind::range:
        case PathCrossing::Kind::start:
          tracer_.add_point(crossing.spot);
          return end(crossing.kind == PathCrossing::Kind::range ? PathBranch::End::range : PathBranch::End::closed);
        case PathCrossing::Kind::dead_centre:
          return end_at_dead_centre(crossing.spot);
        case PathCrossing::Kind::watched:
          return switch_piece(crossing);
        case PathCrossing::Kind::fold:
          if (!pass_fold(crossing.spot)) return false;
          break;
        case PathCrossing::Kind::branch:
        case PathCrossing::Kind::multiple:
          if (!pass_branch_point(crossing.spot)) return false;
          break;
      }
    }
    tracer_.fill(segment_, from, segment_.h, passed_, segment_.b);
    here_ = std::move(segment_.b);
    switches_ = 0;
    tracer_.add_point(here_);
    h_ = std::min(tracer_.options_.longest_step, h_ * std::clamp(1.0 / badness_, 0.5, 2.0));
    std::swap(watched_, next_watched_);
    return true;
  }

  // --- ends of a piece

  bool switch_piece(PathCrossing& crossing) {
    PathSpot& spot = crossing.spot;
    PathEvent event = change_at(spot, crossing.watched);
    ++switches_;
    std::optional<PathSpot> beyond =
        switches_ > most_switches ? std::nullopt : pieces_.switched(spot, crossing.watched);
    spot.negative = passed_.negative;
    tracer_.add_point(spot, true);
    tracer_.judge(event, spot, crossing.watched);
    const int index = tracer_.add_event(event, spot);
    if (!beyond) return end_of_pieces(event, spot);
    const bool turns = beyond->rate() * spot.rate() < 0.0 && std::abs(beyond->rate()) > tracing::standstill;
    const int loss = turns ? add_kink(event, spot) : index;
    if (!may_lose(loss, spot, beyond->negative > 0 || turns)) return false;
    // What is reached here by the curve is lost by a mechanism that comes from the other side.
    if (beyond->negative == 0 && (spot.negative > 0 || turns)) {
      losses_.push_back({loss, *beyond, beyond->rate() >= 0.0 ? -1.0 : 1.0});
    }
    here_ = std::move(*beyond);
    h_ = std::min({h_, first_step, tracer_.options_.longest_step});
    pieces_.watch(here_, watched_);
    return true;
  }

  // What happens where something watched reaches zero.
  PathEvent change_at(const PathSpot& spot, int watched) const {
    PathEvent out;
    const int stops = static_cast<int>(spot.piece.side.size());
    const bool is_stop = watched < 2 * stops;
    out.kind = is_stop ? PathEvent::Kind::stop : PathEvent::Kind::slack;
    out.item = is_stop ? watched / 2 : pieces_.one_way()[watched - 2 * stops];
    out.on = is_stop ? spot.piece.side[out.item] == 0 : spot.piece.acts[watched - 2 * stops] == 0;
    return out;
  }

  // Adds the fold where the curve turns back at a change of pieces.
  int add_kink(const PathEvent& change, const PathSpot& spot) {
    PathEvent kink;
    kink.kind = PathEvent::Kind::fold;
    kink.error = change.error;
    kink.rounding_effect = change.rounding_effect;
    return tracer_.add_event(kink, spot);
  }

  // --- folds and branch points on a piece

  bool pass_fold(PathSpot& spot) {
    PathEvent event;
    event.kind = PathEvent::Kind::fold;
    tracer_.judge(event, spot, -1);
    // Degenerate: what is said of it is said of the side it was reached on.
    spot.negative = passed_.negative;
    if (tracer_.repeats(spot)) {
      tracer_.add_point(spot, true);
      return end(PathBranch::End::closed, "it repeats itself after whole turns");
    }
    const int index = tracer_.add_event(event, spot);
    tracer_.add_point(spot, true);
    // A mechanism that is loaded further cannot follow a curve that turns back.
    if (!may_lose(index, spot, segment_.b.negative > 0 || until_ == Until::unstable)) return false;
    direction_ = -direction_;
    pass(index, spot);
    return true;
  }

  bool pass_branch_point(PathSpot& spot) {
    spot.negative = passed_.negative;
    const VectorXd along = segment_.b.point.z - segment_.a.point.z;
    int index = tracer_.known_branch_point(spot);
    if (index < 0) {
      PathEvent event;
      event.kind = PathEvent::Kind::branch;
      event.error = 1e-15;
      index = tracer_.add_event(event, spot);
      tracer_.add_point(spot, true);
      tracer_.branch_points_.emplace_back(index, spot.point.z);
      if (tracer_.options_.branches) tracer_.depart(spot, index, along);
    } else {
      branch().events.push_back(index);
      tracer_.add_point(spot, true);
      tracer_.mark_used(index, spot, along);
    }
    if (!may_lose(index, spot, segment_.b.negative > 0)) return false;
    pass(index, spot);
    return true;
  }

  // Notes whether a stable mechanism leaves the curve at a spot, and whether the branch ends with that.
  bool may_lose(int event, const PathSpot& spot, bool leaves) {
    if (passed_.negative != 0 || !leaves) return true;
    losses_.push_back({event, spot, direction_});
    return until_ == Until::unstable ? end(PathBranch::End::snapped) : true;
  }

  // Goes on from a spot on the step, with the stability of the step's end.
  void pass(int event, PathSpot& spot) {
    if (passed_.negative > 0 && segment_.b.negative == 0) losses_.push_back({event, spot, -direction_});
    spot.negative = segment_.b.negative;
    passed_ = spot;
  }

  // --- words

  std::string place_text(const PathSpot& spot) const {
    const VariedScene& varied = tracer_.varied_;
    return fmt::format("at {} = {:.6g}", varied.name(), pieces_.value_at(spot.p()) / varied.unit());
  }

  bool end_at_dead_centre(const PathSpot& spot) {
    return end(
        PathBranch::End::singular,
        "towards a dead centre, where the closures lose rank, joint forces grow without bound " + place_text(spot));
  }

  // Tells why no piece follows a change.
  bool end_of_pieces(const PathEvent& change, const PathSpot& spot) {
    const VariedScene& varied = tracer_.varied_;
    const std::string place = place_text(spot);
    if (switches_ > most_switches) {
      return end(PathBranch::End::singular, "several stops or springs change together " + place);
    }
    if (change.kind == PathEvent::Kind::stop && change.on) {
      std::vector<int> stops = active_stops(spot.piece, varied.is_driven());
      if (std::find(stops.begin(), stops.end(), change.item) == stops.end()) stops.push_back(change.item);
      std::string holding;
      for (const int stop : stops) {
        holding += (holding.empty() ? "" : " and ") + varied.scene().stops[static_cast<std::size_t>(stop)].title();
      }
      return end(varied.is_driven() ? PathBranch::End::blocked : PathBranch::End::singular,
                 fmt::format("{} leave{} no motion {}", holding, stops.size() > 1 ? "" : "s", place));
    }
    return end(PathBranch::End::singular, "beyond it a whole set of positions is in equilibrium " + place);
  }

  PathTracer& tracer_;
  PathPieces& pieces_;
  const PathSpot& start_;
  Until until_;
  std::vector<Loss> losses_;
  PathSpot here_;
  double h_ = 0.0;  // length of the next step
  int steps_ = 0;
  int switches_ = 0;  // of pieces since the last whole step
  std::vector<PathPieces::Watched> watched_, next_watched_;
  // The step in hand.
  PathSegment segment_;
  double badness_ = 1.0;  // by which it is too long
  std::vector<PathCrossing> crossings_;
  PathSpot passed_;         // the last spot on it
  double direction_ = 1.0;  // of the parameter there: 1 or -1
};

std::vector<PathTracer::Loss> PathTracer::trace(const PathSpot& start, int from_event, Until until) {
  pieces_.curve(start.piece);  // compiled before the clock starts
  const auto begin = std::chrono::steady_clock::now();
  std::vector<Loss> losses = Walk(*this, start, from_event, until).run();
  out_.microseconds += std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count();
  return losses;
}

}  // namespace poise
