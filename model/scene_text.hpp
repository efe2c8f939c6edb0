#pragma once

// The text of a scene file, changed item by item.

#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "model/parameters.hpp"
#include "model/scene.hpp"

namespace poise {

/// Keys with their values as TOML text, in the order in which they are written.
using TomlKeys = std::vector<std::pair<std::string, std::string>>;

/// "A", "B", ..., "Z", "A1", ...: the first that is not taken, which is then.
std::string free_letter(std::set<std::string>& taken);

/// How the plane is moved as a whole, in the units of a scene.
struct PlaneMotion {
  bool mirrored = false;  ///< y to -y, at first
  double angle = 0.0;     ///< by which it is turned then
  Vec2 at{};              ///< to where its origin comes

  /// This motion after another; `angle_unit`: rad in the unit of angles.
  PlaneMotion after(const PlaneMotion& first, double angle_unit) const;
};

/// Items that become a part: the text of its file, and that of the scene with a table [[part]] in their place.
struct GroupedText {
  std::string part, scene;
};

/// Reads a scene as parse_scene(), also one that is still being drawn, which may have no body.
Scene parse_sketch(std::string_view text, const std::string& name);

/// An item that the text of a scene has, by the name that pictures and messages give it: "crank" (a body), "crank.B" (a
/// point), "ground", "pin hinge", "spring holder", "stop open", "load P", "torque M", "drive motor".
struct SceneItem {
  std::string name;
  std::string own_name;  ///< "holder"
  Owner owner;
  int index;       ///< in its list of the scene; of a flexible link that of its first body
  int point = -1;  ///< of a point: index in the body
};

/// An item and a copy of it, by their places in the lists of the scenes before and after.
struct ItemCopy {
  Owner owner;
  int original, copy;
};

/// The text of a scene, which may still be without bodies (parse_sketch()), and changes of it as a person would make
/// them: a new item stands behind the others of its kind, comments and layout stay. Every function throws InputError,
/// with the text as it was, where what it is to become is no scene.
class SceneText {
 public:
  SceneText(std::string text, std::string file);

  const std::string& text() const { return text_; }
  const Scene& scene() const { return scene_; }
  /// All items that have a table, or a key, of their own: not the parts of flexible links, nor what comes with slots.
  const std::vector<SceneItem>& items() const { return items_; }

  /// A point of a body, or of "ground", in the units of the file.
  void add_point(const std::string& body, const std::string& name, const std::string& at);
  /// [body.NAME].
  void add_body(const std::string& name, const TomlKeys& keys);
  /// [[TABLE]], as of a pin, spring or force.
  void add_item(const std::string& table, const TomlKeys& keys);
  /// Sets keys of an item's table, or adds them to it. Of a point its name is the only key.
  void set(const std::string& item, const TomlKeys& keys);
  /// The guess of a body's angle, or of a joint's travel, in [start]; or of a body's place in [start.position].
  void set_start(const std::string& name, const std::string& value);
  void set_start_position(const std::string& body, const std::string& value);
  /// Takes items away, and with them all that refers to them: joints, springs, loads, stops, guesses, outputs.
  void remove(const std::vector<std::string>& items);
  /// Copies items, moved once, twice, ... `times` times: bodies with all that is among them and between them and the
  /// ground. Other names are found for them; loads that keep their direction are turned too. Returns what is copied of
  /// the items that have a table in a list.
  std::vector<ItemCopy> copy(const std::vector<std::string>& items, const PlaneMotion& step, int times);
  /// Moves items themselves, which keep their names, with what copy() would copy.
  void move(const std::vector<std::string>& items, const PlaneMotion& motion);
  /// Gives an item another name, also where others refer to it.
  void rename(const std::string& item, const std::string& name);
  /// Makes items, with what copy() would copy, a part NAME in a file beside the scene's. What refers to them elsewhere
  /// calls them NAME.ITEM then; points of the ground stay, and the part is joined to them. Changes nothing here: the
  /// scene can be read once the file is there.
  GroupedText grouped(const std::vector<std::string>& items, const std::string& name, const std::string& file) const;
  /// The text with the items of a part in the place of its table, with their numbers of now. Throws InputError of a
  /// part that stands elsewhere than its file says, or whose names the scene has too.
  std::string ungrouped(const std::string& part) const;
  /// Names of the parts that ungrouped() may take apart: each stands once.
  const std::vector<std::string>& parts() const { return parts_; }

 private:
  class Editing;
  void take(std::string text);

  std::string text_;
  std::string file_;
  Scene scene_;
  std::vector<SceneItem> items_;
  std::vector<std::string> parts_;
};

}  // namespace poise
