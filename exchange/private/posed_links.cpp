#include "exchange/private/posed_links.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include <fmt/format.h>

#include "exchange/private/drawn_scene.hpp"

namespace poise {
namespace {

std::size_t root_of(std::vector<std::size_t>& parent, std::size_t body) {
  while (parent[body] != body) body = parent[body] = parent[parent[body]];
  return body;
}

/// One set of what were two, with its least member as the root.
void join(std::vector<std::size_t>& parent, std::size_t i, std::size_t k) {
  const std::size_t a = root_of(parent, i), b = root_of(parent, k);
  parent[std::max(a, b)] = std::min(a, b);
}

std::string counted(std::size_t number, const std::string& singular, const std::string& plural) {
  return fmt::format("{} {}", number, number == 1 ? singular : plural);
}

}  // namespace

bool PosedLinks::Node::has(std::size_t link) const {
  return std::find(links.begin(), links.end(), link) != links.end();
}

PosedLinks::PosedLinks(const Scene& scene, const std::vector<BodyPose<double>>& poses) : scene_(scene), poses_(poses) {
  double size = 0.0;
  for (std::size_t body = 0; body < scene.bodies.size(); ++body) {
    for (const NamedPoint& point : scene.bodies[body].points) size = std::max(size, norm(poses[body].world(point.at)));
  }
  constexpr double rounding_of_poses = 1e-14;
  rounding_ = rounding_of_poses * size;
  find_links();
  find_nodes();
}

void PosedLinks::find_links() {
  std::vector<std::size_t> parent(scene_.bodies.size());
  std::iota(parent.begin(), parent.end(), 0U);
  for (const Joint& joint : scene_.joints) {
    if (joint.kind != Joint::Kind::weld) continue;
    join(parent, static_cast<std::size_t>(joint.a.body), static_cast<std::size_t>(joint.b.body));
  }
  link_of_.resize(scene_.bodies.size());
  for (std::size_t body = 0; body < scene_.bodies.size(); ++body) {
    const std::size_t root = root_of(parent, body);  // the first of those that are welded, of the ground the ground
    if (root == body) {
      link_of_[body] = links_.size();
      links_.push_back({scene_.bodies[body].name, {}, {}});
    } else {
      link_of_[body] = link_of_[root];
    }
    Link& link = links_[link_of_[body]];
    for (std::size_t p = 0; p < scene_.bodies[body].points.size(); ++p) {
      const PointRef point{static_cast<int>(body), static_cast<int>(p)};
      link.points.push_back(point);
      link.places.push_back(place(point));
    }
  }
  bars_.resize(scene_.joints.size());
  for (std::size_t j = 0; j < scene_.joints.size(); ++j) {
    const Joint& joint = scene_.joints[j];
    if (!joint.keeps_length()) continue;
    bars_[j] = links_.size();
    links_.push_back({joint.name, {}, {place(joint.a), place(joint.b)}});
  }
}

void PosedLinks::find_nodes() {
  first_.assign(scene_.bodies.size() + 1, 0);
  for (std::size_t b = 0; b < scene_.bodies.size(); ++b) first_[b + 1] = first_[b] + scene_.bodies[b].points.size();
  std::vector<std::size_t> parent(first_.back());
  std::iota(parent.begin(), parent.end(), 0U);
  for (const Joint& joint : scene_.joints) {
    if (!joint.has_travel() && !joint.keeps_length()) join(parent, index(joint.a), index(joint.b));
  }
  for (const Link& link : links_) {
    std::map<std::pair<double, double>, std::size_t> seen;
    for (std::size_t p = 0; p < link.points.size(); ++p) {
      const std::size_t own = index(link.points[p]);
      const auto [other, is_new] = seen.emplace(std::pair{link.places[p].x, link.places[p].y}, own);
      if (!is_new) join(parent, other->second, own);
    }
  }
  node_of_.resize(first_.back());
  std::map<std::size_t, std::size_t> node_of_root;
  const auto put = [&](std::size_t node, std::size_t link) {
    if (!nodes_[node].has(link)) nodes_[node].links.push_back(link);
  };
  for (std::size_t l = 0; l < links_.size(); ++l) {
    for (std::size_t p = 0; p < links_[l].points.size(); ++p) {
      const std::size_t own = index(links_[l].points[p]);
      const auto [node, is_new] = node_of_root.emplace(root_of(parent, own), nodes_.size());
      if (is_new) nodes_.push_back({.at = links_[l].places[p]});
      node_of_[own] = node->second;
      put(node->second, l);
    }
  }
  for (std::size_t j = 0; j < scene_.joints.size(); ++j) {
    if (!scene_.joints[j].keeps_length()) continue;
    put(node_of(scene_.joints[j].a), bars_[j]);
    put(node_of(scene_.joints[j].b), bars_[j]);
  }
}

Vec2 PosedLinks::place(int body, Vec2 local) const {
  const Vec2 at = poses_[static_cast<std::size_t>(body)].world(local);
  const auto in_units = [&](double si) {
    return std::abs(si) < rounding_ ? 0.0 : short_number(si / scene_.units.length);
  };
  return {in_units(at.x), in_units(at.y)};
}

Vec2 PosedLinks::place(PointRef point) const { return place(point.body, scene_.local(point)); }

Vec2 PosedLinks::direction_in_world(int body, Vec2 local) const {
  return direction<double>(local) * poses_[static_cast<std::size_t>(body)].direction();
}

std::vector<std::string> PosedLinks::welds() const {
  const auto is_weld = [](const Joint& joint) { return joint.kind == Joint::Kind::weld; };
  if (std::none_of(scene_.joints.begin(), scene_.joints.end(), is_weld)) return {};
  return {"Bodies that are welded are one link, which has the name of the first."};
}

std::vector<std::string> PosedLinks::left_out() const {
  std::map<std::string, std::size_t> families;
  for (const Element& element : scene_.elements) ++families[element.family()];
  if (!scene_.blades.empty()) families["blade"] = scene_.blades.size();
  bool binds = false;
  for (const Stop& stop : scene_.stops) {
    ++families[stop.family()];
    binds = binds || stop.table != "stop";
  }
  std::vector<std::string> out;
  for (const auto& [family, number] : families) {
    out.push_back(fmt::format("{} left out.", counted(number, family + " is", family + "s are")));
  }
  if (binds) out.emplace_back("Without what binds its links to one another the mechanism has more freedoms there.");
  const auto rubs = [](const Joint& joint) { return joint.friction.has_value(); };
  if (std::any_of(scene_.joints.begin(), scene_.joints.end(), rubs)) out.emplace_back("Friction is left out.");
  if (!scene_.torques.empty()) {
    out.push_back(fmt::format("{} left out.", counted(scene_.torques.size(), "torque is", "torques are")));
  }
  return out;
}

}  // namespace poise
