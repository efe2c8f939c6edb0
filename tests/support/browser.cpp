#include "tests/support/browser.hpp"

#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <httplib.h>
#include <nlohmann/json.hpp>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;  // NOLINT(readability-identifier-naming): of POSIX

namespace poise::test {
namespace {

using nlohmann::json;

std::optional<std::string> program(const std::vector<std::string>& names) {
  const char* const path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    for (const std::string& name : names) {
      const std::string file = folder + "/" + name;
      if (::access(file.c_str(), X_OK) == 0) return file;
    }
  }
  return std::nullopt;
}

std::optional<std::string> chromium() { return program({"chromium", "chromium-browser", "google-chrome"}); }
std::optional<std::string> chromedriver() { return program({"chromedriver"}); }

/// The number behind `words` in what a program prints, read until it comes; none where the program ends before.
std::optional<int> number_printed(int pipe, const std::string& words, std::string& printed) {
  std::array<char, 256> piece{};
  for (;;) {
    const std::size_t at = printed.find(words);
    if (at != std::string::npos && printed.find_first_not_of("0123456789", at + words.size()) != std::string::npos) {
      return std::stoi(printed.substr(at + words.size()));
    }
    const ssize_t got = ::read(pipe, piece.data(), piece.size());
    if (got <= 0) return std::nullopt;
    printed.append(piece.data(), static_cast<std::size_t>(got));
  }
}

std::string decoded_base64(const std::string& text) {
  std::string out;
  unsigned bits = 0;
  int have = 0;
  for (const char c : text) {
    static const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const std::size_t value = letters.find(c);
    if (value == std::string::npos) continue;
    bits = (bits << 6U) | static_cast<unsigned>(value);
    have += 6;
    if (have < 8) continue;
    have -= 8;
    out += static_cast<char>((bits >> static_cast<unsigned>(have)) & 0xFFU);
  }
  return out;
}

/// A key by its name, as WebDriver writes it.
std::string key_code(const std::string& name) {
  static const std::map<std::string, std::string> codes = {
      {"Enter", "\uE007"},     {"Tab", "\uE004"},     {"Escape", "\uE00C"},     {"Space", " "},
      {"ArrowLeft", "\uE012"}, {"ArrowUp", "\uE013"}, {"ArrowRight", "\uE014"}, {"ArrowDown", "\uE015"},
      {"Home", "\uE011"},      {"End", "\uE010"},     {"Control", "\uE009"},    {"Shift", "\uE008"},
      {"Backspace", "\uE003"}, {"Delete", "\uE017"}};
  const auto code = codes.find(name);
  return code != codes.end() ? code->second : name;
}

}  // namespace

class Browser::Driver {
 public:
  Driver() {
    // ChromeDriver takes a free port of IPv6 and ends where another program has that of IPv4, so that the next try
    // helps.
    constexpr int tries = 10;
    std::optional<int> listens;
    std::string printed;
    for (int k = 0; k < tries && !listens; ++k) {
      if (k > 0) end_process();
      start_process();
      listens = number_printed(output_, "successfully on port ", printed);
    }
    if (!listens) {
      end_process();
      throw std::runtime_error("chromedriver did not start: " + printed);
    }
    client_ = std::make_unique<httplib::Client>("127.0.0.1", *listens);
    client_->set_read_timeout(120);
    // ChromeDriver sends an answer in two pieces, and holds back the second for 40 ms where the connection stays open.
    client_->set_keep_alive(false);
    std::string folder = (std::filesystem::temp_directory_path() / "poise_browser_XXXXXX").string();
    if (::mkdtemp(folder.data()) == nullptr) throw std::runtime_error("no folder for the browser");
    profile_ = folder;
  }

  ~Driver() {
    if (!session.empty()) client_->Delete(("/session/" + session).c_str());
    end_process();
    std::error_code left;
    std::filesystem::remove_all(profile_, left);
  }
  Driver(const Driver&) = delete;
  Driver& operator=(const Driver&) = delete;

  json post(const std::string& path, const json& body) {
    return value_of(client_->Post(path.c_str(), body.dump(), "application/json"));
  }
  json get(const std::string& path) { return value_of(client_->Get(path.c_str())); }
  const std::string& profile() const { return profile_; }

  std::string session;

 private:
  void start_process() {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    // A group of its own: the browser that it starts ends with it.
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    std::string name = *chromedriver(), port = "--port=0";
    char* const words[] = {name.data(), port.data(), nullptr};
    const int error = ::posix_spawn(&process_, name.c_str(), &actions, &attributes, words, environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    ::close(ends[1]);
    output_ = ends[0];
    if (error != 0) throw std::runtime_error("chromedriver cannot be started");
  }

  void end_process() {
    ::kill(-process_, SIGTERM);
    ::waitpid(process_, nullptr, 0);
    ::close(output_);
  }

  static json value_of(const httplib::Result& result) {
    if (!result) throw std::runtime_error("chromedriver does not answer");
    json value = json::parse(result->body).at("value");
    if (result->status != 200) throw std::runtime_error("browser: " + value.value("message", result->body));
    return value;
  }

  pid_t process_ = 0;
  int output_ = -1;
  std::string profile_;
  std::unique_ptr<httplib::Client> client_;
};

std::string Browser::missing() {
  if (chromium() && chromedriver()) return "";
  return "no chromium with its chromedriver here; cmake/setup.sh browser installs them";
}

Browser::Browser(const Screen& screen) : driver_(std::make_unique<Driver>()) {
  const json arguments = {"--headless=new",
                          "--no-sandbox",
                          "--disable-gpu",
                          "--disable-quic",
                          "--disable-dev-shm-usage",
                          "--no-first-run",
                          "--disable-background-networking",
                          "--disable-component-update",
                          "--disable-sync",
                          "--hide-scrollbars",
                          "--user-data-dir=" + driver_->profile(),
                          fmt::format("--window-size={},{}", screen.width, screen.height)};
  const json capabilities = {{"capabilities",
                              {{"alwaysMatch",
                                {{"browserName", "chrome"},
                                 {"goog:loggingPrefs", {{"browser", "ALL"}}},
                                 {"goog:chromeOptions", {{"binary", *chromium()}, {"args", arguments}}}}}}}};
  driver_->session = driver_->post("/session", capabilities).at("sessionId").get<std::string>();
  emulate(screen);
}

Browser::~Browser() = default;

Browser& Browser::shared() {
  static Browser one;
  return one;
}

void Browser::emulate(const Screen& screen) {
  // The window has borders, and the page gets the size that was asked for; a headless one cannot be made narrow.
  demand("Emulation.setDeviceMetricsOverride",
         {{"width", screen.width}, {"height", screen.height}, {"deviceScaleFactor", 1}, {"mobile", false}});
  const json features = {
      {{"name", "prefers-color-scheme"}, {"value", screen.dark ? "dark" : "light"}},
      {{"name", "prefers-reduced-motion"}, {"value", screen.less_motion ? "reduce" : "no-preference"}}};
  demand("Emulation.setEmulatedMedia", {{"features", features}});
}

json Browser::ask(const std::string& what, const json& body) {
  return driver_->post("/session/" + driver_->session + "/" + what, body);
}

void Browser::demand(const std::string& command, const json& parameters) {
  ask("goog/cdp/execute", {{"cmd", command}, {"params", parameters}});
}

json Browser::get(const std::string& what) { return driver_->get("/session/" + driver_->session + "/" + what); }

void Browser::open(const std::string& address) {
  leave_frames();
  ask("url", {{"url", address}});
}

void Browser::enter_frame(const std::string& selector) {
  ask("frame", {{"id", ask("element", {{"using", "css selector"}, {"value", selector}})}});
}

void Browser::leave_frames() { ask("frame", {{"id", nullptr}}); }

json Browser::run(const std::string& script, const json& arguments) {
  return ask("execute/sync", {{"script", script}, {"args", arguments}});
}

json Browser::run(const std::string& script) { return run(script, json::array()); }

bool Browser::wait_for(const std::string& expression, double seconds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  for (;;) {
    if (run("return Boolean(" + expression + ")").get<bool>()) return true;
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

// ChromeDriver's own moves do not say which button is down, and Chromium then captures no pointer.
void Browser::mouse(const std::string& type, double x, double y) {
  x_ = std::round(x);
  y_ = std::round(y);
  const bool down = is_down_ || type == "mousePressed";
  demand("Input.dispatchMouseEvent", {{"type", type},
                                      {"x", x_},
                                      {"y", y_},
                                      {"button", down ? "left" : "none"},
                                      {"buttons", down && type != "mouseReleased" ? 1 : 0},
                                      {"clickCount", type == "mouseMoved" ? 0 : 1}});
  is_down_ = down && type != "mouseReleased";
}

void Browser::press(double x, double y) {
  move(x, y);
  mouse("mousePressed", x, y);
}

void Browser::move(double x, double y) { mouse("mouseMoved", x, y); }
void Browser::let_go() { mouse("mouseReleased", x_, y_); }

void Browser::chord(const std::string& held, const std::string& key) {
  json actions = json::array();
  for (const auto& [what, one] :
       {std::pair("keyDown", held), std::pair("keyDown", key), std::pair("keyUp", key), std::pair("keyUp", held)})
    actions.push_back({{"type", what}, {"value", key_code(one)}});
  ask("actions", {{"actions", {{{"type", "key"}, {"id", "keyboard"}, {"actions", actions}}}}});
}

void Browser::type(const std::vector<std::string>& keys) {
  json actions = json::array();
  for (const std::string& key : keys) {
    actions.push_back({{"type", "keyDown"}, {"value", key_code(key)}});
    actions.push_back({{"type", "keyUp"}, {"value", key_code(key)}});
  }
  ask("actions", {{"actions", {{{"type", "key"}, {"id", "keyboard"}, {"actions", actions}}}}});
}

std::vector<std::string> Browser::missed_by_tab() {
  // Of radio buttons only the chosen one is a stop of Tab, and of tabs the open one: arrow keys lead to the others.
  const json count =
      run("window.wanted = new Set([...document.querySelectorAll('a[href], button, input, select, textarea, summary, "
          "[tabindex=\"0\"]')].filter(one => one.checkVisibility({visibilityProperty: true}) && !one.disabled &&"
          " one.tabIndex >= 0 && !(one.type === 'radio' && !one.checked)));"
          "document.addEventListener('focusin', event => window.wanted.delete(event.target));"
          "document.activeElement.blur(); return window.wanted.size");
  std::vector<std::string> missed;
  // What the page redraws meanwhile can take the focus along: a second round comes to what the first one skipped.
  for (int round = 0; round < 2; ++round) {
    type(std::vector<std::string>(count.get<std::size_t>() + 5, "Tab"));
    const json left = run("return [...window.wanted].map(one => one.outerHTML.slice(0, 200))");
    missed = left.get<std::vector<std::string>>();
    if (missed.empty()) break;
  }
  return missed;
}

std::vector<std::string> Browser::console() {
  std::vector<std::string> out;
  for (const json& entry : ask("se/log", {{"type", "browser"}})) {
    out.push_back(entry.value("level", "") + ": " + entry.value("message", ""));
  }
  return out;
}

void Browser::picture(const std::filesystem::path& file) {
  std::ofstream(file, std::ios::binary) << decoded_base64(get("screenshot").get<std::string>());
}

}  // namespace poise::test
