#pragma once

// Friction of joints that grows with the forces in them.

#include <algorithm>
#include <cmath>
#include <limits>

#include "motion/reduced_motion.hpp"

namespace poise {

// Gives the direction across the line of a slide or slot, in the world.
template <class T>
Planar<T> ReducedMotion<T>::normal_of(const Grip& grip) const {
  return quarter_turn(grip.axis * mechanism_.phasors().line_direction(pose_.data(), grip.travel));
}

// Gives the place in drives_ of the stop that a contact is of.
template <class T>
std::size_t ReducedMotion<T>::stop_row(int contact) const {
  return first_stop_ + static_cast<std::size_t>(bearing_loads_.contacts()[static_cast<std::size_t>(contact)].holding);
}

// Reads Q from the multipliers of the used rows in small_rows_.
template <class T>
T ReducedMotion<T>::effort_in(int contact) const {
  const int place = place_of_row_[static_cast<std::size_t>(mechanism_.equalities()) + stop_row(contact)];
  return place < 0 ? T(0) : T(-small_rows_[place]);
}

// Gives the row of the limit that is touched of the stop of a grip; -1 if none is.
template <class T>
int ReducedMotion<T>::touched_row(const Grip& grip) const {
  for (std::size_t k = 0; k < touching_.size(); ++k) {
    if (touching_[k].stop == grip.stop) return mechanism_.equalities() + static_cast<int>(prescribed_ + k);
  }
  return -1;
}

// Reads the multipliers of a joint's closures from these.
template <class T>
typename ReducedMotion<T>::Hold ReducedMotion<T>::multipliers_of(const Grip& grip) const {
  if (grip.is_stop()) {
    const int row = touched_row(grip);
    if (row < 0 || place_of_row_[row] < 0) return {};
    const T& multiplier = small_rows_[place_of_row_[row]];
    const bool upper = touching_[static_cast<std::size_t>(row - mechanism_.equalities()) - prescribed_].upper;
    return {{upper ? multiplier : T(-multiplier), T(0)}, {}};
  }
  const auto multiplier = [&](int row) { return place_of_row_[row] < 0 ? T(0) : small_rows_[place_of_row_[row]]; };
  Hold out{{multiplier(grip.row), multiplier(grip.row + 1)}, {}};
  if (grip.end >= 0) out.end = {multiplier(grip.end), multiplier(grip.end + 1)};
  return out;
}

// Adds to the multipliers of a joint the parts of contacts.
template <class T>
typename ReducedMotion<T>::Hold ReducedMotion<T>::hold_of(std::size_t i) const {
  if (grips_[i].is_teeth()) return {{effort_in(grips_[i].contact), T(0)}, {}};
  Hold out = multipliers_of(grips_[i]);
  const std::size_t contacts = contact_efforts_.size();
  for (std::size_t c = 0; c < contacts; ++c) {
    const T effort = effort_in(static_cast<int>(c));
    out.at += effort * contact_holds_[i * contacts + c].at;
    out.end += effort * contact_holds_[i * contacts + c].end;
  }
  return out;
}

// What a unit effort of each contact changes in joints by acting at its place, and the generalized forces of teeth that
// push their wheels apart by 1. False where a contact transmits no effort by a finite force.
template <class T>
bool ReducedMotion<T>::load_bearings() {
  const std::size_t contacts = contact_efforts_.size();
  const std::size_t n = static_cast<std::size_t>(n_);
  if (contacts == 0) return true;
  bearing_loads_.place(q_.data(), pose_.data());
  for (std::size_t c = 0; c < contacts; ++c) {
    T* slopes = &contact_slopes_[c * n];
    std::fill(slopes, slopes + n, T(0));
    drives_[stop_row(static_cast<int>(c))].on.add_gradient(here(), T(1), slopes);
    if (!bearing_loads_.add(bearing_loads_.contacts()[c], T(1), T(0), pose_.data(), slopes)) return false;
    for (std::size_t i = 0; i < dependent_.size(); ++i) small_rows_[i] = -slopes[dependent_[i]];
    lu_.solve_transposed(small_rows_.data());
    for (std::size_t i = 0; i < first_teeth_; ++i) contact_holds_[i * contacts + c] = multipliers_of(grips_[i]);
  }
  for (std::size_t i = first_teeth_; i < grips_.size(); ++i) {
    T* slopes = &grip_slopes_[i * n];
    std::fill(slopes, slopes + n, T(0));
    bearing_loads_.add(bearing_loads_.contacts()[static_cast<std::size_t>(grips_[i].contact)], T(0), T(1), pose_.data(),
                       slopes);
  }
  return true;
}

template <class T>
T ReducedMotion<T>::size_of(const Grip& grip, const Branch& branch, const Hold& hold, const Planar<T>& normal) {
  if (grip.is_pin()) return norm(hold.at);
  return branch.by_at * dot(normal, hold.at) + branch.by_end * dot(normal, hold.end);
}

// The branch of |R| that the force in a joint belongs to. Of a carriage the contact forces at its ends are
// N / 2 -+ C / length with the couple C = end length / 2, so that the sum of their sizes is the greater of |N| and
// |end|.
template <class T>
int ReducedMotion<T>::branch_at(std::size_t i) const {
  using std::abs;
  if (grips_[i].is_pin()) return 0;
  const T end = dot(normals_[i], holds_[i].end);
  const T whole = dot(normals_[i], holds_[i].at) + end;
  if (abs(whole) >= abs(end)) return whole < 0 ? -1 : 1;
  return end < 0 ? -2 : 2;
}

// The size of the force in a joint, and how it depends on it.
template <class T>
void ReducedMotion<T>::take_size(std::size_t i, const Hold& hold) {
  const Grip& grip = grips_[i];
  holds_[i] = hold;
  const int branch = followed_[i] != 0 ? followed_[i] : branch_at(i);
  const T sign(branch < 0 ? -1 : 1);
  branches_[i] = {branch == 1 || branch == -1 ? sign : T(0), grip.end < 0 ? T(0) : sign};
  sizes_[i] = size_of(grip, branches_[i], hold, normals_[i]);
}

template <class T>
std::size_t ReducedMotion<T>::grip_of(int element) const {
  std::size_t i = 0;
  while (i < grips_.size() && grips_[i].element != element) ++i;
  return i;
}

// The bound of what is held acts on no motion, so that its kinks do not matter.
template <class T>
void ReducedMotion<T>::follow_branches() {
  for (std::size_t i = 0; i < grips_.size(); ++i) followed_[i] = directions_[i] == 0 ? 0 : branch_at(i);
}

template <class T>
void ReducedMotion<T>::free_branches() {
  std::fill(followed_.begin(), followed_.end(), 0);
}

template <class T>
void ReducedMotion<T>::turn_branch(int element, const std::vector<int>& from) {
  const std::size_t i = grip_of(element);
  const T end = dot(normals_[i], holds_[i].end);
  const T whole = dot(normals_[i], holds_[i].at) + end;
  const bool by_whole = from[i] == 1 || from[i] == -1;
  if (grips_[i].end < 0)
    followed_[i] = -from[i];
  else
    followed_[i] = by_whole ? (end < 0 ? -2 : 2) : (whole < 0 ? -1 : 1);
}

template <class T>
T ReducedMotion<T>::branch_margin(int element) const {
  using std::abs;
  const std::size_t i = grip_of(element);
  const int branch = i < grips_.size() ? followed_[i] : 0;
  if (branch == 0) return std::numeric_limits<T>::infinity();
  const T end = dot(normals_[i], holds_[i].end);
  const T whole = dot(normals_[i], holds_[i].at) + end;
  const T sign(branch < 0 ? -1 : 1);
  const T margin = branch == 1 || branch == -1 ? T(sign * whole - abs(end)) : T(sign * end - abs(whole));
  // Where there is no normal force, rounding must not seem to turn it.
  const T rounding = static_cast<T>(1e-13) * (norm(holds_[i].at) + norm(holds_[i].end) + 1);
  return abs(margin) <= rounding ? T(0) : T(abs(grips_[i].factor) * margin);
}

// The change of the size where the force and the normal change.
template <class T>
T ReducedMotion<T>::size_along(std::size_t i, const Hold& change, const Planar<T>& normal_change) const {
  const Grip& grip = grips_[i];
  if (grip.is_pin()) return sizes_[i] > 0 ? T(dot(holds_[i].at, change.at) / sizes_[i]) : T(0);
  return size_of(grip, branches_[i], change, normals_[i]) + size_of(grip, branches_[i], holds_[i], normal_change);
}

// Whether rows of J that repeat others leave the force in a joint with friction open. A row that is not used is
// sum_i k_i (used row i): multiples of these k may be added to the multipliers.
template <class T>
bool ReducedMotion<T>::leaves_open() {
  using std::abs;
  undetermined_ = -1;
  if (rank() == rows_) return false;
  const auto joint_of = [&](int row) {
    for (const Grip& grip : grips_) {
      if (grip.factor == 0) continue;
      if (grip.is_stop() && row == touched_row(grip)) return -1;
      if (grip.is_stop()) continue;
      for (const int first : {grip.row, grip.end}) {
        if (first >= 0 && (row == first || row == first + 1)) return grip.joint;
      }
    }
    for (std::size_t c = 0; c < contact_efforts_.size(); ++c) {
      if (row == mechanism_.equalities() + static_cast<int>(stop_row(static_cast<int>(c)))) {
        return bearing_loads_.contacts()[c].joint;
      }
    }
    return -2;
  };
  const int first_held = rows_ - static_cast<int>(held_.size());
  const auto needs = [&](int row) {
    const int joint = joint_of(row);
    undetermined_ = std::max(joint, -1);
    return joint >= -1 || row >= first_held;
  };
  for (int row = 0; row < rows_; ++row) {
    if (place_of_row_[row] >= 0) continue;
    if (needs(row)) return true;
    for (std::size_t j = 0; j < dependent_.size(); ++j) small_rows_[j] = jacobian(row, dependent_[j]);
    lu_.solve_transposed(small_rows_.data());
    for (std::size_t i = 0; i < used_rows_.size(); ++i) {
      if (abs(small_rows_[i]) > static_cast<T>(1e-7) && needs(used_rows_[i])) return true;
    }
  }
  return false;
}

// Adds the friction that grows with forces to the motion without it.
template <class T>
typename ReducedMotion<T>::Status ReducedMotion<T>::add_gripping_friction(const std::vector<double>* sizes) {
  set_grip_directions();
  if (!open_known_) open_ = leaves_open();
  open_known_ = true;
  if (open_) return Status::undetermined;
  if (load_bearings()) {
    find_grip_responses();
    state_grip_forces();
    if ((sizes != nullptr || grip_forces_.is_unique()) && solve_grips(sizes)) {
      add_grip_efforts();
      return Status::ok;
    }
  }
  std::fill(a_.begin(), a_.end(), std::numeric_limits<T>::quiet_NaN());
  return Status::locked;
}

// Sets the direction s in which each slides, its slopes and the normal of its line; no efforts yet.
template <class T>
void ReducedMotion<T>::set_grip_directions() {
  const std::size_t n = static_cast<std::size_t>(n_);
  for (std::size_t i = first_teeth_; i < grips_.size(); ++i) {
    efforts_[i] = T(0);
    directions_[i] = T(1);
    normals_[i] = {T(1), T(0)};
  }
  for (std::size_t i = 0; i < first_teeth_; ++i) {
    const Grip& one = grips_[i];
    efforts_[i] = T(0);
    T* slopes = &grip_slopes_[i * n];
    std::fill(slopes, slopes + n, T(0));
    one.on.add_gradient(here(), T(1), slopes);
    if (sliding() != nullptr) {
      directions_[i] = T(sliding()[one.element]);
    } else {
      const T rate = one.on.along(here(), v_.data());
      directions_[i] = rate > 0 ? T(1) : rate < 0 ? T(-1) : T(0);
    }
    normals_[i] = one.travel >= 0 ? normal_of(one) : one.is_stop() ? Planar<T>{T(1), T(0)} : Planar<T>{};
    if (one.is_stop() && touched_row(one) < 0) directions_[i] = T(0);
  }
}

// Finds the forces in joints without the efforts, and what a unit of each effort changes in them and in alpha.
template <class T>
void ReducedMotion<T>::find_grip_responses() {
  const std::size_t k = grips_.size();
  const std::size_t f = independent_.size();
  const std::size_t n = static_cast<std::size_t>(n_);
  for (std::size_t i = 0; i < dependent_.size(); ++i) small_rows_[i] = -full_force_[dependent_[i]];
  lu_.solve_transposed(small_rows_.data());
  for (std::size_t i = 0; i < k; ++i) holds_without_[i] = hold_of(i);
  for (std::size_t j = 0; j < k; ++j) {
    T* alpha = grip_alpha_.data() + j * f;
    const T* slopes = &grip_slopes_[j * n];
    std::fill(alpha, alpha + f, T(0));
    if (j < first_teeth_) {  // teeth that push their wheels apart move nothing
      project(slopes, alpha);
      for (std::size_t l = 0; l < f; ++l) alpha[l] = -alpha[l];
      divide_by_mass(alpha);
    }
    for (std::size_t i = 0; i < dependent_.size(); ++i) {
      T force = slopes[dependent_[i]];
      for (std::size_t l = 0; l < f; ++l) force += alpha[l] * mass_columns_[l * n + dependent_[i]];
      small_rows_[i] = -force;
    }
    lu_.solve_transposed(small_rows_.data());
    for (std::size_t i = 0; i < k; ++i) responses_[i * k + j] = hold_of(i);
  }
}

// States the equations of the sizes for FrictionForces, which tells how many solutions they have.
template <class T>
void ReducedMotion<T>::state_grip_forces() {
  const std::size_t k = grips_.size();
  // The |R| of a carriage is the greater of the whole normal force and that of its end.
  const auto components = [&](std::size_t i, const Hold& hold) {
    if (grips_[i].is_pin()) return planar_cast<double>(hold.at);
    const T end = dot(normals_[i], hold.end);
    return planar_cast<double>(Planar<T>{dot(normals_[i], hold.at) + end, end});
  };
  for (std::size_t i = 0; i < k; ++i) {
    grip_forces_.force(i) = components(i, holds_without_[i]);
    for (std::size_t j = 0; j < k; ++j) {
      grip_forces_.response(i, j) = static_cast<double>(acting(j)) * components(i, responses_[i * k + j]);
    }
  }
}

// Takes the sizes of the forces in joints at the efforts.
template <class T>
void ReducedMotion<T>::take_sizes() {
  const std::size_t k = grips_.size();
  for (std::size_t i = 0; i < k; ++i) {
    Hold hold = holds_without_[i];
    for (std::size_t j = 0; j < k; ++j) {
      hold.at += efforts_[j] * responses_[i * k + j].at;
      hold.end += efforts_[j] * responses_[i * k + j].end;
    }
    take_size(i, hold);
  }
}

// The sum of |S c |R| - T|.
template <class T>
T ReducedMotion<T>::missing_effort() const {
  using std::abs;
  T sum(0);
  for (std::size_t i = 0; i < grips_.size(); ++i) sum += abs(acting(i) * sizes_[i] - efforts_[i]);
  return sum;
}

// The largest of |S c |R||.
template <class T>
T ReducedMotion<T>::largest_effort() const {
  using std::abs;
  T largest(0);
  for (std::size_t i = 0; i < grips_.size(); ++i) largest = std::max<T>(largest, abs(acting(i) * sizes_[i]));
  return largest;
}

// Factors I - S c |R|' dR/dT. False where it is singular.
template <class T>
bool ReducedMotion<T>::factor_grips() {
  const std::size_t k = grips_.size();
  T* entries = grip_lu_.matrix();
  for (std::size_t i = 0; i < k; ++i) {
    for (std::size_t j = 0; j < k; ++j) {
      entries[i * k + j] =
          T(i == j ? 1 : 0) - (acting(j) != 0 ? T(acting(i) * size_along(i, responses_[i * k + j], {})) : T(0));
    }
  }
  return grip_lu_.factor() > 0;
}

// Solves T = S c |R(T)| by Newton's method, from the efforts under the forces without them or those given; steps that
// do not come nearer are halved, and where that does not help T <- S c |R(T)|, which may contract. Leaves the matrix
// factored; false where no solution is found.
template <class T>
bool ReducedMotion<T>::solve_grips(const std::vector<double>* sizes) {
  const std::size_t k = grips_.size();
  if (sizes != nullptr) {
    for (std::size_t i = 0; i < k; ++i) efforts_[i] = acting(i) * static_cast<T>((*sizes)[i]);
  }
  take_sizes();
  T last = missing_effort();
  const auto is_within = [&](double roundings) {
    return last <= roundings * std::numeric_limits<T>::epsilon() * largest_effort();
  };
  for (int iteration = 0; iteration < 2000 && !is_within(4); ++iteration) {
    grip_work_ = efforts_;
    for (std::size_t i = 0; i < k; ++i) grip_step_[i] = acting(i) * sizes_[i] - efforts_[i];
    grip_fixed_ = grip_step_;
    const T before = last;
    if (factor_grips()) {
      grip_lu_.solve(grip_step_.data());
      for (T share(1); share > static_cast<T>(0.01) && !(last < before); share /= 2) {
        for (std::size_t i = 0; i < k; ++i) efforts_[i] = grip_work_[i] + share * grip_step_[i];
        take_sizes();
        last = missing_effort();
      }
      if (last < before) continue;
      last = before;
      if (is_within(1000)) {  // as near as rounding lets it come
        efforts_ = grip_work_;
        take_sizes();
        break;
      }
    }
    for (std::size_t i = 0; i < k; ++i) efforts_[i] = grip_work_[i] + grip_fixed_[i];
    take_sizes();
    last = missing_effort();
  }
  return (is_within(1e5) || largest_effort() == 0) && factor_grips();
}

// Adds what the efforts make of alpha, accelerations and forces, and the efforts of contacts.
template <class T>
void ReducedMotion<T>::add_grip_efforts() {
  const std::size_t f = independent_.size();
  const std::size_t n = static_cast<std::size_t>(n_);
  std::fill(small_.begin(), small_.end(), T(0));
  for (std::size_t j = 0; j < grips_.size(); ++j) {
    for (std::size_t l = 0; l < f; ++l) small_[l] += efforts_[j] * grip_alpha_[j * f + l];
    for (std::size_t i = 0; i < n; ++i) full_force_[i] += efforts_[j] * grip_slopes_[j * n + i];
  }
  for (std::size_t l = 0; l < f; ++l) alpha_[l] += small_[l];
  add_accelerations(small_.data());
  if (contact_efforts_.empty()) return;
  for (std::size_t i = 0; i < dependent_.size(); ++i) small_rows_[i] = -full_force_[dependent_[i]];
  lu_.solve_transposed(small_rows_.data());
  for (std::size_t c = 0; c < contact_efforts_.size(); ++c) {
    contact_efforts_[c] = effort_in(static_cast<int>(c));
    for (std::size_t i = 0; i < n; ++i) full_force_[i] += contact_efforts_[c] * contact_slopes_[c * n + i];
  }
}

template <class T>
T ReducedMotion<T>::load_bound(int element) const {
  const std::size_t i = grip_of(element);
  return i < grips_.size() ? T(grips_[i].factor * sizes_[i]) : T(0);
}

// Along a direction in which G + J^T multipliers changes by `force`, and alpha by `dalpha`, where the efforts of joints
// do not change: adds what these make of alpha.
template <class T>
void ReducedMotion<T>::let_friction_follow(const T* dq, const Direct* direct, const T* force, T* dalpha) {
  const std::size_t k = grips_.size();
  const std::size_t f = independent_.size();
  const std::size_t n = static_cast<std::size_t>(n_);
  for (std::size_t i = 0; i < dependent_.size(); ++i) {
    T sum = force[dependent_[i]];
    for (std::size_t l = 0; l < f; ++l) sum += dalpha[l] * mass_columns_[l * n + dependent_[i]];
    small_rows_[i] = -sum;
  }
  lu_.solve_transposed(small_rows_.data());
  for (std::size_t i = 0; i < k; ++i) {
    const Grip& grip = grips_[i];
    Planar<T> turned{};
    const int frame = grip.travel < 0 ? -1 : mechanism_.phasors().frame(grip.travel);
    if (dq != nullptr && frame >= 0) turned = dq[frame] * quarter_turn(normals_[i]);
    grip_work_[i] = directions_[i] * grip.factor * size_along(i, hold_of(i), turned);
    if (direct != nullptr) grip_work_[i] += directions_[i] * direct->bound[i];
  }
  grip_lu_.solve(grip_work_.data());
  for (std::size_t j = 0; j < k; ++j) {
    for (std::size_t l = 0; l < f; ++l) dalpha[l] += grip_work_[j] * grip_alpha_[j * f + l];
  }
}

}  // namespace poise
