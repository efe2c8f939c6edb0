// Newton's iterations must not allocate. A program of its own, because it stands in for malloc.

#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "model/scene.hpp"
#include "solvers/newton.hpp"
#include "statics/model/static_model.hpp"
#include "statics/model/virtual_work.hpp"

namespace {
// Volatile: compilers may take it that malloc reads nothing of the program, and leave out what it counts by.
volatile bool counting = false;
volatile int allocations = 0;
}  // namespace

#ifdef __SANITIZE_ADDRESS__
// The sanitizer has a malloc of its own, which calls this.
extern "C" void __sanitizer_malloc_hook(const volatile void*, std::size_t) {
  if (counting) allocations = allocations + 1;
}
#else
extern "C" void* __libc_malloc(std::size_t size);

// Visible, although clang takes it for hidden as all else: libraries must call it too.
extern "C" [[gnu::visibility("default")]] void* malloc(std::size_t size) {
  if (counting) allocations = allocations + 1;
  return __libc_malloc(size);
}
#endif

namespace poise::allocation_test {
namespace {

int allocations_of_a_solve(const StaticModel& model, solvers::Goal goal, int dense_limit) {
  solvers::NewtonOptions options;
  options.goal = goal;
  options.dense_limit = dense_limit;
  solvers::Newton newton(model.problem(), options);
  const std::vector<double> x = model.start();
  allocations = 0;
  counting = true;
  const solvers::NewtonEnd end = newton.solve(x).end;
  counting = false;
  EXPECT_EQ(end, solvers::NewtonEnd::converged);
  return allocations;
}

TEST(Allocation, TheCounterCounts) {
  allocations = 0;
  counting = true;
  std::vector<double>* volatile v = new std::vector<double>(100);
  counting = false;
  delete v;
  EXPECT_GE(allocations, 1);
}

TEST(Allocation, SolvingAllocatesNothing) {
  for (const char* file :
       {"thesis_four_bar.toml", "thesis_four_bar_reversed.toml", "thesis_chain.toml", "lift.toml",
        "redundant_parallelogram.toml", "toggle_clamp.toml", "heaton_timme.toml", "rocking_chair.toml"}) {
    const StaticModel model(read_scene(std::string(POISE_SOURCE_DIR "/datasets/") + file));
    for (const solvers::Goal goal : {solvers::Goal::stationary, solvers::Goal::minimum}) {
      for (const int dense_limit : {48, 0}) {
        EXPECT_EQ(allocations_of_a_solve(model, goal, dense_limit), 0) << file << ", dense limit " << dense_limit;
      }
    }
  }
}

TEST(Allocation, EquationsForOthersAllocateNothing) {
  for (const char* file : {"six_bar.toml", "lift.toml", "redundant_parallelogram.toml", "hanging_chain_10.toml"}) {
    VirtualWork work(std::make_shared<const StaticModel>(read_scene(std::string(POISE_SOURCE_DIR "/datasets/") + file)),
                     {});
    std::vector<double> x = work.start();
    for (double& value : x) value += 1e-3;
    const std::size_t size = x.size() + static_cast<std::size_t>(work.rows());
    const std::vector<double> y(static_cast<std::size_t>(work.rows()), 1.0);
    std::vector<double> out(size * size);
    allocations = 0;
    counting = true;
    work.place(x.data());
    work.equations(out.data());
    work.jacobian(out.data());
    work.directions(out.data());
    work.hessian(y.data(), out.data());
    work.equations_with(y.data(), out.data());
    work.jacobian_with(y.data(), out.data());
    counting = false;
    EXPECT_EQ(allocations, 0) << file;
  }
}

}  // namespace
}  // namespace poise::allocation_test
