#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_set>

#include <fmt/format.h>

#include "exchange/private/joint_tree.hpp"
#include "exchange/private/reading.hpp"
#include "exchange/private/xml.hpp"
#include "exchange/urdf.hpp"
#include "model/one_line.hpp"

namespace poise {
namespace {

constexpr double no_stop = 1e10;  // a limit of a slide that has none
constexpr double assumed_gravity = 9.81;

class UrdfWriter {
 public:
  UrdfWriter(const Scene& scene, const std::vector<BodyPose<double>>& poses)
      : scene_(scene), tree_(scene, poses), effects_(effects_on(tree_, scene, "URDF")), origins_(scene.bodies.size()) {
    for (const Body& body : scene.bodies) links_.insert(body.name);
    refuse_loops();
    read_lines();
  }

  Exported write() {
    std::string out =
        fmt::format("<robot name=\"{}\">\n", xml_value(one_line(scene_.title.empty() ? "scene" : scene_.title)));
    out += upright();
    for (const int body : tree_.order()) {
      if (body != 0) out += joints(body);
      out += link(body);
    }
    for (std::size_t c = 0; c < effects_.on_coordinates.size(); ++c) {
      const CoordinateEffects& effects = effects_.on_coordinates[c];
      if (effects.stiffness == 0.0) continue;
      has_springs_ = true;
      out += fmt::format(
          "  <gazebo{}>\n    <springStiffness>{}</springStiffness>\n    <springReference>{}</springReference>\n  "
          "</gazebo>\n",
          attribute("reference", tree_.coordinates()[c].name), shortest(effects.stiffness),
          shortest(effects.free_value));
    }
    return {out + "</robot>\n", notes()};
  }

 private:
  static std::string attribute(const std::string& key, const std::string& value) {
    return fmt::format(" {}=\"{}\"", key, xml_value(value));
  }

  void refuse_loops() const {
    if (tree_.closures().empty()) return;
    const Joint& joint = scene_.joints[static_cast<std::size_t>(tree_.closures().front())];
    fail_at(scene_.file, joint.line, fmt::format("{} \"{}\"", joint.traits().key, joint.name),
            "URDF has trees of links only, and this closes a loop; write MJCF (--mjcf FILE)");
  }

  // Mimics are all that URDF has of what acts on more than a joint.
  void read_lines() {
    for (const LineEffects& line : effects_.on_lines) {
      const std::size_t terms = line.sum.terms.size();
      if (!line.held || !line.points.empty() || terms > 2 || !is_in_joints(line.sum)) {
        fail_at(scene_.file, line.line, line.item,
                "URDF has only what acts on one joint, or couples two of them; write MJCF (--mjcf FILE)");
      }
      const auto& [first, factor] = line.sum.terms.front();
      const bool is_alone = terms == 1;
      const int leader = is_alone ? -1 : line.sum.terms.back().first;
      Mimic mimic{first, leader, is_alone ? 0.0 : -line.sum.terms.back().second / factor, *line.held / factor};
      if (is_alone || !mimicking_.insert(first).second) {
        fail_at(scene_.file, line.line, line.item,
                "URDF couples a joint to one other joint only; write MJCF (--mjcf FILE)");
      }
      mimics_.push_back(mimic);
    }
    for (const int body : tree_.order()) {
      if (body == 0 || tree_.branch(body).joint >= 0) continue;
      for (const int c : tree_.branch(body).coordinates) {
        const CoordinateEffects& effects = effects_.on_coordinates[static_cast<std::size_t>(c)];
        if (effects.stiffness > 0.0 || effects.damping > 0.0 || effects.friction > 0.0 ||
            std::isfinite(effects.lower) || std::isfinite(effects.upper)) {
          const Body& free = scene_.bodies[static_cast<std::size_t>(body)];
          fail_at(scene_.file, free.line, fmt::format("body \"{}\"", free.name),
                  "URDF has nothing that acts on a body without a joint; write MJCF (--mjcf FILE)");
        }
      }
    }
  }

  bool is_in_joints(const SumOfCoordinates& sum) const {
    return std::all_of(sum.terms.begin(), sum.terms.end(), [&](const auto& term) {
      return std::any_of(tree_.order().begin(), tree_.order().end(), [&](int body) {
        const std::vector<int>& own = tree_.branch(body).coordinates;
        return body != 0 && tree_.branch(body).joint >= 0 && std::find(own.begin(), own.end(), term.first) != own.end();
      });
    });
  }

  // A link in whose frame gravity is along -z carries the ground where it is not along -y of the scene.
  std::string upright() {
    const Vec2& gravity = scene_.gravity;
    const double turn = norm(gravity) > 0.0 ? -std::numbers::pi / 2 - std::atan2(gravity.y, gravity.x) : 0.0;
    if (gravity.x == 0.0 && gravity.y <= 0.0) return "";
    const std::string base = own_name("world", links_);
    return fmt::format("  <link{}/>\n", attribute("name", base)) +
           joint_element("upright", "fixed", base, "ground", {}, turn, "");
  }

  static std::string joint_element(const std::string& name, const std::string& type, const std::string& parent,
                                   const std::string& child, Vec2 at, double turn, const std::string& more) {
    std::string origin;
    if (!(at == Vec2{}) || turn != 0.0) {
      origin = attribute("xyz", in_space(at)) +
               (turn == 0.0 ? "" : attribute("rpy", fmt::format("0 {} 0", shortest(-turn))));
      origin = fmt::format("    <origin{}/>\n", origin);
    }
    return fmt::format("  <joint{}{}>\n    <parent{}/>\n    <child{}/>\n{}{}  </joint>\n", attribute("name", name),
                       attribute("type", type), attribute("link", parent), attribute("link", child), origin, more);
  }

  // Links have their origins where their first joint is, as URDF wants it.
  std::string joints(int body) {
    const TreeBranch& branch = tree_.branch(body);
    const std::string& child = scene_.bodies[static_cast<std::size_t>(body)].name;
    const std::string parent = scene_.bodies[static_cast<std::size_t>(branch.parent)].name;
    if (branch.joint < 0) {
      return joint_element(child + " planar", "planar", parent, child, branch.at, branch.angle,
                           fmt::format("    <axis xyz=\"{}\"/>\n", normal_in_space));
    }
    const Joint& joint = scene_.joints[static_cast<std::size_t>(branch.joint)];
    const PointRef of_parent = branch.is_reversed ? joint.b : joint.a, own = branch.is_reversed ? joint.a : joint.b;
    origins_[static_cast<std::size_t>(body)] = scene_.local(own);
    const Vec2 at = scene_.local(of_parent) - origins_[static_cast<std::size_t>(branch.parent)];
    const double turn = joint.keeps_angle() ? branch.angle : 0.0;
    if (branch.coordinates.empty()) return joint_element(joint.name, "fixed", parent, child, at, turn, "");
    const Vec2 along = joint.direction() * unit(branch.is_reversed ? 0.0 : -turn);
    const Vec2 axis = branch.is_reversed ? -along : along;
    if (branch.coordinates.size() == 1) {
      return moving_joint(branch.coordinates.front(), joint.name, parent, child, at, turn, axis);
    }
    const std::string between = own_name(child + " carrier", links_);
    const int first = branch.coordinates.front(), second = branch.coordinates.back();
    return moving_joint(first, tree_.coordinates()[static_cast<std::size_t>(first)].name, parent, between, at, 0.0,
                        axis) +
           fmt::format("  <link{}/>\n", attribute("name", between)) +
           moving_joint(second, tree_.coordinates()[static_cast<std::size_t>(second)].name, between, child, {}, 0.0,
                        axis);
  }

  std::string moving_joint(int coordinate, const std::string& name, const std::string& parent, const std::string& child,
                           Vec2 at, double turn, Vec2 axis) const {
    const CoordinateEffects& effects = effects_.on_coordinates[static_cast<std::size_t>(coordinate)];
    const bool slides = tree_.coordinates()[static_cast<std::size_t>(coordinate)].slides;
    const bool is_limited = slides || std::isfinite(effects.lower) || std::isfinite(effects.upper);
    std::string more = fmt::format("    <axis xyz=\"{}\"/>\n", slides ? in_space(axis) : std::string(normal_in_space));
    if (is_limited) {
      more += fmt::format("    <limit lower=\"{}\" upper=\"{}\" effort=\"{}\" velocity=\"{}\"/>\n",
                          shortest(std::max(effects.lower, -no_stop)), shortest(std::min(effects.upper, no_stop)),
                          shortest(no_stop), shortest(no_stop));
    }
    if (effects.damping > 0.0 || effects.friction > 0.0) {
      more += fmt::format("    <dynamics damping=\"{}\" friction=\"{}\"/>\n", shortest(effects.damping),
                          shortest(effects.friction));
    }
    for (const Mimic& mimic : mimics_) {
      if (mimic.joint != coordinate) continue;
      more += fmt::format("    <mimic{} multiplier=\"{}\" offset=\"{}\"/>\n",
                          attribute("joint", tree_.coordinates()[static_cast<std::size_t>(mimic.leader)].name),
                          shortest(mimic.multiplier), shortest(mimic.offset));
    }
    return joint_element(name,
                         slides       ? "prismatic"
                         : is_limited ? "revolute"
                                      : "continuous",
                         parent, child, at, turn, more);
  }

  std::string link(int index) const {
    const Body& body = scene_.bodies[static_cast<std::size_t>(index)];
    const std::string head = fmt::format("  <link{}", attribute("name", body.name));
    if (body.mass == 0.0 && body.inertia == 0.0) return head + "/>\n";
    const std::string inertia = shortest(body.inertia);
    return head + ">\n    <inertial>\n" +
           fmt::format("      <origin xyz=\"{}\"/>\n",
                       in_space(body.center - origins_[static_cast<std::size_t>(index)])) +
           fmt::format("      <mass value=\"{}\"/>\n", shortest(body.mass)) +
           fmt::format("      <inertia ixx=\"{0}\" iyy=\"{0}\" izz=\"{0}\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/>\n",
                       inertia) +
           "    </inertial>\n  </link>\n";
  }

  std::vector<std::string> notes() const {
    std::vector<std::string> out;
    if (const double strength = norm(scene_.gravity); std::abs(strength - assumed_gravity) > 1e-12) {
      out.push_back(fmt::format("URDF has no gravity; that of the scene is {} m/s^2 along -z.", shortest(strength)));
    }
    if (has_springs_) out.emplace_back("Springs are in <gazebo>, which some readers leave out.");
    if (std::any_of(scene_.bodies.begin(), scene_.bodies.end(), [](const Body& body) { return body.section; })) {
      out.emplace_back("Cross-sections are left out.");
    }
    return out;
  }

  struct Mimic {
    int joint = 0, leader = 0;
    double multiplier = 0.0, offset = 0.0;
  };

  const Scene& scene_;
  JointTree tree_;
  TreeEffects effects_;
  std::vector<Vec2> origins_;  // of the links in the frames of the bodies
  std::vector<Mimic> mimics_;
  std::unordered_set<int> mimicking_;
  std::unordered_set<std::string> links_;
  bool has_springs_ = false;
};

}  // namespace

Exported export_urdf(const Scene& scene, const std::vector<BodyPose<double>>& poses) {
  return UrdfWriter(scene, poses).write();
}

}  // namespace poise
