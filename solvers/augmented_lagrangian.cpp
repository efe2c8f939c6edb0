#include "solvers/augmented_lagrangian.hpp"

namespace poise::solvers {

SearchResult solve_with_augmented_lagrangian(const Problem&, const std::vector<double>& start,
                                             const AugmentedLagrangianOptions&, const std::vector<int>&) {
  SearchResult result;
  result.x = start;
  result.status = "not built yet";
  return result;
}

}  // namespace poise::solvers
