#include <filesystem>
#include <map>
#include <optional>
#include <set>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "exchange/private/reading.hpp"
#include "exchange/private/spatial_model.hpp"
#include "exchange/private/xml.hpp"
#include "exchange/urdf.hpp"
#include "model/nearest_name.hpp"
#include "model/one_line.hpp"
#include "model/value_range.hpp"

namespace poise {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using pugi::xml_node;
using Frame = Eigen::Isometry3d;

struct UrdfJoint {
  std::string name;
  xml_node node;
  std::string parent, child;
  int index = -1;  // in the model, of those that turn or slide
};

class UrdfReader {
 public:
  UrdfReader(std::string_view text, const std::string& file) : xml_(text, file), robot_(xml_.root("robot")) {
    model_.file = file;
    model_.title = one_line(trimmed(robot_.attribute("name").value()));
  }

  SpatialModel model() {
    for (const xml_node node : robot_.children()) read_element(node);
    if (links_.empty()) xml_.fail(robot_, "robot", "expected a link, found none");
    for (const UrdfJoint& joint : joints_) hang(joint);
    place(root_link());
    for (const auto& [name, node] : links_) {
      if (bodies_.find(name) == bodies_.end()) {
        xml_.fail(node, link_item(name),
                  "expected a link of the tree, found one of a ring of joints; close loops by "
                  "loop_joint, or take MJCF");
      }
    }
    read_mimics();
    for (const xml_node node : springs_) read_spring(node);
    for (const xml_node node : loops_) read_loop(node);
    add_notes();
    return std::move(model_);
  }

 private:
  static std::string link_item(const std::string& name) { return fmt::format("link \"{}\"", name); }
  static std::string joint_item(const std::string& name) { return fmt::format("joint \"{}\"", name); }

  void read_element(xml_node node) {
    const std::string_view kind = node.name();
    if (kind == "link") {
      const std::string name = xml_.word(node, "name", "link");
      if (links_.size() >= most_items) xml_.fail(node, link_item(name), "expected at most 10000 links");
      if (!links_.emplace(name, node).second)
        xml_.fail(node, link_item(name), "expected a name of its own, it is there twice");
      order_.push_back(name);
    } else if (kind == "joint") {
      const std::string name = xml_.word(node, "name", "joint");
      if (!joint_places_.emplace(name, joints_.size()).second) {
        xml_.fail(node, joint_item(name), "expected a name of its own, it is there twice");
      }
      joints_.push_back({name, node, {}, {}, -1});
    } else if (kind == "loop_joint") {
      loops_.push_back(node);
    } else if (kind == "gazebo") {
      if (node.child("springStiffness")) springs_.push_back(node);
    } else if (kind.starts_with("xacro:")) {
      xml_.fail(node, one_line(kind), "expected URDF, found a macro; run xacro over the file first");
    } else if (kind == "transmission") {
      left_out_.insert("transmissions");
    } else if (node.type() == pugi::node_element && kind != "material") {
      left_out_.insert(fmt::format("<{}>", one_line(kind)));
    }
  }

  // The link that a part of an element names, as <parent link="..."/> does.
  std::string link_named(xml_node node, const std::string& item, const char* part) const {
    if (!node.child(part)) xml_.fail(node, item, fmt::format("expected a <{} link=\"...\"/>, found none", part));
    std::string name = xml_.word(node.child(part), "link", item + "." + part);
    if (links_.find(name) == links_.end()) {
      xml_.fail(node, item + "." + part,
                fmt::format("expected the name of a link, found \"{}\"{}", name, did_you_mean_or_list(name, order_)));
    }
    return name;
  }

  void hang(const UrdfJoint& given) {
    UrdfJoint& joint = joints_[joint_places_.at(given.name)];
    const std::string item = joint_item(joint.name);
    joint.parent = link_named(joint.node, item, "parent");
    joint.child = link_named(joint.node, item, "child");
    if (!parent_of_.emplace(joint.child, joint.name).second) {
      xml_.fail(joint.node, item,
                fmt::format("expected a tree, found a second joint that leads to link \"{}\", besides \"{}\"; close "
                            "loops by loop_joint, or take MJCF",
                            joint.child, parent_of_.at(joint.child)));
    }
    children_[joint.parent].push_back(joint.name);
  }

  std::string root_link() {
    std::vector<std::string> roots;
    for (const std::string& name : order_) {
      if (parent_of_.find(name) == parent_of_.end()) roots.push_back(name);
    }
    if (roots.empty()) xml_.fail(robot_, "robot", "expected a link without a parent, which is the base, found none");
    if (roots.size() > 1) {
      xml_.fail(links_.at(roots[1]), link_item(roots[1]),
                fmt::format("expected one link without a parent, found two, \"{}\" and this one; join it by a joint",
                            roots[0]));
    }
    return roots.front();
  }

  Frame frame_of(xml_node holder, const std::string& item) const {
    Frame frame = Frame::Identity();
    const xml_node origin = holder.child("origin");
    if (!origin) return frame;
    const std::vector<double> at = xml_.numbers(origin, "xyz", item + ".origin", 3, {0.0, 0.0, 0.0});
    const std::vector<double> rpy = xml_.numbers(origin, "rpy", item + ".origin", 3, {0.0, 0.0, 0.0});
    return frame_of(at, rpy);
  }

  static Frame frame_of(const std::vector<double>& at, const std::vector<double>& rpy) {
    Frame frame = Frame::Identity();
    frame.linear() = (Eigen::AngleAxisd(rpy[2], Vector3d::UnitZ()) * Eigen::AngleAxisd(rpy[1], Vector3d::UnitY()) *
                      Eigen::AngleAxisd(rpy[0], Vector3d::UnitX()))
                         .toRotationMatrix();
    frame.translation() = Vector3d(at[0], at[1], at[2]);
    return frame;
  }

  // All links that hang on it, from the base on.
  void place(const std::string& root) {
    frames_[root] = Frame::Identity();
    bodies_[root] = 0;
    if (links_.at(root).child("inertial")) base_has_mass_ = root;
    std::vector<std::string> reached = {root};
    for (std::size_t next = 0; next < reached.size(); ++next) {
      const std::string parent = reached[next];
      for (const std::string& name : children_[parent]) {
        UrdfJoint& joint = joints_[joint_places_.at(name)];
        add_body(joint);
        reached.push_back(joint.child);
      }
    }
  }

  void add_body(UrdfJoint& joint) {
    const std::string item = joint_item(joint.name);
    const Frame frame = frames_.at(joint.parent) * frame_of(joint.node, item);
    frames_[joint.child] = frame;
    SpatialBody body;
    body.name = joint.child == "ground" ? "ground link" : joint.child;
    body.line = xml_.line_of(links_.at(joint.child));
    body.parent = bodies_.at(joint.parent);
    body.at = frame.translation();
    bodies_[joint.child] = static_cast<int>(model_.bodies.size());
    const std::string type = xml_.word(joint.node, "type", item);
    if (type == "revolute" || type == "continuous" || type == "prismatic") {
      joint.index = static_cast<int>(model_.joints.size());
      body.joints.push_back(joint.index);
      model_.joints.push_back(read_joint(joint, type, frame));
    } else if (type == "planar") {
      body.is_free = true;
      planar_.push_back(joint.name);
    } else if (type == "floating") {
      xml_.fail(joint.node, item, "expected a joint that stays in the plane, found a floating one; make it planar");
    } else if (type != "fixed") {
      const std::vector<std::string> known = {"revolute", "continuous", "prismatic", "fixed", "planar"};
      xml_.fail(
          joint.node, item + ".type",
          fmt::format("expected one of {}, found \"{}\"{}", fmt::join(known, ", "), type, did_you_mean(type, known)));
    }
    read_inertia(links_.at(joint.child), frame, body);
    model_.bodies.push_back(std::move(body));
  }

  Vector3d axis_of(xml_node node, const std::string& item) const {
    const std::vector<double> xyz = xml_.numbers(node.child("axis"), "xyz", item + ".axis", 3, {1.0, 0.0, 0.0});
    const Vector3d axis(xyz[0], xyz[1], xyz[2]);
    if (!(axis.stableNorm() > 0.0)) xml_.fail(node, item + ".axis", "expected a direction, found 0 0 0");
    return axis.stableNormalized();
  }

  double not_negative(xml_node node, const char* attribute, const std::string& item) const {
    const double value = xml_.number(node, attribute, item, 0.0);
    if (value < 0.0) xml_.fail(node, item + "." + attribute, out_of_range(Range::not_negative, value));
    return value;
  }

  SpatialJoint read_joint(const UrdfJoint& joint, const std::string& type, const Frame& frame) {
    const std::string item = joint_item(joint.name);
    SpatialJoint out;
    out.name = joint.name;
    out.line = xml_.line_of(joint.node);
    out.slides = type == "prismatic";
    out.axis = frame.linear() * axis_of(joint.node, item);
    out.at = frame.translation();
    if (const xml_node dynamics = joint.node.child("dynamics")) {
      out.damping = not_negative(dynamics, "damping", item + ".dynamics");
      out.friction = not_negative(dynamics, "friction", item + ".dynamics");
    }
    const xml_node limit = joint.node.child("limit");
    if (type != "continuous") {
      if (!limit) xml_.fail(joint.node, item, fmt::format("expected a <limit> of a {} joint, found none", type));
      out.lower = SpatialModel::lower_limit(xml_.number(limit, "lower", item + ".limit", 0.0));
      out.upper = SpatialModel::upper_limit(xml_.number(limit, "upper", item + ".limit", 0.0));
      if (out.lower > out.upper) {
        xml_.fail(limit, item + ".limit",
                  fmt::format("expected lower <= upper, found {} and {}", out.lower, out.upper));
      }
    }
    if (limit && (limit.attribute("effort") || limit.attribute("velocity")))
      left_out_.insert("limits of efforts and velocities");
    if (joint.node.child("safety_controller")) left_out_.insert("safety controllers");
    return out;
  }

  void read_inertia(xml_node link, const Frame& frame, SpatialBody& body) {
    if (link.child("collision")) has_collisions_ = true;
    const xml_node inertial = link.child("inertial");
    if (!inertial) return;
    const std::string item = link_item(body.name) + ".inertial";
    if (!inertial.child("mass")) xml_.fail(inertial, item, "expected a <mass value=\"...\"/>, found none");
    body.mass = xml_.number(inertial.child("mass"), "value", item + ".mass");
    if (body.mass < 0.0) xml_.fail(inertial, item + ".mass", out_of_range(Range::not_negative, body.mass));
    const Frame own = frame * frame_of(inertial, item);
    body.center = own.translation();
    const xml_node tensor = inertial.child("inertia");
    if (!tensor) return;
    const auto part = [&](const char* name) { return xml_.number(tensor, name, item + ".inertia", 0.0); };
    const double xx = part("ixx"), yy = part("iyy"), zz = part("izz");
    const double xy = part("ixy"), xz = part("ixz"), yz = part("iyz");
    Matrix3d inertia;
    inertia << xx, xy, xz, xy, yy, yz, xz, yz, zz;
    body.inertia = own.linear() * inertia * own.linear().transpose();
  }

  void read_mimics() {
    for (const UrdfJoint& joint : joints_) {
      const xml_node mimic = joint.node.child("mimic");
      if (!mimic) continue;
      const std::string item = joint_item(joint.name) + ".mimic";
      const std::string other = xml_.word(mimic, "joint", item);
      const auto found = joint_places_.find(other);
      const int leader = found == joint_places_.end() ? -1 : joints_[found->second].index;
      if (leader < 0 || joint.index < 0 || leader == joint.index) {
        xml_.fail(mimic, item, fmt::format("expected two joints that turn or slide, found \"{}\"", other));
      }
      SpatialTendon tendon;
      tendon.name = joint.name + " mimic";
      tendon.line = xml_.line_of(mimic);
      tendon.terms = {{joint.index, 1.0}};
      if (const double multiplier = xml_.number(mimic, "multiplier", item, 1.0); multiplier != 0.0) {
        tendon.terms.emplace_back(leader, -multiplier);
      }
      tendon.lower = tendon.upper = xml_.number(mimic, "offset", item, 0.0);
      model_.tendons.push_back(std::move(tendon));
    }
  }

  void read_spring(xml_node gazebo) {
    const std::string name = one_line(gazebo.attribute("reference").value());
    const auto found = joint_places_.find(name);
    const int index = found == joint_places_.end() ? -1 : joints_[found->second].index;
    if (index < 0)
      xml_.fail(gazebo, "gazebo.reference", fmt::format("expected a joint that turns or slides, found \"{}\"", name));
    const auto number = [&](const char* child) {
      const std::string text = gazebo.child(child).text().get();
      return text.empty() ? 0.0 : number_at(text, model_.file, xml_.line_of(gazebo), joint_item(name) + "." + child);
    };
    SpatialJoint& joint = model_.joints[static_cast<std::size_t>(index)];
    joint.stiffness = number("springStiffness");
    joint.spring_reference = number("springReference");
    if (joint.stiffness < 0.0) {
      xml_.fail(gazebo, joint_item(name) + ".springStiffness", out_of_range(Range::not_negative, joint.stiffness));
    }
  }

  void read_loop(xml_node node) {
    const std::string name = one_line(node.attribute("name").value());
    const std::string item = fmt::format("loop_joint \"{}\"", name);
    const std::string type = xml_.word(node, "type", item);
    SpatialClosure closure;
    closure.name = name;
    closure.line = xml_.line_of(node);
    closure.is_fixed = type == "fixed";
    if (type != "spherical" && type != "revolute" && type != "continuous" && type != "fixed") {
      xml_.fail(node, item, fmt::format("expected spherical, revolute, continuous or fixed, found \"{}\"", type));
    }
    std::vector<Frame> ends;
    std::vector<int> bodies;
    for (const char* const end : {"link1", "link2"}) {
      const std::string body = link_named(node, item, end);
      const std::vector<double> at = xml_.numbers(node.child(end), "xyz", item + "." + end, 3, {0.0, 0.0, 0.0});
      const std::vector<double> rpy = xml_.numbers(node.child(end), "rpy", item + "." + end, 3, {0.0, 0.0, 0.0});
      bodies.push_back(bodies_.at(body));
      ends.push_back(frames_.at(body) * frame_of(at, rpy));
    }
    if (bodies[0] == bodies[1]) xml_.fail(node, item, "expected two links that differ");
    closure.a = bodies[0];
    closure.b = bodies[1];
    closure.at_a = ends[0].translation();
    closure.at_b = ends[1].translation();
    closure.turn = ends[0].linear() * ends[1].linear().transpose();
    model_.closures.push_back(std::move(closure));
  }

  void add_notes() {
    std::vector<std::string>& notes = model_.notes;
    notes.emplace_back("URDF has no gravity: it is 9.81 m/s^2 along -z of the file.");
    if (!base_has_mass_.empty()) {
      notes.push_back(fmt::format("Link \"{}\" is the ground; its mass is left out.", base_has_mass_));
    }
    for (const std::string& name : planar_) {
      notes.push_back(fmt::format("Joint \"{}\" is planar: its link moves and turns freely in the plane.", name));
    }
    if (has_collisions_) notes.emplace_back("Contacts are left out.");
    if (!left_out_.empty()) notes.push_back(fmt::format("Left out: {}.", fmt::join(left_out_, ", ")));
  }

  Xml xml_;
  xml_node robot_;
  SpatialModel model_;
  std::map<std::string, xml_node> links_;
  std::vector<std::string> order_;  // of the links in the file
  std::vector<UrdfJoint> joints_;
  std::map<std::string, std::size_t> joint_places_;
  std::map<std::string, std::string> parent_of_;              // joints that lead to links
  std::map<std::string, std::vector<std::string>> children_;  // joints that leave links
  std::map<std::string, Frame> frames_;
  std::map<std::string, int> bodies_;
  std::vector<xml_node> loops_, springs_;
  std::vector<std::string> planar_;
  std::set<std::string> left_out_;
  std::string base_has_mass_;
  bool has_collisions_ = false;
};

}  // namespace

Imported import_urdf(std::string_view text, const std::string& file, const ImportOptions& options) {
  expect_si("URDF", options);
  return planar_scene(UrdfReader(text, file).model());
}

}  // namespace poise
