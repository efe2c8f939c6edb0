#include "statics/model/mobility.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <random>
#include <string_view>

#include <Eigen/SparseCore>
#include <fmt/format.h>

#include "model/controllers.hpp"
#include "solvers/linear_algebra.hpp"
#include "solvers/newton.hpp"
#include "statics/bodies/sparse_least_squares.hpp"
#include "statics/model/curvature.hpp"
#include "statics/model/equilibrium_problem.hpp"
#include "statics/model/held_rows.hpp"
#include "statics/model/private/closure_rounding.hpp"

namespace poise {
namespace {

constexpr double reach_tolerance = 1e-9;
constexpr int dense_mobility_limit = 400;
// So far a mechanism is moved to see whether its freedoms are finite, rad or sizes. Where its loops open as the k-th
// power of the distance they look closed within closed_in_place^(1/k): for k = 2 to 5 much nearer.
constexpr double finite_step = 0.05;
constexpr double closed_in_place = 1e-13;
// Curvatures of the rows are known to this share of the largest: positions are closed to 1e-9.
constexpr double bends_for_certain = 1e-6;
constexpr int most_combinations = 100;

constexpr std::string_view asked_of_structures =
    "of a structure, poise loads and poise forces find the forces, poise equilibria --assemblies the assemblies";

// Bodies that move, but states of controllers.
int moving_bodies(const Scene& scene) {
  return static_cast<int>(scene.bodies.size() - 1 - bodies_of_states(scene).size());
}

// Coordinates of such states, which are none of the mechanism.
std::set<int> coordinates_of_states(const Scene& scene, const Layout& layout) {
  std::set<int> out;
  for (const int body : bodies_of_states(scene)) {
    const Link& link = layout.links[static_cast<std::size_t>(body)];
    out.insert(link.frame);
    for (const Arm& arm : link.arms) out.insert(arm.coordinate);
  }
  return out;
}

int gruebler_count(const Scene& scene) {
  int count = 3 * moving_bodies(scene);
  for (const Joint& joint : scene.joints) count -= joint.traits().constraints();
  for (const Stop& stop : scene.stops) count -= stop.couples() ? 1 : 0;
  return count;
}

// The largest gap of a loop or violation of a stop at x, in words and with its line in the scene file.
void find_widest_gap(const ScaledModel& model, Mobility& out) {
  const Mechanism<double>& m = model.mechanism();
  const Scene& scene = model.scene();
  std::vector<Planar<double>> pose(m.pose_size());
  std::vector<double> c(m.constraints());
  m.place(out.x.data(), pose.data());
  m.constraint(out.x.data(), pose.data(), c.data());
  const double in_units = model.scales().length / scene.units.length;
  double widest = 0.0;
  for (const ConstraintBlock& block : m.blocks()) {
    double wide = 0.0;
    for (int r = block.first_row; r < block.first_row + block.rows; ++r) wide = std::hypot(wide, c[r]);
    if (wide <= widest) continue;
    widest = wide;
    const Closure& closure = m.layout().closures[block.closure];
    out.gap_line = scene.joints[closure.joint].line;
    out.gap = fmt::format("the loop closed by joint \"{}\" remains open by {:.4g} {}", closure.name, wide * in_units,
                          scene.units.length_name);
  }
  for (int s = 0; s < m.stops(); ++s) {
    const double beyond = passed_by(m, s, c);
    if (beyond <= widest) continue;
    widest = beyond;
    const Stop& stop = scene.stops[s];
    const bool is_angle = stop.on.is_angle();
    out.gap_line = stop.line;
    out.gap =
        fmt::format("{} \"{}\" remains {} by {:.4g} {}", stop.family(), stop.name, stop.couples() ? "open" : "overrun",
                    is_angle ? beyond / scene.units.angle : beyond * in_units,
                    is_angle ? scene.units.angle_name : scene.units.length_name);
  }
  if (const std::string stops = stops_at_limits(model, out.x); !stops.empty()) out.gap += " while held by " + stops;
}

// Lengths between which the length of a sum of arms can be while its angles take any values; a travel is not bounded.
struct Reach {
  double shortest = 0.0, longest = 0.0;
};

Reach reach_of(const Mechanism<double>& m, const std::vector<Arm>& arms) {
  const PhasorSum<double> sum(m.phasors(), arms);
  double longest = norm(sum.constant());
  double total = longest;
  for (const auto& term : sum.terms()) {
    if (term.coordinate >= m.layout().angles) return {0.0, std::numeric_limits<double>::infinity()};
    longest = std::max(longest, norm(term.coefficient));
    total += norm(term.coefficient);
  }
  return {std::max(0.0, 2.0 * longest - total), total};
}

// The values that a measure can have in scaled units, whatever the loops and stops permit; unbounded if not known.
Reach range_of(const ScaledModel& model, const Measure& measure) {
  const double infinity = std::numeric_limits<double>::infinity();
  if (measure.kind != Measure::Kind::distance) return {-infinity, infinity};
  const Scene& scene = model.scene();
  const double per_length = model.scales().per_length();
  return reach_of(model.mechanism(), model.layout().path(measure.a.body, per_length * scene.local(measure.a),
                                                         measure.b.body, per_length * scene.local(measure.b)));
}

bool is_same(const Measure& a, const Measure& b) {
  if (a.kind != b.kind || a.kind == Measure::Kind::sum) return false;
  switch (a.kind) {
    case Measure::Kind::angle:
      return a.body_a == b.body_a && a.body_b == b.body_b;
    case Measure::Kind::travel:
      return a.joint == b.joint;
    case Measure::Kind::distance:
      return a.a == b.a && a.b == b.b;
    case Measure::Kind::x:
    case Measure::Kind::y:
      return a.b == b.b;
    default:
      return false;
  }
}

// Whether no pose at all can close the loops and keep the stops, as far as single loops and measures show: the longest
// arm of a loop must not be longer than all others together, and the ranges of stops on one measure must overlap.
bool is_impossible(const ScaledModel& model) {
  const Mechanism<double>& m = model.mechanism();
  for (const Closure& closure : m.layout().closures) {
    if (reach_of(m, closure.arms).shortest > reach_tolerance) return true;
  }
  const std::vector<Stop>& stops = model.scene().stops;
  for (std::size_t s = 0; s < stops.size(); ++s) {
    const Reach range = range_of(model, stops[s].on);
    double min = range.shortest - reach_tolerance;
    double max = range.longest + reach_tolerance;
    for (std::size_t other = 0; other < stops.size(); ++other) {
      if (other != s && !is_same(stops[s].on, stops[other].on)) continue;
      min = std::max(min, m.lower()[other]);
      max = std::min(max, m.upper()[other]);
    }
    if (min - max > reach_tolerance) return true;
  }
  return false;
}

// The rows of closures, and behind them those of couplings, which hold in every pose too.
std::vector<int> rows_of_mechanism(const ScaledModel& model) {
  const Mechanism<double>& m = model.mechanism();
  std::vector<int> rows(static_cast<std::size_t>(m.equalities()));
  std::iota(rows.begin(), rows.end(), 0);
  for (int s = 0; s < m.stops(); ++s) {
    if (model.scene().stops[static_cast<std::size_t>(s)].couples()) rows.push_back(m.stop_row(s));
  }
  return rows;
}

// The closures and couplings that own one of the dependent rows, of rows_of_mechanism().
template <class Repeats>
void name_redundant(const ScaledModel& model, const std::vector<int>& rows, Repeats repeats, Mobility& out) {
  const Mechanism<double>& m = model.mechanism();
  for (const ConstraintBlock& block : m.blocks()) {
    bool any = false;
    for (int r = block.first_row; r < block.first_row + block.rows; ++r) any = any || repeats(r);
    if (any) out.redundant.push_back(m.layout().closures[block.closure].name);
  }
  for (int k = m.equalities(); k < static_cast<int>(rows.size()); ++k) {
    if (repeats(k)) out.redundant.push_back(model.scene().stops[rows[k] - m.equalities()].name);
  }
}

// The Jacobian of the rows at x. Entries that the rounding of the scene's numbers may have caused count as zero: two
// pins of one unit in the last place apart hold no more than one.
Eigen::SparseMatrix<double> jacobian_of(const ScaledModel& model, const std::vector<int>& rows,
                                        const std::vector<double>& x) {
  const Mechanism<double>& m = model.mechanism();
  std::vector<int> place(static_cast<std::size_t>(m.constraints()), -1);
  for (std::size_t k = 0; k < rows.size(); ++k) place[rows[k]] = static_cast<int>(k);
  std::vector<Planar<double>> pose(m.pose_size());
  std::vector<double> values(m.jacobian_row().size());
  m.place(x.data(), pose.data());
  m.jacobian(pose.data(), values.data());
  const std::vector<double> rounding = row_rounding(model);
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(values.size());
  for (std::size_t e = 0; e < values.size(); ++e) {
    const int row = m.jacobian_row()[e];
    if (place[row] < 0 || std::abs(values[e]) <= rounding[row]) continue;
    entries.emplace_back(place[row], m.jacobian_column()[e], values[e]);
  }
  Eigen::SparseMatrix<double> jacobian(static_cast<int>(rows.size()), m.coordinates());
  jacobian.setFromTriplets(entries.begin(), entries.end());
  return jacobian;
}

// Redundant are closures with a row that is a combination of others: those with a component in the left null space of
// J.
void find_redundancy(const ScaledModel& model, const std::vector<int>& rows, Mobility& out) {
  if (rows.empty()) return;
  const int count = static_cast<int>(rows.size());
  const Eigen::SparseMatrix<double> jacobian = jacobian_of(model, rows, out.x);
  if (count > dense_mobility_limit) {
    const TouchedNullSpace repeats = SparseLeastSquares(jacobian).left_null_space();
    out.rank = count - repeats.dimension;
    name_redundant(
        model, rows, [&](int row) { return static_cast<bool>(repeats.touches[row]); }, out);
    return;
  }
  const Eigen::MatrixXd null =
      solvers::null_space(Eigen::MatrixXd(jacobian.transpose()), solvers::known_to::closed_point);
  out.rank = count - static_cast<int>(null.cols());
  name_redundant(
      model, rows, [&](int row) { return null.row(row).norm() > 1e-8; }, out);
}

// Whether  z^T (sum w_r c_r'') z  grows along all tangents z for some self-stress w: the combination of those of a
// basis is moved towards those that hold the tangent that is held least, until it holds all (a perceptron).
bool curvature_locks(const ScaledModel& model, const std::vector<int>& rows, const std::vector<double>& x,
                     const Eigen::MatrixXd& jacobian, const Eigen::MatrixXd& tangents) {
  const Eigen::MatrixXd stresses =
      solvers::null_space(Eigen::MatrixXd(jacobian.transpose()), solvers::known_to::closed_point);
  DensePoint<double> point(model.mechanism(), x, rows);
  const Eigen::MatrixXd without = point.tangent(Eigen::VectorXd::Zero(stresses.rows()));
  std::vector<Eigen::MatrixXd> bends;
  double largest = 0.0;
  for (Eigen::Index k = 0; k < stresses.cols(); ++k) {
    const Eigen::MatrixXd whole = point.tangent(stresses.col(k)) - without;
    bends.emplace_back(tangents.transpose() * (whole + whole.transpose()) * tangents / 2);
    largest = std::max(largest, bends.back().cwiseAbs().maxCoeff());
  }
  if (!(largest > bends_for_certain)) return false;
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(tangents.cols(), tangents.cols());
  for (const Eigen::MatrixXd& bend : bends) sum += bend.trace() / largest * bend;
  for (int turn = 0; turn < most_combinations; ++turn) {
    const solvers::SymmetricEigen eigen = solvers::symmetric_eigen(sum);
    if (eigen.values[0] > bends_for_certain * std::max(largest, eigen.values.cwiseAbs().maxCoeff())) return true;
    const Eigen::VectorXd loose = eigen.vectors.col(0);
    bool any = false;
    for (const Eigen::MatrixXd& bend : bends) {
      const double held = loose.dot(bend * loose) / largest;
      any = any || std::abs(held) > bends_for_certain;
      sum += held * bend;
    }
    if (!any) return false;
  }
  return false;
}

}  // namespace

Mobility analyse_mobility(const ScaledModel& model) {
  const Mechanism<double>& m = model.mechanism();
  const Layout& layout = model.layout();
  Mobility out;
  out.bodies = moving_bodies(model.scene());
  out.joints = static_cast<int>(model.scene().joints.size());
  out.gruebler = gruebler_count(model.scene());
  out.coordinates = m.coordinates();
  const std::vector<int> rows = rows_of_mechanism(model);
  out.closures = static_cast<int>(rows.size());

  const EquilibriumProblem problem(m);
  solvers::Newton newton(problem);
  const std::vector<double> start = model.start();
  const solvers::NewtonResult& closed = newton.close(start);
  out.x = closed.x;
  out.assembled = closed.end == solvers::NewtonEnd::converged && closed.constraint_error <= reach_tolerance;
  if (!out.assembled) {
    find_widest_gap(model, out);
    out.impossible = is_impossible(model);
  }
  find_redundancy(model, rows, out);
  for (int j : layout.redundant_angle) {
    out.redundant.push_back(model.scene().joints[j].name + " (angle)");
  }
  out.freedoms = out.coordinates - out.rank;

  const std::set<int> of_states = coordinates_of_states(model.scene(), layout);
  for (int i = 0; i < static_cast<int>(layout.coordinates.size()); ++i) {
    const Coordinate& c = layout.coordinates[i];
    if (of_states.contains(i)) continue;
    const char* kind = c.kind == Coordinate::Kind::angle ? "angle" : "length";
    (i < layout.kept ? out.kept : out.dropped).push_back(fmt::format("{} \"{}\": {}", kind, c.name, c.why()));
  }
  out.dropped.insert(out.dropped.end(), layout.dropped.begin(), layout.dropped.end());
  return out;
}

std::string to_string(Freedoms::By by) {
  switch (by) {
    case Freedoms::By::rank:
      return "rank";
    case Freedoms::By::curvature:
      return "curvature";
    case Freedoms::By::closing_beside:
      return "closing beside";
    case Freedoms::By::nothing:
      return "nothing";
  }
  return "";
}

Freedoms freedoms_at(const ScaledModel& model, const std::vector<double>& x, std::optional<int> repeating) {
  const std::vector<int> rows = rows_of_mechanism(model);
  const int coordinates = model.mechanism().coordinates(), closures = static_cast<int>(rows.size());
  const auto number_at = [&](const std::vector<double>& at) {
    if (rows.empty()) return coordinates;
    const Eigen::SparseMatrix<double> jacobian = jacobian_of(model, rows, at);
    if (closures > dense_mobility_limit) {
      return coordinates - closures + SparseLeastSquares(jacobian).left_null_space().dimension;
    }
    return static_cast<int>(solvers::null_space(Eigen::MatrixXd(jacobian), solvers::known_to::closed_point).cols());
  };
  Freedoms out;
  out.infinitesimal = repeating ? coordinates - closures + *repeating : number_at(x);
  if (out.infinitesimal == coordinates - closures || out.infinitesimal == 0) {
    out.finite = out.infinitesimal;
    out.by = Freedoms::By::rank;
    return out;
  }
  if (closures > dense_mobility_limit) return out;
  const Eigen::MatrixXd jacobian(jacobian_of(model, rows, x));
  const Eigen::MatrixXd tangents = solvers::null_space(jacobian, solvers::known_to::closed_point);
  if (curvature_locks(model, rows, x, jacobian, tangents)) {
    out.finite = 0;
    out.by = Freedoms::By::curvature;
    return out;
  }
  out.by = Freedoms::By::closing_beside;
  const EquilibriumProblem problem(model.mechanism());
  solvers::Newton newton(problem);
  std::minstd_rand random(1);
  std::normal_distribution<double> normal;
  int most = 0;
  for (int trial = 0; trial < 4 + 4 * out.infinitesimal && most < out.infinitesimal; ++trial) {
    const Eigen::VectorXd along = Eigen::VectorXd::NullaryExpr(tangents.cols(), [&] { return normal(random); });
    const Eigen::VectorXd step = finite_step * (tangents * along.normalized());
    std::vector<double> beside = x;
    for (std::size_t i = 0; i < x.size(); ++i) beside[i] += step[static_cast<Eigen::Index>(i)];
    const solvers::NewtonResult& closed = newton.close(beside);
    if (closed.end != solvers::NewtonEnd::converged || !(closed.constraint_error <= closed_in_place)) continue;
    double moved = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) moved = std::hypot(moved, closed.x[i] - x[i]);
    if (moved >= finite_step / 10) most = std::max(most, number_at(closed.x));
  }
  out.finite = std::min(most, out.infinitesimal);
  return out;
}

std::vector<double> close_loops(const ScaledModel& model) {
  Mobility mobility = analyse_mobility(model);
  expect_closed(model, mobility);
  return std::move(mobility.x);
}

void expect_closed(const ScaledModel& model, const Mobility& mobility) {
  if (mobility.assembled) return;
  const std::string place = where(model, mobility.gap_line);
  if (mobility.impossible) {
    throw InputError(
        fmt::format("{}cannot be assembled in any position: {}; check the lengths and stops", place, mobility.gap));
  }
  throw AssemblyError(fmt::format(
      "{}cannot be assembled from its start: {}; give a [start] nearer to a closed position, or check the lengths",
      place, mobility.gap));
}

void expect_movable(const ScaledModel& model) {
  if (model.mechanism().coordinates() > 0) return;
  throw InputError(
      fmt::format("{}nothing can move under load; expected a body that can turn or slide and carries a load, a weight "
                  "or a spring; {}",
                  where(model), asked_of_structures));
}

void expect_movable(const ScaledModel& model, const Mobility& mobility) {
  if (mobility.freedoms > 0) return;
  throw InputError(fmt::format(
      "{}no degree of freedom left: {} coordinates, {} independent closure equations, so that it is a structure; {}",
      where(model), mobility.coordinates, mobility.rank, asked_of_structures));
}

std::string where(const ScaledModel& model, int line) {
  if (line == 0 && model.scene().bodies.size() > 1) line = model.scene().bodies[1].line;
  return model.scene().file + (line > 0 ? fmt::format(":{}", line) : "") + ": mechanism: ";
}

}  // namespace poise
