#include "app/terminal/palette.hpp"

#include <cstdlib>
#include <string_view>

#include <unistd.h>

#include "app/terminal/mpi_ranks.hpp"

namespace poise::app {

namespace {

/// Whether the environment names UTF-8, by the first of these variables that says anything.
bool is_utf8() {
  for (const char* name : {"LC_ALL", "LC_CTYPE", "LANG"}) {
    const char* value = std::getenv(name);
    if (value == nullptr || *value == '\0') continue;
    const std::string_view locale = value;
    for (const char* ending : {"UTF-8", "utf-8", "UTF8", "utf8"}) {
      if (locale.find(ending) != std::string_view::npos) return true;
    }
    return false;
  }
  return false;
}

}  // namespace

Palette Palette::with_signs() {
  Palette palette;
  palette.true_signs_ = true;
  return palette;
}

Palette Palette::for_stream(std::FILE* stream) {
  const char* no_colour = std::getenv("NO_COLOR");
  const char* terminal = std::getenv("TERM");
  Palette palette;
  const bool is_terminal = isatty(fileno(stream)) == 1;
  palette.true_signs_ = is_terminal && is_utf8();
  palette.coloured_ = is_terminal && (no_colour == nullptr || *no_colour == '\0') && terminal != nullptr &&
                      std::string_view(terminal) != "dumb" && !started_by_mpirun();
  return palette;
}

std::string Palette::paint(Tone tone, const std::string& text) const {
  if (!coloured_ || text.empty()) return text;
  const char* code = "";
  switch (tone) {
    case Tone::plain:
      return text;
    case Tone::strong:
      code = "1";
      break;
    case Tone::good:
      code = "32";
      break;
    case Tone::bad:
      code = "31";
      break;
    case Tone::doubtful:
      code = "33";
      break;
    case Tone::faint:
      code = "2";
      break;
  }
  return std::string("\x1b[") + code + "m" + text + "\x1b[0m";
}

}  // namespace poise::app
