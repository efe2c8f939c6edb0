#include "model/read_curve.hpp"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "model/csv_table.hpp"

namespace poise {
namespace {

/// Points of ascending x, each with its place for messages.
class Points {
 public:
  explicit Points(const PointWords& words) : words_(words) {}

  void add(double x, double y, const TomlPlace& place) {
    if (!points_.x.empty() && !(x > points_.x.back())) {
      place.fail("expected " + std::string(words_.an_x) +
                 " after that of the point before; sort the points, and give one " + std::string(words_.y) +
                 " for each " + std::string(words_.x));
    }
    points_.x.push_back(x);
    points_.y.push_back(y);
  }

  CurvePoints two_or_more(const TomlPlace& place) {
    if (points_.x.size() < 2) {
      place.fail("expected two points " + std::string(words_.point) + " or more, found " +
                 std::to_string(points_.x.size()) + "; add others");
    }
    return std::move(points_);
  }

 private:
  const PointWords& words_;
  CurvePoints points_;
};

double checked(double written, double unit, const TomlPlace& place) {
  if (!contains(Range::finite, written * unit)) place.fail(out_of_range(Range::finite, written));
  return written * unit;
}

constexpr PointWords spring_words{"x", "force", "an x", "[x, F]"};
constexpr PointWords damper_words{"rate", "force", "a rate", "[rate, F]"};
constexpr PointWords controller_words{"error", "output", "an error", "[error, output]"};

/// The points of a table { curve = [[x, F], ...] } or { file = "NAME.csv" }.
CurvePoints read_points(const TomlTable& table, double unit_x, double unit_force, const PointWords& words) {
  table.allow_keys({"curve", "file", "interpolation"});
  if (table.has("curve") == table.has("file")) {
    table.place().fail("expected either curve = [" + std::string(words.point) +
                       ", ...] or file = \"NAME.csv\", found " + (table.has("curve") ? "both; leave one out" : "none"));
  }
  if (const auto interpolation = table.find_text("interpolation")) choose(*interpolation, {"monotone"});
  if (table.has("file")) return read_points_of_file(table.text("file"), unit_x, unit_force, words);
  const std::size_t count = table.pairs("curve", unit_x, unit_force).size();
  if (count > CurveSpring::most_points) {
    table.place_of("curve").fail("expected at most " + std::to_string(CurveSpring::most_points) + " points, found " +
                                 std::to_string(count) + "; put them into a file, file = \"NAME.csv\"");
  }
  return read_listed_points(table, "curve", unit_x, unit_force, words);
}

}  // namespace

CurvePoints read_listed_points(const TomlTable& table, std::string_view key, double unit_x, double unit_y,
                               const PointWords& words) {
  Points points(words);
  for (const auto& [point, place] : table.pairs(key, unit_x, unit_y)) points.add(point.x, point.y, place);
  return points.two_or_more(table.place_of(key));
}

CurvePoints read_points_of_file(const TomlText& name, double unit_x, double unit_y, const PointWords& words) {
  // A scene that is built in code has no folder.
  const std::filesystem::path scene = name.place.line > 0 ? name.place.file : "";
  const std::filesystem::path file = scene.parent_path() / name.value;
  const std::vector<std::string> columns = located(name.place, [&] { return read_csv_header(file); });
  if (columns.size() != 2) {
    TomlPlace{file.string(), 1, "header"}.fail("expected two columns, " + std::string(words.x) + " and " +
                                               std::string(words.y) + ", found " + std::to_string(columns.size()) +
                                               "; leave the others out");
  }
  const CsvTable csv = read_csv(file, columns);
  Points points(words);
  for (std::size_t row = 0; row < csv.line.size(); ++row) {
    const auto place = [&](std::size_t column) { return TomlPlace{csv.file, csv.line[row], columns[column]}; };
    const double x = checked(csv.column(columns[0])[row], unit_x, place(0));
    const double y = checked(csv.column(columns[1])[row], unit_y, place(1));
    points.add(x, y, place(0));
  }
  return points.two_or_more({csv.file, 0, ""});
}

CurveSpring read_curve(const TomlTable& table, const Measure& on) {
  CurvePoints points = read_points(table, table.unit(on.dimension()), table.unit(on.effort_dimension()), spring_words);
  return {std::move(points.x), std::move(points.y), table.has("curve")};
}

CurvePoints read_table_of_controller(const TomlTable& table, double unit_x, double unit_y) {
  return read_points(table, unit_x, unit_y, controller_words);
}

CurveDamper read_damper_curve(const TomlTable& table, const Measure& on) {
  const double unit_rate = table.unit(on.dimension() * dimension::time.power(-1));
  CurvePoints points = read_points(table, unit_rate, table.unit(on.effort_dimension()), damper_words);
  const TomlPlace place = table.place_of(table.has("curve") ? "curve" : "file");
  if (std::find(points.x.begin(), points.x.end(), 0.0) != points.x.end()) {
    place.fail("expected rates other than 0, where a damper has no force; leave that point out");
  }
  CurveDamper damper(std::move(points.x), std::move(points.y), table.has("curve"));
  located(place, [&] { damper.check(); });
  return damper;
}

}  // namespace poise
