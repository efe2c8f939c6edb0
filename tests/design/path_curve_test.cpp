#include "design/synthesis/path_curve.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "design/synthesis/path_search.hpp"
#include "model/input_error.hpp"
#include "tests/app/run_poise.hpp"

namespace poise::path_curve_test {
namespace {

constexpr double turn = 2 * std::numbers::pi;

void expect_points(const CurveLine& line, const std::vector<Vec2>& expected, double within = 1e-12) {
  ASSERT_EQ(line.points.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_LE(norm(line.points[i] - expected[i]), within) << i;
}

// SVG has y downwards, the plane upwards.
TEST(SvgCurve, LinesAbsoluteAndRelative) {
  const std::vector<Vec2> square{{1, -1}, {3, -1}, {3, -2}, {1, -2}};
  for (const char* const data : {"M1 1 L3 1 3,2 L1 2 Z", "m1,1l2 0 0 1-2 0z", "M1 1H3V2H1Z", "m 1 1 h 2 v 1 h -2 z",
                                 "M1 1 3 1 3 2 1 2 1 1", "M1-1m", "M+1e0,1.0L30e-1 1 3 2 1 2z M 7 7 L 8 8"}) {
    if (std::string(data) == "M1-1m") {
      EXPECT_EQ(svg_curve(data).points.size(), 1U);
      continue;
    }
    const CurveLine line = svg_curve(data);
    EXPECT_TRUE(line.closed) << data;
    expect_points(line, square);
  }
  EXPECT_FALSE(svg_curve("M0 0L1 0L1 1").closed);
}

TEST(SvgCurve, CircleOfArcs) {
  for (const char* const data : {"M 12 3 A 5 5 0 0 1 2 3 A 5 5 0 0 1 12 3 Z", "M12 3a5 5 0 1 0-10 0a5,5,30,1010 0",
                                 "M 12 3 A 1 1 0 0 1 2 3 1 1 0 0 1 12 3"}) {
    const CurveLine line = svg_curve(data, 50);
    EXPECT_TRUE(line.closed) << data;
    EXPECT_EQ(line.points.size(), 100U);
    for (const Vec2& p : line.points) EXPECT_NEAR(norm(p - Vec2{7, -3}), 5.0, 1e-12) << data;
    // Evenly by length: the angles between neighbours are the same.
    const std::vector<Vec2> even = spread_evenly(line, 20);
    for (std::size_t i = 0; i < 20; ++i) {
      EXPECT_NEAR(norm(even[(i + 1) % 20] - even[i]), 10 * std::sin(turn / 40), 1e-2);
    }
  }
  // Three quarters of an ellipse, turned by 30 degrees: its equation holds at all points.
  const Vec2 axis = unit(turn / 12);
  for (const Vec2& p : svg_curve("M 4 0 A 4 2 0 1 1 0 -2").points) {
    EXPECT_NEAR(p.x * p.x / 16 + p.y * p.y / 4, 1.0, 1e-12);
  }
  const Vec2 from = Vec2{4, 0} * axis, to = Vec2{0, -2} * axis;
  for (const Vec2& p : svg_curve(fmt::format("M {} {} A 4 2 30 1 1 {} {}", from.x, from.y, to.x, to.y)).points) {
    const Vec2 q = conj(p) * conj(axis);
    EXPECT_NEAR(q.x * q.x / 16 + q.y * q.y / 4, 1.0, 1e-12);
  }
}

TEST(SvgCurve, BezierCurves) {
  const auto cubic = [](const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d, double t) {
    // De Casteljau's construction gives the point.
    const auto mix = [&](const Vec2& p, const Vec2& q) { return (1 - t) * p + t * q; };
    const Vec2 ab = mix(a, b), bc = mix(b, c), cd = mix(c, d);
    return conj(mix(mix(ab, bc), mix(bc, cd)));
  };
  std::vector<Vec2> expected{{0, 0}};
  for (int k = 1; k <= 4; ++k) expected.push_back(cubic({0, 0}, {1, 3}, {4, 3}, {5, 0}, k / 4.0));
  for (int k = 1; k <= 4; ++k) expected.push_back(cubic({5, 0}, {6, -3}, {8, 1}, {9, 0}, k / 4.0));
  expect_points(svg_curve("M0 0C1 3 4 3 5 0S8 1 9 0", 4), expected);
  expect_points(svg_curve("m0 0c1 3 4 3 5 0s3 1 4 0", 4), expected);
  // A square curve is the cubic one with controls at two thirds.
  expected = {{0, 0}};
  for (int k = 1; k <= 4; ++k) expected.push_back(cubic({0, 0}, {2, 4}, {4, 4}, {6, 0}, k / 4.0));
  for (int k = 1; k <= 4; ++k) expected.push_back(cubic({6, 0}, {8, -4}, {8, -4}, {6, 0}, k / 4.0));
  expect_points(svg_curve("M0 0Q3 6 6 0T6 0", 4), expected);
}

TEST(SvgCurve, WhatIsWrongIsSaid) {
  for (const char* const data :
       {"", "   ", "L 1 1", "M", "M 1", "M 1 1 L", "M 1 1 X 2 2", "M 1 1 L 2 two", "M 1 1 A 1 1 0 2 0 3 3",
        "M 1 1 A 1 1 0 0", "M 1e99 1", "M 1 1 L 1e400 1", "M nan 0", "M 0 0 C 1 1 2 2", "M 1 1 z 3"}) {
    if (std::string(data) == "M 1 1 z 3") {
      EXPECT_TRUE(svg_curve(data).closed);
      continue;
    }
    EXPECT_THROW(svg_curve(data), InputError) << data;
  }
  EXPECT_EQ(svg_path_data("<svg><path id='d' fill=\"none\" d = 'M0 0L1 1'/></svg>"), "M0 0L1 1");
  for (const char* const text : {"", "<svg/>", "<path", "<path d", "<path d=", "<path d=\"M0 0", "<path id=\"a\"/>"}) {
    EXPECT_THROW(svg_path_data(text), InputError) << text;
  }
}

TEST(CurveFiles, AreReadAndRefused) {
  const app_tests::TempFolder folder;
  const auto curve = [&](const std::string& name, const std::string& text) {
    return read_curve_file(folder.write(name, text));
  };
  EXPECT_FALSE(curve("a.csv", "x,y\n0,0\n1,0\n2,1\n3,3\n").closed);
  EXPECT_TRUE(curve("b.csv", "x,y\n0,0\n1,0\n1,1\n0,1\n").closed);
  EXPECT_EQ(curve("c.csv", "t;x;y\n0;0;0\n1;1;0\n2;1;1\n3;0;1\n4;0;0\n").points.size(), 4U);
  EXPECT_TRUE(curve("a.svg", "<svg><path d=\"M0 0H1V1Z\"/></svg>").closed);
  EXPECT_THROW(curve("d.csv", "x,y\n0,0\n1,0\n"), InputError);
  EXPECT_THROW(curve("e.csv", "x,z\n0,0\n1,0\n2,0\n"), InputError);
  EXPECT_THROW(curve("f.svg", "<svg><path d=\"M0 0\"/></svg>"), InputError);
}

// A drawn bean: the curve of a four-bar, by places that are not even, with the wobble of a hand.
TEST(CurveSynthesis, DrawnCurveOfAFourBar) {
  const FourBar linkage{{10, 5}, {50, 12}, 14, 38, 33, {24, 19}};
  const app_tests::TempFolder folder;
  for (const double wobble : {0.0, 0.1}) {
    std::string text = "x,y\n";
    for (int k = 0; k < 90; ++k) {
      const double angle = turn * k / 90 + 0.01 * std::sin(3.0 * k);
      const Vec2 p = pose_of(linkage, angle, 1)->point;
      text += fmt::format("{},{}\n", p.x + wobble * std::sin(0.7 * k), p.y + wobble * std::cos(1.1 * k));
    }
    folder.write("bean.csv", text);
    const PathProblem problem = read_path_problem(folder.write(
        "bean.toml",
        "[units]\nlength = \"mm\"\n[synthesis]\nkind = \"path\"\ncurve = \"bean.csv\"\nfull_turn = true\n"));
    EXPECT_TRUE(problem.closed);
    PathSearchOptions options;
    options.starts = 24;
    const PathAnswer answer = search_paths(problem, options);
    ASSERT_FALSE(answer.solutions.empty());
    const PathSolution& best = answer.solutions.front();
    EXPECT_FALSE(best.defects.any());
    EXPECT_TRUE(best.range.full());
    // The chords between 90 places are off the curve by up to 0.03 mm; the curve is 30 mm wide.
    EXPECT_LE(best.curve_largest, (0.05 + 2 * wobble) * 1e-3) << wobble;
    // Both ways: the whole coupler curve is near the drawn one.
    const FourBar found = four_bar_of(best.x);
    for (int k = 0; k < 360; ++k) {
      const auto pose = pose_of(found, turn * k / 360, best.visits.front().closure);
      ASSERT_TRUE(pose.has_value());
      double nearest = 1e300;
      for (int j = 0; j < 3600; ++j) {
        nearest = std::min(nearest, norm(1e-3 * pose_of(linkage, turn * j / 3600, 1)->point - pose->point));
      }
      EXPECT_LE(nearest, (0.05 + 2 * wobble) * 1e-3);
    }
  }
}

}  // namespace
}  // namespace poise::path_curve_test
