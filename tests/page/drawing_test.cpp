// Mechanisms drawn by hand, without a browser: what each tool writes, and that text, picture and undo agree.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/view/drawing_tools.hpp"
#include "statics/equilibrium/named_equilibrium.hpp"
#include "statics/model/pose_values.hpp"
#include "statics/model/readings.hpp"
#include "tests/app/run_poise.hpp"
#include "tests/page/hand.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/seed.hpp"

namespace poise::app::drawing_test {
namespace {

using app_tests::contents;
using app_tests::dataset;
using app_tests::error_of;
using app_tests::Hand;
using app_tests::run_poise;
using app_tests::TempFolder;
using nlohmann::json;

// The four-bar of the README, drawn from nothing: the same numbers, and the same equilibrium.
TEST(Drawing, TheFourBarOfTheReadmeFromAnEmptySheet) {
  const TempFolder folder;
  Hand hand(folder.path("drawn.toml"));
  EXPECT_EQ(hand.look()["missing"], "no link is drawn yet");
  for (const std::vector<double>& at : std::vector<std::vector<double>>{{0, 0}, {300, 0}, {0, 250}})
    ASSERT_EQ(error_of(hand.draw("ground_point", {at})), "");
  const double c = std::cos(M_PI / 3), s = std::sin(M_PI / 3);
  ASSERT_EQ(error_of(hand.draw("link", {{0, 0}, {100 * c, 100 * s}}, {{"name", "crank"}})), "");
  const json half = hand.look();
  EXPECT_NE(half["missing"].get<std::string>().find("nothing moves under load yet"), std::string::npos);
  // The coupler's end and the rocker's meet where circles of 280 and 220 mm about B and D do.
  const std::vector<double> b{100 * c, 100 * s}, d{300, 0};
  const double apart = std::hypot(d[0] - b[0], d[1] - b[1]);
  const double along = (280.0 * 280 - 220.0 * 220 + apart * apart) / (2 * apart),
               up = std::sqrt(280.0 * 280 - along * along);
  const std::vector<double> u{(d[0] - b[0]) / apart, (d[1] - b[1]) / apart};
  const std::vector<double> meet{b[0] + along * u[0] - up * u[1], b[1] + along * u[1] + up * u[0]};
  ASSERT_EQ(error_of(hand.draw("link", {b, meet}, {{"name", "coupler"}})), "");
  ASSERT_EQ(error_of(hand.draw("link", {d, meet}, {{"name", "rocker"}})), "");
  ASSERT_EQ(error_of(hand.draw("spring", {{0, 250}, b}, {{"name", "holder"}, {"stiffness", 5}, {"free_length", 100}})),
            "");
  // P is at (140, 60) of the coupler, wherever that rests now.
  json sheet = hand.look()["sheet"];
  const auto place = [&](const std::string& name) {
    for (const json& one : sheet["points"]) {
      if (one["name"] == name) return std::vector<double>{one["at"][0], one["at"][1]};
    }
    return std::vector<double>{};
  };
  const std::vector<double> from = place("coupler.D"), to = place("coupler.E");
  ASSERT_EQ(from.size(), 2U);
  const double length = std::hypot(to[0] - from[0], to[1] - from[1]);
  const std::vector<double> x{(to[0] - from[0]) / length, (to[1] - from[1]) / length};
  const std::vector<double> middle{from[0] + 140 * x[0], from[1] + 140 * x[1]};
  ASSERT_EQ(error_of(hand.draw("force", {middle}, {{"name", "load"}, {"vector", {0, -200}}})), "");
  ASSERT_EQ(
      error_of(hand.ask({{"do", "keys"}, {"item", "coupler"}, {"values", {{"mass", 1.2}, {"center", {140, 20}}}}})),
      "");
  hand.gestures += 3;
  ASSERT_EQ(error_of(hand.ask({{"do", "set"}, {"path", "point.coupler.F.x"}, {"value", 140}})), "");
  ASSERT_EQ(error_of(hand.ask({{"do", "set"}, {"path", "point.coupler.F.y"}, {"value", 60}})), "");
  EXPECT_LE(hand.gestures, 40);
  const std::string readme = contents(std::string(POISE_SOURCE_DIR) + "/README.md");
  const std::size_t begin = readme.find("title = \"My four-bar\"");
  const NamedEquilibrium expected =
      solve(parse_scene(readme.substr(begin, readme.find("```", begin) - begin), "readme.toml"));
  ASSERT_TRUE(expected.found());
  const NamedEquilibrium found = solve(parse_scene(hand.text(), "drawn.toml"));
  ASSERT_TRUE(found.found());
  for (const char* const body : {"crank", "coupler", "rocker"})
    EXPECT_NEAR(found.angle(body), expected.angle(body), 2e-5) << body;  // places were drawn to a thousandth of a mm
  std::printf("%d gestures\n", hand.gestures);
}

// A rectangle of 100 by 40 by 5 mm of steel with a hole of 20 mm in it, whose numbers are known in closed form.
TEST(Drawing, MassOfAPlateFromItsOutlineThicknessAndHoles) {
  const TempFolder folder;
  const std::string text =
      "[units]\nlength = \"mm\"\n[numbers]\nt = 5\n[body.plate]\n"
      "points = { A = [0, 0], B = [100, 0], H = [30, 20], C = [100, 40], D = [0, 40] }\n"
      "[[pin]]\npoints = [\"ground.O\", \"plate.A\"]\n[ground]\npoints = { O = [0, 0] }\n";
  Hand hand(folder.write("plate.toml", text));
  const json of_steel = {{"thickness", "t"}, {"density", 7850}, {"holes", "H 20"}};
  ASSERT_EQ(error_of(hand.draw("plate", {{50, 5}}, of_steel)), "");
  const auto expect_plate = [&](double thickness) {
    const Scene scene = parse_sketch(hand.text(), "plate.toml");
    const double k = 7850.0 * thickness, whole = 0.1 * 0.04, hole = M_PI / 4 * 0.02 * 0.02, area = whole - hole;
    const Vec2 center = (1.0 / area) * (whole * Vec2{0.05, 0.02} - hole * Vec2{0.03, 0.02});
    const double inertia = k * (whole * ((0.1 * 0.1 + 0.04 * 0.04) / 12 + std::pow(0.05 - center.x, 2)) -
                                hole * (0.02 * 0.02 / 8 + std::pow(0.03 - center.x, 2)));
    EXPECT_NEAR(scene.bodies[1].mass, k * area, 1e-5 * k * area);
    EXPECT_NEAR(scene.bodies[1].center.x, center.x, 1e-6);
    EXPECT_NEAR(scene.bodies[1].center.y, center.y, 1e-6);
    EXPECT_NEAR(scene.bodies[1].inertia, inertia, 1e-5 * inertia);
  };
  expect_plate(0.005);
  // The mass follows its thickness.
  ASSERT_EQ(error_of(hand.ask({{"do", "set"}, {"path", "numbers.t"}, {"value", 8}})), "");
  expect_plate(0.008);
  const std::string before = hand.text();
  for (const auto& [key, value] : std::vector<std::pair<const char*, json>>{{"holes", "K 20"},
                                                                            {"holes", "H"},
                                                                            {"holes", "H -3"},
                                                                            {"holes", "H 200"},
                                                                            {"density", 0},
                                                                            {"thickness", -1}}) {
    json wrong = of_steel;
    wrong[key] = value;
    EXPECT_NE(error_of(hand.draw("plate", {{50, 5}}, wrong)), "") << key << " " << value;
  }
  EXPECT_EQ(hand.text(), before);
}

// The corner C of that plate, its hole and a corner of a bar are moved: what the tools wrote is as if it were drawn
// there.
TEST(Drawing, MassesFollowPointsThatAreMoved) {
  const TempFolder folder;
  const auto text_with = [](const std::string& corner, const std::string& hole, const std::string& end) {
    return "[units]\nlength = \"mm\"\n[numbers]\nt = 5\n[body.plate]\npoints = { A = [0, 0], B = [100, 0], H = " +
           hole + ", C = " + corner + ", D = [0, 40] }\n[body.bar]\npoints = { A = [0, 0], E = " + end +
           " }\n[body.other]\npoints = { E = [0, 0], F = [30, 0], G = [0, 30] }\nmass = 2\ninertia = 30\n"
           "[[pin]]\npoints = [\"ground.O\", \"plate.A\"]\n[[pin]]\npoints = [\"ground.P\", \"bar.A\"]\n"
           "[[pin]]\npoints = [\"ground.Q\", \"other.E\"]\n"
           "[ground]\npoints = { O = [0, 0], P = [0, -200], Q = [0, -400] }\n";
  };
  const auto give_masses = [](Hand& hand) {
    ASSERT_EQ(error_of(hand.draw("plate", {{50, 5}}, {{"thickness", "t"}, {"density", 7850}, {"holes", "H 20"}})), "");
    ASSERT_EQ(error_of(hand.draw("mass", {{40, -200}}, {{"mass", 3}})), "");
  };
  const auto expect_same = [](const std::string& found, const std::string& expected) {
    const Scene a = parse_sketch(found, "moved.toml"), b = parse_sketch(expected, "drawn.toml");
    for (std::size_t k = 1; k < a.bodies.size(); ++k) {
      EXPECT_NEAR(a.bodies[k].mass, b.bodies[k].mass, 1e-6 * b.bodies[k].mass) << found;
      EXPECT_NEAR(norm(a.bodies[k].center - b.bodies[k].center), 0.0, 2e-6) << found;
      EXPECT_NEAR(a.bodies[k].inertia, b.bodies[k].inertia, 1e-3 * b.bodies[k].inertia) << found;
    }
  };
  Hand hand(folder.write("moved.toml", text_with("[100, 40]", "[30, 20]", "[80, 0]")));
  give_masses(hand);
  const std::string before = hand.text();
  const auto place = [&](const char* point, const std::vector<double>& at, bool goes_on) {
    ASSERT_EQ(
        error_of(hand.ask({{"do", "place"}, {"point", point}, {"at", at}, {"grain", 0.001}, {"goes_on", goes_on}})),
        "");
  };
  // A gesture of three moves is one step.
  place("plate.C", {105, 41}, true);
  place("plate.C", {115, 48}, true);
  place("plate.C", {120, 55}, false);
  Hand drawn(folder.write("drawn.toml", text_with("[120, 55]", "[30, 20]", "[80, 0]")));
  give_masses(drawn);
  expect_same(hand.text(), drawn.text());
  EXPECT_NE(hand.text().find("(t)*("), std::string::npos) << "its thickness is still a number\n" << hand.text();
  ASSERT_EQ(error_of(hand.ask({{"do", "undo"}})), "");
  EXPECT_EQ(hand.text(), before);
  // They follow a number of the panel too, and what no tool wrote stays.
  ASSERT_EQ(error_of(hand.ask({{"do", "set"}, {"path", "point.bar.E.x"}, {"value", 140}})), "");
  place("plate.H", {50, 15}, false);
  place("other.F", {60, -400}, false);
  Hand others(folder.write("others.toml", text_with("[100, 40]", "[50, 15]", "[140, 0]")));
  give_masses(others);
  expect_same(hand.text(), others.text());
  EXPECT_NE(hand.text().find("mass = 2\ninertia = 30\n"), std::string::npos) << hand.text();
}

// The message about an unknown key lists all keys of a scene file.
TEST(Drawing, EveryTableHasATool) {
  const std::string message = test::message_of([] { parse_scene("nothing = 1\n", "s.toml"); });
  const std::string before = "expected one of the keys ";
  std::size_t at = message.find(before);
  ASSERT_NE(at, std::string::npos) << message;
  std::set<std::string> tables;
  for (at += before.size(); at < message.size();) {
    const std::size_t end = std::min(message.find(", ", at), message.size());
    tables.insert(message.substr(at, end - at));
    at = end + 2;
  }
  EXPECT_GT(tables.size(), 30U);
  for (const char* const none :
       {"title", "source", "gravity", "units", "numbers", "ground", "body", "start", "outputs", "part", "frame"})
    EXPECT_EQ(tables.erase(none), 1U) << none;
  for (const DrawingTool& tool : drawing_tools()) tables.erase(std::string(tool.table));
  EXPECT_TRUE(tables.empty()) << *tables.begin() << " has no tool";
}

// What each tool writes at first is a scene that is read back.
TEST(Drawing, EveryToolWritesWhatIsRead) {
  const TempFolder folder;
  for (const DrawingTool& tool : drawing_tools()) {
    SCOPED_TRACE(std::string(tool.name));
    Hand hand(folder.write(std::string(tool.name) + ".toml", app_tests::slider_crank));
    const std::string before = hand.text();
    std::vector<std::vector<double>> at;
    // On the crank, on the rod, on the ground, elsewhere: as the picks want.
    const std::vector<std::vector<double>> bodies{{25, 43.3}, {95, 64.95}, {0, 200}};
    for (const Pick pick : tool.picks) {
      switch (pick) {
        case Pick::place:
          at.push_back(tool.name == "ground_point" ? std::vector<double>{-50, 50}
                       : tool.name == "link" ? std::vector<double>{-50.0 + 60.0 * static_cast<double>(at.size()), 120}
                       : tool.name == "pin" || tool.name == "weld" || tool.name == "plate" || tool.name == "loose_pin"
                           ? std::vector<double>{95, 64.95}
                           : std::vector<double>{25, 43.3});
          break;
        case Pick::direction:
          at.push_back({at.back()[0] + 100, at.back()[1]});
          break;
        case Pick::slide:
          at.push_back({230, 0});
          break;
        case Pick::moving:
          at.push_back(tool.name == "distributed_load" && at.empty() ? std::vector<double>{50, 86.6}
                       : tool.name == "distributed_load"             ? std::vector<double>{185, 22}
                                                                     : std::vector<double>{270.28, 0});
          break;
        case Pick::point:
          at.push_back(at.empty() ? std::vector<double>{0, 200}
                       : tool.picks[0] == Pick::moving
                           ? std::vector<double>{250.0 + 50.0 * static_cast<double>(at.size()), 0}
                           : std::vector<double>{50, 86.6});
          break;
        case Pick::body:
        case Pick::link:
          at.push_back(tool.name == "coupling" && at.size() % 2 == 0
                           ? bodies[2]
                           : bodies[(at.size() / (tool.name == "coupling" ? 2 : 1)) % 2]);
          break;
      }
    }
    const json drawn = hand.draw(std::string(tool.name), at);
    ASSERT_EQ(error_of(drawn), "");
    const std::string after = hand.text();
    EXPECT_NE(after, before);
    if (!tool.table.empty()) {
      EXPECT_NE(after.find("[[" + std::string(tool.table) + "]]"), std::string::npos) << after;
    }
    EXPECT_EQ(test::message_of([&] { parse_sketch(after, "drawn.toml"); }), "");
    EXPECT_EQ(error_of(hand.ask({{"do", "undo"}})), "");
    EXPECT_EQ(hand.text(), before);
    EXPECT_EQ(error_of(hand.ask({{"do", "redo"}})), "");
    EXPECT_EQ(hand.text(), after);
  }
}

// An outline is on one body, its point on another; a pin or a slot with clearance on one link is held by the ground.
TEST(Drawing, ContactsAndClearancesAreOnTheBodiesThatAreMeant) {
  const TempFolder folder;
  const auto drawn = [&](const std::string& tool, const std::vector<std::vector<double>>& at) {
    Hand hand(folder.write(tool + ".toml", app_tests::slider_crank));
    EXPECT_EQ(error_of(hand.draw(tool, at)), "") << tool;
    return parse_sketch(hand.text(), "drawn.toml");
  };
  const std::vector<double> on_rod{95, 64.95}, rod_too{185, 22};
  {
    // At the last place of the outline the crank has a point, too.
    const Scene scene = drawn("contact", {{270.28, 0}, rod_too, on_rod, {50, 86.6}});
    EXPECT_TRUE(scene.stops.back().table.starts_with("contact")) << scene.stops.back().table;
    EXPECT_EQ(scene.bodies[static_cast<std::size_t>(scene.stops.back().on.b.body)].name, "block");
    for (const PointRef& point : scene.stops.back().on.outline.points)
      EXPECT_EQ(scene.bodies[static_cast<std::size_t>(point.body)].name, "rod");
    EXPECT_GT(scene.stops.back().min, 0.0);
  }
  {
    const Scene scene = drawn("loose_pin", {on_rod});
    const Stop& stop = scene.stops.back();
    EXPECT_EQ(stop.table, "loose_pin");
    EXPECT_EQ(stop.on.a.body, 0);
    EXPECT_EQ(scene.bodies[static_cast<std::size_t>(stop.on.b.body)].name, "rod");
    EXPECT_GT(stop.max, 0.0);
  }
  {
    const Scene scene = drawn("loose_slot", {on_rod, {195, 64.95}});
    const Stop& stop = scene.stops.back();
    EXPECT_EQ(stop.table, "loose_slot");
    EXPECT_EQ(stop.on.a.body, 0);
    EXPECT_EQ(scene.bodies[static_cast<std::size_t>(stop.on.b.body)].name, "rod");
    EXPECT_GT(stop.max, 0.0);
    EXPECT_EQ(stop.min, -stop.max);
  }
}

// What was drawn outlives the program, and leads back to the file.
TEST(Drawing, WhatWasNotSavedIsThereAgain) {
  const TempFolder folder;
  const std::string file = folder.write("clamp.toml", contents(dataset("toggle_clamp")));
  std::string first, drawn;
  {
    Hand hand(file);
    first = hand.text();
    EXPECT_EQ(folder.names(), std::vector<std::string>{"clamp.toml"});
    ASSERT_EQ(error_of(hand.draw("ground_point", {{10, 200}})), "");
    drawn = hand.text();
  }
  EXPECT_EQ(contents(folder.path("clamp.toml.draft").string()), drawn);
  {
    Hand hand(file);
    EXPECT_TRUE(hand.look()["draft"]);
    EXPECT_EQ(hand.text(), drawn);
    ASSERT_EQ(error_of(hand.ask({{"do", "undo"}})), "");
    EXPECT_EQ(hand.text(), first);
    ASSERT_EQ(error_of(hand.ask({{"do", "redo"}})), "");
    EXPECT_EQ(hand.text(), drawn);
    ASSERT_EQ(error_of(hand.ask({{"do", "save"}})), "");
  }
  EXPECT_EQ(folder.names(), std::vector<std::string>{"clamp.toml"});
  EXPECT_EQ(contents(file), drawn);
  // A draft that is no scene is left alone.
  folder.write("clamp.toml.draft", "[[spring");
  Hand hand(file);
  EXPECT_FALSE(hand.look()["draft"]);
  EXPECT_EQ(hand.text(), drawn);
}

// Gestures at random: whatever is drawn, renamed or taken away, the text is a scene with the points that are shown,
// undo leads back to the first byte, and what is called an equilibrium is one for `poise solve` of the text that is
// shown. POISE_FIRST_SEQUENCE=I begins with sequence I.
TEST(Drawing, AtRandomTextPictureAndUndoAgree) {
  const int sequences = test::cases(6, 250);
  const char* const first_sequence = std::getenv("POISE_FIRST_SEQUENCE");
  const TempFolder folder;
  int done = 0, refused = 0, rests = 0, compared = 0;
  for (int sequence = first_sequence == nullptr ? 0 : std::atoi(first_sequence); sequence < sequences; ++sequence) {
    SCOPED_TRACE("sequence " + std::to_string(sequence));
    std::mt19937 random(test::seed(static_cast<std::uint64_t>(sequence)));
    const auto below = [&](int n) { return std::uniform_int_distribution<int>(0, n - 1)(random); };
    Hand hand(folder.path(std::to_string(sequence) + ".toml"));
    const std::string first = hand.text();
    const auto compare = [&](const std::string& text) {
      // A number or a place can leave nothing loaded: all rests where it is, and solve has nothing to find.
      if (hand.session.tracked().equilibrium().x.empty()) return;
      SolveOptions any;
      any.seek = Seek::any;
      std::optional<NamedEquilibrium> solved;
      const std::string why = test::message_of([&] { solved = solve(parse_scene(text, "random.toml"), any); });
      ASSERT_EQ(why, "") << text;
      const NamedEquilibrium& found = *solved;
      if (!found.found()) return;
      ++compared;
      // Where an equilibrium is one of many, the text has the one that is shown to the digits of [start] alone.
      if (found.result().certificate.outcome != poise::Outcome::proved) return;
      const TrackedEquilibrium& tracked = hand.session.tracked();
      const StaticModel model(found.scene());
      for (const NamedValue& angle : angles_of(model, read_off(model, found.result().x))) {
        const std::vector<Body>& bodies = tracked.scene().bodies;
        const auto body =
            std::find_if(bodies.begin(), bodies.end(), [&](const Body& one) { return one.name == angle.name; });
        if (body == bodies.end()) continue;  // not a body of its own: a rope, a chain
        const double shown = tracked.poses()[static_cast<std::size_t>(body - bodies.begin())].angle;
        EXPECT_NEAR(std::remainder(angle.value - shown, 2 * M_PI), 0.0, angle.determined ? 1e-9 : 1e-5)
            << angle.name << "\n"
            << text;
      }
    };
    // A swing on a spring, which comes to rest.
    for (const double x : {0.0, 100.0}) hand.draw("ground_point", {{x, 100.0 - x}});
    hand.draw("link", {{0, 100}, {60.0 + below(40), 20.0 + below(40)}});
    const json tip = hand.look()["sheet"]["points"].back()["at"];
    hand.draw("force", {{tip[0], tip[1]}});
    hand.draw("spring", {{100, 0}, {tip[0], tip[1]}});
    for (int gesture = 5; gesture < 50; ++gesture) {
      const json state = hand.look();
      const json& points = state["sheet"]["points"];
      const json& items = state["items"];
      const auto place = [&]() -> std::vector<double> {
        if (!points.empty() && below(3) > 0) {
          const json& at = points[static_cast<std::size_t>(below(static_cast<int>(points.size())))]["at"];
          return {at[0], at[1]};
        }
        return {10.0 * below(40), 10.0 * below(25)};
      };
      json answer;
      const int kind = below(20);
      if (kind == 0 && !items.empty()) {
        answer =
            hand.ask({{"do", "remove"},
                      {"items", {items[static_cast<std::size_t>(below(static_cast<int>(items.size())))]["item"]}}});
      } else if (kind == 1 && !items.empty()) {
        answer = hand.ask({{"do", "rename"},
                           {"item", items[static_cast<std::size_t>(below(static_cast<int>(items.size())))]["item"]},
                           {"name", "n" + std::to_string(gesture)}});
      } else if (kind == 2 && !points.empty()) {
        const std::string name = points[static_cast<std::size_t>(below(static_cast<int>(points.size())))]["name"];
        answer = hand.ask({{"do", "place"}, {"point", name}, {"at", place()}, {"grain", 0.01}});
      } else {
        const auto tools = drawing_tools();
        // Links come more often than the rest.
        const DrawingTool& tool =
            below(3) == 0 ? tools[1] : tools[static_cast<std::size_t>(below(static_cast<int>(tools.size())))];
        std::vector<std::vector<double>> at;
        for (std::size_t k = 0; k < tool.picks.size() + (tool.more ? static_cast<std::size_t>(below(2)) : 0); ++k)
          at.push_back(place());
        answer = hand.draw(std::string(tool.name), at);
      }
      const json now = hand.look();
      if (!error_of(answer).empty()) {
        ++refused;
        ASSERT_EQ(now["text"], state["text"]) << error_of(answer);
        continue;
      }
      ++done;
      const std::string text = now["text"];
      Scene scene;
      ASSERT_EQ(test::message_of([&] { scene = parse_sketch(text, "random.toml"); }), "") << text;
      std::set<std::string> shown, written;
      for (const json& point : now["sheet"]["points"]) shown.insert(point["name"].get<std::string>());
      for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
        for (const NamedPoint& point : scene.bodies[b].points) written.insert(scene.bodies[b].name + "." + point.name);
      }
      ASSERT_EQ(shown, written) << text;
      if (!now["missing"].get<std::string>().empty()) continue;
      ++rests;
      if (hand.session.tracked().equilibrium().found() && gesture % 5 == 0) compare(text);
    }
    while (hand.look()["undo"] > 0) ASSERT_EQ(error_of(hand.ask({{"do", "undo"}})), "");
    ASSERT_EQ(hand.text(), first);
  }
  std::printf("%d gestures, %d refused, %d ended in a mechanism that rests, %d compared with solve\n", done, refused,
              rests, compared);
  EXPECT_GT(done, refused);
}

}  // namespace
}  // namespace poise::app::drawing_test
