#include "tests/judge/exact_reactions.hpp"

#include <cmath>

#include "solvers/linear_algebra.hpp"
#include "statics/model/readings.hpp"

namespace poise::judge {
namespace {

constexpr int most_newton_steps = 6;
constexpr double converged_within = 1e-40;

Planar<Real> line_of(const ExactMechanics& mechanics, const Joint& joint, const Vector& q) {
  const Planar<Real> along = planar_cast<Real>(joint.axis);
  return (1 / norm(along)) * along * unit(mechanics.angle(joint.a.body, q));
}

}  // namespace

std::optional<ExactForces> exact_forces(const StaticModel& model, const Equilibrium& answer) {
  const Scene& scene = model.scene();
  const ExactMechanics mechanics(scene, model.scales().length);
  const Readings readings = read_off(model, answer.x);
  Piece piece;
  // Near its free length the force tells more than the length whether a one-way spring is slack.
  for (const Element& element : scene.elements) {
    const auto* spring = std::get_if<LinearSpring>(&element.law);
    const bool acts = answer.check.element_forces[piece.slack.size()].value != 0.0;
    piece.slack.push_back(spring != nullptr && spring->acts != LinearSpring::Acts::both && !acts);
  }
  std::vector<int> active = answer.certificate.active_stops;
  std::sort(active.begin(), active.end());
  for (const int s : active) {
    const bool at_min = std::string_view(pressed_limit(scene.stops[s], readings.stops[s]).name) == "min";
    piece.contacts.push_back({s, at_min ? -1 : 1});
  }
  const Eigen::Index n = mechanics.coordinates();
  Vector q(n);
  for (std::size_t b = 1; b < scene.bodies.size(); ++b) {
    const auto at = 3 * (static_cast<Eigen::Index>(b) - 1);
    q[at] = Real(readings.poses[b].origin.x) / mechanics.length();
    q[at + 1] = Real(readings.poses[b].origin.y) / mechanics.length();
    q[at + 2] = Real(readings.poses[b].angle);
  }
  Vector y;
  for (int step = 0;; ++step) {
    const Forces forces = mechanics.at(q, piece);
    if (!forces.smooth) return std::nullopt;
    const auto m = static_cast<Eigen::Index>(forces.rows.size());
    Matrix jacobian(m, n);
    Vector gap(m);
    for (Eigen::Index r = 0; r < m; ++r) {
      jacobian.row(r) = forces.rows[static_cast<std::size_t>(r)].grad.transpose();
      gap[r] = forces.rows[static_cast<std::size_t>(r)].value;
    }
    if (step == 0) {
      y = solvers::minimum_norm_solution<Real>(jacobian.transpose(), -forces.force, solvers::known_to::closed_point);
    }
    Matrix all = Matrix::Zero(n + m, n + m);
    all.topLeftCorner(n, n) = forces.stiffness;
    for (Eigen::Index r = 0; r < m; ++r) forces.rows[static_cast<std::size_t>(r)].add_hessian(y[r], all);
    all.bottomLeftCorner(m, n) = jacobian;
    all.topRightCorner(n, m) = jacobian.transpose();
    Vector left(n + m);
    left << forces.force + jacobian.transpose() * y, gap;
    const solvers::LeastSquares<Real> newton(all, solvers::known_to::half_of_50_digits);
    if (newton.rank() < n + m || step == most_newton_steps) return std::nullopt;
    const Vector change = newton.solve(-left);
    q += change.head(n);
    y += change.tail(m);
    const Real size = 1 + (m > 0 ? y.cwiseAbs().maxCoeff() : Real(0));
    if (change.cwiseAbs().maxCoeff() < converged_within * size) break;
  }

  ExactForces out;
  Eigen::Index row = 0;
  const Real& length = mechanics.length();
  for (const Joint& joint : scene.joints) {
    ExactReaction& reaction = out.joints.emplace_back();
    const auto push = [&](const Planar<Real>& along) { reaction.force += (-y[row++] / length) * along; };
    if (joint.keeps_length()) {
      const Planar<Real> d = mechanics.place(joint.b, q) - mechanics.place(joint.a, q);
      push((1 / norm(d)) * d);
    } else if (joint.has_travel()) {
      push(quarter_turn(line_of(mechanics, joint, q)));
    } else {
      push({Real(1), Real(0)});
      push({Real(0), Real(1)});
    }
    if (joint.keeps_angle()) reaction.moment = -y[row++];
  }
  for (const Contact& contact : piece.contacts) {
    out.stops.push_back(-y[row++] / (scene.stops[contact.stop].on.is_angle() ? Real(1) : length));
  }
  for (const Element& element : scene.elements) {
    const Real g = mechanics.measure(element.on, q).value * (element.on.is_angle() ? Real(1) : length);
    const auto* spring = std::get_if<LinearSpring>(&element.law);
    if (spring != nullptr && spring->slack(g) != piece.slack[out.elements.size()]) return std::nullopt;
    out.elements.push_back(force_at_rest(element.law, g).value);
  }
  return out;
}

}  // namespace poise::judge
