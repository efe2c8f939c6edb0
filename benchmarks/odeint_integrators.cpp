#include <algorithm>
#include <cmath>

#include <boost/numeric/odeint/integrate/integrate_adaptive.hpp>
#include <boost/numeric/odeint/stepper/bulirsch_stoer.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta4.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>

#include "benchmarks/integrators.hpp"

namespace poise::benchmarks {
namespace {

namespace odeint = boost::numeric::odeint;
using State = std::vector<double>;

struct CannotEvaluate {};

auto function_of(solvers::OdeSystem& system) {
  return [&system](const State& y, State& dydt, double t) {
    if (!system.rates(t, y.data(), dydt.data())) throw CannotEvaluate{};
  };
}

State fixed_rk4(solvers::OdeSystem& system, State y, double end, double step) {
  const auto steps = static_cast<long>(std::ceil(end / step));
  odeint::runge_kutta4<State> method;
  const auto f = function_of(system);
  for (long k = 0; k < steps; ++k) {
    method.do_step(f, y, static_cast<double>(k) * end / static_cast<double>(steps), end / static_cast<double>(steps));
  }
  return y;
}

State dormand_prince(solvers::OdeSystem& system, State y, double end, double tolerance) {
  odeint::runge_kutta_dopri5<State> method;
  State dydt(y.size()), next(y.size()), rates(y.size()), error(y.size());
  const auto f = function_of(system);
  double t = 0.0;
  double h = 1e-3 * end;
  f(y, dydt, t);
  while (t < end) {
    const bool last = h >= end - t;
    if (last) h = end - t;
    method.do_step(f, y, dydt, t, next, rates, h, error);
    double worst = 1e-10;
    for (double e : error) worst = std::max(worst, std::abs(e) / tolerance);
    if (worst <= 1.0) {
      t = last ? end : t + h;
      y.swap(next);
      dydt.swap(rates);
    }
    h *= std::clamp(0.9 * std::pow(worst, -0.2), 0.2, 5.0);
  }
  return y;
}

State bulirsch_stoer(solvers::OdeSystem& system, State y, double end, double tolerance) {
  odeint::bulirsch_stoer<State> method(tolerance, 0.0, 0.0, 0.0);
  odeint::integrate_adaptive(method, function_of(system), y, 0.0, end, 1e-3 * end);
  return y;
}

State fehlberg78(solvers::OdeSystem& system, State y, double end, double tolerance) {
  solvers::RungeKutta78 method(system);
  State dydt(y.size()), next(y.size()), error(y.size());
  double t = 0.0;
  double h = 1e-3 * end;
  if (!system.rates(t, y.data(), dydt.data())) return {};
  while (t < end) {
    const bool last = h >= end - t;
    if (last) h = end - t;
    if (!method.step(t, y, dydt, h, next, error)) return {};
    double worst = 0.0;
    for (double e : error) worst = std::max(worst, std::abs(e) / tolerance);
    if (worst <= 1.0) {
      t = last ? end : t + h;
      y.swap(next);
      if (!system.rates(t, y.data(), dydt.data())) return {};
    }
    h = solvers::next_step(h, worst);
  }
  return y;
}

}  // namespace

Integrator poise_integrator() { return {"RKF 7(8), Poise", false, fehlberg78}; }

std::vector<Integrator> odeint_integrators() {
  return {{"RK4, fixed steps", true, fixed_rk4},
          {"Dormand-Prince 5(4)", false, dormand_prince},
          {"Bulirsch-Stoer", false, bulirsch_stoer}};
}

}  // namespace poise::benchmarks
