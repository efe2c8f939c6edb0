#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "identification/prediction/private/quantity_reader.hpp"
#include "identification/prediction/private/sensor_reader.hpp"
#include "identification/prediction/random_states.hpp"
#include "identification/prediction/run_model.hpp"
#include "motion/contacts.hpp"
#include "solvers/random_stream.hpp"

namespace poise {
namespace {

using Reduced = ReducedMotion<double>;

/// A sum that is smaller than its terms by this is rounding of them and of the pose.
constexpr double lost_in_terms = 0x1p12 * std::numeric_limits<double>::epsilon();
/// What a change of a number by 100 % changes by this part of the acceleration at most is rounding of that.
constexpr double lost_in_whole = 50 * std::numeric_limits<double>::epsilon();
/// States of the run's own motion.
constexpr std::size_t states_of_motion = 20;
/// Poses nearer to a dead point are left out: rounding would grow with their condition.
constexpr double least_pivot = 1e-3;
/// Further impacts at the same limit tell the same.
constexpr std::ptrdiff_t most_impacts_of_side = 2;

/// The derivatives of a quantity are wrong by this part of their terms, and by this part of the quantity itself where a
/// number changes by all of it.
constexpr double lost_in_differences = 1e-7, lost_in_quantity = 1e-10;

/// An unknown number of a sensor that is read.
struct ReadNumber {
  SensorNumber::Of of;
  std::size_t reader;
  double zero, factor;
};

/// A run's model with what its unknowns change.
struct Acting {
  Acting(const MotionModel& m, const std::vector<Influence>& i, const std::vector<Variation>& v,
         const std::vector<Sensor>& s, std::vector<std::optional<VariedQuantity>> of_quantities,
         const std::vector<MotionInput>& inputs)
      : model(m),
        influences(i),
        variations(v),
        sensors(s),
        reduced(m.scaled_scene(), m.mechanism(), m.inertia()),
        quantities(std::move(of_quantities)) {
    for (const Sensor& sensor : sensors) {
      std::optional<SensorReader>& reader = readers.emplace_back();
      if (!sensor.quantity) reader.emplace(model, sensor);
    }
    for (const Variation& variation : variations) {
      std::vector<std::optional<SensorVariation>>& of_sensors = varied.emplace_back();
      for (const Sensor& sensor : sensors) {
        std::optional<SensorVariation>& of_sensor = of_sensors.emplace_back();
        if (!sensor.quantity) of_sensor.emplace(variation, sensor);
      }
    }
    reduced.set_inputs(m.scaled_scene(), scaled(inputs, m.scene(), m.scales()));
    reduced.set_variations(variations);
  }

  const MotionModel& model;
  const std::vector<Influence>& influences;
  const std::vector<Variation>& variations;
  const std::vector<Sensor>& sensors;
  Reduced reduced;
  std::vector<std::optional<SensorReader>> readers;                 // none of one that reads a quantity
  std::vector<std::vector<std::optional<SensorVariation>>> varied;  // by variation and sensor
  std::vector<std::optional<VariedQuantity>> quantities;            // none of the others
  // They hold the sizes of what the derivatives of alpha by at() are sums of, and the errors of those of quantities.
  Eigen::MatrixXd terms, unsure;

  Eigen::Index rows() const { return reduced.freedoms() + static_cast<Eigen::Index>(sensors.size()); }

  /// d(reading)/d(number), one column for each number of the sensors, as the readings of at(), which are before they
  /// are multiplied by what turns the quantity into the column. At the state of the last at().
  Eigen::MatrixXd by_sensor_numbers(const std::vector<ReadNumber>& numbers) {
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(rows(), static_cast<Eigen::Index>(numbers.size()));
    const std::size_t n = static_cast<std::size_t>(reduced.coordinates());
    const std::vector<double> q = model.to_si({reduced.q(), reduced.q() + n});
    const std::vector<double> v = model.to_si({reduced.v(), reduced.v() + n});
    const std::vector<double> a = model.to_si({reduced.a(), reduced.a() + n});
    const bool jerks = std::any_of(numbers.begin(), numbers.end(), [&](const ReadNumber& number) {
      const Sensor& sensor = sensors[number.reader];
      return number.of == SensorNumber::Of::delay && (sensor.reads_acceleration() || sensor.quantity);
    });
    const std::vector<double> jerk = jerks ? change_of_accelerations() : std::vector<double>();
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const ReadNumber& number = numbers[i];
      double value = 0.0, change = 0.0;
      if (std::optional<VariedQuantity>& quantity = quantities[number.reader]) {
        const MovingState here = state();
        value = quantity->read(reduced.time(), here);
        if (!jerk.empty()) change = quantity->by_time(reduced.time(), here, model.from_si(jerk));
      } else {
        const Read now = read(*readers[number.reader], q, v, a);
        value = now.value;
        change = now.along(v.data(), a.data(), jerk.empty() ? nullptr : jerk.data());
      }
      out(reduced.freedoms() + static_cast<Eigen::Index>(number.reader), static_cast<Eigen::Index>(i)) =
          number.of == SensorNumber::Of::zero     ? -1.0
          : number.of == SensorNumber::Of::factor ? (number.zero - value) / number.factor
                                                  : -change;
    }
    return out;
  }

  /// The derivatives of all accelerations by time along the motion, SI: what loads and drives change with time itself
  /// by differences. After at(), whose state it leaves.
  std::vector<double> change_of_accelerations() {
    const std::size_t n = static_cast<std::size_t>(reduced.coordinates());
    std::vector<double> out(n, 0.0), z, w;
    for (int k = 0; k < reduced.freedoms(); ++k) {
      const auto own = static_cast<std::size_t>(reduced.independent()[k]);
      z.push_back(reduced.q()[own]);
      w.push_back(reduced.v()[own]);
      for (std::size_t i = 0; i < n; ++i)
        out[i] += reduced.a_z(k)[i] * w.back() + reduced.a_w(k)[i] * reduced.alpha()[k];
    }
    if (reduced.drives() > 0 || !reduced.inputs().empty()) {
      constexpr double step = 1e-5;  // s
      const double now = reduced.time();
      for (const double side : {1.0, -1.0}) {
        if (reduced.evaluate(now + side * step, z.data(), w.data()) != Reduced::Status::ok) continue;
        for (std::size_t i = 0; i < n; ++i) out[i] += side * reduced.a()[i] / (2 * step);
      }
      reduced.evaluate(now, z.data(), w.data());
      reduced.linearize();
    }
    return model.to_si(out);
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
    unsure = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(sensors.size()), out.cols());
    std::vector<double> alpha(static_cast<std::size_t>(f));
    reduced.linearize();
    const std::size_t n = static_cast<std::size_t>(reduced.coordinates());
    const std::vector<double> q = model.to_si({reduced.q(), reduced.q() + n});
    const std::vector<double> v = model.to_si({reduced.v(), reduced.v() + n});
    const std::vector<double> a = model.to_si({reduced.a(), reduced.a() + n});
    for (std::size_t p = 0; p < influences.size(); ++p) {
      reduced.influence(influences[p], alpha.data());
      out.col(static_cast<Eigen::Index>(p)).head(f) = Eigen::Map<const Eigen::VectorXd>(alpha.data(), f);
      reduced.influence_terms(influences[p], terms.col(static_cast<Eigen::Index>(p)).data());
      for (std::size_t k = 0; k < sensors.size(); ++k) {
        double& by = out(f + static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(p));
        if (quantities[k]) {
          by = by_number(*quantities[k], p, alpha, numbers[p].get(model.scene()),
                         unsure(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(p)));
          continue;
        }
        if (sensors[k].reads_force()) {
          const double g = read(*readers[k], q, v, a).measure;
          by += numbers[p].force_by(model.scene(), sensors[k].element, g, 0.0);
        }
        if (!influences[p].moves()) continue;
        const std::vector<double> q_p = model.to_si({reduced.q_p(), reduced.q_p() + n});
        const std::vector<double> v_p = model.to_si({reduced.v_p(), reduced.v_p() + n});
        const std::vector<double> a_p = model.to_si({reduced.a_p(), reduced.a_p() + n});
        by += read(*readers[k], q, v, a).along(q_p.data(), v_p.data(), a_p.data());
        if (influences[p].variation < 0) continue;
        SensorVariation& direct = *varied[static_cast<std::size_t>(influences[p].variation)][k];
        by += direct.read(some(q, direct).data(), some(v, direct).data(), some(a, direct).data());
      }
    }
    return out;
  }

  /// Gives d(jump of the rates)/dp of the impact at these independent coordinates and rates, and below these rows, in
  /// the first of as many, d(time of the impact)/dp; one column for each influence. Empty where nothing hits there.
  Eigen::MatrixXd at_impact(double t, const double* z, const double* w) {
    if (reduced.evaluate(t, z, w) != Reduced::Status::ok) return {};
    const auto n = static_cast<std::size_t>(reduced.coordinates());
    const std::vector<double> q(reduced.q(), reduced.q() + n), v(reduced.v(), reduced.v() + n), still(n, 0.0);
    Contacts contacts(model, variations);
    Reduced hits(model.scaled_scene(), model.mechanism(), model.inertia());
    hits.set_inputs(model.scaled_scene(), reduced.inputs());
    const Contacts::Hit hit = contacts.hit(hits, t, q, v);
    if (hit.outcome != Contacts::Hit::Outcome::done) return {};
    reduced.linearize();
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(2 * rows(), static_cast<Eigen::Index>(influences.size()));
    std::vector<double> alpha(static_cast<std::size_t>(reduced.freedoms()));
    std::vector<std::vector<double>> places, rates, changes(influences.size(), still);
    std::vector<Contacts::JumpChange> jumps;
    for (std::size_t p = 0; p < influences.size(); ++p) {
      reduced.influence(influences[p], alpha.data());
      const bool moves = influences[p].moves();
      places.push_back(moves ? std::vector<double>(reduced.q_p(), reduced.q_p() + n) : still);
      rates.push_back(moves ? std::vector<double>(reduced.v_p(), reduced.v_p() + n) : still);
      jumps.push_back({places[p].data(), rates[p].data(), &influences[p], changes[p].data()});
      out(rows(), static_cast<Eigen::Index>(p)) =
          contacts.hit_time_by(hits, hit.first, v.data(), places[p].data(), influences[p].variation);
    }
    contacts.change_jump(hits, hit, t, q, v, jumps);
    for (std::size_t p = 0; p < influences.size(); ++p) {
      for (int k = 0; k < reduced.freedoms(); ++k) {
        out(k, static_cast<Eigen::Index>(p)) = changes[p][static_cast<std::size_t>(reduced.independent()[k])];
      }
    }
    return out;
  }

  struct Read {
    double value = 0.0, measure = 0.0;
    const SensorReader* reader = nullptr;

    /// The change along q', v' and a'; null of accelerations that no sensor needs.
    double along(const double* q_p, const double* v_p, const double* a_p) const {
      const std::vector<int>& on = reader->coordinates();
      const SensorReader::Derivatives& by = reader->derivatives();
      double out = 0.0;
      for (std::size_t i = 0; i < on.size(); ++i) {
        out += by.by_q[i] * q_p[on[i]] + by.by_v[i] * v_p[on[i]];
        if (a_p != nullptr) out += by.by_a[i] * a_p[on[i]];
      }
      return out;
    }
  };
  static Read read(SensorReader& reader, const std::vector<double>& q, const std::vector<double>& v,
                   const std::vector<double>& a) {
    Read out;
    out.value = reader.read(some(q, reader).data(), some(v, reader).data(), some(a, reader).data());
    out.measure = reader.measure();
    out.reader = &reader;
    return out;
  }

  MovingState state() const {
    const auto n = static_cast<std::size_t>(reduced.coordinates());
    return {{reduced.q(), reduced.q() + n}, {reduced.v(), reduced.v() + n}, {reduced.a(), reduced.a() + n}};
  }

  /// After influence() of number p, which gave alpha: the derivative of a quantity, and its error.
  double by_number(VariedQuantity& quantity, std::size_t p, const std::vector<double>& alpha, double value,
                   double& error) const {
    const auto n = static_cast<std::size_t>(reduced.coordinates());
    const MovingState here = state();
    MovingState change{std::vector<double>(n, 0.0), std::vector<double>(n, 0.0), std::vector<double>(n, 0.0)};
    if (influences[p].moves()) {
      change = {
          {reduced.q_p(), reduced.q_p() + n}, {reduced.v_p(), reduced.v_p() + n}, {reduced.a_p(), reduced.a_p() + n}};
    } else {
      for (int k = 0; k < reduced.freedoms(); ++k) {
        for (std::size_t i = 0; i < n; ++i) change.a[i] += reduced.B(k)[i] * alpha[static_cast<std::size_t>(k)];
      }
    }
    const double t = reduced.time();
    const double along = quantity.along(t, here, change), direct = quantity.by_number(p, t, here);
    error = lost_in_differences * (std::abs(along) + std::abs(direct));
    if (value != 0) error += lost_in_quantity * std::abs(quantity.read(t, here) / value);
    return along + direct;
  }

  /// The values of the coordinates that a sensor depends on.
  template <class Reader>
  static std::vector<double> some(const std::vector<double>& all, const Reader& reader) {
    std::vector<double> out;
    for (const int i : reader.coordinates()) out.push_back(all[static_cast<std::size_t>(i)]);
    return out;
  }
};

}  // namespace

/// Gathers the rows of actions() at one state after the other: those of the scene, and those of the scene disturbed.
class RunModel::ActionRows {
 public:
  ActionRows(const RunModel& run, const Built& built, const double* unknowns)
      : run_(run),
        model_(*built.model),
        unknowns_(unknowns),
        x_(model_.from_si(built.q)),
        numbers_(run.numbers_),
        sensors_(sensors_that_are_read(unknowns)),
        near_model_(std::make_shared<const MotionModel>(disturbed(model_.scene()), run.scales_, run.varying_)),
        changes_(changes_of(near_model_)),
        own_(model_, built.influences, built.variations, sensors_, quantities_in(built.model),
             run.inputs_in(model_.scene())),
        changed_(*near_model_, changes_.influences, changes_.variations, sensors_, quantities_in(near_model_),
                 run.inputs_in(near_model_->scene())),
        p_(static_cast<Eigen::Index>(run.numbers_.size())),
        z_(static_cast<std::size_t>(run.freedoms_), 0.0),
        w_(z_) {
    if (run.set_by_equilibrium_) numbers_.push_back(*run.set_by_equilibrium_);
    for (Acting* acting : {&own_, &changed_}) {
      acting->reduced.begin(0.0, x_.data(), &run.independent_);
    }
    const bool any_delay = std::any_of(of_sensors_.begin(), of_sensors_.end(),
                                       [](const ReadNumber& number) { return number.of == SensorNumber::Of::delay; });
    timed_ = own_.reduced.drives() > 0 || run.has_inputs();
    shifts_ = run.start_unknown_ && any_delay && !timed_;
    out_.scene = model_.scene();
  }

  /// The number that an equilibrium sets follows the others: alpha = 0 there. False where it does not.
  bool follow_equilibrium() {
    return !run_.set_by_equilibrium_ || (follow(own_, own_follows_) && follow(changed_, changed_follows_));
  }

  void add_random_states(int states) {
    visit_random_states(own_.reduced, x_, states, timed_ ? run_.span() : 0.0, [&](const RandomState& state) {
      // Rates at which forces of inertia are about as large as the others.
      std::fill(w_.begin(), w_.end(), 0.0);
      own_.reduced.move(w_.data());
      double size = 1.0;
      if (own_.reduced.accelerate() == Reduced::Status::ok) {
        for (int k = 0; k < run_.freedoms_; ++k) size = std::max(size, std::abs(own_.reduced.alpha()[k]));
      }
      for (std::size_t k = 0; k < w_.size(); ++k) w_[k] = std::sqrt(size) * state.w[k];
      add(state.t, state.z.data(), w_.data());
    });
  }

  void add_motion(const Trajectory& path) {
    const std::size_t every = std::max<std::size_t>(1, path.nodes() / states_of_motion);
    for (std::size_t node = 0; node < path.nodes(); node += every) {
      const std::vector<double> q = at_node(path.q, node);
      z_ = independent_in(q);
      w_ = independent_in(at_node(path.v, node));
      own_.reduced.expect(q.data());
      if (own_.reduced.place(path.t[node], z_.data()) != Reduced::Status::ok || own_.reduced.pivot() < least_pivot)
        continue;
      add(path.t[node], z_.data(), w_.data());
    }
  }

  /// The time at which a load jumps changes accelerations at that time alone, and rates from then on.
  void add_jumps(const Trajectory& path) {
    for (std::size_t i = 0; i < run_.numbers_.size(); ++i) {
      const std::vector<Jump> own = jumps_by(own_, i), changed = jumps_by(changed_, i);
      for (std::size_t j = 0; j < own.size(); ++j) {
        Eigen::MatrixXd here = row_of(own_, own[j], i, path), there = row_of(changed_, changed[j], i, path);
        if (here.rows() == 0 || there.rows() == 0) continue;
        errors_.emplace_back(Eigen::MatrixXd::Zero(own_.rows(), run_.unknowns()));
        rows_.push_back(std::move(here));
        rows_again_.push_back(std::move(there));
        add_state(changed[j].jump.at);
      }
    }
  }

  /// Limits of stops and what their impacts give back act in impacts alone, and so do masses of bodies that no force
  /// moves.
  void add_impacts(const Motion& motion) {
    std::vector<Touch> met;
    for (const ContactEvent& event : motion.events) {
      if (event.kind != ContactEvent::Kind::impact) continue;
      if (std::count(met.begin(), met.end(), event.at) == most_impacts_of_side) continue;
      met.push_back(event.at);
      const Trajectory& path = motion.trajectory;
      const std::size_t node = node_from(path, event.t - 1e-12 * run_.span());
      if (node == path.nodes()) continue;
      const std::vector<double> q = at_node(path.q, node);
      z_ = independent_in(q);
      w_ = independent_in(at_node(path.v, node));
      own_.reduced.expect(q.data());
      changed_.reduced.expect(q.data());
      Eigen::MatrixXd here = own_.at_impact(path.t[node], z_.data(), w_.data());
      Eigen::MatrixXd there = changed_.at_impact(path.t[node], z_.data(), w_.data());
      if (here.rows() == 0 || there.rows() == 0) continue;
      let_equilibrium_follow(here, there);
      if (!here.allFinite() || !there.allFinite()) continue;
      out_.has_impacts = true;
      for (const Eigen::Index first : {Eigen::Index{0}, own_.rows()}) {
        errors_.emplace_back(Eigen::MatrixXd::Zero(own_.rows(), run_.unknowns()));
        rows_.push_back(errors_.back());
        rows_.back().leftCols(p_) = here.block(first, 0, own_.rows(), p_);
        rows_again_.push_back(errors_.back());
        rows_again_.back().leftCols(p_) = there.block(first, 0, own_.rows(), p_);
        add_state(path.t[node]);
        if (!shifts_) continue;
        rates_.emplace_back(Eigen::VectorXd::Zero(own_.rows()));
        rates_again_.push_back(rates_.back());
      }
    }
  }

  Actions take() {
    const auto stack = [&](const auto& parts, auto& to, Eigen::Index columns) {
      to.resize(static_cast<Eigen::Index>(parts.size()) * own_.rows(), columns);
      for (std::size_t s = 0; s < parts.size(); ++s)
        to.middleRows(static_cast<Eigen::Index>(s) * own_.rows(), own_.rows()) = parts[s];
    };
    out_.rows_per_state = static_cast<int>(own_.rows());
    stack(rows_, out_.rows, run_.unknowns());
    stack(rows_again_, out_.again, run_.unknowns());
    stack(errors_, out_.error, run_.unknowns());
    if (shifts_) {
      stack(rates_, out_.rate, 1);
      stack(rates_again_, out_.rate_again, 1);
    }
    return std::move(out_);
  }

 private:
  /// A load that jumps at a time that depends on a number, and by how much that time does.
  struct Jump {
    ForceNumber whole;
    JumpInTime jump;
    double by;
  };

  std::vector<Sensor> sensors_that_are_read(const double* unknowns) {
    std::vector<Sensor> out;
    const std::vector<Scaling> scaling = run_.scalings(unknowns);
    for (std::size_t k = 0; k < run_.times_.size(); ++k) {
      if (run_.times_[k].empty()) continue;
      for (std::size_t i = 0; i < run_.sensor_numbers_.size(); ++i) {
        const SensorNumber& number = run_.sensor_numbers_[i];
        if (number.sensor != k) continue;
        of_sensors_.push_back({number.of, out.size(), scaling[k].zero, scaling[k].factor});
        places_.push_back(static_cast<Eigen::Index>(run_.numbers_.size() + i));
      }
      out.push_back(run_.experiment_.sensors[k]);
    }
    return out;
  }

  /// Gives the sensors that are read their quantities in a model; none where they read a measure.
  std::vector<std::optional<VariedQuantity>> quantities_in(const std::shared_ptr<const MotionModel>& model) const {
    std::vector<std::optional<VariedQuantity>> out;
    for (std::size_t k = 0; k < run_.times_.size(); ++k) {
      if (run_.times_[k].empty()) continue;
      out.emplace_back();
      if (run_.experiment_.sensors[k].quantity) out.back().emplace(run_.quantity_of(k, model, true));
    }
    return out;
  }

  Built changes_of(const std::shared_ptr<const MotionModel>& model) const {
    Built out;
    run_.vary(model, out);
    if (run_.set_by_equilibrium_) {
      out.influences.push_back(run_.set_by_equilibrium_->influence(model->scene(), run_.scales_));
    }
    return out;
  }

  bool follow(Acting& acting, Eigen::RowVectorXd& by) const {
    const double z = x_[static_cast<std::size_t>(run_.independent_[0])];
    const std::vector<double> still(static_cast<std::size_t>(run_.freedoms_), 0.0);
    acting.reduced.expect(x_.data());
    if (acting.reduced.place(0.0, &z) != Reduced::Status::ok) return false;
    const Eigen::MatrixXd rows = acting.at(still.data(), numbers_);
    if (rows.rows() == 0 || rows(0, p_) == 0) return false;
    by = -rows.row(0).head(p_) / rows(0, p_);
    return true;
  }

  /// Adds to the columns of the numbers what follows through the one that the equilibrium sets.
  void let_equilibrium_follow(Eigen::MatrixXd& here, Eigen::MatrixXd& there) const {
    if (!run_.set_by_equilibrium_) return;
    here.leftCols(p_) += here.col(p_) * own_follows_;
    there.leftCols(p_) += there.col(p_) * changed_follows_;
  }

  /// At the pose placed.
  void add(double t, const double* z, const double* w) {
    Eigen::MatrixXd here = own_.at(w, numbers_);
    changed_.reduced.expect(own_.reduced.q());
    // Rounding that no number takes part in, of the sine of an angle say, follows the state.
    std::vector<double> near_z(z, z + run_.freedoms_);
    std::vector<double> near_w(w, w + run_.freedoms_);
    for (auto* values : {&near_z, &near_w}) {
      for (double& value : *values) value *= 1 + random_.uniform(-disturbance, disturbance);
    }
    if (here.rows() == 0 || changed_.reduced.place(t, near_z.data()) != Reduced::Status::ok) return;
    Eigen::MatrixXd there = changed_.at(near_w.data(), numbers_);
    if (there.rows() == 0) return;
    let_equilibrium_follow(here, there);
    if (run_.set_by_equilibrium_) own_.terms.leftCols(p_) += own_.terms.col(p_) * own_follows_.cwiseAbs();
    if (!here.allFinite() || !there.allFinite()) return;
    errors_.push_back(lost_by_rounding());
    rows_.push_back(with_sensors(own_, here));
    rows_again_.push_back(with_sensors(changed_, there));
    add_state(t);
    if (!shifts_) return;
    rates_.push_back(own_.rates());
    rates_again_.push_back(changed_.rates());
  }

  Eigen::MatrixXd lost_by_rounding() const {
    Eigen::MatrixXd lost = Eigen::MatrixXd::Zero(own_.rows(), run_.unknowns());
    for (int k = 0; k < run_.freedoms_; ++k) {
      const double whole = std::abs(own_.reduced.alpha()[k]);
      for (Eigen::Index i = 0; i < p_; ++i) {
        lost(k, i) = lost_in_terms * own_.terms(k, i);
        if (unknowns_[i] != 0) lost(k, i) = std::max(lost(k, i), lost_in_whole * whole / std::abs(unknowns_[i]));
      }
    }
    lost.block(run_.freedoms_, 0, own_.unsure.rows(), p_) = own_.unsure.leftCols(p_);
    return lost;
  }

  Eigen::MatrixXd with_sensors(Acting& acting, const Eigen::MatrixXd& of_scene) const {
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(acting.rows(), run_.unknowns());
    all.leftCols(p_) = of_scene.leftCols(p_);
    all(Eigen::all, places_) = acting.by_sensor_numbers(of_sensors_);
    return all;
  }

  void add_state(double t) {
    out_.states.push_back({t, model_.to_si({own_.reduced.q(), own_.reduced.q() + x_.size()}),
                           model_.to_si({own_.reduced.v(), own_.reduced.v() + x_.size()})});
  }

  static std::vector<Jump> jumps_by(const Acting& acting, std::size_t number) {
    std::vector<Jump> out;
    acting.influences[number].for_each_function(
        acting.model.scene(), [&](const TimeFunction& function, int of_function, double by) {
          if (const std::optional<JumpInTime> jump = function.law.jump_by(of_function)) {
            out.push_back({force_number(function.of, function.item, function.part, TimeFunction::whole), *jump, by});
          }
        });
    return out;
  }

  /// None where the motion does not reach the jump.
  Eigen::MatrixXd row_of(Acting& acting, const Jump& jump, std::size_t number, const Trajectory& path) {
    const double when = jump.jump.at;
    const std::size_t node = node_from(path, when);
    if (when <= 0 || node == path.nodes()) return {};
    const std::vector<double> q = at_node(path.q, node);
    z_ = independent_in(q);
    std::fill(w_.begin(), w_.end(), 0.0);
    acting.reduced.expect(q.data());
    if (acting.reduced.evaluate(when, z_.data(), w_.data()) != Reduced::Status::ok) return {};
    Influence by_to;
    by_to.force = jump.whole;
    std::vector<double> alpha(z_.size());
    acting.reduced.influence(by_to, alpha.data());
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(acting.rows(), run_.unknowns());
    for (int k = 0; k < run_.freedoms_; ++k) {
      out(k, static_cast<Eigen::Index>(number)) = -jump.by * jump.jump.by * alpha[static_cast<std::size_t>(k)];
    }
    return out;
  }

  /// The first node at this time or later; their number if there is none.
  static std::size_t node_from(const Trajectory& path, double t) {
    return static_cast<std::size_t>(std::lower_bound(path.t.begin(), path.t.end(), t) - path.t.begin());
  }

  std::vector<double> at_node(const std::vector<double>& of, std::size_t node) const {
    const auto begin = of.begin() + static_cast<std::ptrdiff_t>(node * x_.size());
    return model_.from_si({begin, begin + static_cast<std::ptrdiff_t>(x_.size())});
  }

  std::vector<double> independent_in(const std::vector<double>& full) const {
    std::vector<double> out;
    for (const int i : run_.independent_) out.push_back(full[static_cast<std::size_t>(i)]);
    return out;
  }

  const RunModel& run_;
  const MotionModel& model_;
  const double* unknowns_;
  std::vector<double> x_;
  std::vector<SceneParameter> numbers_;
  std::vector<ReadNumber> of_sensors_;
  std::vector<Eigen::Index> places_;  // of these among the unknowns
  std::vector<Sensor> sensors_;
  std::shared_ptr<const MotionModel> near_model_;
  Built changes_;
  Acting own_, changed_;
  Eigen::Index p_;
  bool timed_ = false, shifts_ = false;
  Eigen::RowVectorXd own_follows_, changed_follows_;
  solvers::RandomStream random_{4};
  std::vector<double> z_, w_;
  std::vector<Eigen::MatrixXd> rows_, rows_again_, errors_;
  std::vector<Eigen::VectorXd> rates_, rates_again_;
  Actions out_;
};

RunModel::Actions RunModel::actions(const double* unknowns, const double* nuisances, int states) const {
  if (is_at_rest()) return actions_at_rest(unknowns, states);
  Actions none;
  const Built built = build(unknowns, equilibrium_unknown_ ? nuisances[0] : equilibrium_at(), true);
  if (!built.model) return none;
  const Motion motion = move(built, nuisances, std::max(span(), 1e-9), 1e-6, false, nullptr);
  ActionRows rows(*this, built, unknowns);
  none.scene = built.model->scene();
  if (!rows.follow_equilibrium()) return none;
  rows.add_random_states(states);
  rows.add_motion(motion.trajectory);
  rows.add_jumps(motion.trajectory);
  rows.add_impacts(motion);
  return rows.take();
}

}  // namespace poise
