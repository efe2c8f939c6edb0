#include "statics/tracking/private/dragged_point.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <Eigen/SVD>

#include "model/input_error.hpp"
#include "solvers/linear_algebra.hpp"

namespace poise {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double longest_drag_step = 0.05;   // rad or mechanism sizes
constexpr double shortest_drag_step = 1e-8;  // the same, below which it is blocked
constexpr double shortest_leap = 5e-3;       // the same, of a step across a place from which short ones lead away
constexpr int most_drag_steps = 400;
constexpr double close_enough = 1e-11;  // of what a step still gains, mechanism sizes
constexpr double immovable = 1e-9;      // rate of a point, mechanism sizes per rad or size
constexpr double on_a_curve = 1e-6;     // ratio of its rates across and along the way of a point that runs on a curve
// Rates at which a point is nearly at the end of its way, or, in its largest rate, of its reach: there no force on it
// holds the mechanism.
constexpr double end_of_curve = 2e-4;
constexpr double end_of_area = 5e-3;
constexpr double shortest_drag_part = 1e-4;  // of a straight way
constexpr double sideways = 1e-3;            // of a step away from the farthest place, rad or mechanism sizes
constexpr double damping = 0.02;  // of steps, where a point can hardly move in one direction: part of the other rate
constexpr double touching_within = 1e-9;
constexpr double drag_overrun = 1e-10;
constexpr double clear = 1e-7;           // of stops, rad or mechanism sizes
constexpr double farthest_clear = 1e-5;  // the same, of the motion that clears them

Scene with_rows(Scene scene, PointRef point) {
  scene.stops.push_back({.name = "x", .on = Measure::x_of(point)});
  scene.stops.push_back({.name = "y", .on = Measure::y_of(point)});
  return scene;
}

// A start that does not close nearby closes nowhere that counts.
solvers::NewtonOptions without_other_starts() {
  solvers::NewtonOptions out;
  out.closing_starts = 0;
  return out;
}

}  // namespace

DraggedPoint::DraggedPoint(Scene scene, PointRef point, const std::atomic<bool>* interrupt)
    : interrupt_(interrupt),
      model_(with_rows(std::move(scene), point)),
      closing_(model_.problem(), without_other_starts()) {
  const Body& body = model_.scene().bodies[static_cast<std::size_t>(point.body)];
  double extent = 0.0;
  for (const NamedPoint& other : body.points) extent = std::max(extent, norm(other.at - body.points.front().at));
  extent /= model_.scales().length;
  if (extent > 0.0) extent_ = std::min(1.0, 4.0 * extent);
  x_ = model_.start();
  const solvers::NewtonResult& closed = closing_.close(x_);
  if (closed.end == solvers::NewtonEnd::converged) x_ = closed.x;
  look();
}

bool DraggedPoint::Motions::runs_on_a_curve() const { return rate.y <= on_a_curve * rate.x; }

std::vector<Vec2> DraggedPoint::directions() const {
  const Motions all = motions({});
  if (all.size() < immovable) return {};
  if (all.runs_on_a_curve()) return {{all.along(0, 0), all.along(1, 0)}};
  return {{1, 0}, {0, 1}};
}

void DraggedPoint::expect_no_interrupt() const {
  if (interrupt_ != nullptr && *interrupt_) throw InputError("interrupted");
}

void DraggedPoint::go_to(Vec2 target, bool is_held) {
  target = (1 / model_.scales().length) * target;
  passed_.clear();
  locked_ = false;
  // At the end of its reach it moves along a curve, to first order.
  moves_in_an_area_ = directions().size() == 2;
  sense_ = {};
  sense_ = sense_at(motions({}));
  if (moves_in_an_area_ && go_straight(target)) return;
  last_balanced_ = {x_, passed_.size(), sense_};
  const double at_start = least_rate(motions({}));
  approach(target, false);
  if (!is_held && moves_in_an_area_) return;
  if (const Motions now = motions({}); holds_at(now) || least_rate(now) >= at_start) return;
  // It has come to where no force on the point holds it: up to there, then.
  x_ = last_balanced_.x;
  passed_.resize(last_balanced_.passed);
  sense_ = last_balanced_.sense;
  look();
  approach(target, true);
}

void DraggedPoint::clear_stops() {
  const Mechanism<double>& m = model_.mechanism();
  std::vector<int> touched;
  VectorXd missing(stops());
  for (int s = 0; s < stops(); ++s) {
    const double value = values_[static_cast<std::size_t>(s)];
    const double above = value - m.lower()[s], below = m.upper()[s] - value;
    if (std::min(above, below) >= clear || above + below < 4 * clear) continue;
    missing[static_cast<Index>(touched.size())] = above < below ? clear - above : below - clear;
    touched.push_back(s);
  }
  if (touched.empty()) return;
  const Motions all = motions({});
  MatrixXd rates(static_cast<Index>(touched.size()), all.basis.cols());
  for (std::size_t k = 0; k < touched.size(); ++k) {
    rates.row(static_cast<Index>(k)) = here_->jacobian.row(m.equalities() + touched[k]) * all.basis;
  }
  const VectorXd step = all.basis * solvers::minimum_norm_solution<double>(rates, missing.head(rates.rows()),
                                                                           solvers::known_to::singular_point);
  // Where a stop is at the farthest of its measure a long way would clear it by little.
  if (step.size() == 0 || step.cwiseAbs().maxCoeff() > farthest_clear) return;
  std::vector<double> to = x_;
  for (std::size_t j = 0; j < to.size(); ++j) to[j] += step[static_cast<Index>(j)];
  if (m.equalities() > 0) {
    const solvers::NewtonResult& closed = closing_.close(to);
    if (closed.end != solvers::NewtonEnd::converged) return;
    to = closed.x;
  }
  x_ = std::move(to);
  look();
}

bool DraggedPoint::holds_at(const Motions& there) const {
  return moves_in_an_area_ ? there.rate.y > end_of_area * there.rate.x : there.size() > end_of_curve * extent_;
}

// A point that moves in an area, straight to a place in it, as far as that can be: the motions of the mechanism are the
// shortest.
bool DraggedPoint::go_straight(Vec2 target) {
  const Vec2 from = place_;
  double part = 0.0, step = 1.0;
  for (int k = 0; k < most_drag_steps && step > shortest_drag_part; ++k) {
    expect_no_interrupt();
    const double to = std::min(1.0, part + step);
    const Vec2 goal = from + to * (target - from);
    const std::vector<double> x = x_;
    const Motions now = motions({});
    if (reach(goal)) {
      const Motions then = motions({});
      const bool is_balanced = holds_at(then) || least_rate(then) >= least_rate(now);
      if (is_balanced && then.basis.cols() == now.basis.cols() && goes_to(then)) {
        passed_.push_back(place());
        if (to == 1.0) return true;
        part = to;
        step *= 2.0;
        continue;
      }
    }
    x_ = x;
    look();
    step *= 0.5;
  }
  return false;
}

// Newton's method on c = 0, P = goal by shortest steps; false where it is not near.
bool DraggedPoint::reach(Vec2 goal) {
  const Mechanism<double>& m = model_.mechanism();
  const Index closures = m.equalities();
  const std::vector<double> from = x_;
  const std::vector<double> stops_before = values_;
  double last = longest_drag_step;
  for (int i = 0; i < 8; ++i) {
    MatrixXd rows(closures + 2, m.coordinates());
    rows.topRows(closures) = here_->jacobian.topRows(closures);
    rows.bottomRows(2) = here_->jacobian.bottomRows(2);
    VectorXd missing(closures + 2);
    for (Index r = 0; r < closures; ++r) missing[r] = -here_->constraint[static_cast<std::size_t>(r)];
    missing[closures] = goal.x - place_.x;
    missing[closures + 1] = goal.y - place_.y;
    const VectorXd step = solvers::minimum_norm_solution<double>(rows, missing, solvers::known_to::closed_point);
    const double size = step.cwiseAbs().maxCoeff();
    if (!(size <= std::max(last, 1e-12))) return false;
    std::vector<double> to = x_;
    for (std::size_t j = 0; j < to.size(); ++j) to[j] += step[static_cast<Index>(j)];
    const bool is_last = size < 1e-12;
    if (is_last && overruns(to, stops_before)) return false;
    x_ = std::move(to);
    look();
    if (is_last) return largest_gap() < 1e-11 && norm(goal - place_) < 1e-11;
    last = 0.3 * size;
  }
  return false;
}

double DraggedPoint::largest_gap() const {
  double out = 0.0;
  for (int r = 0; r < model_.mechanism().equalities(); ++r) {
    out = std::max(out, std::abs(here_->constraint[static_cast<std::size_t>(r)]));
  }
  return out;
}

// `holds`: at each step a force on the point holds the mechanism.
void DraggedPoint::approach(Vec2 target, bool holds) {
  locked_ = false;
  for (int k = 0; k < most_drag_steps; ++k) {
    expect_no_interrupt();
    const double before = norm(target - place_);
    const auto try_step = [&](bool strongly) {
      const VectorXd step = step_to(target, strongly);
      const double size = step.size() == 0 ? 0.0 : step.cwiseAbs().maxCoeff();
      if (!(size > shortest_drag_step)) return false;
      locked_ = !advance(step, std::min(1.0, longest_drag_step / size), target, holds, shortest_drag_step);
      return !locked_;
    };
    if (!try_step(false) && !(locked_ && try_step(true))) return;
    passed_.push_back(place());
    const Motions now = motions({});
    moves_in_an_area_ = moves_in_an_area_ || !now.runs_on_a_curve();
    if (holds_at(now)) last_balanced_ = {x_, passed_.size(), sense_};
    // Where a way is slow for a while, and beside a cusp of it, the point gains next to nothing, and may farther on.
    if (before - norm(target - place_) < close_enough && (moves_in_an_area_ || !leap(target, holds))) return;
  }
}

// A long step along the way of a point, either way.
bool DraggedPoint::leap(Vec2 target, bool holds) {
  const Motions now = motions({});
  if (now.basis.cols() != 1) return false;
  const double towards = now.rates(0, 0) * (target.x - place_.x) + now.rates(1, 0) * (target.y - place_.y);
  const VectorXd step = std::copysign(longest_drag_step, towards) / now.basis.cwiseAbs().maxCoeff() * now.basis.col(0);
  return advance(step, 1.0, target, holds, shortest_leap) || advance(-step, 1.0, target, holds, shortest_leap);
}

void DraggedPoint::look() {
  const Mechanism<double>& m = model_.mechanism();
  std::vector<int> rows(static_cast<std::size_t>(m.constraints()));
  std::iota(rows.begin(), rows.end(), 0);
  here_.emplace(m, x_, rows);
  values_.assign(here_->constraint.begin() + m.equalities(), here_->constraint.end());
  place_ = {values_[values_.size() - 2], values_[values_.size() - 1]};
}

DraggedPoint::Motions DraggedPoint::motions(const std::vector<int>& blocking) const {
  const Mechanism<double>& m = model_.mechanism();
  Motions out;
  MatrixXd kept(m.equalities() + static_cast<Index>(blocking.size()), m.coordinates());
  kept.topRows(m.equalities()) = here_->jacobian.topRows(m.equalities());
  for (std::size_t k = 0; k < blocking.size(); ++k) {
    kept.row(m.equalities() + static_cast<Index>(k)) = here_->jacobian.row(m.equalities() + blocking[k]);
  }
  out.basis = kept.rows() == 0 ? MatrixXd::Identity(m.coordinates(), m.coordinates())
                               : solvers::null_space<double>(kept, solvers::known_to::closed_point);
  out.rates = here_->jacobian.bottomRows(2) * out.basis;
  if (out.basis.cols() == 0) return out;
  const Eigen::JacobiSVD<MatrixXd> svd(out.rates, Eigen::ComputeFullU);
  out.along = svd.matrixU();
  out.rate = {svd.singularValues()[0], svd.singularValues().size() > 1 ? svd.singularValues()[1] : 0.0};
  return out;
}

// `strongly`: only in the direction in which the point moves most.
VectorXd DraggedPoint::step_to(Vec2 target, bool strongly) {
  std::vector<int> blocking;
  held_up_by_.clear();
  const VectorXd missing = (VectorXd(2) << target.x - place_.x, target.y - place_.y).finished();
  for (;;) {
    const Motions left = motions(blocking);
    if (!(left.size() > immovable)) return {};
    VectorXd step;
    if (strongly) {
      const double towards = left.along.col(0).dot(missing) / (left.rate.x * left.rate.x);
      step = left.basis * (left.rates.transpose() * (towards * left.along.col(0)));
    } else {
      step = newton_step(left, blocking, missing);
    }
    const int stop = first_blocked(step, blocking);
    if (stop < 0) return step;
    blocking.push_back(stop);
    held_up_by_ = model_.scene().stops[static_cast<std::size_t>(stop)].name;
  }
}

// The Newton step d = Z H^-1 Z^T A^T (T - P) with A = dP/dx, Z the motions left and H = Z^T (A^T A + W) Z, in which W
// is the curvature of closures, blocking stops and P under the multipliers that balance P - T. Curvatures that are
// negative are turned round, and those near zero raised, so that it leads closer, and not far.
VectorXd DraggedPoint::newton_step(const Motions& left, const std::vector<int>& blocking,
                                   const VectorXd& missing) const {
  const Mechanism<double>& m = model_.mechanism();
  const Index rows = here_->jacobian.rows();
  std::vector<Index> kept(static_cast<std::size_t>(m.equalities()));
  std::iota(kept.begin(), kept.end(), Index{0});
  for (const int s : blocking) kept.push_back(m.equalities() + s);
  const VectorXd pull = here_->jacobian.bottomRows(2).transpose() * missing;
  VectorXd y = VectorXd::Zero(rows);
  y.tail(2) = -missing;
  if (!kept.empty()) {
    MatrixXd jacobian(static_cast<Index>(kept.size()), m.coordinates());
    for (std::size_t k = 0; k < kept.size(); ++k) {
      jacobian.row(static_cast<Index>(k)) = here_->jacobian.row(kept[k]);
    }
    const VectorXd balance = solvers::minimum_norm_solution<double>(jacobian.transpose(), pull);
    for (std::size_t k = 0; k < kept.size(); ++k) y[kept[k]] = balance[static_cast<Index>(k)];
  }
  DensePoint<double> here = *here_;
  const MatrixXd bend = here.tangent(y) - here.tangent(VectorXd::Zero(rows));
  MatrixXd curvature = left.rates.transpose() * left.rates + left.basis.transpose() * bend * left.basis;
  curvature = 0.5 * (curvature + curvature.transpose()).eval();
  const solvers::SymmetricEigen eigen = solvers::symmetric_eigen(curvature);
  VectorXd along = eigen.vectors.transpose() * (left.rates.transpose() * missing);
  const double least = damping * damping * left.rate.x * left.rate.x;
  // Where it is farther away than at both sides either is as good.
  if (eigen.values[0] < -least && std::abs(along[0]) < shortest_drag_step * -eigen.values[0]) {
    return left.basis * (sideways * eigen.vectors.col(0));
  }
  for (Index i = 0; i < along.size(); ++i) along[i] /= std::max(std::abs(eigen.values[i]), least);
  return left.basis * (eigen.vectors * along);
}

// A stop at its limit that the step would overrun.
int DraggedPoint::first_blocked(const VectorXd& step, const std::vector<int>& blocking) const {
  const Mechanism<double>& m = model_.mechanism();
  for (int s = 0; s < stops(); ++s) {
    if (std::find(blocking.begin(), blocking.end(), s) != blocking.end()) continue;
    const double rate = here_->jacobian.row(m.equalities() + s).dot(step);
    const double value = values_[static_cast<std::size_t>(s)];
    const double room = rate > 0 ? m.upper()[s] - value : value - m.lower()[s];
    if (room <= touching_within && std::abs(rate) > 1e-7 * step.cwiseAbs().maxCoeff()) return s;
  }
  return -1;
}

// Tells whether a stop is passed by more than before.
bool DraggedPoint::overruns(const std::vector<double>& x, const std::vector<double>& before) const {
  const Mechanism<double>& m = model_.mechanism();
  std::vector<Planar<double>> pose(m.pose_size());
  std::vector<double> c(static_cast<std::size_t>(m.constraints()));
  m.place(x.data(), pose.data());
  m.constraint(x.data(), pose.data(), c.data());
  for (int s = 0; s < stops(); ++s) {
    const double value = c[static_cast<std::size_t>(m.stop_row(s))], now = before[static_cast<std::size_t>(s)];
    const double over = std::max(m.lower()[s] - value, value - m.upper()[s]);
    if (over > std::max(drag_overrun, std::max(m.lower()[s] - now, now - m.upper()[s]) + 1e-13)) return true;
  }
  return false;
}

// The sign of det(dP/dx Z) with the motions Z turned as those before, where the point does not run on a curve.
DraggedPoint::Sense DraggedPoint::sense_at(const Motions& there) const {
  if (there.basis.cols() != 2) return {};
  Sense out{there.basis, sense_.sign};
  const auto determinant = [](const MatrixXd& m) { return m(0, 0) * m(1, 1) - m(0, 1) * m(1, 0); };
  double turned = 1.0;
  if (sense_.basis.cols() == 2 && determinant(sense_.basis.transpose() * there.basis) < 0.0) {
    out.basis.col(0) *= -1.0;
    turned = -1.0;
  }
  if (!there.runs_on_a_curve()) out.sign = turned * determinant(there.rates) < 0.0 ? -1 : 1;
  return out;
}

// False where, with two freedoms, the point could not move across its way in between, as at the end of the reach of an
// arm of two links: beyond that the arm is bent the other way.
bool DraggedPoint::goes_to(const Motions& there) {
  Sense sense = sense_at(there);
  if (sense_.sign != 0 && sense.sign != 0 && sense.sign != sense_.sign) return false;
  sense_ = std::move(sense);
  return true;
}

// A part of the step after which the loops close nearby, no stop is overrun and the point is closer.
bool DraggedPoint::advance(const VectorXd& step, double part, Vec2 target, bool holds, double shortest) {
  const double before = norm(target - place_);
  const Motions now = motions({});
  const double least = least_rate(now);
  const std::vector<double> from = x_;
  const double size = step.cwiseAbs().maxCoeff();
  for (; part * size > shortest; part *= 0.5) {
    std::vector<double> to = from;
    for (std::size_t i = 0; i < to.size(); ++i) to[i] += part * step[static_cast<Index>(i)];
    const std::vector<double> predicted = to;
    if (model_.mechanism().equalities() > 0) {
      const solvers::NewtonResult& closed = closing_.close(to);
      if (closed.end != solvers::NewtonEnd::converged) continue;
      to = closed.x;
    }
    double off = 0.0;
    for (std::size_t i = 0; i < to.size(); ++i) off = std::max(off, std::abs(to[i] - predicted[i]));
    // A correction as long as the step may lead to another branch of the way.
    if (off > 0.3 * part * size || overruns(to, values_)) continue;
    x_ = std::move(to);
    look();
    if (norm(target - place_) < before) {
      const Motions then = motions({});
      const bool is_balanced = !holds || holds_at(then) || least_rate(then) >= least;
      if (is_balanced && then.basis.cols() == now.basis.cols() && goes_to(then)) return true;
    }
    x_ = from;
    look();
  }
  return false;
}

}  // namespace poise
