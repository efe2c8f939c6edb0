#include "statics/proof/private/smooth_piece.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numeric>
#include <optional>
#include <utility>

#include <Eigen/LU>
#include <fmt/format.h>

#include "solvers/linear_algebra.hpp"
#include "statics/model/singular_configuration.hpp"
#include "statics/proof/private/change_point.hpp"

namespace poise {
namespace {

// These numbers choose what is tried, in which order, and how far from the answer. What is proved is proved in ball
// arithmetic.

constexpr std::array dependence = {1e-5, 1e-9, 1e-12};  // pivots below which rows may repeat others
constexpr double nearly_neutral = 1e-5;                 // curvatures, relative to the largest, that may vanish
constexpr double narrow_bracket = 1e-17;
constexpr double no_finite_force = 1e6;  // times the loads
// Ways, rad or mechanism sizes, along which rows must repeat others.
constexpr double first_way = 1e-2;
constexpr double shortest_way = 1e-8;
constexpr double far_enough = 0.02;
constexpr double far_at_least = 1e-3;
constexpr int most_ways = 60;

// Columns that are combinations of others to within the tolerance. (One more column of size one, with a row of its own,
// keeps a matrix that is rounding only from counting as large.)
std::vector<int> dependent_columns(const Eigen::MatrixXd& columns, double tolerance) {
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(columns.rows() + 1, columns.cols() + 1);
  a.topLeftCorner(columns.rows(), columns.cols()) = columns;
  a(columns.rows(), columns.cols()) = 1.0;
  const auto [rank, order] = solvers::pivot_order<double>(a, tolerance);
  std::vector<int> out(order.begin() + rank, order.end());
  std::erase(out, static_cast<int>(columns.cols()));
  std::sort(out.begin(), out.end());
  return out;
}

KeptEquations without(KeptEquations kept, const std::vector<int>& dropped) {
  for (auto k = dropped.rbegin(); k != dropped.rend(); ++k) {
    kept.rows.erase(kept.rows.begin() + *k);
    kept.at_upper.erase(kept.at_upper.begin() + *k);
  }
  return kept;
}

}  // namespace

std::vector<Ball> midpoints(const std::vector<Ball>& balls) {
  std::vector<Ball> out;
  for (const Ball& b : balls) out.push_back(b.midpoint());
  return out;
}

std::vector<double> middles(const std::vector<Ball>& balls) {
  std::vector<double> out;
  for (const Ball& b : balls) out.push_back(b.middle());
  return out;
}

Eigen::VectorXd shares_in(const Eigen::MatrixXd& jacobian, const Eigen::RowVectorXd& row) {
  return solvers::minimum_norm_solution<double>(jacobian.transpose(), row.transpose());
}

TangentSpace::TangentSpace(const Mechanism<double>& mechanism, const Finding& finding)
    : x(middles(finding.solution.q)),
      point(mechanism, x, finding.kept.rows),
      basis(solvers::null_space(point.jacobian, solvers::known_to::closed_point)) {
  const std::vector<double> y = middles(finding.solution.y);
  const auto rows = static_cast<Eigen::Index>(y.size());
  hessian = basis.transpose() * point.tangent(Eigen::VectorXd::Map(y.data(), rows)) * basis;
}

// The closure of a constraint row.
int SmoothPiece::loop_of(int row) const {
  const std::vector<ConstraintBlock>& blocks = m().blocks();
  const auto after = std::upper_bound(blocks.begin(), blocks.end(), row,
                                      [](int r, const ConstraintBlock& block) { return r < block.first_row; });
  return std::prev(after)->closure;
}

BalanceSystem::Solution SmoothPiece::solve(const KeptEquations& kept, const std::vector<Ball>& from, double reach,
                                           double farthest, bool rounding) const {
  const std::optional<std::vector<Ball>> y = BalanceSystem(balls_, kept).multipliers(from);
  if (!y) return {};
  const BalanceSystem system(balls_, kept, rounding);
  Solution out = system.prove(from, *y, reach, farthest);
  // Uncertain numbers may move it farther than the box reaches.
  for (double wider = 100 * reach; (rounding || uncertain_) && !out.proved && wider < farthest; wider *= 100) {
    out = system.prove(from, *y, wider, farthest);
  }
  return out;
}

BalanceSystem::Solution SmoothPiece::solve_closely(const KeptEquations& kept, const std::vector<Ball>& from) const {
  Solution out;
  for (const long bits : {usual_bits, many_bits}) {
    const Ball::Precision precision(bits);
    for (const double reach : {first_reach, 1e-13, last_reach}) {
      out = solve(kept, from, reach, farthest_);
      if (out.proved) return out;
    }
  }
  return out;
}

std::vector<int> SmoothPiece::dependent_rows(const KeptEquations& kept, double tolerance) const {
  if (kept.rows.empty() || m().coordinates() > dense_limit) return {};
  const DensePoint<double> point(m(), x_, kept.rows);
  Eigen::MatrixXd columns = point.jacobian.transpose();
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    const double numbers = balls_.row_rounding[kept.rows[static_cast<std::size_t>(k)]] / half_unit;
    columns.col(k) /= std::max(numbers, half_unit);
  }
  const Eigen::Index closures =
      std::count_if(kept.rows.begin(), kept.rows.end(), [&](int row) { return row < m().equalities(); });
  std::vector<int> out = dependent_columns(columns.leftCols(closures), tolerance);
  if (closures == columns.cols()) return out;
  Eigen::MatrixXd independent(closures - static_cast<Eigen::Index>(out.size()), columns.rows());
  for (Eigen::Index k = 0, row = 0; k < closures; ++k) {
    if (!std::binary_search(out.begin(), out.end(), static_cast<int>(k))) {
      independent.row(row++) = columns.col(k).transpose();
    }
  }
  const Eigen::MatrixXd free = independent.rows() > 0
                                   ? solvers::null_space<double>(independent, solvers::known_to::rounding)
                                   : Eigen::MatrixXd::Identity(columns.rows(), columns.rows());
  const Eigen::MatrixXd stops = free.transpose() * columns.rightCols(columns.cols() - closures);
  for (const int k : dependent_columns(stops, tolerance)) out.push_back(static_cast<int>(closures) + k);
  return out;
}

KeptEquations SmoothPiece::without_stops(const KeptEquations& kept) const {
  KeptEquations out;
  for (const int row : kept.rows) {
    if (row < m().equalities()) out.rows.push_back(row);
  }
  out.at_upper.assign(out.rows.size(), 0);
  return out;
}

std::vector<int> SmoothPiece::free_coordinates(const KeptEquations& kept) const {
  std::vector<int> others;
  for (int i = 0; i < m().coordinates(); ++i) {
    if (std::find(kept.fixed.begin(), kept.fixed.end(), i) == kept.fixed.end()) others.push_back(i);
  }
  std::vector<int> out = kept.fixed;
  if (kept.rows.empty()) {
    out.insert(out.end(), others.begin(), others.end());
    return out;
  }
  const DensePoint<double> point(m(), x_, kept.rows);
  const auto [rank, order] = solvers::pivot_order<double>(point.jacobian(Eigen::all, others), nearly_dependent);
  for (auto k = order.begin() + rank; k != order.end(); ++k) out.push_back(others[static_cast<std::size_t>(*k)]);
  return out;
}

// Whether the rows of `all` that `kept` leaves out hold at a solution: with J_d = A J_k for dropped and kept rows,
// |c_d| <= r_d + |A| r_k, r being the rounding of each row.
SmoothPiece::Repeated SmoothPiece::repeated(const KeptEquations& kept, const std::vector<Ball>& at,
                                            const KeptEquations& all) const {
  Repeated out;
  const std::vector<Ball> none(all.rows.size());
  const std::vector<double> x = middles(at);
  const std::vector<Ball> value = BalanceSystem(balls_, all).residual(at, none);
  const std::vector<Ball> rounded = BalanceSystem(balls_, all, true).residual(midpoints(at), none);
  const std::size_t first = value.size() - all.rows.size();
  const DensePoint<double> whole(m(), x, all.rows);
  const DensePoint<double> part(m(), x, kept.rows);
  const auto rounding_of = [&](std::size_t r) {
    return std::max(rounded[first + r].radius(), balls_.row_rounding[all.rows[r]]);
  };
  Eigen::VectorXd kept_rounding(static_cast<Eigen::Index>(kept.rows.size()));
  std::vector<std::size_t> dropped;
  for (std::size_t k = 0, r = 0; r < all.rows.size(); ++r) {
    if (k < kept.rows.size() && kept.rows[k] == all.rows[r])
      kept_rounding[static_cast<Eigen::Index>(k++)] = rounding_of(r);
    else
      dropped.push_back(r);
  }
  for (const std::size_t r : dropped) {
    double allowed = rounding_of(r);
    Eigen::VectorXd share;
    if (!kept.rows.empty()) {
      share = shares_in(part.jacobian, whole.jacobian.row(static_cast<Eigen::Index>(r))).cwiseAbs();
      allowed += share.dot(kept_rounding);
    }
    const Ball& open = value[first + r];
    if (!(open.least() <= allowed)) return {};
    const bool holds = all.rows[r] >= m().equalities() || open.contains_zero();
    out.gaps.push_back(holds ? 0.0 : open.middle());
    if (holds) continue;
    out.loops.push_back(loop_of(all.rows[r]));
    for (std::size_t k = 0; k < kept.rows.size(); ++k) {
      const bool takes_part = share[static_cast<Eigen::Index>(k)] > solvers::known_to::closed_point;
      if (takes_part && kept.rows[k] < m().equalities()) out.loops.push_back(loop_of(kept.rows[k]));
    }
  }
  out.to_rounding = true;
  return out;
}

// Finds the repeated rows there and at other places of the mechanism, with the largest of the gaps and of their
// growths: only rows that repeat others hold at all of them. Closures must do so without stops, which may leave no
// motion in which they could fail.
SmoothPiece::Repeated SmoothPiece::repeated_everywhere(const Repeated& here, const KeptEquations& kept,
                                                       const Solution& at, const KeptEquations& all) const {
  const KeptEquations closures = without_stops(kept);
  const KeptEquations all_closures = without_stops(all);
  if (closures.rows.size() < kept.rows.size() && closures.rows.size() < all_closures.rows.size()) {
    const Repeated alone = repeated(closures, at.q, all_closures);
    if (!alone.to_rounding || !repeated_everywhere(alone, closures, at, all_closures).to_rounding) return {};
  }
  Repeated out = here;
  KeptEquations with_fixed = kept;
  with_fixed.fixed = free_coordinates(kept);
  const auto take = [&](const Repeated& rows, double way) {
    out.loops.insert(out.loops.end(), rows.loops.begin(), rows.loops.end());
    // A gap that grows with the motion is one of direction.
    for (std::size_t k = 0; k < rows.gaps.size(); ++k) {
      const double growth = (rows.gaps[k] - here.gaps[k]) / way;
      out.gaps[k] = std::max({std::abs(out.gaps[k]), std::abs(rows.gaps[k]), std::abs(growth)});
    }
  };
  int shown = 0;
  for (const double aside : {1e-3, -1e-2, 0.05}) {
    std::vector<Ball> from = midpoints(at.q);
    double sign = 1.0;
    for (const int i : with_fixed.fixed) {
      from[i] += Ball(aside * sign);
      sign *= -0.7;
    }
    const Solution there = solve(with_fixed, from, first_reach, 10 * std::abs(aside));
    if (!there.proved) continue;
    const Repeated rows = repeated(with_fixed, there.q, all);
    if (!rows.to_rounding) {
      // It may have led to poses of another kind, where the same bars cross.
      if (!repeated_along(with_fixed, at, all, take)) return {};
      shown = 1;
      break;
    }
    take(rows, aside);
    ++shown;
  }
  // Next to where rows lose rank nothing may be proved so far away at once.
  out.to_rounding = shown > 0 || repeated_along(with_fixed, at, all, take);
  return out;
}

// Whether rows that were left out hold all along a curve of poses through `at` in which the kept ones do, on which each
// of the fixed coordinates moves in turn: steps are as long as proofs that they stay on it allow, so that they grow
// with the distance from a pose in which rows lose rank. On it a row that is lost here only would be open.
bool SmoothPiece::repeated_along(const KeptEquations& with_fixed, const Solution& at, const KeptEquations& all,
                                 const TakeRepeated& take) const {
  const BalanceSystem system(balls_, with_fixed);
  std::vector<Ball> from = at.q;
  double before = 0.0;
  for (const int i : with_fixed.fixed) {
    std::vector<Ball> farthest = from;
    double farthest_way = 0.0;
    for (const double sign : {1.0, -1.0}) {
      std::vector<Ball> place = from;
      double way = 0.0;
      double step = first_way;
      for (int k = 0; k < most_ways && way < far_enough && step > shortest_way; ++k) {
        std::vector<double> change(place.size());
        change[static_cast<std::size_t>(i)] = sign * step;
        std::optional<std::vector<Ball>> next = system.follow(place, change);
        if (!next) {
          step /= 4;
          continue;
        }
        const Repeated rows = repeated(with_fixed, *next, all);
        if (!rows.to_rounding) return false;
        place = std::move(*next);
        way += step;
        take(rows, before + way);
        step *= 2;
      }
      if (way <= farthest_way) continue;
      farthest_way = way;
      farthest = std::move(place);
      if (way >= far_enough) break;
    }
    if (farthest_way < far_at_least) return false;
    from = std::move(farthest);
    before += farthest_way;
  }
  return true;
}

KeptEquations SmoothPiece::closures() const {
  KeptEquations out;
  out.rows.resize(static_cast<std::size_t>(m().equalities()));
  std::iota(out.rows.begin(), out.rows.end(), 0);
  out.at_upper.assign(out.rows.size(), 0);
  return out;
}

std::vector<double> SmoothPiece::open_loops() const {
  const KeptEquations all = closures();
  for (const double tolerance : dependence) {
    const std::vector<int> dropped = dependent_rows(all, tolerance);
    if (dropped.empty()) break;
    const KeptEquations kept = without(all, dropped);
    KeptEquations with_fixed = kept;
    with_fixed.fixed = free_coordinates(kept);
    const Solution at = solve(with_fixed, start_, first_reach, farthest_);
    if (!at.proved) continue;
    const Repeated here = repeated(kept, at.q, all);
    if (!here.to_rounding) continue;
    const Repeated everywhere = repeated_everywhere(here, kept, at, all);
    if (!everywhere.to_rounding) continue;
    const double widest = *std::max_element(everywhere.gaps.begin(), everywhere.gaps.end());
    if (widest == 0.0) return {};
    std::vector<double> out(m().closures(), 0.0);
    for (const int c : everywhere.loops) out[c] = widest;
    return out;
  }
  return {};
}

Finding SmoothPiece::examine(const KeptEquations& kept) const {
  // Equilibria of rows beside which the others hold here, but not everywhere.
  struct Alone {
    Finding finding;
    std::vector<int> dropped;
  };
  std::vector<Alone> alone;
  std::vector<int> last;
  for (const double tolerance : dependence) {
    const std::vector<int> dropped = dependent_rows(kept, tolerance);
    if (dropped.empty()) break;
    if (dropped == last) continue;
    last = dropped;
    Finding out = examine_independent(without(kept, dropped));
    if (out.kind == Finding::Kind::none) continue;
    const Repeated here = repeated(out.kept, out.solution.q, kept);
    if (!here.to_rounding) continue;
    if (!repeated_everywhere(here, out.kept, out.solution, kept).to_rounding) {
      alone.push_back({std::move(out), dropped});
      continue;
    }
    out.redundant = static_cast<int>(dropped.size());
    return out;
  }
  const bool nearly_singular = !last.empty();
  std::optional<Finding> undecided;
  for (Alone& rows : alone) {
    if (!examine_singular(rows.finding, kept, rows.dropped)) continue;
    if (rows.finding.degenerate != Stability::unknown) return rows.finding;
    // Beside the singular point itself more rows determine what they can.
    if (!undecided) undecided = std::move(rows.finding);
  }
  Finding out = examine_independent(kept);
  if (out.kind == Finding::Kind::none && undecided) return *undecided;
  if (out.kind == Finding::Kind::none && nearly_singular) {
    if (const std::optional<std::vector<double>> point = nearest_singular_point(m(), x_, kept.rows)) {
      const double distance =
          (Eigen::VectorXd::Map(point->data(), m().coordinates()) - Eigen::VectorXd::Map(x_.data(), m().coordinates()))
              .cwiseAbs()
              .maxCoeff();
      if (distance > first_reach && distance <= farthest_) {
        const SmoothPiece there(balls_, *point, farthest_, uncertain_);
        Finding found = there.examine(kept);
        if (found.kind != Finding::Kind::none) return found;
        out.least_joint_force = there.least_joint_force(kept);
      }
    }
    out.singular = true;
    out.least_joint_force = std::max(out.least_joint_force, least_joint_force(kept));
    out.why = "the closures nearly lose rank here, and no joint forces were found that balance the loads";
    if (out.least_joint_force > no_finite_force) {
      out.why = fmt::format("the closures lose rank here: only joint forces above {:.1g} times the loads could balance",
                            out.least_joint_force);
    }
  }
  return out;
}

int SmoothPiece::unstable_directions(const Solution& solution) const {
  return m().has_follower_loads() ? (solution.stiffness_sign < 0 ? 1 : 0) : solution.unstable;
}

Finding SmoothPiece::examine_independent(const KeptEquations& kept) const {
  Finding out;
  out.kept = kept;
  out.solution = solve(kept, start_, first_reach, farthest_);
  if (out.solution.proved)
    out.kind = Finding::Kind::regular;
  else
    examine_flat(out, kept);
  out.freedoms = m().coordinates() - static_cast<int>(kept.rows.size());
  if (out.kind == Finding::Kind::regular) out.unstable = unstable_directions(out.solution);
  return out;
}

// F + J^T y = 0 gives F.u = -y.(J u) for every u, so that max |y| >= |F.u| / sum_r |(J u)_r|: with u the part of F that
// the rows do not balance, a bound for all poses within first_reach of x.
double SmoothPiece::least_joint_force(const KeptEquations& kept) const {
  if (m().coordinates() > dense_limit || kept.rows.empty()) return 0.0;
  const DensePoint<double> point(m(), x_, kept.rows);
  const Eigen::MatrixXd z = solvers::null_space<double>(point.jacobian, solvers::known_to::path);
  const Eigen::VectorXd unbalanced = z * (z.transpose() * point.force);
  const std::vector<Ball> u(unbalanced.begin(), unbalanced.end());
  std::vector<Ball> box;
  for (const double x : x_) box.push_back(Ball(x).widened(first_reach));
  const BalanceSystem system(balls_, kept);
  const std::vector<Ball> force = system.forces(box, std::vector<Ball>(kept.rows.size()));
  Ball work(0);
  for (std::size_t i = 0; i < u.size(); ++i) work += force[i] * u[i];
  Ball rate(0);
  for (const Ball& r : system.rates(box, u)) rate += abs(r);
  const double greatest = rate.greatest();
  return greatest > 0.0 ? work.least() / greatest : 0.0;
}

// At a configuration where the closures lose rank, with an equilibrium of the kept rows alone. False where they do not.
bool SmoothPiece::examine_singular(Finding& finding, const KeptEquations& all, const std::vector<int>& dropped) const {
  finding.kind = Finding::Kind::degenerate;
  finding.degenerate = Stability::unknown;
  finding.singular = true;
  finding.why = "the closures lose rank here (a change point)";
  const TangentSpace tangents(m(), finding);
  DensePoint<double> whole(m(), tangents.x, all.rows);
  const Eigen::MatrixXd without_rows = whole.tangent(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(all.rows.size())));
  const std::vector<Ball> value =
      BalanceSystem(balls_, all).residual(finding.solution.q, std::vector<Ball>(all.rows.size()));
  std::vector<LostRow> lost;
  for (const int row : dropped) {
    // With the multipliers that cancel its gradient.
    const Eigen::RowVectorXd gradient = whole.jacobian.row(row);
    const Eigen::VectorXd share =
        finding.kept.rows.empty() ? Eigen::VectorXd() : shares_in(tangents.point.jacobian, gradient);
    Eigen::VectorXd multipliers = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(all.rows.size()));
    multipliers[row] = 1.0;
    for (std::size_t k = 0, r = 0; k < finding.kept.rows.size(); ++k, ++r) {
      while (all.rows[r] != finding.kept.rows[k]) ++r;
      multipliers[static_cast<Eigen::Index>(r)] = -share[static_cast<Eigen::Index>(k)];
    }
    LostRow& out = lost.emplace_back();
    out.gradient = gradient * tangents.basis;
    out.second = tangents.basis.transpose() * (whole.tangent(multipliers) - without_rows) * tangents.basis;
    out.open = value[value.size() - all.rows.size() + static_cast<std::size_t>(row)].greatest();
  }
  const ChangePoint point = examine_change_point(tangents.hessian, lost);
  if (!point.loses_rank) return false;
  if (!m().has_follower_loads()) finding.degenerate = point.stability;
  finding.spread = point.spread;
  return true;
}

// Where curvatures nearly vanish.
void SmoothPiece::examine_flat(Finding& finding, const KeptEquations& kept) const {
  finding.why = "Newton's method did not converge to an equilibrium near the answer";
  if (m().coordinates() > dense_limit) return;
  const ReducedHessian reduced(m(), x_, kept.rows);
  if (reduced.matrix.size() == 0) return;
  const solvers::SingularValues spectrum = solvers::singular_value_decomposition(reduced.matrix);
  // Very soft directions are not neutral: those that vanish most clearly are tried first.
  Eigen::Index tried = 0;
  for (const double part : {1e-13, 1e-9, nearly_neutral}) {
    const double flat_below = part * std::max(1.0, reduced.largest);
    const auto flat = static_cast<Eigen::Index>(
        std::count_if(spectrum.values.begin(), spectrum.values.end(), [&](double v) { return v <= flat_below; }));
    if (flat == tried) continue;
    tried = flat;
    const Eigen::MatrixXd directions = reduced.basis * spectrum.right.rightCols(flat);
    const auto [rank, order] = solvers::pivot_order<double>(directions.transpose(), solvers::known_to::solution);
    KeptEquations with_fixed = kept;
    with_fixed.fixed.assign(order.begin(), order.begin() + std::min(rank, flat));
    finding.neutral = with_fixed.fixed;
    const Solution across = solve(with_fixed, start_, first_reach, farthest_);
    if (!across.proved || static_cast<Eigen::Index>(with_fixed.fixed.size()) != flat) continue;
    if (!is_neutral(with_fixed, directions, across)) continue;
    finding.kind = Finding::Kind::neutral;
    finding.kept = with_fixed;
    finding.solution = across;
    finding.unstable = across.unstable;
    return;
  }
  finding.solution = solve_closely(kept, start_);
  const std::vector<int> candidates = std::exchange(finding.neutral, {});
  if (finding.solution.proved) {
    finding.kind = Finding::Kind::regular;
    // If the scene's numbers do not determine the sign of the least curvature, the signs of the force on both sides may
    // still do.
    if (candidates.size() == 1 && !m().has_follower_loads()) {
      if (!solve(kept, midpoints(finding.solution.q), last_reach, farthest_, true).proved) {
        Finding sides = finding;
        bracket(sides, kept, candidates.front(), true);
        if (sides.degenerate != Stability::unknown) finding = sides;
      }
    }
    return;
  }
  const Ball::Precision precision(many_bits);
  if (candidates.size() == 1 && !m().has_follower_loads())
    bracket(finding, kept, candidates.front(), false);
  else if (candidates.size() > 1)
    finding.why = "several curvatures vanish here, and the equilibrium is not isolated to within rounding";
}

// Whether the fixed coordinates need no force, to within the rounding of the scene's numbers, where they are and some
// way from there. Along the directions, so that the closures stay on their branch.
bool SmoothPiece::is_neutral(const KeptEquations& with_fixed, const Eigen::MatrixXd& directions,
                             const Solution& at) const {
  const auto free_of_force = [&](const std::vector<Ball>& q) {
    const Solution near = solve(with_fixed, midpoints(q), first_reach, farthest_, true);
    if (!near.proved) return false;
    const std::vector<Ball> force = BalanceSystem(balls_, with_fixed, true).forces(near.q, near.y);
    return std::all_of(with_fixed.fixed.begin(), with_fixed.fixed.end(),
                       [&](int i) { return force[i].contains_zero(); });
  };
  if (!free_of_force(at.q)) return false;
  Eigen::VectorXd parts(directions.cols());
  for (Eigen::Index k = 0; k < parts.size(); ++k) parts[k] = k % 2 == 0 ? 1.0 : -0.8;
  const Eigen::VectorXd along = directions * directions(with_fixed.fixed, Eigen::all).fullPivLu().solve(parts);
  int shown = 0;
  for (const double aside : {1e-3, -1e-3, 0.02, -0.05, 0.2}) {
    std::vector<Ball> from = midpoints(at.q);
    for (std::size_t i = 0; i < from.size(); ++i) from[i] += Ball(aside * along[static_cast<Eigen::Index>(i)]);
    const Solution there = solve(with_fixed, from, first_reach, 20 * std::abs(aside));
    if (!there.proved) continue;
    if (!free_of_force(there.q)) return false;
    ++shown;
  }
  return shown >= 3;
}

// Along the curve of equilibria of all but one coordinate, dV/dx_i = F_i + (J^T y)_i: its signs at both ends of an
// interval prove a minimum or maximum of the energy between them.
void SmoothPiece::bracket(Finding& finding, const KeptEquations& kept, int coordinate, bool rounding) const {
  finding.why = "an equilibrium merges with another here, or vanishes: the numbers of the scene leave open which";
  KeptEquations with_fixed = kept;
  with_fixed.fixed = {coordinate};
  const Solution middle = solve(with_fixed, start_, first_reach, farthest_, rounding);
  if (!middle.proved) return;
  const BalanceSystem system(balls_, with_fixed, rounding);
  const std::vector<Ball> centre = midpoints(middle.q);
  const auto sign_at = [&](const Ball& value) {
    std::vector<Ball> from = centre;
    from[coordinate] = value;
    const Solution there = solve(with_fixed, from, first_reach, 0.1, rounding);
    if (!there.proved) return 0;
    const Ball force = system.forces(there.q, there.y)[coordinate];
    return force > Ball(0) ? 1 : force < Ball(0) ? -1 : 0;
  };
  for (double half = 1e-15; half <= 2 * farthest_; half *= 10) {
    Ball from = centre[coordinate] - Ball(half);
    Ball to = centre[coordinate] + Ball(half);
    const int before = sign_at(from);
    const int after = sign_at(to);
    if (before == 0 || after == 0) continue;
    std::vector<Ball> range = centre;
    range[coordinate] = range[coordinate].widened(half);
    if (before == after) {
      const Solution whole = solve(with_fixed, range, std::max(first_reach, 100 * half), 0.1, rounding);
      finding.excluded =
          finding.excluded || (whole.proved && !system.forces(whole.q, whole.y)[coordinate].contains_zero());
      continue;
    }
    for (int step = 0; step < 100; ++step) {
      const Ball middle_of = ((from + to) / Ball(2)).midpoint();
      const int sign = sign_at(middle_of);
      if (sign == 0) {
        // The force vanishes there: both ends move towards it.
        const Ball tenth = ((to - from) / Ball(20)).midpoint();
        if (sign_at(middle_of - tenth) != before || sign_at(middle_of + tenth) != after) break;
        from = middle_of - tenth;
        to = middle_of + tenth;
      } else {
        (sign == before ? from : to) = middle_of;
      }
      if ((to - from).greatest() < narrow_bracket) break;
    }
    range = centre;
    range[coordinate] = Ball::of_both(from, to);
    const Solution whole = solve(with_fixed, range, std::max(first_reach, 100 * half), 0.1, rounding);
    if (!whole.proved) return;
    finding.excluded = false;
    finding.kind = Finding::Kind::degenerate;
    finding.kept = kept;
    finding.solution = whole;
    finding.unstable = whole.unstable + (before < 0 ? 0 : 1);
    finding.degenerate = finding.unstable > 0 ? Stability::unstable : Stability::stable;
    return;
  }
}

}  // namespace poise
