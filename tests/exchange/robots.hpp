#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "model/scene.hpp"
#include "motion/body_motion.hpp"

namespace poise::test {

/// A chain of 2 to 5 bodies or a tree of them, with pins, slides, pins in slots and welds, one of which may be free,
/// and, where `loops` is not 0, so many pins, welds or bars that close loops. Springs, dampers, stops, constant
/// friction and couplings act on joints, and with `lines` also on sums of joints and between points. All bodies have
/// mass and inertia, all loops are closed at its start, and at least one freedom is left.
struct RobotWish {
  int loops = 0;
  bool lines = false;
  bool free_body = false;
  bool friction = true;
  bool at_zero = false;  ///< starts where pins are at the angle 0 and travels are 0
};
Scene random_robot(std::uint64_t seed, const RobotWish& wish);

/// The poses of the bodies with loops closed from the start.
std::vector<BodyPose<double>> poses_at_start(const Scene& scene);

/// Motions of bodies that are released at rest from the start, without friction.
std::vector<BodyMotion> released(const Scene& scene);

}  // namespace poise::test
