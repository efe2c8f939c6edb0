#include "motion/steady_running.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <string>
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
constexpr int most_newton_steps = 60;
/// It takes over again where the speed has changed by this part since.
constexpr double elsewhere = 0.25;
/// This bounds the difference of a period and the next one, of sizes and speeds; what grows by more winds up.
constexpr double turn_repeated_within = 1e-6;
/// Periods after which all bodies may be back, and turns that are taken without being asked for.
constexpr int most_periods = 30, most_turns_of_itself = 12;
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

  /// Where the rate of the angle is in a state.
  Index place_of_speed() const { return freedoms() - 1 + section_; }
  /// The largest part of off(), over the sizes of the period.
  double relative_off(const VectorXd& x, const Turned& shot) const {
    return off(x, shot.after).cwiseQuotient(sizes(shot.period)).cwiseAbs().maxCoeff();
  }
  /// The least number of periods from there, up to `most`, after which all bodies are where they were; 0 without one.
  int periods_until_back(const VectorXd& x, double period, int most) {
    constexpr double longer = 1.5, back_within = 1e-6;
    const Motion motion = move(x, longer * most * period, false, running_accuracy);
    std::vector<int> all(from_.size());
    std::iota(all.begin(), all.end(), 0);
    TrajectoryReader begin(motion.trajectory, all), reader(motion.trajectory, all);
    begin.at(0.0);
    for (int count = 1; count <= most; ++count) {
      const std::optional<double> t = crossing(motion.trajectory, count);
      if (!t) return 0;
      reader.at(*t);
      bool is_back = true;
      for (std::size_t i = 0; i < all.size(); ++i) {
        const bool turns = static_cast<int>(i) < model_.layout().angles;
        const double moved = reader.q(i) - begin.q(i);
        const double off = turns ? std::remainder(moved, turn) : moved / model_.scales().length;
        is_back = is_back && std::abs(off) <= back_within;
      }
      if (is_back) return count;
    }
    return 0;
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

  /// The time at which the angle has turned by the turns of so many periods, either way.
  std::optional<double> crossing(const Trajectory& path, int periods = 1) {
    const auto n = static_cast<std::size_t>(path.coordinates), i = static_cast<std::size_t>(options_.coordinate);
    const double whole = turn * options_.turns * periods;
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

/// How far all coordinates have moved over a period, and whether the next period repeats it.
struct Repeated {
  VectorXd moved;
  double differs = 0.0;  ///< the next one, over sizes and speeds
};

Repeated repeat(const MotionModel& model, const Runs& runs, const VectorXd& x, double period) {
  const int n = model.mechanism().coordinates();
  std::vector<int> all(static_cast<std::size_t>(n));
  std::iota(all.begin(), all.end(), 0);
  const Motion motion = runs.move(x, 2 * period, false, running_accuracy / 100);
  Repeated out;
  if (!motion.completed()) {
    out.moved = VectorXd::Zero(n);
    out.differs = std::numeric_limits<double>::infinity();
    return out;
  }
  TrajectoryReader reader(motion.trajectory, all);
  const auto read = [&](double t, auto part) {
    reader.at(t);
    VectorXd values(n);
    for (int i = 0; i < n; ++i) values[i] = (reader.*part)(static_cast<std::size_t>(i));
    return values;
  };
  const VectorXd first = read(0.0, &TrajectoryReader::q), second = read(period, &TrajectoryReader::q),
                 third = read(2 * period, &TrajectoryReader::q);
  const VectorXd rates = read(2 * period, &TrajectoryReader::v) - read(period, &TrajectoryReader::v);
  out.moved = second - first;
  for (int i = 0; i < n; ++i) {
    const double unit = i < model.layout().angles ? 1.0 : model.scales().length;
    out.differs = std::max({out.differs, std::abs(third[i] - second[i] - out.moved[i]) / unit,
                            std::abs(rates[i]) * period / (turn * unit)});
  }
  return out;
}

/// Names what a whole turn does not bring back: a spring that winds up, a limit that is reached in the end, a place
/// that is controlled; empty if nothing. Where bodies are not `back`, of angles alone, which never are.
std::string what_winds_up(const MotionModel& model, const VectorXd& q, const VectorXd& moved, bool back) {
  const Scene& scene = model.scene();
  const auto poses_at = [&](const VectorXd& at) {
    return model.mechanism().poses(model.from_si({at.data(), at.data() + at.size()}).data());
  };
  const std::vector<BodyPose<double>> before = poses_at(q), after = poses_at(q + moved);
  const Scene& scaled = model.scaled_scene();
  const auto winds = [&](const Measure& on) {
    if (!back && on.kind != Measure::Kind::angle) return false;
    return std::abs(value_of(scaled, on, after) - value_of(scaled, on, before)) > turn_repeated_within;
  };
  for (std::size_t e = 0; e < scene.elements.size(); ++e) {
    const Element& element = scene.elements[e];
    const Controller* const controller = controller_of(element.law);
    const bool keeps = controller == nullptr
                           ? stores_energy(element.law)
                           : element.feedback->source == Feedback::Source::measure && !controller->of_rate &&
                                 (controller->has(Controller::proportional) || controller->curve);
    if (!keeps || !winds(controller == nullptr ? scaled.elements[e].on : scaled.elements[e].feedback->reads)) continue;
    return fmt::format("{} \"{}\" winds up with each period", element.family(), element.name);
  }
  for (std::size_t k = 0; k < scene.stops.size(); ++k) {
    const Stop& stop = scene.stops[k];
    const bool is_limited = std::isfinite(stop.min) || std::isfinite(stop.max);
    if (stop.holds() || !is_limited || !winds(scaled.stops[k].on)) continue;
    return fmt::format("it comes nearer to a limit of {} with each period", stop.title());
  }
  return "";
}

/// Closes a period by Newton's method for  s (P(x) - x) = 0  with the speed s of the angle: without s torques that do
/// not balance would seem small where it is fast. Steps are shortened until that is less, and change the speed by half
/// of it at most.
bool close_by_newton(Runs& runs, VectorXd& at, Turned& shot) {
  const Index speed = runs.place_of_speed();
  const auto open = [&](const VectorXd& x, const Turned& made) {
    return runs.relative_off(x, made) * x[speed] * x[speed];
  };
  shot = runs.shoot(at, true, running_accuracy);
  for (int step = 0; step < most_newton_steps && shot.why.empty(); ++step) {
    const VectorXd size = runs.sizes(shot.period), off = runs.off(at, shot.after).cwiseQuotient(size);
    const double residual = off.cwiseAbs().maxCoeff();
    if (residual > 1.0 || at[speed] == 0.0) return false;
    MatrixXd J =
        MatrixXd::Identity(at.size(), at.size()) - size.cwiseInverse().asDiagonal() * shot.by * size.asDiagonal();
    J.col(speed) -= off * (size[speed] / at[speed]);
    VectorXd change = size.cwiseProduct(solvers::minimum_norm_solution<double>(J, off));
    // Where the speed grows without end the residual falls, but not the step.
    const double step_size = change.cwiseQuotient(size).cwiseAbs().maxCoeff();
    if (residual < turn_closed_at_all && step_size < turn_closed_at_all) {
      at += change;
      return true;
    }
    change *= std::min(1.0, std::abs(at[speed] / (2 * change[speed])));
    const double left = open(at, shot);
    bool is_better = false;
    constexpr int most_halvings = 8;
    for (int halving = 0; halving < most_halvings && !is_better; ++halving, change /= 2) {
      const VectorXd next = at + change;
      Turned made = runs.shoot(next, true, running_accuracy);
      if (!made.why.empty() || !(open(next, made) < left)) continue;
      is_better = true;
      at = next;
      shot = std::move(made);
    }
    if (!is_better) return false;
  }
  return false;
}

}  // namespace

SteadyRunning steady_running(const MotionModel& model, const MotionState& start, const RunningOptions& options) {
  refuse_blades(model.scene(), "turns of a machine");
  refuse_states_of_controllers(model.scene(), "steady runnings");
  SteadyRunning out;
  out.turns = options.turns;
  Runs runs(model, start, options);
  VectorXd x = runs.start();
  const auto interrupted = [&] { return options.interrupt != nullptr && options.interrupt->load(); };
  // It gives the running at `at`, closed by the period `shot`.
  const auto finish = [&](const VectorXd& at, Turned& shot) {
    SteadyRunning found = out;
    found.found = true;
    const VectorXd size = runs.sizes(shot.period);
    for (const std::complex<double>& one :
         solvers::eigenpairs(MatrixXd(size.cwiseInverse().asDiagonal() * shot.by * size.asDiagonal())).values) {
      found.multipliers.push_back(one);
    }
    std::sort(found.multipliers.begin(), found.multipliers.end(),
              [](const auto& a, const auto& b) { return std::abs(a) > std::abs(b); });
    found.stable = found.multipliers.empty() || std::abs(found.multipliers.front()) < 1.0;
    Turned again = runs.shoot(at, false, running_accuracy / 100);
    const auto fail = [&](std::string why) {
      found.found = false;
      found.why = std::move(why);
      return found;
    };
    if (!again.why.empty()) return fail(std::move(again.why));
    found.residual = runs.relative_off(at, again);
    found.period = again.period;
    found.direction = runs.direction();
    found.mean = turn * options.turns / found.period;
    found.motion = runs.move(at, found.period, false, running_accuracy / 100);
    found.error = difference(found.motion, runs.move(at, found.period, false, running_accuracy));
    find_speeds(options, found);
    if (found.residual > turn_closed_at_all) {
      return fail(fmt::format("its state after a period differs by {:.2g} from that before", found.residual));
    }
    const Repeated repeated = repeat(model, runs, at, found.period);
    const std::size_t n = static_cast<std::size_t>(model.mechanism().coordinates());
    const std::vector<double> q(found.motion.trajectory.q.begin(),
                                found.motion.trajectory.q.begin() + static_cast<std::ptrdiff_t>(n));
    const bool repeats = repeated.differs <= turn_repeated_within;
    const int back = repeats ? 1 : runs.periods_until_back(at, found.period, most_periods);
    const std::string winding =
        what_winds_up(model, Eigen::Map<const VectorXd>(q.data(), static_cast<Index>(n)), repeated.moved, back == 1);
    if (!winding.empty()) return fail(winding + ", so that no running repeats itself");
    if (repeats) return found;
    found.whole_turns = options.turns * back;
    return fail(fmt::format(
        "after {} its state is that of before, but not where other bodies are: the next period differs by {:.2g}{}",
        options.turns == 1 ? "one turn" : fmt::format("{} turns", options.turns), repeated.differs,
        found.whole_turns > options.turns ? fmt::format("; expected --turns {}", found.whole_turns) : ""));
  };
  std::optional<SteadyRunning> far;  // one that it does not come to by itself
  const auto give_up = [&](std::string why) {
    if (far) return *far;
    out.why = std::move(why);
    return out;
  };
  Turned shot;
  double tried = 0.0;  // the speed from which Newton's method was begun last
  bool comes_near = false;
  for (double near = near_running; near > turn_closed_within; near /= comes_near ? 10.0 : 1.0) {
    for (double change = 0.0;;) {
      if (out.periods >= options.most_turns) {
        return give_up(fmt::format("after {} periods its speed still changes from each to the next, by {:.2g} of it",
                                   out.periods, change));
      }
      shot = runs.shoot(x, false, running_accuracy);
      if (interrupted()) shot.why = "interrupted";
      if (!shot.why.empty()) return give_up(std::move(shot.why));
      ++out.periods;
      if (options.progress) options.progress(out.periods);
      change = runs.relative_off(x, shot);
      x += runs.off(x, shot.after);
      // On a slow way to it there may be places from which Newton's method does not lead there.
      const double speed = std::abs(x[runs.place_of_speed()]);
      const bool is_elsewhere = change < near_running && !(std::abs(speed - tried) <= elsewhere * tried);
      comes_near = change < near;
      if (!comes_near && !is_elsewhere) continue;
      tried = speed;
      break;
    }
    VectorXd at = x;
    if (!close_by_newton(runs, at, shot)) continue;
    SteadyRunning found = finish(at, shot);
    if (found.whole_turns > options.turns && found.whole_turns <= most_turns_of_itself) {
      RunningOptions longer = options;
      longer.turns = found.whole_turns;
      return steady_running(model, start, longer);
    }
    const bool is_near = (at - x).cwiseQuotient(runs.sizes(shot.period)).cwiseAbs().maxCoeff() <= near_running;
    if (!found.found || found.stable || is_near) return found;
    far = std::move(found);
  }
  return give_up("its running could not be closed: after a period it is not where it was");
}

}  // namespace poise
