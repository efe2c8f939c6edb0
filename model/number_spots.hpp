#pragma once

// Where the numbers of a scene stand in its document. Private to model/.

#include <string>
#include <string_view>
#include <vector>

#include <toml++/toml.h>

#include "model/parameters.hpp"
#include "model/scene.hpp"

namespace poise {

/// Where a number is written: under the key of a table, there as it is, or as a component of a vector.
struct NumberSpot {
  const toml::table* table = nullptr;  ///< none where the document does not have it
  std::string header;                  ///< of that table
  std::string key;
  int component = -1;
  int point = -1;  ///< in a list of pairs, of which it is the component
  int twin = -1;   ///< another point, whose component has to be the same

  /// The number itself; null where the document leaves it to its default.
  const toml::node* node() const;
  /// That of the twin.
  const toml::node* twin_node() const;
};

/// The named number that a formula of time uses, of its row in the parameter table; empty of other rows.
std::string_view name_in_formula(const ParameterRow& row);

/// Finds the spots of a scene in the document that it was read from; both must outlive it.
class NumberSpots {
 public:
  NumberSpots(const toml::table& document, const Scene& scene);

  /// Of a row of the parameter table; of a force its size or the x of its vector; without a table and a header where
  /// the number is none of the document, as those of the parts of a flexible link. Throws InputError naming the scene's
  /// file where the document is no longer that of the scene.
  NumberSpot of(const ParameterRow& row) const;
  /// The table of an element, joint, force, drive, stop or coupling; null of one that the document has within another.
  const toml::table* item(Owner owner, int index) const;

 private:
  bool is_written(Owner owner, std::size_t at) const;
  const toml::table* in_list(std::string_view key, std::size_t index) const;
  const toml::table* table_of(std::size_t element) const;
  const toml::table* table_of(const TimeFunction& function) const;
  static NumberSpot of_curve(const Stop& stop, const toml::table* written, const std::string& key, int number);
  static NumberSpot of_rim(const Stop& rope, const toml::table* written, const std::string& key);
  NumberSpot of_element(std::size_t element, const std::string& key, int number) const;

  const toml::table& document_;
  const Scene& scene_;
  // Place of each among those of its table: each table of a file has a list of its own.
  std::vector<std::size_t> elements_, forces_, joints_, stops_;
};

}  // namespace poise
