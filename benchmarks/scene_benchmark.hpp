#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "benchmarks/external_solver.hpp"
#include "statics/model/static_model.hpp"

namespace poise::benchmarks {

/// The equilibrium that datasets/answers.json lists first, refined in 50 digits; for hanging chains, which it does not
/// list, what Poise finds, refined, and held to their references (known_answers.hpp). Throws std::runtime_error where
/// these do not agree.
std::vector<double> known_equilibrium(const StaticModel& model, const std::string& name);

/// Largest difference of a coordinate, rad (whole turns left out) or lengths over the mechanism's size.
double difference(const Layout& layout, const std::vector<double>& x, const std::vector<double>& truth);

/// A way to solve the scene at hand from the start at hand.
struct Solver {
  std::string family;  ///< "Poise", "Ipopt", "SciPy", "NumPy", "Simbody", "MuJoCo"
  std::string method;
  bool has_accuracy = true;  ///< false: it is taken as it is
  std::function<std::optional<SolverAnswer>(double accuracy, int times)> solve;
};

/// What became of one solver.
struct SolverResult {
  const Solver* solver = nullptr;
  bool arrives = false;      ///< within right_answer of the known equilibrium, from the scene's own start
  double error = 0.0;        ///< of that answer; infinite where there was none
  double accuracy = 0.0;     ///< asked for
  int evaluations = 0;       ///< for one solution
  int nearby = 0;            ///< of nearby_starts, those from which it found an equilibrium; -1: too slow to be tried
  double seconds = 0.0;      ///< median; 0 where it does not arrive
  bool false_claim = false;  ///< called an answer from a nearby start right that is no equilibrium
};

inline constexpr double right_answer = 1e-5;  ///< what counts as arriving, rad or sizes
inline constexpr double wanted_error = 1e-9;  ///< each may stop as soon as its error is below
inline constexpr int nearby_starts = 10;      ///< that start with every coordinate moved
inline constexpr double nearby_reach = 0.3;   ///< by up to this, rad or sizes

/// Lets Poise's virtual work, Ipopt and all methods of the external solvers solve the scene `name`: each with the
/// loosest accuracy of 1e-4, 1e-5, ... 1e-14 whose error is below wanted_error, or, if none, the one with the least
/// error. Those that arrive are then timed turn by turn, all in one race, from the scene's closed start.
class SceneBenchmark {
 public:
  SceneBenchmark(const std::string& name, const std::vector<ExternalSolver*>& external_solvers);

  const StaticModel& model() const { return model_; }
  std::vector<SolverResult> run();
  /// External solvers that cannot do this scene, and why.
  const std::vector<std::string>& left_out() const { return left_out_; }

 private:
  void add_our_own();
  void add(ExternalSolver& external);
  void start_from(const std::vector<double>& x);
  SolverResult solve_from_start(const Solver& solver) const;
  void solve_nearby(std::vector<SolverResult>& results);
  void time(std::vector<SolverResult>& results) const;

  StaticModel model_;
  std::vector<double> truth_, origin_, start_;
  std::vector<ExternalSolver*> external_;  // that can do it
  std::vector<Solver> solvers_;
  std::vector<std::string> left_out_;
};

}  // namespace poise::benchmarks
