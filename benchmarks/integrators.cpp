// poise_integrators: work against precision of ways to integrate the same equations of motion. For every method and
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

// The reduced equations of a scene in u, where  z = z0 + far u_z,  w = w0 + fast u_w: all components of order one.
class FreeMotion : public solvers::OdeSystem {
 public:
  FreeMotion(Scene scene, const std::vector<StartValue>& release, bool from_equilibrium, double duration)
      : model_(std::move(scene)),
        reduced_(model_.scaled_scene(), model_.mechanism(), model_.inertia()),
        end_(duration) {
    const MotionState start = begin(release, from_equilibrium);
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

  bool rates(double t, const double* u, double* dudt) override {
    for (std::size_t k = 0; k < from_.size(); ++k) y_[k] = from_[k] + size_[k] * u[k];
    if (!system_->rates(t, y_.data(), dydt_.data())) return false;
    for (std::size_t k = 0; k < from_.size(); ++k) dudt[k] = dydt_[k] / size_[k];
    return true;
  }

 private:
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
      fmt::print("{:<26} {:>9.1e} {:>9.1e} {:>12} {:>8.3f} ms\n", method.name, m.tolerance, m.error, m.evaluations,
                 1e3 * m.seconds);
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
  if (sundials_integrators().empty()) fmt::print("SUNDIALS was not found: CVODES and ARKODE are skipped.\n");
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
