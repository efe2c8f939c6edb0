#include "app/view/server.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <list>
#include <stdexcept>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <spawn.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "app/view/frame_origin.hpp"
#include "app/view/http_request.hpp"
#include "model/input_error.hpp"

extern char** environ;  // NOLINT(readability-identifier-naming): of POSIX

namespace poise::app {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* host = "127.0.0.1";

std::string random_token() {
  std::array<std::uint8_t, 16> bytes{};
  for (std::size_t have = 0; have < bytes.size();) {
    const ssize_t got = ::getrandom(bytes.data() + have, bytes.size() - have, 0);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw std::runtime_error("the system gives no random numbers for the address");
    have += static_cast<std::size_t>(got);
  }
  std::string out;
  for (const std::uint8_t byte : bytes) out += fmt::format("{:02x}", byte);
  return out;
}

/// In a time that does not depend on where they differ.
bool same_text(const std::string& a, const std::string& b) {
  if (a.size() != b.size()) return false;
  unsigned differing = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    differing |= static_cast<unsigned>(static_cast<unsigned char>(a[i])) ^ static_cast<unsigned char>(b[i]);
  }
  return differing == 0;
}

/// Allows `rate` in each second, and as many at once.
class Limiter {
 public:
  explicit Limiter(double rate) : rate_(rate), left_(rate) {}

  bool allow() {
    const auto now = Clock::now();
    left_ = std::min(rate_, left_ + rate_ * std::chrono::duration<double>(now - last_).count());
    last_ = now;
    if (left_ < 1.0) return false;
    left_ -= 1.0;
    return true;
  }

 private:
  double rate_, left_;
  Clock::time_point last_ = Clock::now();
};

constexpr const char* html_type = "text/html; charset=utf-8";
constexpr const char* json_type = "application/json; charset=utf-8";
constexpr const char* plain_type = "text/plain; charset=utf-8";

const char* reason(int status) {
  switch (status) {
    case 200:
      return "OK";
    case 400:
      return "Bad Request";
    case 403:
      return "Forbidden";
    case 404:
      return "Not Found";
    case 411:
      return "Length Required";
    case 413:
      return "Content Too Large";
    case 429:
      return "Too Many Requests";
    case 431:
      return "Request Header Fields Too Large";
    case 505:
      return "HTTP Version Not Supported";
    default:
      return "Internal Server Error";
  }
}

constexpr const char* no_frame = "X-Frame-Options: DENY\r\n";

struct Response {
  int status = 200;
  const char* type = plain_type;
  std::string content{}, more_headers{};
  std::string framing = no_frame;  // header: who may show it in a frame
};

std::string written(const Response& response, bool keeps_connection) {
  return fmt::format(
      "HTTP/1.1 {} {}\r\nContent-Type: {}\r\nContent-Length: {}\r\nConnection: {}\r\nCache-Control: no-store\r\n"
      "X-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\n{}"
      "Cross-Origin-Opener-Policy: same-origin\r\nCross-Origin-Resource-Policy: same-origin\r\n{}\r\n{}",
      response.status, reason(response.status), response.type, response.content.size(),
      keeps_connection ? "keep-alive" : "close", response.framing, response.more_headers, response.content);
}

/// A file descriptor that is closed with it.
class Socket {
 public:
  explicit Socket(int number) : number_(number) {}
  ~Socket() {
    if (number_ >= 0) ::close(number_);
  }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  int number() const { return number_; }

 private:
  int number_;
};

/// A socket that listens on a port of this machine, 0 for any; negative where there is none. The port can be had again
/// at once, but not by two programs, of which one could take what is meant for the other. Throws InputError for a
/// number that no port has.
int listening(int port) {
  constexpr int last_port = 65535;
  if (port < 0 || port > last_port) {
    throw InputError(fmt::format("--port: expected a number from 0 to {}, found {}", last_port, port));
  }
  const int number = ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (number < 0) return -1;
  const int yes = 1;
  ::setsockopt(number, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::bind(number, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 &&  // NOLINT
      ::listen(number, SOMAXCONN) == 0) {
    return number;
  }
  ::close(number);
  return -1;
}

int port_of(int number) {
  sockaddr_in address{};
  socklen_t length = sizeof address;
  if (::getsockname(number, reinterpret_cast<sockaddr*>(&address), &length) != 0) return -1;  // NOLINT
  return ntohs(address.sin_port);
}

struct Connection {
  explicit Connection(int number) : socket(number) {}

  /// Takes in what has come, without waiting. False where the other side has ended.
  bool receive() {
    std::array<char, 1 << 16U> part{};
    const ssize_t got = ::recv(socket.number(), part.data(), part.size(), 0);
    if (got < 0) return errno == EAGAIN || errno == EINTR;
    in.append(part.data(), static_cast<std::size_t>(got));
    return got > 0;
  }

  /// Hands on what can be taken, without waiting. False where the other side has ended.
  bool send() {
    if (out.empty()) return true;
    const ssize_t sent = ::send(socket.number(), out.data() + sent_bytes, out.size() - sent_bytes, MSG_NOSIGNAL);
    if (sent < 0) return errno == EAGAIN || errno == EINTR;
    sent_bytes += static_cast<std::size_t>(sent);
    if (sent > 0) since = Clock::now();
    if (sent_bytes == out.size()) {
      out.clear();
      sent_bytes = 0;
      // What still comes is read before it is closed: otherwise the other side could lose the answer.
      if (ends) ::shutdown(socket.number(), SHUT_WR);
    }
    return true;
  }

  Socket socket;
  std::string in, out;
  std::size_t sent_bytes = 0;              // of out
  Clock::time_point since = Clock::now();  // when it came, was answered, or took a part of its answer
  bool is_known = false;                   // it has sent a request with the token
  bool wants_more = true;                  // in holds no whole request
  bool ends = false;                       // after its answer: what still comes is thrown away
};

}  // namespace

class LocalServer::Server {
 public:
  Server(Answers answers, const Listening& where)
      : answers_(std::move(answers)),
        frame_origin_(where.frame_origin ? read_frame_origin(*where.frame_origin) : ""),
        token_(random_token()),
        listener_(listening(where.port)),
        limiter_(where.most_in_a_second) {
    if (listener_.number() < 0) {
      throw InputError(where.port == 0
                           ? std::string("--port: no port of 127.0.0.1 is free")
                           : fmt::format("--port: cannot listen on port {} of 127.0.0.1, which another program "
                                         "may use; expected a free one, or leave the option out",
                                         where.port));
    }
    port_ = port_of(listener_.number());
    base_ = "/" + token_ + "/";
    address_ = fmt::format("http://{}:{}{}", host, port_, base_);
  }

  const std::string& address() const { return address_; }

  void run(const std::atomic<bool>& interrupt) {
    while (!interrupt) {
      wait();
      accept_some();
      for (auto at = connections_.begin(); at != connections_.end() && !interrupt;) {
        at = serve(*at) ? std::next(at) : connections_.erase(at);
      }
    }
  }

 private:
  /// Until something comes, can be sent, or some ms have gone.
  void wait() {
    constexpr int longest_ms = 50;  // Ctrl-C is noticed then
    waiting_.assign(1, {listener_.number(), POLLIN, 0});
    bool has_request = false;
    for (const Connection& one : connections_) {
      waiting_.push_back({one.socket.number(), static_cast<short>(one.out.empty() ? POLLIN : POLLOUT), 0});
      has_request = has_request || (one.out.empty() && !one.wants_more && !one.ends);
    }
    ::poll(waiting_.data(), waiting_.size(), has_request ? 0 : longest_ms);
  }

  void accept_some() {
    constexpr int most_at_once = 32;  // then those that are there are served
    for (int k = 0; k < most_at_once; ++k) {
      const int number = ::accept4(listener_.number(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
      if (number < 0) return;
      const int yes = 1;
      ::setsockopt(number, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
      if (connections_.size() >= most_connections) drop_one();
      connections_.emplace_back(number);
    }
  }

  /// Newer connections stand behind older ones.
  void drop_one() {
    auto dropped =
        std::find_if(connections_.begin(), connections_.end(), [](const Connection& one) { return !one.is_known; });
    if (dropped == connections_.end()) {
      dropped = std::min_element(connections_.begin(), connections_.end(),
                                 [](const Connection& a, const Connection& b) { return a.since < b.since; });
    }
    connections_.erase(dropped);
  }

  /// Goes on with a connection as far as it goes without waiting. False where it is at its end.
  bool serve(Connection& connection) {
    if (!connection.out.empty()) {
      if (!connection.send()) return false;
    } else if (connection.ends) {
      if (!connection.receive()) return false;
      connection.in.clear();
    } else {
      if (connection.wants_more && !connection.receive()) return false;
      read(connection);
    }
    // A page keeps its connection for the next request.
    const bool rests = connection.is_known && !connection.ends && connection.in.empty() && connection.out.empty();
    return rests || Clock::now() - connection.since < longest_wait;
  }

  /// Answers the request that has come, if one has come whole. One that is refused is not read to its end.
  void read(Connection& connection) {
    const HttpHead head = read_head(connection.in);
    connection.wants_more = head.refused == 0 && head.length == 0;
    if (connection.wants_more) return;
    const HttpRequest& request = head.request;
    Response response = head.refused != 0 ? refusal(head.refused, head.why) : screen(request);
    if (response.status == 200) {
      connection.is_known = true;
      connection.wants_more = connection.in.size() - head.length < request.body_length;
      if (connection.wants_more) return;
      response = answer(request, connection.in.substr(head.length, request.body_length));
      connection.in.erase(0, head.length + request.body_length);
      connection.wants_more = connection.in.empty();
    } else {
      connection.is_known = false;
    }
    connection.ends = !(connection.is_known && request.keeps_connection);
    connection.out = written(response, !connection.ends);
    connection.since = Clock::now();
  }

  static Response refusal(int status, const char* why) { return {.status = status, .content = why}; }

  bool is_own(const std::string& authority) const {
    return authority == fmt::format("{}:{}", host, port_) || authority == fmt::format("localhost:{}", port_);
  }

  /// Whether a browser asks for the page itself for a frame of another page, which may be one that is allowed to show
  /// it. That is told where its Referer is not withheld; where it is, the browser decides by frame-ancestors.
  bool is_for_allowed_frame(const HttpRequest& request) const {
    if (frame_origin_.empty() || request.method != "GET" || !same_text(request.path, base_)) return false;
    if (request.header("sec-fetch-mode") != "navigate" || request.header("sec-fetch-dest") != "iframe") return false;
    const std::string referrer = request.header("referer");
    return referrer.empty() || referrer == frame_origin_ || referrer.starts_with(frame_origin_ + "/");
  }

  /// Nothing is said to a request that comes from elsewhere, but that it is refused.
  Response screen(const HttpRequest& request) const {
    if (!is_own(request.header("host"))) return refusal(403, "refused\n");
    const std::string origin = request.header("origin");
    const std::string scheme = "http://";
    if (!origin.empty() && !(origin.starts_with(scheme) && is_own(origin.substr(scheme.size())))) {
      return refusal(403, "refused\n");
    }
    const std::string site = request.header("sec-fetch-site");
    const bool is_of_other_site = !site.empty() && site != "same-origin" && site != "none";
    if (is_of_other_site && !is_for_allowed_frame(request)) return refusal(403, "refused\n");
    if (!same_text(request.path.substr(0, base_.size()), base_)) return refusal(404, "not found\n");
    return {};
  }

  Response answer(const HttpRequest& request, const std::string& body) {
    if (!limiter_.allow()) return refusal(429, "too many requests\n");
    const std::string what = request.method + " " + request.path.substr(base_.size());
    try {
      if (what == "GET ") return {.type = html_type, .content = answers_.page(), .framing = framing_of_page()};
      if (what == "POST do") return {.type = json_type, .content = answers_.act(body)};
      if (what == "GET poll") return {.type = json_type, .content = answers_.poll(revision_in(request.query))};
      if (what == "GET page") {
        return {.type = html_type,
                .content = answers_.shared(),
                .more_headers = "Content-Disposition: attachment; filename=\"mechanism.html\"\r\n"};
      }
    } catch (const std::exception&) {
      return refusal(500, "an error of Poise\n");
    }
    return refusal(404, "not found\n");
  }

  /// X-Frame-Options can name no origin, and would forbid what frame-ancestors allows.
  std::string framing_of_page() const {
    if (frame_origin_.empty()) return no_frame;
    return fmt::format("Content-Security-Policy: frame-ancestors {}\r\n", frame_origin_);
  }

  static std::string revision_in(const std::string& query) {
    const std::string key = "revision=";
    return query.starts_with(key) ? query.substr(key.size()) : "";
  }

  Answers answers_;
  std::string frame_origin_;  // empty: no page may show ours in a frame
  std::string token_, base_, address_;
  Socket listener_;
  int port_ = 0;
  Limiter limiter_;
  std::list<Connection> connections_;
  std::vector<pollfd> waiting_;
};

LocalServer::LocalServer(Answers answers, const Listening& listening)
    : server_(std::make_unique<Server>(std::move(answers), listening)) {}
LocalServer::~LocalServer() = default;

const std::string& LocalServer::address() const { return server_->address(); }
void LocalServer::run(const std::atomic<bool>& interrupt) { server_->run(interrupt); }

bool open_in_browser(const std::string& address) {
  posix_spawn_file_actions_t silent;
  posix_spawn_file_actions_init(&silent);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    posix_spawn_file_actions_addopen(&silent, stream, "/dev/null", O_RDWR, 0);
  }
  bool opened = false;
  for (const char* program : {"xdg-open", "open"}) {
    std::string name = program, argument = address;
    char* const words[] = {name.data(), argument.data(), nullptr};
    pid_t child = 0;
    if (::posix_spawnp(&child, program, &silent, nullptr, words, environ) != 0) continue;
    // It hands the address on and ends; a browser that it starts itself may live as long as it likes.
    std::thread([child] { ::waitpid(child, nullptr, 0); }).detach();
    opened = true;
    break;
  }
  posix_spawn_file_actions_destroy(&silent);
  return opened;
}

}  // namespace poise::app
