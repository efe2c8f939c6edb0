#include "app/answer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace poise::app {
namespace {

bool turns_count(const Scene& scene) {
  return !scene.torsion_springs.empty() ||
         std::any_of(scene.stops.begin(), scene.stops.end(), [](const Stop& s) { return s.kind == Stop::Kind::angle; });
}

struct Difference {
  double size = 0.0;
  std::size_t coordinate = 0;
  bool whole_turns = false;
};

Difference largest_difference(const StaticModel& model, const std::vector<double>& a, const std::vector<double>& b) {
  const bool wrap = !turns_count(model.scene());
  const auto angles = static_cast<std::size_t>(model.layout().angles);
  Difference largest;
  for (std::size_t i = 0; i < a.size(); ++i) {
    double d = std::abs(a[i] - b[i]);
    if (wrap && i < angles) {
      largest.whole_turns = largest.whole_turns || d > M_PI;
      d = std::abs(std::remainder(d, 2 * M_PI));
    }
    if (d <= largest.size) continue;
    largest.size = d;
    largest.coordinate = i;
  }
  return largest;
}

bool same_equilibrium(const StaticModel& model, const Answer& a, const Answer& b) {
  constexpr double same_reference = 1e-9;
  constexpr double same_answer = 1e-6;
  const bool refined = a.reference && a.reference->refined && b.reference && b.reference->refined;
  if (refined) return largest_difference(model, a.reference->x, b.reference->x).size < same_reference;
  return largest_difference(model, a.rest.x, b.rest.x).size < same_answer;
}

}  // namespace

double error_of(const Answer& answer) {
  return answer.reference && answer.reference->refined ? answer.reference->error
                                                       : std::numeric_limits<double>::quiet_NaN();
}

Answer measure(const StaticModel& model, Equilibrium rest) {
  Answer answer{std::move(rest), std::nullopt, std::nullopt};
  const std::vector<double>& x = answer.rest.x;
  const bool searched = answer.rest.status != Status::refused && answer.rest.status != Status::not_solved;
  const bool finite = std::all_of(x.begin(), x.end(), [](double v) { return std::isfinite(v); });
  if (searched && finite && !x.empty()) answer.readings = read_off(model, x);
  if (answer.rest.found()) answer.reference = refine(model, x);
  return answer;
}

Agreement compare_answers(const StaticModel& model, const std::vector<Answer>& answers) {
  Agreement agreement;
  std::vector<const Answer*> confirmed;
  for (const Answer& answer : answers) {
    if (answer.rest.found()) confirmed.push_back(&answer);
  }
  agreement.confirmed = static_cast<int>(confirmed.size());
  for (std::size_t i = 0; i < confirmed.size(); ++i) {
    for (std::size_t j = i + 1; j < confirmed.size(); ++j) {
      agreement.same = agreement.same && same_equilibrium(model, *confirmed[i], *confirmed[j]);
      const Difference d = largest_difference(model, confirmed[i]->rest.x, confirmed[j]->rest.x);
      agreement.whole_turns = agreement.whole_turns || d.whole_turns;
      if (d.size < agreement.difference) continue;
      agreement.difference = d.size;
      agreement.coordinate = model.layout().coordinates[d.coordinate].name;
    }
  }
  return agreement;
}

}  // namespace poise::app
