#pragma once

// The parts of the equations of motion in any scalar.

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "model/inertia_impl.hpp"
#include "model/mechanism_impl.hpp"
#include "motion/motion_input_impl.hpp"
#include "motion/private/function_in_time.hpp"

namespace poise {

/// The equations of motion of a scene in all its coordinates q, with the rates v = q', at the time t:
///
///   M(q) v' + k(q, v) + V_q(q) = Q(q, v, t) + J^T (multipliers),   g(q, t) = 0,
///   J v + g_t = 0,   J v' + b = 0,   b = D2g[v, v] + g_tt,
///
/// with the rows g of loop closures, couplings and drives, as ReducedMotion has them. V is the energy of gravity and of
/// everything elastic, Q what forces, torques, dampers, friction and the acceleration of the frame do. All of the
/// scene, and so SI.
template <class T>
class MotionTerms {
 public:
  /// The layout is one of the scene for Purpose::dynamics. Drives without a given start begin at `begin`, coordinates.
  MotionTerms(const Scene& scene, const Layout& layout, const std::vector<double>& begin)
      : whole_(scene, layout, Purpose::dynamics),
        elastic_(without_loads(scene), layout, Purpose::dynamics),
        loads_(loads_alone(scene), layout, Purpose::dynamics),
        inertia_(scene, whole_),
        n_(whole_.coordinates()),
        pose_(static_cast<std::size_t>(whole_.pose_size())),
        elastic_pose_(static_cast<std::size_t>(elastic_.pose_size())),
        loads_pose_(static_cast<std::size_t>(loads_.pose_size())) {
    for (const Drive& drive : scene.drives) {
      drives_.push_back({drive, {scene, whole_.layout(), whole_.phasors(), drive.on}, T(0), nullptr});
    }
    for (const Stop& stop : scene.stops) {
      if (!stop.holds()) continue;
      Drive still;
      still.start = stop.max;
      drives_.push_back({still, {scene, whole_.layout(), whole_.phasors(), stop.on}, T(0), nullptr});
    }
    int scratch = 0;
    for (const Row& row : drives_) scratch = std::max(scratch, row.on.scratch_size());
    scratch_.resize(static_cast<std::size_t>(scratch));
    const std::vector<T> q(begin.begin(), begin.end());
    whole_.place(q.data(), pose_.data());
    for (Row& row : drives_) row.start = row.drive.start ? T(*row.drive.start) : row.on.value(here());
    std::map<int, std::vector<MotionInput>> of_springs;
    for (MotionInput& input : inputs_of(scene)) {
      if (input.of == MotionInput::Of::drive)
        drives_[static_cast<std::size_t>(input.item)].function = input.function;
      else if (input.of == MotionInput::Of::element)
        of_springs[input.item].push_back(input);
      else if (input.of == MotionInput::Of::frame)
        frames_.push_back(input.function);
      else
        time_loads_.emplace_back(input.function, InputLoad<T>(scene, whole_, input));
    }
    for (auto& [element, functions] : of_springs) time_springs_.emplace_back(elastic_, std::move(functions));
    laws_.resize(scene.elements.size(), nullptr);
  }

  int coordinates() const { return n_; }
  int rows() const { return whole_.equalities() + static_cast<int>(drives_.size()); }

  /// Goes to the coordinates q at the time t, which the others are of.
  void place(const T& t, const T* q) {
    t_ = t;
    whole_.place(q, pose_.data());
    elastic_.place(q, elastic_pose_.data());
    loads_.place(q, loads_pose_.data());
    q_.assign(q, q + n_);
  }
  /// g and g_t, rows() values, and J, rows() x coordinates(), row by row.
  void close(T* gap, T* moving, T* jacobian) {
    std::vector<T> all(static_cast<std::size_t>(whole_.constraints()), T(0));
    whole_.constraint(q_.data(), pose_.data(), all.data());
    const int equalities = whole_.equalities();
    std::copy(all.begin(), all.begin() + equalities, gap);
    std::fill(moving, moving + rows(), T(0));
    std::fill(jacobian, jacobian + static_cast<std::ptrdiff_t>(rows()) * n_, T(0));
    const auto entry = [&](int row, int column) -> T& {
      return jacobian[static_cast<std::ptrdiff_t>(row) * n_ + column];
    };
    std::vector<T> values(whole_.jacobian_row().size(), T(0));
    whole_.jacobian(pose_.data(), values.data());
    for (std::size_t e = 0; e < values.size(); ++e) {
      if (whole_.jacobian_row()[e] < equalities)
        entry(whole_.jacobian_row()[e], whole_.jacobian_column()[e]) += values[e];
    }
    for (std::size_t k = 0; k < drives_.size(); ++k) {
      const Row& row = drives_[k];
      const int at = equalities + static_cast<int>(k);
      gap[at] = row.on.value(here()) - target(row, 0);
      moving[at] = -target(row, 1);
      row.on.gradient(here(),
                      [&](int i, const T& by) { entry(at, row.on.support()[static_cast<std::size_t>(i)]) += by; });
    }
  }
  /// M, row by row, k, V_q and Q, and b of each row.
  void forces(const T* v, T* mass, T* velocity, T* potential, T* load, T* bend) {
    const auto n = static_cast<std::size_t>(n_);
    inertia_.mass_matrix(pose_.data(), mass);
    std::vector<Planar<T>> second(n), weighed(n);
    whole_.phasors().second(pose_.data(), v, v, second.data());
    inertia_.weigh(second.data(), weighed.data());
    std::fill(velocity, velocity + n, T(0));
    whole_.phasors().add_projection(pose_.data(), weighed.data(), velocity);
    std::fill(bend, bend + rows(), T(0));
    whole_.closures_of(second.data(), bend);
    for (std::size_t k = 0; k < drives_.size(); ++k) {
      bend[static_cast<std::size_t>(whole_.equalities()) + k] =
          drives_[k].on.second(here(), v, v) - target(drives_[k], 2);
    }
    std::fill(potential, potential + n, T(0));
    elastic_.negative_force(q_.data(), elastic_pose_.data(), potential);
    for (InputSpring<T>& spring : time_springs_) {
      spring.set_values([&](const MotionInput& one) { return in_time(*one.function, t_, 0); });
      spring.add(elastic_pose_.data(), potential);
      laws_[static_cast<std::size_t>(spring.element())] = &spring.law();
    }
    std::vector<T> resisting(n, T(0));
    loads_.negative_force(q_.data(), loads_pose_.data(), resisting.data());
    std::vector<T> resistances(static_cast<std::size_t>(whole_.resistances_size()), T(0));
    whole_.resist(pose_.data(), v, nullptr, resistances.data(), {.laws = laws_.data()});
    whole_.add_resistance(resistances.data(), resisting.data());
    for (auto& [function, time_load] : time_loads_) {
      time_load.set_value(in_time(*function, t_, 0));
      time_load.add(pose_.data(), resisting.data());
    }
    for (const auto& function : frames_) {
      const T along = in_time(*function, t_, function->order);
      whole_.add_frame(function->part == 0 ? Planar<T>{along, T(0)} : Planar<T>{T(0), along}, pose_.data(),
                       resisting.data());
    }
    for (std::size_t i = 0; i < n; ++i) load[i] = -resisting[i];
  }

 private:
  struct Row {
    Drive drive;
    CompiledMeasure<T> on;
    T start{};
    std::shared_ptr<const TimeFunction> function;
  };

  static Scene without_loads(Scene scene) {
    scene.forces.clear();
    scene.torques.clear();
    return scene;
  }
  static Scene loads_alone(Scene scene) {
    scene.gravity = {};
    scene.elements.clear();
    return scene;
  }
  T target(const Row& row, int derivative) const {
    if (row.function) return in_time(*row.function, t_, derivative);
    return (derivative == 0 ? row.start : T(0)) + row.drive.moved(t_, derivative);
  }
  Configuration<T> here() { return {whole_.phasors(), pose_.data(), scratch_.data()}; }

  Mechanism<T> whole_, elastic_, loads_;
  Inertia<T> inertia_;
  int n_;
  std::vector<Row> drives_;
  std::vector<std::pair<std::shared_ptr<const TimeFunction>, InputLoad<T>>> time_loads_;
  std::vector<InputSpring<T>> time_springs_;
  std::vector<const LawIn<T>*> laws_;  // by element, of those that vary
  std::vector<std::shared_ptr<const TimeFunction>> frames_;
  T t_{};
  std::vector<T> q_;
  std::vector<Planar<T>> pose_, elastic_pose_, loads_pose_, scratch_;
};

}  // namespace poise
