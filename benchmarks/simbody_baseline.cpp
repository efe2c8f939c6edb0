// Simbody as an external solver; external_solver.hpp has the lines it is asked and answers. A program of its own,
// because Simbody's library brings an old Ipopt along whose names are those of ours.

#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include "benchmarks/baseline_scenes.hpp"
#include "benchmarks/simbody_solver.hpp"
#include "statics/model/static_model.hpp"

namespace poise::benchmarks {
namespace {

PlainMechanism::Vector plain(Vec2 v) { return {v.x, v.y}; }

PlainMechanism::Joint plain(const Scene& scene, const Joint& joint) {
  if (joint.kind != Joint::Kind::pin && joint.kind != Joint::Kind::slide) {
    throw InputError(joint.name + ": only pins and slides are translated for Simbody");
  }
  return {joint.kind == Joint::Kind::slide,
          {joint.a.body, plain(scene.local(joint.a))},
          {joint.b.body, plain(scene.local(joint.b))},
          std::atan2(joint.axis.y, joint.axis.x),
          joint.angle};
}

PlainMechanism plain(const Scene& scene) {
  if (!scene.stops.empty()) throw InputError("stops are not translated for Simbody");
  const auto place = [&scene](PointRef p) -> PlainMechanism::Place { return {p.body, plain(scene.local(p))}; };
  PlainMechanism out;
  out.gravity = plain(scene.gravity);
  for (const Body& b : scene.bodies) out.bodies.push_back({b.mass, b.inertia, plain(b.center)});
  for (const Joint& joint : scene.joints) out.joints.push_back(plain(scene, joint));
  for (const Element& element : scene.elements) {
    if (!stores_energy(element.law)) continue;
    const auto* s = std::get_if<LinearSpring>(&element.law);
    if (s == nullptr || element.on.kind != Measure::Kind::distance) {
      throw InputError(element.name + ": only springs between two points are translated for Simbody");
    }
    out.springs.push_back({place(element.on.a), place(element.on.b), s->stiffness, s->free_length,
                           s->acts != LinearSpring::Acts::compression, s->acts != LinearSpring::Acts::tension});
  }
  for (const Force& f : scene.forces) {
    if (f.follows >= 0) throw InputError(f.name + ": it has no potential");
    out.forces.push_back({place(f.at), plain(f.vector)});
  }
  for (const Torque& t : scene.torques) out.torques.push_back({t.body, t.value});
  return out;
}

PlainPose plain_pose(const StaticModel& model, const std::vector<double>& x) {
  PlainPose pose;
  for (const BodyPose<double>& place : model.poses(x)) pose.angle.push_back(place.angle);
  for (const int travel : model.layout().travel) pose.travel.push_back(travel < 0 ? 0.0 : x.at(travel));
  return pose;
}

std::vector<double> coordinates(const StaticModel& model, const PlainPose& pose) {
  const Layout& layout = model.layout();
  std::vector<double> x = model.start();
  for (const Link& link : layout.links) {
    if (link.body > 0 && link.frame >= 0 && link.frame < layout.kept) x[link.frame] = pose.angle[link.body] - link.turn;
  }
  for (std::size_t j = 0; j < layout.travel.size(); ++j) {
    if (layout.travel[j] >= 0 && layout.travel[j] < layout.kept) x[layout.travel[j]] = pose.travel[j];
  }
  return x;
}

// One scene, in its scaled units.
struct Baseline {
  explicit Baseline(const std::string& scene) : model(baseline_scene(scene)), solver(plain(model.scaled_scene())) {}

  std::string solve(int method, double accuracy, int times) {
    const auto by = method == 0 ? SimbodyMethod::minimizer : SimbodyMethod::optimizer;
    const SimbodySolver::Result result = solver.solve(by, accuracy, times);
    return fmt::format("{} {} 1 {}", result.seconds, result.evaluations,
                       fmt::join(coordinates(model, result.pose), " "));
  }

  StaticModel model;
  SimbodySolver solver;
};

std::string answer(std::unique_ptr<Baseline>& baseline, const std::string& line) {
  std::istringstream words(line);
  std::string request;
  words >> request >> std::ws;
  if (request == "methods") return "LocalEnergyMinimizer|Optimizer, exact Jacobian";
  if (request == "scene") {
    std::string name;
    std::getline(words, name);
    baseline = std::make_unique<Baseline>(name);
    return "";
  }
  if (request == "start") {
    std::vector<double> x;
    for (double value = 0.0; words >> value;) x.push_back(value);
    baseline->solver.start_from(plain_pose(baseline->model, x));
    return "";
  }
  int method = 0, times = 0;
  double accuracy = 0.0;
  if (request != "solve" || !(words >> method >> accuracy >> times)) throw std::runtime_error("unknown: " + line);
  return baseline->solve(method, accuracy, times);
}

void serve(std::FILE* out) {
  std::unique_ptr<Baseline> baseline;
  for (std::string line; std::getline(std::cin, line);) {
    std::string said;
    try {
      said = "ok " + answer(baseline, line);
    } catch (const std::exception& error) {
      said = std::string("no ") + error.what();
      for (char& c : said) c = c == '\n' ? ' ' : c;
    }
    fmt::print(out, "{}\n", said);
    std::fflush(out);
  }
}

}  // namespace
}  // namespace poise::benchmarks

int main() {
  // Simbody's Ipopt talks to the standard output, which is taken.
  std::FILE* out = fdopen(dup(STDOUT_FILENO), "w");
  if (out == nullptr || std::freopen("/dev/null", "w", stdout) == nullptr) return 1;
  poise::benchmarks::serve(out);
}
