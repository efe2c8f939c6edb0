#include "identification/run_model.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "identification/sensor_reader.hpp"
#include "solvers/linear_algebra.hpp"

namespace poise {
namespace {

using Reduced = ReducedMotion<double>;

std::string at(const Experiment& experiment, int line) { return fmt::format("{}:{}: ", experiment.file, line); }

/// start_motion() to values that are written at a place of the experiment, which its errors name.
MotionState start_at(const std::string& place, const MotionModel& model, const std::vector<StartValue>& wanted,
                     const std::vector<double>* q = nullptr) {
  try {
    return start_motion(model, wanted, q);
  } catch (const InputError& error) {
    throw InputError(place + error.what());
  }
}

}  // namespace

std::pair<int, double> RunModel::coordinate_of(const Scene& scene, const Layout& layout, int body, int joint,
                                               int line) {
  if (joint >= 0) return {layout.travel[static_cast<std::size_t>(joint)], 0.0};
  const Link& link = layout.links[static_cast<std::size_t>(body)];
  if (link.frame < 0 || link.frame >= layout.kept) {
    throw InputError(fmt::format("{}:{}: {}: expected a body that turns and has inertia; name another", scene.file,
                                 line, scene.bodies[static_cast<std::size_t>(body)].name));
  }
  return {link.frame, layout.turns[static_cast<std::size_t>(link.turn)].to<double>()};
}

RunModel::RunModel(const Experiment& experiment, std::size_t run, std::vector<SceneParameter> numbers)
    : experiment_(experiment), run_(experiment.runs[run]), scene_(experiment.scene), numbers_(std::move(numbers)) {
  for (const ParameterChange& change : run_.changes) set_value(scene_, change.path, change.value);
  start_unknown_ = run_.unknown_start;
  equilibrium_unknown_ = run_.equilibrium && run_.equilibrium->unknown;
  const MotionModel model(scene_);
  scales_ = model.scales();
  const Layout& layout = model.layout();
  std::vector<StartValue> wanted;
  std::string place;
  if (run_.equilibrium) {
    place = at(experiment, run_.equilibrium->line) + "rest.at: ";
    set_by_equilibrium_ = SceneParameter::find(scene_, run_.equilibrium->by);
    if (!set_by_equilibrium_ || set_by_equilibrium_->scales_with_force()) {
      throw InputError(at(experiment, run_.equilibrium->line) +
                       "rest.by: expected the free length of a spring or the free angle "
                       "of a torsion spring, found \"" +
                       run_.equilibrium->by + "\"; give spring.NAME.free_length");
    }
    std::tie(equilibrium_coordinate_, equilibrium_turn_) =
        coordinate_of(scene_, layout, run_.equilibrium->body, run_.equilibrium->joint, run_.equilibrium->line);
    wanted.push_back({equilibrium_coordinate_, false, run_.equilibrium->at - equilibrium_turn_});
  }
  closed_ = start_at(place, model, wanted).q;
  Reduced reduced(model.scaled_scene(), model.mechanism(), model.inertia());
  const std::vector<double> x = model.from_si(closed_);
  reduced.start_drives(x.data());
  reduced.choose(0.0, x.data(), false);
  freedoms_ = reduced.freedoms();
  independent_ = reduced.independent();
  if (run_.equilibrium && freedoms_ != 1) {
    throw InputError(
        at(experiment, run_.equilibrium->line) +
        fmt::format(
            "rest: expected a mechanism with one degree of freedom, found {}; make {} an unknown per run instead",
            freedoms_, run_.equilibrium->by));
  }
  std::vector<StartValue> release;
  for (const Release& r : run_.release) {
    const auto [coordinate, turn] = coordinate_of(scene_, layout, r.body, r.joint, r.line);
    const double base = run_.equilibrium && !r.rate ? closed_[static_cast<std::size_t>(coordinate)]
                        : r.rate                    ? 0.0
                                                    : -turn;
    release.push_back({coordinate, r.rate, base + r.value});
  }
  if (!run_.release.empty()) place = at(experiment, run_.release.front().line) + "release: ";
  if (!start_unknown_ && !run_.is_simulated()) {
    const std::vector<double> z = model.from_si(closed_);
    reduced.expect(z.data());
    std::vector<double> independent;
    for (const int i : independent_) independent.push_back(z[static_cast<std::size_t>(i)]);
    if (reduced.place(0.0, independent.data()) == Reduced::Status::ok) {
      complete_start(model, reduced, experiment.records[run], release);
    }
  }
  const MotionState state = start_at(place, model, release, &closed_);
  for (const int i : independent_) released_.push_back(state.q[static_cast<std::size_t>(i)]);
  for (const int i : independent_) released_.push_back(state.v[static_cast<std::size_t>(i)]);
  if (run_.is_simulated()) {
    const auto count = static_cast<std::size_t>(std::llround(run_.duration * run_.sample_rate));
    std::vector<double> times;
    for (std::size_t i = 0; i < count; ++i) times.push_back(static_cast<double>(i) / run_.sample_rate);
    times_.assign(experiment.sensors.size(), times);
  } else {
    for (const Series& series : experiment.records[run].sensors) times_.push_back(series.time);
  }
  for (std::size_t k = 0; k < times_.size(); ++k) {
    for (std::size_t i = 0; i < times_[k].size(); ++i) readings_.push_back({times_[k][i], k, i});
  }
  std::stable_sort(readings_.begin(), readings_.end(),
                   [](const Reading& a, const Reading& b) { return a.time < b.time; });
}

void RunModel::complete_start(const MotionModel& model, const ReducedMotion<double>& reduced, const Record& record,
                              std::vector<StartValue>& start) const {
  for (const bool rate : {false, true}) {
    // Rows: how the values given change with the independent coordinates, or their rates.
    Eigen::MatrixXd given(0, freedoms_);
    const auto adds = [&](int coordinate) {
      Eigen::MatrixXd more(given.rows() + 1, freedoms_);
      more.topRows(given.rows()) = given;
      for (int k = 0; k < freedoms_; ++k) more(given.rows(), k) = reduced.B(k)[coordinate];
      if (solvers::rank<double>(more, solvers::known_to::closed_point) <= given.rows()) return false;
      given = std::move(more);
      return true;
    };
    for (const StartValue& value : start) {
      if (value.rate == rate) adds(value.coordinate);
    }
    for (std::size_t k = 0; k < experiment_.sensors.size(); ++k) {
      const Sensor& sensor = experiment_.sensors[k];
      if (sensor.rate != rate || sensor.reads_force() || record.sensors[k].value.empty() ||
          (sensor.on.kind != Measure::Kind::angle && sensor.on.kind != Measure::Kind::travel)) {
        continue;
      }
      SensorReader reader(model, sensor);
      if (reader.coordinates().size() != 1 || !adds(reader.coordinates()[0])) continue;
      const double none = 0.0;
      double by_q = 0.0;
      double by_v = 0.0;
      const double zero = reader.read(&none, &none, &by_q, &by_v);
      start.push_back({reader.coordinates()[0], rate, record.sensors[k].value.front() - zero});
    }
    for (const int i : independent_) {
      if (!adds(i)) continue;
      const std::string& name = model.layout().coordinates[static_cast<std::size_t>(i)].name;
      throw InputError(
          at(experiment_, run_.line) +
          (rate ? fmt::format(
                      "run \"{}\".start_known: expected the rate of \"{}\" at the start; add release_rate = "
                      "{{ \"{}\" = NUMBER }} (0 where it is released without speed) or a sensor with rate = true",
                      run_.name, name, name)
                : fmt::format("run \"{}\".start_known: expected where \"{}\" starts; add release = {{ \"{}\" = NUMBER "
                              "}} or a sensor of it",
                              run_.name, name, name)));
    }
  }
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

std::vector<std::string> RunModel::nuisance_names() const {
  std::vector<std::string> names;
  if (equilibrium_unknown_) names.emplace_back("equilibrium");
  if (!start_unknown_) return names;
  const Layout layout = lay_out(scene_, Purpose::dynamics);
  for (const char* what : {"start ", "start rate "}) {
    for (const int i : independent_) names.push_back(what + layout.coordinates[static_cast<std::size_t>(i)].name);
  }
  return names;
}

std::vector<Dimension> RunModel::nuisance_dimensions() const {
  std::vector<Dimension> out;
  if (equilibrium_unknown_) out.push_back(run_.equilibrium->body >= 0 ? dimension::angle : dimension::length);
  if (!start_unknown_) return out;
  const Layout layout = lay_out(scene_, Purpose::dynamics);
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
  return values;
}

std::vector<double> RunModel::released() const {
  std::vector<double> values;
  if (equilibrium_unknown_) values.push_back(run_.equilibrium->at);
  if (start_unknown_) values.insert(values.end(), released_.begin(), released_.end());
  return values;
}

const double* RunModel::start_of(const double* nuisances) const {
  return start_unknown_ ? nuisances + (equilibrium_unknown_ ? 1 : 0) : released_.data();
}

std::vector<double> RunModel::start_of_run(const std::vector<double>& nuisances) const {
  const double* start = start_of(nuisances.data());
  return {start, start + freedoms_};
}

// In equilibrium alpha(z_e, L, p) = 0, which is linear in L: one step finds it.
RunModel::Built RunModel::build(const double* unknowns, double equilibrium, bool derivatives) const {
  Built out;
  Scene scene = scene_;
  for (std::size_t i = 0; i < numbers_.size(); ++i) numbers_[i].set(scene, unknowns[i]);
  if (run_.equilibrium) {
    MotionModel model(scene, scales_);
    try {
      out.q_equilibrium =
          start_motion(model, {{equilibrium_coordinate_, false, equilibrium - equilibrium_turn_}}, &closed_).q;
    } catch (const InputError&) {
      out.why = "it cannot take its equilibrium pose";
      return out;
    }
    const std::vector<double> x = model.from_si(out.q_equilibrium);
    Reduced reduced(model.scaled_scene(), model.mechanism(), model.inertia());
    reduced.choose(0.0, x.data(), false, &independent_);
    const double still = 0.0;
    const auto stand = [&](Reduced& motion) {
      motion.expect(x.data());
      const double z = x[static_cast<std::size_t>(independent_[0])];
      if (motion.place(0.0, &z) != Reduced::Status::ok) return false;
      motion.move(&still);
      return motion.accelerate() == Reduced::Status::ok;
    };
    const Influence set = set_by_equilibrium_->influence(scene, scales_);
    double by_set = 0.0;
    if (stand(reduced)) reduced.influence(set, &by_set);
    if (by_set == 0 || !std::isfinite(by_set)) {
      out.why = fmt::format("{} cannot hold it in its equilibrium pose", run_.equilibrium->by);
      return out;
    }
    set_by_equilibrium_->set(scene, set_by_equilibrium_->get(scene) - reduced.alpha()[0] / by_set);
    out.set_value = set_by_equilibrium_->get(scene);
    if (derivatives) {
      MotionModel balanced(scene, scales_);
      Reduced again(balanced.scaled_scene(), balanced.mechanism(), balanced.inertia());
      again.choose(0.0, x.data(), false, &independent_);
      if (!stand(again)) {
        out.why = "its motion cannot be computed in its equilibrium pose";
        return out;
      }
      again.linearize();
      again.influence(set, &by_set);
      const double at_per_z = again.B(0)[equilibrium_coordinate_];
      const double z_unit = equilibrium_coordinate_ < balanced.layout().angles ? 1.0 : scales_.length;
      out.set_by_at = -again.alpha_z(0)[0] / by_set / (at_per_z * z_unit);
      for (const SceneParameter& number : numbers_) {
        double alpha = 0.0;
        again.influence(number.influence(scene, scales_), &alpha);
        out.set_by.push_back(-alpha / by_set);
      }
    }
  }
  out.model = std::make_unique<MotionModel>(scene, scales_);
  for (const SceneParameter& number : numbers_) out.influences.push_back(number.influence(scene, scales_));
  if (set_by_equilibrium_) out.influences.push_back(set_by_equilibrium_->influence(scene, scales_));
  return out;
}

MotionState RunModel::begin(const Built& built, const double* nuisances) const {
  MotionState state;
  state.q = built.q_equilibrium.empty() ? closed_ : built.q_equilibrium;
  state.v.assign(state.q.size(), 0.0);
  const double* start = start_of(nuisances);
  for (int k = 0; k < freedoms_; ++k) {
    const auto i = static_cast<std::size_t>(independent_[static_cast<std::size_t>(k)]);
    state.q[i] = start[k];
    state.v[i] = start[freedoms_ + k];
  }
  return state;
}

Motion RunModel::move(const Built& built, const double* nuisances, double duration, double accuracy,
                      bool sensitivities) const {
  MotionOptions options;
  options.duration = duration;
  options.accuracy = accuracy;
  options.independent = independent_;
  options.sensitivities = sensitivities;
  // Steps that the readings could follow; a fit may start from a stiffness that would need a billion.
  options.most_steps = 20'000 + 20 * static_cast<int>(readings_.size());
  if (sensitivities) options.influences = built.influences;
  return simulate(*built.model, begin(built, nuisances), options);
}

Motion RunModel::move(const double* unknowns, const double* nuisances, double duration, double accuracy,
                      bool sensitivities) const {
  const Built built = build(unknowns, equilibrium_unknown_ ? nuisances[0] : equilibrium_at(), false);
  if (!built.model) {
    Motion none;
    none.why = built.why;
    return none;
  }
  return move(built, nuisances, duration, accuracy, sensitivities);
}

void RunModel::predict(const double* unknowns, const double* nuisances, double until, double accuracy, bool jacobian,
                       Prediction& out) const {
  out.ok = false;
  const int p = static_cast<int>(numbers_.size());
  const int f = freedoms_;
  const Built built = build(unknowns, equilibrium_unknown_ ? nuisances[0] : equilibrium_at(), jacobian);
  if (!built.model) {
    out.why = built.why;
    return;
  }
  const Motion motion = move(built, nuisances, std::max(std::min(until, span()), 1e-9), accuracy, jacobian);
  if (!motion.completed()) {
    out.why = motion.why;
    return;
  }
  std::vector<SensorReader> readers;
  std::vector<int> coordinates;
  std::vector<std::vector<std::size_t>> places;
  for (const Sensor& sensor : experiment_.sensors) {
    readers.emplace_back(*built.model, sensor);
    places.emplace_back();
    for (const int i : readers.back().coordinates()) {
      const auto known = std::find(coordinates.begin(), coordinates.end(), i);
      places.back().push_back(static_cast<std::size_t>(known - coordinates.begin()));
      if (known == coordinates.end()) coordinates.push_back(i);
    }
  }
  TrajectoryReader trajectory(motion.trajectory, coordinates);
  const std::size_t width = static_cast<std::size_t>(columns());
  std::vector<std::size_t> first{0};  // row of each sensor's first reading
  for (const std::size_t count : counts(until)) first.push_back(first.back() + count);
  out.reading.resize(first.back());
  if (jacobian) out.jacobian.assign(out.reading.size() * width, 0.0);
  // Columns of the trajectory: f starts, f start rates, the numbers, the one that the equilibrium sets.
  std::vector<double> q(coordinates.size()), v(q), by_q(q), by_v(q);
  std::vector<double> column(static_cast<std::size_t>(motion.trajectory.columns));
  double now = -INFINITY;
  for (const auto& [time, k, s] : readings_) {
    if (time > until) break;
    if (time > now) trajectory.at(time);
    now = time;
    SensorReader& reader = readers[k];
    const Sensor& sensor = experiment_.sensors[k];
    const std::size_t n = reader.coordinates().size();
    for (std::size_t i = 0; i < n; ++i) {
      q[i] = trajectory.q(places[k][i]);
      v[i] = trajectory.v(places[k][i]);
    }
    const std::size_t row = first[k] + s;
    out.reading[row] = reader.read(q.data(), v.data(), by_q.data(), by_v.data());
    if (!jacobian) continue;
    std::fill(column.begin(), column.end(), 0.0);
    for (std::size_t i = 0; i < n; ++i) {
      const std::span<const double> q_p = trajectory.q_p(places[k][i]);
      const std::span<const double> v_p = trajectory.v_p(places[k][i]);
      const double on_q = by_q[i];
      const double on_v = by_v[i];
      for (std::size_t c = 0; c < column.size(); ++c) column[c] += on_q * q_p[c];
      if (on_v == 0) continue;
      for (std::size_t c = 0; c < column.size(); ++c) column[c] += on_v * v_p[c];
    }
    double* numbers = column.data() + 2 * f;
    if (sensor.reads_force()) {
      for (int i = 0; i <= p; ++i) {
        if (i == p && !set_by_equilibrium_) break;
        const SceneParameter& number = i < p ? numbers_[static_cast<std::size_t>(i)] : *set_by_equilibrium_;
        numbers[i] += number.force_by(built.model->scene(), sensor.element, reader.measure(), 0.0);
      }
    }
    double* to = &out.jacobian[row * width];
    for (int i = 0; i < p; ++i) {
      *to++ = numbers[i] + (set_by_equilibrium_ ? numbers[p] * built.set_by[static_cast<std::size_t>(i)] : 0.0);
    }
    if (equilibrium_unknown_) *to++ = numbers[p] * built.set_by_at;
    if (start_unknown_) std::copy(column.begin(), column.begin() + 2 * f, to);
  }
  out.ok = true;
}

RunModel::Oscillator RunModel::oscillator(const double* unknowns, double equilibrium) const {
  Oscillator out;
  const Built built = build(unknowns, equilibrium, false);
  if (!built.model) return out;
  const MotionModel& model = *built.model;
  const std::vector<double> x = model.from_si(built.q_equilibrium.empty() ? closed_ : built.q_equilibrium);
  Reduced reduced(model.scaled_scene(), model.mechanism(), model.inertia());
  reduced.choose(0.0, x.data(), false, &independent_);
  reduced.expect(x.data());
  const double z = x[static_cast<std::size_t>(independent_[0])];
  const double still = 0.0;
  if (reduced.place(0.0, &z) != Reduced::Status::ok) return out;
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
  SensorReader reader(model, experiment_.sensors.front());
  const std::vector<double> q = model.to_si(x);
  const std::size_t n = reader.coordinates().size();
  std::vector<double> own(n), rate(n, 0.0), by_q(n), by_v(n);
  for (std::size_t i = 0; i < n; ++i) own[i] = q[static_cast<std::size_t>(reader.coordinates()[i])];
  out.reading = reader.read(own.data(), rate.data(), by_q.data(), by_v.data());
  const auto by_z = [&](int i) {
    const double unit = i < model.layout().angles ? 1.0 : scales_.length;
    return reduced.B(0)[i] * unit / z_unit;
  };
  for (std::size_t i = 0; i < n; ++i) out.reading_by_z += by_q[i] * by_z(reader.coordinates()[i]);
  out.z = q[static_cast<std::size_t>(independent_[0])];
  if (equilibrium_coordinate_ >= 0) out.equilibrium_by_z = by_z(equilibrium_coordinate_);
  return out;
}

std::vector<double> RunModel::natural_frequencies(const double* unknowns, double equilibrium,
                                                  const std::vector<double>& pose) const {
  const Built built = build(unknowns, equilibrium, false);
  if (!built.model) return {};
  const MotionModel& model = *built.model;
  std::vector<double> q = built.q_equilibrium.empty() ? closed_ : built.q_equilibrium;
  for (std::size_t k = 0; built.q_equilibrium.empty() && k < pose.size(); ++k) {
    q[static_cast<std::size_t>(independent_[k])] = pose[k];
  }
  const std::vector<double> x = model.from_si(q);
  Reduced reduced(model.scaled_scene(), model.mechanism(), model.inertia());
  const std::vector<double> closed = model.from_si(closed_);
  reduced.start_drives(closed.data());
  reduced.choose(0.0, closed.data(), false, &independent_);
  reduced.expect(x.data());
  std::vector<double> z;
  for (const int i : independent_) z.push_back(x[static_cast<std::size_t>(i)]);
  const std::vector<double> still(z.size(), 0.0);
  if (reduced.place(0.0, z.data()) != Reduced::Status::ok) return {};
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

std::vector<double> RunModel::start_from_readings(const Record& record) const {
  // Quadratics through the first readings of every angle and travel sensor: value and slope at the start.
  const MotionModel model(scene_, scales_);
  std::vector<StartValue> wanted;
  for (std::size_t k = 0; k < experiment_.sensors.size(); ++k) {
    const Sensor& sensor = experiment_.sensors[k];
    if (sensor.rate || sensor.reads_force() ||
        (sensor.on.kind != Measure::Kind::angle && sensor.on.kind != Measure::Kind::travel))
      continue;
    // More readings than degrees of freedom would contradict each other by their noise.
    if (wanted.size() >= 2 * static_cast<std::size_t>(freedoms_)) break;
    const Series& series = record.sensors[k];
    const auto count = static_cast<Eigen::Index>(std::min<std::size_t>(series.time.size(), 16));
    const SensorReader reader(model, sensor);
    if (count < 3 || reader.coordinates().size() != 1) continue;
    Eigen::MatrixXd powers(count, 3);
    for (Eigen::Index i = 0; i < count; ++i) {
      const double t = series.time[static_cast<std::size_t>(i)];
      powers.row(i) << 1.0, t, t * t;
    }
    const std::vector<double> one{0.0};
    double by_q = 0.0;
    double by_v = 0.0;
    const double zero = SensorReader(reader).read(one.data(), one.data(), &by_q, &by_v);
    const Eigen::VectorXd fit =
        solvers::LeastSquares<double>(powers).solve(Eigen::Map<const Eigen::VectorXd>(series.value.data(), count));
    wanted.push_back({reader.coordinates()[0], false, fit[0] - zero});
    wanted.push_back({reader.coordinates()[0], true, fit[1]});
  }
  const MotionState state = start_motion(model, wanted, &closed_);
  std::vector<double> start;
  for (const int i : independent_) start.push_back(state.q[static_cast<std::size_t>(i)]);
  for (const int i : independent_) start.push_back(state.v[static_cast<std::size_t>(i)]);
  return start;
}

}  // namespace poise
