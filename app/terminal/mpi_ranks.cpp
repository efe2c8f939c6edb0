#include "app/terminal/mpi_ranks.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>

#include <dlfcn.h>

#include "app/terminal/mpi_module.hpp"
#include "model/input_error.hpp"
#include "solvers/parallel.hpp"

namespace poise::app {
namespace {

namespace fs = std::filesystem;

/// Whether mpirun, or srun with MPI, has started this process, and not this one alone.
bool has_mpi_environment() {
  // Open MPI and MPICH say how many ranks there are, PMIx (srun) does not.
  for (const char* size : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"}) {
    if (const char* const ranks = std::getenv(size); ranks != nullptr) return std::string_view(ranks) != "1";
  }
  return std::getenv("PMIX_RANK") != nullptr || std::getenv("PMI_RANK") != nullptr;
}

[[noreturn]] void refuse(const std::string& reason) {
  throw InputError("mpirun: " + reason +
                   ", every rank would do the whole study; install poise-mpi, or build Poise with Open MPI "
                   "(libopenmpi-dev), or start parts of the study by --shard i/N without mpirun");
}

/// Beside the program in the build folder, or where it is installed.
fs::path module_file() {
  std::error_code unknown;
  const fs::path folder = fs::read_symlink("/proc/self/exe", unknown).parent_path();
  for (const char* place : {"", POISE_MODULE_FOLDER}) {
    fs::path file = (folder / place / "poise_mpi.so").lexically_normal();
    if (fs::exists(file, unknown)) return file;
  }
  refuse("this poise has no module for MPI (poise_mpi.so)");
}

/// The module stays loaded to the end of the process, as MPI does.
decltype(&poise_join_mpi) load_module() {
  void* const module = ::dlopen(module_file().c_str(), RTLD_NOW);
  void* const join = module == nullptr ? nullptr : ::dlsym(module, "poise_join_mpi");
  if (join == nullptr) refuse("cannot load MPI (" + std::string(::dlerror()) + ")");
  return reinterpret_cast<decltype(&poise_join_mpi)>(join);
}

}  // namespace

std::unique_ptr<studies::Ranks> join_ranks(int& jobs) {
  if (!has_mpi_environment()) return nullptr;
  int ranks_on_this_machine = 1;
  std::unique_ptr<studies::Ranks> ranks(load_module()(&ranks_on_this_machine));
  if (jobs == 0) {
    // mpirun binds a rank to cores of its own, or, where it does not, all of them may use all.
    const int share = static_cast<int>(std::thread::hardware_concurrency()) / ranks_on_this_machine;
    jobs = std::clamp(share, 1, solvers::threads_of(0));
  }
  return ranks;
}

}  // namespace poise::app
