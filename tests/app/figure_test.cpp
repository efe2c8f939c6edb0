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
#include "app/draw/stage.hpp"
#include "motion/forces_along.hpp"
#include "tests/app/run_poise.hpp"

namespace poise::app::figure_test {
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
      position.picture = {.poses = poses_of(forces.motions), .reactions = forces.reactions, .drives = forces.drives};
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
  int most_jumps;  ///< twice what was measured
};
constexpr Case cases[] = {{"thesis_four_bar", "link4", 0.0, 2 * M_PI, 44},
                          {"lift", "obd", 0.3, 0.5, 18},
                          {"toggle_clamp", "handle", 0.5, 1.2, 12},
                          {"six_bar", "crank", 0.0, 2 * M_PI, 44},
                          {"andrews", "k1", -0.06, 6.0, 56},
                          {"scissor_lift", "rise1", 0.4, 0.9, 38}};

/// The shapes of every frame, by layer and item, as JSON text, each frame decoded from those before it.
using Shown = std::map<std::pair<std::string, std::string>, std::vector<std::string>>;
std::vector<Shown> decoded(const json& drawing) {
  std::vector<Shown> out;
  std::vector<int> now;
  for (const json& frame : drawing["frames"]) {
    if (out.empty()) {
      now = frame.get<std::vector<int>>();
    } else {
      for (std::size_t i = 0; i + 1 < frame.size(); i += 2)
        now.at(frame[i].get<std::size_t>()) = frame[i + 1].get<int>();
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

/// What a shape is, and its coordinates; of lines with corners, of which frames of a motion have fewer, the ends.
std::pair<std::string, std::vector<double>> taken_apart(const std::string& text) {
  json shape = json::parse(text);
  if (shape[2].is_array()) {
    const json points = std::exchange(shape[2], nullptr);
    const std::size_t n = points.size();
    return {shape.dump(), {points[0], points[1], points[n - 2], points[n - 1]}};
  }
  std::vector<double> numbers;
  for (std::size_t i = 2; i < shape.size(); ++i) {
    if (!shape[i].is_number()) continue;
    numbers.push_back(shape[i].get<double>());
    shape[i] = nullptr;
  }
  return {shape.dump(), numbers};
}

Drawing drawing_of(const Canvas& canvas, const Drawing& like) {
  Drawing one = like;
  one.frames.clear();
  one.frames.push_back({canvas});
  return one;
}

TEST(Figure, FramesDecodedAreTheShapesDrawn) {
  constexpr double close = 0.26;  // px: what cannot be seen, and rounding to a tenth
  for (const Case& c : cases) {
    const Driven driven(c.name, c.drive, c.from, c.to, 47);
    std::vector<Position> positions = driven.positions();
    // Parts that appear and vanish.
    for (std::size_t k = 0; k < positions.size(); k += 5) positions[k].picture.reactions.reset();
    for (std::size_t k = 3; k < positions.size(); k += 7) positions[k].picture.loads = false;
    const Drawing drawing = draw_frames(positions, c.name);
    const std::vector<Shown> frames = decoded(json::parse(drawing_json(drawing)));
    ASSERT_EQ(frames.size(), positions.size());
    for (std::size_t k = 0; k < frames.size(); ++k) {
      const json alone = json::parse(drawing_json(drawing_of(drawing.frames[k].canvas, drawing)));
      std::size_t shapes = 0;
      const Shown shown = decoded(alone).front();
      for (const auto& [slot, drawn] : shown) {
        // A single frame has the values of its items in their names.
        const auto seen = std::find_if(frames[k].begin(), frames[k].end(), [&slot = slot](const auto& entry) {
          return entry.first.first == slot.first &&
                 (entry.first.second == slot.second || slot.second.starts_with(entry.first.second + ": "));
        });
        ASSERT_NE(seen, frames[k].end()) << c.name << " " << k << ": " << slot.second;
        ASSERT_EQ(seen->second.size(), drawn.size()) << c.name << " " << k << ": " << slot.second;
        shapes += drawn.size();
        for (std::size_t i = 0; i < drawn.size(); ++i) {
          const auto [what, at] = taken_apart(drawn[i]);
          const auto [what_seen, at_seen] = taken_apart(seen->second[i]);
          EXPECT_EQ(what, what_seen);
          ASSERT_EQ(at.size(), at_seen.size());
          for (std::size_t n = 0; n < at.size(); ++n) EXPECT_NEAR(at[n], at_seen[n], close) << drawn[i];
        }
      }
      EXPECT_GT(shapes, 10U);
    }
  }
}

/// Where the texts of labels are in each frame, by their item and number.
std::vector<std::map<std::string, Vec2>> labels_of(const Drawing& drawing) {
  std::vector<std::map<std::string, Vec2>> out;
  for (const Frame& frame : drawing.frames) {
    std::map<std::string, Vec2>& labels = out.emplace_back();
    for (const PlacedShape& placed : placed_shapes(frame.canvas)) {
      const auto* text = std::get_if<shape::Text>(&placed.shape);
      if (placed.layer != "labels" || text == nullptr) continue;
      std::string key = placed.item->name;
      while (labels.contains(key)) key += "'";
      labels[key] = text->at;
    }
  }
  return out;
}

TEST(Figure, LabelsKeepStillOverASlowMotion) {
  constexpr double jump = 30.0;
  for (const Case& c : cases) {
    const Driven driven(c.name, c.drive, c.from, c.to, 199);
    const Drawing drawing = draw_frames(driven.positions(), c.name);
    const auto labels = labels_of(drawing);
    int jumps = 0;
    for (std::size_t k = 1; k < labels.size(); ++k) {
      for (const auto& [item, at] : labels[k]) {
        const auto before = labels[k - 1].find(item);
        if (before != labels[k - 1].end() && norm(at - before->second) > jump) ++jumps;
      }
    }
    std::printf("%s: %zu labels jump %d times in %zu frames\n", c.name, labels.front().size(), jumps, labels.size());
    EXPECT_LE(jumps, c.most_jumps) << c.name;
  }
}

TEST(Figure, LoopsAreClosedAndInsideTheArea) {
  for (const Case& c : cases) {
    const Driven driven(c.name, c.drive, c.from, c.to, 60);
    const Scene& scene = driven.model.scene();
    const Drawing drawing = draw_frames(driven.positions(), c.name);
    EXPECT_LE(drawing.width, 900.5) << c.name;
    for (std::size_t k = 0; k < drawing.frames.size(); ++k) {
      const Canvas& canvas = drawing.frames[k].canvas;
      EXPECT_GE(canvas.bounds().low.x, 0.0) << c.name;
      EXPECT_GE(canvas.bounds().low.y, 0.0) << c.name;
      EXPECT_LE(canvas.bounds().high.x, drawing.width) << c.name;
      EXPECT_LE(canvas.bounds().high.y, drawing.height) << c.name;
      // Dots of points of both bodies of a pin, and what the drawing says of the world.
      std::map<std::string, Vec2> dots;
      for (const PlacedShape& placed : placed_shapes(canvas)) {
        const auto* circle = std::get_if<shape::Circle>(&placed.shape);
        if (placed.layer == "joints" && circle != nullptr) dots[placed.item->name] = circle->centre;
      }
      const Poses poses = poses_of(driven.found.poses[k].motions);
      for (const Joint& joint : scene.joints) {
        if (joint.has_travel() || joint.keeps_length()) continue;
        const auto a = dots.find(scene.name_of(joint.a)), b = dots.find(scene.name_of(joint.b));
        if (a == dots.end() || b == dots.end()) continue;
        EXPECT_LT(norm(a->second - b->second), 1e-3) << c.name << " " << joint.name;
        const Vec2 world = poses[static_cast<std::size_t>(joint.b.body)].world(scene.local(joint.b));
        EXPECT_LT(norm(drawing.view.page(world) - b->second), 1e-6) << c.name;
        EXPECT_LT(norm(drawing.view.world(b->second) - world), 1e-9 * norm(world) + 1e-12) << c.name;
      }
    }
  }
}

TEST(Figure, OneFrameIsDrawnQuickly) {
  for (const Case& c : cases) {
    const Driven driven(c.name, c.drive, c.from, c.to, 239);
    const std::vector<Position> positions = driven.positions();
    auto begin = Clock::now();
    const Drawing drawing = draw_frames(positions, c.name);
    const double drawn = microseconds_since(begin);
    begin = Clock::now();
    const std::string text = drawing_json(drawing);
    std::printf("%s: %zu bodies, %zu frames, %.0f x %.0f px, drawn in %.1f ms, %.0f kB in %.1f ms", c.name,
                driven.model.scene().bodies.size() - 1, drawing.frames.size(), drawing.width, drawing.height,
                drawn / 1e3, static_cast<double>(text.size()) / 1e3, microseconds_since(begin) / 1e3);
    FrameDrawer drawer(driven.model.scene(), world_of(driven.model.scene(), positions.front().picture));
    drawer.draw(positions.front().picture);
    begin = Clock::now();
    for (const Position& p : positions) drawer.draw(p.picture);
    std::printf("; one frame %.0f us\n", microseconds_since(begin) / static_cast<double>(positions.size()));
  }
}

TEST(Figure, ChartsHaveNoNumbersThatJsonLacks) {
  Charts charts{.panels = {{.y_label = "\"y\""}}};
  charts.panels[0].curves.push_back(
      {.name = "c", .x = {0, 1, 2}, .y = {1.23456789, std::nan(""), 1e300}, .style = Curve::Style::crosses});
  charts.cursors = {{.x = {0.5}}};
  const json read = json::parse(charts_json(charts));
  const json& panel = read["panels"][0];
  EXPECT_EQ(panel["curves"][0]["y"][0], 1.23457);
  EXPECT_TRUE(panel["curves"][0]["y"][1].is_null());
  EXPECT_EQ(panel["curves"][0]["colour"], "load");
  EXPECT_EQ(panel["y_label"], "\"y\"");
  EXPECT_EQ(panel["cursor"], json::parse(R"({"x": [0.5], "y": []})"));
  const json figure = json::parse(figure_json({.title = "t", .charts = charts}));
  EXPECT_EQ(figure["kind"], "charts");
  EXPECT_FALSE(figure.contains("drawing"));
}

}  // namespace
}  // namespace poise::app::figure_test
