#pragma once

// Reads the tables of a scene file that bind measures to one another. Private to the readers of model/.

#include <vector>

#include "model/scene.hpp"
#include "model/scene_names.hpp"
#include "model/toml_reader.hpp"

namespace poise {

/// Adds for each table [[curved_slot]] the coordinate along its track: the travel of a massless rider that slides on
/// the body of the slot, with the name of the slot. Returns these slides, in the order of the tables. Throws InputError
/// with file, line and item.
std::vector<int> add_riders(const TomlTable& root, const SceneNames& names, Scene& scene);

/// Adds for each table [[circular_slot]] with ends and each [[rolling_on_circle]] the body whose angle is that of the
/// line of centres: massless, pinned to the circle's centre, with the name of the table. Returns these bodies in the
/// order of the tables [[circular_slot]], -1 of those without ends, and then of the others.
std::vector<int> add_lines_of_centres(const TomlTable& root, const SceneNames& names, Scene& scene);

/// Reads the tables of coupling_kinds() and adds each as a stop to the scene, one of several rows as several, whose
/// bodies and joints are registered in `names`; `riders` and `lines` are those of the two above. Values that the file
/// does not give are NaN until set_values_from_start(). Throws InputError with file, line and item.
void read_couplings(const TomlTable& root, const SceneNames& names, const std::vector<int>& riders,
                    const std::vector<int>& lines, Scene& scene);

/// Gives couplings without a value the one that their measure has at the guesses of [start], which has been read, and
/// lines of circular slots with ends a guess where there is none: the middle of the arc.
/// Throws InputError where that is not known.
void set_values_from_start(const TomlTable& root, Scene& scene);

}  // namespace poise
