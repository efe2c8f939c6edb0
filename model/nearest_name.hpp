#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace poise {

/// Edit distance of two names (optimal string alignment: the Damerau-Levenshtein distance in which no part is edited
/// twice): the least number of letters inserted, deleted, replaced or swapped with their neighbour that turns a into
/// b. Letters are bytes. Takes |a| |b| steps.
int edit_distance(std::string_view a, std::string_view b);

/// The tail of an error message, `; did you mean "NAME"?`, with the candidate of least edit distance (the first of
/// several); empty when there are no candidates.
std::string did_you_mean(std::string_view name, const std::vector<std::string>& candidates);

}  // namespace poise
