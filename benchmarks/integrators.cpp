// poise_integrators: work against precision of ways to integrate the same equations of motion; and of `poise motion`
// with all that it does besides, and of IDA on the equations in all coordinates with their loops. For every method and
// tolerance the error at the end, the evaluations and the time, all measured in this run; then how long each takes for
// an error asked for, as a ratio to Poise's own. The error is the largest component's, over how far it travels, against
// the answers at tight tolerances of methods of another family.

#include "benchmarks/integrators.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "motion/equilibrium_pose.hpp"
#include "motion/reduced_system.hpp"
#include "motion/simulate.hpp"
#include "statics/equilibrium/equilibrium.hpp"

namespace poise::benchmarks {
namespace {

using State = std::vector<double>;
using Clock = std::chrono::steady_clock;

std::string dataset(const std::string& name) { return std::string(POISE_SOURCE_DIR) + "/datasets/" + name; }

/// The equations in all coordinates, with multipliers for the loops and for their rates (Gear, Gupta and Leimkuhler
/// 1985): y = (q, v, lambda, mu), of index two.
///   q' = v - J^T mu,   M(q) v' + (velocity terms) - Q + J^T lambda = 0,   c(q) = 0,   J v = 0.
class FullMotion : public DaeSystem {
 public:
  FullMotion(const MotionModel& model, const ReducedMotion<double>& at_start)
      : mechanism_(model.mechanism()),
        inertia_(model.inertia()),
        n_(mechanism_.coordinates()),
        rows_(mechanism_.equalities()),
        pose_(static_cast<std::size_t>(mechanism_.pose_size())),
        second_(static_cast<std::size_t>(n_)),
        weight_(second_),
        first_(second_),
        values_(mechanism_.jacobian_row().size()),
        resistances_(static_cast<std::size_t>(mechanism_.resistances_size())),
        gaps_(static_cast<std::size_t>(mechanism_.constraints())) {
    y_.assign(static_cast<std::size_t>(2 * n_ + 2 * rows_), 0.0);
    rate_ = y_;
    std::copy(at_start.q(), at_start.q() + n_, y_.begin());
    std::copy(at_start.v(), at_start.v() + n_, y_.begin() + n_);
    std::copy(at_start.v(), at_start.v() + n_, rate_.begin());
    std::copy(at_start.a(), at_start.a() + n_, rate_.begin() + n_);
  }

  int size() const override { return 2 * n_ + 2 * rows_; }
  bool has_rate(int component) const override { return component < 2 * n_; }
  const State& start() const { return y_; }
  const State& start_rate() const { return rate_; }

  bool residual(double, const double* y, const double* dydt, double* r) override {
    const double *q = y, *v = y + n_, *lambda = y + 2 * n_, *mu = lambda + rows_;
    mechanism_.place(q, pose_.data());
    const Phasors<double>& phasors = mechanism_.phasors();
    phasors.second(pose_.data(), v, v, second_.data());
    phasors.first(pose_.data(), dydt + n_, first_.data());
    for (int t = 0; t < n_; ++t) second_[static_cast<std::size_t>(t)] += first_[static_cast<std::size_t>(t)];
    double* force = r + n_;
    mechanism_.negative_force(q, pose_.data(), force);
    mechanism_.resist(pose_.data(), v, nullptr, resistances_.data());
    mechanism_.add_resistance(resistances_.data(), force);
    inertia_.weigh(second_.data(), weight_.data());
    phasors.add_projection(pose_.data(), weight_.data(), force);
    for (int i = 0; i < n_; ++i) {
      force[i] += inertia_.moment(i) * dydt[n_ + i];
      r[i] = dydt[i] - v[i];
    }
    mechanism_.constraint(q, pose_.data(), gaps_.data());
    mechanism_.jacobian(pose_.data(), values_.data());
    double *open = r + 2 * n_, *opening = open + rows_;
    for (int k = 0; k < rows_; ++k) {
      open[k] = gaps_[static_cast<std::size_t>(k)];
      opening[k] = 0.0;
    }
    for (std::size_t e = 0; e < values_.size(); ++e) {
      const int row = mechanism_.jacobian_row()[e], column = mechanism_.jacobian_column()[e];
      if (row >= rows_) continue;
      force[column] += lambda[row] * values_[e];
      r[column] += mu[row] * values_[e];
      opening[row] += v[column] * values_[e];
    }
    return true;
  }

 private:
  const Mechanism<double>& mechanism_;
  const Inertia<double>& inertia_;
  int n_, rows_;
  std::vector<Planar<double>> pose_, second_, weight_, first_;
  std::vector<double> values_, resistances_, gaps_;
  State y_, rate_;
};

// The reduced equations of a scene in u, where  z = z0 + far u_z,  w = w0 + fast u_w: all components of order one.
class FreeMotion : public solvers::OdeSystem {
 public:
  FreeMotion(Scene scene, const std::vector<StartValue>& release, bool from_equilibrium, double duration)
      : model_(std::move(scene)),
        reduced_(model_.scaled_scene(), model_.mechanism(), model_.inertia()),
        end_(duration) {
    const MotionState start = start_ = begin(release, from_equilibrium);
    const std::vector<double> q = model_.from_si(start.q);
    const std::vector<double> v = model_.from_si(start.v);
    reduced_.begin(0.0, q.data());
    system_.emplace(model_.scaled_scene(), reduced_, no_influences_, no_variations_, 0);
    MotionOptions options;
    options.duration = duration;
    const Motion motion = simulate(model_, start, options);
    const auto n = static_cast<std::size_t>(motion.trajectory.coordinates);
    const auto largest = [&](const std::vector<double>& values, std::size_t i, double from) {
      double most = 0.0;
      for (std::size_t k = i; k < values.size(); k += n) most = std::max(most, std::abs(values[k] - from));
      return most;
    };
    const auto unit = [&](int i) { return i < model_.layout().angles ? 1.0 : 1 / model_.scales().length; };
    for (int i : reduced_.independent()) {
      const auto at = static_cast<std::size_t>(i);
      from_.push_back(q[at]);
      size_.push_back(unit(i) * largest(motion.trajectory.q, at, start.q[at]));
    }
    for (int i : reduced_.independent()) {
      const auto at = static_cast<std::size_t>(i);
      from_.push_back(v[at]);
      size_.push_back(unit(i) * largest(motion.trajectory.v, at, 0.0));
    }
    y_.resize(static_cast<std::size_t>(system_->size()));
    dydt_.resize(y_.size());
  }

  int size() const override { return static_cast<int>(from_.size()); }
  double end() const { return end_; }

  /// The state at the end by poise::simulate(), with all that it does besides: dense output, energy, gaps.
  State simulated(double accuracy) const {
    MotionOptions options;
    options.duration = end_;
    options.accuracy = accuracy;
    const Motion motion = simulate(model_, start_, options);
    if (!motion.completed()) return {};
    const auto n = static_cast<std::size_t>(motion.trajectory.coordinates);
    return normalized(
        model_.from_si({motion.trajectory.q.end() - static_cast<std::ptrdiff_t>(n), motion.trajectory.q.end()}),
        model_.from_si({motion.trajectory.v.end() - static_cast<std::ptrdiff_t>(n), motion.trajectory.v.end()}));
  }
  /// IDA in all coordinates comes to this state.
  State by_full_dae(double tolerance) {
    reduced_.evaluate(0.0, from_.data(), from_.data() + reduced_.freedoms());
    FullMotion full(model_, reduced_);
    const State y = sundials_ida(full, full.start(), full.start_rate(), end_, tolerance);
    if (y.empty()) return {};
    const auto n = y.begin() + reduced_.coordinates();
    return normalized({y.begin(), n}, {n, n + reduced_.coordinates()});
  }

  bool rates(double t, const double* u, double* dudt) override {
    for (std::size_t k = 0; k < from_.size(); ++k) y_[k] = from_[k] + size_[k] * u[k];
    if (!system_->rates(t, y_.data(), dydt_.data())) return false;
    for (std::size_t k = 0; k < from_.size(); ++k) dudt[k] = dydt_[k] / size_[k];
    return true;
  }

 private:
  State normalized(const State& q, const State& v) const {
    State out;
    const auto f = static_cast<std::size_t>(reduced_.freedoms());
    for (std::size_t k = 0; k < 2 * f; ++k) {
      const auto at = static_cast<std::size_t>(reduced_.independent()[k % f]);
      out.push_back(((k < f ? q : v)[at] - from_[k]) / size_[k]);
    }
    return out;
  }

  MotionState begin(const std::vector<StartValue>& release, bool from_equilibrium) const {
    if (!from_equilibrium) return start_motion(model_, release);
    const StaticModel statics(model_.scene());
    const std::vector<double> equilibrium = model_.to_si(motion_coordinates(model_, statics, solve(statics).x));
    std::vector<StartValue> wanted = release;
    for (StartValue& value : wanted) value.value += equilibrium[static_cast<std::size_t>(value.coordinate)];
    return start_motion(model_, wanted, &equilibrium);
  }

  MotionModel model_;
  ReducedMotion<double> reduced_;
  std::vector<Influence> no_influences_;
  std::vector<Variation> no_variations_;
  std::optional<ReducedSystem> system_;
  double end_;
  MotionState start_;
  std::vector<double> from_, size_, y_, dydt_;
};

struct Measured {
  double tolerance = 0.0, error = 0.0, seconds = 0.0;
  long evaluations = 0;
};

State run(const Integrator& by, solvers::OdeSystem& system, double end, double tolerance) {
  return by.run(system, State(static_cast<std::size_t>(system.size()), 0.0), end, tolerance);
}

double apart(const State& a, const State& b) {
  if (a.size() != b.size()) return std::numeric_limits<double>::infinity();
  double most = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) most = std::max(most, std::abs(a[k] - b[k]));
  return most;
}

// The fastest of several runs.
Measured measure(const Integrator& by, FreeMotion& free_motion, double tolerance, const State& truth) {
  Measured out;
  out.tolerance = tolerance;
  CountedSystem counted(free_motion);
  out.error = apart(run(by, counted, free_motion.end(), tolerance), truth);
  out.evaluations = counted.evaluations;
  out.seconds = std::numeric_limits<double>::infinity();
  const auto begun = Clock::now();
  do {
    const auto from = Clock::now();
    run(by, free_motion, free_motion.end(), tolerance);
    out.seconds = std::min(out.seconds, std::chrono::duration<double>(Clock::now() - from).count());
  } while (Clock::now() - begun < std::chrono::milliseconds(60));
  return out;
}

// Seconds for an error, between the two measurements around it on logarithmic scales; empty if none reached that error.
std::optional<double> seconds_for(const std::vector<Measured>& measured, double error) {
  std::optional<double> best;
  for (std::size_t k = 0; k + 1 < measured.size(); ++k) {
    const Measured& rough = measured[k];
    const Measured& fine = measured[k + 1];
    if (!(rough.error >= error && fine.error <= error) || fine.error <= 0) continue;
    const double part = std::log(rough.error / error) / std::log(rough.error / fine.error);
    const double seconds = rough.seconds * std::pow(fine.seconds / rough.seconds, part);
    if (!best || seconds < *best) best = seconds;
  }
  return best;
}

void compare(const std::string& title, FreeMotion& free_motion) {
  std::vector<Integrator> methods = {poise_integrator()};
  for (auto& more : {odeint_integrators(), sundials_integrators()}) {
    methods.insert(methods.end(), more.begin(), more.end());
  }
  // Its steps keep their error below a thousandth of the accuracy.
  methods.push_back(
      {"poise motion, all of it", false, [&](solvers::OdeSystem&, const State&, double, double tolerance) {
         return free_motion.simulated(1e3 * tolerance);
       }});
  if (!sundials_integrators().empty()) {
    methods.push_back({"IDA, all coordinates", false, [&](solvers::OdeSystem&, const State&, double, double tolerance) {
                         return free_motion.by_full_dae(tolerance);
                       }});
  }
  const auto named = [&](const std::string& part) {
    return *std::find_if(methods.begin(), methods.end(),
                         [&](const Integrator& m) { return m.name.find(part) != std::string::npos; });
  };
  // Runge-Kutta methods against extrapolation, all others against Runge-Kutta.
  const State by_poise = run(methods[0], free_motion, free_motion.end(), 1e-15);
  const State by_extrapolation = run(named("Bulirsch"), free_motion, free_motion.end(), 1e-14);
  fmt::print("\n{}: {} components, {:g} s. The two references differ by {:.1e}.\n", title, free_motion.size(),
             free_motion.end(), apart(by_poise, by_extrapolation));
  fmt::print("{:<26} {:>9} {:>9} {:>12} {:>11}\n", "", "tolerance", "error", "evaluations", "time");
  std::vector<std::vector<Measured>> all;
  for (const Integrator& method : methods) {
    const bool against_itself = method.name.find("Bulirsch") != std::string::npos;
    std::vector<Measured>& measured = all.emplace_back();
    for (int digit = 4; digit <= 14; ++digit) {
      // 2^k steps stand for the k-th tolerance of a method without one.
      const double tolerance = method.fixed_steps ? free_motion.end() / (20 << digit) : std::pow(10.0, -digit);
      measured.push_back(measure(method, free_motion, tolerance, against_itself ? by_poise : by_extrapolation));
      const Measured& m = measured.back();
      fmt::print("{:<26} {:>9.1e} {:>9.1e} {:>12} {:>8.3f} ms\n", method.name, m.tolerance, m.error,
                 m.evaluations > 0 ? fmt::format("{}", m.evaluations) : "", 1e3 * m.seconds);
    }
  }
  fmt::print("\ntime over that of {}, at an error of\n{:<26}", methods[0].name, "");
  const std::vector<double> errors = {1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11};
  for (double error : errors) fmt::print(" {:>7.0e}", error);
  fmt::print("\n");
  for (std::size_t k = 1; k < methods.size(); ++k) {
    fmt::print("{:<26}", methods[k].name);
    for (double error : errors) {
      const auto ours = seconds_for(all[0], error);
      const auto theirs = seconds_for(all[k], error);
      fmt::print(" {:>7}", ours && theirs ? fmt::format("{:.2f}", *theirs / *ours) : "-");
    }
    fmt::print("\n");
  }
}

int compare_all() {
  if (sundials_integrators().empty()) fmt::print("SUNDIALS was not found: CVODES, IDA and ARKODE are skipped.\n");
  // In all these scenes the released bodies come first.
  FreeMotion lift(read_scene(dataset("lift.toml")), {{0, false, 0.005}}, true, 2.0);
  compare("Lift, released 5 mrad from its equilibrium", lift);
  FreeMotion pendulum(read_scene(dataset("pendulum_a01.toml")), {}, false, 10.0);
  compare("Pendulum of A01", pendulum);
  FreeMotion arms(read_scene(dataset("double_pendulum.toml")), {{0, false, 0.5}, {1, false, 1.0}}, false, 2.0);
  compare("Double pendulum released from above", arms);
  return 0;
}

}  // namespace
}  // namespace poise::benchmarks

int main() { return poise::benchmarks::compare_all(); }
