#include "app/terminal/mpi_ranks.hpp"
#include "model/input_error.hpp"

namespace poise::app {

std::unique_ptr<studies::Ranks> join_ranks(int& /*jobs*/) {
  if (!has_mpi_environment()) return nullptr;
  throw InputError(
      "mpirun: this poise was built without MPI, every rank would do the whole study; build it with Open MPI "
      "(libopenmpi-dev), or use --shard i/N");
}

}  // namespace poise::app
