#include "python/module/scene_object.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "model/input_error.hpp"
#include "model/nearest_name.hpp"
#include "model/parameters.hpp"
#include "model/rewritten_scene.hpp"
#include "model/text_file.hpp"
#include "model/time_function.hpp"
#include "python/module/system_object.hpp"

namespace poise::python {
namespace {

// Scenes with other numbers that one remembers: a compiled body takes some 10 kB.
constexpr std::size_t most_kept = 8;
constexpr std::size_t most_bodies_kept = 100;

}  // namespace

SceneObject::SceneObject(std::string text, std::string name, Changes changes, std::shared_ptr<const Scene> as_read,
                         Scene scene)
    : text_(std::move(text)),
      name_(std::move(name)),
      changes_(std::move(changes)),
      as_read_(std::move(as_read)),
      scene_(std::make_shared<const Scene>(std::move(scene))) {}

std::shared_ptr<const SceneObject> SceneObject::load(const std::string& file) {
  // A file's name would end there.
  if (const std::size_t end = file.find('\0'); end != std::string::npos) {
    throw InputError(fmt::format("{}: expected the name of a file, found a NUL behind it", file.substr(0, end)));
  }
  return parse(read_text_file(file), file, {});
}

std::shared_ptr<const SceneObject> SceneObject::parse(std::string text, std::string name, Changes changes) {
  auto as_read = std::make_shared<const Scene>(parse_scene(text, name));
  Scene scene = *as_read;
  for (const auto& [path, value] : changes) set_value(scene, path, value);
  return std::shared_ptr<const SceneObject>(
      new SceneObject(std::move(text), std::move(name), std::move(changes), std::move(as_read), std::move(scene)));
}

std::shared_ptr<const SceneObject> SceneObject::with(const Changes& changes) const {
  if (scene_->bodies.size() > most_bodies_kept) return changed(changes);
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [numbers, scene] : changed_) {
      if (numbers == changes) return scene;
    }
  }
  std::shared_ptr<const SceneObject> out = changed(changes);
  const std::lock_guard lock(mutex_);
  changed_.emplace_front(changes, out);
  if (changed_.size() > most_kept) changed_.pop_back();
  return out;
}

std::shared_ptr<const SceneObject> SceneObject::changed(const Changes& changes) const {
  Changes all = changes_;
  std::vector<std::string> paths;
  for (const auto& [given, value] : changes) {
    const std::string path = path_of(given);
    if (std::find(paths.begin(), paths.end(), path) != paths.end()) {
      throw InputError(fmt::format("{}: {} is given twice; expected one value", name_, path));
    }
    paths.push_back(path);
    const auto before = std::find_if(all.begin(), all.end(), [&](const auto& one) { return one.first == path; });
    if (before != all.end()) all.erase(before);
    all.emplace_back(path, value);
  }
  Scene scene = *as_read_;
  for (const auto& [path, value] : all) set_value(scene, path, value);
  return std::shared_ptr<const SceneObject>(new SceneObject(text_, name_, std::move(all), as_read_, std::move(scene)));
}

Scene SceneObject::without(const std::vector<std::string>& paths) const {
  Scene out = *as_read_;
  for (const auto& [path, value] : changes_) {
    if (std::find(paths.begin(), paths.end(), path) == paths.end()) set_value(out, path, value);
  }
  return out;
}

std::string SceneObject::path_of(const std::string& name) const {
  if (find_parameter(*scene_, name)) return name;
  std::vector<std::string> all, ending;
  for (const ParameterRow& row : parameter_table(*scene_)) {
    all.push_back(row.path.text());
    const std::string& path = all.back();
    // Guesses have the names of what they guess.
    if (path.ends_with("." + name) && row.place.owner != Owner::start) ending.push_back(path);
  }
  if (ending.size() == 1) return ending.front();
  if (ending.empty()) {
    throw InputError(fmt::format("{}: expected a number of the scene, found \"{}\"{}", name_, name,
                                 did_you_mean_or_list(name, all)));
  }
  constexpr std::size_t most_shown = 6;
  const auto end = ending.begin() + static_cast<std::ptrdiff_t>(std::min(ending.size(), most_shown));
  throw InputError(fmt::format("{}: \"{}\" may be {}{}; expected one of these in full", name_, name,
                               fmt::join(ending.begin(), end, " or "), ending.size() > most_shown ? " or others" : ""));
}

std::vector<std::string> SceneObject::settings() const {
  std::vector<std::string> out;
  for (const auto& [path, value] : changes_) out.push_back(fmt::format("{}={}", path, value));
  return out;
}

std::string SceneObject::written() const { return rewritten_scene(text_, name_, *scene_); }

std::shared_ptr<const StaticModel> SceneObject::model() const {
  const std::lock_guard lock(mutex_);
  if (!model_) model_ = std::make_shared<const StaticModel>(at_time(Scene(*scene_), 0.0));
  return model_;
}

std::shared_ptr<SystemObject> SceneObject::system() const {
  std::shared_ptr<const StaticModel> compiled = model();
  const std::lock_guard lock(mutex_);
  if (!system_) system_ = std::make_shared<SystemObject>(std::move(compiled), std::vector<TouchedLimit>());
  return system_;
}

}  // namespace poise::python
