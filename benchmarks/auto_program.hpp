#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace poise::benchmarks {

/// A run of auto-07p. Its points are those of its fixed step.
struct AutoRun {
  double parameter = 0.0;     ///< at the start
  std::vector<double> start;  ///< an equilibrium there
  double step = 0.0;          ///< along the curve, in AUTO's norm: of parameter and unknowns
  int points = 0;             ///< after which it ends
  double tolerance = 0.0;     ///< relative, of parameter and unknowns
  bool with_events = false;   ///< folds and branch points are looked for
};

struct AutoCurve {
  struct Point {
    double parameter = 0.0;
    std::vector<double> u;
  };
  std::vector<Point> points;
  double per_point = 0.0;  ///< s, from the first point to the last: without starting the program and reading its files
  double process = 0.0;    ///< s, of the whole process
};

/// Equations for auto-07p (Debian package auto-07p), compiled with its library in a temporary folder, and run in a
/// separate process: from C++ on through Fortran, as AUTO's own scripts do it.
class AutoProgram {
 public:
  /// `equations`: a Fortran file of benchmarks/ with FUNC. why_absent() says why there is no program.
  explicit AutoProgram(const std::string& equations);
  ~AutoProgram();
  AutoProgram(const AutoProgram&) = delete;
  AutoProgram& operator=(const AutoProgram&) = delete;

  const std::string& why_absent() const { return why_absent_; }
  /// Empty if AUTO fails or ends before two points.
  std::optional<AutoCurve> run(const AutoRun& run) const;

 private:
  std::filesystem::path folder_;
  std::string why_absent_;
};

}  // namespace poise::benchmarks
