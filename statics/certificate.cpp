#include "statics/certificate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "solvers/deadline.hpp"
#include "solvers/linear_algebra.hpp"
#include "solvers/nonnegative_least_squares.hpp"
#include "statics/balance_system.hpp"
#include "statics/closure_rounding.hpp"
#include "statics/curvature.hpp"
#include "statics/singular_configuration.hpp"

namespace poise {
namespace {

// These numbers choose what is tried, in which order, and how far from the answer. What is proved is proved in ball
// arithmetic. Change points and stability exactly at the limit of stops and springs are decided in double, with
// margins.

constexpr double touched = 1e-6;       // distance from its bound, rad or sizes, at which a stop may be active
constexpr double same_place = 1e-15;   // rad or sizes
constexpr double first_reach = 1e-10;  // of the box in which an equilibrium is proved to be the only one
constexpr double last_reach = 0x1p-50;
constexpr long usual_bits = 128;
constexpr long many_bits = 320;
constexpr std::array dependence = {1e-5, 1e-9, 1e-12};  // pivots below which rows may repeat others
constexpr double nearly_dependent = 1e-9;               // pivots of closure rows that may repeat others
constexpr double nearly_neutral = 1e-5;                 // curvatures, relative to the largest, that may vanish
constexpr double narrow_bracket = 1e-17;
constexpr int dense_limit = 400;   // coordinates up to which ranks and spectra are computed in double
constexpr int most_undecided = 4;  // stops and one-way springs whose state is undecided: 2^4 pieces
constexpr double largest_gap_by_rounding = 1e-6;
constexpr double infinity = std::numeric_limits<double>::infinity();

// An active stop and the side on which it acts.
struct ActiveStop {
  int stop;
  bool upper;
  bool both = false;  // it pushes either way: min = max, or by rounding no motion is possible between it and others
};

// What is proved for one set of active stops and one state of each one-way spring.
struct Finding {
  enum class Kind { none, regular, neutral, degenerate };
  Kind kind = Kind::none;
  BalanceSystem::Solution solution;
  KeptEquations kept;
  int unstable = 0;  // with follower loads 1 if the reduced stiffness has a negative determinant
  int freedoms = 0;
  std::vector<int> neutral;  // held coordinates
  int redundant = 0;
  bool singular = false;
  Stability degenerate = Stability::unknown;
  double spread = 0.0;
  std::string why;
  bool excluded = false;  // proved that there is no equilibrium near
};

class Certifier {
 public:
  Certifier(const StaticModel& model, const std::vector<double>& x, const CertificateOptions& options)
      : model_(model), options_(options), x_(x), balls_(&model.balls()) {}

  Certificate run() const;

 private:
  using Solution = BalanceSystem::Solution;

  Certificate deny(Outcome outcome, const std::string& why) const {
    Certificate out;
    out.outcome = outcome;
    out.statement = why;
    out.x = x_;
    return out;
  }

  // --- stops
  std::vector<double> stop_values() const;
  std::vector<ActiveStop> stops_in_contact() const;
  std::vector<ActiveStop> find_active_stops() const;
  KeptEquations equations(const std::vector<ActiveStop>& active) const;

  // --- one piece
  Finding examine(const KeptEquations& kept) const;
  Finding examine_independent(const KeptEquations& kept) const;
  int unstable_directions(const Solution& solution) const;
  Solution solve(const KeptEquations& kept, const std::vector<Ball>& from, double reach, double farthest,
                 bool rounding = false) const;
  Solution solve_closely(const KeptEquations& kept, const std::vector<Ball>& from) const;
  std::vector<int> dependent_rows(const KeptEquations& kept, double tolerance) const;
  std::vector<int> free_coordinates(const KeptEquations& kept) const;
  // Whether rows that were left out hold to within the rounding of the scene's numbers.
  struct Repeated {
    bool to_rounding = false;
    std::vector<int> loops;  // closures of which some hold to rounding only, and those that they depend on
  };
  Repeated repeated(const KeptEquations& kept, const Solution& at, const KeptEquations& all) const;
  Repeated repeated_elsewhere(const KeptEquations& kept, const Solution& at, const KeptEquations& all) const;
  std::optional<BallMechanism> loosened() const;
  void allow_for_rounding(Finding& finding, const std::vector<KeptEquations>& others) const;
  void examine_singular(Finding& finding, const KeptEquations& all, const std::vector<int>& dropped) const;
  void examine_flat(Finding& finding, const KeptEquations& kept) const;
  bool is_neutral(const KeptEquations& held, const Solution& at) const;
  void bracket(Finding& finding, const KeptEquations& kept, int coordinate, bool rounding) const;

  // --- all pieces
  struct Settled {
    Finding finding;
    std::vector<ActiveStop> active;
    bool consistent = false;  // no active stop pulls, none is overrun
  };
  Settled settle(std::vector<ActiveStop> active) const;
  Settled settle() const;
  double moved(const Settled& settled) const;
  std::vector<int> undecided_springs(const Finding& finding) const;
  BallMechanism with_springs(const std::vector<int>& springs, unsigned act) const;
  Certifier with(const BallMechanism& balls) const;
  Ball beyond(const std::vector<Ball>& constraints, int stop, bool upper) const;
  std::size_t row_of(const Finding& finding, const ActiveStop& a) const;
  std::optional<Ball> push_of(const Finding& finding, const ActiveStop& a) const;
  struct Sharing {
    std::vector<std::size_t> opposite;          // indices of active stops
    std::optional<std::size_t> first_relieved;  // of those on the same side, if the dependent stop pushes more and more
  };
  Sharing sharing(const Finding& finding, const std::vector<ActiveStop>& active, const ActiveStop& dependent) const;
  std::vector<ActiveStop> weak_stops(const Settled& settled) const;
  Certificate conclude_all() const;
  Certificate conclude(const Settled& settled) const;
  Certificate conclude_pieces(const std::vector<int>& springs) const;
  Certificate conclude_at_limit(const Settled& settled, const std::vector<int>& springs) const;
  Stability stability_on_cones(const Finding& loosest, const std::vector<int>& springs,
                               const std::vector<ActiveStop>& weak, bool& locked) const;
  Certificate report(const Finding& finding, const std::vector<ActiveStop>& active) const;
  // The closure of a constraint row.
  int loop_of(int row) const {
    const std::vector<ConstraintBlock>& blocks = m().blocks();
    const auto after = std::upper_bound(blocks.begin(), blocks.end(), row,
                                        [](int r, const ConstraintBlock& block) { return r < block.first_row; });
    return std::prev(after)->closure;
  }
  std::string name(int coordinate) const { return model_.layout().coordinates[coordinate].name; }

  std::vector<Ball> start() const { return {x_.begin(), x_.end()}; }

  // In double, with the laws of the present state of the one-way springs.
  const Mechanism<double>& m() const { return balls_->plain; }

  const StaticModel& model_;
  const CertificateOptions& options_;
  std::vector<double> x_;
  const BallMechanism* balls_;
  bool loose_ = false;  // some numbers of the mechanism are uncertain
};

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

// In double, at a solution: the tangents Z of the kept rows, and the Hessian of the Lagrangian on them.
struct TangentSpace {
  TangentSpace(const Mechanism<double>& mechanism, const Finding& finding)
      : x(middles(finding.solution.q)),
        point(mechanism, x, finding.kept.rows),
        basis(solvers::null_space(point.jacobian, solvers::known_to::closed_point)) {
    const std::vector<double> y = middles(finding.solution.y);
    const auto rows = static_cast<Eigen::Index>(y.size());
    hessian = basis.transpose() * point.tangent(Eigen::VectorXd::Map(y.data(), rows)) * basis;
  }

  std::vector<double> x;
  DensePoint<double> point;
  Eigen::MatrixXd basis;
  Eigen::MatrixXd hessian;
};

std::string in_words(double radius) {
  return (radius == 0.0 ? "0" : fmt::format("{:.1e}", radius)) + " (rad, or length over size)";
}

// "a, b, c and 4 more".
std::string first_of(const std::vector<std::string>& names) {
  constexpr std::size_t most = 6;
  const auto end = names.begin() + static_cast<std::ptrdiff_t>(std::min(most, names.size()));
  const std::string more = names.size() > most ? fmt::format(" and {} more", names.size() - most) : "";
  return fmt::format("{}{}", fmt::join(names.begin(), end, ", "), more);
}

double bound(const Mechanism<double>& m, int stop, bool upper) { return upper ? m.upper()[stop] : m.lower()[stop]; }

// --- stops ----------------------------------------------------------------------------------------------------------

KeptEquations Certifier::equations(const std::vector<ActiveStop>& active) const {
  KeptEquations out;
  for (int r = 0; r < m().equalities(); ++r) out.rows.push_back(r);
  out.at_upper.assign(out.rows.size(), 0);
  for (const ActiveStop& a : active) {
    out.rows.push_back(m().stop_row(a.stop));
    out.at_upper.push_back(a.upper ? 1 : 0);
  }
  return out;
}

std::vector<double> Certifier::stop_values() const {
  std::vector<Planar<double>> pose(m().pose_size());
  std::vector<double> c(m().constraints());
  m().place(x_.data(), pose.data());
  m().constraint(x_.data(), pose.data(), c.data());
  return {c.begin() + m().equalities(), c.end()};
}

// Those near a bound, min = max aside.
std::vector<ActiveStop> Certifier::stops_in_contact() const {
  std::vector<ActiveStop> out;
  if (m().stops() == 0) return out;
  const std::vector<double> g = stop_values();
  for (int s = 0; s < m().stops(); ++s) {
    if (m().lower()[s] == m().upper()[s]) continue;
    if (g[s] > m().upper()[s] - touched) out.push_back({.stop = s, .upper = true});
    if (g[s] < m().lower()[s] + touched) out.push_back({.stop = s, .upper = false});
  }
  return out;
}

// Those with min = max, and of the others those with a positive force in the non-negative least-squares solution
// of balance.
std::vector<ActiveStop> Certifier::find_active_stops() const {
  std::vector<ActiveStop> active;
  for (int s = 0; s < m().stops(); ++s) {
    if (m().lower()[s] == m().upper()[s]) active.push_back({.stop = s, .upper = true, .both = true});
  }
  const std::vector<ActiveStop> candidates = stops_in_contact();
  if (candidates.empty()) return active;
  if (m().coordinates() > dense_limit) {
    active.insert(active.end(), candidates.begin(), candidates.end());
    return active;
  }
  KeptEquations kept = equations(active);
  const std::size_t fixed = kept.rows.size();
  for (const ActiveStop& a : candidates) kept.rows.push_back(m().stop_row(a.stop));
  const DensePoint<double> point(m(), x_, kept.rows);
  const Eigen::MatrixXd z = solvers::null_space<double>(point.jacobian.topRows(static_cast<Eigen::Index>(fixed)),
                                                        solvers::known_to::closed_point);
  // Columns: Z^T of the direction in which a stop prevents motion.
  Eigen::MatrixXd prevents(z.cols(), static_cast<Eigen::Index>(candidates.size()));
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    const auto row = point.jacobian.row(static_cast<Eigen::Index>(fixed + k));
    Eigen::VectorXd a = z.transpose() * row.transpose();
    if (a.norm() <= solvers::known_to::solution * row.norm()) a.setZero();
    prevents.col(static_cast<Eigen::Index>(k)) = (candidates[k].upper ? 1.0 : -1.0) * a;
  }
  const Eigen::VectorXd force = solvers::nonnegative_least_squares(prevents, -(z.transpose() * point.force).eval());
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    if (force[static_cast<Eigen::Index>(k)] > 0.0) active.push_back(candidates[k]);
  }
  return active;
}

// --- one piece ------------------------------------------------------------------------------------------------------

BalanceSystem::Solution Certifier::solve(const KeptEquations& kept, const std::vector<Ball>& from, double reach,
                                         double farthest, bool rounding) const {
  const std::optional<std::vector<Ball>> y = BalanceSystem(*balls_, kept).multipliers(from);
  if (!y) return {};
  const BalanceSystem system(*balls_, kept, rounding);
  Solution out = system.prove(from, *y, reach, farthest);
  // Uncertain numbers may move it farther than the box reaches.
  for (double wider = 100 * reach; (rounding || loose_) && !out.proved && wider < farthest; wider *= 100) {
    out = system.prove(from, *y, wider, farthest);
  }
  return out;
}

// In smaller and smaller boxes, and to more and more digits.
BalanceSystem::Solution Certifier::solve_closely(const KeptEquations& kept, const std::vector<Ball>& from) const {
  Solution out;
  for (const long bits : {usual_bits, many_bits}) {
    const Ball::Precision precision(bits);
    for (const double reach : {first_reach, 1e-13, last_reach}) {
      out = solve(kept, from, reach, options_.farthest);
      if (out.proved) return out;
    }
  }
  return out;
}

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

// Indices into kept.rows of closures that are nearly combinations of other closures, and of stops that nothing moves
// that the closures and other stops leave free. Each row counts over the size of the numbers of its loop.
std::vector<int> Certifier::dependent_rows(const KeptEquations& kept, double tolerance) const {
  if (kept.rows.empty() || m().coordinates() > dense_limit) return {};
  const DensePoint<double> point(m(), x_, kept.rows);
  Eigen::MatrixXd columns = point.jacobian.transpose();
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    const double numbers = balls_->row_rounding[kept.rows[static_cast<std::size_t>(k)]] / half_unit;
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

KeptEquations without(KeptEquations kept, const std::vector<int>& dropped) {
  for (auto k = dropped.rbegin(); k != dropped.rend(); ++k) {
    kept.rows.erase(kept.rows.begin() + *k);
    kept.at_upper.erase(kept.at_upper.begin() + *k);
  }
  return kept;
}

// Coordinates that may be chosen freely while the kept rows determine the others.
std::vector<int> Certifier::free_coordinates(const KeptEquations& kept) const {
  if (kept.rows.empty()) {
    std::vector<int> all(m().coordinates());
    std::iota(all.begin(), all.end(), 0);
    return all;
  }
  const DensePoint<double> point(m(), x_, kept.rows);
  const auto [rank, order] = solvers::pivot_order<double>(point.jacobian, nearly_dependent);
  return {order.begin() + rank, order.end()};
}

// A with  J_r = A J  for a row J_r that is a combination of those of J.
Eigen::VectorXd shares_in(const Eigen::MatrixXd& jacobian, const Eigen::RowVectorXd& row) {
  return solvers::minimum_norm_solution<double>(jacobian.transpose(), row.transpose());
}

// Whether the rows of `all` that `kept` leaves out hold at a solution: with J_d = A J_k for dropped and kept rows,
// |c_d| <= r_d + |A| r_k, r being the rounding of each row.
Certifier::Repeated Certifier::repeated(const KeptEquations& kept, const Solution& at, const KeptEquations& all) const {
  Repeated out;
  const std::vector<Ball> none(all.rows.size());
  const std::vector<double> x = middles(at.q);
  const std::vector<Ball> value = BalanceSystem(*balls_, all).residual(at.q, none);
  const std::vector<Ball> rounded = BalanceSystem(*balls_, all, true).residual(midpoints(at.q), none);
  const std::size_t first = value.size() - all.rows.size();
  const DensePoint<double> whole(m(), x, all.rows);
  const DensePoint<double> part(m(), x, kept.rows);
  const auto rounding_of = [&](std::size_t r) {
    return std::max(rounded[first + r].radius(), balls_->row_rounding[all.rows[r]]);
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
    if (!(std::abs(open.middle()) <= allowed)) return {};
    if (all.rows[r] >= m().equalities() || open.contains_zero()) continue;
    out.loops.push_back(loop_of(all.rows[r]));
    for (std::size_t k = 0; k < kept.rows.size(); ++k) {
      const bool takes_part = share[static_cast<Eigen::Index>(k)] > solvers::known_to::closed_point;
      if (takes_part && kept.rows[k] < m().equalities()) out.loops.push_back(loop_of(kept.rows[k]));
    }
  }
  out.to_rounding = true;
  return out;
}

// The same at other places of the mechanism: only rows that repeat others hold there too.
Certifier::Repeated Certifier::repeated_elsewhere(const KeptEquations& kept, const Solution& at,
                                                  const KeptEquations& all) const {
  Repeated out;
  KeptEquations held = kept;
  held.held = free_coordinates(kept);
  int shown = 0;
  for (const double aside : {1e-3, -1e-2, 0.05}) {
    std::vector<Ball> from = midpoints(at.q);
    double sign = 1.0;
    for (const int i : held.held) {
      from[i] += Ball(aside * sign);
      sign *= -0.7;
    }
    const Solution there = solve(held, from, first_reach, 10 * std::abs(aside));
    if (!there.proved) continue;
    const Repeated rows = repeated(held, there, all);
    if (!rows.to_rounding) return {};
    out.loops.insert(out.loops.end(), rows.loops.begin(), rows.loops.end());
    ++shown;
  }
  out.to_rounding = shown > 0;
  return out;
}

// Closures that repeat others to rounding only: no pose closes all of them as they are written. What is said must be
// true whichever joints are left open, so that the numbers of their loops count as uncertain.
std::optional<BallMechanism> Certifier::loosened() const {
  constexpr double units = 4.0;  // of rounding; the gap of a joint is the sum of the roundings of several numbers
  const KeptEquations all = equations({});
  for (const double tolerance : dependence) {
    const std::vector<int> dropped = dependent_rows(all, tolerance);
    if (dropped.empty()) break;
    const KeptEquations kept = without(all, dropped);
    KeptEquations held = kept;
    held.held = free_coordinates(kept);
    const Solution at = solve(held, start(), first_reach, options_.farthest);
    if (!at.proved) continue;
    const Repeated here = repeated(kept, at, all);
    const Repeated elsewhere = repeated_elsewhere(kept, at, all);
    if (!here.to_rounding || !elsewhere.to_rounding) continue;
    if (here.loops.empty() && elsewhere.loops.empty()) return std::nullopt;
    Layout layout = model_.layout();
    layout.loosen(here.loops, units);
    layout.loosen(elsewhere.loops, units);
    return BallMechanism(model_, layout);
  }
  return std::nullopt;
}

// Rows of stops that repeat others to rounding only: what is said must be true whichever of them are left out.
void Certifier::allow_for_rounding(Finding& finding, const std::vector<KeptEquations>& others) const {
  Solution& solution = finding.solution;
  for (const KeptEquations& kept : others) {
    const Solution other = solve_closely(kept, midpoints(finding.solution.q));
    if (!other.proved || finding.kind == Finding::Kind::degenerate || unstable_directions(other) != finding.unstable) {
      finding.kind = Finding::Kind::none;
      finding.why =
          "stops repeat others only to within the rounding of the scene's numbers, and that rounding leaves open what "
          "equilibrium there is";
      return;
    }
    for (std::size_t i = 0; i < solution.q.size(); ++i) {
      solution.q[i] = Ball::of_both(solution.q[i], other.q[i]);
      solution.box[i] = Ball::of_both(solution.box[i], other.box[i]);
    }
  }
}

// With rows left out that repeat others to within some accuracy of x; with all of them if the others do not imply them.
Finding Certifier::examine(const KeptEquations& kept) const {
  std::vector<int> last;
  bool nearly_singular = false;
  std::optional<Finding> undecided;
  for (const double tolerance : dependence) {
    const std::vector<int> dropped = dependent_rows(kept, tolerance);
    if (dropped.empty()) break;
    if (dropped == last) continue;
    nearly_singular = true;
    last = dropped;
    Finding out = examine_independent(without(kept, dropped));
    if (out.kind == Finding::Kind::none) continue;
    if (!repeated(out.kept, out.solution, kept).to_rounding) continue;
    if (!repeated_elsewhere(out.kept, out.solution, kept).to_rounding) {
      examine_singular(out, kept, dropped);
      if (out.degenerate != Stability::unknown) return out;
      // Beside the singular point itself more rows determine what they can.
      if (!undecided) undecided = std::move(out);
      continue;
    }
    out.redundant = static_cast<int>(dropped.size());
    return out;
  }
  Finding out = examine_independent(kept);
  if (out.kind == Finding::Kind::none && undecided) return *undecided;
  if (out.kind == Finding::Kind::none && nearly_singular) {
    if (const std::optional<std::vector<double>> point = nearest_singular_point(m(), x_, kept.rows)) {
      const double distance =
          (Eigen::VectorXd::Map(point->data(), m().coordinates()) - Eigen::VectorXd::Map(x_.data(), m().coordinates()))
              .cwiseAbs()
              .maxCoeff();
      if (distance > first_reach && distance <= options_.farthest) {
        Certifier there = *this;
        there.x_ = *point;
        Finding found = there.examine(kept);
        if (found.kind != Finding::Kind::none) return found;
      }
    }
    out.singular = true;
    out.why = "the closures nearly lose rank here, and no joint forces were found that balance the loads";
  }
  return out;
}

int Certifier::unstable_directions(const Solution& solution) const {
  return m().has_follower_loads() ? (solution.stiffness_sign < 0 ? 1 : 0) : solution.unstable;
}

Finding Certifier::examine_independent(const KeptEquations& kept) const {
  Finding out;
  out.kept = kept;
  out.solution = solve(kept, start(), first_reach, options_.farthest);
  if (out.solution.proved)
    out.kind = Finding::Kind::regular;
  else
    examine_flat(out, kept);
  out.freedoms = m().coordinates() - static_cast<int>(kept.rows.size());
  if (out.kind == Finding::Kind::regular) out.unstable = unstable_directions(out.solution);
  return out;
}

// How far from a change point equilibria may lie whose row is open by so much there: across the branches a gap is the
// square of a distance, v^T T v = 2 open, and equilibria lie where  H v = lambda T v.
double beside_change_point(const Eigen::MatrixXd& h, const Eigen::MatrixXd& t, double open) {
  const double size = t.cwiseAbs().maxCoeff();
  double away = 4 * std::sqrt(open / size);
  const double shift = 0.7 * std::max(1.0, h.cwiseAbs().maxCoeff()) / size;
  const solvers::FullyPivotedLu shifted(h + shift * t);
  const solvers::Eigenpairs pairs = solvers::eigenpairs(shifted.solve(t));
  for (Eigen::Index k = 0; k < pairs.vectors.cols(); ++k) {
    const Eigen::VectorXd v = pairs.vectors.col(k).real();
    const double along = std::abs(v.dot(t * v)) / v.squaredNorm();
    // Along a branch energies of that order are not compared.
    if (along > 1e-6 * size) away = std::max(away, 1.5 * std::sqrt(2 * open / along));
  }
  return away;
}

// A configuration where the closures lose rank, with an equilibrium of the kept rows alone: the motions are those
// tangent to the set where a dropped row t vanishes to second order, z^T T z = 0 on the tangents z of the kept rows.
// The energy grows along all of them if H + nu T is positive definite for some nu, and not if for one dropped row it is
// indefinite for all nu (Finsler's lemma).
void Certifier::examine_singular(Finding& finding, const KeptEquations& all, const std::vector<int>& dropped) const {
  finding.kind = Finding::Kind::degenerate;
  finding.degenerate = Stability::unknown;
  finding.singular = true;
  finding.why = "the closures lose rank here (a change point)";
  if (m().has_follower_loads() || m().coordinates() > dense_limit) return;
  const TangentSpace tangents(m(), finding);
  const Eigen::MatrixXd& z = tangents.basis;
  const Eigen::MatrixXd& h = tangents.hessian;
  if (h.size() == 0) {
    finding.degenerate = Stability::stable;
    return;
  }
  const double scale = std::max(1.0, h.cwiseAbs().maxCoeff());
  const auto least = [](const Eigen::MatrixXd& a) { return solvers::symmetric_eigenvalues<double>(a)[0]; };
  // T of each dropped row: its second derivatives, with the multipliers that cancel its gradient.
  DensePoint<double> whole(m(), tangents.x, all.rows);
  const Eigen::MatrixXd without_rows = whole.tangent(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(all.rows.size())));
  const std::vector<Ball> value =
      BalanceSystem(*balls_, all).residual(finding.solution.q, std::vector<Ball>(all.rows.size()));
  Eigen::MatrixXd t;
  double spread = 0.0;
  for (const int row : dropped) {
    const Eigen::RowVectorXd gradient = whole.jacobian.row(row);
    const Eigen::VectorXd share =
        finding.kept.rows.empty() ? Eigen::VectorXd() : shares_in(tangents.point.jacobian, gradient);
    Eigen::VectorXd multipliers = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(all.rows.size()));
    multipliers[row] = 1.0;
    for (std::size_t k = 0, r = 0; k < finding.kept.rows.size(); ++k, ++r) {
      while (all.rows[r] != finding.kept.rows[k]) ++r;
      multipliers[static_cast<Eigen::Index>(r)] = -share[static_cast<Eigen::Index>(k)];
    }
    t = z.transpose() * (whole.tangent(multipliers) - without_rows) * z;
    const double size = t.size() > 0 ? t.cwiseAbs().maxCoeff() : 0.0;
    if (size == 0.0) return;
    const double open = value[value.size() - all.rows.size() + static_cast<std::size_t>(row)].greatest();
    const double away = beside_change_point(h, t, open) + same_place;
    spread = std::max(spread, away);
    // The change point itself may be beside this one.
    if ((gradient * z).cwiseAbs().maxCoeff() > size * away) return;
  }
  finding.spread = spread;
  constexpr double margin = 1e-7;
  if (least(h) > margin * scale) finding.degenerate = Stability::stable;
  if (finding.degenerate == Stability::stable || dropped.size() != 1) return;
  const double size = t.cwiseAbs().maxCoeff();
  double from = -1e6 * scale / size;
  double to = -from;
  for (int k = 0; k < 200; ++k) {  // the least eigenvalue is concave in nu
    const double a = from + (to - from) / 3;
    const double b = to - (to - from) / 3;
    (least(h + a * t) < least(h + b * t) ? from : to) = least(h + a * t) < least(h + b * t) ? a : b;
  }
  const double best = least(h + (from + to) / 2 * t);
  const double near_best = scale + std::abs((from + to) / 2) * size;
  if (best > margin * near_best) finding.degenerate = Stability::stable;
  if (best < -margin * near_best) finding.degenerate = Stability::unstable;
}

// Where curvatures nearly vanish.
void Certifier::examine_flat(Finding& finding, const KeptEquations& kept) const {
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
    KeptEquations held = kept;
    held.held.assign(order.begin(), order.begin() + std::min(rank, flat));
    finding.neutral = held.held;
    const Solution across = solve(held, start(), first_reach, options_.farthest);
    if (!across.proved || static_cast<Eigen::Index>(held.held.size()) != flat || !is_neutral(held, across)) continue;
    finding.kind = Finding::Kind::neutral;
    finding.kept = held;
    finding.solution = across;
    finding.unstable = across.unstable;
    return;
  }
  finding.solution = solve_closely(kept, start());
  const std::vector<int> candidates = std::exchange(finding.neutral, {});
  if (finding.solution.proved) {
    finding.kind = Finding::Kind::regular;
    // If the scene's numbers do not determine the sign of the least curvature, the signs of the force on both sides may
    // still do.
    if (candidates.size() == 1 && !m().has_follower_loads()) {
      if (!solve(kept, midpoints(finding.solution.q), last_reach, options_.farthest, true).proved) {
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

// Whether the held coordinates need no force, to within the rounding of the scene's numbers, where they are and some
// way from there.
bool Certifier::is_neutral(const KeptEquations& held, const Solution& at) const {
  const auto free_of_force = [&](const std::vector<Ball>& q) {
    const Solution near = solve(held, midpoints(q), first_reach, options_.farthest, true);
    if (!near.proved) return false;
    const std::vector<Ball> force = BalanceSystem(*balls_, held, true).forces(near.q, near.y);
    return std::all_of(held.held.begin(), held.held.end(), [&](int i) { return force[i].contains_zero(); });
  };
  if (!free_of_force(at.q)) return false;
  int shown = 0;
  for (const double aside : {1e-3, -1e-3, 0.02, -0.05, 0.2}) {
    std::vector<Ball> from = midpoints(at.q);
    double part = 1.0;
    for (const int i : held.held) {
      from[i] += Ball(aside * part);
      part = part > 0.6 ? -0.8 * part : 1.0;
    }
    const Solution there = solve(held, from, first_reach, 20 * std::abs(aside));
    if (!there.proved) continue;
    if (!free_of_force(there.q)) return false;
    ++shown;
  }
  return shown >= 2;
}

// Along the curve of equilibria of all but one coordinate, dV/dx_i = F_i + (J^T y)_i: its signs at both ends of an
// interval prove a minimum or maximum of the energy between them.
void Certifier::bracket(Finding& finding, const KeptEquations& kept, int coordinate, bool rounding) const {
  finding.why = "an equilibrium merges with another here, or vanishes: the numbers of the scene leave open which";
  KeptEquations held = kept;
  held.held = {coordinate};
  const Solution middle = solve(held, start(), first_reach, options_.farthest, rounding);
  if (!middle.proved) return;
  const BalanceSystem system(*balls_, held, rounding);
  const std::vector<Ball> centre = midpoints(middle.q);
  const auto sign_at = [&](const Ball& value) {
    std::vector<Ball> from = centre;
    from[coordinate] = value;
    const Solution there = solve(held, from, first_reach, 0.1, rounding);
    if (!there.proved) return 0;
    const Ball force = system.forces(there.q, there.y)[coordinate];
    return force > Ball(0) ? 1 : force < Ball(0) ? -1 : 0;
  };
  for (double half = 1e-15; half <= 2 * options_.farthest; half *= 10) {
    Ball from = centre[coordinate] - Ball(half);
    Ball to = centre[coordinate] + Ball(half);
    const int before = sign_at(from);
    const int after = sign_at(to);
    if (before == 0 || after == 0) continue;
    std::vector<Ball> range = centre;
    range[coordinate] = range[coordinate].widened(half);
    if (before == after) {
      const Solution whole = solve(held, range, std::max(first_reach, 100 * half), 0.1, rounding);
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
    const Solution whole = solve(held, range, std::max(first_reach, 100 * half), 0.1, rounding);
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

// --- all pieces -----------------------------------------------------------------------------------------------------

Certificate Certifier::report(const Finding& f, const std::vector<ActiveStop>& active) const {
  if (f.kind == Finding::Kind::none) {
    Certificate out = deny(f.excluded ? Outcome::no_equilibrium : Outcome::not_proved, f.why);
    out.singular = f.singular;
    return out;
  }
  const std::vector<double>& open = balls_->row_rounding;
  const double widest_gap = open.empty() ? 0.0 : *std::max_element(open.begin(), open.end());
  if (widest_gap > largest_gap_by_rounding) {
    return deny(Outcome::not_proved,
                fmt::format("the numbers as written do not determine the mechanism: rounded to doubles they leave its "
                            "joints open by up to {:.1g} of its size",
                            widest_gap));
  }
  Certificate out;
  for (std::size_t i = 0; i < f.solution.q.size(); ++i) {
    const double middle = f.solution.q[i].middle();
    out.x.push_back(middle);
    const bool held = std::find(f.neutral.begin(), f.neutral.end(), static_cast<int>(i)) != f.neutral.end();
    if (!held) out.radius = std::max(out.radius, (f.solution.q[i] - Ball(middle)).greatest());
    out.moved = std::max(out.moved, std::abs(middle - x_[i]));
  }
  for (const ActiveStop& a : active) out.active_stops.push_back(a.stop);
  out.radius += f.spread;
  out.redundant = f.redundant;
  out.unstable_directions = f.unstable;
  out.neutral_directions = static_cast<int>(f.neutral.size());
  for (const int i : f.neutral) out.neutral_coordinates.push_back(name(i));
  out.locked = f.freedoms <= 0;
  // Effect of the rounding of the scene's numbers, to first order.
  if (f.solution.matrix && f.solution.matrix->regular()) {
    const BalanceSystem rounded(*balls_, f.kept, true);
    std::vector<Ball> residual = rounded.residual(midpoints(f.solution.q), midpoints(f.solution.y));
    for (Ball& r : residual) r = Ball(0).widened(r.radius());
    residual = f.solution.matrix->solve(std::move(residual));
    const std::size_t coordinates = residual.size() - f.kept.rows.size();
    for (std::size_t i = 0; i < coordinates; ++i) {
      out.rounding_effect = std::max(out.rounding_effect, residual[i].greatest());
    }
  }
  out.singular = f.singular;
  switch (f.kind) {
    case Finding::Kind::regular:
      out.outcome = Outcome::proved;
      out.stability = f.unstable > 0 ? Stability::unstable : Stability::stable;
      if (m().has_follower_loads() && f.freedoms > 1 && f.unstable == 0) out.stability = Stability::unknown;
      out.statement = "exactly one equilibrium within " + in_words(out.radius);
      break;
    case Finding::Kind::neutral:
      out.outcome = Outcome::neutral;
      out.stability = f.unstable > 0 ? Stability::unstable : Stability::neutral;
      out.statement = "equilibrium at any value of " + first_of(out.neutral_coordinates);
      if (out.neutral_coordinates.size() < out.x.size()) {
        out.statement += "; across these exactly one within " + in_words(out.radius);
      }
      break;
    default:
      out.outcome = Outcome::degenerate;
      out.stability = f.degenerate;
      out.statement =
          f.singular ? f.why + (f.degenerate == Stability::stable     ? ": the energy grows along every motion"
                                : f.degenerate == Stability::unstable ? ": the energy falls along one of the motions"
                                                                      : ", and its stability was not decided")
                     : fmt::format("a curvature vanishes within {}, where the energy has {}", in_words(out.radius),
                                   f.degenerate == Stability::stable ? "a minimum" : "no minimum");
      if (f.degenerate == Stability::unstable) out.unstable_directions = std::max(1, out.unstable_directions);
      break;
  }
  return out;
}

// One-way springs whose state is undecided somewhere in the box in which the solution is the only one; without a
// solution those near their free length.
std::vector<int> Certifier::undecided_springs(const Finding& finding) const {
  std::vector<int> one_way;
  for (int e = 0; e < m().elements(); ++e) {
    const auto* spring = std::get_if<LinearSpring>(&balls_->exact.law_of(e));
    if (spring != nullptr && spring->acts != LinearSpring::Acts::both) one_way.push_back(e);
  }
  if (one_way.empty()) return {};
  std::vector<Ball> box = start();
  const bool found = finding.kind != Finding::Kind::none;
  for (std::size_t i = 0; i < box.size(); ++i) {
    box[i] = found ? finding.solution.box[i] : box[i].widened(touched);
  }
  const std::vector<Ball> g = BalanceSystem(*balls_, finding.kept).measures(box);
  std::erase_if(one_way, [&](int e) {
    return !(g[e] - Ball(std::get<LinearSpring>(balls_->exact.law_of(e)).free_length)).contains_zero();
  });
  return one_way;
}

// The mechanism with some one-way springs replaced: by springs that act both ways, or by none.
BallMechanism Certifier::with_springs(const std::vector<int>& springs, unsigned act) const {
  BallMechanism piece = *balls_;
  for (std::size_t k = 0; k < springs.size(); ++k) {
    LinearSpring spring = std::get<LinearSpring>(piece.exact.law_of(springs[k]));
    spring.acts = LinearSpring::Acts::both;
    const Law law = (act >> k & 1U) != 0 ? Law(spring) : Law(ConstantForce{0.0});
    piece.exact.replace_law(springs[k], law);
    piece.rounded.replace_law(springs[k], law);
    piece.plain.replace_law(springs[k], law);
  }
  return piece;
}

Certifier Certifier::with(const BallMechanism& balls) const {
  Certifier out = *this;
  out.balls_ = &balls;
  return out;
}

// How far a stop is overrun at q.
Ball Certifier::beyond(const std::vector<Ball>& constraints, int stop, bool upper) const {
  const Ball& value = constraints[m().stop_row(stop)];
  return upper ? value - Ball(m().upper()[stop]) : Ball(m().lower()[stop]) - value;
}

// The force of an active stop, positive if it pushes; none if its row was left out.
std::optional<Ball> Certifier::push_of(const Finding& finding, const ActiveStop& a) const {
  const std::size_t row = row_of(finding, a);
  if (row == finding.kept.rows.size()) return std::nullopt;
  return a.upper ? finding.solution.y[row] : -finding.solution.y[row];
}

// Of an active stop among the kept rows.
std::size_t Certifier::row_of(const Finding& finding, const ActiveStop& a) const {
  const auto row = std::find(finding.kept.rows.begin(), finding.kept.rows.end(), m().stop_row(a.stop));
  return static_cast<std::size_t>(row - finding.kept.rows.begin());
}

// Of an active stop whose row is a combination of kept ones: the active stops that take part, on its own side and on
// the other one.
Certifier::Sharing Certifier::sharing(const Finding& finding, const std::vector<ActiveStop>& active,
                                      const ActiveStop& dependent) const {
  Sharing out;
  if (m().coordinates() > dense_limit || finding.kept.rows.empty()) return out;
  const std::vector<double> x = middles(finding.solution.q);
  const DensePoint<double> kept(m(), x, finding.kept.rows);
  const DensePoint<double> stop(m(), x, {m().stop_row(dependent.stop)});
  const Eigen::VectorXd share = shares_in(kept.jacobian, stop.jacobian.row(0));
  const double negligible = solvers::known_to::closed_point * share.cwiseAbs().maxCoeff();
  double least = infinity;
  for (std::size_t a = 0; a < active.size(); ++a) {
    const std::size_t row = row_of(finding, active[a]);
    if (row == finding.kept.rows.size()) continue;
    const double part = share[static_cast<Eigen::Index>(row)] * (active[a].upper == dependent.upper ? 1.0 : -1.0);
    if (std::abs(part) <= negligible) continue;
    if (active[a].both || dependent.both || part < 0) {
      out.opposite.push_back(a);
      continue;
    }
    const double relieved = push_of(finding, active[a])->middle() / part;
    if (relieved < least) out.first_relieved = a;
    least = std::min(least, relieved);
  }
  return out;
}

// Stops that would have to pull are left, those that are overrun become active, until neither is.
Certifier::Settled Certifier::settle(std::vector<ActiveStop> active) const {
  Settled out;
  for (int pass = 0; pass < 3 + 2 * m().stops(); ++pass) {
    out.finding = examine(equations(active));
    out.active = active;
    out.consistent = false;
    if (out.finding.kind == Finding::Kind::none || m().stops() == 0) {
      out.consistent = out.finding.kind != Finding::Kind::none;
      return out;
    }
    const std::vector<Ball> g = BalanceSystem(*balls_, out.finding.kept).constraints(out.finding.solution.q);
    // Active stops that depend on others or on closures hold to rounding. One that is overrun takes the place of one on
    // its side; where there is none no motion is possible between it and the others, and all of them push either way.
    std::optional<std::size_t> relieved;
    std::vector<KeptEquations> others;
    for (std::size_t k = 0; k < active.size() && !relieved; ++k) {
      const ActiveStop& a = active[k];
      const Ball over = beyond(g, a.stop, a.upper);
      if (push_of(out.finding, a) || !(a.both ? !over.contains_zero() : over > Ball(0))) continue;
      const Sharing shared = sharing(out.finding, active, a);
      relieved = shared.first_relieved;
      out.active[k].both = true;
      for (const std::size_t other : shared.opposite) {
        out.active[other].both = true;
        const std::size_t row = row_of(out.finding, active[other]);
        KeptEquations& exchanged = others.emplace_back(out.finding.kept);
        exchanged.rows[row] = m().stop_row(a.stop);
        exchanged.at_upper[row] = a.upper ? 1 : 0;
      }
    }
    if (relieved) {
      active.erase(active.begin() + static_cast<std::ptrdiff_t>(*relieved));
      continue;
    }
    allow_for_rounding(out.finding, others);
    if (out.finding.kind == Finding::Kind::none) return out;
    const auto pulls = std::find_if(out.active.begin(), out.active.end(), [&](const ActiveStop& a) {
      const std::optional<Ball> push = push_of(out.finding, a);
      return !a.both && push && *push < Ball(0);
    });
    if (pulls != out.active.end()) {
      active.erase(active.begin() + (pulls - out.active.begin()));
      continue;
    }
    std::optional<ActiveStop> overrun;
    for (int s = 0; s < m().stops() && !overrun; ++s) {
      for (const bool upper : {false, true}) {
        const bool known = std::any_of(active.begin(), active.end(), [&](const ActiveStop& a) {
          return a.stop == s && (a.upper == upper || a.both);
        });
        if (!known && std::isfinite(bound(m(), s, upper)) && beyond(g, s, upper) > Ball(0)) {
          overrun = ActiveStop{.stop = s, .upper = upper};
        }
      }
    }
    out.consistent = !overrun;
    if (!overrun) return out;
    active.push_back(*overrun);
  }
  out.consistent = false;
  return out;
}

// From the stops that seem to be active at the answer; where more are in contact, or that leads nowhere, from each set
// of those in contact: the nearest equilibrium counts, of two in the same place one that is
// stable and presses on its stops.
Certifier::Settled Certifier::settle() const {
  const std::vector<ActiveStop> likely = find_active_stops();
  Settled out = settle(likely);
  const std::vector<ActiveStop> contact = stops_in_contact();
  if (contact.empty() || contact.size() > most_undecided) return out;
  std::vector<ActiveStop> always;
  const auto rank = [&](const Settled& s) {
    return moved(s) + (s.finding.unstable > 0 || !weak_stops(s).empty() ? same_place : 0.0);
  };
  std::copy_if(likely.begin(), likely.end(), std::back_inserter(always), [](const ActiveStop& a) { return a.both; });
  if (out.consistent && out.active.size() == always.size() + contact.size()) return out;
  for (unsigned set = 0; set < 1U << contact.size(); ++set) {
    std::vector<ActiveStop> active = always;
    for (std::size_t k = 0; k < contact.size(); ++k) {
      if ((set >> k & 1U) != 0) active.push_back(contact[k]);
    }
    Settled other = settle(active);
    if (other.consistent && (!out.consistent || rank(other) < rank(out))) out = std::move(other);
  }
  return out;
}

// Largest distance of a coordinate of an equilibrium from the answer.
double Certifier::moved(const Settled& settled) const {
  double most = 0.0;
  for (std::size_t i = 0; i < x_.size(); ++i) {
    most = std::max(most, std::abs((settled.finding.solution.q[i] - Ball(x_[i])).middle()));
  }
  return most;
}

Certificate Certifier::run() const {
  if (!std::all_of(x_.begin(), x_.end(), [](double v) { return std::isfinite(v); })) {
    return deny(Outcome::not_proved, "a coordinate is not a finite number");
  }
  if (const std::optional<BallMechanism> loose = loosened()) {
    Certifier uncertain = with(*loose);
    uncertain.loose_ = true;
    return uncertain.conclude_all();
  }
  return conclude_all();
}

Certificate Certifier::conclude_all() const {
  Settled first = settle();
  std::vector<int> springs = undecided_springs(first.finding);
  if (!springs.empty() && first.finding.kind == Finding::Kind::regular) {
    // A smaller box may decide.
    Finding smaller = first.finding;
    smaller.solution = solve(smaller.kept, midpoints(smaller.solution.q), last_reach, options_.farthest);
    smaller.unstable = unstable_directions(smaller.solution);
    if (smaller.solution.proved && undecided_springs(smaller).empty()) {
      first.finding = std::move(smaller);
      springs.clear();
    }
  }
  if (springs.empty()) return conclude(first);
  if (springs.size() > most_undecided) {
    return deny(Outcome::not_proved, fmt::format("{} one-way springs are at their free length", springs.size()));
  }
  return conclude_pieces(springs);
}

// One-way springs at their free length: of the pieces of the mechanism, in which each of them acts or does not, those
// count whose solution is on their own side. At such a solution all is smooth. A solution exactly at the limit is
// examined from all sides.
Certificate Certifier::conclude_pieces(const std::vector<int>& springs) const {
  const Ball::Precision precision(many_bits);
  std::optional<Certificate> nearest;
  std::optional<Certificate> at_limit;
  std::string why = "no state of the one-way springs agrees with its own solution";
  for (unsigned act = 0; act < 1U << springs.size(); ++act) {
    const BallMechanism piece = with_springs(springs, act);
    const Certifier part = with(piece);
    const Settled settled = part.settle();
    if (!settled.consistent) {
      why = settled.finding.why;
      continue;
    }
    const std::vector<Ball> g = BalanceSystem(piece, settled.finding.kept).measures(settled.finding.solution.q);
    bool agrees = true;
    std::vector<int> decided, undecided;
    unsigned acting = 0;  // bits of the decided ones
    for (std::size_t k = 0; k < springs.size(); ++k) {
      const LinearSpring& spring = std::get<LinearSpring>(balls_->exact.law_of(springs[k]));
      const Ball over = g[springs[k]] - Ball(spring.free_length);
      const bool acts_above = spring.acts == LinearSpring::Acts::tension;
      const bool acts = (act >> k & 1U) != 0;
      const bool above = acts_above == acts;
      if (over.contains_zero()) {
        undecided.push_back(springs[k]);
      } else {
        acting |= (acts ? 1U : 0U) << decided.size();
        decided.push_back(springs[k]);
      }
      agrees = agrees && (above ? !(over < Ball(0)) : !(over > Ball(0)));
    }
    if (!agrees) continue;
    if (!undecided.empty()) {
      const BallMechanism known = with_springs(decided, acting);
      if (!at_limit) at_limit = with(known).conclude_at_limit(settled, undecided);
      continue;
    }
    Certificate found = part.conclude(settled);
    if (found.confirmed() && (!nearest || found.moved < nearest->moved)) nearest = std::move(found);
  }
  if (nearest && (!at_limit || !at_limit->confirmed() || nearest->moved < at_limit->moved)) return *nearest;
  if (at_limit) return *at_limit;
  return deny(Outcome::not_proved, why);
}

// Stops that are touched without force, to many digits, are examined from all sides.
Certificate Certifier::conclude(const Settled& settled) const {
  if (settled.finding.kind == Finding::Kind::none) return report(settled.finding, settled.active);
  if (!settled.consistent) {
    return deny(Outcome::no_equilibrium, "a stop would have to pull where it is in contact, and is overrun without it");
  }
  if (weak_stops(settled).empty()) return report(settled.finding, settled.active);
  if (Ball::bits() < many_bits) {
    const Ball::Precision precision(many_bits);
    return conclude(settle(settled.active));
  }
  return conclude_at_limit(settled, {});
}

// Stops in contact of which it is undecided whether they press, but for those that no motion leaves.
std::vector<ActiveStop> Certifier::weak_stops(const Settled& settled) const {
  std::vector<ActiveStop> out, strong;
  for (const ActiveStop& a : settled.active) {
    const std::optional<Ball> push = push_of(settled.finding, a);
    if (!push) continue;
    (a.both || !push->contains_zero() ? strong : out).push_back(a);
  }
  const std::vector<Ball> g = BalanceSystem(*balls_, settled.finding.kept).constraints(settled.finding.solution.q);
  for (int s = 0; s < m().stops(); ++s) {
    const bool known =
        std::any_of(settled.active.begin(), settled.active.end(), [&](const ActiveStop& a) { return a.stop == s; });
    for (const bool upper : {false, true}) {
      if (known || !std::isfinite(bound(m(), s, upper)) || !beyond(g, s, upper).contains_zero()) continue;
      out.push_back({.stop = s, .upper = upper});
    }
  }
  if (out.empty() || m().coordinates() > dense_limit) return out;
  const std::size_t before = dependent_rows(equations(strong), nearly_dependent).size();
  std::erase_if(out, [&](const ActiveStop& a) {
    std::vector<ActiveStop> with_it = strong;
    with_it.push_back(a);
    return dependent_rows(equations(with_it), nearly_dependent).size() > before;
  });
  return out;
}

// Where it is undecided whether a stop is active or a one-way spring acts, all combinations are examined.
Certificate Certifier::conclude_at_limit(const Settled& settled, const std::vector<int>& springs) const {
  const std::vector<ActiveStop> weak = weak_stops(settled);
  std::vector<ActiveStop> strong = settled.active;
  std::erase_if(strong, [&](const ActiveStop& a) {
    return std::any_of(weak.begin(), weak.end(), [&](const ActiveStop& w) { return w.stop == a.stop; });
  });
  if (weak.size() + springs.size() > most_undecided) {
    return deny(Outcome::not_proved, fmt::format("{} stops and one-way springs are exactly at the limit of acting",
                                                 weak.size() + springs.size()));
  }
  // Bits of `state` say which springs act and which stops are active.
  int falling = 0;
  bool same_orientation = true;
  std::optional<Finding> loosest, tightest;
  const unsigned states = 1U << (springs.size() + weak.size());
  for (unsigned state = 0; state < states; ++state) {
    std::vector<ActiveStop> now = strong;
    for (std::size_t k = 0; k < weak.size(); ++k) {
      if ((state >> (springs.size() + k) & 1U) != 0) now.push_back(weak[k]);
    }
    const BallMechanism mechanism = with_springs(springs, state);
    const Finding piece = with(mechanism).examine(equations(now));
    if (piece.kind == Finding::Kind::none || piece.kind == Finding::Kind::degenerate) {
      return deny(Outcome::not_proved, "a stop or one-way spring is exactly at the limit of acting, and " +
                                           (piece.why.empty() ? "one of its states was not proved" : piece.why));
    }
    falling += piece.unstable > 0 ? 1 : 0;
    if (state == 0) loosest = piece;
    if (state == states - 1) tightest = piece;
    same_orientation =
        same_orientation && piece.kind == Finding::Kind::regular && piece.unstable % 2 == loosest->unstable % 2;
  }
  Certificate out = report(*loosest, strong);
  out.strict = false;
  if (!out.confirmed()) return out;
  if (m().has_follower_loads()) {
    if (same_orientation) return out;
    return deny(Outcome::not_proved, "a stop or one-way spring is exactly at the limit of acting");
  }
  if (falling == 0) {
    if (loosest->kind == Finding::Kind::neutral) {
      out.stability = tightest->kind == Finding::Kind::neutral ? Stability::neutral : Stability::unknown;
    }
  } else {
    // With all springs acting and all stops active the energy is highest and motion least: if it falls then it falls. A
    // single limit leaves one of two opposite directions to the loosest piece.
    const bool falls = tightest->unstable > 0 || (weak.size() + springs.size() == 1 && loosest->unstable > 0);
    out.stability = falls ? Stability::unstable : stability_on_cones(*loosest, springs, weak, out.locked);
    out.unstable_directions = out.stability == Stability::unstable ? std::max(1, tightest->unstable) : 0;
  }
  if (!same_orientation || out.stability == Stability::unknown) out.outcome = Outcome::degenerate;
  if (out.outcome == Outcome::degenerate) {
    out.statement = "a stop or one-way spring is exactly at the limit of acting";
    out.statement += out.stability == Stability::stable     ? ": the energy grows on all sides"
                     : out.stability == Stability::unstable ? ": the energy falls on one side"
                                                            : ", and stability was not decided";
  }
  return out;
}

// Springs at their free length have no force, so for a motion v the energy changes by half of
//   q(v) = v^T H v + sum_k stiffness_k (a_k.v)^2 over the springs that v makes act,
// H being the reduced Hessian without them and a_k the gradient of a measure; stops leave the motions with a_s.v <= 0.
Stability Certifier::stability_on_cones(const Finding& loosest, const std::vector<int>& springs,
                                        const std::vector<ActiveStop>& weak, bool& locked) const {
  const BallMechanism slack = with_springs(springs, 0);
  TangentSpace tangents(slack.plain, loosest);
  const Eigen::MatrixXd& z = tangents.basis;
  const Eigen::MatrixXd& h = tangents.hessian;
  std::vector<Planar<double>>& pose = tangents.point.pose;
  const Eigen::Index d = z.cols();
  if (d == 0) return Stability::stable;
  std::vector<Eigen::VectorXd> acting;     // a_k times the root of the stiffness, positive where the spring acts
  std::vector<Eigen::VectorXd> forbidden;  // a_s
  for (const int e : springs) {
    const LinearSpring& spring = std::get<LinearSpring>(m().law_of(e));
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(m().coordinates());
    m().add_measure_gradient(e, pose.data(), gradient.data());
    const Eigen::VectorXd a = std::sqrt(spring.stiffness) * z.transpose() * gradient;
    acting.push_back(spring.acts == LinearSpring::Acts::tension ? a : Eigen::VectorXd(-a));
  }
  for (const ActiveStop& s : weak) {
    const DensePoint<double> stop(m(), tangents.x, {m().stop_row(s.stop)});
    const Eigen::VectorXd a = z.transpose() * stop.jacobian.row(0).transpose();
    forbidden.push_back(s.upper ? a : Eigen::VectorXd(-a));
  }
  double steepest = h.norm();
  for (const Eigen::VectorXd& a : acting) steepest += a.squaredNorm();
  const auto energy = [&](const Eigen::VectorXd& v) {
    for (const Eigen::VectorXd& a : forbidden) {
      if (a.dot(v) > 0.0) return infinity;
    }
    double q = v.dot(h * v);
    for (const Eigen::VectorXd& a : acting) q += std::pow(std::max(0.0, a.dot(v)), 2);
    return q;
  };
  constexpr double margin = 1e-9;
  double least = infinity;
  double between = 0.0;  // greatest decrease between two directions that were looked at
  if (d == 1) {
    for (const double way : {-1.0, 1.0}) least = std::min(least, energy(Eigen::VectorXd::Constant(1, way)));
  } else if (d == 2) {
    constexpr int directions = 7200;
    for (int k = 0; k < directions; ++k) {
      const double angle = 2 * M_PI * k / directions;
      least = std::min(least, energy(Eigen::Vector2d(std::cos(angle), std::sin(angle))));
    }
    between = 2 * steepest * M_PI / directions;
  } else {
    const solvers::SymmetricEigen eigen = solvers::symmetric_eigen(h);
    for (Eigen::Index k = 0; k < d; ++k) {
      for (const double way : {-1.0, 1.0}) least = std::min(least, energy(way * eigen.vectors.col(k)));
    }
    between = infinity;  // only a direction in which the energy falls is a proof
  }
  locked = d <= 2 && least == infinity;
  if (least < -margin * steepest) return Stability::unstable;
  return least > between + margin * steepest ? Stability::stable : Stability::unknown;
}

}  // namespace

std::string to_string(Outcome outcome) {
  switch (outcome) {
    case Outcome::proved:
      return "proved";
    case Outcome::neutral:
      return "neutral";
    case Outcome::degenerate:
      return "degenerate";
    case Outcome::no_equilibrium:
      return "no equilibrium near";
    case Outcome::not_proved:
      return "not proved";
  }
  return "not proved";
}

std::string to_string(Stability stability) {
  switch (stability) {
    case Stability::unknown:
      return "unknown";
    case Stability::stable:
      return "stable";
    case Stability::unstable:
      return "unstable";
    case Stability::neutral:
      return "neutral";
  }
  return "unknown";
}

Certificate certify(const StaticModel& model, const std::vector<double>& x, const CertificateOptions& options) {
  const Ball::Precision precision(usual_bits);
  const solvers::Deadline deadline(options.seconds);
  Certificate out = Certifier(model, x, options).run();
  out.out_of_time = !out.confirmed() && solvers::Deadline::passed();
  if (out.out_of_time) {
    out.outcome = Outcome::not_proved;
    out.statement = fmt::format("no proof within {:g} s", options.seconds);
  }
  return out;
}

}  // namespace poise
