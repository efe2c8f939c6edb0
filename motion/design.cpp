#include "motion/design.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <random>
#include <utility>

#include "motion/extent.hpp"
#include "solvers/nlopt.hpp"

namespace poise {
namespace {

constexpr int search_positions = 25;
constexpr int final_positions = 201;
// Share of each limit: positions between those evaluated may be slightly worse.
constexpr double search_part = 0.95;
constexpr double not_closed = 100.0;   // misfit beyond that of any closed candidate
constexpr double least_travel = 1e-3;  // of the shape before scaling: below, the point only rotates

std::vector<int> needed_bodies(const DesignProblem& problem) {
  std::vector<int> out = {problem.guided.body, problem.level};
  for (const Actuator& actuator : problem.actuators) out.insert(out.end(), {actuator.a.body, actuator.b.body});
  return out;
}

// Longest axis of a cloud of points, from the first towards the last.
Vec2 mean_line(const std::vector<Vec2>& path) {
  Vec2 middle{};
  for (const Vec2& p : path) middle += (1.0 / static_cast<double>(path.size())) * p;
  Vec2 second{};  // sum of (p - middle)^2 as complex numbers: its argument is twice that of the axis
  for (const Vec2& p : path) second += (p - middle) * (p - middle);
  const Vec2 axis = unit(0.5 * std::atan2(second.y, second.x));
  return dot(axis, path.back() - path.front()) < 0 ? -axis : axis;
}

double excess(double value, double limit) { return value <= limit ? 0.0 : std::log(value / limit); }

}  // namespace

DesignModel::DesignModel(const DesignProblem& problem)
    : problem_(problem), chain_(problem.scene, problem.driver, needed_bodies(problem)) {}

std::vector<double> DesignModel::lower() const {
  std::vector<double> out;
  for (const DesignVariable& v : problem_.variables) out.push_back(v.range.min);
  out.insert(out.end(), {problem_.from.min, problem_.turn.min});
  return out;
}

std::vector<double> DesignModel::upper() const {
  std::vector<double> out;
  for (const DesignVariable& v : problem_.variables) out.push_back(v.range.max);
  out.insert(out.end(), {problem_.from.max, problem_.turn.max});
  return out;
}

std::vector<Vec2> DesignModel::points_of(std::span<const double> values) const {
  std::vector<Vec2> points;
  points.reserve(chain_.slots());
  for (const Body& body : problem_.scene.bodies) {
    for (const NamedPoint& p : body.points) points.push_back(p.at);
  }
  for (std::size_t k = 0; k < problem_.variables.size(); ++k) {
    const DesignVariable& v = problem_.variables[k];
    Vec2& point = points[chain_.slot(v.point)];
    (v.is_y ? point.y : point.x) = values[k];
  }
  return points;
}

DesignFacts DesignModel::facts(std::span<const double> values, const std::vector<int>& signs, int positions) const {
  const std::vector<Vec2> points = points_of(values);
  const double from = values[problem_.variables.size()];
  const double turn = values[problem_.variables.size() + 1];
  std::vector<DyadChain::Pose> poses(problem_.scene.bodies.size());
  std::vector<double> cosines(chain_.dyads().size());
  DesignFacts out;
  out.transmission.assign(cosines.size(), std::numbers::pi / 2);
  out.strokes.resize(problem_.actuators.size());
  std::vector<Vec2> path;
  path.reserve(static_cast<std::size_t>(positions));
  std::vector<Extent> lengths(problem_.actuators.size()), levers(problem_.actuators.size());
  std::vector<double> before(problem_.actuators.size());
  Extent angles;
  double angle = 0.0;
  for (int k = 0; k < positions; ++k) {
    const double step = turn / (positions - 1);
    out.gap += chain_.place(points, from + k * step, signs, poses, cosines);
    for (std::size_t i = 0; i < cosines.size(); ++i) {
      out.transmission[i] = std::min(out.transmission[i], std::acos(std::min(1.0, std::abs(cosines[i]))));
    }
    const Vec2 direction = poses[problem_.level].direction;
    const double absolute = std::atan2(direction.y, direction.x);
    angle = k == 0 ? absolute : angle + std::remainder(absolute - angle, 2 * std::numbers::pi);
    angles.add(angle);
    path.push_back(poses[problem_.guided.body].world(points[chain_.slot(problem_.guided)]));
    for (std::size_t i = 0; i < lengths.size(); ++i) {
      const Actuator& jack = problem_.actuators[i];
      const double length = norm(poses[jack.b.body].world(points[chain_.slot(jack.b)]) -
                                 poses[jack.a.body].world(points[chain_.slot(jack.a)]));
      lengths[i].add(length);
      if (k > 0) levers[i].add((length - before[i]) / step);
      before[i] = length;
    }
  }
  const Vec2 line = mean_line(path);
  Extent along, across;
  for (const Vec2& p : path) {
    along.add(dot(line, p));
    across.add(cross(line, p));
  }
  if (along.width() < least_travel) out.gap += 1.0;
  out.scale = problem_.travel / std::max(along.width(), least_travel);
  out.turned = std::numbers::pi / 2 - std::atan2(line.y, line.x);
  out.travel = out.scale * along.width();
  out.drift = out.scale * across.width();
  out.inclination = 0.5 * angles.width();
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    // A lever arm that changes sign counts as zero.
    const bool one_way = levers[i].min > 0.0 || levers[i].max < 0.0;
    out.strokes[i] = {out.scale * lengths[i].min, out.scale * lengths[i].max,
                      one_way ? out.scale * std::min(std::abs(levers[i].min), std::abs(levers[i].max)) : 0.0};
  }
  Extent sizes;
  for (const Dyad& d : chain_.dyads()) {
    sizes.add(norm(points[chain_.slot(d.first_tip)] - points[chain_.slot(d.first_anchor)]));
    sizes.add(norm(points[chain_.slot(d.second_tip)] - points[chain_.slot(d.second_anchor)]));
  }
  for (std::size_t i = 1; i < problem_.scene.bodies.size(); ++i) {
    if (!chain_.places(static_cast<int>(i))) continue;
    const int count = static_cast<int>(problem_.scene.bodies[i].points.size());
    for (int a = 0; a < count; ++a) {
      for (int b = 0; b < a; ++b) {
        sizes.max = std::max(sizes.max, norm(points[chain_.slot({static_cast<int>(i), a})] -
                                             points[chain_.slot({static_cast<int>(i), b})]));
      }
    }
  }
  out.shortest = out.scale * sizes.min;
  out.longest = out.scale * sizes.max;
  return out;
}

double DesignModel::misfit(const DesignFacts& facts, double part) const {
  if (facts.gap > 0.0) return not_closed * (1.0 + facts.gap);
  constexpr double tiny = 1e-12;
  double sum = excess(facts.drift, part * problem_.drift) + excess(facts.inclination, part * problem_.inclination) +
               excess(problem_.shortest, part * std::max(facts.shortest, tiny)) +
               excess(facts.longest, part * problem_.longest);
  for (const double t : facts.transmission) sum += excess(problem_.transmission, part * std::max(t, tiny));
  for (std::size_t i = 0; i < facts.strokes.size(); ++i) {
    const DesignFacts::Stroke& stroke = facts.strokes[i];
    sum += excess(stroke.longest, part * problem_.actuators[i].ratio * std::max(stroke.shortest, tiny));
    sum += excess(problem_.actuators[i].lever, part * std::max(stroke.least_lever, 1e-3));
  }
  return sum;
}

Scene DesignModel::scene_of(std::span<const double> values, const std::vector<int>& signs,
                            const DesignFacts& facts) const {
  Scene scene = problem_.scene;
  const std::vector<Vec2> points = points_of(values);
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    for (std::size_t p = 0; p < scene.bodies[i].points.size(); ++p) {
      const Vec2 at = facts.scale * points[chain_.slot({static_cast<int>(i), static_cast<int>(p)})];
      scene.bodies[i].points[p].at = i == 0 ? at * unit(facts.turned) : at;
    }
  }
  for (Joint& joint : scene.joints) {
    joint.length *= facts.scale;
    if (joint.a.body == 0) joint.axis = joint.axis * unit(facts.turned);
    if (joint.a.body == 0) joint.angle += facts.turned;
    if (joint.b.body == 0) joint.angle -= facts.turned;
  }
  std::vector<DyadChain::Pose> poses(scene.bodies.size());
  std::vector<double> cosines(chain_.dyads().size());
  chain_.place(points, values[problem_.variables.size()], signs, poses, cosines);
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    std::optional<double>& angle = scene.start.angle[i];
    if (chain_.places(static_cast<int>(i))) angle = std::atan2(poses[i].direction.y, poses[i].direction.x);
    if (angle) *angle += facts.turned;
  }
  // The driver's is unwrapped: its range begins there.
  scene.start.angle[static_cast<std::size_t>(problem_.driver)] = values[problem_.variables.size()] + facts.turned;
  start_jacks(scene, points, poses, facts);
  return scene;
}

// Jacks, two bodies on a slide that are pinned to placed ones at the points it joins, have their start along the line
// between these.
void DesignModel::start_jacks(Scene& scene, const std::vector<Vec2>& points, const std::vector<DyadChain::Pose>& poses,
                              const DesignFacts& facts) const {
  const auto pinned_at = [&](PointRef p) -> std::optional<Vec2> {
    for (const Joint& pin : scene.joints) {
      if (pin.kind != Joint::Kind::pin) continue;
      for (const auto& [own, other] : {std::pair(pin.a, pin.b), std::pair(pin.b, pin.a)}) {
        if (own.body != p.body || own.point != p.point || !chain_.places(other.body)) continue;
        return poses[other.body].world(points[chain_.slot(other)]);
      }
    }
    return std::nullopt;
  };
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    const Joint& slide = scene.joints[j];
    if (slide.kind != Joint::Kind::slide) continue;
    const auto a = pinned_at(slide.a), b = pinned_at(slide.b);
    if (!a || !b) continue;
    const Vec2 d = *b - *a;
    const double angle = std::atan2(d.y, d.x) + facts.turned - std::atan2(slide.axis.y, slide.axis.x);
    scene.start.angle[slide.a.body] = angle;
    scene.start.angle[slide.b.body] = angle + slide.angle;
    scene.start.travel[j] = facts.scale * norm(d);
  }
}

DesignResult design(const DesignProblem& problem, const DesignOptions& options) {
  const DesignModel model(problem);
  const std::vector<double> lower = model.lower(), upper = model.upper();
  std::mt19937_64 random(options.seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  DesignResult best;
  best.misfit = std::numeric_limits<double>::infinity();
  const auto stopped = [&] { return options.interrupt != nullptr && options.interrupt->load(); };
  while (best.starts < options.starts && !best.met && !stopped()) {
    std::vector<double> x(model.size()), drawn(model.size());
    std::vector<int> signs(model.chain().dyads().size()), drawn_signs(signs.size());
    double least = std::numeric_limits<double>::infinity();
    for (int k = 0; k < options.draws; ++k) {
      for (std::size_t i = 0; i < x.size(); ++i) drawn[i] = lower[i] + uniform(random) * (upper[i] - lower[i]);
      for (int& sign : drawn_signs) sign = uniform(random) < 0.5 ? -1 : 1;
      const double misfit = model.misfit(model.facts(drawn, drawn_signs, search_positions), search_part);
      if (misfit >= least) continue;
      least = misfit;
      x = drawn;
      signs = drawn_signs;
    }
    solvers::NloptOptions settings;
    settings.evaluations = options.evaluations;
    settings.interrupt = options.interrupt;
    const solvers::NloptResult found = solvers::minimise_with_nlopt(
        [&](const double* values) {
          return model.misfit(model.facts({values, model.size()}, signs, search_positions), search_part);
        },
        lower, upper, x, settings);
    best.evaluations += options.draws + found.evaluations;
    ++best.starts;
    const double misfit = model.misfit(model.facts(found.x, signs, final_positions));
    if (misfit < best.misfit) {
      best.misfit = misfit;
      best.values = found.x;
      best.signs = signs;
      best.met = misfit == 0.0;
    }
    if (options.progress) options.progress(best.starts, best.misfit);
  }
  if (best.values.empty()) return best;
  best.facts = model.facts(best.values, best.signs, final_positions);
  best.scene = model.scene_of(best.values, best.signs, best.facts);
  best.from = best.values[problem.variables.size()] + best.facts.turned;
  best.to = best.from + best.values[problem.variables.size() + 1];
  return best;
}

}  // namespace poise
