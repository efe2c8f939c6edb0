#pragma once

// Look-up of the names of a scene file, with messages that give the nearest name. Private to the readers of model/.

#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "model/scene.hpp"
#include "model/toml_reader.hpp"

namespace poise {

/// Names and the lines of the file that declare them.
using NameLines = std::unordered_map<std::string, int>;

/// A string of the document by which an item refers to a body, a point or a joint.
struct NameUse {
  enum class Of { body, point, joint };
  Of of;
  std::string text;
  toml::source_region source;  ///< its path is null in the scene's own file
};

/// Looks up bodies, points and joints of a scene that is being read. Look-up takes constant time; only a failure
/// searches all names for the nearest.
class SceneNames {
 public:
  /// Adds what is looked up by the text of a document to `uses`, where there is such a list.
  explicit SceneNames(const Scene& scene, std::vector<NameUse>* uses = nullptr) : scene_(scene), uses_(uses) {}

  /// Registers a body (joint) that was added to the scene, with its points.
  void learn_body(int body);
  void learn_joint(int joint);
  /// Registers a name for the first body of a chain, and one for a point.
  void learn_chain(const std::string& name, int first) { bodies_.emplace(name, first); }
  void learn_point(const std::string& name, PointRef point) { points_.emplace(name, point); }

  /// The body of that name; fails if there is none. `movable` excludes the ground.
  int body(const TomlText& name) const { return find_body(name, 0); }
  int movable_body(const TomlText& name) const { return find_body(name, 1); }
  /// The point "BODY.POINT", split at the last dot.
  PointRef point(const TomlText& name) const;
  /// The slide or pin in a slot of that name.
  int travelling_joint(const TomlText& name) const;
  /// The two ends of an item between two different bodies: the key `points` (`bodies`) of the table.
  std::pair<PointRef, PointRef> two_points(const TomlTable& table) const;
  std::pair<int, int> two_bodies(const TomlTable& table) const;

  /// The body, or -1; the joint, or -1.
  int index_of_body(const std::string& name) const;
  int index_of_joint(const std::string& name) const;

  std::vector<std::string> movable_body_names() const;
  std::vector<std::string> travelling_joint_names() const;

 private:
  int find_body(const TomlText& name, int first) const;
  void note(NameUse::Of of, const TomlText& name) const;

  const Scene& scene_;
  std::vector<NameUse>* uses_;
  std::unordered_map<std::string, int> bodies_;
  std::unordered_map<std::string, int> joints_;
  std::unordered_map<std::string, PointRef> points_;
};

/// Fails because something else, in that line of the file (0: in none), has the name already.
[[noreturn]] void fail_taken(const TomlPlace& place, const std::string& name, int line);

/// Fails unless a name is valid: not empty, no control characters.
void check_name(const std::string& name, const TomlPlace& place);

/// The name of each item: the value of its key `name`, which must be unique, or its default, made unique by " (2)", "
/// (3)", ... `taken` are names already in use.
std::vector<std::string> names_of(const std::vector<TomlTable>& items, const std::vector<std::string>& defaults,
                                  NameLines taken);

}  // namespace poise
