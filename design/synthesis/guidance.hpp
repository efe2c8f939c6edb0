#pragma once

#include <atomic>
#include <optional>
#include <span>
#include <vector>

#include "design/synthesis/centre_curve.hpp"
#include "design/synthesis/dyads.hpp"
#include "design/synthesis/four_bar.hpp"
#include "design/synthesis/passage.hpp"

namespace poise {

/// A rectangle with its lower left and upper right corner, m.
struct Rectangle {
  Vec2 low{}, high{};

  bool contains(const Vec2& p) const { return p.x >= low.x && p.x <= high.x && p.y >= low.y && p.y <= high.y; }
};

/// A four-bar whose coupler has all positions of a body.
struct GuidingFourBar {
  int input = 0, output = 0;  ///< its links, indices into those given
  FourBar linkage;            ///< its point is the origin of the body's frame
  GrashofKind kind = GrashofKind::triple_rocker;
  std::vector<InputPosition> positions;
  Passage passage;
  bool wanted = true;  ///< it is of the kind asked for, with its pivots where they are asked for

  bool suits() const { return wanted && passage.defect == Defect::none; }
};

/// What is asked of a four-bar besides its positions.
struct FourBarWishes {
  std::optional<GrashofKind> kind{};
  std::optional<Rectangle> within{};  ///< both pivots
};

/// A body that is to be guided through three to five positions by a four-bar.
struct PoseTask {
  std::vector<BodyPosition> positions{};
  FourBarWishes wishes{};
  std::vector<Vec2>
      near{};  ///< of four positions: the pivots are the points of the curve nearest to these; two or none
  std::vector<Vec2> pins{};    ///< of three positions, in the body's frame; two pins and pivots in all
  std::vector<Vec2> pivots{};  ///< of three positions
};

/// Each pair of links as a four-bar, driven by the one with which it passes the positions without a defect, or, where
/// both do, with the larger transmission angle. Slides are left out.
std::vector<GuidingFourBar> four_bars_of(std::span<const GuidingDyad> links, std::span<const BodyPosition> positions,
                                         const FourBarWishes& wishes);

/// The index of the one that suits, with the largest least transmission angle; -1 where none does.
int best_of(const std::vector<GuidingFourBar>& found);

/// The best four-bar of two links of a curve, of all pairs of its points. The pivots lie in the rectangle asked for, or
/// else no farther from the middle of the positions, along x and along y, than six times the farthest of these; so do,
/// always, the pins in the first position. Both links are then 0 and 1 of `links`; empty where none suits.
struct BestPair {
  std::vector<GuidingDyad> links;
  long pairs = 0;  ///< that were tried
  bool interrupted = false;
};
BestPair best_pair(const CentreCurve& curve, std::span<const BodyPosition> positions, const FourBarWishes& wishes,
                   const std::atomic<bool>* interrupt);

/// Four-bars that guide a body.
struct Guidance {
  FiveDyads five;                         ///< of five positions
  CentreCurve curve;                      ///< of four
  long pairs = 0;                         ///< of points of the curve that were tried for the best
  bool interrupted = false;               ///< before all pairs were
  std::vector<GuidingDyad> links;         ///< all of five positions, else the two that were chosen
  std::vector<GuidingFourBar> four_bars;  ///< of pairs of these
  int best = -1;                          ///< the best that suits, an index; -1 where none does
};

/// Does the task: all four-bars through five positions; through four that of the two points of the curve of centres
/// that were asked for, or the best of all pairs of its points; through three that with the points given.
Guidance guide(const PoseTask& task, const std::atomic<bool>* interrupt = nullptr);

}  // namespace poise
