#pragma once

// What readers of other programs' files have in common. All of them bound what they take, so that no file, however
// large or deep, costs more than a moment.

#include <cstddef>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

namespace poise {

/// Joints and points that a file may have, of each; and its links, of which all are assembled.
inline constexpr std::size_t most_items = 10'000, most_links = 1'000;

/// Of one turn a minute.
inline constexpr double degrees_per_second = 6.0;

/// Throws InputError "file:line: item: message"; line 0 is that of the whole file, and an empty item is left out.
[[noreturn]] void fail_at(const std::string& file, int line, const std::string& item, const std::string& message);

/// The lines of a text, without their ends; a carriage return belongs to the end.
std::vector<std::string_view> lines_of(std::string_view text);

/// Without blanks and tabs at both ends.
std::string_view trimmed(std::string_view text);

/// In small letters, by ASCII.
std::string in_small_letters(std::string_view text);

/// A number as it is written, of a size that a scene can have in any unit. Throws InputError as fail_at().
double number_at(std::string_view word, const std::string& file, int line, const std::string& item);

/// The name, bounded and never empty, and none of those `taken`: another of the same name gets a number. It is taken
/// from then on.
std::string own_name(std::string_view name, std::unordered_set<std::string>& taken);

/// The same with what a name of a point may not hold replaced by an underscore.
std::string name_beside(std::string_view name, std::unordered_set<std::string>& taken);

/// A, B, ..., Z, A2, B2, ...: what points are called that have no names.
std::string point_name(std::size_t index);

}  // namespace poise
