#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/draw/chart/motion_charts.hpp"
#include "app/draw/equilibria_picture.hpp"
#include "app/draw/equilibrium_figure.hpp"
#include "app/draw/figure_json.hpp"
#include "app/draw/followed.hpp"
#include "app/draw/goals_figures.hpp"
#include "app/draw/modes_figure.hpp"
#include "app/draw/motion_pictures.hpp"
#include "app/draw/path_picture.hpp"
#include "model/joint_friction.hpp"
#include "motion/confirmed_motion.hpp"
#include "motion/equilibrium_pose.hpp"
#include "motion/release.hpp"
#include "tests/app/run_poise.hpp"
#include "tests/support/touching_scenes.hpp"

namespace poise::app::figure_builders_test {
namespace {

using nlohmann::json;

/// What every page relies on; the figure as JSON.
json checked(const Figure& figure, const std::string& name) {
  const std::size_t frames = figure.drawing.frames.size();
  const auto begin = std::chrono::steady_clock::now();
  const std::string text = figure_json(figure);
  std::printf("%s: %zu frames, %.0f kB, written in %.1f ms\n", name.c_str(), frames,
              static_cast<double>(text.size()) / 1e3,
              std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
  if (const char* folder = std::getenv("POISE_FIGURES"))
    std::ofstream(std::string(folder) + "/" + name + ".json") << text;
  EXPECT_LT(text.size(), 1'500'000U) << name;
  EXPECT_GT(frames, 0U) << name;
  EXPECT_FALSE(figure.title.empty()) << name;
  if (figure.play) {
    EXPECT_EQ(figure.play->values.size(), frames) << name;
    for (const FollowedPoint& point : figure.play->points) EXPECT_EQ(point.at.size(), frames) << name << point.name;
    for (const Play::Mark& mark : figure.play->marks) EXPECT_LT(mark.frame, frames) << name;
    EXPECT_EQ(figure.charts.cursors.size(), figure.charts.panels.size()) << name;
    for (const ChartCursor& cursor : figure.charts.cursors) EXPECT_EQ(cursor.x.size(), frames) << name;
  }
  return json::parse(text);
}

std::size_t colours_unknown(const json& figure, const json& palette) {
  std::size_t unknown = 0;
  for (const json& style : figure["drawing"]["styles"]) {
    for (const char* key : {"fill", "stroke", "colour"}) {
      if (style.contains(key) && style[key] != "none" && !palette.contains(style[key])) ++unknown;
    }
  }
  return unknown;
}

TEST(FigureBuilders, Equilibrium) {
  const StaticModel model(read_scene(app_tests::dataset("toggle_clamp")));
  const json figure = checked(equilibrium_figure(model, solve(model), assemble(model)), "solve");
  EXPECT_EQ(figure["kind"], "drawing");
  EXPECT_TRUE(figure["play"].is_null());
  EXPECT_TRUE(figure["charts"].is_null());
  EXPECT_TRUE(figure["drawing"]["confirmed"][0].get<bool>());
  EXPECT_EQ(colours_unknown(figure, json::parse(palette_json())), 0U);
  const json start = checked(assembled_figure(model, analyse_mobility(model)), "check");
  EXPECT_EQ(start["drawing"]["captions"][0], "assembled start");
}

TEST(FigureBuilders, EquilibriaAreCards) {
  const StaticModel model(read_scene(app_tests::dataset("toggle_clamp")));
  EquilibriumSet set;
  for (int i = 0; i < 203; ++i) set.equilibria.push_back(solve(model));
  const std::vector<std::string> captions(set.equilibria.size(), "caption");
  const json figure = checked(equilibria_figure(model, set, captions), "equilibria");
  EXPECT_EQ(figure["kind"], "cards");
  EXPECT_EQ(figure["title"], "The first 200 of 203 equilibria");
  EXPECT_EQ(figure["drawing"]["frames"].size(), 200U);
  EXPECT_EQ(figure["drawing"]["tones"][7], "good");
  EXPECT_LT(figure["drawing"]["width"].get<double>(), 500.0);
}

TEST(FigureBuilders, PathHasItsEventsAsFrames) {
  const VariedScene varied(read_scene(app_tests::dataset("von_mises_toggle")), "loads", 0.0, 2.0);
  const auto begin = std::chrono::steady_clock::now();
  const Path found = path(varied);
  const auto traced = std::chrono::steady_clock::now();
  const Figure figure = path_figure(varied, found, {});
  std::printf("path traced in %.0f ms, figure in %.0f ms\n",
              std::chrono::duration<double, std::milli>(traced - begin).count(),
              std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - traced).count());
  checked(figure, "path");
  ASSERT_TRUE(figure.play.has_value());
  EXPECT_GE(figure.play->marks.size(), found.events.size());
  EXPECT_LE(figure.drawing.frames.size(), 300U);
  EXPECT_TRUE(figure.play->snaps.empty());
  for (std::size_t k = 0; k < figure.drawing.frames.size(); ++k) {
    EXPECT_FALSE(figure.drawing.frames[k].caption.empty());
    EXPECT_TRUE(std::isfinite(figure.charts.cursors[0].y[k]));
  }
}

TEST(FigureBuilders, PathThatSnaps) {
  for (const double last : {2.0, 3.0}) {  // the snap is where the range ends, and before
    const VariedScene varied(read_scene(app_tests::dataset("von_mises_toggle")), "loads", 0.0, last);
    PathOptions options;
    options.follow = PathOptions::Follow::jump;
    const Path found = path(varied, options);
    const Figure figure = path_figure(varied, found, {});
    checked(figure, "path that snaps");
    const auto landing = std::find_if(figure.play->marks.begin(), figure.play->marks.end(),
                                      [](const Play::Mark& m) { return m.label.find("′") != std::string::npos; });
    ASSERT_NE(landing, figure.play->marks.end());
    EXPECT_GT(landing->frame, 0U) << "the landing is a frame of its own";
  }
}

TEST(FigureBuilders, DrivenPath) {
  const VariedScene varied(read_scene(app_tests::dataset("toggle_clamp")), "angle.handle", 93.0, 60.0);
  const Path found = path(varied);
  ASSERT_FALSE(found.branches.empty());
  checked(path_figure(varied, found, {}), "driven path");
}

TEST(FigureBuilders, Kinematics) {
  const Scene scene = read_scene(app_tests::dataset("lift"));
  const std::vector<DriveRange> ranges = {{"obd", 0.2, 0.6}};
  SweepOptions options;
  options.steps = 400;
  const KinematicsResult found = sweep(scene, ranges, options);
  const Figure figure = kinematics_figure(scene, found, ranges, {"gl.L"}, true);
  const json read = checked(figure, "kinematics");
  EXPECT_EQ(figure.drawing.frames.size(), most_frames(scene, false));
  EXPECT_EQ(std::count_if(figure.play->points.begin(), figure.play->points.end(),
                          [](const FollowedPoint& p) { return p.traced; }),
            1);
  const json& panels = read["charts"]["panels"];
  ASSERT_EQ(panels.size(), 3u) << "path, speed and acceleration of the point";
  EXPECT_EQ(panels[0]["cursor"]["y"].size(), figure.drawing.frames.size()) << "the place on its path";
  EXPECT_EQ(panels[1]["cursor"]["x"][0], 0.2);
  EXPECT_EQ(read["play"]["label"], "obd");
}

TEST(FigureBuilders, Motion) {
  const MotionModel model(read_scene(app_tests::dataset("lift")));
  MotionOptions options;
  options.duration = 3.0;
  options.accuracy = 1e-6;
  const std::vector<Displacement> displaced = {{channel_named("", "obd", channels_of(model)), false, 0.02}};
  const Motion motion = simulate(model, release(model, equilibrium_origin(model), displaced), options);
  ASSERT_TRUE(motion.completed()) << motion.why;
  const auto begin = std::chrono::steady_clock::now();
  const MotionRecord recorded = record(model, motion, 200.0);
  const Figure figure =
      motion_figure(model.scene(), model, motion, recorded, motion_panels(model.scene(), recorded), true);
  std::printf("motion drawn in %.0f ms\n",
              std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
  checked(figure, "motion");
  EXPECT_DOUBLE_EQ(figure.play->seconds, 3.0);
  EXPECT_DOUBLE_EQ(figure.play->values.back(), 3.0);
  EXPECT_EQ(figure.play->unit, "s");
}

/// States of the items of a layer: "1.962 N on ball by ground".
std::vector<std::string> states_of(const Frame& frame, const std::string& layer) {
  std::vector<std::string> out;
  for (const PlacedShape& shape : placed_shapes(frame.canvas)) {
    const bool is_new = out.empty() || out.back() != shape.item->state;
    if (shape.layer == layer && is_new) out.push_back(shape.item->state);
  }
  return out;
}

TEST(FigureBuilders, MotionHasForcesImpactsAndEventsOfContacts) {
  const Scene scene = parse_scene(test::ball_on_slope, "ball.toml");
  const MotionModel model(resisted_by_joints(scene));
  MotionOptions options;
  options.duration = 0.6;
  const Motion motion = simulate(model, release(model, {}, {}), options);
  ASSERT_TRUE(motion.completed()) << motion.why;
  const MotionRecord recorded = record(model, motion, 200.0);
  const Figure figure = motion_figure(scene, model, motion, recorded, motion_panels(scene, recorded), true);
  checked(figure, "motion with contact");
  const std::vector<Frame>& frames = figure.drawing.frames;
  const std::vector<Play::Mark>& marks = figure.play->marks;
  ASSERT_EQ(marks.size(), 1U);
  EXPECT_EQ(marks[0].label, "1\u20132");
  EXPECT_EQ(marks[0].caption, "t = 0.3193 s, impact of slope (min), 0.5425 N s; stick of slope (min)");
  const std::size_t hit = marks[0].frame;
  const double t = std::sqrt(2 * 0.5 / 9.81);
  EXPECT_GE(figure.play->values[hit], t);
  EXPECT_LT(figure.play->values[hit - 1], t);
  EXPECT_TRUE(states_of(frames[hit - 1], "contact-forces").empty());
  EXPECT_TRUE(states_of(frames[hit - 1], "impacts").empty());
  // m v cos(30 deg) with v = g t; then m g cos(30 deg), and of m g sin(30 deg) the part I / (I + m r^2) as friction.
  EXPECT_EQ(states_of(frames[hit], "impacts"), std::vector<std::string>{"0.5425 N s"});
  EXPECT_TRUE(states_of(frames.back(), "impacts").empty()) << "it has faded";
  EXPECT_EQ(states_of(frames.back(), "contact-forces"),
            std::vector<std::string>{"1.73 N, 1.699 N of it pressing, on ball by ground"});
}

/// The shapes of a kind that an item has in its first frame.
template <class Kind>
std::vector<Kind> shapes_of(const Figure& figure, const std::string& item) {
  std::vector<Kind> out;
  for (const PlacedShape& shape : placed_shapes(figure.drawing.frames.front().canvas)) {
    if (const auto* const one = std::get_if<Kind>(&shape.shape); one != nullptr && shape.item->name == item)
      out.push_back(*one);
  }
  return out;
}

// The wheel has twelve teeth, not the convex hull of their tips, and no line divides it.
TEST(FigureBuilders, ABodyHasTheOutlineThatOthersTouch) {
  const StaticModel model(read_scene(app_tests::dataset("ratchet")));
  const Figure figure = assembled_figure(model, analyse_mobility(model));
  checked(figure, "ratchet");
  const auto wheel = shapes_of<shape::Polygon>(figure, "wheel");
  ASSERT_FALSE(wheel.empty());
  EXPECT_EQ(wheel.front().points.size(), 24U);
  std::size_t edges = 0;
  for (const Stop& stop : model.scene().stops) edges += shapes_of<shape::Line>(figure, "contact " + stop.name).size();
  EXPECT_EQ(edges, 24U);
}

// The hole is as much wider than the pin as the pin is loose.
TEST(FigureBuilders, APinWithClearanceIsInItsHole) {
  const StaticModel model(parse_scene(R"([ground]
points = { A = [0, 0] }
[body.arm]
points = { A = [0, 0], B = [1, 0] }
mass = 1
[[loose_pin]]
name = "A"
points = ["ground.A", "arm.A"]
clearance = 0.05
)",
                                      "arm.toml"));
  const Figure figure = assembled_figure(model, analyse_mobility(model));
  checked(figure, "pin with clearance");
  const auto circles = shapes_of<shape::Circle>(figure, "loose pin A");
  ASSERT_EQ(circles.size(), 2U);
  EXPECT_NEAR(circles[0].radius - circles[1].radius, 0.05 * figure.drawing.view.scale, 1e-9);
}

TEST(FigureBuilders, ForcesOverARange) {
  Scene scene = read_scene(app_tests::dataset("lift"));
  scene.drives = {find_drive(scene, "obd")};
  const MotionModel model(scene);
  SweepOptions options;
  options.steps = 239;
  const ForcesAlong found = forces_over(model, {{"obd", 0.3, 0.5}}, options, true);
  const Figure figure = forces_figure(model.scene(), found, found.balanced());
  checked(figure, "forces");
  EXPECT_EQ(figure.drawing.frames.size(), most_frames(scene, true));
  const json pose = checked(forces_figure(model.scene(), forces_in_place(model), true), "forces in place");
  EXPECT_TRUE(pose["play"].is_null());
}

TEST(FigureBuilders, ModesSwingWithClosedLoops) {
  for (const char* name : {"lift", "double_pendulum"}) {
    const StaticModel statics(read_scene(app_tests::dataset(name)));
    const MotionModel model(statics.scene());
    const Equilibrium equilibrium = solve(statics);
    ASSERT_TRUE(equilibrium.found()) << equilibrium.why;
    const std::vector<double> x = motion_coordinates(model, statics, equilibrium.x);
    const Modes modes = modes_of(model, x);
    ASSERT_TRUE(modes.known) << modes.why;
    const Figure figure = modes_figure(model, x, modes, true);
    checked(figure, std::string("modes of ") + name);
    ASSERT_EQ(figure.play->marks.size(), std::min<std::size_t>(6, modes.vibrations.size())) << name;
    EXPECT_EQ(figure.drawing.frames.size(), 24 * figure.play->marks.size());
    EXPECT_TRUE(figure.play->marks[0].caption.ends_with(" Hz")) << figure.play->marks[0].caption;
    // Points that pins join stay together, and they move visibly.
    const Scene& scene = model.scene();
    const auto at = [&](PointRef p) -> const std::vector<Vec2>& {
      const std::string point = scene.name_of(p);
      return std::find_if(figure.play->points.begin(), figure.play->points.end(),
                          [&](const FollowedPoint& f) { return f.name == point; })
          ->at;
    };
    double way = 0.0;
    for (const Joint& joint : scene.joints) {
      if (joint.has_travel() || joint.keeps_length() || joint.a.body == 0 || joint.b.body == 0) continue;
      const std::vector<Vec2>&a = at(joint.a), &b = at(joint.b);
      for (std::size_t k = 0; k < a.size(); ++k) {
        EXPECT_LT(norm(a[k] - b[k]), 1e-3) << name << " " << joint.name << " " << k;
        way = std::max(way, norm(a[k] - a[0]));
      }
    }
    EXPECT_GT(way, 5.0) << name;
  }
}

TEST(FigureBuilders, Design) {
  const DesignProblem problem = read_design(app_tests::dataset("lift_design"));
  DesignOptions options;
  options.starts = 300;
  const DesignResult best = design(problem, options);
  ASSERT_FALSE(best.values.empty());
  const Figure figure = design_figure(problem, best, best.met);
  checked(figure, "design");
  EXPECT_EQ(figure.title, "The mechanism found");
}

TEST(FigureBuilders, DesignForGoals) {
  const GoalProblem problem = read_goals(app_tests::dataset("wall_bed_design"));
  const GoalDesign found = design_for_goals(problem);
  const std::vector<Figure> figures = goals_figures(problem, found);
  ASSERT_EQ(figures.size(), 2u);
  EXPECT_EQ(figures[0].title, "Before and after");
  EXPECT_EQ(figures[0].drawing.frames.size(), 2u);
  EXPECT_FALSE(figures[0].play);
  checked(figures[1], "design for goals");
  EXPECT_EQ(figures[1].play->values.front(), 0.0);
  EXPECT_EQ(figures[1].play->values.back(), 90.0);
  ASSERT_EQ(figures[1].charts.panels.size(), 1u);
  ASSERT_EQ(figures[1].charts.panels[0].curves.size(), 4u);  // after, before, both limits
  for (const double force : figures[1].charts.panels[0].curves[0].y) EXPECT_LE(std::abs(force), 25.0);
}

TEST(FigureBuilders, EveryDatasetIsDrawn) {
  int drawn = 0;
  double slowest = 0.0;
  const std::filesystem::path folder = std::filesystem::path(app_tests::dataset("zeeman")).parent_path();
  for (const auto& file : std::filesystem::recursive_directory_iterator(folder)) {
    if (file.path().extension() != ".toml") continue;
    Figure figure;
    try {
      const StaticModel model(read_scene(file.path()));
      const auto begin = std::chrono::steady_clock::now();
      figure = assembled_figure(model, analyse_mobility(model));
      slowest = std::max(slowest,
                         std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
    } catch (const InputError&) {
      continue;  // no scene
    }
    const json read = json::parse(figure_json(figure));
    EXPECT_EQ(read["drawing"]["frames"].size(), 1U) << file.path();
    EXPECT_LE(read["drawing"]["width"].get<double>(), 901.0) << file.path();
    EXPECT_LE(read["drawing"]["height"].get<double>(), 1000.0) << file.path();
    ++drawn;
  }
  std::printf("%d scenes drawn, the slowest in %.0f ms\n", drawn, slowest);
  EXPECT_GT(drawn, 40);
}

TEST(FigureBuilders, LiveFramesKeepTheirArea) {
  Scene scene = read_scene(app_tests::dataset("thesis_four_bar"));
  scene.drives = {find_drive(scene, "link4")};
  const MotionModel model(scene);
  const ForcesAlong found = forces_over(model, {{"link4", 0.0, 1.0}}, {.steps = 20}, false);
  std::optional<FrameDrawer> drawer;
  double width = 0.0;
  for (const Forces& forces : found.poses) {
    const MechanismPicture picture{.poses = poses_of(forces.motions), .reactions = forces.reactions};
    if (!drawer) drawer.emplace(model.scene(), world_of(model.scene(), picture));
    const Drawing drawing = drawer->finished({{drawer->draw(picture)}}, "live");
    EXPECT_TRUE(width == 0.0 || drawing.width == width);
    width = drawing.width;
    const Vec2 world = picture.poses[1].origin;
    EXPECT_LT(norm(drawing.view.world(drawing.view.page(world)) - world), 1e-12);
    EXPECT_EQ(json::parse(drawing_json(drawing))["frames"].size(), 1U);
  }
  EXPECT_NEAR(width, 900.0, 1e-9);
}

TEST(FigureBuilders, NothingFoundIsNothingDrawn) {
  const Scene scene = read_scene(app_tests::dataset("lift"));
  EXPECT_TRUE(kinematics_figure(scene, {}, {}, {}, false).drawing.frames.empty());
  EXPECT_TRUE(forces_figure(scene, {}, false).drawing.frames.empty());
}

}  // namespace
}  // namespace poise::app::figure_builders_test
