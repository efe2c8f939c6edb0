#include "app/report/kinematics_report.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/kinematics_files.hpp"
#include "app/report/parts.hpp"
#include "app/table.hpp"
#include "model/nearest_name.hpp"

namespace poise::app {
namespace {

constexpr int value_digits = 8;
constexpr int rate_digits = 6;
constexpr double nothing = 1e-12;  // of the largest value of a table: rounding, shown as 0

/// Every how many samples one is shown.
std::size_t stride_of(const KinematicsResult& result) {
  return (result.samples.size() + Table::shown_rows - 1) / Table::shown_rows;
}

std::vector<double> thinned(const std::vector<double>& values, std::size_t stride) {
  std::vector<double> out;
  for (std::size_t i = 0; i < values.size(); i += stride) out.push_back(values[i]);
  // The end of the range is always shown.
  if (!values.empty() && (values.size() - 1) % stride != 0) out.push_back(values.back());
  return out;
}

/// `largest` of all that stands beside it says what is rounding.
std::vector<std::string> column(const std::vector<double>& values, Quantity quantity, int digits, const Units& units,
                                std::size_t stride, double largest) {
  std::vector<double> shown = thinned(values, stride);
  for (double& v : shown) v = std::abs(v) <= nothing * largest ? 0.0 : v;
  return aligned(in_unit(shown, quantity, units), digits);
}

double largest_of(const std::vector<double>& values) {
  double largest = 0.0;
  for (const double v : values) largest = std::max(largest, std::abs(v));
  return largest;
}

/// One table: a row for each place of the range, a column for each course.
std::string course_section(const std::string& title, const std::vector<Course>& courses,
                           std::vector<double> Course::*values, int digits, const Course& drive, const Units& units,
                           std::size_t stride, const Palette& palette) {
  if (courses.empty()) return "";
  Table table;
  table.add_number_column(with_unit(drive.name, drive.quantity, units),
                          column(drive.value, drive.quantity, value_digits, units, stride, largest_of(drive.value)));
  // Second derivatives of what turns evenly are nothing against the square of its speed, not against themselves.
  double largest = values == &Course::acceleration ? std::pow(largest_of(drive.rate), 2) : 0.0;
  for (const Course& course : courses) largest = std::max(largest, largest_of(course.*values));
  for (const Course& course : courses) {
    if (values == &Course::value && course.name == drive.name) continue;
    table.add_number_column(course.name, column(course.*values, course.quantity, digits, units, stride, largest));
  }
  return section(title, table.print(palette), palette);
}

std::string course_sections(const std::string& noun, const std::vector<Course>& courses, Quantity quantity,
                            const Course& drive, const Units& units, std::size_t stride, const Palette& palette) {
  std::vector<Course> of_kind;
  for (const Course& course : courses) {
    if (course.quantity == quantity) of_kind.push_back(course);
  }
  const std::string unit = unit_name(quantity, units);
  const auto show = [&](const std::string& title, std::vector<double> Course::*values, int digits) {
    return course_section(title, of_kind, values, digits, drive, units, stride, palette);
  };
  return show(fmt::format("{} ({})", noun, unit), &Course::value, value_digits) +
         show(fmt::format("{}: rates ({}/s)", noun, unit), &Course::rate, rate_digits) +
         show(fmt::format("{}: accelerations ({}/s²)", noun, unit), &Course::acceleration, rate_digits);
}

std::vector<Course> courses_of(const std::vector<std::string>& points, const Scene& scene,
                               const KinematicsResult& result) {
  const std::vector<Course> all = point_courses(scene, result);
  std::vector<std::string> names;
  for (std::size_t i = 0; i < all.size(); i += 2) names.push_back(all[i].name.substr(0, all[i].name.size() - 2));
  std::vector<Course> out;
  for (const std::string& point : points) {
    const auto found = std::find(names.begin(), names.end(), point);
    if (found == names.end()) {
      throw InputError(
          fmt::format("--point {}: expected a point of a moving body{}", point, did_you_mean_or_list(point, names)));
    }
    const auto at = 2 * (found - names.begin());
    out.insert(out.end(), {all[at], all[at + 1]});
  }
  return out;
}

std::string drive_words(const Scene& scene, const std::vector<DriveRange>& ranges, const std::vector<double>& values) {
  std::string out;
  for (std::size_t k = 0; k < ranges.size(); ++k) {
    const Quantity quantity = quantity_of(find_drive(scene, ranges[k].name).on);
    double shown = in_unit(values[k], quantity, scene.units);
    if (std::abs(shown) < 1e-9) shown = 0.0;  // singular poses are found to 1e-10
    out += fmt::format("{}{} = {} {}", out.empty() ? "" : ", ", ranges[k].name, significant(shown, 10),
                       unit_name(quantity, scene.units));
  }
  return out;
}

std::string singular_section(const Scene& scene, const KinematicsResult& result, const std::vector<DriveRange>& ranges,
                             const Palette& palette) {
  std::string out;
  for (const SingularPose& pose : result.singular) {
    out += fmt::format("  {}{}: {}\n", drive_words(scene, ranges, pose.drive),
                       pose.before_range ? " (on the way to the range)" : "", pose.text);
  }
  return section("Singular poses", out, palette);
}

}  // namespace

std::string kinematics_report(const Scene& scene, const KinematicsResult& result, const std::vector<DriveRange>& ranges,
                              double rate, const std::vector<std::string>& points, const Palette& palette) {
  const Units& units = scene.units;
  const std::vector<Course> of_points = courses_of(points, scene, result);
  std::string out = heading(scene.title.empty() ? scene.file : scene.title, scene.source, palette);
  out += result.complete ? palette.paint(Tone::good, "Driven through the whole range.")
         : result.stop   ? palette.paint(Tone::doubtful, "Driven up to a stop: " + result.why + ".")
                         : palette.paint(Tone::bad, "Not driven through the whole range: " + result.why + ".");
  out += "\n";
  if (!result.samples.empty()) {
    const Course drive = drive_course(scene, result, 0, ranges);
    const std::size_t stride = stride_of(result);
    double closest = 1.0;
    for (const KinematicSample& sample : result.samples) closest = std::min(closest, sample.closeness_to_singular);
    out += fact("driven",
                fmt::format("{} at {} {}/s, {}", drive.name, significant(in_unit(rate, drive.quantity, units), 6),
                            unit_name(drive.quantity, units),
                            count(static_cast<int>(result.samples.size()), "sample", "samples")) +
                    (stride > 1 ? fmt::format(", every {} of them shown", stride) : ""),
                palette);
    out += fact("closeness",
                fmt::format("{} to a singular pose at worst: smallest over largest singular value of the "
                            "closures",
                            significant(closest, 3)),
                palette);
    const std::vector<Course> courses = coordinate_courses(scene, result);
    out += course_sections("Angles", courses, Quantity::angle, drive, units, stride, palette);
    out += course_sections("Lengths", courses, Quantity::length, drive, units, stride, palette);
    out += course_sections("Points", of_points, Quantity::length, drive, units, stride, palette);
  }
  return out + singular_section(scene, result, ranges, palette);
}

}  // namespace poise::app
