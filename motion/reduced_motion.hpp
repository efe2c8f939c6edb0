#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "model/inertia.hpp"
#include "model/mechanism.hpp"
#include "motion/bearing_loads.hpp"
#include "motion/blade_row.hpp"
#include "motion/friction_forces.hpp"
#include "motion/motion_input.hpp"
#include "motion/motion_model.hpp"
#include "motion/small_lu.hpp"
#include "motion/touch.hpp"
#include "motion/variation.hpp"

namespace poise {

/// A parameter of the scene for sensitivities of motion: part of a body's inertia, a number of a force or of a drive,
/// or any other number, which may move the dependent coordinates.
struct Influence {
  int body =
      -1;  ///< inertial if >= 0: the change of (m, m x, m y, J about the body's origin) per unit of the parameter
  double mass = 0.0;
  Vec2 first{};
  double moment = 0.0;
  int drive = -1;  ///< a number of this drive if >= 0
  /// Index into Drive::numbers, or the numbers of its function of time, then SI; TimeFunction::whole stands for the
  /// acceleration of the drive alone.
  int drive_number = 0;
  int variation = -1;   ///< if >= 0 an index into the variations
  ForceNumber force{};  ///< if none of these
  double by = 1.0;      ///< change of the number of the force or drive per unit
  /// A number of a function of time, SI, or of a drive without one, that changes with the parameter, and by how much
  /// per unit.
  struct InTime {
    TimeFunction::Of of = TimeFunction::Of::force;
    int item = 0;    ///< index into Scene::forces, torques, drives or elements
    int number = 0;  ///< index into the numbers of its function, or Drive::numbers
    double by = 0.0;
    int part = 0;  ///< as of TimeFunction
  };
  std::vector<InTime> in_time{};  ///< beside a variation

  /// Calls visit(function, number, by) for the functions of loads of which a number changes with the parameter.
  template <class Visit>
  void for_each_function(const Scene& scene, Visit visit) const {
    const auto find = [&](const ForceNumber& of, double change) {
      for (const TimeFunction& function : scene.time_functions) {
        if (function.of == TimeFunction::Of::drive) continue;
        const ForceNumber own = force_number(function.of, function.item, function.part, of.time_number);
        const bool is_one = own.of == of.of && own.item == of.item && own.number == of.number;
        if (is_one) visit(function, of.time_number, change);
      }
    };
    if (body < 0 && !moves() && force.time_number >= 0) find(force, 1.0);
    for (const InTime& one : in_time) {
      if (one.of != TimeFunction::Of::drive) find(force_number(one.of, one.item, one.part, one.number), one.by);
    }
  }

  /// Calls visit(function, number, by) for those of drives.
  template <class Visit>
  void for_each_function_of_drives(const Scene& scene, Visit visit) const {
    for (const TimeFunction& function : scene.time_functions) {
      if (function.of != TimeFunction::Of::drive) continue;
      if (body < 0 && drive == function.item) visit(function, drive_number, by);
      for (const InTime& one : in_time) {
        if (one.of == TimeFunction::Of::drive && one.item == function.item) visit(function, one.number, one.by);
      }
    }
  }

  /// Coordinates depend on it where z and w are given.
  bool moves() const { return drive >= 0 || variation >= 0; }
};

struct MotionVariations;

/// The equations of motion of a mechanism in its independent coordinates z, f = freedoms() of the n coordinates q.
///
/// Closures, couplings and drives c(q, t) = 0 with Jacobian J give the dependent coordinates, their rates and
/// accelerations:
///   q(z, t),   v = B w + (rates of the drives),   a = B alpha + a0,   J B = 0,   w = z', alpha = w'.
/// With G = M a + velocity terms + (-Q) + resistances, d'Alembert's principle B^T G = 0 gives
///   (B^T M B) alpha = -B^T G(a0).
/// Complete pivoting removes redundant closures and chooses z. Units are those of the scene given.
///
/// States s of controllers are independent, and no force acts on them but what their controllers give, so that their
/// rows of these equations are  M_s s'' = -G_s. A drive whose acceleration a controller sets moves by its course, such
/// a state; with its columns of B the other rows are
///   (B^T M B) alpha = -B^T G(a0) - B^T M B_s s''.
///
/// A number p of the scene that closures or drives depend on moves dependent coordinates at fixed z and w. With |p for
/// the derivative at fixed coordinates, rates, accelerations and multipliers
///   J q_p + c|p = 0,   J v_p + D2c[v, q_p] + (J v)|p = 0,
///   J a_p + D3c[v, v, q_p] + 2 D2c[v, v_p] + D2c[a, q_p] + (J a + D2c[v, v] - accelerations of the drives)|p = 0,
/// and alpha_p follows from  B^T (change of G + J^T multipliers along q_p, v_p, a_p, and its |p) = 0.
///
/// What a controller reads of a force that follows from accelerations, y = +-(a multiplier), tells its states alone: it
/// is found with the accelerations of the mechanism, and theirs after it. Its derivatives are those of the multipliers,
///   J^T multipliers' = -(change of G + J^T multipliers at constant multipliers).
///
/// Blades are conditions of rates alone, A v = 0 (BladeRow), with multipliers mu and the forces -mu across their edges.
/// All f rates w stay; those that satisfy the conditions at the start do so forever, because with the reduced mass
/// M' = B^T M B, C = A B and h = A a + DA[v] v
///   M' alpha = -B^T G(a0) - C^T mu,   C alpha = -h(a0),   mu = (C M'^-1 C^T)^-1 (h(a0) - C M'^-1 B^T G(a0)).
/// Their derivatives are those of these equations; G + J^T multipliers + A^T mu = 0.
///
/// Friction of joints in a scene that is resisted_by_joints(): an element that sticks resists with its constant force
/// F_i, and where its bound grows with the force R in the joint, with T_i = s_i c_i |R|_i more, s_i the direction in
/// which it slides. R are multipliers of closures, affine in all T; where the force of teeth or of a cam's roller acts
/// at its place (BearingLoads) they have its part, R = R_0 + Q D with the effort Q, and of teeth that push their wheels
/// apart |Q| E more, |Q| as the size of one more force. Where T = S c |R(T)| need not have one solution
/// (FrictionForces) friction is locked. By any z, w or p,
///   T' = S (c |R|' + c' |R|),  |R|' = |R|'(R' at constant T + dR/dT T').
///
/// One object per thread: it holds the last state evaluated. Call begin() once, or choose() (again to change to better
/// coordinates), then evaluate(), which is place(), move() and accelerate(), and for derivatives linearize().
template <class T>
class ReducedMotion {
 public:
  /// All three must outlive this; the mechanism compiled for Purpose::dynamics.
  ReducedMotion(const Scene& scene, const Mechanism<T>& mechanism, const Inertia<T>& inertia);

  enum class Status {
    ok,
    open,          ///< the loops cannot be closed for these z
    singular,      ///< so near a singular pose that the dependent coordinates are ill-conditioned
    no_inertia,    ///< B^T M B is not positive definite: some degree of freedom has no inertia
    locked,        ///< friction of joints grows with the forces that it makes: they may be several, or none; or a cam
                   ///< could drive its follower by no finite force
    undetermined,  ///< closures that repeat each other leave the force in a joint open that has friction or is read
    blades         ///< a blade's condition repeats those of others, or what joints, drives and stops hold
  };

  const Layout& layout() const { return mechanism_.layout(); }
  int coordinates() const { return n_; }
  int freedoms() const { return static_cast<int>(independent_.size()); }
  /// Drives, stops whose limits are equal, limits of stops that are touched, and rows of friction that is held.
  int drives() const { return static_cast<int>(drives_.size()); }
  /// Ascending, those of the mechanism before the states of controllers.
  const std::vector<int>& independent() const { return independent_; }
  /// Whether a coordinate is a state of a controller: what is large of those is not so of the mechanism.
  bool is_state(int coordinate) const { return std::find(states_.begin(), states_.end(), coordinate) != states_.end(); }
  /// The rows of J, rank() of them, from which the other coordinates follow.
  const std::vector<int>& used_rows() const { return used_rows_; }
  /// Rank of J when the coordinates were last chosen.
  int rank() const { return static_cast<int>(dependent_.size()); }

  /// Loads and drives that follow curves of time, in the units of `scene`, which is the one given to the constructor.
  void set_inputs(const Scene& scene, std::vector<MotionInput> inputs);
  const std::vector<MotionInput>& inputs() const { return inputs_; }
  /// What forces follow at the time of the last place().
  ForcesInTime<T> forces_in_time() const { return input_forces_.in_time(); }
  /// Adds torques that follow from the past of the motion, or none; they must outlive this.
  void set_past(const TorquesOfPast* past) { input_forces_.set_past(past); }
  const TorquesOfPast* past() const { return input_forces_.past(); }
  /// d(number of an element's law at that time)/d(number), of the scene or of a function of time.
  T number_of_element_by(const ForceNumber& number) const { return input_forces_.by(number); }
  /// Until the next call loads and drives follow the formulas that their functions of time have at this time
  /// (TimeFunction); NaN: at the time of each pose, as without a call.
  void set_near(double time) { near_ = time; }
  double near() const { return near_; }
  const T& time() const { return t_; }  ///< of the last place()
  /// Holds the measures of stops at these limits, by one more row each after those of the drives and of stops whose
  /// limits are equal; friction is held by none any more. `scene` is the one given to the constructor. Call
  /// set_sliding() thereafter where some friction sticks, and choose().
  void set_touching(const Scene& scene, std::vector<Touch> touching);
  const std::vector<Touch>& touching() const { return touching_; }
  /// Force of the k-th of these limits on its measure, positive where it pushes the measure back between the limits;
  /// after jump() its impulse.
  T pushing_force(std::size_t k) const {
    const T& multiplier = drive_multipliers_[prescribed_ + k];
    return touching_[k].upper ? multiplier : T(-multiplier);
  }
  /// How friction that sticks (DryFriction of width 0) moves: per element of the scene, which is the one given to the
  /// constructor, the direction 1 or -1 in which it slides, or 0 where it is held: its measure keeps the value that it
  /// has at q, by one more row after those of the drives. Without a call the signs of the rates are the directions.
  /// Call choose() thereafter.
  void set_sliding(const Scene& scene, std::vector<int> sliding, const T* q);
  /// As set; null without.
  const int* sliding() const { return sliding_.empty() ? nullptr : sliding_.data(); }
  /// Elements that are held, in the order of their rows.
  const std::vector<int>& held() const { return held_; }
  /// Force T of the law of the h-th of these; after accelerate().
  const T& holding_force(int h) const { return drive_multipliers_[drives_.size() - held_.size() + h]; }
  /// Sets the initial values of drives without a given start to those of q. Those with a given start have the part
  /// `share` of the way from their values at q to it behind them.
  void start_drives(const T* q, const T& share = T(1));
  /// After start_drives(): the largest distance of a measure that is driven, at the pose given there, from its value at
  /// t.
  T farthest_drive(const T& t) const;
  /// Chooses independent coordinates by complete pivoting of J at (q, t). With `keep_rank` the rank of the first pose
  /// is kept at a pose of lower rank. Returns singular if the rank has grown. With `fixed`, these are the independent
  /// coordinates and only the rows are chosen.
  Status choose(const T& t, const T* q, bool keep_rank, const std::vector<int>* fixed = nullptr);
  /// Drives begin in the closed pose q, where coordinates are chosen, and from which the next place() starts.
  Status begin(const T& t, const T* q, const std::vector<int>* fixed = nullptr) {
    start_drives(q);
    const Status chosen = choose(t, q, false, fixed);
    expect(q);
    return chosen;
  }
  /// Copies the choice of coordinates and the initial values of drives from another object of the same scene.
  template <class S>
  void take_over(const ReducedMotion<S>& other);

  /// Relative pivot of the dependent columns of J below which a pose counts as singular.
  void set_singular_limit(const T& limit) { singular_limit_ = limit; }
  /// Pivot of the last pose.
  const T& pivot() const { return pivot_; }
  /// Largest entry of B there: how far a coordinate moves, at most, for each independent one.
  T steepness() const {
    using std::abs;
    T out(0);
    for (const T& slope : B_) out = std::max<T>(out, abs(slope));
    return out;
  }

  /// The next place() starts from the dependent coordinates of q.
  void expect(const T* q);
  /// Closes the loops by Newton's method with q[independent] = z, from the second-order extrapolation of the last pose.
  Status place(const T& t, const T* z);
  /// Rates v for the independent ones w.
  void move(const T* w);
  /// Accelerations a and alpha; NaN where friction is locked. With `sizes`, one of friction_forces().all(), those of
  /// this solution.
  Status accelerate(const std::vector<double>* sizes = nullptr);
  /// The accelerations at the coordinates z and rates w: the first status that is not ok.
  Status evaluate(const T& t, const T* z, const T* w) {
    const Status placed = place(t, z);
    if (placed != Status::ok) return placed;
    move(w);
    return accelerate();
  }
  /// After accelerate() that found friction locked: its equations, in the sizes of the forces in joints with friction.
  FrictionForces& friction_forces() { return grip_forces_; }
  /// Computes the multipliers of the rows of J, and the derivatives of alpha, v and a with respect to z and w.
  void linearize();
  /// Sets the variations that influences refer to, which must outlive this. Call it after set_inputs().
  void set_variations(const std::vector<Variation>& variations);
  /// The derivative of alpha by a number of the scene, f values. After linearize() where the influence moves().
  void influence(const Influence& influence, T* alpha);
  /// After influence(), f values: the size of the terms whose sum is that alpha = -M^-1 B^T g, relative to which it is
  /// rounded:  sum_ji |(M^-1)_kj B_ji g_i|  with the reduced mass M.
  void influence_terms(const Influence& influence, T* size) const;
  /// After influence() of one that moves(): q_p, v_p and a_p, n values each.
  const T* q_p() const { return q_p_.data(); }
  const T* v_p() const { return v_p_.data(); }
  const T* a_p() const { return a_p_.data(); }
  /// After influence() of one that moves(): of the rows that repeat others the largest change  J q_p + c|p  of a gap,
  /// over the sum of its terms. Unless it is rounding the loops close for this value of the number alone.
  T gap_by() const;

  /// Whether controllers read forces in joints or of drives.
  bool reads_reactions() const { return !readings_.empty(); }
  /// After linearize(): the changes of these by element of the scene, where places and rates change by dq and dv, n
  /// values each, and by an influence unless null.
  std::vector<T> reactions_along(const T* dq, const T* dv, const Influence* influence);
  /// After evaluate(), f values: the derivative of alpha by a generalized force along the slope (n values); and the
  /// change of what a controller reads of forces that follow from accelerations, of the last such call or influence().
  void push(const T* slope, T* dalpha);
  T reaction_change(int element) const { return reaction_changes_[element]; }

  /// Blades of the scene, in its order.
  int blades() const { return static_cast<int>(blades_.size()); }
  /// Force of one across its edge, to the left of it, on the body of its point; after accelerate(). After jump() its
  /// impulse.
  T blade_force(int k) const { return -blade_multipliers_[k]; }
  /// After place(): adds A to `row`, n values.
  void add_blade(int k, T* row) const { blades_[k].add(here(), T(1), row); }
  /// After move(): the rate A v across the edge.
  T blade_rate(int k) const { return blades_[k].along(here(), v_.data()); }
  /// The sum of the sizes of the terms of the rates of its point, at the rates v: what rounds in blade_rate().
  T blade_terms(int k, const T* v) const { return blades_[k].terms(here(), v); }
  /// Its change along dq and dv, n values each.
  T blade_rate_change(int k, const T* dq, const T* dv);
  /// After influence() of one that moves(): its derivative by the number, at constant z and w.
  T blade_rate_p(int k) { return direct_.blade_rate[k] + blade_rate_change(k, q_p(), v_p()); }
  /// After accelerate(): takes the rates across blades out of w, by impulses of the blades; f values.
  void hold_blades(T* w) const;

  /// Of all rows of c, those too that repeated others where the coordinates were chosen: after place() the row that is
  /// open by most, rad or lengths; after move() the row that opens fastest, |J v - (rate of its drive)|, and the sum of
  /// the sizes of these terms. Rows are those of the mechanism's closures, then drives().
  struct Opening {
    int row = -1;
    T size{};
    T terms{};  ///< of rates
  };
  Opening widest_gap();
  Opening fastest_opening();

  const T* q() const { return q_.data(); }
  const T* v() const { return v_.data(); }
  const T* a() const { return a_.data(); }
  const T* alpha() const { return alpha_.data(); }
  /// B, column by column (n values each): also dq/dz and dv/dw.
  const T* B(int k) const { return &B_[static_cast<std::size_t>(k) * n_]; }
  /// After linearize(), n values: dv/dz_k, da/dz_k, da/dw_k; f values: dalpha/dz_k, dalpha/dw_k.
  const T* v_z(int k) const { return v_z_.data() + static_cast<std::size_t>(k) * n_; }
  const T* a_z(int k) const { return a_z_.data() + static_cast<std::size_t>(k) * n_; }
  const T* a_w(int k) const { return a_w_.data() + static_cast<std::size_t>(k) * n_; }
  const T* alpha_z(int k) const { return alpha_z_.data() + static_cast<std::size_t>(k) * freedoms(); }
  const T* alpha_w(int k) const { return alpha_w_.data() + static_cast<std::size_t>(k) * freedoms(); }

  /// The jump of rates by impulses, at the pose that place() was called for: the rates of the measures that are touched
  /// change by `steps`, in the order of touching(), all other rows of J v stay. a() is the jump,
  ///   M a + J^T P = 0,   J a = steps,
  /// the multipliers are the impulses P, v() is zero. Forces are finite and have no part in it. linearize() and
  /// jump_change() are then those of the jump, until move().
  /// `impulse`, unless null, is a generalized impulse beside these (n values).
  void jump(const T* steps, const T* impulse = nullptr);
  /// After jump() and linearize(): the derivative of the jump where the pose moves along dq, the steps change by
  /// `steps`, and, unless null, a number of the scene by `influence`; n values.
  void jump_change(const T* dq, const T* steps, const Influence* influence, T* change, const T* impulse = nullptr);
  /// After evaluate(), f values: the jump of w by a unit impulse along the slope (n values) of a measure.
  void respond(const T* slope, T* dw) const;

  /// Gives the size c |R| by which the bound of friction that sticks exceeds that of its law, of an element of the
  /// scene. Call it after accelerate().
  T load_bound(int element) const;
  /// Teeth that push their wheels apart onto joints with friction, by |Q|: in load_bound(), turn_branch() and
  /// branch_margin() each counts as one more element, behind those of the scene.
  int separating_teeth() const { return static_cast<int>(grips_.size() - first_teeth_); }
  /// |R| of a slide or slot is the size of a normal force, of a carriage the greater of two: piecewise linear in R, by
  /// branches. From now on, whatever the forces become, that of each joint follows the branch that accelerate() found
  /// last; free again after free_branches().
  void follow_branches();
  void free_branches();
  /// Lets that of an element follow the branch next to the one in `from`.
  void turn_branch(int element, const std::vector<int>& from);
  /// c times the force by which the branch that an element follows is the right one; 0 where that is rounding, infinite
  /// where it follows none.
  T branch_margin(int element) const;
  const std::vector<int>& branches() const { return followed_; }
  void set_branches(const std::vector<int>& followed) { followed_ = followed; }
  /// Where accelerate() found a joint's force undetermined: the joint, or -1 of what friction holds.
  int undetermined() const { return undetermined_; }

  T kinetic_energy() const;
  T potential_energy() const { return mechanism_.energy(q_.data(), pose_.data()); }
  /// Sum of the sizes of the multipliers: the change of potential energy and work, at most, where every loop and drive
  /// is open by 1. After accelerate(), with drives.
  T work_of_gaps() const;
  /// Power of everything without a potential: resistances (negative), follower loads, inputs less the constant loads in
  /// whose place they are, drives. After accelerate().
  T power() const;
  /// That of the drives alone; after jump(), times the impulses of the drives, the work of these.
  T drive_power() const;
  /// Values of the measures that the stops limit, in the pose placed; the mechanism's stops() values.
  std::vector<T> stop_values() const;
  /// Force (torque, N m or N in the scene's units) of drive k. After accelerate().
  T drive_force(int k) const;
  /// Sets the accelerations of all coordinates that follow from a given alpha.
  void accelerate_as(const T* alpha);
  /// B^T times the inertia and weight forces of one more body inertia at the accelerations last set: f values.
  void reduced_inertia(int body, const BodyInertia<T>& part, T* f) const;

 private:
  // g(q) = start + moved(t), or the input's curve. Where a controller sets the drive, g is its measure less led_by
  // times the coordinate `led` of the course.
  struct DriveRow {
    Drive drive;
    CompiledMeasure<T> on;
    T start{};
    std::optional<MotionInput> input{};
    int led = -1;
    T led_by{}, led_rate{};  // the rate is that of the last move()

    T target(const T& t, int derivative, double near) const {
      if (input) return static_cast<T>(input->at(static_cast<double>(t), derivative, near));
      return (derivative == 0 ? start : T(0)) + drive.moved(t, derivative);
    }
  };
  // Multipliers of the closures of a joint, by components in the world: of the joint, and of the end of a carriage.
  struct Hold {
    Planar<T> at{}, end{};
  };
  // Friction of a joint or across a stop that grows with its force; or teeth that push their wheels apart by |Q|, whose
  // force is (Q, 0) along the normal (1, 0).
  struct Grip {
    int element, joint;
    CompiledMeasure<T> on;   // the joint's angle or travel
    T factor;                // c
    int row = -1, end = -1;  // first rows of the closures
    int travel = -1;         // its coordinate, whose line has the direction `axis` at zero angle
    Planar<T> axis{};
    int contact = -1;  // of teeth: index into BearingLoads::contacts()
    int stop = -1;     // of friction across a stop: of the scene; its force is (N, 0), N that of the limit touched

    bool is_teeth() const { return contact >= 0; }
    bool is_stop() const { return stop >= 0; }
    bool is_pin() const { return travel < 0 && !is_teeth() && !is_stop(); }
  };
  // What its size depends on: |at| of a pin; else of the normal components N = n . at and n . end, of the carriage's
  // end, by N + end or by end alone, with the sign of that.
  struct Branch {
    T by_at{}, by_end{};
  };
  // c, J v, the second derivatives of c, G + J^T multipliers, c_i |R|_i, A v and h of blades, and what is read of
  // forces: their direct derivatives by a number.
  struct Direct {
    std::vector<T> gap, rate, acceleration, force, bound, blade_rate, blade, read;

    std::array<std::vector<T>*, 8> parts() {
      return {&gap, &rate, &acceleration, &force, &bound, &blade_rate, &blade, &read};
    }
  };
  template <class S>
  friend class ReducedMotion;
  /// A controller that reads the force of a drive, the multiplier of a row of J with the other sign; or of a joint, by
  /// the component of that of its two rows. What acts on the travel of a joint is in its multipliers, along its line,
  /// and is none of its reaction, so that of such a joint  y = -(n . R) (n . e)  with the normal n of the line.
  struct Reading {
    int element, joint, row, along;
    int travel = -1;   // its coordinate
    Planar<T> axis{};  // of its line at zero angle
    int varied = -1;   // place among the grips that variations know

    int rows() const { return joint < 0 ? 1 : 2; }
  };
  static std::vector<Reading> readings_of(const Scene& scene, const Mechanism<T>& mechanism);
  T multiplier_of(int row) const;
  Planar<T> read_normal(const Reading& one) const;
  static T component(const Reading& one, const Planar<T>& v) { return one.along == 0 ? v.x : v.y; }
  bool leaves_reading_open();
  void read_reactions();
  void let_states_follow(const T* force, const T* dq, const Direct* direct, T* dalpha);
  void keep_reaction_changes(std::vector<T>& to, int k);
  static std::vector<DriveRow> rows_of(const Scene& scene, const Mechanism<T>& mechanism);
  static DriveRow row_of(const Scene& scene, int drive, const Mechanism<T>& mechanism);
  bool is_course(int coordinate) const {
    return std::find(courses_.begin(), courses_.end(), coordinate) != courses_.end();
  }
  void divide_states_by_mass(T* b) const;
  static std::vector<Grip> grips_of(const Scene& scene, const Mechanism<T>& mechanism);
  static std::vector<int> growing(const std::vector<Grip>& grips);
  double near_at(const T& t) const { return std::isnan(near_) ? static_cast<double>(t) : near_; }
  void make_rows();
  void make_room();
  void predict(const T& t, const T* z);
  void residual(const T& t);
  void fill_jacobian();
  void solve_rows(const T* rows, T* full) const;  // full[dependent] = -Jd^-1 rows, full[independent] = 0
  void place_accelerations();
  void find_forces();
  Status solve_accelerations();
  void find_multipliers();
  void add_accelerations(const T* alpha);
  bool leaves_open();
  Status add_gripping_friction(const std::vector<double>* sizes);
  void set_grip_directions();
  void find_grip_responses();
  void state_grip_forces();
  T acting(std::size_t grip) const { return directions_[grip] * grips_[grip].factor; }  // S c
  void take_sizes();
  T missing_effort() const;
  T largest_effort() const;
  bool factor_grips();
  bool solve_grips(const std::vector<double>* sizes);
  void add_grip_efforts();
  std::size_t stop_row(int contact) const;
  T effort_in(int contact) const;
  int touched_row(const Grip& grip) const;
  Hold multipliers_of(const Grip& grip) const;
  Hold hold_of(std::size_t i) const;
  bool load_bearings();
  Planar<T> normal_of(const Grip& grip) const;
  void take_size(std::size_t i, const Hold& hold);
  std::size_t grip_of(int element) const;
  int branch_at(std::size_t i) const;
  T size_along(std::size_t i, const Hold& change, const Planar<T>& normal_change) const;
  static T size_of(const Grip& grip, const Branch& branch, const Hold& hold, const Planar<T>& normal);
  void let_friction_follow(const T* dq, const Direct* direct, const T* force, T* dalpha);
  void linearize_pose(const T* dq, const Direct* direct, T* dv, T* da, T* dalpha);
  void linearize_direction(const T* dq, const T* dv, const Direct* direct, T* da, T* dalpha);
  void linearize_state(int k);
  void answer_change(const T* dq, const T* dv, const Direct* direct, T* da, T* dalpha);
  void state_for_variations();
  void add_direct(std::size_t variation);
  void add_drive_number(int drive, int number, const T& by);
  void add_influence(const Influence& influence, const T* a, const Planar<T>* second, T* g) const;
  Configuration<T> here() const { return {mechanism_.phasors(), pose_.data(), drive_scratch_.data()}; }
  void project(const T* full, T* reduced) const;
  void divide_by_mass(T* reduced) const;
  void divide_change_by_mass(T* reduced) const;
  static std::vector<BladeRow<T>> blades_of(const Scene& scene, const Mechanism<T>& mechanism);
  bool factor_blades();
  void solve_blades(T* rates) const;
  void press_blades(const T* multipliers, T* alpha) const;
  void hold_by_blades(T* alpha) const;
  T& jacobian(int row, int column) { return J_[static_cast<std::size_t>(row) * n_ + column]; }
  const T& jacobian(int row, int column) const { return J_[static_cast<std::size_t>(row) * n_ + column]; }

  const Mechanism<T>& mechanism_;
  const Inertia<T>& inertia_;
  int n_, rows_;
  std::vector<DriveRow> drives_;
  std::size_t prescribed_ = 0;   // rows of drives and stops, before those of limits touched and of friction
  std::vector<Touch> touching_;  // see set_touching()
  std::vector<T> steps_;         // of jump()
  bool jumps_ = false;           // the state is that of jump()
  std::vector<MotionInput> inputs_;
  InputForces<T> input_forces_;
  std::vector<int> states_, courses_;  // of controllers; those of them by which drives move
  std::vector<int> moving_;            // the other coordinates
  int first_rank_ = -1;
  std::vector<int> independent_, dependent_, used_rows_;
  int heavy_ = 0;     // of the independent coordinates: those before the states of controllers
  int carrying_ = 0;  // those before the states by which no drive moves
  T singular_limit_{};
  T pivot_{1};
  T t_{};
  double near_ = std::numeric_limits<double>::quiet_NaN();
  T reach_{};           // distance of the last predict()
  bool known_ = false;  // B and the factors belong to q

  // State, and scratch that is mutable because it carries no meaning between calls.
  std::vector<T> q_, v_, a_, alpha_, c_, J_, values_, B_, drift_, force_, full_force_, mass_, inverse_diagonal_,
      multipliers_;
  std::vector<int> sliding_, held_;  // see set_sliding()
  std::vector<T> resistances_;       // at q, v
  std::vector<T> v_z_, a_z_, a_w_, alpha_z_, alpha_w_, tangent_, tangent_of_loads_;
  std::vector<T> mass_by_courses_;  // B^T M B_s: heavy_ values of each
  std::vector<T> mass_columns_, drive_multipliers_, drive_rows_, zero_;
  std::vector<Planar<T>> weight_columns_;
  std::vector<Planar<T>> second_, weight_;
  mutable std::vector<Planar<T>> pose_, work_, work2_, drive_scratch_;
  mutable std::vector<T> full_, rows_work_, small_, small_rows_;
  SmallLu<T> lu_;

  std::vector<Reading> readings_;
  std::vector<T> reactions_, reaction_changes_;  // of each element
  std::vector<T> reading_work_;
  std::vector<T> reactions_z_, reactions_w_;  // the derivatives of each reading by all z and w
  bool reading_open_ = false, reading_open_known_ = false;

  std::vector<BladeRow<T>> blades_;
  std::vector<T> blade_rows_;       // of each A, n values
  std::vector<T> blade_reduced_;    // C, f values of each
  std::vector<T> blade_responses_;  // M'^-1 C^T, f values of each
  std::vector<T> blade_factors_;    // of C M'^-1 C^T by Cholesky, lower part
  std::vector<T> blade_multipliers_;
  mutable std::vector<T> blade_work_;

  std::vector<Grip> grips_;
  std::size_t first_teeth_ = 0;  // behind those of joints
  BearingLoads<T> bearing_loads_;
  std::size_t first_stop_ = 0;                   // in drives_
  std::vector<T> contact_slopes_;                // of each contact, n values: Dg less the generalized force of F
  std::vector<T> contact_efforts_;               // Q
  std::vector<Hold> contact_holds_;              // of each joint and contact: D
  std::vector<T> directions_, efforts_, sizes_;  // of each: s, T, |R|
  std::vector<Hold> holds_, responses_;          // R, and dR_i/dT_j
  std::vector<Branch> branches_;
  std::vector<int> followed_;  // branch of each: +-1 by N + end, +-2 by end alone, with their signs; 0: free
  std::vector<Planar<T>> normals_;
  std::vector<T> grip_slopes_, grip_alpha_;  // Dg and d alpha/dT of each
  std::vector<T> grip_work_, grip_step_, grip_fixed_;
  std::vector<Hold> holds_without_;  // R where all T are zero
  FrictionForces grip_forces_{{}};
  SmallLu<T> grip_lu_;             // of I - S c |R|' dR/dT
  std::vector<int> place_of_row_;  // in used_rows_, or -1
  int undetermined_ = -1;
  bool gripping_ = false;  // some bound grows with a force
  bool open_ = false, open_known_ = false;

  std::shared_ptr<MotionVariations> variations_;  // none where there are no variations
  Direct direct_;
  std::vector<T> q_p_, v_p_, a_p_;
};

extern template class ReducedMotion<double>;

}  // namespace poise
