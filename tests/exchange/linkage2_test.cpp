// Files of Linkage, against the places that they say.

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/exchange/placed.hpp"

namespace poise::exchange_tests::linkage2_test {
namespace {

std::string linkage(const std::string& parts, const std::string& program = "<program units=\"Millimeters\"/>") {
  return "<linkage2>" + program + "\n" + parts + "</linkage2>\n";
}

// Four connectors, 96 units are an inch.
const std::string four_bar = R"(<connector id="0" x="0" y="0" anchor="true" input="true" rpm="15"/>
<connector id="1" x="96" y="192" color="4"/>
<connector id="2" x="384" y="288" name="knee"/>
<connector id="3" x="480" y="0" anchor="true"/>
<Link id="0"><connector id="0"/><connector id="1"/></Link>
<Link id="1" name="coupler"><connector id="1"/><connector id="2"/></Link>
<Link id="2"><connector id="2"/><connector id="3"/></Link>
<Link id="3"><connector id="0"/><connector id="3"/></Link>
)";

TEST(Linkage2, ConnectorsArePins) {
  const Scene scene = scene_of("linkage2", linkage(four_bar));
  ASSERT_EQ(scene.bodies.size(), 4U);
  EXPECT_EQ(scene.bodies[2].name, "coupler");
  EXPECT_EQ(scene.bodies[2].points[1].name, "knee");
  const Placed there = placed(scene);
  EXPECT_EQ(there.freedoms, 1);
  constexpr double inch = 0.0254;
  expect_places({{0, 0}, {inch, 2 * inch}, {4 * inch, 3 * inch}, {5 * inch, 0}}, there);
  ASSERT_EQ(scene.drives.size(), 1U);
  EXPECT_NEAR(scene.drives[0].rate, 90 * scene.units.angle, 1e-12);  // 15 turns a minute
  EXPECT_TRUE(has_note(imported("linkage2", linkage(four_bar)).notes, "Link 3 has two anchors"));
  EXPECT_NEAR(
      scene_of("linkage2", linkage(four_bar, "<program units=\"Inches\" scalefactor=\"2\"/>")).bodies[0].points[1].at.x,
      10 * inch, 1e-12);
}

TEST(Linkage2, ASliderRunsBetweenTwoConnectors) {
  const Scene scene = scene_of("linkage2", linkage(R"(<connector id="0" x="0" y="0" anchor="true"/>
<connector id="1" x="0" y="96"/>
<connector id="2" x="288" y="0" slider="true"><slidelimit id="4"/><slidelimit id="5"/></connector>
<connector id="4" x="96" y="0" anchor="true"/><connector id="5" x="480" y="0" anchor="true"/>
<connector id="9" x="1" y="1" layer="1"/>
<Link id="0"><connector id="0"/><connector id="1"/></Link><Link id="1"><connector id="1"/><connector id="2"/></Link>
)"));
  ASSERT_EQ(scene.joints.size(), 3U);
  EXPECT_EQ(scene.joints[2].kind, Joint::Kind::pin_in_slot);
  ASSERT_EQ(scene.stops.size(), 1U);
  EXPECT_NEAR(scene.stops[0].max, 4 * 0.0254, 1e-12);
  const Placed there = placed(scene);
  EXPECT_TRUE(there.assembled);
  EXPECT_EQ(there.freedoms, 1);
  expect_places({{3 * 0.0254, 0}}, there);
}

TEST(Linkage2, SaysWhatItCannotTake) {
  const auto with = [&](const std::string& more) { return linkage(four_bar + more); };
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"", "expected XML"},
      {"<linkage2><connector", "it.linkage2:1: expected XML"},
      {"<robot name=\"arm\"/>", "it.linkage2:1: expected the element <linkage2>, found <robot>"},
      {linkage(""), "expected a link besides the ground, found none"},
      {linkage(four_bar, "<program units=\"Furlongs\"/>"), "program.units: expected Millimeters or Inches"},
      {linkage(four_bar, "<program scalefactor=\"-1\"/>"), "program.scalefactor: expected a number > 0"},
      {with("<connector x=\"1\" y=\"1\"/>"), "it.linkage2:10: connector: expected the attribute id, found none"},
      {with("<connector id=\"8\" y=\"1\"/>"), "connector 8: expected the attribute x, found none"},
      {with("<connector id=\"8\" x=\"nan\" y=\"1\"/>"), "connector 8.x: expected"},
      {with("<connector id=\"1\" x=\"1\" y=\"1\"/>"), "connector 1: expected one connector of this id"},
      {with("<connector id=\"8\" x=\"1\" y=\"1\" fastenlink=\"1\"/>"),
       "expected no connector that is fastened to a link"},
      {with("<connector id=\"8\" x=\"1\" y=\"1\" slider=\"true\" slideradius=\"4\"/>"), "expected a straight slider"},
      {with("<connector id=\"8\" x=\"1\" y=\"1\" slider=\"true\"/>"), "expected a slider between two connectors"},
      {with("<Link id=\"7\" actuator=\"true\"/>"), "it.linkage2:10: Link 7: expected no actuator, which is not taken"},
      {with("<Link id=\"7\" gear=\"true\"/>"), "Link 7: expected no gear"},
      {with("<Link id=\"7\"><connector id=\"77\"/></Link>"), "expected the id of a connector, found \"77\""},
      {with("<ratios><ratio type=\"gears\"/></ratios>"), "ratio: expected no gears and chains"}};
  for (const auto& [text, message] : cases) {
    try {
      imported("linkage2", text);
      ADD_FAILURE() << "read: " << message;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << error.what();
    }
  }
  std::string deep;
  for (int i = 0; i < 200; ++i) deep += "<a>";
  for (int i = 0; i < 200; ++i) deep += "</a>";
  EXPECT_THROW(imported("linkage2", linkage(deep)), InputError);
}

}  // namespace
}  // namespace poise::exchange_tests::linkage2_test
