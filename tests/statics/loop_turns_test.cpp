#include "statics/all_equilibria/private/loop_turns.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "statics/all_equilibria/private/assembly_modes.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/model/mobility.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/known_answers.hpp"

namespace poise::loop_turns_test {
namespace {

using test::dataset;

constexpr double turn = 2.0 * M_PI;

std::vector<double> turned(std::vector<double> x, std::size_t coordinate, double by) {
  x[coordinate] += by;
  return x;
}

constexpr const char* near_parallelogram = R"(
[ground]
points = { A = [0, 0], D = [1, 0] }
[body.crank]
points = { A = [0, 0], B = [0.499, 0] }
[body.coupler]
points = { B = [0, 0], C = [1, 0] }
[body.rocker]
points = { D = [0, 0], C = [0.5, 0] }
[[pin]]
points = ["ground.A", "crank.A"]
[[pin]]
points = ["crank.B", "coupler.B"]
[[pin]]
points = ["coupler.C", "rocker.C"]
[[pin]]
points = ["ground.D", "rocker.D"]
[[torsion_spring]]
bodies = ["ground", "crank"]
stiffness = 1
[[torsion_spring]]
bodies = ["ground", "rocker"]
stiffness = 1
[start]
crank = 1.5
rocker = 1.5
)";

// No link of this four-bar can turn round.
TEST(LoopTurns, OfAFourBarThatRocksAreThoseOfItsStart) {
  const StaticModel model(read_scene(dataset("four_bar_torsion.toml")));
  const Turns turns(model);
  const std::vector<double> start = assemble(model);
  const LoopTurns loops(model, turns, start);
  ASSERT_TRUE(loops.known());
  EXPECT_TRUE(loops.reaches(start));
  for (std::size_t i = 0; i < 3; ++i) EXPECT_FALSE(loops.reaches(turned(start, i, turn))) << i;
  // A pose far from the start, on the same curve: the unstressed one.
  const std::vector<double> rest{1.04719755119659774615, 0.48381504544769919596, 1.83621264428699616940};
  EXPECT_TRUE(loops.reaches(rest));
  EXPECT_FALSE(loops.reaches(turned(rest, 2, -turn)));
}

TEST(LoopTurns, ACrankGoesRoundAndItsRockerDoesNot) {
  Scene scene = read_scene(dataset("four_bar_gravity.toml"));
  test::add_torsion_spring(scene, 0, 1, 3.0);
  test::add_torsion_spring(scene, 0, 3, 2.0);
  const StaticModel model(scene);
  const Turns turns(model);
  const std::vector<double> start = assemble(model);
  LoopTurns loops(model, turns, start);
  ASSERT_TRUE(loops.known());
  EXPECT_TRUE(loops.reaches(turned(start, 0, 2 * turn)));
  EXPECT_FALSE(loops.reaches(turned(start, 2, turn)));
  // The other assembly mode is reached from itself alone.
  const std::vector<double> other{-1.81799882467399407676, 1.1285905859592079814, 3.06681186086143791406};
  EXPECT_TRUE(loops.reaches(turned(other, 2, turn))) << "nothing is known of that mode yet";
  loops.add(turned(other, 2, -3 * turn));
  EXPECT_TRUE(loops.reaches(other));
  EXPECT_TRUE(loops.reaches(turned(other, 0, -turn)));
  EXPECT_FALSE(loops.reaches(turned(other, 2, turn)));
}

// A torque has no least energy at any turn, and says nothing of turns; a stop does.
TEST(LoopTurns, OtherModesStartWithTheirStopsNotPassed) {
  Scene scene = read_scene(dataset("four_bar_gravity.toml"));
  scene.torques.push_back({.name = "torque", .body = 1, .value = -30.0});
  test::add_stop(scene, "stop", 0, 3, -5.5, 0.0);
  const StaticModel model(scene);
  const Turns turns(model);
  LoopTurns loops(model, turns, assemble(model));
  ASSERT_TRUE(loops.known());
  const std::vector<double> other{-1.81799882467399407676, 1.1285905859592079814, 3.06681186086143791406};
  loops.add(turned(other, 2, 2 * turn));
  EXPECT_TRUE(loops.reaches(turned(other, 2, -turn)));
  EXPECT_FALSE(loops.reaches(other));
}

TEST(LoopTurns, OfALockedFourBarAreThoseOfItsStart) {
  Scene scene = read_scene(dataset("four_bar_torsion.toml"));
  test::add_stop(scene, "motor", 0, 1, -1.0, -1.0);
  const StaticModel model(scene);
  const Turns turns(model);
  const std::vector<double> start = close_loops(model);
  const LoopTurns loops(model, turns, start);
  ASSERT_TRUE(loops.known());
  EXPECT_TRUE(loops.reaches(start));
  EXPECT_FALSE(loops.reaches(turned(start, 2, turn)));
}

// It can fold in two ways where it lies in one line, and go from one curve of poses to another there.
TEST(LoopTurns, AreNotKnownWhereCurvesOfPosesCross) {
  const Scene flat = read_scene(dataset("hard/flat_sprung_four_bar.toml"));
  Scene folded = flat;
  folded.start.angle = {std::nullopt, -0.841068671, 0.841068671, 2.300523983};
  for (const Scene& scene : {flat, folded}) {
    const StaticModel model(scene);
    const Turns turns(model);
    const LoopTurns loops(model, turns, close_loops(model));
    EXPECT_TRUE(loops.matter());
    EXPECT_FALSE(loops.known());
    EXPECT_TRUE(loops.reaches(turned(close_loops(model), 2, turn)));
  }
}

// Nearly a parallelogram: its crank, a thousandth too short, goes round, and its rocker turns back where all lies
// nearly in one line, near poses of the other mode. Straight on there it would go round with the crank.
TEST(LoopTurns, AreNotMistakenWhereCurvesNearlyMeet) {
  const StaticModel model = test::model_of(near_parallelogram);
  const Turns turns(model);
  const std::vector<double> start = assemble(model);
  const LoopTurns loops(model, turns, start);
  ASSERT_TRUE(loops.known());
  EXPECT_TRUE(loops.reaches(turned(start, 0, turn)));
  EXPECT_FALSE(loops.reaches(turned(turned(start, 0, turn), 2, turn)));
  const double most = loops.ranges()[0].upper[2];
  EXPECT_LT(most, M_PI);
  EXPECT_GT(most, M_PI - 0.2);
}

// A crank that goes round has two circuits, one that cannot has one; a slider-crank that is held has two poses.
TEST(LoopTurns, OfAllAssemblyModesAreFound) {
  Scene rocks = read_scene(dataset("four_bar_torsion.toml"));
  Scene goes_round = read_scene(dataset("four_bar_gravity.toml"));
  test::add_torsion_spring(goes_round, 0, 3, 2.0);
  Scene held = rocks;
  test::add_stop(held, "motor", 0, 1, -1.0, -1.0);
  Scene near = test::model_of(near_parallelogram).scene();
  for (const auto& [scene, curves] :
       {std::pair(&rocks, 1U), std::pair(&goes_round, 2U), std::pair(&held, 2U), std::pair(&near, 2U)}) {
    SCOPED_TRACE(scene->title);
    const StaticModel model(*scene);
    const Turns turns(model);
    LoopTurns loops(model, turns, close_loops(model));
    ASSERT_TRUE(loops.known());
    find_assembly_modes(model, 0, loops, [] { return false; });
    EXPECT_TRUE(loops.known());
    EXPECT_EQ(loops.curves(), curves);
    find_assembly_modes(model, 0, loops, [] { return true; });
    EXPECT_FALSE(loops.known());
  }
}

TEST(LoopTurns, FindWhereTheForceAlongTheCurveChangesItsSign) {
  const StaticModel model(read_scene(dataset("four_bar_gravity.toml")));
  const Turns turns(model);
  LoopTurns loops(model, turns, assemble(model));
  ASSERT_TRUE(loops.is_followed());
  loops.add(assemble(model));
  const std::vector<std::vector<double>> places = loops.changes_of_force();
  // The stable and the unstable equilibrium of this assembly mode, by the scene file.
  const std::vector<std::vector<double>> known = {
      {-1.46050621405410635237, 0.00026605182163744310, -1.66422110997146252064},
      {1.91285710079095610340, -0.86833239079367391, -2.50339224106575783031}};
  for (const std::vector<double>& x : known) {
    EXPECT_TRUE(std::any_of(places.begin(), places.end(),
                            [&](const std::vector<double>& place) { return turns.distance(place, x) < 1e-6; }));
  }
  EXPECT_EQ(places.size(), 2U);
}

TEST(LoopTurns, AreNotNeededWhereNothingTellsThemApart) {
  for (const char* name : {"four_bar_gravity.toml", "inverted_pendulum_torsion.toml"}) {
    const StaticModel model(read_scene(dataset(name)));
    const Turns turns(model);
    EXPECT_FALSE(LoopTurns(model, turns, assemble(model)).known()) << name;
  }
}

}  // namespace
}  // namespace poise::loop_turns_test
