#include "statics/friction/held.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include <Eigen/SVD>
#include <fmt/format.h>

#include "model/couplings.hpp"
#include "model/dependent_number.hpp"
#include "model/parameters.hpp"
#include "solvers/linear_program.hpp"
#include "solvers/root.hpp"
#include "statics/bodies/body_measures.hpp"
#include "statics/bodies/contact_loads.hpp"
#include "statics/friction/private/friction_problem.hpp"
#include "statics/model/static_numbers.hpp"

namespace poise {
namespace {

using Choice = FrictionProblem::Choice;
using ForcePart = FrictionProblem::Part;
using Row = FrictionProblem::Row;
using Side = FrictionProblem::Side;
using ProgramStatus = solvers::LinearProgramResult::Status;

constexpr int most_cases = 4000;          // linear programs of one search
constexpr double force_rounding = 1e-13;  // of forces over the unit of load
constexpr double unbalanced_load = 1e-9;  // of the load: no efforts balance it
constexpr double no_end = std::numeric_limits<double>::infinity();

/// Rows over w, v = particular + basis w.
struct ReducedRows {
  Eigen::MatrixXd rows;
  Eigen::VectorXd bounds;
};

ReducedRows reduced(const FrictionProblem& problem, const std::vector<Row>& rows) {
  const auto& [particular, basis, gap, residual] = problem.solutions();
  const auto count = static_cast<Eigen::Index>(rows.size());
  ReducedRows out{Eigen::MatrixXd::Zero(count, basis.cols()), Eigen::VectorXd(count)};
  for (Eigen::Index r = 0; r < count; ++r) {
    const Row& row = rows[static_cast<std::size_t>(r)];
    out.bounds[r] = row.bound.middle();
    for (const auto& [column, factor] : row.entries) {
      out.rows.row(r) += factor.middle() * basis.row(column);
      out.bounds[r] -= factor.middle() * particular[column];
    }
    // Of an effort that the load determines the basis has rounding, which is no direction. Rows with slack have that.
    if (!row.has_slack) out.rows.row(r) = (out.rows.row(r).array().abs() < 1e-14).select(0.0, out.rows.row(r));
  }
  return out;
}

/// A point with the most slack t <= 1 in all rows that may have some; t < 0 where there is none in the rows.
struct Slackest {
  bool solved = false;
  double slack = 0.0;
  Eigen::VectorXd v;
  Eigen::VectorXd multipliers;  ///< of the rows
};

Slackest slackest(const FrictionProblem& problem, const std::vector<Row>& rows) {
  const ReducedRows r = reduced(problem, rows);
  const Eigen::Index count = r.rows.rows(), n = r.rows.cols();
  solvers::LinearProgram program{Eigen::MatrixXd::Zero(count + 1, n + 1), Eigen::VectorXd(count + 1),
                                 Eigen::VectorXd::Unit(n + 1, n)};
  program.rows.topLeftCorner(count, n) = r.rows;
  program.bounds.head(count) = r.bounds;
  for (Eigen::Index i = 0; i < count; ++i) {
    program.rows(i, n) = rows[static_cast<std::size_t>(i)].has_slack ? 1.0 : 0.0;
  }
  program.rows(count, n) = 1.0;
  program.bounds[count] = 1.0;
  const solvers::LinearProgramResult result = solvers::solve(program);
  Slackest out;
  out.solved = result.status == ProgramStatus::optimal || result.status == ProgramStatus::infeasible;
  out.slack = -no_end;
  if (result.status == ProgramStatus::infeasible) out.multipliers = result.multipliers.head(count);
  if (result.status == ProgramStatus::optimal) {
    out.slack = result.x[n];
    out.v = problem.solutions().particular + problem.solutions().basis * result.x.head(n);
    out.multipliers = result.multipliers.head(count);
  }
  return out;
}

/// What slips by the multipliers of rows: the velocities of the bodies that they are have these rates at the joints. A
/// friction effort at its bound opposes the slip.
std::vector<Slip> slips_of(const FrictionProblem& problem, const std::vector<Row>& rows, const Eigen::VectorXd& z) {
  constexpr double none = 1e-9;
  std::vector<Slip> out;
  double largest = 0.0;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (rows[r].source >= 0) largest = std::max(largest, z[static_cast<Eigen::Index>(r)]);
  }
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (rows[r].source < 0 || z[static_cast<Eigen::Index>(r)] <= none * largest) continue;
    out.push_back({problem.rubbing_of(static_cast<std::size_t>(rows[r].source)), rows[r].sign < 0});
  }
  return out;
}

/// Where a case is to be divided: the source whose bound a point exceeds most; -1 where it exceeds none.
int most_exceeded(const FrictionProblem& problem, const Choice& choice, const Eigen::VectorXd& v, double factor) {
  int worst = -1;
  double most = 0.0;
  for (std::size_t s = 0; s < problem.sources().size(); ++s) {
    if (problem.divided(s, choice[s]).empty()) continue;
    const double over = std::abs(v[problem.sources()[s].effort]) - factor * problem.bound_at(s, v);
    if (worst < 0 || over > most) {
      worst = static_cast<int>(s);
      most = over;
    }
  }
  return worst;
}

/// Puts the parts of a case, one source divided, behind the others.
void divide(const FrictionProblem& problem, const Choice& choice, std::size_t source, std::vector<Choice>& cases) {
  for (const ForcePart& part : problem.divided(source, choice[source])) {
    cases.push_back(choice);
    cases.back()[source] = part;
  }
}

/// Proves that joint forces are bounded: that there are none with |u| = most, over the unit of load, nor more. Were
/// there some, those over their largest would be at most 1, with one that is 1 or -1, and satisfy the equations and the
/// rows of friction with a share s <= 1 / most of loads and constants. So each is maximised there, in all cases.
class BoundedForces {
 public:
  BoundedForces(const FrictionProblem& problem, double factor, double most)
      : problem_(problem), factor_(factor), most_(most) {
    const Eigen::Index n = problem.columns();
    Eigen::MatrixXd all(problem.matrix().rows(), n + 1);
    all.leftCols(n) = problem.matrix();
    all.col(n) = problem.load_over_unit();
    Eigen::JacobiSVD<Eigen::MatrixXd> svd(all, Eigen::ComputeFullV);
    svd.setThreshold(1e-11);
    basis_ = svd.matrixV().rightCols(n + 1 - svd.rank());
  }

  bool proved() {
    for (int column = 0; column < problem_.columns(); ++column) {
      for (const double sign : {1.0, -1.0}) {
        if (!below_one(column, sign)) return false;
      }
    }
    return true;
  }

 private:
  bool below_one(int column, double sign) {
    std::vector<Choice> cases = problem_.whole();
    while (!cases.empty()) {
      if (++count_ > most_cases) return false;
      const Choice choice = std::move(cases.back());
      cases.pop_back();
      const std::vector<Row> rows = problem_.rows(choice, factor_, Side::outer);
      const solvers::LinearProgramResult found = largest(column, sign, rows);
      if (found.status != ProgramStatus::optimal) return false;
      const auto of_rows = static_cast<Eigen::Index>(rows.size());
      if (problem_.proves_below_one(column, sign, found.multipliers.head(of_rows), rows, most_)) continue;
      const int source = most_exceeded(problem_, choice, basis_ * found.x, factor_);
      if (source < 0) return false;
      divide(problem_, choice, static_cast<std::size_t>(source), cases);
    }
    return true;
  }

  solvers::LinearProgramResult largest(int column, double sign, const std::vector<Row>& rows) const {
    const Eigen::Index n = problem_.columns(), count = static_cast<Eigen::Index>(rows.size());
    solvers::LinearProgram program{Eigen::MatrixXd::Zero(count + 2 * n + 2, basis_.cols()),
                                   Eigen::VectorXd::Zero(count + 2 * n + 2), sign * basis_.row(column).transpose()};
    for (Eigen::Index r = 0; r < count; ++r) {
      const Row& row = rows[static_cast<std::size_t>(r)];
      program.rows.row(r) = -row.bound.middle() * basis_.row(n);
      for (const auto& [at, value] : row.entries) program.rows.row(r) += value.middle() * basis_.row(at);
    }
    program.rows.middleRows(count, n) = basis_.topRows(n);
    program.rows.middleRows(count + n, n) = -basis_.topRows(n);
    program.bounds.segment(count, 2 * n).setOnes();
    program.rows.row(count + 2 * n) = basis_.row(n);
    program.bounds[count + 2 * n] = 1.0 / most_;
    program.rows.row(count + 2 * n + 1) = -basis_.row(n);
    return solvers::solve(program);
  }

  const FrictionProblem& problem_;
  double factor_, most_;
  Eigen::MatrixXd basis_;  // of u and s with A u + s load = 0
  int count_ = 0;
};

/// A bound of all joint forces, over the unit of load, that is proved; none where friction may jam under any force, or
/// forces are not determined.
std::optional<double> proved_bound(const FrictionProblem& problem, double factor) {
  for (const double most : {3.0, 30.0, 1e3, 1e5}) {
    if (BoundedForces(problem, factor, most).proved()) return most;
  }
  return std::nullopt;
}

/// The verdict on one problem with all bounds times a factor.
struct Decision {
  Holding verdict = Holding::not_decided;
  bool proved = false;
  Eigen::VectorXd v;        ///< where it is held
  Choice choice;            ///< in which inner rows it is
  std::vector<Slip> slips;  ///< where it is not: with bounds that were just great enough
  std::string why;
  bool exhausted = false;  ///< not decided for want of cases
};

/// The slackest point of inner rows.
struct Inside {
  Slackest point;
  Choice choice;
};

/// Climbs from a point to others with more slack: with inner rows of the directions at the point, then of those at the
/// slackest point in them, which has as much slack at least.
Inside ascended(const FrictionProblem& problem, Eigen::VectorXd v, double factor) {
  constexpr int most_steps = 12;
  Inside best;
  for (int step = 0; step < most_steps; ++step) {
    Choice choice = problem.choice_at(v);
    Slackest point = slackest(problem, problem.rows(choice, factor, Side::inner));
    if (!point.solved || point.v.size() == 0) break;
    const bool better = !best.point.solved || point.slack > best.point.slack;
    if (better) best = {std::move(point), std::move(choice)};
    if (!better || best.point.slack > 0.0) break;
    v = best.point.v;
  }
  return best;
}

/// `strictly`: held is proved with some slack.
Decision decide(const FrictionProblem& problem, double factor, bool prove, bool strictly = false) {
  Decision out;
  if (problem.solutions().gap > unbalanced_load) {
    out.verdict = Holding::slips;
    return out;
  }
  std::vector<Choice> cases = problem.whole();
  std::optional<double> most;  // bound of the forces, found where a case is refused
  bool all_proved = prove;
  double nearest = -no_end;
  Eigen::VectorXd nearest_v;
  for (int count = 0; !cases.empty(); ++count) {
    if (count == most_cases) {
      out.why = fmt::format("{} cases of the directions of joint forces do not decide it", most_cases);
      out.exhausted = true;
      return out;
    }
    const Choice choice = std::move(cases.back());
    cases.pop_back();
    const std::vector<Row> outer = problem.rows(choice, factor, Side::outer);
    const Slackest found = slackest(problem, outer);
    if (!found.solved) {
      out.why = "a linear program was not solved";
      return out;
    }
    if (all_proved && !most && found.slack < 0.0) {
      most = proved_bound(problem, factor);
      all_proved = most.has_value();
    }
    // What is refused without a proof must miss by more than rounding: forces may lie on the edge of two sectors.
    const bool is_refused = all_proved && found.slack < 0.0 ? problem.proves_none(found.multipliers, outer, *most)
                                                            : found.slack < -force_rounding;
    if (is_refused) {
      if (found.slack > nearest) {
        nearest = found.slack;
        nearest_v = found.v;
      }
      continue;
    }
    if (found.v.size() == 0) {
      all_proved = false;
      continue;
    }
    const Inside inside = ascended(problem, found.v, factor);
    if (inside.point.solved && inside.point.slack >= 0.0) {
      out.verdict = Holding::held;
      out.v = inside.point.v;
      out.choice = inside.choice;
      out.proved = prove && problem.proves_point(out.v, problem.rows(out.choice, factor, Side::inner), strictly);
      out.slips.clear();
      return out;
    }
    const int source = most_exceeded(problem, choice, found.v, factor);
    if (source < 0 && found.slack < -force_rounding) {
      all_proved = false;
      continue;
    }
    if (source < 0) {
      out.why = "it is at the edge of slipping, to within rounding";
      return out;
    }
    divide(problem, choice, static_cast<std::size_t>(source), cases);
  }
  if (nearest_v.size() > 0) {
    const Inside inside = ascended(problem, nearest_v, factor);
    if (inside.point.solved && inside.point.v.size() > 0) {
      out.slips = slips_of(problem, problem.rows(inside.choice, factor, Side::inner), inside.point.multipliers);
    }
  }
  out.verdict = Holding::slips;
  out.proved = all_proved;
  return out;
}

/// The least factor by bisection, and what is proved on both sides of it.
void find_factor(const FrictionProblem& problem, HeldPose& out) {
  constexpr double most = 0x1p40, least = 1e-13;
  // Where one search is in vain those near it are too, and take as long.
  bool exhausted = false;
  const auto is_held = [&](double k) {
    const Decision found = decide(problem, k, false);
    exhausted = exhausted || found.exhausted;
    return found.verdict == Holding::held;
  };
  double lower = 0.0, upper = 1.0;
  while (!is_held(upper)) {
    if (exhausted) return;
    lower = upper;
    upper *= 4.0;
    if (upper > most) {
      out.least_factor = no_end;
      out.slips = decide(problem, most, false).slips;
      return;
    }
  }
  solvers::Bracket bracket{lower, upper};
  solvers::bisect(
      bracket, [&](double k) { return !is_held(k); },
      [&](const solvers::Bracket& at) { return exhausted || at.width() <= 1e-14 * at.to || at.to <= least; });
  upper = bracket.to;
  out.least_factor = upper > least ? upper : 0.0;
  const Decision at = decide(problem, upper, false);
  if (at.verdict == Holding::held) {
    out.on_bodies = problem.forces_on_bodies(at.v);
    out.efforts.assign(problem.rubbings(), {});
    for (std::size_t s = 0; s < problem.sources().size(); ++s) {
      const double si = problem.unit() * problem.sources()[s].si;
      out.efforts[problem.rubbing_of(s)] = {at.v[problem.sources()[s].effort] * si, problem.bound_at(s, at.v) * si};
    }
  }
  if (out.least_factor == 0.0 || exhausted) return;
  for (double aside = 1e-11; aside < 1e-5 && !(out.factor_upper < no_end); aside *= 10) {
    if (decide(problem, upper * (1 + aside), true).proved) out.factor_upper = upper * (1 + aside);
  }
  for (double aside = 1e-11; aside < 1e-5 && !(out.factor_lower > 0.0); aside *= 10) {
    const Decision below = decide(problem, upper * (1 - aside), true);
    if (below.verdict != Holding::slips) continue;
    out.slips = below.slips;
    if (below.proved) out.factor_lower = upper * (1 - aside);
  }
}

/// The matrices are dense.
std::string why_too_large(const Scene& scene) {
  constexpr std::size_t most_bodies = 60;
  if (scene.bodies.size() <= most_bodies) return "";
  return fmt::format("the scene has {} bodies, of at most {} for friction that holds", scene.bodies.size(),
                     most_bodies);
}

/// Why friction that holds the pose cannot be asked for.
std::string why_not_asked(const StaticModel& model, const std::vector<double>& x) {
  const Scene& scene = model.scene();
  const std::vector<BodyPose<double>> poses = model.poses_from_anchor(x);
  for (const Rubbing& one : rubbing(scene)) {
    const RopeContact* const pulley = one.rope >= 0 ? untouched_pulley(scene, one.on, poses) : nullptr;
    if (pulley == nullptr) continue;
    return fmt::format("rope \"{}\" does not lie on its pulley {}, on which it is to rub",
                       scene.stops[static_cast<std::size_t>(one.rope)].name, scene.name_of(pulley->at));
  }
  int teeth = 0;
  for (std::size_t s = 0; s < scene.stops.size(); ++s) {
    const Stop& stop = scene.stops[s];
    if (loads_bearings(stop) && !contact_load(BodyForces(scene, poses), static_cast<int>(s))) {
      return fmt::format("no finite force of {} \"{}\" drives its follower in this position", stop.family(), stop.name);
    }
    teeth += separates(stop) ? 1 : 0;
  }
  constexpr int most_teeth = 6;  // 2^6 cases before any other
  if (teeth > most_teeth) {
    return fmt::format("the scene has {} gears and racks with a pressure angle, of at most {} for friction that holds",
                       teeth, most_teeth);
  }
  return why_too_large(scene);
}

HeldPose pose_of(const FrictionProblem& problem) {
  HeldPose out;
  const Decision now = decide(problem, 1.0, true);
  out.verdict = now.verdict;
  out.proved = now.proved;
  out.why = now.why;
  if (out.verdict != Holding::not_decided || !now.exhausted) find_factor(problem, out);
  return out;
}

/// All values of q for which the rows can be satisfied, in q_unit(), with points at both ends.
struct LoadReach {
  bool any = false, solved = true;
  double lower = 0.0, upper = 0.0;
  Eigen::VectorXd at_lower, at_upper;
  Eigen::VectorXd multipliers_lower, multipliers_upper;  ///< of the rows; of size 0 without end
};

/// The same with q between two values.
struct Span {
  double from = -no_end, to = no_end;
};

LoadReach reach(const FrictionProblem& problem, const std::vector<Row>& rows, const Span& span) {
  const ReducedRows r = reduced(problem, rows);
  const auto& solutions = problem.solutions();
  const Eigen::Index count = r.rows.rows(), n = r.rows.cols(), q = problem.columns();
  solvers::LinearProgram program{Eigen::MatrixXd::Zero(count + 2, n), Eigen::VectorXd(count + 2),
                                 solutions.basis.row(q).transpose()};
  program.rows.topRows(count) = r.rows;
  program.bounds.head(count) = r.bounds;
  for (Eigen::Index i = 0; i < count; ++i) {
    if (rows[static_cast<std::size_t>(i)].is_edge) program.bounds[i] += force_rounding;
  }
  constexpr double far = 1e30;           // no row at all
  constexpr double farthest_end = 1e12;  // q beyond which ends are those of rounding
  program.rows.row(count) = solutions.basis.row(q);
  program.bounds[count] = std::min(span.to, far) - solutions.particular[q];
  program.rows.row(count + 1) = -solutions.basis.row(q);
  program.bounds[count + 1] = solutions.particular[q] - std::max(span.from, -far);
  for (Eigen::Index i = count; i < count + 2; ++i) {
    if (std::abs(program.bounds[i]) < 0.5 * far) continue;
    program.rows.row(i).setZero();
    program.bounds[i] = 1.0;
  }
  LoadReach out;
  const auto end = [&](double sign, double& value, Eigen::VectorXd& at, Eigen::VectorXd& multipliers) {
    solvers::LinearProgram sided = program;
    sided.objective *= sign;
    const solvers::LinearProgramResult result = solvers::solve(sided);
    if (result.status == ProgramStatus::infeasible) return false;
    if (result.status == ProgramStatus::not_solved) out.solved = false;
    if (!out.solved) return false;
    at = solutions.particular + solutions.basis * result.x;
    value = at[q];
    Eigen::VectorXd ray;
    if (result.status != ProgramStatus::optimal) {
      ray = solutions.basis * result.ray;
    } else if (sign * value > farthest_end) {
      ray = at - solutions.particular;
      at = solutions.particular;
    } else {
      multipliers = result.multipliers.head(count);
      return true;
    }
    at += (1e6 / ray.cwiseAbs().maxCoeff()) * ray;
    value = sign * no_end;
    return true;
  };
  out.any = end(1.0, out.upper, out.at_upper, out.multipliers_upper) &&
            end(-1.0, out.lower, out.at_lower, out.multipliers_lower);
  return out;
}

/// Searches the values of q for which friction holds.
class RangeSearch {
 public:
  RangeSearch(const FrictionProblem& problem, Span span) : problem_(problem), span_(span) {}

  /// A connected part: from values proved possible, and values beyond which none are.
  struct Part {
    double inner_lower = 0.0, inner_upper = 0.0;
    double outer_lower = 0.0, outer_upper = 0.0;
    std::vector<Slip> slips_lower, slips_upper;
  };

  /// The part that q belongs to; none where no value of it is known. Sets why().
  std::optional<Part> run(double q) {
    for (Choice& choice : problem_.whole()) add(std::move(choice));
    for (int count = 0; count < most_cases; ++count) {
      const Part now = part_of(q);
      const int next = farthest(now);
      if (next < 0 || !why_.empty()) break;
      const Node node = nodes_[static_cast<std::size_t>(next)];
      nodes_.erase(nodes_.begin() + next);
      divide(node, now);
    }
    if (!why_.empty()) return std::nullopt;
    return part_of(q);
  }
  const std::string& why() const { return why_; }
  /// The part that q belongs to, by what is known.
  Part part_of(double q) const {
    Part out{q, q, q, q, {}, {}};
    for (bool grew = true; grew;) {
      grew = false;
      for (const Inner& one : inner_) {
        if (one.lower > out.inner_upper + tolerance(out.inner_upper) ||
            one.upper < out.inner_lower - tolerance(out.inner_lower)) {
          continue;
        }
        if (one.upper >= out.inner_upper) out.slips_upper = one.slips_upper;
        if (one.lower <= out.inner_lower) out.slips_lower = one.slips_lower;
        grew = grew || one.lower < out.inner_lower || one.upper > out.inner_upper;
        out.inner_lower = std::min(out.inner_lower, one.lower);
        out.inner_upper = std::max(out.inner_upper, one.upper);
      }
    }
    out.outer_lower = out.inner_lower;
    out.outer_upper = out.inner_upper;
    for (bool grew = true; grew;) {
      grew = false;
      for (const Node& node : nodes_) {
        const LoadReach& one = node.outer;
        if (one.lower > out.outer_upper + tolerance(out.outer_upper) ||
            one.upper < out.outer_lower - tolerance(out.outer_lower)) {
          continue;
        }
        grew = grew || one.lower < out.outer_lower || one.upper > out.outer_upper;
        out.outer_lower = std::min(out.outer_lower, one.lower);
        out.outer_upper = std::max(out.outer_upper, one.upper);
      }
    }
    return out;
  }
  /// Learns the values around one that is held, v, and on from them in one direction: what is possible with the
  /// directions at v, then with those at the end that this leads to, and so on.
  void add_inner(Eigen::VectorXd v, bool upwards) {
    double before = -no_end;
    for (int step = 0; step < 8; ++step) {
      const std::vector<Row> rows = problem_.rows(problem_.choice_at(v), 1.0, Side::inner);
      const LoadReach found = reach(problem_, rows, span_);
      if (!found.any) return;
      Inner& inner = inner_.emplace_back(Inner{found.lower, found.upper, {}, {}});
      if (found.multipliers_lower.size() > 0) inner.slips_lower = slips_of(problem_, rows, found.multipliers_lower);
      if (found.multipliers_upper.size() > 0) inner.slips_upper = slips_of(problem_, rows, found.multipliers_upper);
      const double end = upwards ? found.upper : -found.lower;
      if (!(end > before + 1e-15 * std::abs(before)) || std::isinf(end)) return;
      before = end;
      v = upwards ? found.at_upper : found.at_lower;
    }
  }

 private:
  struct Node {
    Choice choice;
    LoadReach outer;
  };
  struct Inner {
    double lower, upper;
    std::vector<Slip> slips_lower, slips_upper;
  };

  void add(Choice choice) {
    Node node{std::move(choice), {}};
    node.outer = reach(problem_, problem_.rows(node.choice, 1.0, Side::outer), span_);
    if (!node.outer.solved) why_ = "a linear program was not solved";
    if (!node.outer.any) return;
    add_inner(node.outer.at_upper, true);
    add_inner(node.outer.at_lower, false);
    nodes_.push_back(std::move(node));
  }

  static double tolerance(double at) { return 1e-13 * std::max(std::abs(at), 1e-3); }

  static double beyond(const Node& node, const Part& part) {
    const double above = node.outer.upper - part.inner_upper, below = part.inner_lower - node.outer.lower;
    const double up = std::isnan(above) ? 0.0 : above - tolerance(part.inner_upper);
    const double down = std::isnan(below) ? 0.0 : below - tolerance(part.inner_lower);
    return std::max(up, down);
  }

  bool is_divisible(const Node& node) const {
    for (std::size_t s = 0; s < problem_.sources().size(); ++s) {
      if (!problem_.divided(s, node.choice[s]).empty()) return true;
    }
    return false;
  }

  // The case of the outer part that goes farthest beyond what is known to be held.
  int farthest(const Part& part) const {
    int out = -1;
    double most = 0.0;
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
      const LoadReach& one = nodes_[n].outer;
      if (one.lower > part.outer_upper + tolerance(part.outer_upper) ||
          one.upper < part.outer_lower - tolerance(part.outer_lower)) {
        continue;
      }
      const double over = beyond(nodes_[n], part);
      if (over <= most || !is_divisible(nodes_[n])) continue;
      most = over;
      out = static_cast<int>(n);
    }
    return out;
  }

  void divide(const Node& node, const Part& part) {
    const bool up = node.outer.upper - part.inner_upper > tolerance(part.inner_upper);
    const int source = most_exceeded(problem_, node.choice, up ? node.outer.at_upper : node.outer.at_lower, 1.0);
    if (source < 0) return;
    const auto s = static_cast<std::size_t>(source);
    for (const FrictionProblem::Part& one : problem_.divided(s, node.choice[s])) {
      Choice choice = node.choice;
      choice[s] = one;
      add(std::move(choice));
    }
  }

  const FrictionProblem& problem_;
  Span span_;
  std::vector<Node> nodes_;
  std::vector<Inner> inner_;
  std::string why_;
};

/// A number, or all loads, that a range is sought of.
class Varied {
 public:
  Varied(const Scene& scene, const std::string& name) : scene_(scene) {
    const auto fail = [&](const std::string& what) { throw InputError(name + ": " + what); };
    if (name == "loads") {
      for (int f = 0; f < static_cast<int>(scene.forces.size()); ++f) places_.push_back({Owner::force, f});
      for (int t = 0; t < static_cast<int>(scene.torques.size()); ++t) places_.push_back({Owner::torque, t});
      if (places_.empty()) fail("the scene has no loads; expected a force or a torque, or name another number");
      present_ = 1.0;
      whole_.assign(places_.size(), 0.0);
      for (std::size_t i = 0; i < places_.size(); ++i) whole_[i] = value_at(scene, places_[i]).value_or(0.0);
      is_load_ = true;
      return;
    }
    const ParameterRow row = parameter(scene, name);
    check_is_free(scene, row);
    present_ = value_at(scene, row.place).value_or(0.0);
    if (row.place.owner == Owner::number) {
      named_ = name;
      add_followers(row, fail);
      return;
    }
    places_ = {row.place};
    span_.from = row.range == Range::finite ? -no_end : 0.0;
    add(effect_of(row, fail), fail);
  }

  double present() const { return present_; }
  const Span& span() const { return span_; }
  bool is_load() const { return is_load_; }
  bool is_force() const { return is_force_; }  ///< its size, along the direction that the scene gives it
  int grows() const { return grows_; }         ///< 1 or -1: bounds of friction grow with the number, or fall
  Scene at(double si) const {
    Scene out = scene_;
    if (!named_.empty()) set_value(out, named_, si);
    for (std::size_t i = 0; i < places_.size(); ++i)
      set_value_at(out, places_[i], whole_.empty() ? si : whole_[i] * si);
    return out;
  }

 private:
  /// What a number changes.
  struct Effect {
    bool is_load = false, is_force = false;
    int grows = 0;
  };

  template <class Fail>
  Effect effect_of(const ParameterRow& row, Fail fail) const {
    const auto item = static_cast<std::size_t>(row.place.item);
    const std::string_view key = row.path.parts[3];
    switch (row.place.owner) {
      case Owner::force:
        if (scene_.forces[item].line_of_action() == Vec2{}) {
          fail("expected a force with a direction, its vector is [0, 0]");
        }
        return {.is_load = true, .is_force = true};
      case Owner::torque:
      case Owner::scene:
      case Owner::body:
        return {.is_load = true};
      case Owner::element: {
        const Law& law = scene_.elements[item].law;
        if (const auto* friction = std::get_if<DryFriction>(&law)) {
          const bool falls = friction->falls != DryFriction::Falls::not_at_all;
          if (row.place.number == (falls ? 2 : 0)) return {.grows = 1};
        }
        if (stores_energy(law) && is_affine_in(law, row.place.number)) return {.is_load = true};
        fail("friction that holds is not affine in it; expected a load, a stiffness or a number of friction");
        break;
      }
      case Owner::joint:
        if (key.starts_with("friction.")) return {.grows = key == "friction.length" ? -1 : 1};
        break;
      case Owner::coupling:
        if (key.starts_with("friction.")) return {.grows = 1};
        break;
      default:
        break;
    }
    fail(
        "expected a number on which the places of the bodies do not depend: a load, a mass, a stiffness or a "
        "number of friction; give others with --set");
    return {};
  }

  template <class Fail>
  void add(const Effect& effect, Fail fail) {
    const bool is_other = (is_load_ && !effect.is_load) || (grows_ != 0 && grows_ != effect.grows);
    if (is_other) fail("it makes friction grow and something else change too; expected a number of one of both");
    is_load_ = effect.is_load;
    is_force_ = effect.is_force;
    grows_ = effect.grows;
  }

  /// What follows from a named number: all friction, which grows or falls with it, or all loads, affinely.
  template <class Fail>
  void add_followers(const ParameterRow& named, Fail fail) {
    const std::vector<int> degrees = dependent_degrees(scene_, named.place.item);
    const std::vector<double> slopes = dependents_by(scene_, named.place.item, named_values(scene_));
    const std::vector<ParameterRow> rows = parameter_table(scene_);
    int loads = 0;
    for (std::size_t k = 0; k < degrees.size(); ++k) {
      const DependentNumber& one = (*scene_.dependents)[k];
      if (degrees[k] == 0 || one.at.of == DependentPlace::Of::left_out || one.at.place.owner == Owner::number) continue;
      const auto row = std::find_if(rows.begin(), rows.end(),
                                    [&](const ParameterRow& other) { return other.place == one.at.place; });
      const bool is_component = one.at.of != DependentPlace::Of::row && one.at.of != DependentPlace::Of::force;
      const bool rubs = row != rows.end() && row->path.parts[3].starts_with("friction.");
      if (row == rows.end() || is_component || (!rubs && !acts_in_statics(scene_, row->place))) {
        if (is_component) fail(one.item + " follows from it, on which the places of the bodies depend");
        continue;
      }
      if (degrees[k] > 1) fail(fmt::format("{} = \"{}\" is not affine in it", one.item, one.text()));
      Effect effect = effect_of(*row, fail);
      effect.is_force = false;
      if (slopes[k] < 0.0) effect.grows = -effect.grows;
      add(effect, fail);
      loads += effect.is_load && one.at.of == DependentPlace::Of::row ? 1 : 0;
      // Where a number of friction is not negative.
      if (effect.grows != 0 && slopes[k] != 0.0) {
        const double value = value_at(scene_, row->place).value_or(0.0) / row->dimension.unit(scene_.units);
        const double zero = present_ - value / slopes[k];
        if (effect.grows > 0) span_.from = std::max(span_.from, zero);
        if (effect.grows < 0) span_.to = std::min(span_.to, zero);
      }
    }
    if (!is_load_ && grows_ == 0)
      fail("no load and no friction follows from it; expected a number that one follows from");
    if (loads > 1) fail("several loads and masses follow from it; vary one of these, with --set for the others");
  }

  const Scene& scene_;
  std::string named_;
  std::vector<ParameterPlace> places_;
  std::vector<double> whole_;
  double present_ = 0.0;
  Span span_;
  bool is_load_ = false;
  bool is_force_ = false;
  int grows_ = 0;
};

/// Half the distance on both sides of an end within which the two verdicts are proved, in the units of the number; 0
/// where they are not.
class RangeFinder {
 public:
  RangeFinder(const StaticModel& model, const std::vector<double>& x, const Varied& varied, Span span)
      : model_(model), x_(x), varied_(varied), span_(span) {}

  HeldRange run() {
    FrictionProblem problem(model_, x_);
    out_.present = varied_.present();
    out_.now = pose_of(problem);
    out_.contains_now = out_.now.verdict == Holding::held && span_.from <= out_.present && out_.present <= span_.to;
    if (varied_.is_load())
      find_loads(problem);
    else
      find_friction();
    return out_;
  }

 private:
  /// The load is  at 0 + p (slope): at two values of the number that lie apart as far as the load is large.
  void find_loads(FrictionProblem& problem) {
    const std::vector<Ball> present = problem.load();
    double apart = std::max(std::abs(varied_.present()), 1.0);
    std::vector<Ball> slope = slope_over(problem, apart);
    double steepest = 0.0, largest = 0.0;
    for (std::size_t i = 0; i < slope.size(); ++i) {
      steepest = std::max(steepest, std::abs(slope[i].middle()));
      largest = std::max(largest, std::abs(present[i].middle()));
    }
    if (!(steepest > 0.0)) {
      out_.why = "no load in this position depends on it";
      return;
    }
    if (largest > steepest * apart) slope = slope_over(problem, largest / steepest);
    const FrictionProblem at_present = problem;
    problem.set_slope(slope);
    const double unit = problem.q_unit();
    const Span span{(span_.from - out_.present) / unit, (span_.to - out_.present) / unit};
    out_.ideal = without_friction(problem);
    RangeSearch search(problem, span);
    double q = 0.0;
    const auto held_at = [&](double at) {
      FrictionProblem there = at_present;
      there.set_load(load_at(present, slope, out_.present + at * unit));
      Eigen::VectorXd v = decide(there, 1.0, false).v;
      if (v.size() > 0) {
        v.conservativeResize(problem.columns() + 1);
        v[problem.columns()] = at;
      }
      return v;
    };
    if (!out_.contains_now) {
      const std::optional<double> some = some_value(problem, span);
      if (!some) return;
      q = *some;
    }
    if (const Eigen::VectorXd v = held_at(q); v.size() > 0) {
      search.add_inner(v, true);
      search.add_inner(v, false);
    }
    std::optional<RangeSearch::Part> part = search.run(q);
    if (!part) {
      out_.why = search.why();
      return;
    }
    // The search ends where cases are too many. What is held just beyond an end tells more of the part.
    for (const bool up : {true, false}) {
      const auto end = [&] { return up ? part->inner_upper : part->inner_lower; };
      const double limit = up ? span.to : span.from;
      constexpr double least = 1e-12;
      double step = least;
      for (int round = 0; round < 100 && std::isfinite(end()) && end() != limit; ++round) {
        const double from = end(), by = step * std::max(std::abs(from), 1e-3);
        const Eigen::VectorXd v = held_at(up ? std::min(from + by, limit) : std::max(from - by, limit));
        if (v.size() > 0) {
          search.add_inner(v, up);
          part = search.part_of(q);
          step *= 4;
          if (end() == from) break;
        } else if (step > least) {
          step = std::max(least, step / 16);
        } else {
          break;
        }
      }
    }
    out_.any = true;
    set_end(out_.upper, part->inner_upper, part->outer_upper, span.to, unit, part->slips_upper, span_.to);
    set_end(out_.lower, part->inner_lower, part->outer_lower, span.from, unit, part->slips_lower, span_.from);
    prove_end(problem, present, slope, out_.upper, 1.0);
    prove_end(problem, present, slope, out_.lower, -1.0);
  }

  std::optional<double> without_friction(const FrictionProblem& problem) const {
    Eigen::MatrixXd all(problem.matrix().rows(), problem.columns() + 1);
    all.leftCols(problem.columns()) = problem.matrix();
    for (const FrictionProblem::Source& source : problem.sources()) all.col(source.effort).setZero();
    for (Eigen::Index i = 0; i < all.rows(); ++i) {
      all(i, problem.columns()) =
          problem.slope()[static_cast<std::size_t>(i)].middle() * problem.q_unit() / problem.unit();
    }
    Eigen::JacobiSVD<Eigen::MatrixXd> svd(all, Eigen::ComputeFullU | Eigen::ComputeFullV);
    svd.setThreshold(1e-11);
    const Eigen::VectorXd right = -problem.load_over_unit();
    const Eigen::VectorXd found = svd.solve(right);
    if ((all * found - right).cwiseAbs().maxCoeff() > unbalanced_load) return std::nullopt;
    const Eigen::MatrixXd free = svd.matrixV().rightCols(all.cols() - svd.rank());
    if (free.cols() > 0 && free.row(problem.columns()).cwiseAbs().maxCoeff() > unbalanced_load) return std::nullopt;
    const double ideal = out_.present + found[problem.columns()] * problem.q_unit();
    // What is left of a difference by rounding is no load, of which there would be an efficiency.
    return std::abs(ideal) <= 1e-12 * (std::abs(out_.present) + problem.q_unit()) ? 0.0 : ideal;
  }

  std::vector<Ball> slope_over(const FrictionProblem& problem, double apart) const {
    const std::vector<Ball> low = problem.load_of(varied_.at(out_.present)),
                            high = problem.load_of(varied_.at(out_.present + apart));
    std::vector<Ball> out;
    const Ball over = Ball(out_.present + apart) - Ball(out_.present);
    for (std::size_t i = 0; i < low.size(); ++i) out.push_back((high[i] - low[i]) / over);
    return out;
  }

  /// A value for which it is held, where the present one is not.
  std::optional<double> some_value(const FrictionProblem& problem, const Span& span) {
    std::vector<Choice> cases = problem.whole();
    for (int count = 0; !cases.empty(); ++count) {
      if (count == most_cases) {
        out_.why = fmt::format("{} cases of the directions of joint forces find no value that is held", most_cases);
        return std::nullopt;
      }
      const Choice choice = std::move(cases.back());
      cases.pop_back();
      const LoadReach outer = reach(problem, problem.rows(choice, 1.0, Side::outer), span);
      if (!outer.any) continue;
      for (const Eigen::VectorXd& v : {outer.at_upper, outer.at_lower}) {
        const LoadReach inner = reach(problem, problem.rows(problem.choice_at(v), 1.0, Side::inner), span);
        if (!inner.any) continue;
        if (std::isfinite(inner.lower) && std::isfinite(inner.upper)) return 0.5 * (inner.lower + inner.upper);
        return std::isfinite(inner.lower) ? inner.lower : std::isfinite(inner.upper) ? inner.upper : 0.0;
      }
      const int source = most_exceeded(problem, choice, outer.at_upper, 1.0);
      if (source < 0) continue;
      divide(problem, choice, static_cast<std::size_t>(source), cases);
    }
    return std::nullopt;
  }

  void set_end(HeldEnd& end, double inner, double outer, double limit, double unit, std::vector<Slip> slips,
               double limit_si) const {
    end.value = out_.present + inner * unit;
    end.radius = std::isfinite(inner) ? std::abs(outer - inner) * unit : 0.0;
    end.slips = std::move(slips);
    end.at_limit = std::isfinite(limit) && std::abs(inner - limit) <= 1e-13 * std::max(1.0, std::abs(limit));
    if (end.at_limit) {
      end.value = limit_si;
      end.slips.clear();
    }
    if (!std::isfinite(inner)) end.value = inner;
  }

  std::vector<Ball> load_at(const std::vector<Ball>& present, const std::vector<Ball>& slope, double p) const {
    std::vector<Ball> out;
    for (std::size_t i = 0; i < present.size(); ++i) {
      out.push_back(present[i] + (Ball(p) - Ball(out_.present)) * slope[i]);
    }
    return out;
  }

  // An end without end is proved by a direction in which joint forces grow within their bounds, with some slack: far
  // enough along it they satisfy all rows from whatever values that balance the load.
  void prove_end(FrictionProblem& problem, const std::vector<Ball>& present, const std::vector<Ball>& slope,
                 HeldEnd& end, double sign) const {
    if (std::isinf(end.value)) {
      std::vector<Ball> direction;
      for (const Ball& one : slope) direction.push_back(Ball(sign) * one);
      problem.set_load(direction, false);
      const Decision along = decide(problem, 1.0, true, true);
      end.proved = along.verdict == Holding::held && along.proved;
      return;
    }
    const auto at = [&](double p) {
      problem.set_load(load_at(present, slope, p));
      return decide(problem, 1.0, true);
    };
    if (end.at_limit) {
      const Decision there = at(end.value);
      end.proved = there.verdict == Holding::held && there.proved;
      return;
    }
    const double size = std::max(std::abs(end.value), 1e-6 * problem.q_unit());
    const double open = 2 * end.radius / size;
    for (double aside = open < 1e-5 ? std::max(1e-12, open) : 1e-12; aside < 1e-5 && !end.proved; aside *= 10) {
      const Decision inside = at(end.value - sign * aside * size), outside = at(end.value + sign * aside * size);
      end.proved =
          inside.verdict == Holding::held && inside.proved && outside.verdict == Holding::slips && outside.proved;
      if (end.proved) end.radius = aside * size;
      if (outside.verdict == Holding::slips) end.slips = outside.slips;
    }
  }

  Decision with_friction(double value, bool prove) const {
    const StaticModel changed(varied_.at(value), model_.scales());
    return decide(FrictionProblem(changed, x_), 1.0, prove);
  }

  /// Bounds change in one direction with the number: it is held on one side of one value.
  void find_friction() {
    const auto held = [&](double value) { return with_friction(value, false).verdict == Holding::held; };
    const bool grows = varied_.grows() > 0;
    HeldEnd& edge = grows ? out_.lower : out_.upper;
    HeldEnd& open = grows ? out_.upper : out_.lower;
    open.value = grows ? span_.to : span_.from;
    open.at_limit = std::isfinite(open.value);
    open.proved = true;
    const double limit = std::isfinite(grows ? span_.from : span_.to) ? (grows ? span_.from : span_.to) : 0.0;
    double in = out_.present, out = limit;
    if (!out_.contains_now) {
      in = std::isfinite(open.value) ? open.value : std::max(1.0, out_.present);
      for (int step = 0; grows && std::isinf(open.value) && step < 40 && !held(in); ++step) in *= 2;
      if (!held(in)) {
        out_.why = "no value of the number that was asked for holds the position";
        return;
      }
    }
    out_.any = true;
    if (!grows && !std::isfinite(span_.to)) {
      for (out = std::max(1.0, in); out < 0x1p40 && held(out); out *= 2) {
      }
    }
    if (held(out)) {
      edge.value = std::isfinite(span_.to) || grows ? out : no_end;
      edge.at_limit = std::isfinite(edge.value);
      edge.proved = edge.at_limit && with_friction(out, true).proved;
      return;
    }
    solvers::Bracket bracket{in, out};
    solvers::bisect(bracket, held, [](const solvers::Bracket& at) {
      return at.width() <= 1e-14 * std::max(std::abs(at.from), std::abs(at.to));
    });
    in = edge.value = bracket.from;
    const double inwards = grows ? 1.0 : -1.0;
    for (double aside = 1e-12; aside < 1e-5 && !edge.proved; aside *= 10) {
      const Decision inside = with_friction(in * (1 + inwards * aside), true),
                     outside = with_friction(in * (1 - inwards * aside), true);
      edge.proved =
          inside.verdict == Holding::held && inside.proved && outside.verdict == Holding::slips && outside.proved;
      edge.radius = aside * std::abs(in);
      if (outside.verdict == Holding::slips) edge.slips = outside.slips;
    }
  }

  const StaticModel& model_;
  const std::vector<double>& x_;
  const Varied& varied_;
  Span span_;
  HeldRange out_;
};

}  // namespace

std::optional<double> HeldRange::efficiency() const {
  if (!any || !ideal || *ideal == 0.0) return std::nullopt;
  const HeldEnd& far = *ideal > 0 ? upper : lower;
  if (far.at_limit || !(std::abs(far.value) >= std::abs(*ideal)) || far.value * *ideal < 0) return std::nullopt;
  return *ideal / far.value;
}

std::optional<double> HeldRange::efficiency_back() const {
  if (!any || !ideal || *ideal == 0.0) return std::nullopt;
  const HeldEnd& near = *ideal > 0 ? lower : upper;
  if (near.value * *ideal <= 0) return 0.0;
  if (near.at_limit || std::abs(near.value) > std::abs(*ideal)) return std::nullopt;
  return near.value / *ideal;
}

std::vector<Rubbing> rubbing(const Scene& scene) {
  std::vector<Rubbing> out;
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    const Joint& joint = scene.joints[j];
    if (!joint.friction || !joint.can_rub()) continue;
    const int index = static_cast<int>(j);
    const Measure on =
        joint.has_travel() ? Measure::travel_of(index) : Measure::angle_between(joint.a.body, joint.b.body);
    out.push_back({joint.name, joint.traits().key, on, index, -1});
  }
  for (std::size_t e = 0; e < scene.elements.size(); ++e) {
    const Element& element = scene.elements[e];
    if (!std::holds_alternative<DryFriction>(element.law)) continue;
    out.push_back({element.name, "friction", element.on, -1, static_cast<int>(e)});
  }
  for (std::size_t s = 0; s < scene.stops.size(); ++s) {
    const Stop& rope = scene.stops[s];
    for (const int contact : rubbing_rims(rope.on)) {
      const PointRef pulley = rope.on.contacts[static_cast<std::size_t>(contact)].at;
      out.push_back(
          {rope.name + " on " + scene.name_of(pulley), "rope", rope.on, -1, -1, static_cast<int>(s), contact});
    }
  }
  return out;
}

bool has_friction(const Scene& scene) { return !rubbing(scene).empty(); }

HeldPose held_pose(const StaticModel& model, const std::vector<double>& x) {
  refuse_blades(model.scene(), "positions that friction holds");
  HeldPose none;
  none.why = why_not_asked(model, x);
  if (!none.why.empty()) return none;
  return pose_of(FrictionProblem(model, x));
}

HeldRange held_range(const StaticModel& model, const std::vector<double>& x, const std::string& number, double from,
                     double to) {
  refuse_blades(model.scene(), "positions that friction holds");
  const Varied varied(model.scene(), number);
  const std::string why_not = why_not_asked(model, x);
  if (!why_not.empty()) throw InputError(number + ": " + why_not);
  Span span{std::max(from, varied.span().from), std::min(to, varied.span().to)};
  // A negative size of a force, where somebody asks for it, is that of the opposite force.
  if (std::isfinite(from) && varied.is_force()) span.from = from;
  if (std::isfinite(from) && from < span.from) {
    throw InputError(number + ": expected a range from 0 on, since it is never negative; found one that begins below");
  }
  if (!(span.from <= span.to)) throw InputError(number + ": expected a range that it may be in, found none");
  return RangeFinder(model, x, varied, span).run();
}

}  // namespace poise
