#pragma once

#include <cstddef>
#include <vector>

#include "motion/motion_step.hpp"
#include "motion/sensitivity_columns.hpp"

namespace poise {

/// Writes the nodes of a motion, and keeps what steps need to know of those before. Private to simulate().
class MotionWriter {
 public:
  /// All must outlive this; `q_start` in the units of the model.
  MotionWriter(const MotionModel& model, const SensitivityColumns& columns, const std::vector<double>& q_start,
               Motion& out);

  /// Adds the node at t, to which `reduced` is evaluated with the state of `step`.
  void add(double t, const ReducedMotion<double>& reduced, const MotionStep& step);
  /// Takes the last node away.
  void drop();

  std::size_t nodes() const { return out_.trajectory.nodes(); }
  const std::vector<double>& times() const { return out_.trajectory.t; }
  /// Pivots of all nodes.
  const std::vector<double>& pivots() const { return pivot_; }
  /// Largest distance of a coordinate from the start at any node, and its largest rate.
  double reach(std::size_t coordinate) const { return reach_[coordinate]; }
  double speed(std::size_t coordinate) const { return speed_[coordinate]; }
  /// Kinetic and potential energy at the last node, and the largest energy exchanged yet, in the units of the model.
  double energy() const { return energy_; }
  double exchanged() const { return exchanged_; }

  /// One coordinate at a node, in the units of the model.
  NodeValues at(std::size_t node, std::size_t coordinate) const;
  /// Its acceleration at the last one.
  double acceleration(std::size_t coordinate) const { return at(nodes() - 1, coordinate).a; }
  /// Derivatives of the coordinates, or of their rates, at the last node by a column, in the units of the model.
  void read_places_by(std::size_t column, std::vector<double>& out) const { read(out_.trajectory.q_p, column, out); }
  void read_rates_by(std::size_t column, std::vector<double>& out) const { read(out_.trajectory.v_p, column, out); }
  /// Sets the sensitivities in the state of a step, whose coordinates are chosen anew, to those at the last node.
  void read_sensitivities(const ReducedMotion<double>& reduced, MotionStep& step) const;

  /// The motion is smooth from the last node on, and with `piece` accelerations jump there: no polynomial goes through.
  void begin_smooth() { smooth_from_ = nodes() - 1; }
  void begin_piece() { smooth_from_ = piece_from_ = nodes() - 1; }
  std::size_t smooth_from() const { return smooth_from_; }  ///< node at the last break, or where the piece begins
  std::size_t piece_from() const { return piece_from_; }    ///< node at the last event

 private:
  void add_energies(const ReducedMotion<double>& reduced, const MotionStep& step);
  void add_sensitivities(const MotionStep& step);
  void read(const std::vector<double>& by, std::size_t column, std::vector<double>& out) const;

  const MotionModel& model_;
  const SensitivityColumns& columns_;
  const std::vector<double>& unit_;
  const std::vector<double>& q_start_;
  Motion& out_;
  std::size_t n_;
  MotionStep::Changes changes_;
  std::vector<double> reach_, speed_;
  std::vector<double> pivot_;
  double energy_ = 0.0, exchanged_ = 0.0;
  std::size_t smooth_from_ = 0, piece_from_ = 0;
};

}  // namespace poise
