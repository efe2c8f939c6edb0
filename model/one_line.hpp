#pragma once

#include <string>
#include <string_view>

namespace poise {

/// The text as one line that a terminal shows and JSON takes: a control character (line breaks, escapes, U+0080 to
/// U+009F) becomes a blank, and each byte that is not part of valid UTF-8 a question mark.
std::string one_line(std::string_view text);

/// The words of a key: "torsion_spring" -> "torsion spring".
std::string words_of_key(std::string_view key);

}  // namespace poise
