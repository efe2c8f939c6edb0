// Derivatives of goals by the parts of the variables against differences.

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "design/goals/goal_evaluation.hpp"
#include "model/input_error.hpp"
#include "statics/paths/path_measures.hpp"
#include "tests/app/run_poise.hpp"
#include "tests/design/planted_goals.hpp"
#include "tests/support/random_scenes.hpp"
#include "tests/support/seed.hpp"

namespace poise::test::goal_derivatives_test {
namespace {

namespace fs = std::filesystem;

struct Compared {
  int derivatives = 0, rough = 0;  ///< those that agree or not, and those of which differences are not good enough
  double worst = 0.0;              ///< of the first, over the larger of the value and the derivative
};

/// Differences of the terms of all goals in one variable; false where one of the places has no values.
bool differences(GoalEvaluation& evaluation, const DesignPoint& point, Eigen::Index variable, double step,
                 std::vector<std::vector<double>>& out) {
  std::array<GoalValues, 2> values;
  for (const int side : {0, 1}) {
    DesignPoint there = point;
    there.parts[variable] += side == 0 ? -step : step;
    if (!evaluation.evaluate(there, false, values[static_cast<std::size_t>(side)])) return false;
  }
  out.clear();
  for (std::size_t g = 0; g < values[0].terms.size(); ++g) {
    out.emplace_back();
    for (std::size_t k = 0; k < values[0].terms[g].size(); ++k) {
      out.back().push_back((values[1].terms[g][k].value - values[0].terms[g][k].value) / (2.0 * step));
    }
  }
  return true;
}

/// Compares all derivatives at a point with extrapolated differences, whose own error is the change by the last
/// extrapolation.
void compare(const GoalProblem& problem, GoalEvaluation& evaluation, const DesignPoint& point, const std::string& what,
             Compared& out) {
  GoalValues exact;
  ASSERT_TRUE(evaluation.evaluate(point, true, exact)) << what << ": " << evaluation.why();
  for (Eigen::Index v = 0; v < point.parts.size(); ++v) {
    std::array<std::vector<std::vector<double>>, 3> by;
    double step = 4e-3;
    bool has_all = true;
    for (auto& one : by) {
      has_all = has_all && differences(evaluation, point, v, step, one);
      step /= 2.0;
    }
    if (!has_all) continue;
    for (std::size_t g = 0; g < exact.terms.size(); ++g) {
      for (std::size_t k = 0; k < exact.terms[g].size(); ++k) {
        const double once = (4.0 * by[1][g][k] - by[0][g][k]) / 3.0, again = (4.0 * by[2][g][k] - by[1][g][k]) / 3.0;
        const double best = (16.0 * again - once) / 15.0;
        const double given = exact.terms[g][k].by[v];
        const double natural = 30.0 * evaluation.size_of(static_cast<int>(g));  // size_of() is small where limits are 0
        const double size = std::max({std::abs(best), std::abs(exact.terms[g][k].value), natural});
        // A fold of the measure, or a spring that comes on within the step: then differences tell nothing.
        if (std::abs(best - again) > 1e-8 * size) {
          ++out.rough;
          continue;
        }
        ++out.derivatives;
        out.worst = std::max(out.worst, std::abs(best - given) / size);
        EXPECT_NEAR(given, best, 1e-7 * size) << what << ": " << problem.goals[g].name << " at " << exact.terms[g][k].at
                                              << " by " << problem.variables[static_cast<std::size_t>(v)].path;
      }
    }
  }
}

/// Values of goals at positions are those of a path through the scene with the numbers of the point.
void compare_values(const GoalProblem& problem, GoalEvaluation& evaluation, const DesignPoint& point,
                    const std::string& what) {
  GoalValues values;
  ASSERT_TRUE(evaluation.evaluate(point, false, values)) << what << ": " << evaluation.why();
  const Scene scene = scene_at(problem, point);
  for (std::size_t s = 0; s < problem.sweeps.size(); ++s) {
    const Sweep& sweep = problem.sweeps[s];
    if (sweep.along.empty()) continue;
    const double last = sweep.last == sweep.first ? sweep.first + 0.01 * sweep.unit : sweep.last;
    const VariedScene varied(scene, sweep.along, sweep.first / sweep.unit, last / sweep.unit);
    PathOptions options;
    options.certify = false;
    options.at = sweep.at;
    const Path found = path(varied, options);
    PathReader reader(varied);
    for (std::size_t g = 0; g < problem.goals.size(); ++g) {
      const DesignGoal& goal = problem.goals[g];
      if (goal.sweep != static_cast<int>(s) || goal.of.is_over_path()) continue;
      for (const GoalTerm& term : values.terms[g]) {
        const auto k =
            static_cast<std::size_t>(std::find(sweep.at.begin(), sweep.at.end(), term.at) - sweep.at.begin());
        ASSERT_LT(k, found.wanted.size());
        if (found.wanted[k].size() != 1) continue;
        const double known = reader.value(goal.of, found.wanted[k][0]);
        EXPECT_NEAR(term.value, known, 1e-8 * std::max(std::abs(known), evaluation.size_of(static_cast<int>(g))))
            << what << ": " << goal.name << " at " << term.at;
      }
    }
  }
}

DesignPoint random_point(const GoalProblem& problem, std::mt19937_64& random) {
  DesignPoint out = own_point(problem);
  for (Eigen::Index k = 0; k < out.parts.size(); ++k) {
    out.parts[k] = 0.05 + 0.9 * static_cast<double>(random() >> 11) * 0x1p-53;
  }
  for (std::size_t c = 0; c < out.rows.size(); ++c) {
    out.rows[c] = static_cast<int>(random() % problem.catalogues[c].rows.size());
  }
  return out;
}

TEST(GoalDerivatives, OfTheDesignsOfDatasets) {
  std::mt19937_64 random(seed(5));
  Compared out;
  for (const char* name : {"bike_suspension", "bistable_four_bar", "constant_force", "garage_door", "knee_press",
                           "over_centre_latch", "tailgate", "torque_profile", "wall_bed"}) {
    const GoalProblem problem = read_goals(app_tests::dataset(std::string(name) + "_design"));
    GoalEvaluation evaluation(problem);
    int places = 0;
    for (int draw = 0; draw < 40 && places < cases(2, 10); ++draw) {
      const DesignPoint point = random_point(problem, random);
      GoalValues values;
      if (!evaluation.evaluate(point, true, values)) continue;
      ++places;
      compare(problem, evaluation, point, name, out);
    }
    EXPECT_GT(places, 0) << name << ": " << evaluation.why();
  }
  EXPECT_LT(out.rough, 0.05 * out.derivatives);
  RecordProperty("derivatives", out.derivatives);
}

/// The goals of a design without some: those of these indices.
GoalProblem without(GoalProblem problem, std::size_t goal) {
  problem.goals.erase(problem.goals.begin() + static_cast<std::ptrdiff_t>(goal));
  return problem;
}

/// A design that asks for every quantity of a random mechanism.
std::string every_quantity(const PlantedGoals& problem, const GoalProblem& read) {
  std::string out = problem.design.substr(0, problem.design.find("[[goal]]"));
  const Sweep& sweep = read.sweeps[0];
  const std::string positions =
      sweep.along.empty() ? ""
                          : fmt::format("along = \"{}\"\nat = [{:.17g}, {:.17g}]\n", sweep.along,
                                        sweep.first / sweep.unit, (0.3 * sweep.first + 0.7 * sweep.last) / sweep.unit);
  const std::string range = sweep.along.empty() || sweep.first == sweep.last
                                ? ""
                                : fmt::format("along = \"{}\"\nover = [{:.17g}, {:.17g}]\npositions = 5\n", sweep.along,
                                              sweep.first / sweep.unit, sweep.last / sweep.unit);
  std::vector<std::string> names;
  for (const std::string& name : quantity_names(sweep.names)) {
    if (!name.starts_with("fold.") && !name.starts_with("mode.") && !name.starts_with("stress.")) names.push_back(name);
  }
  for (std::size_t k = 0; k < names.size(); ++k) {
    out += "[[goal]]\nof = \"" + names[k] + "\"\naim = \"least\"\n" + positions;
    const std::string& other = names[(k * 7 + 3) % names.size()];
    out += "[[goal]]\nof = \"" + names[k] + " * " + other + "\"\naim = \"least\"\n" + positions;
    if (!range.empty() && k % 3 == 0) {
      const char* const kinds[] = {"mean", "max", "min", "span"};
      out += fmt::format("[[goal]]\nof = \"{}({})\"\naim = \"least\"\n{}", kinds[k / 3 % 4], names[k], range);
    }
  }
  for (const SoughtQuantity& one : all_quantities(sweep.names)) {
    if (one.kind != SoughtQuantity::Kind::measure && one.kind != SoughtQuantity::Kind::energy) continue;
    out += "[[goal]]\nof = \"d(" + one.name + ")/d(" + names[0] + ")\"\naim = \"least\"\n" + positions;
  }
  return out;
}

TEST(RandomGoalDerivatives, OfEveryQuantity) {
  const int wanted = cases(12, 300);
  Compared out;
  int problems = 0, dropped = 0, kept = 0;
  for (std::uint64_t one = seed(1); problems < wanted; ++one) {
    const auto planted = plant_goals(one);
    if (!planted) continue;
    const app_tests::TempFolder folder;
    const GoalProblem first = read_goals(write_files(folder, *planted));
    GoalProblem problem;
    try {
      problem = read_goals(folder.write("every.toml", every_quantity(*planted, first)));
    } catch (const InputError& error) {
      ADD_FAILURE() << planted->what << ": " << error.what();
      ++problems;
      continue;
    }
    // Quantities without a value there, or without a derivative as the size of a force that vanishes.
    std::mt19937_64 random(one);
    DesignPoint point = random_point(problem, random);
    bool has_values = false;
    for (int tries = 0; tries < 400; ++tries) {
      GoalEvaluation evaluation(problem);
      GoalValues values;
      if (evaluation.evaluate(point, true, values)) {
        has_values = true;
        break;
      }
      const auto wrong = std::find_if(problem.goals.begin(), problem.goals.end(), [&](const DesignGoal& goal) {
        return evaluation.why() == goal.of.name + " has no value at all positions";
      });
      if (wrong == problem.goals.end()) break;
      ++dropped;
      problem = without(problem, static_cast<std::size_t>(wrong - problem.goals.begin()));
    }
    if (!has_values) continue;
    kept += static_cast<int>(problem.goals.size());
    ++problems;
    GoalEvaluation evaluation(problem);
    compare(problem, evaluation, point, planted->what, out);
    compare_values(problem, evaluation, point, planted->what);
  }
  EXPECT_LT(out.rough, 0.05 * out.derivatives);
  EXPECT_LT(dropped, kept);
  RecordProperty("derivatives", out.derivatives);
  RecordProperty("rough", out.rough);
}

// A lever on a coil of stiffness c^2 / 2 under a force that leans by one part in c; and tied numbers.
TEST(GoalDerivatives, ThroughNamedNumbersAndTies) {
  const app_tests::TempFolder folder;
  folder.write("scene.toml", R"(
title = "lever"
source = "ours"
[units]
length = "mm"
[numbers]
c = 1.5
[ground]
points = { O = [0, 0], S = [100, 300] }
[body.lever]
points = { O = [0, 0], B = [300, 0], C = [150, 20] }
mass = 2
center = [100, 5]
[[pin]]
name = "O"
points = ["ground.O", "lever.O"]
[[torsion_spring]]
name = "coil"
bodies = ["ground", "lever"]
stiffness = "c^2/2 * 1e4"
free_angle = 0.0
[[spring]]
name = "s"
points = ["ground.S", "lever.C"]
stiffness = 0.4
free_length = 100
[[force]]
name = "P"
at = "lever.B"
vector = ["-4/c", 4]
)");
  const std::string variables = R"toml(
scene = "scene.toml"
[variables]
"numbers.c" = [1, 3]
"point.lever.B.x" = [200, 400]
"spring.s.free_length" = [50, 150]
[ties]
"point.lever.C.x" = "point.lever.B.x / 2 + sin(spring.s.free_length / 40)"
"spring.s.stiffness" = "20 / spring.s.free_length^1.3"
)toml";
  std::string goals;
  for (const char* of : {"force.coil", "energy", "reaction.O", "angle.lever", "length.s", "y.lever.B"}) {
    goals += fmt::format("[[goal]]\nof = \"{}\"\naim = \"least\"\n", of);
    goals += fmt::format("[[goal]]\nof = \"{}\"\nalong = \"angle.lever\"\nat = [-0.2, 0.3]\naim = \"least\"\n", of);
    goals += fmt::format("[[goal]]\nof = \"{}\"\nalong = \"loads\"\nover = [0.5, 1.5]\naim = \"least\"\n", of);
  }
  goals += "[[goal]]\nof = \"force.drive\"\nalong = \"angle.lever\"\nat = [-0.2, 0.3]\naim = \"least\"\n";
  const GoalProblem problem = read_goals(folder.write("design.toml", variables + goals));
  Compared out;
  GoalEvaluation evaluation(problem);
  std::mt19937_64 random(3);
  for (int k = 0; k < 3; ++k) {
    const DesignPoint point = random_point(problem, random);
    compare(problem, evaluation, point, "lever", out);
    compare_values(problem, evaluation, point, "lever");
  }
  EXPECT_GT(out.derivatives, 500);
  EXPECT_EQ(out.rough, 0);
  // Closed form: at a held angle the coil's torque is c^2/2 1e4 N mm/rad times the angle, and dc/dpart = 2.
  DesignPoint point = own_point(problem);
  GoalValues values;
  ASSERT_TRUE(evaluation.evaluate(point, true, values)) << evaluation.why();
  for (const GoalTerm& term : values.terms[1]) {
    EXPECT_NEAR(std::abs(term.by[0]), 1.5 * 1e4 * 1e-3 * std::abs(term.at) * 2.0, 1e-10 * 20.0);
  }
}

}  // namespace
}  // namespace poise::test::goal_derivatives_test
