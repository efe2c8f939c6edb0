#pragma once

// Copies of items of a scene's text, moved in the plane, as a person would have written them: named anew, with numbers
// and expressions that are not moved as they stand. Private to model/.
//
// The ground stands for itself in a copy: its points are new points of the ground, and axes, angles and limits that
// count from it are turned. Only where a turned item counts from the ground otherwise (a coupling, a coordinate) a body
// of its own, welded to the ground, stands for it as in a [[part]].

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <toml++/toml.h>

#include "model/moved_items.hpp"
#include "model/scene_text.hpp"
#include "model/toml_edits.hpp"

namespace poise {

/// What is copied: items of the document.
struct CopiedSelection {
  std::set<std::string> bodies;
  std::vector<std::string> ground_points;  ///< also those that nothing refers to
  std::set<std::string> shared_points;     ///< of the ground, to which others refer too
  struct Item {
    std::string table;  ///< [[table]]
    std::size_t index;  ///< in its list
    Owner owner;
    std::string name;
    std::vector<std::string> derived;  ///< what [start] calls by the item's name: bodies and travels that come with it
  };
  std::vector<Item> items;  ///< in the order of the document
};

/// The names that a scene has, and new ones beside them.
class FreeNames {
 public:
  explicit FreeNames(const Scene& scene);

  /// "crank_2" beside "crank", "link_3" beside "link_1".
  std::string item(const std::string& like);
  /// Finds a name for a joint; beside a single letter it is another letter, which no point has either.
  std::string joint(const std::string& like);
  /// Finds a name for a point in the same way, among the points.
  std::string point(const std::string& like);
  bool take_item(const std::string& name) { return items_.insert(name).second; }

 private:
  std::set<std::string> items_, points_;
};

/// One copy, or with `in_place` the items themselves, which keep their names, at their other place.
class CopiedItems : private MovedItems {
 public:
  /// `document`: parsed once more from the text, to be changed here; `original`: that of the edits.
  CopiedItems(toml::table document, const toml::table& original, const TomlEdits& text, const std::string& file,
              const Scene& scene, const CopiedSelection& selection, const PlaneMotion& motion, FreeNames& names,
              bool in_place);

  using Tables = std::vector<std::pair<std::string, TomlKeys>>;
  TomlKeys ground_points;
  Tables bodies;  ///< by their names
  Tables items;   ///< by [[table]]
  TomlKeys start, positions;
  TomlKeys placed_points;  ///< of the ground, which are elsewhere in place

  /// In place: changes the tables of bodies and items in the text.
  void change(TomlEdits& edits) const;

 private:
  void name_body(std::string& name) override;
  void name_point(std::string& name) override;
  void name_joint(std::string& name) override;
  void name_element(std::string& name) override;
  std::string origin_of_places() override;
  std::string carrier_of_gears() override;

  bool is_turned() const { return !angle_.is(0.0); }
  moved::Place placed(const toml::node& at) const;
  std::string ground_point(const std::string& name);
  const std::string& frame();
  std::string name_of_default(const CopiedSelection::Item& item, const toml::table& table);
  bool counts_from_ground(std::string_view table, const toml::table& item) const;
  void turn_joint(std::string_view kind, toml::table& joint) const;
  void turn_limits(std::string_view table, toml::table& item) const;
  static void add_amount(toml::table& table, std::string_view key, const moved::Amount& more);
  void copy_item(const CopiedSelection::Item& item, toml::table& table, const TomlTable& place);
  void write_frame();
  void write_start(const CopiedSelection& selection);
  std::string text_of(const toml::node& node, const toml::node* before) const;
  TomlKeys keys_of(const toml::table& table, const toml::table& before) const;
  void change(TomlEdits& edits, const toml::table& table, const toml::table& before, const std::string& header) const;

  toml::table document_;
  const toml::table& original_;
  const TomlEdits& text_;
  const Scene& scene_;
  const CopiedSelection& selection_;
  FreeNames& names_;
  bool in_place_;
  moved::Place at_;
  std::map<std::string, std::string> body_names_, joint_names_, element_names_, point_names_;  // by the names before
  std::string frame_, frame_point_, frame_origin_;
  bool uses_frame_ = false;  // the item that is being copied
  std::string ground_;
  std::string origin_;  // the point of the ground where places count from
};

}  // namespace poise
