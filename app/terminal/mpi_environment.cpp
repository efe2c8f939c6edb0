#include <algorithm>
#include <array>
#include <cstdlib>

#include "app/terminal/mpi_ranks.hpp"

namespace poise::app {

bool has_mpi_environment() {
  // Of Open MPI, of PMIx (srun) and of MPICH.
  constexpr std::array variables = {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK"};
  return std::any_of(variables.begin(), variables.end(),
                     [](const char* variable) { return std::getenv(variable) != nullptr; });
}

}  // namespace poise::app
