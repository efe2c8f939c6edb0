#include "identification/identifiability/private/null_words.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

namespace poise {
namespace {

/// Words show so many parts of a direction, the largest, and so many terms of a combination.
constexpr std::size_t most_parts = 8;
/// What a weak direction mainly is depends on its parts above this, relative to the largest.
constexpr double main_part = 0.03;

/// "m +100 %" of the number; of one that is negative "gravity.y +50 % in size", and of one that is zero "x +0.03 m".
std::string part_in_words(const FitProblem& problem, std::size_t i, double value, double part, double scale) {
  const Unknown& unknown = problem.unknown_of(i);
  const std::string& name = problem.parameters()[i].name;
  const double shown = value + unknown.includes;
  if (shown == 0) {
    const std::string unit = problem.dimension(static_cast<int>(i)).unit_name(problem.experiment().scene.units);
    return fmt::format("{} {:+.2g}{}{}", name, part * scale / unknown.unit, unit.empty() ? "" : " ", unit);
  }
  const double percent = 100 * part * scale / shown;
  const char* const of = shown < 0 ? " in size" : "";
  return std::abs(percent) < 9.5 ? fmt::format("{} {:+.2g} %{}", name, percent, of)
                                 : fmt::format("{} {:+.0f} %{}", name, percent, of);
}

}  // namespace

void explain(const FitProblem& problem, const std::vector<double>& parameters, const Eigen::VectorXd& scale,
             Identifiability::Direction& direction) {
  std::vector<std::size_t> parts;
  int main_parts = 0;
  int alike = 0;
  bool all_scale = true;
  bool inertial = false;
  bool all_delays = true;
  for (std::size_t i = 0; i < direction.part.size(); ++i) {
    if (direction.part[i] == 0) continue;
    parts.push_back(i);
    const std::optional<SensorNumber>& of_sensor = problem.unknown_of(i).of_sensor;
    all_delays = all_delays && of_sensor && of_sensor->of == SensorNumber::Of::delay;
    if (std::abs(direction.part[i]) < main_part) continue;
    ++main_parts;
    alike += direction.part[i] * (parameters[i] + problem.unknown_of(i).includes) > 0 ? 1 : -1;
    const SceneParameter* const number = problem.number(static_cast<int>(i));
    all_scale = all_scale && problem.scales_with_force(static_cast<int>(i));
    inertial = inertial || (number != nullptr && number->is_inertial());
  }
  if (direction.singular_value > 0)
    direction.scale = main_parts > 1 && std::abs(alike) == main_parts && all_scale && inertial;
  std::vector<std::size_t> shown = parts;
  if (shown.size() > most_parts) {
    std::stable_sort(shown.begin(), shown.end(), [&](std::size_t a, std::size_t b) {
      return std::abs(direction.part[a]) > std::abs(direction.part[b]);
    });
    shown.resize(most_parts);
    std::sort(shown.begin(), shown.end());
  }
  std::string changes;
  for (const std::size_t i : shown) {
    changes += (changes.empty() ? "" : ", ") +
               part_in_words(problem, i, parameters[i], direction.part[i], scale[static_cast<Eigen::Index>(i)]);
  }
  if (shown.size() < parts.size()) changes += fmt::format(" and {} smaller parts", parts.size() - shown.size());
  if (direction.scale) {
    direction.words = "the overall scale of masses, inertias, stiffnesses and damping: " + changes + " together ";
    direction.remedy = "add a run with a known payload, weigh one of them, or give one a prior";
  } else if (parts.size() == 1) {
    direction.words = changes + " ";
    direction.remedy = !direction.structural ? "add a run or a sensor in which it matters, or give it a prior"
                       : problem.all_at_rest()
                           ? "add a run in motion in which it acts, leave it out of the unknowns, or give it a prior"
                           : "leave it out of the unknowns, or give it a prior";
  } else {
    direction.words = changes + " together ";
    direction.remedy = "fix one of them, give one a prior, or add runs from other positions or with another payload";
  }
  // Starts that are estimated follow a delay of all sensors.
  if (all_delays) direction.remedy = "leave the delay of one sensor out of the unknowns, or add a run with start_known";
  if (!direction.exact && direction.singular_value == 0) {
    direction.words += parts.size() == 1 ? "changes" : "change";
    direction.words += " the readings of these runs by less than errors of computation, if at all";
  } else if (!direction.exact) {
    direction.words +=
        fmt::format("change all readings by only {:.2g} standard deviations of the noise", direction.singular_value);
  } else {
    direction.words += parts.size() == 1 ? "changes no reading" : "change no reading";
    direction.words += !direction.structural   ? " of these runs"
                       : problem.all_at_rest() ? " at rest, whatever the inputs"
                       : problem.any_at_rest() ? " of any motion, nor at rest"
                                               : " of any motion";
  }
}

std::string in_words(const FitProblem& problem, const Identifiability::Combination& combination) {
  const auto name = [&](std::size_t i) { return problem.parameters()[i].name; };
  const auto first = static_cast<std::size_t>(combination.unit_of);
  std::string words = name(first);
  std::size_t terms = 1;
  for (std::size_t i = 0; i < combination.coefficient.size(); ++i) {
    const double by = combination.coefficient[i] * problem.unknown_of(i).unit / problem.unknown_of(first).unit;
    if (i == first || by == 0) continue;
    if (++terms <= most_parts) words += fmt::format(" {} {:.6g} {}", by < 0 ? '-' : '+', std::abs(by), name(i));
  }
  if (terms > most_parts) words += fmt::format(" and {} more terms", terms - most_parts);
  if (combination.over < 0) return words;
  if (terms > 1) words = "(" + words + ")";
  return words + " / " + name(static_cast<std::size_t>(combination.over));
}

}  // namespace poise
