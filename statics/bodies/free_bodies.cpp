#include "statics/bodies/free_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "solvers/linear_algebra.hpp"
#include "solvers/nonnegative_least_squares.hpp"
#include "statics/bodies/forces_on_bodies.hpp"
#include "statics/bodies/free_body_equations.hpp"
#include "statics/bodies/minimum_norm.hpp"

namespace poise {
namespace {

using Equations = FreeBodyEquations<BodyPose<double>>;

// A pull of a stop, over the largest force, that is rounding.
constexpr double no_pull = 1e-9;

// The reactions of the items of equations, without forces.
std::vector<Reaction> reactions_of(const Equations& equations) {
  std::vector<Reaction> out;
  out.reserve(equations.items().size());
  for (const Equations::Item& item : equations.items()) {
    Reaction& reaction = out.emplace_back();
    reaction.name = *item.name;
    reaction.kind = item.kind;
    reaction.joint = item.joint;
    reaction.stop = item.stop;
    reaction.at = item.at;
  }
  for (const Equations::Unknown& unknown : equations.unknowns()) {
    Reaction& reaction = out[static_cast<std::size_t>(unknown.item)];
    reaction.body_a = unknown.body_a;
    reaction.body_b = unknown.body_b;
  }
  return out;
}

class Statics {
 public:
  Statics(const Scene& scene, const std::vector<BodyPose<double>>& poses, double size, const Additions& additions)
      : scene_(scene), poses_(poses), size_(size), additions_(additions) {
    const Equations equations(scene, poses, size);
    load_ = Eigen::VectorXd::Zero(equations.rows());
    const auto push_on = [&](int body, Vec2 at, Vec2 force, double moment) {
      push(equations, body, at, force, moment);
    };
    equations.push_loads(push_on);
    for (const BodyLoad& load : additions.loads) push_on(load.body, load.at, load.force, load.moment);
    out_.largest_applied = out_.largest_load;
    out_.element_force = equations.push_elements(push_on);
  }

  // With the reactions of stops that act on these sides. What other sides leave undetermined remains so.
  // Teeth push their wheels apart by the sizes of their efforts, which do not depend on that.
  FreeBodies solve(const std::vector<int>& sides) {
    signs_.assign(scene_.stops.size(), 0.0);
    find(sides);
    if (additions_.teeth_separate &&
        std::any_of(found_signs_.begin(), found_signs_.end(), [](double s) { return s != 0; })) {
      signs_ = found_signs_;
      find(sides);
    }
    for (Reaction& reaction : out_.reactions) {
      if (!reaction.determined) undetermined_.insert({reaction.kind, reaction.name});
      reaction.determined = !undetermined_.contains({reaction.kind, reaction.name});
    }
    return out_;
  }

  void find(const std::vector<int>& sides) {
    const Equations equations = with_stops(sides);
    const Eigen::SparseMatrix<double> a = matrix(equations, [](const Equations::Unknown&) { return true; });
    MinimumNorm reactions(a);
    const Eigen::VectorXd f = reactions.solve(-load_);
    report(equations, a, f, reactions.null_space());
  }

  // Some stop of the solution pulls where it can only push.
  bool any_pulls() const { return !pulled_.empty(); }

  // The sides of the stops that push in the set of least norm among those in which all of them push, and no other stop
  // acts; where no set balances all forces, in the non-negative least-squares solution.
  std::vector<int> pushing(const std::vector<int>& sides) {
    const OneSided stops = one_sided(sides);
    const Eigen::VectorXd push = solvers::nonnegative_least_squares(stops.balance, stops.load);
    std::vector<bool> idle;
    for (const double p : push) idle.push_back(p <= 0.0);
    if (stops.balances(push)) {
      idle = solvers::zeros_of_least_norm(stops.balance, push, stops.norm, stops.others);
    } else {
      note_pulling(stops);
    }
    return stops.without(idle, sides);
  }

  // The least-squares solution alone, should rounding leave one that pulls.
  std::vector<int> pushing_somehow(const std::vector<int>& sides) {
    const OneSided stops = one_sided(sides);
    std::vector<bool> idle;
    for (const double p : solvers::nonnegative_least_squares(stops.balance, stops.load)) idle.push_back(p <= 0.0);
    return stops.without(idle, sides);
  }

  // Marks the reactions of stops without which the others that touch carry the loads too.
  void mark_idle(const std::vector<int>& sides, FreeBodies& bodies) {
    const auto is_undetermined = [](const Reaction& r) { return r.of_stop() && !r.determined; };
    if (std::none_of(bodies.reactions.begin(), bodies.reactions.end(), is_undetermined)) return;
    const OneSided stops = one_sided(sides);
    for (std::size_t k = 0; k < stops.index.size(); ++k) {
      const auto reaction = std::find_if(bodies.reactions.begin(), bodies.reactions.end(), [&](const Reaction& r) {
        return is_undetermined(r) && r.stop == stops.index[k];
      });
      if (reaction == bodies.reactions.end()) continue;
      Eigen::MatrixXd others = stops.balance;
      others.col(static_cast<Eigen::Index>(k)).setZero();
      OneSided without = stops;
      without.balance = others;
      if (without.balances(solvers::nonnegative_least_squares(others, stops.load))) reaction->may_be_idle = true;
    }
  }

 private:
  // Stops that push on one side only, with p >= 0 their forces. All else that acts is free, f = -A_f^+ (A_s p + load),
  // so that the bodies balance where  balance p = load  with what A_f cannot balance,  P A_s p = -P load,  and the
  // whole set has the norm of  norm p + others.
  struct OneSided {
    std::vector<int> index;  // of Scene::stops
    Eigen::MatrixXd balance, norm;
    Eigen::VectorXd load, others;
    double largest = 0.0;  // force

    bool balances(const Eigen::VectorXd& p) const { return (balance * p - load).norm() <= no_pull * largest; }
    std::vector<int> without(const std::vector<bool>& idle, std::vector<int> sides) const {
      for (std::size_t k = 0; k < index.size(); ++k) {
        if (idle[k]) sides[static_cast<std::size_t>(index[k])] = 0;
      }
      return sides;
    }
  };

  OneSided one_sided(const std::vector<int>& sides) const {
    OneSided out;
    out.largest = out_.largest_force;
    const Equations equations = with_stops(sides);
    std::vector<Eigen::VectorXd> columns;
    const auto is_one_sided = [&](const Equations::Unknown& u) {
      return std::abs(equations.items()[u.item].side) == 1;
    };
    for (const Equations::Unknown& u : equations.unknowns()) {
      if (!is_one_sided(u)) continue;
      const Equations::Item& item = equations.items()[u.item];
      Eigen::VectorXd& column = columns.emplace_back(Eigen::VectorXd::Zero(load_.size()));
      equations.for_each_entry(u, [&](int row, double value) { column[row] -= item.side * value; });
      out.index.push_back(item.stop);
    }
    const Eigen::SparseMatrix<double> free =
        matrix(equations, [&](const Equations::Unknown& u) { return !is_one_sided(u); });
    MinimumNorm reactions(free);
    const auto count = static_cast<Eigen::Index>(columns.size());
    // One row more than needed, so that there are not fewer rows than columns.
    Eigen::MatrixXd left = Eigen::MatrixXd::Zero(std::max(load_.size(), count + 1), count + 1);
    Eigen::MatrixXd carried = Eigen::MatrixXd::Zero(free.cols() + count + 1, count + 1);
    carried.topLeftCorner(count, count).setIdentity();
    for (Eigen::Index k = 0; k <= count; ++k) {
      const Eigen::VectorXd column = k < count ? columns[static_cast<std::size_t>(k)] : Eigen::VectorXd(-load_);
      const Eigen::VectorXd f = reactions.solve(column);
      carried.col(k).segment(count, free.cols()) = f;
      left.col(k).head(load_.size()) = column - free * f;
    }
    const Eigen::MatrixXd balance = solvers::triangular_factor(left), norm = solvers::triangular_factor(carried);
    out.balance = balance.leftCols(count);
    out.load = balance.col(count);
    out.norm = norm.leftCols(count);
    out.others = -norm.col(count);
    return out;
  }

  // Where only stops that pull could balance all forces: some of those of the set of least norm, of which none can be
  // left out.
  void note_pulling(const OneSided& stops) {
    Eigen::MatrixXd both(stops.balance.rows(), 2 * stops.balance.cols());
    both << stops.balance, Eigen::MatrixXd::Zero(stops.balance.rows(), stops.balance.cols());
    const auto pulls = [&](std::size_t k) { return both.col(stops.balance.cols() + static_cast<Eigen::Index>(k)); };
    const auto balances = [&] {
      const Eigen::VectorXd p = solvers::nonnegative_least_squares(both, stops.load);
      return (both * p - stops.load).norm() <= no_pull * stops.largest;
    };
    for (std::size_t k = 0; k < stops.index.size(); ++k) {
      const bool pulled = std::find(pulled_.begin(), pulled_.end(), stops.index[k]) != pulled_.end();
      if (pulled) pulls(k) = -stops.balance.col(static_cast<Eigen::Index>(k));
    }
    out_.pulling.clear();
    if (!balances()) return;
    for (std::size_t k = 0; k < stops.index.size(); ++k) {
      if (pulls(k).isZero(0.0)) continue;
      const Eigen::VectorXd column = pulls(k);
      pulls(k).setZero();
      if (balances()) continue;
      pulls(k) = column;
      out_.pulling.push_back(stops.index[k]);
    }
  }

  Equations with_stops(const std::vector<int>& sides) const {
    Equations out(scene_, poses_, size_);
    out.add_joints();
    for (std::size_t i = 0; i < sides.size(); ++i) {
      if (sides[i] != 0) out.add_stop(static_cast<int>(i), sides[i], signs_[i]);
    }
    for (std::size_t b = 0; additions_.blades && b < scene_.blades.size(); ++b) out.add_blade(static_cast<int>(b));
    for (const Drive& drive : additions_.drives) out.add_drive(drive);
    return out;
  }

  void push(const Equations& equations, int body, Vec2 at, Vec2 force, double moment) {
    if (body == 0) return;
    const Eigen::Index row = 3 * (body - 1);
    const double turning = equations.turning(body, at, force, moment);
    load_[row] += force.x;
    load_[row + 1] += force.y;
    load_[row + 2] += turning;
    out_.largest_load = std::max({out_.largest_load, norm(force), std::abs(turning)});
  }

  // The columns of those unknowns that are `wanted`.
  template <class Wanted>
  Eigen::SparseMatrix<double> matrix(const Equations& equations, Wanted wanted) const {
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(4 * equations.unknowns().size());
    int column = 0;
    for (const Equations::Unknown& u : equations.unknowns()) {
      if (!wanted(u)) continue;
      equations.for_each_entry(u, [&](int row, double value) { entries.emplace_back(row, column, value); });
      ++column;
    }
    Eigen::SparseMatrix<double> a(load_.size(), column);
    a.setFromTriplets(entries.begin(), entries.end());
    return a;
  }

  void report(const Equations& equations, const Eigen::SparseMatrix<double>& a, const Eigen::VectorXd& f,
              const TouchedNullSpace& self_stress) {
    const Eigen::VectorXd left = load_ + a * f;
    Eigen::Index worst = 0;
    out_.imbalance = left.size() > 0 ? left.cwiseAbs().maxCoeff(&worst) : 0.0;
    out_.worst_body = static_cast<int>(worst) / 3 + 1;
    out_.is_moment = worst % 3 == 2;
    out_.redundancy = std::max(out_.redundancy, self_stress.dimension);
    out_.largest_force = std::max(out_.largest_load, f.size() > 0 ? f.cwiseAbs().maxCoeff() : 0.0);
    out_.reactions = reactions_of(equations);
    pulled_.clear();
    found_signs_.assign(scene_.stops.size(), 0.0);
    for (Eigen::Index u = 0; u < f.size(); ++u) {
      const Equations::Unknown& unknown = equations.unknowns()[static_cast<std::size_t>(u)];
      const Equations::Item& item = equations.items()[static_cast<std::size_t>(unknown.item)];
      Reaction& reaction = out_.reactions[static_cast<std::size_t>(unknown.item)];
      reaction.force += f[u] * unknown.force;
      reaction.moment += f[u] * unknown.moment;
      if (!unknown.with.empty()) add_parts(equations, unknown, f[u], reaction.parts);
      if (self_stress.touches[static_cast<std::size_t>(u)]) reaction.determined = false;
      if (item.axial) reaction.axial = -f[u];
      if (item.stop >= 0 && separates(scene_.stops[static_cast<std::size_t>(item.stop)])) {
        found_signs_[static_cast<std::size_t>(item.stop)] = f[u] < 0 ? -1.0 : f[u] > 0 ? 1.0 : 0.0;
      }
      if (std::abs(item.side) == 1 && item.side * f[u] > no_pull * out_.largest_force) pulled_.push_back(item.stop);
    }
    out_.pressing.clear();
    for (std::size_t k = 0; k < out_.reactions.size(); ++k) {
      const Reaction& reaction = out_.reactions[k];
      const double pressure = std::max(norm(reaction.force), std::abs(reaction.moment) / size_);
      const int stop = equations.items()[k].stop;
      if (stop >= 0 && pressure > 1e-10 * out_.largest_force) out_.pressing.push_back(stop);
    }
  }

  static void add_parts(const Equations& equations, const Equations::Unknown& unknown, double effort,
                        std::vector<BodyForce>& parts) {
    equations.for_each_action(unknown, [&](int body, Vec2 at, Vec2 force, double moment) {
      add_at_place({.body = body, .at = at, .force = effort * force, .moment = effort * moment}, parts);
    });
  }

  const Scene& scene_;
  const std::vector<BodyPose<double>>& poses_;
  double size_;
  const Additions& additions_;
  Eigen::VectorXd load_;
  FreeBodies out_;
  std::set<std::pair<std::string, std::string>> undetermined_;  // kinds and names
  std::vector<double> signs_, found_signs_;  // per stop: of the efforts of teeth that push their wheels apart
  std::vector<int> pulled_;                  // stops of the last set found that pull where they can only push
};

}  // namespace

FreeBodies balance(const Scene& scene, const std::vector<BodyPose<double>>& poses, const std::vector<int>& touching,
                   double size, const Additions& additions) {
  Statics statics(scene, poses, size, additions);
  FreeBodies out = statics.solve(touching);
  if (statics.any_pulls()) out = statics.solve(statics.pushing(touching));
  if (statics.any_pulls()) out = statics.solve(statics.pushing_somehow(touching));
  if (out.pulling.empty()) statics.mark_idle(touching, out);
  return out;
}

Reaction idle_reaction(const Scene& scene, const std::vector<BodyPose<double>>& poses, int stop) {
  Equations equations(scene, poses, 1.0);
  equations.add_stop(stop, 2);
  Reaction out = reactions_of(equations).front();
  out.determined = false;
  out.may_be_idle = true;
  return out;
}

}  // namespace poise
