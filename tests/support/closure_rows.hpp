#pragma once

// Rows of the loop closures.

#include <numeric>
#include <vector>

#include "model/mechanism.hpp"

namespace poise::test {

inline std::vector<int> closure_rows(const Mechanism<double>& mechanism) {
  std::vector<int> rows(mechanism.equalities());
  std::iota(rows.begin(), rows.end(), 0);
  return rows;
}

}  // namespace poise::test
