#include "app/view/server.hpp"

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <httplib.h>
#include <spawn.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "model/input_error.hpp"

extern char** environ;  // NOLINT(readability-identifier-naming): of POSIX

namespace poise::app {
namespace {

constexpr const char* host = "127.0.0.1";
constexpr int threads = 4;  // one request at a time is answered, the others are read and refused meanwhile

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
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto now = std::chrono::steady_clock::now();
    left_ = std::min(rate_, left_ + rate_ * std::chrono::duration<double>(now - last_).count());
    last_ = now;
    if (left_ < 1.0) return false;
    left_ -= 1.0;
    return true;
  }

 private:
  double rate_, left_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
  std::mutex mutex_;
};

constexpr const char* html_type = "text/html; charset=utf-8";
constexpr const char* json_type = "application/json; charset=utf-8";
constexpr const char* plain_type = "text/plain; charset=utf-8";

}  // namespace

class LocalServer::Server {
 public:
  Server(Answers answers, int port, double most_in_a_second)
      : answers_(std::move(answers)), token_(random_token()), limiter_(most_in_a_second) {
    server_.new_task_queue = [] { return new httplib::ThreadPool(threads); };  // httplib deletes it
    server_.set_tcp_nodelay(true);
    server_.set_keep_alive_max_count(1'000'000);
    // For so long Ctrl-C waits for connections that a browser keeps open.
    server_.set_keep_alive_timeout(1);
    server_.set_read_timeout(10);
    server_.set_write_timeout(10);
    server_.set_payload_max_length(largest_body);
    server_.set_default_headers({{"Cache-Control", "no-store"},
                                 {"X-Content-Type-Options", "nosniff"},
                                 {"Referrer-Policy", "no-referrer"},
                                 {"X-Frame-Options", "DENY"},
                                 {"Cross-Origin-Opener-Policy", "same-origin"},
                                 {"Cross-Origin-Resource-Policy", "same-origin"}});
    // A port can be had again at once, but not by two programs, of which one could take what is meant for the other.
    server_.set_socket_options([](socket_t socket) {
      const int yes = 1;
      ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    port_ = port == 0 ? server_.bind_to_any_port(host) : (server_.bind_to_port(host, port) ? port : -1);
    if (port_ < 0) {
      throw InputError(port == 0 ? std::string("--port: no port of 127.0.0.1 is free")
                                 : fmt::format("--port: cannot listen on port {} of 127.0.0.1, which another program "
                                               "may use; expected a free one, or leave the option out",
                                               port));
    }
    address_ = fmt::format("http://{}:{}/{}/", host, port_, token_);
    add_routes();
  }

  const std::string& address() const { return address_; }

  void run(const std::atomic<bool>& interrupt) {
    std::atomic<bool> ended = false;
    std::thread watch([&] {
      while (!interrupt && !ended) std::this_thread::sleep_for(std::chrono::milliseconds(50));
      while (!server_.is_running() && !ended) std::this_thread::sleep_for(std::chrono::milliseconds(5));
      server_.stop();
    });
    server_.listen_after_bind();
    ended = true;
    watch.join();
  }

 private:
  using Request = httplib::Request;
  using Response = httplib::Response;

  // Nothing is said to a request that comes from elsewhere, but that it is refused.
  static httplib::Server::HandlerResponse refuse(Response& response, int status, const char* why) {
    response.status = status;
    response.set_content(why, plain_type);
    return httplib::Server::HandlerResponse::Handled;
  }

  bool is_own(const std::string& authority) const {
    return authority == fmt::format("{}:{}", host, port_) || authority == fmt::format("localhost:{}", port_);
  }

  httplib::Server::HandlerResponse screen(const Request& request, Response& response) {
    if (!limiter_.allow()) return refuse(response, 429, "too many requests\n");
    if (request.remote_addr != host) return refuse(response, 403, "refused\n");
    if (!is_own(request.get_header_value("Host"))) return refuse(response, 403, "refused\n");
    const std::string origin = request.get_header_value("Origin");
    const std::string scheme = "http://";
    if (!origin.empty() && !(origin.rfind(scheme, 0) == 0 && is_own(origin.substr(scheme.size())))) {
      return refuse(response, 403, "refused\n");
    }
    const std::string site = request.get_header_value("Sec-Fetch-Site");
    if (!site.empty() && site != "same-origin" && site != "none") return refuse(response, 403, "refused\n");
    if (!same_text(request.path.substr(0, token_.size() + 2), "/" + token_ + "/")) {
      return refuse(response, 404, "not found\n");
    }
    return httplib::Server::HandlerResponse::Unhandled;
  }

  template <class Answer>
  std::string one_at_a_time(Answer answer) {
    const std::lock_guard<std::mutex> lock(mutex_);
    return answer();
  }

  void add_routes() {
    server_.set_pre_routing_handler(
        [this](const Request& request, Response& response) { return screen(request, response); });
    server_.set_exception_handler([](const Request&, Response& response, const std::exception_ptr&) {
      refuse(response, 500, "an error of Poise\n");
    });
    const std::string base = "/" + token_ + "/";
    server_.Get(base, [this](const Request&, Response& response) {
      response.set_content(one_at_a_time([&] { return answers_.page(); }), html_type);
    });
    server_.Post(base + "do", [this](const Request& request, Response& response) {
      response.set_content(one_at_a_time([&] { return answers_.act(request.body); }), json_type);
    });
    server_.Get(base + "poll", [this](const Request& request, Response& response) {
      response.set_content(one_at_a_time([&] { return answers_.poll(request.get_param_value("revision")); }),
                           json_type);
    });
    server_.Get(base + "page", [this](const Request&, Response& response) {
      response.set_header("Content-Disposition", "attachment; filename=\"mechanism.html\"");
      response.set_content(one_at_a_time([&] { return answers_.shared(); }), html_type);
    });
  }

  Answers answers_;
  std::string token_, address_;
  int port_ = 0;
  Limiter limiter_;
  std::mutex mutex_;
  httplib::Server server_;
};

LocalServer::LocalServer(Answers answers, int port, double most_in_a_second)
    : server_(std::make_unique<Server>(std::move(answers), port, most_in_a_second)) {}
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
