#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace poise {

/// Edit distance of two names (optimal string alignment: the Damerau-Levenshtein distance in which no part is edited
/// twice): the least number of letters inserted, deleted, replaced or swapped with their neighbour that changes a into
/// b. Letters are bytes. Cost |a| |b|.
int edit_distance(std::string_view a, std::string_view b);

/// Whether one may be a misspelling of the other. L letters are those of the longer one:
///
/// edits    at most 1 for L <= 4, 2 for L <= 8, 3 for more, and always fewer than L/2. A slip of the finger is one
/// edit,
///          and longer names leave room for more of them; but names of many letters are paths, which differ in one part
///          only, so that more edits are another name. "gear" is not near "bar".
/// or       one begins the other and has at least half of its letters, 2 or more: "len" is near "length".
///
/// Names of more than 200 letters are near nothing.
bool is_near(std::string_view name, std::string_view candidate);

/// The tail of an error message that names what is valid, `; did you mean "NAME"?`, with the candidate of least edit
/// distance (the first of several) among those that are near; empty when none is.
std::string did_you_mean(std::string_view name, const std::vector<std::string>& candidates);

/// The same for a message that does not name what is valid: where no candidate is near, the tail lists them,
/// `; known here: a, b, c`. Of more than a dozen it lists the nearest (where one has more than 200 letters, the first),
/// and counts the others: `... and 5 more`.
std::string did_you_mean_or_list(std::string_view name, const std::vector<std::string>& candidates);

}  // namespace poise
