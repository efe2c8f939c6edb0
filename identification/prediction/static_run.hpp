#pragma once

#include <atomic>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "identification/experiment/experiment.hpp"
#include "identification/experiment/scene_parameter.hpp"
#include "statics/quantities/quantity.hpp"

namespace poise {

/// The equilibria of a run at rest. In each row the scene has the row's numbers, and drives that are inputs hold their
/// measures; what is read is that of the equilibrium in which the mechanism settles from the scene's start, which a
/// certificate proves. Positions that drives hold are reached from there in small steps, so that they keep the branch
/// of assembly. Friction, dampers and drives that are no inputs do not act.
///
/// For a sensor of loads at which it slips the mechanism stands where it is assembled, or where its drives have put it,
/// and friction alone holds it there: the end of held_range() that the load comes to as it grows or falls. A load
/// that is negative in the scene grows in size.
class StaticRun {
 public:
  /// `scene`: that of the run with its known changes, SI. Throws InputError where it cannot be assembled.
  StaticRun(const Experiment& experiment, std::size_t run, const Scene& scene);

  /// The sensors that are read, ascending.
  const std::vector<std::size_t>& sensors() const { return sensors_; }
  /// Values of the inputs in a row from 0, in the scene's units.
  std::vector<double> inputs(std::size_t row) const;
  /// Values of inputs at random: from the least to the largest of the rows, or where these are alike within half of
  /// their size. Empty where there are no inputs.
  std::vector<double> random_inputs(std::uint64_t index) const;

  /// Quantities of the sensors() in one row and their derivatives by numbers of the scene, SI: exact but those of loads
  /// at which it slips, which are differences of fourth order.
  struct Row {
    std::string why;        ///< one sentence; there is no such equilibrium, or it has no derivatives
    Eigen::VectorXd value;  ///< per sensor
    Eigen::MatrixXd by;     ///< sensors x numbers
    Eigen::MatrixXd error;  ///< of these: what two steps differ by

    bool ok() const { return why.empty(); }
  };
  /// Of the scene with these inputs; `scene` has the values of the numbers.
  Row read(const Scene& scene, const std::vector<double>& inputs, const std::vector<SceneParameter>& numbers,
           const std::atomic<bool>* interrupt) const;
  /// Predicts all rows in their order, from the first to `last`; those with the same inputs are computed once. It ends
  /// behind the first that is not ok().
  std::vector<Row> read(const Scene& scene, const std::vector<SceneParameter>& numbers, std::size_t last,
                        const std::atomic<bool>* interrupt) const;

 private:
  Scene with(Scene scene, const std::vector<double>& inputs) const;
  std::vector<double> start_of(const Scene& held) const;
  std::optional<double> slips_at(const Sensor::SlipLoad& load, const Scene& scene, const std::vector<double>& inputs,
                                 std::string& why) const;
  void read_slips(const Scene& scene, const std::vector<double>& inputs, const std::vector<SceneParameter>& numbers,
                  Row& out) const;

  const Run& run_;
  std::vector<std::size_t> sensors_;
  std::vector<SoughtQuantity> quantities_;  // of those of them that read an equilibrium
  std::vector<Eigen::Index> at_;            // the places of these among the sensors
  struct SlipSensor {
    Eigen::Index at;
    Sensor::SlipLoad load;
  };
  std::vector<SlipSensor> slips_;  // the others
  bool drives_ = false;            // some input is a drive
};

}  // namespace poise
