#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/draw/figure_json.hpp"
#include "app/draw/frames.hpp"
#include "motion/forces_along.hpp"
#include "tests/app/run_poise.hpp"

namespace poise::app {
namespace {

using nlohmann::json;
using Clock = std::chrono::steady_clock;

double microseconds_since(Clock::time_point begin) {
  return std::chrono::duration<double, std::micro>(Clock::now() - begin).count();
}

/// A mechanism driven slowly, with its forces.
struct Driven {
  explicit Driven(const std::string& name, const std::string& drive, double from, double to, int steps)
      : model([&] {
          Scene scene = read_scene(app_tests::dataset(name));
          scene.drives = {find_drive(scene, drive)};
          return scene;
        }()) {
    SweepOptions options;
    options.steps = steps;
    found = forces_over(model, {{drive, from, to}}, options, false);
  }
  std::vector<Position> positions() const {
    std::vector<Position> out;
    for (const Forces& forces : found.poses) {
      Position& position = out.emplace_back();
      position.scene = &model.scene();
      position.picture = {
          .poses = poses_of(forces.motions), .reactions = forces.reactions, .drives = forces.drives};
    }
    return out;
  }
  MotionModel model;
  ForcesAlong found;
};

struct Case {
  const char* name;
  const char* drive;
  double from, to;
};
constexpr Case cases[] = {{"thesis_four_bar", "link4", 0.0, 2 * M_PI},
                          {"lift", "obd", 0.3, 0.5},
                          {"toggle_clamp", "handle", 0.5, 1.2},
                          {"six_bar", "crank", 0.0, 2 * M_PI},
                          {"andrews", "k1", -0.06, 6.0},
                          {"scissor_lift", "rise1", 0.4, 0.9}};

/// The shapes of every frame, by layer and item, as JSON text, each frame decoded from those before it.
using Shown = std::map<std::pair<std::string, std::string>, std::vector<std::string>>;
std::vector<Shown> decoded(const json& drawing) {
  std::vector<Shown> out;
  std::vector<int> now;
  for (const json& frame : drawing["frames"]) {
    if (out.empty()) {
      now = frame.get<std::vector<int>>();
    } else {
      for (std::size_t i = 0; i + 1 < frame.size(); i += 2) now.at(frame[i].get<std::size_t>()) = frame[i + 1].get<int>();
    }
    Shown& shown = out.emplace_back();
    for (std::size_t s = 0; s < now.size(); ++s) {
      if (now[s] < 0) continue;
      json shape = drawing["shapes"].at(static_cast<std::size_t>(now[s]));
      shape[1] = drawing["styles"].at(shape[1].get<std::size_t>());
      shown[{drawing["slots"][s][0], drawing["slots"][s][1]}].push_back(shape.dump());
    }
  }
  return out;
}

TEST(Figure, Scratch) {
  for (const Case& c : cases) {
    const Driven driven(c.name, c.drive, c.from, c.to, 239);
    std::vector<Position> positions = driven.positions();
    auto begin = Clock::now();
    const Drawing drawing = draw_frames(positions, c.name);
    const double drawn = microseconds_since(begin);
    begin = Clock::now();
    const std::string text = drawing_json(drawing);
    std::printf("%s: %zu frames, %.0f x %.0f, drawn in %.1f ms, %.0f kB in %.1f ms\n", c.name, drawing.frames.size(),
                drawing.width, drawing.height, drawn / 1e3, text.size() / 1e3, microseconds_since(begin) / 1e3);
    FILE* f = fopen((std::string("/tmp/h2_") + c.name + ".json").c_str(), "w");
    fwrite(text.data(), 1, text.size(), f);
    fclose(f);
    const json read = json::parse(text);
    decoded(read);
    Box world;
    for (const Position& p : positions) {
      const Box b = world_of(*p.scene, p.picture);
      world.include(b.low);
      world.include(b.high);
    }
    FrameDrawer drawer(driven.model.scene(), world);
    drawer.draw(positions.front().picture);
    begin = Clock::now();
    std::size_t shapes = 0;
    for (const Position& p : positions) shapes = drawer.draw(p.picture).entries().size();
    std::printf("   one frame: %.0f us, %zu shapes, %zu bodies\n", microseconds_since(begin) / positions.size(), shapes,
                driven.model.scene().bodies.size() - 1);
  }
}

}  // namespace
}  // namespace poise::app
