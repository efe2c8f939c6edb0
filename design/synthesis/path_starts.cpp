#include "design/synthesis/private/path_starts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "design/synthesis/path_curve.hpp"
#include "design/synthesis/path_motion.hpp"

namespace poise {
namespace {

constexpr double whole_turn = 2 * std::numbers::pi;

// Lengths over that of the crank.
constexpr double least_ratio = 0.15, near_ratio = 5.0, far_ratio = 40.0;

double log_uniform(solvers::RandomStream& random, double low, double high) {
  return random.uniform(std::log(low), std::log(high));
}

// A linkage with a crank of length 1 about the origin, turned at random.
PathVector random_shape(PathLinkage linkage, solvers::RandomStream& random) {
  PathVector x{};
  const double most = random.uniform() < 0.5 ? near_ratio : far_ratio;
  x[at_coupler] = log_uniform(random, least_ratio, most);
  // A slider-crank keeps 0 here.
  const double output = log_uniform(random, least_ratio, most);
  if (linkage == PathLinkage::four_bar) x[at_output] = output;
  const double turned = random.uniform(0.0, whole_turn);
  if (linkage == PathLinkage::four_bar) {
    const Vec2 far = std::exp(log_uniform(random, least_ratio, most)) * unit(turned);
    x[at_b] = far.x;
    x[at_b + 1] = far.y;
  } else {
    x[at_b] = turned;
    x[at_b + 1] = random.uniform(-1.0, 1.0) * std::exp(x[at_coupler]);
  }
  const Vec2 direction = unit(random.uniform(0.0, whole_turn));
  const Vec2 arm = std::exp(log_uniform(random, 0.1, 5.0)) * direction;
  x[at_point] = arm.x;
  x[at_point + 1] = arm.y;
  return x;
}

// Turned and scaled by a complex number, then moved.
PathVector moved(PathLinkage linkage, const PathVector& x, const Vec2& by, const Vec2& to) {
  PathVector out = x;
  const double scale = norm(by), turned = std::atan2(by.y, by.x);
  const Vec2 a = by * Vec2{x[at_a], x[at_a + 1]} + to;
  out[at_a] = a.x;
  out[at_a + 1] = a.y;
  if (linkage == PathLinkage::four_bar) {
    const Vec2 b = by * Vec2{x[at_b], x[at_b + 1]} + to;
    out[at_b] = b.x;
    out[at_b + 1] = b.y;
  } else {
    out[at_b] = x[at_b] + turned;
    out[at_b + 1] = scale * x[at_b + 1];
  }
  for (const int link : {at_crank, at_coupler}) out[link] = x[link] + std::log(scale);
  if (linkage == PathLinkage::four_bar) out[at_output] = x[at_output] + std::log(scale);
  out[at_point] = scale * x[at_point];
  out[at_point + 1] = scale * x[at_point + 1];
  return out;
}

Vec2 mean_of(const std::vector<Vec2>& points) {
  Vec2 sum{};
  for (const Vec2& p : points) sum += p;
  return (1.0 / static_cast<double>(points.size())) * sum;
}

// The angle that a crank has in a task where its angle in the drawn linkage was t (without x[at_start]).
double ground_angle(const PathFit::Task& task, const PathVector& x) {
  return task.from_ground ? std::atan2(x[at_b + 1] - x[at_a + 1], x[at_b] - x[at_a]) : 0.0;
}

std::vector<double> random_angles(std::size_t count, solvers::RandomStream& random) {
  std::vector<double> out;
  double sum = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    out.push_back(sum);
    sum += random.uniform(0.3, 1.7);
  }
  const double begin = random.uniform(0.0, whole_turn), side = random.uniform() < 0.5 ? -1.0 : 1.0;
  const double span = side * random.uniform(0.6, whole_turn);
  for (double& t : out) t = begin + span * t / sum;
  return out;
}

class Draw {
 public:
  Draw(const PathFit::Task& task, const std::vector<double>& crank, solvers::RandomStream& random)
      : task_(task), crank_(crank), random_(random) {}

  std::optional<PathStart> draw() {
    PathVector x = random_shape(task_.linkage, random_);
    if (task_.limits.full_turn && !crank_range(task_.linkage, x).full()) return std::nullopt;
    const int closure = random_.uniform() < 0.5 ? -1 : 1;
    if (task_.pivots_given) return at_given_pivots(x, closure);
    PathStart out{x, {}, std::vector<int>(task_.points.size(), closure)};
    const double ground = ground_angle(task_, x);
    const double begin = task_.start_free ? random_.uniform(0.0, whole_turn) : 0.0;
    const std::vector<double> angles = task_.timed ? crank_ : random_angles(task_.points.size(), random_);
    std::vector<Vec2> drawn;
    for (const double t : angles) {
      const CouplerPlace pose = coupler_place(task_.linkage, x, t + (task_.timed ? begin + ground : 0.0), closure);
      if (pose.gap > 0.0) return std::nullopt;
      drawn.push_back(pose.point);
    }
    return onto_points(std::move(out), drawn, angles, begin);
  }

 private:
  // The move, turn and scale that minimise the sum of squares; without a turn where that would change given angles.
  std::optional<PathStart> onto_points(PathStart out, const std::vector<Vec2>& drawn, const std::vector<double>& angles,
                                       double begin) const {
    const Vec2 from = mean_of(drawn), to = mean_of(task_.points);
    double squares = 0.0;
    Vec2 product{};
    for (std::size_t i = 0; i < drawn.size(); ++i) {
      squares += dot(drawn[i] - from, drawn[i] - from);
      product += (task_.points[i] - to) * conj(drawn[i] - from);
    }
    if (!(squares > 0.0)) return std::nullopt;
    Vec2 by = (1 / squares) * product;
    const bool fixed_turn = task_.timed && !task_.start_free && !task_.from_ground;
    if (fixed_turn) by = {std::max(by.x, 0.0), 0.0};
    if (!(norm(by) > 1e-3)) return std::nullopt;
    for (std::size_t i = 0; i < drawn.size(); ++i) {
      const Vec2 gap = by * (drawn[i] - from) + to - task_.points[i];
      out.misfit += dot(gap, gap);
    }
    out.x = moved(task_.linkage, out.x, by, to - by * from);
    const double turned = std::atan2(by.y, by.x);
    out.t = angles;
    if (!task_.timed) {
      for (double& t : out.t) t += turned;
    }
    if (task_.start_free) out.x[at_start] = begin + (task_.from_ground ? 0.0 : turned);
    return out;
  }

  // The shape keeps the pivots; each point has the nearest of places on the curve.
  std::optional<PathStart> at_given_pivots(const PathVector& shape, int closure) const {
    const Vec2 a{task_.pivots[at_a], task_.pivots[at_a + 1]}, b{task_.pivots[at_b], task_.pivots[at_b + 1]};
    const Vec2 far{shape[at_b], shape[at_b + 1]};
    const Vec2 by = (1 / dot(far, far)) * ((b - a) * conj(far));
    PathStart out{moved(PathLinkage::four_bar, shape, by, a), {}, {}};
    const double ground = ground_angle(task_, out.x);
    if (task_.start_free) out.x[at_start] = random_.uniform(0.0, whole_turn);
    constexpr int places = 48;
    for (std::size_t i = 0; i < task_.points.size(); ++i) {
      double nearest = 1e300, angle = 0.0;
      for (int k = 0; k < (task_.timed ? 1 : places); ++k) {
        const double t = task_.timed ? crank_[i] : whole_turn * k / places;
        const CouplerPlace pose =
            coupler_place(PathLinkage::four_bar, out.x, task_.timed ? t + ground + out.x[at_start] : t, closure);
        const Vec2 gap = pose.point - task_.points[i];
        const double square = dot(gap, gap) + pose.gap * pose.gap;
        if (square < nearest) {
          nearest = square;
          angle = t;
        }
      }
      out.misfit += nearest;
      out.t.push_back(angle);
    }
    out.closures.assign(task_.points.size(), closure);
    return out;
  }

  const PathFit::Task& task_;
  const std::vector<double>& crank_;
  solvers::RandomStream& random_;
};

using Complex = std::complex<double>;
constexpr int harmonics = 6, shifts = 64, places_of_curve = 64, places_of_circuit = 128;
using Descriptors = std::array<Complex, 2 * harmonics>;

int order_of(std::size_t k) {
  const int order = static_cast<int>(k) - harmonics;
  return order < 0 ? order : order + 1;
}

Descriptors descriptors_of(const std::vector<Vec2>& evenly) {
  Descriptors out{};
  for (std::size_t i = 0; i < evenly.size(); ++i) {
    const double at = whole_turn * static_cast<double>(i) / static_cast<double>(evenly.size());
    for (std::size_t k = 0; k < out.size(); ++k) {
      out[k] +=
          Complex(evenly[i].x, evenly[i].y) * std::polar(1.0 / static_cast<double>(evenly.size()), -order_of(k) * at);
    }
  }
  return out;
}

double squares_of(const Descriptors& c) {
  double out = 0.0;
  for (const Complex& z : c) out += std::norm(z);
  return out;
}

// How the curve of the descriptors d is laid on that of c.
struct Overlay {
  double misfit = 1e300;  ///< over the squares of c
  Complex by;
  int shift = 0;
  bool backward = false;
};

Overlay overlay(const Descriptors& c, const Descriptors& d) {
  static const std::vector<Descriptors> turns = [] {
    std::vector<Descriptors> out(shifts);
    for (int s = 0; s < shifts; ++s) {
      for (std::size_t k = 0; k < 2 * harmonics; ++k)
        out[s][k] = std::polar(1.0, -order_of(k) * whole_turn * s / shifts);
    }
    return out;
  }();
  Overlay best;
  const double squares_c = squares_of(c), squares_d = squares_of(d);
  for (const bool backward : {false, true}) {
    Descriptors product;
    for (std::size_t k = 0; k < c.size(); ++k) {
      product[k] = c[k] * std::conj(backward ? d[c.size() - 1 - k] : d[k]);
    }
    for (int s = 0; s < shifts; ++s) {
      Complex sum = 0.0;
      for (std::size_t k = 0; k < c.size(); ++k) sum += product[k] * turns[s][k];
      const double misfit = 1.0 - std::norm(sum) / (squares_c * squares_d);
      if (misfit < best.misfit) best = {misfit, sum / squares_d, s, backward};
    }
  }
  return best;
}

}  // namespace

std::optional<PathStart> drawn_start(const PathFit::Task& task, const std::vector<double>& crank,
                                     solvers::RandomStream& random, int draws) {
  std::optional<PathStart> best;
  Draw draw(task, crank, random);
  for (int k = 0; k < draws; ++k) {
    std::optional<PathStart> next = draw.draw();
    if (next && (!best || next->misfit < best->misfit)) best = std::move(next);
  }
  return best;
}

std::vector<PathStart> curve_starts(const PathFit::Task& task, std::uint64_t seed, int linkages, int kept) {
  const CurveLine curve{task.points, true};
  const std::vector<Vec2> wanted = spread_evenly(curve, places_of_curve);
  const Descriptors c = descriptors_of(wanted);
  struct Fitting {
    Overlay overlay;
    PathVector x;
    PathVisit from;
  };
  std::vector<Fitting> best;
  constexpr std::uint32_t stream_of_table = 2;
  for (int k = 0; k < linkages; ++k) {
    solvers::RandomStream random(seed, stream_of_table, static_cast<std::uint64_t>(k));
    const PathVector x = random_shape(task.linkage, random);
    const CrankRange range = crank_range(task.linkage, x);
    const PathVisit from{random.uniform(0.0, whole_turn), random.uniform() < 0.5 ? -1 : 1};
    if (range.least >= 1.0 || range.greatest <= -1.0 || (task.limits.full_turn && !range.full())) continue;
    CurveLine circuit{{}, true};
    for (const PathVisit& v : once_round(range, from, places_of_circuit)) {
      circuit.points.push_back(coupler_place(task.linkage, x, v.angle, v.closure).point);
    }
    const Descriptors d = descriptors_of(spread_evenly(circuit, places_of_curve));
    if (!(squares_of(d) > 0.0)) continue;
    best.push_back({overlay(c, d), x, from});
  }
  const std::size_t count = std::min(best.size(), static_cast<std::size_t>(kept));
  std::stable_sort(best.begin(), best.end(),
                   [](const Fitting& a, const Fitting& b) { return a.overlay.misfit < b.overlay.misfit; });
  best.resize(count);
  std::vector<PathStart> out;
  for (const Fitting& fitting : best) {
    const Vec2 by{fitting.overlay.by.real(), fitting.overlay.by.imag()};
    CurveLine circuit{{}, true};
    const std::vector<PathVisit> visits =
        once_round(crank_range(task.linkage, fitting.x), fitting.from, places_of_circuit);
    for (const PathVisit& v : visits) {
      circuit.points.push_back(coupler_place(task.linkage, fitting.x, v.angle, v.closure).point);
    }
    const Vec2 to = mean_of(wanted) - by * mean_of(spread_evenly(circuit, places_of_curve));
    PathStart start{moved(task.linkage, fitting.x, by, to), {}, {}};
    const double turned = std::atan2(by.y, by.x);
    for (const Vec2& p : task.points) {
      double nearest = 1e300;
      std::size_t at = 0;
      for (std::size_t i = 0; i < visits.size(); ++i) {
        const Vec2 gap = by * circuit.points[i] + to - p;
        if (dot(gap, gap) < nearest) {
          nearest = dot(gap, gap);
          at = i;
        }
      }
      start.misfit += nearest;
      start.t.push_back(visits[at].angle + turned);
      start.closures.push_back(visits[at].closure);
    }
    out.push_back(std::move(start));
  }
  return out;
}

}  // namespace poise
