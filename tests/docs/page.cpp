#include "tests/docs/page.hpp"

#include <algorithm>
#include <cctype>
#include <regex>
#include <stdexcept>

#include "tests/app/run_poise.hpp"

namespace poise::docs_tests {
namespace {

std::vector<std::string> all_matches(const std::string& text, const std::regex& pattern) {
  std::vector<std::string> out;
  for (std::sregex_iterator it(text.begin(), text.end(), pattern); it != std::sregex_iterator(); ++it) {
    out.push_back((*it)[1].str());
  }
  return out;
}

/// "Where it is: `poise solve`" -> "where-it-is-poise-solve".
std::string anchor_of(const std::string& heading) {
  std::string out;
  for (const char c : heading) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) != 0 || c == '-' || c == '_') out += static_cast<char>(std::tolower(byte));
    if (c == ' ') out += '-';
  }
  return out;
}

void read_mark(const std::string& line, Block& next) {
  static const std::regex pattern(R"(^<!-- ([a-z ]+)(: (.*))? -->$)");
  std::smatch match;
  if (std::regex_match(line, match, pattern)) next.marks.emplace_back(match[1].str(), match[3].str());
}

void read_prose(const std::string& line, std::string& prose, Page& page) {
  if (line.starts_with('#')) page.anchors.push_back(anchor_of(line.substr(line.find_first_not_of("# "))));
  prose += line + '\n';
}

}  // namespace

std::string Block::text() const { return join_lines(lines); }

bool Block::has(std::string_view key) const {
  return std::any_of(marks.begin(), marks.end(), [&](const auto& mark) { return mark.first == key; });
}

std::string Block::mark(std::string_view key) const {
  const auto found = std::find_if(marks.begin(), marks.end(), [&](const auto& mark) { return mark.first == key; });
  return found == marks.end() ? "" : found->second;
}

std::vector<std::string> split_lines(std::string_view text) {
  std::vector<std::string> out;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    out.emplace_back(text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
  return out;
}

std::string join_lines(const std::vector<std::string>& lines) {
  std::string out;
  for (const std::string& line : lines) out += line + '\n';
  return out;
}

Page read_page(const std::filesystem::path& file) {
  Page page{file, split_lines(app_tests::contents(file)), {}, {}, {}, {}};
  Block next;
  bool inside = false;
  std::string prose;
  for (std::size_t i = 0; i < page.lines.size(); ++i) {
    const std::string& line = page.lines[i];
    if (line.starts_with("```")) {
      if (inside) {
        page.blocks.push_back(next);
        next = {};
      } else {
        next.kind = line.substr(3);
        next.line = i + 1;
      }
      inside = !inside;
    } else if (inside) {
      next.lines.push_back(line);
    } else {
      if (line.starts_with("<!-- ")) {
        read_mark(line, next);
      } else if (!line.empty()) {
        next.marks.clear();
      }
      read_prose(line, prose, page);
    }
  }
  if (inside) throw std::runtime_error(file.string() + ": a fence is not closed");
  page.inline_code = all_matches(prose, std::regex("`([^`]+)`"));
  page.links = all_matches(prose, std::regex(R"(\]\(([^)\s]+)\))"));
  return page;
}

std::vector<Command> commands_of(const Block& block) {
  std::vector<Command> out;
  for (std::size_t i = 0; i < block.lines.size(); ++i) {
    const std::string& line = block.lines[i];
    const bool continues = !out.empty() && line.starts_with("> ");
    if (continues || line.starts_with("$ ")) {
      if (!continues) out.emplace_back();
      Command& command = out.back();
      command.text += (continues ? "\n" : "") + line.substr(2);
      command.output_line = i + 1;
    } else {
      if (out.empty()) throw std::runtime_error("a console block begins with \"$ COMMAND\", found: " + line);
      out.back().output.push_back(line);
    }
  }
  return out;
}

}  // namespace poise::docs_tests
