#include "statics/check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "solvers/kkt.hpp"
#include "solvers/linear_algebra.hpp"
#include "solvers/newton.hpp"
#include "statics/body_measures.hpp"
#include "statics/curvature.hpp"
#include "statics/free_bodies.hpp"
#include "statics/kinks.hpp"
#include "statics/reference.hpp"
#include "statics/singular_configuration.hpp"

namespace poise {
namespace {

// Number of coordinates up to which all curvatures are computed; above, only their signs are counted.
constexpr int all_curvatures = 300;
// Curvatures below this share of the tangent are computed in 50 digits.
constexpr double doubtful_below = 1e-6;
constexpr std::size_t most_directions = 6;
// Reactions of so many times the loads may hide an imbalance: 50 digits then decide.
constexpr double heavy_reactions = 1e3;
// Share of the largest force that rounding of stiff springs may leave unbalanced without a further check, and at most.
constexpr double rounding_forgiven = 1e-6;
constexpr double worst_reactions = 1e-3;
// Possible distance, by rounding, of a search's result from an equilibrium with vanishing curvature: the cube root of
// eps and more.
constexpr double beside_a_cusp = 1e-4;
// A direction counts as neutral if over this distance along it the imbalance is at most this share of the largest
// stiffness.
constexpr double flat_over = 1e-3;
constexpr double flat_within = 2e-14;
constexpr double closure_rounding = 4 * std::numeric_limits<double>::epsilon();
// Gap caused by rounding of the coordinates.
constexpr double least_accuracy = 4 * std::numeric_limits<double>::epsilon();
// Share of the smallest curvature up to which a Newton step cannot have passed a fold.
constexpr double safe_step = 1e-2;
constexpr double no_length = 1e-12;  // of the mechanism's size
// Rounding of the forces on a coordinate, scaled to order one: some units in the last place.
constexpr double force_rounding = 64 * std::numeric_limits<double>::epsilon();

// Gap of a joint between the poses of its two bodies, m.
double gap(const Scene& scene, const Joint& joint, const std::vector<BodyPose<double>>& poses, double size) {
  const BodyPose<double>& a = poses[joint.a.body];
  const BodyPose<double>& b = poses[joint.b.body];
  const Vec2 d = b.world(scene.local(joint.b)) - a.world(scene.local(joint.a));
  double wide = norm(d);
  if (joint.keeps_length()) wide = std::abs(wide - joint.length);
  if (joint.has_travel()) wide = std::abs(cross(joint.axis * unit(a.angle), d));
  if (joint.keeps_angle()) {
    wide = std::max(wide, size * std::abs(std::remainder(b.angle - a.angle - joint.angle, 2 * M_PI)));
  }
  return wide;
}

bool is_finite(const std::vector<double>& x) {
  return std::all_of(x.begin(), x.end(), [](double v) { return std::isfinite(v); });
}

class EquilibriumCheck {
 public:
  EquilibriumCheck(const StaticModel& model, const std::vector<double>& x, const CheckTolerances& tolerances)
      : model_(model),
        scene_(model.scene()),
        x_(x),
        tolerances_(tolerances),
        poses_(model.poses(x)),
        size_(model.scales().length) {}

  Check run() {
    if (!is_finite(x_)) {
      out_.objection = "a coordinate is not a finite number";
      return out_;
    }
    measure_closure();
    measure_stops();
    balance_bodies();
    look_for_a_singular_configuration();
    if (out_.is_equilibrium())
      find_stability();
    else
      out_.stability_note = "only an equilibrium can be stable";
    return out_;
  }

 private:
  void object(const std::string& reason) {
    if (out_.objection.empty()) out_.objection = reason;
  }

  void measure_closure() {
    for (std::size_t j = 0; j < scene_.joints.size(); ++j) {
      const Joint& joint = scene_.joints[j];
      double wide = gap(scene_, joint, poses_, size_);
      // A travel that only closes a loop moves no body: it has to agree with the poses of the bodies.
      const int t = model_.layout().travel[j];
      if (t >= 0 && t < model_.layout().kept) {
        wide =
            std::max(wide, std::abs(value_of(scene_, Measure::travel_of(static_cast<int>(j)), poses_) - size_ * x_[t]));
      }
      if (wide > out_.closure_error || out_.worst_joint.empty()) {
        out_.closure_error = wide;
        out_.worst_joint = joint.name;
      }
    }
    out_.closed = out_.closure_error <= tolerances_.closure * size_;
    if (!out_.closed) {
      object(fmt::format("joint \"{}\" is open by {:.3g} {}", out_.worst_joint,
                         out_.closure_error / scene_.units.length, scene_.units.length_name));
    }
  }

  void measure_stops() {
    out_.stops_kept = true;
    for (const Stop& stop : scene_.stops) {
      const double unit_size = stop.on.is_angle() ? 1.0 : size_;
      const double g = value_of(scene_, stop.on, poses_);
      const double beyond = std::max({0.0, g - stop.max, stop.min - g}) / unit_size;
      const double near = tolerances_.stop * unit_size;
      const bool at_max = g >= stop.max - near;
      const bool at_min = g <= stop.min + near;
      touching_.push_back(at_max && at_min ? 2 : at_max ? 1 : at_min ? -1 : 0);
      if (beyond <= out_.stop_violation) continue;
      out_.stop_violation = beyond;
      out_.worst_stop = stop.name;
    }
    if (out_.stop_violation > tolerances_.stop) {
      out_.stops_kept = false;
      object(fmt::format("stop \"{}\" is overrun by {:.3g} of the mechanism's size", out_.worst_stop,
                         out_.stop_violation));
    }
  }

  void balance_bodies() {
    FreeBodies bodies = balance(scene_, poses_, touching_, size_);
    out_.imbalance = bodies.imbalance;
    out_.worst_body = scene_.bodies.size() > 1 ? scene_.bodies[bodies.worst_body].name : "";
    out_.largest_force = bodies.largest_force;
    out_.reactions = std::move(bodies.reactions);
    out_.redundancy = bodies.redundancy;
    pressing_ = bodies.pressing;
    largest_load_ = bodies.largest_load;
    if (const Element* cone = pushing_at_zero_length()) {
      object(fmt::format(
          "{} \"{}\" is compressed to length zero, where its force has no direction: no equilibrium is possible there",
          cone->family(), cone->name));
      return;
    }
    // The balance cannot be better than the change of force of the stiffest spring for a few rounding errors of
    // position.
    double stiffest = 0.0;
    for (const Element& e : scene_.elements) stiffest = std::max(stiffest, rounding_size(e));
    const double rounding = 1e-14 * stiffest;
    if (!std::isfinite(out_.imbalance) || !std::isfinite(out_.largest_force)) {
      object("forces overflow double precision, so balance cannot be checked");
      return;
    }
    out_.balanced = is_balanced(bodies, rounding);
    if (!out_.balanced) object(unbalanced_in_words(bodies, rounding));
  }

  // An imbalance by rounding is accepted if it is small compared with the forces, and if there are no forces beyond
  // rounding; where a very stiff spring makes it large, 50 digits have to find the same equilibrium, and even then the
  // reactions must have some accuracy.
  bool is_balanced(const FreeBodies& bodies, double rounding) const {
    const double force = bodies.largest_force;
    if (bodies.imbalance <= tolerances_.imbalance * force + std::min(rounding, rounding_forgiven * force)) return true;
    if (bodies.imbalance > rounding) return false;
    if (bodies.largest_applied == 0.0 && force <= rounding) return true;
    if (bodies.imbalance > worst_reactions * force || model_.mechanism().coordinates() > all_curvatures) return false;
    const Reference exact = refine(model_, x_);
    return exact.refined && exact.error <= tolerances_.closure;
  }

  // Force that an element would exert over the whole size of the quantities its measure is computed from.
  double rounding_size(const Element& e) const {
    const double k = std::abs(force_at_rest(e.law, value_of(scene_, e.on, poses_)).by_measure);
    if (!e.on.is_angle()) return k * size_;
    double turns = std::abs(value_of(scene_, e.on, poses_));
    if (e.on.kind == Measure::Kind::angle) {
      turns = std::abs(poses_[e.on.body_a].angle) + std::abs(poses_[e.on.body_b].angle);
    }
    if (const auto* spring = std::get_if<LinearSpring>(&e.law)) turns += std::abs(spring->free_length);
    return k * turns / size_;
  }

  // Its energy has the tip of a cone there, where no derivative exists.
  const Element* pushing_at_zero_length() const {
    for (const Element& e : scene_.elements) {
      if (e.on.kind != Measure::Kind::distance) continue;
      if (value_of(scene_, e.on, poses_) <= no_length * size_ && force_at_rest(e.law, 0.0).value < 0.0) return &e;
    }
    return nullptr;
  }

  std::string unbalanced_in_words(const FreeBodies& bodies, double rounding) const {
    const Units& units = scene_.units;
    const std::string amount =
        bodies.is_moment ? fmt::format("{:.3g} {} {}", bodies.imbalance * size_ / (units.force * units.length),
                                       units.force_name, units.length_name)
                         : fmt::format("{:.3g} {}", bodies.imbalance / units.force, units.force_name);
    return fmt::format(
        "body \"{}\" is out of balance by {} ({:.1g} of the largest force{}){}", out_.worst_body, amount,
        bodies.imbalance / bodies.largest_force, bodies.is_moment ? " times the mechanism's size" : "",
        bodies.imbalance <= rounding ? "; the stiffest spring limits the accuracy in double precision" : "");
  }

  // A pose where the closures lose rank may balance no load at all: within rounding errors of it reactions grow without
  // bound and seem to balance. Whether there is an equilibrium is then decided in 50 digits.
  void look_for_a_singular_configuration() {
    if (!out_.closed) return;
    if (!out_.balanced) {
      const std::optional<SingularConfiguration> singular = find_singular_configuration(model_, x_);
      if (!singular) return;
      out_.objection = fmt::format(
          "no finite joint forces balance the loads in this singular pose: its joints lock, only {} of {} closures are "
          "independent",
          singular->rank, singular->rank_beside);
    } else {
      if (out_.largest_force <= heavy_reactions * largest_load_ || model_.mechanism().coordinates() > all_curvatures ||
          lies_close_in_50_digits(tolerances_.position)) {
        return;
      }
      out_.balanced = false;
      object(
          "no finite joint forces balance the loads: here the joints lock (reactions of more than a thousand times the "
          "loads, and no equilibrium in 50 digits)");
    }
    out_.singular = true;
  }

  // Closure rows and active stops.
  std::vector<int> holding_rows() const {
    const Mechanism<double>& m = model_.mechanism();
    std::vector<int> rows(m.equalities());
    std::iota(rows.begin(), rows.end(), 0);
    for (int stop : pressing_) rows.push_back(m.stop_row(stop));
    return rows;
  }

  void find_stability() {
    const Mechanism<double>& m = model_.mechanism();
    const std::vector<int> rows = holding_rows();
    if (!m.has_follower_loads() && m.coordinates() > all_curvatures) {
      count_only(rows);
      return;
    }
    const ReducedHessian<double> reduced(m, x_, rows);
    if (reduced.matrix.size() == 0) {
      settle(0, 0);
      out_.accuracy = force_rounding;
      out_.stability_note = "held by its stops";
    } else if (m.has_follower_loads()) {
      check_followers(reduced);
    } else {
      check_curvatures(reduced);
    }
  }

  void check_curvatures(const ReducedHessian<double>& reduced) {
    const solvers::SymmetricEigen eigen = solvers::symmetric_eigen(reduced.matrix);
    std::vector<double> curvature(eigen.values.begin(), eigen.values.end());
    const bool doubtful = std::any_of(curvature.begin(), curvature.end(), [&](double c) {
      return std::abs(c) <= doubtful_below * std::max(1.0, reduced.largest);
    });
    const std::vector<int> kinks = springs_at_kinks(model_, x_);
    if (!kinks.empty()) {
      check_kinks(kinks, tolerances_.neutral * std::max(1.0, reduced.largest));
      return;
    }
    double smallest = std::numeric_limits<double>::infinity();
    for (double c : curvature) smallest = std::min(smallest, std::abs(c));
    // Near a fold a step as long as the distance to the fold may not converge.
    const double step = step_to_equilibrium(reduced);
    const bool beside_a_fold = !(step * std::max(1.0, reduced.largest) <= safe_step * smallest);
    if (doubtful || beside_a_fold) {
      const double within = doubtful ? beside_a_cusp : tolerances_.position;
      if (!check_in_50_digits(reduced, eigen.vectors, curvature, within)) return;
    } else if (!is_close(step)) {
      return;
    }
    const solvers::FullyPivotedLu stiffness(reduced.matrix);
    const auto solve = [&](const Eigen::VectorXd& right) { return Eigen::VectorXd(stiffness.solve(right)); };
    out_.accuracy = std::max({force_rounding / smallest, shift_by_rounded_closures(reduced, solve), least_accuracy});
    const Eigen::MatrixXd directions = reduced.basis * eigen.vectors;
    for (std::size_t k = 0; k < std::min(most_directions, curvature.size()); ++k) {
      out_.principal_directions.push_back(
          curvature_direction(curvature[k], directions.col(static_cast<Eigen::Index>(k))));
    }
    const double zero = tolerances_.neutral * std::max(1.0, reduced.largest);
    set_accuracy_across_neutral(reduced, eigen.vectors, curvature, zero);
    settle(static_cast<int>(std::count_if(curvature.begin(), curvature.end(), [&](double c) { return c < -zero; })),
           static_cast<int>(
               std::count_if(curvature.begin(), curvature.end(), [&](double c) { return std::abs(c) <= zero; })));
  }

  // As the accuracy, with the inverse of the stiffness on the eigenvectors that are not neutral.
  void set_accuracy_across_neutral(const ReducedHessian<double>& reduced, const Eigen::MatrixXd& vectors,
                                   const std::vector<double>& curvature, double zero) {
    Eigen::VectorXd flexibility(vectors.cols());
    for (Eigen::Index k = 0; k < flexibility.size(); ++k) {
      const double c = curvature[static_cast<std::size_t>(k)];
      flexibility[k] = std::abs(c) <= zero ? 0.0 : 1.0 / c;
    }
    if ((flexibility.array() != 0.0).all()) return;
    const Eigen::MatrixXd inverse = vectors * flexibility.asDiagonal() * vectors.transpose();
    const auto solve = [&](const Eigen::VectorXd& right) { return Eigen::VectorXd(inverse * right); };
    out_.accuracy_across_neutral = std::max({force_rounding * flexibility.cwiseAbs().maxCoeff(),
                                             shift_by_rounded_closures(reduced, solve), least_accuracy});
  }

  // Change of the equilibrium with the rounding of the closures: large reactions act along the motion that a gap of eps
  // permits. `solve` applies the inverse of the reduced stiffness.
  //   J v = e,  Z^T K (v + Z z) = 0,  d = v + Z z
  static double shift_by_rounded_closures(const ReducedHessian<double>& reduced, const auto& solve) {
    const Eigen::Index rows = reduced.jacobian.rows();
    if (rows == 0) return 0.0;
    const solvers::LeastSquares<double> closures(reduced.jacobian, solvers::known_to::solution);
    double largest = 0.0;
    for (Eigen::Index pattern = 1; pattern <= 4; ++pattern) {
      Eigen::VectorXd e(rows);
      for (Eigen::Index r = 0; r < rows; ++r) e[r] = (r / pattern) % 2 == 0 ? closure_rounding : -closure_rounding;
      const Eigen::VectorXd v = closures.solve(e);
      const Eigen::VectorXd d = v - reduced.basis * solve(Eigen::VectorXd(reduced.coupling * v));
      largest = std::max(largest, d.cwiseAbs().maxCoeff());
    }
    return largest;
  }

  void check_kinks(const std::vector<int>& kinks, double zero) {
    out_.stability = stability_at_kinks(model_, x_, holding_rows(), kinks, zero);
    out_.unstable_directions = out_.stability == Stability::unstable ? 1 : 0;
    out_.neutral_directions = out_.stability == Stability::neutral ? 1 : 0;
    out_.stability_note = fmt::format("spring \"{}\" is at its free length: both sides were checked",
                                      scene_.elements[kinks.front()].name);
    if (out_.stability == Stability::unknown) {
      out_.stability_note += ", which is not decisive with more than one degree of freedom";
    }
  }

  bool lies_close_in_50_digits(double within) const {
    const Reference exact = refine(model_, x_);
    return exact.refined && exact.error <= within;
  }

  // The length of one more Newton step, open closures included:  J v = -c,  Z^T (F + K (v + Z z)) = 0,  d = v + Z z.
  double step_to_equilibrium(const ReducedHessian<double>& reduced) const {
    Eigen::VectorXd v = Eigen::VectorXd::Zero(reduced.basis.rows());
    const Eigen::Index closures = model_.mechanism().equalities();
    if (closures > 0) {
      v = -solvers::minimum_norm_solution<double>(reduced.jacobian.topRows(closures),
                                                  Eigen::VectorXd::Map(reduced.kept.data(), closures),
                                                  solvers::known_to::solution);
    }
    const Eigen::VectorXd right = reduced.force + reduced.coupling * v;
    return (v - reduced.basis * solvers::FullyPivotedLu(reduced.matrix).solve(right)).cwiseAbs().maxCoeff();
  }

  bool is_close(double step) {
    if (step <= tolerances_.position) return true;
    deny(fmt::format(
        "the loads are nearly balanced, but the equilibrium itself is about {:.1g} away (rad, or length over "
        "size)",
        step));
    return false;
  }

  void deny(const std::string& reason) {
    out_.balanced = false;
    object(reason);
    out_.stability_note = "only an equilibrium can be stable";
  }

  // Near a fold, where equilibria merge and vanish, double precision determines neither the sign of a curvature nor
  // whether there is an equilibrium at all. If 50 digits find none, only a neutral direction remains as an explanation.
  bool check_in_50_digits(const ReducedHessian<double>& reduced, const Eigen::MatrixXd& directions,
                          std::vector<double>& curvature, double within) {
    const std::vector<double> exact = refined_curvatures(model_, x_);
    if (exact.size() == curvature.size() && lies_close_in_50_digits(within)) {
      curvature = exact;
      out_.stability_note = "a curvature is so small that its sign was taken from 50 digits";
      return true;
    }
    bool flat = false;
    for (std::size_t k = 0; k < curvature.size(); ++k) {
      if (std::abs(curvature[k]) > doubtful_below * std::max(1.0, reduced.largest)) continue;
      if (is_flat(reduced.basis * directions.col(static_cast<Eigen::Index>(k)))) {
        curvature[k] = 0.0;
        flat = true;
        continue;
      }
      deny("50 digits find no equilibrium here: near a fold double precision does not resolve the imbalance");
      return false;
    }
    if (!flat) deny("50 digits find no equilibrium here, or none so near");
    return flat;
  }

  // Whether the imbalance is rounding only a short distance along the direction, too.
  bool is_flat(const Eigen::VectorXd& direction) const {
    const double scale = std::max(1.0, largest_load_ / model_.scales().force);
    solvers::Newton closing(model_.problem());
    for (const double way : {-flat_over, flat_over}) {
      std::vector<double> moved = x_;
      for (std::size_t i = 0; i < moved.size(); ++i) moved[i] += way * direction[static_cast<Eigen::Index>(i)];
      const ReducedHessian<double> there(model_.mechanism(), closing.close(moved).x, holding_rows());
      if (there.force.size() > 0 && there.force.cwiseAbs().maxCoeff() > flat_within * scale) return false;
    }
    return true;
  }

  void settle(int falling, int neutral) {
    out_.unstable_directions = falling;
    out_.neutral_directions = neutral;
    out_.stability = falling > 0 ? Stability::unstable : neutral > 0 ? Stability::neutral : Stability::stable;
  }

  CurvatureDirection curvature_direction(double curvature, const Eigen::VectorXd& direction) const {
    CurvatureDirection out;
    out.curvature = curvature * model_.scales().energy();
    std::vector<int> order(direction.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(),
              [&](int a, int b) { return std::abs(direction[a]) > std::abs(direction[b]); });
    const double sign = order.empty() || direction[order[0]] >= 0 ? 1.0 : -1.0;
    for (int i : order) {
      if (out.moves.size() == 4 || std::abs(direction[i]) < 0.05 * std::abs(direction[order[0]])) break;
      out.moves.emplace_back(model_.layout().coordinates[i].name, sign * direction[i]);
    }
    return out;
  }

  // Without a potential the reduced stiffness K is not symmetric. Statics can use the sign of its determinant, which
  // does not depend on the units of the coordinates: negative means divergence. With more than one degree of freedom a
  // positive one does not exclude flutter, which depends on the masses.
  void check_followers(const ReducedHessian<double>& reduced) {
    if (!is_close(step_to_equilibrium(reduced))) return;
    out_.accuracy = force_rounding / solvers::singular_value_decomposition(reduced.matrix).values.minCoeff();
    const double scale = std::max(1.0, reduced.largest);
    const double determinant = solvers::FullyPivotedLu(reduced.matrix / scale).determinant();
    const bool neutral = std::abs(determinant) <= 1e-12;
    const bool one_freedom = reduced.matrix.rows() == 1;
    settle(!neutral && determinant < 0 ? 1 : 0, neutral ? 1 : 0);
    out_.stability_note = "a follower load has no potential: checked for divergence only (the sign of the stiffness)";
    if (out_.stability == Stability::stable && !one_freedom) {
      out_.stability = Stability::unknown;
      out_.stability_note =
          "a follower load has no potential: it does not diverge, but it may flutter, which statics cannot decide";
    } else if (out_.stability == Stability::unstable && !one_freedom) {
      out_.stability_note =
          "a follower load has no potential: it diverges, the determinant of its stiffness being negative";
    }
  }

  void count_only(const std::vector<int>& rows) {
    std::vector<char> active(model_.mechanism().constraints(), 0);
    for (int r : rows) active[r] = 1;
    const solvers::Inertia inertia = solvers::inertia_at(model_.problem(), x_, active);
    if (inertia.known) settle(inertia.negative, 0);
    out_.stability_note = "too many coordinates for single directions: only the signs of the curvatures were counted";
  }

  const StaticModel& model_;
  const Scene& scene_;
  const std::vector<double>& x_;
  const CheckTolerances& tolerances_;
  std::vector<BodyPose<double>> poses_;
  double size_;
  std::vector<int> touching_;
  std::vector<int> pressing_;
  double largest_load_ = 0.0;
  Check out_;
};

}  // namespace

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

Check check(const StaticModel& model, const std::vector<double>& x, const CheckTolerances& tolerances) {
  return EquilibriumCheck(model, x, tolerances).run();
}

}  // namespace poise
