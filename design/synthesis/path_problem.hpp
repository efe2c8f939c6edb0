#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "design/synthesis/path_models.hpp"
#include "model/planar.hpp"
#include "model/units.hpp"

namespace poise {

/// A linkage is wanted whose coupler point passes points, or draws a curve. Lengths in m, angles in rad.
struct PathProblem {
  std::string file{}, title{}, source{};
  Units units{};
  PathLinkage linkage = PathLinkage::four_bar;
  std::vector<Vec2> points{};                   ///< in their order; of a curve, spread evenly along it
  bool curve = false;                           ///< the points are those of a curve
  bool closed = false;                          ///< which returns to its begin
  std::vector<double> crank{};                  ///< the angle of the crank at each point; empty where it is free
  bool start_free = false;                      ///< all of these count from an angle that is free
  bool from_ground = false;                     ///< they count from the line of the pivots, not from the x axis
  bool order = true;                            ///< the points are to be passed in their order, or in the opposite one
  std::optional<std::array<Vec2, 2>> pivots{};  ///< of crank and output link
  PathLimits limits{};
  double size = 0.0;                     ///< largest distance of a point from the mean of all
  double tolerance = 0.0;                ///< to which points count as passed, m
  std::optional<double> within_error{};  ///< limit of the largest error where points cannot all be passed, m

  /// Unknowns more than conditions: with 0 the points can be passed, in general, by finitely many linkages, with more
  /// by infinitely many, with fewer by none.
  int freedom() const;
  bool exact() const { return freedom() >= 0; }
};

/// Reads a design file with [synthesis] kind = "path" (docs/path-synthesis.md). Throws InputError.
PathProblem read_path_problem(const std::filesystem::path& file);

}  // namespace poise
