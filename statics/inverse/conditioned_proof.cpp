#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "solvers/krawczyk.hpp"
#include "solvers/linear_algebra.hpp"
#include "statics/inverse/ball_dual.hpp"
#include "statics/inverse/conditioned_impl.hpp"

namespace poise {
/// The equations without those that repeat others, in balls.
class ConditionedEquilibrium::Prover {
 public:
  Prover(const ConditionedEquilibrium& system, const Point& at) : system_(system), at_(at) { choose_rows(); }

  SolutionProof run();

 private:
  void choose_rows();
  int count() const { return static_cast<int>(unknowns_.size()); }
  /// Left sides, and where asked for their derivatives, at u, the kept unknowns. False where a comparison of balls is
  /// not decided, so that it is not known which piece of a law holds.
  bool evaluate(const std::vector<Ball>& u, std::vector<Ball>& values, std::vector<std::vector<Ball>>* by) const;
  std::string check_stops(const std::vector<Ball>& u) const;
  bool has_given_force(int stop) const {
    return std::any_of(system_.conditions_.begin(), system_.conditions_.end(), [&](const Condition& one) {
      return one.of.kind == SoughtQuantity::Kind::stop_reaction && one.of.item == stop;
    });
  }
  bool is_held(const Measure& on, const NumberedEquations::Bodies<BallDual>& bodies,
               const std::vector<NumberedEquations::Placed<BallDual>>& placed) const;
  void expand(const std::vector<Ball>& u, std::vector<BallDual>& z, std::vector<BallDual>& s) const;

  const ConditionedEquilibrium& system_;
  const Point& at_;
  // Indices of the unknowns and equations that are kept, as many of both: without joints that repeat others, and
  // without directions along which the equations do not change.
  std::vector<int> unknowns_, rows_;
  int neutral_ = 0;
  Eigen::MatrixXd gaps_;  // columns: derivatives of the rows of joints and of stops that act, by the poses
  Eigen::MatrixXd inverse_;
};

void ConditionedEquilibrium::Prover::choose_rows() {
  const NumberedEquations& equations = system_.equations_;
  const Eigen::Index bodies = equations.poses(), rows = equations.unknowns() - bodies;
  const LeftSides here = system_.differentiate(at_);
  std::vector<int> all;
  for (int i = 0; i < bodies; ++i) all.push_back(i);
  if (rows > 0) {
    gaps_ = here.by.block(bodies, 0, rows, bodies).transpose();
    for (const int k : independent_columns(gaps_)) all.push_back(static_cast<int>(bodies) + k);
  }
  for (int k = 0; k < system_.numbers().count(); ++k) all.push_back(equations.unknowns() + k);
  Eigen::MatrixXd matrix = here.by(all, all);
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) matrix.row(i) /= std::max(matrix.row(i).norm(), 1e-300);
  for (const int k : independent_columns(matrix)) unknowns_.push_back(all[static_cast<std::size_t>(k)]);
  for (const int k : independent_columns(matrix.transpose())) rows_.push_back(all[static_cast<std::size_t>(k)]);
  // The equations of a body that nothing loads depend on nothing.
  constexpr double nothing = 1e-14;
  for (const int k : all) {
    const bool is_kept = std::find(rows_.begin(), rows_.end(), k) != rows_.end();
    if (!is_kept && here.by.row(k).norm() > nothing) ++neutral_;
  }
  if (rows_.size() != unknowns_.size()) return;
  inverse_ = inverse_of(here.by(rows_, unknowns_));
}

void ConditionedEquilibrium::Prover::expand(const std::vector<Ball>& u, std::vector<BallDual>& z,
                                            std::vector<BallDual>& s) const {
  for (const double value : at_.z) z.emplace_back(Ball(value));
  for (const double value : at_.s) s.emplace_back(Ball(value));
  for (int k = 0; k < count(); ++k) {
    const auto i = static_cast<std::size_t>(unknowns_[static_cast<std::size_t>(k)]);
    (i < z.size() ? z[i] : s[i - z.size()]).a = u[static_cast<std::size_t>(k)];
  }
}

bool ConditionedEquilibrium::Prover::evaluate(const std::vector<Ball>& u, std::vector<Ball>& values,
                                              std::vector<std::vector<Ball>>* by) const {
  const Ball::Undecided undecided;
  std::vector<BallDual> z, s, out;
  expand(u, z, s);
  const auto variable = [&](int k) -> BallDual& {
    const auto i = static_cast<std::size_t>(unknowns_[static_cast<std::size_t>(k)]);
    return i < z.size() ? z[i] : s[i - z.size()];
  };
  if (by != nullptr) by->assign(static_cast<std::size_t>(count()), {});
  const int blocks_end = by == nullptr ? 1 : count();
  for (int first = 0; first < blocks_end; first += BallDual::DIMENSION) {
    const int lanes = by == nullptr ? 0 : std::min<int>(BallDual::DIMENSION, count() - first);
    for (int l = 0; l < lanes; ++l) variable(first + l).v[l] = Ball(1);
    const std::vector<BallDual> p = system_.numbers().enclosed(s);
    system_.evaluate(p.data(), z.data(), out);
    for (int l = 0; l < lanes; ++l) variable(first + l).v[l] = Ball(0);
    values.clear();
    for (int k = 0; k < count(); ++k) {
      const BallDual& value = out[static_cast<std::size_t>(rows_[static_cast<std::size_t>(k)])];
      values.push_back(value.a);
      for (int l = 0; l < lanes; ++l) (*by)[static_cast<std::size_t>(k)].push_back(value.v[l]);
    }
  }
  return !undecided.any();
}

/// Whether joints and stops that act let a measure change, to rounding. What they hold is as it is in the certificate.
bool ConditionedEquilibrium::Prover::is_held(const Measure& on, const NumberedEquations::Bodies<BallDual>& bodies,
                                             const std::vector<NumberedEquations::Placed<BallDual>>& placed) const {
  const std::vector<BallDual> gradient = system_.equations_.measure_gradient(on, bodies, placed);
  Eigen::VectorXd along(static_cast<Eigen::Index>(gradient.size()));
  for (Eigen::Index i = 0; i < along.size(); ++i) along[i] = gradient[static_cast<std::size_t>(i)].a.middle();
  if (gaps_.cols() == 0 || !along.allFinite()) return false;
  const Eigen::VectorXd by_rows = solvers::minimum_norm_solution<double>(gaps_, along, solvers::known_to::solution);
  return (along - gaps_ * by_rows).norm() <= solvers::known_to::closed_point * along.norm();
}

// Stops that act press, others are within their limits; both sides of a stop that holds its measure may press.
std::string ConditionedEquilibrium::Prover::check_stops(const std::vector<Ball>& u) const {
  std::vector<BallDual> z, s;
  expand(u, z, s);
  const std::vector<BallDual> p = system_.numbers().enclosed(s);
  const NumberedEquations& equations = system_.equations_;
  std::vector<NumberedEquations::Placed<BallDual>> placed;
  equations.place(z.data(), placed);
  const NumberedEquations::Bodies<BallDual> bodies = equations.bodies(p.data(), placed);
  const std::vector<Stop>& stops = equations.scene().stops;
  for (int stop = 0; stop < static_cast<int>(stops.size()); ++stop) {
    const Stop& of = stops[static_cast<std::size_t>(stop)];
    if (of.min == of.max) continue;
    const auto acting = std::find_if(equations.acting().begin(), equations.acting().end(),
                                     [&](const ActingStop& one) { return one.stop == stop; });
    if (acting != equations.acting().end()) {
      const int place = static_cast<int>(acting - equations.acting().begin());
      if (place == system_.acting().driven || has_given_force(stop)) continue;
      const Ball& effort = z[static_cast<std::size_t>(equations.multiplier_of_stop(place))].a;
      const bool presses = acting->upper ? effort < Ball(0) : effort > Ball(0);
      if (!presses) return fmt::format("stop \"{}\" is not proved to press", of.name);
      continue;
    }
    if (is_held(of.on, bodies, placed)) continue;
    const bool is_low = std::isfinite(of.min) && !(bodies.overrun(stop, false).a > Ball(0));
    const bool is_high = std::isfinite(of.max) && !(bodies.overrun(stop, true).a < Ball(0));
    if (is_low || is_high) return fmt::format("stop \"{}\" is not proved to be within its limits", of.name);
  }
  return "";
}

SolutionProof ConditionedEquilibrium::Prover::run() {
  SolutionProof out;
  out.part = at_.s;
  out.radius.assign(at_.s.size(), std::numeric_limits<double>::infinity());
  out.why = why_not_enclosed(system_.numbers(), system_.equations_.scene(), count());
  if (!out.why.empty()) return out;
  const int numbers = system_.numbers().count(), first_number = system_.equations_.unknowns();
  const auto has_all_numbers = [&](const std::vector<int>& of) {
    return std::count_if(of.begin(), of.end(), [&](int i) { return i >= first_number; }) == numbers;
  };
  if (rows_.size() != unknowns_.size() || !has_all_numbers(rows_) || !has_all_numbers(unknowns_) ||
      !inverse_.allFinite()) {
    out.why = "the equations are singular there, as where the quantity turns or the equilibrium is at a fold";
    return out;
  }
  std::vector<Ball> point;
  for (const int i : unknowns_) {
    const auto k = static_cast<std::size_t>(i);
    point.emplace_back(k < at_.z.size() ? at_.z[k] : at_.s[k - at_.z.size()]);
  }
  const solvers::KrawczykProof proof = solvers::krawczyk(
      std::move(point), inverse_, [&](const auto& u, auto& values, auto* by) { return evaluate(u, values, by); });
  out.why = proof.undecided ? "it lies where a law of force or a measure changes its piece"
            : !proof.proved ? "the enclosure of the equations is not proved to have a solution"
                            : check_stops(proof.solution);
  if (!out.why.empty()) return out;
  out.proved = true;
  out.neutral = neutral_;
  out.reach = proof.reach;
  for (std::size_t k = 0; k < at_.s.size(); ++k) {
    const Ball& part = proof.solution[proof.solution.size() - at_.s.size() + k];
    out.part[k] = part.middle();
    out.radius[k] = (part - Ball(out.part[k])).greatest();
  }
  return out;
}

SolutionProof ConditionedEquilibrium::prove(const Point& at) const { return Prover(*this, at).run(); }

}  // namespace poise
