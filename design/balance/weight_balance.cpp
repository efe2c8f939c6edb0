#include "design/balance/weight_balance.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "design/balance/bounded_system.hpp"
#include "model/input_error.hpp"
#include "solvers/random_stream.hpp"
#include "statics/model/check.hpp"
#include "statics/model/static_model.hpp"

namespace poise {
namespace {

// Coefficients of a spring's energy: V = k h(r), with what of it the numbers change.
struct SpringForm {
  std::size_t element = 0;
  int stiffness = -1;            // unknown, or -1
  double given = 0.0;            // stiffness, where it is given
  EnergyTerms base;              // of the half square of the length at coordinates 0 of the unknown ones
  std::vector<int> coordinates;  // unknowns of the problem at one of its ends
  std::vector<EnergyTerms> by;   // of each
};

[[noreturn]] void refuse(const Scene& scene, int line, const std::string& what, const std::string& why) {
  throw InputError(fmt::format("{}:{}: {}: {}", scene.file, line, what, why));
}

double stiffness_of(const Element& element) {
  if (const auto* spring = std::get_if<LinearSpring>(&element.law)) return spring->stiffness;
  return std::get<PreloadedSpring>(element.law).stiffness;
}

PhasorTerms place_with(const PoseForm& form, PointRef p, const BalanceProblem& problem, int one) {
  Vec2 local = form.scene().local(p);
  for (std::size_t c = 0; c < problem.coordinates.size(); ++c) {
    const ParameterPlace& at = problem.coordinates[c].place;
    if (at.item != p.body || at.part != p.point) continue;
    (at.number == 0 ? local.x : local.y) = static_cast<int>(c) == one ? form.size() : 0.0;
  }
  return form.place(p.body, local);
}

std::vector<int> coordinates_of(PointRef p, const BalanceProblem& problem) {
  std::vector<int> out;
  for (std::size_t c = 0; c < problem.coordinates.size(); ++c) {
    const ParameterPlace& at = problem.coordinates[c].place;
    if (at.item == p.body && at.part == p.point) out.push_back(static_cast<int>(c));
  }
  return out;
}

SpringForm spring_form(const PoseForm& form, const BalanceProblem& problem, std::size_t at) {
  const Element& element = form.scene().elements[at];
  SpringForm out;
  out.element = at;
  out.given = stiffness_of(element);
  for (std::size_t k = 0; k < problem.stiffnesses.size(); ++k) {
    if (problem.stiffnesses[k].place.item == static_cast<int>(at)) out.stiffness = static_cast<int>(k);
  }
  const std::vector<int> a = coordinates_of(element.on.a, problem), b = coordinates_of(element.on.b, problem);
  if (!a.empty() && !b.empty()) {
    refuse(form.scene(), element.line, element.family() + " \"" + element.name + "\"",
           "expected points to choose at one of its ends, found both; give the coordinates of one");
  }
  out.coordinates = a.empty() ? b : a;
  const auto half_square_with = [&](int one) {
    return half_square(place_with(form, element.on.a, problem, one), place_with(form, element.on.b, problem, one));
  };
  out.base = half_square_with(-1);
  for (const int c : out.coordinates) {
    // The square of the coordinate itself is the same in all poses; what is left is linear in it.
    EnergyTerms by = sum(half_square_with(c), out.base, -1.0);
    for (auto& [function, coefficient] : by) coefficient = (1 / form.size()) * coefficient;
    out.by.push_back(std::move(by));
  }
  return out;
}

// A spring that acts, or whose stiffness is sought.
bool takes_part(const BalanceProblem& problem, std::size_t at) {
  const Law& law = problem.scene.elements[at].law;
  const auto is_sought = [&](const FreeNumber& n) { return n.place.item == static_cast<int>(at); };
  return std::any_of(problem.stiffnesses.begin(), problem.stiffnesses.end(), is_sought) ||
         (stores_energy(law) && idle(law).empty());
}

std::vector<SpringForm> spring_forms(const PoseForm& form, const BalanceProblem& problem) {
  std::vector<SpringForm> out;
  std::vector<int> users(problem.coordinates.size(), 0);
  std::vector<char> with_stiffness(problem.coordinates.size(), 0);
  for (std::size_t i = 0; i < form.scene().elements.size(); ++i) {
    const Element& element = form.scene().elements[i];
    if (!takes_part(problem, i)) continue;
    if (!has_no_free_length(element)) {
      refuse(form.scene(), element.line, element.family() + " \"" + element.name + "\"",
             "balances no weight in every position, since its force is not proportional to its length; give it "
             "free_length = 0, or add over = { \"angle.BODY\" = [FROM, TO] } for the best there is in a range");
    }
    out.push_back(spring_form(form, problem, i));
    for (const int c : out.back().coordinates) {
      ++users[c];
      if (out.back().stiffness >= 0) with_stiffness[c] = 1;
    }
  }
  for (std::size_t c = 0; c < users.size(); ++c) {
    const std::string& path = problem.coordinates[c].path;
    if (users[c] == 0)
      throw InputError(fmt::format("{}:{}: {}: no spring is fixed there", problem.file, problem.line, path));
    if (users[c] > 1 && with_stiffness[c] != 0) {
      throw InputError(
          fmt::format("{}:{}: {}: several springs are fixed there, with stiffnesses to choose; give each "
                      "spring a point of its own",
                      problem.file, problem.line, path));
    }
  }
  return out;
}

// The equations for the unknowns: stiffnesses, then for each coordinate itself or its product with the stiffness.
struct Equations {
  std::vector<SpringForm> springs;
  EnergyTerms given;
  FunctionSpace space;
  BoundedSystem system;
  std::vector<int> times_stiffness;  // per coordinate: the stiffness that it is multiplied with, or -1
};

std::vector<EnergyTerms> all_energies(const std::vector<SpringForm>& springs, const EnergyTerms& given) {
  std::vector<EnergyTerms> out{given};
  for (const SpringForm& spring : springs) {
    out.push_back(spring.base);
    out.insert(out.end(), spring.by.begin(), spring.by.end());
  }
  return out;
}

void fill_bounds(const BalanceProblem& problem, Equations& e) {
  const auto n_k = static_cast<Eigen::Index>(problem.stiffnesses.size());
  const auto n = n_k + static_cast<Eigen::Index>(problem.coordinates.size());
  BoundedSystem& s = e.system;
  s.g = Eigen::MatrixXd::Zero(2 * n, n);
  s.h = Eigen::VectorXd::Zero(2 * n);
  s.cost = Eigen::VectorXd::Zero(n);
  s.near = Eigen::VectorXd::Zero(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const bool is_k = j < n_k;
    const FreeNumber& number = is_k ? problem.stiffnesses[static_cast<std::size_t>(j)]
                                    : problem.coordinates[static_cast<std::size_t>(j - n_k)];
    const int factor = is_k ? -1 : e.times_stiffness[static_cast<std::size_t>(j - n_k)];
    s.g(2 * j, j) = 1.0;
    s.g(2 * j + 1, j) = -1.0;
    if (factor < 0) {
      s.h[2 * j] = number.max;
      s.h[2 * j + 1] = -number.min;
    } else {
      s.g(2 * j, factor) = -number.max;
      s.g(2 * j + 1, factor) = number.min;
    }
    if (is_k) s.cost[j] = 1.0;
    const double now = value_at(problem.scene, number.place).value_or(0.0);
    s.near[j] = factor < 0 ? std::clamp(now, number.min, number.max) : 0.0;
  }
}

Equations equations_of(const PoseForm& form, const BalanceProblem& problem, const std::vector<PlacedLoad>& loads) {
  std::vector<SpringForm> springs = spring_forms(form, problem);
  EnergyTerms of_loads;
  for (const PlacedLoad& load : loads) of_loads = sum(std::move(of_loads), potential(load.place, load.force));
  EnergyTerms given = of_loads;
  for (const SpringForm& spring : springs) {
    if (spring.stiffness < 0) given = sum(std::move(given), spring.base, spring.given);
  }
  FunctionSpace space(form, all_energies(springs, given));
  Equations e{std::move(springs), std::move(given), std::move(space), {}, {}};
  e.times_stiffness.assign(problem.coordinates.size(), -1);
  const auto n_k = static_cast<Eigen::Index>(problem.stiffnesses.size());
  const auto rows = static_cast<Eigen::Index>(e.space.components().size());
  e.system.a = Eigen::MatrixXd::Zero(rows, n_k + static_cast<Eigen::Index>(problem.coordinates.size()));
  e.system.b = -e.space.vector(e.given);
  if (rows > 0) e.system.size = e.space.vector(of_loads).cwiseAbs().maxCoeff();
  for (const SpringForm& spring : e.springs) {
    if (spring.stiffness >= 0) e.system.a.col(spring.stiffness) += e.space.vector(spring.base);
    for (std::size_t c = 0; c < spring.coordinates.size(); ++c) {
      const int at = spring.coordinates[c];
      e.times_stiffness[at] = spring.stiffness;
      e.system.a.col(n_k + at) += (spring.stiffness >= 0 ? 1.0 : spring.given) * e.space.vector(spring.by[c]);
    }
  }
  fill_bounds(problem, e);
  return e;
}

// What the unknowns can give each term: bounds of a row of a x, from the ranges alone.
void add_reach(const BalanceProblem& problem, const Equations& e, std::size_t row, EnergyTerm& term) {
  const std::size_t n_k = problem.stiffnesses.size();
  for (std::size_t j = 0; j < n_k + problem.coordinates.size(); ++j) {
    const double a = e.system.a(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(j));
    double least = 0.0, most = 0.0;
    if (j < n_k) {
      least = problem.stiffnesses[j].min;
      most = problem.stiffnesses[j].max;
    } else {
      const FreeNumber& number = problem.coordinates[j - n_k];
      const int factor = e.times_stiffness[j - n_k];
      least = number.min;
      most = number.max;
      if (factor >= 0) {
        const FreeNumber& k = problem.stiffnesses[factor];
        least = std::min(k.min * number.min, k.max * number.min);
        most = std::max(k.min * number.max, k.max * number.max);
      }
    }
    term.least += std::min(a * least, a * most);
    term.most += std::max(a * least, a * most);
  }
}

// Largest sizes of the unknowns within their bounds.
Eigen::VectorXd largest_unknowns(const BalanceProblem& problem, const Equations& e) {
  const std::size_t n_k = problem.stiffnesses.size();
  Eigen::VectorXd out(static_cast<Eigen::Index>(n_k + problem.coordinates.size()));
  for (std::size_t k = 0; k < n_k; ++k) out[static_cast<Eigen::Index>(k)] = problem.stiffnesses[k].max;
  for (std::size_t c = 0; c < problem.coordinates.size(); ++c) {
    const FreeNumber& number = problem.coordinates[c];
    const int factor = e.times_stiffness[c];
    const double size = std::max(std::abs(number.min), std::abs(number.max));
    out[static_cast<Eigen::Index>(n_k + c)] = size * (factor >= 0 ? problem.stiffnesses[factor].max : 1.0);
  }
  return out;
}

// The scene with what was found, and that in SI.
void put_in_place(const BalanceProblem& problem, const Equations& e, const Eigen::VectorXd& x, double size_of_scene,
                  WeightBalance& out) {
  constexpr double rounding = 1e-14;
  const std::size_t n_k = problem.stiffnesses.size();
  for (std::size_t k = 0; k < n_k; ++k) {
    const FreeNumber& number = problem.stiffnesses[k];
    out.found.push_back(std::clamp(x[static_cast<Eigen::Index>(k)], number.min, number.max));
    set_value_at(out.scene, number.place, out.found.back());
  }
  for (std::size_t c = 0; c < problem.coordinates.size(); ++c) {
    const FreeNumber& number = problem.coordinates[c];
    const int factor = e.times_stiffness[c];
    double at = x[static_cast<Eigen::Index>(n_k + c)];
    if (factor >= 0) {
      // A spring of stiffness zero has its end anywhere: it stays.
      at = out.found[factor] > 0.0 ? at / out.found[factor] : value_at(problem.scene, number.place).value_or(0.0);
    }
    // What is rounding of zero is zero.
    if (std::abs(at) < rounding * size_of_scene) at = 0.0;
    out.found.push_back(std::clamp(at, number.min, number.max));
    set_value_at(out.scene, number.place, out.found.back());
  }
}

// The energy of the springs that were sought, with the numbers of a scene.
EnergyTerms found_energy(const Equations& e, const BalanceProblem& problem, const Scene& scene) {
  EnergyTerms out;
  for (const SpringForm& spring : e.springs) {
    const double k = spring.stiffness >= 0 ? stiffness_of(scene.elements[spring.element]) : spring.given;
    if (spring.stiffness >= 0) out = sum(std::move(out), spring.base, k);
    for (std::size_t c = 0; c < spring.coordinates.size(); ++c) {
      const ParameterPlace& place = problem.coordinates[spring.coordinates[c]].place;
      out = sum(std::move(out), spring.by[c], k * value_at(scene, place).value_or(0.0));
    }
  }
  return out;
}

}  // namespace

bool has_no_free_length(const Element& element) {
  if (element.on.kind != Measure::Kind::distance) return false;
  if (const auto* spring = std::get_if<LinearSpring>(&element.law)) {
    return spring->free_length == 0.0 && spring->acts != SpringActs::compression;
  }
  return false;
}

bool may_be_exact(const BalanceProblem& problem) {
  for (std::size_t i = 0; i < problem.scene.elements.size(); ++i) {
    if (takes_part(problem, i) && !has_no_free_length(problem.scene.elements[i])) return false;
  }
  return true;
}

std::vector<PlacedLoad> placed_loads(const PoseForm& form) {
  const Scene& scene = form.scene();
  if (!scene.time_functions.empty()) {
    throw InputError(scene.file +
                     ": balancing needs loads that stay, found one that follows a function of time; leave "
                     "it out");
  }
  for (const Torque& torque : scene.torques) {
    refuse(scene, torque.line, "torque \"" + torque.name + "\"",
           "no spring between points balances a torque that is the same in all positions; leave it out");
  }
  std::vector<PlacedLoad> out;
  for (std::size_t b = 1; b < scene.bodies.size(); ++b) {
    const Body& body = scene.bodies[b];
    if (body.mass == 0.0) continue;
    out.push_back({body.name, form.place(static_cast<int>(b), body.center), body.mass * scene.gravity});
  }
  for (const Force& force : scene.forces) {
    if (force.follows >= 0) {
      refuse(scene, force.line, "force \"" + force.name + "\"",
             "a force that turns with a body has no potential, so that nothing balances it in every position; leave it "
             "out");
    }
    const double share = scene.share_at_points<double>(force);
    force.for_each_point([&](PointRef p) { out.push_back({force.name, form.place(p), share * force.vector}); });
  }
  return out;
}

double total_size(const std::vector<PlacedLoad>& loads) {
  double out = 0.0;
  for (const PlacedLoad& load : loads) out += norm(load.force);
  return out;
}

PosesChecked check_in_poses(const Scene& scene, int poses, double weight) {
  constexpr int tries_for_each = 20;
  PosesChecked out;
  out.weight = weight;
  Scene loose = scene;
  loose.stops.clear();
  const PoseForm form(loose);
  const StaticModel model(loose);
  const std::vector<int> no_stops;
  for (int k = 0; out.poses < poses && k < tries_for_each * poses; ++k) {
    solvers::RandomStream random(23, 0, static_cast<std::uint64_t>(k));
    std::vector<double> q = form.start();
    for (const int t : form.coordinates()) {
      q[t] += form.is_length(t) ? form.size() * random.uniform(-0.5, 0.5)
                                : random.uniform(-std::numbers::pi, std::numbers::pi);
    }
    q = form.closed(std::move(q));
    if (q.empty()) continue;
    const std::map<std::string, double> named = form.named(q);
    std::vector<double> own;
    for (int t = 0; t < model.layout().kept; ++t) own.push_back(named.at(model.layout().coordinates[t].name));
    const Check found = check(model, model.from_si(own), {}, &no_stops);
    ++out.poses;
    out.imbalance = std::max(out.imbalance, found.imbalance);
  }
  return out;
}

WeightBalance balance_weights(const BalanceProblem& problem) {
  constexpr double exact = 1e-12;
  constexpr int poses = 100;
  WeightBalance out;
  out.scene = problem.scene;
  const PoseForm form(problem.scene);
  const std::vector<PlacedLoad> loads = placed_loads(form);
  if (form.coordinates().empty() || total_size(loads) == 0.0) {
    throw InputError(fmt::format("{}: expected {}", problem.scene.file,
                                 form.coordinates().empty() ? "bodies that can move; all are held"
                                                            : "weights or loads to balance; add mass, or gravity"));
  }
  const Equations e = equations_of(form, problem, loads);
  out.closures = static_cast<int>(form.closures().size());
  out.relations = e.space.relations();
  out.parallelograms = form.parallelograms();
  out.complete = e.space.is_complete();
  const BoundedSolution solution = solve(e.system);
  Eigen::VectorXd springs = Eigen::VectorXd::Zero(e.system.b.size());
  if (solution.solved) {
    put_in_place(problem, e, solution.x, form.size(), out);
    springs = e.space.vector(found_energy(e, problem, out.scene));
  } else {
    out.refuted = is_refutation(e.system, solution, largest_unknowns(problem, e));
    out.row = solution.row;
    out.demand = solution.demand;
    out.most = solution.most;
  }
  const double size = e.system.b.size() > 0 ? std::max({e.system.size, e.system.b.cwiseAbs().maxCoeff(), 1e-300}) : 1.0;
  for (std::size_t r = 0; r < e.space.components().size(); ++r) {
    const auto at = static_cast<Eigen::Index>(r);
    EnergyTerm term{e.space.name(e.space.components()[r]), -e.system.b[at], springs[at]};
    if (!solution.solved && solution.y.size() > 0) term.multiplier = solution.y[at];
    add_reach(problem, e, r, term);
    if (solution.solved) out.residual = std::max(out.residual, std::abs(term.weights + term.springs) / size);
    out.terms.push_back(std::move(term));
  }
  if (solution.solved) {
    out.check = check_in_poses(out.scene, poses, total_size(loads));
    const bool rests = out.check.poses > 0 && out.check.imbalance <= 1e-9 * out.check.weight;
    out.balanced = out.residual <= exact && rests;
  }
  return out;
}

}  // namespace poise
