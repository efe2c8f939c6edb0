// The 50-digit reference against closed forms, and against errors that are known because they were made.

#include "statics/model/reference.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <gtest/gtest.h>

#include "model/scene.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/known_answers.hpp"

namespace poise::reference_test {
namespace {

using Real = boost::multiprecision::cpp_bin_float_100;
using test::dataset;

// Forty digits are printed: half a unit of the last one, and the rounding of 50 digits.
void expect_digits(const std::string& decimal, const Real& exact) {
  const Real error = abs(Real(decimal) - exact);
  EXPECT_LE(error, Real("1e-39") * std::max(Real(1), Real(abs(exact)))) << decimal << "\n" << exact.str(45);
}

const Real half_turn = boost::math::constants::pi<Real>();

// A chain of `links` bars of 1 m and 1 kg pulled aside at its tip:  tan = F / ((n - i + 1/2) m g)  from the vertical.
StaticModel pulled_chain(int links) {
  Scene scene = test::chain(links, 1.0, 1.0);
  scene.gravity = {0.0, -9.81};
  test::add_force(scene, std::to_string(links) + ".b", {10.0, 0.0}, "F");
  for (int i = 1; i <= links; ++i) scene.start.angle[i] = -M_PI_2 + std::atan2(10.0, (links - i + 0.5) * 9.81);
  return StaticModel(scene);
}

class PulledChain : public testing::TestWithParam<int> {};

TEST_P(PulledChain, HasFortyDigitsOfItsClosedForm) {
  const int links = GetParam();
  const StaticModel model = pulled_chain(links);
  const Reference reference = refine(model, model.start());
  ASSERT_TRUE(reference.refined) << reference.why;
  EXPECT_GE(reference.digits, 40);
  EXPECT_LT(reference.error, 1e-15);
  ASSERT_EQ(reference.decimal.size(), static_cast<std::size_t>(links));
  for (int i = 1; i <= links; ++i) {
    // The scene has 9.81 in double, which the reference takes as exact.
    const Real from_vertical = atan2(Real(10), (links - i + Real("0.5")) * Real(9.81));
    expect_digits(reference.decimal[i - 1], from_vertical - half_turn / 2);
    EXPECT_EQ(reference.x[i - 1], static_cast<double>(from_vertical - half_turn / 2));
  }
}

// Dense up to 80 coordinates, sparse above.
INSTANTIATE_TEST_SUITE_P(Links, PulledChain, testing::Values(1, 5, 80, 81, 200));

TEST(Reference, ChainOfTheThesis) {
  // tan th3 = 2X / Z3, tan th2 = 2X / (Z2 + 2 Z3), tan th1 = 2X / (Z1 + 2 Z2 + 2 Z3), from the downward vertical.
  const Scene scene = read_scene(dataset("pendulum_chain.toml"));
  const StaticModel model(scene);
  const Equilibrium found = solve(model, test::by(Method::virtual_work));
  ASSERT_TRUE(found.found()) << found.why;
  const Reference reference = refine(model, found.x);
  ASSERT_TRUE(reference.refined) << reference.why;
  EXPECT_LE(reference.error, 1e-15);
  EXPECT_GE(reference.digits, 40);
}

TEST(Reference, LengthsAreInMetres) {
  // 2 kg under 10 m/s^2 on 96 N/m from a height of 5 m, free length 3: y = 5 - 3 - 20/96, whatever the units.
  for (const char* units : {"", "[units]\nlength = \"m\"\nforce = \"kN\"\n"}) {
    const StaticModel model(parse_scene("gravity = [0, -10]\n" + std::string(units) +
                                            "[ground]\npoints = { R = [0, 0], top = [0, 5] }\n"
                                            "[body.block]\npoints = { P = [0, 0] }\nmass = 2\n"
                                            "[[slide]]\nname = \"rail\"\n"
                                            "points = [\"ground.R\", \"block.P\"]\naxis = [0, 1]\n"
                                            "[[spring]]\npoints = [\"ground.top\", \"block.P\"]\n"
                                            "free_length = 3\nstiffness = " +
                                            (*units ? "0.09375" : "93.75"),
                                        "block.toml"));
    const Reference reference = refine(model, model.from_si({2.0 - 20.0 / 93.75}));
    ASSERT_TRUE(reference.refined) << reference.why;
    expect_digits(reference.decimal[0], Real(2) - Real(20) / Real("93.75"));
    EXPECT_NEAR(reference.x[0] * model.scales().length, 2.0 - 20.0 / 93.75, 1e-15);
  }
}

class Measured : public testing::TestWithParam<const char*> {};

TEST_P(Measured, ErrorIsTheShiftThatWasMade) {
  const StaticModel model(read_scene(dataset(GetParam())));
  const Equilibrium found = solve(model, test::by(Method::virtual_work));
  ASSERT_TRUE(found.found()) << found.why;
  const Reference exact = refine(model, found.x);
  ASSERT_TRUE(exact.refined) << exact.why;
  EXPECT_LE(exact.error, 1e-12);
  for (const double shift : {1e-12, 1e-9, 1e-6}) {
    for (std::size_t i = 0; i < found.x.size(); ++i) {
      std::vector<double> x = exact.x;
      x[i] += shift;
      const Reference reference = refine(model, x);
      ASSERT_TRUE(reference.refined) << reference.why;
      EXPECT_NEAR(reference.error, shift, 1e-15 + 1e-6 * shift);
      for (std::size_t k = 0; k < x.size(); ++k) {
        EXPECT_NEAR(reference.x[k], exact.x[k], 1e-40);
        EXPECT_LE(abs(Real(reference.decimal[k]) - Real(exact.decimal[k])), Real("1e-38")) << reference.decimal[k];
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Each, Measured,
                         testing::Values("thesis_four_bar.toml", "six_bar.toml", "vertical_slider_crank.toml",
                                         "toggle_press.toml"),
                         [](const auto& scene) {
                           const std::string name = scene.param;
                           return name.substr(0, name.find('.'));
                         });

TEST(Reference, HoldsTheStopThatPresses) {
  const StaticModel model(read_scene(dataset("toggle_clamp.toml")));
  const Equilibrium found = solve(model, test::by(Method::virtual_work));
  ASSERT_TRUE(found.found()) << found.why;
  const Reference reference = refine(model, found.x);
  ASSERT_TRUE(reference.refined) << reference.why;
  EXPECT_LE(reference.error, 1e-12);
  std::vector<Real> angle;
  for (const char* body : {"handle", "link"}) {
    for (int i = 0; i < model.layout().kept; ++i) {
      if (model.layout().coordinates[i].name == body) angle.emplace_back(reference.decimal[i]);
    }
  }
  ASSERT_EQ(angle.size(), 2u);
  EXPECT_LE(abs(angle[1] - angle[0] - Real(model.scene().stops[0].min)), Real("4e-39"));
}

TEST(Reference, RedundantJointsAndNeutralFreedomsDoNoHarm) {
  const StaticModel parallel(read_scene(dataset("redundant_parallelogram.toml")));
  const Reference held = refine(parallel, solve(parallel).x);
  ASSERT_TRUE(held.refined) << held.why;
  // Unstressed at the angle 1, and closed there to every digit.
  EXPECT_LE(held.error, 1e-14);

  Scene scene = test::chain(1, 1.0, 2.0);
  scene.gravity = {0.0, -10.0};
  scene.bodies[1].center = {0.0, 0.0};
  test::add_force(scene, "1.m", {0.0, 0.0}, "nothing");
  test::add_torsion_spring(scene, 0, 1, 1e-30, 0.25);
  const StaticModel weak(scene);
  const Reference reference = refine(weak, {0.25});
  EXPECT_TRUE(reference.refined) << reference.why;
}

// --- where there is nothing to find ------------------------------------------------------------------------------

TEST(Reference, RefusesWhereThereIsNoEquilibrium) {
  // Nothing holds the block.
  const StaticModel falling(parse_scene(R"(
    gravity = [0, -10]
    [ground]
    points = { R = [0, 0] }
    [body.block]
    points = { P = [0, 0] }
    mass = 2
    [[slide]]
    points = ["ground.R", "block.P"]
    axis = [0, 1]
  )",
                                        "falling.toml"));
  const Reference none = refine(falling, {0.3});
  EXPECT_FALSE(none.refined);
  EXPECT_NE(none.why, "");
  EXPECT_TRUE(none.x.empty());
  EXPECT_TRUE(none.decimal.empty());
}

TEST(Reference, RefusesWhereTheNextEquilibriumIsFar) {
  const StaticModel model = pulled_chain(3);
  for (const double shift : {0.05, 0.5, 1.5}) {
    std::vector<double> x = model.start();
    x[0] += shift;
    const Reference reference = refine(model, x);
    EXPECT_FALSE(reference.refined);
    EXPECT_NE(reference.why, "");
  }
}

TEST(Reference, RefusesALockedPose) {
  // Two links drawn straight between their anchors: a weight in the middle has no finite reactions there.
  Scene scene = test::chain(2, 1.0, 1.0);
  scene.gravity = {0.0, -10.0};
  scene.add_point(0, "E", {2.0, 0.0});
  test::add_pin(scene, "2.b", "ground.E");
  const StaticModel model(scene);
  EXPECT_FALSE(refine(model, {0.0, 0.0}).refined);
  EXPECT_FALSE(check(model, {0.0, 0.0}).is_equilibrium());
}

// A load that follows the last of 90 links holds it nowhere: its row of the tangent is empty. Large systems are
// factored as sparse ones.
TEST(Reference, RefusesALargeSystemThatIsSingular) {
  Scene scene = test::chain(90, 1.0, 1.0);
  scene.gravity = {};
  test::add_force(scene, "90.b", {-1.0, 0.0}, "P");
  scene.forces.back().follows = 90;
  const StaticModel model(scene);
  ASSERT_EQ(model.mechanism().coordinates(), 90);
  const Reference reference = refine(model, model.start());
  EXPECT_FALSE(reference.refined);
  EXPECT_NE(reference.why.find("singular"), std::string::npos) << reference.why;
}

}  // namespace
}  // namespace poise::reference_test
