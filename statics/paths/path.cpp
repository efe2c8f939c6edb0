#include "statics/paths/path.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include <Eigen/Core>
#include <fmt/format.h>

#include "solvers/newton.hpp"
#include "solvers/root.hpp"
#include "solvers/vectors.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/equilibrium/settle.hpp"
#include "statics/model/mobility.hpp"
#include "statics/model/readings.hpp"
#include "statics/paths/private/event_accuracy.hpp"
#include "statics/paths/private/path_tracer.hpp"
#include "statics/paths/varied_mechanism.hpp"

namespace poise {
namespace {

using Eigen::VectorXd;

constexpr double widest_range = 1e6;     // of loads, in forces that act besides
constexpr double small_distance = 0.05;  // rad or mechanism sizes
constexpr double same_fold = 1e-4;       // the same: next to branch points folds are found to half the digits
constexpr int driven_steps = 50;         // from the start's pose to the first value of a driven measure
constexpr double beyond_loss = 1e-6;     // of the range: how far beyond the loss of stability the mechanism is released

// A driven measure is held in any pose, so that its equilibrium does not tell whether the springs are as the curve
// says.
std::string spring_in_another_state(const StaticModel& model, const PathPoint& point) {
  const Readings readings = read_off(model, point.x);
  for (const int e : VariedMechanism::one_way_springs(model.scene())) {
    const auto& spring = std::get<LinearSpring>(model.scene().elements[e].law);
    const bool is_slack =
        std::find(point.slack_springs.begin(), point.slack_springs.end(), e) != point.slack_springs.end();
    const double beyond = std::abs(readings.elements[e].value - spring.free_length);
    if (is_slack == readings.elements[e].slack || beyond < 1e-9 * model.scales().length) continue;
    return fmt::format("\"{}\" {} here, unlike on this piece of the curve", model.scene().elements[e].name,
                       is_slack ? "acts" : "is slack");
  }
  return {};
}

void certify_point(const VariedScene& varied, const PathOptions& options, PathPoint& point) {
  const auto model = varied.model_at(point.parameter);
  const Mechanism<double>& m = model->mechanism();
  point.energy = energy_at(*model, point.x);
  if (!options.certify) return;
  const Certificate certificate = certify(*model, point.x, options.certificate);
  point.statement = certificate.statement;
  point.radius = certificate.radius;
  const std::string other_state = spring_in_another_state(*model, point);
  if (certificate.confirmed() && other_state.empty()) {
    point.proof = PointProof::proved;
  } else if (!other_state.empty()) {
    point.proof = PointProof::failed;
    point.statement = other_state;
  } else if (point.proof != PointProof::critical) {
    point.proof = PointProof::failed;
  }
  if (certificate.confirmed()) {
    point.stability = certificate.stability;
    point.unstable_directions = certificate.unstable_directions;
    if (point.stability == Stability::unknown && m.has_follower_loads() && options.dynamic_stability) {
      point.stability = options.dynamic_stability(*model, point.x);
    }
  }
}

class PathFinder {
 public:
  PathFinder(const VariedScene& varied, const PathOptions& options, Path& out)
      : varied_(varied), options_(options), out_(out), pieces_(varied), tracer_(varied, options, pieces_, out) {}

  void run() {
    const std::optional<PathSpot> start = find_start();
    if (!start) return;
    if (jumps()) {
      load_and_unload(*start);
    } else {
      follow_all(*start);
      search();
    }
    conclude();
  }

  // Between proved points of which small motions grow at one only.
  void find_flutter() {
    for (std::size_t b = 0; b < out_.branches.size(); ++b) {
      for (std::size_t k = 1; k < out_.branches[b].points.size(); ++k) {
        const PathPoint &before = out_.branches[b].points[k - 1], &after = out_.branches[b].points[k];
        const bool stable = before.stability == Stability::stable, unstable = before.stability == Stability::unstable;
        const bool changes =
            (stable && after.stability == Stability::unstable) || (unstable && after.stability == Stability::stable);
        const bool by_motion = before.unstable_directions == after.unstable_directions &&
                               before.proof == PointProof::proved && after.proof == PointProof::proved;
        if (changes && by_motion) add_flutter(static_cast<int>(b), before, after);
      }
    }
  }

 private:
  // Finds the event by bisection of the parameter.
  void add_flutter(int branch, PathPoint before, PathPoint after) {
    PathEvent event;
    event.kind = PathEvent::Kind::flutter;
    bool is_lost = false;
    const auto is_before = [&](double& value) -> std::optional<bool> {
      std::vector<double> x = before.x;
      for (std::size_t i = 0; i < x.size(); ++i) x[i] = 0.5 * (x[i] + after.x[i]);
      const auto spot = pieces_.spot(x, varied_.part_at(value), before.active_stops, 1.0);
      is_lost = !spot;
      if (is_lost) return std::nullopt;
      PathPoint middle = pieces_.report(*spot);
      certify_point(varied_, options_, middle);
      if (middle.proof != PointProof::proved) return std::nullopt;
      value = middle.parameter;
      const bool out = middle.stability == before.stability;
      (out ? before : after) = std::move(middle);
      return out;
    };
    solvers::Bracket bracket{before.parameter, after.parameter};
    solvers::bisect_at_most(50, bracket, is_before);
    if (is_lost) return;
    event.at = before;
    // Growth below a ten-millionth of the frequencies counts as none (motion/modes.hpp).
    event.error =
        std::max(1e-7, std::abs(after.parameter - before.parameter) / std::max(std::abs(before.parameter), 1e-300));
    tracer_.add_event(std::move(event), branch);
  }

  bool jumps() const { return options_.follow != PathOptions::Follow::unstable; }

  std::optional<PathSpot> find_start() {
    const auto model = varied_.model_at(varied_.from());
    const auto fail = [&](const std::string& why) {
      out_.status = tracer_.interrupted() ? Path::Status::interrupted : Path::Status::no_start;
      out_.why = fmt::format("no equilibrium to begin with at {} = {:.6g}: {}", varied_.name(),
                             varied_.from() / varied_.unit(), why);
      return std::nullopt;
    };
    const bool is_given = options_.from == PathOptions::From::given;
    std::vector<double> x = is_given ? options_.start : varied_.is_driven() ? driven_start(*model) : assemble(*model);
    if (options_.from == PathOptions::From::settle) {
      const Settling rest = settle(*model, x, {.interrupt = options_.interrupt});
      if (rest.end != Settling::End::settled && rest.end != Settling::End::start_unstable) return fail(rest.why);
      x = rest.x;
      if (rest.end == Settling::End::start_unstable) {
        out_.notes.push_back("The start is an unstable equilibrium, which the mechanism would leave" +
                             std::string(jumps() ? "; loading begins where one side of it falls to." : "."));
        if (jumps() && rest.sides.empty()) return fail("the start is unstable");
        if (jumps()) x = rest.sides.front().x;
      }
    } else if (!is_given) {
      SolveOptions solving;
      solving.seek = Seek::any;
      solving.interrupt = options_.interrupt;
      solving.certificate = options_.certificate;
      const Equilibrium first = solve(*model, x, solving);
      if (!first.found()) return fail(first.why);
      x = first.x;
    }
    const Certificate certificate = certify(*model, x, options_.certificate);
    if (!certificate.confirmed()) return fail(certificate.statement);
    if (certificate.outcome == Outcome::neutral) {
      return fail(fmt::format("it rests there at any value of {}; begin at another value",
                              fmt::join(certificate.neutral_coordinates, ", ")));
    }
    auto spot = pieces_.spot(certificate.x, 0.0, certificate.active_stops, 1.0);
    if (!spot) return fail("the equilibrium is singular there; begin at another value");
    if (jumps() && spot->negative > 0)
      return fail("it is unstable, and a mechanism that is loaded does not rest there");
    if (!pieces_.depends(*spot)) {
      throw InputError(
          fmt::format("{}: equilibrium does not depend on it here; expected another number", varied_.name()));
    }
    return spot;
  }

  // The assembled start of the scene, driven to the first value in steps.
  std::vector<double> driven_start(const StaticModel& first) {
    // The stop that holds it has no limits there.
    const ScaledModel plain(varied_.scene(), Purpose::statics, varied_.scales(), varied_.varying());
    const Mobility mobility = analyse_mobility(plain);
    expect_closed(plain, mobility);
    std::vector<double> x = mobility.x;
    const auto measure = [&] {
      std::vector<Planar<double>> pose(first.mechanism().pose_size());
      std::vector<double> c(first.mechanism().constraints());
      first.mechanism().place(x.data(), pose.data());
      first.mechanism().constraint(x.data(), pose.data(), c.data());
      const double scale = varied_.scene().stops.back().on.is_angle() ? 1.0 : varied_.scales().length;
      return c.back() * scale;
    };
    const double begin = measure();
    for (int k = 1; k <= driven_steps; ++k) {
      const double value = k == driven_steps ? varied_.from() : begin + (varied_.from() - begin) * k / driven_steps;
      const auto model = varied_.model_at(value);
      solvers::Newton closing(model->problem());
      const solvers::NewtonResult& closed = closing.close(x);
      if (closed.end != solvers::NewtonEnd::converged) {
        throw AssemblyError(
            fmt::format("{}{} cannot be driven from {:.6g}, where it is at the start, to {:.6g}; begin "
                        "nearer to it, or give another [start]",
                        where(first), varied_.name(), begin / varied_.unit(), varied_.from() / varied_.unit()));
      }
      x = closed.x;
    }
    return x;
  }

  void follow_all(const PathSpot& start) {
    follow(start, -1);
    follow_departures();
  }

  void follow_departures() {
    std::deque<PathTracer::Departure>& departures = tracer_.departures();
    while (!tracer_.interrupted()) {
      const auto next = std::find_if(departures.begin(), departures.end(), [](const auto& d) { return !d.used; });
      if (next == departures.end()) break;
      next->used = true;
      const PathTracer::Departure departure = *next;
      follow(departure.start, departure.event);
    }
  }

  // A curve, and those on which the mechanism lands where it loses its stability there.
  void follow(const PathSpot& start, int from) {
    const std::vector<PathTracer::Loss> losses = tracer_.trace(start, from, PathTracer::Until::ends);
    for (const PathTracer::Loss& loss : losses) {
      if (tracer_.interrupted()) return;
      Landing landed = note_loss(loss, branch_of(loss));
      if (landed.kind != Landing::Kind::jump || is_known(pieces_.report(*landed.spot))) continue;
      const int snap = static_cast<int>(out_.events.size()) - 1;
      follow(*landed.spot, snap);
      landed.spot->reverse();
      follow(*landed.spot, snap);
    }
  }

  // Equilibria on other curves, by deflation of those that are known.
  void search() {
    constexpr int values = 5, steps = 100;
    std::minstd_rand random(20261122);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    for (int v = 0; v < values && options_.search > 0; ++v) {
      const double p = static_cast<double>(v) / (values - 1);
      const auto model = varied_.model_at(pieces_.value_at(p));
      for (int k = 0; k < options_.search && !tracer_.interrupted(); ++k) {
        const std::vector<PathSpot> known = spots_at(p);
        std::vector<double> x = model->start();
        if (!known.empty()) {
          const VectorXd& z = known[static_cast<std::size_t>(k) % known.size()].point.z;
          std::copy(z.data(), z.data() + x.size(), x.begin());
        }
        // First near what is known, then anywhere.
        const double reach = M_PI * (k + 1) / options_.search;
        for (double& value : x) value += reach * uniform(random);
        solvers::Newton closing(model->problem());
        const solvers::NewtonResult& closed = closing.close(x);
        if (closed.end != solvers::NewtonEnd::converged) continue;
        const auto place = pieces_.deflated(closed.x, p, known, steps);
        if (!place) continue;
        const Certificate certificate = certify(*model, *place, options_.certificate);
        if (certificate.outcome != Outcome::proved) continue;
        auto found = pieces_.spot(certificate.x, p, certificate.active_stops, 1.0);
        if (!found || is_known(pieces_.report(*found))) continue;
        // Both ways, but not out of the range.
        if (p < 1.0) follow(*found, -1);
        found->reverse();
        if (p > 0.0) follow(*found, -1);
        follow_departures();
      }
    }
  }

  // Where the branches pass a value of the parameter.
  std::vector<PathSpot> spots_at(double p) {
    std::vector<PathSpot> out;
    const double value = pieces_.value_at(p);
    for (const PathBranch& branch : out_.branches) {
      for (std::size_t k = 1; k < branch.points.size(); ++k) {
        const PathPoint &a = branch.points[k - 1], &b = branch.points[k];
        if ((a.parameter - value) * (b.parameter - value) > 0.0 || a.parameter == b.parameter) continue;
        const double share = (value - a.parameter) / (b.parameter - a.parameter);
        std::vector<double> x = a.x;
        for (std::size_t i = 0; i < x.size(); ++i) x[i] += share * (b.x[i] - a.x[i]);
        if (const auto spot = pieces_.spot(x, p, share < 0.5 ? a.active_stops : b.active_stops, 1.0)) {
          out.push_back(*spot);
        }
      }
    }
    return out;
  }

  int branch_of(const PathTracer::Loss& loss) const {
    for (std::size_t b = 0; b < out_.branches.size(); ++b) {
      const std::vector<int>& events = out_.branches[b].events;
      if (std::find(events.begin(), events.end(), loss.event) != events.end()) return static_cast<int>(b);
    }
    return static_cast<int>(out_.branches.size()) - 1;
  }

  // Whether a branch passes through the point: between two of its points that are no farther apart than usual.
  bool is_known(const PathPoint& point) {
    const auto through = [&](const PathPoint& a, const PathPoint& b) {
      if ((a.parameter - point.parameter) * (b.parameter - point.parameter) > 0.0) return false;
      if (a.active_stops != point.active_stops && b.active_stops != point.active_stops) return false;
      const double share =
          a.parameter == b.parameter ? 0.0 : (point.parameter - a.parameter) / (b.parameter - a.parameter);
      std::vector<double> between = a.x;
      for (std::size_t i = 0; i < between.size(); ++i) between[i] += share * (b.x[i] - a.x[i]);
      const std::vector<double> x = pieces_.unwound(point.x, between, PathPieces::Turns::forces_and_stops);
      return solvers::largest_difference(x, between) < 0.5 * options_.spacing;
    };
    return std::any_of(out_.branches.begin(), out_.branches.end(), [&](const PathBranch& branch) {
      for (std::size_t k = 1; k < branch.points.size(); ++k) {
        if (through(branch.points[k - 1], branch.points[k])) return true;
      }
      return false;
    });
  }

  // Where a mechanism goes that is loaded further than a point at which it loses its stability.
  struct Landing {
    enum class Kind { jump, goes_on, nowhere } kind = Kind::nowhere;
    std::optional<PathSpot> spot{};             // of `goes_on` a little further
    std::vector<std::vector<double>> course{};  // of `jump`
    std::string why{};                          // of `nowhere`
  };
  Landing land(const PathTracer::Loss& loss) {
    const PathPoint from = pieces_.report(loss.at);
    Landing out;
    const auto part = [&](double little) { return loss.at.p() + loss.direction * little; };
    const auto released = [&](double little) {
      Settling rest = settle(*varied_.model_at(pieces_.value_at(part(little))), from.x,
                             {.course = options_.courses, .interrupt = options_.interrupt});
      // On a curve that goes on without a jump the start is an equilibrium that the mechanism leaves to either side.
      if (rest.end == Settling::End::start_unstable && !rest.sides.empty()) {
        Settling::Side& side = rest.sides.front();
        rest.end = side.end;
        rest.x = std::move(side.x);
        rest.active_stops = std::move(side.active_stops);
      }
      if (rest.end != Settling::End::settled) out.why = rest.why;
      return rest;
    };
    const auto distance = [&](const std::vector<double>& x) { return solvers::largest_difference(x, from.x); };
    const Settling far = released(beyond_loss);
    Settling near = released(0.01 * beyond_loss);
    if (far.end != Settling::End::settled || near.end != Settling::End::settled) return out;
    // Where the distance is small and shrinks with the load the mechanism moves on without a jump.
    const double reach = distance(far.x);
    const bool goes_on = reach < same_fold || (reach < small_distance && distance(near.x) < 0.5 * reach);
    out.spot = goes_on ? pieces_.spot(far.x, part(beyond_loss), far.active_stops, loss.direction)
                       : pieces_.spot(near.x, loss.at.p(), near.active_stops, loss.direction);
    if (out.spot) {
      out.kind = goes_on ? Landing::Kind::goes_on : Landing::Kind::jump;
      if (!goes_on) out.course = std::move(near.course);
    } else {
      out.why = "the equilibrium it comes to is not isolated";
    }
    return out;
  }

  // Adds the event of kind snap, if the mechanism does not simply go on.
  Landing note_loss(const PathTracer::Loss& loss, int branch) {
    Landing out = land(loss);
    if (out.kind == Landing::Kind::goes_on) return out;
    PathEvent snap;
    snap.kind = PathEvent::Kind::snap;
    snap.why = out.why;
    snap.course = out.course;
    if (out.spot) snap.landing = pieces_.report(*out.spot);
    const PathEvent& lost = out_.events[loss.event];
    snap.at = lost.at;
    snap.error = lost.error;
    snap.rounding_effect = lost.rounding_effect;
    tracer_.add_event(std::move(snap), branch);
    return out;
  }

  // Loading with jumps up to the last value, then back where that is asked for.
  void load_and_unload(const PathSpot& start) {
    constexpr int most_snaps = 100;
    PathSpot here = start;
    for (const double direction : {1.0, -1.0}) {
      if (direction < 0.0 && options_.follow == PathOptions::Follow::load) return;
      int from = -1;
      for (int k = 0; k < most_snaps; ++k) {
        if (here.rate() * direction < 0.0) here.reverse();
        const auto losses = tracer_.trace(here, from, PathTracer::Until::unstable);
        if (tracer_.interrupted() || losses.empty()) break;
        const int branch = static_cast<int>(out_.branches.size()) - 1;
        const Landing landed = note_loss(losses.back(), branch);
        if (landed.kind == Landing::Kind::nowhere) {
          out_.branches[branch].end = PathBranch::End::stuck;
          out_.branches[branch].why = landed.why;
          return;
        }
        here = *landed.spot;
        if (here.p() < 0.0 || here.p() > 1.0) return;
        from = losses.back().event;
        if (landed.kind == Landing::Kind::goes_on) continue;
        from = static_cast<int>(out_.events.size()) - 1;
        const PathEvent snap = out_.events.back();
        if (direction > 0.0 || !is_known(*snap.landing)) continue;
        PathEvent back;
        back.kind = PathEvent::Kind::hysteresis_end;
        back.at = *snap.landing;
        back.error = snap.error;
        back.rounding_effect = snap.rounding_effect;
        tracer_.add_event(std::move(back), branch);
      }
      const PathBranch& last = out_.branches.back();
      if (last.end != PathBranch::End::range) return;
      const auto spot =
          pieces_.spot(last.points.back().x, direction > 0.0 ? 1.0 : 0.0, last.points.back().active_stops, -direction);
      if (!spot) return;
      here = *spot;
    }
  }

  void conclude() {
    out_.evaluations = pieces_.evaluations();
    out_.status = Path::Status::traced;
    if (const double times = varied_.excess(); times > widest_range) {
      out_.status = Path::Status::incomplete;
      out_.why = fmt::format(
          "the range is {:.0e} times as wide as the forces that act besides, so that events may be missed or be none; "
          "narrow it",
          times);
      out_.notes.emplace_back(
          "The range is so wide for the forces that act besides that events may be missed; narrow it.");
    }
    for (const PathBranch& branch : out_.branches) {
      if (branch.end == PathBranch::End::interrupted) out_.status = Path::Status::interrupted;
      const bool ended = branch.end == PathBranch::End::range || branch.end == PathBranch::End::closed ||
                         branch.end == PathBranch::End::blocked || branch.end == PathBranch::End::snapped;
      if (!ended && out_.status == Path::Status::traced) {
        out_.status = Path::Status::incomplete;
        out_.why = branch.why;
      }
    }
  }

  const VariedScene& varied_;
  const PathOptions& options_;
  Path& out_;
  PathPieces pieces_;
  PathTracer tracer_;
};

std::vector<PathPoint*> all_points(Path& path) {
  std::vector<PathPoint*> out;
  for (PathBranch& branch : path.branches) {
    for (PathPoint& point : branch.points) out.push_back(&point);
  }
  for (std::vector<PathPoint>& points : path.wanted) {
    for (PathPoint& point : points) out.push_back(&point);
  }
  for (PathEvent& event : path.events) {
    out.push_back(&event.at);
    if (event.landing) out.push_back(&*event.landing);
  }
  return out;
}

}  // namespace

int PathEvent::digits() const { return decimal_digits(error, rounding_effect); }

int Path::unproved() const {
  int count = 0;
  for (const PathBranch& branch : branches) {
    for (const PathPoint& point : branch.points) count += point.proof == PointProof::failed;
  }
  return count;
}

Path path(const VariedScene& varied, const PathOptions& options) {
  Path out;
  out.wanted.resize(options.at.size());
  PathFinder finder(varied, options, out);
  finder.run();
  int done = 0;
  for (PathPoint* point : all_points(out)) {
    if (options.interrupt != nullptr && options.interrupt->load()) {
      out.status = Path::Status::interrupted;
      break;
    }
    certify_point(varied, options, *point);
    if (options.progress && ++done % 64 == 0) options.progress(point->parameter, done);
  }
  if (options.certify && options.dynamic_stability && out.status != Path::Status::interrupted) finder.find_flutter();
  return out;
}

}  // namespace poise
