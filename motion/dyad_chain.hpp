#pragma once

#include <span>
#include <string>
#include <vector>

#include "model/scene.hpp"

namespace poise {

/// Two bodies pinned to each other, and each to a body whose pose is known: an Assur group that closes by the
/// intersection of two circles. `sign` +1: the pin between them lies to the left of the line from the first one's known
/// pin to the second one's.
struct Dyad {
  std::string joint;  ///< name of the pin between them
  int first = -1, second = -1;
  PointRef first_known, second_known;    ///< points of known bodies
  PointRef first_anchor, second_anchor;  ///< points of the two bodies that lie there
  PointRef first_tip, second_tip;        ///< their common pin
};

/// Closed-form kinematics of a driven body, pinned to the ground, and a sequence of dyads: no iteration, no allocation,
/// about 30 ns a dyad.
class DyadChain {
 public:
  struct Pose {
    Vec2 origin{};
    Vec2 direction{1.0, 0.0};  ///< exp(i angle)

    Vec2 world(Vec2 local) const { return origin + local * direction; }
  };

  /// Finds dyads among the pins of the scene until all bodies `needed` are placed. Throws InputError if they are not,
  /// or if the driver is not pinned to the ground.
  DyadChain(const Scene& scene, int driver, const std::vector<int>& needed);

  const std::vector<Dyad>& dyads() const { return dyads_; }
  /// Index of a point in the list of all points of the scene, body by body.
  std::size_t slot(PointRef p) const { return first_slot_[p.body] + static_cast<std::size_t>(p.point); }
  std::size_t slots() const { return first_slot_.back(); }
  bool places(int body) const { return placed_[body]; }

  /// Places bodies with the driver at `angle`, rad. `points`: local coordinates of all points, by slot; one sign for
  /// each dyad; one pose for each body of the scene. cosines (one for each dyad) become the cosine of the angle
  /// between its two bodies at their pin. Returns the sum of the gaps of the dyads over their lengths: 0 if all close.
  /// The bodies of a dyad that does not close point towards each other.
  double place(std::span<const Vec2> points, double angle, std::span<const int> signs, std::span<Pose> poses,
               std::span<double> cosines) const;

 private:
  std::vector<Dyad> dyads_;
  std::vector<std::size_t> first_slot_;
  std::vector<bool> placed_;
  int driver_;
  PointRef pivot_, pivot_anchor_;
};

}  // namespace poise
