#include "motion/driven_path.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "motion/private/golden_section.hpp"
#include "motion/stop_room.hpp"
#include "solvers/linear_algebra.hpp"
#include "solvers/root.hpp"
#include "statics/model/curvature.hpp"
#include "statics/model/held_rows.hpp"
#include "statics/model/rounding.hpp"

namespace poise {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// All in rad or mechanism sizes.
constexpr double longest_correction = 1e-4;  // of the predicted pose: a bound that keeps the path on its branch
constexpr double closed_within = 1e-12;
constexpr double crossing_below = 1e-7;   // closeness to singular that counts as singular
constexpr double narrowest = 1e-13;       // to which least values are found, of the path's parameter
constexpr double shortest_step = 1e-10;   // of a driven coordinate
constexpr double farthest_turning = 0.1;  // along the path, in which a turning point is searched
constexpr double end_of_way = 1.0 - 1e-13;

double largest(const VectorXd& v) { return v.size() > 0 ? v.cwiseAbs().maxCoeff() : 0.0; }

}  // namespace

// --- closures -------------------------------------------------------------------------------------------------------

SplitClosure::SplitClosure(const MotionModel& model, std::vector<int> driven, std::vector<int> measured)
    : model_(model),
      driven_(std::move(driven)),
      measured_(std::move(measured)),
      rows_(permanent_rows(model.mechanism())),
      coordinates_(model.mechanism().coordinates()) {
  const Mechanism<double>& m = model.mechanism();
  const Scene& scaled = model.scaled_scene();
  const auto compiled = [&](const Measure& on) { return Measured(scaled, m.layout(), m.phasors(), on); };
  for (std::size_t k = static_cast<std::size_t>(m.equalities()); k < rows_.size(); ++k) {
    couplings_.push_back(rows_[k] - m.equalities());
    coupled_.push_back(compiled(scaled.stops[static_cast<std::size_t>(couplings_.back())].on));
  }
  for (const int drive : measured_) measures_.push_back(compiled(scaled.drives[static_cast<std::size_t>(drive)].on));
  const int size = m.coordinates() + static_cast<int>(measured_.size());
  for (int i = 0; i < size; ++i) {
    if (std::find(driven_.begin(), driven_.end(), i) == driven_.end()) free_.push_back(i);
  }
}

double SplitClosure::least_scale() const {
  return measured_.empty() ? rounding_of_closures / DrivenPath::singular_below : 1.0;
}

int SplitClosure::constant_measure() const {
  const auto found =
      std::find_if(measures_.begin(), measures_.end(), [](const Measured& g) { return g.support().empty(); });
  return found == measures_.end() ? -1 : static_cast<int>(found - measures_.begin());
}

template <class Of>
VectorXd SplitClosure::of_measures(const VectorXd& x, Of of) const {
  VectorXd out(static_cast<Eigen::Index>(measures_.size()));
  if (measures_.empty()) return out;
  const Mechanism<double>& m = model_.mechanism();
  std::vector<Planar<double>> pose(m.pose_size());
  m.place(x.data(), pose.data());
  for (std::size_t k = 0; k < measures_.size(); ++k) {
    std::vector<Planar<double>> scratch(static_cast<std::size_t>(measures_[k].scratch_size()));
    out[static_cast<Eigen::Index>(k)] =
        of(measures_[k], Configuration<double>{m.phasors(), pose.data(), scratch.data()});
  }
  return out;
}

VectorXd SplitClosure::with_measures(const VectorXd& q) const {
  VectorXd x(coordinates_ + static_cast<Eigen::Index>(measures_.size()));
  x.head(coordinates_) = q;
  x.tail(x.size() - coordinates_) = of_measures(q, [](const Measured& g, const auto& at) { return g.value(at); });
  return x;
}

VectorXd SplitClosure::gap(const VectorXd& x) const {
  const Mechanism<double>& m = model_.mechanism();
  std::vector<Planar<double>> pose(m.pose_size());
  std::vector<double> c(m.constraints());
  m.place(x.data(), pose.data());
  m.constraint(x.data(), pose.data(), c.data());
  const VectorXd closures = gaps_of(m, rows_, c);
  const VectorXd values = of_measures(x, [](const Measured& g, const auto& at) { return g.value(at); });
  VectorXd out(closures.size() + values.size());
  out.head(closures.size()) = closures;
  out.tail(values.size()) = values - x.tail(values.size());
  return out;
}

MatrixXd SplitClosure::jacobian(const VectorXd& x) const {
  MatrixXd of_closures = DensePoint<double>(model_.mechanism(), coordinates(x), rows_).jacobian;
  const Eigen::Index closures = of_closures.rows(), measures = static_cast<Eigen::Index>(measures_.size());
  if (measures == 0) return of_closures;
  MatrixXd out = MatrixXd::Zero(closures + measures, coordinates_ + measures);
  out.topLeftCorner(closures, coordinates_) = of_closures;
  out.bottomRightCorner(measures, measures).diagonal().setConstant(-1.0);
  Eigen::Index row = closures;
  of_measures(x, [&](const Measured& g, const auto& at) {
    VectorXd slopes = VectorXd::Zero(coordinates_);
    g.add_gradient(at, 1.0, slopes.data());
    out.row(row++).head(coordinates_) = slopes;
    return 0.0;
  });
  return out;
}

MatrixXd SplitClosure::free_columns(const MatrixXd& jacobian) const {
  MatrixXd out(jacobian.rows(), static_cast<Eigen::Index>(free_.size()));
  for (std::size_t k = 0; k < free_.size(); ++k) out.col(static_cast<Eigen::Index>(k)) = jacobian.col(free_[k]);
  return out;
}

VectorXd SplitClosure::curvature(const VectorXd& x, const VectorXd& v) const {
  const Mechanism<double>& m = model_.mechanism();
  std::vector<Planar<double>> pose(m.pose_size()), second(m.coordinates());
  const Eigen::Index closures = static_cast<Eigen::Index>(rows_.size());
  VectorXd out(closures + static_cast<Eigen::Index>(measures_.size()));
  m.place(x.data(), pose.data());
  m.phasors().second(pose.data(), v.data(), v.data(), second.data());
  m.closures_of(second.data(), out.data());
  const Configuration<double> at{m.phasors(), pose.data(), pose.data() + m.phasors().pose_size()};
  for (std::size_t k = 0; k < coupled_.size(); ++k) {
    out[m.equalities() + static_cast<Eigen::Index>(k)] = coupled_[k].second(at, v.data(), v.data());
  }
  out.tail(out.size() - closures) =
      of_measures(x, [&](const Measured& g, const auto& here) { return g.second(here, v.data(), v.data()); });
  return out;
}

bool SplitClosure::close(VectorXd& x) const {
  VectorXd c = gap(x);
  double open = largest(c);
  for (int k = 0; k < 20 && open > 0.0 && !free_.empty(); ++k) {
    const VectorXd step =
        solvers::minimum_norm_solution<double>(free_columns(jacobian(x)), -c, solvers::known_to::path);
    if (!(largest(step) < 0.5)) return false;
    VectorXd next = x;
    for (std::size_t i = 0; i < free_.size(); ++i) next[free_[i]] += step[static_cast<Eigen::Index>(i)];
    c = gap(next);
    const double left = largest(c);
    // Newton converges quadratically down to rounding.
    if (left >= open && open <= closed_within) break;
    x = next;
    open = left;
  }
  return open <= closed_within;
}

// --- path -----------------------------------------------------------------------------------------------------------

DrivenPath::DrivenPath(const SplitClosure& closure, VectorXd direction)
    : closure_(closure), direction_(std::move(direction)) {}

void DrivenPath::measure(PathPose& pose, const MatrixXd& jacobian) const {
  if (closure_.free().empty()) return;
  const solvers::SingularValues svd = solvers::singular_value_decomposition(closure_.free_columns(jacobian));
  const Eigen::Index last = svd.values.size() - 1;
  pose.smallest = svd.values[last];
  pose.closeness = svd.values[last] / std::max(svd.values[0], closure_.least_scale());
  pose.left = svd.left.col(last);
  pose.right = svd.right.col(last);
}

PathPose DrivenPath::differentiated(double at, VectorXd x) const {
  PathPose pose;
  pose.at = at;
  pose.x = std::move(x);
  const MatrixXd jacobian = closure_.jacobian(pose.x);
  measure(pose, jacobian);
  pose.v = VectorXd::Zero(pose.x.size());
  pose.a = pose.v;
  for (std::size_t k = 0; k < closure_.driven().size(); ++k) {
    pose.v[closure_.driven()[k]] = direction_[static_cast<Eigen::Index>(k)];
  }
  if (closure_.free().empty()) return pose;
  const solvers::LeastSquares<double> factors(closure_.free_columns(jacobian));
  const auto spread = [&](const VectorXd& of_free, VectorXd& out) {
    for (std::size_t i = 0; i < closure_.free().size(); ++i) {
      out[closure_.free()[i]] = of_free[static_cast<Eigen::Index>(i)];
    }
  };
  spread(factors.solve(-(jacobian * pose.v)), pose.v);
  spread(factors.solve(-closure_.curvature(pose.x, pose.v)), pose.a);
  return pose;
}

// Hermite polynomial of degree 5 through values, first and second derivatives of both poses.
PathPose DrivenPath::interpolated(const PathPose& from, const PathPose& to, double at) const {
  const double h = to.at - from.at;
  const double s = (at - from.at) / h;
  const VectorXd rise = to.x - from.x - h * from.v - 0.5 * h * h * from.a;
  const VectorXd slope = h * (to.v - from.v) - h * h * from.a;
  const VectorXd bend = h * h * (to.a - from.a);
  const VectorXd c3 = 10 * rise - 4 * slope + 0.5 * bend;
  const VectorXd c4 = -15 * rise + 7 * slope - bend;
  const VectorXd c5 = 6 * rise - 3 * slope + 0.5 * bend;
  PathPose pose;
  pose.at = at;
  pose.x = from.x + s * (h * from.v + s * (0.5 * h * h * from.a + s * (c3 + s * (c4 + s * c5))));
  pose.v = from.v + s * (h * from.a + s * (3 * c3 + s * (4 * c4 + s * 5 * c5)) / h);
  pose.a = from.a + s * (6 * c3 + s * (12 * c4 + s * 20 * c5)) / (h * h);
  return pose;
}

PathPose DrivenPath::sampled(const PathPose& from, const PathPose& to, double at) const {
  if (at == to.at) return to;
  PathPose limit = interpolated(from, to, at);
  VectorXd x = limit.x;
  // Near a singular pose closing would move x along the direction in which the closures are nearly flat.
  if (!closure_.close(x)) x = limit.x;
  PathPose pose = differentiated(at, std::move(x));
  if (pose.closeness >= singular_below) return pose;
  measure(limit, closure_.jacobian(limit.x));
  return limit;
}

// The pose between a and c where the free columns lose rank, if they do.
std::optional<PathPose> DrivenPath::crossing_between(const PathPose& a, const PathPose& b, const PathPose& c) const {
  const auto pose_at = [&](double at) {
    PathPose pose = at < b.at ? interpolated(a, b, at) : interpolated(b, c, at);
    measure(pose, closure_.jacobian(pose.x));
    return pose;
  };
  const ValueAt nearest = least_between([&](double at) { return pose_at(at).closeness; }, a.at, c.at, narrowest);
  PathPose pose = pose_at(nearest.at);
  if (pose.closeness > crossing_below) return std::nullopt;
  return pose;
}

// Follows the curve of closed poses z = (free x, t), t a coordinate like the others, to the turning point of t.
std::optional<PathPose> DrivenPath::turning_point(const PathPose& from) const {
  const Eigen::Index n = static_cast<Eigen::Index>(closure_.free().size());
  struct OnCurve {
    VectorXd x, tangent;
    double at;
  };
  const auto matrix = [&](const VectorXd& x) {
    const MatrixXd jacobian = closure_.jacobian(x);
    MatrixXd out(jacobian.rows(), n + 1);
    out.leftCols(n) = closure_.free_columns(jacobian);
    VectorXd along = VectorXd::Zero(x.size());
    for (std::size_t k = 0; k < closure_.driven().size(); ++k) {
      along[closure_.driven()[k]] = direction_[static_cast<Eigen::Index>(k)];
    }
    out.col(n) = jacobian * along;
    return out;
  };
  const auto tangent = [&](const VectorXd& x, const VectorXd& like) {
    const VectorXd t = solvers::singular_value_decomposition(matrix(x)).right.col(n);
    return VectorXd(t.dot(like) < 0 ? -t : t);
  };
  const auto shift = [&](OnCurve& z, const VectorXd& step) {
    for (Eigen::Index i = 0; i < n; ++i) z.x[closure_.free()[i]] += step[i];
    for (std::size_t k = 0; k < closure_.driven().size(); ++k) {
      z.x[closure_.driven()[k]] += step[n] * direction_[static_cast<Eigen::Index>(k)];
    }
    z.at += step[n];
  };
  OnCurve base{from.x, {}, from.at};
  base.tangent = tangent(base.x, VectorXd::Unit(n + 1, n));
  const auto point = [&](double s) {
    OnCurve z = base;
    shift(z, s * base.tangent);
    for (int k = 0; k < 8; ++k) {
      shift(z, solvers::minimum_norm_solution<double>(matrix(z.x), -closure_.gap(z.x), solvers::known_to::path));
    }
    z.tangent = tangent(z.x, base.tangent);
    return z;
  };
  solvers::Bracket bracket{0.0, 1e-7};
  OnCurve beyond = point(bracket.to);
  while (beyond.tangent[n] > 0.0) {
    bracket = {bracket.to, 2.0 * bracket.to};
    if (bracket.to > farthest_turning) return std::nullopt;
    beyond = point(bracket.to);
  }
  if (largest(closure_.gap(beyond.x)) > closed_within) return std::nullopt;
  solvers::bisect(
      bracket, [&](double s) { return point(s).tangent[n] > 0.0; },
      [](const solvers::Bracket& at) { return at.width() <= 1e-12; });
  OnCurve turning = point(bracket.from);
  PathPose pose = from;
  pose.at = turning.at;
  pose.x = turning.x;
  measure(pose, closure_.jacobian(pose.x));
  return pose;
}

// The first stop that is passed between two neighbouring poses. Those that hold their measure are closed in every pose,
// not in those that interpolate between poses.
std::optional<PathEnd> DrivenPath::stop_between(const PathPose& from, const PathPose& to) const {
  const auto rooms = [&](const VectorXd& x) {
    return stop_rooms(closure_.model(), {x.data(), static_cast<std::size_t>(x.size())});
  };
  const std::vector<StopRoom> begin = rooms(from.x), finish = rooms(to.x);
  std::optional<PathEnd> first;
  for (std::size_t s = 0; s < begin.size(); ++s) {
    if (closure_.model().scene().stops[s].holds() || begin[s].overrun() > StopRoom::rounding) continue;
    const auto overrun = [&](double at) { return rooms(interpolated(from, to, at).x)[s].overrun(); };
    double beyond = to.at;
    if (finish[s].overrun() <= StopRoom::rounding) {
      // It may be passed and returned from within the step.
      const double little = 1e-6 * (to.at - from.at);
      if (overrun(from.at + little) <= overrun(from.at) || overrun(to.at - little) <= overrun(to.at)) continue;
      beyond = least_between([&](double at) { return -overrun(at); }, from.at, to.at, narrowest).at;
      if (overrun(beyond) <= StopRoom::rounding) continue;
    }
    solvers::Bracket bracket{from.at, beyond};
    solvers::bisect(bracket, [&](double at) { return !(rooms(sampled(from, to, at).x)[s].overrun() > 0.0); });
    const double within = bracket.from;
    if (first && first->pose.at <= within) continue;
    PathPose pose = sampled(from, to, within);
    const bool at_max = rooms(pose.x)[s].at_max();
    first = PathEnd{std::move(pose), static_cast<int>(s), at_max};
  }
  return first;
}

std::optional<PathEnd> DrivenPath::follow(PathPose begin, const std::vector<double>& samples, const Visitor& visitor,
                                          int most_steps, const std::function<bool()>& stopped) const {
  std::size_t next_sample = 0;
  for (; next_sample < samples.size() && samples[next_sample] <= begin.at; ++next_sample) visitor.sample(begin);
  std::optional<PathPose> before;
  PathPose here = std::move(begin);
  double h = 1.0;
  int tried = 0;
  int overtime = 0;  // steps beyond the end, to detect a singular pose just before it
  while (here.at < end_of_way ||
         (before && here.closeness < before->closeness && here.closeness < 0.05 && overtime++ < 3)) {
    if (stopped()) return PathEnd{.pose = here};
    h = std::min(h, longest_move / largest(here.v));
    if (here.at < end_of_way) h = std::min(h, 1.0 - here.at);
    std::optional<PathPose> next;
    int around = 0;  // attempts to step across a singular pose instead of onto it
    while (!next) {
      if (tried++ == most_steps) return PathEnd{.pose = here, .out_of_steps = true};
      const VectorXd predicted = here.x + h * here.v + 0.5 * h * h * here.a;
      VectorXd x = predicted;
      for (const int d : closure_.driven()) x[d] = here.x[d] + h * here.v[d];
      const bool closed = closure_.close(x);
      double correction = largest(x - predicted);
      if (closed && correction <= longest_correction) {
        PathPose pose = differentiated(here.at + h, std::move(x));
        if (pose.closeness < singular_below && around++ < 6) {
          h *= 1.4;
          continue;
        }
        correction = std::max(correction, h * largest(pose.v - here.v - h * here.a));
        if (pose.closeness >= singular_below && correction <= longest_correction) next = std::move(pose);
      }
      if (next) {
        h *= std::clamp(0.9 * std::cbrt(longest_correction / std::max(correction, 1e-30)), 0.5, 2.0);
      } else {
        h *= 0.5;
        if (h * largest(direction_) < shortest_step) break;
      }
    }
    if (!next) {
      if (here.at >= end_of_way) break;
      std::optional<PathPose> turning = turning_point(here);
      return PathEnd{.pose = turning ? std::move(*turning) : here};
    }
    if (next->at >= end_of_way && next->at < 1.0) next->at = 1.0;
    std::optional<PathEnd> met;
    if (here.at < end_of_way) met = stop_between(here, *next);
    const double last = met ? met->pose.at : next->at;
    for (; next_sample < samples.size() && samples[next_sample] <= last; ++next_sample) {
      visitor.sample(sampled(here, *next, samples[next_sample]));
    }
    const bool dips = before && here.closeness <= before->closeness && here.closeness <= next->closeness;
    if (dips || !before) {
      const auto crossing = before ? crossing_between(*before, here, *next) : crossing_between(here, here, *next);
      if (crossing && crossing->at <= (met ? last : 1.0) + 1e-9) visitor.crossing(*crossing);
    }
    if (met) return met;
    before = std::exchange(here, std::move(*next));
  }
  return std::nullopt;
}

}  // namespace poise
