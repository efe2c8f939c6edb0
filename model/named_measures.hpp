#pragma once

// Measures of the pose by their names, for what users drive, vary and ask for (docs/quantities.md).

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "model/measure.hpp"
#include "model/scene.hpp"

namespace poise {

/// A measure, its name, and what it is in words: "angle of upper relative to lower".
struct NamedMeasure {
  std::string name;
  Measure on{};
  std::string words;
  std::vector<std::string> also{};  ///< older spellings of the name
};

/// What the names of a family of measures begin with, and what they are of.
struct MeasureFamily {
  std::string_view prefix, item;
};
inline constexpr std::array<MeasureFamily, 6> measure_families{{{"angle.", "a body"},
                                                                {"travel.", "a slide or a pin in a slot"},
                                                                {"x.", "a point, BODY.POINT"},
                                                                {"y.", "a point, BODY.POINT"},
                                                                {"along.", "a point and an angle, BODY.POINT.DEGREES"},
                                                                {"length.", "a force element"}}};

/// The name of a force element, empty where one of another table has it too, and that with its table.
struct ElementName {
  std::string own, whole;  ///< "buffer", "spring.buffer"
};
std::vector<ElementName> names_of_elements(const Scene& scene);

/// The measures of a scene that are listed, in this order, with older spellings:
///   angle.BODY            of a body in the world           BODY
///   travel.JOINT          of a slide or a pin in a slot    JOINT
///   x.BODY.POINT, y.      place of a point in the world    BODY.POINT.x, BODY.POINT.y
///   length.ELEMENT        what a force element acts on     ELEMENT, TABLE.ELEMENT, length.TABLE.ELEMENT
std::vector<NamedMeasure> named_measures(const Scene& scene);

/// The measure with whose name the text begins, the longest such name, of two families that have too many members for a
/// list:
///   angle.BODY.OTHER            angle(BODY) - angle(OTHER), unwrapped; one of them may be the ground
///   along.BODY.POINT.DEGREES    x cos + y sin of a point in the world, of an angle in degrees from x
/// The angle ends at one of `separators`, or where the text does.
std::optional<NamedMeasure> composed_measure(const Scene& scene, std::string_view text,
                                             std::string_view separators = "");

/// The measure of that name, of any of the families; nothing where there is none.
std::optional<NamedMeasure> find_measure(const Scene& scene, std::string_view name);

/// Why there is none of a name that begins as a family does, with the nearest names: "expected the name of a body; did
/// you mean \"arm\"?". Empty of other names.
std::string why_no_measure(const Scene& scene, std::string_view name);

}  // namespace poise
