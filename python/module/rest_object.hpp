#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "app/commands/caller.hpp"
#include "python/module/scene_object.hpp"
#include "statics/equilibrium/answer.hpp"
#include "statics/quantities/quantities_at.hpp"

namespace poise::python {

/// A quantity in a scene's units: not a number where it is undefined, and why, in one sentence.
struct NamedValue {
  double value = 0.0;
  std::string unit;
  double in_si = 1.0;  ///< SI value of one unit
  std::string why;
};

/// Where a scene rests, as solve() found it. What is measured there is found when it is first asked for.
class RestObject {
 public:
  RestObject(std::shared_ptr<const SceneObject> scene, std::shared_ptr<const StaticModel> model, SolveOptions options,
             std::optional<double> time, Equilibrium equilibrium);

  const std::shared_ptr<const SceneObject>& scene() const { return scene_; }
  const StaticModel& model() const { return *model_; }
  const SolveOptions& options() const { return options_; }
  const std::optional<double>& time() const { return time_; }
  const Equilibrium& equilibrium() const { return equilibrium_; }
  bool has_position() const;

  /// The value of a quantity (docs/quantities.md). Throws InputError for a name that is none.
  NamedValue value(const std::string& name) const;
  /// What `poise solve` shows.
  app::Outcome outcome(bool wants_pictures) const;

 private:
  const SoughtQuantity& quantity(const std::string& name) const;

  std::shared_ptr<const SceneObject> scene_;
  std::shared_ptr<const StaticModel> model_;
  SolveOptions options_;
  std::optional<double> time_;
  Equilibrium equilibrium_;
  mutable std::mutex mutex_;
  mutable std::optional<Answer> answer_;
  mutable std::optional<RestingPlace> place_;
  mutable std::unordered_map<std::string, SoughtQuantity> quantities_;
};

}  // namespace poise::python
