#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "app/draw/canvas.hpp"
#include "app/draw/labels.hpp"
#include "app/draw/mechanism.hpp"
#include "app/draw/symbols.hpp"
#include "tests/app/run_poise.hpp"
#include "tests/app/scenes.hpp"

namespace poise::app {
namespace {

TEST(Picture, ConvexHullKeepsCornersInOrder) {
  const std::vector<Vec2> hull = convex_hull({{0, 0}, {2, 0}, {1, 1}, {2, 2}, {0, 2}, {1, 0}, {0, 0}});
  ASSERT_EQ(hull.size(), 4U);
  double area = 0.0;
  for (std::size_t i = 0; i < 4; ++i) area += cross(hull[i], hull[(i + 1) % 4]) / 2;
  EXPECT_DOUBLE_EQ(area, 4.0);
}

TEST(Picture, HullOfPointsOnALineIsItsEnds) {
  const std::vector<Vec2> hull = convex_hull({{1, 1}, {3, 3}, {0, 0}, {2, 2 + 1e-12}});
  ASSERT_EQ(hull.size(), 2U);
  EXPECT_DOUBLE_EQ(norm(hull[1] - hull[0]), std::sqrt(18.0));
  EXPECT_EQ(convex_hull({{1, 1}, {1, 1}, {1, 1}}).size(), 1U);
  EXPECT_TRUE(convex_hull({}).empty());
}

TEST(Picture, XmlIsEscaped) {
  EXPECT_EQ(escape_xml("a<b & \"c\">\x01\n\xC3\xA9"), "a&lt;b &amp; &quot;c&quot;&gt; \xC3\xA9");
}

TEST(Picture, CanvasKnowsWhatItFills) {
  Canvas canvas;
  EXPECT_TRUE(canvas.bounds().empty());
  canvas.circle({10, 20}, 5, {.stroke = "black", .width = 2});
  EXPECT_DOUBLE_EQ(canvas.bounds().low.x, 4);
  EXPECT_DOUBLE_EQ(canvas.bounds().high.y, 26);
  Canvas page;
  page.insert(canvas, "inner", {100, 0});
  EXPECT_DOUBLE_EQ(page.bounds().low.x, 104);
}

TEST(Picture, LabelsOfOnePlaceDoNotCoverEachOther) {
  Canvas canvas;
  LabelSetter setter;
  std::vector<Box> boxes;
  for (int i = 0; i < 6; ++i) {
    Canvas one;
    Label label;
    label.text = "label";
    setter.set(one, label);
    for (const Box& other : boxes) {
      const bool apart = one.bounds().low.x > other.high.x || one.bounds().high.x < other.low.x ||
                         one.bounds().low.y > other.high.y - 4 || one.bounds().high.y < other.low.y + 4;
      EXPECT_TRUE(apart) << i;
    }
    boxes.push_back(one.bounds());
  }
}

TEST(Picture, LabelKeepsOffALine) {
  LabelSetter setter;
  setter.avoid({-50, -12}, {50, -12}, 6);
  Canvas canvas;
  Label label;
  label.text = "label";
  label.toward = {0, -1};
  setter.set(canvas, label);
  EXPECT_TRUE(canvas.bounds().high.y < -9 || canvas.bounds().low.y > -15)
      << canvas.bounds().low.y << " " << canvas.bounds().high.y;
}

TEST(Picture, DashpotJoinsItsEndsAndStepsAside) {
  const Paint paint{.stroke = "black", .width = 1};
  Canvas straight;
  draw_dashpot(straight, {0, 0}, {100, 0}, {}, paint);
  EXPECT_NEAR(straight.bounds().low.x, 0, 1);
  EXPECT_NEAR(straight.bounds().high.x, 100, 1);
  EXPECT_NEAR(straight.bounds().low.y, -straight.bounds().high.y, 1e-9);
  EXPECT_LT(straight.bounds().height(), 20);
  Canvas aside;
  draw_dashpot(aside, {0, 0}, {100, 0}, {0, 20}, paint);
  EXPECT_NEAR(aside.bounds().low.y, 0, 1);
  EXPECT_NEAR(aside.bounds().high.y, 20 + straight.bounds().high.y, 1e-9);
  Canvas point;
  draw_dashpot(point, {5, 5}, {5, 5}, {}, paint);
  EXPECT_EQ(point.elements().find("nan"), std::string::npos);
}

TEST(Picture, ShowsDampers) {
  const auto figure = [](const std::string& more) {
    const StaticModel model(parse_scene(std::string(app_tests::pendulum) + more, "pendulum.toml"));
    return draw_svg(model, solve(model), {});
  };
  EXPECT_EQ(figure("").find("damper, no force in equilibrium"), std::string::npos);
  const std::string svg = figure("[[damper]]\nname = 'oil'\npoints = ['ground.O', 'rod.tip']\ncoefficient = 1\n");
  EXPECT_EQ(app_tests::objection_to_xml(svg), "");
  EXPECT_NE(svg.find("damper, no force in equilibrium"), std::string::npos);
  EXPECT_NE(svg.find(">oil<"), std::string::npos);
}

TEST(Picture, PoseWithoutExtentIsDrawn) {
  const StaticModel model(parse_scene(app_tests::against_the_stop, "stop.toml"));
  const Equilibrium rest = solve(model);
  ASSERT_TRUE(rest.found()) << rest.why;
  const std::string svg = draw_svg(model, rest, {});
  EXPECT_EQ(app_tests::objection_to_xml(svg), "");
  EXPECT_EQ(svg.find("inf"), std::string::npos);
  EXPECT_NE(svg.find("end: 7 N"), std::string::npos);
  EXPECT_EQ(svg.find("starting position"), std::string::npos);
}

TEST(Picture, ShadowShowsWhereItStarted) {
  const StaticModel model(parse_scene(app_tests::pendulum, "pendulum.toml"));
  const Equilibrium rest = solve(model);
  ASSERT_TRUE(rest.found()) << rest.why;
  EXPECT_NE(draw_svg(model, rest, model.start()).find("starting position"), std::string::npos);
  EXPECT_EQ(draw_svg(model, rest, rest.x).find("starting position"), std::string::npos) << "it did not move";
}

}  // namespace
}  // namespace poise::app
