#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "app/view/served_view.hpp"

namespace poise::app {

/// The live page of `poise view` beside what else a program does, for a notebook, say: it is served in a thread of its
/// own. A program may have several. Nothing is printed, opened or done to the program's signals.
///
///   BackgroundView view(std::filesystem::path("toggle_clamp.toml"), {.frame_origin = "http://localhost:8888"});
///   show(fmt::format("<iframe src=\"{}\"></iframe>", view.address()));
class BackgroundView {
 public:
  /// Reads the scene and settles before it returns. Throws InputError: for the scene, for a port that cannot be had
  /// (naming --port), for what is no origin (naming --frame-origin).
  explicit BackgroundView(ViewedScene scene, const Listening& listening = {});
  /// stop().
  ~BackgroundView();
  BackgroundView(const BackgroundView&) = delete;
  BackgroundView& operator=(const BackgroundView&) = delete;

  /// "http://127.0.0.1:PORT/TOKEN/", also when it has stopped. Whoever knows it can change the mechanism, and save it
  /// where the scene is a file.
  const std::string& address() const { return address_; }
  /// Whether the page is answered.
  bool runs() const { return runs_; }
  /// Ends the page: what is being computed is interrupted, the thread joined, the port given back. Any thread may call
  /// it, any number of times, but none that holds a lock for which that computation waits.
  void stop();

 private:
  void serve();

  std::atomic<bool> ends_ = false;
  std::atomic<bool> runs_ = true;
  std::unique_ptr<ServedView> view_;
  std::string address_;
  std::mutex stopping_;
  std::thread thread_;
};

}  // namespace poise::app
