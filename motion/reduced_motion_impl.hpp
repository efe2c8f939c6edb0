#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "motion/reduced_motion.hpp"

namespace poise {

template <class T>
ReducedMotion<T>::ReducedMotion(const Scene& scene, const Mechanism<T>& mechanism, const Inertia<T>& inertia)
    : mechanism_(mechanism), inertia_(inertia), n_(mechanism.coordinates()), singular_limit_(1e-9) {
  const Layout& layout = mechanism.layout();
  for (const Drive& drive : scene.drives) {
    DriveRow row{drive, -1, -1, T(0), T(0)};
    if (drive.kind == Drive::Kind::travel) {
      row.b = layout.travel[drive.joint];
    } else {
      const Link& a = layout.links[drive.body_a];
      const Link& b = layout.links[drive.body_b];
      row.a = a.frame;
      row.b = b.frame;
      row.constant = static_cast<T>(b.turn) - static_cast<T>(a.turn);
    }
    drives_.push_back(row);
  }
  rows_ = 2 * mechanism.closures() + drives();
  const std::size_t n = static_cast<std::size_t>(n_);
  for (auto* full : {&q_, &v_, &a_, &drift_, &force_, &full_force_, &full_, &zero_}) full->assign(n, T(0));
  const std::size_t constraints = static_cast<std::size_t>(mechanism.constraints()) + drives_.size();
  for (auto* rows : {&c_, &rows_work_, &multipliers_}) rows->assign(constraints, T(0));
  J_.resize(rows_ * n);
  values_.resize(mechanism.jacobian_row().size());
  tangent_.resize(mechanism.tangent_row().size());
  pose_.resize(mechanism.pose_size());
  for (auto* phasors : {&second_, &weight_, &work_, &work2_}) phasors->resize(n);
}

template <class T>
T ReducedMotion<T>::value(const DriveRow& d, const T& t, int derivative) const {
  using std::cos;
  using std::sin;
  const T omega = 2 * std::numbers::pi * static_cast<T>(d.drive.frequency);
  const T turn = omega * t + static_cast<T>(d.drive.phase);
  const T amplitude = static_cast<T>(d.drive.amplitude);
  const T rate = static_cast<T>(d.drive.rate);
  const T acceleration = static_cast<T>(d.drive.acceleration);
  if (derivative == 0) {
    return d.start + rate * t + acceleration * t * t / 2 + amplitude * (sin(turn) - sin(static_cast<T>(d.drive.phase)));
  }
  if (derivative == 1) return rate + acceleration * t + amplitude * omega * cos(turn);
  return acceleration - amplitude * omega * omega * sin(turn);
}

template <class T>
void ReducedMotion<T>::start_drives(const T* q) {
  for (DriveRow& d : drives_) {
    d.start = d.constant + (d.b >= 0 ? q[d.b] : T(0)) - (d.a >= 0 ? q[d.a] : T(0));
    if (d.drive.start) d.start = static_cast<T>(*d.drive.start);
  }
}

template <class T>
void ReducedMotion<T>::fill_jacobian() {
  std::fill(J_.begin(), J_.end(), T(0));
  mechanism_.jacobian(pose_.data(), values_.data());
  const auto& row = mechanism_.jacobian_row();
  const auto& column = mechanism_.jacobian_column();
  const int closure_rows = 2 * mechanism_.closures();
  for (std::size_t e = 0; e < row.size(); ++e) {
    if (row[e] < closure_rows) jacobian(row[e], column[e]) += values_[e];
  }
  for (int k = 0; k < drives(); ++k) {
    if (drives_[k].b >= 0) jacobian(closure_rows + k, drives_[k].b) += T(1);
    if (drives_[k].a >= 0) jacobian(closure_rows + k, drives_[k].a) -= T(1);
  }
}

template <class T>
void ReducedMotion<T>::residual(const T& t) {
  mechanism_.constraint(q_.data(), pose_.data(), c_.data());
  for (int k = 0; k < drives(); ++k) {
    const DriveRow& d = drives_[k];
    c_[2 * mechanism_.closures() + k] =
        d.constant + (d.b >= 0 ? q_[d.b] : T(0)) - (d.a >= 0 ? q_[d.a] : T(0)) - value(d, t, 0);
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
  if (fixed != nullptr) {
    // The fixed ones are put last, and pivots are looked for before them only.
    std::stable_partition(columns.begin(), columns.end(),
                          [&](int j) { return std::find(fixed->begin(), fixed->end(), j) == fixed->end(); });
  }
  const int searched = fixed != nullptr ? n_ - static_cast<int>(fixed->size()) : n_;
  T first(0);
  int rank = 0;
  const int most = keep_rank && first_rank_ >= 0 ? first_rank_ : std::min(rows_, searched);
  // Rounding in pivots of exactly singular poses stays below this; a mechanism as badly determined cannot be moved.
  const T zero = static_cast<T>(1e-9);
  bool grown = false;
  for (; rank < std::min(rows_, searched); ++rank) {
    int p = rank, c = rank;
    for (int i = rank; i < rows_; ++i) {
      for (int j = rank; j < searched; ++j) {
        if (abs(jacobian(rows[i], columns[j])) > abs(jacobian(rows[p], columns[c]))) {
          p = i;
          c = j;
        }
      }
    }
    const T size = abs(jacobian(rows[p], columns[c]));
    if (rank == 0) first = size;
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

// Of what depends on the choice of coordinates.
template <class T>
void ReducedMotion<T>::make_room() {
  lu_.resize(rank());
  small_rows_.assign(dependent_.size(), T(0));
  const std::size_t f = independent_.size();
  const std::size_t n = static_cast<std::size_t>(n_);
  for (auto* columns_of : {&B_, &v_z_, &a_z_, &a_w_, &mass_columns_}) columns_of->assign(f * n, T(0));
  for (auto* square : {&alpha_z_, &alpha_w_, &mass_}) square->assign(f * f, T(0));
  weight_columns_.resize(f * n);
  for (auto* few : {&alpha_, &small_}) few->assign(f, T(0));
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

// q + u + J^-1(-D2c[u, u]/2) with u = B dz + (rates of the drives) dt: the pose placed last continued to second order.
template <class T>
void ReducedMotion<T>::predict(const T& dt, const T* z) {
  using std::abs;
  std::fill(full_.begin(), full_.end(), T(0));
  for (int k = 0; k < freedoms(); ++k) {
    const T dz = z[k] - q_[independent_[k]];
    const T* column = B(k);
    for (int i = 0; i < n_; ++i) full_[i] += dz * column[i];
  }
  if (drives() > 0) {
    for (int i = 0; i < n_; ++i) full_[i] += dt * drift_[i];
  }
  mechanism_.phasor_second(pose_.data(), full_.data(), full_.data(), work_.data());
  std::fill(rows_work_.begin(), rows_work_.end(), T(0));
  mechanism_.closures_of(work_.data(), rows_work_.data());
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
  if (predicted) predict(t - t_, z);
  known_ = false;
  t_ = t;
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
    if (!(pivot_ > singular_limit_)) return Status::singular;
    T gap(0);
    for (int i = 0; i < r; ++i) {
      small_rows_[i] = -c_[used_rows_[i]];
      gap = std::max<T>(gap, abs(small_rows_[i]));
    }
    // A gap of nothing but rounding would be enlarged by 1 / pivot_: next to singular poses no step is the better one.
    closed = gap <= 3 * std::numeric_limits<T>::epsilon();
    if (closed) break;
    lu_.solve(small_rows_.data());
    T step(0);
    for (int i = 0; i < r; ++i) step = std::max<T>(step, abs(small_rows_[i]));
    // A correction as large as the way that was predicted leads to some other branch of the loops.
    corrected += step;
    if (!(step < 1) || (predicted && corrected > reach_ / 2 + fine / pivot_)) return Status::open;
    closed = step <= fine || (iteration > 2 && step <= fine / pivot_) || (iteration > 5 && step < 1e-9 && step >= last);
    for (int i = 0; i < r; ++i) q_[dependent_[i]] += small_rows_[i];
    last = step;
  }
  if (!closed) return Status::open;
  // B = [-Jd^-1 Ji; I]
  for (int k = 0; k < freedoms(); ++k) {
    for (int i = 0; i < rows_; ++i) rows_work_[i] = jacobian(i, independent_[k]);
    T* column = &B_[static_cast<std::size_t>(k) * n_];
    solve_rows(rows_work_.data(), column);
    column[independent_[k]] = T(1);
  }
  known_ = true;
  return Status::ok;
}

template <class T>
void ReducedMotion<T>::move(const T* w) {
  if (drives() > 0) {
    std::fill(rows_work_.begin(), rows_work_.end(), T(0));
    for (int k = 0; k < drives(); ++k) rows_work_[2 * mechanism_.closures() + k] = -value(drives_[k], t_, 1);
    solve_rows(rows_work_.data(), drift_.data());
  }
  std::copy(drift_.begin(), drift_.end(), v_.begin());
  for (int k = 0; k < freedoms(); ++k) {
    const T* column = B(k);
    for (int i = 0; i < n_; ++i) v_[i] += w[k] * column[i];
  }
}

template <class T>
void ReducedMotion<T>::project(const T* full, T* reduced) const {
  for (int k = 0; k < freedoms(); ++k) {
    const T* column = B(k);
    T sum(0);
    for (int i = 0; i < n_; ++i) sum += column[i] * full[i];
    reduced[k] = sum;
  }
}

// Cholesky factors are in mass_, lower part.
template <class T>
void ReducedMotion<T>::divide_by_mass(T* b) const {
  const int f = freedoms();
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

// a0: what the accelerations must be where alpha is zero.
template <class T>
void ReducedMotion<T>::place_accelerations() {
  mechanism_.phasor_second(pose_.data(), v_.data(), v_.data(), second_.data());
  std::fill(rows_work_.begin(), rows_work_.end(), T(0));
  mechanism_.closures_of(second_.data(), rows_work_.data());
  for (int k = 0; k < drives(); ++k) rows_work_[2 * mechanism_.closures() + k] = -value(drives_[k], t_, 2);
  solve_rows(rows_work_.data(), a_.data());
  mechanism_.phasor_first(pose_.data(), a_.data(), work_.data());
  for (int t = 0; t < n_; ++t) second_[t] += work_[t];
}

template <class T>
typename ReducedMotion<T>::Status ReducedMotion<T>::accelerate() {
  using std::sqrt;
  const int f = freedoms();
  place_accelerations();
  inertia_.weigh(second_.data(), weight_.data());
  mechanism_.negative_force(q_.data(), pose_.data(), full_force_.data());
  mechanism_.add_resistance(pose_.data(), v_.data(), full_force_.data());
  mechanism_.add_projection(pose_.data(), weight_.data(), full_force_.data());
  for (int i = 0; i < n_; ++i) full_force_[i] += inertia_.moment(i) * a_[i];

  for (int k = 0; k < f; ++k) {
    Planar<T>* weighed = &weight_columns_[static_cast<std::size_t>(k) * n_];
    T* moved = &mass_columns_[static_cast<std::size_t>(k) * n_];
    mechanism_.phasor_first(pose_.data(), B(k), work_.data());
    inertia_.weigh(work_.data(), weighed);
    for (int i = 0; i < n_; ++i) moved[i] = inertia_.moment(i) * B(k)[i];
    mechanism_.add_projection(pose_.data(), weighed, moved);
    project(moved, small_.data());
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
      }
    }
  }
  project(full_force_.data(), alpha_.data());
  for (T& x : alpha_) x = -x;
  divide_by_mass(alpha_.data());
  for (int k = 0; k < f; ++k) {
    const T* column = B(k);
    const T* moved = &mass_columns_[static_cast<std::size_t>(k) * n_];
    const Planar<T>* weighed = &weight_columns_[static_cast<std::size_t>(k) * n_];
    mechanism_.phasor_first(pose_.data(), column, work_.data());
    for (int i = 0; i < n_; ++i) {
      a_[i] += alpha_[k] * column[i];
      full_force_[i] += alpha_[k] * moved[i];
      second_[i] += alpha_[k] * work_[i];
      weight_[i] += alpha_[k] * weighed[i];
    }
  }
  if (drives() > 0) find_multipliers();
  return Status::ok;
}

// Jd^T multipliers = -G over the dependent coordinates; rows that are not used have none.
template <class T>
void ReducedMotion<T>::find_multipliers() {
  std::fill(multipliers_.begin(), multipliers_.end(), T(0));
  for (std::size_t i = 0; i < dependent_.size(); ++i) small_rows_[i] = -full_force_[dependent_[i]];
  lu_.solve_transposed(small_rows_.data());
  drive_multipliers_.assign(drives_.size(), T(0));
  const int closure_rows = 2 * mechanism_.closures();
  for (std::size_t i = 0; i < used_rows_.size(); ++i) {
    if (used_rows_[i] < closure_rows)
      multipliers_[used_rows_[i]] = small_rows_[i];
    else
      drive_multipliers_[used_rows_[i] - closure_rows] = small_rows_[i];
  }
}

// With q' = B_k or 0 and v' for one direction: from the phasors' known second time derivative change `work_` (all but
// that of the unknown alpha'), finds a' = a'0 + B alpha' with  B^T dG = 0.
template <class T>
void ReducedMotion<T>::linearize_direction(const T* dq, const T* dv, T* da, T* dalpha) {
  std::fill(rows_work_.begin(), rows_work_.end(), T(0));
  mechanism_.closures_of(work_.data(), rows_work_.data());
  solve_rows(rows_work_.data(), da);
  mechanism_.phasor_first(pose_.data(), da, work2_.data());
  for (int t = 0; t < n_; ++t) work_[t] += work2_[t];
  inertia_.weigh(work_.data(), work2_.data());
  for (int i = 0; i < n_; ++i) force_[i] = inertia_.moment(i) * da[i];
  mechanism_.add_projection(pose_.data(), work2_.data(), force_.data());
  if (dq != nullptr) {
    mechanism_.add_projection_change(pose_.data(), dq, weight_.data(), force_.data());
    const auto& row = mechanism_.tangent_row();
    const auto& column = mechanism_.tangent_column();
    const bool full = mechanism_.has_follower_loads();
    for (std::size_t e = 0; e < row.size(); ++e) {
      force_[row[e]] += tangent_[e] * dq[column[e]];
      if (!full && row[e] != column[e]) force_[column[e]] += tangent_[e] * dq[row[e]];
    }
  }
  mechanism_.add_resistance_change(pose_.data(), v_.data(), dq != nullptr ? dq : zero_.data(), dv, force_.data());
  project(force_.data(), dalpha);
  for (int j = 0; j < freedoms(); ++j) dalpha[j] = -dalpha[j];
  divide_by_mass(dalpha);
  for (int k = 0; k < freedoms(); ++k) {
    for (int i = 0; i < n_; ++i) da[i] += dalpha[k] * B(k)[i];
  }
}

template <class T>
void ReducedMotion<T>::linearize() {
  find_multipliers();
  mechanism_.tangent(pose_.data(), multipliers_.data(), tangent_.data());
  for (int k = 0; k < freedoms(); ++k) {
    const std::size_t at = static_cast<std::size_t>(k) * n_;
    const std::size_t at_small = static_cast<std::size_t>(k) * freedoms();
    const T* dq = B(k);
    T* dv = &v_z_[at];
    // Along z_k: J v' = -D2c[v, q'].
    mechanism_.phasor_second(pose_.data(), v_.data(), dq, work_.data());
    std::fill(rows_work_.begin(), rows_work_.end(), T(0));
    mechanism_.closures_of(work_.data(), rows_work_.data());
    solve_rows(rows_work_.data(), dv);
    mechanism_.phasor_third(pose_.data(), v_.data(), v_.data(), dq, work_.data());
    mechanism_.phasor_second(pose_.data(), v_.data(), dv, work2_.data());
    for (int t = 0; t < n_; ++t) work_[t] += T(2) * work2_[t];
    mechanism_.phasor_second(pose_.data(), a_.data(), dq, work2_.data());
    for (int t = 0; t < n_; ++t) work_[t] += work2_[t];
    linearize_direction(dq, dv, &a_z_[at], &alpha_z_[at_small]);
    // Along w_k: v' = B_k.
    mechanism_.phasor_second(pose_.data(), v_.data(), dq, work_.data());
    for (int t = 0; t < n_; ++t) work_[t] = T(2) * work_[t];
    linearize_direction(nullptr, dq, &a_w_[at], &alpha_w_[at_small]);
  }
}

template <class T>
void ReducedMotion<T>::add_influence(const Influence& influence, const T* a, const Planar<T>* second, T* g) const {
  if (influence.body < 0) {
    const auto element = static_cast<typename Mechanism<T>::Element>(influence.element);
    mechanism_.add_force_derivative(element, influence.index, static_cast<T>(influence.by), q_.data(), pose_.data(),
                                    v_.data(), g);
    return;
  }
  inertia_.add_body(influence.body,
                    {static_cast<T>(influence.mass), planar_cast<T>(influence.first), static_cast<T>(influence.moment)},
                    pose_.data(), a, second, g);
}

template <class T>
void ReducedMotion<T>::influence(const Influence& influence, T* alpha) const {
  std::fill(full_.begin(), full_.end(), T(0));
  add_influence(influence, a_.data(), second_.data(), full_.data());
  project(full_.data(), alpha);
  for (int j = 0; j < freedoms(); ++j) alpha[j] = -alpha[j];
  divide_by_mass(alpha);
}

template <class T>
void ReducedMotion<T>::accelerate_as(const T* alpha) {
  place_accelerations();
  for (int k = 0; k < freedoms(); ++k) {
    mechanism_.phasor_first(pose_.data(), B(k), work_.data());
    for (int i = 0; i < n_; ++i) {
      a_[i] += alpha[k] * B(k)[i];
      second_[i] += alpha[k] * work_[i];
    }
  }
}

template <class T>
void ReducedMotion<T>::reduced_inertia(int body, const typename Inertia<T>::BodyInertia& part, T* f) const {
  std::fill(full_.begin(), full_.end(), T(0));
  inertia_.add_body(body, part, pose_.data(), a_.data(), second_.data(), full_.data());
  project(full_.data(), f);
}

template <class T>
T ReducedMotion<T>::kinetic_energy() const {
  mechanism_.phasor_first(pose_.data(), v_.data(), work_.data());
  inertia_.weigh(work_.data(), work2_.data());
  T twice(0);
  for (int i = 0; i < n_; ++i) twice += dot(work_[i], work2_[i]) + inertia_.moment(i) * v_[i] * v_[i];
  return twice / 2;
}

template <class T>
T ReducedMotion<T>::power() const {
  std::fill(full_.begin(), full_.end(), T(0));
  mechanism_.add_resistance(pose_.data(), v_.data(), full_.data());
  T power = mechanism_.has_follower_loads() ? mechanism_.follower_power(pose_.data(), v_.data()) : T(0);
  for (int i = 0; i < n_; ++i) power -= v_[i] * full_[i];
  for (int k = 0; k < drives(); ++k) power += drive_force(k) * value(drives_[k], t_, 1);
  return power;
}

template <class T>
std::vector<T> ReducedMotion<T>::stop_values() const {
  std::vector<T> c(mechanism_.constraints());
  mechanism_.constraint(q_.data(), pose_.data(), c.data());
  return {c.begin() + 2 * mechanism_.closures(), c.end()};
}

template <class T>
T ReducedMotion<T>::drive_force(int k) const {
  return -drive_multipliers_[k];
}

}  // namespace poise
