#include "comparison/agreement.hpp"

#include <algorithm>

#include "comparison/difference.hpp"

namespace poise::comparison {
namespace {

bool same_equilibrium(const StaticModel& model, const Answer& a, const Answer& b) {
  const Certificate& p = a.equilibrium.certificate;
  const Certificate& q = b.equilibrium.certificate;
  // Of neutral and degenerate equilibria the place is known less well.
  constexpr double same_place = 1e-9;
  return largest_difference(model, p.x, q.x).size <= std::max(same_place, p.radius + q.radius);
}

}  // namespace

Agreement compare_answers(const StaticModel& model, const std::vector<Answer>& answers) {
  Agreement agreement;
  std::vector<const Answer*> confirmed;
  for (std::size_t k = 0; k < answers.size(); ++k) {
    if (!answers[k].equilibrium.found()) continue;
    confirmed.push_back(&answers[k]);
    const auto group = std::find_if(agreement.equilibria.begin(), agreement.equilibria.end(), [&](const auto& places) {
      return same_equilibrium(model, answers[places.front()], answers[k]);
    });
    if (group != agreement.equilibria.end())
      group->push_back(k);
    else
      agreement.equilibria.push_back({k});
  }
  agreement.confirmed = static_cast<int>(confirmed.size());
  agreement.same = agreement.equilibria.size() < 2;
  for (std::size_t i = 0; i < confirmed.size(); ++i) {
    for (std::size_t j = i + 1; j < confirmed.size(); ++j) {
      const Difference d =
          largest_difference(model, confirmed[i]->equilibrium.reached, confirmed[j]->equilibrium.reached);
      agreement.whole_turns = agreement.whole_turns || d.whole_turns;
      if (d.size < agreement.difference) continue;
      agreement.difference = d.size;
      agreement.coordinate = model.layout().coordinates[d.coordinate].name;
    }
  }
  return agreement;
}

}  // namespace poise::comparison
