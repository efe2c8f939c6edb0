#include "app/draw/equilibria_picture.hpp"

#include <algorithm>
#include <cstddef>

#include <fmt/format.h>

#include "app/draw/mechanism.hpp"
#include "app/draw/multiples.hpp"
#include "app/draw/symbols.hpp"

namespace poise::app {

std::string equilibria_picture(const StaticModel& model, const EquilibriumSet& set,
                               const std::vector<std::string>& captions, const std::string& heading, bool confirmed) {
  constexpr std::size_t most = 64;
  const std::size_t drawn = std::min(most, set.equilibria.size());
  // A stop whose limits are equal stands for a motor.
  Scene scene = model.scene();
  std::erase_if(scene.stops, [](const Stop& stop) { return stop.min == stop.max; });
  std::vector<Multiple> multiples;
  for (std::size_t k = 0; k < drawn; ++k) {
    const Equilibrium& equilibrium = set.equilibria[k];
    const bool is_stable = equilibrium.certificate.stability == Stability::stable;
    multiples.push_back({.caption = captions[k],
                         .scene = &scene,
                         .poses = model.poses(equilibrium.x),
                         .colour = is_stable ? ink::spring : ink::load});
  }
  const std::string shown = drawn < set.equilibria.size()
                                ? fmt::format("{} The first {} of {} are drawn.", heading, drawn, set.equilibria.size())
                                : heading;
  return stacked(heading_page(scene, shown, confirmed, "equilibria"), draw_multiples(multiples));
}

}  // namespace poise::app
