#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <unordered_map>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "exchange/mjcf.hpp"
#include "exchange/private/reading.hpp"
#include "exchange/private/spatial_model.hpp"
#include "exchange/private/xml.hpp"
#include "model/nearest_name.hpp"
#include "model/one_line.hpp"
#include "model/value_range.hpp"

namespace poise {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using pugi::xml_node;
using Frame = Eigen::Isometry3d;

constexpr double pi = std::numbers::pi;

// Mass, centre and inertia about it, as they add up.
struct SolidMass {
  double mass = 0.0;
  Vector3d center = Vector3d::Zero();
  Matrix3d about_center = Matrix3d::Zero();

  static Matrix3d shift(double mass, const Vector3d& by) {
    return mass * (by.squaredNorm() * Matrix3d::Identity() - by * by.transpose());
  }

  void add(const SolidMass& other) {
    const double sum = mass + other.mass;
    if (sum == 0.0) return;
    const Vector3d common = (mass * center + other.mass * other.center) / sum;
    about_center += other.about_center + shift(mass, center - common) + shift(other.mass, other.center - common);
    center = common;
    mass = sum;
  }
};

// Of a solid with an axis along z: volume, and the moments of inertia of unit mass along and across its axis.
struct Solid {
  double volume = 0.0;
  Vector3d moments = Vector3d::Zero();
};

Solid sphere(double r) { return {4.0 / 3.0 * pi * r * r * r, Vector3d::Constant(0.4 * r * r)}; }

Solid ellipsoid(const Vector3d& r) {
  const Vector3d square = r.cwiseAbs2();
  return {4.0 / 3.0 * pi * r.prod(),
          Vector3d(square.y() + square.z(), square.x() + square.z(), square.x() + square.y()) / 5.0};
}

Solid box(const Vector3d& half) {
  const Vector3d square = half.cwiseAbs2();
  return {8.0 * half.prod(), Vector3d(square.y() + square.z(), square.x() + square.z(), square.x() + square.y()) / 3.0};
}

Solid cylinder(double r, double half) {
  const double across = (3.0 * r * r + 4.0 * half * half) / 12.0;
  return {2.0 * pi * r * r * half, {across, across, r * r / 2.0}};
}

// A cylinder between two halves of a sphere, each with its centre of mass 3/8 r from its flat face.
Solid capsule(double r, double half) {
  const Solid middle = cylinder(r, half), ends = sphere(r);
  const double volume = middle.volume + ends.volume;
  const double apart = half * half + 0.75 * half * r;
  return {volume,
          (middle.volume * middle.moments + ends.volume * (ends.moments + Vector3d(apart, apart, 0.0))) / volume};
}

class MjcfReader {
 public:
  MjcfReader(std::string_view text, const std::string& file) : xml_(text, file), root_(xml_.root("mujoco")) {
    model_.file = file;
    model_.title = one_line(trimmed(root_.attribute("model").value()));
  }

  SpatialModel model() {
    read_head();
    const xml_node world = root_.child("worldbody");
    if (!world) xml_.fail(root_, "mujoco", "expected a <worldbody>, found none");
    body_places_["world"] = 0;
    frames_.push_back(Frame::Identity());
    Content content;
    for (const xml_node part : root_.children("worldbody")) read_content(part, 0, Frame::Identity(), "main", content);
    model_.bodies.front().points = points_of_[0];
    if (model_.bodies.size() == 1) xml_.fail(world, "worldbody", "expected a body, found none");
    if (!does_enable("passive")) {
      for (SpatialJoint& joint : model_.joints) joint.stiffness = joint.damping = 0.0;
    }
    for (const xml_node part : root_.children("tendon")) {
      for (const xml_node tendon : part.children()) read_tendon(tendon);
    }
    if (does_enable("equality")) {
      for (const xml_node part : root_.children("equality")) {
        for (const xml_node equality : part.children()) read_equality(equality);
      }
    }
    for (SpatialTendon& tendon : tendons_) add_tendon(tendon);
    add_notes();
    return std::move(model_);
  }

 private:
  using Attributes = std::map<std::string, std::string>;

  // What a body has in itself.
  struct Content {
    std::vector<int> joints;
    std::optional<SolidMass> inertial;
    SolidMass geoms;
    bool is_free = false;
    int free_line = 0;
  };

  // ---- head

  void read_head() {
    for (const xml_node part : root_.children()) {
      const std::string_view kind = part.name();
      static constexpr std::array<std::string_view, 9> silent = {
          "worldbody", "equality", "tendon", "visual", "statistic", "size", "asset", "custom", "contact"};
      if (part.type() != pugi::node_element || std::find(silent.begin(), silent.end(), kind) != silent.end()) continue;
      if (kind == "compiler") {
        read_compiler(part);
      } else if (kind == "option") {
        read_option(part);
      } else if (kind == "default") {
        read_class(part, "main", {});
      } else if (kind == "actuator" || kind == "sensor" || kind == "keyframe") {
        if (part.first_child()) left_out_.insert(fmt::format("{}s", kind));
      } else if (kind == "include") {
        xml_.fail(part, "include", "expected one file, found another that it includes; put both into one");
      } else if (kind == "extension" || kind == "deformable") {
        xml_.fail(part, std::string(kind), "expected rigid bodies without plugins, found this; leave it out");
      } else {
        xml_.fail(part, one_line(kind),
                  "expected a part of MJCF, found this" +
                      did_you_mean(std::string(kind), {"worldbody", "equality", "tendon", "compiler", "option",
                                                       "default", "actuator", "sensor"}));
      }
    }
  }

  bool flag(xml_node node, const char* attribute, bool otherwise) const {
    const std::string text = node.attribute(attribute).value();
    if (text.empty()) return otherwise;
    if (text != "true" && text != "false") {
      xml_.fail(node, item_of(node) + "." + attribute,
                fmt::format("expected true or false, found \"{}\"", one_line(text)));
    }
    return text == "true";
  }

  static std::string item_of(xml_node node) {
    const std::string name = one_line(node.attribute("name").value());
    return name.empty() ? one_line(node.name()) : fmt::format("{} \"{}\"", one_line(node.name()), name);
  }

  void read_compiler(xml_node node) {
    const std::string angle = node.attribute("angle").as_string("degree");
    if (angle != "degree" && angle != "radian") {
      xml_.fail(node, "compiler.angle", fmt::format("expected degree or radian, found \"{}\"", one_line(angle)));
    }
    if (node.attribute("angle")) angle_unit_ = angle == "radian" ? 1.0 : pi / 180.0;
    if (node.attribute("eulerseq")) euler_order_ = node.attribute("eulerseq").value();
    if (euler_order_.size() != 3 || euler_order_.find_first_not_of("xyzXYZ") != std::string::npos) {
      xml_.fail(node, "compiler.eulerseq",
                fmt::format("expected three of x, y, z, X, Y, Z, found \"{}\"", one_line(euler_order_)));
    }
    if (const std::string from = node.attribute("inertiafromgeom").value(); !from.empty()) {
      if (from != "auto" && from != "true" && from != "false") {
        xml_.fail(node, "compiler.inertiafromgeom",
                  fmt::format("expected auto, true or false, found \"{}\"", one_line(from)));
      }
      inertia_from_geoms_ = from;
    }
    has_auto_limits_ = flag(node, "autolimits", has_auto_limits_);
    if (node.attribute("inertiagrouprange")) {
      const std::vector<double> groups = xml_.numbers(node, "inertiagrouprange", "compiler", 2, {});
      groups_ = {groups[0], groups[1]};
    }
    if (std::string_view(node.attribute("coordinate").as_string("local")) != "local") {
      xml_.fail(node, "compiler.coordinate", "expected local, found another; save the file by MuJoCo 2.3.3");
    }
    for (const char* const bound : {"boundmass", "boundinertia"}) {
      if (xml_.number(node, bound, "compiler", 0.0) > 0.0) {
        xml_.fail(node, fmt::format("compiler.{}", bound),
                  "expected none, found a bound; write masses and inertias as they are");
      }
    }
    if (xml_.number(node, "settotalmass", "compiler", -1.0) > 0.0) {
      xml_.fail(node, "compiler.settotalmass", "expected none, found a mass; write masses and inertias as they are");
    }
  }

  void read_option(xml_node node) {
    model_.gravity = vector_of(node, "gravity", model_.gravity);
    if (xml_.number(node, "density", "option", 0.0) > 0.0 || xml_.number(node, "viscosity", "option", 0.0) > 0.0) {
      left_out_.insert("forces of the medium");
    }
    for (const xml_node flags : node.children("flag")) {
      for (const pugi::xml_attribute attribute : flags.attributes()) {
        if (std::string_view(attribute.value()) == "disable") disabled_.insert(attribute.name());
      }
    }
    if (!does_enable("gravity")) model_.gravity.setZero();
  }

  bool does_enable(const std::string& part) const { return disabled_.find(part) == disabled_.end(); }

  // ---- defaults

  // A class has what its parent has, and more.
  void read_class(xml_node node, const std::string& otherwise, std::map<std::string, Attributes> inherited) {
    const std::string name = node.attribute("class") ? one_line(node.attribute("class").value()) : otherwise;
    if (classes_.size() >= most_classes) xml_.fail(node, "default", "expected at most 1000 classes");
    for (const xml_node part : node.children()) {
      static constexpr std::array<std::string_view, 5> used = {"joint", "geom", "site", "equality", "tendon"};
      if (std::find(used.begin(), used.end(), part.name()) == used.end()) continue;
      Attributes& attributes = inherited[part.name()];
      for (const pugi::xml_attribute attribute : part.attributes()) {
        if (std::string_view(attribute.value()).size() > longest_default) {
          xml_.fail(part, "default",
                    fmt::format("expected at most {} characters of {}", longest_default, one_line(attribute.name())));
        }
        if (attributes.size() < most_defaults) attributes[attribute.name()] = attribute.value();
      }
    }
    classes_[name] = inherited;
    for (const xml_node part : node.children("default")) read_class(part, "", inherited);
  }

  // Gives an element the attributes that its class has and that it does not have itself. A place that is given in
  // another way takes the one of the class away.
  void complete(xml_node node, const std::string& of_parents, const char* as = nullptr) {
    const std::string name = node.attribute("class") ? one_line(node.attribute("class").value()) : of_parents;
    const auto found = classes_.find(name);
    if (found == classes_.end()) {
      if (name == "main") return;
      std::vector<std::string> known;
      for (const auto& [one, tables] : classes_) known.push_back(one);
      xml_.fail(node, item_of(node) + ".class",
                fmt::format("expected a class of <default>, found \"{}\"{}", name, did_you_mean_or_list(name, known)));
    }
    const auto table = found->second.find(as != nullptr ? as : node.name());
    if (table == found->second.end()) return;
    const auto is_turned = [](xml_node one) {
      return std::any_of(turns.begin(), turns.end(), [&](const char* key) { return one.attribute(key); });
    };
    const bool has_turn = is_turned(node), has_line = node.attribute("fromto");
    for (const auto& [key, value] : table->second) {
      if (node.attribute(key.c_str())) continue;
      const bool is_turn = std::find(turns.begin(), turns.end(), key) != turns.end();
      if (is_turn && (has_turn || has_line)) continue;
      if (key == "class") continue;
      node.append_attribute(key.c_str()) = value.c_str();
    }
  }

  // ---- places

  Matrix3d turn_of(xml_node node) const {
    const std::string item = item_of(node);
    const auto given = std::count_if(turns.begin(), turns.end(), [&](const char* key) { return node.attribute(key); });
    if (given > 1) xml_.fail(node, item, "expected one of quat, axisangle, xyaxes, zaxis, euler, found two");
    const auto has = [&](const char* key) { return static_cast<bool>(node.attribute(key)); };
    const auto direction = [&](const char* key, const Vector3d& v) {
      if (!(v.stableNorm() > 0.0)) xml_.fail(node, item + "." + key, "expected a direction, found 0 0 0");
      return Vector3d(v.stableNormalized());
    };
    if (has("quat")) {
      const std::vector<double> q = xml_.numbers(node, "quat", item, 4, {});
      Eigen::Vector4d all(q[0], q[1], q[2], q[3]);
      if (!(all.stableNorm() > 0.0)) xml_.fail(node, item + ".quat", "expected a turn, found 0 0 0 0");
      all.stableNormalize();
      return Eigen::Quaterniond(all[0], all[1], all[2], all[3]).toRotationMatrix();
    }
    if (has("axisangle")) {
      const std::vector<double> a = xml_.numbers(node, "axisangle", item, 4, {});
      return Eigen::AngleAxisd(a[3] * angle_unit_, direction("axisangle", {a[0], a[1], a[2]})).toRotationMatrix();
    }
    if (has("xyaxes")) {
      const std::vector<double> a = xml_.numbers(node, "xyaxes", item, 6, {});
      const Vector3d x = direction("xyaxes", {a[0], a[1], a[2]}), y(a[3], a[4], a[5]);
      Matrix3d out;
      out.col(0) = x;
      out.col(1) = direction("xyaxes", y - x.dot(y) * x);
      out.col(2) = x.cross(out.col(1));
      return out;
    }
    if (has("zaxis")) {
      const std::vector<double> a = xml_.numbers(node, "zaxis", item, 3, {});
      return z_to(direction("zaxis", {a[0], a[1], a[2]}));
    }
    if (has("euler")) {
      const std::vector<double> angles = xml_.numbers(node, "euler", item, 3, {});
      Matrix3d out = Matrix3d::Identity();
      for (std::size_t k = 0; k < 3; ++k) {
        const char letter = euler_order_[k];
        const bool moves = letter >= 'a';
        const Vector3d axis = Vector3d::Unit(moves ? letter - 'x' : letter - 'X');
        const Matrix3d one = Eigen::AngleAxisd(angles[k] * angle_unit_, axis).toRotationMatrix();
        out = moves ? Matrix3d(out * one) : Matrix3d(one * out);
      }
      return out;
    }
    return Matrix3d::Identity();
  }

  // The least turn that takes z to a direction.
  static Matrix3d z_to(const Vector3d& direction) {
    return Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), direction).toRotationMatrix();
  }

  Vector3d vector_of(xml_node node, const char* attribute, const Vector3d& otherwise = Vector3d::Zero()) const {
    const std::vector<double> v =
        xml_.numbers(node, attribute, item_of(node), 3, {otherwise.x(), otherwise.y(), otherwise.z()});
    return {v[0], v[1], v[2]};
  }

  Frame frame_of(xml_node node) const {
    Frame frame = Frame::Identity();
    frame.linear() = turn_of(node);
    frame.translation() = vector_of(node, "pos");
    return frame;
  }

  // ---- bodies

  void read_content(xml_node holder, int body, const Frame& frame, const std::string& of_parents, Content& content) {
    for (const xml_node node : holder.children()) {
      const std::string_view kind = node.name();
      if (kind == "body") {
        read_body(node, body, frame, of_parents);
      } else if (kind == "frame") {
        const std::string own =
            node.attribute("childclass") ? one_line(node.attribute("childclass").value()) : of_parents;
        read_content(node, body, frame * frame_of(node), own, content);
      } else if (kind == "joint" || kind == "freejoint") {
        if (body == 0) xml_.fail(node, item_of(node), "expected a joint of a body, found one of the world");
        if (kind == "joint") complete(node, of_parents);
        read_joint(node, frame, content);
      } else if (kind == "inertial") {
        content.inertial = read_inertial(node, frame);
      } else if (kind == "geom") {
        if (++geoms_ > most_items) xml_.fail(node, "geom", "expected at most 10000 geoms");
        complete(node, of_parents);
        geoms_of_[body].emplace_back(node, frame);
        note_contact(node);
      } else if (kind == "site") {
        complete(node, of_parents);
        const Vector3d at = frame * vector_of(node, "pos");
        if (const std::string name = one_line(node.attribute("name").value()); !name.empty()) {
          if (!sites_.emplace(name, std::pair(body, at)).second) twice(node);
          if (sites_.size() > most_items) xml_.fail(node, "site", "expected at most 10000 sites");
          const std::string of_body = model_.bodies[static_cast<std::size_t>(body)].name + ".";
          points_of_[body].emplace_back(name.starts_with(of_body) ? name.substr(of_body.size()) : name, at);
        }
      } else if (kind == "composite" || kind == "flexcomp" || kind == "replicate" || kind == "attach" ||
                 kind == "plugin") {
        xml_.fail(node, std::string(kind), "expected bodies as they are, found a part that makes some; write them out");
      } else if (node.type() == pugi::node_element && kind != "camera" && kind != "light") {
        xml_.fail(
            node, one_line(kind),
            "expected body, joint, geom, site or inertial, found this" +
                did_you_mean(std::string(kind), {"body", "joint", "freejoint", "geom", "site", "inertial", "frame"}));
      }
    }
  }

  [[noreturn]] void twice(xml_node node) const {
    xml_.fail(node, item_of(node), "expected a name of its own, it is there twice");
  }

  void read_body(xml_node node, int parent, const Frame& of_parent, const std::string& of_parents) {
    const int index = static_cast<int>(model_.bodies.size());
    if (model_.bodies.size() > most_items) xml_.fail(node, "body", "expected at most 10000 bodies");
    const Frame frame = of_parent * frame_of(node);
    std::string name = one_line(trimmed(node.attribute("name").value()));
    if (name.empty()) name = fmt::format("body {}", index);
    if (!body_places_.emplace(name, index).second) twice(node);
    if (xml_.number(node, "gravcomp", item_of(node), 0.0) != 0.0) {
      xml_.fail(node, item_of(node) + ".gravcomp",
                "expected a body that gravity acts on, found one that it is taken from");
    }
    model_.bodies.push_back(
        {.name = name == "ground" ? "ground body" : name, .line = xml_.line_of(node), .parent = parent});
    model_.bodies.back().at = frame.translation();
    frames_.push_back(frame);
    const std::string own = node.attribute("childclass") ? one_line(node.attribute("childclass").value()) : of_parents;
    Content content;
    read_content(node, index, frame, own, content);
    SpatialBody& body = model_.bodies[static_cast<std::size_t>(index)];
    body.joints = content.joints;
    body.is_free = content.is_free;
    if (content.is_free && (!body.joints.empty() || parent != 0)) {
      fail_at(model_.file, content.free_line, item_of(node), "expected a free body in the world without other joints");
    }
    body.points = points_of_[index];
    const bool from_geoms = inertia_from_geoms_ == "true" || (inertia_from_geoms_ == "auto" && !content.inertial);
    SolidMass inertia = content.inertial.value_or(SolidMass{});
    if (from_geoms) {
      inertia = {};
      for (const auto& [geom, around] : geoms_of_[index]) inertia.add(read_geom(geom, around));
    }
    geoms_of_.erase(index);
    body.mass = inertia.mass;
    body.center = inertia.center;
    body.inertia = inertia.about_center;
    if (std::string_view(node.attribute("mocap").as_string("false")) == "true") {
      model_.notes.push_back(fmt::format("Body \"{}\", which a program moves, stands still.", body.name));
    }
  }

  double not_negative(xml_node node, const char* attribute, double otherwise = 0.0) const {
    const double value = xml_.number(node, attribute, item_of(node), otherwise);
    if (value < 0.0) xml_.fail(node, item_of(node) + "." + attribute, out_of_range(Range::not_negative, value));
    return value;
  }

  void read_joint(xml_node node, const Frame& frame, Content& content) {
    const std::string item = item_of(node);
    const std::string type =
        std::string_view(node.name()) == "freejoint" ? "free" : node.attribute("type").as_string("hinge");
    if (type == "free") {
      content.is_free = true;
      content.free_line = xml_.line_of(node);
      model_.notes.push_back(
          fmt::format("A free body moves and turns freely in the plane, and stays in it: line {}.", content.free_line));
      return;
    }
    if (type != "hinge" && type != "slide") {
      xml_.fail(node, item + ".type",
                fmt::format("expected hinge, slide or free, found \"{}\"; Poise models planar "
                            "mechanisms",
                            one_line(type)));
    }
    if (model_.joints.size() >= most_items) xml_.fail(node, item, "expected at most 10000 joints");
    SpatialJoint joint;
    joint.line = xml_.line_of(node);
    joint.slides = type == "slide";
    joint.name = one_line(trimmed(node.attribute("name").value()));
    const int index = static_cast<int>(model_.joints.size());
    if (!joint.name.empty() && !joint_places_.emplace(joint.name, index).second) twice(node);
    const Vector3d axis = vector_of(node, "axis", Vector3d::UnitZ());
    if (!(axis.stableNorm() > 0.0)) xml_.fail(node, item + ".axis", "expected a direction, found 0 0 0");
    joint.axis = frame.linear() * axis.stableNormalized();
    joint.at = frame * vector_of(node, "pos");
    const double unit = joint.slides ? 1.0 : angle_unit_;
    joint.reference = unit * xml_.number(node, "ref", item, 0.0);
    joint.stiffness = not_negative(node, "stiffness");
    joint.spring_reference = unit * xml_.number(node, "springref", item, 0.0);
    joint.damping = not_negative(node, "damping");
    joint.armature = not_negative(node, "armature");
    joint.friction = does_enable("frictionloss") ? not_negative(node, "frictionloss") : 0.0;
    const std::vector<double> makes_both = xml_.numbers(node, "springdamper", item, 2, {0.0, 0.0});
    if (makes_both[0] > 0.0 || makes_both[1] > 0.0) {
      xml_.fail(node, item + ".springdamper", "expected stiffness and damping, found the times that they follow from");
    }
    read_limits(node, unit, joint.lower, joint.upper);
    content.joints.push_back(index);
    model_.joints.push_back(std::move(joint));
  }

  void read_limits(xml_node node, double unit, double& lower, double& upper) const {
    const std::string limited = node.attribute("limited").as_string("auto");
    if (limited != "auto" && limited != "true" && limited != "false") {
      xml_.fail(node, item_of(node) + ".limited",
                fmt::format("expected auto, true or false, found \"{}\"", one_line(limited)));
    }
    const bool is_limited = limited == "true" || (limited == "auto" && has_auto_limits_ && node.attribute("range"));
    if (!is_limited || !does_enable("limit")) return;
    const std::vector<double> range = xml_.numbers(node, "range", item_of(node), 2, {0.0, 0.0});
    if (!(range[0] < range[1])) {
      xml_.fail(node, item_of(node) + ".range",
                fmt::format("expected two ascending limits, found {} and {}", range[0], range[1]));
    }
    lower = SpatialModel::lower_limit(unit * range[0]);
    upper = SpatialModel::upper_limit(unit * range[1]);
  }

  SolidMass read_inertial(xml_node node, const Frame& frame) const {
    SolidMass out;
    out.mass = xml_.number(node, "mass", "inertial");
    if (out.mass < 0.0) xml_.fail(node, "inertial.mass", out_of_range(Range::not_negative, out.mass));
    const Frame own = frame * frame_of(node);
    out.center = own.translation();
    Matrix3d inertia = Matrix3d::Zero();
    if (node.attribute("fullinertia")) {
      const std::vector<double> v = xml_.numbers(node, "fullinertia", "inertial", 6, {});
      inertia << v[0], v[3], v[4], v[3], v[1], v[5], v[4], v[5], v[2];
    } else {
      inertia.diagonal() = vector_of(node, "diaginertia");
    }
    out.about_center = own.linear() * inertia * own.linear().transpose();
    return out;
  }

  void note_contact(xml_node geom) {
    const auto collides = [&](const char* key) { return std::string_view(geom.attribute(key).as_string("1")) != "0"; };
    has_contacts_ = has_contacts_ || collides("contype") || collides("conaffinity");
  }

  SolidMass read_geom(xml_node node, const Frame& frame) const {
    const std::string item = item_of(node);
    const double group = xml_.number(node, "group", item, 0.0);
    if (group < groups_[0] || group > groups_[1]) return {};
    const double density = not_negative(node, "density", 1000.0);
    const bool has_mass = node.attribute("mass");
    const double mass = not_negative(node, "mass");
    const std::string type = node.attribute("type")   ? node.attribute("type").value()
                             : node.attribute("mesh") ? "mesh"
                                                      : "sphere";
    if (type == "plane" || type == "hfield" || (has_mass ? mass : density) == 0.0) return {};
    Frame own = Frame::Identity();
    const Solid solid = solid_of(node, type, own);
    SolidMass out;
    out.mass = has_mass ? mass : density * solid.volume;
    own = frame * own;
    out.center = own.translation();
    out.about_center = out.mass * own.linear() * solid.moments.asDiagonal() * own.linear().transpose();
    return out;
  }

  // The frame of a solid that is given by its ends is between them, with z along it.
  Solid solid_of(xml_node node, const std::string& type, Frame& frame) const {
    const std::string item = item_of(node);
    const std::string shell = node.attribute("shellinertia").as_string("false");
    if (shell == "true")
      xml_.fail(node, item + ".shellinertia", "expected a solid, found a shell; give its body an inertial");
    std::vector<double> size = xml_.numbers_up_to(node, "size", item, 1, 3);
    const std::vector<double> ends = xml_.numbers_up_to(node, "fromto", item, 6, 6);
    static const std::map<std::string, std::size_t> needed = {
        {"sphere", 1}, {"capsule", 2}, {"cylinder", 2}, {"box", 3}, {"ellipsoid", 3}};
    const auto kind = needed.find(type);
    if (kind == needed.end()) {
      xml_.fail(node, item + ".type",
                fmt::format("expected sphere, capsule, cylinder, box or ellipsoid, found \"{}\", "
                            "whose mass is not known here; give its body an inertial",
                            one_line(type)));
    }
    if (!ends.empty() && type != "sphere") {
      const Vector3d from(ends[0], ends[1], ends[2]), to(ends[3], ends[4], ends[5]);
      const double half = (to - from).stableNorm() / 2.0;
      if (!(half > 0.0)) xml_.fail(node, item + ".fromto", "expected two ends, found the same place twice");
      size.resize(1);
      if (kind->second == 3) size.push_back(size[0]);
      size.push_back(half);
      frame.linear() = z_to((to - from).stableNormalized());
      frame.translation() = (from + to) / 2.0;
    } else {
      frame = frame_of(node);
    }
    if (size.size() < kind->second || std::any_of(size.begin(), size.end(), [](double s) { return !(s >= 0.0); }) ||
        size.empty() || !(size[0] > 0.0)) {
      xml_.fail(node, item + ".size",
                fmt::format("expected {} size{} > 0 of a {}", kind->second, kind->second == 1 ? "" : "s", type));
    }
    if (type == "sphere") return sphere(size[0]);
    if (type == "capsule") return capsule(size[0], size[1]);
    if (type == "cylinder") return cylinder(size[0], size[1]);
    const Vector3d all(size[0], size[1], size[2]);
    return type == "box" ? box(all) : ellipsoid(all);
  }

  // ---- what ties bodies and joints

  template <class Places>
  auto& named(xml_node node, const char* attribute, Places& places) const {
    const std::string name = xml_.word(node, attribute, item_of(node));
    const auto found = places.find(name);
    if (found == places.end()) {
      std::vector<std::string> known;
      for (const auto& [one, place] : places) known.push_back(one);
      xml_.fail(node, item_of(node) + "." + attribute,
                fmt::format("expected a name that is there, found \"{}\"{}", name, did_you_mean_or_list(name, known)));
    }
    return found->second;
  }

  int tendon_named(xml_node node, const char* attribute) const { return named(node, attribute, tendon_places_); }

  void read_equality(xml_node node) {
    if (node.type() != pugi::node_element) return;
    complete(node, "main", "equality");
    const std::string kind = node.name(), item = item_of(node);
    if (!flag(node, "active", true)) {
      left_out_.insert("equalities that are not active");
      return;
    }
    if (kind == "connect" || kind == "weld") return read_closure(node, kind == "weld");
    if (kind == "joint") return read_joint_equality(node);
    if (kind == "tendon") return read_tendon_equality(node);
    xml_.fail(node, item, fmt::format("expected connect, weld, joint or tendon, found \"{}\"", one_line(kind)));
  }

  void read_closure(xml_node node, bool is_fixed) {
    const std::string item = item_of(node);
    SpatialClosure closure;
    closure.name = one_line(trimmed(node.attribute("name").value()));
    if (closure.name.empty()) closure.name = fmt::format("{} {}", node.name(), model_.closures.size() + 1);
    closure.line = xml_.line_of(node);
    closure.is_fixed = is_fixed;
    if (node.attribute("site1")) {
      const auto& [a, at_a] = named(node, "site1", sites_);
      const auto& [b, at_b] = named(node, "site2", sites_);
      closure.a = a;
      closure.b = b;
      closure.at_a = at_a;
      closure.at_b = at_b;
    } else {
      closure.a = named(node, "body1", body_places_);
      closure.b = node.attribute("body2") ? named(node, "body2", body_places_) : 0;
      const Frame& a = frames_[static_cast<std::size_t>(closure.a)];
      const Frame& b = frames_[static_cast<std::size_t>(closure.b)];
      if (is_fixed) {
        closure.at_a = closure.at_b = b.translation();
        read_relative_pose(node, a, b, closure);
      } else {
        if (!node.attribute("anchor")) xml_.fail(node, item, "expected the attribute anchor, found none");
        closure.at_a = closure.at_b = a * vector_of(node, "anchor");
      }
    }
    if (closure.a == closure.b) xml_.fail(node, item, "expected two bodies that differ");
    if (model_.closures.size() >= most_items) xml_.fail(node, item, "expected at most 10000 equalities");
    model_.closures.push_back(std::move(closure));
  }

  // Position and quaternion of the second body in the first; a quaternion of zeros means as they are.
  void read_relative_pose(xml_node node, const Frame& a, const Frame& b, SpatialClosure& closure) const {
    const std::vector<double> pose = xml_.numbers(node, "relpose", item_of(node), 7, {0, 0, 0, 0, 0, 0, 0});
    Eigen::Vector4d turn(pose[3], pose[4], pose[5], pose[6]);
    if (!(turn.stableNorm() > 0.0)) return;
    turn.stableNormalize();
    closure.at_a = a * Vector3d(pose[0], pose[1], pose[2]);
    closure.turn =
        a.linear() * Eigen::Quaterniond(turn[0], turn[1], turn[2], turn[3]).toRotationMatrix() * b.linear().transpose();
  }

  // The result is the constant and the slope of a polynomial that is a straight line.
  std::array<double, 2> line_of_polynomial(xml_node node) const {
    std::vector<double> c = xml_.numbers_up_to(node, "polycoef", item_of(node), 1, 5);
    if (c.empty()) c = {0.0, 1.0};
    for (std::size_t k = 2; k < c.size(); ++k) {
      if (c[k] != 0.0) xml_.fail(node, item_of(node) + ".polycoef", "expected a straight line, found a curve");
    }
    return {c[0], c.size() > 1 ? c[1] : 0.0};
  }

  void read_joint_equality(xml_node node) {
    const std::array<double, 2> line = line_of_polynomial(node);
    SpatialTendon tendon;
    tendon.name = one_line(trimmed(node.attribute("name").value()));
    if (tendon.name.empty()) tendon.name = fmt::format("coupling {}", model_.tendons.size() + 1);
    tendon.line = xml_.line_of(node);
    const int first = named(node, "joint1", joint_places_);
    double value = model_.joints[static_cast<std::size_t>(first)].reference + line[0];
    tendon.terms = {{first, 1.0}};
    if (node.attribute("joint2") && line[1] != 0.0) {
      const int second = named(node, "joint2", joint_places_);
      if (first == second) xml_.fail(node, item_of(node), "expected two joints that differ");
      tendon.terms.emplace_back(second, -line[1]);
      value -= line[1] * model_.joints[static_cast<std::size_t>(second)].reference;
    }
    tendon.lower = tendon.upper = value;
    model_.tendons.push_back(std::move(tendon));
  }

  // Lengths of tendons count from those in the pose that is drawn.
  void read_tendon_equality(xml_node node) {
    const std::array<double, 2> line = line_of_polynomial(node);
    SpatialTendon held = tendons_[static_cast<std::size_t>(tendon_named(node, "tendon1"))];
    double value = length_as_drawn(held) + line[0];
    if (node.attribute("tendon2") && line[1] != 0.0) {
      const SpatialTendon& other = tendons_[static_cast<std::size_t>(tendon_named(node, "tendon2"))];
      if (!held.points.empty() || !other.points.empty()) {
        xml_.fail(node, item_of(node), "expected two fixed tendons, found a spatial one");
      }
      for (const auto& [joint, factor] : other.terms) add_term(held.terms, joint, -line[1] * factor);
      value -= line[1] * length_as_drawn(other);
    }
    if (held.points.size() > 2) xml_.fail(node, item_of(node), "expected a tendon with two sites, found more");
    if (!held.points.empty() && !(value > 0.0)) xml_.fail(node, item_of(node), "expected a length > 0");
    SpatialTendon tendon;
    tendon.name = one_line(trimmed(node.attribute("name").value()));
    if (tendon.name.empty()) tendon.name = held.name + " held";
    tendon.line = xml_.line_of(node);
    tendon.terms = held.terms;
    tendon.points = held.points;
    tendon.lower = tendon.upper = value;
    model_.tendons.push_back(std::move(tendon));
  }

  static void add_term(std::vector<std::pair<int, double>>& terms, int joint, double factor) {
    const auto found = std::find_if(terms.begin(), terms.end(), [&](const auto& term) { return term.first == joint; });
    if (found == terms.end())
      terms.emplace_back(joint, factor);
    else
      found->second += factor;
  }

  double length_as_drawn(const SpatialTendon& tendon) const {
    double out = 0.0;
    for (const auto& [joint, factor] : tendon.terms)
      out += factor * model_.joints[static_cast<std::size_t>(joint)].reference;
    for (std::size_t k = 1; k < tendon.points.size(); ++k) {
      out += (tendon.points[k].second - tendon.points[k - 1].second).norm();
    }
    return out;
  }

  void read_tendon(xml_node node) {
    if (node.type() != pugi::node_element) return;
    complete(node, "main", "tendon");
    const std::string kind = node.name(), item = item_of(node);
    if (kind != "spatial" && kind != "fixed") {
      xml_.fail(node, item, fmt::format("expected spatial or fixed, found \"{}\"", one_line(kind)));
    }
    if (tendons_.size() >= most_items) xml_.fail(node, item, "expected at most 10000 tendons");
    SpatialTendon tendon;
    tendon.line = xml_.line_of(node);
    tendon.name = one_line(trimmed(node.attribute("name").value()));
    if (tendon.name.empty()) tendon.name = fmt::format("tendon {}", tendons_.size() + 1);
    if (!tendon_places_.emplace(tendon.name, static_cast<int>(tendons_.size())).second) twice(node);
    if (tendon_parts_ += static_cast<std::size_t>(std::distance(node.begin(), node.end()));
        tendon_parts_ > most_items) {
      xml_.fail(node, item, "expected at most 10000 parts of tendons");
    }
    for (const xml_node part : node.children()) {
      const std::string_view what = part.name();
      if (kind == "fixed" && what == "joint") {
        add_term(tendon.terms, named(part, "joint", joint_places_), xml_.number(part, "coef", item));
      } else if (kind == "spatial" && what == "site") {
        tendon.points.push_back(named(part, "site", sites_));
      } else if (part.type() == pugi::node_element) {
        xml_.fail(part, item,
                  fmt::format("expected {}, found \"{}\"; a way over a pulley or round a geom is not taken",
                              kind == "fixed" ? "joints" : "sites", one_line(what)));
      }
    }
    std::erase_if(tendon.terms, [](const auto& term) { return term.second == 0.0; });
    if (tendon.terms.empty() && tendon.points.size() < 2) {
      xml_.fail(node, item, kind == "fixed" ? "expected a joint with a coef that is not 0" : "expected two sites");
    }
    if (xml_.number(node, "armature", item, 0.0) != 0.0) {
      xml_.fail(node, item + ".armature", "expected a tendon without inertia, found an armature");
    }
    const bool is_passive = does_enable("passive");
    tendon.stiffness = is_passive ? not_negative(node, "stiffness") : 0.0;
    tendon.damping = is_passive ? not_negative(node, "damping") : 0.0;
    tendon.friction = does_enable("frictionloss") ? not_negative(node, "frictionloss") : 0.0;
    read_limits(node, 1.0, tendon.lower, tendon.upper);
    read_free_length(node, tendon);
    tendons_.push_back(std::move(tendon));
  }

  // Left out, or -1, it is the length with all joints at their own springref.
  void read_free_length(xml_node node, SpatialTendon& tendon) const {
    const std::vector<double> given = xml_.numbers_up_to(node, "springlength", item_of(node), 1, 2);
    if (!given.empty() && given[0] != -1.0) {
      tendon.slack_from = given[0];
      tendon.slack_to = given.back();
      if (tendon.slack_from > tendon.slack_to) {
        xml_.fail(node, item_of(node) + ".springlength", "expected two ascending lengths");
      }
      return;
    }
    double length = 0.0;
    for (const auto& [joint, factor] : tendon.terms) {
      length += factor * model_.joints[static_cast<std::size_t>(joint)].spring_reference;
    }
    if (!tendon.points.empty()) {
      const bool is_as_drawn = std::all_of(model_.joints.begin(), model_.joints.end(), [](const SpatialJoint& joint) {
        return joint.spring_reference == joint.reference;
      });
      if (!is_as_drawn && tendon.stiffness > 0.0) {
        xml_.fail(node, item_of(node),
                  "expected the attribute springlength, found none, while joints have a springref");
      }
      length = length_as_drawn(tendon);
    }
    tendon.slack_from = tendon.slack_to = length;
  }

  void add_tendon(SpatialTendon& tendon) {
    const bool acts = tendon.stiffness > 0.0 || tendon.damping > 0.0 || tendon.friction > 0.0 ||
                      std::isfinite(tendon.lower) || std::isfinite(tendon.upper);
    if (acts) model_.tendons.push_back(std::move(tendon));
  }

  void add_notes() {
    if (has_contacts_) left_out_.insert("contacts between geoms");
    if (!left_out_.empty()) model_.notes.push_back(fmt::format("Left out: {}.", fmt::join(left_out_, ", ")));
  }

  static constexpr std::size_t most_classes = 1000, longest_default = 100, most_defaults = 40;
  static constexpr std::array<const char*, 5> turns = {"quat", "axisangle", "xyaxes", "zaxis", "euler"};

  Xml xml_;
  xml_node root_;
  SpatialModel model_;
  double angle_unit_ = pi / 180.0;
  std::string euler_order_ = "xyz", inertia_from_geoms_ = "auto";
  bool has_auto_limits_ = true, has_contacts_ = false;
  std::array<double, 2> groups_{0.0, 5.0};
  std::set<std::string> disabled_, left_out_;
  std::map<std::string, std::map<std::string, Attributes>> classes_;
  std::vector<Frame> frames_;  // of the bodies
  std::map<std::string, int> body_places_, joint_places_, tendon_places_;
  std::map<std::string, std::pair<int, Vector3d>> sites_;
  std::map<int, std::vector<std::pair<std::string, Vector3d>>> points_of_;
  std::map<int, std::vector<std::pair<xml_node, Frame>>> geoms_of_;
  std::vector<SpatialTendon> tendons_;
  std::size_t geoms_ = 0, tendon_parts_ = 0;
};

}  // namespace

Imported import_mjcf(std::string_view text, const std::string& file, const ImportOptions& options) {
  expect_si("MJCF", options);
  return planar_scene(MjcfReader(text, file).model());
}

}  // namespace poise
