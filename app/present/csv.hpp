#pragma once

#include <string>

#include "app/result/result.hpp"

namespace poise::app {

/// A table as CSV (RFC 4180, lines ended by "\n"): one line of the columns' keys, then one line for each row; columns
/// without a key are left out. Each number has the fewest digits that read back as exactly the same double; one that is
/// not finite leaves its cell empty; flags are 0 and 1. Texts are quoted where they must be. Without rows there is
/// the header alone; without columns the text is empty.
std::string csv_text(const Table& table);

}  // namespace poise::app
