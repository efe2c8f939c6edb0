#pragma once

#include <limits>
#include <string>

#include "model/scene.hpp"
#include "model/scene_builder.hpp"

namespace poise::test {

// Scenes whose size is a parameter, built by SceneBuilder, and changes to scenes after they are built, also to such as
// the reader of scene files refuses. All SI, angles from +x; points are named "body.point".

/// The point of that name. Throws std::out_of_range where there is none.
PointRef point(const Scene& scene, const std::string& name);

/// A uniform link of that length: points a = (0, 0), m in the middle and b = (length, 0).
int add_link(Scene& scene, const std::string& name, double length, double mass = 0.0);

void add_link(SceneBuilder& builder, const std::string& name, double length, double mass = 0.0);

/// Joints by the names of their points; the joint's own name is "a.P-b.Q" unless given.
int add_pin(Scene& scene, const std::string& a, const std::string& b, const std::string& name = {});
int add_slide(Scene& scene, const std::string& a, const std::string& b, Vec2 axis, const std::string& name = {});
int add_pin_in_slot(Scene& scene, const std::string& a, const std::string& b, Vec2 axis, const std::string& name = {});
int add_bar(Scene& scene, const std::string& a, const std::string& b, double length, const std::string& name = {});

void add_force(Scene& scene, const std::string& at, Vec2 vector, const std::string& name);
/// Keeps a measure, or angle(b) - angle(a) of two bodies, between the limits.
void add_stop(Scene& scene, const std::string& name, const Measure& on, double min,
              double max = std::numeric_limits<double>::infinity());
void add_stop(Scene& scene, const std::string& name, int a, int b, double min, double max);
void add_torsion_spring(Scene& scene, int a, int b, double stiffness, double free_angle = 0.0);

/// `count` links "1", "2", ... in series from ground.O = (0, 0), pinned end to end.
Scene chain(int count, double length, double mass);

/// The same with its free end pinned at ground.E = (span, 0), guessed along a circular arc below the span.
Scene hanging_chain(int count, double total_length, double total_weight, double span);

/// A scissor of `stages` pairs of crossed arms, each 1 m long and of weight `arm_weight`, on ground.O = (0, 0) and a
/// slot along x, "base"; the load presses on the platform, which it carries the same way, "top". Arms "rise1", "fall1",
/// ... are guessed at the angles theta and pi - theta.
Scene scissor(int stages, double arm_weight, double load, double theta);

/// A lever on a pin "O", level on a stop "foot" under its long arm of 0.5 m; the force "P", 40 N upwards, on its short
/// arm of 0.25 m presses it down.
Scene lever();

/// `windows` four-bar windows side by side, all bars 1 m and 1 kg under gravity 1 m/s^2: posts "post0" ... on
/// ground.O0 = (0, 0), ground.O1 = (1, 0), ... and beams "beam1" ... from post to post.
Scene windows(int count);

/// Equal parallel cranks "0", "1", ... of 1 m a metre apart on ground.A0, ground.A1, ... carry the body "coupler" at
/// coupler.B0, ..., with `load` downwards at coupler.B1. A torque on the first crank holds it at `angle`, where it
/// starts.
Scene parallelogram(int cranks, double angle, double load);

}  // namespace poise::test
