#include "benchmarks/integrators.hpp"

namespace poise::benchmarks {

std::vector<Integrator> sundials_integrators() { return {}; }

}  // namespace poise::benchmarks
