#include "solvers/dynamic_relaxation.hpp"

namespace poise::solvers {

SearchResult solve_with_dynamic_relaxation(const Problem&, const std::vector<double>& start, const SearchOptions&,
                                           const std::vector<int>&) {
  SearchResult result;
  result.x = start;
  result.status = "not built yet";
  return result;
}

}  // namespace poise::solvers
