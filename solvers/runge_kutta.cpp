#include "solvers/runge_kutta.hpp"

#include <algorithm>
#include <cmath>

#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>

namespace poise::solvers {

class RungeKutta78::Stepper {
 public:
  explicit Stepper(OdeSystem& system) : system_(system) {
    method_.adjust_size(std::vector<double>(static_cast<std::size_t>(system.size())));
  }

  bool step(double t, const std::vector<double>& y, const std::vector<double>& dydt, double h,
            std::vector<double>& y_new, std::vector<double>& error) {
    bool known = true;
    const auto rates = [&](const std::vector<double>& at, std::vector<double>& out, double time) {
      known = known && system_.rates(time, at.data(), out.data());
    };
    method_.do_step(rates, y, dydt, t, y_new, h, error);
    if (!known) return false;
    return std::all_of(y_new.begin(), y_new.end(), [](double value) { return std::isfinite(value); });
  }

 private:
  OdeSystem& system_;
  boost::numeric::odeint::runge_kutta_fehlberg78<std::vector<double>> method_;
};

RungeKutta78::RungeKutta78(OdeSystem& system) : stepper_(std::make_unique<Stepper>(system)) {}
RungeKutta78::~RungeKutta78() = default;

bool RungeKutta78::step(double t, const std::vector<double>& y, const std::vector<double>& dydt, double h,
                        std::vector<double>& y_new, std::vector<double>& error) {
  return stepper_->step(t, y, dydt, h, y_new, error);
}

double next_step(double h, double error) {
  if (!(error > 0)) return 4 * h;
  return h * std::clamp(0.9 * std::pow(error, -1.0 / 8.0), 0.2, 4.0);
}

}  // namespace poise::solvers
