#include "app/draw/equilibria_picture.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "app/draw/frames.hpp"
#include "app/draw/multiples.hpp"
#include "app/draw/symbols.hpp"

namespace poise::app {

namespace {

/// The mechanism without motors: a stop whose limits are equal stands for one.
Scene without_motors(Scene scene) {
  scene.dependents.reset();  // which refer to places of stops
  std::erase_if(scene.stops, [](const Stop& stop) { return stop.min == stop.max; });
  return scene;
}

}  // namespace

std::string equilibria_picture(const StaticModel& model, const EquilibriumSet& set,
                               const std::vector<std::string>& captions, const std::string& heading, bool confirmed) {
  constexpr std::size_t most = 64;
  const std::size_t drawn = std::min(most, set.equilibria.size());
  const Scene scene = without_motors(model.scene());
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

Figure equilibria_figure(const StaticModel& model, const EquilibriumSet& set,
                         const std::vector<std::string>& captions) {
  const std::size_t parts = model.scene().bodies.size() + model.scene().joints.size();
  const std::size_t most = std::clamp<std::size_t>(6000 / parts, 20, 200);
  const std::size_t drawn = std::min(most, set.equilibria.size());
  if (drawn == 0) return {};
  const Scene scene = without_motors(model.scene());
  std::vector<Position> positions;
  for (std::size_t k = 0; k < drawn; ++k) {
    const Equilibrium& equilibrium = set.equilibria[k];
    const Stability stability = equilibrium.certificate.stability;
    Position& position = positions.emplace_back();
    position.scene = &scene;
    position.picture = {
        .poses = model.poses(equilibrium.x), .heading = captions[k], .confirmed = equilibrium.found(), .loads = false};
    position.tone = stability == Stability::stable     ? Tone::good
                    : stability == Stability::unstable ? Tone::bad
                                                       : Tone::plain;
  }
  Figure figure{.title = "Equilibria"};
  if (drawn < set.equilibria.size())
    figure.title = fmt::format("The first {} of {} equilibria", drawn, set.equilibria.size());
  figure.drawing = draw_frames(std::move(positions), "The mechanism in every equilibrium found", false);
  return figure;
}

}  // namespace poise::app
