#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <pybind11/stl.h>

#include "app/commands/options.hpp"
#include "app/commands/solve.hpp"
#include "model/input_error.hpp"
#include "model/nearest_name.hpp"
#include "model/parameters.hpp"
#include "model/time_function.hpp"
#include "python/module/bindings.hpp"
#include "python/module/conversion.hpp"
#include "python/module/interrupt_scope.hpp"
#include "python/module/lock.hpp"
#include "python/module/rest_object.hpp"
#include "python/module/scene_object.hpp"
#include "statics/model/mobility.hpp"
#include "statics/model/virtual_work.hpp"

namespace poise::python {
namespace {

using SharedScene = std::shared_ptr<const SceneObject>;

/// The options of a solve; the others are numbers of the scene.
SolveOptions take_options(py::dict& given, std::optional<double>& time) {
  SolveOptions options;
  const auto take = [&](const char* name) -> std::optional<py::object> {
    if (!given.contains(name)) return std::nullopt;
    py::object out = given[name];
    PyDict_DelItemString(given.ptr(), name);
    return out;
  };
  const auto number = [](const char* name, const py::object& value) {
    return changes_of(py::dict(py::arg(name) = value)).front().second;
  };
  const auto word = [](const char* name, const py::object& value) {
    if (py::isinstance<py::str>(value)) return utf8(value);
    throw InputError(fmt::format("{}: expected a text, found {}", name, shown(value)));
  };
  if (const auto value = take("method")) options.method = app::read_method("method", word("method", *value));
  if (const auto value = take("seek")) options.seek = app::read_seek(word("seek", *value));
  if (const auto value = take("proof_seconds")) options.certificate = app::read_proof(number("proof_seconds", *value));
  if (const auto value = take("time")) time = number("time", *value);
  if (const auto value = take("proof")) {
    if (!is_flag(*value)) throw InputError(fmt::format("proof: expected True or False, found {}", shown(*value)));
    options.prove = PyObject_IsTrue(value->ptr()) == 1;
  }
  return options;
}

/// Throws InputError for a keyword that is no number of the scene but near an option.
void expect_numbers(const SceneObject& scene, const py::kwargs& left) {
  for (const auto& [name, value] : left) {
    const std::string word = utf8(name);
    try {
      scene.path_of(word);
    } catch (const InputError&) {
      const std::string near = did_you_mean(word, {"method", "seek", "time", "proof", "proof_seconds"});
      if (!near.empty()) throw InputError(fmt::format("solve: has no option or number \"{}\"{}", word, near));
      throw;
    }
  }
}

std::shared_ptr<const RestObject> solve_scene(const SharedScene& scene, const py::args& args, py::kwargs kwargs) {
  if (args.size() > 1) throw InputError("solve: expected one dictionary of numbers, found several");
  SolveOptions options;
  std::optional<double> time;
  SharedScene changed = scene;
  if (!args.empty() || !kwargs.empty()) {
    SceneObject::Changes changes;
    if (!args.empty()) {
      if (!py::isinstance<py::dict>(args[0])) {
        throw InputError(
            fmt::format("solve: expected a dictionary of numbers, {{\"load.P\": 25}}, found {}", shown(args[0])));
      }
      changes = changes_of(py::cast<py::dict>(args[0]));
    }
    options = take_options(kwargs, time);
    try {
      for (auto& change : changes_of(kwargs)) changes.push_back(std::move(change));
      if (!changes.empty()) changed = scene->with(changes);
    } catch (const InputError&) {
      expect_numbers(*scene, kwargs);
      throw;
    }
  }
  std::atomic<bool> interrupt = false;
  options.interrupt = &interrupt;
  std::shared_ptr<const StaticModel> model;
  {
    const WithoutLock others;
    model = time ? std::make_shared<const StaticModel>(app::scene_at_time(*changed->scene(), *time)) : changed->model();
  }
  // Smaller ones end before anybody can want them to.
  constexpr int most_unwatched = 100;
  std::optional<InterruptScope> scope;
  if (model->mechanism().coordinates() > most_unwatched) scope.emplace(interrupt);
  Equilibrium found;
  {
    const WithoutLock others;
    try {
      found = solve(*model, options);
    } catch (const AssemblyError& error) {
      found.status = Status::not_found;
      found.method = options.method;
      found.seek = options.seek;
      found.why = error.what();
    }
  }
  if (scope) scope->hand_back_unless(found.status == Status::interrupted);
  return std::make_shared<const RestObject>(changed, model, options, time, std::move(found));
}

py::object proved(const RestObject& rest) {
  if (!rest.options().prove) return py::none();
  return py::bool_(rest.equilibrium().found());
}

py::object radius(const RestObject& rest) {
  if (!rest.options().prove || !rest.equilibrium().found()) return py::none();
  return py::float_(rest.equilibrium().certificate.radius);
}

void bind_scene(py::module_& m) {
  py::class_<SceneObject, std::shared_ptr<SceneObject>>(m, "Scene", "A mechanism, as a scene file describes it.")
      .def_static("load", &SceneObject::load, py::arg("file"))
      .def_static("parse", &SceneObject::parse, py::arg("text"), py::arg("name"), py::arg("changes"))
      .def("with_numbers",
           [](const SceneObject& self, const py::dict& numbers) { return self.with(changes_of(numbers)); })
      .def("path_of", &SceneObject::path_of, py::arg("name"))
      .def_property_readonly("name", [](const SceneObject& self) { return text_of(self.name()); })
      .def_property_readonly("text", [](const SceneObject& self) { return text_of(self.text()); })
      .def_property_readonly("changes", &SceneObject::changes)
      .def_property_readonly("settings", &SceneObject::settings)
      .def_property_readonly("title", [](const SceneObject& self) { return text_of(self.scene()->title); })
      .def("written", &SceneObject::written)
      .def_property_readonly("numbers",
                             [](const SceneObject& self) {
                               py::dict out;
                               for (const ParameterRow& row : parameter_table(*self.scene())) {
                                 const std::optional<double> value = value_at(*self.scene(), row.place);
                                 if (!value) continue;
                                 out[text_of(row.path.text())] = *value / row.dimension.unit(self.scene()->units);
                               }
                               return out;
                             })
      .def("unit_of",
           [](const SceneObject& self, const std::string& name) {
             return parameter(*self.scene(), self.path_of(name)).dimension.unit_name(self.scene()->units);
           })
      .def_property_readonly("quantities", [](const SceneObject& self) { return quantity_names(*self.scene()); })
      .def("solve", [](const std::shared_ptr<SceneObject>& self, const py::args& args, const py::kwargs& kwargs) {
        return std::const_pointer_cast<RestObject>(solve_scene(self, args, kwargs));
      });
}

void bind_rest(py::module_& m) {
  py::class_<RestObject, std::shared_ptr<RestObject>>(m, "Rest", "Where a scene rests.")
      .def_property_readonly("scene",
                             [](const RestObject& self) { return std::const_pointer_cast<SceneObject>(self.scene()); })
      .def_property_readonly("found", &RestObject::has_position)
      .def_property_readonly("proved", proved)
      .def_property_readonly("radius", radius)
      .def_property_readonly("status", [](const RestObject& self) { return to_string(self.equilibrium().status); })
      .def_property_readonly("why", [](const RestObject& self) { return text_of(self.equilibrium().why); })
      .def_property_readonly("method", [](const RestObject& self) { return to_string(self.equilibrium().method); })
      .def_property_readonly("seek", [](const RestObject& self) { return to_string(self.equilibrium().seek); })
      .def_property_readonly("time", &RestObject::time)
      .def_property_readonly("proof_seconds", [](const RestObject& self) { return self.options().certificate.seconds; })
      .def_property_readonly("stability",
                             [](const RestObject& self) -> std::optional<std::string> {
                               if (!self.equilibrium().found()) return std::nullopt;
                               return to_string(self.equilibrium().certificate.stability);
                             })
      .def_property_readonly("x",
                             [](const RestObject& self) {
                               std::vector<double> x = self.equilibrium().x;
                               if (self.has_position())
                                 x = in_scene_units(self.model(), std::move(x));
                               else
                                 std::fill(x.begin(), x.end(), std::numeric_limits<double>::quiet_NaN());
                               return py::array_t<double>(static_cast<py::ssize_t>(x.size()), x.data());
                             })
      .def_property_readonly("touching",
                             [](const RestObject& self) {
                               const Equilibrium& found = self.equilibrium();
                               return touching_names(self.model(), found.certificate.active_stops, found.x);
                             })
      .def("value",
           [](const RestObject& self, const std::string& name) {
             const NamedValue value = self.value(name);
             return py::make_tuple(value.value, text_of(value.unit), value.in_si, text_of(value.why));
           })
      .def(
          "outcome",
          [](const RestObject& self, bool pictures) {
            const WithoutLock others;
            return std::make_shared<app::Outcome>(self.outcome(pictures));
          },
          py::arg("pictures") = false);
}

}  // namespace

void bind_scenes(py::module_& m) {
  bind_scene(m);
  bind_rest(m);
}

}  // namespace poise::python
