#include "exchange/pmks_address.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_map>
#include <unordered_set>

#include <fmt/format.h>

#include "exchange/private/drawn_scene.hpp"
#include "exchange/private/pmks_words.hpp"
#include "exchange/private/posed_links.hpp"
#include "exchange/private/reading.hpp"
#include "model/one_line.hpp"

namespace poise {
namespace {

constexpr double weight_of_one = 9.81;  // m/s^2

// Reading.

/// What is behind the question mark of the address in a text, with characters that were written as %2C read back.
std::string query_in(std::string_view text, const std::string& file) {
  std::string_view address;
  for (const std::string_view line : lines_of(text)) {
    const std::string_view word = trimmed(line);
    if (in_small_letters(word.substr(0, 4)) == "url=") {
      address = word.substr(4);
      break;
    }
    if (word.empty() || word.front() == '[') continue;
    if (!address.empty()) fail_at(file, 2, "address", "expected one line, the address of a mechanism");
    address = word;
  }
  const std::size_t question = address.find('?');
  if (question != std::string_view::npos) address.remove_prefix(question + 1);
  std::string out;
  for (std::size_t i = 0; i < address.size(); ++i) {
    const std::string_view code = address.substr(i, 3);
    if (in_small_letters(code) == "%2c") {
      out += ',';
      i += 2;
    } else {
      out += address[i];
    }
  }
  return out;
}

struct UnitsOfPmks {
  std::string length;   // of Poise
  double factor = 1.0;  // length units of Poise in one of PMKS+
  double si = 1.0;      // of the unit of Poise
  std::string force, mass;
};

UnitsOfPmks units_of_pmks(PmksMechanism::Length length) {
  switch (length) {
    case PmksMechanism::Length::inch:
      return {"in", 1.0, 0.0254, "lbf", "lb"};
    case PmksMechanism::Length::cm:
      return {"mm", 10.0, 0.001, "N", "kg"};
    case PmksMechanism::Length::m:
      break;
  }
  return {"m", 1.0, 1.0, "N", "kg"};
}

/// An angle that was rounded to 0.001 rad, in degrees: the multiple of 15 that it was, if it was one.
double degrees_of_rounded(double angle, bool& is_restored) {
  constexpr double rounding = 0.000501, step = 15.0;
  const double degrees = angle * 180 / std::numbers::pi;
  const double nearest = std::round(degrees / step) * step;
  if (std::abs(nearest * std::numbers::pi / 180 - angle) > rounding) return degrees;
  is_restored = is_restored || nearest != degrees;
  return nearest;
}

class PmksImport {
 public:
  PmksImport(const PmksMechanism& mechanism, const std::string& file)
      : pmks_(mechanism),
        file_(file),
        units_(units_of_pmks(mechanism.length)),
        scene_(file, {.length = units_.length, .force = units_.force, .mass = units_.mass}) {}

  Imported scene() {
    name_all();
    for (const PmksLink& link : pmks_.links) {
      if (link.is_root) add_link(link);
    }
    for (const PmksJoint& joint : pmks_.joints) {
      if (joint.slides) {
        add_slider(joint);
      } else {
        add_pin(joint);
      }
    }
    for (const PmksForce& force : pmks_.forces) add_force(force);
    if (pmks_.has_gravity) {
      scene_.set_gravity({0.0, -weight_of_one / units_.si});
      scene_.add_note("Gravity is on in the address: 9.81 m/s^2 downward.");
    }
    add_notes();
    return scene_.finish();
  }

 private:
  [[noreturn]] void fail(const std::string& item, const std::string& message) const {
    fail_at(file_, 1, item, message);
  }
  Vec2 at(double x, double y) const { return {units_.factor * x, units_.factor * y}; }

  /// Joints and links by their ids; names that are taken already get a number.
  void name_all() {
    for (const PmksJoint& joint : pmks_.joints) {
      if (!joints_.emplace(joint.id, &joint).second) {
        fail(fmt::format("joint \"{}\"", one_line(joint.id)), "expected one joint of this id, found two");
      }
      point_names_[joint.id] = name_beside(joint.name.empty() ? joint.id : joint.name, points_);
    }
    std::unordered_set<std::string> taken = {"ground"};
    for (const PmksLink& link : pmks_.links) {
      if (!links_.emplace(link.id, &link).second) {
        fail(fmt::format("link \"{}\"", one_line(link.id)), "expected one link of this id, found two");
      }
      if (link.is_root) link_names_[link.id] = name_beside(link.name.empty() ? link.id : link.name, taken);
    }
    for (const PmksLink& link : pmks_.links) {
      for (const std::string& part : link.parts) root_of_part_.emplace(part, link.id);
    }
  }

  const PmksJoint& joint_of(const std::string& id, const std::string& item) const {
    const auto found = joints_.find(id);
    if (found == joints_.end()) fail(item, fmt::format("expected the id of a joint, found \"{}\"", one_line(id)));
    return *found->second;
  }

  void add_link(const PmksLink& link) {
    const std::string item = fmt::format("link \"{}\"", one_line(link.id)), name = link_names_.at(link.id);
    if (link.joints.empty()) fail(item, "expected its joints, found none");
    scene_.add_link(name);
    std::unordered_set<std::string> own;
    for (const std::string& id : link.joints) {
      const PmksJoint& joint = joint_of(id, item);
      if (!own.insert(id).second) continue;
      scene_.add_point(name, point_names_.at(id), at(joint.x, joint.y));
      links_at_[id].push_back(&link);
    }
    const double square = units_.factor * units_.factor;
    scene_.set_mass(name, {link.mass, square * link.inertia, centre_of(link)});
  }

  /// The centre of mass; a block has its own joint for one.
  Vec2 centre_of(const PmksLink& link) const {
    if (link.mass == 0.0) return {};
    if (!link.is_block) return at(link.x, link.y);
    const PmksJoint& joint = *joints_.at(link.joints.front());
    return at(joint.x, joint.y);
  }

  void add_ground_point(const PmksJoint& joint) {
    scene_.add_point("ground", point_names_.at(joint.id), at(joint.x, joint.y));
  }

  void add_joint(Joint::Kind kind, const std::string& a, const PmksLink& b, const PmksJoint& joint, double degrees) {
    const std::string point = point_names_.at(joint.id);
    scene_.add_joint({kind, {a, point}, {link_names_.at(b.id), point}, axis_at(degrees)});
  }

  /// A joint that turns: all links through it, and the ground, are pinned together, or welded where it is welded and no
  /// link has its parts in one already.
  void add_pin(const PmksJoint& joint) {
    const std::vector<const PmksLink*>& links = links_at_[joint.id];
    if (links.empty()) return;
    const bool has_parts =
        std::any_of(links.begin(), links.end(), [](const auto* link) { return !link->parts.empty(); });
    const bool is_welded = joint.is_welded && !has_parts;
    if (joint.is_grounded) {
      add_ground_point(joint);
      for (const PmksLink* link : links) {
        if (is_welded && link != links.front()) continue;
        add_joint(Joint::Kind::pin, "ground", *link, joint, 0.0);
      }
      add_input(joint, *links.front());
    }
    if (joint.is_grounded && !is_welded) return;
    for (std::size_t k = 1; k < links.size(); ++k) {
      add_joint(is_welded ? Joint::Kind::weld : Joint::Kind::pin, link_names_.at(links.front()->id), *links[k], joint,
                0.0);
    }
  }

  void add_input(const PmksJoint& joint, const PmksLink& link) {
    if (!joint.is_input) return;
    const double rate = static_cast<double>(pmks_.speed) * degrees_per_second * (pmks_.is_clockwise ? -1 : 1);
    if (!driven_.insert(link.id).second) return;
    scene_.add_drive(link_names_.at(link.id), rate);
    scene_.add_note(fmt::format("The input {} drives {} at {:g} deg/s in motion; in equilibria it is free.",
                                point_names_.at(joint.id), link_names_.at(link.id), rate));
  }

  void add_slider(const PmksJoint& joint) {
    const std::string item = fmt::format("joint \"{}\"", one_line(joint.id));
    const std::vector<const PmksLink*>& links = links_at_[joint.id];
    if (links.empty()) return;
    if (joint.is_input) {
      scene_.add_note(fmt::format("The slider {} is an input, of a speed that is not taken: here it is free.",
                                  point_names_.at(joint.id)));
    }
    if (!joint.carrier.empty()) return add_slot(joint, item, links);
    const double degrees = degrees_of_rounded(joint.angle, has_restored_angle_);
    if (joint.is_grounded) {
      add_ground_point(joint);
      for (const PmksLink* link : links) add_joint(Joint::Kind::slide, "ground", *link, joint, degrees);
      return;
    }
    if (links.size() != 2) {
      fail(item, fmt::format("expected a slider between two links, or on the ground, found {}", links.size()));
    }
    add_joint(Joint::Kind::slide, link_names_.at(links[0]->id), *links[1], joint, degrees);
  }

  /// A slider in a slot of a link that moves, along two of its joints.
  void add_slot(const PmksJoint& joint, const std::string& item, const std::vector<const PmksLink*>& links) {
    const PmksJoint &from = joint_of(joint.from, item), &to = joint_of(joint.to, item);
    const auto part = root_of_part_.find(joint.carrier);
    const auto carrier = link_names_.find(part == root_of_part_.end() ? joint.carrier : part->second);
    if (carrier == link_names_.end()) {
      fail(item, fmt::format("expected the id of the link with the slot, found \"{}\"", one_line(joint.carrier)));
    }
    const Vec2 along{to.x - from.x, to.y - from.y};
    if (norm(along) == 0.0) fail(item, "expected two joints along the slot that are apart");
    const std::vector<const PmksLink*>& there = links_at_[joint.id];
    if (std::none_of(there.begin(), there.end(), [&](const auto* link) { return link->id == carrier->first; })) {
      scene_.add_point(carrier->second, point_names_.at(joint.id), at(joint.x, joint.y));
    }
    for (const PmksLink* link : links) {
      if (link->id == carrier->first) continue;
      const std::string point = point_names_.at(joint.id);
      scene_.add_joint({Joint::Kind::slide, {carrier->second, point}, {link_names_.at(link->id), point}, along});
    }
  }

  void add_force(const PmksForce& force) {
    const std::string item = fmt::format("force \"{}\"", one_line(force.id));
    const auto part = root_of_part_.find(force.link);
    const auto link = link_names_.find(part == root_of_part_.end() ? force.link : part->second);
    if (link == link_names_.end()) {
      fail(item, fmt::format("expected the id of a link, found \"{}\"", one_line(force.link)));
    }
    const Vec2 arrow{force.to_x - force.x, force.to_y - force.y};
    if (norm(arrow) == 0.0) fail(item, "expected an arrow with two ends that are apart");
    const Vec2 vector = (force.size / norm(arrow) * (force.is_outward ? 1 : -1)) * arrow;
    const std::string name = name_beside(force.name.empty() ? force.id : force.name, loads_);
    const std::string point = name_beside(name, points_);
    scene_.add_point(link->second, point, at(force.x, force.y));
    scene_.add_force(name, link->second, point, vector, force.is_local);
  }

  void add_notes() {
    if (pmks_.length == PmksMechanism::Length::cm) scene_.add_note("Lengths are cm in the address and mm here.");
    if (std::any_of(pmks_.links.begin(), pmks_.links.end(), [](const auto& link) { return link.inertia > 0.0; })) {
      scene_.add_note(fmt::format("Masses are taken for {}, inertias for {} {}^2 about the centres of mass.",
                                  units_.mass, units_.mass,
                                  pmks_.length == PmksMechanism::Length::cm ? "cm" : units_.length));
    }
    if (has_restored_angle_) {
      scene_.add_note(
          "Angles of sliders are rounded to 0.001 rad in the address: multiples of 15 degrees are restored.");
    }
    scene_.add_note("Colours, labels and what the address says of its display are left out.");
  }

  const PmksMechanism& pmks_;
  const std::string& file_;
  UnitsOfPmks units_;
  DrawnScene scene_;
  std::unordered_map<std::string, const PmksJoint*> joints_;
  std::unordered_map<std::string, const PmksLink*> links_;
  std::unordered_map<std::string, std::string> point_names_, link_names_, root_of_part_;
  std::unordered_map<std::string, std::vector<const PmksLink*>> links_at_;
  std::unordered_set<std::string> points_, loads_, driven_;
  bool has_restored_angle_ = false;
};

// Writing.

/// Letters, digits and what an address and its records have no other meaning for.
std::string in_address(const std::string& name) {
  std::string out;
  for (const char c : name) {
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-';
    out += is_plain ? c : '_';
  }
  return out;
}

class PmksExport {
 public:
  PmksExport(const Scene& scene, const std::vector<BodyPose<double>>& poses) : scene_(scene), links_(scene, poses) {
    const std::string& length = scene.units.length_name;
    out_.length = length == "m"                      ? PmksMechanism::Length::m
                  : length == "in" || length == "ft" ? PmksMechanism::Length::inch
                                                     : PmksMechanism::Length::cm;
    const UnitsOfPmks units = units_of_pmks(out_.length);
    length_ = units.si * units.factor;
    const Units si = units_of({.length = units.length, .force = units.force, .mass = units.mass});
    force_ = si.force;
    mass_ = si.mass;
  }

  Exported text() {
    find_nodes();
    for (const Joint& joint : scene_.joints) {
      if (joint.has_travel() && links_.link_of(joint.a.body) != links_.link_of(joint.b.body)) add_slider(joint);
    }
    write_joints();
    write_links();
    write_forces();
    write_drive();
    write_gravity();
    return {"https://app.pmksplus.com/?" + pmks_query(out_) + "\n", all_notes()};
  }

 private:
  struct Node {
    Vec2 at{};
    bool is_grounded = false, is_welded = false;
    std::vector<std::size_t> links{};  // that move, once each
    std::string id{};
  };
  struct Slider {
    std::size_t node = 0;          // the pin of the block
    std::size_t carrier = 0;       // link, 0 the ground
    std::size_t from = 0, to = 0;  // nodes along the slot of a link
    double angle = 0.0;
    bool is_link = false;  // the block is the link itself, which has no other joint
    std::size_t link = 0;
  };

  Vec2 in_pmks(Vec2 place) const { return (scene_.units.length / length_) * place; }

  /// Those of the links, each without the ground.
  void find_nodes() {
    for (const PosedLinks::Node& one : links_.nodes()) {
      Node node{.at = in_pmks(one.at), .is_grounded = one.has(0), .links = one.links};
      std::erase(node.links, std::size_t{0});
      nodes_.push_back(std::move(node));
    }
  }

  std::size_t new_node(std::size_t link, Vec2 at) {
    nodes_.push_back({.at = at, .links = {link}});
    return nodes_.size() - 1;
  }

  std::size_t nodes_on(std::size_t link) const {
    return static_cast<std::size_t>(std::count_if(nodes_.begin(), nodes_.end(), [&](const Node& node) {
      return std::find(node.links.begin(), node.links.end(), link) != node.links.end();
    }));
  }

  /// A link with one joint that slides once and has no load: the block itself, on which PMKS+ has no forces.
  bool is_only_a_block(std::size_t link) const {
    const auto is_of = [&](PointRef point) { return links_.link_of(point.body) == link; };
    const auto slides = std::count_if(scene_.joints.begin(), scene_.joints.end(), [&](const Joint& joint) {
      return joint.has_travel() && (is_of(joint.a) || is_of(joint.b));
    });
    return slides == 1 && nodes_on(link) == 1 &&
           std::none_of(scene_.forces.begin(), scene_.forces.end(), [&](const Force& one) { return is_of(one.at); });
  }

  /// A slide or a pin in a slot: a block that slides on the first link, pinned or welded to the second one. A slide on
  /// the second link's side is a slide on the first one's too, and on the ground it needs no slot.
  void add_slider(const Joint& joint) {
    const Vec2 along = links_.direction_in_world(joint.a.body, joint.axis);
    const bool turned = joint.kind == Joint::Kind::slide && links_.link_of(joint.b.body) == 0;
    Slider slider;
    slider.carrier = links_.link_of(turned ? joint.b.body : joint.a.body);
    slider.link = links_.link_of(turned ? joint.a.body : joint.b.body);
    slider.node = links_.node_of(turned ? joint.a : joint.b);
    if (slider.link == 0) {
      throw InputError(
          fmt::format("--pmks: {} \"{}\": expected a slot that the ground is not the pin of; "
                      "PMKS+ has no block that stands still",
                      joint.traits().key, joint.name));
    }
    if (joint.kind == Joint::Kind::slide) {
      slider.is_link = is_only_a_block(slider.link);
      if (slider.is_link) {
        blocks_.insert(slider.link);
      } else {
        // All links of a welded joint are one, so that no other may be there.
        slider.node = new_node(slider.link, nodes_[slider.node].at);
        nodes_[slider.node].is_welded = true;
      }
    }
    slider.angle = std::atan2(along.y, along.x);
    if (slider.carrier != 0) {
      // Two joints of the carrier that say where the slot is; far enough apart for their rounding.
      constexpr double apart = 10.0;
      const Vec2 at = nodes_[slider.node].at;
      slider.from = new_node(slider.carrier, at);
      slider.to = new_node(slider.carrier, at + apart * along);
      rounded_direction_ = rounded_direction_ || !is_whole(apart * along.x) || !is_whole(apart * along.y);
    } else {
      const double degrees = slider.angle * 180 / std::numbers::pi;
      bool is_restored = false;
      const double back = degrees_of_rounded(std::round(slider.angle * 1000) / 1000, is_restored);
      rounded_direction_ = rounded_direction_ || std::abs(back - degrees) > 1e-9;
    }
    sliders_.push_back(slider);
  }

  static bool is_whole(double value) { return std::abs(value * 1000 - std::round(value * 1000)) < 1e-6; }

  void write_joints() {
    for (Node& node : nodes_) {
      if (node.links.empty()) continue;
      node.id = point_name(ids_++);
      rounded_place_ = rounded_place_ || !is_whole(node.at.x) || !is_whole(node.at.y);
      out_.joints.push_back({.is_grounded = node.is_grounded,
                             .is_welded = node.is_welded,
                             .id = node.id,
                             .name = node.id,
                             .x = node.at.x,
                             .y = node.at.y});
    }
  }

  void write_links() {
    std::vector<std::vector<std::string>> joints(links_.links().size());
    for (const Node& node : nodes_) {
      for (const std::size_t link : node.links) joints[link].push_back(node.id);
    }
    for (std::size_t l = 1; l < joints.size(); ++l) {
      if (joints[l].empty()) {
        left_out_.push_back(fmt::format("{} is left out: it has no point.", links_.links()[l].name));
        ids_of_links_.emplace_back();
        continue;
      }
      PmksLink link;
      link.id = new_id(joints[l]);
      link.name = in_address(links_.links()[l].name);
      link.is_block = blocks_.count(l) != 0;
      link.joints = joints[l];
      weigh(l, link);
      ids_of_links_.push_back(link.id);
      out_.links.push_back(std::move(link));
    }
    for (const Slider& slider : sliders_) write_slider(slider);
  }

  void write_slider(const Slider& slider) {
    const Node& pin = nodes_[slider.node];
    PmksJoint joint;
    joint.slides = true;
    joint.is_grounded = slider.carrier == 0;
    joint.id = joint.name = point_name(ids_++);
    joint.x = pin.at.x;
    joint.y = pin.at.y;
    if (slider.carrier == 0) {
      joint.angle = slider.angle;
    } else {
      joint.carrier = ids_of_links_[slider.carrier - 1];
      joint.from = nodes_[slider.from].id;
      joint.to = nodes_[slider.to].id;
    }
    if (slider.is_link) {
      const std::string& id = ids_of_links_[slider.link - 1];
      const auto block =
          std::find_if(out_.links.begin(), out_.links.end(), [&](const auto& one) { return one.id == id; });
      block->joints.push_back(joint.id);
    } else {
      PmksLink block;
      block.is_block = true;
      block.joints = {pin.id, joint.id};
      block.id = block.name = new_id(block.joints);
      out_.links.push_back(std::move(block));
    }
    out_.joints.push_back(std::move(joint));
  }

  std::string new_id(const std::vector<std::string>& joints) {
    const std::string base = fmt::format("{}", fmt::join(joints, ""));
    std::string id = base;
    for (int k = 2; !taken_.insert(id).second; ++k) id = fmt::format("{}-{}", base, k);
    return id;
  }

  /// Mass, centre of mass and inertia of the bodies that are welded into one link.
  void weigh(std::size_t l, PmksLink& link) {
    double mass = 0.0, inertia = 0.0;
    Vec2 first{};
    const auto each = [&](auto visit) {
      for (std::size_t b = 1; b < scene_.bodies.size(); ++b) {
        if (links_.link_of(static_cast<int>(b)) == l) visit(static_cast<int>(b), scene_.bodies[b]);
      }
    };
    const auto centre = [&](int b, const Body& body) { return scene_.units.length * links_.place(b, body.center); };
    each([&](int b, const Body& body) {
      mass += body.mass;
      first = first + body.mass * centre(b, body);
    });
    const Vec2 middle = mass > 0.0 ? (1 / mass) * first : Vec2{};
    each([&](int b, const Body& body) {
      const Vec2 arm = centre(b, body) - middle;
      inertia += body.inertia + body.mass * dot(arm, arm);
    });
    link.mass = mass / mass_;
    link.inertia = inertia / (mass_ * length_ * length_);
    link.x = middle.x / length_;
    link.y = middle.y / length_;
    rounded_mass_ =
        rounded_mass_ || !is_whole(link.mass) || !is_whole(link.inertia) || !is_whole(link.x) || !is_whole(link.y);
    constexpr double rounding = 1e-6;  // of a unit of length
    if (link.is_block && mass > 0.0 && norm(middle - nodes_at_block(l)) > rounding * length_) {
      left_out_.push_back(fmt::format("The mass of {} is in its pin: it is a block.", link.name));
    }
  }

  Vec2 nodes_at_block(std::size_t l) const {
    for (const Node& node : nodes_) {
      if (std::find(node.links.begin(), node.links.end(), l) != node.links.end()) return length_ * node.at;
    }
    return {};
  }

  void write_forces() {
    for (std::size_t f = 0; f < scene_.forces.size(); ++f) {
      const Force& force = scene_.forces[f];
      const std::size_t l = links_.link_of(force.at.body);
      const double size = norm(force.vector);
      const bool follows_another = force.follows >= 0 && links_.link_of(force.follows) != l;
      if (force.to || l == 0 || size == 0.0 || follows_another) {
        left_out_.push_back(fmt::format("The load {} is left out.", force.name));
        continue;
      }
      const Vec2 at = in_pmks(links_.place(force.at));
      const Vec2 along =
          force.follows < 0 ? (1 / size) * force.vector : links_.direction_in_world(force.follows, force.vector);
      constexpr double arrow = 10.0;
      PmksForce out;
      out.is_local = force.follows >= 0;
      out.id = fmt::format("F{}", f + 1);
      out.name = in_address(force.name);
      out.link = ids_of_links_[l - 1];
      out.x = at.x;
      out.y = at.y;
      out.to_x = at.x + arrow * along.x;
      out.to_y = at.y + arrow * along.y;
      out.size = size / force_;
      rounded_force_ =
          rounded_force_ || !is_whole(out.to_x - out.x) || !is_whole(out.to_y - out.y) || !is_whole(out.size);
      out_.forces.push_back(std::move(out));
    }
  }

  /// The first drive of a link against the ground becomes the input.
  void write_drive() {
    for (const Drive& drive : scene_.drives) {
      const bool is_of_ground = drive.on.is_angle() && drive.on.kind == Measure::Kind::angle && drive.on.body_a == 0;
      const std::size_t l = is_of_ground ? links_.link_of(drive.on.body_b) : 0;
      const auto node = std::find_if(nodes_.begin(), nodes_.end(), [&](const Node& one) {
        return one.is_grounded && std::find(one.links.begin(), one.links.end(), l) != one.links.end();
      });
      if (l == 0 || node == nodes_.end() || has_input_) {
        left_out_.push_back(fmt::format("The drive {} is left out.", drive.name));
        continue;
      }
      has_input_ = true;
      const auto joint =
          std::find_if(out_.joints.begin(), out_.joints.end(), [&](const auto& one) { return one.id == node->id; });
      joint->is_input = true;
      const double turns = drive.rate * 180 / std::numbers::pi / degrees_per_second;
      constexpr double most_turns = 1e6;
      out_.speed = std::llround(std::clamp(std::abs(turns), 0.0, most_turns));
      out_.is_clockwise = turns < 0.0;
      left_out_.push_back(
          fmt::format("The drive {} is the input {}, of {} turns a minute.", drive.name, node->id, out_.speed));
    }
  }

  void write_gravity() {
    constexpr double near = 0.02;
    if (scene_.gravity == Vec2{}) return;
    out_.has_gravity = scene_.gravity.x == 0.0 && std::abs(scene_.gravity.y + weight_of_one) < near;
    if (!out_.has_gravity) left_out_.emplace_back("Gravity is left out: PMKS+ has 9.81 m/s^2 downward or none.");
  }

  std::vector<std::string> all_notes() const {
    std::vector<std::string> out = links_.welds();
    if (rounded_place_) out.emplace_back("Places are rounded to 0.001 of the unit of length, as PMKS+ does.");
    if (rounded_direction_) out.emplace_back("Directions of slots are rounded to 0.001 rad, as PMKS+ does.");
    if (rounded_mass_) out.emplace_back("Masses, inertias and centres of mass are rounded to 0.001 of their units.");
    if (rounded_force_) out.emplace_back("Forces are rounded to 0.001 of their unit, and their directions.");
    if (!has_input_) out.emplace_back("No joint is an input: PMKS+ moves nothing until one is chosen.");
    out.insert(out.end(), left_out_.begin(), left_out_.end());
    const std::vector<std::string> more = links_.left_out();
    out.insert(out.end(), more.begin(), more.end());
    return out;
  }

  const Scene& scene_;
  PosedLinks links_;
  PmksMechanism out_;
  double length_ = 1.0, force_ = 1.0, mass_ = 1.0;  // SI of its units
  std::vector<Node> nodes_;
  std::vector<Slider> sliders_;
  std::unordered_set<std::size_t> blocks_;  // links that are the block of a slider themselves
  std::vector<std::string> ids_of_links_;   // without the ground
  std::unordered_set<std::string> taken_;
  std::size_t ids_ = 0;
  std::vector<std::string> left_out_;
  bool rounded_place_ = false, rounded_direction_ = false, rounded_mass_ = false, rounded_force_ = false;
  bool has_input_ = false;
};

}  // namespace

Imported import_pmks_address(std::string_view text, const std::string& file, const ImportOptions& /*options*/) {
  const PmksMechanism mechanism = read_pmks_query(query_in(text, file), file);
  return PmksImport(mechanism, file).scene();
}

Exported export_pmks_address(const Scene& scene, const std::vector<BodyPose<double>>& poses) {
  return PmksExport(scene, poses).text();
}

}  // namespace poise
