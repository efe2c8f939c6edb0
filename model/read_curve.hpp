#pragma once

// Reads the curve of a spring or damper. Private to the readers of model/.

#include <string_view>
#include <vector>

#include "model/laws/curve_damper.hpp"
#include "model/laws/curve_spring.hpp"
#include "model/measure.hpp"
#include "model/toml_reader.hpp"

namespace poise {

/// Points (x, y) of ascending x, two or more.
struct CurvePoints {
  std::vector<double> x, y;
};

/// What a message calls the coordinates of points.
struct PointWords {
  std::string_view x, y;   ///< "x", "force"
  std::string_view an_x;   ///< "an x"
  std::string_view point;  ///< "[x, F]"
};

/// The points of the list `key`, or of the two columns of a CSV file beside the scene, x and y times their units.
CurvePoints read_listed_points(const TomlTable& table, std::string_view key, double unit_x, double unit_y,
                               const PointWords& words);
CurvePoints read_points_of_file(const TomlText& name, double unit_x, double unit_y, const PointWords& words);

/// The spring of a table { curve = [[x, F], ...] } or { file = "NAME.csv" }, of which x is a value of the measure `on`
/// and F a force on it. The file has a header and two columns; its name counts from the folder of the
/// scene file. Throws InputError with file and line unless there are two points or more, of ascending x.
CurveSpring read_curve(const TomlTable& table, const Measure& on);

/// The points of the table of a controller, of the same keys, of which x is an error in units of `unit_x` and what it
/// gives there one in units of `unit_y`.
CurvePoints read_table_of_controller(const TomlTable& table, double unit_x, double unit_y);

/// The same of a damper, of which x is a rate of the measure. Fails, too, where a force does not resist.
CurveDamper read_damper_curve(const TomlTable& table, const Measure& on);

}  // namespace poise
