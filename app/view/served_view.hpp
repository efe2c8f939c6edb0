#pragma once

#include <atomic>
#include <filesystem>
#include <string>
#include <variant>

#include "app/view/server.hpp"
#include "app/view/view_session.hpp"

namespace poise::app {

/// What is shown: the path of a scene's file, or a scene that is no file.
using ViewedScene = std::variant<std::filesystem::path, SceneInMemory>;

/// The live page of a scene at an address of this machine: a ViewSession that a LocalServer gives to a browser.
class ServedView {
 public:
  /// Listens, reads the scene and settles. Throws InputError. `interrupt` ends what takes long, also in run().
  ServedView(ViewedScene scene, const Listening& listening, const std::atomic<bool>& interrupt);
  ServedView(const ServedView&) = delete;
  ServedView& operator=(const ServedView&) = delete;

  /// "http://127.0.0.1:PORT/TOKEN/".
  const std::string& address() const { return server_.address(); }
  /// Answers the page, in the calling thread, until `interrupt` is raised.
  void run();

 private:
  const std::atomic<bool>& interrupt_;
  LocalServer server_;  // first, as a port that cannot be had is noticed before the mechanism has settled
  ViewSession session_;
};

}  // namespace poise::app
