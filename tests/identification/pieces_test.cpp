// Records that are cut into pieces with starts of their own: motions that no start tells for long.

#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "identification/assessment/misfit.hpp"
#include "identification/fit/first_readings.hpp"
#include "identification/fit/fit.hpp"
#include "tests/identification/experiments.hpp"
#include "tests/identification/written_experiment.hpp"

namespace poise::pieces_test {
namespace {

const std::string scene = R"(
gravity = [0, -9.81]
[ground]
points = { O = [0, 0] }
[body.upper]
points = { A = [0, 0], B = [0.3, 0] }
mass = 1.2
center = [0.16, 0]
inertia = 0.012
[body.lower]
points = { B = [0, 0] }
mass = 0.7
center = [0.14, 0]
inertia = 0.006
[[pin]]
points = ["ground.O", "upper.A"]
[[pin]]
points = ["upper.B", "lower.B"]
[[torsion_damper]]
name = "grease"
bodies = ["ground", "upper"]
coefficient = 0.001
[start]
upper = -1.5707963267948966
lower = -1.5707963267948966
)";

const std::string sensors = R"(
scene = "scene.toml"
[[sensor]]
name = "one"
angle = "upper"
noise = 2e-3
[[sensor]]
name = "two"
angle = "lower"
noise = 2e-3
)";

const std::string unknowns = R"(
[[unknown]]
path = "body.upper.inertia"
start = 0.02
[[unknown]]
path = "body.lower.inertia"
start = 0.01
[[unknown]]
path = "torsion_damper.grease.coefficient"
start = 0
)";

class Pieces : public test::WrittenExperiment {
 protected:
  Pieces() : WrittenExperiment(scene) {
    // It goes over the top: neighbouring motions part within a second or two.
    const Experiment e = read(sensors + "[[run]]\nduration = 30\nrate = 50\nrelease = { upper = 1.8, lower = 2.3 }\n");
    const FitProblem problem(e);
    whole_ = problem.records()[0];
    std::string text = "time,one,two";
    for (std::size_t i = 0; i < whole_.sensors[0].time.size(); ++i) {
      text += fmt::format("\n{:.17g},{:.17g},{:.17g}", 5 + whole_.sensors[0].time[i], whole_.sensors[0].value[i],
                          whole_.sensors[1].value[i]);
    }
    folder_.write("swing.csv", text + "\n");
  }

  Record whole_;
};

TEST_F(Pieces, AreTheRecordCutApart) {
  const Experiment e =
      read(sensors + "[[unknown]]\npath = \"body.upper.inertia\"\nper = \"run\"\n" +
           "[[run]]\nname = \"swing\"\ndata = \"swing.csv\"\nrelease = { upper = 1.8 }\npiece = 1.55\n");
  ASSERT_EQ(e.runs.size(), 19U);
  std::size_t next = 0;
  for (std::size_t r = 0; r < e.runs.size(); ++r) {
    EXPECT_EQ(e.runs[r].name, fmt::format("swing from {:.6g} s", e.runs[r].clock_zero));
    EXPECT_EQ(e.runs[r].release.size(), r == 0 ? 1U : 0U);
    const Series& series = e.records[r].sensors[1];
    EXPECT_EQ(series.time.front(), 0.0);
    for (std::size_t i = 0; i < series.time.size(); ++i, ++next) {
      EXPECT_NEAR(e.runs[r].clock_zero + series.time[i], 5 + whole_.sensors[1].time[next], 1e-12);
      EXPECT_EQ(series.value[i], whole_.sensors[1].value[next]);
    }
  }
  EXPECT_EQ(next, whole_.sensors[1].time.size());
  EXPECT_EQ(FitProblem(e).parameters().size(), 1U);
}

// No start of the whole record tells where it is after 30 s.
TEST_F(Pieces, FitAMotionThatIsChaotic) {
  const Experiment e = read(sensors + unknowns + "[[run]]\ndata = \"swing.csv\"\npiece = 1\n");
  const std::vector<double> truth = {0.012, 0.006, 0.001};
  const Fit found = fit(FitProblem(e), FitProblem(e).records());
  ASSERT_EQ(found.status, FitStatus::converged) << found.why;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    SCOPED_TRACE(found.estimates[i].name);
    EXPECT_FALSE(found.estimates[i].withheld);
    EXPECT_NEAR(found.estimates[i].value, truth[i], 4 * found.estimates[i].standard_error);
    EXPECT_LT(found.estimates[i].standard_error, 0.05 * truth[i]);
  }
}

// What a fit of the whole record leaves is named, with the text that cures it.
TEST_F(Pieces, AreTheCauseOfAMisfitWithoutThem) {
  const Experiment e = read(sensors + unknowns + "[[run]]\ndata = \"swing.csv\"\nto = 10\n");
  const FitProblem problem(e);
  const std::vector<Record> records = problem.records();
  Fit whole;
  whole.status = FitStatus::misfit;
  whole.parameters = problem.starts();
  whole.rms = {1.0, 1.0};
  const std::vector<double> unknown = problem.unknowns_of(0, whole.parameters);
  whole.runs.push_back({.name = e.runs[0].name,
                        .nuisances = first_guess(problem.run(0), unknown, records[0]),
                        .rms = whole.rms,
                        .autocorrelation = {1.0, 1.0},
                        .mean = {0.0, 0.0},
                        .correlated = {true, true},
                        .shifted = {false, false}});
  const std::vector<MisfitCause> causes = misfit_causes(problem, whole, records, {});
  ASSERT_FALSE(causes.empty());
  EXPECT_NE(causes[0].words.find("no start tells the motion for long"), std::string::npos) << causes[0].words;
  EXPECT_EQ(causes[0].cure.find("piece = "), 0U) << causes[0].cure;
  EXPECT_LT(causes[0].over_noise, 1.2);
  EXPECT_TRUE(causes[0].cures);
}

// A measured torque goes on across the cuts.
TEST_F(Pieces, FollowTheirPartOfAnInput) {
  folder_.write("scene.toml", scene + "[[torque]]\nname = \"M\"\non = \"upper\"\nvalue = 0\n");
  const std::string input = "inputs = { \"load.M\" = \"tau\" }\n";
  std::vector<double> torque;
  std::string text = "time,tau";
  for (int i = 0; i <= 600; ++i) {
    torque.push_back(1.5 * std::sin(0.05 * i) + 0.8 * std::sin(0.021 * i * std::sqrt(1.0 + i)));
    text += fmt::format("\n{:.17g},{:.17g}", 0.02 * i, torque.back());
  }
  folder_.write("tau.csv", text + "\n");
  const Experiment driven =
      read(sensors + "[[run]]\nduration = 12\nrate = 50\nrelease = { upper = -1.5, lower = -1.6 }\n" +
           "inputs = { \"load.M\" = { column = \"tau\", file = \"tau.csv\" } }\n");
  const Record record = FitProblem(driven).records()[0];
  text = "time,one,two,tau";
  for (std::size_t i = 0; i < record.sensors[0].time.size(); ++i) {
    text += fmt::format("\n{:.17g},{:.17g},{:.17g},{:.17g}", record.sensors[0].time[i], record.sensors[0].value[i],
                        record.sensors[1].value[i], torque[i]);
  }
  folder_.write("driven.csv", text + "\n");
  const Experiment e = read(sensors + unknowns + "[[run]]\ndata = \"driven.csv\"\npiece = 2\n" + input);
  ASSERT_EQ(e.runs.size(), 6U);
  const FitProblem problem(e);
  const Fit found = fit(problem, problem.records());
  ASSERT_EQ(found.status, FitStatus::converged) << found.why;
  EXPECT_NEAR(found.residual_over_noise, 1.0, 0.1);
  EXPECT_NEAR(found.estimates[0].value, 0.012, 4 * found.estimates[0].standard_error);
  EXPECT_NEAR(found.estimates[1].value, 0.006, 4 * found.estimates[1].standard_error);
}

TEST_F(Pieces, AreRefusedWhereTheyHaveNoMeaning) {
  const auto says = [&](const std::string& more) { return error(sensors + "[[run]]\ndata = \"swing.csv\"\n" + more); };
  EXPECT_EQ(says("piece = 0"), "experiment.toml:13: run 1.piece: expected a finite number > 0, found 0");
  EXPECT_EQ(says("piece = 1\nstart_known = true"),
            "experiment.toml:13: run 1.piece: expected no pieces of a run whose start is known; leave it out");
  EXPECT_EQ(
      says("piece = 0.01"),
      "experiment.toml:13: run 1.piece: expected pieces with at least 12 readings, run 1 from 5 s has 2; make them "
      "longer");
  folder_.write("scene.toml", scene +
                                  "[[torque]]\nname = \"M\"\non = \"upper\"\nvalue = 0.1\ntime = { sine = { amplitude "
                                  "= 1, frequency = 2 } }\n");
  EXPECT_NE(says("piece = 1").find("expected no pieces of a run of a scene with functions of time"), std::string::npos);
}

}  // namespace
}  // namespace poise::pieces_test
