#include "app/results/motion/equations.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "app/result/each.hpp"
#include "app/result/numbers.hpp"
#include "app/results/parts.hpp"

namespace poise::app {
namespace {

using Reached = ReducedMotion<double>::Status;

constexpr int equation_digits = 8;

const char* word_of(Reached status) {
  switch (status) {
    case Reached::ok:
      return "ok";
    case Reached::open:
      return "open";
    case Reached::singular:
      return "singular";
    case Reached::no_inertia:
      return "no_inertia";
    case Reached::locked:
    case Reached::undetermined:
    case Reached::blades:  // they are refused before
      break;
  }
  return "undetermined";
}

Line verdict_of(const EquationsAnswer& answer) {
  const int f = answer.equations.freedoms(), n = answer.equations.coordinates();
  switch (answer.numbers.status) {
    case Reached::ok:
      return good(fmt::format("The equation of motion in {}.", f == n ? count(f, "coordinate", "coordinates")
                                                                      : fmt::format("{} of {} coordinates", f, n)));
    case Reached::no_inertia:
      return bad("No acceleration follows: some motion has no inertia, so that D is singular.");
    case Reached::singular:
      return bad("Singular position: the other coordinates do not follow from those of the equation there.");
    default:
      return bad("It cannot be assembled there.");
  }
}

std::string name_of(const EquationsOfMotion& equations, int coordinate) {
  const std::string& name = equations.coordinate_names[static_cast<std::size_t>(coordinate)];
  return name.empty() ? fmt::format("q{}", coordinate) : name;
}

const char* unit_of(const EquationsOfMotion& equations, int coordinate) {
  return equations.is_length(coordinate) ? "m" : "rad";
}

/// A column of a matrix, row by row with so many columns.
std::vector<double> column_of(const std::vector<double>& matrix, std::size_t columns, std::size_t column) {
  std::vector<double> out;
  for (std::size_t at = column; at < matrix.size(); at += columns) out.push_back(matrix[at]);
  return out;
}

/// The equation, a row for each z: as text and CSV, with the columns of D by the names of coordinates.
void add_equation(Group& group, const EquationsAnswer& answer) {
  const EquationsOfMotion& equations = answer.equations;
  const EquationNumbers& at = answer.numbers;
  const auto f = static_cast<std::size_t>(equations.freedoms());
  const Format format{.digits = equation_digits};
  Table& table = group.table("", "D z'' + h + c = Q, in SI units", Rows::list);
  table.csv = true;
  table.words("coordinate", "", each(equations.independent, [&](int i) { return name_of(equations, i); }));
  table.words("unit", "unit", each(equations.independent, [&](int i) { return unit_of(equations, i); }));
  table.numbers("z", "z", "", at.z, format);
  table.numbers("w", "w = z'", "", at.w, format);
  for (std::size_t k = 0; k < f; ++k) {
    const std::string name = name_of(equations, equations.independent[k]);
    table.numbers("D." + name, f == 1 ? "D" : "D " + name, "", column_of(at.D, f, k), format);
  }
  // What is below 1e-13 of the work of the scene's loads is rounding, and so are accelerations from it.
  const double rounding = 1e-13 * equations.scales.energy();
  double lightest = at.D[0];
  for (std::size_t k = 0; k < f; ++k) lightest = std::min(lightest, at.D[k * f + k]);
  const Format of_forces{.digits = equation_digits, .zero_below = rounding};
  table.numbers("h", "h", "", at.h, of_forces);
  table.numbers("c", "c", "", at.c, of_forces);
  table.numbers("Q", "Q", "", at.Q, of_forces);
  table.numbers("alpha", "z''", "", at.alpha,
                {.digits = equation_digits, .zero_below = lightest > 0 ? rounding / lightest : 0.0});
  table.footnotes.emplace_back(
      "D: inertia; h: Coriolis and centrifugal forces, and those of moving drives; c: gravity and what is elastic; "
      "Q: loads, dampers, friction");
}

void add_all_coordinates(Group& group, const EquationsAnswer& answer) {
  const EquationsOfMotion& equations = answer.equations;
  const EquationNumbers& at = answer.numbers;
  const std::vector<std::size_t> rows = places(static_cast<std::size_t>(equations.coordinates()));
  const Format format{.digits = equation_digits};
  Table& table = group.table("", "All coordinates, in SI units", Rows::list, Verbosity::verbose);
  table.words("", "", each(rows, [&](std::size_t i) { return name_of(equations, static_cast<int>(i)); }));
  table.words("", "unit", each(rows, [&](std::size_t i) { return unit_of(equations, static_cast<int>(i)); }));
  table.numbers("", "q", "", at.q, format);
  table.numbers("", "v = q'", "", at.v, format);
  table.numbers("", "q''", "", at.a, format);
}

void add_data(Group& group, const EquationsAnswer& answer) {
  const EquationsOfMotion& equations = answer.equations;
  const EquationNumbers& at = answer.numbers;
  const auto f = static_cast<std::size_t>(equations.freedoms());
  const auto n = static_cast<std::size_t>(equations.coordinates());
  group.data("status", word_of(at.status));
  group.data("time", answer.state.t);
  const bool is_placed = !at.q.empty();
  Table& equation = group.table("equation", "", Rows::list, Verbosity::data);
  Table& coordinates = group.table("coordinates", "", Rows::list, Verbosity::data);
  Table& constraints = group.table("constraints", "", Rows::list, Verbosity::data);
  if (!is_placed) return;
  equation.words("coordinate", "", each(equations.independent, [&](int i) { return name_of(equations, i); }));
  equation.words("unit", "", each(equations.independent, [&](int i) { return unit_of(equations, i); }));
  equation.data("z", at.z);
  equation.data("w", at.w);
  for (std::size_t k = 0; k < f; ++k) equation.data("D[]", column_of(at.D, f, k));
  equation.data("h", at.h);
  equation.data("c", at.c);
  equation.data("Q", at.Q);
  equation.data("alpha", at.alpha);
  const std::vector<std::size_t> all = places(n);
  coordinates.words("name", "", each(all, [&](std::size_t i) { return name_of(equations, static_cast<int>(i)); }));
  coordinates.words("unit", "", each(all, [&](std::size_t i) { return unit_of(equations, static_cast<int>(i)); }));
  coordinates.flags("independent", each(all, [&](std::size_t i) {
                      return std::binary_search(equations.independent.begin(), equations.independent.end(),
                                                static_cast<int>(i))
                                 ? 1.0
                                 : 0.0;
                    }));
  coordinates.data("origin", each(all, [&](std::size_t i) { return equations.layout.coordinates[i].origin; }));
  coordinates.data("q", at.q);
  coordinates.data("v", at.v);
  coordinates.data("a", at.a);
  for (std::size_t k = 0; k < f; ++k) coordinates.data("B[]", column_of(at.B, f, k));
  constraints.words("of", "", equations.row_names);
  for (std::size_t i = 0; i < n; ++i) constraints.data("J[]", column_of(at.J, n, i));
}

}  // namespace

Result equations_result(const EquationsAnswer& answer, const std::vector<std::string>& settings) {
  const EquationsOfMotion& equations = answer.equations;
  Result out = scene_result(equations.scene, settings);
  out.verdict = verdict_of(answer);
  add_data(out.content, answer);
  out.content.fact("position", answer.position);
  std::vector<std::string> names = each(equations.independent, [&](int i) { return name_of(equations, i); });
  out.content.fact("coordinates z", listed(names));
  std::vector<std::string> stops;
  for (const Stop& stop : equations.scene.stops) {
    if (!stop.holds()) stops.push_back(stop.title());
  }
  if (!stops.empty()) out.content.fact("left out", listed(stops) + ": these act at their limits only");
  if (answer.numbers.q.empty()) return out;
  add_equation(out.content, answer);
  add_all_coordinates(out.content, answer);
  return out;
}

}  // namespace poise::app
