#pragma once

// A part of a scene on its way into the document that has it (model/parts.hpp). Private to model/.

#include <algorithm>
#include <filesystem>
#include <initializer_list>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <toml++/toml.h>

#include "model/moved_items.hpp"
#include "model/parts.hpp"

namespace poise::parts {

constexpr std::string_view fixed_frame = "ground";

using moved::Amount;
using moved::Direction;
using moved::list_in;
using moved::Place;
using moved::table_in;
using moved::tables_in;
using moved::text_in;

/// The table under a key, which is made where there is none; null where something else is there.
toml::table* made_table(toml::table& in, std::string_view key);

/// Fails on two numbers of one name.
[[noreturn]] void fail_number_taken(const TomlPlace& place, const std::string& name);

/// A point that a point of the ground of a part is.
struct Joined {
  TomlPlace place;
  std::string to;
};

/// A file that is being read: the scene's own, or that of a part.
struct Level {
  toml::table document;
  Units units;
  std::string name;  ///< in front of its items in the scene; empty of the scene's own
  std::vector<PartUse*> uses;
  TomlPlace place;
  std::vector<Joined> joined{};
};

/// What a table [[part]] says.
struct Group {
  const TomlTable* table;
  toml::table* written;
  std::string name{}, number_scope{};
  std::filesystem::path shown{}, file{};
  bool mirrored = false, is_repeated = false;
  Amount scale{1.0}, turn{};
  int count = 1;
  Place at{}, step{};
  Amount angle{};
  std::string on{};
  std::map<std::string, std::string> join{}, join_next{};
  std::vector<std::string> instances{};
  toml::table* numbers = nullptr;
};

/// What all parts of a document have in common.
struct Shared {
  PartedDocument& out;
  toml::table globals{};  ///< numbers of parts' files
  std::size_t items = 0;  ///< of all parts
};

/// Brings one part, whose own parts are in their places, into the document that has it.
class Placing : private MovedItems {
 public:
  Placing(Shared& shared, Level& level, Level& part, const Group& group, int k, PartUse& use,
          toml::source_region held_at)
      : shared_(shared),
        level_(level),
        part_(part),
        group_(group),
        k_(k),
        use_(use),
        name_(group.instances.back()),
        held_at_(std::move(held_at)) {}

  void run();

 private:
  std::string named(const std::string& item) const { return name_ + "." + item; }
  std::string frame() const { return named(std::string(fixed_frame)); }

  // Fails where a number of the table cannot follow an expression of scale.
  void check_follows_scale(const toml::table& table, const TomlTable& place) const;
  // Where instance k is: each is a step and a turn behind the one before.
  void find_place();

  // Points of the part's ground that are points of other bodies.
  void find_joined(const TomlTable& root);

  // The names that numbers of the part have in the scene: a number that the part gives, or that follows from one, is
  // its own, all others are those of the file.
  void scope_numbers();

  // All parts in this one have its scale too.
  void multiply_scales() const;
  std::string scoped(const std::string& name) const;

  void rename(toml::value<std::string>& expression, std::string_view but = {}) const;  // the name that stays

  // Expressions of a value, not of the names in it.
  void rename_below(toml::node& node, std::string_view key) const;

  void name_body(std::string& name) override;
  void name_point(std::string& name) override;
  void name_joint(std::string& name) override { name = named(name); }
  void name_element(std::string& name) override { name = named(name); }
  std::string origin_of_places() override;
  std::string carrier_of_gears() override;
  void note_negated(const toml::node& node) override;
  void take_value(toml::node& from, toml::table& to, const toml::key& key, std::string_view before) override;

  void place_item(std::string_view key, toml::table& table, const TomlTable& place);
  void place_body(toml::table& body, const TomlTable& place);
  void rename_points(toml::table& owner);

  std::string origin();

  // The guesses, at the place of the part; those that the document has itself stay.
  void add_start(const TomlTable& root);
  Amount unit_of_length() const;
  Amount angle_of_base() const;
  void guess(const toml::key& key, const Amount& value);
  void add_positions(toml::table& positions);
  // Bodies, under their names in the scene, that no slides and welds keep at an angle to a guess or to the ground:
  // their guess is 0 in the part.
  std::vector<std::string> free_bodies(const std::set<std::string>& guessed);
  std::vector<std::string> lines_of_centres();

  // The ground of the part as a body of the scene, where anything is fixed in it.
  void add_ground(const TomlTable& root);
  // The point at which the part is held, of the ground or of a body.
  void place_on(toml::table& bodies);

  void append(std::string_view key, toml::table&& table);

  void merge();
  void count() const;

  Shared& shared_;
  Level& level_;
  Level& part_;
  const Group& group_;
  int k_;
  PartUse& use_;
  std::string name_, origin_{};
  toml::source_region held_at_;
  toml::source_region source_{};  // of what the part brings that its file does not have
  Place at_{};
  std::map<std::string, std::string> joined_{}, scoped_{};
  bool needs_frame_ = false;
};

}  // namespace poise::parts
