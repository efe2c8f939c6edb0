#include "statics/answer.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace poise {

std::optional<double> error_of(const Answer& answer) {
  if (!answer.reference || !answer.reference->refined) return std::nullopt;
  return answer.reference->error;
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

}  // namespace poise
