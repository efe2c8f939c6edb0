#pragma once

#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "exchange/formats.hpp"
#include "model/joint.hpp"
#include "model/planar.hpp"
#include "model/units.hpp"

namespace poise {

/// The number with 12 significant digits: of a length that was converted the digits behind are rounding, and a person
/// would not write them.
double short_number(double value);

/// A scene of links that were drawn where they are at the start: each has the frame of the drawing, so that its points
/// have the coordinates that they were drawn with and all angles count from the drawn position.
class DrawnScene {
 public:
  /// `file` is for messages. Angles are in degrees.
  DrawnScene(std::string file, UnitNames units);

  struct Mass {
    double mass = 0.0, inertia = 0.0;
    Vec2 center{};  ///< as it was drawn
  };
  struct DrawnJoint {
    Joint::Kind kind = Joint::Kind::pin;       ///< any but a bar
    std::pair<std::string, std::string> a, b;  ///< link and point; of a pin in a slot the slot belongs to the first
    Vec2 axis{1.0, 0.0};                       ///< of one that slides, as it was drawn
  };

  /// A link and its place among links that move, from 0; "ground" is the ground.
  void add_link(const std::string& link);
  /// A point of a link, which is added where it is new. Points of one link have names of their own.
  void add_point(const std::string& link, const std::string& point, Vec2 at);
  void set_mass(const std::string& link, const Mass& mass);
  /// A joint of points that were added before.
  void add_joint(const DrawnJoint& joint);
  /// The travel of a joint that was added last ends where it meets both of these.
  void limit_travel(double least, double most);
  void set_gravity(Vec2 acceleration) { gravity_ = acceleration; }
  /// A force at a point that was added before; one that is `fixed` turns with its link.
  void add_force(const std::string& name, const std::string& link, const std::string& point, Vec2 vector, bool fixed);
  /// A drive of a link's angle, degrees per second.
  void add_drive(const std::string& link, double rate);
  void add_note(std::string note) { notes_.push_back(std::move(note)); }

  /// The scene. Throws InputError where no link is left that can move.
  Imported finish() const;

 private:
  struct Link {
    std::string name;
    std::vector<std::pair<std::string, Vec2>> points;
    Mass mass{};
  };
  struct Limits {
    std::size_t joint;
    double least, most;
  };
  struct DrawnForce {
    std::string name, link, point;
    Vec2 vector;
    bool fixed;
  };

  Link& link(const std::string& name);
  const Vec2& place_of(const std::pair<std::string, std::string>& point) const;

  std::string file_;
  UnitNames units_;
  std::vector<Link> links_;  // the first is the ground
  std::unordered_map<std::string, std::size_t> places_;
  std::vector<DrawnJoint> joints_;
  std::vector<Limits> limits_;
  std::optional<Vec2> gravity_;
  std::vector<DrawnForce> forces_;
  std::vector<std::pair<std::string, double>> drives_;
  std::vector<std::string> notes_;
};

/// The direction at that angle, exact where it is along an axis.
Vec2 axis_at(double degrees);

/// The unit of length of a file that names none: that of the options, or `otherwise`, which a note says.
std::string length_unit(const ImportOptions& options, const std::string& otherwise, std::vector<std::string>& notes);

}  // namespace poise
