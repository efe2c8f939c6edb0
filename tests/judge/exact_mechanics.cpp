#include "tests/judge/exact_mechanics.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <variant>

#include <boost/math/constants/constants.hpp>

namespace poise::judge {
namespace {

using Place = Planar<Real>;

// Index of a coordinate of a body; -1 for the ground, which has none.
Eigen::Index at_x(int body) { return body == 0 ? -1 : 3 * (body - 1); }
Eigen::Index at_y(int body) { return body == 0 ? -1 : 3 * (body - 1) + 1; }
Eigen::Index at_angle(int body) { return body == 0 ? -1 : 3 * (body - 1) + 2; }

void add(Vector& to, Eigen::Index i, const Real& value) {
  if (i >= 0) to[i] += value;
}

// An entry and its mirror image.
void add(Smooth& to, Eigen::Index i, Eigen::Index j, const Real& value) {
  if (i < 0 || j < 0) return;
  to.hessian.push_back({i, j, value});
  if (i != j) to.hessian.push_back({j, i, value});
}

void add(Matrix& to, Eigen::Index i, Eigen::Index j, const Real& value) {
  if (i >= 0 && j >= 0) to(i, j) += value;
}

// to += factor times term.
void add(Smooth& to, const Real& factor, const Smooth& term) {
  to.value += factor * term.value;
  to.grad += factor * term.grad;
  for (const Smooth::Entry& e : term.hessian) to.hessian.push_back({e.i, e.j, factor * e.value});
}

const LinearSpring* spring_of(const Element& element) { return std::get_if<LinearSpring>(&element.law); }

// A linear spring between two points whose energy k/2 |b - a|^2 is smooth where they coincide.
bool has_zero_length(const Element& element) {
  const LinearSpring* spring = spring_of(element);
  return spring != nullptr && element.on.kind == Measure::Kind::distance && spring->free_length == 0.0;
}

bool acts(const Element& element) {
  if (const LinearSpring* spring = spring_of(element)) return spring->stiffness != 0.0;
  if (const auto* spring = std::get_if<CubicSpring>(&element.law))
    return spring->stiffness != 0.0 || spring->cubic != 0;
  if (const auto* constant = std::get_if<ConstantForce>(&element.law)) return constant->force != 0.0;
  return false;
}

// Unit vector along the axis of a joint.
Place axis(const Joint& joint, const Real& angle) {
  const Place along = planar_cast<Real>(joint.axis);
  return (1 / norm(along)) * along * unit(angle);
}

Real largest_entry(const Vector& v) { return v.size() > 0 ? v.cwiseAbs().maxCoeff() : Real(0); }

}  // namespace

ExactMechanics::ExactMechanics(const Scene& scene, double length) : scene_(scene), length_(length) {
  double largest = 0.0;
  for (const Body& body : scene.bodies) {
    for (const NamedPoint& p : body.points) largest = std::max({largest, std::abs(p.at.x), std::abs(p.at.y)});
  }
  rounding_ = std::ldexp(largest / length, -49);
}

bool ExactMechanics::has_followers() const {
  return std::any_of(scene_.forces.begin(), scene_.forces.end(),
                     [](const Force& f) { return f.follows > 0 && !(f.vector == Vec2{}); });
}

Smooth ExactMechanics::zero() const {
  Smooth out;
  out.grad = Vector::Zero(coordinates());
  return out;
}

ExactMechanics::End ExactMechanics::end(int body, const Vec2& local, const Vector& q) const {
  if (body == 0) return {0, {}, length_of(local)};
  return {body, {q[at_x(body)], q[at_y(body)]}, length_of(local) * unit(q[at_angle(body)])};
}

Planar<Real> ExactMechanics::place(PointRef p, const Vector& q) const {
  const End e = end(p, q);
  return e.origin + e.arm;
}

Real ExactMechanics::travel(int joint, const Vector& q) const {
  const Joint& j = scene_.joints[joint];
  return dot(axis(j, angle(j.a.body, q)), place(j.b, q) - place(j.a, q));
}

// g = w . d,  d = b - a,  with dd/d(angle_a) = -i r_a,  dd/d(angle_b) = i r_b,  and  dw/d(angle_a) = i w  if w turns.
Smooth ExactMechanics::component(const End& a, const End& b, const Place& w, bool turns) const {
  const Place d = b.origin + b.arm - a.origin - a.arm;
  Smooth g = zero();
  g.value = dot(w, d);
  add(g.grad, at_x(a.body), -w.x);
  add(g.grad, at_y(a.body), -w.y);
  add(g.grad, at_angle(a.body), -dot(w, quarter_turn(a.arm)));
  add(g.grad, at_x(b.body), w.x);
  add(g.grad, at_y(b.body), w.y);
  add(g.grad, at_angle(b.body), dot(w, quarter_turn(b.arm)));
  add(g, at_angle(a.body), at_angle(a.body), dot(w, a.arm));
  add(g, at_angle(b.body), at_angle(b.body), -dot(w, b.arm));
  if (!turns) return g;
  const Place v = quarter_turn(w);
  const Eigen::Index t = at_angle(a.body);
  add(g.grad, t, dot(v, d));
  add(g, t, t, -dot(w, d) - 2 * dot(v, quarter_turn(a.arm)));
  add(g, t, at_x(a.body), -v.x);
  add(g, t, at_y(a.body), -v.y);
  add(g, t, at_x(b.body), v.x);
  add(g, t, at_y(b.body), v.y);
  add(g, t, at_angle(b.body), dot(v, quarter_turn(b.arm)));
  return g;
}

// r = |d|: with u = d/r and v = i u,  Dr = u . Dd  and  D2r = (v . Dd)(v . Dd)^T / r + u . D2d.
Smooth ExactMechanics::distance(const End& a, const End& b) const {
  const Place d = b.origin + b.arm - a.origin - a.arm;
  const Real r = norm(d);
  if (r == 0) return zero();
  const Place u = (1 / r) * d;
  Smooth g = component(a, b, u, false);
  const Smooth across = component(a, b, quarter_turn(u), false);
  std::vector<Eigen::Index> moved;
  for (Eigen::Index i = 0; i < across.grad.size(); ++i) {
    if (across.grad[i] != 0) moved.push_back(i);
  }
  for (const Eigen::Index i : moved) {
    for (const Eigen::Index j : moved) g.hessian.push_back({i, j, across.grad[i] * across.grad[j] / r});
  }
  return g;
}

Smooth ExactMechanics::angle_between(int a, int b, const Vector& q) const {
  Smooth g = zero();
  g.value = angle(b, q) - angle(a, q);
  add(g.grad, at_angle(a), Real(-1));
  add(g.grad, at_angle(b), Real(1));
  return g;
}

Smooth ExactMechanics::measure(const Measure& m, const Vector& q) const {
  switch (m.kind) {
    case Measure::Kind::angle:
      return angle_between(m.body_a, m.body_b, q);
    case Measure::Kind::distance:
      return distance(end(m.a, q), end(m.b, q));
    case Measure::Kind::travel: {
      const Joint& joint = scene_.joints[m.joint];
      return component(end(joint.a, q), end(joint.b, q), axis(joint, angle(joint.a.body, q)), true);
    }
    case Measure::Kind::x:
      return component(end(0, {}, q), end(m.b, q), {Real(1), Real(0)}, false);
    case Measure::Kind::y:
      return component(end(0, {}, q), end(m.b, q), {Real(0), Real(1)}, false);
    case Measure::Kind::component:
      return component(end(m.a, q), end(m.b, q), direction<Real>(m.axis) * unit(angle(m.a.body, q)), true);
    case Measure::Kind::clearance:
    case Measure::Kind::along_outline:
    case Measure::Kind::slip_on_cam:
      throw std::invalid_argument("the judge knows no outlines");
    case Measure::Kind::rope:
      throw std::invalid_argument("the judge knows no ropes");
    case Measure::Kind::sum:
      break;
  }
  Smooth sum = zero();
  for (const Measure::Term& term : m.terms) {
    if (term.profile) throw std::invalid_argument("the judge knows no cams");
    add(sum, Real(term.factor), measure(term.measure, q));
  }
  return sum;
}

Real ExactMechanics::limit(const Stop& stop, int side) const {
  const Real value = side > 0 ? stop.max : stop.min;
  return stop.on.is_angle() ? value : Real(value / length_);
}

Real ExactMechanics::free_length(const Element& element) const {
  const LinearSpring* linear = spring_of(element);
  const Real value = linear != nullptr ? linear->free_length : std::get<CubicSpring>(element.law).free_length;
  return element.on.is_angle() ? value : Real(value / length_);
}

// k/2 d . d
void ExactMechanics::add_spring_of_zero_length(const Element& element, const Vector& q, Forces& out) const {
  const Real k = spring_of(element)->stiffness * length_ * length_;
  const End a = end(element.on.a, q);
  const End b = end(element.on.b, q);
  for (const Place& axis : {Place{Real(1), Real(0)}, Place{Real(0), Real(1)}}) {
    const Smooth d = component(a, b, axis, false);
    out.force += k * d.value * d.grad;
    out.stiffness += k * d.grad * d.grad.transpose();
    d.add_hessian(k * d.value, out.stiffness);
  }
}

void ExactMechanics::add_element(const Element& element, const Vector& q, Forces& out) const {
  if (has_zero_length(element)) return add_spring_of_zero_length(element, q, out);
  const Smooth g = measure(element.on, q);
  if (element.on.kind == Measure::Kind::distance && g.value == 0) {
    out.smooth = false;
    return;
  }
  const Real unit = element.on.is_angle() ? Real(1) : length_;
  Real T, by_measure;
  if (const LinearSpring* spring = spring_of(element)) {
    by_measure = spring->stiffness * unit * unit;
    T = by_measure * (g.value - free_length(element));
  } else if (const auto* cubic = std::get_if<CubicSpring>(&element.law)) {
    const Real u = g.value - free_length(element);
    const Real k = cubic->stiffness * unit * unit;
    const Real c = cubic->cubic * unit * unit * unit * unit;
    T = k * u + c * u * u * u;
    by_measure = k + 3 * c * u * u;
  } else {
    T = std::get<ConstantForce>(element.law).force * unit;
  }
  out.force += T * g.grad;
  g.add_hessian(T, out.stiffness);
  if (by_measure == 0) return;
  for (Eigen::Index i = 0; i < g.grad.size(); ++i) {
    if (g.grad[i] == 0) continue;
    for (Eigen::Index j = 0; j < g.grad.size(); ++j) out.stiffness(i, j) += by_measure * g.grad[i] * g.grad[j];
  }
}

// -Q of a force f at the end of the arm r:  -f  on the origin,  -i r . f  on the angle. A follower turns:  df = i f.
void ExactMechanics::add_force(const End& at, const Place& f, int follows, Forces& out) const {
  if (at.body == 0) return;
  add(out.force, at_x(at.body), -f.x);
  add(out.force, at_y(at.body), -f.y);
  add(out.force, at_angle(at.body), -dot(quarter_turn(at.arm), f));
  add(out.stiffness, at_angle(at.body), at_angle(at.body), dot(at.arm, f));
  if (follows <= 0) return;
  const Place turned = quarter_turn(f);
  add(out.stiffness, at_x(at.body), at_angle(follows), -turned.x);
  add(out.stiffness, at_y(at.body), at_angle(follows), -turned.y);
  add(out.stiffness, at_angle(at.body), at_angle(follows), -dot(quarter_turn(at.arm), turned));
}

void ExactMechanics::add_joint(const Joint& joint, const Vector& q, std::vector<Smooth>& rows) const {
  const End a = end(joint.a, q);
  const End b = end(joint.b, q);
  if (joint.keeps_length()) {
    rows.push_back(distance(a, b));
    rows.back().value -= joint.length / length_;
  } else if (joint.has_travel()) {
    rows.push_back(component(a, b, quarter_turn(axis(joint, angle(joint.a.body, q))), true));
  } else {
    rows.push_back(component(a, b, {Real(1), Real(0)}, false));
    rows.push_back(component(a, b, {Real(0), Real(1)}, false));
  }
  if (!joint.keeps_angle()) return;
  rows.push_back(angle_between(joint.a.body, joint.b.body, q));
  Real& turn = rows.back().value;
  turn -= joint.angle;
  // The angle is kept but for whole turns.
  const Real whole = 2 * boost::math::constants::pi<Real>();
  turn -= whole * floor(Real(turn / whole + 0.5));
}

Forces ExactMechanics::at(const Vector& q, const Piece& piece) const {
  const Eigen::Index n = coordinates();
  Forces out;
  out.force = Vector::Zero(n);
  out.stiffness = Matrix::Zero(n, n);
  for (std::size_t b = 1; b < scene_.bodies.size(); ++b) {
    const Body& body = scene_.bodies[b];
    if (body.mass == 0.0 || scene_.gravity == Vec2{}) continue;
    const Place weight = (Real(body.mass) * length_) * planar_cast<Real>(scene_.gravity);
    add_force(end(static_cast<int>(b), body.center, q), weight, -1, out);
  }
  for (const Force& load : scene_.forces) {
    const Place f = length_ * planar_cast<Real>(load.vector);
    add_force(end(load.at, q), load.follows > 0 ? f * unit(angle(load.follows, q)) : f, load.follows, out);
  }
  for (const Torque& torque : scene_.torques) add(out.force, at_angle(torque.body), Real(-torque.value));
  for (std::size_t e = 0; e < scene_.elements.size(); ++e) {
    if (!piece.slack[e] && acts(scene_.elements[e])) add_element(scene_.elements[e], q, out);
  }
  for (const Joint& joint : scene_.joints) add_joint(joint, q, out.rows);
  for (const Contact& contact : piece.contacts) {
    const Stop& stop = scene_.stops[contact.stop];
    out.rows.push_back(measure(stop.on, q));
    if (stop.on.kind == Measure::Kind::distance && out.rows.back().value == 0) out.smooth = false;
    out.rows.back().value -= limit(stop, contact.side);
  }
  return out;
}

Matrix ExactMechanics::observed(const Vector& q) const {
  std::vector<Vector> rows;
  const auto see = [&](const End& from, const End& to) {
    rows.push_back(component(from, to, {Real(1), Real(0)}, false).grad);
    rows.push_back(component(from, to, {Real(0), Real(1)}, false).grad);
  };
  const End origin = end(0, {}, q);
  const auto see_angle = [&](int body) { rows.push_back(angle_between(0, body, q).grad); };
  const auto see_measure = [&](const auto& self, const Measure& m) -> void {
    if (m.kind == Measure::Kind::distance) {
      see(end(m.a, q), end(m.b, q));
    } else if (m.kind == Measure::Kind::sum) {
      for (const Measure::Term& term : m.terms) self(self, term.measure);
    } else {
      rows.push_back(measure(m, q).grad);
    }
  };
  for (std::size_t b = 1; b < scene_.bodies.size(); ++b) {
    const Body& body = scene_.bodies[b];
    if (body.mass != 0.0 && !(scene_.gravity == Vec2{})) see(origin, end(static_cast<int>(b), body.center, q));
  }
  for (const Force& load : scene_.forces) {
    if (load.vector == Vec2{}) continue;
    see(origin, end(load.at, q));
    if (load.follows > 0) see_angle(load.follows);
  }
  for (const Torque& torque : scene_.torques) {
    if (torque.value != 0.0) see_angle(torque.body);
  }
  for (const Element& element : scene_.elements) {
    if (acts(element)) see_measure(see_measure, element.on);
  }
  for (const Stop& stop : scene_.stops) see_measure(see_measure, stop.on);
  Matrix out(static_cast<Eigen::Index>(rows.size()), coordinates());
  for (std::size_t i = 0; i < rows.size(); ++i) out.row(static_cast<Eigen::Index>(i)) = rows[i].transpose();
  return out;
}

Real ExactMechanics::force_scale(const Vector& q) const {
  Real scale = 0;
  for (const Body& body : scene_.bodies) {
    scale = std::max<Real>(scale, body.mass * length_ * norm(planar_cast<Real>(scene_.gravity)));
  }
  for (const Force& load : scene_.forces) scale = std::max<Real>(scale, length_ * norm(planar_cast<Real>(load.vector)));
  for (const Torque& torque : scene_.torques) scale = std::max<Real>(scale, abs(Real(torque.value)));
  for (const Element& element : scene_.elements) {
    if (!acts(element)) continue;
    const Smooth g = measure(element.on, q);
    const Real unit = element.on.is_angle() ? Real(1) : length_;
    if (const auto* constant = std::get_if<ConstantForce>(&element.law)) {
      scale = std::max<Real>(scale, abs(Real(constant->force)) * unit * largest_entry(g.grad));
      continue;
    }
    const Real reach = abs(g.value) + abs(free_length(element)) + 1;
    Real k;
    if (const LinearSpring* spring = spring_of(element)) {
      k = spring->stiffness * unit * unit;
    } else {
      const auto& cubic = std::get<CubicSpring>(element.law);
      k = (cubic.stiffness + abs(Real(cubic.cubic)) * reach * reach * unit * unit) * unit * unit;
    }
    scale = std::max<Real>(scale, k * reach);
  }
  return scale;
}

}  // namespace poise::judge
