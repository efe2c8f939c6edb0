#include "app/present/text.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "app/present/signs.hpp"
#include "app/result/cells.hpp"
#include "app/result/numbers.hpp"
#include "model/one_line.hpp"

namespace poise::app {
namespace {

constexpr std::size_t widest_table = 120;  // columns of a terminal

class TextWriter {
 public:
  TextWriter(const Palette& palette, Verbosity level) : palette_(palette), level_(level) {}

  std::string text;

  void line(const std::string& words, Tone tone) { text += palette_.paint(tone, signed_text(words)) + "\n"; }

  void items(const Group& group) {
    for (const Item& item : group.items()) {
      if (!is_shown(item, level_)) continue;
      if (!item.title.empty()) text += "\n" + palette_.paint(Tone::strong, item.title) + "\n";
      std::visit([this](const auto& content) { write(content); }, item.content);
    }
  }

 private:
  std::string signed_text(const std::string& words) const {
    return palette_.has_true_signs() ? with_true_signs(words) : words;
  }

  void fact(const std::string& label, const std::string& words) {
    text += "  " + palette_.paint(Tone::faint, fmt::format("{:<12} ", label)) + words + "\n";
  }

  void write(const Line& content) {
    const std::string words = palette_.paint(content.tone, signed_text(content.text));
    if (content.label.empty())
      text += words + "\n";
    else
      fact(content.label, words);
  }
  void write(const Entry& content) { fact(content.label, signed_text(text_of(content))); }
  void write(const Listing& content) {
    const std::size_t all = content.items.size();
    const std::size_t shown = all <= most_rows + 1 || level_ == Verbosity::verbose ? all : most_rows;
    for (std::size_t i = 0; i < shown; ++i) text += "  " + signed_text(content.items[i]) + "\n";
    more(all - shown);
  }
  void write(const Branch& content) {
    for (const Group& part : content.parts) items(part);
  }
  void write(const Table& table) {
    std::vector<TextColumn> columns = text_columns(table);
    const std::vector<std::size_t> rows = shown_rows(table);
    std::size_t used = 0;  // of the line
    bool is_continued = false;
    std::vector<TextColumn> block;
    std::vector<std::size_t> widths;
    for (TextColumn& column : columns) {
      column.title = signed_text(column.title);
      for (std::string& cell : column.cells) cell = signed_text(cell);
      std::size_t width = screen_width(column.heading());
      for (const std::size_t r : rows) width = std::max(width, screen_width(column.cells[r]));
      // What does not fit goes on below, beside the first column again.
      if (block.size() > 1 && used + 2 + width > widest_table) {
        write_block(block, widths, is_continued ? told_rows(block, rows) : rows);
        is_continued = true;
        text += "\n";
        block.resize(1);
        widths.resize(1);
        used = 2 + widths.front();
      }
      block.push_back(column);
      widths.push_back(width);
      used += 2 + width;
    }
    write_block(block, widths, is_continued ? told_rows(block, rows) : rows);
    if (table.shown == Table::Shown::first) more(table.size() - rows.size());
    for (const std::string& note : table.footnotes) line("  " + note, Tone::faint);
  }

  /// The rows of a block that say something beside their first column.
  static std::vector<std::size_t> told_rows(const std::vector<TextColumn>& block,
                                            const std::vector<std::size_t>& rows) {
    std::vector<std::size_t> out;
    for (const std::size_t r : rows) {
      const bool says = std::any_of(block.begin() + 1, block.end(),
                                    [&](const TextColumn& column) { return !column.cells[r].empty(); });
      if (says) out.push_back(r);
    }
    return out;
  }

  void write_block(const std::vector<TextColumn>& columns, const std::vector<std::size_t>& widths,
                   const std::vector<std::size_t>& rows) {
    row(columns, widths, [](const TextColumn& column) { return Piece{column.heading(), Tone::faint}; });
    for (const std::size_t r : rows) {
      row(columns, widths, [r](const TextColumn& column) {
        const std::vector<Tone>& tones = column.column->tones;
        return Piece{column.cells[r], tones.empty() ? Tone::plain : tones[r]};
      });
    }
  }

  struct Piece {
    std::string text;
    Tone tone;
  };

  void row(const std::vector<TextColumn>& columns, const std::vector<std::size_t>& widths, auto piece_of) {
    std::string out;
    std::size_t owed = 2;  // blanks before the next text, so that no line ends in blanks
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const auto [cell, tone] = piece_of(columns[c]);
      const bool to_the_left = columns[c].column->is_words();
      const std::size_t fill = widths[c] - screen_width(cell);
      const std::size_t end = cell.find_last_not_of(' ') + 1;
      if (!to_the_left) owed += fill;
      if (end > 0) out += std::string(owed, ' ') + palette_.paint(tone, cell.substr(0, end));
      owed = (end > 0 ? 0 : owed) + cell.size() - end + (to_the_left ? fill : 0) + 2;
    }
    text += out + "\n";
  }

  void more(std::size_t rows) {
    if (rows > 0) line(fmt::format("  ... and {} more", rows), Tone::faint);
  }

  const Palette& palette_;
  Verbosity level_;
};

}  // namespace

std::string plain_text(const Result& result, const Palette& palette, Verbosity level) {
  TextWriter writer(palette, level);
  if (level > Verbosity::quiet && !result.title.empty()) {
    writer.line(one_line(result.title), Tone::strong);
    if (!result.source.empty()) writer.line("source: " + one_line(result.source), Tone::faint);
    writer.text += "\n";
  }
  if (!result.verdict.text.empty()) writer.line(result.verdict.text, result.verdict.tone);
  for (const Line& warning : result.warnings) writer.line(warning.text, warning.tone);
  writer.items(result.content);
  return std::move(writer.text);
}

}  // namespace poise::app
