#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "statics/model/varied_scene.hpp"
#include "statics/tracking/tracked_equilibrium.hpp"

namespace poise::judge {

/// Where small steps come to: a way to an equilibrium that owes nothing to statics/paths/path.hpp.
struct SmallSteps {
  enum class End {
    arrived,   ///< a stable equilibrium at each step, each near the last
    lost,      ///< the equilibrium ends, turns unstable or singular on the way
    undecided  ///< not stable at the start, or too many or too small steps
  };
  End end = End::undecided;
  double part = 0.0;  ///< of the way, up to which they came
  std::string why;
  BodyPoses poses;  ///< there
};

/// Follows the stable equilibrium at `poses` from one scene to the other, all numbers growing in proportion: Newton
/// from the last point, in steps that move nothing by more than 0.02 rad or mechanism sizes. With care: in shorter
/// ones, in which the equations change so little that they cannot turn singular between.
SmallSteps follow_numbers(const VariedScene& varied, const BodyPoses& poses, bool with_care = false);

/// A mechanism with one freedom: its poses are a curve, which is walked in small steps.
class CurveOfPoses {
 public:
  /// Of the scene, in which the last `held` stops count for nothing, from these poses.
  CurveOfPoses(Scene scene, int held, const BodyPoses& poses);
  /// The loops close there, with one freedom.
  bool is_curve() const { return is_curve_; }
  /// Closures lose rank there, nearly at least: the curve may lead on in several ways.
  bool begins_singular() const;
  double size() const { return model_.scales().length; }

  struct Walked {
    bool passed = false;   ///< the curve leads there, through regular poses that keep the stops
    bool goes_on = false;  ///< it is longer than was walked
    std::string why;
  };
  Walked to(const BodyPoses& poses) const;

  struct Nearest {
    double distance = 0.0;  ///< m, the least to which a point comes while it comes closer all the way
    std::string ended_by;   ///< a stop or a singular pose; empty where it would go away from there
  };
  Nearest nearest(PointRef point, Vec2 place) const;

 private:
  struct Spot {
    std::vector<double> x;
    Eigen::VectorXd tangent;
    double sign = 0.0;  ///< of the determinant of the rows and the tangent
    double weakest = 0.0;
  };
  std::optional<Spot> spot(std::vector<double> x, const Eigen::VectorXd* like) const;
  std::optional<Spot> next(const Spot& here, double h, std::string& why) const;
  Vec2 place_of(const Spot& spot, PointRef point) const;

  StaticModel model_;
  int stops_;
  std::vector<int> rows_;
  std::vector<double> x_;
  bool is_curve_ = false;
};

/// Scaled coordinates of a model where its bodies stand so, loops closed; empty where they do not close near.
std::optional<std::vector<double>> coordinates_at(const StaticModel& model, const BodyPoses& poses);

/// max over bodies of differences of angles, rad, not wrapped, and of places over `size`.
double apart(const BodyPoses& a, const BodyPoses& b, double size);

}  // namespace poise::judge
