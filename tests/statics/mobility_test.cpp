// What is said of a scene before anything is solved: counts, redundancy by name, what is kept and what is dropped.

#include "statics/model/mobility.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "comparison/redundant_scenes.hpp"
#include "model/scene.hpp"
#include "statics/model/private/closure_rounding.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/parallel_links.hpp"
#include "tests/support/seed.hpp"

namespace poise::mobility_test {
namespace {

using test::dataset;

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

bool any_contains(const std::vector<std::string>& lines, const std::string& item, const std::string& why) {
  return std::any_of(lines.begin(), lines.end(),
                     [&](const std::string& line) { return contains(line, item) && contains(line, why); });
}

struct Counted {
  const char* scene;
  int bodies, joints, gruebler, freedoms;
};

class Counts : public testing::TestWithParam<Counted> {};

TEST_P(Counts, AreThoseOfATextbook) {
  const Counted& known = GetParam();
  const StaticModel model(read_scene(dataset(known.scene)));
  const Mobility mobility = analyse_mobility(model);
  EXPECT_EQ(mobility.bodies, known.bodies);
  EXPECT_EQ(mobility.joints, known.joints);
  EXPECT_EQ(mobility.gruebler, known.gruebler);
  EXPECT_EQ(mobility.freedoms, known.freedoms);
  EXPECT_TRUE(mobility.assembled) << mobility.gap;
  EXPECT_EQ(mobility.gap, "");
  EXPECT_EQ(mobility.freedoms, mobility.coordinates - mobility.rank);
  EXPECT_EQ(mobility.coordinates, model.mechanism().coordinates());
  EXPECT_EQ(mobility.closures, 2 * model.mechanism().closures());
  EXPECT_EQ(mobility.kept.size(), static_cast<std::size_t>(mobility.coordinates));
  EXPECT_EQ(mobility.redundant.empty(), mobility.gruebler == mobility.freedoms);
}

INSTANTIATE_TEST_SUITE_P(
    Datasets, Counts,
    testing::Values(Counted{"thesis_four_bar.toml", 3, 4, 1, 1}, Counted{"thesis_chain.toml", 4, 5, 2, 2},
                    Counted{"pendulum_chain.toml", 3, 3, 3, 3}, Counted{"vertical_slider_crank.toml", 4, 5, 2, 2},
                    Counted{"toggle_clamp.toml", 3, 4, 1, 1}, Counted{"redundant_parallelogram.toml", 4, 6, 0, 1},
                    Counted{"hencky_cantilever.toml", 3, 3, 3, 3}),
    [](const auto& scene) {
      const std::string name = scene.param.scene;
      return name.substr(0, name.find('.'));
    });

TEST(Mobility, CountsJointsOfEveryKind) {
  // 3 bodies, less 2 for the pin, 2 for the slide, 1 for the slot, 3 for the weld and 1 for the bar: 12 - 9 = 3.
  const StaticModel model(parse_scene(R"(
    gravity = [0, -10]
    [ground]
    points = { O = [0, 0], B = [4, 0] }
    [body.one]
    points = { P = [0, 0], Q = [1, 0] }
    mass = 1
    center = [1, 0]
    [body.two]
    points = { P = [0, 0], Q = [1, 0] }
    mass = 1
    center = [1, 0]
    [body.three]
    points = { P = [0, 0], Q = [1, 0] }
    mass = 1
    center = [1, 0]
    [body.four]
    points = { P = [0, 0], Q = [1, 0] }
    mass = 1
    center = [1, 0]
    [[pin]]
    points = ["ground.O", "one.P"]
    [[slide]]
    points = ["one.Q", "two.P"]
    axis = [1, 0]
    [[weld]]
    points = ["two.Q", "three.P"]
    [[pin_in_slot]]
    name = "slot"
    points = ["three.Q", "four.P"]
    axis = [0, 1]
    [[bar]]
    points = ["four.Q", "ground.B"]
    length = 1.5
    [start]
    one = 0
    four = 0
  )",
                                      "kinds.toml"));
  const Mobility mobility = analyse_mobility(model);
  EXPECT_EQ(mobility.bodies, 4);
  EXPECT_EQ(mobility.joints, 5);
  EXPECT_EQ(mobility.gruebler, 3);
  EXPECT_TRUE(mobility.assembled) << mobility.gap;
  EXPECT_EQ(mobility.freedoms, 3);
  EXPECT_TRUE(mobility.redundant.empty());
}

TEST(Mobility, OfScissorsIsOneWhateverTheirHeight) {
  for (const int stages : {1, 2, 5, 30}) {
    const StaticModel model(test::scissor(stages, 1.0, 10.0, 0.6));
    const Mobility mobility = analyse_mobility(model);
    EXPECT_TRUE(mobility.assembled) << mobility.gap;
    EXPECT_EQ(mobility.gruebler, 1);
    EXPECT_EQ(mobility.freedoms, 1);
    EXPECT_EQ(mobility.redundant, std::vector<std::string>());
  }
}

// Windows leaning to the right: flat on the ground, as they start by themselves, they are singular.
Scene leaning_windows(int count) {
  Scene scene = test::windows(count);
  for (int i = 0; i <= count; ++i) scene.start.angle[test::point(scene, "post" + std::to_string(i) + ".a").body] = 1.2;
  return scene;
}

// Each window adds a post and a beam with three pins: one freedom, however many. 300 of them are counted on sparse
// factors.
TEST(Mobility, OfWindowsIsOneWhateverTheirNumber) {
  for (const int count : {1, 7, 100, 300}) {
    const StaticModel model(leaning_windows(count));
    const Mobility mobility = analyse_mobility(model);
    EXPECT_EQ(mobility.closures, 2 * count);
    EXPECT_EQ(mobility.rank, 2 * count);
    EXPECT_EQ(mobility.freedoms, 1) << count;
    EXPECT_EQ(mobility.redundant, std::vector<std::string>());
  }
}

TEST(Mobility, NamesTheRedundantBeamAmongManyLoops) {
  for (const int count : {5, 100, 300}) {
    SCOPED_TRACE(count);
    // A second beam alongside the third: it needs one equation for its own angle, and the other repeats.
    Scene scene = leaning_windows(count);
    test::add_link(scene, "double", 1.0, 1.0);
    test::add_pin(scene, "post2.b", "double.a", "first");
    test::add_pin(scene, "double.b", "post3.b", "second");
    const Mobility mobility = analyse_mobility(StaticModel(scene));
    EXPECT_TRUE(mobility.assembled) << mobility.gap;
    EXPECT_EQ(mobility.gruebler, 0);
    EXPECT_EQ(mobility.closures, 2 * count + 2);
    EXPECT_EQ(mobility.rank, 2 * count + 1);
    EXPECT_EQ(mobility.freedoms, 1);
    ASSERT_FALSE(mobility.redundant.empty());
    for (const std::string& name : mobility.redundant) {
      EXPECT_TRUE(name == "second" || name == "first" || contains(name, "beam3")) << name;
    }
  }
}

Scene three_links(double shorter) { return parse_scene(test::three_links(shorter), "links.toml"); }

Freedoms freedoms_of(const Scene& scene, int infinitesimal) {
  const StaticModel model(scene);
  const Mobility mobility = analyse_mobility(model);
  EXPECT_EQ(mobility.freedoms, infinitesimal);
  const Freedoms out = freedoms_at(model, mobility.x);
  EXPECT_EQ(out.infinitesimal, infinitesimal);
  return out;
}

// Turned by a, the tips of links of the lengths 1, L, 1 that stay parallel leave the line of the bed by (1 - L) a^2 /
// 2: to second order unless L = 1.
TEST(Mobility, OfAShakyStructureIsInfinitesimal) {
  for (const double shorter : {0.5, 0.1, 0.01, 1e-3, -0.1}) {
    const Freedoms none = freedoms_of(three_links(shorter), 1);
    EXPECT_EQ(none.finite, 0) << shorter;
    EXPECT_EQ(none.by, Freedoms::By::curvature) << shorter;
    EXPECT_TRUE(none.is_shaky());
  }
  for (const Scene& scene : {three_links(0.0), test::parallelogram(5, 1.0, 1.0)}) {
    const Freedoms one = freedoms_of(scene, 1);
    EXPECT_EQ(one.finite, 1);
    EXPECT_EQ(one.by, Freedoms::By::closing_beside);
    EXPECT_FALSE(one.is_shaky());
  }
  for (const Scene& scene : {test::parallelogram(2, 1.0, 1.0), test::scissor(4, 1.0, 1.0, 0.5)}) {
    const Freedoms one = freedoms_of(scene, 1);
    EXPECT_EQ(one.finite, 1);
    EXPECT_EQ(one.by, Freedoms::By::rank);
  }
}

TEST(Mobility, OfMechanismsThatRepeatThemselvesEverywhereIsFinite) {
  const int count = test::cases(40, 2000);
  for (int k = 0; k < count; ++k) {
    const std::uint64_t seed = test::seed(9000) + static_cast<std::uint64_t>(k);
    const Freedoms one = freedoms_of(comparison::redundant_scene(seed), 1);
    EXPECT_EQ(one.finite, 1) << seed;
    EXPECT_EQ(one.by, Freedoms::By::closing_beside) << seed;
  }
}

// A flat parallelogram can go on in two ways, each of one degree of freedom.
TEST(Mobility, OfAChangePointIsThatBeyond) {
  const Freedoms one = freedoms_of(test::parallelogram(2, 0.0, 1.0), 2);
  EXPECT_EQ(one.finite, 1);
  EXPECT_EQ(one.by, Freedoms::By::closing_beside);
}

TEST(Mobility, NamesTheJointsOfTheParallelogram) {
  const Scene scene = read_scene(dataset("redundant_parallelogram.toml"));
  const StaticModel model(scene);
  const Mobility mobility = analyse_mobility(model);
  EXPECT_EQ(mobility.closures, 4);
  EXPECT_EQ(mobility.rank, 3);
  ASSERT_FALSE(mobility.redundant.empty());
  std::set<std::string> joints;
  for (const Joint& joint : scene.joints) joints.insert(joint.name);
  for (const std::string& name : mobility.redundant) EXPECT_EQ(joints.count(name), 1u) << name;
}

TEST(Mobility, NamesAnAngleThatIsKeptTwice) {
  const StaticModel model(parse_scene(R"(
    gravity = [0, -10]
    [ground]
    points = { A = [0, 0], B = [0, 1] }
    [body.lift]
    points = { A = [0, 0], B = [0, 1] }
    mass = 1
    [[slide]]
    name = "lower"
    points = ["ground.A", "lift.A"]
    axis = [0, 1]
    [[slide]]
    name = "upper"
    points = ["ground.B", "lift.B"]
    axis = [0, 1]
  )",
                                      "lift.toml"));
  const Mobility mobility = analyse_mobility(model);
  EXPECT_EQ(mobility.gruebler, -1);
  EXPECT_EQ(mobility.freedoms, 1);
  EXPECT_EQ(mobility.redundant, (std::vector<std::string>{"upper", "upper (angle)"}));
}

TEST(Mobility, ConflictingWeldsAreRefused) {
  try {
    const StaticModel model(parse_scene(R"([ground]
points = { A = [0, 0] }
[body.one]
points = { A = [0, 0] }
[[weld]]
name = "first"
points = ["ground.A", "one.A"]
[[weld]]
name = "second"
points = ["ground.A", "one.A"]
angle = 0.5
)",
                                        "conflict.toml"));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_TRUE(contains(error.what(), "conflict.toml:8: weld \"second\"")) << error.what();
  }
}

TEST(Mobility, SaysWhichLoopStaysOpenAndByHowMuch) {
  Scene scene = test::chain(3, 1.0, 1.0);
  scene.units.length_name = "mm";
  scene.units.length = 1e-3;
  scene.gravity = {0.0, -10.0};
  scene.add_point(0, "E", {3.25, 0.0});
  test::add_pin(scene, "3.b", "ground.E", "far");
  const StaticModel model(scene);
  const Mobility mobility = analyse_mobility(model);
  EXPECT_FALSE(mobility.assembled);
  EXPECT_TRUE(contains(mobility.gap, "\"" + model.layout().closures[0].name + "\"")) << mobility.gap;
  EXPECT_TRUE(contains(mobility.gap, "open by 250 mm")) << mobility.gap;
  EXPECT_EQ(mobility.x.size(), 3u);
}

TEST(Mobility, ReturnsTheClosedStart) {
  const StaticModel model(test::started_at(read_scene(dataset("thesis_four_bar.toml")), {{"link6", 0.1}}));
  const Mobility mobility = analyse_mobility(model);
  ASSERT_TRUE(mobility.assembled);
  EXPECT_TRUE(check(model, mobility.x).closed);
}

TEST(Mobility, SaysWhatIsKeptAndWhatIsDroppedAndWhy) {
  const StaticModel model(parse_scene(R"(
    [ground]
    points = { O = [0, 0] }
    [body.arm]
    points = { O = [0, 0], P = [1, 0] }
    mass = 1
    inertia = 2
    [body.idle]
    points = { O = [0, 0] }
    mass = 3
    [[pin]]
    points = ["ground.O", "arm.O"]
    [[pin]]
    points = ["arm.P", "idle.O"]
    [[force]]
    name = "F"
    at = "arm.P"
    vector = [1, 0]
    [[force]]
    name = "Z"
    at = "arm.P"
    vector = [0, 0]
    [[spring]]
    name = "weak"
    points = ["ground.O", "arm.P"]
    stiffness = 0
    free_length = 1
  )",
                                      "kept.toml"));
  const Mobility mobility = analyse_mobility(model);
  EXPECT_EQ(mobility.kept.size(), 1u);
  EXPECT_TRUE(any_contains(mobility.kept, "angle \"arm\"", "carries a load"));
  EXPECT_TRUE(any_contains(mobility.dropped, "angle \"idle\"", "carries no load"));
  EXPECT_TRUE(any_contains(mobility.dropped, "mass of 2 bodies", "no gravity"));
  EXPECT_TRUE(any_contains(mobility.dropped, "inertia of 1 body", "nothing moves in statics"));
  EXPECT_TRUE(any_contains(mobility.dropped, "force \"Z\"", "zero"));
  EXPECT_TRUE(any_contains(mobility.dropped, "spring \"weak\"", "zero"));
}

// 0.3 and 0.1 + 0.2, one unit in the last place apart: as numbers written in decimal they are one place.
std::string rod_on_two_pins(const std::string& second) {
  return "gravity = [0, -10]\n[ground]\npoints = { O = [0, 0] }\n[body.rod]\npoints = { a = [0.3, 0], b = [" + second +
         ", 0] }\nmass = 1\ncenter = [0.5, 0]\n[[pin]]\nname = \"first\"\npoints = [\"ground.O\", \"rod.a\"]\n"
         "[[pin]]\nname = \"second\"\npoints = [\"ground.O\", \"rod.b\"]\n";
}

TEST(Mobility, OfAPinWrittenTwiceWithinRoundingIsOne) {
  const StaticModel model(parse_scene(rod_on_two_pins("0.30000000000000004"), "rod.toml"));
  const Mobility mobility = analyse_mobility(model);
  EXPECT_EQ(mobility.coordinates, 1);
  EXPECT_EQ(mobility.closures, 2);
  EXPECT_EQ(mobility.rank, 0);
  EXPECT_EQ(mobility.freedoms, 1);
  EXPECT_EQ(mobility.redundant, std::vector<std::string>{"second"});
}

TEST(Mobility, OfTwoPinsASmallDistanceApartIsNone) {
  // Two hundred units in the last place: more than rounding explains.
  const StaticModel model(parse_scene(rod_on_two_pins("0.30000000000001"), "rod.toml"));
  EXPECT_EQ(analyse_mobility(model).freedoms, 0);
}

TEST(ClosureRounding, IsTwiceTheRoundingOfEveryNumberOfTheLoop) {
  const StaticModel rod(parse_scene(rod_on_two_pins("0.30000000000000004"), "rod.toml"));
  const double scale = rod.scales().length;
  const double unit = std::ldexp(1.0, -52);
  EXPECT_DOUBLE_EQ(closure_rounding(rod).front(), 2 * 0.3 * unit / scale);
  // Three links of 1.5 m, the ground points 0 and 2.
  Scene scene = test::chain(3, 1.5, 1.0);
  scene.add_point(0, "E", {2.0, 0.0});
  test::add_pin(scene, "3.b", "ground.E");
  const StaticModel chain(scene);
  EXPECT_DOUBLE_EQ(closure_rounding(chain).front(), (3 * 1.5 + 2.0) * unit / chain.scales().length);
  // Far from the origin every ground point is rounded more, although the gap is a difference of near points.
  for (NamedPoint& p : scene.bodies[0].points) p.at.x += 1e14;
  const StaticModel far(scene);
  EXPECT_NEAR(closure_rounding(far).front() * far.scales().length, 2e14 * unit, 1e-12);
}

}  // namespace
}  // namespace poise::mobility_test
