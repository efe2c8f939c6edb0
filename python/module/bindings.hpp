#pragma once

// The parts of the module, each in a source of its own.

#include <pybind11/pybind11.h>

namespace poise::python {

void bind_builder(pybind11::module_& m);    ///< SceneBuilder and Measure
void bind_commands(pybind11::module_& m);   ///< Outcome, call() and commands()
void bind_many(pybind11::module_& m);       ///< solve_many()
void bind_numerics(pybind11::module_& m);   ///< System, Certificate, and what makes them
void bind_path_many(pybind11::module_& m);  ///< path_many()
void bind_scenes(pybind11::module_& m);     ///< Scene and Rest
void bind_timing(pybind11::module_& m);     ///< seconds_of_solves()
void bind_view(pybind11::module_& m);       ///< BackgroundView

}  // namespace poise::python
