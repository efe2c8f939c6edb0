#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "statics/paths/path_measures.hpp"
#include "statics/paths/private/path_pieces.hpp"

namespace poise {

/// A branch as a curve: points, and those between neighbours.
class BranchCurve {
 public:
  BranchCurve(const VariedScene& varied, const PathBranch& branch, const OtherQuantities& others = {})
      : varied_(varied), branch_(branch), reader_(varied, others), pieces_(varied) {}

  std::size_t size() const { return branch_.points.size(); }
  /// Size of the varied number's range, and what a quantity of the mechanism is measured in, SI.
  double range() const { return std::abs(varied_.to() - varied_.from()); }
  double scale_of(const SoughtQuantity& of) const { return 1.0 / of.dimension.per_scale(varied_.scales()); }
  const PathPoint& operator[](std::size_t k) const { return branch_.points[k]; }

  /// At the part t of the way from a point to the next one; empty where the curve cannot be followed there.
  std::optional<PathPoint> between(std::size_t k, double t);
  /// Values of several quantities there, why the first has none in `why`.
  std::vector<double> values(const std::vector<SoughtQuantity>& of, const PathPoint& point, std::string& why);

 private:
  std::optional<PathPoint> between(PathSpot spot, std::size_t k, double t);
  bool is_consistent(const PathPoint& point);
  void prepare(std::size_t k);

  const VariedScene& varied_;
  const PathBranch& branch_;
  PathReader reader_;
  PathPieces pieces_;
  std::size_t prepared_ = static_cast<std::size_t>(-1);
  std::array<std::optional<PathSpot>, 2> spots_;
};

}  // namespace poise
