#pragma once

#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "solvers/curve.hpp"
#include "statics/paths/path.hpp"
#include "statics/paths/path_piece.hpp"
#include "statics/paths/varied_mechanism.hpp"

namespace poise {

/// A point of the curve of equilibria on one of its smooth pieces.
struct PathSpot {
  PathPiece piece;
  solvers::CurvePoint point;  ///< the parameter runs from 0 to 1
  int negative = 0;           ///< directions, -1 where unknown

  double p() const { return point.z[point.z.size() - 1]; }
  double rate() const { return point.tangent[point.tangent.size() - 1]; }  ///< of p by arclength
  /// Turns to the other direction along the curve.
  void reverse() {
    point.tangent = -point.tangent;
    point.orientation = -point.orientation;
  }
};

/// The smooth pieces of the curves of equilibria as one number varies: the equations of each, what bounds it, and how
/// the curve goes on in the next. Pieces are compiled when they are first met, and kept.
class PathPieces {
 public:
  explicit PathPieces(const VariedScene& varied);
  ~PathPieces();

  /// The spot at scaled coordinates x, nearly an equilibrium at the parameter p, with those stops active; its tangent
  /// points to where p grows (`direction` 1) or falls (-1). Empty where no equilibrium is near.
  std::optional<PathSpot> spot(const std::vector<double>& x, double p, const std::vector<int>& active_stops,
                               double direction);
  /// Coordinates of another equilibrium at p, found from x by deflation of those known; empty if none is.
  std::optional<std::vector<double>> deflated(const std::vector<double>& x, double p,
                                              const std::vector<PathSpot>& known, int steps);
  /// The spot moved to the parameter p, nearly where it is already; empty where Newton's method leads elsewhere.
  std::optional<PathSpot> at_parameter(const PathSpot& spot, double p);
  /// `critical`: where an event is.
  PathPoint report(const PathSpot& spot, bool critical = false) const;

  solvers::Curve& curve(const PathPiece& piece);
  /// One-way springs, indices of Scene::elements.
  const std::vector<int>& one_way() const { return one_way_; }
  /// The number at a parameter, SI. What is zero but for the rounding of p is zero: equilibria are neutral exactly
  /// there, if at all.
  double value_at(double p) const;
  int evaluations() const;

  /// A function that is positive on a piece, with its derivative along the curve; and the same in a form that is smooth
  /// along the curve, also where a distance passes its least value.
  struct Watched {
    double value = std::numeric_limits<double>::infinity(), rate = 0.0;
    double smooth = std::numeric_limits<double>::infinity(), smooth_rate = 0.0;
  };
  /// Evaluates what must stay positive on the spot's piece: gaps of free stops (two each), pushes of active ones, and
  /// how far one-way springs are from their free length; infinite where nothing is watched.
  void watch(const PathSpot& spot, std::vector<Watched>& out);
  /// The unknowns of one piece as those of another: multipliers of rows that are not active there are left out, those
  /// of rows that come on are zero.
  Eigen::VectorXd mapped(const Eigen::VectorXd& z, const PathPiece& from, const PathPiece& to);
  /// Gives the point on the piece beyond the one that `watched` bounds, with the tangent that leads into it; empty
  /// where several curves leave it.
  std::optional<PathSpot> switched(const PathSpot& spot, int watched);

  /// Whether forces, closures or limits change with the parameter beside a spot, in the first derivative.
  bool depends(const PathSpot& spot);
  /// What whole turns of angles must leave as it is.
  enum class Turns { forces, forces_and_stops };
  /// `x` with whole turns added to angles such that it comes as near as possible to `near`, where these turns change
  /// nothing; otherwise x itself.
  std::vector<double> unwound(const std::vector<double>& x, const std::vector<double>& near, Turns turns);
  /// Size of the largest multiplier.
  double heaviest_multiplier(const PathSpot& spot);
  /// Whether the mechanism has run away there.
  bool is_far(const PathSpot& spot);
  /// Whether joints that repeat others where the curve began are open there.
  bool is_torn(const PathSpot& spot);

 private:
  // The piece that x is on, and its multipliers there.
  PathSpot guess(const std::vector<double>& x, double p, const std::vector<int>& active_stops);

  const VariedScene& varied_;
  std::vector<int> one_way_;
  std::map<std::vector<char>, std::unique_ptr<VariedMechanism>> mechanisms_;
  std::map<PathPiece, std::unique_ptr<solvers::Curve>> curves_;
  std::vector<int> equalities_;             // independent ones
  std::unique_ptr<StaticModel> somewhere_;  // in the middle of the range
  int angles_ = 0;                          // of the coordinates, the first
  bool has_left_out_ = false;               // rows of closures that repeat others
};

}  // namespace poise
