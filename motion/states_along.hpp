#pragma once

#include <memory>
#include <vector>

#include "motion/simulate.hpp"
#include "motion/trajectory.hpp"

namespace poise {

/// Scaled coordinates of a model, their rates (per s) and accelerations (per s^2).
struct MovingState {
  std::vector<double> x, v, a;
};

/// States of a simulated motion at its times. Between the steps of the integrator coordinates and rates are those of
/// TrajectoryReader, the dependent ones closed; accelerations are those of the equations of motion there. Near singular
/// poses and where something in the scene can stick, or a stop is touched, all three are those of its polynomials. One
/// object per thread: it holds the last state.
class StatesAlong {
 public:
  /// Both must outlive this; the motion has two nodes at least.
  StatesAlong(const MotionModel& model, const Motion& motion);
  ~StatesAlong();

  /// Where something jumps, after the jump. Valid until the next call; fastest at ascending times.
  const MovingState& at(double t);
  /// What the polynomials alone give, SI, n values each.
  struct Reading {
    std::vector<double> q, v;
  };
  const Reading& read(double t);
  /// The fastest rate of a scaled coordinate at the nodes.
  double fastest() const { return fastest_; }

 private:
  class Equations;

  const MotionModel& model_;
  const Trajectory& path_;
  TrajectoryReader reader_;
  std::unique_ptr<Equations> equations_;  // none where something can stick
  double fastest_ = 0.0;
  double at_;
  Reading reading_;
  MovingState state_;
};

}  // namespace poise
