#include "app/draw/followed.hpp"

#include <algorithm>
#include <utility>

namespace poise::app {

std::size_t most_frames(const Scene& scene, bool forces) {
  const std::size_t parts = scene.bodies.size() + scene.joints.size();
  return std::clamp<std::size_t>((forces ? 2900 : 4300) / parts, 60, 300);
}

std::vector<std::size_t> evenly(std::size_t n, std::size_t most) {
  std::vector<std::size_t> out;
  if (n <= most) {
    for (std::size_t i = 0; i < n; ++i) out.push_back(i);
    return out;
  }
  for (std::size_t k = 0; k < most; ++k) out.push_back(k * (n - 1) / (most - 1));
  return out;
}

void animate(Figure& figure, std::vector<Position> positions, Play play, const std::string& description,
             const std::vector<std::string>& traced) {
  constexpr std::size_t most_places = 15000;
  const Scene& scene = *positions.front().scene;
  std::size_t places = 0;
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) places += scene.bodies[i].points.size() * positions.size();
  // Places in the world, until the drawing says where that is.
  std::vector<FollowedPoint> points;
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    for (std::size_t p = 0; p < scene.bodies[i].points.size(); ++p) {
      FollowedPoint point;
      point.name = scene.bodies[i].name + "." + scene.bodies[i].points[p].name;
      point.traced = std::find(traced.begin(), traced.end(), point.name) != traced.end();
      if (!point.traced && places > most_places) continue;
      for (const Position& position : positions) {
        point.at.push_back(position.picture.poses[i].world(position.scene->bodies[i].points[p].at));
      }
      points.push_back(std::move(point));
    }
  }
  const bool moves = positions.size() > 1;
  figure.drawing = draw_frames(std::move(positions), description);
  if (!moves) {
    figure.charts.cursors.clear();
    return;
  }
  for (FollowedPoint& point : points) {
    for (Vec2& at : point.at) at = figure.drawing.view.page(at);
  }
  play.points = std::move(points);
  figure.play = std::move(play);
}

}  // namespace poise::app
