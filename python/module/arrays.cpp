#include "python/module/arrays.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "model/input_error.hpp"
#include "python/module/conversion.hpp"

namespace poise::python {
namespace {

bool has_shape(const py::array& array, const std::vector<py::ssize_t>& shape) {
  return array.ndim() == static_cast<py::ssize_t>(shape.size()) &&
         std::equal(shape.begin(), shape.end(), array.shape());
}

std::vector<py::ssize_t> shape_of(const py::array& array) { return {array.shape(), array.shape() + array.ndim()}; }

/// The object as an array; nothing where it makes none. (`Array::ensure()` clears Ctrl-C as well.)
template <class Array>
std::optional<Array> array_of(const py::object& given) {
  try {
    return Array(given);
  } catch (const py::error_already_set& error) {
    if (!error.matches(PyExc_Exception)) throw;
    return std::nullopt;
  }
}

}  // namespace

std::string shape_text(const std::vector<py::ssize_t>& shape) {
  return fmt::format("({}{})", fmt::join(shape, ", "), shape.size() == 1 ? "," : "");
}

py::array_t<double> real_array(const py::object& given, const char* name) {
  if (py::isinstance<py::array_t<double, py::array::c_style>>(given)) {
    return py::reinterpret_borrow<py::array_t<double>>(given);
  }
  const std::optional<py::array> any = array_of<py::array>(given);
  if (!any) {
    throw InputError(fmt::format("{}: expected an array of numbers, found {}", name, shown(given)));
  }
  const char kind = any->dtype().kind();
  if (kind != 'f' && kind != 'i' && kind != 'u') {
    throw InputError(fmt::format("{}: expected an array of real numbers, found {}", name,
                                 any->size() > 8 ? "one of " + std::string(py::str(any->dtype())) : shown(given)));
  }
  const auto out = array_of<py::array_t<double, py::array::c_style | py::array::forcecast>>(*any);
  if (!out) {
    throw InputError(fmt::format("{}: expected an array of real numbers, found {}", name, shown(given)));
  }
  return py::reinterpret_borrow<py::array_t<double>>(*out);
}

NumbersIn::NumbersIn(const py::object& given, const char* name, const std::vector<py::ssize_t>& shape)
    : array_(real_array(given, name)) {
  if (!has_shape(array_, shape)) {
    throw InputError(fmt::format("{}: expected an array of shape {}, found one of {}", name, shape_text(shape),
                                 shape_text(shape_of(array_))));
  }
  const double* const begin = array_.data();
  const double* const end = begin + array_.size();
  const double* const wrong = std::find_if(begin, end, [](double value) { return !std::isfinite(value); });
  if (wrong != end) {
    throw InputError(fmt::format("{}: expected finite numbers, found {} at index {}", name, *wrong, wrong - begin));
  }
}

NumbersOut::NumbersOut(const py::object& given, const std::vector<py::ssize_t>& shape) {
  if (given.is_none()) {
    py::array_t<double> made(shape);
    data_ = made.mutable_data();
    array_ = std::move(made);
    return;
  }
  const bool is_array = py::isinstance<py::array_t<double, py::array::c_style>>(given);
  if (!is_array || !has_shape(py::reinterpret_borrow<py::array>(given), shape) ||
      !py::reinterpret_borrow<py::array>(given).writeable()) {
    throw InputError(fmt::format("out: expected a writable contiguous array of float64 of shape {}, found {}",
                                 shape_text(shape),
                                 py::isinstance<py::array>(given)
                                     ? fmt::format("one of {} of shape {}", std::string(py::str(given.attr("dtype"))),
                                                   shape_text(shape_of(py::reinterpret_borrow<py::array>(given))))
                                     : shown(given)));
  }
  array_ = given;
  data_ = static_cast<double*>(py::reinterpret_borrow<py::array>(given).mutable_data());
}

}  // namespace poise::python
