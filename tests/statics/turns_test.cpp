#include "statics/all_equilibria/turns.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/build_scene.hpp"
#include "tests/support/pulled_chain.hpp"

namespace poise::turns_test {
namespace {

using test::pulled_chain;

TEST(Turns, CountWhereASpringOrStopTellsThemApart) {
  Scene scene = pulled_chain(2);
  const double turn = 2.0 * M_PI;
  {
    const StaticModel model(scene);
    const Turns turns(model);
    EXPECT_FALSE(turns.count());
    EXPECT_NEAR(turns.distance({1.0, 2.0 + turn}, {1.0 - 3 * turn, 2.001}), 1e-3, 1e-12);
    EXPECT_NEAR(turns.reduced({1.0 + turn, -2.0})[0], 1.0, 1e-12);
  }
  test::add_torsion_spring(scene, 1, 2, 3.0);
  {
    const StaticModel model(scene);
    const Turns turns(model);
    EXPECT_TRUE(turns.count(0) && turns.count(1));
    EXPECT_NEAR(turns.distance({1.0, 2.0}, {1.0 + turn, 2.0 + turn}), 0.0, 1e-12) << "both turn";
    EXPECT_TRUE(std::isinf(turns.distance({1.0, 2.0}, {1.0, 2.0 + turn})));
    const std::vector<double> reduced = turns.reduced({1.0 + turn, 2.0 + 3 * turn});
    EXPECT_NEAR(reduced[0], 1.0, 1e-12);
    EXPECT_NEAR(reduced[1], 2.0 + 2 * turn, 1e-12);
  }
  test::add_stop(scene, "stop", 0, 1, -20.0, 20.0);
  {
    const StaticModel model(scene);
    const Turns turns(model);
    EXPECT_TRUE(std::isinf(turns.distance({1.0, 2.0}, {1.0 + turn, 2.0 + turn})));
    EXPECT_EQ(turns.reduced({1.0 + turn, 2.0}), (std::vector<double>{1.0 + turn, 2.0}));
  }
}

}  // namespace
}  // namespace poise::turns_test
