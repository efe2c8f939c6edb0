// `poise plan` through the command line: which runs it chooses, and that what it predicts is what they determine.

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/wheel_experiment.hpp"

namespace poise::app_tests::plan_command_test {
namespace {

using nlohmann::json;

/// The least standard errors that `poise identifiability` finds, by name.
json predicted(const TempFolder& folder, const std::string& file) {
  json out = json::object();
  const json result = run_json(folder, {"identifiability", file}, 0);
  for (const json& row : result["predicted"]) out[row["name"]] = row["standard_error"];
  return out;
}

void expect_monotone(const json& plan) {
  for (std::size_t k = 1; k < plan["steps"].size(); ++k) {
    for (const auto& [name, error] : plan["steps"][k - 1]["standard_error"].items()) {
      const json& next = plan["steps"][k]["standard_error"][name];
      if (error.is_null()) continue;
      ASSERT_FALSE(next.is_null()) << name;
      EXPECT_LE(next.get<double>(), error.get<double>() * (1 + 1e-9)) << name << " after run " << k + 1;
    }
  }
}

/// The wheel, one run of 10 degrees and 6 s, and [plan] with these lines.
std::string wheel_plan(const std::string& lines) {
  std::string run = one_run;
  run.replace(run.find("wheel = 20"), 10, "wheel = 10");
  return std::string(wheel_unknowns) + "[plan]\n" + lines + run;
}

const char* const release_and_duration =
    "[[plan.vary]]\nwhat = \"release.wheel\"\nmin = 1\nmax = 20\n"
    "[[plan.vary]]\nwhat = \"duration\"\nmin = 1\nmax = 6\n";

TEST(PlanCommand, ALinearWheelWantsTheLargestReleaseAndTheLongestRun) {
  const TempFolder folder;
  for (const std::string criterion : {"D", "A", "E"}) {
    const std::string file =
        experiment(folder, wheel_plan("runs = 4\ncriterion = \"" + criterion + "\"\n" + release_and_duration));
    const json plan = run_json(folder, {"plan", file}, 0);
    EXPECT_EQ(plan["criterion"], criterion);
    ASSERT_EQ(plan["planned"].size(), 4u);
    for (const json& run : plan["planned"]) {
      EXPECT_EQ(run["values"]["release.wheel"], 20);
      EXPECT_EQ(run["values"]["duration"], 6);
    }
    // Readings are proportional to the release, and the information of equal runs adds up.
    for (const char* name : {"k", "c"}) {
      const double own = plan["own"]["standard_error"][name];
      for (int n = 1; n <= 4; ++n) {
        EXPECT_NEAR(plan["steps"][n - 1]["standard_error"][name].get<double>(), own / 2 / std::sqrt(n), 1e-6 * own);
      }
    }
    expect_monotone(plan);
  }
}

TEST(PlanCommand, TimeIsAtMostTheLimit) {
  const TempFolder folder;
  const json plan = run_json(
      folder, {"plan", experiment(folder, wheel_plan(std::string("runs = 5\ntime = 8\n") + release_and_duration))}, 0);
  double time = 0.0;
  for (const json& run : plan["planned"]) {
    EXPECT_EQ(run["values"]["release.wheel"], 20);
    time += run["duration"].get<double>();
  }
  EXPECT_LE(time, 8 * (1 + 1e-12));
  EXPECT_GE(time, 7);
}

TEST(PlanCommand, DependsOnTheSeedNotOnThreads) {
  const TempFolder folder;
  const std::string file = experiment(folder, wheel_plan(std::string("runs = 2\n") + release_and_duration));
  const auto plan = [&](const std::string& jobs) {
    json out = run_json(folder, {"plan", file, "--seed", "5", "--jobs", jobs}, 0);
    out.erase("seconds");
    return out;
  };
  EXPECT_EQ(plan("1"), plan("3"));
}

// The mass and the inertia of a pendulum are known up to their scale, unless a known mass hangs on it.
const char* const pendulum = R"(gravity = [0, -9.81]
[ground]
points = { O = [0, 0] }
[body.rod]
points = { O = [0, 0], tip = [0.8, 0] }
mass = 2
center = [0.4, 0]
inertia = 0.2
[body.payload]
points = { Q = [0, 0] }
mass = 0
[[pin]]
points = ["ground.O", "rod.O"]
[[weld]]
points = ["rod.tip", "payload.Q"]
[start]
rod = -1.5707963267948966
)";

const char* const pendulum_experiment = R"(title = "Pendulum"
scene = "pendulum.toml"
[[sensor]]
name = "angle"
angle = "rod"
noise = 1e-4
[[unknown]]
path = "body.rod.mass"
name = "m"
[[unknown]]
path = "body.rod.inertia"
name = "J"
[[run]]
release = { rod = -1.3 }
duration = 3
rate = 100
[plan]
runs = 3
[[plan.vary]]
what = "set.body.payload.mass"
values = [0, LOADS]
)";

TEST(PlanCommand, AScaleNeedsAKnownPayload) {
  const TempFolder folder;
  folder.write("pendulum.toml", pendulum);
  std::string text = pendulum_experiment;
  const std::size_t loads = text.find("LOADS");
  const json plan =
      run_json(folder, {"plan", folder.write("loads.toml", std::string(text).replace(loads, 5, "1, 2"))}, 0);
  EXPECT_TRUE(plan["own"]["standard_error"]["m"].is_null()) << plan["own"];
  int loaded = 0;
  for (const json& run : plan["planned"]) loaded += run["values"]["set.body.payload.mass"] > 0;
  EXPECT_GE(loaded, 1);
  EXPECT_FALSE(plan["steps"].back()["standard_error"]["m"].is_null());
  expect_monotone(plan);
  // Without one no plan has it, and the plan says so in words.
  const std::string empty = folder.write("empty.toml", text.replace(loads, 5, "0"));
  const json none = run_json(folder, {"plan", empty}, 0);
  EXPECT_TRUE(none["steps"].back()["standard_error"]["m"].is_null());
  ASSERT_EQ(none["steps"].back()["not_identifiable"].size(), 1u);
  const ProgramRun run = run_poise({"plan", empty});
  EXPECT_TRUE(has(run.out, "not identifiable from them: m and J.")) << run.out;
  EXPECT_TRUE(has(run.out, "change no reading")) << run.out;
  EXPECT_TRUE(has(run.out, "remedy: ")) << run.out;
}

TEST(PlanCommand, MeasuredRunsCount) {
  const TempFolder folder;
  folder.write("wheel.toml", wheel);
  run_poise({"motion", folder.path("wheel.toml").string(), "--duration", "6", "--rate", "200", "--release", "wheel=20",
             "--noise", "0.02", "--csv", folder.path("turn.csv").string()});
  std::string text = wheel_plan(std::string("runs = 2\n") + release_and_duration);
  text.insert(text.find("noise"), "column = \"wheel\"\n");
  const std::string file = folder.write(
      "experiment.toml", text + "[[run]]\nname = \"made\"\ndata = \"turn.csv\"\nrelease = { wheel = 20 }\n");
  std::filesystem::create_directory(folder.path("elsewhere"));
  const std::string out = folder.path("elsewhere/planned.toml").string();
  const json plan = run_json(folder, {"plan", file, "--experiment", out}, 0);
  EXPECT_EQ(predicted(folder, out), plan["steps"].back()["standard_error"]);
  EXPECT_TRUE(has(contents(out), "turn.csv"));
  EXPECT_TRUE(has(contents(out), "../wheel.toml")) << contents(out);
}

TEST(PlanCommand, CommonChoicesAreSharedByAllRuns) {
  const TempFolder folder;
  std::string scene = wheel;
  scene.replace(scene.find("[body.wheel]\npoints = { O = [0, 0] }"), 36,
                "[body.wheel]\npoints = { O = [0, 0], mark = [1, 0] }");
  folder.write("wheel.toml", scene);
  std::string text = wheel_plan(
      "runs = 2\ncandidates = 20\n[[plan.vary]]\nwhat = \"set.point.wheel.mark.x\"\nmin = 0.5\nmax = 2\ncommon = "
      "true\n[[plan.vary]]\nwhat = \"release.wheel\"\nmin = 5\nmax = 20\n");
  // The height of the mark grows with its distance from the pin.
  text.replace(text.find("angle = \"wheel\""), 15, "y = \"wheel.mark\"");
  const std::string file = folder.write("experiment.toml", text), out = folder.path("planned.toml").string();
  const json plan = run_json(folder, {"plan", file, "--experiment", out}, 0);
  for (const json& run : plan["planned"]) {
    EXPECT_EQ(run["values"]["set.point.wheel.mark.x"], 2);
    EXPECT_EQ(run["values"]["release.wheel"], 20);
  }
  EXPECT_EQ(predicted(folder, out), plan["steps"].back()["standard_error"]);
}

TEST(PlanCommand, ALiftIsKnownThreeTimesBetterThanByEqualRuns) {
  const TempFolder folder;
  std::vector<json> plans;
  for (const std::string criterion : {"D", "A", "E"}) {
    std::string text = contents(dataset("lift_plan"));
    text.replace(text.find("criterion = \"E\""), 15, "criterion = \"" + criterion + "\"");
    folder.write("lift.toml", contents(dataset("lift")));
    const std::string file = folder.write("lift_plan.toml", text), out = folder.path("planned.toml").string();
    std::filesystem::remove(out);
    plans.push_back(run_json(folder, {"plan", file, "--experiment", out}, 0));
    const json& plan = plans.back();
    ASSERT_EQ(plan["planned"].size(), 6u);
    for (const json& run : plan["planned"]) {
      EXPECT_LE(run["values"]["release.obd"], 0.005);
      EXPECT_LE(run["values"]["duration"], 2);
      EXPECT_GE(run["values"]["rest.at"], -0.0704);
      EXPECT_LE(run["values"]["rest.at"], 0.8242);
    }
    // Three heights, each empty and with 200 kg, give 1.2 per cent.
    EXPECT_LE(plan["steps"].back()["worst"].get<double>(), 0.0095);
    EXPECT_EQ(predicted(folder, out), plan["steps"].back()["standard_error"]);
    expect_monotone(plan);
  }
  EXPECT_TRUE(plans[2]["own"]["standard_error"]["mP"].is_null()) << "equal runs do not separate it from the stiffness";
  // Each is the best by its own criterion, of which the search may miss a little.
  const auto sum = [&](std::size_t plan, auto&& of) {
    double total = 0.0;
    for (const double s : plans[plan]["steps"].back()["singular_values"]) total += of(s);
    return total;
  };
  for (std::size_t other = 0; other < 3; ++other) {
    const auto log = [](double s) { return -2 * std::log(s); };
    const auto trace = [](double s) { return 1 / (s * s); };
    EXPECT_LE(sum(0, log), sum(other, log) + 0.01);
    EXPECT_LE(sum(1, trace), 1.01 * sum(other, trace));
    const auto least = [&](std::size_t plan) {
      return plans[plan]["steps"].back()["singular_values"].back().get<double>();
    };
    EXPECT_GE(1.01 * least(2), least(other));
  }
  // Simulated and fitted, the plan keeps what it promises.
  const json trials = run_json(
      folder, {"montecarlo", folder.path("planned.toml").string(), "--trials", "40", "--start-error", "0.2"}, 0);
  for (const json& row : trials["estimates"]) EXPECT_NEAR(row["rmse_over_bound"], 1.0, 0.4) << row;
}

TEST(PlanCommand, EqualRunsThatIdentifyAllAreThreeTimesWorseToo) {
  const TempFolder folder;
  std::string text = contents(dataset("lift_plan"));
  for (const char* const name : {"body.lump.mass", "spring.oil.stiffness"}) {  // they are known here
    const std::size_t begin = text.rfind("[[unknown]]", text.find(name));
    text.erase(begin, text.find("\n\n", begin) - begin);
  }
  folder.write("lift.toml", contents(dataset("lift")));
  const json plan = run_json(folder, {"plan", folder.write("lift_plan.toml", text)}, 0);
  ASSERT_FALSE(plan["own"]["worst"].is_null());
  EXPECT_GE(plan["own"]["worst"].get<double>(), 3 * plan["steps"].back()["worst"].get<double>());
  expect_monotone(plan);
}

TEST(PlanCommand, InterruptKeepsTheBestPlanSoFar) {
  const TempFolder folder;
  const std::string out = folder.path("out").string();
  const std::string limits = std::string("runs = 20\ncandidates = 100000\n") + release_and_duration;
  const int code =
      interrupt_poise({"plan", experiment(folder, wheel_plan(limits))}, out, std::chrono::milliseconds(500));
  EXPECT_EQ(code, 1);
  EXPECT_TRUE(has(contents(out), "Interrupted")) << contents(out);
}

TEST(PlanCommand, BadLimitsAreNamed) {
  const TempFolder folder;
  const auto plan = [](const std::string& lines) { return wheel_plan("runs = 2\n" + lines); };
  const std::string vary = "[[plan.vary]]\nwhat = \"duration\"\n";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {std::string(wheel_unknowns) + one_run, "plan: expected what may be chosen; add [plan]"},
      {plan(""), "expected what may be chosen; add [[plan.vary]]"},
      {wheel_plan(release_and_duration), "expected the key runs"},
      {wheel_plan(std::string("runs = 101\n") + release_and_duration), "expected at most 100"},
      {plan(std::string("criterion = \"F\"\n") + release_and_duration), "expected one of D, A, E, found \"F\""},
      {plan("[[plan.vary]]\nwhat = \"realease.wheel\"\nvalues = [1]\n"), "did you mean \"release\"?"},
      {plan("[[plan.vary]]\nwhat = \"release.whel\"\nvalues = [1]\n"), "did you mean \"wheel\"?"},
      {plan("[[plan.vary]]\nwhat = \"set.body.wheel.mas\"\nvalues = [1]\n"), "body.wheel.mas"},
      {plan("[[plan.vary]]\nwhat = \"rest.at\"\nvalues = [1]\n"), "expected runs with a rest, run \"only\""},
      {plan(vary + "min = 2\nmax = 1\n"), "expected max > min = 2"},
      {plan(vary + "values = []\n"), "expected a number; give min and max"},
      {plan(vary + "values = [1]\nmax = 2\n"), "expected either values or min and max"},
      {plan(vary + "values = [1]\ncommon = true\n"), "expected a number of the scene"},
      {plan(vary + "values = [1, 2]\n" + vary + "values = [3]\n"), "expected another number"},
      {plan(vary + "values = [-1]\n"), "no run within the limits can be made: "}};
  for (const auto& [text, message] : cases) {
    const ProgramRun run = run_poise({"plan", experiment(folder, text)});
    EXPECT_NE(run.exit_code, 0) << text;
    EXPECT_TRUE(has(run.err + run.out, message)) << run.out << run.err;
  }
}

}  // namespace
}  // namespace poise::app_tests::plan_command_test
