#include "app/present/html.hpp"

#include <cstddef>
#include <map>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

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

/// JSON that stays within its script element: "</" would end it, and after "<!--" the parser of HTML would overlook its
/// end. Both can only stand in strings, where the escapes mean the same.
std::string embedded(const json& document) {
  const std::string text = document.dump(-1, ' ', false, json::error_handler_t::replace);
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    const std::string_view rest = std::string_view(text).substr(i);
    if (rest.starts_with("<!--")) {
      out += "\\u003c";
    } else {
      out += text[i];
      if (rest.starts_with("</")) out += '\\';
    }
  }
  return out;
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
  return filled(joined(page.skeleton), {{"styles", joined(page.styles)},
                                        {"libraries", joined(page.libraries)},
                                        {"scripts", joined(page.scripts)},
                                        {"document", embedded(document)},
                                        {"title", title_of(document)}});
}

}  // namespace poise::app
