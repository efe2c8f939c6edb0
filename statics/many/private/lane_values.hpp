#pragma once

#include <memory>
#include <vector>

#include "model/mechanism.hpp"
#include "model/number_list.hpp"
#include "model/recorded.hpp"
#include "statics/model/static_model.hpp"
#include "statics/quantities/numbered_equations.hpp"
#include "statics/quantities/quantity.hpp"

namespace poise {

/// Poses and quantities of a scene at rest, recorded.
class LaneValues {
 public:
  /// `numbers` are those of the list; both outlive this.
  LaneValues(const StaticModel& model, std::shared_ptr<const NumberList> list, const std::vector<Recorded>& numbers,
             std::vector<ActingStop> acting);

  /// At these scaled coordinates.
  void place(const Mechanism<Recorded>& mechanism, const std::vector<Recorded>& x);
  /// x, y, m, and angle of every body but the ground.
  void add_poses(std::vector<Recorded>& out) const;
  /// Adds those of the quantities, SI, that can be recorded, and says which. Others depend on pivots of their own, on
  /// redundant forces, or on more than a place.
  std::vector<char> add(const std::vector<SoughtQuantity>& of, std::vector<Recorded>& out);
  /// Where the pivots of forces are no small part of what they are in the scene as it is.
  const RecordedMask& is_good() const { return good_; }

 private:
  bool find_efforts();

  const StaticModel& model_;
  const std::vector<Recorded>& numbers_;
  NumberedEquations equations_;
  std::vector<Recorded> z_;
  RecordedMask good_{true};
};

}  // namespace poise
