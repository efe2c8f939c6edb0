#pragma once

#include <cmath>
#include <string>

namespace poise::page_tests {

/// The text of the document in a page of `poise --html`, decoded as docs/json.md says. Throws std::runtime_error where
/// there is none.
std::string document_in(const std::string& page);

/// Whether the data of a page are those of a file of --json, numbers to 9 digits.
template <class Json>
bool are_data_of(const Json& page, const Json& file) {
  if (file.is_number_float()) {
    return page.is_number_float() && std::abs(page.template get<double>() - file.template get<double>()) <=
                                         5.01e-9 * std::abs(file.template get<double>());
  }
  if (!file.is_structured()) return page == file;
  if (page.type() != file.type() || page.size() != file.size()) return false;
  for (auto one = page.begin(), other = file.begin(); one != page.end(); ++one, ++other) {
    if (!are_data_of(*one, *other) || (file.is_object() && one.key() != other.key())) return false;
  }
  return true;
}

}  // namespace poise::page_tests
