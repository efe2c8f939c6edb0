// Points of the curves of slots and cams as numbers: exact derivatives against differences, expressions, files.

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/parameters.hpp"
#include "model/profile.hpp"
#include "model/rewritten_scene.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/model/varied_scene.hpp"
#include "statics/paths/path.hpp"
#include "statics/sensitivity/sensitivity.hpp"
#include "statics/sensitivity/tolerance.hpp"
#include "tests/support/elements.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/message_of.hpp"

namespace poise::statics_curve_points_test {
namespace {

// A weight on a bent wire, pulled by a spring.
std::string wire(const std::string& more = "", const std::string& curve = "") {
  return fmt::format(R"(
gravity = [0, -10000]
[numbers]
r = 100
[units]
length = "mm"
[ground]
points = {{ O = [0, 0], S = [150, 300] }}
[body.bead]
points = {{ P = [0, 0] }}
mass = 2
[[curved_slot]]
name = "wire"
pin = "bead.P"
at = "ground.O"
curve = {}
{}
[[spring]]
points = ["ground.S", "bead.P"]
stiffness = 0.2
free_length = 50
[start]
wire = 200
)",
                     curve.empty() ? "[[-100, 80], [\"-r/2\", 20], [30, -20], [\"r\", \"0.3*r\"], [180, 120]]" : curve,
                     more);
}

std::string ring() { return wire("closed = true", "[[-100, 80], [-50, 20], [30, -20], [100, 30], [60, 150]]"); }

// A cam of a spline that a spring holds, its follower under a weight.
const std::string cam = R"(
gravity = [0, -10]
[units]
angle = "deg"
[ground]
points = { O = [0, 0] }
[body.cam]
points = { O = [0, 0] }
[body.follower]
points = { R = [0, 0] }
mass = 2
[[pin]]
name = "shaft"
points = ["ground.O", "cam.O"]
[[slide]]
name = "guide"
points = ["ground.O", "follower.R"]
axis = [0, 1]
[[cam]]
name = "eccentric"
bodies = ["ground", "cam"]
follower = { slide = "guide" }
curve = [[0, 0.1], [80, 0.4], [170, 1], [250, 0.6], [360, 0.1]]
phase = 10
lift = 0.02
base = 0.05
guided = true
[[torsion_spring]]
name = "holder"
bodies = ["ground", "cam"]
stiffness = 0.02
free_angle = 100
[start]
cam = 80
guide = 0.06
)";

std::vector<std::string> numbers_of(const Scene& scene, const std::string& prefix) {
  std::vector<std::string> out;
  for (const ParameterRow& row : parameter_table(scene)) {
    if (row.path.text().starts_with(prefix)) out.push_back(row.path.text());
  }
  return out;
}

/// Derivatives of a quantity by these numbers against central differences.
void expect_derivatives(const Scene& scene, const std::string& quantity, const std::vector<std::string>& numbers) {
  const auto value = [&](const Scene& at) {
    const StaticModel model(at);
    const Sensitivities found = sensitivities(model, {find_quantity(at, quantity)});
    EXPECT_EQ(found.of.size(), 1U) << found.why;
    return found.of.at(0);
  };
  const QuantitySensitivity exact = value(scene);
  std::size_t seen = 0;
  for (const Sensitivity& by : exact.by) {
    if (std::find(numbers.begin(), numbers.end(), by.number) == numbers.end()) continue;
    ++seen;
    EXPECT_EQ(by.why, "") << by.number;
    const double unit = value_unit(scene, by.number), h = 1e-5 * std::max(1.0, 0.1 / unit);
    const auto moved = [&](double change) {
      Scene other = scene;
      set_value(other, by.number, get_value(scene, by.number) + change);
      return value(other).value;
    };
    const double slope = (8 * (moved(h) - moved(-h)) - (moved(2 * h) - moved(-2 * h))) / (12 * h * unit);
    EXPECT_NEAR(by.derivative, slope, 2e-7 * (1.0 + std::abs(slope))) << quantity << " by " << by.number;
  }
  EXPECT_EQ(seen, numbers.size());
}

TEST(CurvePoints, OfASlotHaveTheirExactDerivatives) {
  for (const std::string& text : {wire("", "[[-100, 80], [-50, 20], [30, -20], [100, 30], [180, 120]]"), ring()}) {
    const Scene scene = parse_scene(text, "wire.toml");
    const std::vector<std::string> points = numbers_of(scene, "curved_slot.wire.curve.");
    EXPECT_EQ(points.size(), 10U);
    expect_derivatives(scene, "travel.wire", points);
    expect_derivatives(scene, "bead.P.x", points);
    expect_derivatives(scene, "stop.wire x", points);
  }
}

// A bead that presses on the end of its slot, which is the end of its curve.
TEST(CurvePoints, MoveTheEndOfTheSlot) {
  std::string text = wire("", "[[-100, 80], [-50, 20], [30, -20], [100, 30], [180, 120]]");
  text.replace(text.find("stiffness = 0.2"), 15, "stiffness = 2.0");
  const Scene scene = parse_scene(text, "wire.toml");
  const StaticModel model(scene);
  const Equilibrium found = solve(model, test::by(Method::virtual_work, Seek::stable));
  ASSERT_TRUE(found.found()) << found.why;
  EXPECT_NEAR(test::place_of(model, found.x, "bead.P").x, 0.18, 1e-12) << "it is at the end";
  std::vector<std::string> numbers = numbers_of(scene, "curved_slot.wire.curve.");
  numbers.emplace_back("curved_slot.wire.to");
  expect_derivatives(scene, "bead.P.y", numbers);
  Scene longer = scene;
  set_value(longer, "curved_slot.wire.curve.5.y", 150);
  EXPECT_NEAR(get_value(longer, "curved_slot.wire.to") - get_value(scene, "curved_slot.wire.to"),
              std::hypot(80, 120) - std::hypot(80, 90), 1e-11);
  set_value(longer, "curved_slot.wire.to", 210);
  set_value(longer, "curved_slot.wire.curve.5.y", 120);
  EXPECT_NEAR(get_value(longer, "curved_slot.wire.to"), 210, 1e-12) << "an end that is given stays";
}

TEST(CurvePoints, OfACamHaveTheirExactDerivatives) {
  const Scene scene = parse_scene(cam, "cam.toml");
  const std::vector<std::string> points = numbers_of(scene, "cam.eccentric.curve.");
  EXPECT_EQ(points.size(), 4U) << "the last point is the first";
  expect_derivatives(scene, "angle.cam", points);
  expect_derivatives(scene, "travel.guide", points);
  expect_derivatives(scene, "angle.cam", {"cam.eccentric.phase", "cam.eccentric.lift"});
}

// Reading a file with other points gives the same scene.
TEST(CurvePoints, AreThoseOfTheFile) {
  const auto same = [](const Scene& a, const Scene& b) {
    ASSERT_EQ(a.stops.size(), b.stops.size());
    for (std::size_t s = 0; s < a.stops.size(); ++s) {
      EXPECT_EQ(a.stops[s].max, b.stops[s].max);
      for (std::size_t t = 0; t < a.stops[s].on.terms.size(); ++t) {
        const Measure::Term &one = a.stops[s].on.terms[t], &other = b.stops[s].on.terms[t];
        if (!one.profile) continue;
        EXPECT_EQ(one.span, other.span);
        for (const double u : {-0.2, 0.1, 0.55, 0.97, 1.3}) {
          EXPECT_DOUBLE_EQ(one.profile->at(u).value, other.profile->at(u).value);
        }
      }
    }
  };
  Scene scene = parse_scene(wire(), "wire.toml");
  set_value(scene, "curved_slot.wire.curve.3.y", -35);
  set_value(scene, "numbers.r", 110);
  const std::string written = rewritten_scene(wire(), "wire.toml", scene);
  EXPECT_NE(written.find("[\"-r/2\", 20], [30, -35.0], [\"r\", \"0.3*r\"]"), std::string::npos) << written;
  EXPECT_EQ(written.find("to ="), std::string::npos) << "the end follows";
  same(parse_scene(written, "wire.toml"), scene);
  EXPECT_EQ(get_value(scene, "curved_slot.wire.curve.4.x"), 110);
  EXPECT_NE(test::message_of([&] { set_value(scene, "curved_slot.wire.curve.4.x", 1); }).find("change numbers.r"),
            std::string::npos);

  Scene turned = parse_scene(cam, "cam.toml");
  set_value(turned, "cam.eccentric.curve.1", 0.2);
  set_value(turned, "cam.eccentric.curve.4", 0.7);
  const std::string again = rewritten_scene(cam, "cam.toml", turned);
  EXPECT_NE(again.find("[[0, 0.2], [80, 0.4], [170, 1], [250, 0.7], [360, 0.2]]"), std::string::npos) << again;
  same(parse_scene(again, "cam.toml"), turned);
}

TEST(CurvePoints, OfACamMayBeExpressions) {
  std::string text = cam + "[numbers]\ndip = 0.1\n";
  for (const char* angle : {"[0, ", "[360, "}) {
    const std::size_t at = text.find(angle + std::string("0.1]"));
    text.replace(at + std::string(angle).size(), 3, "\"dip\"");
  }
  Scene scene = parse_scene(text, "cam.toml");
  set_value(scene, "numbers.dip", 0.3);
  EXPECT_EQ(scene.stops[0].on.terms[1].profile->at(0.0).value, 0.3);
  expect_derivatives(scene, "angle.cam", {"numbers.dip"});
  text.replace(text.find("\"dip\"]]"), 5, "0.1");
  EXPECT_NE(test::message_of([&] { parse_scene(text, "cam.toml"); }).find("expected the same expression"),
            std::string::npos);
}

TEST(CurvePoints, AreScaledWithTheirScene) {
  const Scene scene = parse_scene(wire(), "wire.toml");
  const Scales scales{.length = 0.25, .force = 8.0};
  Scene small = scaled(scene, scales);
  const double here = small.stops[1].on.terms[1].factor * small.stops[1].on.terms[1].profile->at(0.3).value;
  EXPECT_EQ(here, 4 * scene.stops[1].on.terms[1].factor * scene.stops[1].on.terms[1].profile->at(0.3).value);
  Scene changed = scene;
  set_value(changed, "curved_slot.wire.curve.1.x", -120);
  set_value_at(small, parameter(scene, "curved_slot.wire.curve.1.x").place, 4 * -0.12);
  EXPECT_EQ(small.stops[0].max, 4 * changed.stops[0].max);
  EXPECT_NEAR(small.stops[1].on.terms[1].profile->at(0.3).value, changed.stops[1].on.terms[1].profile->at(0.3).value,
              1e-15);
}

TEST(CurvePoints, MustDiffer) {
  Scene scene = parse_scene(wire("", "[[-100, 80], [-50, 80], [30, -20], [100, 30]]"), "wire.toml");
  EXPECT_EQ(test::message_of([&] { set_value(scene, "curved_slot.wire.curve.2.x", -100); }),
            "curved_slot.wire.curve.2.x: expected points that differ from those before, found points 1 and 2 of the "
            "curve in one place");
  EXPECT_EQ(get_value(scene, "curved_slot.wire.curve.2.x"), -50) << "nothing has changed";
  EXPECT_NE(scene.stops[0].max, 0.0);
}

// Along a path of a point every equilibrium is that of the scene with it.
TEST(CurvePoints, VaryAlongPaths) {
  for (const auto& [text, name, from, to] : {std::tuple{wire(), std::string("curved_slot.wire.curve.3.y"), -20.0, 15.0},
                                             std::tuple{wire(), std::string("numbers.r"), 100.0, 120.0},
                                             std::tuple{cam, std::string("cam.eccentric.curve.2"), 0.4, 0.55}}) {
    SCOPED_TRACE(name);
    const VariedScene varied(parse_scene(text, "scene.toml"), name, from, to);
    PathOptions options;
    options.certify = false;
    const Path found = path(varied, options);
    ASSERT_FALSE(found.branches.empty());
    const PathPoint& last = found.branches[0].points.back();
    Scene scene = parse_scene(text, "scene.toml");
    EXPECT_DOUBLE_EQ(last.parameter, to * value_unit(scene, name));
    set_value(scene, name, to);
    const StaticModel there(scene);
    const Equilibrium rest = solve(there, test::by(Method::virtual_work, Seek::stable));
    ASSERT_TRUE(rest.found()) << rest.why;
    EXPECT_NEAR(varied.model_at(last.parameter)->poses(last.x)[1].origin.x, there.poses(rest.x)[1].origin.x, 1e-8);
    EXPECT_NEAR(varied.model_at(last.parameter)->poses(last.x)[1].angle, there.poses(rest.x)[1].angle, 1e-8);
  }
}

}  // namespace
}  // namespace poise::statics_curve_points_test
