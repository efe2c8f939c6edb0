#pragma once

// Scenes in dual numbers, along one of their numbers.

#include <cstddef>
#include <memory>
#include <vector>

#include <ceres/jet.h>

#include "model/inertia.hpp"
#include "model/mechanism.hpp"
#include "model/number_list.hpp"
#include "model/numbers.hpp"
#include "motion/motion_model.hpp"

namespace poise {

/// All numbers of a scene as dual numbers, whose derivatives are those by one of them.
class NumbersAlong {
 public:
  using Dual = ceres::Jet<double, 1>;

  /// Derivatives are by the number of this row of parameter_table(), per SI unit, of a scene in these scales. Joints'
  /// friction and all that follows from named
  /// numbers change with it. Throws InputError where an expression that follows from it has no derivative.
  NumbersAlong(const Scene& scene, const ParameterPlace& number, const Scales& scales);

  /// The scene whose items Numbers::term() takes.
  const Scene& scene() const { return list_.scene(); }
  Numbers<Dual> numbers() const { return {list_, values_.data()}; }

 private:
  NumberList list_;
  std::vector<Dual> values_;
};

/// A scene compiled for motion in dual numbers, whose derivatives are those by one of its numbers: exact, at fixed
/// coordinates, rates and accelerations.
class VariedModel {
 public:
  using Dual = NumbersAlong::Dual;

  /// By the number of this row of parameter_table(), per SI unit; the layout of the model must let it vary (lay_out()).
  /// Throws InputError as NumbersAlong does.
  VariedModel(const MotionModel& model, const ParameterPlace& number);

  /// In the units of the scaled scene.
  const Scene& scene() const { return along_->scene(); }
  Numbers<Dual> numbers() const { return along_->numbers(); }
  const Mechanism<Dual>& mechanism() const { return *mechanism_; }
  const Inertia<Dual>& inertia() const { return *inertia_; }
  /// A measure of scene(); of that of a stop, of index `stop`, with the numbers of its coupling.
  CompiledMeasure<Dual> measure(const Measure& on, int stop = -1) const;
  /// The derivative by the number of what read(configuration) gives of such a measure, at the coordinates q of the
  /// scaled scene.
  template <class Read>
  double derivative(const CompiledMeasure<Dual>& on, const double* q, Read read) const {
    const Phasors<Dual>& phasors = mechanism_->phasors();
    const std::vector<Dual> at(q, q + phasors.coordinates());
    std::vector<Planar<Dual>> pose(static_cast<std::size_t>(phasors.pose_size() + on.scratch_size()));
    phasors.place(at.data(), pose.data());
    return read(Configuration<Dual>{phasors, pose.data(), pose.data() + phasors.pose_size()}).v[0];
  }

 private:
  std::shared_ptr<const NumbersAlong> along_;
  std::shared_ptr<const Mechanism<Dual>> mechanism_;
  std::shared_ptr<const Inertia<Dual>> inertia_;
};

}  // namespace poise
