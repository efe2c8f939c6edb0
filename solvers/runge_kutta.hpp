#pragma once

#include <memory>
#include <vector>

namespace poise::solvers {

/// y' = f(t, y).
class OdeSystem {
 public:
  virtual ~OdeSystem() = default;
  virtual int size() const = 0;
  /// Fills dydt; false if f cannot be evaluated at (t, y), so that the step has to be changed.
  virtual bool rates(double t, const double* y, double* dydt) = 0;
};

/// Steps of the Runge-Kutta-Fehlberg method of order 8 with its embedded error estimate of order 7 (E. Fehlberg, NASA
/// TR R-287, 1968), as Boost.Odeint computes them. All buffers are made in the constructor.
class RungeKutta78 {
 public:
  /// `system` must outlive this.
  explicit RungeKutta78(OdeSystem& system);
  ~RungeKutta78();
  RungeKutta78(const RungeKutta78&) = delete;
  RungeKutta78& operator=(const RungeKutta78&) = delete;

  /// Midpoints of the widest gaps between the abscissae of the stages, as fractions of a step; ascending.
  static constexpr double gaps[] = {0.25, 7.0 / 12, 0.75, 11.0 / 12};

  /// From y with the rates dydt at t to y_new at t + h, with the estimated error of each component. False if a stage
  /// could not be evaluated.
  bool step(double t, const std::vector<double>& y, const std::vector<double>& dydt, double h,
            std::vector<double>& y_new, std::vector<double>& error);

 private:
  class Stepper;
  std::unique_ptr<Stepper> stepper_;
};

/// The next step size for a method of order 8 after a step h whose error was `error` times the tolerance: changes with
/// error^(-1/8), by factors between 1/5 and 4.
double next_step(double h, double error);

}  // namespace poise::solvers
