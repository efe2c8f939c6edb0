#pragma once

#include <array>
#include <vector>

#include "model/mechanism.hpp"

namespace poise {

/// Inertia of a mechanism in phasor form. The centre of mass of every body is a sum of phasors, so the kinetic energy
///   T = 1/2 sum_bodies (m |dp/dt|^2 + I (dtheta/dt)^2) = 1/2 qdot^T M(q) qdot
/// reduces, for any number of bodies, to one complex constant per pair of phasors and one moment per frame:
///   M_ab = Re sum_tu conj(d phi_t / d q_a) W_tu (d phi_u / d q_b)  +  J_a [a = b, an angle],
///   W_tu = sum_bodies m conj(c_t) c_u.
/// The mechanism must be compiled for Purpose::dynamics, and must outlive this. Memory is n^2.
template <class T>
class Inertia {
 public:
  Inertia(const Scene& scene, const Mechanism<T>& mechanism);
  /// With these numbers, Numbers<T> or SceneNumbers<T>, which the mechanism has been given too where some vary.
  template <class NumbersOfScene>
  Inertia(const NumbersOfScene& numbers, const Mechanism<T>& mechanism);

  /// out_t = sum_u W_tu f_u: the inertia force on phasor t for phasor accelerations f. out must not be f.
  void weigh(const Planar<T>* f, Planar<T>* out) const;
  /// Moment J_a of the bodies that turn with coordinate a, zero for lengths.
  const T& moment(int a) const { return moment_[a]; }

  /// g += generalized force that the inertia `part`, moving with `body`, requires in addition to its weight, at the
  /// rates v:
  ///   m (p'' - gravity) . Dp + first-moment terms + J theta'' D theta,
  /// linear in `part`: with unit parts, the derivatives of the equations of motion by the inertia of a body. p of the
  /// body's origin; `second` are the second time derivatives of all phasors, a the accelerations of the coordinates.
  /// `frame`: the acceleration of the frame of the scene.
  void add_body(int body, const BodyInertia<T>& part, const Planar<T>* pose, const T* a, const Planar<T>* second, T* g,
                const Planar<T>& frame = {}) const;

  /// With it as `frame` bodies have no weight.
  const Planar<T>& gravity() const { return gravity_; }

  /// M(q), n x n, row by row: kg m^2 between angles, kg m with one length, kg between lengths. `pose` from place().
  void mass_matrix(const Planar<T>* pose, T* m) const;

 private:
  // Partial derivatives of one phasor: at most its own coordinate and the angle of its line's frame.
  struct Partial {
    int coordinate = -1;
    Planar<T> value{};
  };
  std::array<Partial, 2> first(const Planar<T>* pose, int t) const;

  const Mechanism<T>& mechanism_;
  int n_;
  std::vector<std::size_t> moved_;  // coordinates that move masses: of all others, rows and columns of W are zero
  std::vector<Planar<T>> w_;        // W of these, row by row
  std::vector<T> moment_;           // J per coordinate
  Planar<T> gravity_;
  struct Origin {  // of a body, a sum of phasors
    std::vector<int> coordinate;
    std::vector<Planar<T>> coefficient;
    int frame = -1;
    Planar<T> turn{};
  };
  std::vector<Origin> origin_;
};

extern template class Inertia<double>;

}  // namespace poise
