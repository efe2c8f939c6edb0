#include "statics/equilibrium/settle.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

#include "solvers/curve_motion.hpp"
#include "solvers/damped_motion.hpp"
#include "solvers/linear_algebra.hpp"
#include "solvers/newton.hpp"
#include "solvers/vectors.hpp"
#include "statics/equilibrium/private/damped_mechanism.hpp"
#include "statics/model/curvature.hpp"

namespace poise {
namespace {

using solvers::Arrival;
using solvers::DampedResult;

constexpr int dense_settling_limit = 300;  // coordinates up to which ranks and directions are found by dense factors
constexpr double settling_closed_within = 1e-13;
// Several freedoms: error of one step, at first and at least, and of the whole motion, where it has grown most.
constexpr double first_tolerance = 1e-3;
constexpr double least_tolerance = 1e-11;
constexpr double accurate_within = 0.02;
constexpr double beside_start[] = {1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2};  // distances of displaced starts
constexpr double flat_curvature = 1e-9;   // curvature, relative to the largest, below which a direction may be unstable
constexpr double drive_rounding = 1e-13;  // of forces, relative to the largest, and to the model's unit of force
constexpr double course_step = 0.05;      // of motions whose poses are kept, so that they can be shown

class Settler {
 public:
  Settler(const StaticModel& model, const SettleOptions& options)
      : model_(model), mechanism_(model.mechanism()), options_(options), closing_(model.problem()) {}

  Settling run(const std::vector<double>& x) {
    const auto begin = std::chrono::steady_clock::now();
    settle_from(x);
    if (out_.why.empty()) out_.why = describe();
    out_.microseconds = std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count();
    return std::move(out_);
  }

 private:
  void settle_from(const std::vector<double>& x) {
    out_.x = x;
    if (!close(out_.x)) return;
    const std::vector<double> start = out_.x;
    out_.freedoms = freedoms_at(start);
    problem_.emplace(model_, start);
    out_.by_dampers = problem_->by_dampers();
    const DampedResult result = move(start);
    take(result);
    if (result.arrival != Arrival::rest && result.arrival != Arrival::unstable) return;
    const bool at_start = distance(start, result.x) <= 1e-9;
    if (result.arrival == Arrival::rest && !at_start) return;
    find_sides(result.x, result.active);
    if (out_.sides.empty()) {
      out_.end = Settling::End::settled;
      return;
    }
    out_.course.insert(out_.course.end(), first_fall_.begin(), first_fall_.end());
    if (at_start) {
      out_.end = Settling::End::start_unstable;
      if (!options_.sides) out_.sides.clear();
      return;
    }
    // The motion ended on a watershed: whatever disturbs it decides.
    out_.end = out_.sides.front().end;
    out_.x = out_.sides.front().x;
    out_.active_stops = out_.sides.front().active_stops;
    out_.in_doubt = true;
    out_.margin = 0.0;
  }

  bool close(std::vector<double>& x) {
    const solvers::Problem& problem = model_.problem();
    solvers::Evaluation at = problem.make_evaluation();
    at.x = x;
    problem.evaluate(at);
    double gap = 0.0;
    for (int r = 0; r < problem.constraints(); ++r) gap = std::max(gap, std::abs(solvers::violation(problem, at, r)));
    if (gap <= settling_closed_within) return true;
    const solvers::NewtonResult& closed = closing_.close(x);
    out_.evaluations += closed.evaluations;
    x = closed.x;
    return closed.end == solvers::NewtonEnd::converged;
  }

  std::vector<int> closure_rows() const {
    std::vector<int> rows(mechanism_.equalities());
    std::iota(rows.begin(), rows.end(), 0);
    return rows;
  }

  int freedoms_at(const std::vector<double>& x) const {
    const int n = mechanism_.coordinates();
    if (mechanism_.equalities() == 0) return n;
    if (n > dense_settling_limit) return n - mechanism_.equalities();
    const DensePoint<double> point(mechanism_, x, closure_rows());
    return n - static_cast<int>(solvers::rank<double>(point.jacobian.transpose(), solvers::known_to::closed_point));
  }

  static double distance(const std::vector<double>& a, const std::vector<double>& b) {
    double far = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) far = std::max(far, std::abs(a[i] - b[i]));
    return far;
  }

  DampedResult move(const std::vector<double>& x) {
    solvers::DampedOptions settings{
        .run_away = options_.run_away, .steps = options_.steps, .interrupt = options_.interrupt};
    if (options_.course) {
      settings.longest_step = course_step;
      settings.passed = [this](std::span<const double> passed) { passed_.emplace_back(passed.begin(), passed.end()); };
    }
    passed_.assign(options_.course ? 1 : 0, x);
    if (out_.freedoms == 1) {
      if (!curve_) curve_.emplace(*problem_, settings);
      return counted(curve_->run(x));
    }
    if (!motion_) motion_.emplace(*problem_, settings);
    DampedResult result;
    for (double tolerance = first_tolerance;;) {
      passed_.resize(options_.course ? 1 : 0);
      result = counted(motion_->run(x, tolerance));
      const bool is_large = mechanism_.coordinates() > dense_settling_limit;
      if (result.error <= accurate_within || result.arrival == Arrival::interrupted || is_large) break;
      if (tolerance <= least_tolerance) break;
      tolerance = std::max(least_tolerance, tolerance * std::min(0.1, 0.2 * accurate_within / result.error));
    }
    return result;
  }

  const DampedResult& counted(const DampedResult& result) {
    out_.evaluations += result.evaluations;
    out_.steps += result.steps;
    return result;
  }

  std::vector<int> stops_of(const std::vector<char>& active) const {
    std::vector<int> stops;
    for (int s = 0; s < mechanism_.stops(); ++s) {
      if (active[mechanism_.stop_row(s)] != 0) stops.push_back(s);
    }
    return stops;
  }

  void take(const DampedResult& result) {
    out_.end = end_of(result.arrival);
    out_.x = result.x;
    out_.course = std::move(passed_);
    if (options_.course) out_.course.push_back(result.x);
    out_.active_stops = stops_of(result.active);
    out_.margin = result.margin;
    const bool has_several = out_.freedoms > 1;
    out_.in_doubt = result.rounding_decides ||
                    (has_several && (result.margin < options_.watershed || result.error > accurate_within));
  }

  static Settling::End end_of(Arrival arrival) {
    switch (arrival) {
      case Arrival::rest:
      case Arrival::unstable:
        return Settling::End::settled;
      case Arrival::runs_away:
        return Settling::End::runs_away;
      case Arrival::singular:
        return Settling::End::singular;
      case Arrival::step_limit:
        return Settling::End::step_limit;
      case Arrival::interrupted:
        return Settling::End::interrupted;
    }
    return Settling::End::step_limit;
  }

  // --- unstable equilibria
  // ----------------------------------------------------------------------------------------------

  // Both sides of each direction of negative curvature, or of next to none, in which it falls.
  void find_sides(const std::vector<double>& x, const std::vector<char>& active) {
    for (const Eigen::VectorXd& direction : falling_directions(x, active)) {
      for (const double sign : {1.0, -1.0}) {
        const std::optional<std::vector<double>> beside_x = start_of_fall(x, sign * direction);
        if (!beside_x) continue;
        Settling::Side side;
        side.direction.resize(x.size());
        for (std::size_t i = 0; i < x.size(); ++i) {
          side.direction[i] = sign * direction[static_cast<Eigen::Index>(i)];
        }
        if (options_.sides || out_.sides.empty()) {
          const DampedResult result = fall(*beside_x);
          if (options_.course && out_.sides.empty()) {
            first_fall_ = std::move(passed_);
            first_fall_.push_back(result.x);
          }
          side.end = end_of(result.arrival);
          side.x = result.x;
          side.active_stops = stops_of(result.active);
        }
        out_.sides.push_back(std::move(side));
      }
    }
  }

  // As move(), and on from every unstable equilibrium that a symmetric motion leads to.
  DampedResult fall(const std::vector<double>& x) {
    DampedResult result = move(x);
    for (int k = 0; k < out_.freedoms && result.arrival == Arrival::unstable; ++k) {
      std::optional<std::vector<double>> next;
      for (const Eigen::VectorXd& direction : falling_directions(result.x, result.active)) {
        next = start_of_fall(result.x, direction);
        if (!next) next = start_of_fall(result.x, -direction);
        if (next) break;
      }
      if (!next) break;
      const std::vector<std::vector<double>> before = std::move(passed_);
      result = move(*next);
      passed_.insert(passed_.begin(), before.begin(), before.end());
    }
    return result;
  }

  std::vector<Eigen::VectorXd> falling_directions(const std::vector<double>& x, const std::vector<char>& active) const {
    std::vector<Eigen::VectorXd> out;
    const auto n = static_cast<Eigen::Index>(x.size());
    if (n > dense_settling_limit) {
      out.push_back(
          Eigen::VectorXd::NullaryExpr(n, [](Eigen::Index i) { return std::sin(1.0 + 2.0 * i); }).normalized());
      return out;
    }
    std::vector<int> rows;
    for (int r = 0; r < mechanism_.constraints(); ++r) {
      if (active[r] != 0) rows.push_back(r);
    }
    const ReducedHessian hessian(mechanism_, x, rows);
    if (hessian.matrix.size() == 0) return out;
    const solvers::SymmetricEigen eigen = solvers::symmetric_eigen(0.5 * (hessian.matrix + hessian.matrix.transpose()));
    for (Eigen::Index k = 0; k < eigen.values.size(); ++k) {
      if (eigen.values[k] < flat_curvature * hessian.largest) out.emplace_back(hessian.basis * eigen.vectors.col(k));
    }
    return out;
  }

  // The nearest displaced pose on a side from which the force drives farther away; none if it holds.
  std::optional<std::vector<double>> start_of_fall(const std::vector<double>& x, const Eigen::VectorXd& direction) {
    for (const double by : beside_start) {
      std::vector<double> displaced = x;
      for (std::size_t i = 0; i < x.size(); ++i) displaced[i] += by * direction[static_cast<Eigen::Index>(i)];
      if (!close(displaced)) return std::nullopt;
      const double drive = drive_away(x, displaced);
      if (std::isnan(drive) || drive < 0.0) return std::nullopt;
      if (drive > 0.0) return displaced;
    }
    return std::nullopt;
  }

  // The force at `to` along the way there from `from`, both closed; 0 if it is rounding.
  double drive_away(const std::vector<double>& from, const std::vector<double>& to) const {
    const DensePoint<double> point(mechanism_, to, closure_rows());
    Eigen::VectorXd way = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(to.size()));
    for (std::size_t i = 0; i < to.size(); ++i) way[static_cast<Eigen::Index>(i)] = to[i] - from[i];
    if (static_cast<int>(to.size()) <= dense_settling_limit && point.jacobian.rows() > 0) {
      const Eigen::MatrixXd basis = solvers::null_space<double>(point.jacobian, solvers::known_to::solution);
      way = basis * (basis.transpose() * way);
    }
    if (!(way.norm() > 0.3 * beside_start[0])) return std::numeric_limits<double>::quiet_NaN();
    const double drive = -point.force.dot(way.normalized());
    return std::abs(drive) <= drive_rounding * (1.0 + point.force.cwiseAbs().maxCoeff()) ? 0.0 : drive;
  }

  std::string describe() const {
    switch (out_.end) {
      case Settling::End::settled:
        return "it comes to rest there when released from the start with heavy damping";
      case Settling::End::start_unstable:
        return "the start is an equilibrium from which it falls";
      case Settling::End::runs_away:
        return "it runs away: it moves on without coming to rest";
      case Settling::End::singular:
        return "the loops lock or branch on the way, so that the mechanism could continue in several ways";
      case Settling::End::not_closed:
        return "the loops could not be closed from the start";
      case Settling::End::step_limit:
        return "it had not come to rest after the most steps allowed";
      case Settling::End::interrupted:
        return "interrupted";
    }
    return "unknown";
  }

  const StaticModel& model_;
  const Mechanism<double>& mechanism_;
  SettleOptions options_;
  solvers::Newton closing_;
  std::optional<DampedMechanism> problem_;
  std::optional<solvers::CurveMotion> curve_;
  std::optional<solvers::DampedMotion> motion_;
  std::vector<std::vector<double>> passed_, first_fall_;  // poses of the last motion, and of that to the first side
  Settling out_;
};

}  // namespace

std::string to_string(Settling::End end) {
  switch (end) {
    case Settling::End::settled:
      return "settled";
    case Settling::End::start_unstable:
      return "start unstable";
    case Settling::End::runs_away:
      return "runs away";
    case Settling::End::singular:
      return "singular";
    case Settling::End::not_closed:
      return "not closed";
    case Settling::End::step_limit:
      return "step limit";
    case Settling::End::interrupted:
      return "interrupted";
  }
  return "unknown";
}

Settling settle(const StaticModel& model, const std::vector<double>& x, const SettleOptions& options) {
  return Settler(model, options).run(x);
}

}  // namespace poise
