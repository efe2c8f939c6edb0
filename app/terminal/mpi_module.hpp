#pragma once

#include "studies/ranks.hpp"

/// The one function of the module poise_mpi.so. The program loads it where mpirun has started it, so that nothing else
/// of Poise needs MPI. Joins the ranks and counts those on this machine; the caller owns the result.
extern "C" [[gnu::visibility("default")]] poise::studies::Ranks* poise_join_mpi(int* ranks_on_this_machine);
