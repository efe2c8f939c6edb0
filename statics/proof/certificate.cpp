#include "statics/proof/certificate.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "solvers/linear_algebra.hpp"
#include "solvers/nonnegative_least_squares.hpp"
#include "solvers/work_limit.hpp"
#include "statics/proof/private/smooth_piece.hpp"
#include "statics/proof/private/stability_on_cones.hpp"

namespace poise {
namespace {

// These numbers choose what is tried, and where. What is proved is proved in ball arithmetic.
constexpr double touched_within = 1e-6;   // distance from its bound, rad or sizes, at which a stop may be active
constexpr double place_rounding = 1e-15;  // rad or sizes
constexpr int most_undecided = 4;         // stops and one-way springs whose state is undecided: 2^4 pieces
constexpr double largest_gap_by_rounding = 1e-6;

// An active stop and the side on which it acts.
struct ActiveStop {
  int stop;
  bool upper;
  bool both = false;  // it pushes either way: min = max, or by rounding no motion is possible between it and others
};

class Certifier {
 public:
  Certifier(const StaticModel& model, const CertificateOptions& options, const SmoothPiece& piece)
      : model_(model), options_(options), piece_(piece) {}

  Certificate run() const;

 private:
  Certificate deny(Outcome outcome, const std::string& why) const {
    Certificate out;
    out.outcome = outcome;
    out.statement = why;
    out.x = x();
    return out;
  }

  // --- stops
  std::vector<double> stop_values() const;
  std::vector<ActiveStop> stops_in_contact() const;
  std::vector<ActiveStop> find_active_stops() const;
  struct Corner {
    Eigen::MatrixXd prevents;  // columns: directions in which the stops in contact prevent motion
    Eigen::VectorXd force;     // of everything else, so that  prevents f + force = 0  of the forces f of these stops
  };
  Corner corner(const std::vector<ActiveStop>& always, const std::vector<ActiveStop>& contact) const;
  std::vector<std::vector<ActiveStop>> carrying_sets(const std::vector<ActiveStop>& always,
                                                     const std::vector<ActiveStop>& contact) const;
  KeptEquations equations(const std::vector<ActiveStop>& active) const;

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
  std::optional<std::size_t> relieved_by(const Finding& finding, const std::vector<ActiveStop>& active,
                                         const ActiveStop& overrun) const;
  // Stops at their limit of which it is undecided whether they push.
  struct Touched {
    std::vector<ActiveStop> weak;
    std::vector<ActiveStop> sharing;  // those that no motion leaves which the others allow
  };
  Touched touched_stops(const Settled& settled) const;
  Certificate conclude_all() const;
  Certificate conclude(const Settled& settled) const;
  Certificate conclude_pieces(const std::vector<int>& springs) const;
  Certificate conclude_at_limit(const Settled& settled, const std::vector<int>& springs) const;
  std::vector<Ball> rates_beyond(const ActiveStop& s, const std::vector<Ball>& q,
                                 const std::vector<std::vector<Ball>>& motions) const;
  std::vector<int> needed_stops(const Settled& settled, const std::vector<ActiveStop>& sharing) const;
  std::optional<Cones> cones_at(const Finding& piece, const std::vector<int>& springs,
                                const std::vector<ActiveStop>& weak) const;
  void allow_for_rounding(Finding& finding, const std::vector<KeptEquations>& others) const;
  Certificate report(const Finding& finding, const std::vector<ActiveStop>& active) const;
  std::string name(int coordinate) const { return model_.layout().coordinates[coordinate].name; }

  const Mechanism<double>& m() const { return piece_.m(); }
  const BallMechanism& balls() const { return piece_.balls(); }
  const std::vector<double>& x() const { return piece_.x(); }

  const StaticModel& model_;
  const CertificateOptions& options_;
  SmoothPiece piece_;
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
  KeptEquations out = piece_.closures();
  for (const ActiveStop& a : active) {
    out.rows.push_back(m().stop_row(a.stop));
    out.at_upper.push_back(a.upper ? 1 : 0);
  }
  return out;
}

std::vector<double> Certifier::stop_values() const {
  std::vector<Planar<double>> pose(m().pose_size());
  std::vector<double> c(m().constraints());
  m().place(x().data(), pose.data());
  m().constraint(x().data(), pose.data(), c.data());
  return {c.begin() + m().equalities(), c.end()};
}

// Stops that x is near a bound of; those that hold their measure (min = max) are not among them.
std::vector<ActiveStop> Certifier::stops_in_contact() const {
  std::vector<ActiveStop> out;
  if (m().stops() == 0) return out;
  const std::vector<double> g = stop_values();
  for (int s = 0; s < m().stops(); ++s) {
    if (m().lower()[s] == m().upper()[s]) continue;
    if (g[s] > m().upper()[s] - touched_within) out.push_back({.stop = s, .upper = true});
    if (g[s] < m().lower()[s] + touched_within) out.push_back({.stop = s, .upper = false});
  }
  return out;
}

// Balance in the motions Z that the closures and the stops that hold their measures leave.
Certifier::Corner Certifier::corner(const std::vector<ActiveStop>& always,
                                    const std::vector<ActiveStop>& contact) const {
  KeptEquations kept = equations(always);
  const std::size_t fixed = kept.rows.size();
  for (const ActiveStop& a : contact) kept.rows.push_back(m().stop_row(a.stop));
  const DensePoint<double> point(m(), x(), kept.rows);
  const Eigen::MatrixXd z = solvers::null_space<double>(point.jacobian.topRows(static_cast<Eigen::Index>(fixed)),
                                                        solvers::known_to::closed_point);
  Corner out{Eigen::MatrixXd(z.cols(), static_cast<Eigen::Index>(contact.size())), z.transpose() * point.force};
  for (std::size_t k = 0; k < contact.size(); ++k) {
    const auto row = point.jacobian.row(static_cast<Eigen::Index>(fixed + k));
    Eigen::VectorXd a = z.transpose() * row.transpose();
    if (a.norm() <= solvers::known_to::solution * row.norm()) a.setZero();
    out.prevents.col(static_cast<Eigen::Index>(k)) = (contact[k].upper ? 1.0 : -1.0) * a;
  }
  return out;
}

// Sets of as many independent stops in contact as can be, whose forces balance the loads and of which none pulls by
// more than rounding. Where more stops meet than there are motions, and some carry nothing but rounding, the
// equilibrium is at one of these corners: the energy is nearly linear there, and a linear program has its minimum at
// such a set.
std::vector<std::vector<ActiveStop>> Certifier::carrying_sets(const std::vector<ActiveStop>& always,
                                                              const std::vector<ActiveStop>& contact) const {
  constexpr double rounding = 1e-9;
  constexpr int most_looked_at = 5000;
  constexpr std::size_t most_found = 32;
  std::vector<std::vector<ActiveStop>> out;
  if (m().coordinates() > SmoothPiece::dense_limit) return out;
  const auto [prevents, force] = corner(always, contact);
  const auto independent = static_cast<std::size_t>(solvers::rank<double>(prevents, solvers::known_to::solution));
  if (independent == 0) return out;
  std::vector<char> in(contact.size(), 0);
  std::fill_n(in.begin(), independent, 1);
  int looked_at = 0;
  do {
    std::vector<Eigen::Index> columns;
    for (std::size_t k = 0; k < in.size(); ++k) {
      if (in[k] != 0) columns.push_back(static_cast<Eigen::Index>(k));
    }
    const Eigen::MatrixXd of_set = prevents(Eigen::all, columns);
    const Eigen::VectorXd push = solvers::minimum_norm_solution<double>(of_set, -force);
    const double largest = push.size() > 0 ? push.cwiseAbs().maxCoeff() : 0.0;
    if (!(push.array() >= -rounding * largest).all()) continue;
    if (!((of_set * push + force).norm() <= rounding * force.norm())) continue;
    out.push_back(always);
    for (const Eigen::Index k : columns) out.back().push_back(contact[static_cast<std::size_t>(k)]);
  } while (++looked_at < most_looked_at && out.size() < most_found && std::prev_permutation(in.begin(), in.end()));
  return out;
}

// Active are stops with min = max, and those of the others that have a positive force in the non-negative least-squares
// solution of balance.
std::vector<ActiveStop> Certifier::find_active_stops() const {
  std::vector<ActiveStop> active;
  for (int s = 0; s < m().stops(); ++s) {
    if (m().lower()[s] == m().upper()[s]) active.push_back({.stop = s, .upper = true, .both = true});
  }
  const std::vector<ActiveStop> candidates = stops_in_contact();
  if (candidates.empty()) return active;
  if (m().coordinates() > SmoothPiece::dense_limit) {
    active.insert(active.end(), candidates.begin(), candidates.end());
    return active;
  }
  const auto [prevents, force] = corner(active, candidates);
  const Eigen::VectorXd push = solvers::nonnegative_least_squares(prevents, -force);
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    if (push[static_cast<Eigen::Index>(k)] > 0.0) active.push_back(candidates[k]);
  }
  return active;
}

// Rows of stops that repeat others to rounding only: what is said must be true whichever of them are left out.
void Certifier::allow_for_rounding(Finding& finding, const std::vector<KeptEquations>& others) const {
  BalanceSystem::Solution& solution = finding.solution;
  for (const KeptEquations& kept : others) {
    const BalanceSystem::Solution other = piece_.solve_closely(kept, midpoints(finding.solution.q));
    if (!other.proved || finding.kind == Finding::Kind::degenerate ||
        piece_.unstable_directions(other) != finding.unstable) {
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

// --- all pieces -----------------------------------------------------------------------------------------------------

Certificate Certifier::report(const Finding& f, const std::vector<ActiveStop>& active) const {
  if (f.kind == Finding::Kind::none) {
    Certificate out = deny(f.excluded ? Outcome::no_equilibrium : Outcome::not_proved, f.why);
    out.singular = f.singular;
    out.least_joint_force = f.least_joint_force * model_.scales().force;
    return out;
  }
  const std::vector<double>& open = balls().row_rounding;
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
    const bool is_arbitrary = std::find(f.neutral.begin(), f.neutral.end(), static_cast<int>(i)) != f.neutral.end();
    const Ball rest = f.solution.q[i] - Ball(middle);
    if (!is_arbitrary) out.radius = std::max(out.radius, rest.greatest());
    if (f.redundant == 0 && f.spread == 0.0) out.rest.push_back(rest.middle());
    if (!out.rest.empty()) out.rest_radius = std::max(out.rest_radius, (rest - Ball(rest.middle())).greatest());
    out.moved = std::max(out.moved, std::abs(middle - x()[i]));
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
    const BalanceSystem rounded(balls(), f.kept, true);
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
    const auto* spring = std::get_if<LinearSpring>(&balls().exact.law_of(e));
    if (spring != nullptr && spring->acts != LinearSpring::Acts::both) one_way.push_back(e);
  }
  if (one_way.empty()) return {};
  std::vector<Ball> box(x().begin(), x().end());
  const bool found = finding.kind != Finding::Kind::none;
  for (std::size_t i = 0; i < box.size(); ++i) {
    box[i] = found ? finding.solution.box[i] : box[i].widened(touched_within);
  }
  const std::vector<Ball> g = BalanceSystem(balls(), finding.kept).measures(box);
  std::erase_if(one_way, [&](int e) {
    return !(g[e] - Ball(std::get<LinearSpring>(balls().exact.law_of(e)).free_length)).contains_zero();
  });
  return one_way;
}

// The mechanism with some one-way springs replaced: by springs that act both ways, or by none.
BallMechanism Certifier::with_springs(const std::vector<int>& springs, unsigned act) const {
  BallMechanism piece = balls();
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
  return {model_, options_, SmoothPiece(balls, x(), options_.farthest, piece_.is_uncertain())};
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

// Finds the place of an active stop among the kept rows.
std::size_t Certifier::row_of(const Finding& finding, const ActiveStop& a) const {
  const auto row = std::find(finding.kept.rows.begin(), finding.kept.rows.end(), m().stop_row(a.stop));
  return static_cast<std::size_t>(row - finding.kept.rows.begin());
}

// The row of `dependent` is a combination of kept ones: finds the active stops that take part in it, on its own side
// and on the other one.
Certifier::Sharing Certifier::sharing(const Finding& finding, const std::vector<ActiveStop>& active,
                                      const ActiveStop& dependent) const {
  Sharing out;
  if (m().coordinates() > SmoothPiece::dense_limit || finding.kept.rows.empty()) return out;
  const std::vector<double> x = middles(finding.solution.q);
  const DensePoint<double> kept(m(), x, finding.kept.rows);
  const DensePoint<double> stop(m(), x, {m().stop_row(dependent.stop)});
  const Eigen::VectorXd share = shares_in(kept.jacobian, stop.jacobian.row(0));
  const double negligible = solvers::known_to::closed_point * share.cwiseAbs().maxCoeff();
  double least = std::numeric_limits<double>::infinity();
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

// Finds the active stop whose place an overrun stop takes, because no motion is left in which both could act, so that
// all that act go on pushing; there is none where such a motion is left, or where all of them would push more.
std::optional<std::size_t> Certifier::relieved_by(const Finding& finding, const std::vector<ActiveStop>& active,
                                                  const ActiveStop& overrun) const {
  KeptEquations with_it = finding.kept;
  with_it.rows.push_back(m().stop_row(overrun.stop));
  if (piece_.dependent_rows(with_it, SmoothPiece::nearly_dependent).size() ==
      piece_.dependent_rows(finding.kept, SmoothPiece::nearly_dependent).size()) {
    return std::nullopt;
  }
  return sharing(finding, active, overrun).first_relieved;
}

// Stops that would have to pull are left, those that are overrun become active, until neither is.
Certifier::Settled Certifier::settle(std::vector<ActiveStop> active) const {
  Settled out;
  for (int pass = 0; pass < 3 + 2 * m().stops(); ++pass) {
    out.finding = piece_.examine(equations(active));
    out.active = active;
    out.consistent = false;
    if (out.finding.kind == Finding::Kind::none || m().stops() == 0) {
      out.consistent = out.finding.kind != Finding::Kind::none;
      return out;
    }
    std::vector<Ball> g = BalanceSystem(balls(), out.finding.kept).constraints(out.finding.solution.q);
    // Active stops that depend on others or on closures hold to rounding. One that is overrun takes the place of one on
    // its side; where there is none no motion is possible between it and the others, and all of them push either way.
    const auto is_overrun = [&](const ActiveStop& a) {
      const Ball over = beyond(g, a.stop, a.upper);
      return !push_of(out.finding, a) && (a.both ? !over.contains_zero() : over > Ball(0));
    };
    std::vector<std::size_t> wedged;
    for (bool grows = true; grows;) {
      grows = false;
      for (std::size_t k = 0; k < active.size(); ++k) {
        if (!is_overrun(active[k]) || std::find(wedged.begin(), wedged.end(), k) != wedged.end()) continue;
        const Sharing shared = sharing(out.finding, out.active, active[k]);
        if (shared.first_relieved) continue;
        wedged.push_back(k);
        grows = true;
        out.active[k].both = true;
        for (const std::size_t other : shared.opposite) out.active[other].both = true;
      }
    }
    std::optional<std::size_t> relieved;
    std::vector<KeptEquations> others;
    for (std::size_t k = 0; k < active.size() && !relieved; ++k) {
      const ActiveStop& a = active[k];
      if (!is_overrun(a)) continue;
      const Sharing shared = sharing(out.finding, out.active, a);
      relieved = shared.first_relieved;
      for (const std::size_t other : shared.opposite) {
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
    if (!others.empty()) {
      allow_for_rounding(out.finding, others);
      if (out.finding.kind == Finding::Kind::none) return out;
      g = BalanceSystem(balls(), out.finding.kept).constraints(out.finding.solution.q);
    }
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
    const std::optional<std::size_t> makes_room = relieved_by(out.finding, out.active, *overrun);
    if (makes_room) active.erase(active.begin() + static_cast<std::ptrdiff_t>(*makes_room));
    active.push_back(*overrun);
  }
  return out;
}

// From the stops that seem to be active at the answer; where more are in contact, or that leads nowhere, from each set
// of those in contact, or, of many, from those that could carry the loads: the nearest equilibrium counts, of two in
// the same place one that is stable and presses on its stops.
Certifier::Settled Certifier::settle() const {
  const std::vector<ActiveStop> likely = find_active_stops();
  Settled out = settle(likely);
  const std::vector<ActiveStop> contact = stops_in_contact();
  const bool few = contact.size() <= most_undecided;
  if (contact.empty() || (!few && out.consistent)) return out;
  std::vector<ActiveStop> always;
  const auto rank = [&](const Settled& s) {
    return moved(s) + (s.finding.unstable > 0 || !touched_stops(s).weak.empty() ? place_rounding : 0.0);
  };
  std::copy_if(likely.begin(), likely.end(), std::back_inserter(always), [](const ActiveStop& a) { return a.both; });
  const bool all = out.consistent && out.active.size() == always.size() + contact.size();
  if (all && moved(out) <= place_rounding) return out;
  std::vector<std::vector<ActiveStop>> sets;
  for (unsigned set = 0; few && set < 1U << contact.size(); ++set) {
    sets.push_back(always);
    for (std::size_t k = 0; k < contact.size(); ++k) {
      if ((set >> k & 1U) != 0) sets.back().push_back(contact[k]);
    }
  }
  if (!few) sets = carrying_sets(always, contact);
  for (std::vector<ActiveStop>& active : sets) {
    Settled other = settle(std::move(active));
    if (other.consistent && (!out.consistent || rank(other) < rank(out))) out = std::move(other);
  }
  return out;
}

// Largest distance of a coordinate of an equilibrium from the answer.
double Certifier::moved(const Settled& settled) const {
  double most = 0.0;
  for (std::size_t i = 0; i < x().size(); ++i) {
    most = std::max(most, std::abs((settled.finding.solution.q[i] - Ball(x()[i])).middle()));
  }
  return most;
}

Certificate Certifier::run() const {
  if (!std::all_of(x().begin(), x().end(), [](double v) { return std::isfinite(v); })) {
    return deny(Outcome::not_proved, "a coordinate is not a finite number");
  }
  // Where joints repeat others to rounding only no pose closes all of them as they are written. What is said must be
  // true whichever are left open, so that the numbers of their loops count as uncertain.
  const std::vector<double> open = piece_.open_loops();
  if (!open.empty()) {
    Layout layout = model_.layout();
    layout.loosen(open);
    const BallMechanism uncertain(model_, layout);
    Certificate out = Certifier(model_, options_, SmoothPiece(uncertain, x(), options_.farthest, true)).conclude_all();
    out.gap = *std::max_element(open.begin(), open.end());
    return out;
  }
  return conclude_all();
}

Certificate Certifier::conclude_all() const {
  Settled first = settle();
  std::vector<int> springs = undecided_springs(first.finding);
  if (!springs.empty() && first.finding.kind == Finding::Kind::regular) {
    // A smaller box may decide.
    Finding smaller = first.finding;
    smaller.solution = piece_.solve(smaller.kept, midpoints(smaller.solution.q), SmoothPiece::last_reach);
    smaller.unstable = piece_.unstable_directions(smaller.solution);
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
  const Ball::Precision precision(SmoothPiece::many_bits);
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
      const LinearSpring& spring = std::get<LinearSpring>(balls().exact.law_of(springs[k]));
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
  const Touched stops = touched_stops(settled);
  if (stops.weak.empty()) {
    Certificate out = report(settled.finding, settled.active);
    for (const ActiveStop& s : stops.sharing) out.sharing_stops.push_back(s.stop);
    out.needed_stops = needed_stops(settled, stops.sharing);
    return out;
  }
  if (Ball::bits() < SmoothPiece::many_bits) {
    const Ball::Precision precision(SmoothPiece::many_bits);
    const Settled closely = settle(settled.active);
    // With more digits stops may pull, or be overrun, that were not told from such that do not.
    return conclude(closely.consistent ? closely : settle());
  }
  return conclude_at_limit(settled, {});
}

Certifier::Touched Certifier::touched_stops(const Settled& settled) const {
  Touched out;
  std::vector<ActiveStop> strong;
  for (const ActiveStop& a : settled.active) {
    const std::optional<Ball> push = push_of(settled.finding, a);
    if (!push) continue;
    (a.both || !push->contains_zero() ? strong : out.weak).push_back(a);
  }
  const std::vector<Ball> g = BalanceSystem(balls(), settled.finding.kept).constraints(settled.finding.solution.q);
  for (int s = 0; s < m().stops(); ++s) {
    const bool known =
        std::any_of(settled.active.begin(), settled.active.end(), [&](const ActiveStop& a) { return a.stop == s; });
    for (const bool upper : {false, true}) {
      if (known || !std::isfinite(bound(m(), s, upper)) || !beyond(g, s, upper).contains_zero()) continue;
      out.weak.push_back({.stop = s, .upper = upper});
    }
  }
  if (out.weak.empty() || m().coordinates() > SmoothPiece::dense_limit) return out;
  const std::size_t before = piece_.dependent_rows(equations(strong), SmoothPiece::nearly_dependent).size();
  const auto shares = std::stable_partition(out.weak.begin(), out.weak.end(), [&](const ActiveStop& a) {
    std::vector<ActiveStop> with_it = strong;
    with_it.push_back(a);
    return piece_.dependent_rows(equations(with_it), SmoothPiece::nearly_dependent).size() == before;
  });
  out.sharing.assign(shares, out.weak.end());
  out.weak.erase(shares, out.weak.end());
  return out;
}

// Where it is undecided whether a stop is active or a one-way spring acts, all combinations are examined.
Certificate Certifier::conclude_at_limit(const Settled& settled, const std::vector<int>& springs) const {
  const std::vector<ActiveStop> weak = touched_stops(settled).weak;
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
  std::vector<Finding> faces;  // no spring acts, and the stops of the bits of the index are active
  const unsigned states = 1U << (springs.size() + weak.size());
  for (unsigned state = 0; state < states; ++state) {
    std::vector<ActiveStop> now = strong;
    for (std::size_t k = 0; k < weak.size(); ++k) {
      if ((state >> (springs.size() + k) & 1U) != 0) now.push_back(weak[k]);
    }
    const BallMechanism mechanism = with_springs(springs, state);
    const Finding piece = with(mechanism).piece_.examine(equations(now));
    if (piece.kind == Finding::Kind::none || piece.kind == Finding::Kind::degenerate) {
      return deny(Outcome::not_proved, "a stop or one-way spring is exactly at the limit of acting, and " +
                                           (piece.why.empty() ? "one of its states was not proved" : piece.why));
    }
    falling += piece.unstable > 0 ? 1 : 0;
    if (state == 0) loosest = piece;
    if (state == states - 1) tightest = piece;
    if (state % (1U << springs.size()) == 0) faces.push_back(piece);
    same_orientation =
        same_orientation && piece.kind == Finding::Kind::regular && piece.unstable % 2 == loosest->unstable % 2;
  }
  Finding place = *loosest;
  if (place.kind == Finding::Kind::neutral) {
    // Along its neutral coordinates the loosest piece is in equilibrium beyond the stops too; at the settled place all
    // of them hold.
    place.solution = settled.finding.solution;
    place.kept = settled.finding.kept;
  }
  Certificate out = report(place, strong);
  out.strict = false;
  if (!out.confirmed()) return out;
  if (m().has_follower_loads()) {
    if (same_orientation) return out;
    return deny(Outcome::not_proved, "a stop or one-way spring is exactly at the limit of acting");
  }
  // A single limit leaves one of two opposite directions to the loosest piece.
  const bool is_single = weak.size() + springs.size() == 1;
  const auto decide_on_cones = [&] {
    out.stability = Stability::unknown;
    for (unsigned face = 0; face < faces.size() && out.stability == Stability::unknown; ++face) {
      std::vector<ActiveStop> left;
      for (std::size_t k = 0; k < weak.size(); ++k) {
        if ((face >> k & 1U) == 0) left.push_back(weak[k]);
      }
      const std::optional<Cones> cones = cones_at(faces[face], springs, left);
      if (!cones) continue;
      if (falling == 0 && goes_on_beside(*cones, faces[face].neutral.size())) {
        out.stability = Stability::neutral;
        break;
      }
      const StabilityOnCones on_face = stability_on_cones(*cones);
      // Motions on a face of the cone are some of those that the stops leave.
      if (face == 0 || on_face.stability == Stability::unstable) out.stability = on_face.stability;
      if (face == 0) out.locked = on_face.locked;
    }
  };
  if (falling == 0) {
    if (loosest->kind == Finding::Kind::neutral) {
      if (is_single || tightest->kind == Finding::Kind::neutral) {
        out.stability = Stability::neutral;
      } else {
        decide_on_cones();
      }
    }
  } else {
    // The energy is highest and motion least with all springs acting and all stops active: if it falls then it falls.
    const bool falls = tightest->unstable > 0 || (is_single && loosest->unstable > 0);
    out.stability = Stability::unstable;
    if (!falls) decide_on_cones();
    out.unstable_directions = out.stability == Stability::unstable ? std::max(1, tightest->unstable) : 0;
  }
  if (!same_orientation || out.stability == Stability::unknown) out.outcome = Outcome::degenerate;
  if (out.outcome == Outcome::degenerate) {
    out.statement = "a stop or one-way spring is exactly at the limit of acting";
    out.statement += out.stability == Stability::stable     ? ": the energy grows on all sides"
                     : out.stability == Stability::unstable ? ": the energy falls on one side"
                     : out.stability == Stability::neutral  ? ": along some motions the energy does not change"
                                                            : ", and stability was not decided";
  }
  return out;
}

// Finds the stops, active or sharing, without which the loads would move the mechanism: in a motion that leaves all the
// others they do work, so that no forces of these could balance them.
std::vector<int> Certifier::needed_stops(const Settled& settled, const std::vector<ActiveStop>& sharing) const {
  const bool are_determined = std::all_of(settled.active.begin(), settled.active.end(),
                                          [&](const ActiveStop& a) { return push_of(settled.finding, a).has_value(); });
  if (sharing.empty() && are_determined) return {};
  const std::vector<Ball>& q = settled.finding.solution.q;
  KeptEquations with_fixed;
  for (const int row : settled.finding.kept.rows) {
    const int stop = row - m().equalities();
    if (stop < 0 || m().lower()[stop] == m().upper()[stop]) with_fixed.rows.push_back(row);
  }
  with_fixed.at_upper.assign(with_fixed.rows.size(), 0);
  with_fixed.fixed = piece_.free_coordinates(with_fixed);
  const std::optional<std::vector<std::vector<Ball>>> motions = BalanceSystem(balls(), with_fixed).motions(q);
  if (!motions) return {};
  const std::vector<Ball> force = BalanceSystem(balls(), {}).forces(q, {});
  std::vector<int> stops;
  std::vector<std::vector<Ball>> forms;
  for (const std::vector<ActiveStop>* some : {&settled.active, &sharing}) {
    for (const ActiveStop& s : *some) {
      if (m().lower()[s.stop] == m().upper()[s.stop]) continue;
      stops.push_back(s.stop);
      forms.push_back(rates_beyond(s, q, *motions));
    }
  }
  std::vector<Ball> work;
  for (const std::vector<Ball>& motion : *motions) {
    Ball& sum = work.emplace_back(0.0);
    for (std::size_t i = 0; i < motion.size(); ++i) sum += force[i] * motion[i];
  }
  std::vector<int> out;
  for (std::size_t k = 0; k < stops.size(); ++k) {
    std::vector<std::vector<Ball>> others = forms;
    others[k] = work;
    if (is_left_together(others)) out.push_back(stops[k]);
  }
  return out;
}

// How fast a stop is overrun in each of the motions.
std::vector<Ball> Certifier::rates_beyond(const ActiveStop& s, const std::vector<Ball>& q,
                                          const std::vector<std::vector<Ball>>& motions) const {
  const BalanceSystem stop(balls(), {.rows = {m().stop_row(s.stop)}, .at_upper = {0}, .fixed = {}});
  std::vector<Ball> out;
  for (const std::vector<Ball>& motion : motions) out.push_back(Ball(s.upper ? 1 : -1) * stop.rates(q, motion)[0]);
  return out;
}

// The motions that a piece in which the springs do not act leaves, along its neutral coordinates first. None where they
// are not proved to be all.
std::optional<Cones> Certifier::cones_at(const Finding& piece, const std::vector<int>& springs,
                                         const std::vector<ActiveStop>& weak) const {
  const BallMechanism slack = with_springs(springs, 0);
  KeptEquations with_fixed = piece.kept;
  with_fixed.fixed = piece_.free_coordinates(piece.kept);
  const std::vector<Ball>& q = piece.solution.q;
  const std::optional<std::vector<std::vector<Ball>>> motions = BalanceSystem(slack, with_fixed).motions(q);
  if (!motions) return std::nullopt;
  KeptEquations whole = piece.kept;
  whole.fixed.clear();
  const BalanceSystem balance(slack, whole);
  Cones out;
  const auto with_rows = [&](std::vector<Ball> motion) {
    motion.resize(motion.size() + whole.rows.size());
    return motion;
  };
  for (const std::vector<Ball>& left : *motions) {
    std::vector<Ball>& row = out.hessian.emplace_back();
    for (const std::vector<Ball>& right : *motions) {
      row.push_back(balance.product(q, piece.solution.y, with_rows(left), with_rows(right)));
    }
  }
  for (const int e : springs) {
    const LinearSpring& spring = std::get<LinearSpring>(balls().exact.law_of(e));
    const Ball by = sqrt(Ball(spring.stiffness)) * Ball(spring.acts == LinearSpring::Acts::tension ? 1 : -1);
    std::vector<Ball>& a = out.acting.emplace_back();
    for (const std::vector<Ball>& motion : *motions) a.push_back(by * balance.measure_rate(e, q, motion));
  }
  for (const ActiveStop& s : weak) out.forbidden.push_back(rates_beyond(s, q, *motions));
  return out;
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
  const Ball::Precision precision(SmoothPiece::usual_bits);
  const solvers::WorkLimit limit(options.products, options.seconds);
  Certificate out = Certifier(model, options, SmoothPiece(model.balls(), x, options.farthest)).run();
  out.unfinished = !out.confirmed() && limit.exceeded();
  if (out.unfinished) {
    out.outcome = Outcome::not_proved;
    out.statement = options.seconds ? fmt::format("no proof within {:g} s", *options.seconds)
                                    : fmt::format("no proof within {:g} products", options.products);
  }
  return out;
}

}  // namespace poise
