#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/numpy.h>

namespace poise::python {

/// Numbers of many variants of a scene: a path and a contiguous float64 array with a value for each variant, or one for
/// all.
using ManyNumbers = std::vector<std::pair<std::string, pybind11::array_t<double>>>;

/// "5 of 100 variants".
std::string variants_done(std::size_t done, std::size_t all);

}  // namespace poise::python
