#pragma once

#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "statics/paths/path.hpp"
#include "statics/paths/private/path_crossings.hpp"
#include "statics/paths/private/path_pieces.hpp"

namespace poise {

/// Follows curves of equilibria through their folds and from piece to piece.
class PathTracer {
 public:
  PathTracer(const VariedScene& varied, const PathOptions& options, PathPieces& pieces, Path& out);

  /// What ends a branch besides PathBranch::End.
  enum class Until {
    ends,     ///< the ends of the range
    unstable  ///< the first point beyond which the equilibrium is no longer stable
  };
  /// Where a branch loses its stability.
  struct Loss {
    int event = -1;
    PathSpot at;
    double direction = 1.0;  ///< in which the parameter went before: 1 or -1
  };
  /// Appends a branch that begins at `start` and follows its tangent. Returns where it lost its stability, if it did,
  /// in the order of the events.
  std::vector<Loss> trace(const PathSpot& start, int from_event, Until until);

  /// A curve that leaves a branch point, not followed yet.
  struct Departure {
    int event = -1;
    PathSpot start;
    bool used = false;
  };
  std::deque<Departure>& departures() { return departures_; }

  /// Adds an event to a branch; returns its index.
  int add_event(PathEvent event, int branch);
  bool interrupted() const { return options_.interrupt != nullptr && options_.interrupt->load(); }

 private:
  class Walk;

  std::optional<PathSpot> step(const PathSpot& here, double h, double& badness);
  void fill(const PathSegment& segment, double from, double to, const PathSpot& begin, const PathSpot& end);
  int add_event(PathEvent event, const PathSpot& spot);
  void add_point(const PathSpot& spot, bool critical = false);
  void judge(PathEvent& event, const PathSpot& spot, int watched);
  int known_branch_point(const PathSpot& spot);
  void depart(const PathSpot& spot, int event, const Eigen::VectorXd& along);
  void mark_used(int event, const PathSpot& spot, const Eigen::VectorXd& along);
  bool repeats(const PathSpot& fold);

  const VariedScene& varied_;
  const PathOptions& options_;
  PathPieces& pieces_;
  Path& out_;
  PathCrossings crossings_;
  std::vector<double> wanted_;  // parameters of PathOptions::at
  std::deque<Departure> departures_;
  std::vector<std::pair<int, Eigen::VectorXd>> branch_points_;  // event, (x, p)
  int branch_ = -1;
};

}  // namespace poise
