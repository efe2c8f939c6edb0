#pragma once

#include <vector>

#include <Eigen/Core>

#include "model/scene.hpp"
#include "solvers/real50.hpp"

namespace poise::judge {

using Real = Real50;
using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;

/// A smooth function of the coordinates with its gradient and Hessian, the latter as entries to be added up.
struct Smooth {
  struct Entry {
    Eigen::Index i, j;
    Real value;
  };

  Real value{};
  Vector grad;
  std::vector<Entry> hessian;

  void add_hessian(const Real& factor, Matrix& to) const {
    for (const Entry& e : hessian) to(e.i, e.j) += factor * e.value;
  }
};

/// A stop at its limit: g = min (side -1) or g = max (side 1).
struct Contact {
  int stop = 0;
  int side = 0;

  friend bool operator==(const Contact&, const Contact&) = default;
};

/// A smooth piece of a scene: some one-way springs are slack, some stops are in contact.
struct Piece {
  std::vector<bool> slack;  ///< per element
  std::vector<Contact> contacts;

  friend bool operator==(const Piece&, const Piece&) = default;
};

/// Forces and constraints of a piece in one pose.
struct Forces {
  Vector force;              ///< -Q: negative generalized forces of loads and springs
  Matrix stiffness;          ///< d(-Q)/dq
  std::vector<Smooth> rows;  ///< joints, then contacts: zero where they hold
  bool smooth = true;        ///< false: a spring or stop acts on the distance of points that coincide
};

/// Statics of a Scene in 50 digits, written down from its declarations alone. Each moving body b has the coordinates
/// x, y of its origin and its angle, q[3 (b - 1) ...]; joints are equations between them. Lengths are measured in
/// `length`, angles in rad, energies in J. The doubles of the scene are exact. Nothing is shared with the compiled
/// mechanism, so that this can judge what is computed from it.
class ExactMechanics {
 public:
  /// `length`, m, must be a power of two.
  ExactMechanics(const Scene& scene, double length);

  const Scene& scene() const { return scene_; }
  const Real& length() const { return length_; }
  Eigen::Index coordinates() const { return 3 * (static_cast<Eigen::Index>(scene_.bodies.size()) - 1); }
  bool has_followers() const;
  /// By which redundant joints may disagree because the places of points are rounded: eight units in the last place of
  /// the largest.
  double rounding() const { return rounding_; }

  Forces at(const Vector& q, const Piece& piece) const;

  Smooth measure(const Measure& m, const Vector& q) const;
  /// A limit of a stop and the free length (angle) of a spring, in units of this mechanism.
  Real limit(const Stop& stop, int side) const;
  Real free_length(const Element& element) const;

  /// Gradients of all that loads, springs and stops depend on, as rows.
  Matrix observed(const Vector& q) const;
  /// Size of the terms that cancel in the forces: rounding of the scene's numbers as doubles is 1e-16 of it.
  Real force_scale(const Vector& q) const;

  /// World place of a point.
  Planar<Real> place(PointRef p, const Vector& q) const;
  /// s of  b = a + s axis,  |axis| = 1,  of a slide or pin in a slot.
  Real travel(int joint, const Vector& q) const;
  Real angle(int body, const Vector& q) const { return body == 0 ? Real(0) : q[3 * (body - 1) + 2]; }

 private:
  struct End {  // a point: its body and the world vector from the body's origin
    int body;
    Planar<Real> origin, arm;
  };

  Planar<Real> length_of(const Vec2& v) const { return {Real(v.x) / length_, Real(v.y) / length_}; }
  End end(int body, const Vec2& local, const Vector& q) const;
  End end(PointRef p, const Vector& q) const { return end(p.body, scene_.local(p), q); }
  Smooth zero() const;
  /// (b - a) . direction; the direction turns with body a or is fixed.
  Smooth component(const End& a, const End& b, const Planar<Real>& direction, bool turns) const;
  Smooth distance(const End& a, const End& b) const;
  Smooth angle_between(int a, int b, const Vector& q) const;
  void add_spring_of_zero_length(const Element& element, const Vector& q, Forces& out) const;
  void add_element(const Element& element, const Vector& q, Forces& out) const;
  void add_force(const End& at, const Planar<Real>& force, int follows, Forces& out) const;
  void add_joint(const Joint& joint, const Vector& q, std::vector<Smooth>& rows) const;

  const Scene& scene_;
  Real length_;
  double rounding_ = 0.0;
};

}  // namespace poise::judge
