#pragma once

// Measures by vector mechanics, from the poses of the bodies: for the independent checks, which use none of the phasor
// sums that the mechanism is compiled to. Templates on the type of the poses, BodyPose or PlacedBody of any scalar;
// their definitions are in statics/bodies/body_forces.hpp, and BodyPose<double> is compiled in body_measures.cpp.

#include <string>
#include <string_view>
#include <vector>

#include "model/mechanism.hpp"
#include "model/scene.hpp"

namespace poise {

/// The pose of a body with the direction of its x axis, computed once, for scalars whose sines are dear.
template <class T>
struct PlacedBody {
  PlacedBody() = default;
  explicit PlacedBody(const BodyPose<T>& pose) : origin(pose.origin), angle(pose.angle), along(pose.direction()) {}

  Planar<T> origin{};
  T angle{};
  Planar<T> along{T(1), T(0)};

  const Planar<T>& direction() const { return along; }
  Planar<T> world(const Vec2& local) const { return origin + planar_cast<T>(local) * along; }
};

/// The scalar of a pose.
template <class Pose>
using ScalarOf = decltype(Pose::angle);

/// Value of a measure, rad or m, with the scene's bodies at `poses`, SI, measured from any point of the world; the
/// ground's origin says from which.
template <class Pose>
ScalarOf<Pose> value_of(const Scene& scene, const Measure& measure, const std::vector<Pose>& poses);

/// Loads that correspond to a unit effort (1 N, or 1 N m on an angle) on a measure: `force`, N per unit, and `moment`,
/// N m per unit, on body b at the point b, measured as the poses, their opposites on body a at the point a. Their power
/// is the rate of the measure. A distance of zero has no direction, and no force; of one that may be zero, in balls, it
/// is any vector up to 1 N in each component.
template <class T>
struct UnitEffortOf {
  int body_a = 0, body_b = 0;
  Planar<T> a{}, b{};
  Planar<T> force{};
  T moment{};
};
using UnitEffort = UnitEffortOf<double>;

/// One unit effort, or for a sum one per term.
template <class Pose>
std::vector<UnitEffortOf<ScalarOf<Pose>>> unit_efforts(const Scene& scene, const Measure& measure,
                                                       const std::vector<Pose>& poses);

/// Throws InputError where a rope of the scene passes over a pulley, off which it may come, or where a wheel rolls on a
/// line or a circle, off which it may lift, which `what` does not treat.
void refuse_contacts(const Scene& scene, std::string_view what);

/// Throws InputError naming the first blade of the scene, which `what` ("load paths") do not treat.
void refuse_blades(const Scene& scene, std::string_view what);

/// Where a rope would have to lie on the wrong side of a pulley, so that it does not touch it: that pulley's point;
/// null where it touches all, and of other measures.
const RopeContact* untouched_pulley(const Scene& scene, const Measure& measure,
                                    const std::vector<BodyPose<double>>& poses);

/// In words, the first rope whose rims leave no straight part between two neighbours, so that it has no length: their
/// centres are nearer to each other than the difference of their radii (the sum, where they turn it in opposite ways)
/// times 1 + `slack`. Empty if there is none.
std::string rope_without_length(const Scene& scene, const std::vector<BodyPose<double>>& poses, double slack = 0.0);

}  // namespace poise
