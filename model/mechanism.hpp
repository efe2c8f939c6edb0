#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "model/layout.hpp"
#include "model/measures/measures.hpp"
#include "model/phasor_sum.hpp"
#include "model/phasors.hpp"
#include "model/planar.hpp"
#include "model/scene.hpp"

namespace poise {

/// Pose of a body's frame in the world: origin, m, and unwrapped angle, rad.
template <class T>
struct BodyPose {
  Planar<T> origin{};
  T angle{};

  /// Of the frame's x axis.
  Planar<T> direction() const { return unit(angle); }
  /// World coordinates of a point given in the body's frame, m.
  Planar<T> world(const Vec2& local) const { return origin + planar_cast<T>(local) * direction(); }
};

/// Rows of the constraint vector that belong together, for example those of one loop.
struct ConstraintBlock {
  int closure = -1;  ///< index into Layout::closures
  int first_row = 0;
  int rows = 0;
};

/// A number that forces depend on: of a force element or a load of the scene.
struct ForceNumber {
  enum class Of { element, force, torque, frame };
  Of of = Of::element;
  int item = 0;          ///< index into Scene::elements, forces or torques
  int number = 0;        ///< element: index into the numbers of its law; frame: 0 for x, 1 for y
  int time_number = -1;  ///< if >= 0 index into the numbers of the function of time of that, in place of its own
};

/// The number `time_number` of the function of time of a load, a spring or a frame, not of a drive; `part` as of
/// TimeFunction.
inline ForceNumber force_number(TimeFunction::Of of, int item, int part, int time_number) {
  switch (of) {
    case TimeFunction::Of::force:
      return {ForceNumber::Of::force, item, 0, time_number};
    case TimeFunction::Of::torque:
      return {ForceNumber::Of::torque, item, 0, time_number};
    case TimeFunction::Of::frame:
      return {ForceNumber::Of::frame, item, part, time_number};
    default:
      return {ForceNumber::Of::element, item, part, time_number};
  }
}

/// What forces of a motion follow besides places and rates: by element of the scene laws to use in place of those
/// compiled, or null.
template <class T>
struct ForcesInTime {
  const LawIn<T>* const* laws = nullptr;
  const T* reactions = nullptr;  ///< by element what controllers read of forces that follow from accelerations, or null
};

/// The law that an element has there.
template <class T, class MechanismOf>
const LawIn<T>& law_in_time(const MechanismOf& mechanism, const ForcesInTime<T>& in_time, int element) {
  const bool varies = in_time.laws != nullptr && in_time.laws[element] != nullptr;
  return varies ? *in_time.laws[element] : mechanism.law_of(element);
}

/// A direction along which controllers change: of places and rates, unless null, and of a number of the law of an
/// element.
template <class T>
struct ControlChange {
  const T* dq = nullptr;
  const T* dv = nullptr;
  int element = -1;  ///< or none
  int number = 0;
  T by{};                        ///< of the number
  const T* reactions = nullptr;  ///< of those of ForcesInTime, or null
};

/// A scene compiled to a short sum of phasors, to be evaluated in the scalar T; in lanes (model/pack.hpp) of several
/// variants of the scene at once.
///
/// Coordinates q (see Coordinate): n = coordinates(), angles first. Every point of every body is a sum
/// p(q) = c0 + sum_t c_t phi_t  of their phasors (see Phasors), and so
///   dead loads and gravity  V_load(q) = -Re sum_t a_t phi_t - sum_k torque_k q_k,
///   loop closures           c_l(q)    = C_l0 + sum_t C_lt phi_t = 0   (one block of real rows x, y each, m),
///   force elements          V_e(q)    = V(g(q)) with the force T = dV/dg of the law on the measure g.
/// Stops follow the equalities as rows of the constraint vector, lower() <= g(q) <= upper() (rad or m).
///
/// Units are those of the scene: SI, or those of scaled(). All functions are const and pure; shared values are computed
/// once per configuration by place() into a caller's buffer. Nothing allocates after construction. Template definitions
/// are in model/mechanism_impl.hpp; Poise instantiates double, and 50 digits in statics/.
template <class T>
class Mechanism {
 public:
  explicit Mechanism(const Scene& scene, Purpose purpose = Purpose::statics);
  /// The same from a layout of the scene.
  Mechanism(const Scene& scene, Layout layout, Purpose purpose);
  /// Gives all that varies (Layout::varying) the values that it has in these numbers: a Numbers<T> of the same scene,
  /// or the SceneNumbers<T> of one that differs from it in such numbers only. Where T is a dual number all results then
  /// have derivatives by the numbers. Laws refer to the numbers. Of a mechanism for statics.
  template <class NumbersOfScene>
  void set_numbers(const NumbersOfScene& numbers);
  Mechanism(const Mechanism&);
  Mechanism(Mechanism&&) noexcept;
  Mechanism& operator=(const Mechanism&);
  Mechanism& operator=(Mechanism&&) noexcept;
  ~Mechanism();

  const Layout& layout() const { return layout_; }
  const Phasors<T>& phasors() const { return phasors_; }
  int coordinates() const { return layout_.kept; }
  int closures() const { return static_cast<int>(closure_constant_.size()); }
  /// Rows that must be zero, in blocks.
  int equalities() const { return equalities_; }
  const std::vector<ConstraintBlock>& blocks() const { return blocks_; }
  int stops() const { return static_cast<int>(stops_.size()); }
  /// Row of a stop in the constraint vector.
  int stop_row(int stop) const { return equalities_ + stop; }
  /// Rows of the constraint vector: equalities, then one per stop.
  int constraints() const { return equalities_ + stops(); }

  /// True if a load follows a body: then forces have no potential and the tangent is not symmetric.
  bool has_follower_loads() const { return !followers_.empty(); }
  /// Names of the forces that have no potential.
  const std::vector<std::string>& follower_names() const { return follower_names_; }

  /// Guesses of the scene for the kept coordinates, rad or m.
  std::vector<T> start() const;

  /// Size of the buffer `pose` that place() fills, with scratch behind it.
  int pose_size() const { return phasors_.pose_size() + scratch_size_; }
  /// Evaluates all phasors at q into `pose`. The other functions read them and use the scratch.
  void place(const T* q, Planar<T>* pose) const { phasors_.place(q, pose); }

  /// Potential of dead loads, gravity and force elements, V(q), J; the zero of dead loads is arbitrary.
  T energy(const T* q, Planar<T>* pose) const;

  /// Negative generalized force  g = -Q(q)  of all loads, N m per rad or N, n values. Equals grad V if no load follows
  /// a body.
  void negative_force(const T* q, Planar<T>* pose, T* g) const;

  /// Equalities and stops, constraints() values.
  void constraint(const T* q, Planar<T>* pose, T* c) const;

  /// Sparsity of the Jacobian of the constraints: entry e is at (jacobian_row[e], jacobian_column[e]).
  const std::vector<int>& jacobian_row() const { return jacobian_row_; }
  const std::vector<int>& jacobian_column() const { return jacobian_column_; }
  void jacobian(Planar<T>* pose, T* values) const;

  /// Sparsity of the tangent: lower triangle if symmetric, all of it with follower loads. Every diagonal entry is
  /// present, first and in order.
  const std::vector<int>& tangent_row() const { return tangent_row_; }
  const std::vector<int>& tangent_column() const { return tangent_column_; }
  /// Tangent stiffness  K = dg/dq + sum_r multiplier_r d2 c_r/dq2: the Hessian of the Lagrangian V + multiplier . c
  /// if loads have a potential. `multiplier` has constraints() values.
  void tangent(Planar<T>* pose, const T* multiplier, T* values) const;

  const std::vector<T>& lower() const { return lower_; }  ///< of the stops
  const std::vector<T>& upper() const { return upper_; }

  /// Force elements that take part; for Purpose::dynamics all, in the order of the scene.
  int elements() const { return static_cast<int>(elements_.size()); }
  /// The law of one, and the value of its measure.
  const LawIn<T>& law_of(int element) const { return elements_[element].law; }
  void replace_law(int element, const LawIn<T>& law) { elements_[element].law = law; }
  T measure_of(int element, Planar<T>* pose) const { return elements_[element].on.value(at(pose)); }
  T rate_of(int element, Planar<T>* pose, const T* v) const { return elements_[element].on.along(at(pose), v); }
  /// g += the gradient of its measure, n values.
  void add_measure_gradient(int element, Planar<T>* pose, T* g) const { add_measure_gradient(element, pose, T(1), g); }
  /// g += force times that, and its change along dq where the force changes by `slope` with the measure.
  void add_measure_gradient(int element, Planar<T>* pose, const T& force, T* g) const {
    elements_[element].on.add_gradient(at(pose), force, g);
  }
  void add_measure_change(int element, Planar<T>* pose, const T& force, const T& slope, const T* dq, T* g) const {
    const CompiledMeasure<T>& on = elements_[element].on;
    on.add_gradient(at(pose), slope * on.along(at(pose), dq), g);
    on.add_bend(at(pose), dq, force, g);
  }

  // Motion.

  /// The equalities' derivatives from those of the phasors, equalities() values: sum_t C_lt f_t of every closure.
  void closures_of(const Planar<T>* f, T* c) const;

  /// Size of the buffer `resistances` that resist() fills.
  int resistances_size() const { return resistances_size_; }
  /// Evaluates dampers, friction and controllers at the rates v into `resistances`, which the next two read. `slides`,
  /// where given, has a value per element, of which those of friction that sticks are used: the direction in which it
  /// slides, 1 or -1, in place of the sign of its rate; 0 of what is held, which has no force here; 2 or -2 where it
  /// begins to slide (DryFriction::sliding()).
  void resist(Planar<T>* pose, const T* v, const int* slides, T* resistances,
              const ForcesInTime<T>& in_time = {}) const;
  /// g += their generalized forces; v . g is the power they dissipate.
  void add_resistance(const T* resistances, T* g) const;
  /// g += the change of these along dq and dv.
  void add_resistance_change(Planar<T>* pose, const T* resistances, const T* v, const T* dq, const T* dv, T* g,
                             const ForcesInTime<T>& in_time = {}) const;
  bool is_controller(int element) const { return controller_of(elements_[element].law) != nullptr; }
  /// Whether an element is a controller, or one whose force a controller reads, or of which one sets a number.
  bool is_of_control(int element) const;
  /// What a controller reads of the mechanism, and its states, at the rates v: without what other controllers give it.
  ControlSignals<T> own_signals_of(int element, Planar<T>* pose, const T* v) const {
    return own_signals(control_of(element), at(pose), v);
  }
  /// Their changes along dq and dv: with dq = v and dv the accelerations by time.
  ControlSignals<T> own_signals_along(int element, Planar<T>* pose, const T* v, const T* dq, const T* dv) const {
    return own_signals_along(control_of(element), at(pose), v, dq, dv);
  }
  /// All that it knows, and how that changes.
  ControlSignals<T> signals_of(int element, Planar<T>* pose, const T* v, const ForcesInTime<T>& in_time = {}) const {
    return signals(control_of(element), at(pose), v, in_time, true);
  }
  ControlSignals<T> signals_along(int element, Planar<T>* pose, const T* v, const ControlChange<T>& change,
                                  const ForcesInTime<T>& in_time = {}) const {
    return signals_along(control_of(element), at(pose), v, change, in_time, true);
  }
  /// What it does there, and how that changes.
  ControlOutputs<T> outputs_of(int element, Planar<T>* pose, const T* v, const ForcesInTime<T>& in_time = {}) const {
    return outputs(control_of(element), at(pose), v, in_time, true);
  }
  ControlOutputs<T> outputs_along(int element, Planar<T>* pose, const T* v, const ControlChange<T>& change,
                                  const ForcesInTime<T>& in_time = {}) const {
    return outputs_along(control_of(element), at(pose), v, change, in_time, true);
  }
  /// g += the change of -Q along a direction in which no place and no rate changes: of the element named there, for
  /// which is_of_control(), and of the controllers behind it.
  void add_control_derivative(const ControlChange<T>& change, Planar<T>* pose, const T* v,
                              const ForcesInTime<T>& in_time, T* g) const;
  /// g += the change of -Q where what controllers read of forces that follow from accelerations changes by `reactions`,
  /// one of each element: of their states alone.
  void add_change_of_read(const T* reactions, Planar<T>* pose, const T* v, const ForcesInTime<T>& in_time, T* g) const;
  /// g -= what the scene's generalized forces change by where the output of a controller does by one.
  void add_output_derivative(int element, Planar<T>* pose, const T* v, T* g) const {
    add_push(control_of(element), T(1), at(pose), v, {}, g);
  }
  /// g += the generalized force that a frame with this acceleration requires of all masses, and its change along dq. Of
  /// a scene whose frame moves (Scene::time_functions), compiled for dynamics.
  void add_frame(const Planar<T>& acceleration, const Planar<T>* pose, T* g) const;
  void add_frame_change(const Planar<T>& acceleration, const Planar<T>* pose, const T* dq, T* g) const;
  /// Power of follower loads at the rates v.
  T follower_power(Planar<T>* pose, const T* v) const;

  /// g += by d(-Q)/dp at the rates v, for p a number that forces depend on, of a force its magnitude. Only for
  /// Purpose::dynamics, which keeps every item. `slides` as of resist().
  void add_force_derivative(const ForceNumber& number, const T& by, Planar<T>* pose, const T* v, const int* slides,
                            T* g) const;

  /// Poses of all bodies (indices of Scene::bodies) and then of all bars, dropped coordinates at their start value.
  /// Origins are measured from the point `from` of the world; the ground's is then -from.
  std::vector<BodyPose<T>> poses(const T* q, const Vec2& from = {}) const;

 private:
  // Places in the tangent of support x support of a measure, row by row.
  struct TangentBlock {
    std::vector<int> entry;       // lower part (i >= j)
    std::vector<int> transposed;  // the same above the diagonal, only with follower loads; -1 on it

    void add(int i, int j, const T& value, T* values) const {
      const int at = i * (i + 1) / 2 + j;
      values[entry[at]] += value;
      if (!transposed.empty() && i != j) values[transposed[at]] += value;
    }
  };
  struct ForceElement {
    CompiledMeasure<T> on;
    LawIn<T> law;
    TangentBlock block;
    int element;          // of the scene
    bool is_half_square;  // of the distance, see HalfSquareMeasure
  };
  struct Control {
    int element;                                 // of elements_
    CompiledMeasure<T> reads, integral, filter;  // the angles of its states, or nothing
    std::array<CompiledMeasure<T>, 3> held;
    T inertia{};                        // of these
    int on = -1;                        // the element whose measure it acts on
    int sets = -1;                      // the number of that element's law that it adds to
    int load = -1;                      // of loads_, to whose size it adds
    std::vector<int> turns;             // coordinates on which it acts by a torque
    T turned_by{1};                     // of a unit of its effort
    int follows = -1, reads_from = -1;  // controllers
    int reads_force = -1;               // an element
    int force_set_by = -1;              // the controller that sets a number of that

    bool reads_reaction = false;
    bool is_behind_others() const { return follows >= 0 || reads_from >= 0 || reads_force >= 0 || reads_reaction; }
  };
  struct LoadAt {  // a unit force at a point, for derivatives; its frame as of a follower, or -1
    PhasorSum<T> path;
    Planar<T> direction;
    int frame;
  };
  struct Follower {
    PhasorSum<T> path;
    TangentBlock block;
    Planar<T> force;               // at zero angle of its frame
    int load;                      // index into Scene::forces
    int frame;                     // -1: fixed
    std::vector<int> frame_entry;  // tangent entry (support[i], frame)
  };
  struct Limit {
    CompiledMeasure<T> on;
    TangentBlock block;
    std::vector<int> entry;  // in the Jacobian, by slot
  };

  int angles() const { return layout_.angles; }
  int frame(int t) const { return phasors_.frame(t); }
  const Planar<T>& line_direction(const Planar<T>* pose, int t) const { return phasors_.line_direction(pose, t); }
  Configuration<T> at(Planar<T>* pose) const { return {phasors_, pose, pose + phasors_.pose_size()}; }
  Planar<T> world_force(const Planar<T>& force, int frame, const Planar<T>* pose) const {
    return frame >= 0 ? force * pose[frame] : force;
  }
  void need_scratch(int size);
  PhasorSum<T> path_to(const Scene& scene, const Force& force) const;
  Arm arm_to(const Scene& scene, PointRef point) const;
  template <class NumbersOfScene>
  Planar<T> coefficient_of(const NumbersOfScene& numbers, PointRef point) const;
  template <class NumbersOfScene>
  static Planar<T> force_at_points(const NumbersOfScene& numbers, int force);
  template <class NumbersOfScene>
  void set_loads(const NumbersOfScene& numbers);
  template <class NumbersOfScene>
  void set_first_moments(const NumbersOfScene& numbers);
  void compile_closures();
  ForceElement compiled_element(const Scene& scene, int element, Purpose purpose) const;
  void compile_elements(const Scene& scene, Purpose purpose);
  Control compiled_control(const Scene& scene, const Element& element) const;
  void size_resistances();
  const Control& control_of(int element) const;
  // What others give is left out of a controller whose output does not depend on it at once, unless `all` is asked for.
  ControlSignals<T> own_signals(const Control& control, const Configuration<T>& here, const T* v) const;
  ControlSignals<T> own_signals_along(const Control& control, const Configuration<T>& here, const T* v, const T* dq,
                                      const T* dv) const;
  ControlSignals<T> signals(const Control& control, const Configuration<T>& here, const T* v,
                            const ForcesInTime<T>& in_time, bool all) const;
  ControlSignals<T> signals_along(const Control& control, const Configuration<T>& here, const T* v,
                                  const ControlChange<T>& change, const ForcesInTime<T>& in_time, bool all) const;
  ControlOutputs<T> outputs(const Control& control, const Configuration<T>& here, const T* v,
                            const ForcesInTime<T>& in_time, bool all) const;
  ControlOutputs<T> outputs_along(const Control& control, const Configuration<T>& here, const T* v,
                                  const ControlChange<T>& change, const ForcesInTime<T>& in_time, bool all) const;
  const ControllerOf<NumberOfLaw<T>>& law_at(const Control& control, const ForcesInTime<T>& in_time) const {
    return *controller_of(law_in_time(*this, in_time, control.element));
  }
  const std::vector<int>& pushed(const Control& control) const {
    if (control.on >= 0) return elements_[control.on].on.support();
    return control.load >= 0 ? loads_[control.load].path.support() : control.turns;
  }
  // The power of a unit effort is the sum of slope[i] v[pushed(control)[i]].
  void slopes_of_push(const Control& control, const Configuration<T>& here, T* slopes) const;
  void add_push(const Control& control, const T& change, const Configuration<T>& here, const T* v,
                const ForcesInTime<T>& in_time, T* g) const;
  void add_load_at(int load, const T& size, const Configuration<T>& here, T* g) const;
  void add_bend_of_push(const Control& control, const Configuration<T>& here, const T* dq, const T& effort, T* g) const;
  T effort_by(const Control& control, const T& output, const Configuration<T>& here, const T* v,
              const ForcesInTime<T>& in_time) const;
  T effort_along(const Control& control, const T& output, const T& change, const Configuration<T>& here, const T* v,
                 const ControlChange<T>& along, const ForcesInTime<T>& in_time) const;
  T more_by_setting(int controller, const Configuration<T>& here, const T* v, const ForcesInTime<T>& in_time) const;
  LawForce<T> read_force(const Control& control, const Configuration<T>& here, const T* v,
                         const ForcesInTime<T>& in_time) const;
  T force_by_number_there(int element, int number, const Configuration<T>& here, const T* v,
                          const ForcesInTime<T>& in_time) const;
  static void add_states(const Control& control, const T& integral, const T& filtered, T* g);
  void compile_followers(const Scene& scene);
  void compile_stops(const Scene& scene);
  void find_what_varies(const Scene& scene);
  void compile_load_derivatives(const Scene& scene);
  void make_jacobian_pattern();
  void make_tangent_pattern();

  Layout layout_;
  Phasors<T> phasors_;
  std::vector<Planar<T>> load_;          // a_t
  std::vector<Planar<T>> first_moment_;  // sum of m c_t, where the frame of the scene moves
  std::vector<T> torque_;                // per coordinate
  bool has_torque_ = false;
  std::vector<Planar<T>> carried_;  // by each link, while loads are summed up; kept where they vary
  bool loads_vary_ = false;
  // Closures in compressed rows; entry_own / entry_frame: place of the x row's Jacobian entry, y row next to it.
  std::vector<int> closure_first_;
  std::vector<int> closure_coordinate_;
  std::vector<Planar<T>> closure_coefficient_;
  std::vector<Planar<T>> closure_constant_;
  std::vector<int> closure_own_, closure_frame_, closure_row_;
  std::vector<std::pair<int, PhasorSum<T>>> varying_closures_;
  std::vector<ConstraintBlock> blocks_;
  int equalities_ = 0;
  std::vector<ForceElement> elements_;  // for dynamics all, in the order of the scene
  std::vector<int> resisting_;          // those that resist motion
  std::vector<Control> controls_;       // none in statics
  // Each of those that resist has the three values of its LawForce there, then Dg over its support; each controller has
  // its effort, the changes of its states, then Dg.
  int resistances_size_ = 0;
  std::vector<LoadAt> loads_;  // one per force; only for dynamics
  std::vector<int> torque_coordinate_;
  std::vector<Follower> followers_;
  std::vector<std::string> follower_names_;
  std::vector<Limit> stops_;
  std::vector<T> lower_, upper_;
  std::vector<int> varying_stops_;  // stops of which a limit or a term of the measure varies
  std::vector<char> varying_laws_;  // per force element, empty where none varies
  std::vector<int> jacobian_row_, jacobian_column_;
  std::vector<int> tangent_row_, tangent_column_;
  std::vector<int> slide_entry_, slide_transposed_;  // per length: tangent entry (length, frame) and (frame, length)
  int scratch_size_ = 0;
};

extern template class Mechanism<double>;

}  // namespace poise
