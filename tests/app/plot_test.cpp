#include "app/draw/chart/plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <random>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "app/draw/chart/axis.hpp"
#include "app/draw/chart/gnuplot.hpp"
#include "app/draw/chart/mark_labels.hpp"
#include "app/draw/chart/thinned.hpp"
#include "app/draw/palette.hpp"
#include "model/scene.hpp"
#include "tests/app/run_poise.hpp"

namespace poise::app::plot_test {
namespace {

using app_tests::objection_to_xml;
using app_tests::TempFolder;

#define SKIP_WITHOUT_GNUPLOT() \
  if (!has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed"

std::vector<std::string> labels(const Axis& axis) {
  std::vector<std::string> texts;
  for (const Tick& tick : axis.ticks) texts.push_back(tick.label);
  return texts;
}

/// Points of the first path in `colour` that has more than one: pixels, y down.
std::vector<std::pair<double, double>> path_of(const std::string& svg, const std::string& colour) {
  for (std::size_t at = svg.find(colour); at != std::string::npos; at = svg.find(colour, at + 1)) {
    const std::size_t begin = svg.find("d='", at) + 3;
    std::string text = svg.substr(begin, svg.find('\'', begin) - begin);
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c == 'M' || c == 'L' || c == ','; }, ' ');
    std::istringstream numbers(text);
    std::vector<std::pair<double, double>> points;
    for (double x = 0, y = 0; numbers >> x >> y;) points.emplace_back(x, y);
    if (points.size() > 2) return points;
  }
  return {};
}

TEST(PlotAxis, MarksRoundNumbers) {
  EXPECT_EQ(labels(linear_axis({0, 20}, 0.0, 8)),
            (std::vector<std::string>{"0", "2", "4", "6", "8", "10", "12", "14", "16", "18", "20"}));
  EXPECT_EQ(labels(linear_axis({-1, 1}, 0.0, 4)), (std::vector<std::string>{"-1.0", "-0.5", "0", "0.5", "1.0"}));
  EXPECT_EQ(labels(linear_axis({1e-12, 3e-12}, 0.0, 2)), (std::vector<std::string>{"1·10⁻¹²", "2·10⁻¹²", "3·10⁻¹²"}));
  EXPECT_EQ(labels(linear_axis({0, 2.5e7}, 0.0, 2)), (std::vector<std::string>{"0", "1·10⁷", "2·10⁷"}));
  for (const Tick& tick : linear_axis({1.5707, 1.5709}, 0.1, 5).ticks) {
    EXPECT_NEAR(std::stod(tick.label), tick.at, 1e-12) << "labels tell close marks apart";
  }
}

TEST(PlotAxis, HoldsAllValuesAndTheirMargin) {
  const Axis axis = linear_axis({-3, NAN, 5, std::numeric_limits<double>::infinity()}, 0.1, 5);
  EXPECT_DOUBLE_EQ(axis.low, -3.8);
  EXPECT_DOUBLE_EQ(axis.high, 5.8);
  const Axis constant = linear_axis({7.0, 7.0 * (1 + 1e-14)}, 0.1, 5);
  EXPECT_LT(constant.low, 6.5);
  EXPECT_GT(constant.high, 7.5);
  EXPECT_GE(linear_axis({}, 0.1, 5).ticks.size(), 2U);
  EXPECT_GE(linear_axis({0.0}, 0.1, 5).ticks.size(), 2U);
}

TEST(PlotAxis, LogarithmicHasWholeDecades) {
  const Axis axis = log_axis({0.02, 3e3, 0.0, -1.0, NAN}, 10);
  EXPECT_DOUBLE_EQ(axis.low, 0.01);
  EXPECT_DOUBLE_EQ(axis.high, 1e4);
  EXPECT_EQ(labels(axis), (std::vector<std::string>{"0.01", "0.1", "1", "10", "100", "1000", "10⁴"}));
  EXPECT_EQ(labels(log_axis({1e-12, 1e-2}, 5)),
            (std::vector<std::string>{"10⁻¹²", "10⁻¹⁰", "10⁻⁸", "10⁻⁶", "10⁻⁴", "0.01"}));
  EXPECT_LT(log_axis({10.0}, 5).low, log_axis({10.0}, 5).high);
}

TEST(PlotThinned, KeepsEveryPeakAndTheOrder) {
  std::vector<double> x, y;
  for (int i = 0; i < 100000; ++i) {
    x.push_back(i);
    y.push_back(std::sin(1e-3 * i));
  }
  y[12345] = 9;
  y[54321] = -9;
  y[70000] = NAN;
  const std::vector<std::size_t> kept = thinned(x, y, 1000);
  EXPECT_LE(kept.size(), 1001U);
  EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end()));
  for (std::size_t peak : {0, 12345, 54321, 70000, 99999}) {
    EXPECT_TRUE(std::binary_search(kept.begin(), kept.end(), peak)) << peak;
  }
  EXPECT_EQ(thinned({1, 2, 3}, {1, 2, 3}, 4), (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_EQ(every_kth(10, 4), (std::vector<std::size_t>{0, 3, 6, 9}));
}

TEST(Plot, IsWellFormedAndShowsWhatItWasGiven) {
  SKIP_WITHOUT_GNUPLOT();
  Panel panel{.title = "Angles & <rates>", .x_label = "time (s)", .y_label = "angle (µrad)"};
  panel.curves = {{.name = "boom's \"end\"", .x = {0, 1, 2}, .y = {0, 1, 0}},
                  {.name = "dashed", .x = {0, 2}, .y = {1, 0}, .style = Curve::Style::dashed},
                  {.name = "dots", .x = {0, 1, 2}, .y = {0.2, 0.4, 0.1}, .style = Curve::Style::points},
                  {.name = "nothing", .x = {0, 1}, .y = {NAN, NAN}}};
  panel.levels = {{.y = 0.7, .name = "limit"}};
  panel.bands = {{.low = 0.1, .high = 0.2, .name = "95 %"}};
  const std::string svg = draw_plot({panel, Panel{.log_x = true, .log_y = true}, Panel{}}, 2);
  EXPECT_EQ(objection_to_xml(svg), "");
  for (const char* part : {"Angles &amp; &lt;rates", "time (s)", "angle (µrad)", "boom’s \"end\"", "dashed", "dots",
                           "nothing", "limit", "95 %", "font-family=\"system-ui", "font-weight=\"bold\""}) {
    EXPECT_NE(svg.find(part), std::string::npos) << part;
  }
  for (const char* part : {"poise-chart", "gnuplot_plot_1a</title>", "NaN", "nan", "GNUPLOT"}) {
    EXPECT_EQ(svg.find(part), std::string::npos) << part;
  }
  EXPECT_EQ(draw_plot({panel}), draw_plot({panel})) << "no time stamps";
  EXPECT_EQ(objection_to_xml(draw_plot({})), "");
}

TEST(Plot, PutsPointsWhereTheyBelong) {
  SKIP_WITHOUT_GNUPLOT();
  const std::string blue = "rgb(  0, 114, 178)";
  Panel panel;
  panel.curves = {{.name = "", .x = {0, 1, 3}, .y = {2, 5, 2}}};
  const auto linear = path_of(draw_plot({panel}), blue);
  ASSERT_EQ(linear.size(), 3U);
  EXPECT_NEAR(linear[2].first - linear[0].first, 3 * (linear[1].first - linear[0].first), 0.1);
  EXPECT_GT(linear[1].first, linear[0].first + 200) << "x to the right";
  EXPECT_LT(linear[1].second, linear[0].second - 100) << "y upwards";
  EXPECT_NEAR(linear[2].second, linear[0].second, 0.02);

  Panel logarithmic{.log_y = true};
  logarithmic.curves = {{.name = "", .x = {0, 1, 2, 3}, .y = {1, 10, 1000, -1}}};
  const auto decades = path_of(draw_plot({logarithmic}), blue);
  ASSERT_EQ(decades.size(), 3U) << "what is not positive is left out";
  EXPECT_NEAR(decades[0].second - decades[2].second, 3 * (decades[0].second - decades[1].second), 0.1);
}

/// Linear red, green and blue of "#rrggbb".
std::array<double, 3> linear_rgb(std::string_view colour) {
  std::array<double, 3> rgb{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double c = std::stoi(std::string(colour.substr(1 + 2 * i, 2)), nullptr, 16) / 255.0;
    rgb[i] = c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
  }
  return rgb;
}

using ColourMatrix = std::array<std::array<double, 3>, 3>;

std::array<double, 3> operator*(const ColourMatrix& m, const std::array<double, 3>& v) {
  std::array<double, 3> out{};
  for (std::size_t i = 0; i < 3; ++i) out[i] = m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2];
  return out;
}

/// CIE L*a*b* for D65.
std::array<double, 3> lab(const std::array<double, 3>& rgb) {
  constexpr ColourMatrix to_xyz = {{{0.4124, 0.3576, 0.1805}, {0.2126, 0.7152, 0.0722}, {0.0193, 0.1192, 0.9505}}};
  const std::array<double, 3> xyz = to_xyz * rgb;
  const auto f = [](double t) { return t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116; };
  const double x = f(xyz[0] / 0.9505), y = f(xyz[1]), z = f(xyz[2] / 1.089);
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

TEST(Plot, ColoursOfNeighboursDifferForTheColourBlindToo) {
  // How a colour is seen with full protanopia and deuteranopia: Machado, Oliveira and Fernandes, 2009.
  constexpr ColourMatrix all = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  constexpr ColourMatrix protanopia = {
      {{0.152286, 1.052583, -0.204868}, {0.114503, 0.786281, 0.099216}, {-0.003882, -0.048116, 1.051998}}};
  constexpr ColourMatrix deuteranopia = {
      {{0.367322, 0.860646, -0.227968}, {0.280085, 0.672501, 0.047413}, {-0.011820, 0.042940, 0.968881}}};
  for (const auto value : {light_value, dark_value}) {
    for (const auto& [seen, least] :
         {std::pair(all, 55.0), std::pair(protanopia, 45.0), std::pair(deuteranopia, 45.0)}) {
      for (std::size_t i = 0; i < curve_colours; ++i) {
        const auto colour = [&, &seen = seen](std::size_t k) {
          std::array<double, 3> rgb = seen * linear_rgb(value(curve_colour(k)));
          for (double& c : rgb) c = std::clamp(c, 0.0, 1.0);
          return lab(rgb);
        };
        const std::array<double, 3> a = colour(i), b = colour(i + 1);
        EXPECT_GE(std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]), least) << i << " " << value(curve_colour(i));
      }
    }
  }
}

TEST(Plot, CoincidentCurvesShowThroughEachOther) {
  SKIP_WITHOUT_GNUPLOT();
  Panel panel;
  for (const double offset : {0.0, 1e-6, 1.0, -1e-6}) {
    panel.curves.push_back({.name = "", .x = {0, 1, 2}, .y = {offset, 2 + offset, offset}});
  }
  const std::string svg = draw_plot({panel});
  const auto dashed = [&](const std::string& colour) {
    return svg.find("stroke='" + colour + "' stroke-dasharray=") != std::string::npos;
  };
  EXPECT_FALSE(dashed("rgb(  0, 114, 178)")) << "lies below";
  EXPECT_TRUE(dashed("rgb(230, 159,   0)")) << "lies on the first";
  EXPECT_FALSE(dashed("rgb(204, 121, 167)")) << "lies elsewhere";
  EXPECT_TRUE(dashed("rgb(213,  94,   0)")) << "lies on the first two";
  EXPECT_NE(svg.find("stroke-dasharray='10.2,10.2'"), std::string::npos);
  EXPECT_NE(svg.find("stroke-dasharray='5.1,15.3'"), std::string::npos) << "leaves half of the second";
}

TEST(Plot, ChartsBelowEachOtherShareTheirAxis) {
  SKIP_WITHOUT_GNUPLOT();
  Panel upper, lower{.x_label = "time (s)"}, other{.x_label = "angle (rad)"};
  upper.curves = {{.name = "", .x = {0, 0.5, 1}, .y = {0, 1, 0}}};
  lower.curves = {{.name = "", .x = {0, 0.5, 1, 2}, .y = {0, 20000, 0, 1}, .colour = 1}};
  other.curves = {{.name = "", .x = {0, 0.5, 1}, .y = {0, 1, 0}, .colour = 2}};
  const std::string svg = draw_plot({upper, lower, other});
  const auto above = path_of(svg, "rgb(  0, 114, 178)");
  const auto below = path_of(svg, "rgb(230, 159,   0)");
  const auto own = path_of(svg, "rgb(204, 121, 167)");
  ASSERT_TRUE(above.size() == 3 && below.size() == 4 && own.size() == 3);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(above[i].first, below[i].first, 0.02) << i;
  EXPECT_NEAR(own[0].first, above[0].first, 0.02);
  EXPECT_GT(own[2].first, above[2].first + 200) << "another quantity has its own axis";
}

TEST(Plot, BreaksTheLineAtAGap) {
  SKIP_WITHOUT_GNUPLOT();
  Panel whole, broken;
  whole.curves = {{.name = "", .x = {0, 1, 2, 3, 4}, .y = {0, 1, 2, 1, 0}}};
  broken.curves = {{.name = "", .x = {0, 1, 2, 3, 4}, .y = {0, 1, NAN, 1, 0}}};
  const auto strokes = [](const std::string& svg) {
    const std::size_t begin = svg.find("d='", svg.find("stroke='rgb(  0, 114, 178)'"));
    const std::string path = svg.substr(begin, svg.find("/>", begin) - begin);
    return std::count(path.begin(), path.end(), 'M');
  };
  EXPECT_EQ(strokes(draw_plot({whole})), 1);
  EXPECT_EQ(strokes(draw_plot({broken})), 2);
}

TEST(Plot, RunsNoCommandWithinAName) {
  SKIP_WITHOUT_GNUPLOT();
  const TempFolder folder;
  const std::string touch = "touch " + folder.path("made").string();
  const std::vector<std::string> names = {
      "`" + touch + "`",    "$(" + touch + ")",   "'; system('" + touch + "')", "\nsystem('" + touch + "')\n",
      "\\\nEND\n!" + touch, "@x {/:Bold b} %s \\"};
  for (const std::string& name : names) {
    Panel panel{.title = name, .x_label = name, .y_label = name};
    panel.curves = {{.name = name, .x = {0, 1}, .y = {0, 1}}};
    panel.levels = {{.y = 1, .name = name}};
    EXPECT_EQ(objection_to_xml(draw_plot({panel})), "") << name;
  }
  EXPECT_TRUE(folder.names().empty());
  const std::string svg = draw_plot({Panel{.title = names.back()}});
  EXPECT_NE(svg.find("<text>" + names.back() + "</text>"), std::string::npos) << "shown as it is";
}

TEST(Plot, LongRecordsStaySmall) {
  SKIP_WITHOUT_GNUPLOT();
  std::mt19937 random(1);
  std::normal_distribution<double> noise;
  std::vector<Panel> panels(3);
  for (Panel& panel : panels) {
    for (const Curve::Style style : {Curve::Style::line, Curve::Style::dashed, Curve::Style::points}) {
      Curve curve{.name = "noise", .style = style};
      for (int i = 0; i < 200000; ++i) {
        curve.x.push_back(i);
        curve.y.push_back(noise(random));
      }
      panel.curves.push_back(std::move(curve));
    }
  }
  EXPECT_LT(draw_plot(panels).size(), 300000U);
  panels.front().curves.resize(1);
  const std::string one = draw_plot({panels.front()});
  EXPECT_LT(one.size(), 300000U);
  EXPECT_GT(path_of(one, "rgb(  0, 114, 178)").size(), 3000U) << "thinned no more than needed";
}

TEST(Plot, WithoutGnuplotReportsWhatToInstall) {
  const TempFolder folder;
  const char* found = std::getenv("PATH");
  const std::string path = found != nullptr ? found : "";
  ASSERT_EQ(::setenv("PATH", folder.path("").c_str(), 1), 0);
  std::string says;
  try {
    expect_plotter();
  } catch (const InputError& error) {
    says = error.what();
  }
  EXPECT_FALSE(has_gnuplot());
  EXPECT_THROW(draw_plot({Panel{}}), InputError);
  ::setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(says, "--svg: gnuplot was not found; install it (Debian: apt-get install gnuplot-nox)");
}

TEST(Plot, ReportsTheErrorOfGnuplot) {
  SKIP_WITHOUT_GNUPLOT();
  try {
    run_gnuplot("no such command\n");
    FAIL() << "must not pass for success";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("invalid command"), std::string::npos) << error.what();
  }
}

TEST(MarkLabels, StandApart) {
  const PageBox graph{0.0, 400.0, 0.0, 300.0};
  // Two marks in one place, two a few pixels apart, one in a corner.
  const std::vector<PlacedMark> marks = {
      {200.0, 150.0, "start"}, {200.5, 150.0, "1"}, {208.0, 152.0, "a"}, {213.0, 148.0, "2"}, {399.0, 1.0, "end"}};
  const std::vector<MarkLabel> texts = mark_labels(marks, graph, 12.0);
  ASSERT_EQ(texts.size(), 4u);
  EXPECT_EQ(texts.front().text, "start, 1");
  for (std::size_t i = 0; i < texts.size(); ++i) {
    const PageBox& box = texts[i].box;
    EXPECT_TRUE(box.left >= graph.left && box.right <= graph.right && box.top >= graph.top &&
                box.bottom <= graph.bottom)
        << texts[i].text;
    for (std::size_t k = 0; k < i; ++k) {
      const PageBox& other = texts[k].box;
      EXPECT_TRUE(box.left >= other.right || other.left >= box.right || box.top >= other.bottom ||
                  other.top >= box.bottom)
          << texts[i].text << " over " << texts[k].text;
    }
  }
}

}  // namespace
}  // namespace poise::app::plot_test
