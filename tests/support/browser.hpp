#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace poise::test {

/// What a page is shown on.
struct Screen {
  int width = 1280, height = 900;  ///< px
  bool dark = false;               ///< the scheme that the system asks for
  bool less_motion = false;        ///< the system asks for less motion
};

/// A headless Chromium, driven through its ChromeDriver (WebDriver, W3C Recommendation 2018). Debian's packages
/// chromium and chromium-driver; cmake/setup.sh browser installs them. Whatever the browser denies is thrown as
/// std::runtime_error.
class Browser {
 public:
  /// Why there is none here; empty where one can be started. Tests skip with it.
  static std::string missing();

  explicit Browser(const Screen& screen = {});
  ~Browser();
  Browser(const Browser&) = delete;
  Browser& operator=(const Browser&) = delete;

  /// One that all tests of a program share: starting it takes longer than most of them.
  static Browser& shared();

  /// Goes on with another screen.
  void emulate(const Screen& screen);

  void open(const std::string& address);
  /// Runs the body of a function in the page, with its arguments in `arguments`, and returns what it returns; a promise
  /// is waited for.
  nlohmann::json run(const std::string& script, const nlohmann::json& arguments);
  nlohmann::json run(const std::string& script);
  /// Waits until an expression is true; false where it is not after `seconds`.
  bool wait_for(const std::string& expression, double seconds = 60.0);

  /// From here on run() and wait_for() are within the first frame of the page that a CSS selector finds; leave_frames()
  /// and open() go back to the page.
  void enter_frame(const std::string& selector);
  void leave_frames();

  /// The pointer, at places of the window, px.
  void press(double x, double y);
  void move(double x, double y);
  void let_go();
  /// Keys of the keyboard, one after the other: "a", "Enter", "ArrowRight", "Tab", ...
  void type(const std::vector<std::string>& keys);
  /// A key while another is held: chord("Control", "z").
  void chord(const std::string& held, const std::string& key);

  /// Which controls that are seen the Tab key does not come to, of those that it should; as HTML.
  std::vector<std::string> missed_by_tab();

  /// What was written to the console since the last call, errors and warnings of the browser included.
  std::vector<std::string> console();
  /// The window as a PNG file.
  void picture(const std::filesystem::path& file);

 private:
  nlohmann::json ask(const std::string& what, const nlohmann::json& body);
  nlohmann::json get(const std::string& what);
  /// A command of the Chrome DevTools Protocol.
  void demand(const std::string& command, const nlohmann::json& parameters);
  void mouse(const std::string& type, double x, double y);

  class Driver;
  std::unique_ptr<Driver> driver_;
  double x_ = 0.0, y_ = 0.0;  // of the pointer
  bool is_down_ = false;
};

}  // namespace poise::test
