#include "identification/fit/private/alternatives.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace poise {

double more_than_best(const FitTask& task, double cost, double best_cost) {
  const double noise = std::max(1.0, task.residual_over_noise(best_cost));
  return 2 * (cost - best_cost) / (noise * noise);
}

Alternative alternative_at(const FitProblem& problem, const std::vector<double>& parameters,
                           const Frequencies& frequencies, double more) {
  Alternative out;
  out.more = more;
  for (const Frequencies::Mode& mode : frequencies.modes()) {
    if (mode.runs.front() == frequencies.modes().front().runs.front()) out.frequency.push_back(mode.frequency);
  }
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    out.values.push_back(parameters[i] + problem.unknown_of(i).includes);
  }
  return out;
}

std::vector<Alternative> alternatives_among(const FitTask& task, std::vector<Minimum> minima, double best_cost) {
  std::vector<Alternative> out;
  std::sort(minima.begin(), minima.end());
  std::vector<Frequencies> distinct;
  for (const Minimum& minimum : minima) {
    const double more = more_than_best(task, minimum.cost, best_cost);
    if (!(more < equally_good)) break;
    const auto same = [&](const Frequencies& one) { return !one.differ(minimum.point.parameters); };
    if (std::any_of(distinct.begin(), distinct.end(), same)) continue;
    distinct.emplace_back(task.problem, minimum.point);
    out.push_back(alternative_at(task.problem, minimum.point.parameters, distinct.back(), more));
  }
  if (out.size() < 2) out.clear();
  return out;
}

std::string ambiguity_in_words(const std::vector<Alternative>& alternatives) {
  std::vector<std::string> frequencies;
  for (const Alternative& one : alternatives) {
    // Where nothing oscillates there is none.
    if (!one.frequency.empty()) frequencies.push_back(fmt::format("{:.4g} Hz", fmt::join(one.frequency, " with ")));
  }
  std::string of;
  if (frequencies.size() == alternatives.size()) {
    const std::string last = frequencies.back();
    frequencies.pop_back();
    of = fmt::format(", with frequencies of {} and {}", fmt::join(frequencies, ", "), last);
  }
  return fmt::format(
      "{} minima explain the readings equally well{}; read faster or at uneven times, or narrow min and max of the "
      "unknowns",
      alternatives.size(), of);
}

}  // namespace poise
