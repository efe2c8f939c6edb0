#pragma once

#include "app/result/result.hpp"
#include "design/synthesis/path_problem.hpp"
#include "design/synthesis/path_search.hpp"

namespace poise::app {

/// What `poise design` shows of linkages through points or along a curve: whether they pass all points, the best ones
/// with their dimensions, errors and defects, and, as data, the angles of their cranks and their cognates.
/// `microseconds` is what the search took.
Result path_synthesis_result(const PathProblem& problem, const PathAnswer& answer, const PathSearchOptions& options,
                             double microseconds);

/// The best linkage without a defect; null where there is none.
const PathSolution* path_to_build(const PathAnswer& answer);

/// That linkage passes all points within the tolerance, or, where the unknowns do not suffice, keeps the limit of its
/// error, if there is one.
bool path_is_met(const PathProblem& problem, const PathAnswer& answer);

}  // namespace poise::app
