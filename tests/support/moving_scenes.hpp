#pragma once

#include "model/scene.hpp"

namespace poise::test {

// Made-up mechanisms that between them have everything that acts in motion.

/// A weighty four-bar with a spring and a damper on its coupler, a torsion spring, a torsion damper, dry friction, a
/// dead force and a torque: one freedom.
Scene four_bar_with_everything();

/// The same, its coupler also pushed by a force of constant direction in the frame of the rocker.
Scene four_bar_with_follower();

/// A crank whose pin runs in the slot of a rocker, and a block that slides across the rocker on a spring, damped
/// against the ground: two freedoms, two travels in a frame that turns.
Scene quick_return();

/// The same with a spring, a constant force, a damper and friction upon measures of every kind.
Scene quick_return_with_every_measure();

/// A five-bar on a driven crank and on a carriage that is driven along the ground: one freedom is left.
Scene driven_five_bar();

/// A sun, a planet on an arm and a fixed ring, whose teeth press on bearings with friction: one freedom. For this and
/// the following the friction of joints is that of motion: resisted_by_joints().
Scene rubbing_planet();

/// A beam that swings in a bearing with friction, on which a pinion with friction drives a rack in a guide with
/// friction: two freedoms.
Scene rubbing_rack();

/// Two cams in bearings with friction, one under a roller on a ram in guides, one under that of a lever: two freedoms.
Scene rubbing_rollers();

}  // namespace poise::test
