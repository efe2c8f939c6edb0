#pragma once

#include <string>
#include <string_view>

#include "model/scene.hpp"

namespace poise {

/// The text of a scene file with the numbers of `wanted`, a scene that was read from it and whose numbers have been
/// changed since. Numbers that have changed are written in place, in the units of the file, with the digits that they
/// are read back from; comments and layout are kept. Expressions are kept: those that follow from a changed number of
/// [numbers] have its value, and guesses of [start] need not. A number that the text leaves to its default is added to
/// the table of its item, one of a part's file to [numbers]: all parts of that file have it from there. Throws
/// InputError naming `file` where the text is no longer that of the scene.
std::string rewritten_scene(std::string_view text, const std::string& file, const Scene& wanted);

}  // namespace poise
