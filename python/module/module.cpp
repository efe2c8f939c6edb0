// The module poise._poise: what Python calls of Poise. Names, defaults and pictures are the Python files' beside it.

#include <exception>
#include <string>

#include <pybind11/eval.h>
#include <pybind11/pybind11.h>

#include "model/input_error.hpp"
#include "python/module/bindings.hpp"
#include "python/module/conversion.hpp"

namespace poise::python {
namespace {

/// The class InputError, whose message is one line of at most 1000 bytes also where the Python files raise it.
py::object input_error_class() {
  py::dict names;
  names["__name__"] = "poise._poise";
  names["one_line"] =
      py::cpp_function([](const py::str& text) { return text_of(InputError(utf8_with_escapes(text)).what()); });
  py::exec(R"(
class InputError(ValueError):
    """Bad input, in the one line that the command line prints: what was expected, found, and a likely fix."""

    def __init__(self, *arguments):
        super().__init__(*(one_line(one) if isinstance(one, str) else one for one in arguments))
)",
           names);
  return names["InputError"];
}

}  // namespace
}  // namespace poise::python

PYBIND11_MODULE(_poise, m) {
  // It is raised for as long as the process lives.
  static const py::handle input_error = poise::python::input_error_class().release();
  m.attr("InputError") = input_error;
  // NOLINTNEXTLINE(performance-unnecessary-value-param): pybind11 takes a function of this signature
  py::register_exception_translator([](std::exception_ptr error) {
    try {
      if (error) std::rethrow_exception(error);
    } catch (const poise::InputError& wrong) {
      PyErr_SetObject(input_error.ptr(), poise::python::text_of(wrong.what()).ptr());
    }
  });
  input_error.attr("__module__") = "poise";
  m.attr("version") = POISE_VERSION;
  poise::python::bind_scenes(m);
  poise::python::bind_builder(m);
  poise::python::bind_commands(m);
  poise::python::bind_view(m);
  poise::python::bind_many(m);
  poise::python::bind_numerics(m);
  poise::python::bind_path_many(m);
  poise::python::bind_timing(m);
}
