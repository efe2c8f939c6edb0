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

#include "app/view/draft.hpp"
#include "app/view/other_equilibria.hpp"
#include "app/view/page_commands.hpp"
#include "app/view/screen.hpp"
#include "app/view/shown_mechanism.hpp"
#include "model/parameters.hpp"
#include "model/scene_text.hpp"

namespace poise::app {

/// A scene that is no file. Its page can save its text elsewhere, but not to where it came from.
struct SceneInMemory {
  Scene scene;       ///< whose numbers may differ from those of the text
  std::string text;  ///< that it was read from (parse_scene())
  std::string name;  ///< stands for a file in titles and messages, and gives the folder of the files that it names
};

/// An empty sheet on which a mechanism can be drawn.
SceneInMemory new_scene();

/// What `poise view` shows and changes: a scene, the equilibrium it rests in, and what was done before. No part of it
/// knows of HTTP; docs/view.md describes the requests.
class ViewSession {
 public:
  /// Reads the file and settles; begins with an empty sheet where its folder has none of that name. Throws InputError.
  /// `interrupt` ends what takes long.
  explicit ViewSession(std::filesystem::path file, const std::atomic<bool>* interrupt = nullptr);
  /// Settles. Throws InputError, also where the text is not that of the scene.
  explicit ViewSession(SceneInMemory scene, const std::atomic<bool>* interrupt = nullptr);

  /// Carries out a request, and returns the state in JSON; or what is wrong with it, with nothing changed. A request
  /// that changes something must carry the revision of the state that it was made for, and is refused for any other.
  std::string act(const nlohmann::json& request);
  /// The document of the page, with the whole state under "view".
  nlohmann::json page();
  /// {"revision", "file", "company", "searching", "others"}: of the file on disk whether it is as it was read, whether
  /// another program shows it too, and the other equilibria where they are known by now and belong to a later state
  /// than `revision`.
  nlohmann::json poll(long revision);
  /// The present state as a report for others.
  std::string report() const;

  /// Throws InputError of a sketch.
  const TrackedEquilibrium& tracked() const { return now_.shown.at_rest(); }

 private:
  /// What undo goes back to.
  struct Snapshot {
    std::string text;
    Scene scene;
    std::set<std::string> off;
    BodyPoses poses;
  };
  using Snapshots = std::vector<std::shared_ptr<const Snapshot>>;
  /// All that a request may change.
  struct State {
    std::optional<std::string> on_disk;  ///< text of the file when it was last read or written; none of a new one
    std::string text;                    ///< the text that scene was read from; its numbers may have changed since
    Scene scene;                         ///< with all that is switched off
    std::set<std::string> off{};
    ShownMechanism shown;
    Snapshots undo{}, redo{};
    std::string saved_text{};  ///< what present_text() gives while nothing has changed since on_disk
    std::string gesture{};     ///< of the requests that undo takes back together
    bool in_gesture = false;   ///< the last request said that it goes on
    long revision = 1;
    std::shared_ptr<Screen> screen{};
    std::shared_ptr<const SceneText> parsed{};  ///< of a text, in most cases the present one
  };
  enum class Parts { moving, all };

  State opened(const std::string& text, std::optional<Scene> scene);
  void begin();
  void take_draft();
  void expect_file() const;
  std::string line() const;
  std::string solving_line() const;
  bool rests_stably() const;
  bool solve_finds_another() const;
  std::optional<std::string> text_on_disk() const;
  void allow_files_of(const std::string& text);
  Scene read(const std::string& text) const;
  void expect_present(const nlohmann::json& request) const;
  std::string answer_beside(const nlohmann::json& request, const std::string& what);
  std::string answered(const std::string& what, const nlohmann::json& request, nlohmann::json& out);
  Transition carry_out(const std::string& what, const nlohmann::json& request);
  Scene effective(Scene scene) const;
  void sync();
  void write_start(int finer);
  void look_for_others();
  std::string present_text() const;
  void expect_parked() const;
  std::shared_ptr<const Snapshot> snapshot() const;
  void remember(std::shared_ptr<const Snapshot> before);
  void go_back(const std::string& what, Snapshots& from, Snapshots& to);
  Transition take(Scene scene);
  Transition take_shaped(Scene scene, std::optional<double> grain = {});
  PointRef point_called(const std::string& name) const;
  nlohmann::json shown(const Transition& transition, Parts parts);
  nlohmann::json verdict_json() const;
  std::string title() const;
  double size_of_mechanism() const;
  nlohmann::json numbers() const;
  nlohmann::json changed_from(const std::vector<std::optional<double>>& before) const;
  nlohmann::json switches() const;
  nlohmann::json items();
  nlohmann::json sheet() const;
  nlohmann::json position() const;
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
  Transition take_edited(const SceneText& edited, const std::vector<ItemCopy>& copies = {});
  Transition take_moved(const SceneText& moved);
  Transition take_renamed(const SceneText& renamed);
  Transition take_regrouped(const SceneText& regrouped, const std::string& part);
  void return_to(const BodyPoses& poses);
  SceneText whole_text() const;
  Transition do_draw(const nlohmann::json& request);
  Transition do_place(const nlohmann::json& request);
  Transition do_items(const std::string& what, const nlohmann::json& request);
  Transition do_group(const nlohmann::json& request);
  Transition do_go(const nlohmann::json& request);
  Transition do_save(const nlohmann::json& request);

  std::filesystem::path file_;
  bool has_file_ = true;                 ///< otherwise file_ is a name alone
  std::optional<Draft> draft_;           ///< none of what is no file
  std::set<std::string> allowed_files_;  ///< that the scene on disk names, as it names them
  const std::atomic<bool>* interrupt_;
  State now_;
  long searched_ = 0;  ///< revision whose other equilibria are looked for
  OtherEquilibria others_;
  PageCommands commands_;
};

}  // namespace poise::app
