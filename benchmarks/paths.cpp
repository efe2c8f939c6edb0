// poise_path_ratios: the speed that load paths and settling promise, as one table. Every ratio is of programs measured
// in this run, turn by turn, medians over the turns; times of wrong answers are not printed. auto-07p takes part if it
// is installed. Exit code 1 if an answer of Poise is wrong; times do not affect it.

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "benchmarks/auto_program.hpp"
#include "benchmarks/hand_four_bar.hpp"
#include "benchmarks/race.hpp"
#include "benchmarks/ratio_table.hpp"
#include "benchmarks/timing.hpp"
#include "benchmarks/yardstick_inputs.hpp"
#include "model/scene_builder.hpp"
#include "solvers/newton.hpp"
#include "statics/equilibrium/settle.hpp"
#include "statics/model/reference.hpp"
#include "statics/paths/path.hpp"

namespace poise::benchmarks {
namespace {

constexpr double newton_limit = 2.0;   // a path over warm-started Newton at its points
constexpr double settle_limit = 20.0;  // settling over Newton from the same start
constexpr double auto_limit = 50.0;    // at least: auto-07p over Poise, per point
// The thesis four-bar by hand takes 0.16 us on the machine for which absolute times were promised.
constexpr double four_bar_seconds = 0.16e-6;
constexpr double loop_seconds = 5e-3, chain_seconds = 0.2;
constexpr int links = 100;
constexpr int checked_points = 40;       // of a path, in 50 digits
constexpr double largest_error = 1e-10;  // next to a fold rounding of the parameter alone moves a point by 1e-11
constexpr double elsewhere = 1e-6;       // rad or sizes, between Newton's result and the point
constexpr double rounding = 1e-14;
constexpr int repeats = 5;

struct Course {
  std::string name;
  VariedScene varied;
  PathOptions options;
};

Scene dataset(const char* name) { return read_scene(fmt::format("{}/datasets/{}", POISE_SOURCE_DIR, name)); }

int body_named(const Scene& scene, const std::string& name) {
  const auto found =
      std::find_if(scene.bodies.begin(), scene.bodies.end(), [&](const Body& body) { return body.name == name; });
  return static_cast<int>(found - scene.bodies.begin());
}

// Started open at 0.2 rad; the datasets' own start is next to the fold.
Scene toggle() {
  Scene scene = dataset("toggle.toml");
  scene.start.angle[body_named(scene, "left")] = 0.2;
  scene.start.angle[body_named(scene, "right")] = -0.2;
  return scene;
}

// A strut of length and bending stiffness 1, clamped at one end, as links with torsion springs; a small force beside
// the load makes it bend to one side.
Scene hinged_chain() {
  SceneBuilder builder("hinged chain");
  builder.ground_point("O", {0, 0});
  std::string before = "ground", end = "ground.O";
  for (int i = 0; i < links; ++i) {
    const std::string name = fmt::format("link{}", i);
    builder.body(name, {.points = {{"a", {0, 0}}, {"b", {1.0 / links, 0}}}});
    builder.pin(end, name + ".a");
    builder.element("torsion_spring", "", measures::angle(before, name),
                    {{"stiffness", double{links}}, {"free_angle", 0.0}});
    before = name;
    end = name + ".b";
  }
  return builder.force("P", end, {-1, 0}).force("side", end, {0, 0.01}).build();
}

Course course(const std::string& name, Scene scene, const std::string& number, double from, double to, double spacing) {
  PathOptions options;
  options.from = PathOptions::From::equilibrium;
  options.certify = false;
  options.spacing = spacing;
  return {name, VariedScene(std::move(scene), number, from, to), options};
}

const std::vector<PathPoint>& points_of(const Path& path) { return path.branches.front().points; }

// Largest distance of a point from the exact equilibrium at its parameter, of up to so many points.
double error_of(const VariedScene& varied, const std::vector<PathPoint>& points) {
  const std::size_t stride = std::max<std::size_t>(1, points.size() / checked_points);
  double worst = 0.0;
  for (std::size_t i = 0; i < points.size(); i += stride) {
    const Reference exact = refine(*varied.model_at(points[i].parameter), points[i].x);
    worst = std::max(worst, exact.refined ? exact.error : INFINITY);
  }
  return worst;
}

// Newton's method at the points of a path, each started from the point before. Models and solvers are made beforehand.
class WarmNewton {
 public:
  WarmNewton(const VariedScene& varied, const std::vector<PathPoint>& points) : points_(points) {
    for (const PathPoint& point : points) {
      models_.push_back(varied.model_at(point.parameter));
      solvers_.push_back(std::make_unique<solvers::Newton>(models_.back()->problem()));
    }
  }

  void operator()() {
    for (std::size_t i = 1; i < points_.size(); ++i) solvers_[i]->solve(points_[i - 1].x);
  }

  // Results that are not the point of the path.
  int strays() {
    int count = 0;
    for (std::size_t i = 1; i < points_.size(); ++i) {
      const solvers::NewtonResult& found = solvers_[i]->solve(points_[i - 1].x);
      double apart = found.end == solvers::NewtonEnd::converged ? 0.0 : INFINITY;
      for (std::size_t k = 0; k < found.x.size(); ++k) apart = std::max(apart, std::abs(found.x[k] - points_[i].x[k]));
      if (!(apart <= elsewhere)) ++count;
    }
    return count;
  }

 private:
  const std::vector<PathPoint>& points_;
  std::vector<std::unique_ptr<StaticModel>> models_;
  std::vector<std::unique_ptr<solvers::Newton>> solvers_;
};

// Seconds of following curves, as Path has them.
Turn tracing(const Course& course) {
  return [&course](int times) {
    double sum = 0.0;
    for (int k = 0; k < times; ++k) sum += 1e-6 * path(course.varied, course.options).microseconds;
    return sum / times;
  };
}

// Each turn is the least of several, so that what it needs is in the caches: the models of a yardstick fill them.
std::vector<double> race_warm(const std::vector<Turn>& turns) {
  std::vector<Turn> least;
  for (const Turn& turn : turns) {
    least.emplace_back([&turn](int times) {
      double seconds = turn(times);
      for (int k = 1; k < repeats; ++k) seconds = std::min(seconds, turn(times));
      return seconds;
    });
  }
  return race(least);
}

enum class Promise { over_newton_and_time, time };

void race_path(RatioTable& table, const Course& course, Promise promise, double limit) {
  const Path traced = path(course.varied, course.options);
  const std::vector<PathPoint>& points = points_of(traced);
  WarmNewton newton(course.varied, points);
  const std::array<double, 3> start = four_bar_start(StaticModel(thesis_four_bar()));
  const std::vector<double> seconds =
      race_warm({tracing(course), [&](int times) { return seconds_of([&] { newton(); }, times); },
                 [&](int times) { return seconds_of([&] { solve_four_bar_by_hand(start); }, times); }});
  const double error = error_of(course.varied, points);
  const bool right = traced.status == Path::Status::traced && traced.branches.size() == 1 && error <= largest_error;
  std::string note = fmt::format("{} points, {} events, error {:.1e}, Newton elsewhere at {}", points.size(),
                                 traced.events.size(), error, newton.strays());
  if (promise == Promise::over_newton_and_time) {
    table.ratio("path, " + course.name + " / Newton", seconds[0], seconds[1], newton_limit, right, note);
    note = fmt::format("{} where a four-bar takes 0.16 us", in_units(limit));
  } else {
    note += fmt::format(", {:.2f} x Newton's time", seconds[0] / seconds[1]);
  }
  const double four_bars = limit / four_bar_seconds;
  table.ratio(fmt::format("path, {} / {:.0f} four-bars", course.name, four_bars), seconds[0], four_bars * seconds[2],
              1.0, right, note);
}

void race_settling(RatioTable& table, const std::string& name, const Scene& scene) {
  const StaticModel model(scene);
  const std::vector<double> start = model.start();
  solvers::Newton newton(model.problem());
  Settling settling;
  const std::vector<double> seconds =
      race_warm({[&](int times) { return seconds_of([&] { settling = settle(model, start); }, times); },
                 [&](int times) { return seconds_of([&] { newton.solve(start); }, times); }});
  const bool settled = settling.end == Settling::End::settled;
  const double error = settled ? refine(model, settling.x).error : INFINITY;
  table.ratio("settling, " + name + " / Newton", seconds[0], seconds[1], settle_limit, error <= largest_error,
              fmt::format("{} steps, {} evaluations, error {:.1e}", settling.steps, settling.evaluations, error));
}

void time_certificates(const Course& course) {
  PathOptions certified = course.options;
  certified.certify = true;
  Path traced;
  const auto turn = [&](const PathOptions& options) -> Turn {
    return [&](int times) { return seconds_of([&] { traced = path(course.varied, options); }, times); };
  };
  const std::vector<double> seconds = race_warm({turn(course.options), turn(certified)});
  traced = path(course.varied, certified);
  const auto points = static_cast<double>(points_of(traced).size());
  fmt::print("{:<46}{:>12} a point; {} of {:.0f} points not proved\n", "certificates, " + course.name,
             in_units((seconds[1] - seconds[0]) / points), traced.unproved(), points);
}

// Against AUTO on the same curve with the same number of points, from the same start.
class AutoRace {
 public:
  AutoRace(const Course& course, const std::string& equations, double step)
      : course_(course), auto_(equations), step_(step), traced_(path(course.varied, course.options)) {}

  const std::string& why_absent() const { return auto_.why_absent(); }

  void run(RatioTable& table, const std::string& how, double tolerance, bool with_events) {
    const std::vector<PathPoint>& ours = points_of(traced_);
    const AutoRun request{ours.front().parameter,        ours.front().x, step_,
                          static_cast<int>(ours.size()), tolerance,      with_events};
    const std::string name = fmt::format("auto-07p, {} / Poise, {}", how, course_.name);
    const std::optional<AutoCurve> curve = auto_.run(request);
    if (!curve) {
      fmt::print("{:<46}left out: AUTO fails\n", name);
      return;
    }
    std::vector<double> processes = {curve->process};
    const Turn turn = [&](int times) {
      double sum = 0.0;
      for (int k = 0; k < times; ++k) {
        const std::optional<AutoCurve> again = auto_.run(request);
        sum += again ? again->per_point : INFINITY;
        if (again) processes.push_back(again->process);
      }
      return sum / times;
    };
    const std::vector<double> seconds = race({tracing(course_), turn});
    const double error = error_of(course_.varied, ours), their_error = error_of(course_.varied, as_path(*curve));
    table.speedup(name, seconds[0] / static_cast<double>(ours.size()), seconds[1], auto_limit,
                  error <= std::max(their_error, rounding),
                  fmt::format("errors {:.1e}/{:.1e}, {} points to {:.3g}; {} a point with start-up", error, their_error,
                              curve->points.size(), curve->points.back().parameter,
                              in_units(median(processes) / static_cast<double>(curve->points.size()))));
  }

 private:
  static std::vector<PathPoint> as_path(const AutoCurve& curve) {
    std::vector<PathPoint> points;
    for (const AutoCurve::Point& point : curve.points) {
      PathPoint& added = points.emplace_back();
      added.parameter = point.parameter;
      added.x = point.u;
    }
    return points;
  }

  const Course& course_;
  AutoProgram auto_;
  double step_;
  Path traced_;
};

void race_auto(RatioTable& table, const Course& course, const std::string& equations, double step) {
  AutoRace race(course, equations, step);
  if (!race.why_absent().empty()) {
    fmt::print("{:<46}left out: {}\n", "auto-07p / Poise, " + course.name, race.why_absent());
    return;
  }
  race.run(table, "1e-7", 1e-7, false);
  race.run(table, "1e-12", 1e-12, false);
  race.run(table, "events", 1e-7, true);
}

bool measure() {
  RatioTable table;
  table.head();
  const Course four_bar = course("four-bar", dataset("four_bar_gravity.toml"), "body.coupler.mass", 1.0, 8.0, 0.002);
  const Course toggle_course = course("toggle", toggle(), "load.P", -25.0, 25.0, 0.006);
  const Course chain = course(fmt::format("{} links", links), hinged_chain(), "load.P", 0.0, 10.0, 0.05);
  race_path(table, four_bar, Promise::over_newton_and_time, loop_seconds);
  race_path(table, toggle_course, Promise::over_newton_and_time, loop_seconds);
  race_path(table, chain, Promise::time, chain_seconds);
  race_settling(table, "four-bar", four_bar.varied.scene());
  race_settling(table, "toggle", dataset("toggle.toml"));
  for (const Course* each : {&four_bar, &toggle_course, &chain}) time_certificates(*each);
  race_auto(table, four_bar, "auto_four_bar.f90", 0.0136);
  race_auto(table, chain, "auto_chain.f90", 0.045);
  fmt::print(
      "\nPaths: of tracing alone, without certificates. Yardsticks: Newton at every point, started from the point "
      "before,\n"
      "models made beforehand; a four-bar solved by hand; Newton from the same start. auto-07p, per point of a fixed "
      "step:\n"
      "its tolerance, or with folds and branch points looked for; exact derivatives; from its first point to its last, "
      "so\n"
      "that starting the program and reading its files do not count, writing its file of points does. errors: ours, "
      "then\n"
      "AUTO's, of {} points, against 50 digits.\n",
      checked_points);
  return table.all_right();
}

}  // namespace
}  // namespace poise::benchmarks

int main() { return poise::benchmarks::measure() ? 0 : 1; }
