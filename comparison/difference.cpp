#include "comparison/difference.hpp"

#include <algorithm>
#include <cmath>

#include "statics/all_equilibria/turns.hpp"

namespace poise::comparison {

bool turns_count(const Scene& scene) {
  const auto counts = [](const Element& e) {
    return counts_turns(e.on) && stores_energy(e.law) && !std::holds_alternative<ConstantForce>(e.law);
  };
  return std::any_of(scene.elements.begin(), scene.elements.end(), counts) ||
         std::any_of(scene.stops.begin(), scene.stops.end(), [](const Stop& s) { return counts_turns(s.on); });
}

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

}  // namespace poise::comparison
