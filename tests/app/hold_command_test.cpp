#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/run_poise.hpp"

namespace poise::app_tests::hold_command_test {
namespace {

using nlohmann::json;

json hold(std::vector<std::string> words, int code = 0) {
  const TempFolder folder;
  const std::string file = folder.path("hold.json").string();
  words.insert(words.begin(), "hold");
  words.insert(words.end(), {"--json", file});
  const ProgramRun run = run_poise(words);
  EXPECT_EQ(run.exit_code, code) << run.out << run.err;
  return json::parse(contents(file));
}

TEST(HoldCommand, WedgeLocksAtAnyLoad) {
  const json found = hold({dataset("friction/wedge"), "--vary", "load.P"});
  EXPECT_EQ(found["verdict"], "held");
  EXPECT_EQ(found["proved"], true);
  EXPECT_NEAR(found["least_factor"].get<double>(), std::tan(4 * M_PI / 180) / 0.1, 1e-9);
  EXPECT_EQ(found["range"]["upper"]["without_end"], true);
  EXPECT_EQ(found["range"]["upper"]["proved"], true);
  EXPECT_EQ(found["range"]["contains_present"], true);
}

TEST(HoldCommand, LadderOfTheDataset) {
  const json found = hold({dataset("friction/ladder"), "--vary", "load.P=0..100000"});
  EXPECT_EQ(found["verdict"], "held");
  // With the weights in the middle: datasets/friction/ladder.toml.
  const double edge = std::atan((1 - 0.3 * 0.2) / 0.6) * 180 / M_PI;
  EXPECT_NEAR(edge, 57.45, 0.01);
}

TEST(HoldCommand, DrawerMovesFromItsPullOn) {
  const json found = hold({dataset("friction/drawer"), "--vary", "load.P"});
  EXPECT_NEAR(found["range"]["upper"]["value"].get<double>(), 2 / 0.58, 1e-9);
  EXPECT_EQ(found["range"]["upper"]["slips"][0]["name"], "guides");
  EXPECT_EQ(found["range"]["upper"]["slips"][0]["increases"], true);
}

TEST(HoldCommand, APoseThatIsHeldIsSoOutsideOfTheRangeToo) {
  const ProgramRun none = run_poise({"hold", dataset("friction/drawer"), "--vary", "load.P=5..9"});
  EXPECT_NE(none.out.find("now          3 N, held, outside of the range"), std::string::npos) << none.out;
  EXPECT_NE(none.out.find("no value of it that was asked for is held"), std::string::npos) << none.out;
  const ProgramRun some = run_poise({"hold", dataset("friction/drawer"), "--vary", "load.P=3.2..9"});
  EXPECT_NE(some.out.find("now          3 N, held, outside of the range"), std::string::npos) << some.out;
  const ProgramRun slips = run_poise({"hold", dataset("friction/drawer"), "--set", "load.P=4", "--vary", "load.P"});
  EXPECT_NE(slips.out.find("now          4 N, not held"), std::string::npos) << slips.out;
}

// A cart on a level floor needs no sideways gravity: what rounding leaves of 0 is none, and has no efficiency.
TEST(HoldCommand, RoundingIsNoIdealLoad) {
  const TempFolder folder;
  const std::string cart = folder.write("cart.toml", R"(
gravity = [0.1, -10]
ground.points = { O = [0, 0] }
body.cart = { points = { A = [0, 0], B = [1, 0] }, mass = 10, center = [0.4, 0.3] }
body.w1.points = { O = [0, 0] }
body.w2.points = { O = [0, 0] }
pin = [{ name = "A", points = ["cart.A", "w1.O"], friction = { coefficient = 0.3, radius = 0.03 } },
       { name = "B", points = ["cart.B", "w2.O"], friction = { coefficient = 0.3, radius = 0.03 } }]
rolling = [{ name = "r1", wheel = "w1.O", line = "ground.O", axis = [1, 0], radius = 0.2 },
           { name = "r2", wheel = "w2.O", line = "ground.O", axis = [1, 0], radius = 0.2, offset = 1 }]
start.position = { cart = [0, 0.2] }
)");
  const json range = hold({cart, "--vary", "gravity.x"})["range"];
  EXPECT_EQ(range["ideal"], 0.0);
  EXPECT_TRUE(range["efficiency"].is_null()) << range;
  // A wheel without mass rolls where the force on it passes its axle's friction circle.
  const double circle = 0.03 * std::sin(std::atan(0.3));
  EXPECT_NEAR(range["upper"]["value"].get<double>(), 10 * std::tan(std::asin(circle / 0.2)), 1e-9);
}

TEST(HoldCommand, CapstanOfTheDataset) {
  const json found = hold({dataset("friction/capstan"), "--vary", "load.P"});
  EXPECT_EQ(found["verdict"], "held");
  EXPECT_NEAR(found["range"]["lower"]["value"].get<double>(), 400 * std::exp(-0.3 * M_PI), 1e-7);
  EXPECT_NEAR(found["range"]["upper"]["value"].get<double>(), 400 * std::exp(0.3 * M_PI), 1e-7);
  EXPECT_EQ(found["range"]["upper"]["slips"][0]["name"], "rope on ground.O");
  EXPECT_EQ(found["friction"][0]["kind"], "rope");
  const ProgramRun solved = run_poise({"forces", dataset("friction/capstan")});
  EXPECT_NE(solved.out.find("Friction of the rope \"rope\""), std::string::npos) << solved.out << solved.err;
}

TEST(HoldCommand, ToggleOfTheDataset) {
  const json found = hold({dataset("friction/toggle"), "--vary", "load.P"});
  const double circle = 8 * std::sin(std::atan(0.15));
  EXPECT_NEAR(found["range"]["upper"]["value"].get<double>(), 5 / (100 * std::sin(2 * M_PI / 180) - 2 * circle), 1e-8);
  EXPECT_EQ(found["range"]["upper"]["slips"].size(), 3U);
}

TEST(HoldCommand, RefusesByName) {
  const auto refused = [](const std::vector<std::string>& words, const std::string& message) {
    const ProgramRun run = run_poise(words);
    EXPECT_EQ(run.exit_code, 2) << run.out;
    EXPECT_NE(run.err.find(message), std::string::npos) << run.err;
  };
  refused({"hold", dataset("six_bar")}, "expected friction");
  refused({"hold", dataset("friction/wedge"), "--vary", "point.wedge.W.y"}, "--vary point.wedge.W.y: expected");
}

TEST(HoldCommand, MotionTreatsFrictionOfJoints) {
  const ProgramRun swings =
      run_poise({"motion", dataset("friction/bearing"), "--release", "arm=60", "--duration", "1"});
  EXPECT_EQ(swings.exit_code, 0) << swings.err;
  const std::vector<std::string> wedge{"motion", dataset("friction/wedge"), "--from", "start", "--duration", "1"};
  // Without a mass the wedge may also leave the block that falls, with no force between them.
  const ProgramRun massless = run_poise(wedge);
  EXPECT_EQ(massless.exit_code, 1);
  EXPECT_NE(massless.out.find("may hold or let go"), std::string::npos) << massless.out << massless.err;
  std::vector<std::string> with_mass = wedge;
  with_mass.insert(with_mass.end(), {"--set", "body.wedge.mass=2"});
  const ProgramRun held = run_poise(with_mass);
  EXPECT_EQ(held.exit_code, 0) << held.out << held.err;
}

constexpr const char* pendulum = R"(
gravity = [0, -10]
[ground]
points = { O = [0, 0] }
[body.rod]
points = { O = [0, 0] }
mass = MASS
center = [0.5, 0]
[[pin]]
name = "O"
points = ["ground.O", "rod.O"]
friction = { radius = 0.01, coefficient = 0.2 }
[start]
rod = 0.1
)";

std::string pendulum_of(const std::string& mass) {
  std::string text = pendulum;
  return text.replace(text.find("MASS"), 4, mass);
}

TEST(HoldCommand, AtRestIsTheEquilibriumWithoutFriction) {
  const TempFolder folder;
  const std::string scene = folder.write("pendulum.toml", pendulum_of("2"));
  const json drawn = hold({scene});
  EXPECT_EQ(drawn["verdict"], "slips");
  EXPECT_EQ(drawn["at_rest"], false);
  const json rest = hold({scene, "--at-rest"});
  EXPECT_EQ(rest["verdict"], "held");
  EXPECT_EQ(rest["at_rest"], true);
  EXPECT_EQ(rest["least_factor"], 0.0);
  EXPECT_NEAR(std::remainder(rest["pose"]["rod"].get<double>() + M_PI / 2, 2 * M_PI), 0.0, 1e-9);
}

TEST(HoldCommand, WithoutALoadItIsHeld) {
  const TempFolder folder;
  const std::string scene = folder.write("pendulum.toml", pendulum_of("0"));
  for (const std::vector<std::string>& more : {std::vector<std::string>{}, {"--at-rest"}}) {
    std::vector<std::string> words = {scene};
    words.insert(words.end(), more.begin(), more.end());
    const json found = hold(words);
    EXPECT_EQ(found["verdict"], "held");
    EXPECT_EQ(found["proved"], true);
    EXPECT_EQ(found["least_factor"], 0.0);
  }
}

TEST(HoldCommand, DrawsWhatSlipsFirst) {
  const TempFolder folder;
  const std::string file = folder.path("held.svg").string();
  EXPECT_EQ(run_poise({"hold", dataset("friction/wedge"), "--svg", file}).exit_code, 0);
  EXPECT_NE(contents(file).find("slips first"), std::string::npos);
  const std::string scene = folder.write("pendulum.toml", pendulum_of("0"));
  EXPECT_EQ(run_poise({"hold", scene, "--svg", file}).exit_code, 0);
  EXPECT_EQ(contents(file).find("slips first"), std::string::npos) << "nothing slips without a load";
}

// The force across a guide that a cam makes is not one of the guide's.
TEST(HoldCommand, SaysWhereContactsPressOnGuides) {
  std::string text = contents(dataset("offset_cam"));
  const std::string guide = "name = \"guide\"\n";
  ASSERT_NE(text.find(guide), std::string::npos);
  text.insert(text.find(guide) + guide.size(), "friction = { coefficient = 0.2 }\n");
  const TempFolder folder;
  const std::string file = folder.write("cam.toml", text);
  const std::string expected =
      "Friction leaves out how teeth and contacts of \"eccentric\" press on bearings and guides";
  for (const std::vector<std::string>& words : {std::vector<std::string>{"hold", file},
                                                {"solve", file},
                                                {"forces", file, "--drive", "cam=30", "--rate", "1"}}) {
    const ProgramRun run = run_poise(words);
    EXPECT_NE((run.out + run.err).find(expected), std::string::npos) << words[0] << "\n" << run.out << run.err;
  }
  // Not where the scene has the roller.
  const std::string curve = "guided = true\n";
  ASSERT_NE(text.find(curve), std::string::npos);
  text.insert(text.find(curve), "roller = \"follower.R\"\n");
  const std::string known = folder.write("roller.toml", text);
  for (const std::vector<std::string>& words : {std::vector<std::string>{"hold", known},
                                                {"forces", known, "--drive", "cam=30", "--rate", "1"},
                                                {"motion", known, "--from", "start", "--duration", "0.001"}}) {
    const ProgramRun run = run_poise(words);
    EXPECT_EQ((run.out + run.err).find("riction leaves out"), std::string::npos) << words[0] << run.out << run.err;
  }
  const ProgramRun plain = run_poise({"solve", dataset("offset_cam")});
  EXPECT_EQ((plain.out + plain.err).find("Friction leaves out"), std::string::npos) << plain.out;
}

TEST(HoldCommand, OthersSayThatFrictionIsLeftOut) {
  const ProgramRun solved = run_poise({"solve", dataset("friction/drawer")});
  EXPECT_NE(solved.out.find("friction"), std::string::npos) << solved.out << solved.err;
  EXPECT_NE(solved.out.find("as drawn"), std::string::npos) << solved.out;
}

}  // namespace
}  // namespace poise::app_tests::hold_command_test
