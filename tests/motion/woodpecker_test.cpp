// The woodpecker toy: a sleeve that jams on its pole, a spring and a bird that pecks at it, which together fall in a
// limit cycle of impacts, friction that sticks and slips, and lift-off.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/joint_friction.hpp"
#include "model/read_scene.hpp"
#include "motion/simulate.hpp"
#include "tests/support/motions.hpp"

namespace poise::woodpecker_test {
namespace {

using Kind = ContactEvent::Kind;

// Small angles M of the sleeve and S of the bird are travels, whose inertias (kg m2) are masses; the bird is at
// y + lM M + lG S. Beak and edges of the sleeve are points whose x is the gap and whose y is the way along the pole.
// Data and values: ../shared/benchmarks.md 1.1, after R. I. Leine, C. Glocker, D. H. van Campen, "The Woodpecker Toy",
// ASME DETC 2001.
const char* const toy = R"(gravity = [0, -9.81]
[ground]
points = { O = [0, 0] }
[body.sleeve]
points = { C = [0, 0] }
mass = 3e-4
[body.bird]
points = { C = [0, 0] }
mass = 4.5e-3
[body.turn_sleeve]
points = { C = [0, 0] }
mass = 5e-9
[body.turn_bird]
points = { C = [0, 0] }
mass = 7e-7
[[slide]]
name = "y"
points = ["ground.O", "sleeve.C"]
axis = [0, 1]
[[slide]]
name = "z"
points = ["ground.O", "bird.C"]
axis = [0, 1]
[[slide]]
name = "M"
points = ["ground.O", "turn_sleeve.C"]
axis = [1, 0]
[[slide]]
name = "S"
points = ["ground.O", "turn_bird.C"]
axis = [1, 0]
[[coupling]]
name = "arm"
sum = [{ factor = 1, slide = "z" }, { factor = -1, slide = "y" }, { factor = -1e-2, slide = "M" }, { factor = -1.5e-2, slide = "S" }]
value = 0
[[spring]]
name = "c"
sum = [{ factor = 1, slide = "M" }, { factor = -1, slide = "S" }]
stiffness = 5.6e-3
free_length = 0
[body.beak_x]
points = { C = [0, 0] }
[body.beak]
points = { C = [0, 0] }
[[slide]]
name = "bx"
points = ["ground.O", "beak_x.C"]
axis = [1, 0]
[[slide]]
name = "by"
points = ["beak_x.C", "beak.C"]
axis = [0, 1]
[[coupling]]
name = "beak gap"
sum = [{ factor = 1, slide = "bx" }, { factor = 2e-2, slide = "S" }]
value = 2.4e-3
[[coupling]]
name = "beak way"
sum = [{ factor = 1, slide = "by" }, { factor = -1, slide = "y" }, { factor = -1e-2, slide = "M" }, { factor = 5.1e-3, slide = "S" }]
value = 0
[[stop]]
name = "beak"
x = "beak.C"
min = 0
restitution = 0.5
friction = 0.3
law = "newton"
[body.edge_x]
points = { C = [0, 0] }
[body.edge]
points = { C = [0, 0] }
[[slide]]
name = "ex"
points = ["ground.O", "edge_x.C"]
axis = [1, 0]
[[slide]]
name = "ey"
points = ["edge_x.C", "edge.C"]
axis = [0, 1]
[[coupling]]
name = "edge gap"
sum = [{ factor = 1, slide = "ex" }, { factor = -5.8e-3, slide = "M" }]
value = 0
[[coupling]]
name = "edge way"
sum = [{ factor = 1, slide = "ey" }, { factor = -1, slide = "y" }, { factor = -3.1e-3, slide = "M" }]
value = 0
[[stop]]
name = "lower"
x = "edge.C"
min = -6e-4
friction = 0.3
law = "newton"
[[stop]]
name = "upper"
x = "edge.C"
max = 6e-4
friction = 0.3
law = "newton"
)";

/// It begins where the lower edge breaks loose.
std::string breaking_loose() {
  const double M = -6e-4 / 5.8e-3, S = -0.20513535;
  return fmt::format(
      "[start]\ny = 0\nz = {:.17g}\nM = {:.17g}\nS = {:.17g}\nbx = {:.17g}\nby = {:.17g}\nex = -6e-4\ney = {:.17g}\n",
      1e-2 * M + 1.5e-2 * S, M, S, 2.4e-3 - 2e-2 * S, 1e-2 * M - 5.1e-3 * S, 3.1e-3 * M);
}

struct Seen {
  Kind kind;
  const char* of;
  double t;
};

// One turn of the cycle.
TEST(Woodpecker, PecksAsPublished) {
  const MotionModel model(resisted_by_joints(parse_scene(toy + breaking_loose(), "woodpecker.toml")));
  constexpr double period = 0.145976060, loose = 0.005820757;
  const Motion motion = test::moved(model, test::released(model, {{}, {{"S", 17.5746654}}}), period + 2 * loose);
  ASSERT_EQ(motion.status, MotionStatus::completed) << motion.why;
  EXPECT_LT(motion.energy_error, 1e-10);
  const std::vector<Seen> expected{{Kind::lift_off, "lower", loose},       {Kind::impact, "upper", 0.016709824},
                                   {Kind::impact, "beak", 0.019811178},    {Kind::impact, "upper", 0.020390700},
                                   {Kind::lift_off, "upper", 0.022245390}, {Kind::impact, "lower", 0.057533800},
                                   {Kind::impact, "lower", 0.060262532},   {Kind::lift_off, "lower", period + loose}};
  std::vector<ContactEvent> normal, along;
  for (const ContactEvent& event : motion.events) {
    const bool is_along = event.kind == Kind::stick || event.kind == Kind::slide;
    (is_along ? along : normal).push_back(event);
  }
  ASSERT_EQ(normal.size(), expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k) {
    const ContactEvent& event = normal[k];
    EXPECT_EQ(event.kind, expected[k].kind) << k;
    EXPECT_EQ(model.scene().stops[static_cast<std::size_t>(event.at.stop)].name, expected[k].of) << k;
    // The start is known to 1e-8.
    EXPECT_NEAR(event.t, expected[k].t, 2e-8) << k;
    EXPECT_TRUE(event.unique) << k;
  }
  // The beak is at -hS S.
  EXPECT_NEAR(normal[2].rate_before, -0.02 * 16.9111769, 1e-8);
  EXPECT_NEAR(normal[2].rate_after, 0.5 * 0.02 * 16.9111769, 1e-8);
  // The lower edge sticks, and breaks loose again.
  const auto is_seen = [&](Kind kind, double t) {
    return std::any_of(along.begin(), along.end(),
                       [&](const ContactEvent& event) { return event.kind == kind && std::abs(event.t - t) < 2e-8; });
  };
  EXPECT_TRUE(is_seen(Kind::stick, 0.106382653));
  EXPECT_TRUE(is_seen(Kind::slide, period));
  TrajectoryReader reader(motion.trajectory, {test::coordinate_of(model, "y")});
  reader.at(period);
  EXPECT_NEAR(reader.q(0), -0.019445375, 1e-8);
}

}  // namespace
}  // namespace poise::woodpecker_test
