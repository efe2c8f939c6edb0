#include "model/quantity.hpp"

#include <gtest/gtest.h>

namespace poise::quantity_test {
namespace {

TEST(Quantity, UnitsFollowFromThoseOfTheScene) {
  Units units;
  EXPECT_EQ(unit_name(Quantity::energy, units), "J");
  EXPECT_EQ(unit_name(Quantity::moment, units), "N m");
  units.length_name = "in";
  units.length = 0.0254;
  units.force_name = "lbf";
  units.force = 4.4482216152605;
  EXPECT_EQ(unit_name(Quantity::energy, units), "lbf in");
  EXPECT_DOUBLE_EQ(in_unit(0.0254 * 4.4482216152605, Quantity::moment, units), 1.0);
}

TEST(Quantity, OfAMeasureAndOfWhatDoesWorkOnIt) {
  const Measure turn = Measure::angle_between(0, 1);
  const Measure travel = Measure::travel_of(0);
  EXPECT_EQ(quantity_of(turn), Quantity::angle);
  EXPECT_EQ(effort_of(turn), Quantity::moment);
  EXPECT_EQ(quantity_of(travel), Quantity::length);
  EXPECT_EQ(effort_of(travel), Quantity::force);
}

}  // namespace
}  // namespace poise::quantity_test
