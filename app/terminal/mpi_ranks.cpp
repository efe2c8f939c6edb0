#include "app/terminal/mpi_ranks.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>

#include <dlfcn.h>
#include <fmt/format.h>
#include <link.h>

#include "app/terminal/mpi_module.hpp"
#include "model/input_error.hpp"
#include "solvers/parallel.hpp"

namespace poise::app {
namespace {

namespace fs = std::filesystem;

/// Whether mpirun, or srun with MPI, has started this process, and not this one alone.
bool has_other_ranks() {
  for (const char* size : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"}) {
    if (const char* const ranks = std::getenv(size); ranks != nullptr) return std::string_view(ranks) != "1";
  }
  return started_by_mpirun();
}

fs::path program_folder() {
  std::error_code unknown;
  return fs::read_symlink("/proc/self/exe", unknown).parent_path();
}

/// An archive of the program has no package poise-mpi that fits it.
[[noreturn]] void refuse(const std::string& reason) {
  const std::string remedy =
      program_folder() == "/usr/bin" ? "install poise-mpi" : "build Poise with Open MPI (libopenmpi-dev)";
  throw InputError("mpirun: " + reason + ", every rank would do the whole study; " + remedy +
                   ", or start parts of the study by --shard i/N without mpirun");
}

/// Beside the program in the build folder, or where it is installed.
fs::path module_file() {
  std::error_code unknown;
  for (const char* place : {"", POISE_MODULE_FOLDER}) {
    fs::path file = (program_folder() / place / "poise_mpi.so").lexically_normal();
    if (fs::exists(file, unknown)) return file;
  }
  refuse("this poise has no module for MPI (poise_mpi.so)");
}

/// Refuses a file that ends before the segments that it announces: the loader maps them unseen and the process would
/// end by a bus error.
void refuse_cut(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary | std::ios::ate);
  const auto size = static_cast<std::uint64_t>(stream.tellg());
  ElfW(Ehdr) header = {};
  stream.seekg(0);
  stream.read(reinterpret_cast<char*>(&header), sizeof header);
  // What is no library at all, or one of another machine, the loader refuses by itself.
  const std::string_view mark(reinterpret_cast<const char*>(header.e_ident), SELFMAG);
  if (!stream || mark != ELFMAG || header.e_ident[EI_CLASS] != (sizeof(void*) == 8 ? ELFCLASS64 : ELFCLASS32)) return;
  std::uint64_t end = header.e_phoff + std::uint64_t{header.e_phnum} * sizeof(ElfW(Phdr));
  stream.seekg(static_cast<std::streamoff>(header.e_phoff));
  ElfW(Phdr) segment = {};
  for (int i = 0; i < header.e_phnum && stream.read(reinterpret_cast<char*>(&segment), sizeof segment); ++i) {
    if (segment.p_type == PT_LOAD) end = std::max<std::uint64_t>(end, segment.p_offset + segment.p_filesz);
  }
  if (size >= end) return;
  refuse(fmt::format("cannot load MPI ({}: the file is cut: it has {} bytes of {} or more)", file.string(), size, end));
}

/// The module stays loaded to the end of the process, as MPI does.
decltype(&poise_join_mpi) load_module() {
  const fs::path file = module_file();
  refuse_cut(file);
  void* const module = ::dlopen(file.c_str(), RTLD_NOW);
  void* const join = module == nullptr ? nullptr : ::dlsym(module, "poise_join_mpi");
  if (join == nullptr) refuse("cannot load MPI (" + std::string(::dlerror()) + ")");
  return reinterpret_cast<decltype(&poise_join_mpi)>(join);
}

}  // namespace

bool started_by_mpirun() {
  // Open MPI and MPICH say how many ranks there are, PMIx (srun) does not.
  constexpr std::array names = {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMIX_RANK", "PMI_RANK"};
  return std::any_of(names.begin(), names.end(), [](const char* name) { return std::getenv(name) != nullptr; });
}

std::unique_ptr<studies::Ranks> join_ranks(int& jobs) {
  if (!has_other_ranks()) return nullptr;
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
