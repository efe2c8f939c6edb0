#include "tests/app/mutate.hpp"

#include <algorithm>
#include <cctype>
#include <functional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace poise::app_tests {
namespace {

struct Span {
  std::size_t begin = 0, end = 0;
};

/// Runs of the characters that `is_part` accepts.
std::vector<Span> runs(const std::string& text, const std::function<bool(char)>& is_part) {
  std::vector<Span> out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (!is_part(text[i])) continue;
    if (out.empty() || out.back().end != i) out.push_back({i, i});
    out.back().end = i + 1;
  }
  return out;
}

bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-'; }

std::vector<Span> tokens(const std::string& text) {
  return runs(text, [](char c) { return is_word(c) || c == '.' || c == '+'; });
}

/// Numbers with a meaning: not those of comments, titles and sources.
std::vector<Span> numbers(const std::string& text) {
  std::vector<Span> all = tokens(text);
  std::erase_if(all, [&](const Span& s) {
    const std::string_view line = std::string_view(text).substr(text.rfind('\n', s.begin) + 1);
    if (line.starts_with('#') || line.starts_with("title") || line.starts_with("source")) return true;
    const char first = text[s.begin], second = s.end - s.begin > 1 ? text[s.begin + 1] : first;
    return std::isdigit(static_cast<unsigned char>(first == '-' || first == '+' ? second : first)) == 0;
  });
  return all;
}

std::vector<Span> names(const std::string& text) {
  std::vector<Span> all = runs(text, is_word);
  std::erase_if(all, [&](const Span& s) { return std::isalpha(static_cast<unsigned char>(text[s.begin])) == 0; });
  return all;
}

std::vector<Span> lines(const std::string& text) {
  std::vector<Span> out{{0, 0}};
  for (std::size_t i = 0; i < text.size(); ++i) {
    out.back().end = i + 1;
    if (text[i] == '\n') out.push_back({i + 1, i + 1});
  }
  return out;
}

/// What is behind the equals signs, to the ends of their lines.
std::vector<Span> values(const std::string& text) {
  std::vector<Span> out;
  for (const Span& line : lines(text)) {
    const std::size_t equals = text.find('=', line.begin);
    if (equals < line.end) out.push_back({equals + 1, std::max(equals + 1, line.end - 1)});
  }
  return out;
}

std::string repeated(const std::string& part, std::size_t count) {
  std::string out;
  out.reserve(part.size() * count);
  for (std::size_t i = 0; i < count; ++i) out += part;
  return out;
}

std::string misspelt(std::string name, Random& random) {
  const std::size_t at = random.below(name.size());
  switch (random.below(4)) {
    case 0:
      return name.erase(at, 1);
    case 1:
      return name.insert(at, 1, name[at]);
    case 2:
      name[at] = static_cast<char>('a' + random.below(26));
      return name;
    default:
      std::swap(name[at], name[random.below(name.size())]);
      return name;
  }
}

const std::vector<std::string> odd_bytes = {std::string(1, '\0'),
                                            "\xFF",
                                            "\xC3",
                                            "\xE2\x82",
                                            "\xED\xA0\x80",
                                            "\xC0\x80",
                                            "\x1b[31m",
                                            "\x07",
                                            "\x7f",
                                            "\xC2\x9B"
                                            "31m",
                                            "\r",
                                            "\t",
                                            "\xF0\x9F\x98\x80",
                                            "\xE2\x80\xAE",
                                            "\"",
                                            "'",
                                            "\\",
                                            "\\u0000",
                                            "\\x",
                                            "#",
                                            "=",
                                            "[",
                                            "]",
                                            "{",
                                            "}",
                                            ",",
                                            "."};

const std::vector<std::string> odd_values = {"\"\"",
                                             "\"text\"",
                                             "[]",
                                             "{}",
                                             "[1]",
                                             "[1, 2, 3]",
                                             "[[1, 2], [3, 4]]",
                                             "[\"a\", \"b\"]",
                                             "true",
                                             "false",
                                             "1979-05-27",
                                             "07:32:00",
                                             "{ a = 1 }",
                                             "[nan, inf]",
                                             "[1e308, -1e308]",
                                             "",
                                             "\"\"\"\n\"\"\"",
                                             "[1, \"a\"]"};

/// Writes over one of the spans, if there is any.
void replace_one(std::string& text, const std::vector<Span>& spans, Random& random, std::string& how,
                 const std::function<std::string(const std::string&)>& by) {
  if (spans.empty()) return;
  const Span span = random.of(spans);
  const std::string was = text.substr(span.begin, span.end - span.begin), is = by(was);
  how += fmt::format("\"{}\" -> \"{}\"", was.substr(0, 60), is.substr(0, 60));
  text.replace(span.begin, was.size(), is);
}

using Change = std::pair<const char*, void (*)(std::string& text, Random& random, std::string& how)>;

const std::vector<Change> changes = {
    {"odd number",
     [](std::string& text, Random& random, std::string& how) {
       replace_one(text, numbers(text), random, how, [&](const std::string&) { return random.of(odd_numbers()); });
     }},
    {"another number",
     [](std::string& text, Random& random, std::string& how) {
       replace_one(text, numbers(text), random, how, [&](const std::string& was) {
         const std::vector<std::string> others = {"-" + was, was + "e3", was + "e-3", was + "0", "0" + was, "1", "-1"};
         return random.of(others);
       });
     }},
    {"odd value",
     [](std::string& text, Random& random, std::string& how) {
       replace_one(text, values(text), random, how, [&](const std::string&) { return random.of(odd_values); });
     }},
    {"misspelt",
     [](std::string& text, Random& random, std::string& how) {
       replace_one(text, names(text), random, how, [&](const std::string& was) { return misspelt(was, random); });
     }},
    {"another name",
     [](std::string& text, Random& random, std::string& how) {
       const std::vector<Span> all = names(text);
       if (all.empty()) return;
       const Span other = random.of(all);
       const std::string name = text.substr(other.begin, other.end - other.begin);
       replace_one(text, all, random, how, [&](const std::string&) { return name; });
     }},
    {"no name",
     [](std::string& text, Random& random, std::string& how) {
       replace_one(text, names(text), random, how, [](const std::string&) { return ""; });
     }},
    {"deleted byte", [](std::string& text, Random& random, std::string&) { text.erase(random.below(text.size()), 1); }},
    {"doubled byte",
     [](std::string& text, Random& random, std::string&) {
       const std::size_t at = random.below(text.size());
       text.insert(at, 1, text[at]);
     }},
    {"garbled byte",
     [](std::string& text, Random& random, std::string& how) {
       const std::size_t at = random.below(text.size());
       text[at] = static_cast<char>(random.below(256));
       how += fmt::format("byte {} is {:#x}", at, static_cast<unsigned char>(text[at]));
     }},
    {"odd bytes",
     [](std::string& text, Random& random, std::string& how) {
       const std::string& odd = random.of(odd_bytes);
       const std::size_t at = random.below(text.size());
       text.insert(at, odd);
       how += fmt::format("\"{}\" at {}", odd, at);
     }},
    {"odd bytes in a name",
     [](std::string& text, Random& random, std::string& how) {
       replace_one(text, names(text), random, how, [&](const std::string& was) { return was + random.of(odd_bytes); });
     }},
    {"cut out",
     [](std::string& text, Random& random, std::string&) {
       const std::size_t length = random.below(40);
       text.erase(random.below(text.size()), length);
     }},
    {"truncated", [](std::string& text, Random& random, std::string&) { text.resize(random.below(text.size())); }},
    {"deleted line",
     [](std::string& text, Random& random, std::string& how) {
       replace_one(text, lines(text), random, how, [](const std::string&) { return ""; });
     }},
    {"doubled line",
     [](std::string& text, Random& random, std::string& how) {
       replace_one(text, lines(text), random, how, [](const std::string& was) { return was + "\n" + was; });
     }},
    {"moved line",
     [](std::string& text, Random& random, std::string& how) {
       const std::vector<Span> all = lines(text);
       const Span moved = random.of(all);
       const std::string line = text.substr(moved.begin, moved.end - moved.begin);
       replace_one(text, all, random, how, [&](const std::string& was) { return line + was; });
     }},
    {"doubled text", [](std::string& text, Random&, std::string&) { text += text; }},
    {"CR LF",
     [](std::string& text, Random&, std::string&) {
       for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2) text.insert(at, 1, '\r');
     }},
    {"CR", [](std::string& text, Random&, std::string&) { std::replace(text.begin(), text.end(), '\n', '\r'); }},
    {"byte order mark", [](std::string& text, Random&, std::string&) { text.insert(0, "\xEF\xBB\xBF"); }},
    {"UTF-16",
     [](std::string& text, Random&, std::string&) {
       std::string wide = "\xFF\xFE";
       for (const char c : text) wide += {c, '\0'};
       text = wide;
     }},
    {"empty", [](std::string& text, Random&, std::string&) { text.clear(); }},
    {"long name",
     [](std::string& text, Random& random, std::string& how) {
       replace_one(text, names(text), random, how, [&](const std::string& was) {
         return repeated(was, (random.below(2) == 0 ? 300 : 100'000) / was.size() + 1);
       });
     }},
    {"long number",
     [](std::string& text, Random& random, std::string& how) {
       replace_one(text, numbers(text), random, how, [&](const std::string&) { return "1" + repeated("0", 5000); });
     }},
    {"long line",
     [](std::string& text, Random& random, std::string&) {
       const std::string inserted = random.of(std::vector<std::string>{" ", "#", "x ", "1,"});
       text.insert(random.below(text.size()), repeated(inserted, 50'000));
     }},
    {"nested value",
     [](std::string& text, Random& random, std::string& how) {
       const std::size_t depth = random.of(std::vector<std::size_t>{5, 17, 300, 50'000});
       const bool lists = random.below(2) == 0;
       replace_one(text, values(text), random, how, [&](const std::string&) {
         return repeated(lists ? "[" : "{ a = ", depth) + "1" + repeated(lists ? "]" : " }", depth);
       });
     }},
    {"nested key",
     [](std::string& text, Random& random, std::string& how) {
       const std::size_t depth = random.of(std::vector<std::size_t>{2, 17, 40'000});
       replace_one(text, names(text), random, how, [&](const std::string& was) { return was + repeated(".a", depth); });
     }},
    {"nested table",
     [](std::string& text, Random& random, std::string&) {
       const std::size_t depth = random.of(std::vector<std::size_t>{3, 40'000});
       text += "\n[a" + repeated(random.below(2) == 0 ? ".a" : " . \"b\"", depth) + "]\nx = 1\n";
     }},
    {"many tables",
     [](std::string& text, Random& random, std::string&) {
       const std::vector<Span> all = names(text);
       const Span name = all.empty() ? Span{0, 0} : random.of(all);
       text += "\n" + repeated("[[" + text.substr(name.begin, name.end - name.begin) + "]]\n", 2000);
     }},
};

}  // namespace

const std::vector<std::string>& odd_numbers() {
  static const std::vector<std::string> all = {"nan",
                                               "-nan",
                                               "inf",
                                               "-inf",
                                               "+inf",
                                               "1e400",
                                               "-1e400",
                                               "1e308",
                                               "-1e308",
                                               "1e200",
                                               "-1e200",
                                               "1e51",
                                               "1e50",
                                               "-1e50",
                                               "1e30",
                                               "1e-30",
                                               "1e-320",
                                               "5e-324",
                                               "1e-50",
                                               "1e-51",
                                               "-0",
                                               "0",
                                               "-0.0",
                                               "-1",
                                               "9223372036854775807",
                                               "9223372036854775808",
                                               "-9223372036854775808",
                                               "99999999999999999999",
                                               "1e9",
                                               "2147483648",
                                               "0x10",
                                               "0x7fffffffffffffff",
                                               "1_000",
                                               "1__0",
                                               "1.",
                                               "01",
                                               ".5",
                                               "1e",
                                               "1e+",
                                               "--1",
                                               "+-1",
                                               "1,5",
                                               "\"1\"",
                                               "''",
                                               "true",
                                               "[1, 2]",
                                               "[]",
                                               "{}",
                                               "1979-05-27",
                                               "x",
                                               ""};
  return all;
}

std::string mutated(std::string text, Random& random, std::string& how) {
  // Mostly one change: of several the first hides the others.
  for (std::size_t left = random.below(4) == 0 ? 1 + random.below(4) : 1; left > 0 && !text.empty(); --left) {
    // The first three leave the file readable more often than others.
    const auto& [name, change] = changes[random.below(random.below(2) == 0 ? 3 : changes.size())];
    how += fmt::format("{}{} ", how.empty() ? "" : "; ", name);
    change(text, random, how);
  }
  return text;
}

std::string mutated_word(std::string word, Random& random) {
  const std::vector<Span> figures = numbers(word);
  switch (random.below(6)) {
    case 0:
      return random.of(odd_numbers());
    case 1:
      if (word.empty()) return "\xFF";
      return misspelt(word, random);
    case 2:
      return repeated(word.empty() ? "x" : word, 100'000 / std::max<std::size_t>(1, word.size()));
    case 3: {
      const std::string& odd = random.of(odd_bytes);
      return word.insert(random.below(word.size() + 1), odd.front() == '\0' ? "\x01" : odd);
    }
    default: {
      if (figures.empty()) return word + random.of(odd_numbers());
      const Span figure = random.of(figures);
      return word.replace(figure.begin, figure.end - figure.begin, random.of(odd_numbers()));
    }
  }
}

}  // namespace poise::app_tests
