#pragma once

#include <functional>
#include <string>
#include <vector>

#include "solvers/runge_kutta.hpp"

namespace poise::benchmarks {

/// Counts evaluations of the system that it wraps.
class CountedSystem : public solvers::OdeSystem {
 public:
  explicit CountedSystem(solvers::OdeSystem& system) : system_(system) {}
  int size() const override { return system_.size(); }
  bool rates(double t, const double* y, double* dydt) override {
    ++evaluations;
    return system_.rates(t, y, dydt);
  }

  long evaluations = 0;

 private:
  solvers::OdeSystem& system_;
};

/// A way from y at t = 0 to y at `end`, all components of order one, each step's error estimate below `tolerance` (the
/// step itself of the method with fixed steps). Empty if it fails.
struct Integrator {
  std::string name;
  bool fixed_steps = false;
  std::function<std::vector<double>(solvers::OdeSystem&, std::vector<double> y, double end, double tolerance)> run;
};

/// Equations F(t, y, y') = 0 of which some components of y have no rates.
class DaeSystem {
 public:
  virtual ~DaeSystem() = default;
  virtual int size() const = 0;
  /// Whether the rate of a component occurs.
  virtual bool has_rate(int component) const = 0;
  virtual bool residual(double t, const double* y, const double* dydt, double* r) = 0;
};

/// Goes from y and its rates at t = 0 to y at `end`. Empty if it fails, or where there is no such solver.
std::vector<double> sundials_ida(DaeSystem& system, const std::vector<double>& from, const std::vector<double>& rates,
                                 double end, double tolerance);

/// RungeKutta78 of solvers/, step sizes by next_step(), as in simulate().
Integrator poise_integrator();
/// Boost.Odeint: fixed RK4, Dormand-Prince 5(4), and Bulirsch-Stoer.
std::vector<Integrator> odeint_integrators();
/// CVODES (Adams), IDA on y' = f, ARKODE (Verner 8(5,6), Fehlberg 13(7,8)); none where Poise was configured without
/// SUNDIALS.
std::vector<Integrator> sundials_integrators();

}  // namespace poise::benchmarks
