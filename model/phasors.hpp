#pragma once

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "model/layout.hpp"
#include "model/planar.hpp"

namespace poise {

/// A number in the scalar T. Scalars that enclose all numbers that round to those of a scene specialise it: `rounding`
/// is by how much this one may differ.
template <class T>
T rounded_number(double value, double /*rounding*/) {
  return static_cast<T>(value);
}

/// Half the carriage of a slide along its line, in the frame of its second body, where that line is turned back by the
/// angle that the slide keeps.
template <class NumbersOfScene, class T = typename NumbersOfScene::Scalar>
Planar<T> end_of_carriage(const NumbersOfScene& numbers, int joint) {
  constexpr int length = 1;  // of the numbers of its friction
  return T(numbers.friction(joint, length) / T(2)) * (numbers.axis(joint) * unit(T(-numbers.kept_by(joint))));
}

/// The phasors of a mechanism's coordinates q, n = coordinates() of them, angles first:
///   phi_k = exp(i q_k)                 for an angle,
///   phi_t = q_t exp(i q_f(t)) or q_t   for a length along a line fixed in frame f(t) or in the ground.
/// place() evaluates them once per configuration into a caller's buffer `pose`, which all others read. Directions u, v,
/// w have n values, phasor arrays n entries; D is a derivative with respect to q.
template <class T>
class Phasors {
 public:
  /// With `keeps_values`, `pose` also holds the coordinates, for measures of angles and lengths.
  Phasors(const Layout& layout, bool keeps_values)
      : angles_(layout.angles), keeps_values_(keeps_values), start_(layout.coordinates.size()) {
    for (int t = 0; t < layout.kept; ++t) frame_.push_back(layout.coordinates[t].frame);
    for (std::size_t t = 0; t < start_.size(); ++t) start_[t] = static_cast<T>(layout.coordinates[t].start);
    for (const Coordinate& c : layout.coordinates) {
      is_angle_.push_back(c.kind == Coordinate::Kind::angle);
      any_frame_.push_back(c.frame);
    }
    for (std::size_t k = 0; k < layout.turns.size(); ++k) {
      const Turn& turn = layout.turns[k];
      turns_.push_back(turn.to<T>());
      turned_.push_back(unit(turns_.back()));
      if (!turn.varying.empty()) varying_turns_.push_back({static_cast<int>(k), turn.fixed.to<T>(), turn.varying});
    }
    varying_vectors_ = layout.vectors;
  }

  /// Takes what varies (Layout::varying) from these numbers, of the scalar T, in place of those that the layout was
  /// made of. Does not allocate after the first time.
  template <class NumbersOfScene>
  void set_numbers(const NumbersOfScene& numbers);

  int coordinates() const { return static_cast<int>(frame_.size()); }
  int angles() const { return angles_; }
  /// Coordinate of the angle of the frame in which the line of length t is fixed; -1 for the ground, and for angles.
  int frame(int t) const { return frame_[t]; }

  /// Size of `pose`: phasors, directions of the lengths' lines, and with `keeps_values` the coordinates.
  int pose_size() const { return (keeps_values_ ? 3 : 2) * coordinates() - angles_; }
  void place(const T* q, Planar<T>* pose) const {
    const int n = coordinates();
    for (int k = 0; k < angles_; ++k) pose[k] = unit(q[k]);
    for (int t = angles_; t < n; ++t) {
      const int f = frame_[t];
      Planar<T>& along = pose[n + t - angles_];
      along = f >= 0 ? pose[f] : Planar<T>{T(1), T(0)};
      pose[t] = q[t] * along;
    }
    if (!keeps_values_) return;
    Planar<T>* values = pose + 2 * n - angles_;
    for (int t = 0; t < n; ++t) values[t].x = q[t];
  }
  /// The same for some coordinates only, sorted, including the frames of the lengths; `phasors` false: the values only.
  void place_some(const T* q, const std::vector<int>& some, bool phasors, Planar<T>* pose) const {
    const int n = coordinates();
    for (const int t : some) {
      if (keeps_values_) pose[2 * n - angles_ + t].x = q[t];
      if (!phasors) continue;
      if (t < angles_) {
        pose[t] = unit(q[t]);
        continue;
      }
      Planar<T>& along = pose[n + t - angles_];
      along = frame_[t] >= 0 ? pose[frame_[t]] : Planar<T>{T(1), T(0)};
      pose[t] = q[t] * along;
    }
  }
  /// exp(i theta_f(t)), the direction of the line of length coordinate t; 1 on the ground.
  const Planar<T>& line_direction(const Planar<T>* pose, int t) const { return pose[coordinates() + t - angles_]; }
  /// q_t.
  const T& value(const Planar<T>* pose, int t) const { return pose[2 * coordinates() - angles_ + t].x; }

  /// Dropped coordinates and their start values.
  bool dropped(int t) const { return t >= coordinates(); }
  const T& start(int t) const { return start_[t]; }
  bool is_angle(int t) const { return is_angle_[t]; }
  int any_frame(int t) const { return any_frame_[t]; }

  /// The angle of an index into Layout::turns, and whether it varies; exp(i turn).
  const T& turn(int turn) const { return turns_[turn]; }
  bool turn_varies(int turn) const {
    return std::any_of(varying_turns_.begin(), varying_turns_.end(),
                       [&](const VaryingTurn& one) { return one.turn == turn; });
  }
  /// Whether the coefficient of an arm varies.
  bool varies(const Arm& arm) const { return arm.vector != 0 || turn_varies(arm.turn); }
  const Planar<T>& turned(int turn) const { return turned_[turn]; }
  /// Coefficient  arm exp(i turn)  of an arm's phasor; along a length it is a unit vector.
  Planar<T> coefficient(const Arm& arm) const {
    if (arm.vector != 0 && !vectors_.empty()) {
      const Planar<T>& vector = vectors_[static_cast<std::size_t>(std::abs(arm.vector)) - 1];
      const Planar<T> c = arm.vector > 0 ? vector : -vector;
      return arm.turn == 0 ? c : c * turned_[arm.turn];
    }
    const bool along = arm.coordinate >= 0 && !is_angle(arm.coordinate);
    Planar<T> c =
        along ? direction<T>(arm.arm)
              : Planar<T>{rounded_number<T>(arm.arm.x, arm.rounding.x), rounded_number<T>(arm.arm.y, arm.rounding.y)};
    c = {uncertain_number(c.x, arm.open.x), uncertain_number(c.y, arm.open.y)};
    return arm.turn == 0 ? c : c * turned_[arm.turn];
  }

  /// Directional derivatives of all phasors:  D phi_t[u],  D2 phi_t[u, v],  D3 phi_t[u, v, w].
  void first(const Planar<T>* pose, const T* u, Planar<T>* out) const;
  void second(const Planar<T>* pose, const T* u, const T* v, Planar<T>* out) const;
  void third(const Planar<T>* pose, const T* u, const T* v, const T* w, Planar<T>* out) const;
  /// g_a += sum_t Re(conj(d phi_t/dq_a) f_t): generalized forces of forces f_t on the phasors.
  void add_projection(const Planar<T>* pose, const Planar<T>* f, T* g) const;
  /// g_a += sum_t Re(conj(d/dq_a D phi_t[u]) f_t): their change along u for constant f.
  void add_projection_change(const Planar<T>* pose, const T* u, const Planar<T>* f, T* g) const;

 private:
  int angles_;
  bool keeps_values_;
  std::vector<int> frame_;
  std::vector<T> start_;
  std::vector<char> is_angle_;
  std::vector<int> any_frame_;
  std::vector<T> turns_;
  std::vector<Planar<T>> turned_;
  struct VaryingTurn {
    int turn;
    T fixed;
    std::vector<int> joints;  // as Turn::varying
  };
  std::vector<VaryingTurn> varying_turns_;
  std::vector<VaryingVector> varying_vectors_;
  std::vector<Planar<T>> vectors_;  // of these, once numbers are set
};

template <class T>
template <class NumbersOfScene>
void Phasors<T>::set_numbers(const NumbersOfScene& numbers) {
  for (const VaryingTurn& one : varying_turns_) {
    T sum = one.fixed;
    for (const int joint : one.joints) {
      const T& angle = numbers.kept_by(std::abs(joint) - 1);
      sum = joint > 0 ? T(sum + angle) : T(sum - angle);
    }
    turned_[one.turn] = unit(sum);
    turns_[one.turn] = sum;
  }
  vectors_.resize(varying_vectors_.size());
  for (std::size_t k = 0; k < vectors_.size(); ++k) {
    const VaryingVector& one = varying_vectors_[k];
    vectors_[k] = one.of == VaryingVector::Of::point  ? numbers.point(one.point)
                  : one.of == VaryingVector::Of::bar  ? Planar<T>{numbers.kept_by(one.joint), T(0)}
                  : one.of == VaryingVector::Of::axis ? numbers.axis(one.joint)
                                                      : end_of_carriage(numbers, one.joint);
  }
}

template <class T>
void Phasors<T>::first(const Planar<T>* pose, const T* u, Planar<T>* out) const {
  for (int k = 0; k < angles(); ++k) out[k] = u[k] * quarter_turn(pose[k]);
  for (int t = angles(); t < coordinates(); ++t) {
    out[t] = u[t] * line_direction(pose, t);
    if (frame(t) >= 0) out[t] += u[frame(t)] * quarter_turn(pose[t]);
  }
}

template <class T>
void Phasors<T>::second(const Planar<T>* pose, const T* u, const T* v, Planar<T>* out) const {
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
void Phasors<T>::third(const Planar<T>* pose, const T* u, const T* v, const T* w, Planar<T>* out) const {
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
void Phasors<T>::add_projection(const Planar<T>* pose, const Planar<T>* f, T* g) const {
  for (int k = 0; k < angles(); ++k) g[k] += cross(pose[k], f[k]);
  for (int t = angles(); t < coordinates(); ++t) {
    g[t] += dot(line_direction(pose, t), f[t]);
    if (frame(t) >= 0) g[frame(t)] += cross(pose[t], f[t]);
  }
}

template <class T>
void Phasors<T>::add_projection_change(const Planar<T>* pose, const T* u, const Planar<T>* f, T* g) const {
  for (int k = 0; k < angles(); ++k) g[k] -= u[k] * dot(pose[k], f[k]);
  for (int t = angles(); t < coordinates(); ++t) {
    const int of = frame(t);
    if (of < 0) continue;
    const T across = cross(line_direction(pose, t), f[t]);
    g[t] += u[of] * across;
    g[of] += u[t] * across - u[of] * dot(pose[t], f[t]);
  }
}

}  // namespace poise
