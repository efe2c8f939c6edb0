// Pages in frames of other pages, in a real browser: the live page in one of a notebook's origin, and the
// self-contained one in a sandbox.
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <httplib.h>
#include <nlohmann/json.hpp>

#include "app/view/background_view.hpp"
#include "tests/app/run_poise.hpp"
#include "tests/support/browser.hpp"

namespace poise::page_tests::framed_view_test {
namespace {

using app::BackgroundView;
using app::SceneInMemory;
using app_tests::contents;
using app_tests::dataset;
using app_tests::run_poise;
using app_tests::TempFolder;
using nlohmann::json;
using test::Browser;

Browser& browser() { return Browser::shared(); }

/// A notebook with one cell, on a port of its own.
class Notebook {
 public:
  Notebook() : port_(server_.bind_to_any_port("127.0.0.1")) {
    server_.set_keep_alive_timeout(1);  // s: at its end it waits for connections of the browser
    server_.Get("/", [this](const httplib::Request&, httplib::Response& response) {
      response.set_content("<!DOCTYPE html><link rel=\"icon\" href=\"data:,\"><title>Notebook</title>" + cell_,
                           "text/html; charset=utf-8");
    });
    thread_ = std::thread([this] { server_.listen_after_bind(); });
  }
  ~Notebook() {
    server_.stop();
    thread_.join();
  }
  Notebook(const Notebook&) = delete;
  Notebook& operator=(const Notebook&) = delete;

  std::string origin(const std::string& host = "localhost") const {
    return "http://" + host + ":" + std::to_string(port_);
  }
  /// Opens the notebook under a name of this machine, with a cell.
  void open(const std::string& cell, const std::string& host = "localhost") {
    cell_ = cell;
    browser().open(origin(host) + "/");
  }

 private:
  httplib::Server server_;
  int port_ = 0;
  std::string cell_;
  std::thread thread_;
};

std::string framed(const std::string& address, const std::string& referrer_policy = "") {
  return "<iframe style=\"width: 100%; height: 640px; border: 0\" referrerpolicy=\"" + referrer_policy + "\" src=\"" +
         address + "\"></iframe>";
}

class FramedView : public testing::Test {
 protected:
  void SetUp() override {
    if (const std::string why = Browser::missing(); !why.empty()) GTEST_SKIP() << why;
    browser().emulate({.width = 1000, .height = 700});
    browser().console();
  }
  void TearDown() override {
    if (!Browser::missing().empty()) return;
    // Otherwise the page would write to the console that the view has ended.
    browser().open("about:blank");
    browser().console();
  }

  std::unique_ptr<BackgroundView> shown(const std::optional<std::string>& frame_origin) {
    const std::string file = folder_.write("toggle_clamp.toml", contents(dataset("toggle_clamp")));
    return std::make_unique<BackgroundView>(std::filesystem::path(file), app::Listening{.frame_origin = frame_origin});
  }

  /// Enters a frame, and says whether it shows the mechanism; otherwise the browser refuses to.
  static bool is_drawn() {
    browser().enter_frame("iframe");
    EXPECT_TRUE(browser().wait_for("location.protocol === 'chrome-error:' || document.querySelector('.picture *')"));
    return browser().run("return location.protocol !== 'chrome-error:'").get<bool>();
  }

  static void expect_silence() {
    for (const std::string& line : browser().console()) ADD_FAILURE() << line;
  }

  TempFolder folder_;
  Notebook notebook_;
};

TEST_F(FramedView, WorksInANotebookThatIsAllowed) {
  const std::unique_ptr<BackgroundView> view = shown(notebook_.origin());
  notebook_.open(framed(view->address()));
  ASSERT_TRUE(is_drawn());
  EXPECT_TRUE(
      browser().wait_for("document.querySelector('.live-verdict').innerText.includes('In equilibrium, proved')"));
  // It asks for what its own page may ask for: a number changes, and the other equilibria come with a poll.
  const std::string before = browser().run("return document.body.dataset.revision");
  browser().run(
      "const field = document.querySelector('[data-number=\"load.P\"] input[type=number]');"
      "field.value = 30; field.dispatchEvent(new Event('input', {bubbles: true}));"
      "field.dispatchEvent(new Event('change', {bubbles: true}));");
  EXPECT_TRUE(browser().wait_for("Number(document.body.dataset.revision) > " + before));
  EXPECT_TRUE(browser().wait_for("document.body.textContent.includes('3 equilibria, complete, proved')"));
  EXPECT_LE(browser().run("return document.documentElement.scrollWidth - innerWidth"), 0) << "wider than the cell";
  if (const char* file = std::getenv("POISE_FRAMED_PICTURE")) browser().picture(file);
  expect_silence();
  // The page opens by itself as before.
  browser().open(view->address());
  EXPECT_TRUE(browser().wait_for("document.querySelector('.picture *')"));
  expect_silence();
}

TEST_F(FramedView, WorksInANotebookOfItsOwnHost) {
  const std::unique_ptr<BackgroundView> view = shown(notebook_.origin("127.0.0.1"));
  notebook_.open(framed(view->address()), "127.0.0.1");
  EXPECT_TRUE(is_drawn());
  expect_silence();
}

TEST_F(FramedView, IsRefusedToEveryOtherPage) {
  Notebook other;
  for (const std::optional<std::string>& origin :
       {std::optional<std::string>(), std::optional(other.origin()), std::optional(notebook_.origin("127.0.0.1"))}) {
    const std::unique_ptr<BackgroundView> view = shown(origin);
    // Also where the page around it says nothing of itself, and the browser alone can refuse.
    for (const char* policy : {"", "no-referrer"}) {
      notebook_.open(framed(view->address(), policy));
      EXPECT_FALSE(is_drawn()) << origin.value_or("no origin") << " " << policy;
    }
  }
  const std::unique_ptr<BackgroundView> view = shown(notebook_.origin());
  notebook_.open(framed(view->address(), "no-referrer"));
  EXPECT_TRUE(is_drawn());
  // All pages around it must be of that origin.
  other.open(framed(notebook_.origin() + "/"));
  browser().enter_frame("iframe");
  EXPECT_FALSE(is_drawn());
}

// Whoever may frame the page may still not speak for it, even when it knows the address.
TEST_F(FramedView, LeavesRequestsToThePageItself) {
  const std::unique_ptr<BackgroundView> view = shown(notebook_.origin());
  notebook_.open(framed(view->address()));
  const json heard = browser().run(
      "const body = JSON.stringify({do: 'set', path: 'load.P', value: 12, revision: 1});"
      "const asked = (path, options) => fetch(arguments[0] + path, options).then(async one => one.type + await "
      "one.text(),"
      "  () => 'refused');"
      "return Promise.all([asked('do', {method: 'POST', body}), asked('do', {method: 'POST', body, mode: 'no-cors'}),"
      "  asked('', {}), asked('', {mode: 'no-cors'}), asked('poll', {}), asked('page', {mode: 'no-cors'})])",
      {view->address()});
  for (const json& one : heard) EXPECT_TRUE(one == "refused" || one == "opaque") << one;
  EXPECT_TRUE(
      browser()
          .run("try { return document.querySelector('iframe').contentDocument === null; } catch { return true; }")
          .get<bool>());
  // A form's answer would be shown in a frame.
  browser().run(
      "const form = document.createElement('form'); form.method = 'POST'; form.enctype = 'text/plain';"
      "form.action = arguments[0] + 'do'; form.target = 'sink'; const sink = document.createElement('iframe');"
      "sink.name = 'sink'; document.body.append(sink, form); form.innerHTML = `<input name='{\"do\":\"set\",\"path\":"
      "\"load.P\",\"value\":12,\"revision\":1,\"x\":\"' value='\"}'>`; form.submit();",
      {view->address()});
  browser().console();
  browser().open(view->address());
  ASSERT_TRUE(browser().wait_for("document.body.dataset.revision !== undefined"));
  EXPECT_EQ(browser().run("return document.body.dataset.revision"), "1");
}

std::string attribute(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&') {
      out += "&amp;";
    } else if (c == '"') {
      out += "&quot;";
    } else {
      out += c;
    }
  }
  return out;
}

// Where the kernel is elsewhere no port of it can be had: the page is in the notebook, and may do nothing but run.
TEST_F(FramedView, SelfContainedPageFitsASandbox) {
  const std::string file = folder_.path("clamp.html").string();
  ASSERT_EQ(run_poise({"solve", dataset("toggle_clamp"), "--html", file}).exit_code, 0);
  const std::string page = attribute(contents(file));
  for (const int width : {400, 1280}) {
    browser().emulate({.width = width, .height = 800});
    notebook_.open(
        "<style>body { margin: 0 }</style><iframe sandbox=\"allow-scripts\" style=\"display: block; width: "
        "100%; height: 700px; border: 0\" srcdoc=\"" +
        page + "\"></iframe>");
    ASSERT_TRUE(is_drawn());
    EXPECT_EQ(browser().run("try { return String(localStorage); } catch { return 'none'; }"), "none");
    const json seen = browser().run(
        "const box = document.querySelector('.picture').getBoundingClientRect();"
        "const verdict = document.querySelector('.verdict').getBoundingClientRect();"
        "return {wide: document.documentElement.scrollWidth - innerWidth, top: box.top, bottom: box.bottom,"
        " width: box.width, height: box.height, verdict: verdict.bottom, inner: innerHeight}");
    EXPECT_LE(seen["wide"], 0) << seen;
    EXPECT_GE(seen["verdict"], 0) << seen;
    EXPECT_LE(seen["verdict"], seen["inner"]) << "the verdict is seen at once: " << seen;
    EXPECT_LE(seen["bottom"], seen["inner"]) << "so is the picture: " << seen;
    EXPECT_GE(seen["height"], 180) << seen;
    // A theme can be chosen, though nothing keeps the choice.
    browser().run("document.querySelector('input[value=dark]').click()");
    EXPECT_EQ(browser().run("return document.documentElement.dataset.theme"), "dark");
    browser().run("document.querySelector('input[value=auto]').click()");
    if (const char* folder = std::getenv("POISE_FRAMED_FOLDER")) {
      browser().picture(std::filesystem::path(folder) / ("sandbox_" + std::to_string(width) + ".png"));
    }
    expect_silence();
  }
}

}  // namespace
}  // namespace poise::page_tests::framed_view_test
