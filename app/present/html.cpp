#include "app/present/html.hpp"

#include <cstddef>
#include <map>
#include <new>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>
#include <zlib.h>

#include "app/draw/canvas.hpp"
#include "app/present/page_parts.hpp"

namespace poise::app {
namespace {

using nlohmann::json;

std::string joined(const std::vector<std::string_view>& pieces) {
  std::string out;
  for (const std::string_view piece : pieces) out += piece;
  return out;
}

/// In base64, of which nothing can end the element that holds it.
std::string in_letters(const std::vector<unsigned char>& bytes) {
  constexpr std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned group = 0;  // of 24 bits
    for (std::size_t k = i; k < i + 3; ++k) group = (group << 8U) | (k < bytes.size() ? bytes[k] : 0U);
    for (std::size_t k = 0; k < 4; ++k) out += i + k > bytes.size() ? '=' : letters[(group >> (18 - 6 * k)) & 63U];
  }
  return out;
}

/// The document in the format of zlib: numbers and names repeat, and browsers read it without a library.
std::string embedded(const json& document) {
  const std::string text = document.dump(-1, ' ', false, json::error_handler_t::replace);
  uLongf size = compressBound(text.size());
  std::vector<unsigned char> packed(size);
  const auto* const bytes = reinterpret_cast<const unsigned char*>(text.data());
  if (compress2(packed.data(), &size, bytes, text.size(), Z_BEST_COMPRESSION) != Z_OK) throw std::bad_alloc();
  packed.resize(size);
  return in_letters(packed);
}

std::string title_of(const json& document) {
  const std::string title = document.at("title");
  return escape_xml(title.empty() ? "poise " + document.at("command").get<std::string>() : title);
}

/// The template with its {{names}} replaced, all at once: braces in a part are text.
std::string filled(const std::string& skeleton, const std::map<std::string, std::string>& parts) {
  std::string out;
  std::size_t from = 0;
  while (true) {
    const std::size_t open = skeleton.find("{{", from);
    const std::size_t close = skeleton.find("}}", open);
    if (open == std::string::npos || close == std::string::npos) return out.append(skeleton, from);
    out.append(skeleton, from, open - from).append(parts.at(skeleton.substr(open + 2, close - open - 2)));
    from = close + 2;
  }
}

}  // namespace

std::string html_page(const json& document) {
  const PageParts page = page_parts();
  const bool is_live = document.at("command") == "view";
  return filled(joined(page.skeleton), {{"styles", joined(page.styles)},
                                        {"libraries", joined(page.libraries)},
                                        {"scripts", joined(is_live ? page.live_scripts : page.scripts)},
                                        {"document", embedded(document)},
                                        {"title", title_of(document)}});
}

}  // namespace poise::app
