#pragma once

// A page of the documentation as the test of the documentation reads it: fenced blocks, inline code, links, headings.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace poise::docs_tests {

/// A fenced block. Comments `<!-- key: value -->` (or `<!-- key -->`) on the lines above it say how it is tested.
struct Block {
  std::string kind;  ///< the word after the fence
  std::vector<std::string> lines;
  std::size_t line = 0;  ///< of its first line in the page, from 0
  std::vector<std::pair<std::string, std::string>> marks;

  std::string text() const;
  bool has(std::string_view mark) const;
  /// Empty where the mark is missing.
  std::string mark(std::string_view key) const;
};

/// A command of a console block, "$ poise solve ...", and the output that the page shows.
struct Command {
  std::string text;  ///< without "$ "; continued on lines "> ..."
  std::vector<std::string> output;
  std::size_t output_line = 0;  ///< place of the output in the block
};

struct Page {
  std::filesystem::path file;
  std::vector<std::string> lines;
  std::vector<Block> blocks;
  std::vector<std::string> inline_code;
  std::vector<std::string> links;    ///< targets of [text](target)
  std::vector<std::string> anchors;  ///< of headings, as GitHub forms them
};

/// Throws std::runtime_error where a fence is not closed.
Page read_page(const std::filesystem::path& file);

std::vector<Command> commands_of(const Block& block);

std::vector<std::string> split_lines(std::string_view text);
std::string join_lines(const std::vector<std::string>& lines);

}  // namespace poise::docs_tests
