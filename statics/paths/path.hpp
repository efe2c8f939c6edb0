#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "model/quantity.hpp"
#include "model/scene.hpp"
#include "statics/model/varied_scene.hpp"
#include "statics/proof/certificate.hpp"

namespace poise {

/// How a point of a path is known.
enum class PointProof {
  proved,     ///< Certificate::confirmed()
  critical,   ///< a fold, branch point or change of pieces, where rounding leaves open which equilibria there are; the
              ///< points on both sides of it are proved or not
  failed,     ///< nothing could be proved; PathPoint::statement says why
  not_tried,  ///< PathOptions::certify is off
};

/// An equilibrium on a path.
struct PathPoint {
  double parameter = 0.0;  ///< SI
  std::vector<double> x;   ///< scaled coordinates of VariedScene::model_at(), which has the same for all parameters
  Stability stability = Stability::unknown;
  int unstable_directions = 0;
  /// V, J; empty with follower loads, which have no potential.
  std::optional<double> energy;
  /// Of a driven measure: the force that holds it, N or N m, positive if it tends to increase the measure.
  double effort = 0.0;
  std::vector<int> active_stops;   ///< indices of Scene::stops, a driven measure left out
  std::vector<int> slack_springs;  ///< indices of Scene::elements: one-way springs that do not act
  PointProof proof = PointProof::not_tried;
  std::string statement;  ///< of the certificate
  double radius = 0.0;    ///< of the certificate: rad or mechanism sizes
};

/// A point where the curve of equilibria turns, branches or changes its pieces.
struct PathEvent {
  enum class Kind {
    fold,            ///< the parameter turns
    branch,          ///< curves of equilibria cross
    stop,            ///< a stop comes on or off
    slack,           ///< a one-way spring comes on or off
    flutter,         ///< a motion that grows sets in or ends (PathOptions::dynamic_stability), at a regular point
    snap,            ///< from a point where the loaded mechanism finds no stable equilibrium near, to where it lands
    hysteresis_end,  ///< where a mechanism loaded and unloaded again is back on the curve on which it was loaded
  };
  Kind kind = Kind::fold;
  PathPoint at;
  /// Of a fold or a branch point: relative distance of the parameter from the exact one for the scene as written, and
  /// what the rounding of the scene's own numbers leaves open, both to first order.
  double error = std::numeric_limits<double>::infinity();
  double rounding_effect = 0.0;
  int item = -1;    ///< of a stop or slack event: index of Scene::stops or Scene::elements
  bool on = false;  ///< it comes on along the path
  /// Of a snap: where the mechanism comes to rest, and energies before and after; empty where it comes to rest nowhere.
  std::optional<PathPoint> landing;
  /// Of a snap, with PathOptions::courses: the poses that it passes with heavy damping, scaled coordinates.
  std::vector<std::vector<double>> course;
  std::string why;  ///< of a snap that lands nowhere, of an event that could not be found to full accuracy

  /// Decimal digits of the parameter that are known: of `error` and of `rounding_effect`, at most 16.
  int digits() const;
};

/// A connected piece of the curve of equilibria, traced in one direction.
struct PathBranch {
  enum class End {
    range,     ///< the parameter reached an end of its range
    closed,    ///< back at the first point
    blocked,   ///< a stop lets the driven measure go no further
    snapped,   ///< PathOptions::Follow::jump: an event of kind snap ends it
    singular,  ///< closures lose rank: a change point or dead centre through which no single curve leads
    stuck,     ///< no step succeeds, `why` says where
    limit,     ///< PathOptions::most_points
    interrupted,
  };
  std::vector<PathPoint> points;  ///< in the order of the path
  std::vector<int> events;        ///< on it, indices of Path::events
  int from = -1;                  ///< event at which it begins; -1: the start
  End end = End::range;
  std::string why;
};

struct PathOptions {
  enum class From {
    settle,       ///< where the mechanism comes to rest when released from the scene's start at the first value
    equilibrium,  ///< the equilibrium nearest to the scene's start at the first value
    given         ///< the one at PathOptions::start
  };
  enum class Follow {
    unstable,  ///< the curve through its folds, also where it is unstable
    jump,  ///< what a machine does that is loaded slowly: stable equilibria only, from fold to landing, there and back
    load   ///< the same without the way back
  };
  From from = From::settle;
  std::vector<double> start{};  ///< From::given: scaled coordinates of VariedScene::model_at(from()), loops closed
  Follow follow = Follow::unstable;
  /// Starts, at each of five values, of a search for equilibria on curves that are not connected with the start.
  int search = 0;
  bool branches = false;      ///< follow all curves that cross at branch points
  bool courses = false;       ///< keep the poses that snaps pass
  bool certify = true;        ///< every point carries a certificate
  std::vector<double> at{};   ///< values of the parameter, SI, at which points are wanted besides; ascending or not
  double spacing = 0.01;      ///< largest distance of neighbouring points: parts of the range, rad, mechanism sizes
  double longest_step = 0.1;  ///< along the curve, in the same units
  int most_points = 100'000;  ///< of each branch
  CertificateOptions certificate{};
  /// Asked where loads follow bodies and the signs of stiffness do not decide (motion/dynamic_stability.hpp).
  std::function<Stability(const StaticModel&, const std::vector<double>& x)> dynamic_stability{};
  const std::atomic<bool>* interrupt = nullptr;
  /// Called now and then while curves are followed, and again while their points are proved.
  std::function<void(double parameter, int points)> progress{};
};

/// Curves of equilibria of a scene as one number of it changes.
struct Path {
  enum class Status {
    not_started,
    traced,      ///< every branch ended at the range's end, closed, joined or snapped
    incomplete,  ///< some branch ended otherwise
    no_start,    ///< no equilibrium was found at the first value
    interrupted
  };
  Status status = Status::not_started;
  std::string why;                 ///< one sentence
  std::vector<std::string> notes;  ///< sentences that a reader should not miss
  std::vector<PathBranch> branches;
  std::vector<PathEvent> events;
  /// Equilibria at each of PathOptions::at, in their order, in the order of the branches.
  std::vector<std::vector<PathPoint>> wanted;
  int steps = 0, evaluations = 0;
  /// Of following curves alone, without compiling, the search for the start and for landings, and certificates.
  double microseconds = 0.0;

  /// Points that carry no proof although one was tried.
  int unproved() const;
};

/// Follows the equilibria of a scene from the first value of its varied number to the last.
///
/// With x the coordinates, y the multipliers of closures and active stops and p the parameter, the curve of
///   F(x, p) + J(x, p)^T y = 0,   c(x, p) = 0,   g_s(x, p) = bound of active stop s
/// is followed by pseudo-arclength continuation (H. B. Keller, "Numerical solution of bifurcation and nonlinear
/// eigenvalue problems", 1977). docs/load-paths.md has the whole of it. Throws InputError if the mechanism cannot be
/// assembled at the first value; every numerical failure is a status.
Path path(const VariedScene& varied, const PathOptions& options = {});

}  // namespace poise
