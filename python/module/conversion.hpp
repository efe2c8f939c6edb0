#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "python/module/scene_object.hpp"

namespace py = pybind11;

namespace poise::python {

/// The same data in dictionaries, lists, numbers and texts; what is not finite is None, as it is null in a file.
py::object to_python(const nlohmann::json& value);

/// As text, whatever the bytes: what is no UTF-8 is replaced.
py::str text_of(const std::string& text);

/// The SI unit of the same kind and the SI value of one unit: of "N mm/deg" it is "N m/rad" and 0.0573. Units that are
/// none of a scene's units (units_of()), such as s or J, are SI ones.
std::pair<std::string, double> si_unit(const std::string& unit);

/// The names and numbers of a dictionary. Throws InputError for a key that is no name or a value that is no number.
SceneObject::Changes changes_of(const py::dict& numbers);

/// Whether it is True or False, of Python or of NumPy.
bool is_flag(const py::handle& object);

/// Clears the pending error of Python where it says that a value is none of what was expected; throws it where it is to
/// end the program (KeyboardInterrupt, SystemExit), whatever was being converted when it came.
void clear_failed_conversion();

/// The number that an object is, or that it makes of itself; none of a flag and of what is no number.
std::optional<double> number_in(const py::handle& object);

/// The bytes of a text of Python. Throws InputError for one with surrogates, which UTF-8 has no bytes for.
std::string utf8(const py::handle& text);

/// The same with Python's escapes, "\\ud800", for surrogates.
std::string utf8_with_escapes(const py::handle& text);

/// What Python shows of an object, for messages: one line of at most 200 bytes.
std::string shown(const py::handle& object);

/// {"NAME": "min"} of stops (indices of Scene::stops) that are touched at the scaled coordinates; without those that
/// always hold.
py::dict touching_names(const StaticModel& model, const std::vector<int>& stops, const std::vector<double>& scaled);

/// A view of numbers that belong to what was found, which it keeps alive.
template <class Owner>
py::array view_of(const std::vector<double>& numbers, const std::shared_ptr<const Owner>& owner) {
  py::array_t<double> out(static_cast<py::ssize_t>(numbers.size()), numbers.data(),
                          py::cast(std::const_pointer_cast<Owner>(owner)));
  py::detail::array_proxy(out.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return out;
}

}  // namespace poise::python
