#include <algorithm>
#include <cmath>
#include <unordered_set>
#include <utility>

#include <fmt/format.h>

#include "exchange/mjcf.hpp"
#include "exchange/private/joint_tree.hpp"
#include "exchange/private/reading.hpp"
#include "exchange/private/xml.hpp"
#include "model/one_line.hpp"

namespace poise {
namespace {

constexpr double least_inertia = 1e-14;  // MuJoCo wants more than 1e-15 of what moves, kg and kg m^2
constexpr double far = 1e10;             // where a limit is that there is none

class MjcfWriter {
 public:
  MjcfWriter(const Scene& scene, const std::vector<BodyPose<double>>& poses)
      : scene_(scene), poses_(poses), tree_(scene, poses), effects_(effects_on(tree_, scene, "MJCF")) {
    for (const Body& body : scene.bodies) {
      if (body.name == "world")
        fail_at(scene.file, body.line, "body \"world\"", "expected another name, \"world\" is MuJoCo's ground");
    }
  }

  Exported write() {
    std::string bodies = inside(0, "    ");
    std::string equalities = closures();
    std::string tendons;
    for (const LineEffects& line : effects_.on_lines) add_line(line, tendons, equalities);
    std::string out = fmt::format("<mujoco model=\"{}\">\n", xml_value(one_line(scene_.title)));
    out += "  <compiler angle=\"radian\" autolimits=\"false\"/>\n";
    out += fmt::format("  <option gravity=\"{}\"/>\n", in_space(scene_.gravity));
    out += fmt::format(
        "  <default>\n    <geom type=\"capsule\" size=\"{}\" contype=\"0\" conaffinity=\"0\" density=\"0\"/>\n  "
        "</default>\n",
        shortest(thickness()));
    out += "  <worldbody>\n" + bodies + "  </worldbody>\n";
    if (!tendons.empty()) out += "  <tendon>\n" + tendons + "  </tendon>\n";
    if (!equalities.empty()) out += "  <equality>\n" + equalities + "  </equality>\n";
    out += "</mujoco>\n";
    return {std::move(out), notes()};
  }

 private:
  static std::string attribute(const std::string& key, const std::string& value) {
    return fmt::format(" {}=\"{}\"", key, xml_value(value));
  }
  static std::string unless(const std::string& key, double value, double otherwise) {
    return value == otherwise ? "" : attribute(key, shortest(value));
  }

  std::string body_name(int body) const {
    return body == 0 ? "world" : scene_.bodies[static_cast<std::size_t>(body)].name;
  }

  // Bodies are drawn as rods, whose thickness is a fiftieth of the typical length.
  double thickness() const {
    double sum = 0.0;
    int count = 0;
    for (std::size_t body = 1; body < scene_.bodies.size(); ++body) {
      const std::vector<NamedPoint>& points = scene_.bodies[body].points;
      for (std::size_t k = 1; k < points.size(); ++k, ++count) sum += norm(points[k].at - points[k - 1].at);
    }
    return sum > 0.0 ? std::max(1e-6, 0.02 * sum / count) : 0.01;
  }

  // Its sites, the rods that it is drawn as, and the bodies that hang on it.
  std::string inside(int index, const std::string& indent) {
    const Body& body = scene_.bodies[static_cast<std::size_t>(index)];
    std::string out;
    for (std::size_t k = 0; k < body.points.size(); ++k) {
      const NamedPoint& point = body.points[k];
      out += fmt::format("{}<site{}{}/>\n", indent, attribute("name", body.name + "." + point.name),
                         attribute("pos", in_space(point.at)));
      if (index != 0 && k > 0 && norm(point.at - body.points[k - 1].at) > 1e-9) {
        out += fmt::format("{}<geom{}/>\n", indent,
                           attribute("fromto", in_space(body.points[k - 1].at) + " " + in_space(point.at)));
      }
    }
    for (const int child : tree_.order()) {
      if (child != 0 && tree_.branch(child).parent == index) out += body_element(child, indent);
    }
    return out;
  }

  std::string body_element(int index, const std::string& indent) {
    const Body& body = scene_.bodies[static_cast<std::size_t>(index)];
    const TreeBranch& branch = tree_.branch(index);
    std::string out =
        fmt::format("{}<body{}{}", indent, attribute("name", body.name), attribute("pos", in_space(branch.at)));
    if (branch.angle != 0.0)
      out += attribute("axisangle", fmt::format("{} {}", normal_in_space, shortest(branch.angle)));
    out += ">\n";
    const std::string deeper = indent + "  ";
    for (const int coordinate : branch.coordinates) out += joint_element(coordinate, deeper);
    out += inertial(body, deeper, !branch.coordinates.empty());
    return out + inside(index, deeper) + indent + "</body>\n";
  }

  std::string inertial(const Body& body, const std::string& indent, bool moves) {
    if (!moves && body.mass == 0.0 && body.inertia == 0.0) return "";
    if (body.mass < least_inertia || body.inertia < least_inertia) raised_.push_back('"' + body.name + '"');
    const std::string inertia = shortest(std::max(body.inertia, least_inertia));
    return fmt::format("{}<inertial{}{}{}/>\n", indent, attribute("pos", in_space(body.center)),
                       attribute("mass", shortest(std::max(body.mass, least_inertia))),
                       attribute("diaginertia", inertia + " " + inertia + " " + inertia));
  }

  std::string joint_element(int index, const std::string& indent) const {
    const TreeCoordinate& coordinate = tree_.coordinates()[static_cast<std::size_t>(index)];
    const CoordinateEffects& effects = effects_.on_coordinates[static_cast<std::size_t>(index)];
    std::string out = fmt::format("{}<joint{}", indent, attribute("name", coordinate.name));
    if (coordinate.slides)
      out += attribute("type", "slide") + attribute("axis", in_space(coordinate.axis));
    else
      out += attribute("type", "hinge") + attribute("axis", std::string(normal_in_space)) +
             attribute("pos", in_space(coordinate.at));
    out += unless("ref", coordinate.value, 0.0) + unless("stiffness", effects.stiffness, 0.0);
    if (effects.stiffness > 0.0) out += attribute("springref", shortest(effects.free_value));
    out += unless("damping", effects.damping, 0.0) + unless("frictionloss", effects.friction, 0.0);
    return out + range(effects.lower, effects.upper) + "/>\n";
  }

  static std::string range(double lower, double upper) {
    if (!std::isfinite(lower) && !std::isfinite(upper)) return "";
    return attribute("limited", "true") +
           attribute("range", fmt::format("{} {}", shortest(std::max(lower, -far)), shortest(std::min(upper, far))));
  }

  std::string closures() const {
    std::string out;
    for (const int index : tree_.closures()) {
      const Joint& joint = scene_.joints[static_cast<std::size_t>(index)];
      const std::string ends =
          attribute("body1", body_name(joint.a.body)) + attribute("body2", body_name(joint.b.body));
      if (joint.kind == Joint::Kind::pin) {
        out += fmt::format("    <connect{}{}{}/>\n", attribute("name", joint.name), ends,
                           attribute("anchor", in_space(scene_.local(joint.a))));
      } else if (joint.kind == Joint::Kind::weld) {
        const Vec2 at = scene_.local(joint.a) - scene_.local(joint.b) * unit(joint.angle);
        const Vec2 half = unit(joint.angle / 2);
        out += fmt::format(
            "    <weld{}{}{}/>\n", attribute("name", joint.name), ends,
            attribute("relpose", fmt::format("{} {} 0 {} 0", in_space(at), shortest(half.x), shortest(-half.y))));
      } else {
        fail_at(scene_.file, joint.line, fmt::format("{} \"{}\"", joint.traits().key, joint.name),
                "MJCF closes loops by pins and welds, and all joints of this loop slide; leave one out");
      }
    }
    return out;
  }

  void add_line(const LineEffects& line, std::string& tendons, std::string& equalities) {
    if (line.held && line.points.empty() && line.sum.terms.size() <= 2) {
      equalities += joint_equality(line);
      return;
    }
    // A negative length at rest means the length as it is drawn, in MuJoCo before 2.3.1.
    if (line.points.empty() && line.slack_from == line.slack_to && line.slack_from < 0.0) {
      add_line(reversed(line), tendons, equalities);
      return;
    }
    const std::string name = own_name(line.name, tendon_names_);
    std::string out = line.points.empty() ? "    <fixed" : "    <spatial";
    out += attribute("name", name) + unless("stiffness", line.stiffness, 0.0);
    if (line.stiffness > 0.0) {
      const bool is_slack = line.slack_from != line.slack_to;
      has_slack_ = has_slack_ || is_slack;
      out += attribute("springlength", shortest(line.slack_from) + (is_slack ? " " + shortest(line.slack_to) : ""));
    }
    out += unless("damping", line.damping, 0.0) + unless("frictionloss", line.friction, 0.0);
    out += range(line.points.empty() || line.lower > 0.0 || !std::isfinite(line.upper) ? line.lower : 0.0, line.upper) +
           ">\n";
    double drawn = 0.0;
    for (const auto& [index, factor] : line.sum.terms) {
      const TreeCoordinate& coordinate = tree_.coordinates()[static_cast<std::size_t>(index)];
      drawn += factor * coordinate.value;
      out +=
          fmt::format("      <joint{}{}/>\n", attribute("joint", coordinate.name), attribute("coef", shortest(factor)));
    }
    for (std::size_t k = 0; k < line.points.size(); ++k) {
      out += fmt::format("      <site{}/>\n", attribute("site", scene_.name_of(line.points[k])));
      if (k > 0) drawn += norm(place(line.points[k]) - place(line.points[k - 1]));
    }
    tendons += out + (line.points.empty() ? "    </fixed>\n" : "    </spatial>\n");
    if (line.held) {
      equalities += fmt::format("    <tendon{}{}{}/>\n", attribute("name", line.name), attribute("tendon1", name),
                                attribute("polycoef", shortest(*line.held - drawn) + " 0 0 0 0"));
    }
  }

  // The effects are those on the negative sum.
  static LineEffects reversed(LineEffects line) {
    for (auto& [coordinate, factor] : line.sum.terms) factor = -factor;
    line.slack_from = line.slack_to = -line.slack_from;
    line.lower = -std::exchange(line.upper, -line.lower);
    if (line.held) line.held = -*line.held;
    return line;
  }

  Vec2 place(PointRef point) const { return poses_[static_cast<std::size_t>(point.body)].world(scene_.local(point)); }

  // q1 - r1 = c + f (q2 - r2), with the values r in the pose that is drawn.
  std::string joint_equality(const LineEffects& line) const {
    const auto& [first, factor] = line.sum.terms.front();
    const TreeCoordinate& one = tree_.coordinates()[static_cast<std::size_t>(first)];
    std::string out = "    <joint" + attribute("name", line.name) + attribute("joint1", one.name);
    double constant = *line.held / factor - one.value, slope = 0.0;
    if (line.sum.terms.size() == 2) {
      const auto& [second, other] = line.sum.terms.back();
      const TreeCoordinate& two = tree_.coordinates()[static_cast<std::size_t>(second)];
      slope = -other / factor;
      constant += slope * two.value;
      out += attribute("joint2", two.name);
    }
    return out + attribute("polycoef", shortest(constant) + " " + shortest(slope) + " 0 0 0") + "/>\n";
  }

  std::vector<std::string> notes() const {
    std::vector<std::string> out;
    if (!raised_.empty()) {
      out.push_back(
          fmt::format("Bodies without mass or inertia have 1e-14 kg or kg m^2, for MuJoCo moves no others: {}.",
                      fmt::join(raised_, ", ")));
    }
    if (has_slack_) out.emplace_back("Springs that act on one side need MuJoCo 2.3.1 or later.");
    if (std::any_of(scene_.bodies.begin(), scene_.bodies.end(), [](const Body& body) { return body.section; })) {
      out.emplace_back("Cross-sections are left out.");
    }
    return out;
  }

  const Scene& scene_;
  const std::vector<BodyPose<double>>& poses_;
  JointTree tree_;
  TreeEffects effects_;
  std::unordered_set<std::string> tendon_names_;
  std::vector<std::string> raised_;
  bool has_slack_ = false;
};

}  // namespace

Exported export_mjcf(const Scene& scene, const std::vector<BodyPose<double>>& poses) {
  return MjcfWriter(scene, poses).write();
}

}  // namespace poise
