#include "python/module/rest_object.hpp"

#include <limits>
#include <utility>

#include <fmt/format.h>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/commands/solve.hpp"
#include "app/results/statics/quantities.hpp"
#include "model/input_error.hpp"

namespace poise::python {

RestObject::RestObject(std::shared_ptr<const SceneObject> scene, std::shared_ptr<const StaticModel> model,
                       SolveOptions options, std::optional<double> time, Equilibrium equilibrium)
    : scene_(std::move(scene)),
      model_(std::move(model)),
      options_(options),
      time_(time),
      equilibrium_(std::move(equilibrium)) {
  options_.interrupt = nullptr;
}

bool RestObject::has_position() const { return equilibrium_.found() || equilibrium_.status == Status::checked; }

const SoughtQuantity& RestObject::quantity(const std::string& name) const {
  const auto known = quantities_.find(name);
  if (known != quantities_.end()) return known->second;
  return quantities_.emplace(name, find_quantity(model_->scene(), name)).first->second;
}

NamedValue RestObject::value(const std::string& name) const {
  const std::lock_guard lock(mutex_);
  const SoughtQuantity& of = quantity(name);
  const Units& units = model_->scene().units;
  NamedValue out{std::numeric_limits<double>::quiet_NaN(), of.dimension.unit_name(units), of.dimension.unit(units), ""};
  if (of.is_over_path() || of.has(SoughtQuantity::Kind::load_at_fold)) {
    throw InputError(fmt::format("{}: it belongs to a path, not to a position; expected another quantity", name));
  }
  if (!has_position()) {
    out.why = "no equilibrium was found";
    return out;
  }
  if (!place_) {
    place_ = resting_place(*model_, equilibrium_.x, equilibrium_.certificate.active_stops, -1, app::other_quantity);
  }
  const QuantityValue value = quantity_values(*place_, {of}).front();
  out.why = value.why;
  if (value.why.empty()) out.value = value.value / out.in_si;
  return out;
}

app::Outcome RestObject::outcome(bool wants_pictures) const {
  const std::lock_guard lock(mutex_);
  if (equilibrium_.x.empty()) {  // its loops do not close
    app::Outcome none;
    none.code = app::not_solved;
    none.result.title = model_->scene().title;
    none.result.verdict = app::bad(equilibrium_.why);
    return none;
  }
  if (!answer_) answer_ = measure(*model_, equilibrium_);
  app::SolveOutcome found =
      app::outcome_of(*model_, *answer_, scene_->settings(), app::read_shown_in_position({}, model_->scene()),
                      wants_pictures, wants_pictures);
  app::Outcome out;
  out.code = found.is_solved ? 0 : 1;
  out.result = std::move(found.result);
  out.pictures = std::move(found.pictures);
  std::vector<std::string> words = {"solve", scene_->name()};
  for (const std::string& setting : scene_->settings()) {
    words.emplace_back("--set");
    words.push_back(setting);
  }
  out.origin = {"solve", app::line_of(words)};
  return out;
}

}  // namespace poise::python
