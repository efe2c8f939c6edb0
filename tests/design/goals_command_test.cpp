// `poise design` of files with [[goal]]: what is wrong with a file, the same bytes on any number of threads, Ctrl-C.

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "model/scene.hpp"
#include "tests/app/run_poise.hpp"
#include "tests/app/wheel_experiment.hpp"

namespace poise::app_tests::goals_command_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const char* const head = "scene = \"wall_bed.toml\"\n";
const char* const chosen = "[variables]\n\"spring.balance.stiffness\" = [5000, 30000]\n";
const char* const force = "[[goal]]\nof = \"force.drive / 2\"\nalong = \"angle.bed\"\nover = [0, 90]\n";
const char* const goal =
    "[[goal]]\nof = \"force.drive / 2\"\nalong = \"angle.bed\"\nover = [0, 90]\nleast = -25\nmost = 25\n";

/// A design that is wrong: its text, and the message after "FILE:".
struct Wrong {
  std::string text, message;
};

std::vector<Wrong> wrong_designs() {
  const std::string variables = std::string(head) + "[variables]\n", good = std::string(head) + chosen;
  const std::string passes = "along = \"angle.bed\"\nover = [0, 90]\n";
  return {
      {std::string(chosen) + goal, "1: expected the key scene; add scene = \"...\""},
      {head + std::string(goal), "1: expected [variables] or [[catalogue]]: what may be chosen; add one"},
      {variables + goal, "1: expected [variables] or [[catalogue]]: what may be chosen; add one"},
      {"scenes = 3\n" + good + goal,
       "1: scenes: expected one of the keys title, source, scene, tolerances, share, variables, ties, catalogue, goal; "
       "did you mean \"scene\"?"},
      {good + goal + "[synthesis]\na = 1\n",
       "10: synthesis: expected one kind of design, found goal and synthesis; remove one"},
      {variables + "\"spring.balanc.stiffness\" = [1, 2]\n" + goal,
       "3: variables.spring.balanc.stiffness: spring.balanc.stiffness: expected the path of a number of the scene; did "
       "you mean \"spring.balance.stiffness\"?"},
      {variables + "\"spring.balance.stiffness\" = 5000\n" + goal,
       "3: variables.spring.balance.stiffness: expected two numbers [X, Y], found a number"},
      {variables + "\"spring.balance.stiffness\" = [3, 2]\n" + goal,
       "3: variables.spring.balance.stiffness: expected [LEAST, GREATEST], two different numbers, the smaller first"},
      {variables + "\"spring.balance.stiffness\" = [-5, 2]\n" + goal,
       "3: variables.spring.balance.stiffness: expected a finite number >= 0, found -5"},
      {variables + "\"spring.balance.stiffness\" = [nan, 2]\n" + goal,
       "3: variables.spring.balance.stiffness: expected a finite number, found nan"},
      {variables + "\"body.bed.inertia\" = [1, 2]\n" + goal,
       "3: variables.body.bed.inertia: equilibrium does not depend on it; expected a load, a stiffness, a dimension or "
       "another number that acts at rest"},
      {variables + "\"spring.balance.stiffness\" = { range = [5, 7.5], whole = true }\n" + goal,
       "3: variables.spring.balance.stiffness.range: expected two different whole numbers, the smaller first"},
      {variables + "\"spring.balance.stiffness\" = { range = [1, 300], whole = true }\n" + goal,
       "3: variables.spring.balance.stiffness.range: expected at most 200 whole numbers; take a smaller range"},
      {good + "[ties]\n\"point.ground.S.x\" = \"spring.balance.stifness / 1000\"\n" + goal,
       "5: ties.point.ground.S.x: expected numbers of [variables], found spring.balance.stifness; did you mean "
       "\"spring.balance.stiffness\"?"},
      {good + "[ties]\n\"spring.balance.stiffness\" = \"3\"\n" + goal,
       "5: ties.spring.balance.stiffness: it is chosen twice; remove one"},
      {good + "[ties]\n\"point.ground.S.x\" = 3\n" + goal,
       "5: ties.point.ground.S.x: expected a string, found a number"},
      {good + "[[goal]]\n" + passes,
       "4: goal 1: expected one of: of = \"QUANTITY\", equilibrium = \"stable\", passes = true"},
      {good + "[[goal]]\npasses = true\nof = \"angle.bed\"\n" + passes,
       "4: goal 1: expected one of: of = \"QUANTITY\", equilibrium = \"stable\", passes = true"},
      {good + "[[goal]]\npasses = false\n" + passes, "5: goal 1.passes: expected true; leave the goal out otherwise"},
      {good + "[[goal]]\npasses = true\nalong = \"angle.bed\"\nat = 3\n",
       "4: goal 1: expected over = [FROM, TO], the range that is to be passed"},
      {good + "[[goal]]\npasses = true\nleast = 3\n" + passes,
       "6: goal 1.least: expected one of the keys equilibrium, passes, along, over, at, positions"},
      {good + "[[goal]]\nequilibrium = \"stabel\"\nalong = \"angle.bed\"\nat = 3\n",
       "5: goal 1.equilibrium: expected one of stable, unstable, none, found \"stabel\"; did you mean \"stable\"?"},
      {good + "[[goal]]\nequilibrium = \"none\"\nalong = \"angle.bed\"\nat = 3\n",
       "4: goal 1: expected over = [FROM, TO], where there is to be none"},
      {good + "[[goal]]\nequilibrium = \"stable\"\n" + passes, "4: goal 1: expected at = VALUE, where it is to be"},
      {good + "[[goal]]\nequilibrium = \"stable\"\nalong = \"angle.bed\"\nat = [3, 4]\n",
       "7: goal 1.at: expected one value; make a goal of each"},
      {good + "[[goal]]\nequilibrium = \"stable\"\nalong = \"body.bed.mass\"\nat = 30\n",
       "6: goal 1.along: expected a measure that is driven, say angle.BODY or length.ELEMENT: in an equilibrium "
       "nothing "
       "drives it"},
      {good + "[ties]\n\"point.ground.S.x\" = \"spring.balance.stiffness / \"\n" + goal,
       "5: ties.point.ground.S.x: expected a number, a name or \"(\", found its end in \"spring.balance.stiffness / "
       "\""},
      {good + "[[goal]]\nof = \"force.driv\"\nmost = 3\n" + passes,
       "5: goal 1.of: force.driv: expected the name of a force element or drive; did you mean \"force.bed\" or "
       "\"force.balance\"?"},
      {good + "[[goal]]\nof = \"angle.bed\"\nalong = \"angle.bad\"\nat = 3\nmost = 3\n",
       "6: goal 1.along: angle.bad: expected the name of a body; did you mean \"bed\"?"},
      {good + "[[goal]]\nof = \"angle.bed\"\nalong = \"spring.balance.stiffness\"\nat = 3\nmost = 3\n",
       "6: goal 1.along: it is chosen too; expected what goals are asked along"},
      {good + "[[goal]]\nof = \"angle.bed\"\nalong = \"angle.bed\"\nmost = 3\n",
       "4: goal 1: expected either over = [FROM, TO] or at = VALUE"},
      {good + force + "at = 3\nmost = 3\n", "4: goal 1: expected either over = [FROM, TO] or at = VALUE"},
      {good + "[[goal]]\nof = \"force.balance\"\nover = [3, 4]\nmost = 3\n",
       "6: goal 1.over: expected along = \"...\" beside it, what takes these values"},
      {good + "[[goal]]\nof = \"force.drive\"\nalong = \"angle.bed\"\nover = [3, 3]\nmost = 3\n",
       "7: goal 1.over: expected two different values"},
      {good + force, "4: goal 1: expected least, most, equals, curve or aim"},
      {good + force + "least = 30\nmost = 25\n", "8: goal 1.least: expected least <= most; swap them"},
      {good + force + "equals = 3\nmost = 25\n", "8: goal 1.equals: expected either equals or least and most"},
      {good + force + "equals = 3\n",
       "8: goal 1.equals: expected within = DISTANCE beside it: no mechanism keeps a value exactly"},
      {good + force + "within = 3\nmost = 3\n", "8: goal 1.within: expected equals or curve beside it"},
      {good + force + "aim = \"flat\"\nmost = 3\n",
       "9: goal 1.most: it is a limit, and the goal an aim; make a goal of each"},
      {good + force + "aim = \"falt\"\n",
       "8: goal 1.aim: expected one of least, greatest, flat, curve, found \"falt\"; did you mean \"flat\"?"},
      {good + force + "weight = 2\nmost = 3\n",
       "8: goal 1.weight: limits are kept, whatever they weigh; expected an aim beside it, or none"},
      {good + force + "positions = 1\nmost = 3\n", "8: goal 1.positions: expected a whole number from 2 to 1000"},
      {good + "[[goal]]\nof = \"max(force.drive)\"\nalong = \"angle.bed\"\nat = 3\nmost = 3\n",
       "5: goal 1.of: it belongs to a range; expected over = [FROM, TO]"},
      {good + "[[goal]]\nof = \"mode.1.frequency\"\nmost = 3\n",
       "5: goal 1.of: it has no derivatives here; expected another quantity"},
      {"share = \"99.7 %\"\n" + good + goal, "1: share: expected tolerances = \"FILE\" beside it"},
      {good + "[[catalogue]]\nfile = \"twice.csv\"\nitems = [\"spring.balance\"]\n" + goal,
       "6: catalogue 1.items: it is chosen twice; remove one"},
      {variables + "[[catalogue]]\nfile = \"twice.csv\"\n" + goal,
       "3: catalogue 1: expected items = [\"TABLE.NAME\"], what a row of the file is chosen for"},
  };
}

TEST(GoalsCommand, SaysWhatIsWrongWithAFileAndWritesNothing) {
  const TempFolder folder;
  fs::copy_file(dataset("wall_bed"), folder.path("wall_bed.toml"));
  folder.write("twice.csv", "name,stiffness\nsoft,8000\nhard,12000\n");
  for (const Wrong& wrong : wrong_designs()) {
    const std::string file = folder.write("design.toml", wrong.text);
    const std::size_t before = folder.names().size();
    const ProgramRun run = run_poise(
        {"design", file, "--json", folder.path("o.json").string(), "--scene", folder.path("o.toml").string()});
    EXPECT_EQ(run.exit_code, 2) << wrong.text;
    EXPECT_EQ(run.err, file + ":" + wrong.message + "\n") << wrong.text;
    EXPECT_EQ(run.out, "") << wrong.text;
    EXPECT_EQ(folder.names().size(), before) << wrong.text;
  }
}

// Rows of a catalogue are placed in its own file, or at the key that names it.
TEST(GoalsCommand, SaysWhatIsWrongWithACatalogue) {
  const TempFolder folder;
  fs::copy_file(dataset("wall_bed"), folder.path("wall_bed.toml"));
  const std::string file = folder.write("design.toml", std::string(head) +
                                                           "[[catalogue]]\nfile = \"c.csv\"\nitems = "
                                                           "[\"spring.balance\"]\n" +
                                                           goal);
  const std::string csv = folder.path("c.csv").string();
  const auto objection = [&](const std::string& rows) {
    folder.write("c.csv", rows);
    const ProgramRun run = run_poise({"design", file});
    EXPECT_EQ(run.exit_code, 2) << rows;
    return run.err;
  };
  EXPECT_EQ(objection("name,stiffness\na,5x\n"), file + ":3: catalogue 1.file: " + csv +
                                                     ":2: stiffness: expected a number, found \"5x\"; correct it or "
                                                     "leave the row out\n");
  EXPECT_EQ(objection("name,stiffness\n"), file + ":3: catalogue 1.file: " + csv + ": expected one row at least\n");
  EXPECT_EQ(objection("stiffness\n-5\n"), csv + ":2: stiffness: expected a finite number >= 0, found -5\n");
  EXPECT_EQ(objection("stiffness,shortest,longest\n5,3,2\n"), csv + ":2: expected shortest <= longest\n");
  EXPECT_EQ(objection("name,longest\na,3\n"),
            file + ":3: catalogue 1.file: " + csv + ": expected a column for each number of the item, say stiffness\n");
}

TEST(GoalsCommand, TheSameBytesOnAnyNumberOfThreads) {
  const TempFolder folder;
  const auto bytes = [&](const std::string& design, const std::string& jobs, const std::string& seed) {
    const std::string result = folder.path("o.json").string(), scene = folder.path("o.toml").string();
    run_poise({"design", design, "--json", result, "--scene", scene, "--jobs", jobs, "--seed", seed, "--starts", "20",
               "--quiet"});
    return contents(result) + contents(scene);
  };
  for (const char* name : {"wall_bed_robust_design", "tailgate_design"}) {
    const std::string one = bytes(dataset(name), "1", "7");
    EXPECT_GT(one.size(), 1000u);
    EXPECT_EQ(one, bytes(dataset(name), "16", "7")) << name;
  }
  // What is not met searches all starts, of which the seed tells.
  fs::copy_file(dataset("wall_bed"), folder.path("wall_bed.toml"));
  const std::string hopeless = folder.write("hopeless.toml", std::string(head) + chosen + force + "most = -100\n");
  const std::string one = bytes(hopeless, "1", "3");
  EXPECT_EQ(one, bytes(hopeless, "2", "3"));
  EXPECT_EQ(one, bytes(hopeless, "16", "3"));
  EXPECT_NE(one.find("\"met\": false"), std::string::npos);
}

TEST(GoalsCommand, AnInterruptKeepsTheBestSoFar) {
  const TempFolder folder;
  fs::copy_file(dataset("torque_profile"), folder.path("torque_profile.toml"));
  std::string text = contents(dataset("torque_profile_design"));
  fs::copy_file(fs::path(dataset("torque_profile")).replace_extension(".csv"), folder.path("torque_profile.csv"));
  const std::string within = "within = 300";
  // So many positions that no search ends in the time.
  text.replace(text.find(within), within.size(), "positions = 1000\nwithin = 0.001");
  const std::string file = folder.write("design.toml", text), out = folder.path("out.txt").string(),
                    json_file = folder.path("o.json").string(), scene = folder.path("o.toml").string();
  const int code =
      interrupt_poise({"design", file, "--starts", "1000000", "--jobs", "2", "--json", json_file, "--scene", scene},
                      out, std::chrono::milliseconds(1500));
  EXPECT_EQ(code, 1);
  EXPECT_NE(contents(out).find("Interrupted; the best numbers so far."), std::string::npos) << contents(out);
  const json found = json::parse(contents(json_file));
  EXPECT_EQ(found["met"], false);
  const double stiffness = found["numbers"]["spring.spring.stiffness"]["value"].get<double>();
  EXPECT_GE(stiffness, 2.0);
  EXPECT_LE(stiffness, 30.0);
  EXPECT_EQ(get_value(read_scene(scene), "spring.spring.stiffness"), stiffness);
}

}  // namespace
}  // namespace poise::app_tests::goals_command_test
