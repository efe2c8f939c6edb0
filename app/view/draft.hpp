#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "app/view/held_file.hpp"

namespace poise::app {

/// What was drawn and is not saved stands beside the scene's file, in FILE.draft, so that it is not lost with the
/// program. Of programs that show one file each has a draft of its own, and leaves those alone that others hold.
class Draft {
 public:
  explicit Draft(std::filesystem::path scene) : scene_(std::move(scene)), shown_(scene_) {}

  /// Drafts of programs that have ended.
  std::vector<std::filesystem::path> left_behind() const;
  /// One of those, with its text, is that of this program from now on.
  void take_over(const std::filesystem::path& file, const std::string& text);
  /// What is shown began with a draft that was left behind.
  bool is_taken_over() const { return taken_over_; }

  /// Writes the text. A folder that cannot be written to has no draft.
  void keep(const std::string& text);
  void remove();

  /// Whether another program shows the scene's file too.
  bool has_company();

 private:
  std::vector<std::filesystem::path> possible_files() const;

  std::filesystem::path scene_;
  HeldFile shown_;              // the scene's file
  std::string text_;            // of the draft; empty where there is none
  std::filesystem::path file_;  // where that stands
  HeldFile held_;               // the same
  bool taken_over_ = false;
};

}  // namespace poise::app
