#pragma once

#include <atomic>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "model/scene.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/equilibrium/settle.hpp"
#include "statics/model/readings.hpp"
#include "statics/model/static_model.hpp"

namespace poise {

class DraggedPoint;

/// Where all bodies stand, SI.
using BodyPoses = std::vector<BodyPose<double>>;

/// How a mechanism came from one position to the next.
struct Transition {
  enum class Kind {
    none,      ///< it rests where it did
    followed,  ///< along a curve of equilibria, and no fold was crossed; a dragged point along its way
    snapped,   ///< followed to a fold, from where it moved to another equilibrium, which was followed further
    settled,   ///< nothing led there without a jump: released where it was, it moved to where it rests
    blocked    ///< a dragged point can follow no further; it was taken as far as it can
  };
  Kind kind = Kind::none;
  std::string why;                  ///< one sentence; empty where it was simply followed
  std::vector<std::string> passed;  ///< what happened on the way: `stop "open" comes off`, in words
  /// A snap or settling has the positions that it passes with heavy damping, from where it leaves to where it rests.
  /// They are no equilibria.
  struct Course {
    std::string why;  ///< one sentence
    std::vector<BodyPoses> poses;
  };
  std::vector<Course> courses;
  /// A drag that its DragLimits ended on the way: the same drag once more goes on from here.
  bool unfinished = false;
  int proved_steps = 0;  ///< of a drag: how many steps were tried with a proof each
};

/// How much work one drag may do. Work is counted, so that no clock decides where a point comes to.
struct DragLimits {
  int proved_steps = std::numeric_limits<int>::max();
  int settling_steps = SettleOptions{}.steps;  ///< of a jump to another equilibrium; 0: none without a fold
  /// What is nearer than this to where the point should come is there, mechanism sizes: beside the end of its reach
  /// ever shorter steps lead nearer.
  double near_enough = 0.0;
};

/// "none", "followed", ...
std::string to_string(Transition::Kind kind);

struct TrackedOptions {
  CertificateOptions certificate{.products = 1e7};  ///< somebody waits for each answer
  const std::atomic<bool>* interrupt = nullptr;
};

/// An equilibrium that is followed while numbers of its scene change, or while a hand drags a point of it.
///
/// A change of numbers is a path from the scene before to the scene after, all numbers growing in proportion
/// (VariedScene), which is followed as statics/paths/path.hpp does: with every fold, stop and one-way spring on the
/// way. The mechanism moves to another equilibrium only where the one that it rests in ends or loses its stability (a
/// fold, a branch point), and where no path leads on.
///
/// A hand holds a point P where it is, in the directions in which it can move: with t the tangent of its way where it
/// can only move along a curve, the measure t . P; where it can move in an area, both coordinates. That is a stop with
/// equal limits, called hand, and what it carries is the force of the hand: an equilibrium as any other, which is
/// proved as such. To drag P to a place T the closest position that is connected with the present one is sought, by
/// steps along
///   minimise |P(x) - T|^2  on  c(x) = 0,  stops kept,
/// with the other freedoms, where there are any, in equilibrium.
///
/// Every function gives the strong guarantee: it throws InputError, with everything as before, or succeeds. Copies
/// share the model, which does not change.
class TrackedEquilibrium {
 public:
  /// Settles from the start of the scene as solve() does. Throws InputError as solve().
  explicit TrackedEquilibrium(Scene scene, const TrackedOptions& options = {});

  /// The scene, without the hand, with the present position as its start.
  const Scene& scene() const { return scene_; }
  /// Has the stops of the hand besides, where it holds a point.
  const Scene& scene_with_hand() const { return model_->scene(); }
  const StaticModel& model() const { return *model_; }
  /// Belongs to model(). Where its status is not confirmed, nothing was found there.
  const Equilibrium& equilibrium() const { return equilibrium_; }
  BodyPoses poses() const { return model_->poses(equilibrium_.x); }
  /// The point that the hand holds.
  std::optional<PointRef> hand() const { return hand_ ? std::optional(hand_->at) : std::nullopt; }
  /// How many stops of scene_with_hand() are the hand: its last ones.
  std::size_t hand_stops() const { return hand_ ? hand_->along.size() : 0; }

  /// What the hand exerts on the body whose point it holds, N in the world; zero where none is found.
  Vec2 force_of_hand() const;

  /// The scene is now `wanted`. Where it differs in numbers only the equilibrium is followed; otherwise, a spring that
  /// is taken away, say, the mechanism is released where it is. Bodies must have the names that they had, or it settles
  /// from the start of `wanted`.
  Transition change(Scene wanted);
  /// Drags a point of a moving body to a place, m in the world, as close as it can get; or with limits as far towards
  /// it as they let it.
  Transition drag(PointRef point, Vec2 place, const DragLimits& limits = {});
  /// The hand lets go, and the mechanism settles.
  Transition release();
  /// Settles from the start of a scene: of one of before, where it was.
  void restore(Scene scene);
  /// The hand lets go, and the mechanism is taken to an equilibrium near these positions, stable or not. Throws
  /// InputError where none is found.
  void stay_at(const BodyPoses& poses);
  /// How it came here from the start of its scene, where it has settled from there and nothing was done since.
  Transition settled_from_start(const std::string& why) const;

 private:
  struct Hand {
    PointRef at;
    std::vector<Vec2> along;  ///< unit vectors, m in the world: the directions in which the hand holds it
  };
  struct Found {
    std::shared_ptr<const StaticModel> model;
    Equilibrium equilibrium;
  };

  /// What a scene is followed from.
  struct Position {
    Scene scene;
    BodyPoses poses;
    std::vector<int> active_stops;
    bool is_stable = false;
  };

  static Position position_of(const StaticModel& model, const Equilibrium& equilibrium);
  Found found_at(Scene scene, const BodyPoses& poses, double within) const;
  Found settled_from(Scene scene, std::vector<BodyPoses> carried, bool falls, const std::string& why,
                     Transition& transition, const DragLimits& limits = {}) const;
  Found moved(const Position& at, const Scene& after, const std::string& why, Transition& transition,
              const DragLimits& limits = {}) const;
  Transition drag_in_equilibrium(PointRef point, Vec2 place, const DragLimits& limits);
  Found dragged_to(Vec2 place, Hand& hand, const DragLimits& limits, Transition& out) const;
  void take(Scene scene, std::optional<Hand> hand, Found found);
  Transition drag_back(PointRef point, Vec2 place, const DragLimits& limits);
  Transition drag_all(DraggedPoint& walk, const std::vector<Vec2>& along, PointRef point, Vec2 place,
                      const DragLimits& limits);

  TrackedOptions options_;
  Scene scene_;
  std::optional<Hand> hand_;
  std::optional<BodyPoses> movable_;  // where the hand could move its point last
  std::shared_ptr<const StaticModel> model_;
  Equilibrium equilibrium_;
};

/// The scene with its start where these bodies stand: angles of bodies, travels of joints and places of bodies.
Scene started_at(Scene scene, const BodyPoses& poses);

/// A scene of which only the joints count, whatever acts on it and whether it could rest at all. Its loops closed near
/// these poses, by the shortest steps; none where that fails. Throws InputError if the scene contradicts itself.
std::optional<BodyPoses> closed_near(const Scene& scene, const BodyPoses& poses);

/// Such a scene moved from poses with closed loops so that a point comes as near to a place, m in the world, as joints
/// and stops let it. Throws InputError where it cannot move.
struct MovedPoint {
  BodyPoses poses;
  Transition transition;
};
MovedPoint moved_point(const Scene& scene, const BodyPoses& poses, PointRef point, Vec2 place,
                       const std::atomic<bool>* interrupt = nullptr);

}  // namespace poise
