#include "tests/support/page_document.hpp"

#include <stdexcept>
#include <string_view>

#include <zlib.h>

namespace poise::page_tests {
namespace {

std::string bytes_of(std::string_view letters) {
  constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  unsigned held = 0, bits = 0;
  for (const char letter : letters) {
    if (letter == '=') break;
    const std::size_t digit = alphabet.find(letter);
    if (digit == std::string_view::npos) throw std::runtime_error("the document of the page is no base64");
    held = (held << 6U) | static_cast<unsigned>(digit);
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    out += static_cast<char>((held >> bits) & 0xffU);
  }
  return out;
}

}  // namespace

std::string document_in(const std::string& page) {
  const std::string begin = R"(<script type="text/plain" id="document">)";
  const std::size_t at = page.find(begin), from = at + begin.size();
  const std::size_t to = page.find("</script", from);
  if (at == std::string::npos || to == std::string::npos) throw std::runtime_error("the page has no document");
  const std::string packed = bytes_of(std::string_view(page).substr(from, to - from));
  std::string out(64 * packed.size() + 1024, '\0');
  while (true) {
    uLongf size = out.size();
    const int outcome = uncompress(reinterpret_cast<Bytef*>(out.data()), &size,
                                   reinterpret_cast<const Bytef*>(packed.data()), packed.size());
    if (outcome == Z_OK) return out.substr(0, size);
    if (outcome != Z_BUF_ERROR || out.size() > 1100 * packed.size()) {
      throw std::runtime_error("the document of the page cannot be unpacked");
    }
    out.resize(2 * out.size());
  }
}

}  // namespace poise::page_tests
