#pragma once

// Bodies in space with axes, as files of robots have them, and the planar mechanism that they are.
//
// Where all axes of hinges are parallel to one normal n and all slides are perpendicular to it, every body moves in a
// plane of its own that is perpendicular to n. Then only what is seen along n counts: places and axes are projected on
// the plane, and of a body's inertia tensor J about its centre of mass only n^T J n.

#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Dense>

#include "exchange/formats.hpp"

namespace poise {

/// A hinge or a slide. All places and axes are those in the world in the pose in which the file draws the mechanism.
struct SpatialJoint {
  std::string name;
  int line = 0;
  bool slides = false;
  Eigen::Vector3d axis{0.0, 0.0, 1.0};
  Eigen::Vector3d at{0.0, 0.0, 0.0};
  double reference = 0.0;  ///< its value as it is drawn, rad or m
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  double stiffness = 0.0, spring_reference = 0.0;
  double damping = 0.0;
  double friction = 0.0;  ///< constant, of Coulomb's law
  double armature = 0.0;  ///< inertia of what turns with its rate, kg m^2 or kg

  bool is_bare() const;  ///< nothing acts on it
};

struct SpatialBody {
  std::string name;
  int line = 0;
  int parent = -1;  ///< before it in the list; the first body is the ground
  bool is_free = false;
  Eigen::Vector3d at{0.0, 0.0, 0.0};
  double mass = 0.0;
  Eigen::Vector3d center{0.0, 0.0, 0.0};
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  ///< about the centre of mass, along the axes of the world
  /// From the parent on, each carried by those before it; none: it is fixed to its parent, unless it is free.
  std::vector<int> joints{};
  std::vector<std::pair<std::string, Eigen::Vector3d>> points{};
};

/// A place of one body that is a place of another; the bodies may turn about it unless they are fixed to each other.
struct SpatialClosure {
  std::string name;
  int line = 0;
  int a = 0, b = 0;
  Eigen::Vector3d at_a, at_b;
  bool is_fixed = false;
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();  ///< by which b, as it is drawn, has to turn to be fixed
};

/// A line whose length is a sum of joint values, or the way over points of bodies.
struct SpatialTendon {
  std::string name;
  int line = 0;
  std::vector<std::pair<int, double>> terms;            ///< joints with their factors
  std::vector<std::pair<int, Eigen::Vector3d>> points;  ///< of bodies
  double stiffness = 0.0;
  double slack_from = 0.0, slack_to = 0.0;  ///< lengths between which its spring is slack
  double damping = 0.0, friction = 0.0;
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
};

struct SpatialModel {
  std::string title;
  std::string file;
  Eigen::Vector3d gravity{0.0, 0.0, -9.81};
  std::vector<SpatialBody> bodies{SpatialBody{.name = "ground"}};
  std::vector<SpatialJoint> joints;
  std::vector<SpatialClosure> closures;
  std::vector<SpatialTendon> tendons;
  std::vector<std::string> notes;

  /// The limit, or none where it is so far that it means none: 1e6 m or rad.
  static double lower_limit(double value);
  static double upper_limit(double value);
};

/// Throws InputError where the options say what the format, which is in SI, does not leave open.
void expect_si(const std::string& format, const ImportOptions& options);

/// The planar scene. Throws InputError naming the joint that turns or slides out of the plane, and what would leave it.
Imported planar_scene(SpatialModel model);

}  // namespace poise
