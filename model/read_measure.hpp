#pragma once

// Reads measures of a scene file. Private to the readers of model/.

#include <optional>
#include <string_view>
#include <vector>

#include "model/measure.hpp"
#include "model/scene_names.hpp"
#include "model/toml_reader.hpp"
#include "model/units.hpp"

namespace poise {

/// Keys of which a table has one, which says what its measure is: "bodies", "points", "slide", ...
using MeasureKeys = std::vector<std::string_view>;
/// All of them; the last, "sum", is of terms that have one of the others.
const MeasureKeys& all_measures();

class MeasureReader {
 public:
  /// Of scenes whose bodies and joints are registered in `names`, which outlives it.
  explicit MeasureReader(const SceneNames& names) : names_(names) {}

  /// The measure of a table that has one of the keys `measures` and, besides a name, the keys `others`.
  Measure read(const TomlTable& table, const MeasureKeys& measures, const std::vector<std::string_view>& others) const;

  /// Terms of the key "sum", which may mix angles and lengths.
  std::vector<Measure::Term> terms(const TomlTable& table) const;
  /// The points and pulleys of a rope under `key`.
  std::vector<RopeContact> contacts(const TomlTable& table, std::string_view key, bool may_rub = false) const;

  /// Whether the measure of a table will be an angle, before it is read: that determines the other keys of the table.
  static bool reads_angle(const TomlTable& table, const MeasureKeys& measures);

 private:
  Measure under(const TomlTable& table, std::string_view key) const;

  const SceneNames& names_;
};

}  // namespace poise
