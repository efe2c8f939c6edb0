#include "app/terminal/palette.hpp"

#include <cstdlib>
#include <string_view>

#include <unistd.h>

#include "app/terminal/mpi_ranks.hpp"

namespace poise::app {

Palette Palette::for_stream(std::FILE* stream) {
  const char* no_colour = std::getenv("NO_COLOR");
  const char* terminal = std::getenv("TERM");
  Palette palette;
  palette.coloured_ = isatty(fileno(stream)) == 1 && (no_colour == nullptr || *no_colour == '\0') &&
                      terminal != nullptr && std::string_view(terminal) != "dumb" && !started_by_mpirun();
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
