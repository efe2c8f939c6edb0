#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "app/draw/figure.hpp"
#include "app/present/document.hpp"
#include "app/result/result.hpp"
#include "model/scene.hpp"

namespace poise::app {

/// What a command has drawn.
struct Pictures {
  std::string svg{};              ///< for --svg; empty: none
  std::vector<Figure> figures{};  ///< for --html
};

/// What a command leaves with the program that called it.
struct Outcome {
  int code = 0;  ///< exit code: 0 solved and confirmed, 1 not
  Result result{};
  Pictures pictures{};    ///< none where the work was interrupted
  std::string written{};  ///< the scene or experiment that was found, as its file would be; empty: none
  PageOrigin origin{};
};

/// A program that runs a command within itself. It gives what the command would read, and takes what it would print and
/// write to files.
struct Caller {
  std::shared_ptr<const Scene> scene{};                      ///< in place of the file SCENE; null: that is read
  bool wants_pictures = false;                               ///< they may take longer than the work
  bool wants_svg = true;                                     ///< of these also the one for files
  std::function<void(const std::string& doing)> listener{};  ///< told what is being done, by any thread
  std::atomic<bool> interrupt = false;                       ///< raised by the caller to stop the work
  Outcome outcome{};
};

}  // namespace poise::app
