// What a server of `poise view` answers, and whom.
#include "app/view/server.hpp"

#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <regex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <httplib.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "app/view/frame_origin.hpp"
#include "app/view/http_request.hpp"
#include "model/input_error.hpp"

namespace poise::app::server_test {
namespace {

/// A server with answers that name themselves, run in a thread of its own.
class Running {
 public:
  explicit Running(const Listening& listening = {.most_in_a_second = 1e6})
      : server_({.page = [] { return std::string("the page"); },
                 .act = [](const std::string& body) { return "acted on " + body; },
                 .poll = [](const std::string& revision) { return "polled " + revision; },
                 .shared = [] { return std::string("the report"); }},
                listening),
        thread_([this] { server_.run(interrupt_); }) {
    static const std::regex form(R"(http://127\.0\.0\.1:([0-9]+)(/[0-9a-f]{32}/))");
    std::smatch match;
    EXPECT_TRUE(std::regex_match(server_.address(), match, form)) << server_.address();
    port_ = std::stoi(match[1]);
    base_ = match[2];
  }
  ~Running() { end(); }
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;

  void end() {
    interrupt_ = true;
    if (thread_.joinable()) thread_.join();
  }
  httplib::Client client() const { return httplib::Client("127.0.0.1", port_); }
  const std::string& base() const { return base_; }
  int port() const { return port_; }

  int status(const std::string& path, const httplib::Headers& headers = {}) const {
    const httplib::Result result = client().Get(path.c_str(), headers);
    return result ? result->status : 0;
  }

 private:
  std::atomic<bool> interrupt_ = false;
  LocalServer server_;
  std::thread thread_;
  int port_ = 0;
  std::string base_;
};

TEST(LocalServer, AnswersUnderItsToken) {
  const Running server;
  httplib::Client client = server.client();
  EXPECT_EQ(client.Get(server.base().c_str())->body, "the page");
  EXPECT_EQ(client.Post((server.base() + "do").c_str(), "{}", "application/json")->body, "acted on {}");
  EXPECT_EQ(client.Get((server.base() + "poll?revision=7").c_str())->body, "polled 7");
  EXPECT_EQ(client.Get((server.base() + "page").c_str())->body, "the report");
}

TEST(LocalServer, HasNothingWithoutTheToken) {
  const Running server;
  std::string other = server.base();
  other[5] = other[5] == '0' ? '1' : '0';
  for (const std::string& path :
       {std::string("/"), std::string("/index.html"), other, other + "do", std::string("/etc/passwd"),
        server.base() + "../../etc/passwd", server.base() + "%2e%2e/%2e%2e/etc/passwd", server.base() + "etc/passwd",
        server.base() + "datasets/toggle_clamp.toml", server.base() + "do"}) {
    EXPECT_EQ(server.status(path), 404) << path;
  }
}

TEST(LocalServer, GivesEveryRunAnotherToken) {
  const Running one, two;
  EXPECT_NE(one.base(), two.base());
}

// A page of another site can send requests to this machine, and a name of another site can be bound to it: browsers
// then tell the other site's name.
TEST(LocalServer, RefusesPagesOfOtherSites) {
  const Running server;
  const std::string own = "http://127.0.0.1:" + std::to_string(server.port());
  EXPECT_EQ(server.status(server.base(), {{"Host", "example.org"}}), 403);
  EXPECT_EQ(server.status(server.base(), {{"Host", "example.org:" + std::to_string(server.port())}}), 403);
  EXPECT_EQ(server.status(server.base(), {{"Origin", "http://example.org"}}), 403);
  EXPECT_EQ(server.status(server.base(), {{"Origin", "null"}}), 403);
  EXPECT_EQ(server.status(server.base(), {{"Sec-Fetch-Site", "cross-site"}}), 403);
  EXPECT_EQ(server.status(server.base(), {{"Origin", own}, {"Sec-Fetch-Site", "same-origin"}}), 200);
}

/// A connection that says what it is told to, byte for byte.
class Raw {
 public:
  explicit Raw(int port) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);  // NOLINT
  }
  ~Raw() { ::close(socket_); }
  Raw(const Raw&) = delete;
  Raw& operator=(const Raw&) = delete;

  void say(const std::string& text) const {
    // A server that has had enough ends the connection.
    EXPECT_NE(::send(socket_, text.data(), text.size(), MSG_NOSIGNAL), 0);
  }
  /// All that comes until the server ends.
  std::string heard() const {
    std::string out;
    char part[4096];
    for (ssize_t got = 0; (got = ::recv(socket_, part, sizeof part, 0)) > 0;)
      out.append(part, static_cast<std::size_t>(got));
    return out;
  }

 private:
  int socket_;
};

std::string head_of(const Running& server, const std::string& line, const std::string& more) {
  return line + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(server.port()) + "\r\n" + more + "\r\n";
}

TEST(LocalServer, RefusesLargeBodiesAndThoseOfUnknownLength) {
  const Running server;
  httplib::Client client = server.client();
  const std::string address = server.base() + "do", large(HttpRequest::largest_body + 1, 'x');
  const httplib::Result refused = client.Post(address.c_str(), large, "application/json");
  EXPECT_TRUE(!refused || refused->status == 413);
  EXPECT_EQ(client.Post(address.c_str(), large.substr(1), "application/json")->body, "acted on " + large.substr(1));
  const Raw chunked(server.port());
  chunked.say(head_of(server, "POST " + address, "Transfer-Encoding: chunked\r\n") + "2\r\n{}\r\n0\r\n\r\n");
  EXPECT_EQ(chunked.heard().substr(0, 12), "HTTP/1.1 411");
  const Raw both(server.port());
  both.say(head_of(server, "POST " + address, "Content-Length: 2\r\nTransfer-Encoding: chunked\r\n") + "{}");
  EXPECT_EQ(both.heard().substr(0, 12), "HTTP/1.1 411");
}

TEST(LocalServer, RefusesWhatIsNoRequest) {
  const Running server;
  const std::string address = server.base() + "do";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"\r\n\r\n", "400"},
      {"GET\r\n\r\n", "400"},
      {"GET  HTTP/1.1\r\n\r\n", "400"},
      {"GET http://127.0.0.1/ HTTP/1.1\r\n\r\n", "400"},
      {"GET /\x01 HTTP/1.1\r\n\r\n", "400"},
      {"GET / HTTP/2\r\n\r\n", "505"},
      {"GET / HTTP/1.1\r\nHost 127.0.0.1\r\n\r\n", "400"},
      {"GET / HTTP/1.1\r\nHost: a\r\n b\r\n\r\n", "400"},
      {"GET / HTTP/1.1\r\nHost: a\r\nhost: b\r\n\r\n", "400"},
      {head_of(server, "POST " + address, ""), "411"},
      {head_of(server, "POST " + address, "Content-Length: -1\r\n"), "400"},
      {head_of(server, "POST " + address, "Content-Length: 2x\r\n"), "400"},
      {head_of(server, "POST " + address, "Content-Length: 99999999999999999999999\r\n"), "413"},
      {head_of(server, "DELETE " + address, "Content-Length: 0\r\nConnection: close\r\n"), "404"},
      {"GET / HTTP/1.1\r\nX: " + std::string(HttpRequest::largest_head, 'x'), "431"}};
  for (const auto& [text, status] : cases) {
    const Raw connection(server.port());
    connection.say(text);
    EXPECT_EQ(connection.heard().substr(0, 12), "HTTP/1.1 " + status) << text.substr(0, 100);
  }
  EXPECT_EQ(server.status(server.base()), 200);
}

TEST(LocalServer, AnswersRequestsThatComeTogetherOrInPieces) {
  const Running server;
  const std::string one = head_of(server, "POST " + server.base() + "do", "Content-Length: 3\r\n") + "one";
  const std::string two = head_of(server, "GET " + server.base() + "poll?revision=2", "Connection: close\r\n");
  for (const std::size_t piece : {std::size_t{1}, std::size_t{7}, (one + two).size()}) {
    const Raw connection(server.port());
    const std::string text = one + two;
    for (std::size_t at = 0; at < text.size(); at += piece) connection.say(text.substr(at, piece));
    const std::string heard = connection.heard();
    const std::size_t first = heard.find("acted on one"), second = heard.find("polled 2");
    EXPECT_TRUE(first < second && second != std::string::npos) << heard;
  }
}

// Who does not know the token must not be able to keep the page from being served.
TEST(LocalServer, ServesThePageBesideSlowAndManyConnections) {
  const Running server;
  httplib::Client page = server.client();
  page.set_keep_alive(true);
  page.set_read_timeout(5);
  EXPECT_EQ(page.Get(server.base().c_str())->status, 200);
  std::vector<std::unique_ptr<Raw>> slow;
  for (std::size_t k = 0; k < 3 * LocalServer::most_connections; ++k) {
    slow.push_back(std::make_unique<Raw>(server.port()));
    slow.back()->say(k % 2 == 0 ? "GET /" : head_of(server, "POST /none/do", "Content-Length: 1000000\r\n"));
    if (k % 50 == 0) {
      EXPECT_EQ(page.Get((server.base() + "poll?revision=1").c_str())->body, "polled 1");
    }
  }
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(server.status(server.base()), 200) << "a new connection of the page";
  EXPECT_EQ(page.Get((server.base() + "poll?revision=1").c_str())->body, "polled 1");
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(4));
}

TEST(LocalServer, LimitsRequests) {
  const Running slow({.most_in_a_second = 2.0});
  httplib::Client hasty = slow.client();
  int too_many = 0;
  for (int k = 0; k < 10; ++k) {
    const httplib::Result result = hasty.Get((slow.base() + "poll").c_str());
    too_many += result && result->status == 429;
  }
  EXPECT_GT(too_many, 3);
  // What is refused for lack of the token takes none of them away.
  const Running other({.most_in_a_second = 2.0});
  for (int k = 0; k < 20; ++k) EXPECT_EQ(other.status("/none/"), 404);
  EXPECT_EQ(other.status(other.base()), 200);
}

// A browser keeps its connection for the next request; the program must not wait for it as long as it likes.
TEST(LocalServer, EndsWhileABrowserKeepsItsConnection) {
  const auto server = std::make_unique<Running>();
  httplib::Client client = server->client();
  client.set_keep_alive(true);
  EXPECT_EQ(client.Get(server->base().c_str())->body, "the page");
  const std::future<void> ended = std::async(std::launch::async, [&] { server->end(); });
  EXPECT_EQ(ended.wait_for(std::chrono::seconds(10)), std::future_status::ready);
}

TEST(LocalServer, TellsBrowsersNotToShareThePage) {
  const Running server;
  const httplib::Result page = server.client().Get(server.base().c_str());
  EXPECT_EQ(page->get_header_value("Referrer-Policy"), "no-referrer");
  EXPECT_EQ(page->get_header_value("X-Frame-Options"), "DENY");
  EXPECT_EQ(page->get_header_value("Cache-Control"), "no-store");
  EXPECT_FALSE(page->has_header("Content-Security-Policy"));
}

constexpr const char* notebook = "http://localhost:8888";

/// What a browser sends for a frame of a page of another site.
httplib::Headers of_frame(const httplib::Headers& changed = {}) {
  httplib::Headers out = changed;
  const httplib::Headers usual = {
      {"Sec-Fetch-Site", "cross-site"}, {"Sec-Fetch-Mode", "navigate"}, {"Sec-Fetch-Dest", "iframe"}};
  for (const auto& [name, value] : usual) {
    if (!out.contains(name)) out.emplace(name, value);
  }
  return out;
}

TEST(LocalServer, NamesTheOneOriginThatMayFrameThePage) {
  const Running server({.frame_origin = notebook});
  httplib::Client client = server.client();
  const httplib::Result page = client.Get(server.base().c_str());
  EXPECT_EQ(page->get_header_value("Content-Security-Policy"), "frame-ancestors http://localhost:8888");
  EXPECT_FALSE(page->has_header("X-Frame-Options"));
  EXPECT_EQ(page->get_header_value("Referrer-Policy"), "no-referrer");
  const std::string to_act = server.base() + "do";
  std::vector<httplib::Result> others;
  for (const char* path : {"poll", "page", "none"}) others.push_back(client.Get((server.base() + path).c_str()));
  others.push_back(client.Post(to_act.c_str(), "{}", "application/json"));
  others.push_back(client.Get("/"));
  for (const httplib::Result& other : others) {
    EXPECT_EQ(other->get_header_value("X-Frame-Options"), "DENY") << other->status;
    EXPECT_FALSE(other->has_header("Content-Security-Policy")) << other->status;
  }
}

TEST(LocalServer, AnswersAFrameOfAnotherSiteThePageAlone) {
  const Running closed, server({.frame_origin = notebook});
  EXPECT_EQ(closed.status(closed.base(), of_frame()), 403);
  EXPECT_EQ(closed.status(closed.base(), of_frame({{"Referer", "http://localhost:8888/"}})), 403);
  for (const httplib::Headers& allowed :
       {of_frame(), of_frame({{"Sec-Fetch-Site", "same-site"}}), of_frame({{"Referer", "http://localhost:8888/"}}),
        of_frame({{"Referer", "http://localhost:8888/lab/tree/clamp.ipynb"}}), of_frame({{"Referer", notebook}})}) {
    EXPECT_EQ(server.status(server.base(), allowed), 200) << allowed.begin()->second;
  }
  for (const httplib::Headers& refused :
       {of_frame({{"Sec-Fetch-Dest", "document"}}), of_frame({{"Sec-Fetch-Dest", "script"}}),
        of_frame({{"Sec-Fetch-Dest", "frame"}}), of_frame({{"Sec-Fetch-Mode", "no-cors"}}),
        of_frame({{"Sec-Fetch-Mode", "cors"}}), of_frame({{"Origin", notebook}}), of_frame({{"Origin", "null"}}),
        of_frame({{"Host", "example.org"}}), of_frame({{"Host", "localhost:8888"}}),
        of_frame({{"Referer", "http://example.org/"}}), of_frame({{"Referer", "https://localhost:8888/"}}),
        of_frame({{"Referer", "http://localhost:88889/"}}),
        of_frame({{"Referer", "http://localhost:8888.example.org/"}}),
        of_frame({{"Referer", "http://localhost:8888@example.org/"}})}) {
    EXPECT_EQ(server.status(server.base(), refused), 403) << refused.begin()->first << " " << refused.begin()->second;
  }
  std::string other = server.base();
  other[5] = other[5] == '0' ? '1' : '0';
  for (const std::string& path : {other, server.base() + "poll", server.base() + "page", std::string("/")}) {
    EXPECT_EQ(server.status(path, of_frame()), 403) << path;
  }
  const std::string to_act = server.base() + "do";
  for (const httplib::Headers& headers : {of_frame(), httplib::Headers{{"Origin", notebook}}}) {
    EXPECT_EQ(server.client().Post(to_act.c_str(), headers, "{}", "application/json")->status, 403);
  }
  // The page in the frame has this server's origin.
  const std::string own = "http://127.0.0.1:" + std::to_string(server.port());
  const httplib::Headers of_page = {{"Origin", own}, {"Sec-Fetch-Site", "same-origin"}};
  EXPECT_EQ(server.client().Post(to_act.c_str(), of_page, "{}", "application/json")->body, "acted on {}");
}

TEST(FrameOrigin, IsWrittenAsBrowsersWriteIt) {
  for (const auto& [given, origin] :
       std::vector<std::pair<std::string, std::string>>{{"http://localhost:8888", "http://localhost:8888"},
                                                        {"HTTP://LocalHost:8888", "http://localhost:8888"},
                                                        {"http://127.0.0.1:8888", "http://127.0.0.1:8888"},
                                                        {"https://hub.example.org", "https://hub.example.org"},
                                                        {"https://hub.example.org:443", "https://hub.example.org"},
                                                        {"https://hub.example.org:80", "https://hub.example.org:80"},
                                                        {"http://a-b.c:65535", "http://a-b.c:65535"}}) {
    EXPECT_EQ(read_frame_origin(given), origin);
  }
}

// It becomes part of a header: a blank would add an origin, a semicolon a directive, a line break a header.
TEST(FrameOrigin, IsOneOriginAndNothingElse) {
  for (const std::string& text : {std::string(),
                                  std::string("*"),
                                  std::string("null"),
                                  std::string("'self'"),
                                  std::string("localhost:8888"),
                                  std::string("http:"),
                                  std::string("http://"),
                                  std::string("http://*"),
                                  std::string("http://*.example.org"),
                                  std::string("http://localhost:*"),
                                  std::string("http://localhost:8888/"),
                                  std::string("http://localhost:8888/lab"),
                                  std::string("http://localhost:8888?a"),
                                  std::string("http://localhost:8888#a"),
                                  std::string("http://localhost:"),
                                  std::string("http://localhost:0"),
                                  std::string("http://localhost:08888"),
                                  std::string("http://localhost:65536"),
                                  std::string("http://localhost:-1"),
                                  std::string("http://localhost:+1"),
                                  std::string("http://localhost:88 88"),
                                  std::string("http://me@localhost:8888"),
                                  std::string("http://me:word@localhost:8888"),
                                  std::string("http://[::1]:8888"),
                                  std::string("http://localhost:8888 *"),
                                  std::string(" http://localhost:8888"),
                                  std::string("http://localhost:8888 http://example.org"),
                                  std::string("http://localhost:8888,http://example.org"),
                                  std::string("http://localhost:8888; script-src *"),
                                  std::string("http://localhost;frame-ancestors"),
                                  std::string("http://localhost:8888\r\nX-Injected: yes"),
                                  std::string("http://localhost:8888\n"),
                                  std::string("http://local\r\nhost:8888"),
                                  std::string("http://localhost\0.example.org", 29),
                                  std::string("http://localhost:8888\t"),
                                  std::string("http://-a.org"),
                                  std::string("http://a..org"),
                                  std::string("http://a.org."),
                                  std::string("http://a_b.org"),
                                  std::string("http://l\u00f6calhost:8888"),
                                  std::string("ftp://localhost:8888"),
                                  std::string("file://localhost"),
                                  std::string("javascript:alert(1)"),
                                  std::string("http:\\\\localhost:8888"),
                                  "http://" + std::string(64, 'a'),
                                  "http://" + std::string(100000, 'a')}) {
    try {
      const LocalServer server({}, {.frame_origin = text});
      FAIL() << text;
    } catch (const InputError& error) {
      const std::string what = error.what();
      EXPECT_TRUE(what.starts_with("--frame-origin: expected ")) << what;
      EXPECT_EQ(what.find_first_of("\r\n"), std::string::npos) << what;
      EXPECT_LT(what.size(), 500U);
    }
  }
}

TEST(LocalServer, NamesAPortThatIsTaken) {
  const Running server;
  try {
    const LocalServer second({}, {.port = server.port()});
    FAIL() << "two servers share a port";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("--port: cannot listen on port " + std::to_string(server.port())),
              std::string::npos)
        << error.what();
  }
  for (const int port : {-1, 65536, 65536 + 8080}) EXPECT_THROW(LocalServer({}, {.port = port}), InputError) << port;
}

}  // namespace
}  // namespace poise::app::server_test
