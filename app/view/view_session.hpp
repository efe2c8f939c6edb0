#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "app/view/other_equilibria.hpp"
#include "app/view/screen.hpp"
#include "model/parameters.hpp"
#include "statics/tracked_equilibrium.hpp"

namespace poise::app {

/// What `poise view` shows and changes: a scene, the equilibrium it rests in, and what was done before. No part of it
/// knows of HTTP; docs/view.md describes the requests.
class ViewSession {
 public:
  /// Reads the file and settles. Throws InputError.
  explicit ViewSession(std::filesystem::path file);

  /// Carries out a request, and returns the state in JSON; or what is wrong with it, with nothing changed.
  std::string act(const nlohmann::json& request);
  /// The document of the page, with the whole state under "view".
  nlohmann::json page();
  /// {"revision", "file", "searching", "others"}: of the file on disk whether it is as it was read, and the other
  /// equilibria where they are known by now and belong to a later state than `revision`.
  nlohmann::json poll(long revision);
  /// The present state as a report for others.
  std::string report() const;

  const TrackedEquilibrium& tracked() const { return *tracked_; }

 private:
  /// What undo goes back to.
  struct Snapshot {
    std::string text;
    Scene scene;
    std::set<std::string> off;
  };
  enum class Parts { moving, all };

  Scene effective(Scene scene) const;
  void sync();
  void look_for_others();
  std::string present_text() const;
  void expect_parked() const;
  Snapshot snapshot() const { return {text_, scene_, off_}; }
  void remember(Snapshot before);
  void go_back(const std::string& what, std::vector<Snapshot>& from, std::vector<Snapshot>& to);
  Transition take(Scene scene);
  PointRef point_called(const std::string& name) const;
  nlohmann::json shown(const Transition& transition, Parts parts);
  nlohmann::json numbers() const;
  nlohmann::json switches() const;
  nlohmann::json handles() const;
  nlohmann::json hand() const;
  nlohmann::json others_json(const OtherEquilibria::Found& found) const;

  Transition do_drag(const nlohmann::json& request);
  /// Throws InputError where a number follows from an expression.
  void expect_free(const ParameterPlace& place) const;
  Transition do_ground(const nlohmann::json& request);
  Transition do_load(const nlohmann::json& request);
  Transition do_set(const nlohmann::json& request);
  Transition do_switch(const nlohmann::json& request);
  Transition do_text(const std::string& text);
  Transition do_go(const nlohmann::json& request);
  void do_save(const nlohmann::json& request);

  std::filesystem::path file_;
  std::string on_disk_;  ///< text of the file when it was last read or written
  std::string text_;     ///< the text that scene_ was read from; its numbers may have changed since
  Scene scene_;          ///< with all that is switched off
  std::set<std::string> off_;
  std::unique_ptr<TrackedEquilibrium> tracked_;
  std::vector<Snapshot> undo_, redo_;
  std::string saved_text_;            ///< what present_text() gives while nothing has changed since on_disk_
  std::string gesture_;               ///< of the requests that undo takes back together
  bool in_gesture_ = false;           ///< the last request said that it goes on
  long revision_ = 1, searched_ = 0;  ///< of the state, and of that whose other equilibria are looked for
  std::unique_ptr<Screen> screen_;
  OtherEquilibria others_;
};

}  // namespace poise::app
