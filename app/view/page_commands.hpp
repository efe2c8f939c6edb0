#pragma once

#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "app/commands/call.hpp"

namespace poise::app {

/// The mechanism of a page as a command is to see it.
struct ShownScene {
  std::string text;
  std::filesystem::path file;  ///< a name alone of a scene that is no file
  bool has_file = true;
  bool is_saved = true;  ///< the file has this text
  long revision = 0;
};

/// Commands of `poise` that a person runs in the page of `poise view`: of the text as it is shown, within this program,
/// in a thread of their own. Nothing is written; files that options name are those of the scene's folder.
///
///   {"do": "commands"}                                             those that make sense, with their options
///   {"do": "run", "command": "path", "options": [["--vary", "load.P=0..60"], ["--branches"]]}
///   {"do": "result"}, {"do": "result", "html": true}, {"do": "stop"}
class PageCommands {
 public:
  PageCommands() = default;
  ~PageCommands();
  PageCommands(const PageCommands&) = delete;
  PageCommands& operator=(const PageCommands&) = delete;

  /// Whether it is one of these requests.
  static bool takes(const std::string& request);
  /// The answer in JSON. Throws InputError for bad input that is known before the work begins.
  std::string answer(const nlohmann::json& request, const ShownScene& shown);

 private:
  struct Run {
    ShownScene shown;
    std::string command, line;
    std::vector<GivenOption> options;
    Caller caller{};
    std::string doing{}, error{};
    std::string document{};  // of the result's page, JSON
    bool stopped = false, ended = false;
  };

  void start(const nlohmann::json& request, const ShownScene& shown);
  void work(Run& run);
  std::string present() const;
  std::string html() const;

  mutable std::mutex mutex_;  // of what the thread tells
  std::unique_ptr<Run> run_;
  std::thread thread_;
};

}  // namespace poise::app
