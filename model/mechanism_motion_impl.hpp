#pragma once

// What a moving mechanism asks of its phasors; the rest of Mechanism is in model/mechanism_impl.hpp.

#include <cmath>

#include "model/mechanism.hpp"

namespace poise {

template <class T>
void Mechanism<T>::compile_motion(const Scene& scene, const Scales& scales) {
  for (const Damper& d : scene.dampers) {
    dampers_.push_back({compile_path(scene, scales, d.a, d.b), static_cast<T>(scales.per_stiffness() * d.coefficient)});
  }
  for (const TorsionDamper& d : scene.torsion_dampers) {
    angle_resistances_.push_back({relative_angle(d.a, d.b), static_cast<T>(scales.per_energy() * d.coefficient), T(0)});
  }
  torsion_dampers_ = static_cast<int>(scene.torsion_dampers.size());
  for (const Friction& f : scene.frictions) {
    angle_resistances_.push_back(
        {relative_angle(f.a, f.b), static_cast<T>(scales.per_energy() * f.torque), static_cast<T>(f.width)});
  }
  for (const Force& f : scene.forces) {
    const double size = norm(f.vector);
    const Vec2 along = size > 0 && f.follows < 0 ? (1 / size) * f.vector : Vec2{};
    const Vec2 at = scales.per_length() * scene.local(f.at);
    dead_forces_.push_back({compile(layout_.path(0, {0, 0}, f.at.body, at)), planar_cast<T>(along)});
  }
  for (const Torque& t : scene.torques) torque_coordinate_.push_back(layout_.links[t.body].frame);
}

template <class T>
void Mechanism<T>::phasor_first(const Planar<T>* pose, const T* u, Planar<T>* out) const {
  for (int k = 0; k < angles(); ++k) out[k] = u[k] * quarter_turn(pose[k]);
  for (int t = angles(); t < coordinates(); ++t) {
    out[t] = u[t] * line_direction(pose, t);
    if (frame(t) >= 0) out[t] += u[frame(t)] * quarter_turn(pose[t]);
  }
}

template <class T>
void Mechanism<T>::phasor_second(const Planar<T>* pose, const T* u, const T* v, Planar<T>* out) const {
  for (int k = 0; k < angles(); ++k) out[k] = (-u[k] * v[k]) * pose[k];
  for (int t = angles(); t < coordinates(); ++t) {
    const int f = frame(t);
    if (f < 0) {
      out[t] = {};
      continue;
    }
    out[t] = (u[t] * v[f] + u[f] * v[t]) * quarter_turn(line_direction(pose, t));
    out[t] -= (u[f] * v[f]) * pose[t];
  }
}

template <class T>
void Mechanism<T>::phasor_third(const Planar<T>* pose, const T* u, const T* v, const T* w, Planar<T>* out) const {
  for (int k = 0; k < angles(); ++k) out[k] = (-u[k] * v[k] * w[k]) * quarter_turn(pose[k]);
  for (int t = angles(); t < coordinates(); ++t) {
    const int f = frame(t);
    if (f < 0) {
      out[t] = {};
      continue;
    }
    out[t] = (-(u[t] * v[f] * w[f] + u[f] * v[t] * w[f] + u[f] * v[f] * w[t])) * line_direction(pose, t);
    out[t] -= (u[f] * v[f] * w[f]) * quarter_turn(pose[t]);
  }
}

template <class T>
void Mechanism<T>::add_projection(const Planar<T>* pose, const Planar<T>* f, T* g) const {
  for (int k = 0; k < angles(); ++k) g[k] += cross(pose[k], f[k]);
  for (int t = angles(); t < coordinates(); ++t) {
    g[t] += dot(line_direction(pose, t), f[t]);
    if (frame(t) >= 0) g[frame(t)] += cross(pose[t], f[t]);
  }
}

template <class T>
void Mechanism<T>::add_projection_change(const Planar<T>* pose, const T* u, const Planar<T>* f, T* g) const {
  for (int k = 0; k < angles(); ++k) g[k] -= u[k] * dot(pose[k], f[k]);
  for (int t = angles(); t < coordinates(); ++t) {
    const int of = frame(t);
    if (of < 0) continue;
    const T across = cross(line_direction(pose, t), f[t]);
    g[t] += u[of] * across;
    g[of] += u[t] * across - u[of] * dot(pose[t], f[t]);
  }
}

template <class T>
void Mechanism<T>::closures_of(const Planar<T>* f, T* c) const {
  for (int l = 0; l < closures(); ++l) {
    Planar<T> sum{};
    for (int e = closure_first_[l]; e < closure_first_[l + 1]; ++e) {
      sum += closure_coefficient_[e] * f[closure_coordinate_[e]];
    }
    c[2 * l] = sum.x;
    c[2 * l + 1] = sum.y;
  }
}

template <class T>
T Mechanism<T>::AngleResistance::shape(const T& w) const {
  using std::tanh;
  return width > 0 ? T(tanh(w / width)) : w;
}

template <class T>
T Mechanism<T>::AngleResistance::slope(const T& w) const {
  using std::tanh;
  if (!(width > 0)) return T(1);
  const T s = tanh(w / width);
  return (1 - s * s) / width;
}

template <class T>
T Mechanism<T>::rate(const Angle& angle, const T* v) const {
  T w(0);
  if (angle.b >= 0) w += v[angle.b];
  if (angle.a >= 0) w -= v[angle.a];
  return w;
}

template <class T>
void Mechanism<T>::add_torque(const Angle& angle, const T& torque, T* g) const {
  if (angle.b >= 0) g[angle.b] += torque;
  if (angle.a >= 0) g[angle.a] -= torque;
}

// D p[u], from the derivatives d_i over the support.
template <class T>
Planar<T> Mechanism<T>::add_up(const Path& path, const Planar<T>* d_i, const T* u) const {
  Planar<T> sum{};
  for (std::size_t i = 0; i < path.support.size(); ++i) sum += u[path.support[i]] * d_i[i];
  return sum;
}

// D2 p[u, v].
template <class T>
Planar<T> Mechanism<T>::bend(const Path& path, const Planar<T>* pose, const T* u, const T* v) const {
  Planar<T> sum{};
  second_derivative(path, pose, [&](int i, int j, const Planar<T>& d_ij) {
    const int a = path.support[i];
    const int b = path.support[j];
    sum += (i == j ? T(u[a] * v[a]) : T(u[a] * v[b] + u[b] * v[a])) * d_ij;
  });
  return sum;
}

// g += by dr/dq,  r = |d|.
template <class T>
void Mechanism<T>::add_length_gradient(const Path& path, Planar<T>* pose, const T& by, T* g) const {
  const Planar<T> d = evaluate(path, pose);
  const T r = norm(d);
  if (r == 0) return;
  Planar<T>* d_i = scratch(pose);
  derivative(path, pose, d_i);
  for (std::size_t i = 0; i < path.support.size(); ++i) g[path.support[i]] += (by / r) * dot(d, d_i[i]);
}

template <class T>
void Mechanism<T>::add_resistance(Planar<T>* pose, const T* v, T* g) const {
  Planar<T>* d_i = scratch(pose);
  for (const LineDamper& s : dampers_) {
    const Planar<T> d = evaluate(s.path, pose);
    const T rr = dot(d, d);
    if (rr == 0) continue;
    derivative(s.path, pose, d_i);
    const T pull = s.coefficient * dot(d, add_up(s.path, d_i, v)) / rr;
    for (std::size_t i = 0; i < s.path.support.size(); ++i) g[s.path.support[i]] += pull * dot(d, d_i[i]);
  }
  for (const AngleResistance& s : angle_resistances_) {
    add_torque(s.angle, s.coefficient * s.shape(rate(s.angle, v)), g);
  }
}

// With the resistance  c s d.d_a,  s = d.d'/r^2, d' = D d[v]:  c (ds d.d_a + s (d1.d_a + d.D d_a[dq])).
template <class T>
void Mechanism<T>::add_resistance_change(Planar<T>* pose, const T* v, const T* dq, const T* dv, T* g) const {
  Planar<T>* d_i = scratch(pose);
  for (const LineDamper& s : dampers_) {
    const Planar<T> d = evaluate(s.path, pose);
    const T rr = dot(d, d);
    if (rr == 0) continue;
    derivative(s.path, pose, d_i);
    const Planar<T> rate = add_up(s.path, d_i, v);
    const Planar<T> change = add_up(s.path, d_i, dq);
    const Planar<T> rate_change = add_up(s.path, d_i, dv) + bend(s.path, pose, v, dq);
    const T pull = s.coefficient * dot(d, rate) / rr;
    const T pull_change =
        s.coefficient * (dot(change, rate) + dot(d, rate_change)) / rr - 2 * pull * dot(d, change) / rr;
    for (std::size_t i = 0; i < s.path.support.size(); ++i) {
      g[s.path.support[i]] += pull_change * dot(d, d_i[i]) + pull * dot(change, d_i[i]);
    }
    second_derivative(s.path, pose, [&](int i, int j, const Planar<T>& d_ij) {
      const T part = pull * dot(d, d_ij);
      g[s.path.support[i]] += part * dq[s.path.support[j]];
      if (i != j) g[s.path.support[j]] += part * dq[s.path.support[i]];
    });
  }
  for (const AngleResistance& s : angle_resistances_) {
    add_torque(s.angle, s.coefficient * s.slope(rate(s.angle, v)) * rate(s.angle, dv), g);
  }
}

template <class T>
T Mechanism<T>::follower_power(Planar<T>* pose, const T* v) const {
  T power(0);
  Planar<T>* d_i = scratch(pose);
  for (const Follower& f : followers_) {
    derivative(f.path, pose, d_i);
    power += dot(f.frame >= 0 ? f.force * pose[f.frame] : f.force, add_up(f.path, d_i, v));
  }
  return power;
}

template <class T>
void Mechanism<T>::add_force_derivative(Element element, int index, const T& by, const T* q, Planar<T>* pose,
                                        const T* v, T* g) const {
  switch (element) {
    case Element::stiffness: {
      const LineSpring& s = springs_[index];
      const T r = norm(evaluate(s.path, pose));
      if (!s.slack(r)) add_length_gradient(s.path, pose, by * (r - s.free_length), g);
      break;
    }
    case Element::free_length: {
      const LineSpring& s = springs_[index];
      if (!s.slack(norm(evaluate(s.path, pose)))) add_length_gradient(s.path, pose, -by * s.stiffness, g);
      break;
    }
    case Element::torsion_stiffness:
      add_torque(angle_springs_[index].angle, by * value(angle_springs_[index].angle, q), g);
      break;
    case Element::free_angle:
      add_torque(angle_springs_[index].angle, -by * angle_springs_[index].stiffness, g);
      break;
    case Element::damping: {
      const Path& path = dampers_[index].path;
      Planar<T>* d_i = scratch(pose);
      const Planar<T> d = evaluate(path, pose);
      derivative(path, pose, d_i);
      const T r = norm(d);
      if (r != 0) add_length_gradient(path, pose, by * dot(d, add_up(path, d_i, v)) / r, g);
      break;
    }
    case Element::torsion_damping:
    case Element::friction: {
      const AngleResistance& s = angle_resistances_[element == Element::friction ? index + torsion_dampers_ : index];
      add_torque(s.angle, by * s.shape(rate(s.angle, v)), g);
      break;
    }
    case Element::force: {
      const DeadForce& s = dead_forces_[index];
      Planar<T>* d_i = scratch(pose);
      derivative(s.path, pose, d_i);
      for (std::size_t i = 0; i < s.path.support.size(); ++i) {
        g[s.path.support[i]] -= by * dot(s.direction, d_i[i]);
      }
      break;
    }
    case Element::torque:
      if (torque_coordinate_[index] >= 0) g[torque_coordinate_[index]] -= by;
      break;
  }
}

}  // namespace poise
