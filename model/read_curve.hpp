#pragma once

// Reads the curve of a spring. Private to the readers of model/.

#include "model/laws/curve_spring.hpp"
#include "model/measure.hpp"
#include "model/toml_reader.hpp"
#include "model/units.hpp"

namespace poise {

/// The spring of a table { curve = [[x, F], ...] } or { file = "NAME.csv" }, of which x is a value of the measure `on`
/// and F a force on it, in these units. The file has a header and two columns; its name counts from the folder of the
/// scene file. Throws InputError with file and line unless there are two points or more, of ascending x.
CurveSpring read_curve(const TomlTable& table, const Measure& on, const Units& units);

}  // namespace poise
