#pragma once

#include <vector>

#include "model/layout.hpp"
#include "model/mechanism.hpp"
#include "motion/motion_model.hpp"

namespace poise {

/// Motion of a body in the world: the pose of its frame, and its first and second time derivatives. SI.
struct BodyMotion {
  BodyPose<double> pose;
  Vec2 velocity{};                    ///< of the origin, m/s
  double rate = 0.0;                  ///< rad/s
  Vec2 acceleration{};                ///< of the origin, m/s^2
  double angular_acceleration = 0.0;  ///< rad/s^2

  /// Velocity of a point given in the body's frame, m/s:  v + i w r.
  Vec2 velocity_of(const Vec2& local) const { return velocity + rate * quarter_turn(local * unit(pose.angle)); }
  /// Velocity of the body's material point at a point of the world, m/s.
  Vec2 velocity_at(const Vec2& place) const { return velocity + rate * quarter_turn(place - pose.origin); }
  /// Acceleration of a point given in the body's frame, m/s^2:  a + (i alpha - w^2) r.
  Vec2 acceleration_of(const Vec2& local) const {
    const Vec2 r = local * unit(pose.angle);
    return acceleration + angular_acceleration * quarter_turn(r) - (rate * rate) * r;
  }
};

/// Motions of all bodies and then of all bars, from scaled coordinates x of the model, their rates v (per s) and
/// accelerations a (per s^2): the arms of the spanning tree differentiated in time. Dropped coordinates are constant.
std::vector<BodyMotion> body_motions(const MotionModel& model, const std::vector<double>& x,
                                     const std::vector<double>& v, const std::vector<double>& a);

/// The poses of `motions`.
std::vector<BodyPose<double>> poses_of(const std::vector<BodyMotion>& motions);

/// Rate of a measure of moving bodies, rad/s or m/s; 0 for the distance of points that coincide.
double rate_of(const Scene& scene, const std::vector<BodyMotion>& motions, const Measure& measure);

}  // namespace poise
