#include "motion/reduced_system.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "model/inertia_impl.hpp"
#include "model/mechanism_impl.hpp"
#include "motion/reduced_motion_impl.hpp"

namespace poise {

using ReducedStatus = ReducedMotion<double>::Status;
using Long = long double;

namespace {

/// Relative pivot below which long double is used: 1e-12 rate^2 of an acceleration is uncertain in double.
constexpr double small_pivot = 0.05;

}  // namespace

/// Computes the same motion in long double.
class ReducedSystem::Fine {
 public:
  Fine(const Scene& scene, const ReducedMotion<double>& reduced, const std::vector<Variation>& variations)
      : mechanism_(scene, reduced.layout(), Purpose::dynamics),
        inertia_(scene, mechanism_),
        motion_(scene, mechanism_, inertia_) {
    motion_.set_inputs(scene, reduced.inputs());
    motion_.set_past(reduced.past());
    motion_.set_touching(scene, reduced.touching());
    if (reduced.sliding() != nullptr) {
      const std::vector<Long> q(reduced.q(), reduced.q() + reduced.coordinates());
      motion_.set_sliding(scene, {reduced.sliding(), reduced.sliding() + scene.elements.size()}, q.data());
      motion_.set_branches(reduced.branches());
    }
    motion_.set_variations(variations);
    motion_.take_over(reduced);
    motion_.set_singular_limit(0.0L);
  }

  /// From the pose that `reduced` was placed in.
  bool evaluate(double t, const double* y, const ReducedMotion<double>& reduced) {
    const std::vector<Long> q(reduced.q(), reduced.q() + reduced.coordinates());
    const std::vector<Long> state(y, y + 2 * reduced.freedoms());
    motion_.expect(q.data());
    motion_.set_near(reduced.near());
    return motion_.evaluate(t, state.data(), state.data() + reduced.freedoms()) == ReducedMotion<Long>::Status::ok;
  }

  ReducedMotion<Long>& motion() { return motion_; }

 private:
  Mechanism<Long> mechanism_;
  Inertia<Long> inertia_;
  ReducedMotion<Long> motion_;
};

ReducedSystem::ReducedSystem(const Scene& scene, ReducedMotion<double>& reduced,
                             const std::vector<Influence>& influences, const std::vector<Variation>& variations,
                             int columns)
    : scene_(scene),
      reduced_(reduced),
      influences_(influences),
      variations_(variations),
      columns_(columns),
      freedoms_(reduced.freedoms()),
      alpha_p_(influences.size() * static_cast<std::size_t>(freedoms_)),
      moved_p_(3 * influences.size() * static_cast<std::size_t>(reduced.coordinates())),
      alpha_held_(reduced.held().size() * static_cast<std::size_t>(freedoms_)),
      moved_held_(3 * reduced.held().size() * static_cast<std::size_t>(reduced.coordinates())) {
  reduced_.set_variations(variations);
}

ReducedSystem::~ReducedSystem() = default;

bool ReducedSystem::rates(double t, const double* y, double* dydt) {
  ++evaluations;
  status = reduced_.evaluate(t, y, y + freedoms_);
  if (status != ReducedStatus::ok) return false;
  if (columns_ > 0) reduced_.linearize();
  t_ = t;
  if (reduced_.rank() > 0 && reduced_.pivot() < small_pivot) {
    if (!fine_) fine_ = std::make_unique<Fine>(scene_, reduced_, variations_);
    if (fine_->evaluate(t, y, reduced_)) {
      if (columns_ > 0) fine_->motion().linearize();
      fill(fine_->motion(), y, dydt);
      return true;
    }
  }
  fill(reduced_, y, dydt);
  return true;
}

template <class T>
void ReducedSystem::fill(ReducedMotion<T>& motion, const double* y, double* dydt) {
  const int f = freedoms_;
  const auto alpha = [&](const T* values, int j) { return static_cast<double>(values[j]); };
  std::copy(y + f, y + 2 * f, dydt);
  for (int j = 0; j < f; ++j) dydt[f + j] = alpha(motion.alpha(), j);
  dydt[2 * f] = static_cast<double>(motion.power());
  if (columns_ == 0) return;
  const auto act = [&](const Influence& influence, double* own, double* moved) {
    if constexpr (std::is_same_v<T, double>) {
      motion.influence(influence, own);
    } else {
      std::vector<T> by(static_cast<std::size_t>(f));
      motion.influence(influence, by.data());
      for (int j = 0; j < f; ++j) own[j] = alpha(by.data(), j);
    }
    if (!influence.moves()) return;
    for (const T* part : {motion.q_p(), motion.v_p(), motion.a_p()}) {
      for (int i = 0; i < motion.coordinates(); ++i) *moved++ = static_cast<double>(part[i]);
    }
  };
  const auto n = static_cast<std::size_t>(motion.coordinates());
  for (std::size_t p = 0; p < influences_.size(); ++p) {
    act(influences_[p], alpha_p_.data() + p * static_cast<std::size_t>(f), &moved_p_[3 * p * n]);
  }
  const std::size_t held = motion.held().size();
  for (std::size_t h = 0; h < held; ++h) {
    Influence value;
    value.drive = motion.drives() - static_cast<int>(held - h);
    act(value, alpha_held_.data() + h * static_cast<std::size_t>(f), &moved_held_[3 * h * n]);
  }
  // Rows of all columns, so that the innermost loops run along memory.
  const int columns = columns_;
  const int start = columns - static_cast<int>(influences_.size());
  const double* dz = y + 2 * f + 1;
  const double* dw = dz + f * columns;
  double* out = dydt + 2 * f + 1;
  std::copy(dw, dw + f * columns, out);
  out += f * columns;
  for (int j = 0; j < f; ++j, out += columns) {
    std::fill(out, out + start, 0.0);
    for (int c = start; c < columns; ++c) out[c] = alpha_p_[static_cast<std::size_t>((c - start) * f + j)];
    for (std::size_t h = 0; h < held; ++h) {
      const double by_value = alpha_held_[h * static_cast<std::size_t>(f) + static_cast<std::size_t>(j)];
      for (int c = 0; c < columns; ++c) out[c] += by_value * held_by(h)[c];
    }
    for (int k = 0; k < f; ++k) {
      const double by_z = alpha(motion.alpha_z(k), j);
      const double by_w = alpha(motion.alpha_w(k), j);
      if (by_z == 0.0 && by_w == 0.0) continue;  // as of most states of controllers
      const double* z = dz + k * columns;
      const double* w = dw + k * columns;
      for (int c = 0; c < columns; ++c) out[c] += by_z * z[c] + by_w * w[c];
    }
  }
  if (motion.past() == nullptr) return;
  const double near = std::isnan(motion.near()) ? t_ : motion.near();
  for (const TorquesOfPast::Change& change : motion.past()->changes_at(t_, near)) {
    const auto k = std::find(motion.independent().begin(), motion.independent().end(), change.coordinate);
    double* row = dydt + 2 * f + 1 + (f + (k - motion.independent().begin())) * columns;
    for (int c = 0; c < columns; ++c) row[c] += change.by[static_cast<std::size_t>(c)];
  }
}

}  // namespace poise
