#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "identification/experiment/experiment.hpp"
#include "identification/experiment/scene_parameter.hpp"
#include "identification/prediction/input_errors.hpp"
#include "identification/prediction/static_run.hpp"
#include "motion/simulate.hpp"
#include "statics/model/mobility.hpp"

namespace poise {

class VariedQuantity;

/// Predicted readings of a run and their derivatives by its unknowns.
struct Prediction {
  bool ok = false;
  std::string why;               ///< where the motion could not be computed
  std::vector<double> reading;   ///< sensor after sensor, the values at its times, SI
  std::vector<double> jacobian;  ///< columns() values per reading: d reading / d(unknowns, nuisances), SI
};

/// One run of an experiment as a function of its unknowns:
///   the numbers of the scene that this run depends on, those of its sensors, then its nuisances: the equilibrium pose
///   where the run has an unknown one, the f initial independent coordinates, the f initial independent rates (all SI).
///
/// A reading is predicted as the sensor's zero and factor as written (z, f) turn the column into its quantity:
///   z + f column,  column = (g(t - d) - z') / f',
/// with zero z', factor f' and delay d, which may be unknown, so that the noise is that of the column. Before time 0
/// the mechanism is_held(), or the readings are left out (compared_times()); for delays beyond their range, which only
/// trial steps have, the motion goes on from its ends at constant rates.
///
/// An equilibrium pose z_e sets one more number of the scene, a free length L say: the acceleration from rest, under
/// the inputs at time 0, is zero, alpha(z_e, L, p) = 0, so that  dL/dz_e = -alpha_z/alpha_L,  dL/dp = -alpha_p/alpha_L.
///
/// Numbers that change the geometry, or gravity, are differentiated in dual numbers (Variation). A known start is that
/// of the run as it is written, sought again in the changed mechanism: what it leaves open stays as in the scene as it
/// is written, and so do drives without a start. Values at which it cannot be assembled have no prediction.
///
/// The i-th reading of a sensor of impacts is the time of the i-th of the motion, which may go on beyond the run's end
/// for it; a motion without it has no prediction.
///
/// A run at rest (StaticRun) has no nuisances and no motion: what is said of that below is none, empty or zero. Its
/// rows take the place of times.
class RunModel {
 public:
  /// `numbers`: those of the scene that are unknown in this run, `sensor_numbers`: those of its sensors. Throws
  /// InputError where the run cannot be set up.
  RunModel(const Experiment& experiment, std::size_t run, std::vector<SceneParameter> numbers,
           std::vector<SensorNumber> sensor_numbers = {});

  int unknowns() const { return static_cast<int>(numbers_.size() + sensor_numbers_.size()); }
  int nuisances() const { return (equilibrium_unknown_ ? 1 : 0) + (start_unknown_ ? 2 * freedoms_ : 0); }
  int columns() const { return unknowns() + nuisances(); }
  int sensors() const { return static_cast<int>(experiment_.sensors.size()); }
  int freedoms() const { return freedoms_; }
  /// That the closures leave where the run starts, without its drives.
  const Freedoms& mobility() const { return mobility_; }
  const Run& run() const { return run_; }
  bool is_at_rest() const { return at_rest_ != nullptr; }
  /// "the motion", "the equilibria", for messages.
  const char* computed() const { return is_at_rest() ? "the equilibria" : "the motion"; }
  /// The first unknowns.
  const std::vector<SceneParameter>& numbers() const { return numbers_; }
  /// The ones after these.
  const std::vector<SensorNumber>& sensor_numbers() const { return sensor_numbers_; }
  /// The scene of this run with its known changes, SI.
  const Scene& scene() const { return scene_; }
  /// A change of a number over which the mechanism changes considerably, SI: the mechanism's size, its gravity, of any
  /// other number its own size, at least 1.
  double reach(const SceneParameter& number) const;
  /// Size of the mechanism, m.
  double size() const { return size_; }
  /// Names of the nuisances: "equilibrium", "start obd", "start rate obd".
  std::vector<std::string> nuisance_names() const;
  std::vector<Dimension> nuisance_dimensions() const;

  /// Values of the scene and its sensors as they are written, and nuisances as the run is released.
  std::vector<double> scene_values() const;
  std::vector<double> released() const;
  /// Per sensor: the times of its readings, of the record or of the simulated run; empty where it is not read.
  const std::vector<std::vector<double>>& times() const { return times_; }
  /// Number of readings of each sensor up to the time `until`, s.
  std::vector<std::size_t> counts(double until) const;
  /// Number of readings of all sensors together up to the time `until`, s.
  std::size_t readings(double until) const;
  /// Time of the last reading, s.
  double span() const;
  /// Readings of the run that are not compared (see compared_times()).
  std::size_t left_out() const { return left_out_; }
  /// Readings at rest that at_rest_once() leaves out.
  std::size_t repeated() const { return repeated_; }

  /// Predicts the readings up to the time `until`, s; with the Jacobian where asked. `accuracy` as of simulate(), and
  /// `interrupt`, where there is one: there is no prediction where it is set before the motion ends.
  void predict(const double* unknowns, const double* nuisances, double until, double accuracy, bool jacobian,
               Prediction& out, const std::atomic<bool>* interrupt = nullptr) const;
  /// The motion behind a prediction.
  Motion move(const double* unknowns, const double* nuisances, double duration, double accuracy,
              bool sensitivities) const;

  /// What the noise of inputs does to the readings of a motion, none where no input has noise, or the motion fails. In
  /// between times of readings and steps of the integrator derivatives of accelerations are taken as their mean.
  std::shared_ptr<const InputErrors> input_errors(const double* unknowns, const double* nuisances,
                                                  double accuracy) const;

  /// A state of this run: all coordinates and rates, SI.
  struct State {
    double t = 0.0;
    std::vector<double> q, v;
  };

  /// What readings say of a motion at one time: independent coordinates, their rates and accelerations, SI.
  struct ReadState {
    double t = 0.0;
    std::vector<double> z, w, a;
  };
  /// At `count` times, those of smoothing splines through the readings of angles and travels. Empty unless these
  /// tell all independent coordinates. Of the unknowns, the numbers of the sensors count.
  std::vector<ReadState> states_from_readings(const double* unknowns, const Record& record, std::size_t count) const;
  /// The accelerations alpha that the equations of motion have at these coordinates and rates, at ascending times, in
  /// SI, a row for each; under an equilibrium that is unknown at that of the run as it is written. Empty where the
  /// mechanism cannot take such a state.
  Eigen::MatrixXd accelerations(const double* unknowns, const std::vector<ReadState>& states) const;

  /// How the unknowns act at single states (t, z, w) of this run, whatever led there. Each state has rows
  ///   d alpha/d(unknown)  at fixed z, w, of each degree of freedom,
  ///   d(quantity - what the sensor's numbers add)/d(unknown)  at fixed z, w, of each sensor that is read,
  /// exact to rounding. Where a direction of the unknowns is in the null space of the rows of all states, it changes no
  /// motion and no reading of this run. (A number that an equilibrium sets follows the unknowns.)
  /// A time at which a load jumps has further rows: by how much d w/d(time) jumps there.
  /// A run at rest has rows of its sensors at its own inputs and at random ones, and no states.
  struct Actions {
    int rows_per_state = 0;  ///< degrees of freedom, then the sensors that are read
    Eigen::MatrixXd rows;    ///< per unknown, SI, alpha in the units of the scaled scene; none where there is no motion
    Eigen::MatrixXd again;   ///< the same where all numbers of the scene and the states are changed in their last bits
    Eigen::MatrixXd error;   ///< of the rows: what rounding of the terms whose sums they are may make
    /// d(reading)/d(time) of the rows, of both: a start that is estimated can make up for it, the same part of it in
    /// all rows. Empty where the start is known, time acts on the motion, or no delay is unknown.
    Eigen::VectorXd rate, rate_again;
    bool has_impacts = false;   ///< some rows are of impacts
    Scene scene;                ///< of the rows, SI
    std::vector<State> states;  ///< of the rows
  };
  /// At up to `states` random states and at some of the run's own motion from these nuisances.
  Actions actions(const double* unknowns, const double* nuisances, int states) const;

  /// At most `most` states of the motion from these nuisances.
  std::vector<State> states(const double* unknowns, const double* nuisances, std::size_t most) const;
  /// The accelerations alpha, in the units of the scaled scene, and the readings of the sensors that are read, less
  /// what is the same with all unknowns, at independent coordinates and rates as of these states; a row for each of
  /// them. Empty where the mechanism cannot take such a state.
  Eigen::MatrixXd responses(const double* unknowns, double equilibrium, const std::vector<State>& states) const;

  /// Reduced mass M, stiffness K and damping C at the equilibrium pose for one degree of freedom: small oscillations
  /// obey  M z'' + C z' + K z = 0.
  struct Oscillator {
    double mass = 0.0, stiffness = 0.0, damping = 0.0;
    double z = 0.0;        ///< the independent coordinate there
    double reading = 0.0;  ///< of the first sensor there; not set where that is not read in this run
    double reading_by_z = 0.0, equilibrium_by_z = 0.0;
  };
  /// The small motion about that equilibrium; its mass is 0 where there is none.
  Oscillator oscillator(const double* unknowns, double equilibrium) const;
  /// Undamped natural frequencies of small motions, Hz, ascending, one per degree of freedom:  sqrt(eigenvalues of
  /// -dalpha/dz) / 2 pi  without rates, in the equilibrium pose where the run has one, else at the independent
  /// coordinates `pose`, SI. 0 where nothing restores the pose. Empty where there is no such pose.
  std::vector<double> natural_frequencies(const double* unknowns, double equilibrium,
                                          const std::vector<double>& pose) const;
  /// Equilibrium of the run as it is written: value of the coordinate of its EquilibriumPose, SI.
  double equilibrium_at() const { return run_.equilibrium ? run_.equilibrium->at : 0.0; }
  bool has_equilibrium() const { return run_.equilibrium.has_value(); }
  /// Loads or drives follow time: inputs of the run, functions of the scene.
  bool has_inputs() const { return !run_.inputs.empty() || !scene_.time_functions.empty(); }
  bool equilibrium_is_unknown() const { return equilibrium_unknown_; }
  bool start_is_unknown() const { return start_unknown_; }
  /// The f initial independent coordinates with these nuisances.
  std::vector<double> start_of_run(const std::vector<double>& nuisances) const;
  /// Indices of the independent coordinates.
  const std::vector<int>& independent() const { return independent_; }
  /// Initial independent coordinates and rates guessed from the first readings; the release where the sensors do not
  /// determine them. Of the unknowns, the numbers of the sensors count.
  std::vector<double> start_from_readings(const double* unknowns, const Record& record) const;

 private:
  /// One coordinate of a known start, or its rate.
  struct StartPart {
    StartValue value;
    std::optional<Measure> on;      // of which it is the value, where the coordinate differs from that by an angle
    bool from_equilibrium = false;  // counted from the equilibrium pose
  };
  struct Built {                               // the run's model at given values
    std::shared_ptr<const MotionModel> model;  // none where it cannot be assembled, or has no such equilibrium
    std::string why;
    std::vector<double> q;              // a closed pose, SI: the equilibrium pose, if it has one
    MotionState start;                  // the known start
    std::vector<Influence> influences;  // of the numbers, then of the one that the equilibrium sets
    std::vector<Variation> variations;  // of the geometric numbers
    std::vector<double> released_by;    // derivatives of the known start, 2 f values per number
    double set_by_at = 0.0;             // of the one that the equilibrium sets, by the equilibrium's coordinate
    std::vector<double> set_by;         // and by the numbers
  };
  /// Inputs are those of the run; the others are the functions of time of the scene, in SI.
  std::vector<MotionInput> inputs_in(const Scene& scene) const { return with_inputs_of(scene, inputs_); }
  bool sets_numbers(const double* unknowns, Scene& scene, std::string& why) const;
  Built build(const double* unknowns, double equilibrium, bool derivatives) const;
  std::shared_ptr<const MotionModel> balance(const MotionModel& model, double equilibrium, bool derivatives,
                                             Built& out) const;
  void vary(const std::shared_ptr<const MotionModel>& model, Built& out) const;
  void vary_start(const MotionModel& model, const std::vector<double>& assembled, Built& out) const;
  void refuse_what_opens_loops(const MotionModel& model, const Built& built) const;
  void refuse_start_across_blades() const;
  void rest(const Experiment& experiment, std::size_t run);
  void predict_at_rest(const double* unknowns, double until, bool jacobian, Prediction& out,
                       const std::atomic<bool>* interrupt) const;
  Actions actions_at_rest(const double* unknowns, int loads) const;
  void take_inputs();
  VaryingNumbers varying_numbers() const;
  std::unique_ptr<const MotionModel> assemble();
  void start_drives_in(const MotionModel& model);
  void choose_coordinates(const MotionModel& assembled);
  void release(const MotionModel& assembled);
  void take_times(std::size_t run);
  MotionState released_in(const MotionModel& model, std::vector<double> q) const;
  MotionState start_in(const MotionModel& model, const std::vector<StartPart>& parts,
                       const std::vector<double>& q) const;
  std::vector<StartPart> start_parts(const MotionModel& model, const std::vector<double>& q) const;
  std::vector<double> independent_of(const MotionState& state) const;
  StartValue equilibrium_in(const MotionModel& model, double at) const;
  MotionState begin(const Built& built, const double* nuisances) const;
  Motion move(const Built& built, const double* nuisances, double duration, double accuracy, bool sensitivities,
              const std::atomic<bool>* interrupt) const;
  struct Scaling {  // of the readings of a sensor: zero', factor', delay
    double zero, factor, delay;
  };
  std::vector<Scaling> scalings(const double* unknowns) const;
  /// The impacts that a sensor reads the times of, each time once, up to where bounces have come to rest.
  struct ImpactsRead {
    std::vector<const ContactEvent*> impacts;
    const ContactEvent* rest = nullptr;  // the end of infinitely many, of which small ones are left out
    double ratio = 0.0;                  // of the times between the last ones

    bool has(std::size_t count) const { return impacts.size() >= count || (rest != nullptr && !impacts.empty()); }
    const ContactEvent& at(std::size_t i) const { return *impacts[std::min(i, impacts.size() - 1)]; }
    double time(std::size_t i) const;
  };
  static ImpactsRead impacts_at(const Scene& scene, const Sensor& sensor, const Motion& motion);
  std::vector<double> simulated_impacts(const Sensor& sensor) const;
  /// Says which sensor has read more impacts, up to the time `until`, than a motion has; empty if none.
  std::string lacks_impacts(double until, const Motion& motion) const;
  VariedQuantity quantity_of(std::size_t sensor, const std::shared_ptr<const MotionModel>& model,
                             bool derivatives) const;
  struct Reading {
    double time;
    std::size_t sensor, at;  // index into times_[sensor]
  };
  std::vector<Reading> due(const std::vector<Scaling>& scalings, double until) const;
  /// What the sensors read along one motion.
  class Readings;
  class ActionRows;
  void fill_row(const Built& built, std::size_t k, const Scaling& own, double gain, double quantity, double change,
                const std::vector<double>& by, double* to) const;
  bool is_exact(std::size_t sensor) const;
  void add_first_readings(const MotionModel& model, const ReducedMotion<double>& reduced,
                          std::vector<StartPart>& start) const;
  void complete_start(const MotionModel& model, const MotionState& state);
  static double turn_by(const Variation& variation, int body);
  static StartValue coordinate_at(const MotionModel& model, int body, int joint, int line, double value);

  const Experiment& experiment_;
  const Run& run_;
  Scene scene_;
  std::vector<SceneParameter> numbers_;
  std::vector<SensorNumber> sensor_numbers_;
  std::vector<MotionInput> inputs_;  // of the run
  std::optional<SceneParameter> set_by_equilibrium_;
  Scales scales_;
  double size_ = 1.0;           // of the mechanism, m
  VaryingNumbers varying_;      // geometric ones
  std::vector<double> closed_;  // a closed pose, SI
  std::vector<int> independent_;
  int freedoms_ = 0;
  Freedoms mobility_{};
  bool repeats_joints_ = false;  // rows of closures and drives repeat others
  bool equilibrium_unknown_ = false, start_unknown_ = true;
  int equilibrium_coordinate_ = -1;
  std::vector<std::vector<double>> times_;
  std::vector<Reading> readings_;  // of all sensors, in the order of time
  std::size_t left_out_ = 0, repeated_ = 0;
  double end_ = 0.0;  // to which the motion may have to be known, s
  bool reads_impacts_ = false;
  bool delayed_ = false;  // the delay of a sensor is unknown or not zero
  bool held_ = false;     // until time 0
  std::vector<double> released_;
  std::vector<StartValue> completed_;         // what the start leaves open
  const Record* first_readings_ = nullptr;    // of a known start of measured data
  std::shared_ptr<const StaticRun> at_rest_;  // of a run at rest
};

}  // namespace poise
