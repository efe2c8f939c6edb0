#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "design/balance/pose_form.hpp"

namespace poise {

/// Generalised forces of loads and linear springs on the coordinates of a mechanism whose coordinates are independent:
/// torques on angles, forces on travels. Those that a hand needs are the opposite.
struct TorqueForm {
  /// A spring between points, d = b - a, r = |d|, or on an angle or a sum of travels and angles r = constant + sum of
  /// factors times coordinates:  V = k (r^2/2 - L r) + F r.
  struct Spring {
    int sought = -1;  ///< index of its stiffness among those that are sought, or -1
    double stiffness = 0.0, length = 0.0, force = 0.0;
    bool is_angle = false;
    PhasorTerms d;
    std::vector<double> factors;  ///< of the coordinates, of an angle
    double constant = 0.0;
  };
  struct Load {
    PhasorTerms place;
    Vec2 force;
  };
  std::vector<int> coordinates;  ///< of the layout, those that the torques are on
  std::vector<char> is_length;
  std::vector<Spring> springs;
  std::vector<Load> loads;
  std::vector<double> constant;  ///< torques that are the same in all poses
};

/// Coordinates with their cosines and sines.
template <class T>
struct PlacedCoordinates {
  std::vector<T> q;
  std::vector<Planar<T>> unit;  ///< exp(i q) of angles
};

template <class T>
struct Torques {
  std::vector<T> value;  ///< per coordinate
  std::vector<T> by;     ///< derivative of torque j by coordinate l at j n + l
};

/// A vector with its derivatives by the coordinates.
template <class T>
struct VectorAt {
  Planar<T> value{};
  std::vector<Planar<T>> by;      // n
  std::vector<Planar<T>> by_two;  // n n
};

template <class T>
VectorAt<T> vector_at(const TorqueForm& form, const PhasorTerms& terms, const PlacedCoordinates<T>& at) {
  const std::size_t n = form.coordinates.size();
  VectorAt<T> out;
  out.by.resize(n);
  out.by_two.resize(n * n);
  const auto slot = [&](int coordinate) {
    for (std::size_t k = 0; k < n; ++k) {
      if (form.coordinates[k] == coordinate) return k;
    }
    return n;
  };
  for (const auto& [phasor, coefficient] : terms) {
    const std::size_t angle = phasor.angle >= 0 ? slot(phasor.angle) : n;
    const std::size_t length = phasor.length >= 0 ? slot(phasor.length) : n;
    const Planar<T> c = planar_cast<T>(coefficient);
    const Planar<T> along = angle < n ? c * at.unit[angle] : c;
    const Planar<T> whole = length < n ? at.q[length] * along : along;
    out.value += whole;
    if (length < n) out.by[length] += along;
    if (angle < n) {
      out.by[angle] += quarter_turn(whole);
      out.by_two[angle * n + angle] -= whole;
    }
    if (angle < n && length < n) {
      out.by_two[angle * n + length] += quarter_turn(along);
      out.by_two[length * n + angle] += quarter_turn(along);
    }
  }
  return out;
}

template <class T>
void add_spring(const TorqueForm& form, const TorqueForm::Spring& spring, double stiffness,
                const PlacedCoordinates<T>& at, Torques<T>& out) {
  const std::size_t n = form.coordinates.size();
  const T k(stiffness), L(spring.length), F(spring.force);
  if (spring.is_angle) {
    T r(spring.constant);
    for (std::size_t j = 0; j < n; ++j) r += T(spring.factors[j]) * at.q[j];
    const T force = k * (r - L) + F;
    for (std::size_t j = 0; j < n; ++j) {
      out.value[j] -= T(spring.factors[j]) * force;
      for (std::size_t l = 0; l < n; ++l) out.by[j * n + l] -= T(spring.factors[j] * spring.factors[l]) * k;
    }
    return;
  }
  using std::sqrt;
  const VectorAt<T> d = vector_at(form, spring.d, at);
  // A spring without free length keeps its form where its ends meet.
  const bool has_length = spring.length != 0.0 || spring.force != 0.0;
  const T pull = k * L - F;
  const T square = d.value.x * d.value.x + d.value.y * d.value.y;
  const T r = has_length ? sqrt(square) : T(1);
  const T over_r = has_length ? k - pull / r : k;
  const T bend = has_length ? pull / (r * square) : T(0);
  for (std::size_t j = 0; j < n; ++j) {
    const T dj = dot(d.value, d.by[j]);
    out.value[j] -= over_r * dj;
    for (std::size_t l = 0; l < n; ++l) {
      out.by[j * n + l] -= over_r * (dot(d.by[l], d.by[j]) + dot(d.value, d.by_two[j * n + l]));
      if (has_length) out.by[j * n + l] -= bend * (dot(d.value, d.by[l]) * dj);
    }
  }
}

/// All torques with these stiffnesses of the springs that are sought, SI.
template <class T>
Torques<T> torques_at(const TorqueForm& form, const std::vector<double>& stiffnesses, const PlacedCoordinates<T>& at) {
  const std::size_t n = form.coordinates.size();
  Torques<T> out;
  for (const double constant : form.constant) out.value.push_back(T(constant));
  out.by.assign(n * n, T(0));
  for (const TorqueForm::Load& load : form.loads) {
    const VectorAt<T> p = vector_at(form, load.place, at);
    const Planar<T> force = planar_cast<T>(load.force);
    for (std::size_t j = 0; j < n; ++j) {
      out.value[j] += dot(force, p.by[j]);
      for (std::size_t l = 0; l < n; ++l) out.by[j * n + l] += dot(force, p.by_two[j * n + l]);
    }
  }
  for (const TorqueForm::Spring& spring : form.springs) {
    const double k = spring.sought >= 0 ? stiffnesses[static_cast<std::size_t>(spring.sought)] : spring.stiffness;
    add_spring(form, spring, k, at, out);
  }
  return out;
}

/// Bounds of the largest size of a torque over a box of the coordinates.
struct LargestTorque {
  double reached = 0.0;  ///< proved to be reached, in `at`
  double upper = 0.0;    ///< proved not to be passed; infinite where the springs' lengths may be zero
  std::vector<double> at;
  int boxes = 0;  ///< examined
};

/// Encloses the torques in interval arithmetic on boxes that are halved where the bound is largest, by the derivatives
/// over each box (mean value form), until the bounds are within `gap` of each other, relatively, or the upper one is no
/// more than `rounding`, N m, or after `most` boxes.
LargestTorque largest_torque(const TorqueForm& form, const std::vector<double>& stiffnesses,
                             const std::vector<double>& from, const std::vector<double>& to, double gap,
                             double rounding, int most);

/// A pose and a torque in it with its weight in a combination.
struct WeighedTorque {
  std::vector<double> q;
  std::size_t coordinate = 0;
  double weight = 0.0;  ///< with the sign that the torque has in the combination
};

/// A lower bound of the largest size of these torques, for all stiffnesses within the ranges: the sizes of the weights
/// add up to one at most after division by their sum, so the largest torque is no less than the combination, whose
/// least value over the ranges is that at their ends, as it is linear in each. In interval arithmetic.
double least_largest_torque(const TorqueForm& form, const std::vector<WeighedTorque>& torques,
                            const std::vector<double>& least, const std::vector<double>& greatest);

}  // namespace poise
