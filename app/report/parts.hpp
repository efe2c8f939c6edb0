#pragma once

// What the reports are put together from.

#include <string>
#include <vector>

#include "app/palette.hpp"
#include "app/quantity.hpp"
#include "statics/answer.hpp"

namespace poise::app {
inline namespace replaced {

inline constexpr int coordinate_digits = 10;
inline constexpr int force_digits = 6;

/// "force (N)".
std::string with_unit(const std::string& title, Quantity quantity, const Units& units);

/// A title, its source where there is one, and an empty line.
std::string heading(const std::string& title, const std::string& source, const Palette& palette);
/// Those of the scene.
std::string heading(const ScaledModel& model, const Palette& palette);

/// One line "  name   text" of a list whose names are aligned.
std::string fact(const std::string& name, const std::string& text, const Palette& palette);

/// An empty line, a title and what stands under it; nothing when that is empty.
std::string section(const std::string& title, const std::string& body, const Palette& palette);

/// The items one a line under a title, as many as a screen holds; nothing where there are none.
std::string list_section(const std::string& title, const std::vector<std::string>& items, const Palette& palette);

/// Names every element of the scene that statics left out, and why.
std::string left_out_section(const StaticModel& model, const Palette& palette);

/// A line that says that dry friction, which statics leaves out, may hold the mechanism elsewhere; nothing where there
/// is none.
std::string friction_line(const Scene& scene, const Palette& palette);

Tone tone_of(Status status);
Tone tone_of(Stability stability);

/// "unstable, 1 falling direction".
std::string in_words(const Check& check);

/// Where answers stand, side by side under their titles: a section for angles, one for travels, one for
/// places of free bodies. All answers must have
/// readings.
std::string coordinate_sections(const StaticModel& model, const std::vector<const Answer*>& answers,
                                const std::vector<std::string>& titles, const Palette& palette);

/// Length and force of every spring, moment of every torsion spring; constant forces are among them.
std::string spring_sections(const StaticModel& model, const Readings& readings, const Palette& palette);

/// What every joint, bar and pressing stop carries; reactions that statics leaves open are marked.
std::string reaction_section(const ScaledModel& model, const std::vector<Reaction>& reactions, int redundancy,
                             const Palette& palette);

}  // namespace replaced
}  // namespace poise::app
