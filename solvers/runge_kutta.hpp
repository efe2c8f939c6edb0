#pragma once

#include <memory>
#include <vector>

namespace poise::solvers {

/// y' = f(t, y).
class OdeSystem {
 public:
  virtual ~OdeSystem() = default;
  virtual int size() const = 0;
  /// Fills dydt; false where f cannot be evaluated at (t, y), so that the step has to be another one.
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

  /// Middles of the widest gaps between the places, as parts of a step, at which stages are evaluated; ascending.
  static constexpr double gaps[] = {0.25, 7.0 / 12, 0.75, 11.0 / 12};

  /// From y with the rates dydt at t to y_new at t + h, with the estimated error of each component. False where a stage
  /// could not be evaluated.
  bool step(double t, const std::vector<double>& y, const std::vector<double>& dydt, double h,
            std::vector<double>& y_new, std::vector<double>& error);

 private:
  class Stepper;
  std::unique_ptr<Stepper> stepper_;
};

/// The next step for a method of order 8 after one of h that made `error` times the error allowed: grows or shrinks
/// with error^(-1/8), never by more than the factors 4 and 1/5.
double next_step(double h, double error);

}  // namespace poise::solvers
