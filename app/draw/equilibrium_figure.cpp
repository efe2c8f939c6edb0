#include "app/draw/equilibrium_figure.hpp"

#include "app/draw/frames.hpp"

namespace poise::app {

Figure equilibrium_figure(const StaticModel& model, const Equilibrium& equilibrium, const std::vector<double>& start) {
  Position position{.scene = &model.scene(), .picture = picture_of(model, equilibrium, start)};
  position.tone = position.picture.confirmed ? Tone::plain : Tone::bad;
  return {.title = "Equilibrium", .drawing = draw_frames({position}, "The mechanism in equilibrium, with its forces")};
}

Figure assembled_figure(const StaticModel& model, const Mobility& mobility) {
  const bool assembled = mobility.assembled;
  Position position{.scene = &model.scene(), .tone = assembled ? Tone::plain : Tone::bad};
  position.picture = {.poses = model.poses(mobility.x),
                      .heading = assembled ? "assembled start" : "not assembled: " + mobility.gap,
                      .confirmed = assembled};
  return {.title = "Start", .drawing = draw_frames({position}, "The mechanism as it is assembled")};
}

}  // namespace poise::app
