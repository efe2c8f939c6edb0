#include "app/present/markdown.hpp"

#include <fmt/format.h>

#include "app/result/cells.hpp"
#include "app/result/numbers.hpp"
#include "model/one_line.hpp"

namespace poise::app {
namespace {

/// On one line, with what Markdown's tables read as their own escaped, without the blanks that align columns.
std::string cell_text(const std::string& text) {
  std::string out;
  for (const char c : one_line(text)) {
    if (c == '|') out += '\\';
    out += c;
  }
  const std::size_t first = out.find_first_not_of(' ');
  return first == std::string::npos ? "" : out.substr(first, out.find_last_not_of(' ') + 1 - first);
}

std::string row(const std::vector<std::string>& cells) { return fmt::format("| {} |\n", fmt::join(cells, " | ")); }

class MarkdownWriter {
 public:
  explicit MarkdownWriter(Verbosity level) : level_(level) {}

  std::string text;

  void paragraph(const std::string& words) { block(words + "\n", Block::other); }

  void items(const Group& group, int depth) {
    for (const Item& item : group.items()) {
      if (!is_shown(item, level_)) continue;
      if (!item.title.empty()) paragraph(std::string(static_cast<std::size_t>(depth), '#') + " " + item.title);
      std::visit([&](const auto& content) { write(content, item.title.empty() ? depth : depth + 1); }, item.content);
    }
  }

 private:
  enum class Block { points, other };

  // No empty line between the points of one list.
  void block(const std::string& words, Block kind) {
    if (!text.empty() && !(kind == Block::points && last_ == Block::points)) text += "\n";
    text += words;
    last_ = kind;
  }
  void point(const std::string& words) { block("- " + one_line(words) + "\n", Block::points); }

  void write(const Line& line, int) {
    if (line.label.empty())
      paragraph(line.text);
    else
      point(line.label + ": " + line.text);
  }
  void write(const Entry& entry, int) { point(entry.label + ": " + text_of(entry)); }
  void write(const Listing& list, int) {
    for (const std::string& item : list.items) point(item);
  }
  void write(const Branch& branch, int depth) {
    for (const Group& part : branch.parts) items(part, depth);
  }
  void write(const Table& table, int) {
    const std::vector<TextColumn> columns = text_columns(table);
    std::vector<std::string> titles, lines;
    for (const TextColumn& column : columns) {
      titles.push_back(cell_text(column.heading()));
      lines.emplace_back(column.column->is_words() ? "---" : "---:");
    }
    std::string out = row(titles) + row(lines);
    for (std::size_t r = 0; r < table.size(); ++r) {
      std::vector<std::string> cells;
      for (const TextColumn& column : columns) {
        const std::vector<Tone>& tones = column.column->tones;
        const std::string cell = cell_text(column.cells[r]);
        const bool strong = !tones.empty() && tones[r] == Tone::strong && !cell.empty();
        cells.push_back(strong ? "**" + cell + "**" : cell);
      }
      out += row(cells);
    }
    block(out, Block::other);
    for (const std::string& note : table.footnotes) paragraph(note);
  }

  Verbosity level_;
  Block last_ = Block::other;
};

}  // namespace

std::string markdown_text(const Result& result, Verbosity level) {
  MarkdownWriter writer(level);
  if (!result.title.empty()) writer.paragraph("# " + one_line(result.title));
  if (!result.source.empty()) writer.paragraph("Source: " + one_line(result.source));
  if (!result.verdict.text.empty()) writer.paragraph(result.verdict.text);
  for (const Line& warning : result.warnings) writer.paragraph(warning.text);
  writer.items(result.content, 2);
  return std::move(writer.text);
}

}  // namespace poise::app
