#pragma once

#include <map>
#include <string>
#include <vector>

#include "motion/simulate.hpp"

namespace poise::test {

/// Coordinate of the model's layout that is the angle of that body or the travel of that joint. Throws
/// std::out_of_range where there is none.
int coordinate_of(const MotionModel& model, const std::string& name);

/// Places (rad, m) and rates (rad/s, m/s) by name that a motion is to begin with.
struct Release {
  std::map<std::string, double> places{}, rates{};
};
MotionState released(const MotionModel& model, const Release& release, const std::vector<double>* q = nullptr);

/// Closed coordinates (SI) of the equilibrium next to the scene's start.
std::vector<double> equilibrium_of(const MotionModel& model);

/// Simulates and expects completion.
Motion moved(const MotionModel& model, const MotionState& start, double duration, double accuracy = 1e-10);

/// Coordinates (rates) at a node, SI.
std::vector<double> q_at(const Motion& motion, std::size_t node);
std::vector<double> v_at(const Motion& motion, std::size_t node);

/// Place and velocity of a point "body.name" at the end of a motion, m and m/s.
struct PointState {
  Vec2 place, velocity;
};
PointState end_of(const MotionModel& model, const Motion& motion, const std::string& point);

/// A motion read at one time: all coordinates and their rates, SI.
struct Reading {
  std::vector<double> q, v;
};
/// At ascending times.
std::vector<Reading> read_at(const Motion& motion, const std::vector<double>& times);

}  // namespace poise::test
