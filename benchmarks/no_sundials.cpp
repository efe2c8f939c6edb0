#include "benchmarks/integrators.hpp"

namespace poise::benchmarks {

std::vector<Integrator> sundials_integrators() { return {}; }

std::vector<double> sundials_ida(DaeSystem&, const std::vector<double>&, const std::vector<double>&, double, double) {
  return {};
}

}  // namespace poise::benchmarks
