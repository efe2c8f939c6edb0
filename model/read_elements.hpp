#pragma once

// Reads the items of a scene file that act on bodies: springs, dampers, friction, drives, loads and stops. Private to
// the readers of model/.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "model/scene.hpp"
#include "model/scene_names.hpp"
#include "model/toml_reader.hpp"

namespace poise {

/// "stop 1", "stop 2", ...: the names of so many items that are given none.
std::vector<std::string> numbered(std::string_view what, std::size_t count);

/// Reads these numbers of an item at its address `item`, which acts on the measure `on` or on none (null), under their
/// keys. Fails if a required one is absent.
void read_numbers(const TomlTable& table, std::span<const Number> numbers, void* item, const Measure* on);

/// Reads what a stop, or a coupling that acts on one side, does in an impact besides its restitution: the key "law".
/// Throws InputError where the stop holds its measure and has these keys.
void read_impact(const TomlTable& table, Stop& stop);

/// The tables of force elements, "spring", "torsion_spring", ..., in the order in which they are read.
std::vector<std::string_view> element_tables();

/// Reads these tables of the document `root` and adds their items to the scene, whose units, bodies and joints have
/// been read and are registered in `names`. Throws InputError with file, line and item.
void read_elements(const TomlTable& root, const SceneNames& names, Scene& scene);

}  // namespace poise
