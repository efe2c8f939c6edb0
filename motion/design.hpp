#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "model/scene.hpp"
#include "motion/dyad_chain.hpp"

namespace poise {

struct Interval {
  double min = 0.0, max = 0.0;
};

/// A coordinate of a point, "point.obd.D.x", in its body's frame, that the synthesis chooses from a range, m.
struct DesignVariable {
  std::string path;
  PointRef point;
  bool is_y = false;
  Interval range;
};

/// A jack between two points: its length must not grow by more than `ratio` over the range, and its lever arm
/// |dl/d(drive angle)| must never be less than `lever`, m.
struct Actuator {
  std::string name;
  PointRef a, b;
  double ratio = 0.0;
  double lever = 0.0;
};

/// Dimensions are wanted for the topology of a scene so that, while body `driver` turns about its pin to the ground,
/// a point travels along a straight vertical line and a body stays level.
///
/// Only shape matters while searching: what a candidate does is scaled, turned and shifted (a similarity) until its
/// travel is the wanted one and its mean line vertical, upwards. So two ground pivots may stay where the scene has
/// them, and four numbers need not be searched for.
struct DesignProblem {
  std::string file, title, source;
  Scene scene;  ///< what is not varied is taken from it
  std::vector<DesignVariable> variables;
  int driver = -1;
  Interval from, turn;  ///< where the driver begins, and how far it turns, rad
  PointRef guided;
  double travel = 0.0;       ///< m
  double drift = 0.0;        ///< greatest width of the path across its mean line, m
  int level = -1;            ///< body
  double inclination = 0.0;  ///< its greatest deviation from the middle of its angles, rad
  double transmission =
      0.0;  ///< least angle between the two bodies of a dyad and between one and the other's line, rad
  std::vector<Actuator> actuators;
  double shortest = 0.0, longest = 0.0;  ///< distances of two points on a body that joins others, m
};

/// Reads a design file (TOML; grammar in datasets/lift_design.toml) and its scene. Throws InputError.
DesignProblem read_design(const std::filesystem::path& file);

/// What a set of dimensions does. Lengths in m after the similarity, angles in rad.
struct DesignFacts {
  double gap = 0.0;  ///< by how much dyads fail to close, summed, over their size; all else counts only where it is 0
  double travel = 0.0;
  double drift = 0.0;
  double inclination = 0.0;
  std::vector<double> transmission;  ///< least of each dyad
  struct Stroke {
    double shortest = 0.0, longest = 0.0, least_lever = 0.0;
  };
  std::vector<Stroke> strokes;  ///< of the actuators
  double shortest = 0.0, longest = 0.0;
  double scale = 1.0;   ///< the similarity: lengths times scale,
  double turned = 0.0;  ///< then everything turned by this angle about the ground's origin, rad
};

struct DesignOptions {
  std::uint64_t seed = 1;
  int starts = 200;         ///< at most
  int draws = 400;          ///< random sets of dimensions of which each start takes the best
  int evaluations = 30000;  ///< of each search
  const std::atomic<bool>* interrupt = nullptr;
  std::function<void(int start, double misfit)> progress{};  ///< after each start: the best misfit so far
};

struct DesignResult {
  bool met = false;  ///< all goals
  int starts = 0;    ///< searches made
  long evaluations = 0;
  double misfit = 0.0;         ///< 0 where all goals are met
  std::vector<double> values;  ///< of the variables before the similarity, m; then the driver's from and turn, rad
  std::vector<int> signs;      ///< of the dyads
  DesignFacts facts;
  Scene scene;                  ///< the dimensions found: geometry and start, level and in true size
  double from = 0.0, to = 0.0;  ///< of the driver in that scene, rad
};

/// Judges dimensions by closed-form dyads.
class DesignModel {
 public:
  /// Throws InputError where dyads do not reach a body that the goals name. `problem` must outlive this.
  explicit DesignModel(const DesignProblem& problem);

  const DyadChain& chain() const { return chain_; }
  std::size_t size() const { return problem_.variables.size() + 2; }
  std::vector<double> lower() const;
  std::vector<double> upper() const;

  /// `values` as DesignResult::values, at `positions` angles of the driver spread evenly.
  DesignFacts facts(std::span<const double> values, const std::vector<int>& signs, int positions) const;
  /// 0 where all goals are met, else the sum of log(value / limit) of those missed; far more where the dyads do not
  /// close. All limits are tightened to `part` of what is allowed.
  double misfit(const DesignFacts& facts, double part = 1.0) const;
  /// The scene with these dimensions after the similarity, started at the begin of its range.
  Scene scene_of(std::span<const double> values, const std::vector<int>& signs, const DesignFacts& facts) const;

 private:
  std::vector<Vec2> points_of(std::span<const double> values) const;
  void start_jacks(Scene& scene, const std::vector<Vec2>& points, const std::vector<DyadChain::Pose>& poses,
                   const DesignFacts& facts) const;

  const DesignProblem& problem_;
  DyadChain chain_;
};

/// Searches from random starts, with random signs of the dyads, by SBPLX until all goals are met.
DesignResult design(const DesignProblem& problem, const DesignOptions& options = {});

/// What the general kinematics (motion/kinematics.hpp) say of a design's scene, driven through its range: the loops
/// are closed by Newton's method, nothing is taken from the dyads.
struct DesignCheck {
  bool met = false;        ///< the range is completed, without a singular pose, and all goals are met (travel: to 1e-6)
  std::string why;         ///< what is missed
  DesignFacts facts;       ///< along and across are the world's y and x; scale and turned mean nothing
  double closeness = 0.0;  ///< least closeness to singular (KinematicSample) on the way
};

DesignCheck check_design(const DesignProblem& problem, const DesignResult& result);

/// A scene's geometry as a scene file: ground, bodies with their points, pins, slides, welds, bars and start. Masses,
/// springs and loads of a scene do not fit new dimensions, and are left out.
std::string geometry_text(const Scene& scene);

}  // namespace poise
