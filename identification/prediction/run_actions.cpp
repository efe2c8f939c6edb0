#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "identification/prediction/private/sensor_reader.hpp"
#include "identification/prediction/random_states.hpp"
#include "identification/prediction/run_model.hpp"
#include "solvers/random_stream.hpp"

namespace poise {
namespace {

using Reduced = ReducedMotion<double>;

/// Relative change of the scene's numbers that shows what their rounding, and that of all computation, may do.
constexpr double disturbance = 4 * std::numeric_limits<double>::epsilon();
/// A sum that is smaller than its terms by this is rounding of them and of the pose.
constexpr double lost_in_terms = 0x1p12 * std::numeric_limits<double>::epsilon();
/// What a change of a number by 100 % changes by this part of the acceleration at most is rounding of that.
constexpr double lost_in_whole = 50 * std::numeric_limits<double>::epsilon();
/// States of the run's own motion.
constexpr std::size_t states_of_motion = 20;
/// Poses nearer to a dead point are left out: rounding would grow with their condition.
constexpr double least_pivot = 1e-3;

/// Every number that a motion depends on changed at random by a relative `disturbance` at most.
Scene disturbed(Scene scene) {
  solvers::RandomStream random(3);
  for (const ParameterRow& row : parameter_table(scene)) {
    if (row.place.owner == Owner::start || row.place.owner == Owner::stop) continue;
    const double value = value_at(scene, row.place).value_or(0.0);
    if (value != 0) set_value_at(scene, row.place, value * (1 + random.uniform(-disturbance, disturbance)));
  }
  for (Joint& joint : scene.joints)
    joint.axis = joint.axis + random.uniform(-disturbance, disturbance) * quarter_turn(joint.axis);
  return scene;
}

/// An unknown number of a sensor that is read.
struct ReadNumber {
  SensorNumber::Of of;
  std::size_t reader;
  double zero, factor;
};

/// A run's model with what its unknowns change.
struct Acting {
  Acting(const MotionModel& m, const std::vector<Influence>& i, const std::vector<Variation>& v,
         const std::vector<Sensor>& s, const std::vector<MotionInput>& inputs)
      : model(m), influences(i), variations(v), sensors(s), reduced(m.scaled_scene(), m.mechanism(), m.inertia()) {
    for (const Sensor& sensor : sensors) readers.emplace_back(model, sensor);
    for (const Variation& variation : variations) {
      std::vector<SensorVariation>& of_sensors = varied.emplace_back();
      for (const Sensor& sensor : sensors) of_sensors.emplace_back(variation, sensor);
    }
    reduced.set_inputs(m.scaled_scene(), scaled(inputs, m.scene(), m.scales()));
    reduced.set_variations(variations);
  }

  const MotionModel& model;
  const std::vector<Influence>& influences;
  const std::vector<Variation>& variations;
  const std::vector<Sensor>& sensors;
  Reduced reduced;
  std::vector<SensorReader> readers;
  std::vector<std::vector<SensorVariation>> varied;  // by variation and sensor
  Eigen::MatrixXd terms;  // of the derivatives of alpha by at(): the size of what they are sums of

  Eigen::Index rows() const { return reduced.freedoms() + static_cast<Eigen::Index>(sensors.size()); }

  /// d(reading)/d(number), one column for each number of the sensors, as the readings of at(), which are before they
  /// are multiplied by what turns the quantity into the column. At the state of the last at().
  Eigen::MatrixXd by_sensor_numbers(const std::vector<ReadNumber>& numbers) {
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(rows(), static_cast<Eigen::Index>(numbers.size()));
    const std::size_t n = static_cast<std::size_t>(reduced.coordinates());
    const std::vector<double> q = model.to_si({reduced.q(), reduced.q() + n});
    const std::vector<double> v = model.to_si({reduced.v(), reduced.v() + n});
    const std::vector<double> a = model.to_si({reduced.a(), reduced.a() + n});
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const ReadNumber& number = numbers[i];
      const Read now = read(readers[number.reader], q, v, v.data(), a.data());
      out(reduced.freedoms() + static_cast<Eigen::Index>(number.reader), static_cast<Eigen::Index>(i)) =
          number.of == SensorNumber::Of::zero     ? -1.0
          : number.of == SensorNumber::Of::factor ? (number.zero - now.value) / number.factor
                                                  : -now.change;
    }
    return out;
  }

  /// d(reading)/d(time) of the rows of by_sensor_numbers(), zero of the others.
  Eigen::VectorXd rates() {
    Eigen::VectorXd out = Eigen::VectorXd::Zero(rows());
    for (std::size_t k = 0; k < readers.size(); ++k) {
      const ReadNumber delay{SensorNumber::Of::delay, k, 0.0, 1.0};
      out -= by_sensor_numbers({delay});
    }
    return out;
  }

  /// At the pose placed and the rates w; empty where there is no acceleration.
  Eigen::MatrixXd at(const double* w, const std::vector<SceneParameter>& numbers) {
    reduced.move(w);
    if (reduced.accelerate() != Reduced::Status::ok) return {};
    const Eigen::Index f = reduced.freedoms();
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(rows(), static_cast<Eigen::Index>(influences.size()));
    terms.resize(f, out.cols());
    std::vector<double> alpha(static_cast<std::size_t>(f));
    reduced.linearize();
    const std::size_t n = static_cast<std::size_t>(reduced.coordinates());
    const std::vector<double> q = model.to_si({reduced.q(), reduced.q() + n});
    const std::vector<double> v = model.to_si({reduced.v(), reduced.v() + n});
    for (std::size_t p = 0; p < influences.size(); ++p) {
      reduced.influence(influences[p], alpha.data());
      out.col(static_cast<Eigen::Index>(p)).head(f) = Eigen::Map<const Eigen::VectorXd>(alpha.data(), f);
      reduced.influence_terms(influences[p], terms.col(static_cast<Eigen::Index>(p)).data());
      for (std::size_t k = 0; k < sensors.size(); ++k) {
        double& by = out(f + static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(p));
        if (sensors[k].reads_force()) {
          const double g = read(readers[k], q, v, nullptr, nullptr).measure;
          by += numbers[p].force_by(model.scene(), sensors[k].element, g, 0.0);
        }
        if (!influences[p].moves()) continue;
        const std::vector<double> q_p = model.to_si({reduced.q_p(), reduced.q_p() + n});
        const std::vector<double> v_p = model.to_si({reduced.v_p(), reduced.v_p() + n});
        by += read(readers[k], q, v, q_p.data(), v_p.data()).change;
        if (influences[p].variation < 0) continue;
        SensorVariation& direct = varied[static_cast<std::size_t>(influences[p].variation)][k];
        std::vector<double> own_q, own_v;
        for (const int i : direct.coordinates()) {
          own_q.push_back(q[static_cast<std::size_t>(i)]);
          own_v.push_back(v[static_cast<std::size_t>(i)]);
        }
        by += direct.read(own_q.data(), own_v.data());
      }
    }
    return out;
  }

  struct Read {
    double value = 0.0, measure = 0.0, change = 0.0;  // the change along q' and v'
  };
  static Read read(SensorReader& reader, const std::vector<double>& q, const std::vector<double>& v, const double* q_p,
                   const double* v_p) {
    const std::vector<int>& on = reader.coordinates();
    std::vector<double> own_q, own_v, by_q(on.size()), by_v(on.size());
    for (const int i : on) {
      own_q.push_back(q[static_cast<std::size_t>(i)]);
      own_v.push_back(v[static_cast<std::size_t>(i)]);
    }
    Read out;
    out.value = reader.read(own_q.data(), own_v.data(), by_q.data(), by_v.data());
    out.measure = reader.measure();
    for (std::size_t i = 0; q_p != nullptr && i < on.size(); ++i)
      out.change += by_q[i] * q_p[on[i]] + by_v[i] * v_p[on[i]];
    return out;
  }
};

}  // namespace

RunModel::Actions RunModel::actions(const double* unknowns, const double* nuisances, int states) const {
  Actions out;
  const Built built = build(unknowns, equilibrium_unknown_ ? nuisances[0] : equilibrium_at(), true);
  if (!built.model) return out;
  const MotionModel& model = *built.model;
  const Motion motion = move(built, nuisances, std::max(span(), 1e-9), 1e-6, false, nullptr);
  const std::vector<double> x = model.from_si(built.q);
  std::vector<Sensor> sensors;
  std::vector<ReadNumber> of_sensors;
  std::vector<Eigen::Index> places;  // of these among the unknowns
  const std::vector<Scaling> scaling = scalings(unknowns);
  for (std::size_t k = 0; k < times_.size(); ++k) {
    if (times_[k].empty()) continue;
    for (std::size_t i = 0; i < sensor_numbers_.size(); ++i) {
      if (sensor_numbers_[i].sensor != k) continue;
      of_sensors.push_back({sensor_numbers_[i].of, sensors.size(), scaling[k].zero, scaling[k].factor});
      places.push_back(static_cast<Eigen::Index>(numbers_.size() + i));
    }
    sensors.push_back(experiment_.sensors[k]);
  }
  Acting own(model, built.influences, built.variations, sensors, inputs_in(model.scene()));
  own.reduced.start_drives(x.data());
  own.reduced.choose(0.0, x.data(), false, &independent_);
  own.reduced.expect(x.data());

  const Scene near = disturbed(model.scene());
  const auto near_model = std::make_shared<const MotionModel>(near, scales_, varying_);
  out.scene = model.scene();
  std::vector<SceneParameter> numbers = numbers_;
  if (set_by_equilibrium_) numbers.push_back(*set_by_equilibrium_);
  Built changes;
  vary(near_model, changes);
  if (set_by_equilibrium_) changes.influences.push_back(set_by_equilibrium_->influence(near, scales_));
  Acting changed(*near_model, changes.influences, changes.variations, sensors, inputs_in(near));
  changed.reduced.start_drives(x.data());
  changed.reduced.choose(0.0, x.data(), false, &independent_);

  // The number that an equilibrium sets follows the others: alpha = 0 there.
  const auto p = static_cast<Eigen::Index>(numbers_.size());
  const auto follow = [&](Acting& acting, const double* z, Eigen::RowVectorXd& by) {
    const std::vector<double> still(static_cast<std::size_t>(freedoms_), 0.0);
    acting.reduced.expect(x.data());
    if (acting.reduced.place(0.0, z) != Reduced::Status::ok) return false;
    const Eigen::MatrixXd rows = acting.at(still.data(), numbers);
    if (rows.rows() == 0 || rows(0, p) == 0) return false;
    by = -rows.row(0).head(p) / rows(0, p);
    return true;
  };
  Eigen::RowVectorXd own_follows, changed_follows;
  if (set_by_equilibrium_) {
    const double z = x[static_cast<std::size_t>(independent_[0])];
    if (!follow(own, &z, own_follows) || !follow(changed, &z, changed_follows)) return out;
  }

  const bool timed = own.reduced.drives() > 0 || has_inputs();
  const bool any_delay = std::any_of(of_sensors.begin(), of_sensors.end(),
                                     [](const ReadNumber& number) { return number.of == SensorNumber::Of::delay; });
  const bool shifts = start_unknown_ && any_delay && !timed;
  std::vector<Eigen::MatrixXd> rows, rows_again, errors;
  std::vector<Eigen::VectorXd> rates, rates_again;
  solvers::RandomStream random(4);
  const auto add = [&](double t, const double* z, const double* w) {
    Eigen::MatrixXd here = own.at(w, numbers);
    changed.reduced.expect(own.reduced.q());
    // Rounding that no number takes part in, of the sine of an angle say, follows the state.
    std::vector<double> near_z(z, z + freedoms_);
    std::vector<double> near_w(w, w + freedoms_);
    for (auto* values : {&near_z, &near_w}) {
      for (double& value : *values) value *= 1 + random.uniform(-disturbance, disturbance);
    }
    if (here.rows() == 0 || changed.reduced.place(t, near_z.data()) != Reduced::Status::ok) return;
    Eigen::MatrixXd there = changed.at(near_w.data(), numbers);
    if (there.rows() == 0) return;
    if (set_by_equilibrium_) {
      here.leftCols(p) += here.col(p) * own_follows;
      there.leftCols(p) += there.col(p) * changed_follows;
      own.terms.leftCols(p) += own.terms.col(p) * own_follows.cwiseAbs();
    }
    if (!here.allFinite() || !there.allFinite()) return;
    Eigen::MatrixXd lost = Eigen::MatrixXd::Zero(own.rows(), this->unknowns());
    for (int k = 0; k < freedoms_; ++k) {
      const double whole = std::abs(own.reduced.alpha()[k]);
      for (Eigen::Index i = 0; i < p; ++i) {
        lost(k, i) = lost_in_terms * own.terms(k, i);
        if (unknowns[i] != 0) lost(k, i) = std::max(lost(k, i), lost_in_whole * whole / std::abs(unknowns[i]));
      }
    }
    errors.push_back(std::move(lost));
    const auto whole = [&](Acting& acting, const Eigen::MatrixXd& of_scene) {
      Eigen::MatrixXd all = Eigen::MatrixXd::Zero(acting.rows(), this->unknowns());
      all.leftCols(p) = of_scene.leftCols(p);
      all(Eigen::all, places) = acting.by_sensor_numbers(of_sensors);
      return all;
    };
    rows.push_back(whole(own, here));
    rows_again.push_back(whole(changed, there));
    out.states.push_back({t, model.to_si({own.reduced.q(), own.reduced.q() + x.size()}),
                          model.to_si({own.reduced.v(), own.reduced.v() + x.size()})});
    if (!shifts) return;
    rates.push_back(own.rates());
    rates_again.push_back(changed.rates());
  };
  std::vector<double> w(static_cast<std::size_t>(freedoms_), 0.0);
  visit_random_states(own.reduced, x, states, timed ? span() : 0.0, [&](const RandomState& state) {
    // Rates at which forces of inertia are about as large as the others.
    std::fill(w.begin(), w.end(), 0.0);
    own.reduced.move(w.data());
    double size = 1.0;
    if (own.reduced.accelerate() == Reduced::Status::ok) {
      for (int k = 0; k < freedoms_; ++k) size = std::max(size, std::abs(own.reduced.alpha()[k]));
    }
    for (std::size_t k = 0; k < w.size(); ++k) w[k] = std::sqrt(size) * state.w[k];
    add(state.t, state.z.data(), w.data());
  });
  const Trajectory& path = motion.trajectory;
  const std::size_t n = x.size();
  const std::size_t every = std::max<std::size_t>(1, path.nodes() / states_of_motion);
  std::vector<double> z(w.size());
  const auto at_node = [&](const std::vector<double>& of, std::size_t node) {
    const auto begin = of.begin() + static_cast<std::ptrdiff_t>(node * n);
    return model.from_si({begin, begin + static_cast<std::ptrdiff_t>(n)});
  };
  for (std::size_t node = 0; node < path.nodes(); node += every) {
    const std::vector<double> q = at_node(path.q, node);
    const std::vector<double> v = at_node(path.v, node);
    for (std::size_t k = 0; k < z.size(); ++k) {
      z[k] = q[static_cast<std::size_t>(independent_[k])];
      w[k] = v[static_cast<std::size_t>(independent_[k])];
    }
    own.reduced.expect(q.data());
    if (own.reduced.place(path.t[node], z.data()) != Reduced::Status::ok || own.reduced.pivot() < least_pivot) continue;
    add(path.t[node], z.data(), w.data());
  }
  // The time at which a load jumps changes accelerations at that time alone, and rates from then on.
  for (std::size_t i = 0; i < numbers_.size(); ++i) {
    std::size_t jumps = 0;
    own.influences[i].for_each_function(model.scene(), [&](const TimeFunction& function, int number, double) {
      if (!function.is_smooth_in(number)) ++jumps;
    });
    for (std::size_t j = 0; j < jumps; ++j) {
      double when = 0.0;
      const auto jump_in = [&](Acting& acting) -> Eigen::MatrixXd {
        std::size_t at_jump = 0;
        Eigen::MatrixXd jump;
        acting.influences[i].for_each_function(acting.model.scene(), [&](const TimeFunction& function, int number,
                                                                         double by) {
          if (function.is_smooth_in(number) || at_jump++ != j) return;
          const auto& step = std::get<StepInTime>(function.law);
          when = step.at;
          std::size_t node = 0;
          while (node + 1 < path.nodes() && path.t[node] < step.at) ++node;
          if (step.at <= 0 || path.nodes() == 0 || path.t[node] < step.at) return;
          const std::vector<double> q = at_node(path.q, node);
          for (std::size_t k = 0; k < z.size(); ++k) z[k] = q[static_cast<std::size_t>(independent_[k])];
          std::fill(w.begin(), w.end(), 0.0);
          acting.reduced.expect(q.data());
          if (acting.reduced.place(step.at, z.data()) != Reduced::Status::ok) return;
          acting.reduced.move(w.data());
          if (acting.reduced.accelerate() != Reduced::Status::ok) return;
          Influence by_to;
          by_to.force.of = function.of == TimeFunction::Of::force ? ForceNumber::Of::force : ForceNumber::Of::torque;
          by_to.force.item = function.item;
          by_to.force.time_number = 2;
          std::vector<double> alpha(z.size());
          acting.reduced.influence(by_to, alpha.data());
          jump = Eigen::MatrixXd::Zero(acting.rows(), this->unknowns());
          for (int k = 0; k < freedoms_; ++k) {
            jump(k, static_cast<Eigen::Index>(i)) = by * (step.from - step.to) * alpha[static_cast<std::size_t>(k)];
          }
        });
        return jump;
      };
      Eigen::MatrixXd here = jump_in(own);
      Eigen::MatrixXd there = jump_in(changed);
      if (here.rows() == 0 || there.rows() == 0) continue;
      errors.emplace_back(Eigen::MatrixXd::Zero(own.rows(), this->unknowns()));
      rows.push_back(std::move(here));
      rows_again.push_back(std::move(there));
      out.states.push_back({when, model.to_si({own.reduced.q(), own.reduced.q() + x.size()}),
                            model.to_si({own.reduced.v(), own.reduced.v() + x.size()})});
    }
  }
  out.rows_per_state = static_cast<int>(own.rows());
  out.rows.resize(static_cast<Eigen::Index>(rows.size()) * own.rows(), this->unknowns());
  out.again.resize(out.rows.rows(), out.rows.cols());
  out.error.resize(out.rows.rows(), out.rows.cols());
  for (std::size_t s = 0; s < rows.size(); ++s) {
    out.rows.middleRows(static_cast<Eigen::Index>(s) * own.rows(), own.rows()) = rows[s];
    out.again.middleRows(static_cast<Eigen::Index>(s) * own.rows(), own.rows()) = rows_again[s];
    out.error.middleRows(static_cast<Eigen::Index>(s) * own.rows(), own.rows()) = errors[s];
  }
  if (!shifts) return out;
  out.rate.resize(out.rows.rows());
  out.rate_again.resize(out.rows.rows());
  for (std::size_t s = 0; s < rates.size(); ++s) {
    out.rate.segment(static_cast<Eigen::Index>(s) * own.rows(), own.rows()) = rates[s];
    out.rate_again.segment(static_cast<Eigen::Index>(s) * own.rows(), own.rows()) = rates_again[s];
  }
  return out;
}

}  // namespace poise
