#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>

namespace poise::app {

/// A request of HTTP/1.0 or 1.1 (RFC 9112), as far as a page of one program needs it: a body has its length in
/// Content-Length; chunks are refused, because their sum is known only after they have come.
struct HttpRequest {
  static constexpr std::size_t largest_head = 1 << 14U;  ///< bytes of its lines before the body
  static constexpr std::size_t largest_body = 1 << 20U;

  std::string method, path, query;             ///< as they are written; the query without its "?"
  std::map<std::string, std::string> headers;  ///< names in lower case, values without blanks around them
  std::size_t body_length = 0;
  bool keeps_connection = true;

  /// Empty where the request does not have it.
  std::string header(const std::string& name) const;
};

/// The head of the request that bytes begin with.
struct HttpHead {
  HttpRequest request;
  std::size_t length = 0;  ///< bytes of the head with its empty line; 0: it has not come to its end
  int refused = 0;         ///< status of an answer that refuses it: 400, 411, 413, 431, 505; 0 where it is in order
  const char* why = "";    ///< of the refusal
};

HttpHead read_head(std::string_view bytes);

}  // namespace poise::app
