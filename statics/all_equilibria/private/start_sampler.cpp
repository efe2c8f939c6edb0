#include "statics/all_equilibria/private/start_sampler.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "solvers/newton.hpp"

namespace poise {

std::vector<double> StartSampler::run(std::size_t start) const {
  solvers::RandomStream random(options_.seed, 0, start);
  const bool on_curve = loops_.known() && start % 2 == 0;
  // Some minima are hard to meet by Newton's method alone.
  return from(on_curve ? loops_.pose(random) : likely(start, random), start % 16 >= 12);
}

std::vector<double> StartSampler::from(const std::vector<double>& pose, bool descends) const {
  solvers::NewtonOptions settings;
  const bool has_energy = !options_.assemblies && !model_.mechanism().has_follower_loads();
  settings.goal = descends && has_energy ? solvers::Goal::minimum : solvers::Goal::stationary;
  settings.safeguards.restarts = settings.safeguards.load_stepping = false;
  settings.interrupt = options_.interrupt;
  solvers::Newton newton(model_.problem(), settings);
  const solvers::NewtonResult& closed = newton.close(pose);
  if (closed.end != solvers::NewtonEnd::converged) return {};
  if (options_.assemblies) return closed.x;
  const std::vector<double> x = closed.x;
  const solvers::NewtonResult& found = newton.solve(x);
  return found.end == solvers::NewtonEnd::converged ? found.x : std::vector<double>();
}

std::vector<double> StartSampler::likely(std::size_t start, solvers::RandomStream& random) const {
  const bool winds = turns_.count() && !loops_.known() && start % 2 == 1;
  const double reach = !winds ? M_PI : start % 4 == 1 ? 3.0 * M_PI : 6.0 * M_PI;
  const int candidates = !winds ? 1 : start % 8 < 4 ? 1 : 24;
  std::vector<double> out = place(reach, random);
  for (int k = 1; k < candidates; ++k) {
    std::vector<double> other = place(reach, random);
    if (energy_at(model_, other).value_or(0.0) < energy_at(model_, out).value_or(0.0)) out = std::move(other);
  }
  return out;
}

std::vector<double> StartSampler::place(double reach, solvers::RandomStream& random) const {
  std::vector<double> x = start_;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const auto coordinate = static_cast<int>(i);
    const bool is_length = model_.layout().is_length(coordinate);
    if (is_length || turns_.count(coordinate)) {
      const double by = is_length ? model_.layout().size : reach;
      x[i] = random.uniform(std::min(0.0, x[i]) - by, std::max(0.0, x[i]) + by);
    } else {
      x[i] += random.uniform(-M_PI, M_PI);
    }
  }
  return x;
}

}  // namespace poise
