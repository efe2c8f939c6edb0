#pragma once

// Reads the tables of a scene file that bind measures to one another. Private to the readers of model/.

#include <vector>

#include "model/scene.hpp"
#include "model/scene_names.hpp"
#include "model/toml_reader.hpp"

namespace poise {

/// Adds for each table [[curved_slot]], [[rolling_profile]] and [[rolling_profile_on_circle]] the coordinate along its
/// curve: the travel of a massless rider that slides on the body of the curve, with the name of the table. Returns
/// these slides, in this order of the tables. Throws InputError with file, line and item.
std::vector<int> add_riders(const TomlTable& root, const SceneNames& names, Scene& scene);

/// Adds for each table [[circular_slot]] with ends and each [[rolling_on_circle]] the body whose angle is that of the
/// line of centres: massless, pinned to the circle's centre, with the name of the table; for each
/// [[rolling_profile_on_circle]] that of the radius to the contact, with "radius" behind its name, which its rider has;
/// for each [[chain]], before these, that of its strand, pinned to the centre of its first sprocket.
/// Returns these bodies in this order of the tables, -1 of slots without ends.
std::vector<int> add_lines_of_centres(const TomlTable& root, const SceneNames& names, const std::vector<int>& riders,
                                      Scene& scene);

/// Reads the tables of coupling_kinds() and adds each as a stop to the scene, one of several rows as several, whose
/// bodies and joints are registered in `names`; `riders` and `lines` are those of the two above. Values that the file
/// does not give are NaN until set_values_from_start(). Throws InputError with file, line and item.
void read_couplings(const TomlTable& root, const SceneNames& names, const std::vector<int>& riders,
                    const std::vector<int>& lines, Scene& scene);

/// Gives couplings without a value the one that their measure has at the guesses of [start], which has been read, and
/// lines of circular slots with ends, strands of chains and places on profiles that roll a guess where there is none:
/// the middle of the arc, where the strand touches both sprockets, and where the tangent is that of the contact. The
/// angle of the body of an open profile may begin with whole turns: those that bring it nearest to its guess. Throws
/// InputError where that is not known.
void set_values_from_start(const TomlTable& root, Scene& scene);

}  // namespace poise
