#pragma once

#include <string>
#include <vector>

namespace poise::app {

/// A table as CSV (RFC 4180, lines ended by "\n"): one line of names, then row i holds columns[0][i], columns[1][i],
/// ... Each number has the fewest digits that read back as exactly the same double; one that is not finite leaves its
/// cell empty. Names are quoted where they must be. As many columns as names, all of the same length; without a column
/// the text is empty. `words` are further columns before the others, headed by the first of the names.
std::string csv_text(const std::vector<std::string>& header, const std::vector<std::vector<double>>& columns,
                     const std::vector<std::vector<std::string>>& words = {});

}  // namespace poise::app
