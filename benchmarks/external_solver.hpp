#pragma once

#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace poise::benchmarks {

/// Result and time of a solver.
struct SolverAnswer {
  double seconds = 0.0;   ///< per solution, measured by the solver itself, without communication
  int evaluations = 0;    ///< distinct points, per solution
  bool claimed = false;   ///< it reports success
  std::vector<double> x;  ///< Poise's scaled coordinates
};

/// A program that solves scenes in a separate process, because it is in another language or contains its own Ipopt. It
/// reads one line at a time from its input and answers with one line each:
///
///     methods                       ok NAME|NAME|...
///     idle                          ok SECONDS          (least that its quickest method takes, with nothing to solve)
///     scene NAME                    ok                  (a name that baseline_scene() knows)
///     start X1 X2 ...               ok                  (scaled coordinates from which every solution starts)
///     solve METHOD ACCURACY TIMES   ok SECONDS EVALUATIONS CLAIMED X1 X2 ...     (METHOD counts from 0)
///
/// or "no WHY". Accuracy is about the required error of coordinates, 1e-4 to 1e-14: each method derives its tolerances
/// from it.
class ExternalSolver {
 public:
  /// Starts `command`. If it does not answer, why_absent() gives the reason and it has no methods.
  ExternalSolver(std::string name, const std::vector<std::string>& command);
  ~ExternalSolver();
  ExternalSolver(const ExternalSolver&) = delete;
  ExternalSolver& operator=(const ExternalSolver&) = delete;

  const std::string& name() const { return name_; }
  const std::vector<std::string>& methods() const { return methods_; }
  const std::string& why_absent() const { return why_absent_; }

  /// Least time of its fastest method, s. Empty if it does not report one.
  std::optional<double> idle();
  /// False if the solver does not support this scene; why_not() gives the reason.
  bool take(const std::string& scene);
  const std::string& why_not() const { return why_not_; }
  bool start_from(const std::vector<double>& x);
  /// Empty if it failed, or took longer than a minute and was ended.
  std::optional<SolverAnswer> solve(int method, double accuracy, int times);

 private:
  bool launch(const std::vector<std::string>& command);
  bool ask(const std::string& request);
  bool read_line();
  void end();

  std::string name_, why_absent_, why_not_, answer_, unread_;
  std::vector<std::string> methods_;
  std::size_t variables_ = 0;
  pid_t process_ = -1;
  int to_ = -1, from_ = -1;
};

}  // namespace poise::benchmarks
