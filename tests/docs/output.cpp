#include "tests/docs/output.hpp"

#include <algorithm>
#include <cmath>
#include <regex>
#include <set>
#include <sstream>

namespace poise::docs_tests {
namespace {

constexpr const char* cut = "...";

struct Number {
  double value = 0.0;
  double last_digit = 0.0;  ///< one unit of the last printed decimal; 0 for whole numbers
};

struct Tokens {
  std::string words;  ///< with every number replaced by '#'
  std::vector<Number> numbers;
};

/// Durations and versions, which differ between runs and releases, as words.
std::string without_times(const std::string& line) {
  static const std::regex short_times(R"((^|[\s(])<?[0-9.e+-]+ (ns|µs|ms|min)(?![A-Za-z/]))");
  static const std::regex seconds(R"((^|[\s(])[0-9.e+-]+ s(?![A-Za-z/²]))");
  static const std::regex last_in_brackets(R"(, [0-9.e+-]+ s\))");
  static const std::regex begins_with_effort(R"(^\s*(effort|method)\b)");
  static const std::regex version(R"(\bpoise [0-9]+\.[0-9]+\.[0-9]+)");
  std::string out = std::regex_replace(line, short_times, "$1TIME");
  if (std::regex_search(line, begins_with_effort)) out = std::regex_replace(out, seconds, "$1TIME");
  out = std::regex_replace(out, last_in_brackets, ", TIME)");
  return std::regex_replace(out, version, "poise VERSION");
}

Tokens tokens_of(const std::string& raw) {
  static const std::regex number(R"(<?([+-]?)([0-9]+)(\.[0-9]+)?(e[+-]?[0-9]+)?)");
  const std::string line = without_times(raw);
  Tokens out;
  std::size_t end = 0;
  const auto add_words = [&](const std::string& words) {
    for (const char c : words) {
      const bool blank = c == ' ' || c == '\t';
      if (!blank || (!out.words.empty() && out.words.back() != ' ')) out.words += blank ? ' ' : c;
    }
  };
  for (std::sregex_iterator it(line.begin(), line.end(), number); it != std::sregex_iterator(); ++it) {
    const auto begin = static_cast<std::size_t>(it->position());
    add_words(line.substr(end, begin - end));
    const std::string decimals = (*it)[3].str();
    const std::string exponent = (*it)[4].str();
    const double power = exponent.empty() ? 1.0 : std::pow(10.0, std::stod(exponent.substr(1)));
    const double magnitude = std::stod((*it)[2].str() + decimals) * power;
    // Whole numbers are counts, or parts of names, and have no uncertain decimal.
    const double digits = decimals.empty() ? 0.0 : static_cast<double>(decimals.size()) - 1.0;
    const bool exact = decimals.empty() && exponent.empty();
    out.numbers.push_back(
        {(*it)[1].str() == "-" ? -magnitude : magnitude, exact ? 0.0 : std::pow(10.0, -digits) * power});
    out.words += '#';
    end = begin + static_cast<std::size_t>(it->length());
  }
  add_words(line.substr(end));
  while (out.words.ends_with(' ')) out.words.pop_back();
  return out;
}

bool alike(const Number& a, const Number& b) {
  const double largest = std::max(std::abs(a.value), std::abs(b.value));
  if (largest < 1e-9) return true;
  return std::abs(a.value - b.value) <= std::max({1e-6 * largest, 3.001 * a.last_digit, 3.001 * b.last_digit});
}

/// Common words over all words, numbers left out: 1 for lines that differ in numbers only.
double likeness(const std::string& a, const std::string& b) {
  const auto words_of = [](const std::string& line) {
    std::istringstream stream(tokens_of(line).words);
    std::multiset<std::string> words;
    for (std::string word; stream >> word;) words.insert(word);
    return words;
  };
  const std::multiset<std::string> words_a = words_of(a);
  const std::multiset<std::string> words_b = words_of(b);
  if (words_a.empty() && words_b.empty()) return 1.0;
  std::vector<std::string> common;
  std::set_intersection(words_a.begin(), words_a.end(), words_b.begin(), words_b.end(), std::back_inserter(common));
  return 2.0 * static_cast<double>(common.size()) / static_cast<double>(words_a.size() + words_b.size());
}

/// The line from `begin` on that is most like `line`; among equals the one nearest to `guess`.
std::size_t most_like(const std::string& line, const std::vector<std::string>& printed, std::size_t begin,
                      std::size_t guess) {
  const std::size_t last = printed.size() - 1;
  std::size_t best = std::min(std::max(guess, begin), last);
  for (std::size_t i = begin; i < printed.size(); ++i) {
    const auto distance = [&](std::size_t at) { return at > guess ? at - guess : guess - at; };
    const double gain = likeness(line, printed[i]) - likeness(line, printed[best]);
    if (gain > 0.0 || (gain == 0.0 && distance(i) < distance(best))) best = i;
  }
  return best;
}

/// Expected lines between cuts.
std::vector<std::vector<std::string>> pieces_of(const std::vector<std::string>& expected) {
  std::vector<std::vector<std::string>> out(1);
  for (const std::string& line : expected) {
    if (line == cut) {
      out.emplace_back();
    } else {
      out.back().push_back(line);
    }
  }
  return out;
}

std::string difference_at(const std::vector<std::string>& piece, const std::vector<std::string>& printed,
                          std::size_t at) {
  for (std::size_t i = 0; i < piece.size(); ++i) {
    if (at + i >= printed.size()) return "expected: " + piece[i] + "\nfound the end of the output";
    if (std::string why = difference(piece[i], printed[at + i]); !why.empty()) return why;
  }
  return "";
}

}  // namespace

std::string difference(const std::string& expected, const std::string& printed) {
  const Tokens a = tokens_of(expected);
  const Tokens b = tokens_of(printed);
  const std::string both = "expected: " + expected + "\nprinted:  " + printed;
  if (a.words != b.words) return both;
  for (std::size_t i = 0; i < a.numbers.size(); ++i) {
    if (!alike(a.numbers[i], b.numbers[i])) return both;
  }
  return "";
}

std::string difference(const std::vector<std::string>& expected, const std::vector<std::string>& printed) {
  const auto pieces = pieces_of(expected);
  std::size_t at = 0;
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    const std::size_t size = pieces[p].size();
    const bool is_last = p + 1 == pieces.size();
    if (p > 0 && is_last) {
      if (at + size > printed.size()) return "expected more lines after \"...\"";
      at = printed.size() - size;
    }
    std::string why = difference_at(pieces[p], printed, at);
    for (std::size_t later = at + 1; p > 0 && !is_last && !why.empty() && later + size <= printed.size(); ++later) {
      if (difference_at(pieces[p], printed, later).empty()) {
        why.clear();
        at = later;
      }
    }
    if (!why.empty()) return why;
    at += size;
  }
  return at == printed.size() ? "" : "printed more: " + printed[at];
}

std::vector<std::string> cut_like(const std::vector<std::string>& expected, const std::vector<std::string>& printed) {
  const auto pieces = pieces_of(expected);
  if (pieces.size() == 1 || printed.empty()) return printed;
  std::vector<std::string> out;
  std::size_t at = 0;
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    const auto& piece = pieces[p];
    if (p > 0) out.emplace_back(cut);
    if (piece.empty() || at >= printed.size()) continue;
    const std::size_t begin = p == 0 ? 0 : most_like(piece.front(), printed, at, at);
    const bool to_the_end = p + 1 == pieces.size();
    const std::size_t last =
        to_the_end ? printed.size() - 1 : most_like(piece.back(), printed, begin, begin + piece.size() - 1);
    for (at = begin; at <= last; ++at) out.push_back(printed[at]);
  }
  return out;
}

}  // namespace poise::docs_tests
