#include "motion/sensitivity_columns.hpp"

#include <utility>
#include <variant>

namespace poise {
namespace {

bool switches_over(const Scene& scene, const Influence& influence) {
  if (influence.body >= 0 || influence.moves() || influence.force.of != ForceNumber::Of::element) return false;
  const Element& element = scene.elements[static_cast<std::size_t>(influence.force.item)];
  const auto* const friction = std::get_if<DryFriction>(&element.law);
  return friction != nullptr && friction->width > 0;
}

}  // namespace

SensitivityColumns::SensitivityColumns(const MotionModel& model, const MotionOptions& options,
                                       std::vector<int> independent)
    : options_(options),
      independent_(std::move(independent)),
      unit_(static_cast<std::size_t>(model.mechanism().coordinates()), 1.0),
      count_(options.sensitivities ? column_of(options.influences.size()) : 0) {
  for (auto i = static_cast<std::size_t>(model.layout().angles); i < unit_.size(); ++i) {
    unit_[i] = model.scales().length;
  }
  for (int c = options.accurate_sensitivities ? 0 : 2 * freedoms(); c < count_; ++c) {
    if (options.accurate_sensitivities) {
      that_switch_.push_back(c);
      continue;
    }
    const auto influence = static_cast<std::size_t>(influence_of(c));
    if (switches_over(model.scene(), options.influences[influence])) that_switch_.push_back(c);
  }
}

int SensitivityColumns::variation_of(std::size_t column) const {
  const int influence = influence_of(static_cast<int>(column));
  return influence >= 0 ? options_.influences[static_cast<std::size_t>(influence)].variation : -1;
}

}  // namespace poise
