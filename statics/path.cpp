#include "statics/path.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "statics/equilibrium.hpp"
#include "statics/path_tracer.hpp"

namespace poise {
namespace {

constexpr double beyond_loss = 1e-6;  // of the range: how far beyond the loss of stability the mechanism is released

double value_at_part(const VariedScene& varied, double p) {
  return p == 1.0 ? varied.to() : varied.from() + p * (varied.to() - varied.from());
}

class PathFinder {
 public:
  PathFinder(const VariedScene& varied, const PathOptions& options, Path& out)
      : varied_(varied), options_(options), out_(out), tracer_(varied, options, out) {}

  void run() {
    const std::optional<PathSpot> start = find_start();
    if (!start) return;
    if (options_.follow == PathOptions::Follow::jump) {
      load_and_unload(*start);
    } else {
      follow_all(*start);
    }
    conclude();
  }

 private:
  std::optional<PathSpot> find_start() {
    const auto model = varied_.model_at(varied_.from());
    SolveOptions solving;
    solving.interrupt = options_.interrupt;
    solving.certificate = options_.certificate;
    const Equilibrium first = solve(*model, solving);
    const auto fail = [&](const std::string& why) {
      out_.status = first.status == Status::interrupted ? Path::Status::interrupted : Path::Status::no_start;
      out_.why = fmt::format("no equilibrium to begin with at {} = {:.6g}: {}", varied_.name(),
                             varied_.from() / varied_.unit(), why);
      return std::nullopt;
    };
    if (!first.found()) return fail(first.why);
    if (first.certificate.outcome == Outcome::neutral) {
      return fail(first.certificate.statement + "; begin at another value");
    }
    auto spot = tracer_.spot(first.x, 0.0, first.certificate.active_stops, 1.0);
    if (!spot) return fail("the equilibrium is singular there; begin at another value");
    return spot;
  }

  void follow_all(const PathSpot& start) {
    note_losses(tracer_.trace(start, -1, PathTracer::Until::ends));
    std::deque<PathTracer::Departure>& departures = tracer_.departures();
    for (std::size_t k = 0; k < departures.size() && !tracer_.interrupted(); ++k) {
      if (departures[k].used) continue;
      departures[k].used = true;
      const PathSpot from = departures[k].start;
      note_losses(tracer_.trace(from, departures[k].event, PathTracer::Until::ends));
    }
  }

  // Where the mechanism goes that is loaded further than a point at which stability is lost.
  std::optional<PathSpot> land(const PathTracer::Loss& loss, PathPoint& landing, std::string& why) {
    const auto released = [&](double little) -> std::optional<std::vector<double>> {
      const double p = loss.at.p() + loss.direction * little;
      const auto model = varied_.model_at(value_at_part(varied_, p));
      SolveOptions solving;
      solving.seek = Seek::stable;
      solving.interrupt = options_.interrupt;
      const Equilibrium rest = solve(*model, tracer_.report(loss.at).x, solving);
      if (!rest.found()) {
        why = rest.why;
        return std::nullopt;
      }
      active_ = rest.certificate.active_stops;
      return rest.x;
    };
    const PathPoint from = tracer_.report(loss.at);
    const auto distance = [&](const std::vector<double>& x) {
      double d = 0.0;
      for (std::size_t i = 0; i < x.size(); ++i) d = std::max(d, std::abs(x[i] - from.x[i]));
      return d;
    };
    const auto far = released(beyond_loss);
    if (!far) return std::nullopt;
    // Where the distance shrinks with the load the mechanism moves on without a jump.
    const auto near = released(0.01 * beyond_loss);
    if (near && distance(*near) < 0.5 * distance(*far)) {
      why.clear();
      return std::nullopt;
    }
    const auto spot = tracer_.spot(near ? *near : *far, loss.at.p(), active_, loss.direction);
    if (!spot) {
      why = "the equilibrium it lands on is singular";
      return std::nullopt;
    }
    landing = tracer_.report(*spot);
    return spot;
  }

  // Adds the events of kind snap. Returns where the mechanism lands of the last.
  std::optional<PathSpot> note_losses(const std::vector<PathTracer::Loss>& losses) {
    std::optional<PathSpot> last;
    for (const PathTracer::Loss& loss : losses) {
      PathEvent snap;
      snap.kind = PathEvent::Kind::snap;
      PathPoint landing;
      last = land(loss, landing, snap.why);
      if (!last && snap.why.empty()) continue;
      if (last) snap.landing = landing;
      snap.at = out_.events[loss.event].at;
      snap.error = out_.events[loss.event].error;
      snap.rounding_effect = out_.events[loss.event].rounding_effect;
      out_.branches.back().events.push_back(static_cast<int>(out_.events.size()));
      out_.events.push_back(std::move(snap));
    }
    return last;
  }

  // Loading with jumps up to the last value, then back.
  void load_and_unload(const PathSpot& start) {
    constexpr int most_snaps = 100;
    PathSpot here = start;
    for (const double direction : {1.0, -1.0}) {
      int from = -1;
      for (int k = 0; k < most_snaps; ++k) {
        if (here.rate() * direction < 0.0) here.point.tangent = -here.point.tangent;
        const auto losses = tracer_.trace(here, from, PathTracer::Until::unstable);
        if (tracer_.interrupted() || losses.empty()) break;
        const auto landed = note_losses(losses);
        if (!landed) return;
        here = *landed;
        from = static_cast<int>(out_.events.size()) - 1;
      }
      const PathBranch& last = out_.branches.back();
      if (last.end != PathBranch::End::range) return;
      const auto spot =
          tracer_.spot(last.points.back().x, direction > 0.0 ? 1.0 : 0.0, last.points.back().active_stops, -direction);
      if (!spot) return;
      here = *spot;
    }
  }

  void conclude() {
    out_.evaluations = tracer_.evaluations();
    out_.status = Path::Status::traced;
    for (const PathBranch& branch : out_.branches) {
      if (branch.end == PathBranch::End::interrupted) out_.status = Path::Status::interrupted;
      const bool ended = branch.end == PathBranch::End::range || branch.end == PathBranch::End::closed ||
                         branch.end == PathBranch::End::joined || branch.end == PathBranch::End::snapped;
      if (!ended && out_.status == Path::Status::traced) {
        out_.status = Path::Status::incomplete;
        out_.why = branch.why;
      }
    }
  }

  const VariedScene& varied_;
  const PathOptions& options_;
  Path& out_;
  PathTracer tracer_;
  std::vector<int> active_;
};

void certify_point(const VariedScene& varied, const PathOptions& options, PathPoint& point) {
  const auto model = varied.model_at(point.parameter);
  const Mechanism<double>& m = model->mechanism();
  if (!m.has_follower_loads()) {
    std::vector<Planar<double>> pose(m.pose_size());
    m.place(point.x.data(), pose.data());
    point.energy = m.energy(point.x.data(), pose.data()) * model->scales().energy();
  }
  if (!options.certify) return;
  const Certificate certificate = certify(*model, point.x, options.certificate);
  point.statement = certificate.statement;
  point.radius = certificate.radius;
  point.proof = certificate.confirmed() ? PointProof::proved : PointProof::failed;
  if (certificate.confirmed()) {
    point.stability = certificate.stability;
    point.unstable_directions = certificate.unstable_directions;
  }
}

template <class Use>
void every_point(Path& path, Use use) {
  for (PathBranch& branch : path.branches) {
    for (PathPoint& point : branch.points) use(point);
  }
  for (std::vector<PathPoint>& points : path.wanted) {
    for (PathPoint& point : points) use(point);
  }
  for (PathEvent& event : path.events) {
    use(event.at);
    if (event.landing) use(*event.landing);
  }
}

}  // namespace

int PathEvent::digits() const {
  const double doubt = std::max({error, rounding_effect, 1e-16});
  return std::clamp(static_cast<int>(std::floor(-std::log10(doubt))), 0, 16);
}

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
  const auto begin = std::chrono::steady_clock::now();
  PathFinder(varied, options, out).run();
  out.microseconds = std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count();
  every_point(out, [&](PathPoint& point) { certify_point(varied, options, point); });
  return out;
}

}  // namespace poise
