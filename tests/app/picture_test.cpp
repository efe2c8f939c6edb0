#include <algorithm>
#include <cmath>
#include <limits>
#include <regex>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "app/draw/canvas.hpp"
#include "app/draw/labels.hpp"
#include "app/draw/mechanism.hpp"
#include "app/draw/symbols.hpp"
#include "tests/app/run_poise.hpp"
#include "tests/app/scenes.hpp"
#include "tests/support/random_mechanism.hpp"

namespace poise::app::picture_test {
namespace {

/// What a group of a picture holds; the groups asked for have no groups inside.
std::string group(const std::string& svg, const std::string& id) {
  const std::size_t begin = svg.find("<g id=\"" + id + "\">");
  if (begin == std::string::npos) return "";
  return svg.substr(begin, svg.find("</g>", begin) - begin);
}

std::vector<double> numbers_in(const std::string& text) {
  static const std::regex number("-?[0-9]+[.]?[0-9]*");
  std::vector<double> numbers;
  for (std::sregex_iterator it(text.begin(), text.end(), number), end; it != end; ++it) {
    numbers.push_back(std::stod(it->str()));
  }
  return numbers;
}

/// The points of every element of that kind: its attributes that hold coordinates, in pairs.
std::vector<std::vector<Vec2>> shapes(const std::string& elements, const std::string& form) {
  std::vector<std::vector<Vec2>> found;
  const std::regex element(form);
  for (std::sregex_iterator it(elements.begin(), elements.end(), element), end; it != end; ++it) {
    std::vector<double> numbers;
    for (std::size_t i = 1; i < it->size(); ++i) {
      const std::vector<double> more = numbers_in((*it)[i].str());
      numbers.insert(numbers.end(), more.begin(), more.end());
    }
    std::vector<Vec2> points;
    for (std::size_t i = 0; i + 1 < numbers.size(); i += 2) points.push_back({numbers[i], numbers[i + 1]});
    found.push_back(points);
  }
  return found;
}

constexpr const char* polyline = "<polyline points=\"([^\"]*)\"";
constexpr const char* polygon = "<polygon points=\"([^\"]*)\"";
constexpr const char* circle = "<circle cx=\"([^\"]*)\" cy=\"([^\"]*)\"";
constexpr const char* line = "<line x1=\"([^\"]*)\" y1=\"([^\"]*)\" x2=\"([^\"]*)\" y2=\"([^\"]*)\"";

Vec2 mean(const std::vector<Vec2>& points) {
  Vec2 sum{};
  for (const Vec2& p : points) sum += p;
  return (1.0 / static_cast<double>(points.size())) * sum;
}

/// Pins and blocks of a picture.
std::vector<Vec2> joints_of(const std::string& svg) {
  std::vector<Vec2> places;
  for (const char* form : {circle, polygon}) {
    for (const auto& shape : shapes(group(svg, "joints"), form)) places.push_back(mean(shape));
  }
  return places;
}

std::string picture_of(const test::PlantedMechanism& planted) {
  const StaticModel model(planted.in_equilibrium);
  const std::vector<double> x = model.from_si(planted.equilibrium);
  return draw_mechanism(model.scene(), {.poses = model.poses(x), .reactions = check(model, x).reactions});
}

/// Springs and dampers that lie on each other: nearly parallel, less than 7 px apart, one beside the other.
int lying_on_each_other(const std::string& svg) {
  constexpr std::size_t fewest_of_a_spring = 8;
  std::vector<std::vector<Vec2>> springs;
  for (const auto& shape : shapes(group(svg, "springs-and-dampers"), polyline)) {
    if (shape.size() >= fewest_of_a_spring && norm(shape.back() - shape.front()) > 10.0) springs.push_back(shape);
  }
  int count = 0;
  for (std::size_t i = 0; i < springs.size(); ++i) {
    const Vec2 d = springs[i].back() - springs[i].front();
    const Vec2 u = (1 / norm(d)) * d;
    for (std::size_t k = 0; k < i; ++k) {
      const Vec2 e = springs[k].back() - springs[k].front();
      const Vec2 apart = mean(springs[k]) - mean(springs[i]);
      const bool parallel = std::abs(cross(u, e)) < 0.03 * norm(e);
      const bool beside = std::abs(dot(u, apart)) < 0.3 * (norm(d) + norm(e));
      if (parallel && beside && std::abs(cross(u, apart)) < 7.0) ++count;
    }
  }
  return count;
}

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

TEST(Picture, CanvasHasTheBoxOfItsElements) {
  Canvas canvas;
  EXPECT_TRUE(canvas.bounds().empty());
  canvas.circle({10, 20}, 5, {.stroke = ink::dark, .width = 2});
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
  const Paint paint{.stroke = ink::dark, .width = 1};
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

TEST(Picture, ArrowsOfJointForcesLeaveTheirJoint) {
  int arrows = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const std::string svg = picture_of(test::plant_mechanism(seed, {.loops = static_cast<int>(seed % 3)}));
    EXPECT_EQ(app_tests::objection_to_xml(svg), "") << seed;
    const std::vector<Vec2> joints = joints_of(svg);
    for (const std::vector<Vec2>& arrow : shapes(group(svg, "reactions"), line)) {
      const auto nearest = *std::min_element(joints.begin(), joints.end(),
                                             [&](Vec2 a, Vec2 b) { return norm(a - arrow[0]) < norm(b - arrow[0]); });
      EXPECT_LT(norm(arrow[0] - nearest), 5.0) << "seed " << seed << ": the tail is at a joint";
      EXPECT_GT(norm(arrow[1] - nearest), norm(arrow[0] - nearest)) << "seed " << seed << ": it leaves the joint";
      ++arrows;
    }
  }
  EXPECT_GT(arrows, 100);
}

TEST(Picture, JointForceNamesTheBodyItActsOn) {
  const StaticModel model(parse_scene(app_tests::pendulum, "pendulum.toml"));
  const std::string svg = draw_svg(model, solve(model), {});
  const std::vector<std::vector<Vec2>> arrows = shapes(group(svg, "reactions"), line);
  ASSERT_EQ(arrows.size(), 1U);
  EXPECT_NE(svg.find(">hinge: 6 N on rod<"), std::string::npos);
  EXPECT_LT(arrows[0][1].y, arrows[0][0].y) << "the pin holds the rod up: away from it";
}

TEST(Picture, SpringsAndDampersLieBesideEachOther) {
  std::string scene = app_tests::pendulum;
  for (const char* name : {"one", "two", "three"}) {
    scene += std::string("[[spring]]\nname = '") + name +
             "'\npoints = ['ground.O', 'rod.tip']\nstiffness = 1\nfree_length = 1\n";
  }
  scene += "[[spring]]\nname = 'four'\npoints = ['rod.tip', 'ground.O']\nstiffness = 1\nfree_length = 1\n";
  const StaticModel model(parse_scene(scene, "springs.toml"));
  const std::string svg = draw_svg(model, solve(model), {});
  EXPECT_EQ(shapes(group(svg, "springs-and-dampers"), polyline).size(), 4U);
  EXPECT_EQ(lying_on_each_other(svg), 0);
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    EXPECT_EQ(lying_on_each_other(picture_of(test::plant_mechanism(seed, {.loops = static_cast<int>(seed % 3)}))), 0)
        << seed;
  }
}

TEST(Picture, SlideBetweenPinnedBodiesIsACylinder) {
  const StaticModel model(read_scene(app_tests::dataset("lift")));
  const std::string svg = draw_mechanism(model.scene(), {.poses = model.poses(model.start())});
  EXPECT_TRUE(shapes(group(svg, "guides"), line).empty());
  EXPECT_EQ(shapes(group(svg, "joints"), polygon).size(), 2U) << "the welds of payload and lump, no block";
  EXPECT_EQ(svg.find(">oil = "), std::string::npos) << "no forces were asked for";
  EXPECT_NE(svg.find(">oil<"), std::string::npos);
  EXPECT_NE(svg.find(">spring<"), std::string::npos);
}

TEST(Picture, TextKeepsItsSizeInAWideMechanism) {
  const std::string scene =
      "title = 'Fifty to one'\n[ground]\npoints = { left = [0, 0] }\n[body.beam]\npoints = { left = [0, 0], "
      "right = [50, 1] }\n[[pin]]\nname = 'a bearing with a long name'\npoints = ['ground.left', 'beam.left']\n"
      "[[force]]\nname = 'a load with a name that is long too'\nat = 'beam.right'\nvector = [1000, 0]\n";
  const StaticModel model(parse_scene(scene, "wide.toml"));
  const std::string svg = draw_svg(model, solve(model), model.start());
  EXPECT_NE(svg.find("width=\"900\""), std::string::npos);
  EXPECT_NE(svg.find("viewBox=\"0 0 900 "), std::string::npos);
  const std::regex size("font-size=\"([0-9.]+)\"");
  int texts = 0;
  for (std::sregex_iterator it(svg.begin(), svg.end(), size), end; it != end; ++it, ++texts) {
    EXPECT_GE(std::stod((*it)[1].str()), 10.0);
  }
  EXPECT_GT(texts, 8);
}

TEST(Picture, ShowsOtherPositionsAndPaths) {
  const StaticModel model(parse_scene(app_tests::pendulum, "pendulum.toml"));
  MechanismPicture picture{.poses = model.poses({-1.0}), .heading = "Driven", .loads = false};
  for (const auto& [name, angle] : {std::pair("start", -2.0), std::pair("end", 0.0)}) {
    picture.others.push_back({name, model.poses({angle})});
  }
  PointPath path{.name = "rod.tip", .points = {}};
  for (int i = 0; i <= 20; ++i) path.points.push_back(2.0 * unit(-2.0 + 0.1 * i));
  picture.paths.push_back(path);
  const std::string svg = draw_mechanism(model.scene(), picture);
  EXPECT_EQ(app_tests::objection_to_xml(svg), "");
  for (const char* part : {">Driven<", ">start<", ">end<", "other positions", ">rod.tip<", "path of the point named"}) {
    EXPECT_NE(svg.find(part), std::string::npos) << part;
  }
  EXPECT_EQ(shapes(group(svg, "paths"), polyline).front().size(), path.points.size());
  EXPECT_EQ(svg.find("id=\"reactions\""), std::string::npos);
  EXPECT_EQ(svg.find(">load<"), std::string::npos);

  const std::string twice = stacked(svg, svg);
  EXPECT_EQ(app_tests::objection_to_xml(twice), "");
  const auto height = [](const std::string& text) { return numbers_in(text.substr(text.find(" height="))).front(); };
  EXPECT_DOUBLE_EQ(height(twice), 2 * height(svg));
}

TEST(Picture, ShowsTheEffortOfADrive) {
  const StaticModel model(parse_scene(
      std::string(app_tests::pendulum) + "[[drive]]\nname = 'motor'\nbodies = ['ground', 'rod']\n", "pendulum.toml"));
  MechanismPicture picture{.poses = model.poses({0.0})};
  picture.drives.push_back({.name = "motor", .value = -12.0});
  const std::string svg = draw_mechanism(model.scene(), picture);
  EXPECT_NE(svg.find(">motor = 12 N m<"), std::string::npos);
  EXPECT_NE(svg.find(">drive<"), std::string::npos);
}

TEST(Picture, PoseWithoutExtentIsDrawn) {
  const StaticModel model(parse_scene(app_tests::against_the_stop, "stop.toml"));
  const Equilibrium equilibrium = solve(model);
  ASSERT_TRUE(equilibrium.found()) << equilibrium.why;
  const std::string svg = draw_svg(model, equilibrium, {});
  EXPECT_EQ(app_tests::objection_to_xml(svg), "");
  EXPECT_EQ(svg.find("inf"), std::string::npos);
  EXPECT_NE(svg.find("end: 7 N"), std::string::npos);
  EXPECT_EQ(svg.find("starting position"), std::string::npos);
}

TEST(Picture, FarFromTheOriginItIsDrawnAsNearIt) {
  const auto arrows_at = [](double x) {
    Scene scene = parse_scene(app_tests::pendulum, "pendulum.toml");
    scene.bodies[0].points[0].at.x = x;
    const StaticModel model(scene);
    const Equilibrium equilibrium = solve(model);
    EXPECT_TRUE(equilibrium.found()) << equilibrium.why;
    const std::string svg = draw_svg(model, equilibrium, {});
    EXPECT_EQ(svg.find("nan"), std::string::npos) << x;
    return shapes(group(svg, "reactions"), line);
  };
  const auto near = arrows_at(0.0), far = arrows_at(1e9);
  ASSERT_EQ(near.size(), far.size());
  for (std::size_t i = 0; i < near.size(); ++i) EXPECT_LT(norm(near[i][0] - far[i][0]), 0.1);
  arrows_at(1e18);
}

TEST(Picture, ShadowShowsWhereItStarted) {
  const StaticModel model(parse_scene(app_tests::pendulum, "pendulum.toml"));
  const Equilibrium equilibrium = solve(model);
  ASSERT_TRUE(equilibrium.found()) << equilibrium.why;
  EXPECT_NE(draw_svg(model, equilibrium, model.start()).find("starting position"), std::string::npos);
  EXPECT_EQ(draw_svg(model, equilibrium, equilibrium.x).find("starting position"), std::string::npos)
      << "it did not move";
}

}  // namespace
}  // namespace poise::app::picture_test
