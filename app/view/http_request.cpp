#include "app/view/http_request.hpp"

#include <algorithm>
#include <charconv>
#include <utility>

namespace poise::app {
namespace {

constexpr std::string_view line_end = "\r\n";

bool is_token(std::string_view text) {
  constexpr std::string_view signs = "!#$%&'*+-.^_`|~";
  return !text.empty() && std::all_of(text.begin(), text.end(), [&](char c) {
    return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || signs.find(c) != signs.npos;
  });
}

bool is_printable(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return c == '\t' || (c >= ' ' && c <= '~'); });
}

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return out;
}

std::string_view without_blanks(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

HttpHead refuse(int status, const char* why) {
  HttpHead out;
  out.refused = status;
  out.why = why;
  return out;
}

/// METHOD /PATH?QUERY HTTP/1.x
bool read_request_line(std::string_view line, HttpRequest& request, std::string_view& version) {
  const std::size_t first = line.find(' '), last = line.rfind(' ');
  if (first == std::string_view::npos || first == last) return false;
  const std::string_view target = line.substr(first + 1, last - first - 1);
  request.method = line.substr(0, first);
  version = line.substr(last + 1);
  if (!is_token(request.method) || target.empty() || target.front() != '/') return false;
  if (!is_printable(target) || target.find_first_of(" \t") != std::string_view::npos) return false;
  const std::size_t mark = target.find('?');
  request.path = target.substr(0, mark);
  if (mark != std::string_view::npos) request.query = target.substr(mark + 1);
  return true;
}

}  // namespace

std::string HttpRequest::header(const std::string& name) const {
  const auto found = headers.find(name);
  return found == headers.end() ? "" : found->second;
}

HttpHead read_head(std::string_view bytes) {
  const std::size_t end = bytes.substr(0, HttpRequest::largest_head).find("\r\n\r\n");
  if (end == std::string_view::npos) {
    return bytes.size() < HttpRequest::largest_head ? HttpHead{} : refuse(431, "the head of the request is too long\n");
  }
  HttpHead out;
  out.length = end + 2 * line_end.size();
  HttpRequest& request = out.request;
  std::string_view lines = bytes.substr(0, end + line_end.size()), version;
  const auto next_line = [&] {
    const std::size_t length = lines.find(line_end);
    const std::string_view line = lines.substr(0, length);
    lines.remove_prefix(length + line_end.size());
    return line;
  };
  if (!read_request_line(next_line(), request, version)) return refuse(400, "not a request\n");
  if (version != "HTTP/1.1" && version != "HTTP/1.0") return refuse(505, "expected HTTP/1.1\n");
  while (!lines.empty()) {
    const std::string_view line = next_line();
    const std::size_t colon = line.find(':');
    const std::string_view name = line.substr(0, colon);
    if (colon == std::string_view::npos || !is_token(name)) return refuse(400, "not a header\n");
    const std::string_view value = without_blanks(line.substr(colon + 1));
    if (!request.headers.emplace(lower(name), value).second) {
      return refuse(400, "a header is given twice\n");
    }
  }
  if (request.headers.contains("transfer-encoding")) return refuse(411, "expected Content-Length\n");
  if (request.headers.contains("content-length")) {
    const std::string length = request.header("content-length");
    const char* const last = length.data() + length.size();
    const auto [read_to, error] = std::from_chars(length.data(), last, request.body_length);
    if (error == std::errc::result_out_of_range) return refuse(413, "more than 1 MB\n");
    if (error != std::errc() || read_to != last) return refuse(400, "not a length\n");
    if (request.body_length > HttpRequest::largest_body) return refuse(413, "more than 1 MB\n");
  } else if (request.method == "POST") {
    return refuse(411, "expected Content-Length\n");
  }
  const std::string connection = lower(request.header("connection"));
  request.keeps_connection = version == "HTTP/1.1" ? connection != "close" : connection == "keep-alive";
  return out;
}

}  // namespace poise::app
