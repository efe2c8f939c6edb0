#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "model/controllers.hpp"
#include "model/joint_friction.hpp"
#include "motion/motion_input_impl.hpp"
#include "motion/reduced_motion.hpp"
#include "statics/model/rounding.hpp"

namespace poise {

template <class T>
ReducedMotion<T>::ReducedMotion(const Scene& scene, const Mechanism<T>& mechanism, const Inertia<T>& inertia)
    : mechanism_(mechanism),
      inertia_(inertia),
      n_(mechanism.coordinates()),
      input_forces_(mechanism),
      singular_limit_(1e-9),
      readings_(readings_of(scene, mechanism)),
      blades_(blades_of(scene, mechanism)),
      grips_(grips_of(scene, mechanism)),
      first_teeth_(grips_.size()),
      bearing_loads_(scene, mechanism, growing(grips_)),
      first_stop_(scene.drives.size()) {
  if (!readings_.empty()) {
    for (auto* each : {&reactions_, &reaction_changes_}) each->assign(scene.elements.size(), T(0));
    direct_.read.assign(readings_.size(), T(0));
  }
  drives_ = rows_of(scene, mechanism);
  states_ = states_of_controllers(scene, mechanism.layout());
  for (int i = 0; i < n_; ++i) {
    if (!is_state(i)) moving_.push_back(i);
  }
  for (const DriveRow& row : drives_) {
    if (row.led >= 0) courses_.push_back(row.led);
  }
  prescribed_ = drives_.size();
  const std::size_t contacts = bearing_loads_.contacts().size();
  for (std::size_t c = 0; c < contacts; ++c) {
    const typename BearingLoads<T>::Contact& contact = bearing_loads_.contacts()[c];
    if (!contact.separates) continue;
    const int index = static_cast<int>(scene.elements.size() + grips_.size() - first_teeth_);
    Grip teeth{index, contact.joint, drives_[stop_row(static_cast<int>(c))].on, T(1)};
    teeth.contact = static_cast<int>(c);
    grips_.push_back(std::move(teeth));
  }
  contact_slopes_.assign(contacts * static_cast<std::size_t>(n_), T(0));
  contact_efforts_.assign(contacts, T(0));
  contact_holds_.resize(first_teeth_ * contacts);
  const std::size_t n = static_cast<std::size_t>(n_);
  for (auto* full : {&q_, &v_, &a_, &drift_, &force_, &full_force_, &full_, &zero_, &reading_work_, &direct_.force,
                     &q_p_, &v_p_, &a_p_}) {
    full->assign(n, T(0));
  }
  blade_rows_.assign(blades_.size() * n, T(0));
  for (auto* each : {&blade_multipliers_, &blade_work_, &direct_.blade_rate, &direct_.blade}) {
    each->assign(blades_.size(), T(0));
  }
  blade_factors_.assign(blades_.size() * blades_.size(), T(0));
  const std::size_t k = grips_.size();
  for (auto* each : {&directions_, &efforts_, &sizes_, &grip_work_, &grip_step_, &grip_fixed_, &direct_.bound})
    each->assign(k, T(0));
  for (const Grip& grip : grips_) gripping_ = gripping_ || grip.factor != 0;
  std::vector<FrictionForces::Size> kinds;
  for (const Grip& grip : grips_) {
    kinds.push_back(grip.is_pin()  ? FrictionForces::Size::pin
                    : grip.end < 0 ? FrictionForces::Size::normal
                                   : FrictionForces::Size::carriage);
  }
  grip_forces_ = FrictionForces(std::move(kinds));
  holds_.resize(k);
  holds_without_.resize(k);
  responses_.resize(k * k);
  branches_.resize(k);
  followed_.assign(k, 0);
  normals_.resize(k);
  grip_slopes_.assign(k * n, T(0));
  grip_lu_.resize(static_cast<int>(k));
  make_rows();
  values_.resize(mechanism.jacobian_row().size());
  tangent_.resize(mechanism.tangent_row().size());
  pose_.resize(mechanism.pose_size());
  resistances_.resize(mechanism.resistances_size());
  for (auto* phasors : {&second_, &weight_, &work_, &work2_}) phasors->resize(n);
}

// Drives, and behind them the stops whose limits are equal: each holds its measure as a drive that stands still does.
template <class T>
std::vector<typename ReducedMotion<T>::DriveRow> ReducedMotion<T>::rows_of(const Scene& scene,
                                                                           const Mechanism<T>& mechanism) {
  std::vector<DriveRow> rows;
  for (std::size_t d = 0; d < scene.drives.size(); ++d) rows.push_back(row_of(scene, static_cast<int>(d), mechanism));
  for (const Stop& stop : scene.stops) {
    if (!stop.holds()) continue;
    Drive still;
    still.start = stop.max;
    rows.push_back({still, {scene, mechanism.layout(), mechanism.phasors(), stop.on}, static_cast<T>(stop.max)});
  }
  return rows;
}

template <class T>
typename ReducedMotion<T>::DriveRow ReducedMotion<T>::row_of(const Scene& scene, int drive,
                                                             const Mechanism<T>& mechanism) {
  DriveRow row;
  row.drive = scene.drives[static_cast<std::size_t>(drive)];
  Measure on = row.drive.on;
  const int controller = controller_of_drive(scene, drive);
  if (controller >= 0) {
    const Element& leading = scene.elements[static_cast<std::size_t>(controller)];
    const double by = controller_of(leading.law)->effort_unit;
    row.led = mechanism.layout().links[static_cast<std::size_t>(leading.feedback->course)].frame;
    row.led_by = T(by);
    if (on.kind != Measure::Kind::sum) on = Measure::sum_of({{1.0, on}});
    on.terms.push_back({-by, Measure::angle_between(0, leading.feedback->course)});
  }
  row.on = {scene, mechanism.layout(), mechanism.phasors(), on};
  return row;
}

template <class T>
std::vector<typename ReducedMotion<T>::Reading> ReducedMotion<T>::readings_of(const Scene& scene,
                                                                              const Mechanism<T>& mechanism) {
  std::vector<Reading> out;
  for (const int e : controllers_of(scene)) {
    const Feedback& feedback = *scene.elements[static_cast<std::size_t>(e)].feedback;
    if (feedback.reads_drive >= 0) out.push_back({e, -1, mechanism.equalities() + feedback.reads_drive, 0});
    for (const ConstraintBlock& block : mechanism.blocks()) {
      const bool is_read = mechanism.layout().closures[block.closure].joint == feedback.reads_joint;
      if (feedback.reads_joint < 0 || !is_read) continue;
      Reading one{e, feedback.reads_joint, block.first_row, feedback.along};
      const Joint& joint = scene.joints[static_cast<std::size_t>(feedback.reads_joint)];
      if (joint.has_travel()) {
        one.travel = mechanism.layout().travel[static_cast<std::size_t>(feedback.reads_joint)];
        one.axis = direction<T>(joint.axis) * mechanism.phasors().turned(mechanism.layout().links[joint.a.body].turn);
      }
      out.push_back(one);
      break;
    }
  }
  return out;
}

template <class T>
std::vector<BladeRow<T>> ReducedMotion<T>::blades_of(const Scene& scene, const Mechanism<T>& mechanism) {
  std::vector<BladeRow<T>> out;
  const auto compiled = [&](const Measure& on) {
    return CompiledMeasure<T>(scene, mechanism.layout(), mechanism.phasors(), on);
  };
  for (const Blade& blade : scene.blades) {
    out.push_back({compiled(blade.turn()), compiled(blade.x()), compiled(blade.y()), T(blade.angle)});
  }
  return out;
}

template <class T>
std::vector<typename ReducedMotion<T>::Grip> ReducedMotion<T>::grips_of(const Scene& scene,
                                                                        const Mechanism<T>& mechanism) {
  std::vector<Grip> out;
  const Layout& layout = mechanism.layout();
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    const int joint = static_cast<int>(j);
    const int element = friction_element(scene, joint);
    if (element < 0) continue;
    Grip one{element,
             joint,
             {scene, layout, mechanism.phasors(), scene.elements[element].on},
             T(grip_factor(scene.joints[j]))};
    for (const ConstraintBlock& block : mechanism.blocks()) {
      if (layout.closures[block.closure].joint == joint) (one.row < 0 ? one.row : one.end) = block.first_row;
    }
    if (one.row < 0) continue;  // of a joint in the tree, whose friction is constant
    if (scene.joints[j].has_travel()) {
      one.travel = layout.travel[j];
      one.axis =
          direction<T>(scene.joints[j].axis) * mechanism.phasors().turned(layout.links[scene.joints[j].a.body].turn);
    }
    out.push_back(std::move(one));
  }
  for (std::size_t s = 0; s < scene.stops.size(); ++s) {
    const int element = stop_friction_element(scene, static_cast<int>(s));
    if (element < 0) continue;
    Grip one{
        element, -1, {scene, layout, mechanism.phasors(), scene.elements[element].on}, T(*scene.stops[s].friction)};
    one.stop = static_cast<int>(s);
    out.push_back(std::move(one));
  }
  return out;
}

// Their joints, of those with a bound that grows.
template <class T>
std::vector<int> ReducedMotion<T>::growing(const std::vector<Grip>& grips) {
  std::vector<int> joints;
  for (const Grip& grip : grips) {
    if (grip.factor != 0 && !grip.is_stop()) joints.push_back(grip.joint);
  }
  return joints;
}

// Sizes the buffers that depend on the number of rows.
template <class T>
void ReducedMotion<T>::make_rows() {
  rows_ = mechanism_.equalities() + drives();
  int scratch = 0;
  for (const DriveRow& row : drives_) scratch = std::max(scratch, row.on.scratch_size());
  for (const Grip& grip : grips_) scratch = std::max(scratch, grip.on.scratch_size());
  for (const BladeRow<T>& blade : blades_) scratch = std::max(scratch, blade.scratch_size());
  drive_scratch_.resize(scratch);
  drive_rows_.assign(drives_.size(), T(0));
  for (auto* rows : {&direct_.gap, &direct_.rate, &direct_.acceleration}) {
    rows->assign(static_cast<std::size_t>(rows_), T(0));
  }
  const std::size_t constraints = static_cast<std::size_t>(mechanism_.constraints()) + drives_.size();
  for (auto* rows : {&c_, &rows_work_, &multipliers_}) rows->assign(constraints, T(0));
  J_.resize(rows_ * static_cast<std::size_t>(n_));
}

template <class T>
void ReducedMotion<T>::set_touching(const Scene& scene, std::vector<Touch> touching) {
  known_ = false;
  first_rank_ = -1;
  held_.clear();
  touching_ = std::move(touching);
  drives_.resize(prescribed_);
  for (const Touch& touch : touching_) {
    const Stop& stop = scene.stops[static_cast<std::size_t>(touch.stop)];
    Drive still;
    still.start = touch.upper ? stop.max : stop.min;
    drives_.push_back(
        {still, {scene, mechanism_.layout(), mechanism_.phasors(), stop.on}, static_cast<T>(*still.start)});
  }
  make_rows();
}

template <class T>
void ReducedMotion<T>::set_sliding(const Scene& scene, std::vector<int> sliding, const T* q) {
  known_ = false;
  first_rank_ = -1;
  sliding_ = std::move(sliding);
  held_.clear();
  const std::size_t first = prescribed_ + touching_.size();
  drives_.resize(first);
  for (std::size_t e = 0; e < sliding_.size(); ++e) {
    if (sliding_[e] != 0) continue;
    held_.push_back(static_cast<int>(e));
    drives_.push_back({Drive{}, {scene, mechanism_.layout(), mechanism_.phasors(), scene.elements[e].on}, T(0)});
  }
  make_rows();
  mechanism_.place(q, pose_.data());
  for (std::size_t row = first; row < drives_.size(); ++row) {
    drives_[row].start = drives_[row].on.value(here());
  }
}

template <class T>
void ReducedMotion<T>::set_inputs(const Scene& scene, std::vector<MotionInput> inputs) {
  inputs_ = std::move(inputs);
  for (const MotionInput& input : inputs_) {
    if (input.of == MotionInput::Of::drive) drives_[input.item].input = input;
  }
  input_forces_.set_inputs(SceneNumbers<T>(scene), inputs_);
}

template <class T>
void ReducedMotion<T>::start_drives(const T* q, const T& share) {
  known_ = false;
  mechanism_.place(q, pose_.data());
  for (DriveRow& d : drives_) {
    const T value = d.on.value(here());
    d.start =
        d.drive.start ? share * static_cast<T>(*d.drive.start) + (1 - share) * (value - d.drive.moved(T(0), 0)) : value;
  }
}

template <class T>
T ReducedMotion<T>::farthest_drive(const T& t) const {
  using std::abs;
  T farthest(0);
  for (const DriveRow& d : drives_)
    farthest = std::max<T>(farthest, abs(d.on.value(here()) - d.target(t, 0, near_at(t))));
  return farthest;
}

template <class T>
void ReducedMotion<T>::fill_jacobian() {
  std::fill(J_.begin(), J_.end(), T(0));
  mechanism_.jacobian(pose_.data(), values_.data());
  const auto& row = mechanism_.jacobian_row();
  const auto& column = mechanism_.jacobian_column();
  const int equalities = mechanism_.equalities();
  for (std::size_t e = 0; e < row.size(); ++e) {
    if (row[e] < equalities) jacobian(row[e], column[e]) += values_[e];
  }
  for (int k = 0; k < drives(); ++k) {
    const CompiledMeasure<T>& on = drives_[k].on;
    on.gradient(here(), [&](int i, const T& by) { jacobian(equalities + k, on.support()[i]) += by; });
  }
}

template <class T>
void ReducedMotion<T>::residual(const T& t) {
  mechanism_.constraint(q_.data(), pose_.data(), c_.data());
  for (int k = 0; k < drives(); ++k) {
    const DriveRow& d = drives_[k];
    c_[mechanism_.equalities() + k] = d.on.value(here()) - d.target(t, 0, near_at(t));
  }
}

template <class T>
typename ReducedMotion<T>::Status ReducedMotion<T>::choose(const T& t, const T* q, bool keep_rank,
                                                           const std::vector<int>* fixed) {
  using std::abs;
  t_ = t;
  known_ = false;
  std::copy(q, q + n_, q_.begin());
  mechanism_.place(q_.data(), pose_.data());
  fill_jacobian();
  std::vector<int> rows(rows_), columns(n_);
  for (int i = 0; i < rows_; ++i) rows[i] = i;
  for (int j = 0; j < n_; ++j) columns[j] = j;
  // The fixed ones are put last, and courses, which follow from nothing; pivots are searched before them only.
  const auto is_fixed = [&](int j) {
    return is_course(j) || (fixed != nullptr && std::find(fixed->begin(), fixed->end(), j) != fixed->end());
  };
  const auto first_fixed = std::stable_partition(columns.begin(), columns.end(), [&](int j) { return !is_fixed(j); });
  const int searched = static_cast<int>(first_fixed - columns.begin());
  // Coordinates without names, which only cut joints make, depend on the others where that is well-conditioned.
  int unnamed = 0;
  if (gripping_) {
    const auto first_named = std::stable_partition(columns.begin(), columns.begin() + searched, [&](int j) {
      return mechanism_.layout().coordinates[j].name.empty();
    });
    unnamed = static_cast<int>(first_named - columns.begin());
  }
  T first(0);
  int rank = 0;
  const int most = keep_rank && first_rank_ >= 0 ? first_rank_ : std::min(rows_, searched);
  // Bound on rounding in pivots of exactly singular poses; a mechanism as ill-conditioned cannot be integrated.
  const T zero = static_cast<T>(1e-9);
  bool grown = false;
  for (; rank < std::min(rows_, searched); ++rank) {
    int p = rank, c = rank;
    const auto find_pivot = [&](int end) {
      for (int i = rank; i < rows_; ++i) {
        for (int j = rank; j < end; ++j) {
          if (abs(jacobian(rows[i], columns[j])) > abs(jacobian(rows[p], columns[c]))) {
            p = i;
            c = j;
          }
        }
      }
    };
    find_pivot(rank < unnamed ? unnamed : searched);
    if (rank < unnamed && !(abs(jacobian(rows[p], columns[c])) > static_cast<T>(0.1))) find_pivot(searched);
    const T size = abs(jacobian(rows[p], columns[c]));
    if (rank == 0) first = std::max<T>(size, static_cast<T>(rounding_of_closures) / zero);
    if (rank >= most) {
      grown = size > static_cast<T>(1e-6) * first;
      break;
    }
    if (size <= zero * first && !(keep_rank && first_rank_ >= 0)) break;
    if (size == 0) break;
    std::swap(rows[rank], rows[p]);
    std::swap(columns[rank], columns[c]);
    for (int i = rank + 1; i < rows_; ++i) {
      const T l = jacobian(rows[i], columns[rank]) / jacobian(rows[rank], columns[rank]);
      if (l == 0) continue;
      for (int j = rank; j < n_; ++j) jacobian(rows[i], columns[j]) -= l * jacobian(rows[rank], columns[j]);
    }
  }
  if (first_rank_ < 0) first_rank_ = rank;
  used_rows_.assign(rows.begin(), rows.begin() + rank);
  dependent_.assign(columns.begin(), columns.begin() + rank);
  independent_.assign(columns.begin() + rank, columns.end());
  std::sort(independent_.begin(), independent_.end());
  const auto first_state =
      std::stable_partition(independent_.begin(), independent_.end(), [&](int i) { return !is_state(i); });
  std::stable_partition(first_state, independent_.end(), [&](int i) { return is_course(i); });
  std::sort(dependent_.begin(), dependent_.end());
  std::sort(used_rows_.begin(), used_rows_.end());
  make_room();
  return grown ? Status::singular : Status::ok;
}

template <class T>
template <class S>
void ReducedMotion<T>::take_over(const ReducedMotion<S>& other) {
  known_ = false;
  first_rank_ = other.first_rank_;
  used_rows_ = other.used_rows_;
  dependent_ = other.dependent_;
  independent_ = other.independent_;
  for (std::size_t k = 0; k < drives_.size(); ++k) drives_[k].start = static_cast<T>(other.drives_[k].start);
  make_room();
}

// Sizes the buffers that depend on the choice of coordinates.
template <class T>
void ReducedMotion<T>::make_room() {
  lu_.resize(rank());
  open_known_ = reading_open_known_ = false;
  for (auto* each : {&reactions_z_, &reactions_w_}) each->assign(readings_.size() * independent_.size(), T(0));
  place_of_row_.assign(static_cast<std::size_t>(rows_), -1);
  for (std::size_t i = 0; i < used_rows_.size(); ++i) place_of_row_[used_rows_[i]] = static_cast<int>(i);
  grip_alpha_.assign(grips_.size() * independent_.size(), T(0));
  small_rows_.assign(dependent_.size(), T(0));
  for (auto* each : {&blade_reduced_, &blade_responses_}) each->assign(blades_.size() * independent_.size(), T(0));
  const std::size_t f = independent_.size();
  const std::size_t n = static_cast<std::size_t>(n_);
  for (auto* columns_of : {&B_, &v_z_, &a_z_, &a_w_, &mass_columns_}) columns_of->assign(f * n, T(0));
  for (auto* square : {&alpha_z_, &alpha_w_, &mass_}) square->assign(f * f, T(0));
  heavy_ =
      static_cast<int>(std::count_if(independent_.begin(), independent_.end(), [&](int i) { return !is_state(i); }));
  carrying_ = heavy_ + static_cast<int>(courses_.size());
  mass_by_courses_.assign(courses_.size() * static_cast<std::size_t>(heavy_), T(0));
  weight_columns_.resize(f * n);
  for (auto* few : {&alpha_, &small_, &inverse_diagonal_}) few->assign(f, T(0));
}

// full[dependent] = -Jd^-1 rows, full[independent] = 0.
template <class T>
void ReducedMotion<T>::solve_rows(const T* rows, T* full) const {
  for (std::size_t i = 0; i < used_rows_.size(); ++i) small_rows_[i] = -rows[used_rows_[i]];
  lu_.solve(small_rows_.data());
  std::fill(full, full + n_, T(0));
  for (std::size_t i = 0; i < dependent_.size(); ++i) full[dependent_[i]] = small_rows_[i];
}

template <class T>
void ReducedMotion<T>::expect(const T* q) {
  std::copy(q, q + n_, q_.begin());
  known_ = false;
}

// q + u + J^-1(-D2c[u, u]/2) with u = B dz + J^-1 (what the drives move until t): the pose placed last continued to
// second order. Drives that begin to move smoothly have neither rates nor accelerations there.
template <class T>
void ReducedMotion<T>::predict(const T& t, const T* z) {
  using std::abs;
  std::fill(full_.begin(), full_.end(), T(0));
  if (drives() > 0) {
    std::fill(rows_work_.begin(), rows_work_.end(), T(0));
    for (int k = 0; k < drives(); ++k) {
      const DriveRow& d = drives_[k];
      rows_work_[mechanism_.equalities() + k] = d.target(t_, 0, near_at(t_)) - d.target(t, 0, near_at(t));
    }
    solve_rows(rows_work_.data(), full_.data());
  }
  for (int k = 0; k < freedoms(); ++k) {
    const T dz = z[k] - q_[independent_[k]];
    const T* column = B(k);
    for (int i = 0; i < n_; ++i) full_[i] += dz * column[i];
  }
  mechanism_.phasors().second(pose_.data(), full_.data(), full_.data(), work_.data());
  std::fill(rows_work_.begin(), rows_work_.end(), T(0));
  mechanism_.closures_of(work_.data(), rows_work_.data());
  for (int k = 0; k < drives(); ++k) {
    rows_work_[mechanism_.equalities() + k] = drives_[k].on.second(here(), full_.data(), full_.data());
  }
  solve_rows(rows_work_.data(), force_.data());
  reach_ = T(0);
  for (int i = 0; i < n_; ++i) {
    reach_ = std::max<T>(reach_, abs(full_[i]));
    q_[i] += full_[i] + force_[i] / 2;
  }
}

template <class T>
typename ReducedMotion<T>::Status ReducedMotion<T>::place(const T& t, const T* z) {
  using std::abs;
  const bool predicted = known_ && rank() > 0;
  if (predicted) predict(t, z);
  known_ = false;
  t_ = t;
  input_forces_.set(static_cast<double>(t_), near_at(t_));
  for (int k = 0; k < freedoms(); ++k) q_[independent_[k]] = z[k];
  const int r = rank();
  bool closed = r == 0;
  if (closed) mechanism_.place(q_.data(), pose_.data());
  // Rounding of a step grows with the condition of the dependent columns.
  const T fine = std::numeric_limits<T>::epsilon() * 1000;
  T last(0), corrected(0);
  for (int iteration = 0; iteration < 12 && !closed; ++iteration) {
    mechanism_.place(q_.data(), pose_.data());
    residual(t);
    fill_jacobian();
    T* a = lu_.matrix();
    for (int i = 0; i < r; ++i) {
      for (int j = 0; j < r; ++j) *a++ = jacobian(used_rows_[i], dependent_[j]);
    }
    pivot_ = lu_.factor();
    // Rows that are left out may depend on a coordinate on which those used hardly do any more.
    for (int j = 0; r < rows_ && j < r; ++j) {
      T used(0), any(0);
      for (const int i : used_rows_) used = std::max<T>(used, abs(jacobian(i, dependent_[j])));
      for (int i = 0; i < rows_; ++i) any = std::max<T>(any, abs(jacobian(i, dependent_[j])));
      if (used < pivot_ * any) pivot_ = used / any;
    }
    if (!(pivot_ > singular_limit_)) return Status::singular;
    T gap(0);
    for (int i = 0; i < r; ++i) {
      small_rows_[i] = -c_[used_rows_[i]];
      gap = std::max<T>(gap, abs(small_rows_[i]));
    }
    // A gap that is rounding only would be amplified by 1 / pivot_: near singular poses it is better left.
    closed = gap <= 3 * std::numeric_limits<T>::epsilon();
    if (closed) break;
    lu_.solve(small_rows_.data());
    T step(0);
    for (int i = 0; i < r; ++i) step = std::max<T>(step, abs(small_rows_[i]));
    // A correction as large as the predicted displacement leads to another branch of the loops.
    corrected += step;
    if (!(step < 1) || (predicted && corrected > reach_ / 2 + fine / pivot_)) return Status::open;
    closed = step <= fine || (iteration > 2 && step <= fine / pivot_) || (iteration > 5 && step < 1e-9 && step >= last);
    for (int i = 0; i < r; ++i) q_[dependent_[i]] += small_rows_[i];
    last = step;
  }
  if (!closed) return Status::open;
  // B = [-Jd^-1 Ji; I]; from states of controllers only drives follow.
  for (int k = 0; k < freedoms(); ++k) {
    if (k >= carrying_) {
      B_[static_cast<std::size_t>(k) * n_ + independent_[k]] = T(1);
      continue;
    }
    for (int i = 0; i < rows_; ++i) rows_work_[i] = jacobian(i, independent_[k]);
    T* column = &B_[static_cast<std::size_t>(k) * n_];
    solve_rows(rows_work_.data(), column);
    column[independent_[k]] = T(1);
  }
  known_ = true;
  return Status::ok;
}

template <class T>
typename ReducedMotion<T>::Opening ReducedMotion<T>::widest_gap() {
  using std::abs;
  if (rank() == 0) residual(t_);  // place() had nothing to close
  Opening out;
  for (int i = 0; i < rows_; ++i) {
    if (out.row < 0 || !(abs(c_[i]) <= out.size)) out = {i, abs(c_[i]), T(0)};
  }
  return out;
}

template <class T>
typename ReducedMotion<T>::Opening ReducedMotion<T>::fastest_opening() {
  using std::abs;
  if (rank() == 0) fill_jacobian();
  Opening out;
  for (int i = 0; i < rows_; ++i) {
    const int drive = i - mechanism_.equalities();
    const T rate = drive >= 0 ? drives_[drive].target(t_, 1, near_at(t_)) : T(0);
    Opening one{i, -rate, abs(rate)};
    for (int j = 0; j < n_; ++j) {
      const T term = jacobian(i, j) * v_[j];
      one.size += term;
      one.terms += abs(term);
    }
    one.size = abs(one.size);
    if (out.row < 0 || one.size > out.size) out = one;
  }
  return out;
}

template <class T>
void ReducedMotion<T>::move(const T* w) {
  jumps_ = false;
  if (drives() > 0) {
    std::fill(rows_work_.begin(), rows_work_.end(), T(0));
    for (int k = 0; k < drives(); ++k) rows_work_[mechanism_.equalities() + k] = -drives_[k].target(t_, 1, near_at(t_));
    solve_rows(rows_work_.data(), drift_.data());
  }
  std::copy(drift_.begin(), drift_.end(), v_.begin());
  for (int k = heavy_; k < freedoms(); ++k) v_[independent_[k]] += w[k];
  for (int k = 0; k < carrying_; ++k) {
    const T* column = B(k);
    for (const int i : moving_) v_[i] += w[k] * column[i];
  }
  for (DriveRow& row : drives_) {
    if (row.led >= 0) row.led_rate = row.led_by * v_[row.led];
  }
}

template <class T>
void ReducedMotion<T>::project(const T* full, T* reduced) const {
  if (rank() == 0) {
    for (int k = 0; k < freedoms(); ++k) reduced[k] = full[independent_[k]];
    return;
  }
  for (int k = heavy_; k < freedoms(); ++k) reduced[k] = full[independent_[k]];
  for (int k = 0; k < heavy_; ++k) {
    const T* column = B(k);
    T sum(0);
    for (int i = 0; i < n_; ++i) sum += column[i] * full[i];
    reduced[k] = sum;
  }
}

}  // namespace poise

#include "motion/reduced_motion_dynamics_impl.hpp"
