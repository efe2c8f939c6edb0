// What benchmarks/python_calls.py compares calls from Python with.

#include <chrono>
#include <memory>

#include "python/module/bindings.hpp"
#include "python/module/scene_object.hpp"
#include "statics/equilibrium/equilibrium.hpp"

namespace poise::python {
namespace {

/// Seconds that so many solves of a compiled scene take one by one in C++.
double seconds_of_solves(const std::shared_ptr<const SceneObject>& scene, int count, bool prove) {
  const std::shared_ptr<const StaticModel> model = scene->model();
  SolveOptions options;
  options.prove = prove;
  const auto begin = std::chrono::steady_clock::now();
  for (int k = 0; k < count; ++k) {
    const Equilibrium found = solve(*model, options);
    if (found.x.empty()) return 0.0;
  }
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace

void bind_timing(pybind11::module_& m) {
  m.def("seconds_of_solves", seconds_of_solves, pybind11::arg("scene"), pybind11::arg("count"), pybind11::arg("proof"));
}

}  // namespace poise::python
