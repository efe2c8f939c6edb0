// Where a run starts, and how that depends on its unknowns: members of RunModel.

#include "identification/prediction/private/run_start.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "identification/prediction/private/sensor_reader.hpp"
#include "identification/prediction/run_model.hpp"
#include "motion/blades.hpp"
#include "motion/time_curve.hpp"
#include "solvers/linear_algebra.hpp"
#include "solvers/quintic_spline.hpp"

namespace poise {
namespace {

using Reduced = ReducedMotion<double>;

/// Coordinates, or their rates, that a start gives: how they change with the independent ones. Of rates, blades give
/// that across each of them.
class GivenCoordinates {
 public:
  /// Begins with those of the parts of a start, or with their rates.
  template <class Parts>
  GivenCoordinates(const Reduced& reduced, const Parts& parts, bool rate)
      : reduced_(reduced), rows_(0, reduced.freedoms()) {
    if (rate) rows_ = blade_conditions(reduced);
    for (const auto& part : parts) {
      if (part.value.rate == rate) add(part.value.coordinate);
    }
  }

  /// False where the coordinate follows from those that are given already.
  bool add(int coordinate) {
    Eigen::MatrixXd more(rows_.rows() + 1, rows_.cols());
    more.topRows(rows_.rows()) = rows_;
    for (int k = 0; k < reduced_.freedoms(); ++k) more(rows_.rows(), k) = reduced_.B(k)[coordinate];
    if (solvers::rank<double>(more, solvers::known_to::closed_point) <= rows_.rows()) return false;
    rows_ = std::move(more);
    return true;
  }

 private:
  const Reduced& reduced_;
  Eigen::MatrixXd rows_;
};

/// The reading of an angle, a travel or a rate where its coordinate is 0.
double zero_of(SensorReader& reader) {
  const double none = 0.0;
  return reader.read(&none, &none, &none);
}

}  // namespace

std::string at_line(const std::string& file, int line) { return fmt::format("{}:{}: ", file, line); }

bool place_at_start(Reduced& motion, const std::vector<double>& closed, const std::vector<double>& x,
                    const std::vector<int>& independent) {
  motion.start_drives(closed.data());
  motion.choose(0.0, closed.data(), false, &independent);
  motion.expect(x.data());
  std::vector<double> z;
  for (const int i : independent) z.push_back(x[static_cast<std::size_t>(i)]);
  return motion.place(0.0, z.data()) == Reduced::Status::ok;
}

/// The value of an angle of a body, or of a travel, as one of a coordinate.
StartValue RunModel::coordinate_at(const MotionModel& model, int body, int joint, int line, double value) {
  const Layout& layout = model.layout();
  if (joint >= 0) return {layout.travel[static_cast<std::size_t>(joint)], false, value};
  const Link& link = layout.links[static_cast<std::size_t>(body)];
  if (link.frame < 0 || link.frame >= layout.kept) {
    throw InputError(fmt::format("{}:{}: {}: expected a body that turns and has inertia; name another",
                                 model.scene().file, line, model.scene().bodies[static_cast<std::size_t>(body)].name));
  }
  return {link.frame, false, value - layout.turns[static_cast<std::size_t>(link.turn)].to<double>()};
}

StartValue RunModel::equilibrium_in(const MotionModel& model, double at) const {
  const EquilibriumPose& pose = *run_.equilibrium;
  return coordinate_at(model, pose.body, pose.joint, pose.line, at);
}

/// The derivative of the angle of a body at a fixed coordinate of its frame.
double RunModel::turn_by(const Variation& variation, int body) {
  if (body < 0) return 0.0;
  const Mechanism<VariedModel::Dual>& m = variation.compiled().mechanism();
  return m.phasors().turn(m.layout().links[static_cast<std::size_t>(body)].turn).v[0];
}

/// Where the run starts, from the closed pose q, in which it is in equilibrium if it has an equilibrium pose.
std::vector<RunModel::StartPart> RunModel::start_parts(const MotionModel& model, const std::vector<double>& q) const {
  std::vector<StartPart> out;
  for (const Release& r : run_.release) {
    StartPart part{coordinate_at(model, r.body, r.joint, r.line, r.value), {}};
    part.value.rate = r.rate;
    if (r.rate) {
      part.value.value = r.value;
    } else if (run_.equilibrium) {
      part.value.value = r.value + q[static_cast<std::size_t>(part.value.coordinate)];
      part.from_equilibrium = true;
    } else if (r.joint < 0) {
      part.on = Measure::angle_between(0, r.body);
    }
    out.push_back(std::move(part));
  }
  const auto is_place = [](const StartPart& part) { return !part.value.rate; };
  if (run_.equilibrium && std::none_of(out.begin(), out.end(), is_place)) {
    const double place = q[static_cast<std::size_t>(equilibrium_coordinate_)];
    out.push_back({{equilibrium_coordinate_, false, place}, {}, true});
  }
  if (first_readings_ != nullptr) {
    const std::vector<double> x = model.from_si(q);
    Reduced reduced(model.scaled_scene(), model.mechanism(), model.inertia());
    if (place_at_start(reduced, x, x, independent_)) add_first_readings(model, reduced, out);
  }
  for (const StartValue& value : completed_) out.push_back({value, {}});
  return out;
}

/// Adds the first readings of angles, travels and their rates to a start that is known, where it does not have them
/// yet. Throws InputError unless all degrees of freedom then have a value and a rate.
void RunModel::add_first_readings(const MotionModel& model, const ReducedMotion<double>& reduced,
                                  std::vector<StartPart>& start) const {
  const Record& record = *first_readings_;
  for (const bool rate : {false, true}) {
    GivenCoordinates given(reduced, start, rate);
    for (std::size_t k = 0; k < experiment_.sensors.size(); ++k) {
      const Sensor& sensor = experiment_.sensors[k];
      const bool read_at_start = !record.sensors[k].time.empty() && record.sensors[k].time.front() == 0.0;
      if (!(rate ? sensor.reads_rate() : sensor.reads_measure()) || !read_at_start || !is_exact(k) ||
          sensor.delay != 0 || (sensor.on.kind != Measure::Kind::angle && sensor.on.kind != Measure::Kind::travel)) {
        continue;
      }
      SensorReader reader(model, sensor);
      if (reader.coordinates().size() != 1 || !given.add(reader.coordinates()[0])) continue;
      const double value = record.sensors[k].value.front() - zero_of(reader);
      start.push_back({{reader.coordinates()[0], rate, value}, sensor.on});
    }
    for (const int i : independent_) {
      if (!given.add(i)) continue;
      const std::string& name = model.layout().coordinates[static_cast<std::size_t>(i)].name;
      throw InputError(
          at_line(experiment_.file_of(run_.part), run_.line) +
          (rate ? fmt::format(
                      "run \"{}\".start_known: expected the rate of \"{}\" at the start; add release_rate = "
                      "{{ \"{}\" = NUMBER }} (0 where it is released without speed) or a sensor with rate = true, "
                      "without delay and with exact numbers",
                      run_.name, name, name)
                : fmt::format("run \"{}\".start_known: expected where \"{}\" starts; add release = {{ \"{}\" = NUMBER "
                              "}} or a sensor of it without delay and with exact numbers",
                              run_.name, name, name)));
    }
  }
}

/// What the start of the scene as it is written leaves open stays as it is there, whatever the numbers become.
void RunModel::complete_start(const MotionModel& model, const MotionState& state) {
  if (start_unknown_ || run_.equilibrium) return;
  const std::vector<StartPart> parts = start_parts(model, state.q);
  const std::vector<double> x = model.from_si(state.q);
  Reduced reduced(model.scaled_scene(), model.mechanism(), model.inertia());
  if (!place_at_start(reduced, x, x, independent_)) return;
  for (const bool rate : {false, true}) {
    GivenCoordinates given(reduced, parts, rate);
    for (const int i : independent_) {
      const auto at_i = static_cast<std::size_t>(i);
      if (given.add(i)) completed_.push_back({i, rate, rate ? state.v[at_i] : state.q[at_i]});
    }
  }
}

/// The state in which the run is released in this model, from the closed pose q.
MotionState RunModel::released_in(const MotionModel& model, std::vector<double> q) const {
  if (run_.equilibrium) {
    q = start_motion(model, {equilibrium_in(model, run_.equilibrium->at)}, &q, &independent_).q;
  }
  return start_in(model, start_parts(model, q), q);
}

MotionState RunModel::start_in(const MotionModel& model, const std::vector<StartPart>& parts,
                               const std::vector<double>& q) const {
  std::vector<StartValue> wanted;
  for (const StartPart& part : parts) wanted.push_back(part.value);
  return start_motion(model, wanted, &q, &independent_);
}

std::vector<double> RunModel::independent_of(const MotionState& state) const {
  std::vector<double> out;
  for (const std::vector<double>* values : {&state.q, &state.v}) {
    for (const int i : independent_) out.push_back((*values)[static_cast<std::size_t>(i)]);
  }
  return out;
}

/// How a known start depends on the numbers p. In it the coordinates S q(z, p) are s(p), and the rates S' v(z, w, p)
/// are those that are given, those across blades among them:
///   S B z_p = s_p - S q_p,   S' B w_p = -S' (v_p + sum_k v_z_k z_p_k).
void RunModel::vary_start(const MotionModel& model, const std::vector<double>& assembled, Built& out) const {
  const auto f = static_cast<std::size_t>(freedoms_);
  out.released_by.assign(2 * f * numbers_.size(), 0.0);
  Reduced motion(model.scaled_scene(), model.mechanism(), model.inertia());
  motion.set_inputs(model.scaled_scene(), scaled(inputs_in(model.scene()), model.scene(), model.scales()));
  motion.set_variations(out.variations);
  const auto stand = [&](const std::vector<double>& q, const double* w) {
    const std::vector<double> x = model.from_si(q);
    if (!place_at_start(motion, x, x, independent_)) return false;
    motion.move(w);
    if (motion.accelerate() != Reduced::Status::ok) return false;
    motion.linearize();
    return true;
  };
  std::vector<double> alpha(f), still(f, 0.0);
  const auto q_p = [&](std::size_t number) {
    motion.influence(out.influences[number], alpha.data());
    return Eigen::Map<const Eigen::VectorXd>(motion.q_p(), motion.coordinates());
  };
  // What places that are counted from the equilibrium pose change by, scaled.
  std::vector<Eigen::VectorXd> equilibrium_by(numbers_.size(), Eigen::VectorXd::Zero(motion.coordinates()));
  std::vector<double> q = assembled;
  if (run_.equilibrium) {
    q = start_motion(model, {equilibrium_in(model, run_.equilibrium->at)}, &q, &independent_).q;
    if (!stand(q, still.data())) throw InputError("its motion cannot be computed in its equilibrium position");
    for (std::size_t i = 0; i < numbers_.size(); ++i) {
      const Influence& influence = out.influences[i];
      if (!influence.moves()) continue;
      equilibrium_by[i] = q_p(i);
      double moved = equilibrium_by[i][equilibrium_coordinate_];
      if (influence.variation >= 0) {
        moved += turn_by(out.variations[static_cast<std::size_t>(influence.variation)], run_.equilibrium->body);
      }
      const Eigen::Map<const Eigen::VectorXd> along(motion.B(0), motion.coordinates());
      equilibrium_by[i] -= moved / along[equilibrium_coordinate_] * along;
    }
  }
  const std::vector<StartPart> parts = start_parts(model, q);
  std::vector<double> rates = independent_of(out.start);
  for (std::size_t k = 0; k < f; ++k) {
    const bool is_angle = independent_[k] < model.layout().angles;
    rates[f + k] /= is_angle ? 1.0 : scales_.length;
  }
  if (!stand(out.start.q, rates.data() + f)) throw InputError("its motion cannot be computed where it starts");
  // `across` is what the rates across blades have to change by.
  const auto solve = [&](bool rate, const auto& right_side, const Eigen::VectorXd& across) {
    std::vector<std::pair<const StartPart*, int>> rows;
    for (const StartPart& part : parts) {
      if (part.value.rate == rate) rows.emplace_back(&part, part.value.coordinate);
    }
    const auto given = static_cast<Eigen::Index>(rows.size());
    if (given + across.size() == 0) return Eigen::VectorXd(Eigen::VectorXd::Zero(freedoms_));
    Eigen::MatrixXd B(given + across.size(), f);
    Eigen::VectorXd right(B.rows());
    if (across.size() > 0) B.bottomRows(across.size()) = blade_conditions(motion);
    right.tail(across.size()) = across;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const auto row = static_cast<Eigen::Index>(r);
      for (int k = 0; k < freedoms_; ++k) B(row, k) = motion.B(k)[rows[r].second];
      right[row] = right_side(*rows[r].first, rows[r].second);
    }
    return Eigen::VectorXd(solvers::minimum_norm_solution<double>(B, right));
  };
  for (std::size_t i = 0; i < numbers_.size(); ++i) {
    const Influence& influence = out.influences[i];
    if (!influence.moves()) continue;
    const Eigen::VectorXd places_by = q_p(i);
    const Eigen::VectorXd z = solve(
        false,
        [&](const StartPart& part, int c) {
          double own = part.from_equilibrium ? equilibrium_by[i][c] : 0.0;
          if (part.on && influence.variation >= 0) {
            Sensor sensor;
            sensor.on = *part.on;
            SensorVariation zero(out.variations[static_cast<std::size_t>(influence.variation)], sensor);
            const std::vector<double> none(zero.coordinates().size(), 0.0);
            own -= zero.read(none.data(), none.data(), none.data());
          }
          return own - places_by[c];
        },
        Eigen::VectorXd());
    Eigen::VectorXd across(motion.blades());
    for (int b = 0; b < motion.blades(); ++b) {
      across[b] = -motion.blade_rate_p(b);
      for (int k = 0; k < freedoms_; ++k) across[b] -= z[k] * motion.blade_rate_change(b, motion.B(k), motion.v_z(k));
    }
    const Eigen::VectorXd w = solve(
        true,
        [&](const StartPart&, int c) {
          double change = motion.v_p()[c];
          for (int k = 0; k < freedoms_; ++k) change += motion.v_z(k)[c] * z[k];
          return -change;
        },
        across);
    for (std::size_t k = 0; k < f; ++k) {
      const double unit = independent_[k] < model.layout().angles ? 1.0 : scales_.length;
      out.released_by[2 * f * i + k] = unit * z[static_cast<Eigen::Index>(k)];
      out.released_by[2 * f * i + f + k] = unit * w[static_cast<Eigen::Index>(k)];
    }
  }
}

std::vector<double> RunModel::start_from_readings(const double* unknowns, const Record& record) const {
  // Quadratics through the first readings of every angle and travel sensor: value and slope at the start.
  const MotionModel model(scene_, scales_, varying_);
  constexpr std::size_t most = 16;
  std::vector<std::size_t> sensors;
  for (std::size_t k = 0; k < experiment_.sensors.size(); ++k) {
    const Sensor& sensor = experiment_.sensors[k];
    if (sensor.reads_coordinate() && record.sensors[k].time.size() >= 3) sensors.push_back(k);
  }
  // Sensors whose first readings end first come first: over a long time a motion is no quadratic.
  const auto until = [&](std::size_t k) {
    const std::vector<double>& time = record.sensors[k].time;
    return time[std::min(time.size(), most) - 1];
  };
  std::stable_sort(sensors.begin(), sensors.end(), [&](std::size_t a, std::size_t b) { return until(a) < until(b); });
  const std::vector<double> x = model.from_si(closed_);
  Reduced reduced(model.scaled_scene(), model.mechanism(), model.inertia());
  place_at_start(reduced, x, x, independent_);
  const auto is_free = [&](int coordinate) {
    constexpr double little = 1e-9;  // of an independent coordinate: drives alone move it
    for (int k = 0; k < freedoms_; ++k) {
      if (std::abs(reduced.B(k)[coordinate]) > little) return true;
    }
    return false;
  };
  const std::vector<Scaling> scaling = scalings(unknowns);
  std::vector<StartValue> wanted;
  for (const std::size_t k : sensors) {
    // More readings than degrees of freedom would contradict each other by their noise.
    if (wanted.size() >= 2 * static_cast<std::size_t>(freedoms_)) break;
    const Series& series = record.sensors[k];
    const auto count = static_cast<Eigen::Index>(std::min(series.time.size(), most));
    const SensorReader reader(model, experiment_.sensors[k]);
    if (reader.coordinates().size() != 1) continue;
    const int coordinate = reader.coordinates()[0];
    const bool known =
        std::any_of(wanted.begin(), wanted.end(), [&](const StartValue& s) { return s.coordinate == coordinate; });
    if (known || !is_free(coordinate)) continue;
    Eigen::MatrixXd powers(count, 3);
    Eigen::VectorXd quantity(count);
    const Sensor& sensor = experiment_.sensors[k];
    const double factor = scaling[k].factor / sensor.unit;
    for (Eigen::Index i = 0; i < count; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const double t = series.time[at] - scaling[k].delay;
      powers.row(i) << 1.0, t, t * t;
      quantity[i] = factor * series.value[at] + (scaling[k].zero - factor * sensor.zero);
    }
    SensorReader at_zero(reader);
    const double zero = zero_of(at_zero);
    const Eigen::VectorXd fit = solvers::LeastSquares<double>(powers).solve(quantity);
    wanted.push_back({coordinate, false, fit[0] - zero});
    wanted.push_back({coordinate, true, fit[1]});
  }
  return independent_of(start_motion(model, wanted, &closed_));
}

std::vector<RunModel::ReadState> RunModel::states_from_readings(const double* unknowns, const Record& record,
                                                                std::size_t count) const {
  constexpr std::size_t least_readings = 30;
  constexpr double edge = 0.03;  // of the common time at both ends, where curves are less sure
  if (is_at_rest()) return {};
  const MotionModel model(scene_, scales_, varying_);
  const std::vector<Scaling> scaling = scalings(unknowns);
  std::vector<TimeCurve> curves;
  std::vector<double> rows;  // of d(quantity)/dz
  double from = 0.0, to = INFINITY;
  for (std::size_t k = 0; k < experiment_.sensors.size(); ++k) {
    const Sensor& sensor = experiment_.sensors[k];
    if (!sensor.reads_coordinate() || record.sensors[k].time.size() < least_readings) continue;
    SensorReader reader(model, sensor);
    const std::vector<int>& on = reader.coordinates();
    const auto is_independent = [&](int i) {
      return std::find(independent_.begin(), independent_.end(), i) != independent_.end();
    };
    if (!std::all_of(on.begin(), on.end(), is_independent)) continue;
    const std::vector<double> none(on.size(), 0.0);
    const double at_zero = reader.read(none.data(), none.data(), none.data());
    for (const int i : independent_) {
      const auto at = std::find(on.begin(), on.end(), i);
      rows.push_back(at == on.end() ? 0.0 : reader.derivatives().by_q[static_cast<std::size_t>(at - on.begin())]);
    }
    const double factor = scaling[k].factor / sensor.unit;
    Series read = record.sensors[k];
    for (double& t : read.time) t -= scaling[k].delay;
    for (double& y : read.value) y = factor * y + (scaling[k].zero - factor * sensor.zero) - at_zero;
    std::optional<solvers::QuinticSpline> spline;
    for (double noise = std::abs(factor) * sensor.noise; !spline; noise *= 4) {
      spline = solvers::smoothing_spline(read.time, read.value, noise);
    }
    curves.push_back(TimeCurve::along(*spline));
    from = std::max(from, read.time.front());
    to = std::min(to, read.time.back());
  }
  const auto sensors = static_cast<Eigen::Index>(curves.size());
  const Eigen::MatrixXd by_z = Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
      rows.data(), sensors, freedoms_);
  if (sensors < freedoms_ || freedoms_ == 0 || !(from < to)) return {};
  const solvers::LeastSquares<double> coordinates_of(by_z);
  if (coordinates_of.rank() < freedoms_) return {};
  std::vector<ReadState> out;
  for (std::size_t s = 0; s < count; ++s) {
    const double part = edge + (1 - 2 * edge) * static_cast<double>(s) / static_cast<double>(count - 1);
    ReadState& state = out.emplace_back();
    state.t = from + part * (to - from);
    for (int order = 0; order <= 2; ++order) {
      Eigen::VectorXd read(sensors);
      for (Eigen::Index i = 0; i < sensors; ++i) read[i] = curves[static_cast<std::size_t>(i)].at(state.t, order);
      const Eigen::VectorXd found = coordinates_of.solve(read);
      (order == 0 ? state.z : order == 1 ? state.w : state.a).assign(found.begin(), found.end());
    }
  }
  return out;
}

}  // namespace poise
