#include "tests/support/released_scenes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include <fmt/format.h>

#include "solvers/linear_algebra.hpp"
#include "solvers/newton.hpp"
#include "statics/model/curvature.hpp"
#include "statics/model/static_model.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/closure_rows.hpp"
#include "tests/support/elements.hpp"
#include "tests/support/random_mechanism.hpp"

namespace poise::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Orthonormal directions of motion at a closed pose, and the force along them.
struct Tangent {
  Tangent(const StaticModel& model, const std::vector<double>& x)
      : point(model.mechanism(), x, closure_rows(model.mechanism())) {
    const auto n = static_cast<Eigen::Index>(x.size());
    basis = MatrixXd::Identity(n, n);
    if (point.jacobian.rows() > 0) basis = solvers::null_space<double>(point.jacobian, solvers::known_to::path);
  }
  DensePoint<double> point;
  MatrixXd basis;
};

// Moves along the joints, at random or along `along`, and closes; empty where that fails or a stop is in the way.
std::optional<std::vector<double>> moved(const StaticModel& model, const std::vector<double>& x, const VectorXd& by) {
  std::vector<double> out = x;
  for (std::size_t i = 0; i < x.size(); ++i) out[i] += by[static_cast<Eigen::Index>(i)];
  solvers::NewtonOptions options;
  options.closing_starts = 0;
  solvers::Newton newton(model.problem(), options);
  const solvers::NewtonResult& closed = newton.close(out);
  if (closed.end != solvers::NewtonEnd::converged) return std::nullopt;
  double far = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) far = std::max(far, std::abs(closed.x[i] - out[i]));
  if (far > by.norm()) return std::nullopt;
  return closed.x;
}

// Some way from the start of the scene.
std::optional<std::vector<double>> wander(Random& random, const StaticModel& model, double length) {
  solvers::Newton newton(model.problem());
  const solvers::NewtonResult& closed = newton.close(model.start());
  if (closed.end != solvers::NewtonEnd::converged) return std::nullopt;
  std::vector<double> x = closed.x;
  VectorXd heading;
  for (double gone = 0.0; gone < length; gone += 0.05) {
    const Tangent here(model, x);
    if (here.basis.cols() == 0) return std::nullopt;
    if (heading.size() == 0) {
      heading = VectorXd::Zero(static_cast<Eigen::Index>(x.size()));
      for (double& v : heading) v = random.uniform(-1.0, 1.0);
    }
    VectorXd along = here.basis * (here.basis.transpose() * heading);
    if (!(along.norm() > 1e-6)) return x;
    heading = along.normalized();
    const std::optional<std::vector<double>> next = moved(model, x, 0.05 * heading);
    if (!next) return x;
    x = *next;
  }
  return x;
}

// The angle coordinates that a torque can act on, by the body whose frame it is.
std::vector<std::pair<int, int>> turning_bodies(const StaticModel& model) {
  std::vector<std::pair<int, int>> out;
  for (std::size_t b = 1; b < model.scene().bodies.size(); ++b) {
    const int frame = model.layout().links[b].frame;
    if (frame >= 0 && frame < model.layout().angles) out.emplace_back(static_cast<int>(b), frame);
  }
  return out;
}

// A torque with which the force at some pose on the way vanishes up to a small part of it.
void almost_stop(Random& random, Scene& scene, const std::vector<double>& x) {
  const StaticModel model(scene);
  const auto bodies = turning_bodies(model);
  if (bodies.empty()) return;
  const auto [body, frame] = bodies[random.index(bodies.size())];
  // r_k = a_k + tau b_k along the way in one direction; tau for which the least of the r is 0.
  Tangent here(model, x);
  VectorXd heading = here.basis.col(0) * (random.chance(0.5) ? 1.0 : -1.0);
  std::vector<double> now = x;
  std::vector<std::pair<double, double>> r;
  const double length = random.uniform(0.5, 2.0);
  for (double gone = 0.0; gone < length; gone += 0.01) {
    const Tangent at(model, now);
    if (at.basis.cols() != 1) return;
    const VectorXd t = at.basis.col(0) * (at.basis.col(0).dot(heading) > 0 ? 1.0 : -1.0);
    r.emplace_back(-at.point.force.dot(t), t[frame]);
    heading = t;
    const std::optional<std::vector<double>> next = moved(model, now, 0.01 * t);
    if (!next) break;
    now = *next;
  }
  if (r.size() < 20) return;
  double low = -1e3, high = 1e3;
  const auto least = [&](double tau) {
    double out = 1e300;
    for (const auto& [a, b] : r) out = std::min(out, a + tau * b);
    return out;
  };
  // b of one sign: the least r is monotone in tau.
  if (std::any_of(r.begin(), r.end(), [&](const auto& p) { return p.second * r.front().second <= 1e-3; })) return;
  if (r.front().second < 0) std::swap(low, high);
  for (int k = 0; k < 200; ++k) {
    const double middle = 0.5 * (low + high);
    (least(middle) < 0 ? low : high) = middle;
  }
  const double off = (random.chance(0.5) ? 1.0 : -1.0) * std::pow(10.0, random.uniform(-9.0, -1.0));
  const double in_si = model.scales().energy();
  scene.torques.push_back({"almost", body, (0.5 * (low + high) + off) * in_si});
}

ReleasedScene released(Scene scene, std::vector<double> x, int freedoms) {
  ReleasedScene out;
  out.scene = std::move(scene);
  out.x = std::move(x);
  out.freedoms = freedoms;
  return out;
}

// Of a planted mechanism: the start is elsewhere and the stops are where they were planted.
std::optional<ReleasedScene> release_planted(Random& random, bool followers, int least, int most) {
  const Wish wish{.loops = 1 + random.index(4), .followers = followers, .stops = random.chance(0.5)};
  const PlantedMechanism planted = plant_mechanism(static_cast<std::uint64_t>(random.uniform(0.0, 1e9)), wish);
  if (planted.hangs_on_bars || planted.freedoms < least || planted.freedoms > most) return std::nullopt;
  Scene scene = planted.in_equilibrium;
  const double length = random.uniform(0.0, 3.0);
  {
    const StaticModel model(scene);
    const std::optional<std::vector<double>> x = wander(random, model, length);
    if (!x) return std::nullopt;
    if (most > 1 || !random.chance(0.33)) return released(scene, *x, planted.freedoms);
    almost_stop(random, scene, *x);
  }
  const StaticModel model(scene);
  const std::optional<std::vector<double>> x = wander(random, model, length);
  if (!x) return std::nullopt;
  return released(scene, *x, planted.freedoms);
}

// A chain on springs: hung up by torsion springs and line springs to the ground, some only pulling or pressing.
ReleasedScene release_chain(Random& random) {
  const int links = 2 + random.index(4);
  const double mass = random.uniform(0.0, 2.0);
  Scene scene = chain(links, random.uniform(0.5, 1.5), mass);
  if (random.chance(0.7)) scene.gravity = {0.0, -9.81};
  for (int k = 1; k <= links; ++k) {
    if (random.chance(0.6)) {
      const double free_angle = random.uniform(-2.0, 2.0);
      add_torsion_spring(scene, k - 1, k, std::pow(10.0, random.uniform(-1.0, 2.0)), free_angle);
    }
    if (random.chance(0.3)) {
      const double middle = random.uniform(-1.0, 1.0), most = middle + random.uniform(0.1, 1.0);
      add_stop(scene, fmt::format("stop{}", k), k - 1, k, middle - random.uniform(0.1, 1.0), most);
    }
  }
  const int springs = 1 + random.index(3);
  for (int k = 0; k < springs; ++k) {
    const PointRef hook =
        scene.add_point(0, fmt::format("hook{}", k), {random.uniform(-3.0, 3.0), random.uniform(-3.0, 3.0)});
    const PointRef end = point(scene, fmt::format("{}.b", 1 + random.index(static_cast<std::size_t>(links))));
    const auto acts = static_cast<LinearSpring::Acts>(random.index(3));
    const double free_length = random.uniform(0.3, 3.0), stiffness = std::pow(10.0, random.uniform(0.0, 2.0));
    scene.elements.push_back(line_spring(fmt::format("s{}", k), hook, end, stiffness, free_length, acts));
  }
  add_force(scene, fmt::format("{}.b", links), {random.uniform(-10.0, 10.0), random.uniform(-10.0, 10.0)}, "tip");
  for (int k = 1; k <= links; ++k) scene.start.angle[k] = random.uniform(-3.0, 3.0);
  const StaticModel model(scene);
  solvers::Newton newton(model.problem());
  return released(scene, newton.close(model.start()).x, links);
}

}  // namespace

ReleasedScene release_one_freedom(std::uint64_t seed) {
  Random random(seed);
  for (;;) {
    if (std::optional<ReleasedScene> out = release_planted(random, random.chance(0.2), 1, 1)) return *out;
  }
}

ReleasedScene release_several_freedoms(std::uint64_t seed) {
  Random random(seed);
  if (random.chance(0.4)) return release_chain(random);
  for (;;) {
    if (std::optional<ReleasedScene> out = release_planted(random, false, 2, 5)) return *out;
  }
}

}  // namespace poise::test
