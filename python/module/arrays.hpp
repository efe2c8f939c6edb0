#pragma once

#include <string>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

namespace py = pybind11;

namespace poise::python {

/// "(3, 2)", as NumPy writes shapes.
std::string shape_text(const std::vector<py::ssize_t>& shape);

/// Real numbers in an array, contiguous; without a copy where they are float64 already. Throws InputError for what is
/// no array of real numbers.
py::array_t<double> real_array(const py::object& given, const char* name);

/// Finite numbers of a given shape that a caller hands in; without a copy where they are contiguous float64.
class NumbersIn {
 public:
  /// Throws InputError, with `name`, for another shape, for what are no real numbers, and for what is not finite.
  NumbersIn(const py::object& given, const char* name, const std::vector<py::ssize_t>& shape);

  const double* data() const { return array_.data(); }
  py::ssize_t size() const { return array_.size(); }

 private:
  py::array_t<double> array_;
};

/// An array for results: the one that a caller hands in as `out`, or a new one.
class NumbersOut {
 public:
  /// Throws InputError for an `out` that is no writable contiguous array of float64 of that shape.
  NumbersOut(const py::object& given, const std::vector<py::ssize_t>& shape);

  double* data() { return data_; }
  const py::object& object() const { return array_; }

 private:
  py::object array_;
  double* data_ = nullptr;
};

}  // namespace poise::python
