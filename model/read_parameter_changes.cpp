#include "model/read_parameter_changes.hpp"

#include <string>

namespace poise {

std::vector<ParameterChange> read_parameter_changes(const TomlTable& table, Scene& scene) {
  std::vector<ParameterChange> changes;
  const auto set = table.find_table("set");
  if (!set) return changes;
  for (const std::string& path : set->keys()) {
    const TomlPlace place = set->place_of(path);
    if (set->holds_table(path)) place.fail("expected a number; put the path in quotes: \"body.NAME.mass\" = 2");
    const double value = set->number(path, 1.0, Range::finite);
    // The message names the path itself.
    located({place.file, place.line, set->place().item}, [&] { set_value(scene, path, value); });
    changes.push_back({path, value, place.line});
  }
  return changes;
}

}  // namespace poise
