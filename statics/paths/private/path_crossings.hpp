#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "statics/paths/private/path_pieces.hpp"

namespace poise {

/// A step along a curve of equilibria: two spots of a piece, and the length h of the arc between them.
struct PathSegment {
  PathSpot a, b;
  double h = 0.0;
};

/// An event between the ends of a segment.
struct PathCrossing {
  enum class Kind {
    fold,         ///< the parameter turns back
    branch,       ///< curves cross, by the sign of a determinant
    multiple,     ///< several eigenvalues change their sign together
    watched,      ///< the piece ends: a stop is met or left, a one-way spring goes slack or acts
    range,        ///< the parameter reaches an end of its range
    start,        ///< back at the start of the branch
    dead_centre,  ///< multipliers grow without bound
  } kind;
  double s = 0.0;    ///< arclength from the segment's beginning
  int watched = -1;  ///< index of what PathPieces::watch() gives
  PathSpot spot{};
};

/// Finds what a curve of equilibria meets within a step. The curve between the ends of a segment is the quintic through
/// them with their tangents and bends, from which Newton's method leads to the curve itself.
class PathCrossings {
 public:
  explicit PathCrossings(PathPieces& pieces) : pieces_(pieces) {}

  /// Length of the arc between two spots, of a circle through both with their tangents.
  double arc(const PathSpot& a, const PathSpot& b);
  /// The spot of the curve at arclength s of a segment, about; empty where none is near.
  std::optional<PathSpot> at(const PathSegment& segment, double s);
  /// The interpolated spot there, corrected onto the curve, without its derivatives; false where that fails.
  bool place(const PathSegment& segment, double s, PathSpot& spot);

  struct Root {
    double s;
    PathSpot spot;
  };
  using Function = std::function<double(const PathSpot&)>;
  /// Root of f on the part of a segment that begins at `from` and is h long, at whose ends f has the values fa and fb
  /// of opposite signs. Its s counts from there. Empty where the curve is not found.
  std::optional<Root> root(const PathSegment& segment, double from, double h, const Function& f, double fa, double fb);

  /// Finds the events of a segment, in no order. `before` and `after` are watched at its ends; `start` is the first
  /// spot of the branch, where the curve may close, or null. False if the segment should be halved to tell them apart.
  bool find(const PathSegment& segment, const std::vector<PathPieces::Watched>& before,
            const std::vector<PathPieces::Watched>& after, const PathSpot* start, std::vector<PathCrossing>& out);

 private:
  void interpolate(const PathSegment& segment, double s);
  bool find_ends_of_piece(const PathSegment& segment, const std::vector<PathPieces::Watched>& before,
                          const std::vector<PathPieces::Watched>& after, std::vector<PathCrossing>& out);
  bool find_folds(const PathSegment& segment, std::vector<PathCrossing>& out);
  bool find_branches(const PathSegment& segment, std::vector<PathCrossing>& out);
  bool find_multiples(const PathSegment& segment, std::vector<PathCrossing>& out);
  bool find_end_of_range(const PathSegment& segment, double limit, std::vector<PathCrossing>& out);
  void find_start(const PathSegment& segment, const PathSpot& start, std::vector<PathCrossing>& out);
  std::optional<PathSpot> fold(const PathSegment& segment, double& s);
  std::optional<PathSpot> branch_point(const PathSegment& segment, double& s, bool& is_pole);
  std::optional<PathSpot> multiple_point(const PathSegment& segment, double& s);

  PathPieces& pieces_;
  Eigen::VectorXd z_, row_;  // of interpolate()
};

}  // namespace poise
