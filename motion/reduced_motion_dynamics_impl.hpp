#pragma once

// Accelerations, their derivatives and energies; how poses are closed is in motion/reduced_motion_impl.hpp.

#include <algorithm>
#include <cmath>

#include "motion/reduced_motion.hpp"
#include "motion/reduced_motion_friction_impl.hpp"
#include "motion/variation_terms.hpp"

namespace poise {

// The accelerations of the states of controllers, and what the others do against those that follow from them.
template <class T>
void ReducedMotion<T>::divide_states_by_mass(T* b) const {
  for (int i = heavy_; i < freedoms(); ++i) b[i] /= inertia_.moment(independent_[i]);
  const T* column = mass_by_courses_.data();
  for (int i = heavy_; i < carrying_; ++i, column += heavy_) {
    for (int j = 0; j < heavy_; ++j) b[j] -= column[j] * b[i];
  }
}

// Cholesky factors of what is not a state of controllers are in mass_, lower part. States turn for themselves alone.
template <class T>
void ReducedMotion<T>::divide_by_mass(T* b) const {
  divide_states_by_mass(b);
  const int f = heavy_;
  const auto l = [&](int i, int j) -> const T& { return mass_[static_cast<std::size_t>(i) * f + j]; };
  for (int i = 0; i < f; ++i) {
    for (int j = 0; j < i; ++j) b[i] -= l(i, j) * b[j];
    b[i] /= l(i, i);
  }
  for (int i = f - 1; i >= 0; --i) {
    for (int j = i + 1; j < f; ++j) b[i] -= l(j, i) * b[j];
    b[i] /= l(i, i);
  }
}

// Divides derivatives by the mass, with the reciprocals of the factors' diagonal, which round once more.
template <class T>
void ReducedMotion<T>::divide_change_by_mass(T* b) const {
  divide_states_by_mass(b);
  const int f = heavy_;
  const T* mass = mass_.data();
  const T* inverse = inverse_diagonal_.data();
  for (int i = 0; i < f; ++i) {
    T x = b[i];
    for (int j = 0; j < i; ++j) x -= mass[i * f + j] * b[j];
    b[i] = x * inverse[i];
  }
  for (int i = f - 1; i >= 0; --i) {
    T x = b[i];
    for (int j = i + 1; j < f; ++j) x -= mass[j * f + i] * b[j];
    b[i] = x * inverse[i];
  }
}

// A, C, M'^-1 C^T and the factors of C M'^-1 C^T. False where a blade's condition repeats others.
template <class T>
bool ReducedMotion<T>::factor_blades() {
  using std::sqrt;
  const auto f = static_cast<std::size_t>(freedoms()), n = static_cast<std::size_t>(n_), m = blades_.size();
  std::fill(blade_rows_.begin(), blade_rows_.end(), T(0));
  for (std::size_t i = 0; i < m; ++i) {
    blades_[i].add(here(), T(1), &blade_rows_[i * n]);
    project(&blade_rows_[i * n], &blade_reduced_[i * f]);
    std::copy(&blade_reduced_[i * f], &blade_reduced_[i * f] + f, &blade_responses_[i * f]);
    divide_by_mass(&blade_responses_[i * f]);
    // A blade moves with the courses, on which it does not act.
    for (int k = heavy_; k < carrying_; ++k) {
      T rate(0);
      for (std::size_t j = 0; j < n; ++j) rate += blade_rows_[i * n + j] * B(k)[j];
      blade_reduced_[i * f + static_cast<std::size_t>(k)] = rate;
    }
    for (std::size_t j = 0; j <= i; ++j) {
      T entry(0);
      for (std::size_t k = 0; k < f; ++k) entry += blade_reduced_[i * f + k] * blade_responses_[j * f + k];
      const T whole = entry;
      for (std::size_t k = 0; k < j; ++k) entry -= blade_factors_[i * m + k] * blade_factors_[j * m + k];
      if (j < i) {
        blade_factors_[i * m + j] = entry / blade_factors_[j * m + j];
      } else {
        if (!(entry > static_cast<T>(1e-13) * whole) || !(whole > 0)) return false;
        blade_factors_[i * m + i] = sqrt(entry);
      }
    }
  }
  return true;
}

// Turns rates into the multipliers that take them out.
template <class T>
void ReducedMotion<T>::solve_blades(T* rates) const {
  const std::size_t m = blades_.size();
  for (std::size_t i = 0; i < m; ++i) {
    for (std::size_t j = 0; j < i; ++j) rates[i] -= blade_factors_[i * m + j] * rates[j];
    rates[i] /= blade_factors_[i * m + i];
  }
  for (std::size_t i = m; i-- > 0;) {
    for (std::size_t j = i + 1; j < m; ++j) rates[i] -= blade_factors_[j * m + i] * rates[j];
    rates[i] /= blade_factors_[i * m + i];
  }
}

// alpha -= M'^-1 C^T multipliers.
template <class T>
void ReducedMotion<T>::press_blades(const T* multipliers, T* alpha) const {
  const auto f = static_cast<std::size_t>(freedoms());
  for (std::size_t i = 0; i < blades_.size(); ++i) {
    for (std::size_t k = 0; k < f; ++k) alpha[k] -= multipliers[i] * blade_responses_[i * f + k];
  }
}

// Takes C alpha out of alpha by forces of the blades.
template <class T>
void ReducedMotion<T>::hold_by_blades(T* alpha) const {
  const auto f = static_cast<std::size_t>(freedoms());
  for (std::size_t i = 0; i < blades_.size(); ++i) {
    T rate(0);
    for (std::size_t k = 0; k < f; ++k) rate += blade_reduced_[i * f + k] * alpha[k];
    blade_work_[i] = rate;
  }
  solve_blades(blade_work_.data());
  press_blades(blade_work_.data(), alpha);
}

template <class T>
void ReducedMotion<T>::hold_blades(T* w) const {
  for (int i = 0; i < blades(); ++i) blade_work_[static_cast<std::size_t>(i)] = blade_rate(i);
  solve_blades(blade_work_.data());
  press_blades(blade_work_.data(), w);
}

// a0: the accelerations for alpha = 0.
template <class T>
void ReducedMotion<T>::place_accelerations() {
  mechanism_.phasors().second(pose_.data(), v_.data(), v_.data(), second_.data());
  if (rank() == 0) {
    std::fill(a_.begin(), a_.end(), T(0));
    return;
  }
  std::fill(rows_work_.begin(), rows_work_.end(), T(0));
  mechanism_.closures_of(second_.data(), rows_work_.data());
  for (int k = 0; k < drives() && !jumps_; ++k) {
    rows_work_[mechanism_.equalities() + k] =
        drives_[k].on.second(here(), v_.data(), v_.data()) - drives_[k].target(t_, 2, near_at(t_));
  }
  for (std::size_t k = 0; k < touching_.size() && jumps_; ++k) {
    rows_work_[static_cast<std::size_t>(mechanism_.equalities()) + prescribed_ + k] = -steps_[k];
  }
  solve_rows(rows_work_.data(), a_.data());
  mechanism_.phasors().first(pose_.data(), a_.data(), work_.data());
  for (int t = 0; t < n_; ++t) second_[t] += work_[t];
}

template <class T>
typename ReducedMotion<T>::Status ReducedMotion<T>::accelerate(const std::vector<double>* sizes) {
  place_accelerations();
  if (!readings_.empty()) {
    std::fill(reactions_.begin(), reactions_.end(), T(0));
    input_forces_.set_reactions(reactions_.data());
  }
  find_forces();
  const Status solved = solve_accelerations();
  if (solved != Status::ok) return solved;
  const Status added = gripping_ ? add_gripping_friction(sizes) : Status::ok;
  if (drives() > 0 || !readings_.empty()) find_multipliers();
  if (!readings_.empty()) {
    if (leaves_reading_open()) return Status::undetermined;
    read_reactions();
  }
  return added;
}

template <class T>
T ReducedMotion<T>::multiplier_of(int row) const {
  const int equalities = mechanism_.equalities();
  return row < equalities ? multipliers_[row] : drive_multipliers_[row - equalities];
}

// Whether a row that is read is one of those that repeat each other.
template <class T>
bool ReducedMotion<T>::leaves_reading_open() {
  using std::abs;
  if (reading_open_known_) return reading_open_;
  reading_open_known_ = true;
  reading_open_ = false;
  for (int row = 0; row < rows_; ++row) {
    if (place_of_row_[row] >= 0) continue;
    for (std::size_t j = 0; j < dependent_.size(); ++j) small_rows_[j] = jacobian(row, dependent_[j]);
    lu_.solve_transposed(small_rows_.data());
    for (const Reading& one : readings_) {
      for (int r = 0; r < one.rows(); ++r) {
        const int place = place_of_row_[one.row + r];
        if (place >= 0 && !(abs(small_rows_[place]) > static_cast<T>(1e-7))) continue;
        reading_open_ = true;
        undetermined_ = one.joint;
      }
    }
  }
  return reading_open_;
}

template <class T>
Planar<T> ReducedMotion<T>::read_normal(const Reading& one) const {
  return quarter_turn(one.axis * mechanism_.phasors().line_direction(pose_.data(), one.travel));
}

// Takes what is read, and gives the states of the controllers that read it the accelerations that they have with it.
template <class T>
void ReducedMotion<T>::read_reactions() {
  std::fill(full_.begin(), full_.end(), T(0));
  mechanism_.add_resistance(resistances_.data(), full_.data());
  for (const Reading& one : readings_) {
    if (one.travel < 0) {
      reactions_[one.element] = -multiplier_of(one.row + one.along);
      continue;
    }
    const Planar<T> normal = read_normal(one), force{multiplier_of(one.row), multiplier_of(one.row + 1)};
    reactions_[one.element] = -dot(normal, force) * component(one, normal);
  }
  mechanism_.resist(pose_.data(), v_.data(), sliding(), resistances_.data(), input_forces_.in_time());
  for (T& x : full_) x = -x;
  mechanism_.add_resistance(resistances_.data(), full_.data());
  for (int k = carrying_; k < freedoms(); ++k) {
    const int i = independent_[k];
    const T change = -full_[i] / inertia_.moment(i);
    alpha_[k] += change;
    a_[i] += change;
  }
}

// The changes of what is read, and of the states behind it: `force` is the change of G at alpha' = 0, and dalpha that
// of the mechanism. Places change by dq unless it is null.
template <class T>
void ReducedMotion<T>::let_states_follow(const T* force, const T* dq, const Direct* direct, T* dalpha) {
  const std::size_t n = static_cast<std::size_t>(n_), all = static_cast<std::size_t>(freedoms());
  for (std::size_t i = 0; i < dependent_.size(); ++i) {
    const auto at = static_cast<std::size_t>(dependent_[i]);
    T sum = force[at];
    for (std::size_t l = 0; l < static_cast<std::size_t>(carrying_); ++l) sum += dalpha[l] * mass_columns_[l * n + at];
    for (std::size_t b = 0; b < blades_.size(); ++b) sum += blade_work_[b] * blade_rows_[b * n + at];
    for (std::size_t j = 0; j < grips_.size() && gripping_; ++j) sum += grip_work_[j] * grip_slopes_[j * n + at];
    small_rows_[i] = -sum;
  }
  lu_.solve_transposed(small_rows_.data());
  const auto change_of = [&](int row) { return place_of_row_[row] < 0 ? T(0) : small_rows_[place_of_row_[row]]; };
  for (std::size_t r = 0; r < readings_.size(); ++r) {
    const Reading& one = readings_[r];
    T& change = reaction_changes_[one.element];
    if (one.travel < 0) {
      change = -change_of(one.row + one.along);
    } else {
      const Planar<T> normal = read_normal(one), held{multiplier_of(one.row), multiplier_of(one.row + 1)};
      const Planar<T> more{change_of(one.row), change_of(one.row + 1)};
      const int frame = mechanism_.phasors().frame(one.travel);
      const Planar<T> turned = dq != nullptr && frame >= 0 ? dq[frame] * quarter_turn(normal) : Planar<T>{};
      change = -(dot(normal, more) + dot(turned, held)) * component(one, normal) -
               dot(normal, held) * component(one, turned);
    }
    if (direct != nullptr) change += direct->read[r];
  }
  std::fill(reading_work_.begin(), reading_work_.end(), T(0));
  mechanism_.add_change_of_read(reaction_changes_.data(), pose_.data(), v_.data(), input_forces_.in_time(),
                                reading_work_.data());
  for (std::size_t k = static_cast<std::size_t>(carrying_); k < all; ++k) {
    dalpha[k] -= reading_work_[independent_[k]] / inertia_.moment(independent_[k]);
  }
}

template <class T>
void ReducedMotion<T>::keep_reaction_changes(std::vector<T>& to, int k) {
  for (std::size_t r = 0; r < readings_.size(); ++r) {
    to[r * independent_.size() + static_cast<std::size_t>(k)] = reaction_changes_[readings_[r].element];
  }
}

template <class T>
std::vector<T> ReducedMotion<T>::reactions_along(const T* dq, const T* dv, const Influence* influence) {
  std::vector<T> out(reactions_.size(), T(0));
  if (readings_.empty()) return out;
  if (influence != nullptr) {
    std::vector<T> alpha(independent_.size());
    this->influence(*influence, alpha.data());
    out = reaction_changes_;
  }
  for (std::size_t r = 0; r < readings_.size(); ++r) {
    T& change = out[readings_[r].element];
    for (std::size_t k = 0; k < independent_.size(); ++k) {
      const std::size_t at = r * independent_.size() + k;
      change += reactions_z_[at] * dq[independent_[k]] + reactions_w_[at] * dv[independent_[k]];
    }
  }
  return out;
}

// G at the accelerations a0; of a jump only its part of inertia.
template <class T>
void ReducedMotion<T>::find_forces() {
  inertia_.weigh(second_.data(), weight_.data());
  if (jumps_) {
    std::fill(full_force_.begin(), full_force_.end(), T(0));
  } else {
    mechanism_.negative_force(q_.data(), pose_.data(), full_force_.data());
    mechanism_.resist(pose_.data(), v_.data(), sliding(), resistances_.data(), input_forces_.in_time());
    mechanism_.add_resistance(resistances_.data(), full_force_.data());
    input_forces_.add(pose_.data(), full_force_.data());
  }
  mechanism_.phasors().add_projection(pose_.data(), weight_.data(), full_force_.data());
  for (int i = 0; i < n_; ++i) full_force_[i] += inertia_.moment(i) * a_[i];
}

// (B^T M B) alpha = -B^T G(a0), with accelerations and G at this alpha.
template <class T>
typename ReducedMotion<T>::Status ReducedMotion<T>::solve_accelerations() {
  using std::sqrt;
  const int f = heavy_;
  for (int k = 0; k < carrying_; ++k) {
    Planar<T>* weighed = &weight_columns_[static_cast<std::size_t>(k) * n_];
    T* moved = &mass_columns_[static_cast<std::size_t>(k) * n_];
    mechanism_.phasors().first(pose_.data(), B(k), work_.data());
    inertia_.weigh(work_.data(), weighed);
    for (const int i : moving_) moved[i] = inertia_.moment(i) * B(k)[i];
    mechanism_.phasors().add_projection(pose_.data(), weighed, moved);
    project(moved, small_.data());
    if (k >= f) {
      std::copy_n(small_.data(), f, &mass_by_courses_[static_cast<std::size_t>(k - f) * f]);
      continue;
    }
    for (int j = 0; j < f; ++j) mass_[static_cast<std::size_t>(j) * f + k] = small_[j];
  }
  for (int j = 0; j < f; ++j) {
    for (int i = j; i < f; ++i) {
      T& entry = mass_[static_cast<std::size_t>(i) * f + j];
      const T whole = entry;
      for (int k = 0; k < j; ++k) {
        entry -= mass_[static_cast<std::size_t>(i) * f + k] * mass_[static_cast<std::size_t>(j) * f + k];
      }
      if (i > j) {
        entry /= mass_[static_cast<std::size_t>(j) * f + j];
      } else {
        if (!(entry > static_cast<T>(1e-13) * whole) || !(whole > 0)) return Status::no_inertia;
        entry = sqrt(entry);
        inverse_diagonal_[j] = T(1) / entry;
      }
    }
  }
  project(full_force_.data(), alpha_.data());
  for (T& x : alpha_) x = -x;
  divide_by_mass(alpha_.data());
  if (!blades_.empty()) {
    if (!factor_blades()) return Status::blades;
    for (std::size_t i = 0; i < blades_.size(); ++i) {
      T h = blades_[i].acceleration(here(), v_.data(), a_.data());
      const std::size_t all = independent_.size();
      for (std::size_t k = 0; k < all; ++k) h += blade_reduced_[i * all + k] * alpha_[k];
      blade_multipliers_[i] = h;
    }
    solve_blades(blade_multipliers_.data());
    press_blades(blade_multipliers_.data(), alpha_.data());
  }
  add_accelerations(alpha_.data());
  for (std::size_t i = 0; i < blades_.size(); ++i) {
    const T* row = &blade_rows_[i * static_cast<std::size_t>(n_)];
    for (int j = 0; j < n_; ++j) full_force_[j] += blade_multipliers_[i] * row[j];
  }
  return Status::ok;
}

template <class T>
void ReducedMotion<T>::jump(const T* steps, const T* impulse) {
  jumps_ = true;
  steps_.assign(steps, steps + touching_.size());
  std::fill(v_.begin(), v_.end(), T(0));
  place_accelerations();
  find_forces();
  for (int i = 0; i < n_ && impulse != nullptr; ++i) full_force_[i] -= impulse[i];
  solve_accelerations();
  find_multipliers();
}

template <class T>
void ReducedMotion<T>::jump_change(const T* dq, const T* steps, const Influence* influence, T* change,
                                   const T* impulse) {
  for (auto* part : direct_.parts()) std::fill(part->begin(), part->end(), T(0));
  if (influence != nullptr && influence->variation >= 0) add_direct(static_cast<std::size_t>(influence->variation));
  if (influence != nullptr && influence->body >= 0) {
    add_influence(*influence, a_.data(), second_.data(), direct_.force.data());
  }
  for (std::size_t k = 0; k < touching_.size(); ++k) {
    direct_.acceleration[static_cast<std::size_t>(mechanism_.equalities()) + prescribed_ + k] -= steps[k];
  }
  for (int i = 0; i < n_ && impulse != nullptr; ++i) direct_.force[i] -= impulse[i];
  std::vector<T> rates(static_cast<std::size_t>(n_)), alpha(static_cast<std::size_t>(freedoms()));
  linearize_pose(dq, &direct_, rates.data(), change, alpha.data());
}

template <class T>
void ReducedMotion<T>::respond(const T* slope, T* dw) const {
  project(slope, dw);
  divide_by_mass(dw);
  if (!blades_.empty()) hold_by_blades(dw);
}

template <class T>
void ReducedMotion<T>::push(const T* slope, T* dalpha) {
  respond(slope, dalpha);
  if (readings_.empty()) return;
  for (int i = 0; i < n_; ++i) full_[i] = -slope[i];
  let_states_follow(full_.data(), nullptr, nullptr, dalpha);
}

// B alpha to the accelerations, and what belongs to it to forces.
template <class T>
void ReducedMotion<T>::add_accelerations(const T* alpha) {
  for (const int i : moving_) {
    T change(0), force(0);
    Planar<T> weight{};
    for (int k = 0; k < carrying_; ++k) {
      const std::size_t at = static_cast<std::size_t>(k) * n_ + i;
      change += alpha[k] * B_[at];
      force += alpha[k] * mass_columns_[at];
      weight += alpha[k] * weight_columns_[at];
    }
    full_[i] = change;
    full_force_[i] += force;
    weight_[i] += weight;
  }
  for (int k = heavy_; k < freedoms(); ++k) {
    full_[independent_[k]] = alpha[k];
    full_force_[independent_[k]] += alpha[k] * inertia_.moment(independent_[k]);
  }
  mechanism_.phasors().first(pose_.data(), full_.data(), work_.data());
  for (int i = 0; i < n_; ++i) {
    a_[i] += full_[i];
    second_[i] += work_[i];
  }
}

// Jd^T multipliers = -G over the dependent coordinates; rows that are not used have none.
template <class T>
void ReducedMotion<T>::find_multipliers() {
  std::fill(multipliers_.begin(), multipliers_.end(), T(0));
  for (std::size_t i = 0; i < dependent_.size(); ++i) small_rows_[i] = -full_force_[dependent_[i]];
  lu_.solve_transposed(small_rows_.data());
  drive_multipliers_.assign(drives_.size(), T(0));
  const int equalities = mechanism_.equalities();
  for (std::size_t i = 0; i < used_rows_.size(); ++i) {
    if (used_rows_[i] < equalities)
      multipliers_[used_rows_[i]] = small_rows_[i];
    else
      drive_multipliers_[used_rows_[i] - equalities] = small_rows_[i];
  }
}

// With q' and v' for one direction: from the phasors' known second time derivative change `work_`, and that of the
// driven measures `drive_rows_` (all but that of the unknown alpha'), finds a' = a'0 + B alpha' with  B^T dG = 0.
template <class T>
void ReducedMotion<T>::linearize_direction(const T* dq, const T* dv, const Direct* direct, T* da, T* dalpha) {
  using std::abs;
  std::fill(da, da + n_, T(0));
  if (rank() > 0) {
    std::fill(rows_work_.begin(), rows_work_.end(), T(0));
    mechanism_.closures_of(work_.data(), rows_work_.data());
    for (int k = 0; k < drives(); ++k) rows_work_[mechanism_.equalities() + k] = drive_rows_[k];
    if (direct != nullptr) {
      for (int r = 0; r < rows_; ++r) rows_work_[r] += direct->acceleration[r];
    }
    solve_rows(rows_work_.data(), da);
    mechanism_.phasors().first(pose_.data(), da, work2_.data());
    for (int t = 0; t < n_; ++t) work_[t] += work2_[t];
  }
  inertia_.weigh(work_.data(), work2_.data());
  for (int i = 0; i < n_; ++i) force_[i] = inertia_.moment(i) * da[i];
  mechanism_.phasors().add_projection(pose_.data(), work2_.data(), force_.data());
  if (dq != nullptr) {
    mechanism_.phasors().add_projection_change(pose_.data(), dq, weight_.data(), force_.data());
    const auto& row = mechanism_.tangent_row();
    const auto& column = mechanism_.tangent_column();
    const bool full = mechanism_.has_follower_loads();
    for (std::size_t e = 0; e < row.size(); ++e) {
      force_[row[e]] += tangent_[e] * dq[column[e]];
      if (!full && row[e] != column[e]) force_[column[e]] += tangent_[e] * dq[row[e]];
    }
    for (int k = 0; k < drives(); ++k) drives_[k].on.add_bend(here(), dq, drive_multipliers_[k], force_.data());
    for (std::size_t i = 0; i < first_teeth_ && !jumps_; ++i) {
      if (grips_[i].is_stop()) grips_[i].on.add_bend(here(), dq, efforts_[i], force_.data());
    }
    for (std::size_t c = 0; c < contact_efforts_.size() && !jumps_; ++c) {
      const T& effort = contact_efforts_[c];
      drives_[stop_row(static_cast<int>(c))].on.add_bend(here(), dq, effort, force_.data());
      bearing_loads_.add_change(bearing_loads_.contacts()[c], effort, abs(effort), pose_.data(), dq, force_.data());
    }
    if (!jumps_) input_forces_.add_change(pose_.data(), dq, force_.data());
    for (std::size_t b = 0; b < blades_.size(); ++b) {
      blades_[b].add_change(here(), dq, blade_multipliers_[b], force_.data());
    }
  }
  if (!jumps_) {
    mechanism_.add_resistance_change(pose_.data(), resistances_.data(), v_.data(), dq != nullptr ? dq : zero_.data(),
                                     dv, force_.data(), input_forces_.in_time());
  }
  if (direct != nullptr) {
    for (int i = 0; i < n_; ++i) force_[i] += direct->force[i];
  }
  answer_change(dq, dv, direct, da, dalpha);
}

// alpha' for the change of forces `force_`, and B alpha' to a'.
template <class T>
void ReducedMotion<T>::answer_change(const T* dq, const T* dv, const Direct* direct, T* da, T* dalpha) {
  project(force_.data(), dalpha);
  for (int j = 0; j < freedoms(); ++j) dalpha[j] = -dalpha[j];
  divide_change_by_mass(dalpha);
  if (!blades_.empty()) {
    for (std::size_t b = 0; b < blades_.size(); ++b) {
      T h = blades_[b].acceleration_change(here(), v_.data(), a_.data(), dq, dv);
      if (direct != nullptr) h += direct->blade[b];
      const T* row = &blade_rows_[b * static_cast<std::size_t>(n_)];
      for (int i = 0; i < n_; ++i) h += row[i] * da[i];
      for (int k = 0; k < freedoms(); ++k) {
        h += blade_reduced_[b * static_cast<std::size_t>(freedoms()) + static_cast<std::size_t>(k)] * dalpha[k];
      }
      blade_work_[b] = h;
    }
    solve_blades(blade_work_.data());
    press_blades(blade_work_.data(), dalpha);
  }
  if (gripping_ && !jumps_) let_friction_follow(dq, direct, force_.data(), dalpha);
  if (!readings_.empty() && !jumps_) let_states_follow(force_.data(), dq, direct, dalpha);
  for (int k = 0; k < carrying_; ++k) {
    for (int i = 0; i < n_; ++i) da[i] += dalpha[k] * B(k)[i];
  }
  for (int k = carrying_; k < freedoms(); ++k) da[independent_[k]] += dalpha[k];
}

// Along the place and the rate of a state of a controller, of which controllers alone know.
template <class T>
void ReducedMotion<T>::linearize_state(int k) {
  const std::size_t at = static_cast<std::size_t>(k) * n_;
  const std::size_t at_small = static_cast<std::size_t>(k) * freedoms();
  const T* along = B(k);
  const auto change_by = [&](const T* dq, const T* dv, T* da, T* dalpha) {
    std::fill(force_.begin(), force_.end(), T(0));
    std::fill(da, da + n_, T(0));
    if (!jumps_) {
      mechanism_.add_resistance_change(pose_.data(), resistances_.data(), v_.data(), dq, dv, force_.data(),
                                       input_forces_.in_time());
    }
    answer_change(dq, dv, nullptr, da, dalpha);
  };
  std::fill(&v_z_[at], &v_z_[at] + n_, T(0));
  change_by(along, zero_.data(), &a_z_[at], &alpha_z_[at_small]);
  keep_reaction_changes(reactions_z_, k);
  change_by(zero_.data(), along, &a_w_[at], &alpha_w_[at_small]);
  keep_reaction_changes(reactions_w_, k);
}

// Along q' = B_k, or q' = q_p with the direct derivatives by p:  J v' = -D2c[v, q'] - (J v)|p.
template <class T>
void ReducedMotion<T>::linearize_pose(const T* dq, const Direct* direct, T* dv, T* da, T* dalpha) {
  std::fill(dv, dv + n_, T(0));
  if (rank() > 0) {
    mechanism_.phasors().second(pose_.data(), v_.data(), dq, work_.data());
    std::fill(rows_work_.begin(), rows_work_.end(), T(0));
    mechanism_.closures_of(work_.data(), rows_work_.data());
    for (int d = 0; d < drives(); ++d) {
      rows_work_[mechanism_.equalities() + d] = drives_[d].on.second(here(), v_.data(), dq);
    }
    if (direct != nullptr) {
      for (int r = 0; r < rows_; ++r) rows_work_[r] += direct->rate[r];
    }
    solve_rows(rows_work_.data(), dv);
  }
  mechanism_.phasors().third(pose_.data(), v_.data(), v_.data(), dq, work_.data());
  if (rank() > 0) {
    mechanism_.phasors().second(pose_.data(), v_.data(), dv, work2_.data());
    for (int t = 0; t < n_; ++t) work_[t] += T(2) * work2_[t];
  }
  mechanism_.phasors().second(pose_.data(), a_.data(), dq, work2_.data());
  for (int t = 0; t < n_; ++t) work_[t] += work2_[t];
  for (int d = 0; d < drives(); ++d) {
    const CompiledMeasure<T>& on = drives_[d].on;
    drive_rows_[d] = on.third(here(), v_.data(), v_.data(), dq) + 2 * on.second(here(), v_.data(), dv) +
                     on.second(here(), a_.data(), dq);
  }
  linearize_direction(dq, dv, direct, da, dalpha);
}

template <class T>
void ReducedMotion<T>::linearize() {
  find_multipliers();
  if (variations_) state_for_variations();
  mechanism_.tangent(pose_.data(), multipliers_.data(), tangent_.data());
  if (jumps_) {
    std::fill(rows_work_.begin(), rows_work_.end(), T(0));
    tangent_of_loads_.resize(tangent_.size());
    mechanism_.tangent(pose_.data(), rows_work_.data(), tangent_of_loads_.data());
    for (std::size_t e = 0; e < tangent_.size(); ++e) tangent_[e] -= tangent_of_loads_[e];
  }
  for (int k = carrying_; k < freedoms(); ++k) linearize_state(k);
  for (int k = 0; k < carrying_; ++k) {
    const std::size_t at = static_cast<std::size_t>(k) * n_;
    const std::size_t at_small = static_cast<std::size_t>(k) * freedoms();
    const T* dq = B(k);
    linearize_pose(dq, nullptr, &v_z_[at], &a_z_[at], &alpha_z_[at_small]);
    keep_reaction_changes(reactions_z_, k);
    // Along w_k: v' = B_k.
    mechanism_.phasors().second(pose_.data(), v_.data(), dq, work_.data());
    for (int t = 0; t < n_; ++t) work_[t] = T(2) * work_[t];
    for (int d = 0; d < drives(); ++d) drive_rows_[d] = 2 * drives_[d].on.second(here(), v_.data(), dq);
    linearize_direction(nullptr, dq, nullptr, &a_w_[at], &alpha_w_[at_small]);
    keep_reaction_changes(reactions_w_, k);
  }
}

template <class T>
void ReducedMotion<T>::add_influence(const Influence& influence, const T* a, const Planar<T>* second, T* g) const {
  if (influence.body < 0) {
    input_forces_.add_derivative(influence.force, static_cast<T>(influence.by), pose_.data(), v_.data(), sliding(), g);
    return;
  }
  inertia_.add_body(influence.body,
                    {static_cast<T>(influence.mass), planar_cast<T>(influence.first), static_cast<T>(influence.moment)},
                    pose_.data(), a, second, g, jumps_ ? inertia_.gravity() : input_forces_.frame());
}

template <class T>
void ReducedMotion<T>::set_variations(const std::vector<Variation>& variations) {
  variations_.reset();
  if (variations.empty()) return;
  variations_ = std::make_shared<MotionVariations>();
  std::vector<GripOf> grips;
  for (std::size_t i = 0; i < first_teeth_; ++i) grips.push_back({grips_[i].joint, grips_[i].stop});
  for (Reading& one : readings_) {
    if (one.travel < 0) continue;
    one.varied = static_cast<int>(grips.size());
    grips.push_back({one.joint, -1});
  }
  std::size_t pose = 0;
  for (const Variation& variation : variations) {
    variations_->terms.emplace_back(variation, inputs_, touching_, held_, grips, growing(grips_));
    pose = std::max(pose, variations_->terms.back().pose_size());
  }
  variations_->state.pose.resize(pose);
}

// The state of the last linearize().
template <class T>
void ReducedMotion<T>::state_for_variations() {
  using Dual = VariedState::Dual;
  const auto take = [](std::vector<Dual>& to, const std::vector<T>& from) {
    to.resize(from.size());
    for (std::size_t i = 0; i < from.size(); ++i) to[i] = Dual(static_cast<double>(from[i]));
  };
  const auto take_vectors = [](std::vector<Planar<Dual>>& to, const std::vector<Planar<T>>& from, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      to[i] = {Dual(static_cast<double>(from[i].x)), Dual(static_cast<double>(from[i].y))};
    }
  };
  VariedState& state = variations_->state;
  state.t = static_cast<double>(t_);
  state.near = near_at(t_);
  state.sliding = sliding();
  state.jumps = jumps_;
  take(state.q, q_);
  take(state.v, v_);
  take(state.a, a_);
  take(state.multipliers, multipliers_);
  take(state.drive_multipliers, drive_multipliers_);
  take(state.contact_efforts, contact_efforts_);
  take(state.grip_efforts, efforts_);
  take(state.blade_multipliers, blade_multipliers_);
  take(state.reactions, reactions_);
  state.second.resize(second_.size());
  take_vectors(state.second, second_, second_.size());
  take_vectors(state.pose, pose_, static_cast<std::size_t>(mechanism_.phasors().pose_size()));
}

template <class T>
void ReducedMotion<T>::add_direct(std::size_t variation) {
  VariationTerms& terms = variations_->terms[variation];
  terms.add(variations_->state, direct_.gap.data(), direct_.rate.data(), direct_.acceleration.data(),
            direct_.force.data(), direct_.blade_rate.data(), direct_.blade.data());
  for (std::size_t r = 0; r < readings_.size(); ++r) {
    const Reading& one = readings_[r];
    if (one.travel < 0) continue;
    const Planar<T> axis = planar_cast<T>(terms.axis_by(static_cast<std::size_t>(one.varied)));
    const Planar<T> turned = quarter_turn(axis * mechanism_.phasors().line_direction(pose_.data(), one.travel));
    const Planar<T> normal = read_normal(one), held{multiplier_of(one.row), multiplier_of(one.row + 1)};
    direct_.read[r] -= dot(turned, held) * component(one, normal) + dot(normal, held) * component(one, turned);
  }
  for (std::size_t i = 0; gripping_ && !jumps_ && i < first_teeth_; ++i) {
    const Grip& grip = grips_[i];
    direct_.bound[i] += static_cast<T>(terms.factor_by(i)) * sizes_[i];
    if (grip.is_pin() || grip.is_stop()) continue;
    const Planar<T> axis = planar_cast<T>(terms.axis_by(i));
    const Planar<T> normal = quarter_turn(axis * mechanism_.phasors().line_direction(pose_.data(), grip.travel));
    direct_.bound[i] += grip.factor * size_of(grip, branches_[i], holds_[i], normal);
  }
}

// Along by times the number of a drive, or of its function of time.
template <class T>
void ReducedMotion<T>::add_drive_number(int drive, int number, const T& by) {
  const DriveRow& driven = drives_[drive];
  const int row = mechanism_.equalities() + drive;
  if (number == TimeFunction::whole) {
    direct_.acceleration[row] -= by;
    return;
  }
  const auto moved = [&](int order) -> T {
    if (!driven.input || !driven.input->function) return -by * driven.drive.moved_by(number, t_, order);
    return -by * static_cast<T>(driven.input->unit *
                                driven.input->function->by(number, static_cast<double>(t_), order, near_at(t_)));
  };
  direct_.gap[row] += moved(0);
  direct_.rate[row] += moved(1);
  direct_.acceleration[row] += moved(2);
}

template <class T>
void ReducedMotion<T>::influence(const Influence& influence, T* alpha) {
  if (!influence.moves()) {
    std::fill(full_.begin(), full_.end(), T(0));
    add_influence(influence, a_.data(), second_.data(), full_.data());
    project(full_.data(), alpha);
    for (int j = 0; j < freedoms(); ++j) alpha[j] = -alpha[j];
    divide_change_by_mass(alpha);
    if (!blades_.empty()) hold_by_blades(alpha);
    if (gripping_) let_friction_follow(nullptr, nullptr, full_.data(), alpha);
    if (!readings_.empty()) let_states_follow(full_.data(), nullptr, nullptr, alpha);
    return;
  }
  for (auto* part : direct_.parts()) std::fill(part->begin(), part->end(), T(0));
  if (influence.drive >= 0) {
    add_drive_number(influence.drive, influence.drive_number, static_cast<T>(influence.by));
  } else {
    add_direct(static_cast<std::size_t>(influence.variation));
    for (const Influence::InTime& part : influence.in_time) {
      if (part.of == TimeFunction::Of::drive) {
        add_drive_number(part.item, part.number, static_cast<T>(part.by));
        continue;
      }
      Influence load;
      load.force = force_number(part.of, part.item, part.part, part.number);
      load.by = part.by;
      add_influence(load, a_.data(), second_.data(), direct_.force.data());
    }
  }
  solve_rows(direct_.gap.data(), q_p_.data());
  linearize_pose(q_p_.data(), &direct_, v_p_.data(), a_p_.data(), alpha);
}

template <class T>
T ReducedMotion<T>::blade_rate_change(int k, const T* dq, const T* dv) {
  std::fill(full_.begin(), full_.end(), T(0));
  blades_[k].add_change(here(), dq, T(1), full_.data());
  T out = blades_[k].along(here(), dv);
  for (int i = 0; i < n_; ++i) out += full_[i] * v_[i];
  return out;
}

template <class T>
T ReducedMotion<T>::gap_by() const {
  using std::abs;
  T largest(0);
  for (int r = 0; r < rows_; ++r) {
    if (place_of_row_[r] >= 0) continue;
    T sum = direct_.gap[r], terms = abs(sum);
    for (int j = 0; j < n_; ++j) {
      const T term = jacobian(r, j) * q_p_[j];
      sum += term;
      terms += abs(term);
    }
    if (terms > 0) largest = std::max<T>(largest, abs(sum) / terms);
  }
  return largest;
}

template <class T>
void ReducedMotion<T>::influence_terms(const Influence& influence, T* size) const {
  using std::abs;
  const int f = freedoms();
  const std::vector<T>& g = influence.moves() ? force_ : full_;
  std::fill(size, size + f, T(0));
  std::vector<T> column(static_cast<std::size_t>(f));
  for (int j = 0; j < f; ++j) {
    T terms(0);
    for (int i = 0; i < n_; ++i) terms += abs(B(j)[i] * g[i]);
    std::fill(column.begin(), column.end(), T(0));
    column[static_cast<std::size_t>(j)] = terms;
    divide_change_by_mass(column.data());
    if (!blades_.empty()) hold_by_blades(column.data());
    for (int k = 0; k < f; ++k) size[k] += abs(column[static_cast<std::size_t>(k)]);
  }
}

template <class T>
void ReducedMotion<T>::accelerate_as(const T* alpha) {
  place_accelerations();
  for (int k = 0; k < freedoms(); ++k) {
    mechanism_.phasors().first(pose_.data(), B(k), work_.data());
    for (int i = 0; i < n_; ++i) {
      a_[i] += alpha[k] * B(k)[i];
      second_[i] += alpha[k] * work_[i];
    }
  }
}

template <class T>
void ReducedMotion<T>::reduced_inertia(int body, const BodyInertia<T>& part, T* f) const {
  std::fill(full_.begin(), full_.end(), T(0));
  inertia_.add_body(body, part, pose_.data(), a_.data(), second_.data(), full_.data(), input_forces_.frame());
  project(full_.data(), f);
}

template <class T>
T ReducedMotion<T>::kinetic_energy() const {
  mechanism_.phasors().first(pose_.data(), v_.data(), work_.data());
  inertia_.weigh(work_.data(), work2_.data());
  T twice(0);
  for (int i = 0; i < n_; ++i) twice += dot(work_[i], work2_[i]) + inertia_.moment(i) * v_[i] * v_[i];
  return twice / 2;
}

template <class T>
T ReducedMotion<T>::work_of_gaps() const {
  using std::abs;
  T sum(0);
  for (const T& one : multipliers_) sum += abs(one);
  for (const T& one : drive_multipliers_) sum += abs(one);
  return sum;
}

template <class T>
T ReducedMotion<T>::power() const {
  std::fill(full_.begin(), full_.end(), T(0));
  mechanism_.add_resistance(resistances_.data(), full_.data());
  input_forces_.add(pose_.data(), full_.data());
  T power = mechanism_.has_follower_loads() ? mechanism_.follower_power(pose_.data(), v_.data()) : T(0);
  for (int i = 0; i < n_; ++i) power -= v_[i] * full_[i];
  power += drive_power();
  for (std::size_t i = 0; i < first_teeth_; ++i) power -= efforts_[i] * grips_[i].on.along(here(), v_.data());
  return power;
}

template <class T>
T ReducedMotion<T>::drive_power() const {
  T power(0);
  for (int k = 0; k < drives(); ++k) {
    power += drive_force(k) * (drives_[k].target(t_, 1, near_at(t_)) + drives_[k].led_rate);
  }
  return power;
}

template <class T>
std::vector<T> ReducedMotion<T>::stop_values() const {
  std::vector<T> c(mechanism_.constraints());
  mechanism_.constraint(q_.data(), pose_.data(), c.data());
  return {c.begin() + mechanism_.equalities(), c.end()};
}

template <class T>
T ReducedMotion<T>::drive_force(int k) const {
  return -drive_multipliers_[k];
}

}  // namespace poise
