#include "model/read_curve.hpp"

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
  void add(double x, double force, const TomlPlace& place) {
    if (!x_.empty() && !(x > x_.back())) {
      place.fail("expected an x after that of the point before; sort the points, and give one force for each x");
    }
    x_.push_back(x);
    force_.push_back(force);
  }

  CurveSpring spring(bool numbered, const TomlPlace& place) {
    if (x_.size() < 2) {
      place.fail("expected two points [x, F] or more, found " + std::to_string(x_.size()) + "; add others");
    }
    return {std::move(x_), std::move(force_), numbered};
  }

 private:
  std::vector<double> x_, force_;
};

double checked(double written, double unit, const TomlPlace& place) {
  if (!contains(Range::finite, written * unit)) place.fail(out_of_range(Range::finite, written));
  return written * unit;
}

CurveSpring read_points(const TomlTable& table, double unit_x, double unit_force) {
  Points points;
  const std::vector<TomlTable::Pair> pairs = table.pairs("curve", unit_x, unit_force);
  if (pairs.size() > CurveSpring::most_points) {
    table.place_of("curve").fail("expected at most " + std::to_string(CurveSpring::most_points) + " points, found " +
                                 std::to_string(pairs.size()) + "; put them into a file, file = \"NAME.csv\"");
  }
  for (const auto& [point, place] : pairs) points.add(point.x, point.y, place);
  return points.spring(true, table.place_of("curve"));
}

CurveSpring read_file(const TomlText& name, double unit_x, double unit_force) {
  // A scene that is built in code has no folder.
  const std::filesystem::path scene = name.place.line > 0 ? name.place.file : "";
  const std::filesystem::path file = scene.parent_path() / name.value;
  const std::vector<std::string> columns = located(name.place, [&] { return read_csv_header(file); });
  if (columns.size() != 2) {
    TomlPlace{file.string(), 1, "header"}.fail("expected two columns, x and force, found " +
                                               std::to_string(columns.size()) + "; leave the others out");
  }
  const CsvTable csv = read_csv(file, columns);
  Points points;
  for (std::size_t row = 0; row < csv.line.size(); ++row) {
    const auto place = [&](std::size_t column) { return TomlPlace{csv.file, csv.line[row], columns[column]}; };
    const double x = checked(csv.column(columns[0])[row], unit_x, place(0));
    const double force = checked(csv.column(columns[1])[row], unit_force, place(1));
    points.add(x, force, place(0));
  }
  return points.spring(false, {csv.file, 0, ""});
}

}  // namespace

CurveSpring read_curve(const TomlTable& table, const Measure& on, const Units& units) {
  table.allow_keys({"curve", "file", "interpolation"});
  if (table.has("curve") == table.has("file")) {
    table.place().fail(std::string("expected either curve = [[x, F], ...] or file = \"NAME.csv\", found ") +
                       (table.has("curve") ? "both; leave one out" : "none"));
  }
  if (const auto interpolation = table.find_text("interpolation")) choose(*interpolation, {"monotone"});
  const double unit_x = on.dimension().unit(units), unit_force = on.effort_dimension().unit(units);
  return table.has("curve") ? read_points(table, unit_x, unit_force)
                            : read_file(table.text("file"), unit_x, unit_force);
}

}  // namespace poise
