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

/// A coordinate of a point, "point.obd.D.x", in its body's frame, that the synthesis varies within a range, m.
struct DesignVariable {
  std::string path;
  PointRef point;
  bool is_y = false;
  Interval range;
};

/// A jack between two points: the ratio of its longest to its shortest length over the range must not exceed `ratio`,
/// and its lever arm |dl/d(drive angle)| must not be less than `lever`, m.
struct Actuator {
  std::string name;
  PointRef a, b;
  double ratio = 0.0;
  double lever = 0.0;
};

/// Dimensional synthesis: dimensions for the topology of a scene such that, while body `driver` turns about its pin to
/// the ground, a point travels along a straight vertical line and a body stays level.
///
/// The search needs the shape only: a candidate is scaled, turned and shifted (a similarity) so that its travel is the
/// required one and its mean line vertical, upwards. So two ground pivots can be fixed, which saves four variables.
struct DesignProblem {
  std::string file, title, source;
  Scene scene;  ///< gives everything that is not varied
  std::vector<DesignVariable> variables;
  int driver = -1;
  Interval from, turn;  ///< the driver's first angle, and the angle it turns, rad
  PointRef guided;
  double travel = 0.0;        ///< m
  double drift = 0.0;         ///< limit on the width of the path across its mean line, m
  int level = -1;             ///< body
  double inclination = 0.0;   ///< limit on its deviation from the middle of its angles, rad
  double transmission = 0.0;  ///< limit on the transmission angle: between the two bodies of a dyad, modulo pi, rad
  std::vector<Actuator> actuators;
  double shortest = 0.0, longest = 0.0;  ///< limits on distances of two joint points of a body, m
};

/// Reads a design file (TOML; grammar in datasets/lift_design.toml) and its scene. Throws InputError.
DesignProblem read_design(const std::filesystem::path& file);

/// Properties of a set of dimensions. Lengths in m after the similarity, angles in rad.
struct DesignFacts {
  double gap = 0.0;  ///< sum of the gaps of dyads that do not close, over their size; all else is valid only if it is 0
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
  int draws = 400;          ///< random sets of dimensions, of which each start takes the best
  int evaluations = 30000;  ///< of each search
  const std::atomic<bool>* interrupt = nullptr;
  std::function<void(int start, double misfit)> progress{};  ///< after each start: the best misfit so far
};

struct DesignResult {
  bool met = false;  ///< all goals
  int starts = 0;    ///< searches made
  long evaluations = 0;
  double misfit = 0.0;         ///< 0 if all goals are met
  std::vector<double> values;  ///< of the variables before the similarity, m; then the driver's from and turn, rad
  std::vector<int> signs;      ///< of the dyads
  DesignFacts facts;
  Scene scene;                  ///< the dimensions found: geometry and start, level and in true size
  double from = 0.0, to = 0.0;  ///< of the driver in that scene, rad
};

/// Evaluates dimensions by closed-form dyads.
class DesignModel {
 public:
  /// Throws InputError if dyads do not reach a body that the goals name. `problem` must outlive this.
  explicit DesignModel(const DesignProblem& problem);

  const DyadChain& chain() const { return chain_; }
  std::size_t size() const { return problem_.variables.size() + 2; }
  std::vector<double> lower() const;
  std::vector<double> upper() const;

  /// `values` as DesignResult::values, at `positions` angles of the driver spread evenly.
  DesignFacts facts(std::span<const double> values, const std::vector<int>& signs, int positions) const;
  /// 0 if all goals are met, otherwise the sum of log(value / limit) of those missed; much more if the dyads do not
  /// close. All limits are tightened to the share `part`.
  double misfit(const DesignFacts& facts, double part = 1.0) const;
  /// The scene with these dimensions after the similarity, started at the beginning of its range.
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

/// Independent check of a design by the general kinematics (motion/kinematics.hpp), driven through its range: the loops
/// are closed by Newton's method, without the dyads.
struct DesignCheck {
  bool met = false;        ///< the range is completed without a singular pose, and all goals are met (travel: to 1e-6)
  std::string why;         ///< the goal that is missed
  DesignFacts facts;       ///< along and across are the world's y and x; scale and turned are unused
  double closeness = 0.0;  ///< least closeness to singular (KinematicSample) on the way
};

DesignCheck check_design(const DesignProblem& problem, const DesignResult& result);

/// A scene's geometry as a scene file: ground, bodies with their points, pins, slides, welds, bars and start. Masses,
/// springs and loads, which do not fit new dimensions, are left out.
std::string geometry_text(const Scene& scene);

}  // namespace poise
