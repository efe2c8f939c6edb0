#pragma once

#include <string>
#include <vector>

#include "model/layout.hpp"
#include "model/planar.hpp"
#include "model/scales.hpp"
#include "model/scene.hpp"

namespace poise {

/// Place of a body's frame in the world: origin, m, and unwrapped angle, rad.
template <class T>
struct BodyPose {
  Planar<T> origin{};
  T angle{};

  /// World coordinates of a point given in the body's frame, m.
  Planar<T> world(const Vec2& local) const { return origin + planar_cast<T>(local) * unit(angle); }
};

/// Coefficient  arm exp(i turn)  of an arm's phasor, in the scalar T.
template <class T>
Planar<T> coefficient(const Arm& arm) {
  const Planar<T> c = planar_cast<T>(arm.arm);
  return arm.turn == 0.0 ? c : c * unit(static_cast<T>(arm.turn));
}

/// A scene compiled to a short sum of phasors, ready to be evaluated in the scalar T.
///
/// Coordinates q (see Coordinate): n = coordinates(), angles first. With the phasors
///   phi_k = exp(i q_k)                 for an angle,
///   phi_t = q_t exp(i q_f(t)) or q_t   for a length along a line fixed in frame f(t) or in the ground,
/// every point of every body is  p(q) = c0 + sum_t c_t phi_t,  and so
///   dead loads and gravity  V_load(q) = -Re sum_t a_t phi_t - sum_k torque_k q_k,
///   loop closures           c_l(q)    = C_l0 + sum_t C_lt phi_t = 0   (real rows 2l: x and 2l+1: y, m),
///   springs                 V_s(q)    = k/2 (|d(q)| - L0)^2,  d again such a sum,
///   torsion springs         V_t(q)    = k/2 (relative angle - free angle)^2.
/// Stops follow the closures as rows of the constraint vector, lower() <= g(q) <= upper() (rad or m).
///
/// All functions are const and pure; what they share is computed once per configuration by place() into a caller's
/// buffer. Nothing allocates after construction. Template definitions are in model/mechanism_impl.hpp; Poise
/// instantiates double, and 50 digits in statics/reference.cpp.
template <class T>
class Mechanism {
 public:
  explicit Mechanism(const Scene& scene, Purpose purpose = Purpose::statics);
  /// The same from a layout of the scene, all numbers measured in `scales` instead of SI; time stays in seconds.
  Mechanism(const Scene& scene, Layout layout, Purpose purpose, const Scales& scales);

  const Layout& layout() const { return layout_; }
  int coordinates() const { return layout_.kept; }
  int closures() const { return static_cast<int>(closure_constant_.size()); }
  int stops() const { return static_cast<int>(stops_.size()); }
  /// Rows of the constraint vector: two per closure, then one per stop.
  int constraints() const { return 2 * closures() + stops(); }

  /// True when a load follows a body: then forces have no potential and the tangent is not symmetric.
  bool has_follower_loads() const { return !followers_.empty(); }
  /// Names of the forces that have no potential.
  const std::vector<std::string>& follower_names() const { return follower_names_; }

  /// Guesses of the scene for the kept coordinates, rad or m.
  std::vector<T> start() const;

  /// Size of the buffer `pose` that place() fills: phasors, directions of the lengths' lines, scratch.
  int pose_size() const { return 2 * coordinates() - layout_.angles + widest_path_; }
  /// Evaluates all phasors at q into `pose`. The other functions read them and use the scratch behind them.
  void place(const T* q, Planar<T>* pose) const;

  /// exp(i theta_f(t)), the direction of the line along which length coordinate t runs; 1 on the ground.
  const Planar<T>& line_direction(const Planar<T>* pose, int t) const { return pose[coordinates() + t - angles()]; }

  /// Potential of dead loads, gravity and springs, V(q), J; the zero of dead loads is arbitrary.
  T energy(const T* q, Planar<T>* pose) const;

  /// Negative generalized force  g = -Q(q)  of all loads, N m per rad or N, n values. Equals grad V where no load
  /// follows a body.
  void negative_force(const T* q, Planar<T>* pose, T* g) const;

  /// Closures and stops, constraints() values.
  void constraint(const T* q, Planar<T>* pose, T* c) const;

  /// Sparsity of the Jacobian of the constraints: entry e is at (jacobian_row[e], jacobian_column[e]).
  const std::vector<int>& jacobian_row() const { return jacobian_row_; }
  const std::vector<int>& jacobian_column() const { return jacobian_column_; }
  void jacobian(Planar<T>* pose, T* values) const;

  /// Sparsity of the tangent: lower triangle where symmetric, all of it with follower loads. Every diagonal entry is
  /// present, first and in order.
  const std::vector<int>& tangent_row() const { return tangent_row_; }
  const std::vector<int>& tangent_column() const { return tangent_column_; }
  /// Tangent stiffness  K = dg/dq + sum_r multiplier_r d2 c_r/dq2: the Hessian of the Lagrangian V + multiplier . c
  /// where loads have a potential. `multiplier` has constraints() values.
  void tangent(Planar<T>* pose, const T* multiplier, T* values) const;

  const std::vector<T>& lower() const { return lower_; }  ///< of the stops
  const std::vector<T>& upper() const { return upper_; }

  // Motion. Directions u, v, w have n values; phasor arrays have n entries; D is a derivative with respect to q.

  /// Directional derivatives of all phasors:  D phi_t[u],  D2 phi_t[u, v],  D3 phi_t[u, v, w].
  void phasor_first(const Planar<T>* pose, const T* u, Planar<T>* out) const;
  void phasor_second(const Planar<T>* pose, const T* u, const T* v, Planar<T>* out) const;
  void phasor_third(const Planar<T>* pose, const T* u, const T* v, const T* w, Planar<T>* out) const;
  /// g_a += sum_t Re(conj(d phi_t/dq_a) f_t): what a force f_t on every phasor does along each coordinate.
  void add_projection(const Planar<T>* pose, const Planar<T>* f, T* g) const;
  /// g_a += sum_t Re(conj(d/dq_a D phi_t[u]) f_t): how that changes along u while f stays.
  void add_projection_change(const Planar<T>* pose, const T* u, const Planar<T>* f, T* g) const;
  /// sum_t C_lt f_t of every closure l, 2 closures() values: the closures' derivatives from those of the phasors.
  void closures_of(const Planar<T>* f, T* c) const;

  /// g += what dampers and dry friction resist with at the rates v; v . g is the power they take.
  void add_resistance(Planar<T>* pose, const T* v, T* g) const;
  /// g += its change along dq and dv.
  void add_resistance_change(Planar<T>* pose, const T* v, const T* dq, const T* dv, T* g) const;
  /// Power that follower loads give at the rates v.
  T follower_power(Planar<T>* pose, const T* v) const;

  /// Numbers of a scene on which forces depend, by the list that their item is in.
  enum class Element {
    stiffness,
    free_length,
    torsion_stiffness,
    free_angle,
    damping,
    torsion_damping,
    friction,
    force,  ///< magnitude of a dead load, along its direction
    torque
  };
  /// g += by d(-Q)/dp at the rates v, for p the number `element` of item `index` of its list in the scene. Only for
  /// Purpose::dynamics, which keeps every item.
  void add_force_derivative(Element element, int index, const T& by, const T* q, Planar<T>* pose, const T* v,
                            T* g) const;

  /// Places of all bodies (indices of Scene::bodies) and then of all bars, dropped coordinates at their start value.
  std::vector<BodyPose<T>> poses(const T* q) const;

 private:
  struct Term {
    int coordinate;
    int own_slot;    // place of the coordinate in the support
    int frame_slot;  // place of its line's frame angle in the support, or -1
    Planar<T> coefficient;
  };
  // Sum of phasors c0 + sum_e coefficient_e phi_{coordinate_e} with the coordinates it depends on.
  struct Path {
    std::vector<Term> terms;
    Planar<T> constant{};
    std::vector<int> support;     // coordinates that move it, sorted
    std::vector<int> entry;       // tangent entries of support x support, row by row, lower part (i >= j)
    std::vector<int> transposed;  // the same above the diagonal; only with follower loads
  };
  struct LineSpring {
    Path path;
    T stiffness, free_length;
    Spring::Acts acts;

    bool slack(const T& length) const {
      return (acts == Spring::Acts::tension && length <= free_length) ||
             (acts == Spring::Acts::compression && length >= free_length);
    }
  };
  struct LineDamper {
    Path path;
    T coefficient;
  };
  struct DeadForce {
    Path path;
    Planar<T> direction;
  };
  struct Angle {  // sign_b q_b - sign_a q_a + constant, coordinates -1 where fixed
    int a = -1, b = -1;
    T constant{};
  };
  struct AngleSpring {
    Angle angle;
    T stiffness;
    int entry_aa, entry_bb, entry_ab, entry_ba;
  };
  struct AngleResistance {  // torque  coefficient w,  or, where width > 0,  coefficient tanh(w / width)
    Angle angle;
    T coefficient, width;

    T shape(const T& w) const;
    T slope(const T& w) const;  // d shape / dw
  };
  struct Follower {
    Path path;
    Planar<T> force;               // at zero angle of its frame
    int frame;                     // -1: fixed
    std::vector<int> frame_entry;  // tangent entry (support[i], frame)
  };
  struct Limit {
    Stop::Kind kind;
    Angle angle;      // angle stops
    int travel;       // travel stops
    Path path;        // distance stops
    int first_entry;  // in the Jacobian
  };

  int angles() const { return layout_.angles; }
  int frame(int t) const { return layout_.coordinates[t].frame; }
  Planar<T>* scratch(Planar<T>* pose) const { return pose + 2 * coordinates() - angles(); }
  Planar<T> evaluate(const Path& path, const Planar<T>* pose) const;
  void derivative(const Path& path, const Planar<T>* pose, Planar<T>* d) const;
  template <class Add>
  void second_derivative(const Path& path, const Planar<T>* pose, Add add) const;
  void add_phasor_gradient(const Planar<T>* b, Planar<T>* pose, T* g) const;
  Path compile(const std::vector<Arm>& arms) const;
  Angle relative_angle(int body_a, int body_b) const;
  T value(const Angle& angle, const T* q) const;
  void compile_loads(const Scene& scene, const Scales& scales);
  void compile_closures();
  void compile_springs(const Scene& scene, Purpose purpose, const Scales& scales);
  void compile_followers(const Scene& scene, const Scales& scales);
  void compile_stops(const Scene& scene, const Scales& scales);
  void compile_motion(const Scene& scene, const Scales& scales);
  Path compile_path(const Scene& scene, const Scales& scales, PointRef a, PointRef b) const;
  T rate(const Angle& angle, const T* v) const;
  void add_torque(const Angle& angle, const T& torque, T* g) const;
  Planar<T> add_up(const Path& path, const Planar<T>* d_i, const T* u) const;
  Planar<T> bend(const Path& path, const Planar<T>* pose, const T* u, const T* v) const;
  void add_length_gradient(const Path& path, Planar<T>* pose, const T& by, T* g) const;
  void make_jacobian_pattern();
  void make_tangent_pattern();
  void add_half_square(const Path& path, Planar<T>* pose, const T& w, const T& u, T* values) const;
  void add_symmetric(const Path& path, int i, int j, const T& value, T* values) const;

  Layout layout_;
  std::vector<Planar<T>> load_;  // a_t
  std::vector<T> torque_;        // per coordinate
  bool has_torque_ = false;
  // Closures in compressed rows; entry_own / entry_frame: place of the x row's Jacobian entry, y row next to it.
  std::vector<int> closure_first_;
  std::vector<int> closure_coordinate_;
  std::vector<Planar<T>> closure_coefficient_;
  std::vector<Planar<T>> closure_constant_;
  std::vector<int> closure_own_, closure_frame_;
  std::vector<LineSpring> springs_;
  std::vector<AngleSpring> angle_springs_;
  std::vector<LineDamper> dampers_;
  std::vector<AngleResistance> angle_resistances_;  // torsion dampers, then dry friction
  int torsion_dampers_ = 0;
  std::vector<DeadForce> dead_forces_;  // one by one, for derivatives; only for dynamics
  std::vector<int> torque_coordinate_;
  std::vector<Follower> followers_;
  std::vector<std::string> follower_names_;
  std::vector<Limit> stops_;
  std::vector<T> lower_, upper_;
  std::vector<int> jacobian_row_, jacobian_column_;
  std::vector<int> tangent_row_, tangent_column_;
  std::vector<int> slide_entry_, slide_transposed_;  // per length: tangent entry (length, frame) and (frame, length)
  int widest_path_ = 0;
};

extern template class Mechanism<double>;

}  // namespace poise
