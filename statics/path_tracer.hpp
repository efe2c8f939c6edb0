#pragma once

// Private to statics/path.cpp.

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "solvers/curve.hpp"
#include "statics/path.hpp"
#include "statics/path_piece.hpp"
#include "statics/varied_mechanism.hpp"

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

/// Follows curves of equilibria through their folds and from piece to piece.
class PathTracer {
 public:
  PathTracer(const VariedScene& varied, const PathOptions& options, Path& out);
  ~PathTracer();

  /// The spot at scaled coordinates x, nearly an equilibrium at the parameter p, with those stops active; its tangent
  /// points to where p grows (`direction` 1) or falls (-1). Empty where no equilibrium is near.
  std::optional<PathSpot> spot(const std::vector<double>& x, double p, const std::vector<int>& active_stops,
                               double direction);

  /// Coordinates of another equilibrium at p, found from x by deflation of those known; empty if none is.
  std::optional<std::vector<double>> deflated(const std::vector<double>& x, double p,
                                              const std::vector<PathSpot>& known, int steps);

  /// What ends a branch besides PathBranch::End.
  enum class Until {
    ends,     ///< the ends of the range
    unstable  ///< the first point beyond which the equilibrium is no longer stable
  };
  /// Appends a branch that begins at `start` and follows its tangent. Returns where it lost its stability, if it did:
  /// the events' indices, in their order.
  struct Loss {
    int event = -1;
    PathSpot at;
    double direction = 1.0;  ///< in which the parameter went before: 1 or -1
  };
  std::vector<Loss> trace(const PathSpot& start, int from_event, Until until);

  /// A curve that leaves a branch point, not followed yet.
  struct Departure {
    int event = -1;
    PathSpot start;
    bool used = false;
  };
  std::deque<Departure>& departures() { return departures_; }

  /// `critical`: where an event is.
  PathPoint report(const PathSpot& spot, bool critical = false) const;
  solvers::Curve& curve(const PathPiece& piece);
  /// Whether forces, closures or limits change with the parameter beside a spot, in the first derivative.
  bool depends(const PathSpot& spot);
  /// What whole turns of angles must leave as it is.
  enum class Turns { forces, forces_and_stops };
  /// `x` with whole turns added to angles such that it comes as near as possible to `near`, where these turns change
  /// nothing; otherwise x itself.
  std::vector<double> unwound(const std::vector<double>& x, const std::vector<double>& near, Turns turns);
  /// Adds an event to a branch; returns its index.
  int add_event(PathEvent event, int branch);
  /// The number, SI, at a parameter.
  double value_at(double p) const;
  int evaluations() const;
  bool interrupted() const { return options_.interrupt != nullptr && options_.interrupt->load(); }

 private:
  // The piece that x is on, and its multipliers there.
  PathSpot guess(const std::vector<double>& x, double p, const std::vector<int>& active_stops);
  std::vector<Loss> follow(const PathSpot& start, int from_event, Until until);
  struct Segment;
  struct Crossing;
  std::optional<PathSpot> at(const Segment& segment, double s);
  std::optional<PathSpot> step(const PathSpot& here, double h, double& badness);
  double arc(const Segment& segment);
  void interpolate(const Segment& segment, double s);
  // A function that is positive on a piece, with its derivative along the curve; and the same in a form that is smooth
  // along the curve, also where a distance passes its least value.
  struct Watched {
    double value = std::numeric_limits<double>::infinity(), rate = 0.0;
    double smooth = std::numeric_limits<double>::infinity(), smooth_rate = 0.0;
  };
  void watch(const PathSpot& spot, std::vector<Watched>& out);
  std::optional<PathSpot> find_fold(const Segment& segment, double& s);
  std::optional<PathSpot> find_branch(const Segment& segment, double& s, bool& is_pole);
  std::optional<PathSpot> find_multiple(const Segment& segment, double& s);
  bool find_crossings(const Segment& segment, const std::vector<Watched>& before, const std::vector<Watched>& after,
                      const PathSpot* start, std::vector<Crossing>& out);
  Eigen::VectorXd mapped(const Eigen::VectorXd& z, const PathPiece& from, const PathPiece& to);
  std::optional<PathSpot> switched(const PathSpot& spot, int watched);
  void fill(const Segment& segment, double from, double to, const PathSpot& begin, const PathSpot& end);
  int add_event(PathEvent event, const PathSpot& spot);
  void depart(const PathSpot& spot, int event, const Eigen::VectorXd& along);
  void mark_used(int event, const PathSpot& spot, const Eigen::VectorXd& along);
  void judge(PathEvent& event, const PathSpot& spot, int watched);
  std::optional<PathSpot> held(const PathSpot& spot, double p);
  double heaviest_multiplier(const PathSpot& spot);
  bool is_far(const PathSpot& spot);
  bool repeats(const PathSpot& fold);
  void add_point(const PathSpot& spot, bool critical = false);

  const VariedScene& varied_;
  const PathOptions& options_;
  Path& out_;
  std::vector<int> one_way_;
  std::map<std::vector<char>, std::unique_ptr<VariedMechanism>> mechanisms_;
  std::map<PathPiece, std::unique_ptr<solvers::Curve>> curves_;
  std::vector<int> equalities_;             // independent ones
  std::unique_ptr<StaticModel> somewhere_;  // in the middle of the range
  std::vector<double> wanted_;              // parameters of PathOptions::at
  std::deque<Departure> departures_;
  std::vector<std::pair<int, Eigen::VectorXd>> branch_points_;  // event, (x, p)
  int branch_ = -1;
  Eigen::VectorXd z_, row_;    // of interpolate()
  int angles_ = 0;             // of the coordinates, the first
  bool has_left_out_ = false;  // rows of closures that repeat others
};

}  // namespace poise
