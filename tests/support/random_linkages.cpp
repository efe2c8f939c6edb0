#include "tests/support/random_linkages.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "comparison/random.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/elements.hpp"

namespace poise::test {
namespace {

using comparison::Random;

// Bodies by the joints they connect, numbered; the ground first.
struct Kind {
  std::string name;
  int joints;
  std::vector<std::vector<int>> bodies;
};

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all = {
      {"four_bar", 4, {{0, 3}, {0, 1}, {1, 2}, {2, 3}}},
      {"watt", 7, {{0, 3, 6}, {0, 1}, {1, 2}, {2, 3, 4}, {4, 5}, {5, 6}}},
      {"stephenson", 7, {{0, 3, 6}, {0, 1}, {1, 2, 4}, {2, 3}, {4, 5}, {5, 6}}},
  };
  return all;
}

double longest(const std::vector<int>& body, const std::vector<Vec2>& at) {
  double out = 0.0;
  for (const int a : body) {
    for (const int b : body)
      out = std::max(out, norm(at[static_cast<std::size_t>(a)] - at[static_cast<std::size_t>(b)]));
  }
  return out;
}

double shortest(const std::vector<int>& body, const std::vector<Vec2>& at) {
  double out = 1e9;
  for (std::size_t i = 0; i < body.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      out = std::min(out, norm(at[static_cast<std::size_t>(body[i])] - at[static_cast<std::size_t>(body[j])]));
    }
  }
  return out;
}

std::string joint_name(int joint) { return fmt::format("J{}", joint); }

}  // namespace

const std::vector<std::string>& linkage_kinds() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> out;
    for (const Kind& kind : kinds()) out.push_back(kind.name);
    return out;
  }();
  return names;
}

Scene random_linkage(const std::string& kind, std::uint64_t seed, const LinkageLoads& loads) {
  const auto found = std::find_if(kinds().begin(), kinds().end(), [&](const Kind& k) { return k.name == kind; });
  if (found == kinds().end()) throw std::invalid_argument("there is no linkage \"" + kind + "\"");
  Random random(seed * 0x9e3779b97f4a7c15U + static_cast<std::uint64_t>(found - kinds().begin()));
  std::vector<Vec2> at(static_cast<std::size_t>(found->joints));
  const auto too_short = [&](const std::vector<int>& body) { return shortest(body, at) < 0.3; };
  do {
    for (Vec2& p : at) p = {random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0)};
  } while (std::any_of(found->bodies.begin(), found->bodies.end(), too_short));

  Scene scene;
  scene.file = scene.title = fmt::format("{} {}", kind, seed);
  scene.gravity = {0.0, -9.81};
  std::vector<std::string> first(at.size());  // a point at each joint
  for (std::size_t b = 0; b < found->bodies.size(); ++b) {
    const std::vector<int>& joints = found->bodies[b];
    const Vec2 origin = at[static_cast<std::size_t>(joints[0])];
    const Vec2 along = at[static_cast<std::size_t>(joints[1])] - origin;
    const Vec2 axis = {along.x / norm(along), along.y / norm(along)};
    std::string name = "ground";
    if (b > 0) {
      name = fmt::format("b{}", b);
      scene.add_body(name);
      scene.start.angle[b] = std::atan2(along.y, along.x);
      scene.bodies[b].mass = longest(joints, at);
    }
    Vec2 middle{};
    for (const int joint : joints) {
      const Vec2 d = at[static_cast<std::size_t>(joint)] - origin;
      const Vec2 local = b == 0 ? at[static_cast<std::size_t>(joint)] : Vec2{dot(axis, d), cross(axis, d)};
      scene.add_point(static_cast<int>(b), joint_name(joint), local);
      middle += (1.0 / static_cast<double>(joints.size())) * local;
      std::string& other = first[static_cast<std::size_t>(joint)];
      const std::string here = name + "." + joint_name(joint);
      if (other.empty()) {
        other = here;
      } else {
        add_pin(scene, other, here, joint_name(joint));
      }
    }
    if (b > 0) scene.bodies[b].center = middle;
  }
  const std::size_t moving = scene.bodies.size() - 1;
  for (int k = 0; k < loads.springs; ++k) {
    const int body = 1 + random.index(moving);
    const PointRef a =
        scene.add_point(0, fmt::format("S{}", k), {random.uniform(-4.0, 4.0), random.uniform(-4.0, 4.0)});
    const PointRef b =
        scene.add_point(body, fmt::format("S{}", k), {random.uniform(-1.0, 2.0), random.uniform(-1.0, 1.0)});
    const double stiffness = std::pow(10.0, random.uniform(0.0, 2.0));
    const double free_length = random.uniform(0.2, 3.0);
    const bool one_way = random.chance(loads.one_way);
    scene.elements.push_back(line_spring(fmt::format("spring {}", k), a, b, stiffness,
                                         loads.free_lengths ? free_length : 0.0,
                                         one_way ? LinearSpring::Acts::tension : LinearSpring::Acts::both));
  }
  for (int k = 0; k < loads.torsion_springs; ++k) {
    const Joint& joint = scene.joints[static_cast<std::size_t>(random.index(scene.joints.size()))];
    const double stiffness = std::pow(10.0, random.uniform(0.0, 2.0));
    scene.elements.push_back(torsion_spring(fmt::format("torsion spring {}", k), joint.a.body, joint.b.body, stiffness,
                                            random.uniform(-M_PI, M_PI)));
  }
  return scene;
}

}  // namespace poise::test
