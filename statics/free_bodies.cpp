#include "statics/free_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "solvers/linear_algebra.hpp"
#include "solvers/nonnegative_least_squares.hpp"
#include "statics/forces_on_bodies.hpp"
#include "statics/free_body_equations.hpp"
#include "statics/minimum_norm.hpp"

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
    reaction.of_stop = item.stop >= 0;
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
  bool any_pulls() const { return pulls_; }

  // The sides of the stops that push in the non-negative least-squares solution, in which all that can act either way
  // is free:  min |A_f f + A_s p + load|,  p >= 0.  With P the projection on what A_f cannot balance, p is that of
  // min |P A_s p + P load|.
  std::vector<int> pushing(std::vector<int> sides) {
    const Equations equations = with_stops(sides);
    std::vector<int> stops;
    std::vector<Eigen::VectorXd> columns;
    const auto is_one_sided = [&](const Equations::Unknown& u) {
      return std::abs(equations.items()[u.item].side) == 1;
    };
    for (const Equations::Unknown& u : equations.unknowns()) {
      if (!is_one_sided(u)) continue;
      const Equations::Item& item = equations.items()[u.item];
      Eigen::VectorXd& column = columns.emplace_back(Eigen::VectorXd::Zero(load_.size()));
      equations.for_each_entry(u, [&](int row, double value) { column[row] -= item.side * value; });
      stops.push_back(item.stop);
    }
    const Eigen::SparseMatrix<double> free =
        matrix(equations, [&](const Equations::Unknown& u) { return !is_one_sided(u); });
    MinimumNorm reactions(free);
    const auto count = static_cast<Eigen::Index>(columns.size());
    // One row more than the load has, so that there are not fewer rows than columns.
    Eigen::MatrixXd projected = Eigen::MatrixXd::Zero(std::max(load_.size(), count + 1), count + 1);
    const auto project = [&](const Eigen::VectorXd& v) -> Eigen::VectorXd { return v - free * reactions.solve(v); };
    for (Eigen::Index k = 0; k < count; ++k) {
      projected.col(k).head(load_.size()) = project(columns[static_cast<std::size_t>(k)]);
    }
    projected.col(count).head(load_.size()) = project(-load_);
    const Eigen::MatrixXd reduced = solvers::triangular_factor(projected);
    const Eigen::VectorXd push = solvers::nonnegative_least_squares(reduced.leftCols(count), reduced.col(count));
    for (Eigen::Index k = 0; k < count; ++k) {
      if (push[k] <= 0.0) sides[static_cast<std::size_t>(stops[static_cast<std::size_t>(k)])] = 0;
    }
    return sides;
  }

 private:
  Equations with_stops(const std::vector<int>& sides) const {
    Equations out(scene_, poses_, size_);
    out.add_joints();
    for (std::size_t i = 0; i < sides.size(); ++i) {
      if (sides[i] != 0) out.add_stop(static_cast<int>(i), sides[i], signs_[i]);
    }
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
    pulls_ = false;
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
      if (std::abs(item.side) == 1 && item.side * f[u] > no_pull * out_.largest_force) pulls_ = true;
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
  bool pulls_ = false;
};

}  // namespace

FreeBodies balance(const Scene& scene, const std::vector<BodyPose<double>>& poses, const std::vector<int>& touching,
                   double size, const Additions& additions) {
  Statics statics(scene, poses, size, additions);
  FreeBodies out = statics.solve(touching);
  return statics.any_pulls() ? statics.solve(statics.pushing(touching)) : out;
}

Reaction idle_reaction(const Scene& scene, const std::vector<BodyPose<double>>& poses, int stop) {
  Equations equations(scene, poses, 1.0);
  equations.add_stop(stop, 2);
  Reaction out = reactions_of(equations).front();
  out.determined = false;
  return out;
}

}  // namespace poise
