#pragma once

#include <memory>

#include "model/parameters.hpp"
#include "motion/motion_model.hpp"

namespace poise {

class VariedModel;

/// A number of a scene by which motion is differentiated, as it moves geometry, inertia and forces: the scene compiled
/// in dual numbers along it (motion/varied_model.hpp). Copies share that.
class Variation {
 public:
  /// By the number of this row of parameter_table(), per SI unit; the layout of the model must let it vary (lay_out()).
  /// Throws InputError where an expression that follows from it has no derivative.
  Variation(std::shared_ptr<const MotionModel> model, const ParameterPlace& number);

  const MotionModel& model() const { return *model_; }
  const ParameterPlace& number() const { return number_; }
  const VariedModel& compiled() const { return *compiled_; }

 private:
  std::shared_ptr<const MotionModel> model_;
  ParameterPlace number_;
  std::shared_ptr<const VariedModel> compiled_;
};

}  // namespace poise
