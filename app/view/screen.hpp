#pragma once

#include <algorithm>
#include <string>

#include "app/draw/figure.hpp"
#include "app/draw/frames.hpp"
#include "app/view/other_equilibria.hpp"
#include "app/view/shown_mechanism.hpp"

namespace poise::app {

/// The part of the world that a page shows, and what is drawn there. Places on the page are in px of its drawings.
class Screen {
 public:
  /// Fits the mechanism where it stands, with room to move.
  explicit Screen(const ShownMechanism& shown);
  Screen(const Screen&) = delete;  // the drawer refers to its scene
  Screen& operator=(const Screen&) = delete;

  /// Whether all of the mechanism is within the part that is shown.
  bool shows(const ShownMechanism& shown) const;
  /// The positions that were passed and, last, the present one, with the forces in it. `steady`: arrows keep their
  /// scale, because one of them is being pulled.
  Drawing drawing(const ShownMechanism& shown, const Transition& transition, bool steady);
  /// The mechanism in other equilibria, small and without forces, in the same places.
  Drawing others(const OtherEquilibria::Found& found) const;
  /// The present position for a report.
  static Figure figure(const ShownMechanism& shown);

  /// m: of what is shown.
  double size() const { return std::max(world_.width(), world_.height()); }

  Vec2 world(Vec2 px) const { return view_.world(px); }
  Vec2 px(Vec2 world) const { return view_.page(world); }

  /// The arrow of a load of the scene as it was drawn last.
  struct LoadArrow {
    std::string name;
    Vec2 at, far;             ///< px: the point of the load, and the end of the arrow that is not there
    bool ends_there = false;  ///< its tip is at the point, not its tail
  };
  const std::vector<LoadArrow>& loads() const { return loads_; }
  /// The force, N in the world, of a load whose arrow is pulled at its far end to a place, px.
  Vec2 pulled(const std::string& load, Vec2 to) const;

 private:
  void find_loads(const Canvas& canvas, const ShownMechanism& shown);

  Scene scene_;  // as it is drawn: with the force of the hand as a load
  Box world_;
  FrameDrawer drawer_;
  FrameView view_;
  double height_ = 0.0;         // px
  double largest_force_ = 0.0;  // N: whose arrow is the longest
  std::vector<LoadArrow> loads_;
};

}  // namespace poise::app
