#include "statics/paths/path_measures.hpp"

#include <string>

#include <gtest/gtest.h>

#include "model/input_error.hpp"
#include "statics/paths/path_words.hpp"
#include "statics/quantities/quantity.hpp"
#include "tests/app/fabricated_path.hpp"
#include "tests/app/run_poise.hpp"

namespace poise::path_measures_test {
namespace {

using app_tests::dataset;
using app_tests::toggle_path;
using app_tests::varied_toggle;

std::string complaint(const Scene& scene, const std::string& name) {
  try {
    find_quantity(scene, name);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(PathMeasures, AreFoundByTheNamesOfTheScene) {
  const Scene clamp = read_scene(dataset("toggle_clamp"));
  EXPECT_EQ(find_quantity(clamp, "handle").on.kind, Measure::Kind::angle);
  EXPECT_EQ(find_quantity(clamp, "arm.T.x").on.kind, Measure::Kind::x);
  EXPECT_EQ(find_quantity(clamp, "arm.T.y").on.kind, Measure::Kind::y);
  EXPECT_EQ(find_quantity(clamp, "rubber").on.kind, Measure::Kind::distance);
  EXPECT_EQ(find_quantity(clamp, "spring.rubber").on.kind, Measure::Kind::distance);
  EXPECT_EQ(find_quantity(read_scene(dataset("von_mises_toggle")), "guide").on.kind, Measure::Kind::travel);
  EXPECT_NE(complaint(clamp, "handel").find("did you mean \"angle.handle\""), std::string::npos)
      << complaint(clamp, "handel");
}

TEST(PathMeasures, AsksWhichOfSeveralElementsIsMeant) {
  Scene clamp = read_scene(dataset("toggle_clamp"));
  clamp.elements.push_back(clamp.elements.front());
  clamp.elements.back().table = "damper";
  EXPECT_EQ(complaint(clamp, "rubber"),
            "rubber: expected one element, found spring.rubber and damper.rubber; give one of these");
}

TEST(PathMeasures, ReadsPoses) {
  const VariedScene varied = varied_toggle();
  const Path path = toggle_path(varied);
  PathReader reader(varied);
  const PathPoint& point = path.branches.front().points[10];
  EXPECT_NEAR(reader.value(find_quantity(varied.scene(), "guide"), point), 0.4, 1e-15);
  EXPECT_NEAR(reader.value(find_quantity(varied.scene(), "apex.C.y"), point), 0.4, 1e-15);
  EXPECT_EQ(most_changing(varied, path).name, "travel.guide");
}

TEST(PathMeasures, ReadsDimensionsThatVary) {
  const VariedScene varied(read_scene(dataset("von_mises_toggle")), "point.ground.O.y", 0.0, 0.2);
  PathPoint point;
  PathReader reader(varied);
  const SoughtQuantity height = find_quantity(varied.scene(), "apex.C.y");
  for (const double at : {0.1, 0.2}) {
    point.parameter = at;
    point.x = varied.model_at(at)->from_si({0.3});
    EXPECT_NEAR(reader.value(height, point), 0.3 + at, 1e-15);
  }
}

TEST(EventPlace, HasTheStabilityOnBothSides) {
  const VariedScene varied = varied_toggle();
  const Path path = toggle_path(varied);
  const EventPlace first = place_of(path, 0, 60.0), second = place_of(path, 1, 60.0), snap = place_of(path, 2, 60.0);
  EXPECT_EQ(first.branch, 0);
  EXPECT_EQ(first.before, Stability::stable);
  EXPECT_EQ(first.after, Stability::unstable);
  EXPECT_EQ(second.before, Stability::unstable);
  EXPECT_EQ(second.after, Stability::stable);
  EXPECT_EQ(snap.branch, -1) << "on no branch of this path";
  EXPECT_EQ(snap.after, Stability::stable) << "of the landing";
}

TEST(EventPlace, OfASnapComesFromTheStableSide) {
  const VariedScene varied = varied_toggle();
  Path path = toggle_path(varied);
  // The curve reaches the second fold from its unstable side, a mechanism from the other.
  path.events[2].at = path.events[1].at;
  path.branches.front().events.push_back(2);
  const EventPlace snap = place_of(path, 2, 60.0);
  EXPECT_EQ(snap.before, Stability::stable);
  EXPECT_EQ(snap.after, Stability::stable);
}

TEST(EventPlace, LooksBeyondAPointThatIsTheEvent) {
  const VariedScene varied = varied_toggle();
  Path path = toggle_path(varied);
  std::vector<PathPoint>& points = path.branches.front().points;
  points.insert(points.begin() + 23, path.events.front().at);
  const EventPlace first = place_of(path, 0, 60.0);
  EXPECT_EQ(first.before, Stability::stable);
  EXPECT_EQ(first.after, Stability::unstable);
}

}  // namespace
}  // namespace poise::path_measures_test
