#pragma once

#include <algorithm>
#include <cstdint>
#include <unordered_map>
#include <utility>

#include "model/mechanism.hpp"

namespace poise {

template <class T>
Mechanism<T>::Mechanism(const Scene& scene, Purpose purpose)
    : Mechanism(scene, lay_out(scene, purpose), purpose, Scales{}) {}

template <class T>
Mechanism<T>::Mechanism(const Scene& scene, Layout layout, Purpose purpose, const Scales& scales)
    : layout_(std::move(layout)) {
  layout_.scale_lengths(scales.per_length());
  compile_loads(scene, scales);
  compile_closures();
  compile_springs(scene, purpose, scales);
  compile_followers(scene, scales);
  compile_stops(scene, scales);
  if (purpose == Purpose::dynamics) compile_motion(scene, scales);
  make_jacobian_pattern();
  make_tangent_pattern();
}

// --- compilation ----------------------------------------------------------------------------------------------------

template <class T>
typename Mechanism<T>::Path Mechanism<T>::compile(const std::vector<Arm>& arms) const {
  Path path;
  path.terms.reserve(arms.size());
  for (const Arm& arm : arms) {
    const Planar<T> c = coefficient<T>(arm);
    if (arm.coordinate < 0) {
      path.constant += c;
    } else if (!path.terms.empty() && path.terms.back().coordinate == arm.coordinate) {
      path.terms.back().coefficient += c;
    } else {
      path.terms.push_back({arm.coordinate, -1, -1, c});
    }
  }
  path.support.reserve(path.terms.size());
  for (const Term& term : path.terms) {
    path.support.push_back(term.coordinate);
    if (frame(term.coordinate) >= 0) path.support.push_back(frame(term.coordinate));
  }
  std::sort(path.support.begin(), path.support.end());
  path.support.erase(std::unique(path.support.begin(), path.support.end()), path.support.end());
  const auto slot = [&](int t) {
    return static_cast<int>(std::lower_bound(path.support.begin(), path.support.end(), t) - path.support.begin());
  };
  for (Term& term : path.terms) {
    term.own_slot = slot(term.coordinate);
    if (frame(term.coordinate) >= 0) term.frame_slot = slot(frame(term.coordinate));
  }
  return path;
}

// p_b - p_a.
template <class T>
typename Mechanism<T>::Path Mechanism<T>::compile_path(const Scene& scene, const Scales& scales, PointRef a,
                                                       PointRef b) const {
  const double per_length = scales.per_length();
  return compile(layout_.path(a.body, per_length * scene.local(a), b.body, per_length * scene.local(b)));
}

template <class T>
typename Mechanism<T>::Angle Mechanism<T>::relative_angle(int body_a, int body_b) const {
  const Link& a = layout_.links[body_a];
  const Link& b = layout_.links[body_b];
  return {a.frame, b.frame, static_cast<T>(b.turn) - static_cast<T>(a.turn)};
}

template <class T>
T Mechanism<T>::value(const Angle& angle, const T* q) const {
  T v = angle.constant;
  if (angle.b >= 0) v += q[angle.b];
  if (angle.a >= 0) v -= q[angle.a];
  return v;
}

// Every dead force F at p does the work Re(conj(F) p): summed up the tree, all of them become one number per phasor.
template <class T>
void Mechanism<T>::compile_loads(const Scene& scene, const Scales& scales) {
  const T per_force(scales.per_force());
  load_.assign(coordinates(), {});
  torque_.assign(coordinates(), T(0));
  std::vector<Planar<T>> carried(layout_.links.size());
  const auto add = [&](const Arm& arm, const Planar<T>& force) {
    if (arm.coordinate < 0 || arm.coordinate >= coordinates()) return;
    load_[arm.coordinate] += conj(force) * coefficient<T>(arm);
  };
  const auto apply = [&](int body, Vec2 at, const Planar<T>& force) {
    carried[body] += force;
    add({layout_.links[body].frame, scales.per_length() * at, layout_.links[body].turn}, force);
  };
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    if (body.mass != 0) {
      apply(static_cast<int>(i), body.center, per_force * static_cast<T>(body.mass) * planar_cast<T>(scene.gravity));
    }
  }
  for (const Force& force : scene.forces) {
    if (force.follows < 0) apply(force.at.body, scene.local(force.at), per_force * planar_cast<T>(force.vector));
  }
  for (auto it = layout_.tree_order.rbegin(); it != layout_.tree_order.rend(); ++it) {
    const Link& link = layout_.links[*it];
    if (link.parent < 0) continue;
    for (const Arm& arm : link.arms) add(arm, carried[*it]);
    carried[link.parent] += carried[*it];
  }
  for (const Torque& torque : scene.torques) {
    const int k = layout_.links[torque.body].frame;
    if (k < 0 || k >= coordinates()) continue;
    torque_[k] += static_cast<T>(scales.per_energy()) * static_cast<T>(torque.value);
    has_torque_ = true;
  }
}

template <class T>
void Mechanism<T>::compile_closures() {
  closure_first_.push_back(0);
  for (const Closure& closure : layout_.closures) {
    std::vector<Arm> arms = closure.arms;
    std::stable_sort(arms.begin(), arms.end(), [](const Arm& l, const Arm& r) { return l.coordinate < r.coordinate; });
    const Path path = compile(arms);
    closure_constant_.push_back(path.constant);
    const int first = static_cast<int>(jacobian_row_.size());
    const int row = 2 * (closures() - 1);
    for (int t : path.support) {
      jacobian_row_.insert(jacobian_row_.end(), {row, row + 1});
      jacobian_column_.insert(jacobian_column_.end(), {t, t});
    }
    for (const Term& term : path.terms) {
      closure_coordinate_.push_back(term.coordinate);
      closure_coefficient_.push_back(term.coefficient);
      closure_own_.push_back(first + 2 * term.own_slot);
      closure_frame_.push_back(term.frame_slot < 0 ? -1 : first + 2 * term.frame_slot);
    }
    closure_first_.push_back(static_cast<int>(closure_coordinate_.size()));
  }
}

template <class T>
void Mechanism<T>::compile_springs(const Scene& scene, Purpose purpose, const Scales& scales) {
  springs_.reserve(scene.springs.size());
  for (const Spring& s : scene.springs) {
    if (s.stiffness == 0 && purpose == Purpose::statics) continue;
    LineSpring spring{compile_path(scene, scales, s.a, s.b), static_cast<T>(scales.per_stiffness() * s.stiffness),
                      static_cast<T>(scales.per_length() * s.free_length), s.acts};
    springs_.push_back(std::move(spring));
  }
  for (const TorsionSpring& s : scene.torsion_springs) {
    Angle angle = relative_angle(s.a, s.b);
    if ((s.stiffness == 0 || angle.a == angle.b) && purpose == Purpose::statics) continue;
    angle.constant -= static_cast<T>(s.free_angle);
    angle_springs_.push_back({angle, static_cast<T>(scales.per_energy() * s.stiffness), -1, -1, -1, -1});
  }
}

template <class T>
void Mechanism<T>::compile_followers(const Scene& scene, const Scales& scales) {
  for (const Force& f : scene.forces) {
    if (f.follows < 0 || (f.vector.x == 0 && f.vector.y == 0)) continue;
    const Link& carrier = layout_.links[f.follows];
    Follower follower{compile(layout_.path(0, {0, 0}, f.at.body, scales.per_length() * scene.local(f.at))),
                      planar_cast<T>(scales.per_force() * f.vector) * unit(static_cast<T>(carrier.turn)),
                      carrier.frame,
                      {}};
    followers_.push_back(std::move(follower));
    follower_names_.push_back(f.name);
  }
}

template <class T>
void Mechanism<T>::compile_stops(const Scene& scene, const Scales& scales) {
  for (const Stop& s : scene.stops) {
    Limit limit{s.kind, {}, -1, {}, -1};
    if (s.kind == Stop::Kind::angle) {
      limit.angle = relative_angle(s.body_a, s.body_b);
    } else if (s.kind == Stop::Kind::travel) {
      limit.travel = layout_.travel[s.joint];
    } else {
      limit.path = compile_path(scene, scales, s.a, s.b);
    }
    stops_.push_back(std::move(limit));
    const double per_unit = s.kind == Stop::Kind::angle ? 1.0 : scales.per_length();
    lower_.push_back(static_cast<T>(per_unit * s.min));
    upper_.push_back(static_cast<T>(per_unit * s.max));
  }
}

template <class T>
void Mechanism<T>::make_jacobian_pattern() {
  for (int s = 0; s < stops(); ++s) {
    Limit& stop = stops_[s];
    stop.first_entry = static_cast<int>(jacobian_row_.size());
    const auto add = [&](int t) {
      if (t < 0) return;
      jacobian_row_.push_back(2 * closures() + s);
      jacobian_column_.push_back(t);
    };
    if (stop.kind == Stop::Kind::angle) {
      if (stop.angle.a == stop.angle.b) continue;
      add(stop.angle.a);
      add(stop.angle.b);
    } else if (stop.kind == Stop::Kind::travel) {
      add(stop.travel);
    } else {
      for (int t : stop.path.support) add(t);
    }
  }
}

template <class T>
void Mechanism<T>::make_tangent_pattern() {
  std::unordered_map<std::uint64_t, int> known;
  const auto entry = [&](int i, int j) {
    const auto key = static_cast<std::uint64_t>(i) << 32 | static_cast<std::uint32_t>(j);
    const auto [at, fresh] = known.try_emplace(key, static_cast<int>(tangent_row_.size()));
    if (fresh) {
      tangent_row_.push_back(i);
      tangent_column_.push_back(j);
    }
    return at->second;
  };
  const bool full = has_follower_loads();
  const auto lower = [&](int i, int j) { return entry(std::max(i, j), std::min(i, j)); };
  const auto above = [&](int i, int j) { return full ? entry(std::min(i, j), std::max(i, j)) : -1; };
  if (full) {
    for (int i = 0; i < coordinates(); ++i) entry(i, i);
  } else {
    for (int i = 0; i < coordinates(); ++i) tangent_row_.push_back(i);
    tangent_column_ = tangent_row_;
  }
  const auto diagonal_or = [&](int i, int j) { return i == j ? i : lower(i, j); };
  slide_entry_.assign(coordinates() - angles(), -1);
  slide_transposed_ = slide_entry_;
  for (int t = angles(); t < coordinates(); ++t) {
    if (frame(t) < 0) continue;
    slide_entry_[t - angles()] = lower(t, frame(t));
    slide_transposed_[t - angles()] = above(t, frame(t));
  }
  const auto complete = [&](Path& path) {
    const auto& s = path.support;
    widest_path_ = std::max(widest_path_, static_cast<int>(s.size()));
    for (std::size_t i = 0; i < s.size(); ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        path.entry.push_back(diagonal_or(s[i], s[j]));
        if (full) path.transposed.push_back(i == j ? -1 : above(s[i], s[j]));
      }
    }
  };
  for (LineSpring& spring : springs_) complete(spring.path);
  for (Limit& stop : stops_) complete(stop.path);
  for (const LineDamper& damper : dampers_) {
    widest_path_ = std::max(widest_path_, static_cast<int>(damper.path.support.size()));
  }
  for (const DeadForce& force : dead_forces_) {
    widest_path_ = std::max(widest_path_, static_cast<int>(force.path.support.size()));
  }
  for (Follower& follower : followers_) {
    complete(follower.path);
    for (int i : follower.path.support) {
      if (follower.frame >= 0) follower.frame_entry.push_back(entry(i, follower.frame));
    }
  }
  for (AngleSpring& s : angle_springs_) {
    s.entry_aa = s.angle.a;
    s.entry_bb = s.angle.b;
    if (s.angle.a < 0 || s.angle.b < 0) continue;
    s.entry_ab = lower(s.angle.a, s.angle.b);
    s.entry_ba = above(s.angle.a, s.angle.b);
  }
}

// --- evaluation -----------------------------------------------------------------------------------------------------

template <class T>
std::vector<T> Mechanism<T>::start() const {
  std::vector<T> q;
  for (int i = 0; i < coordinates(); ++i) q.push_back(static_cast<T>(layout_.coordinates[i].start));
  return q;
}

template <class T>
void Mechanism<T>::place(const T* q, Planar<T>* pose) const {
  const int n = coordinates();
  const int n_angles = angles();
  for (int k = 0; k < n_angles; ++k) pose[k] = unit(q[k]);
  for (int t = n_angles; t < n; ++t) {
    const int f = frame(t);
    Planar<T>& along = pose[n + t - n_angles];
    along = f >= 0 ? pose[f] : Planar<T>{T(1), T(0)};
    pose[t] = q[t] * along;
  }
}

template <class T>
Planar<T> Mechanism<T>::evaluate(const Path& path, const Planar<T>* pose) const {
  Planar<T> p = path.constant;
  for (const Term& term : path.terms) p += term.coefficient * pose[term.coordinate];
  return p;
}

// d p / d q over the support:  i c phi  for an angle;  c exp(i theta_f)  for a length, and  i c phi  for its frame.
template <class T>
void Mechanism<T>::derivative(const Path& path, const Planar<T>* pose, Planar<T>* d) const {
  std::fill(d, d + path.support.size(), Planar<T>{});
  for (const Term& term : path.terms) {
    const int t = term.coordinate;
    const Planar<T> turned = quarter_turn(term.coefficient * pose[t]);
    if (t < angles()) {
      d[term.own_slot] += turned;
      continue;
    }
    d[term.own_slot] += term.coefficient * line_direction(pose, t);
    if (term.frame_slot >= 0) d[term.frame_slot] += turned;
  }
}

// d2 p / d q_i d q_j by slots i, j of the support, each pair once: no two angles ever mix.
template <class T>
template <class Add>
void Mechanism<T>::second_derivative(const Path& path, const Planar<T>* pose, Add add) const {
  for (const Term& term : path.terms) {
    const int t = term.coordinate;
    const int own = term.own_slot;
    const int f = term.frame_slot;
    if (t < angles()) {
      add(own, own, -(term.coefficient * pose[t]));
    } else if (f >= 0) {
      add(f, f, -(term.coefficient * pose[t]));
      add(std::max(own, f), std::min(own, f), quarter_turn(term.coefficient * line_direction(pose, t)));
    }
  }
}

template <class T>
void Mechanism<T>::add_symmetric(const Path& path, int i, int j, const T& value, T* values) const {
  const int at = i * (i + 1) / 2 + j;
  values[path.entry[at]] += value;
  if (!path.transposed.empty() && i != j) values[path.transposed[at]] += value;
}

// With B_i = d(r^2/2)/dq_i and A_ij = d2(r^2/2)/dq_i dq_j of r = |d|:  values += w A + u B B^T.
template <class T>
void Mechanism<T>::add_half_square(const Path& path, Planar<T>* pose, const T& w, const T& u, T* values) const {
  Planar<T>* d_i = scratch(pose);
  const Planar<T> d = evaluate(path, pose);
  derivative(path, pose, d_i);
  const int size = static_cast<int>(path.support.size());
  for (int i = 0; i < size; ++i) {
    const T b_i = u * dot(d, d_i[i]);
    for (int j = 0; j <= i; ++j) {
      add_symmetric(path, i, j, w * dot(d_i[i], d_i[j]) + b_i * dot(d, d_i[j]), values);
    }
  }
  second_derivative(path, pose,
                    [&](int i, int j, const Planar<T>& d_ij) { add_symmetric(path, i, j, w * dot(d, d_ij), values); });
}

template <class T>
T Mechanism<T>::energy(const T* q, Planar<T>* pose) const {
  T v(0);
  for (int t = 0; t < coordinates(); ++t) v -= load_[t].x * pose[t].x - load_[t].y * pose[t].y;
  if (has_torque_) {
    for (int k = 0; k < angles(); ++k) v -= torque_[k] * q[k];
  }
  for (const LineSpring& s : springs_) {
    const T r = norm(evaluate(s.path, pose));
    if (!s.slack(r)) v += s.stiffness * (r - s.free_length) * (r - s.free_length) / 2;
  }
  for (const AngleSpring& s : angle_springs_) {
    const T a = value(s.angle, q);
    v += s.stiffness * a * a / 2;
  }
  return v;
}

template <class T>
void Mechanism<T>::negative_force(const T* q, Planar<T>* pose, T* g) const {
  const int n = coordinates();
  // d/dq of -Re(a phi): Im(a phi) for an angle; -Re(a exp(i theta_f)) for a length and Im(a phi) for its frame.
  for (int k = 0; k < angles(); ++k) g[k] = load_[k].x * pose[k].y + load_[k].y * pose[k].x - torque_[k];
  for (int t = angles(); t < n; ++t) {
    const Planar<T>& along = line_direction(pose, t);
    g[t] = load_[t].y * along.y - load_[t].x * along.x;
    if (frame(t) >= 0) g[frame(t)] += load_[t].x * pose[t].y + load_[t].y * pose[t].x;
  }
  Planar<T>* d_i = scratch(pose);
  for (const LineSpring& s : springs_) {
    const Planar<T> d = evaluate(s.path, pose);
    const T r = norm(d);
    if (s.slack(r)) continue;
    // At r = 0 a spring of non-zero free length has no direction; it is taken as pulling nowhere.
    const T w = r == 0 ? s.stiffness : T(s.stiffness * (1 - s.free_length / r));
    derivative(s.path, pose, d_i);
    for (std::size_t i = 0; i < s.path.support.size(); ++i) g[s.path.support[i]] += w * dot(d, d_i[i]);
  }
  for (const AngleSpring& s : angle_springs_) {
    const T torque = s.stiffness * value(s.angle, q);
    if (s.angle.b >= 0) g[s.angle.b] += torque;
    if (s.angle.a >= 0) g[s.angle.a] -= torque;
  }
  for (const Follower& f : followers_) {
    const Planar<T> force = f.frame >= 0 ? f.force * pose[f.frame] : f.force;
    derivative(f.path, pose, d_i);
    for (std::size_t i = 0; i < f.path.support.size(); ++i) g[f.path.support[i]] -= dot(force, d_i[i]);
  }
}

template <class T>
void Mechanism<T>::constraint(const T* q, Planar<T>* pose, T* c) const {
  for (int l = 0; l < closures(); ++l) {
    Planar<T> gap = closure_constant_[l];
    for (int e = closure_first_[l]; e < closure_first_[l + 1]; ++e) {
      gap += closure_coefficient_[e] * pose[closure_coordinate_[e]];
    }
    c[2 * l] = gap.x;
    c[2 * l + 1] = gap.y;
  }
  for (int s = 0; s < stops(); ++s) {
    const Limit& stop = stops_[s];
    T& g = c[2 * closures() + s];
    if (stop.kind == Stop::Kind::angle)
      g = value(stop.angle, q);
    else if (stop.kind == Stop::Kind::travel)
      g = q[stop.travel];
    else
      g = norm(evaluate(stop.path, pose));
  }
}

template <class T>
void Mechanism<T>::jacobian(Planar<T>* pose, T* values) const {
  std::fill(values, values + jacobian_row_.size(), T(0));
  for (std::size_t e = 0; e < closure_coordinate_.size(); ++e) {
    const int t = closure_coordinate_[e];
    const Planar<T> c_phi = closure_coefficient_[e] * pose[t];
    if (t < angles()) {
      values[closure_own_[e]] -= c_phi.y;
      values[closure_own_[e] + 1] += c_phi.x;
      continue;
    }
    const Planar<T> along = closure_coefficient_[e] * line_direction(pose, t);
    values[closure_own_[e]] += along.x;
    values[closure_own_[e] + 1] += along.y;
    if (closure_frame_[e] < 0) continue;
    values[closure_frame_[e]] -= c_phi.y;
    values[closure_frame_[e] + 1] += c_phi.x;
  }
  for (const Limit& stop : stops_) {
    int e = stop.first_entry;
    if (stop.kind == Stop::Kind::angle) {
      if (stop.angle.a == stop.angle.b) continue;
      if (stop.angle.a >= 0) values[e++] = T(-1);
      if (stop.angle.b >= 0) values[e] = T(1);
    } else if (stop.kind == Stop::Kind::travel) {
      values[e] = T(1);
    } else {
      Planar<T>* d_i = scratch(pose);
      const Planar<T> d = evaluate(stop.path, pose);
      const T r = norm(d);
      derivative(stop.path, pose, d_i);
      for (std::size_t i = 0; i < stop.path.support.size(); ++i) values[e++] = r == 0 ? T(0) : T(dot(d, d_i[i]) / r);
    }
  }
}

template <class T>
void Mechanism<T>::tangent(Planar<T>* pose, const T* multiplier, T* values) const {
  const int n = coordinates();
  const int n_angles = angles();
  std::fill(values + n_angles, values + tangent_row_.size(), T(0));
  // Loads and closures are both linear in the phasors: Re(b phi) has the second derivatives -Re(b phi) in an angle,
  // -Im(b exp(i theta_f)) between a length and its frame.
  for (int k = 0; k < n_angles; ++k) values[k] = load_[k].x * pose[k].x - load_[k].y * pose[k].y;
  const auto bend_length = [&](int t, const Planar<T>& b) {
    if (frame(t) < 0) return;
    values[frame(t)] += b.y * pose[t].y - b.x * pose[t].x;
    const Planar<T>& along = line_direction(pose, t);
    const T mixed = -(b.x * along.y + b.y * along.x);
    values[slide_entry_[t - n_angles]] += mixed;
    if (slide_transposed_[t - n_angles] >= 0) values[slide_transposed_[t - n_angles]] += mixed;
  };
  for (int t = n_angles; t < n; ++t) bend_length(t, -load_[t]);
  for (int l = 0; l < closures(); ++l) {
    const Planar<T> pull = {multiplier[2 * l], -multiplier[2 * l + 1]};
    for (int e = closure_first_[l]; e < closure_first_[l + 1]; ++e) {
      const int t = closure_coordinate_[e];
      const Planar<T> b = pull * closure_coefficient_[e];
      if (t < n_angles)
        values[t] += b.y * pose[t].y - b.x * pose[t].x;
      else
        bend_length(t, b);
    }
  }
  for (const LineSpring& s : springs_) {
    const T r = norm(evaluate(s.path, pose));
    if (s.slack(r)) continue;
    const T bend = r == 0 ? T(0) : T(s.stiffness * s.free_length / r);
    add_half_square(s.path, pose, s.stiffness - bend, r == 0 ? T(0) : T(bend / (r * r)), values);
  }
  for (const AngleSpring& s : angle_springs_) {
    if (s.entry_aa >= 0) values[s.entry_aa] += s.stiffness;
    if (s.entry_bb >= 0) values[s.entry_bb] += s.stiffness;
    if (s.entry_ab >= 0) values[s.entry_ab] -= s.stiffness;
    if (s.entry_ba >= 0) values[s.entry_ba] -= s.stiffness;
  }
  for (int s = 0; s < stops(); ++s) {
    const Limit& stop = stops_[s];
    const T& push = multiplier[2 * closures() + s];
    if (stop.kind != Stop::Kind::distance || push == 0) continue;
    const T r = norm(evaluate(stop.path, pose));
    if (r != 0) add_half_square(stop.path, pose, push / r, -push / (r * r * r), values);
  }
  for (const Follower& f : followers_) {
    const Planar<T> force = f.frame >= 0 ? f.force * pose[f.frame] : f.force;
    second_derivative(f.path, pose, [&](int i, int j, const Planar<T>& d_ij) {
      add_symmetric(f.path, i, j, -dot(force, d_ij), values);
    });
    if (f.frame < 0) continue;
    Planar<T>* d_i = scratch(pose);
    derivative(f.path, pose, d_i);
    for (std::size_t i = 0; i < f.path.support.size(); ++i) {
      values[f.frame_entry[i]] -= dot(quarter_turn(force), d_i[i]);
    }
  }
}

template <class T>
std::vector<BodyPose<T>> Mechanism<T>::poses(const T* q) const {
  const auto at = [&](int t) { return t < coordinates() ? q[t] : static_cast<T>(layout_.coordinates[t].start); };
  std::vector<BodyPose<T>> out(layout_.links.size());
  for (int i : layout_.tree_order) {
    const Link& link = layout_.links[i];
    out[i].angle = static_cast<T>(link.turn) + (link.frame < 0 ? T(0) : at(link.frame));
    if (link.parent >= 0) out[i].origin = out[link.parent].origin;
    for (const Arm& arm : link.arms) {
      Planar<T> term = coefficient<T>(arm);
      if (arm.coordinate >= 0) {
        const bool is_angle = layout_.coordinates[arm.coordinate].kind == Coordinate::Kind::angle;
        const int f = is_angle ? arm.coordinate : frame(arm.coordinate);
        if (f >= 0) term = term * unit(at(f));
        if (!is_angle) term = at(arm.coordinate) * term;
      }
      out[i].origin += term;
    }
  }
  return out;
}

}  // namespace poise

#include "model/mechanism_motion_impl.hpp"
