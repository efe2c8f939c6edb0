#include "exchange/linkage2.hpp"

#include <algorithm>
#include <unordered_map>
#include <unordered_set>

#include <fmt/format.h>

#include "exchange/private/drawn_scene.hpp"
#include "exchange/private/reading.hpp"
#include "exchange/private/xml.hpp"
#include "model/one_line.hpp"

namespace poise {
namespace {

constexpr double units_per_inch = 96.0, mm_per_inch = 25.4;
constexpr const char* ground = "ground";

bool is_true(pugi::xml_node node, const char* attribute) {
  return std::string_view(node.attribute(attribute).value()) == "true";
}

/// What is drawn beside the mechanism: layers are bits, of which the first is for drawings.
bool is_drawing(pugi::xml_node node) {
  return node.attribute("layer").as_uint() == 1U || is_true(node, "measurementelement");
}

class LinkageImport {
 public:
  LinkageImport(const Xml& xml, const std::string& file) : xml_(xml), root_(xml.root("linkage2")) {
    const pugi::xml_node program = root_.child("program");
    const std::string units = in_small_letters(program.attribute("units").value());
    if (!units.empty() && units != "millimeters" && units != "inches") {
      xml_.fail(program, "program.units", "expected Millimeters or Inches");
    }
    const double scale = program ? xml_.number(program, "scalefactor", "program", 1.0) : 1.0;
    if (!(scale > 0.0)) xml_.fail(program, "program.scalefactor", "expected a number > 0");
    const bool in_inches = units == "inches";
    factor_ = scale * (in_inches ? 1.0 : mm_per_inch) / units_per_inch;
    scene_.emplace(file, UnitNames{.length = in_inches ? "in" : "mm"});
    scene_->add_note(fmt::format("Coordinates are 1/96 inch, times the scale factor {:g}; y is upward.", scale));
  }

  Imported scene() {
    for (const pugi::xml_node node : root_.children()) {
      const std::string_view name = node.name();
      if (name == "connector") {
        read_connector(node);
      } else if (name == "ratios" && node.child("ratio")) {
        xml_.fail(node.child("ratio"), "ratio", "expected no gears and chains, which are not taken");
      }
    }
    for (const pugi::xml_node node : root_.children()) {
      const std::string_view name = node.name();
      if (name == "Link" || name == "element") read_link(node);
    }
    add_ground();
    for (const std::string& id : order_) add_joints(connectors_.at(id));
    for (const std::string& id : order_) add_slider(connectors_.at(id));
    if (drawings_ > 0) {
      scene_->add_note(fmt::format("{} of the drawing layer or for measuring left out.",
                                   drawings_ == 1 ? "1 item is" : fmt::format("{} items are", drawings_)));
    }
    scene_->add_note("Colours and labels are left out, and no link has a mass.");
    return scene_->finish();
  }

 private:
  struct Connector {
    pugi::xml_node node;
    std::string id, point;
    Vec2 at{};
    bool is_anchor = false, is_input = false, is_slider = false;
    std::vector<std::string> links{};  // by their names
  };

  /// Throws InputError for an attribute that holds parts together in a way that is not taken.
  void refuse(pugi::xml_node node, const std::string& item, const char* attribute, const char* what) const {
    const std::string_view value = node.attribute(attribute).value();
    if (value.empty() || value == "false") return;
    xml_.fail(node, item, fmt::format("expected no {}, which is not taken", what));
  }

  void read_connector(pugi::xml_node node) {
    if (is_drawing(node)) {
      ++drawings_;
      return;
    }
    Connector one;
    one.node = node;
    one.id = xml_.word(node, "id", "connector");
    const std::string item = fmt::format("connector {}", one.id);
    if (connectors_.size() >= most_items) xml_.fail(node, item, fmt::format("expected at most {}", most_items));
    one.at = {factor_ * xml_.number(node, "x", item), factor_ * xml_.number(node, "y", item)};
    one.is_anchor = is_true(node, "anchor");
    one.is_input = is_true(node, "input");
    one.is_slider = is_true(node, "slider");
    for (const char* attribute : {"fasten", "fastenlink", "fastenconnector"}) {
      refuse(node, item, attribute, "connector that is fastened to a link");
    }
    if (one.is_slider && xml_.number(node, "slideradius", item, 0.0) != 0.0) {
      xml_.fail(node, item, "expected a straight slider, found a slideradius");
    }
    const std::string_view name = node.attribute("name").value();
    one.point = name_beside(name.empty() ? "P" + one.id : name, points_);
    const std::string id = one.id;
    if (!connectors_.emplace(id, std::move(one)).second) xml_.fail(node, item, "expected one connector of this id");
    order_.push_back(id);
  }

  void read_link(pugi::xml_node node) {
    if (is_drawing(node)) {
      ++drawings_;
      return;
    }
    const std::string id = xml_.word(node, "id", "Link");
    const std::string item = fmt::format("Link {}", id);
    refuse(node, item, "actuator", "actuator");
    refuse(node, item, "gear", "gear");
    for (const char* attribute : {"fasten", "fastenlink", "fastenconnector"}) {
      refuse(node, item, attribute, "link that is fastened to another");
    }
    std::vector<std::string> own;
    std::size_t anchors = 0;
    for (const pugi::xml_node child : node.children()) {
      if (std::string_view(child.name()) == "fastenconnector") {
        xml_.fail(child, item, "expected no connector that is fastened, which is not taken");
      }
      if (std::string_view(child.name()) != "connector") continue;
      const std::string of = xml_.word(child, "id", item);
      const auto found = connectors_.find(of);
      if (found == connectors_.end()) {
        xml_.fail(child, item, fmt::format("expected the id of a connector, found \"{}\"", of));
      }
      if (std::find(own.begin(), own.end(), of) != own.end()) continue;
      own.push_back(of);
      anchors += found->second.is_anchor ? 1 : 0;
    }
    if (own.size() < 2) {
      scene_->add_note(fmt::format("Link {} is left out: it has fewer than two connectors.", one_line(id)));
      return;
    }
    std::string name = ground;
    if (anchors < 2) {
      const std::string_view label = node.attribute("name").value();
      name = name_beside(label.empty() ? "link " + id : label, names_);
      for (const std::string& of : own) scene_->add_point(name, connectors_.at(of).point, connectors_.at(of).at);
    } else {
      scene_->add_note(fmt::format("Link {} has two anchors: it is part of the ground.", one_line(id)));
    }
    for (const std::string& of : own) {
      std::vector<std::string>& links = connectors_.at(of).links;
      if (std::find(links.begin(), links.end(), name) == links.end()) links.push_back(name);
    }
  }

  /// Anchors are points of the ground, and so is what a link of two of them has.
  void add_ground() {
    for (const std::string& id : order_) {
      Connector& one = connectors_.at(id);
      const auto fixed = std::find(one.links.begin(), one.links.end(), ground);
      const bool is_fixed = one.is_anchor || fixed != one.links.end();
      if (fixed != one.links.end()) one.links.erase(fixed);
      if (!is_fixed) continue;
      one.links.insert(one.links.begin(), ground);
      scene_->add_point(ground, one.point, one.at);
    }
  }

  void add_joints(const Connector& one) {
    for (std::size_t k = 1; k < one.links.size(); ++k) {
      scene_->add_joint({Joint::Kind::pin, {one.links[0], one.point}, {one.links[k], one.point}});
    }
    if (!one.is_input) return;
    if (!one.is_anchor || one.links.size() < 2) {
      scene_->add_note(fmt::format("The input {} is left out: it is no anchor of a link.", one.point));
      return;
    }
    const double rate = degrees_per_second * xml_.number(one.node, "rpm", fmt::format("connector {}", one.id), 0.0);
    if (!driven_.insert(one.links[1]).second) return;
    scene_->add_drive(one.links[1], rate);
    scene_->add_note(
        fmt::format("The input {} drives {} at {:g} deg/s in motion, counterclockwise where its rpm are positive; in "
                    "equilibria it is free.",
                    one.point, one.links[1], rate));
  }

  /// A connector that slides along the line between two others, which belong to one link: a pin in its slot.
  void add_slider(const Connector& one) {
    if (!one.is_slider) return;
    const std::string item = fmt::format("connector {}", one.id);
    std::vector<const Connector*> limits;
    for (const pugi::xml_node child : one.node.children("slidelimit")) {
      const auto found = connectors_.find(xml_.word(child, "id", item));
      if (found == connectors_.end()) xml_.fail(child, item, "expected the id of a connector");
      limits.push_back(&found->second);
    }
    if (limits.size() != 2) xml_.fail(one.node, item, "expected a slider between two connectors (slidelimit)");
    if (one.links.empty()) return;
    const Vec2 along = limits[1]->at - limits[0]->at;
    if (norm(along) == 0.0) xml_.fail(one.node, item, "expected two ends of the slider that are apart");
    const auto shared = std::find_if(limits[0]->links.begin(), limits[0]->links.end(), [&](const std::string& link) {
      return std::find(limits[1]->links.begin(), limits[1]->links.end(), link) != limits[1]->links.end();
    });
    if (shared == limits[0]->links.end()) {
      xml_.fail(one.node, item, "expected a slider between connectors of one link, or two anchors");
    }
    if (std::find(one.links.begin(), one.links.end(), *shared) != one.links.end()) {
      xml_.fail(one.node, item, "expected a slider of another link than the one that it slides on");
    }
    scene_->add_joint({Joint::Kind::pin_in_slot, {*shared, limits[0]->point}, {one.links[0], one.point}, along});
    scene_->limit_travel(0.0, norm(along));
    scene_->add_note(
        fmt::format("The slider {} slides between {} and {}.", one.point, limits[0]->point, limits[1]->point));
  }

  const Xml& xml_;
  pugi::xml_node root_;
  double factor_ = 1.0;  // units of the scene in one of the file
  std::optional<DrawnScene> scene_;
  std::unordered_map<std::string, Connector> connectors_;
  std::vector<std::string> order_;
  std::unordered_set<std::string> points_, names_ = {ground}, driven_;
  int drawings_ = 0;
};

}  // namespace

Imported import_linkage2(std::string_view text, const std::string& file, const ImportOptions& /*options*/) {
  const Xml xml(text, file);
  return LinkageImport(xml, file).scene();
}

}  // namespace poise
