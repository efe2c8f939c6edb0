#include "identification/prediction/run_model.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "identification/prediction/private/run_start.hpp"
#include "identification/prediction/private/sensor_reader.hpp"
#include "model/couplings.hpp"
#include "model/dependent_number.hpp"
#include "model/joint_friction.hpp"
#include "motion/equilibrium_pose.hpp"
#include "solvers/linear_algebra.hpp"

namespace poise {
namespace {

using Reduced = ReducedMotion<double>;

/// A start with values that are written at a place of the experiment, which its errors name.
template <class Make>
auto start_at(const std::string& place, Make make) {
  try {
    return make();
  } catch (const InputError& error) {
    throw InputError(place + error.what());
  }
}

void expect_sensors_of_motion(const Experiment& experiment, const Run& run) {
  for (std::size_t k = 0; k < experiment.sensors.size(); ++k) {
    const Sensor& sensor = experiment.sensors[k];
    if (sensor.is_of_motion() || !run.reads(k)) continue;
    throw InputError(at_line(experiment.file_of(run.part), run.line) +
                     fmt::format("run \"{}\": expected sensors that read motions, \"{}\" reads {}, which a run at rest "
                                 "alone has",
                                 run.name, sensor.name, sensor.quantity->name));
  }
}

}  // namespace

RunModel::RunModel(const Experiment& experiment, std::size_t run, std::vector<SceneParameter> numbers,
                   std::vector<SensorNumber> sensor_numbers)
    : experiment_(experiment),
      run_(experiment.runs[run]),
      scene_(experiment.scene_of(run_.part)),
      numbers_(std::move(numbers)),
      sensor_numbers_(std::move(sensor_numbers)),
      held_(is_held(experiment, run_)) {
  for (const ParameterChange& change : run_.changes) set_value(scene_, change.path, change.value);
  if (run_.is_at_rest()) {
    rest(experiment, run);
    return;
  }
  expect_sensors_of_motion(experiment, run_);
  scene_ = resisted_by_joints(std::move(scene_));
  take_inputs();
  start_unknown_ = run_.unknown_start;
  equilibrium_unknown_ = run_.equilibrium && run_.equilibrium->unknown;
  refuse_start_across_blades();
  const MotionModel as_written(scene_);
  scales_ = as_written.scales();
  size_ = as_written.layout().size * scales_.length;
  varying_ = varying_numbers();
  start_drives_in(*assemble());
  const MotionModel assembled(scene_, scales_, varying_);
  choose_coordinates(assembled);
  if (!start_unknown_ && !run_.is_simulated()) first_readings_ = &experiment.records[run];
  release(assembled);
  take_times(run);
}

/// Unknown rates of a start could go across blades.
void RunModel::refuse_start_across_blades() const {
  if (!start_unknown_ || scene_.blades.empty()) return;
  throw InputError(at_line(experiment_.file_of(run_.part), run_.line) +
                   fmt::format("run \"{}\".start_known: expected true, since the start of a motion on blades (\"{}\") "
                               "is not estimated; add start_known = true, with release and release_rate where it "
                               "does not start at rest",
                               run_.name, scene_.blades.front().name));
}

void RunModel::take_inputs() {
  for (const RunInput& input : run_.inputs) {
    inputs_.push_back(input.motion);
    if (input.motion.of != MotionInput::Of::drive) continue;
    // The start is found with the scene's drive, which is here the input at time 0.
    Drive& drive = scene_.drives[static_cast<std::size_t>(input.motion.item)];
    const auto expect_numbers = [&](ParameterPlace place, std::size_t count) {
      for (std::size_t k = 0; k < count; ++k) {
        place.number = static_cast<int>(k);
        if (dependent_number(scene_, place) == nullptr) continue;
        throw InputError(
            at_line(experiment_.file_of(run_.part), run_.line) +
            fmt::format("run \"{}\".inputs: expected numbers in drive \"{}\", whose place the input takes, "
                        "found an expression; write its value",
                        run_.name, drive.name));
      }
    };
    expect_numbers({Owner::drive, input.motion.item}, Drive::numbers.size());
    drive.start = input.motion.curve->at(0);
    drive.rate = input.motion.curve->at(0, 1);
    drive.acceleration = drive.amplitude = 0.0;
    for (std::size_t f = 0; f < scene_.time_functions.size(); ++f) {
      TimeFunction& function = scene_.time_functions[f];
      if (function.of != TimeFunction::Of::drive || function.item != input.motion.item) continue;
      expect_numbers({Owner::time, static_cast<int>(f)}, function.numbers().size());
      function.law = SineInTime{drive.rate, 0.5 * std::numbers::inv_pi, 0.0, *drive.start};
    }
  }
}

/// Those of the unknowns that move the geometry.
VaryingNumbers RunModel::varying_numbers() const {
  std::vector<ParameterPlace> varying;
  for (const SceneParameter& number : numbers_) {
    if (number.is_friction() && !number.allows(scene_, number.get(scene_))) {
      throw InputError(
          at_line(experiment_.file_of(run_.part), run_.line) +
          fmt::format("run \"{}\": expected {} > 0 where it is an unknown, found 0: a slide without length "
                      "carries couples without friction; give it a length",
                      run_.name, number.path()));
    }
    if (number.is_geometric()) varying.push_back(number.place());
  }
  return {scene_, varying};
}

/// Closes the loops, in the equilibrium pose if there is one. Returns the model of the scene as it is then.
std::unique_ptr<const MotionModel> RunModel::assemble() {
  std::string written;
  std::vector<StartValue> wanted;
  auto model = std::make_unique<const MotionModel>(scene_, scales_, varying_);
  if (run_.equilibrium) {
    written = at_line(experiment_.file_of(run_.part), run_.equilibrium->line) + "rest.at: ";
    set_by_equilibrium_ = SceneParameter::find(scene_, run_.equilibrium->by);
    if (!set_by_equilibrium_ || set_by_equilibrium_->place().owner != Owner::element ||
        set_by_equilibrium_->scales_with_force()) {
      throw InputError(at_line(experiment_.file_of(run_.part), run_.equilibrium->line) +
                       "rest.by: expected the free length of a spring or the free angle "
                       "of a torsion spring, found \"" +
                       run_.equilibrium->by + "\"; give spring.NAME.free_length");
    }
    wanted.push_back(equilibrium_in(*model, run_.equilibrium->at));
    equilibrium_coordinate_ = wanted.back().coordinate;
  }
  closed_ = start_at(written, [&] { return start_motion(*model, wanted); }).q;
  return model;
}

void RunModel::choose_coordinates(const MotionModel& assembled) {
  Reduced reduced(assembled.scaled_scene(), assembled.mechanism(), assembled.inertia());
  const std::vector<double> x = assembled.from_si(closed_);
  reduced.begin(0.0, x.data());
  freedoms_ = reduced.freedoms();
  const bool is_regular = reduced.rank() == assembled.mechanism().equalities() + reduced.drives();
  repeats_joints_ = !is_regular;
  mobility_ = freedoms_at(assembled, x, is_regular ? std::optional(0) : std::nullopt);
  independent_ = reduced.independent();
  if (run_.equilibrium && freedoms_ != 1) {
    throw InputError(
        at_line(experiment_.file_of(run_.part), run_.equilibrium->line) +
        fmt::format(
            "rest: expected a mechanism with one degree of freedom, found {}; make {} an unknown per run instead",
            freedoms_, run_.equilibrium->by));
  }
}

/// Finds the start as it is written.
void RunModel::release(const MotionModel& assembled) {
  std::string written;
  if (!run_.release.empty() || first_readings_ != nullptr) {
    written = at_line(experiment_.file_of(run_.part), run_.release.empty() ? run_.line : run_.release.front().line) +
              fmt::format("run \"{}\".{}: ", run_.name,
                          run_.release.empty()         ? "start_known, by its first readings"
                          : first_readings_ != nullptr ? "release, with its first readings"
                                                       : "release");
  }
  const std::vector<StartPart> parts = start_parts(assembled, closed_);
  const MotionState state = start_at(written, [&] { return start_in(assembled, parts, closed_); });
  released_ = independent_of(state);
  complete_start(assembled, state);
}

void RunModel::take_times(std::size_t run) {
  left_out_ = run_.left_out;
  delayed_ = std::any_of(sensor_numbers_.begin(), sensor_numbers_.end(),
                         [](const SensorNumber& number) { return number.of == SensorNumber::Of::delay; });
  for (std::size_t k = 0; k < experiment_.sensors.size(); ++k) {
    if (experiment_.sensors[k].reads_impacts() && run_.is_simulated()) {
      times_.push_back(run_.reads(k) ? simulated_impacts(experiment_.sensors[k]) : std::vector<double>{});
    } else if (run_.is_simulated()) {
      times_.push_back(simulated_times(experiment_, run_, k));
      const auto count = static_cast<std::size_t>(std::llround(run_.duration * run_.sample_rate));
      if (run_.reads(k) && !is_at_rest()) left_out_ += count - times_[k].size();
    } else {
      const Series& read = experiment_.records[run].sensors[k];
      Series once = is_at_rest() ? read : at_rest_once(read);
      times_.push_back(std::move(once.time));
      repeated_ += once.repeated;
    }
    if (times_[k].empty()) continue;
    const Sensor& sensor = experiment_.sensors[k];
    reads_impacts_ = reads_impacts_ || sensor.reads_impacts();
    delayed_ = delayed_ || sensor.delay != 0;
    end_ = std::max(end_, times_[k].back() - sensor.least_delay);
    for (std::size_t i = 0; i < times_[k].size(); ++i) readings_.push_back({times_[k][i], k, i});
  }
  std::stable_sort(readings_.begin(), readings_.end(),
                   [](const Reading& a, const Reading& b) { return a.time < b.time; });
}

std::vector<double> RunModel::simulated_impacts(const Sensor& sensor) const {
  const Motion motion = move(scene_values().data(), released().data(), run_.duration, MotionOptions().accuracy, false);
  std::vector<double> out;
  for (const ContactEvent* const impact : impacts_at(scene_, sensor, motion).impacts) out.push_back(impact->t);
  return out;
}

std::vector<std::size_t> RunModel::counts(double until) const {
  std::vector<std::size_t> out;
  for (const std::vector<double>& times : times_) {
    out.push_back(static_cast<std::size_t>(std::upper_bound(times.begin(), times.end(), until) - times.begin()));
  }
  return out;
}

std::size_t RunModel::readings(double until) const {
  const std::vector<std::size_t> each = counts(until);
  return std::accumulate(each.begin(), each.end(), std::size_t{0});
}

double RunModel::span() const { return readings_.empty() ? 0.0 : readings_.back().time; }

/// Whether all numbers of a sensor are: neither unknown nor known with a deviation.
bool RunModel::is_exact(std::size_t sensor) const {
  return std::none_of(sensor_numbers_.begin(), sensor_numbers_.end(),
                      [&](const SensorNumber& number) { return number.sensor == sensor; }) &&
         std::none_of(experiment_.known.begin(), experiment_.known.end(), [&](const KnownNumber& known) {
           return known.of_sensor && known.of_sensor->sensor == sensor && known.part == run_.part;
         });
}

std::vector<RunModel::Scaling> RunModel::scalings(const double* unknowns) const {
  std::vector<Scaling> out;
  for (const Sensor& sensor : experiment_.sensors) out.push_back({sensor.zero, sensor.unit, sensor.delay});
  const double* value = unknowns + numbers_.size();
  for (const SensorNumber& number : sensor_numbers_) {
    Scaling& own = out[number.sensor];
    (number.of == SensorNumber::Of::zero     ? own.zero
     : number.of == SensorNumber::Of::factor ? own.factor
                                             : own.delay) = *value++;
  }
  return out;
}

/// The readings up to the time `until`, in the order of the times of which they are.
std::vector<RunModel::Reading> RunModel::due(const std::vector<Scaling>& scalings, double until) const {
  const auto last = std::upper_bound(readings_.begin(), readings_.end(), until,
                                     [](double time, const Reading& reading) { return time < reading.time; });
  std::vector<Reading> out(readings_.begin(), last);
  if (!delayed_) return out;
  for (Reading& reading : out) reading.time -= scalings[reading.sensor].delay;
  std::stable_sort(out.begin(), out.end(), [](const Reading& a, const Reading& b) { return a.time < b.time; });
  return out;
}

double RunModel::reach(const SceneParameter& number) const {
  if (number.is_named()) return number.reach(scene_, size_);
  if (number.place().owner == Owner::scene) return std::max(1.0, norm(scene_.gravity));
  if (number.is_friction() && number.get(scene_) != 0) return std::abs(number.get(scene_));
  return number.is_length() ? size_ : std::max(1.0, std::abs(number.get(scene_)));
}

/// Drives without a start begin where the scene as it is written is assembled.
void RunModel::start_drives_in(const MotionModel& model) {
  for (Drive& drive : scene_.drives) {
    if (drive.start) continue;
    Sensor sensor;
    sensor.on = drive.on;
    SensorReader reader(model, sensor);
    std::vector<double> q, none(reader.coordinates().size(), 0.0);
    for (const int i : reader.coordinates()) q.push_back(closed_[static_cast<std::size_t>(i)]);
    drive.start = reader.read(q.data(), none.data(), none.data());
  }
}

std::vector<std::string> RunModel::nuisance_names() const {
  std::vector<std::string> names;
  if (equilibrium_unknown_) names.emplace_back("equilibrium");
  if (!start_unknown_) return names;
  const Layout layout = lay_out(scene_, Purpose::dynamics, varying_);
  for (const char* what : {"start ", "start rate "}) {
    for (const int i : independent_) names.push_back(what + layout.coordinates[static_cast<std::size_t>(i)].name);
  }
  return names;
}

std::vector<Dimension> RunModel::nuisance_dimensions() const {
  std::vector<Dimension> out;
  if (equilibrium_unknown_) out.push_back(run_.equilibrium->body >= 0 ? dimension::angle : dimension::length);
  if (!start_unknown_) return out;
  const Layout layout = lay_out(scene_, Purpose::dynamics, varying_);
  for (const int per_time : {0, -1}) {
    for (const int i : independent_) {
      const bool angle = layout.coordinates[static_cast<std::size_t>(i)].kind == Coordinate::Kind::angle;
      out.push_back((angle ? dimension::angle : dimension::length) * dimension::time.power(per_time));
    }
  }
  return out;
}

std::vector<double> RunModel::scene_values() const {
  std::vector<double> values;
  for (const SceneParameter& number : numbers_) values.push_back(number.get(scene_));
  for (const SensorNumber& n : sensor_numbers_) values.push_back(experiment_.sensors[n.sensor].number(n.of));
  return values;
}

std::vector<double> RunModel::released() const {
  std::vector<double> values;
  if (equilibrium_unknown_) values.push_back(run_.equilibrium->at);
  if (start_unknown_) values.insert(values.end(), released_.begin(), released_.end());
  return values;
}

std::vector<double> RunModel::start_of_run(const std::vector<double>& nuisances) const {
  if (is_at_rest()) return {};
  if (!start_unknown_) return {released_.begin(), released_.begin() + freedoms_};
  const auto first = nuisances.begin() + (equilibrium_unknown_ ? 1 : 0);
  return {first, first + freedoms_};
}

/// Whether the scene can have these numbers; it has them then.
bool RunModel::sets_numbers(const double* unknowns, Scene& scene, std::string& why) const {
  // The start and the end of a ramp may only be possible together: the one that is not yet is set after the other.
  std::vector<std::size_t> later;
  const auto set = [&](std::size_t i) {
    const bool allowed = numbers_[i].allows(scene, unknowns[i]);
    if (allowed) numbers_[i].set(scene, unknowns[i]);
    return allowed;
  };
  for (std::size_t i = 0; i < numbers_.size(); ++i) {
    if (!set(i)) later.push_back(i);
  }
  for (const std::size_t i : later) {
    if (set(i)) continue;
    why = numbers_[i].path() + (numbers_[i].is_named() ? " gives some number a value that it cannot have"
                                : unknowns[i] <= 0.0 && numbers_[i].place().owner != Owner::time
                                    ? " is not positive"
                                    : " is out of its range");
    return false;
  }
  return true;
}

RunModel::Built RunModel::build(const double* unknowns, double equilibrium, bool derivatives) const {
  Built out;
  Scene scene = scene_;
  if (!sets_numbers(unknowns, scene, out.why)) return out;
  try {
    auto model = std::make_shared<const MotionModel>(std::move(scene), scales_, varying_);
    // Bodies that nothing gives inertia or force have no coordinates.
    if (model->mechanism().coordinates() != std::ssize(closed_)) {
      out.why = "with these values other bodies move than in the scene as written";
      return out;
    }
    out.q = closed_;
    if (!varying_.empty()) out.q = model->to_si(closed_from(*model, model->from_si(closed_)));
    const std::vector<double> assembled = out.q;
    if (!start_unknown_) out.start = released_in(*model, assembled);
    if (run_.equilibrium) {
      model = balance(*model, equilibrium, derivatives, out);
      if (!model) return out;
    } else if (derivatives) {
      vary(model, out);
    }
    if (derivatives && !start_unknown_) vary_start(*model, assembled, out);
    out.model = std::move(model);
  } catch (const InputError& error) {
    out.why = error.what();
  }
  return out;
}

// In equilibrium alpha(z_e, L, p) = 0, which is linear in L: one step finds it.
std::shared_ptr<const MotionModel> RunModel::balance(const MotionModel& model, double equilibrium, bool derivatives,
                                                     Built& out) const {
  Scene scene = model.scene();
  try {
    out.q = start_motion(model, {equilibrium_in(model, equilibrium)}, &out.q, &independent_).q;
  } catch (const InputError&) {
    out.why = "it cannot take its equilibrium position";
    return nullptr;
  }
  const std::vector<double> x = model.from_si(out.q);
  const double still = 0.0;
  const auto stand = [&](Reduced& motion) {
    if (!place_at_start(motion, x, x, independent_)) return false;
    motion.move(&still);
    return motion.accelerate() == Reduced::Status::ok;
  };
  Reduced reduced(model.scaled_scene(), model.mechanism(), model.inertia());
  reduced.set_inputs(model.scaled_scene(), scaled(inputs_in(scene), scene, scales_));
  const Influence set = set_by_equilibrium_->influence(scene, scales_);
  double by_set = 0.0;
  if (stand(reduced)) reduced.influence(set, &by_set);
  if (by_set == 0 || !std::isfinite(by_set)) {
    out.why = fmt::format("{} cannot hold it in its equilibrium position", run_.equilibrium->by);
    return nullptr;
  }
  set_by_equilibrium_->set(scene, set_by_equilibrium_->get(scene) - reduced.alpha()[0] / by_set);
  auto balanced = std::make_shared<const MotionModel>(scene, scales_, varying_);
  if (!derivatives) return balanced;
  vary(balanced, out);
  Reduced again(balanced->scaled_scene(), balanced->mechanism(), balanced->inertia());
  again.set_inputs(balanced->scaled_scene(), scaled(inputs_in(scene), scene, scales_));
  again.set_variations(out.variations);
  if (!stand(again)) {
    out.why = "its motion cannot be computed in its equilibrium position";
    return nullptr;
  }
  again.linearize();
  again.influence(set, &by_set);
  const double at_per_z = again.B(0)[equilibrium_coordinate_];
  const double z_unit = equilibrium_coordinate_ < balanced->layout().angles ? 1.0 : scales_.length;
  out.set_by_at = -again.alpha_z(0)[0] / by_set / (at_per_z * z_unit);
  for (std::size_t i = 0; i < numbers_.size(); ++i) {
    const Influence& influence = out.influences[i];
    double alpha = 0.0;
    again.influence(influence, &alpha);
    if (influence.moves()) {
      // The equilibrium's coordinate stays where it is, but for turns of its body's frame.
      double moved = again.q_p()[equilibrium_coordinate_];
      if (influence.variation >= 0) {
        moved += turn_by(out.variations[static_cast<std::size_t>(influence.variation)], run_.equilibrium->body);
      }
      alpha -= again.alpha_z(0)[0] * moved / at_per_z;
    }
    out.set_by.push_back(-alpha / by_set);
  }
  out.influences.push_back(set);
  return balanced;
}

/// How the motion depends on the numbers.
void RunModel::vary(const std::shared_ptr<const MotionModel>& model, Built& out) const {
  for (const SceneParameter& number : numbers_) {
    if (!number.is_geometric()) {
      out.influences.push_back(number.influence(model->scene(), scales_));
      continue;
    }
    out.influences.push_back({.variation = static_cast<int>(out.variations.size())});
    out.influences.back().in_time = number.in_time(model->scene(), scales_);
    out.variations.emplace_back(model, number.place());
  }
  if (repeats_joints_) refuse_what_opens_loops(*model, out);
}

/// Throws InputError for a number of which joints that repeat each other leave no other value.
void RunModel::refuse_what_opens_loops(const MotionModel& model, const Built& built) const {
  constexpr double rounding = 1e-6;  // near the pose in which joints repeat others it is no more exact
  const std::vector<double> x = model.from_si(built.q.empty() ? closed_ : built.q);
  const std::vector<double> still(independent_.size(), 0.0);
  std::vector<double> alpha(independent_.size());
  Reduced motion(model.scaled_scene(), model.mechanism(), model.inertia());
  motion.set_inputs(model.scaled_scene(), scaled(inputs_in(model.scene()), model.scene(), scales_));
  motion.set_variations(built.variations);
  if (!place_at_start(motion, x, x, independent_)) return;
  motion.move(still.data());
  if (motion.accelerate() != Reduced::Status::ok) return;
  motion.linearize();
  for (std::size_t i = 0; i < numbers_.size(); ++i) {
    if (built.influences[i].variation < 0) continue;
    motion.influence(built.influences[i], alpha.data());
    if (motion.gap_by() <= rounding) continue;
    throw InputError(
        fmt::format("joints repeat each other, so that loops close for this value of {} alone", numbers_[i].path()));
  }
}

MotionState RunModel::begin(const Built& built, const double* nuisances) const {
  MotionState state;
  state.q = built.q;
  state.v.assign(state.q.size(), 0.0);
  const std::vector<double> released = start_unknown_ ? std::vector<double>{} : independent_of(built.start);
  const double* start = start_unknown_ ? nuisances + (equilibrium_unknown_ ? 1 : 0) : released.data();
  for (int k = 0; k < freedoms_; ++k) {
    const auto i = static_cast<std::size_t>(independent_[static_cast<std::size_t>(k)]);
    state.q[i] = start[k];
    state.v[i] = start[freedoms_ + k];
  }
  return state;
}

Motion RunModel::move(const Built& built, const double* nuisances, double duration, double accuracy, bool sensitivities,
                      const std::atomic<bool>* interrupt) const {
  MotionOptions options;
  options.interrupt = interrupt;
  options.duration = duration;
  options.accuracy = accuracy;
  options.independent = independent_;
  options.sensitivities = sensitivities;
  // Steps that the readings could follow; a fit may start from a stiffness that would need a billion.
  options.most_steps = 20'000 + 20 * static_cast<int>(readings_.size());
  options.inputs = inputs_;
  for (const MotionInput& input : inputs_in(built.model->scene()))
    options.most_steps += 20 * static_cast<int>(input.breaks().size());
  if (sensitivities) {
    options.influences = built.influences;
    options.variations = built.variations;
  }
  return simulate(*built.model, begin(built, nuisances), options);
}

Motion RunModel::move(const double* unknowns, const double* nuisances, double duration, double accuracy,
                      bool sensitivities) const {
  if (is_at_rest()) {
    Motion none;
    none.why = "it is at rest";
    return none;
  }
  const Built built = build(unknowns, equilibrium_unknown_ ? nuisances[0] : equilibrium_at(), sensitivities);
  if (!built.model) {
    Motion none;
    none.why = built.why;
    return none;
  }
  return move(built, nuisances, duration, accuracy, sensitivities, nullptr);
}

RunModel::Oscillator RunModel::oscillator(const double* unknowns, double equilibrium) const {
  Oscillator out;
  if (is_at_rest()) return out;
  const Built built = build(unknowns, equilibrium, false);
  if (!built.model) return out;
  const MotionModel& model = *built.model;
  const std::vector<double> x = model.from_si(built.q);
  Reduced reduced(model.scaled_scene(), model.mechanism(), model.inertia());
  if (!place_at_start(reduced, x, x, independent_)) return out;
  const double still = 0.0;
  const double one = 1.0;
  reduced.move(&one);
  // SI: energies per square of the independent coordinate's unit.
  const double z_unit = independent_[0] < model.layout().angles ? 1.0 : scales_.length;
  out.mass = model.scales().energy() / (z_unit * z_unit) * 2 * reduced.kinetic_energy();
  reduced.move(&still);
  if (reduced.accelerate() != Reduced::Status::ok) return out;
  reduced.linearize();
  out.stiffness = -out.mass * reduced.alpha_z(0)[0];
  out.damping = -out.mass * reduced.alpha_w(0)[0];
  if (times_.front().empty()) return out;
  SensorReader reader(model, experiment_.sensors.front());
  const std::vector<double> q = model.to_si(x);
  const std::size_t n = reader.coordinates().size();
  std::vector<double> own(n), none(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) own[i] = q[static_cast<std::size_t>(reader.coordinates()[i])];
  out.reading = reader.read(own.data(), none.data(), none.data());
  const auto by_z = [&](int i) {
    const double unit = i < model.layout().angles ? 1.0 : scales_.length;
    return reduced.B(0)[i] * unit / z_unit;
  };
  for (std::size_t i = 0; i < n; ++i) out.reading_by_z += reader.derivatives().by_q[i] * by_z(reader.coordinates()[i]);
  out.z = q[static_cast<std::size_t>(independent_[0])];
  if (equilibrium_coordinate_ >= 0) out.equilibrium_by_z = by_z(equilibrium_coordinate_);
  return out;
}

std::vector<double> RunModel::natural_frequencies(const double* unknowns, double equilibrium,
                                                  const std::vector<double>& pose) const {
  if (is_at_rest() || freedoms_ == 0) return {};
  const Built built = build(unknowns, equilibrium, false);
  if (!built.model) return {};
  const MotionModel& model = *built.model;
  std::vector<double> q = built.q;
  for (std::size_t k = 0; !run_.equilibrium && k < pose.size(); ++k) {
    q[static_cast<std::size_t>(independent_[k])] = pose[k];
  }
  const std::vector<double> x = model.from_si(q);
  Reduced reduced(model.scaled_scene(), model.mechanism(), model.inertia());
  if (!place_at_start(reduced, model.from_si(closed_), x, independent_)) return {};
  const std::vector<double> still(independent_.size(), 0.0);
  reduced.move(still.data());
  if (reduced.accelerate() != Reduced::Status::ok) return {};
  reduced.linearize();
  Eigen::MatrixXd squares(freedoms_, freedoms_);
  for (int k = 0; k < freedoms_; ++k) {
    for (int i = 0; i < freedoms_; ++i) squares(i, k) = -reduced.alpha_z(k)[i];
  }
  if (!squares.allFinite()) return {};
  std::vector<double> out;
  for (const std::complex<double>& square : solvers::eigenpairs(squares).values) {
    out.push_back(square.real() > 0 ? std::sqrt(std::abs(square)) / (2 * std::numbers::pi) : 0.0);
  }
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace poise
