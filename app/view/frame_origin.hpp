#pragma once

#include <string>

namespace poise::app {

/// The origin of a page that may show ours in a frame, as browsers write it: "http://localhost:8888", in lower case,
/// without a port that its scheme implies. `text` is a scheme (http or https), a host (a name or an IPv4 address) and,
/// where it has one, a port, and nothing else: it becomes part of a header. IPv6 addresses are refused, because
/// frame-ancestors has no form for them (Content Security Policy Level 3, 2.3.1). Throws InputError naming
/// --frame-origin.
std::string read_frame_origin(const std::string& text);

}  // namespace poise::app
