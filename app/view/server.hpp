#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace poise::app {

/// What a LocalServer answers, in the thread that runs it.
struct Answers {
  std::function<std::string()> page;                    ///< HTML
  std::function<std::string(const std::string&)> act;   ///< JSON to a request in JSON
  std::function<std::string(const std::string&)> poll;  ///< JSON to a revision
  std::function<std::string()> shared;                  ///< HTML: what can be given to others
};

/// Where a LocalServer listens, and for whom.
struct Listening {
  int port = 0;  ///< of 127.0.0.1; 0: one that is free
  /// Pages of this origin may show the page in a frame (read_frame_origin()); empty: none may.
  std::optional<std::string> frame_origin{};
  double most_in_a_second = 500;  ///< requests
};

/// A server for one page on this machine. It listens on 127.0.0.1 alone and serves nothing but `Answers`: no file of
/// the disk has an address. Every address begins with a random token of 128 bits; others are not found. Requests whose
/// Host or Origin is another than this server (pages of other sites, names that are bound to this machine), bodies
/// above HttpRequest::largest_body, bodies in chunks, and more than so many requests in a second are refused.
///
/// Where Listening names an origin, one thing more is answered: a frame's request for the page itself, which a page of
/// another site makes. The browser is told then to show it within pages of that origin alone. What the page in the
/// frame asks for comes from this server's own origin, as without a frame; no cookie is needed.
///
/// One thread serves all connections and waits for none. Who does not know the token can neither use up the requests of
/// a second nor keep the page from being served: where there are too many connections, the oldest without a request
/// that had the token is closed first, and one that has not sent a request within `longest_wait` is closed.
class LocalServer {
 public:
  static constexpr std::size_t most_connections = 100;
  static constexpr std::chrono::seconds longest_wait{10};

  /// Throws InputError naming --port where it cannot be had, and --frame-origin for what is no origin.
  LocalServer(Answers answers, const Listening& listening);
  ~LocalServer();
  LocalServer(const LocalServer&) = delete;
  LocalServer& operator=(const LocalServer&) = delete;

  /// "http://127.0.0.1:PORT/TOKEN/".
  const std::string& address() const;
  /// Serves until `interrupt`.
  void run(const std::atomic<bool>& interrupt);

 private:
  class Server;
  std::unique_ptr<Server> server_;
};

/// Opens an address in the user's browser. False where there is no program for that.
bool open_in_browser(const std::string& address);

}  // namespace poise::app
