#pragma once

#include <compare>
#include <vector>

#include "solvers/curve.hpp"
#include "statics/model/static_model.hpp"

namespace poise {

/// Which stops act, and which one-way springs.
struct PathPiece {
  std::vector<signed char> side;  ///< per stop of VariedScene::scene_at(): -1 at min, 1 at max, 0 free
  std::vector<char> acts;         ///< per VariedMechanism::one_way_springs()

  friend auto operator<=>(const PathPiece&, const PathPiece&) = default;
};

/// The piece on which a pose lies whose active stops are known, a held measure (min = max) left out.
PathPiece piece_at(const StaticModel& model, const std::vector<double>& x, const std::vector<int>& active_stops);

/// Indices of Scene::stops that act, a driven measure left out, which is the last.
std::vector<int> active_stops(const PathPiece& piece, bool is_driven);

/// Of these one-way springs (VariedMechanism::one_way_springs) those that do not act.
std::vector<int> slack_springs(const PathPiece& piece, const std::vector<int>& one_way);

/// Closure rows that are independent at x; all of them beyond solvers::Curve::spectrum_limit.
std::vector<int> independent_closures(const Mechanism<double>& m, const std::vector<double>& x);

/// The kept closures, `equalities`, and the active stops, which follow on all `closures` rows.
std::vector<solvers::ActiveRow> active_rows(const PathPiece& piece, const std::vector<int>& equalities, int closures);

}  // namespace poise
