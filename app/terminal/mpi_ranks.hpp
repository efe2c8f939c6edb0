#pragma once

#include <memory>

#include "studies/ranks.hpp"

namespace poise::app {

/// Whether mpirun, or srun with MPI, has started this process, alone or with others.
bool started_by_mpirun();

/// Joins the processes that `mpirun` has started together with this one; null where this one was started alone. The
/// ranks part again when the object ends, in their normal course or by an exception. Throws InputError where the module
/// for MPI is missing or cannot be loaded.
///
/// `jobs` that are 0 become the threads that this rank can have beside the others on its machine.
std::unique_ptr<studies::Ranks> join_ranks(int& jobs);

}  // namespace poise::app
