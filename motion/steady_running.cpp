#include "motion/steady_running.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <utility>

#include <Eigen/Core>
#include <fmt/format.h>

#include "model/controllers.hpp"
#include "model/input_error.hpp"
#include "motion/private/golden_section.hpp"
#include "solvers/linear_algebra.hpp"
#include "statics/bodies/body_measures.hpp"

namespace poise {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double turn = 2 * std::numbers::pi;
constexpr double running_accuracy = 1e-11;
/// These bound the change of the state over a period, of sizes and speeds.
constexpr double turn_closed_within = 1e-11, turn_closed_at_all = 1e-8;
/// From here Newton's method takes over.
constexpr double near_running = 0.05;
constexpr int most_newton_steps = 20;
/// A first period that takes longer than this, s, is none.
constexpr double longest_period = 1e4;

/// A state on the section a period after another.
struct Turned {
  std::string why;  ///< empty if it reached the section
  VectorXd after;   ///< P(x)
  MatrixXd by;      ///< DP, where asked for
  double period = 0.0;
  Motion motion;  ///< up to the section or a little beyond
};

class Runs {
 public:
  Runs(const MotionModel& model, const MotionState& start, const RunningOptions& options)
      : model_(model), options_(options), from_(start.q) {
    const Scene& scene = model.scene();
    if (!scene.drives.empty()) {
      throw InputError(
          fmt::format("{}:{}: drive \"{}\": expected a machine that runs by its motors, without drives; "
                      "leave it out, or use poise motion",
                      scene.file, scene.drives.front().line, scene.drives.front().name));
    }
    if (!scene.time_functions.empty()) {
      throw InputError(
          fmt::format("{}: \"{}\": expected loads and springs that do not follow time, where a machine "
                      "runs by itself; leave the key time out",
                      scene.file, name_of(scene, scene.time_functions.front())));
    }
    choose_coordinates();
    angle_ = start.q[static_cast<std::size_t>(options.coordinate)];
    const VectorXd y = read(start.q, start.v);
    state_ = on_section(y);
    if (options.guess != 0.0) state_[freedoms() - 1 + section_] = options.guess;
  }

  int freedoms() const { return static_cast<int>(independent_.size()); }
  const VectorXd& start() const { return state_; }
  double direction() const { return direction_; }

  /// Sizes of the state, for a period.
  VectorXd sizes(double period) const {
    VectorXd out(2 * freedoms() - 1);
    int at = 0;
    for (int k = 0; k < freedoms(); ++k) {
      const double unit = unit_[static_cast<std::size_t>(k)];
      if (k != section_) out[at++] = unit;
      out[freedoms() - 1 + k] = unit * turn * options_.turns / period;
    }
    return out;
  }

  /// The motion from a state on the section. Throws InputError where there is no such state.
  Motion move(const VectorXd& x, double duration, bool derivatives, double accuracy) const {
    const int f = freedoms();
    std::vector<StartValue> wanted;
    int at = 0;
    for (int k = 0; k < f; ++k) {
      const int i = independent_[static_cast<std::size_t>(k)];
      wanted.push_back({i, false, k == section_ ? angle_ : x[at++]});
    }
    for (int k = 0; k < f; ++k) wanted.push_back({independent_[static_cast<std::size_t>(k)], true, x[f - 1 + k]});
    MotionOptions options;
    options.duration = duration;
    options.accuracy = accuracy;
    options.sensitivities = options.accurate_sensitivities = derivatives;
    options.independent = independent_;
    options.interrupt = options_.interrupt;
    return simulate(model_, start_motion(model_, wanted, &from_, &independent_), options);
  }

  Turned shoot(const VectorXd& x, bool derivatives, double accuracy) {
    Turned out;
    double duration = last_period_ > 0.0 ? 1.1 * last_period_ : first_duration(x);
    for (;; duration *= 2) {
      try {
        out.motion = move(x, duration, derivatives, accuracy);
      } catch (const InputError& error) {
        out.why = error.what();
        return out;
      }
      const std::optional<double> end = crossing(out.motion.trajectory);
      if (end) {
        out.period = last_period_ = *end;
        read_section(out, derivatives);
        return out;
      }
      if (!out.motion.completed()) {
        out.why = out.motion.why;
        return out;
      }
      if (duration > longest_period) {
        out.why = fmt::format("it makes no whole turn in {:.4g} s", duration);
        return out;
      }
    }
  }

  /// P(x) - x, in which angles count modulo whole turns.
  VectorXd off(const VectorXd& x, const VectorXd& after) const {
    VectorXd out = after - x;
    int at = 0;
    for (int k = 0; k < freedoms(); ++k) {
      if (k == section_) continue;
      if (independent_[static_cast<std::size_t>(k)] < model_.layout().angles) out[at] = std::remainder(out[at], turn);
      ++at;
    }
    return out;
  }

 private:
  /// Takes independent coordinates with the angle among them, those that are conditioned best.
  void choose_coordinates() {
    const std::vector<double> x = model_.from_si(from_);
    ReducedMotion<double> reduced(model_.scaled_scene(), model_.mechanism(), model_.inertia());
    reduced.begin(0.0, x.data());
    independent_ = reduced.independent();
    const auto own = std::find(independent_.begin(), independent_.end(), options_.coordinate);
    if (own == independent_.end()) {
      const std::vector<int> chosen = independent_;
      double best = 0.0;
      for (std::size_t k = 0; k < chosen.size(); ++k) {
        std::vector<int> other = chosen;
        other[k] = options_.coordinate;
        ReducedMotion<double> trial(model_.scaled_scene(), model_.mechanism(), model_.inertia());
        if (trial.begin(0.0, x.data(), &other) != ReducedMotion<double>::Status::ok || !(trial.pivot() > best))
          continue;
        best = trial.pivot();
        independent_ = other;
      }
      if (best == 0.0) {
        throw InputError(fmt::format("{}: expected an angle that is free to turn, nothing moves \"{}\"",
                                     model_.scene().file, name()));
      }
    }
    section_ = static_cast<int>(std::find(independent_.begin(), independent_.end(), options_.coordinate) -
                                independent_.begin());
    for (const int i : independent_) unit_.push_back(i < model_.layout().angles ? 1.0 : model_.scales().length);
  }

  const std::string& name() const {
    return model_.layout().coordinates[static_cast<std::size_t>(options_.coordinate)].name;
  }

  double first_duration(const VectorXd& x) const {
    const double speed = std::abs(x[freedoms() - 1 + section_]);
    return speed > 0.0 ? 1.5 * turn * options_.turns / speed : 1.0;
  }

  VectorXd read(const std::vector<double>& q, const std::vector<double>& v) const {
    VectorXd out(2 * freedoms());
    for (int k = 0; k < freedoms(); ++k) {
      const auto i = static_cast<std::size_t>(independent_[static_cast<std::size_t>(k)]);
      out[k] = q[i];
      out[freedoms() + k] = v[i];
    }
    return out;
  }

  /// Without the angle.
  VectorXd on_section(const VectorXd& y) const {
    VectorXd out(y.size() - 1);
    out << y.head(section_), y.tail(y.size() - section_ - 1);
    return out;
  }

  /// The time at which the angle has turned by a period's turns, either way.
  std::optional<double> crossing(const Trajectory& path) {
    const auto n = static_cast<std::size_t>(path.coordinates), i = static_cast<std::size_t>(options_.coordinate);
    const double whole = turn * options_.turns;
    for (std::size_t node = 1; node < path.nodes(); ++node) {
      const double turned = path.q[node * n + i] - angle_;
      if (std::abs(turned) < whole) continue;
      direction_ = turned > 0.0 ? 1.0 : -1.0;
      TrajectoryReader reader(path, {options_.coordinate});
      double low = path.t[node - 1], high = path.t[node], t = high;
      for (int k = 0; k < 100; ++k) {
        reader.at(t);
        const double off = direction_ * (reader.q(0) - angle_) - whole;
        (off < 0.0 ? low : high) = t;
        const double next = t - off / (direction_ * reader.v(0));
        const double wanted = next > low && next < high ? next : (low + high) / 2;
        if (std::abs(wanted - t) <= 1e-16 * t) break;
        t = wanted;
      }
      return t;
    }
    return std::nullopt;
  }

  void read_section(Turned& shot, bool derivatives) const {
    const int f = freedoms();
    TrajectoryReader reader(shot.motion.trajectory, independent_);
    reader.at(shot.period);
    VectorXd y(2 * f), rate(2 * f);
    MatrixXd by(2 * f, 2 * f);
    for (int k = 0; k < f; ++k) {
      const auto at = static_cast<std::size_t>(k);
      y[k] = reader.q(at);
      y[f + k] = rate[k] = reader.v(at);
      rate[f + k] = reader.a(at);
      for (int c = 0; derivatives && c < 2 * f; ++c) {
        by(k, c) = reader.q_p(at)[static_cast<std::size_t>(c)];
        by(f + k, c) = reader.v_p(at)[static_cast<std::size_t>(c)];
      }
    }
    shot.after = on_section(y);
    if (!derivatives) return;
    const MatrixXd whole = by - rate * by.row(section_) / rate[section_];
    shot.by.resize(2 * f - 1, 2 * f - 1);
    for (int row = 0, to = 0; row < 2 * f; ++row) {
      if (row == section_) continue;
      shot.by.row(to++) = on_section(whole.row(row).transpose()).transpose();
    }
  }

  const MotionModel& model_;
  const RunningOptions& options_;
  std::vector<double> from_;  // closed coordinates, SI
  std::vector<int> independent_;
  std::vector<double> unit_;
  int section_ = 0;  // place of the angle among the independent coordinates
  double angle_ = 0.0, direction_ = 1.0, last_period_ = 0.0;
  VectorXd state_;
};

/// The least and largest rate of the angle within a period: at nodes and between them.
void find_speeds(const RunningOptions& options, SteadyRunning& out) {
  constexpr int within = 24;
  const Trajectory& path = out.motion.trajectory;
  TrajectoryReader reader(path, {options.coordinate});
  struct At {
    double t, speed;
  };
  std::vector<At> all;
  const auto speed_at = [&](double t) {
    reader.at(t);
    return out.direction * reader.v(0);
  };
  for (std::size_t node = 0; node + 1 < path.nodes(); ++node) {
    for (int k = 0; k < within; ++k) {
      const double t = path.t[node] + (path.t[node + 1] - path.t[node]) * k / within;
      if (t > out.period) break;
      all.push_back({t, speed_at(t)});
    }
  }
  all.push_back({out.period, speed_at(out.period)});
  const auto refined = [&](double sign) {
    const auto best = std::max_element(all.begin(), all.end(),
                                       [&](const At& a, const At& b) { return sign * a.speed < sign * b.speed; });
    const double low = best == all.begin() ? best->t : (best - 1)->t;
    const double high = best + 1 == all.end() ? best->t : (best + 1)->t;
    const ValueAt found = least_between([&](double t) { return -sign * speed_at(t); }, low, high, 1e-9 * out.period);
    const double t = found.at, speed = -sign * found.value;
    const bool is_better = sign * speed > sign * best->speed;
    reader.at(is_better ? t : best->t);
    return SpeedAt{is_better ? speed : best->speed, reader.q(0)};
  };
  out.slowest = refined(-1.0);
  out.fastest = refined(1.0);
}

}  // namespace

SteadyRunning steady_running(const MotionModel& model, const MotionState& start, const RunningOptions& options) {
  refuse_blades(model.scene(), "turns of a machine");
  refuse_states_of_controllers(model.scene(), "steady runnings");
  SteadyRunning out;
  Runs runs(model, start, options);
  VectorXd x = runs.start();
  const auto interrupted = [&] { return options.interrupt != nullptr && options.interrupt->load(); };
  const auto relative = [&](const Turned& shot, const VectorXd& before) {
    return runs.off(before, shot.after).cwiseQuotient(runs.sizes(shot.period)).cwiseAbs().maxCoeff();
  };
  Turned shot;
  for (double near = near_running; near > turn_closed_within; near /= 10) {
    for (;;) {
      if (out.periods >= options.most_turns) {
        out.why = fmt::format("after {} periods its speed still changes from each to the next, by {:.2g} of it",
                              out.periods, relative(shot, x));
        return out;
      }
      shot = runs.shoot(x, false, running_accuracy);
      if (interrupted()) shot.why = "interrupted";
      if (!shot.why.empty()) {
        out.why = std::move(shot.why);
        return out;
      }
      ++out.periods;
      if (options.progress) options.progress(out.periods);
      const bool is_near = relative(shot, x) < near;
      x += runs.off(x, shot.after);
      if (is_near) break;
    }
    VectorXd at = x;
    for (int step = 0; step < most_newton_steps; ++step) {
      shot = runs.shoot(at, true, running_accuracy);
      if (!shot.why.empty()) break;
      const VectorXd size = runs.sizes(shot.period), off = runs.off(at, shot.after);
      const double residual = off.cwiseQuotient(size).cwiseAbs().maxCoeff();
      if (residual > 1.0) break;
      const MatrixXd scaled = size.cwiseInverse().asDiagonal() * shot.by * size.asDiagonal();
      const MatrixXd J = MatrixXd::Identity(at.size(), at.size()) - scaled;
      const VectorXd change =
          size.cwiseProduct(solvers::minimum_norm_solution<double>(J, VectorXd(off.cwiseQuotient(size))));
      at += change;
      // Where the speed grows without end the residual falls, but not the step.
      const double step_size = change.cwiseQuotient(size).cwiseAbs().maxCoeff();
      if (residual < turn_closed_at_all && step_size < turn_closed_at_all) {
        out.found = true;
        break;
      }
    }
    if (!out.found) continue;
    const VectorXd size = runs.sizes(shot.period);
    for (const std::complex<double>& one :
         solvers::eigenpairs(MatrixXd(size.cwiseInverse().asDiagonal() * shot.by * size.asDiagonal())).values) {
      out.multipliers.push_back(one);
    }
    std::sort(out.multipliers.begin(), out.multipliers.end(),
              [](const auto& a, const auto& b) { return std::abs(a) > std::abs(b); });
    out.stable = out.multipliers.empty() || std::abs(out.multipliers.front()) < 1.0;
    Turned again = runs.shoot(at, false, running_accuracy / 100);
    out.found = again.why.empty();
    if (!out.found) {
      out.why = std::move(again.why);
      return out;
    }
    out.residual = relative(again, at);
    out.period = again.period;
    out.direction = runs.direction();
    out.mean = turn * options.turns / out.period;
    out.motion = runs.move(at, out.period, false, running_accuracy / 100);
    out.error = difference(out.motion, runs.move(at, out.period, false, running_accuracy));
    if (out.residual > turn_closed_at_all) {
      out.found = false;
      out.why = fmt::format("its state after a period differs by {:.2g} from that before", out.residual);
    }
    find_speeds(options, out);
    return out;
  }
  out.why = "its running could not be closed: after a period it is not where it was";
  return out;
}

}  // namespace poise
