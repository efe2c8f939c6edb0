#include "solvers/least_squares.hpp"

namespace poise::solvers {

SearchResult solve_with_least_squares(const Problem&, const std::vector<double>& start, const SearchOptions&,
                                      const std::vector<int>&) {
  SearchResult result;
  result.x = start;
  result.status = "not built yet";
  return result;
}

}  // namespace poise::solvers
