#include "statics/equilibrium/equilibrium.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <random>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "solvers/augmented_lagrangian.hpp"
#include "solvers/dynamic_relaxation.hpp"
#include "solvers/ipopt.hpp"
#include "solvers/least_squares.hpp"
#include "solvers/linear_algebra.hpp"
#include "solvers/newton.hpp"
#include "solvers/nlopt_program.hpp"
#include "statics/model/curvature.hpp"
#include "statics/model/mobility.hpp"
#include "statics/model/singular_configuration.hpp"
#include "statics/proof/enclosed_reactions.hpp"

namespace poise {
namespace {

constexpr int most_unclaimed = 300;        // coordinates up to which the end of a failed search is examined too
constexpr int most_in_dense_planes = 300;  // coordinates up to which neutral directions are computed
constexpr int most_returns = 4;            // along these, to the start
constexpr int most_displaced = 12;         // displaced starts, after a result that the check does not confirm
constexpr double beside_pulling[] = {1e-3, 1e-2, 1e-1};  // rad or sizes, from stops that would have to pull
constexpr int most_around = 4;                           // places at each of these distances
// From where the mechanism settles to the equilibrium of a method, besides what rounding and the proof leave open.
constexpr double settled_within = 1e-9;

double elapsed(std::chrono::steady_clock::time_point since) {
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - since).count();
}

// Constraint rows that are independent at x, and all stops: Ipopt does not accept more equations than variables. If all
// are independent the list is empty, which means all. Mechanisms too large for a dense factor keep all rows.
std::vector<int> independent_rows(const StaticModel& model, const std::vector<double>& x) {
  const Mechanism<double>& m = model.mechanism();
  const int equalities = m.equalities();
  if (equalities == 0 || equalities > 400) return {};
  std::vector<int> rows(equalities);
  std::iota(rows.begin(), rows.end(), 0);
  const DensePoint<double> point(m, x, rows);
  const auto [rank, order] = solvers::pivot_order<double>(point.jacobian.transpose(), solvers::known_to::closed_point);
  if (rank == equalities) return {};
  rows.assign(order.begin(), order.begin() + rank);
  std::sort(rows.begin(), rows.end());
  for (int s = 0; s < m.stops(); ++s) rows.push_back(equalities + s);
  return rows;
}

void search_by_virtual_work(const StaticModel& model, const std::vector<double>& x, const SolveOptions& options,
                            Equilibrium& out) {
  solvers::NewtonOptions settings;
  settings.goal = options.seek == Seek::stable ? solvers::Goal::minimum : solvers::Goal::stationary;
  settings.safeguards = options.safeguards;
  settings.step_tolerance = options.tolerance.value_or(settings.step_tolerance);
  settings.iterations = std::min(settings.iterations, options.iterations.value_or(settings.iterations));
  settings.interrupt = options.interrupt;
  solvers::Newton newton(model.problem(), settings);
  const auto begin = std::chrono::steady_clock::now();
  const solvers::NewtonResult& result = newton.solve(x);
  out.microseconds = elapsed(begin);
  out.x = result.x;
  out.iterations = result.iterations;
  out.evaluations = result.evaluations;
  out.why = "Newton: " + solvers::describe(result.end);
  if (result.load_stepped) {
    out.why += " (by load stepping, after all else failed)";
  } else if (result.restarted) {
    out.why += " (from a displaced start, after others failed)";
  } else if (result.descended) {
    out.why += " (by descending the energy, after plain Newton stalled)";
  }
  out.met_singular = result.met_singular || find_singular_configuration(model, x).has_value();
  if (out.met_singular && result.end != solvers::NewtonEnd::singular) {
    out.why +=
        "; the search left a singular position, where the joints lock: no finite joint forces balance the loads there";
  }
  if (result.end == solvers::NewtonEnd::interrupted) out.status = Status::interrupted;
  out.claimed = result.end == solvers::NewtonEnd::converged;
}

using Program = std::function<solvers::SearchResult(const solvers::Problem&, const std::vector<double>&,
                                                    const solvers::SearchOptions&, const std::vector<int>&)>;

Program augmented_with(solvers::Tangent tangent, const LagrangianWeights& weights) {
  return [tangent, weights](const solvers::Problem& problem, const std::vector<double>& start,
                            const solvers::SearchOptions& options, const std::vector<int>& rows) {
    const solvers::AugmentedLagrangianOptions all{options, tangent, weights.scaling, weights.penalty};
    return solvers::solve_with_augmented_lagrangian(problem, start, all, rows);
  };
}

template <solvers::NloptAlgorithm algorithm>
solvers::SearchResult nlopt_with(const solvers::Problem& problem, const std::vector<double>& start,
                                 const solvers::SearchOptions& options, const std::vector<int>& rows) {
  return solvers::solve_with_nlopt(algorithm, problem, start, options, rows);
}

void search_by_program(const Program& program, const StaticModel& model, const std::vector<double>& x,
                       const SolveOptions& options, Equilibrium& out) {
  const Mechanism<double>& m = model.mechanism();
  const MethodTraits& method = traits(options.method);
  if (method.needs_potential && m.has_follower_loads()) {
    out.status = Status::not_applicable;
    out.why = fmt::format("force \"{}\" follows a body and has no potential, so there is no energy to minimise",
                          m.follower_names().front());
    return;
  }
  if (m.coordinates() > method.coordinates) {
    out.status = Status::not_applicable;
    out.why = fmt::format("{} coordinates are too many for this method; its limit is {}", m.coordinates(),
                          method.coordinates);
    return;
  }
  // From closed loops: redundant closures can be recognized only where they hold.
  solvers::Newton closing(model.problem());
  const std::vector<double> closed = closing.close(x).x;
  const solvers::SearchOptions settings{
      .tolerance = options.tolerance.value_or(method.tolerance),
      .iterations = std::min(method.iterations, options.iterations.value_or(method.iterations)),
      .interrupt = options.interrupt};
  const std::vector<int> rows = independent_rows(model, closed);
  const auto begin = std::chrono::steady_clock::now();
  const solvers::SearchResult result = program(model.problem(), closed, settings, rows);
  out.microseconds = elapsed(begin);
  out.x = result.x;
  out.iterations = result.iterations;
  out.evaluations = result.evaluations;
  out.why = result.status;
  if (result.interrupted) out.status = Status::interrupted;
  out.claimed = result.claims_success;
}

// Without a default, so that the compiler reports a method that is missing here.
void search(const StaticModel& model, const std::vector<double>& x, const SolveOptions& options, Equilibrium& out) {
  const auto by = [&](const Program& program) { search_by_program(program, model, x, options, out); };
  switch (options.method) {
    case Method::virtual_work:
      return search_by_virtual_work(model, x, options, out);
    case Method::energy:
      return by(solvers::solve_with_ipopt);
    case Method::augmented_lagrangian:
      return by(augmented_with(solvers::Tangent::newton, options.lagrangian));
    case Method::augmented_lagrangian_modified:
      return by(augmented_with(solvers::Tangent::modified, options.lagrangian));
    case Method::slsqp:
      return by(nlopt_with<solvers::NloptAlgorithm::slsqp>);
    case Method::auglag_lbfgs:
      return by(nlopt_with<solvers::NloptAlgorithm::auglag_lbfgs>);
    case Method::cobyla:
      return by(nlopt_with<solvers::NloptAlgorithm::cobyla>);
    case Method::dynamic_relaxation:
      return by(solvers::solve_with_dynamic_relaxation);
    case Method::least_squares:
      return by(solvers::solve_with_least_squares);
  }
  throw std::invalid_argument(fmt::format("there is no method {}", static_cast<int>(options.method)));
}

void mark_needed(const Certificate& certificate, Check& check) {
  for (Reaction& reaction : check.reactions) {
    const std::vector<int>& needed = certificate.needed_stops;
    if (reaction.of_stop() && std::find(needed.begin(), needed.end(), reaction.stop) != needed.end()) {
      reaction.may_be_idle = false;
    }
  }
}

// The certificate decides, independent of the solver's own report.
void certify_answer(const StaticModel& model, const SolveOptions& options, Equilibrium& out) {
  out.reached = out.x;
  // Where a search of a large mechanism failed a proof would take long, and there is little to prove.
  if (!options.prove) {
    out.certificate.unfinished = true;
    out.certificate.statement = "no proof was asked for";
  } else if (out.claimed || (out.status != Status::interrupted && model.mechanism().coordinates() <= most_unclaimed)) {
    out.certificate = certify(model, out.x, options.certificate);
  } else {
    out.certificate.statement = "the search did not end at an equilibrium";
  }
  bool confirmed = out.certificate.confirmed();
  if (confirmed) out.x = out.certificate.x;
  out.check = check(model, out.x, options.check, confirmed ? &out.certificate.active_stops : nullptr,
                    confirmed ? out.certificate.sharing_stops : std::vector<int>{});
  confirmed = confirmed && std::isfinite(out.check.largest_force);  // nothing could be said of its forces
  confirmed = confirmed && out.check.keeps_contacts;
  if (confirmed) {
    mark_needed(out.certificate, out.check);
    enclose_reactions(model, out.certificate, out.check);
  }
  out.energy = energy_at(model, out.x);
  if (out.status == Status::interrupted) return;
  const bool wrong_kind = options.seek == Seek::stable && out.certificate.stability == Stability::unstable;
  if (confirmed && !wrong_kind) {
    out.status = Status::confirmed;
    return;
  }
  if (confirmed) {
    out.status = Status::not_found;
    out.why += "; the result is an unstable equilibrium";
    return;
  }
  if (out.certificate.unfinished && out.claimed && out.check.is_equilibrium()) {
    out.status = Status::checked;
    out.why += "; " + out.certificate.statement;
    return;
  }
  out.status = out.claimed ? Status::not_confirmed : Status::not_found;
  out.why += "; " + (out.check.objection.empty() ? out.certificate.statement : out.check.objection);
}

Equilibrium search_and_check(const StaticModel& model, const std::vector<double>& x, const SolveOptions& options) {
  Equilibrium out;
  out.method = options.method;
  out.seek = options.seek;
  out.x = x;
  if (options.scaling) {
    search(model, x, options, out);
  } else {
    const StaticModel plain(model.scene(), Scales{});
    search(plain, plain.from_si(model.to_si(x)), options, out);
    out.x = model.from_si(plain.to_si(out.x));
  }
  if (out.status != Status::not_applicable) certify_answer(model, options, out);
  return out;
}

// The solver claims success, and nothing was proved.
bool is_denied(const Equilibrium& equilibrium) {
  return equilibrium.claimed && !equilibrium.found() && equilibrium.status != Status::interrupted &&
         equilibrium.status != Status::checked;
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
  double far = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) far = std::max(far, std::abs(a[i] - b[i]));
  return far;
}

// An equilibrium that is proved, but is not the one in which the mechanism settles.
void expect_settled(const Settling& settling, Equilibrium& out) {
  const Certificate& certificate = out.certificate;
  const double apart = distance(out.x, settling.x);
  if (!out.found() || certificate.outcome == Outcome::neutral ||
      apart <= settled_within + 2.0 * certificate.radius + 10.0 * certificate.rounding_effect) {
    return;
  }
  out.status = Status::elsewhere;
  out.why += fmt::format("; it left the equilibrium in which the mechanism settles, for one {:.2g} (rad or sizes) away",
                         apart);
}

Equilibrium solve_settled(const StaticModel& model, const std::vector<double>& x, const SolveOptions& options) {
  Settling settling = settle(model, x, {.interrupt = options.interrupt});
  Equilibrium out;
  const bool rests = settling.end == Settling::End::settled || settling.end == Settling::End::start_unstable;
  if (rests) {
    out = search_and_check(model, settling.x, options);
    expect_settled(settling, out);
  } else {
    out.method = options.method;
    out.seek = options.seek;
    out.x = settling.x;
    out.why = settling.why;
    if (settling.end == Settling::End::interrupted) out.status = Status::interrupted;
    certify_answer(model, options, out);
    if (out.status != Status::interrupted) out.status = Status::not_found;
  }
  out.settling = std::move(settling);
  return out;
}

// x moved by a distance inwards from stops that would have to pull there.
std::vector<double> beside(const StaticModel& model, std::vector<double> x, const std::vector<int>& stops, double by) {
  const Mechanism<double>& m = model.mechanism();
  std::vector<int> rows;
  for (const int s : stops) rows.push_back(m.stop_row(s));
  const DensePoint<double> point(m, x, rows);
  std::vector<Planar<double>> pose(m.pose_size());
  std::vector<double> c(m.constraints());
  m.place(x.data(), pose.data());
  m.constraint(x.data(), pose.data(), c.data());
  Eigen::VectorXd inwards = Eigen::VectorXd::Zero(m.coordinates());
  for (std::size_t k = 0; k < stops.size(); ++k) {
    const double g = c[static_cast<std::size_t>(rows[k])];
    const bool at_upper = std::abs(g - m.upper()[stops[k]]) < std::abs(g - m.lower()[stops[k]]);
    const Eigen::VectorXd row = point.jacobian.row(static_cast<Eigen::Index>(k));
    inwards += (at_upper ? -1.0 : 1.0) * row.normalized();
  }
  if (inwards.norm() > 0.0) inwards.normalize();
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += by * inwards[static_cast<Eigen::Index>(i)];
  return x;
}

bool touches_one_side(const Scene& scene, const Check& check) {
  return std::any_of(check.reactions.begin(), check.reactions.end(), [&](const Reaction& r) {
    return r.of_stop() && !scene.stops[static_cast<std::size_t>(r.stop)].holds();
  });
}

// Places from which a search goes on where stops would have to pull, or where a motion came to a halt at stops that it
// could leave in several ways: beside the end, where those that pull are not touched, and anywhere around it.
std::vector<std::vector<double>> places_beside(const StaticModel& model, const Equilibrium& ended) {
  std::vector<std::vector<double>> out;
  if (!ended.check.pulling.empty()) {
    for (const double by : beside_pulling) out.push_back(beside(model, ended.x, ended.check.pulling, by));
  }
  std::minstd_rand random(20261127);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (const double by : beside_pulling) {
    for (int k = 0; k < most_around; ++k) {
      std::vector<double>& x = out.emplace_back(ended.x);
      for (double& v : x) v += by * uniform(random);
    }
  }
  return out;
}

// A search that ended where stops would have to pull goes on with other sets of stops that act.
Equilibrium without_pulling_stops(const StaticModel& model, const SolveOptions& options, Equilibrium ended) {
  const bool is_large = model.mechanism().coordinates() > most_unclaimed;
  if (ended.found() || ended.status == Status::interrupted || is_large) return ended;
  const bool is_stuck =
      ended.settling && ended.settling->end == Settling::End::singular && touches_one_side(model.scene(), ended.check);
  if (ended.check.pulling.empty() && !is_stuck) return ended;
  for (const std::vector<double>& x : places_beside(model, ended)) {
    Equilibrium next =
        options.seek == Seek::settle ? solve_settled(model, x, options) : search_and_check(model, x, options);
    ended.iterations += next.iterations;
    ended.evaluations += next.evaluations;
    ended.microseconds += next.microseconds;
    if (!next.found()) continue;
    next.iterations = ended.iterations;
    next.evaluations = ended.evaluations;
    next.microseconds = ended.microseconds;
    next.why += fmt::format("; from beside a place where {}",
                            ended.check.pulling.empty() ? ended.settling->why : ended.check.objection);
    if (next.settling) {
      next.settling->in_doubt = true;
      next.settling->margin = std::numeric_limits<double>::infinity();  // the way there was not found
    }
    return next;
  }
  return ended;
}

bool is_proved_neutral(const Equilibrium& found) {
  return found.found() && found.certificate.outcome == Outcome::neutral;
}

// The place in the plane of an equilibrium's neutral directions that is nearest to another.
std::vector<double> in_neutral_plane(const StaticModel& model, const Equilibrium& found,
                                     const std::vector<double>& other) {
  const Mechanism<double>& m = model.mechanism();
  std::vector<double> out = found.x;
  if (m.has_follower_loads() || m.coordinates() > most_in_dense_planes) return out;
  std::vector<int> rows(m.equalities());
  std::iota(rows.begin(), rows.end(), 0);
  for (const int stop : found.certificate.active_stops) rows.push_back(m.stop_row(stop));
  const ReducedHessian reduced(m, found.x, rows);
  if (reduced.matrix.size() == 0) return out;
  const solvers::SymmetricEigen eigen = solvers::symmetric_eigen(reduced.matrix);
  const auto n = static_cast<Eigen::Index>(out.size());
  Eigen::Map<Eigen::VectorXd> place(out.data(), n);
  const Eigen::VectorXd away = Eigen::Map<const Eigen::VectorXd>(other.data(), n) - place;
  const Certificate& certificate = found.certificate;
  for (int k = 0; k < certificate.neutral_directions; ++k) {
    const Eigen::Index at = certificate.unstable_directions + k;
    if (at >= eigen.vectors.cols()) break;
    const Eigen::VectorXd direction = reduced.basis * eigen.vectors.col(at);
    place += direction.dot(away) * direction;
  }
  return out;
}

// Among neutral equilibria a search drifts by rounding, or by its steps in other directions. A start, or a place in
// which the mechanism settles, that is one of them is the answer; else the one that is nearest to it.
Equilibrium staying(const StaticModel& model, const std::vector<double>& start, const SolveOptions& options,
                    Equilibrium found) {
  if (!is_proved_neutral(found) || found.x == start) return found;
  Equilibrium here = found;
  here.x = start;
  here.certificate = {};
  here.check = {};
  certify_answer(model, options, here);
  if (is_proved_neutral(here)) {
    if (here.settling) here.settling->x = start;
    return here;
  }
  const std::vector<double> target = found.settling ? found.settling->x : start;
  std::vector<double> back = in_neutral_plane(model, found, target);
  for (int k = 0; k < most_returns && distance(back, found.x) > settled_within; ++k) {
    Equilibrium next = search_and_check(model, back, options);
    if (!is_proved_neutral(next)) break;
    std::vector<double> further = in_neutral_plane(model, next, target);
    if (!(distance(further, next.x) < distance(back, found.x))) break;
    back = std::move(further);
    next.iterations += found.iterations;
    next.evaluations += found.evaluations;
    next.microseconds += found.microseconds;
    next.settling = std::move(found.settling);
    found = std::move(next);
  }
  return found;
}

}  // namespace

std::string to_string(Seek seek) {
  switch (seek) {
    case Seek::settle:
      return "settle";
    case Seek::any:
      return "any";
    case Seek::stable:
      return "stable";
  }
  return "unknown";
}

std::optional<double> energy_at(const StaticModel& model, const std::vector<double>& x) {
  const Mechanism<double>& m = model.mechanism();
  if (m.has_follower_loads()) return std::nullopt;
  std::vector<Planar<double>> pose(m.pose_size());
  m.place(x.data(), pose.data());
  return m.energy(x.data(), pose.data()) * model.scales().energy();
}

std::string to_string(Status status) {
  switch (status) {
    case Status::not_solved:
      return "not solved";
    case Status::confirmed:
      return "confirmed";
    case Status::checked:
      return "checked, not proved";
    case Status::not_confirmed:
      return "not confirmed";
    case Status::elsewhere:
      return "went elsewhere";
    case Status::not_found:
      return "not found";
    case Status::not_applicable:
      return "not applicable";
    case Status::interrupted:
      return "interrupted";
  }
  return "unknown";
}

Equilibrium solve(const StaticModel& model, const std::vector<double>& x, const SolveOptions& options) {
  if (options.seek == Seek::settle) {
    return staying(model, x, options, without_pulling_stops(model, options, solve_settled(model, x, options)));
  }
  Equilibrium out = staying(model, x, options, search_and_check(model, x, options));
  const bool again = options.method == Method::virtual_work && options.safeguards.restarts;
  std::minstd_rand random(20220531);
  for (int k = 1; again && is_denied(out) && k <= most_displaced; ++k) {
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    std::vector<double> displaced = x;
    for (double& v : displaced) v += M_PI * k / most_displaced * uniform(random);
    Equilibrium next = search_and_check(model, displaced, options);
    next.iterations += out.iterations;
    next.evaluations += out.evaluations;
    next.microseconds += out.microseconds;
    next.met_singular = next.met_singular || out.met_singular;
    if (next.found()) next.why += "; from a displaced start, because the result from the given one was not confirmed";
    out = std::move(next);
  }
  return without_pulling_stops(model, options, std::move(out));
}

Equilibrium solve(const StaticModel& model, const SolveOptions& options) {
  // Both methods begin at the closed start: from an open one Newton's first steps, which mostly close loops, lead past
  // the nearest equilibrium.
  return solve(model, assemble(model), options);
}

std::vector<double> assemble(const StaticModel& model) {
  expect_movable(model);
  const Mobility mobility = analyse_mobility(model);
  expect_closed(model, mobility);
  expect_movable(model, mobility);
  return mobility.x;
}

}  // namespace poise
