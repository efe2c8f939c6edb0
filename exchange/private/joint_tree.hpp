#pragma once

#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "exchange/formats.hpp"

namespace poise {

/// A joint value of the tree: the angle by which a body is turned from its parent, counter-clockwise, or a travel.
struct TreeCoordinate {
  std::string name;
  bool slides = false;
  double value = 0.0;  ///< in the pose, rad or m
  /// In the frame of the child, as it stands in the pose: where it turns, and along what it slides.
  Vec2 at{}, axis{};
};

/// How a body hangs on the tree.
struct TreeBranch {
  int parent = -1;
  int joint = -1;                ///< of the scene; none of a body that is free
  bool is_reversed = false;      ///< the body is the first one of the joint
  std::vector<int> coordinates;  ///< from the parent on; none: it is welded; of a free body x, y and the angle
  Vec2 at{};                     ///< its origin in the frame of its parent, in the pose
  double angle = 0.0;            ///< its angle from that of its parent, in the pose
};

/// A sum of joint values and a constant.
struct SumOfCoordinates {
  std::vector<std::pair<int, double>> terms;
  double constant = 0.0;
};

/// The joints of a scene as a tree of bodies that grows from the ground, and the joints that close loops in it. Welds,
/// slides and pins in slots are in the tree before pins, for the formats close loops by pins. Bodies that no joints tie
/// to the ground are free.
class JointTree {
 public:
  JointTree(const Scene& scene, const std::vector<BodyPose<double>>& poses);

  const std::vector<int>& order() const { return order_; }  ///< bodies, each behind its parent, the ground first
  const TreeBranch& branch(int body) const { return branches_[static_cast<std::size_t>(body)]; }
  const std::vector<TreeCoordinate>& coordinates() const { return coordinates_; }
  const std::vector<int>& closures() const { return closures_; }  ///< joints of the scene, bars left out

  /// What measures angles and travels of the tree.
  std::optional<SumOfCoordinates> linear(const Measure& measure) const;

 private:
  void grow(const Scene& scene);
  void hang(const Scene& scene, int body, int parent, int joint);
  void set_free(const std::string& name, int body);
  int add_coordinate(std::string name, bool slides, double value, Vec2 at, Vec2 axis);
  /// Adds factor times the angle of a body.
  void add_angle(int body, double factor, std::vector<double>& shares, double& constant) const;
  bool add_measure(const Measure& measure, double factor, std::vector<double>& shares, double& constant) const;

  const std::vector<BodyPose<double>>& poses_;
  std::vector<TreeBranch> branches_;
  std::vector<TreeCoordinate> coordinates_;
  std::vector<int> order_, closures_;
  std::vector<int> travel_of_;  ///< of the joints of the scene: coordinate, or -1
};

/// What acts on one coordinate.
struct CoordinateEffects {
  double stiffness = 0.0, free_value = 0.0;
  double damping = 0.0, friction = 0.0;
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();

  void add_spring(double k, double at);
};

/// What acts on a sum of coordinates, or on a distance.
struct LineEffects {
  std::string item;  ///< `spring "return"`, for messages
  std::string name;
  int line = 0;
  SumOfCoordinates sum{};
  std::vector<PointRef> points{};  ///< of a distance, or of a way over more points
  double stiffness = 0.0, slack_from = 0.0, slack_to = 0.0;
  double damping = 0.0, friction = 0.0;
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  std::optional<double> held{};  ///< the value that it keeps
};

struct TreeEffects {
  std::vector<CoordinateEffects> on_coordinates;
  std::vector<LineEffects> on_lines;
};

/// Springs, dampers, friction, stops, bars and couplings of a scene. Throws InputError naming what `format`, "MJCF",
/// does not have: loads, drives, and laws and measures of other kinds.
TreeEffects effects_on(const JointTree& tree, const Scene& scene, const std::string& format);

/// The same number with as few digits as it is read back from.
std::string shortest(double value);
/// The numbers of a place or a direction in space: the x axis of the scene is x, y is z.
std::string in_space(Vec2 v);
/// Counter-clockwise in the plane of the scene.
inline constexpr std::string_view normal_in_space = "0 -1 0";

}  // namespace poise
