#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>

#include "tests/app/run_poise.hpp"
#include "tests/app/scenes.hpp"
#include "tests/support/known_answers.hpp"

namespace poise::app_tests::cli_test {
namespace {

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// Exit code 2, one line that says `part`, and not a word elsewhere.
void expect_bad_input(const ProgramRun& run, const std::string& part) {
  EXPECT_EQ(run.exit_code, 2) << run.out << run.err;
  EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  EXPECT_TRUE(run.err.ends_with('\n'));
  EXPECT_TRUE(contains(run.err, part)) << run.err;
  EXPECT_EQ(run.out, "");
}

TEST(CommandLine, ConfirmedEquilibriumExitsZero) {
  const TempFolder folder;
  const std::string scene = folder.write("pendulum.toml", pendulum);
  for (const char* method : {"virtual-work", "energy"}) {
    for (const char* seek : {"settle", "any", "stable"}) {
      const ProgramRun run = run_poise({"solve", scene, "--method", method, "--seek", seek});
      EXPECT_EQ(run.exit_code, 0) << run.out;
      EXPECT_EQ(run.err, "");
      EXPECT_TRUE(contains(run.out, "In equilibrium, proved: stable.")) << run.out;
      EXPECT_TRUE(contains(run.out, "-1.570796327")) << run.out;
      EXPECT_TRUE(contains(run.out, "6.00000")) << "weight and load in the pin\n" << run.out;
      EXPECT_FALSE(contains(run.out, "wrote"));
    }
  }
}

TEST(CommandLine, AnAnswerWithoutTimeForItsProofIsCheckedOnly) {
  const std::string scene = dataset("thesis_four_bar");
  for (const char* command : {"solve", "compare"}) {
    const ProgramRun run = run_poise({command, scene, "--proof-seconds", "0"});
    EXPECT_EQ(run.exit_code, 0) << run.out;
    EXPECT_TRUE(contains(run.out, "checked, not proved")) << run.out;
    EXPECT_FALSE(contains(run.out, "stable")) << run.out;
  }
}

TEST(CommandLine, UnstableEquilibriumIsFoundAndReportedAsUnstable) {
  const TempFolder folder;
  const ProgramRun run =
      run_poise({"solve", folder.write("up.toml", pendulum), "--set", "start.rod=1.5", "--seek", "any"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_TRUE(contains(run.out, "In equilibrium, proved: unstable.")) << run.out;
  EXPECT_TRUE(contains(run.out, "direction    unstable: rod +1.00")) << run.out;
}

TEST(CommandLine, NothingFoundExitsOneAndReportsWhatWasReached) {
  const TempFolder folder;
  const std::string scene = folder.write("runaway.toml", runaway);
  for (const char* method : {"virtual-work", "energy"}) {
    const ProgramRun run = run_poise({"solve", scene, "--method", method});
    EXPECT_EQ(run.exit_code, 1) << run.out;
    EXPECT_EQ(run.err, "");
    EXPECT_FALSE(contains(run.out, "In equilibrium")) << run.out;
    EXPECT_TRUE(contains(run.out, "\"block\" is out of balance")) << run.out;
    EXPECT_TRUE(contains(run.out, "reached, no equilibrium")) << run.out;
  }
  EXPECT_EQ(run_poise({"compare", scene}).exit_code, 1);
}

TEST(CommandLine, MethodThatDoesNotApplyNamesTheLoadAndFailsSolveButNotCompare) {
  const TempFolder folder;
  const std::string scene = folder.write("follower.toml", follower);
  const ProgramRun energy = run_poise({"solve", scene, "--method", "energy"});
  EXPECT_EQ(energy.exit_code, 1);
  EXPECT_TRUE(contains(energy.out, "Not applicable: this method cannot solve this scene.")) << energy.out;
  EXPECT_TRUE(contains(energy.out, "force \"jet\" follows a body")) << energy.out;
  EXPECT_FALSE(contains(energy.out, "Angles")) << "a method that does not apply has reached no position\n"
                                               << energy.out;

  EXPECT_EQ(run_poise({"solve", scene}).exit_code, 0);

  const ProgramRun both = run_poise({"compare", scene});
  EXPECT_EQ(both.exit_code, 0) << both.out;
  EXPECT_TRUE(contains(both.out, "energy        not applicable")) << both.out;
  EXPECT_TRUE(contains(both.out, "force \"jet\"")) << both.out;
  EXPECT_TRUE(contains(both.out, "Only virtual-work found an equilibrium.")) << both.out;
}

// A knee of two links l, the workpiece a spring k that is met 13.5 um before the dead centre: at the angle a from it
//   P = 2 k (2 l cos a - l0) tan a,  and each link carries  P / (2 sin a), 111 P at a = 0.0045 rad.
constexpr const char* knee = R"(
[ground]
points = { A = [0, 0], W = [0.8, 0] }
[body.left]
points = { A = [0, 0], K = [0.3, 0] }
[body.right]
points = { K = [0, 0], B = [0.3, 0] }
[body.ram]
points = { B = [0, 0] }
[[pin]]
name = "A"
points = ["ground.A", "left.A"]
[[pin]]
name = "K"
points = ["left.K", "right.K"]
[[pin]]
name = "B"
points = ["right.B", "ram.B"]
[[slide]]
name = "guide"
points = ["ground.A", "ram.B"]
axis = [1, 0]
[[spring]]
name = "workpiece"
points = ["ram.B", "ground.W"]
stiffness = 4e9
free_length = 0.2000135
[[force]]
name = "P"
at = "left.K"
vector = [0, -267.3]
[start]
left = 0.0067082
right = -0.0067082
guide = 0.5999865
)";

TEST(CommandLine, WeightsAreOfTheAugmentedLagrangianAlone) {
  const std::string scene = dataset("toggle_clamp");
  const ProgramRun none = run_poise({"solve", scene, "--penalty", "3"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_NE(none.err.find("--penalty: is of the augmented Lagrangian alone; expected"), std::string::npos) << none.err;
  const ProgramRun zero = run_poise({"solve", scene, "--method", "augmented-lagrangian", "--scaling", "0"});
  EXPECT_EQ(zero.exit_code, 2);
  EXPECT_NE(zero.err.find("--scaling"), std::string::npos) << zero.err;
  EXPECT_EQ(
      run_poise({"solve", scene, "--method", "augmented-lagrangian", "--scaling", "2", "--penalty", "0"}).exit_code, 0);
  EXPECT_EQ(run_poise({"compare", scene, "--methods", "virtual-work,augmented-lagrangian-modified", "--penalty", "100"})
                .exit_code,
            0);
}

TEST(CommandLine, HeavyJointForcesWarnOfADeadCentre) {
  const TempFolder folder;
  const std::string scene = folder.write("knee.toml", knee);
  const ProgramRun near = run_poise({"solve", scene});
  EXPECT_EQ(near.exit_code, 0) << near.out << near.err;
  EXPECT_TRUE(contains(near.out, "Near a dead centre: ")) << near.out;
  EXPECT_TRUE(contains(near.out, "for loads of 267.")) << near.out;
  const ProgramRun far =
      run_poise({"solve", scene, "--set", "spring.workpiece.stiffness=1e5", "--set", "spring.workpiece.free_length=0.3",
                 "--set", "start.left=0.3", "--set", "start.right=-0.3", "--set", "start.guide=0.57"});
  EXPECT_EQ(far.exit_code, 0) << far.out << far.err;
  EXPECT_FALSE(contains(far.out, "dead centre")) << far.out;
  // Quiet: the verdict and the warning alone.
  const ProgramRun quiet = run_poise({"solve", scene, "--quiet"});
  EXPECT_EQ(std::count(quiet.out.begin(), quiet.out.end(), '\n'), 2) << quiet.out;
  EXPECT_TRUE(contains(quiet.out, "Near a dead centre")) << quiet.out;
  EXPECT_TRUE(contains(run_poise({"solve", scene, "--verbose"}).out, "  ended        ")) << "details";
}

// What an engineer asks first fits a screen; how exact it is stands in the details and, always, in JSON.
TEST(CommandLine, NumericsAreDetails) {
  const TempFolder folder;
  const std::string json = folder.path("o.json");
  const std::string plain = run_poise({"solve", dataset("toggle_clamp"), "--json", json}).out;
  EXPECT_FALSE(contains(plain, "Numerics")) << plain;
  EXPECT_FALSE(contains(plain, "exactly one equilibrium within")) << plain;
  EXPECT_TRUE(contains(run_poise({"solve", dataset("toggle_clamp"), "--verbose"}).out, "\nNumerics\n"));
  EXPECT_TRUE(contains(contents(json), "exactly one equilibrium within"));
}

TEST(CommandLine, ChecksAStructure) {
  const ProgramRun run = run_poise({"check", dataset("structures/three_hinged_portal")});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.err, "");
  EXPECT_TRUE(contains(run.out, "All loops close; a structure: ")) << run.out;
  const ProgramRun solve = run_poise({"solve", dataset("structures/three_hinged_portal")});
  EXPECT_EQ(solve.exit_code, 2);
  EXPECT_FALSE(contains(solve.err, "remove a joint")) << solve.err;
  EXPECT_TRUE(contains(solve.err, "poise forces")) << solve.err;
}

// A strut of 0.3 m that may be 0.2 m long, and a four-bar whose loop is open as it is drawn.
TEST(CommandLine, CheckSaysHowFarTheStartIsFromThePoseInWhichItIsAssembled) {
  const TempFolder folder;
  const std::string strut = folder.write("strut.toml", R"(
[ground]
points = { O = [0, 0] }
[body.arm]
points = { O = [0, 0], P = [0.3, 0] }
mass = 1
[[pin]]
points = ["ground.O", "arm.O"]
[[stop]]
name = "reach"
bodies = ["ground", "arm"]
max = 0.2
[start]
arm = 0.5
)");
  const ProgramRun beyond = run_poise({"check", strut});
  EXPECT_TRUE(contains(beyond.out, "The start is beyond stop \"reach\": 0.5 rad, 0.3 rad above its max of 0.2 rad."))
      << beyond.out << beyond.err;
  const ProgramRun closed = run_poise({"check", dataset("toggle_clamp"), "--set", "start.handle=80"});
  EXPECT_TRUE(contains(closed.out, "  start        closing the loops moves ")) << closed.out << closed.err;
}

TEST(CommandLine, NeutralEquilibriumNamesWhatIsArbitraryAndWhatIsProvedAcrossIt) {
  const ProgramRun run = run_poise({"solve", dataset("hard/balanced_lamp"), "--verbose"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(contains(run.out, "In equilibrium, proved: neutral.")) << run.out;
  EXPECT_TRUE(contains(run.out, "direction    neutral: ")) << run.out;
  EXPECT_TRUE(contains(run.out, "proof        equilibrium at any value of upper, ")) << run.out;
  EXPECT_TRUE(contains(run.out, "; across these exactly one within ")) << run.out;
}

// 12 N m of friction hold a lever of 9.81 N m anywhere; the equilibrium at -90 degrees is one of many, which the output
// states.
TEST(CommandLine, SolveAndCompareNameWhatStaticsLeavesOut) {
  const TempFolder folder;
  const std::string lever = folder.write("lever.toml", rusty_lever);
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"solve", lever}, {"compare", lever}, {"compare", lever, "--tolerances", "1e-6", "--repeat", "1"}}) {
    SCOPED_TRACE(words.front());
    const ProgramRun run = run_poise(words);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_PRED2(contains, run.out, "Dry friction is left out: \"rust\" may hold the mechanism elsewhere too.");
    EXPECT_PRED2(contains, run.out, "friction \"rust\": nothing moves in statics");
    EXPECT_PRED2(contains, run.out, "torsion damper \"grease\": nothing moves in statics");
    EXPECT_PRED2(contains, run.out, "moment of inertia of 1 body: nothing moves in statics");
    EXPECT_PRED2(contains, run.out, "force \"nothing\": it is zero");
  }
}

TEST(CommandLine, EnergySeeksAMinimumAndReportsWhatItCounts) {
  const TempFolder folder;
  const std::string scene = folder.write("pendulum.toml", pendulum);
  const ProgramRun run = run_poise({"solve", scene, "--method", "energy", "--seek", "any", "--verbose"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_PRED2(contains, run.out, "energy, seeking a minimum of the energy");
  EXPECT_PRED2(contains, run.out, "(springs in full, loads without the part that no motion changes)");
  EXPECT_PRED2(contains, run_poise({"solve", scene, "--verbose"}).out,
               "virtual-work, seeking the equilibrium in which it settles");
  EXPECT_PRED2(contains, run_poise({"solve", scene, "--seek", "any", "--verbose"}).out,
               "virtual-work, seeking the nearest equilibrium");
  EXPECT_PRED2(contains,
               run_poise({"solve", scene, "--method", "dynamic-relaxation", "--seek", "any", "--verbose"}).out,
               "seeking a stable equilibrium");
}

TEST(CommandLine, FreeBodiesHaveAHeadingOfTheirOwn) {
  const TempFolder folder;
  const ProgramRun run = run_poise({"solve", folder.write("tray.toml", hung_tray)});
  EXPECT_EQ(run.exit_code, 0) << run.out;
  EXPECT_PRED2(contains, run.out, "Positions of free bodies (mm)");
  EXPECT_PRED2(contains, run.out, "tray.x");
  EXPECT_FALSE(contains(run.out, "Slides")) << run.out;
  const ProgramRun moved = run_poise({"solve", folder.write("tray.toml", hung_tray), "--set", "start.tray.x=510"});
  EXPECT_EQ(moved.exit_code, 0) << moved.err;
}

TEST(CommandLine, CompareShowsTheMethodsSideBySideAndThatTheyAgree) {
  const ProgramRun run = run_poise({"compare", dataset("heaton_timme")});
  EXPECT_EQ(run.exit_code, 0) << run.out;
  for (const char* title :
       {"method", "status", "iterations", "evaluations", "time", "error", "stability", "energy (J)"}) {
    EXPECT_TRUE(contains(run.out, title)) << title;
  }
  EXPECT_TRUE(contains(run.out, "virtual-work and energy agree")) << run.out;
  EXPECT_TRUE(contains(run.out, "2.353554680  2.353554680")) << run.out;
}

TEST(CommandLine, CompareDistinguishesEquilibria) {
  const TempFolder folder;
  const ProgramRun run =
      run_poise({"compare", folder.write("up.toml", pendulum), "--set", "start.rod=1.5", "--seek", "any"});
  EXPECT_EQ(run.exit_code, 0) << run.out;
  EXPECT_TRUE(contains(
      run.out, "different equilibria: virtual-work: unstable; energy: stable. Largest difference: 3.142 rad in rod."))
      << run.out;
}

TEST(CommandLine, CheckReportsMobilityRedundancyAndWhatTheModelDrops) {
  const ProgramRun run = run_poise({"check", dataset("redundant_parallelogram")});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(contains(run.out, "4 moving bodies, 6 joints")) << run.out;
  EXPECT_TRUE(contains(run.out, "1 degree of freedom; counting bodies and joints (Gruebler) gives 0")) << run.out;
  EXPECT_TRUE(contains(run.out, "Redundant joints")) << run.out;
  EXPECT_TRUE(contains(run.out, "  gravity      none")) << run.out;
  EXPECT_TRUE(contains(run.out, "torsion spring  crank1 against ground  stiffness 120 N m/rad, free_angle 1 rad"))
      << run.out;
  EXPECT_TRUE(contains(run.out, "  W     coupler.B2  [0, -100] N")) << run.out;
  EXPECT_TRUE(contains(run.out, "Coordinates of the static model, and why")) << run.out;

  const ProgramRun clamp = run_poise({"check", dataset("toggle_clamp")});
  EXPECT_TRUE(contains(clamp.out, "moment of inertia of 3 bodies: nothing moves in statics")) << clamp.out;
}

TEST(CommandLine, FunctionsOfTimeAreShownAndNotVariedInStatics) {
  const TempFolder folder;
  const std::string scene = folder.write("rotor.toml", R"(
units = { length = "mm", angle = "deg" }
ground.points = { O = [0, 0] }
body.arm.points = { O = [0, 0], T = [100, 0] }
pin = [{ points = ["ground.O", "arm.O"] }]
torsion_spring = [{ bodies = ["ground", "arm"], stiffness = 10 }]
force = [{ name = "F", at = "arm.T", vector = [0, 10], time = { ramp = { from = 0.5, to = 1, end = 2 } } }]
drive = [{ name = "motor", bodies = ["ground", "arm"], time = { ramp = { from = 0, to = 90, end = 2 } } }]
)");
  const ProgramRun check = run_poise({"check", scene});
  EXPECT_TRUE(contains(check.out, "ramp: from 0 deg, to 90 deg, start 0 s, end 2 s")) << check.out << check.err;
  EXPECT_TRUE(contains(check.out, "F: a ramp, at t = 0 s 0.5 times what the scene gives")) << check.out;
  expect_bad_input(run_poise({"path", scene, "--vary", "load.F.time.from=0..1"}), "loads are those of one time here");
}

TEST(CommandLine, SceneThatCannotBeAssembledNamesTheLoopAndItsGap) {
  const TempFolder folder;
  const std::string scene = folder.write("open.toml", open_loop);
  const ProgramRun check =
      run_poise({"check", scene, "--json", folder.path("a.json").string(), "--svg", folder.path("a.svg").string()});
  EXPECT_EQ(check.exit_code, 2);
  EXPECT_EQ(folder.names(), std::vector<std::string>{"open.toml"});
  EXPECT_TRUE(contains(check.out, "remains open by 3 m")) << check.out;
  EXPECT_TRUE(contains(check.err, "remains open by 3 m")) << check.err;
  EXPECT_EQ(std::count(check.err.begin(), check.err.end(), '\n'), 1);
  expect_bad_input(run_poise({"solve", scene}), "the loop closed by joint");
  expect_bad_input(run_poise({"compare", scene}), "the loop closed by joint");
}

TEST(CommandLine, SetChangesTheSceneInItsOwnUnits) {
  // Below 42.9 N the von Mises toggle stays up, above it snaps through.
  const ProgramRun up = run_poise({"solve", dataset("von_mises_toggle"), "--set", "load.P=42"});
  const ProgramRun down = run_poise({"solve", dataset("von_mises_toggle"), "--set", "load.P=43"});
  EXPECT_EQ(up.exit_code, 0);
  EXPECT_EQ(down.exit_code, 0);
  EXPECT_TRUE(contains(up.out, "guide  0.3")) << up.out;
  EXPECT_TRUE(contains(down.out, "guide  -0.5")) << down.out;

  // kN, and several settings at once.
  const TempFolder folder;
  const std::string scene = folder.write("workshop.toml", workshop_pendulum);
  const ProgramRun both = run_poise({"solve", scene, "--set", "load.<P>=4", "--set", "start.a<b=-10"});
  EXPECT_EQ(both.exit_code, 0) << both.err;
  EXPECT_TRUE(contains(both.out, "Fx (kN)")) << both.out;
  EXPECT_TRUE(contains(both.out, "-4.00000")) << both.out;
}

TEST(CommandLine, ActiveStopIsNamedWithItsLimit) {
  const TempFolder folder;
  const ProgramRun run = run_poise({"solve", folder.write("stop.toml", against_the_stop)});
  EXPECT_EQ(run.exit_code, 0) << run.out;
  EXPECT_TRUE(contains(run.out, "end   0.25 m    -  0.25 m  active at its max")) << run.out;
}

TEST(CommandLine, UndeterminedReactionsAreMarked) {
  const ProgramRun run = run_poise({"solve", dataset("redundant_parallelogram")});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_TRUE(contains(run.out, "undetermined")) << run.out;
  EXPECT_TRUE(contains(run.out, "1 state of self-stress")) << run.out;
}

TEST(CommandLine, LongTablesAreCut) {
  const TempFolder folder;
  const ProgramRun run = run_poise({"solve", folder.write("links.toml", hanging_links(200))});
  EXPECT_EQ(run.exit_code, 0) << run.out;
  EXPECT_TRUE(contains(run.out, "... and 176 more")) << run.out;
  EXPECT_LT(std::count(run.out.begin(), run.out.end(), '\n'), 80);
}

struct BadWords {
  const char* name;
  std::vector<std::string> arguments;
  const char* says;
};

// A name rather than the bytes of the structure in the output of a failed test.
void PrintTo(const BadWords& words, std::ostream* out) { *out << words.name; }

class BadInput : public ::testing::TestWithParam<BadWords> {};

TEST_P(BadInput, IsOneLineExitTwoAndWritesNothing) {
  const TempFolder folder;
  std::vector<std::string> arguments = GetParam().arguments;
  for (std::string& word : arguments) {
    if (word == "SCENE") word = folder.write("scene.toml", pendulum);
    if (word == "BROKEN") word = folder.write("broken.toml", "title = \"x\"\n[body.a]\npoints = { O = [0, 0 }\n");
    if (word == "MISSPELT") word = folder.write("misspelt.toml", std::string(pendulum) + "arm = 1\n");
    if (word == "RIGID") {
      word = folder.write("rigid.toml",
                          "gravity = [0, -10]\n[ground]\npoints = { O = [0, 0] }\n[body.a]\n"
                          "points = { O = [0, 0] }\nmass = 1\n[[weld]]\npoints = [\"ground.O\", \"a.O\"]\n");
    }
  }
  const std::vector<std::string> before = folder.names();
  const std::string json = folder.path("result.json").string();
  const std::string svg = folder.path("figure.svg").string();
  if (arguments.size() > 1 && arguments.front() != "check") {
    arguments.insert(arguments.end(), {"--json", json, "--svg", svg});
  }
  expect_bad_input(run_poise(arguments), GetParam().says);
  EXPECT_EQ(folder.names(), before);
}

INSTANTIATE_TEST_SUITE_P(
    CommandLine, BadInput,
    ::testing::Values(
        BadWords{"NoCommand", {}, "expected a command"},
        BadWords{"MisspeltCommand", {"slove", "SCENE"}, "did you mean \"solve\"?"},
        BadWords{"NoScene", {"solve"}, "SCENE is required"},
        BadWords{"TwoScenes", {"solve", "SCENE", "SCENE.2"}, "expected one scene, found \"SCENE.2\" too"},
        BadWords{"MisspeltOption", {"solve", "SCENE", "--metod", "energy"}, "did you mean \"--method\"?"},
        BadWords{"UnknownMethod", {"solve", "SCENE", "--method", "enegry"}, "did you mean \"energy\"?"},
        BadWords{"SettleWithTolerances",
                 {"compare", "SCENE", "--tolerances", "1e-2", "--seek", "settle"},
                 "--seek settle: does not go with --tolerances"},
        BadWords{"UnknownSeek", {"compare", "SCENE", "--seek", "stabel"}, "did you mean \"stable\"?"},
        BadWords{"ProofInNegativeTime", {"solve", "SCENE", "--proof-seconds=-1"}, "expected a number >= 0, found -1"},
        BadWords{"ProofInNoTime", {"compare", "SCENE", "--proof-seconds", "nan"}, "--proof-seconds: expected a number"},
        BadWords{"ProofOfRuns",
                 {"compare", "SCENE", "--tolerances", "1e-3", "--proof-seconds", "1"},
                 "does not count with --tolerances"},
        BadWords{"MethodOfCompare", {"compare", "SCENE", "--method", "energy"}, "compare has no option \"--method\""},
        BadWords{"UnknownMethods", {"compare", "SCENE", "--methods", "energy,cobila"}, "did you mean \"cobyla\"?"},
        BadWords{"NoMethods", {"compare", "SCENE", "--methods", "energy,"}, "--methods: expected virtual-work"},
        BadWords{"RangeToNowhere", {"compare", "SCENE", "--tolerances", "1e-2..x"}, "\"x\" is not a number"},
        BadWords{"RangeThatRises", {"compare", "SCENE", "--tolerances", "1e-9..1e-2"}, "say 1e-2..1e-9"},
        BadWords{
            "ToleranceZero", {"compare", "SCENE", "--tolerances", "1e-2..0"}, "from 1e-20 to less than 1, found 0"},
        BadWords{"ToleranceNegative", {"compare", "SCENE", "--tolerances=-1e-3"}, "found -1e-3"},
        BadWords{
            "NoRepeats", {"compare", "SCENE", "--tolerances", "1e-3", "--repeat", "0"}, "from 1 to 10000, found 0"},
        BadWords{"RepeatsOfWords", {"compare", "SCENE", "--tolerances", "1e-3", "--repeat", "x"}, "--repeat"},
        BadWords{"RepeatAlone", {"compare", "SCENE", "--repeat", "3"}, "--repeat: counts only with --tolerances"},
        BadWords{"CsvAlone", {"compare", "SCENE", "--csv", "a.csv"}, "--csv: is written only with --tolerances"},
        BadWords{"QuietAndVerbose", {"solve", "SCENE", "--quiet", "--verbose"}, "--quiet: expected no --verbose"},
        BadWords{"SetWithoutEquals", {"solve", "SCENE", "--set", "load.P"}, "there is no \"=\""},
        BadWords{"SetWithoutNumber", {"solve", "SCENE", "--set", "load.P="}, "\"\" is not a number"},
        BadWords{"SetToText", {"solve", "SCENE", "--set", "load.P=4k"}, "\"4k\" is not a number"},
        BadWords{"SetToNan", {"solve", "SCENE", "--set", "load.P=nan"}, "load.P"},
        BadWords{"SetUnknownPath", {"solve", "SCENE", "--set", "load.Q=4"}, "did you mean \"load.P\"?"},
        BadWords{"SetNegativeMass", {"solve", "SCENE", "--set", "body.rod.mass=-1"}, "body.rod.mass"},
        BadWords{"NoSuchFile", {"solve", "no/such/scene.toml"}, "no/such/scene.toml"},
        BadWords{"NotToml", {"compare", "BROKEN"}, "broken.toml:3"},
        BadWords{"UnknownName", {"solve", "MISSPELT"}, "misspelt.toml:18"},
        BadWords{"NothingMoves", {"solve", "RIGID"}, "rigid.toml:4: mechanism: nothing can move under load"},
        BadWords{
            "EmptyFile", {"solve", "SCENE", "--markdown", ""}, "--markdown: expected a word that is not empty; leave"},
        BadWords{"EmptyFileBehindEquals", {"motion", "SCENE", "--duration", "1", "--csv="}, "--csv"},
        BadWords{"OptionTwice",
                 {"solve", "SCENE", "--seek", "stable", "--seek", "any"},
                 "poise: --seek: expected once, found several times; see poise solve --help"},
        BadWords{"NothingBehindAnOption",
                 {"check", "SCENE", "--svg"},
                 "poise: --svg: expected a word behind it, found none; see poise check --help"},
        BadWords{"EmptyScene", {"check", ""}, "SCENE: expected a word that is not empty"},
        BadWords{"EmptySetting", {"solve", "SCENE", "--set", ""}, "--set: expected a word that is not empty"},
        BadWords{"NegativeSeed",
                 {"motion", "SCENE", "--duration", "1", "--seed", "-1"},
                 "--seed: expected a whole number from 0 to 18446744073709551615, found \"-1\""},
        BadWords{"LargeSeed",
                 {"motion", "SCENE", "--duration", "1", "--seed", "99999999999999999999"},
                 "--seed: expected a whole number from 0 to 18446744073709551615, found \"99999999999999999999\""},
        BadWords{"ManySteps",
                 {"kinematics", "SCENE", "--drive", "rod=0..1", "--steps", "1e9"},
                 "--steps: expected a number from 1 to 1000000, found 1000000000"},
        BadWords{"HalfAStep",
                 {"kinematics", "SCENE", "--drive", "rod=0..1", "--steps", "2.5"},
                 "--steps: expected a whole number from 0 to 2147483647, found \"2.5\""},
        BadWords{"RateOfWords",
                 {"motion", "SCENE", "--duration", "1", "--rate", "fast"},
                 "--rate: expected a number, found \"fast\""},
        BadWords{"LongRate",
                 {"motion", "SCENE", "--duration", "1", "--release", "rod=1e200"},
                 "--release rod=1e200: expected a finite number, within 1e50, found 1e+200"},
        BadWords{"SetTooLarge",
                 {"solve", "SCENE", "--set", "load.P=1e200"},
                 "--set load.P: expected a finite number >= 0 of at most 1e50 in SI units, found 1e+200"},
        BadWords{"SceneAsExperiment",
                 {"identify", "SCENE"},
                 "scene.toml:5: body: expected an experiment, found a scene; give a file that names it"},
        BadWords{"DesignMethod",
                 {"design", dataset("wall_bed_design"), "--method", "newton"},
                 "--method: expected slsqp, mma or auglag, found \"newton\""},
        BadWords{"DesignOfAScene", {"design", dataset("wall_bed")}, "expected a design, found a scene"},
        BadWords{"CheckOfNothing", {"check"}, "SCENE is required"}),
    [](const auto& one) { return std::string(one.param.name); });

TEST(CommandLine, VersionAndHelpExitZero) {
  const ProgramRun version = run_poise({"--version"});
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_TRUE(version.out.starts_with("poise ")) << version.out;
  const ProgramRun all = run_poise({"--help"});
  EXPECT_EQ(all.exit_code, 0);
  EXPECT_EQ(all.err, "");
  for (const char* name :
       {"check",    "solve",           "find",     "sensitivity", "tolerance", "compare", "kinematics",
        "motion",   "modes",           "response", "forces",      "equations", "design",  "identify",
        "validate", "identifiability", "plan",     "montecarlo",  "import",    "export"}) {
    const std::string example = std::string("poise ") + name + " datasets/";
    EXPECT_TRUE(contains(all.out, example)) << all.out;
    const ProgramRun help = run_poise({name, "--help"});
    EXPECT_EQ(help.exit_code, 0);
    EXPECT_EQ(help.err, "");
    EXPECT_TRUE(contains(help.out, "Example:\n  " + example)) << help.out;
    const std::size_t begin = help.out.find(example) + example.size();
    const std::string file = help.out.substr(begin, help.out.find_first_of(" \n", begin) - begin);
    EXPECT_TRUE(std::filesystem::exists(test::dataset(file))) << file;
  }
}

// Nobody reads what is said, and no file may take the number of a stream that is closed.
TEST(CommandLine, StreamsThatAreClosedOrFullChangeNoExitCode) {
  const TempFolder folder;
  const std::string scene = folder.write("scene.toml", pendulum), file = folder.path("result.json").string();
  const auto run = [&](const std::string& words) {
    const int status = std::system((std::string("\"") + POISE_EXECUTABLE + "\" " + words).c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  };
  for (const char* err : {"2>&-", "2>/dev/full"}) {
    SCOPED_TRACE(err);
    EXPECT_EQ(run(fmt::format("solve nothing >/dev/null {}", err)), 2);
    EXPECT_EQ(run(fmt::format("nothing >/dev/null {}", err)), 2);
    EXPECT_EQ(run(fmt::format("solve {} >/dev/null {}", scene, err)), 0);
    for (const char* out : {">&-", ">/dev/full"}) {
      EXPECT_EQ(run(fmt::format("solve {} --json {} {} {}", scene, file, out, err)), 2);
      EXPECT_TRUE(nlohmann::json::accept(contents(file)));
      EXPECT_EQ(run(fmt::format("--help {} {}", out, err)), 2);
      EXPECT_EQ(run(fmt::format("check {} <&- {} {}", scene, out, err)), 2);
    }
  }
  EXPECT_EQ(run("solve " + scene + " <&- >/dev/null"), 0);
}

TEST(CommandLine, ColoursOnlyOnATerminalWithoutNoColor) {
  const std::vector<std::string> words = {"compare", dataset("zeeman")};
  EXPECT_FALSE(contains(run_poise(words).out, "\x1b"));
  EXPECT_TRUE(contains(run_poise_in_terminal(words).out, "\x1b["));
  EXPECT_FALSE(contains(run_poise_in_terminal(words, {"NO_COLOR=1"}).out, "\x1b"));
  EXPECT_FALSE(contains(run_poise_in_terminal(words, {"TERM=dumb"}).out, "\x1b"));
  EXPECT_TRUE(contains(run_poise_in_terminal(words, {"NO_COLOR="}).out, "\x1b[")) << "an empty NO_COLOR means nothing";
}

TEST(CommandLine, EveryDatasetIsComparedAndDrawn) {
  int scenes = 0;
  for (const std::string& name : test::scene_names()) {
    SCOPED_TRACE(name);
    const TempFolder folder;
    const ProgramRun run = run_poise({"compare", test::dataset(name).string(), "--svg", folder.path("a.svg").string()});
    EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
    EXPECT_EQ(objection_to_xml(contents(folder.path("a.svg"))), "");
    ++scenes;
  }
  EXPECT_GE(scenes, 14);
}

TEST(CommandLine, AStartThatCannotBeClosedIsAFailureOfTheSearchAndNoBadInput) {
  const std::vector<std::string> start = {"--set", "start.rear=132", "--set", "start.front=-143",
                                          "--set", "start.hood=-52"};
  for (const char* const command : {"solve", "compare", "check", "modes"}) {
    std::vector<std::string> words = {command, dataset("car_hood")};
    words.insert(words.end(), start.begin(), start.end());
    const ProgramRun run = run_poise(words);
    EXPECT_EQ(run.exit_code, 1) << command << ": " << run.err;
    EXPECT_NE(run.err.find("car_hood.toml:61: mechanism: cannot be assembled from its start: stop \"reach\""),
              std::string::npos)
        << run.err;
  }
}

}  // namespace
}  // namespace poise::app_tests::cli_test
