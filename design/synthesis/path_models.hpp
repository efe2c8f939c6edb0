#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "design/synthesis/four_bar.hpp"
#include "design/synthesis/path_squares.hpp"
#include "model/planar.hpp"

namespace poise {

/// The linkages whose coupler points are fitted.
enum class PathLinkage { four_bar, slider_crank };

/// The unknowns of a linkage, in this order: pivot a of the crank (2); of a four-bar pivot b (2), of a slider-crank
/// direction and distance from a of the line of the slider's pin (2); logarithms of the lengths of crank, coupler and
/// output link (of a slider-crank unused); the coupler point in the frame of the coupler (2); the first angle of the
/// crank, where that is free.
inline constexpr int path_unknowns = 10;
enum PathUnknown : int { at_a = 0, at_b = 2, at_crank = 4, at_coupler = 5, at_output = 6, at_point = 7, at_start = 9 };
using PathVector = std::array<double, path_unknowns>;

/// What a linkage must keep to; lengths in the unit of the points.
struct PathLimits {
  bool full_turn = false;                ///< the crank turns fully
  double margin_of_turn = 0.0;           ///< so much longer than necessary for that is the sum of two links
  double transmission = 0.0;             ///< least angle of transmission, where the crank turns fully, rad
  double shortest = 0.0, longest = 1e3;  ///< of ground, links and the distance of the coupler point from its pins
  std::optional<std::array<Vec2, 2>> within{};  ///< lower left and upper right corner of where pivots may be
};

/// Distances of the coupler point from wanted points, as squares over the unknowns of the linkage and, where the angle
/// of the crank is free at each point, these. The residuals of a point are the two parts of its distance and how far
/// the links are from reaching each other. Limits are kept by squares of what is beyond them, which PathFit::tighten()
/// shifts until they hold (the method of multipliers).
class PathFit final : public PointSquares {
 public:
  struct Task {
    PathLinkage linkage = PathLinkage::four_bar;
    std::vector<Vec2> points;
    bool timed = false;        ///< t of each point is given: the angle of the crank, behind x[at_start]
    bool start_free = false;   ///< timed: x[at_start] is an unknown
    bool from_ground = false;  ///< angles of the crank count from the line of the pivots, not from the x axis
    bool pivots_given = false;
    PathVector pivots{};  ///< those given, at their places
    PathLimits limits{};
  };

  PathFit(const Task& task, std::vector<int> closures);

  int shared() const override { return path_unknowns; }
  int points() const override { return static_cast<int>(task_.points.size()); }
  int rows() const override { return 3; }
  int more_rows() const override { return static_cast<int>(shifts_.size()); }
  bool own(int) const override { return !task_.timed; }
  bool evaluate(int point, std::span<const double> x, double t, std::span<double> residuals,
                std::span<double> by_shared, std::span<double> by_own) const override;
  bool evaluate_more(std::span<const double> x, std::span<double> residuals,
                     std::span<double> by_shared) const override;

  /// Shifts each limit by what is beyond it. Returns the largest violation at x.
  double tighten(std::span<const double> x);

 private:
  const Task& task_;
  std::vector<int> closures_;
  std::vector<double> shifts_;
};

/// The coupler point of a linkage; `gap` > 0 is how far its links are from reaching each other.
struct CouplerPlace {
  Vec2 point{};
  double gap = 0.0;
};
CouplerPlace coupler_place(PathLinkage linkage, std::span<const double> x, double crank_angle, int closure);

/// How far limits are exceeded, each <= 0 where it holds.
std::vector<double> beyond_limits(PathLinkage linkage, std::span<const double> x, const PathLimits& limits);

FourBar four_bar_of(std::span<const double> x);
PathVector unknowns_of(const FourBar& linkage);

/// Two links that are joined to the same coupler, each by the condition that its length is the same at all points:
///
///   |P_i - e^(i phi_i) z - A| = l    of both, with phi_1 = 0.
///
/// Unknowns x: A, B, z of both (8), the lengths (2); t: phi. Both links the same would solve everything: the second
/// condition is the difference to the first over that of the links.
class LinkFit final : public PointSquares {
 public:
  LinkFit(const std::vector<Vec2>& points, bool pivots_given) : points_(points), pivots_given_(pivots_given) {}

  int shared() const override { return path_unknowns; }
  int points() const override { return static_cast<int>(points_.size()); }
  int rows() const override { return 2; }
  int more_rows() const override { return 0; }
  bool own(int point) const override { return point > 0; }
  bool evaluate(int point, std::span<const double> x, double t, std::span<double> residuals,
                std::span<double> by_shared, std::span<double> by_own) const override;
  bool evaluate_more(std::span<const double>, std::span<double>, std::span<double>) const override { return true; }

 private:
  const std::vector<Vec2>& points_;
  bool pivots_given_;
};

}  // namespace poise
