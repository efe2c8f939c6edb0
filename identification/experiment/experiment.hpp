#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "identification/experiment/plan_limits.hpp"
#include "identification/experiment/record.hpp"
#include "identification/experiment/weighting.hpp"
#include "model/parameter_change.hpp"
#include "model/scene.hpp"
#include "motion/motion_input.hpp"
#include "statics/quantities/quantity.hpp"

namespace poise {

/// A number of a sensor, "sensor.NAME.zero", ".factor" or ".delay", that stands in place of one of the scene.
struct SensorNumber {
  enum class Of { zero, factor, delay };
  std::size_t sensor = 0;  ///< index into Experiment::sensors
  Of of = Of::zero;
};

/// A sensor reads a measure of the pose or a derivative of it by time, the force of an element of the scene, what an
/// accelerometer feels, or another quantity; values SI. At time t its column has
///   (g(t - delay) - zero) / unit,  g the quantity.
/// A delay means nothing at rest.
/// One of impacts reads the times T_1 < T_2 < ... of those at some limits of stops:  (T_i - zero) / unit.
struct Sensor {
  /// The load at which a mechanism that friction holds slips as it grows, or falls, from what the scene gives.
  struct SlipLoad {
    std::string path;  ///< "load.P"
    bool falling = false;
    Dimension dimension{};

    bool operator==(const SlipLoad&) const = default;
  };
  Measure on;                ///< body_a is the ground for an absolute angle
  int element = -1;          ///< index into Scene::elements whose static force it reads, tension positive; else -1
  std::vector<int> stops{};  ///< indices into Scene::stops whose impacts it reads the times of; else none
  /// An accelerometer at the point on.b of a body reads  e . (a - g):  a its acceleration, g gravity, e the unit vector
  /// at this angle from the x axis of the body; else none.
  std::optional<double> axis{};
  std::optional<SlipLoad> slips{};                      ///< whose value it reads, at rest; else none
  std::optional<SoughtQuantity> quantity{};             ///< what else it reads
  bool quantity_rests = false, quantity_moves = false;  ///< of mechanisms at rest, and of those that move
  std::string name;
  std::string column;  ///< of a data file
  bool gaps = false;   ///< empty cells and NaN of the column mean that it was not read at that time
  std::optional<std::vector<double>> missing{};  ///< numbers of the column that mean the same; absent: none is expected
  std::optional<double>
      wraps{};              ///< the column starts again after so much, SI; 0: it does not; absent: expected not to
  int by_time = 0;          ///< the derivative of the measure by time of this order, at most 2; no other has one
  double noise = 0.0;       ///< standard deviation of one reading, SI
  bool noise_known = true;  ///< false: `noise` is a first guess from the readings, and a fit estimates it
  double unit = 1.0;        ///< SI value of one unit of the file's column
  double zero = 0.0;        ///< SI value of the quantity where the column reads 0:  quantity = zero + unit column
  double delay = 0.0;       ///< s
  double least_delay = 0.0, most_delay = 0.0;  ///< that a fit may try; where it is known, that
  int line = 0;

  bool reads_force() const { return element >= 0; }
  bool reads_impacts() const { return !stops.empty(); }
  bool is_accelerometer() const { return axis.has_value(); }
  /// Whether it reads its measure itself, or a derivative of that by time.
  bool is_of_measure() const {
    return !reads_force() && !reads_impacts() && !is_accelerometer() && !quantity && !slips;
  }
  bool reads_measure() const { return is_of_measure() && by_time == 0; }
  bool reads_rate() const { return is_of_measure() && by_time == 1; }
  bool reads_acceleration() const { return is_accelerometer() || by_time == 2; }
  /// Whether a mechanism at rest has what it reads, and whether one that moves has.
  bool is_of_rest() const {
    return quantity ? quantity_rests : !reads_impacts() && !is_accelerometer() && by_time == 0;
  }
  bool is_of_motion() const { return !slips && (!quantity || quantity_moves); }
  /// Whether it reads an angle itself, not its rate or an effort.
  bool reads_angle() const { return on.is_angle() && reads_measure(); }
  /// Whether it reads what may be a coordinate: an angle or the travel of a joint.
  bool reads_coordinate() const { return (on.is_angle() || on.kind == Measure::Kind::travel) && reads_measure(); }
  /// Of a reading.
  Dimension dimension() const {
    if (reads_impacts()) return dimension::time;
    if (quantity) return quantity->dimension;
    if (slips) return slips->dimension;
    if (is_accelerometer()) return dimension::length * dimension::time.power(-2);
    const Dimension read = reads_force() ? on.effort_dimension() : on.dimension();
    return read * dimension::time.power(-by_time);
  }
  /// Of one of its numbers.
  Dimension dimension(SensorNumber::Of of) const {
    return of == SensorNumber::Of::delay ? dimension::time : dimension();
  }
  double number(SensorNumber::Of of) const {
    return of == SensorNumber::Of::zero ? zero : of == SensorNumber::Of::factor ? unit : delay;
  }
};

/// A number of the scene or of a sensor that is to be estimated, by its path (see model/set_value): SI throughout. What
/// is said below of the scene's value is said of the sensor's too.
struct Unknown {
  std::string path;                       ///< "spring.oil.stiffness", "sensor.angle.zero"
  std::optional<SensorNumber> of_sensor;  ///< absent: a number of the scene
  std::string name;                       ///< for tables; the path where none was given
  std::string per;    ///< "" one value for all runs; "run" one for each; else a label: one for each of its values
  double unit = 1.0;  ///< SI value of the unit in which the file gives it
  double includes =
      0.0;  ///< shown value = value in the scene + includes, the part of a lumped parameter that other bodies hold
  // The following are about the shown value.
  std::optional<double> start;  ///< absent: the scene's value + includes
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  std::optional<double> prior;  ///< prior knowledge: mean, with the standard deviation prior_deviation
  double prior_deviation = 0.0;
  std::optional<double> scale;  ///< a change of this size matters: standard errors are judged by it
  std::size_t part = 0;         ///< of the experiment, whose scene has the path; unknowns of one name are one number
  int line = 0;
};

/// A number of the scene or of a sensor that is taken as known, and how well it is: its uncertainty is propagated to
/// the estimates.
struct KnownNumber {
  std::string path;
  std::optional<SensorNumber> of_sensor{};  ///< as of Unknown
  bool of_clock = false;   ///< the path "clock": seconds per second of the clocks of the records and their inputs, 1
  std::string per;         ///< as of Unknown: one error for all runs, one for each label's value, or for each run
  double deviation = 0.0;  ///< standard deviation, SI; with `relative` a part of the number, as each run has it
  bool relative = false;
  std::size_t part = 0;  ///< as of Unknown; those of one path have one error
  int line = 0;
};

/// The equilibrium about which a run moves: the free length (or free angle) of one spring is set so that the coordinate
/// `body` (angle) or `joint` (travel) has the value `at` in equilibrium. For mechanisms with one degree of freedom.
struct EquilibriumPose {
  int body = -1, joint = -1;
  double at = 0.0;      ///< rad or m
  std::string by;       ///< path of the number that is set: "spring.oil.free_length"
  bool unknown = true;  ///< `at` is a nuisance parameter
  int line = 0;
};

/// One value by which a run starts: an angle of a body or a travel of a joint, or its rate; SI. Relative to the
/// equilibrium where the run has one, else absolute.
struct Release {
  int body = -1, joint = -1;
  bool rate = false;
  double value = 0.0;
  int line = 0;
};

/// A load or drive of the scene that was measured in a run: it follows the readings in place of the scene's numbers, or
/// the readings multiply the load of the scene.
struct RunInput {
  std::string path;  ///< "load.motor", "drive.crank"
  MotionInput motion;
  double noise = 0.0;             ///< of a load: standard deviation of a reading, SI, or as a part where it multiplies
  double zero = 0.0, unit = 1.0;  ///< as of a sensor: zero + unit times the column
  std::filesystem::path file;     ///< of its readings
  int line = 0;
};

/// A number of the scene, or what a drive of it holds, in the rows of a run at rest.
struct RowInput {
  std::string path;            ///< as for set_value(): "load.W"; or "drive.crank"
  int drive = -1;              ///< index into Scene::drives whose measure is held; else -1
  std::vector<double> values;  ///< one for each row, in the scene's units
  int line = 0;
};

/// One motion, free or driven, or readings at rest: simulated, or measured.
struct Run {
  std::string name;
  std::vector<ParameterChange> changes;                     ///< of the scene, known: a payload, say
  std::vector<std::pair<std::string, std::string>> labels;  ///< {"height", "low"}
  double duration = 0.0;                                    ///< s; simulated runs
  double sample_rate = 0.0;                                 ///< Hz
  std::optional<EquilibriumPose> equilibrium;
  std::vector<Release> release;  ///< truth of a simulation; first guess of a fit (absent: from the data)
  std::vector<RunInput> inputs;
  bool unknown_start = true;                ///< initial coordinates and rates are nuisance parameters
  std::uint64_t seed = 0;                   ///< of the noise of a simulated run
  std::vector<std::filesystem::path> data;  ///< files of its readings, which may be the experiment's; empty: simulated
  std::string time_column;                  ///< of the first of them
  bool states_time_factor = false;          ///< seconds per unit of these columns; else 1, which check_spans() checks
  std::optional<std::string> segment;       ///< value of the split column; absent: all of the files
  std::vector<std::size_t> sensors;         ///< those that are read in it, ascending; empty: all
  double clock_zero = 0.0;                  ///< s of the files' clock at the run's time 0
  std::size_t left_out = 0;                 ///< readings of the files that compared_times() leaves out
  std::size_t rows = 0;                     ///< at rest: how often it is read, at the "times" 1, 2, ...; else 0
  std::vector<RowInput> row_inputs;         ///< of these
  std::size_t part = 0;                     ///< of the experiment
  int line = 0;

  bool is_simulated() const { return data.empty(); }
  bool is_at_rest() const { return rows > 0; }
  /// Whether sensor k is read in it.
  bool reads(std::size_t k) const {
    return sensors.empty() || std::find(sensors.begin(), sensors.end(), k) != sensors.end();
  }
};

/// The run or label whose value of a number a run uses: "" where all runs share one.
std::string group_of(const std::string& per, const Run& run);

/// One of the experiments that are fitted together.
struct ExperimentPart {
  std::string file;
  Scene scene;
};

/// A scene, sensors, runs that were measured or are simulated, and the unknowns to be estimated from them; or several
/// such experiments for one fit, each with a scene of its own.
struct Experiment {
  std::string file;
  std::string title;
  std::string source;
  Scene scene;                           ///< of all runs, or of the first part; it has the units of all
  std::vector<ExperimentPart> parts;     ///< empty for a single experiment
  std::vector<ParameterChange> changes;  ///< of the scene by `set` of the file, or of all parts; already made
  Loss loss = Loss::squares;
  std::vector<Sensor> sensors;
  std::vector<Unknown> unknowns;
  std::vector<KnownNumber> known;
  std::vector<Run> runs;        ///< a run whose data file is split has been multiplied: one for each segment
  std::vector<Record> records;  ///< one per run; empty where the run is simulated
  std::optional<PlanLimits> plan;

  /// Where a part is written, and its scene.
  const std::string& file_of(std::size_t part) const { return parts.empty() ? file : parts[part].file; }
  const Scene& scene_of(std::size_t part) const { return parts.empty() ? scene : parts[part].scene; }
  /// All of its runs are simulated.
  bool is_simulated() const {
    return std::all_of(runs.begin(), runs.end(), [](const Run& run) { return run.is_simulated(); });
  }
};

/// The value of an unknown in its scene or sensor as written, SI, and its dimension.
double written_value(const Experiment& experiment, const Unknown& unknown);
Dimension dimension_of(const Experiment& experiment, const Unknown& unknown);

/// Paths of the loads and drives that follow readings in measured runs, each once: "load.motor".
std::vector<std::string> measured_inputs(const Experiment& experiment);
/// Readings of the first of these count as exact, and those of the others have noise.
std::vector<std::string> exact_inputs(const Experiment& experiment);
std::vector<std::string> noisy_inputs(const Experiment& experiment);

/// Whether the mechanism is still until a run's time 0, at its start: that is known, without speed, and nothing drives
/// it.
bool is_held(const Experiment& experiment, const Run& run);

/// The times at which readings of sensor k in a run can be compared: where the motion is known at the time less the
/// delay, whichever that is. It is known from 0 on, before where the run is_held(), and, where there are inputs, up to
/// `end`, the time of the run's last reading.
struct TimeRange {
  double from = 0.0, to = 0.0;
};
TimeRange compared_times(const Experiment& experiment, const Run& run, std::size_t k, double end);
/// Leaves out readings at other times; returns their number.
std::size_t leave_out(const TimeRange& compared, Series& series);
/// Those of a simulated run, of which all others are left out.
std::vector<double> simulated_times(const Experiment& experiment, const Run& run, std::size_t k);

struct ExperimentOptions {
  std::filesystem::path data{};         ///< takes the place of the data file that the runs name
  std::vector<std::string> settings{};  ///< PATH=NUMBER changes of the scene, after those of the file
  /// Takes the place of the scene of this name (Scene::file); null: all are read.
  std::shared_ptr<const Scene> scene{};
};

/// Reads an experiment file (TOML; grammar in docs/experiment-files.md), its scene and its data. Throws InputError
/// naming file, line, item, what was expected and a likely fix.
Experiment read_experiment(const std::filesystem::path& file, const ExperimentOptions& options = {});

/// The same of a text that takes the place of what the file holds.
Experiment parse_experiment(const std::string& text, const std::filesystem::path& file,
                            const ExperimentOptions& options = {});

}  // namespace poise
