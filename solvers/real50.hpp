#pragma once

// The scalar of 50 digits in which references are computed, ready for Eigen.

#include <limits>

#include <Eigen/Core>
#include <boost/multiprecision/cpp_bin_float.hpp>

namespace poise {

using Real50 = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<50>, boost::multiprecision::et_off>;

}  // namespace poise

// The traits that Eigen requires of a scalar. (The traits that Boost 1.74 ships lack members that Eigen 3.4 asks for.)
template <>
struct Eigen::NumTraits<poise::Real50> : Eigen::GenericNumTraits<poise::Real50> {
  // NOLINTBEGIN(readability-identifier-naming): Eigen's names
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 1,
    ReadCost = 8,
    AddCost = 8,
    MulCost = 16
  };
  // NOLINTEND(readability-identifier-naming)
  static poise::Real50 dummy_precision() { return 1000 * epsilon(); }
  static int digits10() { return std::numeric_limits<poise::Real50>::digits10; }
};
