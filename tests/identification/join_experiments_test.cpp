#include "identification/experiment/private/join_experiments.hpp"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "identification/fit/fit.hpp"
#include "tests/app/run_poise.hpp"

namespace poise::join_experiments_test {
namespace {

/// A wheel on a torsion spring; in the second scene on a second one that is known, too.
const std::string wheel = R"(
[ground]
points = { O = [0, 0] }
[body.wheel]
points = { O = [0, 0] }
mass = 1
inertia = 0.5
[[pin]]
points = ["ground.O", "wheel.O"]
[[torsion_spring]]
name = "coil"
bodies = ["ground", "wheel"]
stiffness = 20
)";
const std::string second_spring = R"(
[[torsion_spring]]
name = "extra"
bodies = ["ground", "wheel"]
stiffness = 30
)";

std::string experiment(const std::string& scene, const std::string& unknowns, const std::string& sensor = "") {
  return "scene = \"" + scene + "\"\n[[sensor]]\nname = \"turn\"\nangle = \"wheel\"\nnoise = 1e-4\n" + sensor +
         unknowns + "[[run]]\nduration = 2\nrate = 100\nrelease = { wheel = 0.3 }\n";
}

std::string unknown(const std::string& name, const std::string& path, const std::string& keys = "") {
  return "[[unknown]]\nname = \"" + name + "\"\npath = \"" + path + "\"\n" + keys;
}

const std::string k = unknown("k", "torsion_spring.coil.stiffness", "start = 15\n");
const std::string J = unknown("J", "body.wheel.inertia", "start = 0.4\n");

class JoinExperiments : public testing::Test {
 protected:
  JoinExperiments() {
    folder_.write("one.toml", wheel);
    folder_.write("two.toml", wheel + second_spring);
  }

  Experiment read(const std::string& a, const std::string& b,
                  const std::string& joint = "experiments = [\"a.toml\", \"b.toml\"]\n",
                  const ExperimentOptions& options = {}) const {
    folder_.write("a.toml", a);
    folder_.write("b.toml", b);
    return read_experiment(folder_.write("joint.toml", joint), options);
  }

  std::string error(const std::string& a, const std::string& b,
                    const std::string& joint = "experiments = [\"a.toml\", \"b.toml\"]\n",
                    const ExperimentOptions& options = {}) const {
    try {
      read(a, b, joint, options);
    } catch (const InputError& error) {
      std::string message = error.what();
      const std::string prefix = folder_.path("").string();
      for (std::size_t at = 0; (at = message.find(prefix)) != std::string::npos;) message.erase(at, prefix.size());
      return message;
    }
    return "";
  }

  app_tests::TempFolder folder_;
};

// k / J from the one experiment, (k + 30) / J from the other: together they give both.
TEST_F(JoinExperiments, IdentifiesWhatNoneDoesAlone) {
  const Experiment joint = read(experiment("one.toml", k + J), experiment("two.toml", J + k));
  const Experiment alone = read_experiment(folder_.path("a.toml"));
  {
    const FitProblem problem(alone);
    const Fit fitted = fit(problem, problem.records());
    ASSERT_EQ(fitted.estimates.size(), 2u);
    EXPECT_TRUE(fitted.estimates[0].withheld);
    EXPECT_TRUE(fitted.estimates[1].withheld);
  }
  ASSERT_EQ(joint.runs.size(), 2u);
  EXPECT_EQ(joint.runs[0].name, "a: run 1");
  EXPECT_EQ(joint.runs[1].name, "b: run 1");
  ASSERT_EQ(joint.sensors.size(), 2u) << "of different scenes";
  EXPECT_EQ(joint.sensors[0].name, "turn (a)");
  EXPECT_EQ(joint.sensors[1].name, "turn (b)");
  const FitProblem problem(joint);
  ASSERT_EQ(problem.parameters().size(), 2u);
  EXPECT_EQ(problem.parameters_of(1), (std::vector<int>{1, 0})) << "in the order of its own file";
  const std::vector<Record> records = problem.records();
  EXPECT_EQ(records[0].sensors[0].value.size(), 200u);
  EXPECT_TRUE(records[0].sensors[1].value.empty());
  EXPECT_TRUE(records[1].sensors[0].value.empty());
  for (const bool use_starts : {false, true}) {
    const Fit fitted = fit(problem, records, {.use_starts = use_starts});
    ASSERT_EQ(fitted.status, FitStatus::converged) << fitted.why;
    for (const Estimate& estimate : fitted.estimates) {
      EXPECT_FALSE(estimate.withheld) << estimate.why;
      EXPECT_NEAR(estimate.value, estimate.truth, 5 * estimate.standard_error) << estimate.name;
      EXPECT_LT(estimate.standard_error, 1e-3 * estimate.truth) << estimate.name;
    }
  }
}

TEST_F(JoinExperiments, SharesSensorsThatAreTheSame) {
  const Experiment joint = read(experiment("one.toml", k), experiment("one.toml", k));
  ASSERT_EQ(joint.sensors.size(), 1u);
  EXPECT_EQ(joint.sensors[0].name, "turn");
  const Experiment rates = read(experiment("one.toml", k), experiment("one.toml", k, "rate = true\n"));
  ASSERT_EQ(rates.sensors.size(), 2u);
  EXPECT_EQ(rates.sensors[1].name, "turn (b)");
  // One experiment with two runs and two of one run each are the same fit, but for the noise.
  const FitProblem problem(joint);
  const Fit fitted = fit(problem, problem.records());
  EXPECT_EQ(fitted.status, FitStatus::converged) << fitted.why;
  EXPECT_EQ(fitted.rms.size(), 1u);
}

TEST_F(JoinExperiments, KeepsOtherUnknownsApart) {
  const Experiment joint =
      read(experiment("one.toml", k + J), experiment("two.toml", k + unknown("c", "torsion_spring.extra.stiffness")));
  const FitProblem problem(joint);
  ASSERT_EQ(problem.parameters().size(), 3u);
  EXPECT_EQ(problem.parameters_of(0), (std::vector<int>{0, 1}));
  EXPECT_EQ(problem.parameters_of(1), (std::vector<int>{0, 2}));
}

TEST_F(JoinExperiments, TakesWhatOneOfThemGives) {
  const Experiment joint =
      read(experiment("one.toml", unknown("k", "torsion_spring.coil.stiffness", "max = 100\nprior = [20, 3]\n")),
           experiment("two.toml", unknown("k", "torsion_spring.coil.stiffness", "start = 15\nmin = 5\n")));
  for (const Unknown& each : joint.unknowns) {
    EXPECT_EQ(each.start, 15.0);
    EXPECT_EQ(each.min, 5.0);
    EXPECT_EQ(each.max, 100.0);
    EXPECT_EQ(each.prior, 20.0);
    EXPECT_EQ(each.prior_deviation, 3.0);
  }
}

TEST_F(JoinExperiments, RefusesACopyOfARun) {
  folder_.write("one.csv", "time,turn\n0,0.3\n0.1,0.2\n0.2,0.1\n");
  folder_.write("copy.csv", "time,turn\n5,0.3\n5.1,0.2\n5.2,0.1\n");
  const auto of = [&](const std::string& file) {
    return "scene = \"one.toml\"\n[[sensor]]\nname = \"turn\"\nangle = \"wheel\"\nnoise = 1e-4\n[[run]]\ndata = \"" +
           file + "\"\n";
  };
  EXPECT_EQ(
      error(of("one.csv"), of("copy.csv")),
      "b.toml:6: run \"b: run 1\": expected readings of its own, all are those of run \"a: run 1\"; leave one of the "
      "two out");
}

TEST_F(JoinExperiments, RefusesContradictions) {
  const std::string a = experiment("one.toml", k);
  const std::string place = "b.toml:6: unknown \"k\"";
  const std::string same = ", which is the same number in a.toml:6; make them agree, or give one of them another name";
  const auto of = [&](const std::string& keys) {
    return error(a, experiment("two.toml", unknown("k", "torsion_spring.coil.stiffness", keys)));
  };
  EXPECT_EQ(of(""), "");
  EXPECT_EQ(of("start = 16\n"), place + ".start: expected 15" + same);
  EXPECT_EQ(of("start = 15\nper = \"run\"\n"), place + ".per: expected none" + same);
  EXPECT_EQ(of("start = 15\nincludes = 1\n"), place + ".includes: expected 0" + same);
  EXPECT_EQ(of("min = 16\n"), place + ": expected a range with the start 15 in common with the one" + same);
  EXPECT_EQ(error(a, experiment("two.toml", unknown("k", "body.wheel.inertia"))),
            place + ".path: expected the dimension of torsion_spring.coil.stiffness" + same);
  EXPECT_EQ(error(experiment("one.toml", unknown("k", "torsion_spring.coil.stiffness", "prior = [20, 1]\n")),
                  experiment("two.toml", unknown("k", "torsion_spring.coil.stiffness", "prior = [20, 2]\n"))),
            place + ".prior: expected [20, 1]" + same);
  EXPECT_EQ(error(a, experiment("two.toml", unknown("k", "torsion_spring.extra.stiffness"))),
            place + ": expected 20 in the scene of a simulation" + same);
  folder_.write("mm.toml", "[units]\nlength = \"mm\"\n" + wheel);
  EXPECT_EQ(error(a, experiment("mm.toml", k)),
            "mm.toml:1: units: expected those of one.toml in all scenes of one fit; write the same [units]");
  EXPECT_EQ(error(a, a, "experiments = [\"a.toml\", \"none.toml\"]\n"),
            "joint.toml:1: experiments: expected an experiment file, relative to this file; there is no \"none.toml\"");
  EXPECT_EQ(error(a, a, "experiments = [\"a.toml\"]\n"),
            "joint.toml:1: experiments: expected two experiments at least; give a single one to the command itself");
  EXPECT_EQ(error(a, a, "experiments = [\"a.toml\", \"a.toml\"]\n"),
            "joint.toml:1: experiments: expected each experiment once, found \"a.toml\" again");
  EXPECT_EQ(error(a, a, "experiments = [\"a.toml\", \"joint.toml\"]\n"),
            "joint.toml:1: experiments: expected experiments with scenes of their own, \"joint.toml\" names others");
  EXPECT_EQ(error(a, a, "experiments = [\"a.toml\", \"b.toml\"]\nscene = \"one.toml\"\n"),
            "joint.toml:2: scene: expected one of the keys title, source, loss, experiments");
  EXPECT_EQ(error(a, "loss = \"huber\"\n" + a),
            "joint.toml:1: experiments: expected one loss in all experiments, found squares and huber; write loss = "
            "\"...\" in this file");
  EXPECT_EQ(error(a, a, "experiments = [\"a.toml\", \"b.toml\"]\n", {.data = "x.csv"}),
            "--data x.csv: expected an experiment with a scene of its own; name the file in the experiments");
  EXPECT_EQ(error(a, a, "experiments = [\"a.toml\", \"b.toml\"]\n", {.settings = {"body.wheel.mass=2"}}),
            "--set body.wheel.mass=2: expected an experiment with a scene of its own; write set in the experiments");
}

}  // namespace
}  // namespace poise::join_experiments_test
