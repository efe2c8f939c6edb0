#pragma once

#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "model/scene.hpp"
#include "statics/model/static_model.hpp"

namespace poise::python {

class SystemObject;

/// A scene as Python holds it: the text that it was read from, with numbers changed since. It never changes, so that
/// several threads may use one.
class SceneObject {
 public:
  using Changes = std::vector<std::pair<std::string, double>>;

  /// Reads a file. Throws InputError.
  static std::shared_ptr<const SceneObject> load(const std::string& file);
  /// Reads a text; `name` takes the place of the file name in messages, and files that the scene names are looked for
  /// beside it. Throws InputError.
  static std::shared_ptr<const SceneObject> parse(std::string text, std::string name, Changes changes);

  /// The scene with more numbers changed, each in the scene's units, by its path or by a name that only one path has
  /// (path_of()). Small scenes that were last asked for are kept, with what is compiled of them. Throws InputError.
  std::shared_ptr<const SceneObject> with(const Changes& changes) const;

  /// The path of a number: `name` itself, or the one that ends with it behind a point: "P" is "load.P". Throws
  /// InputError with the nearest paths where there is none, or several.
  std::string path_of(const std::string& name) const;

  const std::string& name() const { return name_; }
  const std::string& text() const { return text_; }
  const Changes& changes() const { return changes_; }
  /// The changes as --set has them, "load.P=25".
  std::vector<std::string> settings() const;
  const std::shared_ptr<const Scene>& scene() const { return scene_; }
  /// As it was read, without changes: a force that one of them made zero has its direction there.
  const std::shared_ptr<const Scene>& as_read() const { return as_read_; }
  /// With the changes but for those of these numbers, which are to have other values.
  Scene without(const std::vector<std::string>& paths) const;
  /// The scene as its file would be with the changed numbers written in.
  std::string written() const;
  /// Compiled for statics at the first call. Throws InputError.
  std::shared_ptr<const StaticModel> model() const;
  /// Its equations with all stops free, made at the first call. Throws InputError.
  std::shared_ptr<SystemObject> system() const;

 private:
  SceneObject(std::string text, std::string name, Changes changes, std::shared_ptr<const Scene> as_read, Scene scene);
  std::shared_ptr<const SceneObject> changed(const Changes& changes) const;

  std::string text_, name_;
  Changes changes_;
  std::shared_ptr<const Scene> as_read_, scene_;
  mutable std::mutex mutex_;
  mutable std::shared_ptr<const StaticModel> model_;
  mutable std::shared_ptr<SystemObject> system_;
  mutable std::deque<std::pair<Changes, std::shared_ptr<const SceneObject>>> changed_;  // the newest in front
};

}  // namespace poise::python
