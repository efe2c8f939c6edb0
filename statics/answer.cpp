#include "statics/answer.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace poise {

std::optional<double> error_of(const Answer& answer) {
  if (!answer.reference || !answer.reference->refined) return std::nullopt;
  return answer.reference->error;
}

Answer measure(const StaticModel& model, Equilibrium equilibrium) {
  Answer answer{std::move(equilibrium), std::nullopt, std::nullopt};
  const std::vector<double>& x = answer.equilibrium.x;
  const bool searched =
      answer.equilibrium.status != Status::not_applicable && answer.equilibrium.status != Status::not_solved;
  const bool finite = std::all_of(x.begin(), x.end(), [](double v) { return std::isfinite(v); });
  if (searched && finite && !x.empty()) answer.readings = read_off(model, x);
  if (answer.equilibrium.found()) answer.reference = refine(model, x);
  return answer;
}

}  // namespace poise
