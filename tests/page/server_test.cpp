// What a server of `poise view` answers, and whom.
#include "app/view/server.hpp"

#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <regex>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <httplib.h>

#include "model/input_error.hpp"

namespace poise::app::server_test {
namespace {

/// A server with answers that name themselves, run in a thread of its own.
class Running {
 public:
  explicit Running(double most_in_a_second = 1e6)
      : server_({.page = [] { return std::string("the page"); },
                 .act = [](const std::string& body) { return "acted on " + body; },
                 .poll = [](const std::string& revision) { return "polled " + revision; },
                 .shared = [] { return std::string("the report"); }},
                0, most_in_a_second),
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

TEST(LocalServer, LimitsRequests) {
  const Running server;
  httplib::Client client = server.client();
  const std::string large(static_cast<std::size_t>(LocalServer::largest_body) + 1, 'x');
  const httplib::Result refused = client.Post((server.base() + "do").c_str(), large, "application/json");
  EXPECT_TRUE(!refused || refused->status == 413);
  const Running slow(2.0);
  httplib::Client hasty = slow.client();
  int too_many = 0;
  for (int k = 0; k < 10; ++k) {
    const httplib::Result result = hasty.Get((slow.base() + "poll").c_str());
    too_many += result && result->status == 429;
  }
  EXPECT_GT(too_many, 3);
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
}

TEST(LocalServer, NamesAPortThatIsTaken) {
  const Running server;
  try {
    const LocalServer second({}, server.port());
    FAIL() << "two servers share a port";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("--port: cannot listen on port " + std::to_string(server.port())),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace poise::app::server_test
