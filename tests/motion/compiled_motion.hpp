#pragma once

// Templates of a mechanism in motion, for scalars that Poise does not instantiate: slow to compile.

#include <vector>

#include <gtest/gtest.h>

#include "model/inertia_impl.hpp"
#include "model/mechanism_impl.hpp"
#include "motion/motion_model.hpp"
#include "motion/reduced_motion_impl.hpp"
#include "statics/model/mobility.hpp"
#include "tests/support/random_mechanism.hpp"

namespace poise::test {

/// A scene compiled in T, SI, placed and moved.
template <class T>
struct Compiled {
  explicit Compiled(const Scene& given)
      : scene(given),
        mechanism(scene, Purpose::dynamics),
        inertia(scene, mechanism),
        motion(scene, mechanism, inertia) {}

  Scene scene;
  Mechanism<T> mechanism;
  Inertia<T> inertia;
  ReducedMotion<T> motion;
};

/// Where a mechanism is: the time, a closed pose near by, independent coordinates and their rates.
template <class T>
struct State {
  T t{};
  std::vector<T> q, z, w;
};

/// Drives begin where `drives_start` stands; coordinates are chosen at the state's q.
template <class T>
void start(Compiled<T>& m, const std::vector<double>& drives_start, const State<T>& state) {
  const std::vector<T> q0(drives_start.begin(), drives_start.end());
  m.motion.start_drives(q0.data());
  ASSERT_EQ(m.motion.choose(state.t, state.q.data(), false), ReducedMotion<T>::Status::ok);
  m.motion.expect(state.q.data());
}

/// Places, moves and accelerates; false where that cannot be done.
template <class T>
bool evaluate(Compiled<T>& m, const State<T>& state) {
  using Status = typename ReducedMotion<T>::Status;
  if (m.motion.place(state.t, state.z.data()) != Status::ok) return false;
  m.motion.move(state.w.data());
  return m.motion.accelerate() == Status::ok;
}

/// Loops closed from the scene's start, SI.
inline std::vector<double> closed_pose(const Scene& scene) {
  const MotionModel model(scene);
  return model.to_si(close_loops(model));
}

/// A state some tenths of rad and m from the closed pose q0, in which the loops still close well.
inline State<double> random_state(const Scene& scene, const std::vector<double>& q0, Random& random) {
  Compiled<double> m(scene);
  for (double reach = 0.4;; reach *= 0.9) {
    State<double> state{random.uniform(0.0, 0.5), q0, {}, {}};
    start(m, q0, state);
    for (int i : m.motion.independent()) {
      state.z.push_back(q0[i] + random.uniform(-reach, reach));
      state.w.push_back(random.uniform(-2.0, 2.0));
    }
    if (!evaluate(m, state) || (m.motion.rank() > 0 && m.motion.pivot() < 0.02)) continue;
    state.q.assign(m.motion.q(), m.motion.q() + q0.size());
    return state;
  }
}

}  // namespace poise::test
