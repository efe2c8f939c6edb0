#include "app/view/frame_origin.hpp"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "model/input_error.hpp"
#include "model/one_line.hpp"

namespace poise::app {
namespace {

constexpr std::size_t longest_host = 253;  // RFC 1035, 2.3.4
constexpr std::size_t longest_label = 63;

bool is_letter_or_digit(char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'); }

/// Labels of a name or numbers of an address, with dots between them.
bool is_host(std::string_view text) {
  if (text.empty() || text.size() > longest_host) return false;
  for (;;) {
    const std::string_view label = text.substr(0, text.find('.'));
    if (label.empty() || label.size() > longest_label || label.front() == '-' || label.back() == '-') return false;
    if (!std::all_of(label.begin(), label.end(), [](char c) { return is_letter_or_digit(c) || c == '-'; }))
      return false;
    if (label.size() == text.size()) return true;
    text.remove_prefix(label.size() + 1);
  }
}

std::optional<int> port_in(std::string_view text) {
  int port = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
  const bool is_port = error == std::errc() && end == text.data() + text.size() && port >= 1 && port <= 65535;
  return is_port && text.front() != '0' ? std::optional(port) : std::nullopt;
}

std::optional<std::string> origin_in(std::string_view text, std::string_view scheme, int implied_port) {
  if (!text.starts_with(scheme)) return std::nullopt;
  const std::string_view authority = text.substr(scheme.size());
  const std::size_t colon = authority.find(':');
  const std::string_view host = authority.substr(0, colon);
  if (!is_host(host)) return std::nullopt;
  if (colon == std::string_view::npos) return std::string(text);
  const std::optional<int> port = port_in(authority.substr(colon + 1));
  if (!port) return std::nullopt;
  return *port == implied_port ? fmt::format("{}{}", scheme, host) : fmt::format("{}{}:{}", scheme, host, *port);
}

}  // namespace

std::string read_frame_origin(const std::string& text) {
  constexpr int http_port = 80, https_port = 443;
  std::string lower = text;
  for (char& c : lower) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  if (const auto origin = origin_in(lower, "http://", http_port)) return *origin;
  if (const auto origin = origin_in(lower, "https://", https_port)) return *origin;
  throw InputError(
      fmt::format("--frame-origin: expected the scheme, host and port of one page, \"http://localhost:8888\", say, "
                  "without a path, found \"{}\"",
                  one_line(text.substr(0, longest_host))));
}

}  // namespace poise::app
