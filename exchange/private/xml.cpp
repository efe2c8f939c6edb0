#include "exchange/private/xml.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "exchange/private/reading.hpp"
#include "model/one_line.hpp"

namespace poise {
namespace {

constexpr int deepest = 400;
constexpr int most_elements = 200'000;

/// Whether no element is deeper and no more are there than are taken.
bool is_moderate(pugi::xml_node root) {
  int depth = 0, elements = 0;
  for (pugi::xml_node node = root; node;) {
    if (++elements > most_elements || depth > deepest) return false;
    if (node.first_child()) {
      node = node.first_child();
      ++depth;
      continue;
    }
    while (node && node != root && !node.next_sibling()) {
      node = node.parent();
      --depth;
    }
    node = node == root ? pugi::xml_node() : node.next_sibling();
  }
  return true;
}

}  // namespace

Xml::Xml(std::string_view text, std::string file) : file_(std::move(file)) {
  line_begins_.push_back(0);
  for (std::size_t at = text.find('\n'); at != std::string_view::npos; at = text.find('\n', at + 1)) {
    line_begins_.push_back(at + 1);
  }
  const pugi::xml_parse_result parsed =
      document_.load_buffer(text.data(), text.size(), pugi::parse_default, pugi::encoding_utf8);
  if (!parsed) {
    const auto offset = static_cast<std::size_t>(std::max<std::ptrdiff_t>(parsed.offset, 0));
    const auto line = std::upper_bound(line_begins_.begin(), line_begins_.end(), offset) - line_begins_.begin();
    fail_at(file_, static_cast<int>(line), "", fmt::format("expected XML: {}", parsed.description()));
  }
  if (!is_moderate(document_)) {
    fail_at(file_, 0, "", fmt::format("expected at most {} elements, {} inside each other", most_elements, deepest));
  }
}

pugi::xml_node Xml::root(const std::string& name) const {
  const pugi::xml_node root = document_.document_element();
  if (root.name() != name) {
    fail_at(file_, root ? line_of(root) : 1, "",
            fmt::format("expected the element <{}>, found <{}>", name, one_line(root.name())));
  }
  return root;
}

int Xml::line_of(pugi::xml_node node) const {
  const auto offset = static_cast<std::size_t>(std::max<std::ptrdiff_t>(node.offset_debug(), 0));
  return static_cast<int>(std::upper_bound(line_begins_.begin(), line_begins_.end(), offset) - line_begins_.begin());
}

void Xml::fail(pugi::xml_node node, const std::string& item, const std::string& message) const {
  fail_at(file_, line_of(node), item, message);
}

double Xml::number(pugi::xml_node node, const char* attribute, const std::string& item, double otherwise) const {
  const pugi::xml_attribute found = node.attribute(attribute);
  return found ? number_at(found.value(), file_, line_of(node), item + "." + attribute) : otherwise;
}

double Xml::number(pugi::xml_node node, const char* attribute, const std::string& item) const {
  if (!node.attribute(attribute)) fail(node, item, fmt::format("expected the attribute {}, found none", attribute));
  return number(node, attribute, item, 0.0);
}

std::string Xml::word(pugi::xml_node node, const char* attribute, const std::string& item) const {
  const std::string_view found = trimmed(node.attribute(attribute).value());
  if (found.empty()) fail(node, item, fmt::format("expected the attribute {}, found none", attribute));
  return one_line(found);
}

std::vector<double> Xml::numbers(pugi::xml_node node, const char* attribute, const std::string& item, std::size_t count,
                                 std::vector<double> otherwise) const {
  return node.attribute(attribute) ? numbers_up_to(node, attribute, item, count, count) : std::move(otherwise);
}

std::vector<double> Xml::numbers_up_to(pugi::xml_node node, const char* attribute, const std::string& item,
                                       std::size_t least, std::size_t most) const {
  const pugi::xml_attribute found = node.attribute(attribute);
  std::vector<double> out;
  if (!found) return out;
  std::string_view rest = trimmed(found.value());
  while (!rest.empty() && out.size() <= most) {
    const std::size_t end = rest.find_first_of(" \t\r\n");
    out.push_back(number_at(rest.substr(0, end), file_, line_of(node), item + "." + attribute));
    rest = end == std::string_view::npos ? std::string_view() : trimmed(rest.substr(end));
  }
  if (out.size() < least || out.size() > most) {
    const std::string count = least == most ? fmt::to_string(least) : fmt::format("{} to {}", least, most);
    fail(node, item + "." + attribute,
         fmt::format("expected {} numbers, found \"{}\"", count, one_line(found.value())));
  }
  return out;
}

std::string xml_value(std::string_view text) {
  std::string out;
  for (const char letter : text) {
    switch (letter) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += letter;
    }
  }
  return out;
}

}  // namespace poise
