#include <memory>
#include <optional>
#include <string>

#include <pybind11/stl.h>

#include "app/view/background_view.hpp"
#include "python/module/bindings.hpp"
#include "python/module/conversion.hpp"
#include "python/module/lock.hpp"
#include "python/module/scene_object.hpp"

namespace poise::python {
namespace {

/// A page of a scene as its file has it is one of the file, which it can then save.
app::ViewedScene viewed(const SceneObject& scene, bool is_file) {
  if (is_file) return std::filesystem::path(scene.name());
  return app::SceneInMemory{*scene.scene(), scene.text(), scene.name()};
}

}  // namespace

void bind_view(py::module_& m) {
  using app::BackgroundView;
  // A page that is being computed is ended without the lock, for which other threads may wait.
  const auto without_lock = [](BackgroundView* view) {
    const WithoutLock others;
    delete view;
  };
  py::class_<BackgroundView, std::shared_ptr<BackgroundView>>(m, "BackgroundView", "The live page of a scene.")
      .def(py::init([without_lock](const SceneObject& scene, bool is_file, const std::optional<std::string>& origin,
                                   int port) {
             const WithoutLock others;
             return std::shared_ptr<BackgroundView>(
                 new BackgroundView(viewed(scene, is_file), {.port = port, .frame_origin = origin}), without_lock);
           }),
           py::arg("scene"), py::arg("is_file"), py::arg("origin"), py::arg("port"))
      .def_property_readonly("address", &BackgroundView::address)
      .def_property_readonly("runs", &BackgroundView::runs)
      .def("stop", &BackgroundView::stop, py::call_guard<WithoutLock>());
}

}  // namespace poise::python
