#pragma once

#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "exchange/formats.hpp"
#include "model/joint.hpp"
#include "model/planar.hpp"

namespace poise {

/// A scene of links that were drawn where they are at the start: each has the frame of the drawing, so that its points
/// have the coordinates that they were drawn with and all angles count from the drawn position.
class DrawnScene {
 public:
  /// Lengths are in the unit of the options, or, where these name none, in `length`; a note says so unless the file
  /// itself does.
  DrawnScene(std::string file, const ImportOptions& options, const std::string& length = "mm");
  /// The file says in which unit its lengths are.
  DrawnScene(std::string file, std::string length);

  struct Mass {
    double mass = 0.0, inertia = 0.0;
    Vec2 center{};
  };

  /// A point of a link, which is added where it is new; "ground" is the ground.
  void add_point(const std::string& link, const std::string& point, Vec2 at);
  void set_mass(const std::string& link, const Mass& mass);
  /// A joint at a point that both links have; `axis` of those that slide, as it was drawn. Of a pin in a slot the slot
  /// belongs to the first.
  void add_joint(Joint::Kind kind, const std::string& a, const std::string& b, const std::string& point,
                 Vec2 axis = {1.0, 0.0});
  void add_note(std::string note) { notes_.push_back(std::move(note)); }
  const std::string& length() const { return length_; }

  /// The scene. Throws InputError where no link is left that can move.
  Imported finish() const;

 private:
  struct Link {
    std::string name;
    std::vector<std::pair<std::string, Vec2>> points;
    Mass mass{};
  };
  struct DrawnJoint {
    Joint::Kind kind;
    std::string a, b;  // "crank.A"
    Vec2 axis;
  };

  Link& link(const std::string& name);

  std::string file_, length_;
  std::vector<Link> links_;  // the first is the ground
  std::unordered_map<std::string, std::size_t> places_;
  std::vector<DrawnJoint> joints_;
  std::vector<std::string> notes_;
};

}  // namespace poise
