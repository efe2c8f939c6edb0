#include "design/synthesis/centre_curve.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace poise::centre_curve_test {
namespace {

std::vector<BodyPosition> random_positions(std::mt19937& random, int number) {
  std::uniform_real_distribution<double> place(-2, 2), turn(-1.5, 1.5);
  std::vector<BodyPosition> out;
  for (int k = 0; k < number; ++k) {
    const double x = place(random), y = place(random);
    out.push_back({{x, y}, turn(random)});
  }
  return out;
}

TEST(CentreCurve, HasLinksOfOneLengthAllAlong) {
  std::mt19937 random(1);
  for (int task = 0; task < 10; ++task) {
    const auto four = random_positions(random, 4);
    const CentreCurve curve = centre_curve(four);
    ASSERT_TRUE(curve.complete) << task;
    ASSERT_GE(curve.arcs, 1);
    for (const auto& [arc, link] : curve.links) {
      const double size = 10 + link.length + norm(link.fixed) + norm(link.moving);
      EXPECT_LT(misfit_of(link, four), 1e-13 * size) << task;
      EXPECT_TRUE(link.proved);
    }
    ASSERT_EQ(curve.slides.size(), 2u);
    for (const GuidingDyad& slide : curve.slides) {
      EXPECT_LT(misfit_of(slide, four), 1e-10 * (10 + norm(slide.moving) + norm(slide.fixed)));
    }
  }
}

TEST(CentreCurve, PassesThePivotsOfFivePositions) {
  std::mt19937 random(2);
  int met = 0;
  for (int task = 0; task < 25; ++task) {
    const auto five = random_positions(random, 5);
    const std::vector<BodyPosition> four(five.begin(), five.end() - 1);
    const CentreCurve curve = centre_curve(four);
    for (const GuidingDyad& known : dyads_through(five).dyads) {
      if (norm(known.fixed) > 4) continue;
      const auto on_line = links_on_line(four, {known.fixed.x, 0}, {0, 1});
      double least = INFINITY;
      for (const GuidingDyad& link : on_line) {
        least = std::min(least, norm(link.fixed - known.fixed) + norm(link.moving - known.moving));
      }
      EXPECT_LT(least, 1e-9) << task;
      const auto near = link_near(four, curve, known.fixed + Vec2{0.01, -0.02});
      ASSERT_TRUE(near) << task;
      EXPECT_LT(norm(near->fixed - known.fixed), 0.05) << task;
      // The points of the curve are not far from one another.
      const auto closest = std::min_element(curve.links.begin(), curve.links.end(), [&](auto& a, auto& b) {
        return norm(a.link.fixed - known.fixed) < norm(b.link.fixed - known.fixed);
      });
      EXPECT_LT(norm(closest->link.fixed - known.fixed), 1.0) << task;
      ++met;
    }
  }
  EXPECT_GT(met, 30);
}

TEST(CentreCurve, NearestLinkIsAtTheFootOfThePlace) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-3, 3);
  for (int task = 0; task < 10; ++task) {
    const auto four = random_positions(random, 4);
    const CentreCurve curve = centre_curve(four);
    const Vec2 wanted{place(random), place(random)};
    const auto near = link_near(four, curve, wanted);
    ASSERT_TRUE(near);
    const double distance = norm(near->fixed - wanted);
    for (const auto& [arc, link] : curve.links) EXPECT_GE(norm(link.fixed - wanted), distance - 1e-12) << task;
    // Across the line to it the curve has no nearer point on either side.
    for (const double angle : {-1e-3, 1e-3}) {
      for (const GuidingDyad& link : links_on_line(four, wanted, unit(angle) * (near->fixed - wanted))) {
        EXPECT_GE(norm(link.fixed - wanted), distance - 1e-9) << task;
      }
    }
  }
}

TEST(CentreCurve, ThreePositionsTakeAnyPinOrPivot) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> place(-3, 3);
  for (int task = 0; task < 50; ++task) {
    const auto three = random_positions(random, 3);
    const Vec2 at{place(random), place(random)};
    const auto by_pin = link_with_pin(three, at);
    ASSERT_TRUE(by_pin);
    EXPECT_LT(misfit_of(*by_pin, three), 1e-11 * (1 + by_pin->length * by_pin->length));
    const auto back = link_with_pivot(three, by_pin->fixed);
    ASSERT_TRUE(back);
    EXPECT_LT(norm(back->moving - at), 1e-9 * (1 + by_pin->length * by_pin->length));
  }
  EXPECT_FALSE(link_with_pin(std::vector<BodyPosition>{{{0, 0}, 0}, {{1, 0}, 0.3}, {{3, 0}, 0.6}}, {0, 0}));
}

TEST(CentreCurve, OfABodyThatIsOnlyShiftedIsNone) {
  const std::vector<BodyPosition> four{{{0, 0}, 1}, {{1, 0}, 1}, {{3, 1}, 1}, {{0, 2}, 1}};
  EXPECT_TRUE(centre_curve(four).dependent);
}

}  // namespace
}  // namespace poise::centre_curve_test
