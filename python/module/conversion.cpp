#include "python/module/conversion.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <map>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "model/input_error.hpp"
#include "model/one_line.hpp"
#include "model/units.hpp"
#include "statics/model/readings.hpp"

namespace poise::python {
namespace {

using UnitTable = std::map<std::string, std::pair<std::string, double>>;

/// The SI name and the SI value of each unit that a scene may have.
UnitTable units_of_scenes() {
  UnitTable out;
  for (const char* name : {"m", "mm", "in", "ft"}) out[name] = {"m", units_of({.length = name}).length};
  for (const char* name : {"N", "kN", "lbf"}) out[name] = {"N", units_of({.force = name}).force};
  for (const char* name : {"kg", "g", "lb"}) out[name] = {"kg", units_of({.mass = name}).mass};
  for (const char* name : {"rad", "deg"}) out[name] = {"rad", units_of({.angle = name}).angle};
  return out;
}

/// The power that stands behind a unit, "mm²".
int power_in(const std::string& behind) { return behind == "²" ? 2 : behind == "³" ? 3 : behind == "⁴" ? 4 : 1; }

}  // namespace

std::pair<std::string, double> si_unit(const std::string& unit) {
  static const UnitTable table = units_of_scenes();
  std::string name;
  double value = 1.0;
  for (std::size_t at = 0; at < unit.size();) {
    const bool is_below = unit[at] == '/';
    if (is_below || unit[at] == ' ') name += unit[at++];
    const std::size_t end = std::min(unit.find_first_of(" /", at), unit.size());
    std::size_t letters = at;
    while (letters < end && std::isalnum(static_cast<unsigned char>(unit[letters])) != 0) ++letters;
    const std::string behind = unit.substr(letters, end - letters);
    const auto known = table.find(unit.substr(at, letters - at));
    name += known != table.end() ? known->second.first + behind : unit.substr(at, end - at);
    if (known != table.end()) value *= std::pow(known->second.second, is_below ? -power_in(behind) : power_in(behind));
    at = std::max(end, at + 1);
  }
  return {name, value};
}

py::object to_python(const nlohmann::json& value) {
  switch (value.type()) {
    case nlohmann::json::value_t::object: {
      py::dict out;
      for (const auto& [key, member] : value.items()) out[py::str(key)] = to_python(member);
      return out;
    }
    case nlohmann::json::value_t::array: {
      py::list out(value.size());
      for (std::size_t i = 0; i < value.size(); ++i) out[i] = to_python(value[i]);
      return out;
    }
    case nlohmann::json::value_t::string: {
      // Names of a scene are bytes that a file has.
      const std::string& text = value.get_ref<const std::string&>();
      return py::reinterpret_steal<py::object>(
          PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "replace"));
    }
    case nlohmann::json::value_t::boolean:
      return py::bool_(value.get<bool>());
    case nlohmann::json::value_t::number_integer:
      return py::int_(value.get<std::int64_t>());
    case nlohmann::json::value_t::number_unsigned:
      return py::int_(value.get<std::uint64_t>());
    case nlohmann::json::value_t::number_float:
      // What is not finite is null in the JSON that is written.
      if (const double number = value.get<double>(); std::isfinite(number)) return py::float_(number);
      return py::none();
    default:
      return py::none();
  }
}

py::str text_of(const std::string& text) {
  return py::reinterpret_steal<py::str>(
      PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "replace"));
}

SceneObject::Changes changes_of(const py::dict& numbers) {
  SceneObject::Changes out;
  // A copy: what makes a number of an object may change the dictionary that it came from.
  const auto copy = py::reinterpret_steal<py::dict>(PyDict_Copy(numbers.ptr()));
  for (const auto& [name, value] : copy) {
    if (!py::isinstance<py::str>(name)) {
      throw InputError(fmt::format("expected the name of a number, found {}", shown(name)));
    }
    const std::string path = utf8(name);
    const std::optional<double> number = number_in(value);
    if (!number) throw InputError(fmt::format("{}: expected a number, found {}", path, shown(value)));
    out.emplace_back(path, *number);
  }
  return out;
}

bool is_flag(const py::handle& object) {
  if (PyBool_Check(object.ptr()) != 0) return true;
  // NumPy's own, whose name depends on its version.
  const std::string_view type = Py_TYPE(object.ptr())->tp_name;
  return type == "numpy.bool_" || type == "numpy.bool";
}

void clear_failed_conversion() {
  if (PyErr_ExceptionMatches(PyExc_Exception) == 0) throw py::error_already_set();
  PyErr_Clear();
}

std::optional<double> number_in(const py::handle& object) {
  if (is_flag(object)) return std::nullopt;
  const double number = PyFloat_AsDouble(object.ptr());
  if (number == -1.0 && PyErr_Occurred() != nullptr) {
    clear_failed_conversion();
    return std::nullopt;
  }
  return number;
}

std::string utf8(const py::handle& text) {
  Py_ssize_t size = 0;
  if (const char* const bytes = PyUnicode_AsUTF8AndSize(text.ptr(), &size); bytes != nullptr) {
    return {bytes, static_cast<std::size_t>(size)};
  }
  clear_failed_conversion();
  throw InputError(fmt::format("expected a text that UTF-8 can hold, found {}", shown(text)));
}

py::dict touching_names(const StaticModel& model, const std::vector<int>& stops, const std::vector<double>& scaled) {
  py::dict out;
  if (stops.empty()) return out;
  const Readings readings = read_off(model, scaled);
  for (const int s : stops) {
    const Stop& stop = model.scene().stops[static_cast<std::size_t>(s)];
    if (stop.holds()) continue;
    out[text_of(stop.name)] = pressed_limit(stop, readings.stops[static_cast<std::size_t>(s)]).name;
  }
  return out;
}

std::string utf8_with_escapes(const py::handle& text) {
  const auto bytes =
      py::reinterpret_steal<py::object>(PyUnicode_AsEncodedString(text.ptr(), "utf-8", "backslashreplace"));
  if (!bytes) throw py::error_already_set();
  return {PyBytes_AS_STRING(bytes.ptr()), static_cast<std::size_t>(PyBytes_GET_SIZE(bytes.ptr()))};
}

std::string shown(const py::handle& object) {
  constexpr std::size_t most = 200;
  const auto repr = py::reinterpret_steal<py::object>(PyObject_Repr(object.ptr()));
  if (!repr) {
    clear_failed_conversion();
    return "something that cannot be shown";
  }
  std::string out = utf8_with_escapes(repr);
  if (out.size() > most) out = out.substr(0, most) + "...";
  return out;
}

}  // namespace poise::python
